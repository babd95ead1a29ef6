"""toolroom: a machining-shop simulator in Python.

    import toolroom as tr
    s = tr.scenario("shop.toml")
    s["tool.insert.edge_cost"] = "9 EUR"
    c = s.compare(replications=50, progress=True)
    c.kpi.to_pandas()

The results are those of the command line, byte for byte; the same seed gives the same numbers on any number of threads.
Errors are `Error`. `toolroom.shards` runs studies on Dask and Ray.
"""

from ._error import Error
from ._native import __version__
from ._point import Process, infeed, milling, turning
from ._shop import Comparison, Scenario, Sweep, scenario, sweep
from ._studies import (
    Calibration,
    Diagnosis,
    Lives,
    apply,
    calibrate,
    check,
    diagnose,
    export_fmu,
    identify,
    life,
    lobes,
    verdict,
)
from ._study import Pictures, Study
from ._table import Table

__all__ = [
    "Calibration",
    "Comparison",
    "Diagnosis",
    "Error",
    "Lives",
    "Pictures",
    "Process",
    "Scenario",
    "Study",
    "Sweep",
    "Table",
    "__version__",
    "apply",
    "calibrate",
    "check",
    "diagnose",
    "export_fmu",
    "identify",
    "infeed",
    "life",
    "lobes",
    "milling",
    "scenario",
    "sweep",
    "turning",
    "verdict",
]
