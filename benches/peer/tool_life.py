"""The constant-speed study of `cargo bench -p toolroom-life --bench life`, vectorised in NumPy.

    python benches/peer/tool_life.py [LIVES]

Same model (set ni_vk6om at 30 m/min), same scatter, chipping and wear noise, same quadrature over
16 panels; lives a second on one core, and the mean and variation to compare with.
"""

import sys
import time

import numpy as np

# Set ni_vk6om in SI.
A0, EM, PHI_C, B0, ET, THETA_R = 0.18333e-6, 173.4e3, 6.0, 9e-6 / 60, 173.4e3, 1028.9
H_R, H_E, H_T, H_CR, H_0 = 0.08e-3, 0.02e-3, 0.6e-3, 0.6e-3, 0.02e-3
K_T, X, K_F, AMBIENT, R = 130.0, 0.38, 70.0, 293.15, 8.314462618
V = 30.0 / 60
PANELS, STRETCH = 16, 30.0
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)


def simulate(n, rng, chip_rate):
    z = rng.standard_normal((8, n))
    common, mechanical, thermal = np.exp(0.28 * z[0]), np.exp(0.15 * z[1]), np.exp(0.15 * z[2])
    hardness = np.clip(1 + 0.03 * z[3], 0.85, 1.15)
    initial = 0.005e-3 * np.exp(0.5 * z[7])
    resistance = rng.exponential(size=n)
    chip_heat = K_T * (V * 60) ** X * np.sqrt(hardness)
    a_level, b_level = A0 * common * mechanical * hardness, B0 * common * thermal
    levels = H_CR * ((1 + STRETCH) ** (np.arange(1, PANELS + 1) / PANELS) - 1) / STRETCH
    edges = np.maximum(np.concatenate([[0.0], levels])[:, None], initial[None, :])
    x = np.log1p(edges / H_E)
    operational = np.zeros((PANELS + 1, n))
    for k in range(PANELS):
        centre, half = 0.5 * (x[k] + x[k + 1]), 0.5 * (x[k + 1] - x[k])
        total = 0.0
        for node, weight in zip(NODES, WEIGHTS):
            stretch = np.exp(centre + half * node)
            h = H_E * (stretch - 1)
            theta = AMBIENT + chip_heat + K_F * np.sqrt(V * 60 * (h + H_0) * 1e3) * np.sqrt(hardness)
            cold = 1 / theta - 1 / THETA_R
            phi = 1 / (1 / PHI_C + (1 - 1 / PHI_C) * np.exp(-EM / R * cold))
            a = a_level * (1 + H_R / (h + H_E)) * phi
            b = b_level * (1 + (h / H_T) ** 2) * np.exp(-ET / R * cold)
            total = total + weight * H_E * stretch / (V * a + b)
        operational[k + 1] = operational[k] + half * total
    # Wear noise held for 30 s: time against time without noise, then interpolated for every edge.
    held, tau, sigma = 30.0, 300.0, 0.10
    steps = int(operational[-1].max() / held * 1.6) + 2
    decay, spread = np.exp(-held / tau), sigma * np.sqrt(-np.expm1(-2 * held / tau))
    noise = sigma * rng.standard_normal(n)
    clock = np.zeros((steps + 1, n))
    for i in range(steps):
        clock[i + 1] = clock[i] + held * np.exp(noise - 0.5 * sigma**2)
        noise = noise * decay + spread * rng.standard_normal(n)
    # One search for all edges: every edge's clock is shifted to a range of its own.
    shift = np.arange(n) * (2.0 * clock[-1].max())
    found = np.searchsorted((clock + shift).T.ravel(), (operational + shift).T.ravel(), side="right") - 1
    at = np.minimum(found.reshape(n, PANELS + 1).T - np.arange(n) * (steps + 1), steps - 1)
    rows = np.arange(n)
    low, high = clock[at, rows], clock[at + 1, rows]
    times = held * (at + (operational - low) / (high - low))
    # Chipping: Weibull hazard in path with the land's part by Simpson's rule.
    aged = lambda h: 1 + (h / 0.4e-3) ** 2
    land = (aged(edges[:-1]) + 4 * aged(0.5 * (edges[:-1] + edges[1:])) + aged(edges[1:])) / 6
    power = (chip_rate * V * times) ** 1.5
    hazard = np.concatenate([np.zeros((1, n)), np.cumsum(land * np.diff(power, axis=0), axis=0)])
    life = times[-1].copy()
    chipped = hazard[-1] >= resistance
    for i in np.flatnonzero(chipped):
        k = np.searchsorted(hazard[:, i], resistance[i]) - 1
        part = power[k, i] + (power[k + 1, i] - power[k, i]) * (resistance[i] - hazard[k, i]) / (hazard[k + 1, i] - hazard[k, i])
        life[i] = part ** (1 / 1.5) / (chip_rate * V)
    return life, chipped


def main(count):
    rng = np.random.default_rng(1)
    # The rate at which one nominal edge in ten chips: hazard of a nominal life grows with its
    # power 1.5.
    chip_rate = float(sys.argv[2]) if len(sys.argv) > 2 else 2.06e-4
    simulate(1000, rng, chip_rate)
    started = time.perf_counter()
    block = 20_000
    lives = [simulate(min(block, count - i), rng, chip_rate) for i in range(0, count, block)]
    seconds = time.perf_counter() - started
    life = np.concatenate([each[0] for each in lives]) / 60
    chipped = np.concatenate([each[1] for each in lives])
    print(f"{count / seconds:,.0f} lives/s  mean {life.mean():.3f} min  CV {life.std() / life.mean():.4f}  chipped {100 * chipped.mean():.1f} %")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100_000)
