"""One importer in a process of its own: python importers.py NAME FILE [ARGUMENT].

A unit or an importer that crashes takes only this process with it. The result is one line of
JSON on standard output.
"""

import json
import sys
import time

WEAR = "process.flank_wear"
POINTS = [100.0, 200.0, 300.0, 400.0, 500.0, 600.0]


def fmpy_run(path, interface, step, inputs=None, event_mode=False, start_values=None):
    """Time, wear and count of edges at the communication points."""
    import fmpy
    import numpy

    signals = None
    if inputs is not None:
        signals = numpy.genfromtxt(inputs, delimiter=",", names=True, deletechars="", dtype=None, encoding="utf-8")
        types = [(signals.dtype.names[0], float)] + [(name, bool) for name in signals.dtype.names[1:]]
        signals = numpy.array([tuple(row) for row in signals], dtype=types)
    result = fmpy.simulate_fmu(
        path,
        fmi_type=interface,
        stop_time=600.0,
        step_size=step,
        output_interval=step if interface == "CoSimulation" else 6.0,
        relative_tolerance=1e-8,
        input=signals,
        start_values=start_values or {},
        output=[WEAR, "process.temperature", "tool.count"],
        use_event_mode=event_mode,
        early_return_allowed=event_mode,
    )
    return [[float(value) for value in row] for row in result]


def ecos(path):
    from ecospy.EcosSimulation import EcosSimulation
    from ecospy.EcosSimulationStructure import EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model("unit", path)
    simulation = EcosSimulation(structure=structure, step_size=1.0)
    simulation.init()
    rows = []
    for _ in POINTS:
        simulation.step(100)
        rows.append([simulation.get_time(), simulation.get_real(f"unit::{WEAR}")])
    simulation.terminate()
    simulation.free()
    return rows


