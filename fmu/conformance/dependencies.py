"""Declared dependencies against those that the unit shows: python dependencies.py compare FILE.

Model Exchange in FMPy. Every effect is on, and at scattered points each known (real inputs,
Boolean inputs of the process, continuous states) is moved by itself; an unknown (output,
derivative, event indicator) that changes in any bit depends on it. The points are other ones than
those of the exporter. Outputs of the verdict on chatter depend on the same knowns: what one of
them shows counts for all. The result is one line of JSON; `declared` instead of `compare` gives the
declared pairs.
"""

import ctypes
import json
import math
import random
import sys

# A verdict on chatter takes some milliseconds, all else some microseconds.
POINTS, JUDGED_POINTS = 150, 12


class Exchange:
    """An instance in Continuous-Time Mode whose inputs and states are set at will."""

    def __init__(self, path, parameters):
        import fmpy
        from fmpy.fmi2 import FMU2Model
        from fmpy.fmi3 import FMU3Model

        self.description = fmpy.read_model_description(path)
        self.two = self.description.fmiVersion.startswith("2")
        kind = FMU2Model if self.two else FMU3Model
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(path),
            modelIdentifier=self.description.modelExchange.modelIdentifier,
        )
        self.fmu.instantiate()
        if self.two:
            self.fmu.setupExperiment(startTime=0.0)
        for variable, value in parameters(self.description):
            self.set(variable, value)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.settle()
        self.fresh = (self.fmu.getFMUstate if self.two else self.fmu.getFMUState)()
        self.states = [each.variable.derivative for each in self.description.derivatives]

    def set(self, variable, value):
        names = {"Boolean": "Boolean", "Real": "Real", "Float64": "Float64"}
        getattr(self.fmu, "set" + names[variable.type])([variable.valueReference], [value])

    def settle(self):
        """Event iteration, then Continuous-Time Mode."""
        while (self.fmu.newDiscreteStates if self.two else self.fmu.updateDiscreteStates)()[0]:
            pass
        self.fmu.enterContinuousTimeMode()

    def at(self, states, inputs, unknowns):
        """The unknowns of a fresh unit with these states and inputs."""
        (self.fmu.setFMUstate if self.two else self.fmu.setFMUState)(self.fresh)
        switches = [(each, value) for each, value in inputs.items() if each.type == "Boolean"]
        if switches:
            self.fmu.enterEventMode()
            for variable, value in switches:
                self.set(variable, value)
            self.settle()
        for variable, value in inputs.items():
            if variable.type != "Boolean":
                self.set(variable, value)
        array = (ctypes.c_double * len(self.states))(*[states[each] for each in self.states])
        self.fmu.setContinuousStates(array, len(self.states))
        read = {"Boolean": self.fmu.getBoolean, "Real": self.fmu.getReal} if self.two else {}
        read = read or {"Boolean": self.fmu.getBoolean, "Float64": self.fmu.getFloat64}
        values = {}
        for kind, function in read.items():
            of_kind = [each for each in unknowns if each.type == kind]
            values.update(zip(of_kind, function([each.valueReference for each in of_kind])))
        return [float(values[each]).hex() for each in unknowns]


    def same(self, states, inputs):
        """States and inputs of another instance, as keys of this one."""
        own = {each.name: each for each in self.description.modelVariables}
        return ({own[each.name]: value for each, value in given.items()} for given in (states, inputs))


def attribute(variable, name):
    value = getattr(variable, name)
    return getattr(variable.declaredType, name) if value is None and variable.declaredType else value


def number(variable, name, otherwise):
    value = attribute(variable, name)
    return otherwise if value is None else float(value)


def within(variable, value):
    return min(max(value, number(variable, "min", -math.inf)), number(variable, "max", math.inf))


def effects(description, chatter=False, damped=True):
    """Every effect at a fifth of its display unit; judged for chatter, the machine damped by the process."""
    factors = {(unit.name, shown.name): shown.factor for unit in description.unitDefinitions for shown in unit.displayUnits}
    for variable in description.modelVariables:
        if variable.name.endswith(".process_damping") and not damped:
            yield variable, 0.0
        elif variable.name.startswith("effect.") and variable.causality == "parameter":
            unit = (attribute(variable, "unit"), attribute(variable, "displayUnit"))
            yield variable, 1.0 if variable.type == "Boolean" else within(variable, 0.2 / float(factors.get(unit, 1.0)))
        if chatter and variable.name == "machine.chatter":
            yield variable, True


