"""A unit of FMI 3.0 made with pythonfmu3: `pythonfmu3 build -f gain3.py`; one multiplication a step."""

from pythonfmu3 import Fmi3Causality, Fmi3Slave, Fmi3StepResult, Fmi3Status, Fmi3Variability, Float64
from pythonfmu3.cosimulation import CoSimulation


class Gain3(Fmi3Slave, CoSimulation):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time, self.u, self.y = 0.0, 1.0, 0.0
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous)
        )
        self.register_variable(Float64("u", causality=Fmi3Causality.input, variability=Fmi3Variability.continuous))
        self.register_variable(Float64("y", causality=Fmi3Causality.output, variability=Fmi3Variability.continuous))

    def do_step(self, current_time, step_size):
        self.y = 2.0 * self.u
        return Fmi3StepResult(status=Fmi3Status.ok)
