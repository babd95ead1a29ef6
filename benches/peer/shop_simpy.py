"""The models of shop.py in SimPy: `python shop_simpy.py queue|jobshop OPERATIONS`, prints the mean stay, min."""

import random
import sys

import simpy

MODEL, OPERATIONS = sys.argv[1], int(sys.argv[2])
MACHINES, STEPS, RATE = (1, 1, 0.8) if MODEL == "queue" else (100, 10, 8.0)
draw = random.Random(2)
env = simpy.Environment()
machines = [simpy.Resource(env) for _ in range(MACHINES)]
stays = [0.0, 0]


def order(routing):
    begin = env.now
    for machine in routing:
        with machine.request() as request:
            yield request
            yield env.timeout(draw.expovariate(1.0))
    stays[0] += env.now - begin
    stays[1] += 1


def source():
    while True:
        yield env.timeout(draw.expovariate(RATE))
        env.process(order(draw.sample(machines, STEPS)))


env.process(source())
env.run(OPERATIONS / STEPS / RATE)
print(f"{stays[0] / stays[1]:.3f}")