def scattered(variable, source, scale, everything):
    if variable.type == "Boolean":
        return source.random() > 0.3
    start = float(variable.start or 0.0)
    if start != 0.0:
        return within(variable, start * source.uniform(0.6, 1.4))
    if not everything:
        return 0.0
    return within(variable, scale * number(variable, "nominal", 1.0) * source.random())


def moved(variable, value):
    if variable.type == "Boolean":
        return not value
    # More than the speed and damping by which a verdict is kept are rounded.
    step = 0.4 * abs(value) + 1e-3 * abs(number(variable, "nominal", 1.0))
    return value + step if value + step <= number(variable, "max", math.inf) else value - step


def real(variable):
    return variable.type in ("Real", "Float64")


def try_points(path, points, seed, chatter=False, damped=True):
    """Pairs of unknown and known that show, and the unknowns that change with their verdict."""
    unit = Exchange(path, lambda description: effects(description, chatter, damped))
    silent = Exchange(path, effects) if chatter else None
    knowns, unknowns = of(unit.description)
    inputs = [each for each in knowns if each not in unit.states]
    source = random.Random(seed)
    shown, judged = set(), set()
    amplitude = next(i for i, each in enumerate(unknowns) if each.name == "process.vibration_amplitude")
    for point in range(points):
        scale = (0.1, 1.0, 100.0)[point % 3]
        states = {each: scattered(each, source, scale, True) for each in unit.states}
        # A wild machine takes long to judge: what starts at zero stays there.
        given = {each: scattered(each, source, scale, not chatter) for each in inputs}
        if chatter:
            # Deep cuts, too: a stable one has neither growth nor frequency.
            deep = next(each for each in inputs if each.name == "process.depth_of_cut")
            given[deep] = within(deep, given[deep] * 10 ** source.uniform(-0.5, 1.5))
        before = unit.at(states, given, unknowns)
        if silent:
            without = silent.at(*silent.same(states, given), unknowns)
            judged |= {unknown.name for unknown, one, other in zip(unknowns, before, without) if one != other}
        for known in knowns:
            if known in given:
                after = unit.at(states, {**given, known: moved(known, given[known])}, unknowns)
            else:
                after = unit.at({**states, known: moved(known, states[known])}, given, unknowns)
            if float.fromhex(before[amplitude]) < 0.0 or float.fromhex(after[amplitude]) < 0.0:
                continue  # a force below zero: the effects together left the range of the equations
            shown |= {(unknown.name, known.name) for unknown, one, other in zip(unknowns, before, after) if one != other}
    return shown, judged


def of(description):
    """Knowns and unknowns whose dependencies are declared and can be tried."""
    derivatives = [each.variable for each in description.derivatives]
    knowns = [each for each in description.modelVariables if each.causality == "input" and real(each)]
    # The others, such as tool.change, act through an event.
    switch = lambda each: each.causality == "input" and each.type == "Boolean" and each.name.startswith("process.")
    knowns += [each for each in description.modelVariables if switch(each)]
    knowns += [each.derivative for each in derivatives]
    return knowns, [each.variable for each in structure(description)]


def structure(description):
    """Entries of the model structure that declare dependencies."""
    every = [*description.outputs, *description.derivatives, *description.eventIndicators]
    return [each for each in every if each.dependencies is not None]


def pairs_of(path):
    """The declared pairs of unknown and known."""
    import fmpy

    entries = structure(fmpy.read_model_description(path))
    return sorted([each.variable.name, known.name] for each in entries for known in each.dependencies)


def compare(path):
    import fmpy

    description = fmpy.read_model_description(path)
    shown, _ = try_points(path, POINTS, seed=1)
    by_verdict, judged = set(), set()
    # A slow cut on a damped machine is stable whatever its depth, an undamped one hardly ever.
    for damped in (True, False):
        pairs, unknowns = try_points(path, JUDGED_POINTS, seed=2, chatter=True, damped=damped)
        by_verdict, judged = by_verdict | pairs, judged | unknowns
    # What only a judged unit shows is what the verdict depends on.
    verdict = {known for unknown, known in by_verdict - shown if unknown in judged}
    shown |= by_verdict
    knowns, unknowns = of(description)
    declared = {tuple(pair) for pair in pairs_of(path)}
    idle = {pair for pair in declared - shown if not (pair[0] in judged and pair[1] in verdict)}
    return {
        "tried": len(knowns) * len(unknowns),
        "declared": len(declared),
        "verdict": sorted(judged),
        "hidden": sorted(shown - declared),
        "idle": sorted(idle),
    }


if __name__ == "__main__":
    print("\n" + json.dumps({"declared": pairs_of, "compare": compare}[sys.argv[1]](sys.argv[2])))