def libcosim(path):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(1_000_000_000)
    slave = execution.add_local_slave(CosimLocalSlave(path, "unit"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    references = {each.name.decode(): each.reference for each in execution.slave_variables(slave)}
    rows = []
    for point in POINTS:
        execution.step(100)
        values = observer.last_real_values(slave_index=slave, variable_references=[references[WEAR]])
        rows.append([point, values[0]])
    return rows


class Instance:
    """An instance of FMI 3.0 or 2.0 Co-Simulation in FMPy, ready to step."""

    def __init__(self, path):
        import fmpy
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        self.description = fmpy.read_model_description(path)
        self.references = {each.name: each.valueReference for each in self.description.modelVariables}
        kind = FMU2Slave if self.description.fmiVersion.startswith("2") else FMU3Slave
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(path),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )
        self.two = kind is FMU2Slave
        self.fmu.instantiate()
        if self.two:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def step(self, time_, step):
        self.fmu.doStep(time_, step)

    def get(self, name):
        references = [self.references[name]]
        return (self.fmu.getReal(references) if self.two else self.fmu.getFloat64(references))[0]

    def save(self):
        state = self.fmu.getFMUstate() if self.two else self.fmu.getFMUState()
        return (self.fmu.serializeFMUstate if self.two else self.fmu.serializeFMUState)(state)

    def restore(self, data):
        state = (self.fmu.deSerializeFMUstate if self.two else self.fmu.deserializeFMUState)(data)
        (self.fmu.setFMUstate if self.two else self.fmu.setFMUState)(state)


def save(path, file):
    """Steps to 300 s, saves, goes on to 600 s."""
    unit = Instance(path)
    for i in range(300):
        unit.step(float(i), 1.0)
    data = bytes(unit.save())
    with open(file, "wb") as out:
        out.write(data)
    for i in range(300, 600):
        unit.step(float(i), 1.0)
    return {"wear": unit.get(WEAR).hex(), "bytes": len(data)}


def restore(path, file):
    """In another process: goes on from the saved state; damaged bytes have to be refused."""
    unit = Instance(path)
    with open(file, "rb") as source:
        data = source.read()
    refused = 0
    damaged = [data[:-1], data[: len(data) // 2], b"", bytes([data[0] ^ 1]) + data[1:]]
    damaged.append(data[:40] + bytes([data[40] ^ 4]) + data[41:])
    for each in damaged:
        try:
            unit.restore(each)
        except Exception:
            refused += 1
            unit = Instance(path)
    unit.restore(data)
    for i in range(300, 600):
        unit.step(float(i), 1.0)
    return {"wear": unit.get(WEAR).hex(), "refused": refused, "damaged": len(damaged)}


def cycles(path, count):
    """Growth of memory over `count` instances, in kB."""
    unit = Instance(path)
    fmu, two = unit.fmu, unit.two

    def resident():
        with open("/proc/self/statm") as source:
            return int(source.read().split()[1]) * 4

    def once():
        (fmu.fmi2FreeInstance if two else fmu.fmi3FreeInstance)(fmu.component)
        fmu.instantiate()
        if two:
            fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        fmu.doStep(0.0, 1.0)

    for _ in range(200):
        once()
    before = resident()
    for _ in range(int(count)):
        once()
    return {"growth_kB": resident() - before}


def threads(path):
    """How many different results four threads with four instances each give."""
    from concurrent.futures import ThreadPoolExecutor

    def four(_):
        units = [Instance(path) for _ in range(4)]
        for i in range(100):
            for unit in units:
                unit.step(float(i), 1.0)
        return {unit.get(WEAR).hex() for unit in units}

    with ThreadPoolExecutor(4) as pool:
        return {"different": len(set().union(*pool.map(four, range(4))))}


def speed(path, output):
    """Seconds of a step and of reading one output through FMPy."""
    unit = Instance(path)
    count = 5000
    start = time.perf_counter()
    for i in range(count):
        unit.step(i * 0.1, 0.1)
    step = (time.perf_counter() - start) / count
    start = time.perf_counter()
    for _ in range(count):
        unit.get(output)
    return {"step_us": 1e6 * step, "get_us": 1e6 * (time.perf_counter() - start) / count}


def cell(path, stop, step):
    """Time, wear, speed and edges of a system of units (SSP) by FMPy's own master, which is Jacobi's."""
    import fmpy
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import read_ssd, read_ssv

    read_ssd(path)  # by the schemas of the standard
    folder = fmpy.extract(path)
    values = read_ssv(f"{folder}/resources/parameters.ssv")
    rows = simulate_ssp(path, stop_time=float(stop), step_size=float(step), parameter_set=values)
    names = ["time", "flank_wear", "cutting_speed", "edges"]
    return [[float(row[name]) for name in names] for row in rows]


def cell_in_ecos(path, stop, step):
    """Time, wear and edges of a flat system of units after each step by the master of Ecos."""
    from ecospy.EcosSimulation import EcosSimulation

    stop, step = float(stop), float(step)
    simulation = EcosSimulation(step_size=step, ssp_path=path)
    simulation.init(parameter_set="initialValues")
    rows = []
    for _ in range(round(stop / step)):
        simulation.step(1)
        rows.append([simulation.get_time(), simulation.get_real("lathe::process.flank_wear"), simulation.get_integer("lathe::tool.count")])
    return rows


def cell_in_libcosim(path, stop, step):
    """The same by that of libcosim, the library of the Open Simulation Platform."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    stop, step = float(stop), float(step)
    execution = CosimExecution.from_ssp_file(path, step_size=round(step * 1e9))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    text = lambda name: name.decode() if isinstance(name, bytes) else name
    lathe = {text(info.name): info.index for info in execution.slave_infos()}["lathe"]
    known = {text(each.name): each.reference for each in execution.slave_variables(lathe)}
    rows = []
    for number in range(round(stop / step)):
        execution.step(1)
        wear = observer.last_real_values(slave_index=lathe, variable_references=[known["process.flank_wear"]])
        edges = observer.last_integer_values(slave_index=lathe, variable_references=[known["tool.count"]])
        rows.append([(number + 1) * step, wear[0], edges[0]])
    return rows


def validate(path):
    from fmpy.validation import validate_fmu

    return list(validate_fmu(path))


ACTIONS = {
    "cell": cell,
    "cell_in_ecos": cell_in_ecos,
    "cell_in_libcosim": cell_in_libcosim,
    "validate": validate,
    "cs": lambda path, step: fmpy_run(path, "CoSimulation", float(step)),
    "me": lambda path, speed: fmpy_run(path, "ModelExchange", 1.0, start_values={"process.cutting_speed": float(speed) / 60.0}),
    "inputs": lambda path, inputs: fmpy_run(path, "CoSimulation", 0.1, inputs),
    "events": lambda path, inputs: fmpy_run(path, "CoSimulation", 0.1, inputs, event_mode=True),
    "ecos": ecos,
    "libcosim": libcosim,
    "save": save,
    "restore": restore,
    "cycles": cycles,
    "threads": threads,
    "speed": speed,
}

if __name__ == "__main__":
    print("\n" + json.dumps(ACTIONS[sys.argv[1]](*sys.argv[2:])))
