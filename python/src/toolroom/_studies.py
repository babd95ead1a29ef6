"""Tool lives, stability, grinding trials, calibration, diagnosis, exported units."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

from . import _native
from ._shop import Scenario
from ._study import Changes, Kept, PathLike, _free, _put, changes
from ._table import Data, Table, as_file


class Lives(Kept):
    """A Monte Carlo study of tool lives."""

    @property
    def cells(self) -> Table:
        """A row a condition and policy: lives, their spread, laws, replacement."""
        return self.table("cells")


def life(
    study: PathLike,
    set: Optional[Changes] = None,
    *,
    lives: Optional[int] = None,
    seed: Optional[int] = None,
    confidence: float = 0.9,
    bootstrap: int = 500,
    goodness: int = 199,
    costs: Optional[tuple[float, float]] = None,
    threads: int = 0,
) -> Lives:
    """Simulates tool lives, as ``toolroom life FILE``.

    `lives` is the number of edges of each condition and policy, `costs` those of a planned replacement and of a
    failure in any money. After Ctrl-C the work goes on unseen to its end; its result is dropped.
    """
    statistics = {"confidence": confidence, "bootstrap": bootstrap, "goodness": goodness, "costs": costs, "seed": seed}
    with tempfile.TemporaryDirectory(prefix="toolroom-", ignore_cleanup_errors=True) as parts:
        return Lives(_native.life(os.fspath(study), changes(set), lives, statistics, threads, parts))


def lobes(file: PathLike, set: Optional[Changes] = None, *, threads: int = 0) -> Kept:
    """A stability chart, as ``toolroom lobes FILE``."""
    return Kept(_native.lobes(os.fspath(file), changes(set), threads))


def verdict(file: PathLike, speed: str, depth: str, set: Optional[Changes] = None) -> dict[str, Any]:
    """The stability at one speed and depth, such as ``"5000 rpm"`` and ``"0.5 mm"``."""
    answer: dict[str, Any] = json.loads(_native.verdict(os.fspath(file), changes(set), speed, depth))
    return answer


def identify(
    data: Data,
    forces: Optional[Data] = None,
    *,
    basis: str = "both",
    errors: Optional[Mapping[str, str]] = None,
    resamples: int = 10_000,
    seed: int = 1,
) -> Kept:
    """Lag and stiffnesses of plunge grinding from trials, as ``toolroom identify DATA``."""
    with as_file(data, "trials") as trials:
        if forces is None:
            return Kept(_native.identify(trials, None, basis, changes(errors), resamples, seed))
        with as_file(forces, "forces") as traces:
            return Kept(_native.identify(trials, traces, basis, changes(errors), resamples, seed))


class Calibration(Kept):
    """A parameter set with uncertainty from measured edges."""

    def __init__(self, made: _native.Made, name: str) -> None:
        super().__init__(made)
        #: Name of the set.
        self.name = name

    @property
    def law(self) -> str:
        """The wear law that the set carries."""
        return str(self.summary["law"])

    @property
    def intervals(self) -> dict[str, dict[str, Any]]:
        """Parameters of the law by name: value, 90 % interval, unit, how much of the prior is left."""
        parameters = self.summary["parameters"]
        if isinstance(parameters, dict):
            return parameters
        return {own["name"]: own for own in parameters}

    @property
    def posterior(self) -> Table:
        """Draws of the parameters."""
        return self.table(f"{self.name}-posterior")

    @property
    def set_file(self) -> str:
        """The parameter set as the text of its file."""
        return self.read(f"{self.name}.toml").decode()

    def save(self, path: PathLike, *, overwrite: bool = False) -> Path:
        """Writes the parameter set; scenarios and `turning` take its path."""
        return _put(Path(path), self.read(f"{self.name}.toml"), overwrite)


def calibrate(
    model: PathLike,
    data: Data,
    *,
    name: str = "my",
    map: Optional[PathLike] = None,
    limit: Optional[str] = None,
    laws: Sequence[str] = (),
    fix: Optional[Mapping[str, object]] = None,
    draws: int = 2000,
    seed: int = 1,
) -> Calibration:
    """A parameter set from wear readings or tool lives, as ``toolroom calibrate turning --data``.

    `model` is the set from which everything comes that the data do not say, `limit` the flank wear of a worn edge
    (``"0.3 mm"``). After Ctrl-C the work goes on unseen to its end; its result is dropped.
    """
    mapping = None if map is None else os.fspath(map)
    with as_file(data) as path:
        made = _native.calibrate(
            path, os.fspath(model), name, mapping, limit, list(laws), changes(fix), draws, seed
        )
    return Calibration(made, name)


class Diagnosis(Kept):
    """Why a nominal model and records differ."""

    def __init__(
        self, made: _native.Made, models: list[str], set: list[str], proposed: Optional[str] = None
    ) -> None:
        super().__init__(made)
        self._models, self._set = models, set
        self.proposed = proposed
        """The text of the file of terms that describe the gap and are no cause; none where none was sought or found."""

    @property
    def verdict(self) -> str:
        """``effect``, ``constant``, ``unknown``, ``masked``, ``small``, ``no_gap`` or ``cannot_tell``."""
        return str(self.summary["verdict"])

    @property
    def effects(self) -> list[dict[str, Any]]:
        """The named effects: id, size, 90 % interval, what the data cannot tell from it."""
        found: list[dict[str, Any]] = self.summary["effects"]
        return found

    @property
    def predictions(self) -> Table:
        """What the nominal and the applied model predict of each row."""
        return self.table("predictions")

    def apply_text(
        self,
        model: Union[Scenario, PathLike, None] = None,
        *,
        only: Sequence[str] = (),
        calibration: bool = True,
        accept_empirical: bool = False,
    ) -> str:
        """The text of the model with what was found, as ``toolroom gap apply``.

        Effects of the kind ``empirical`` are written only where they are accepted.
        """
        path, own = self._model(model)
        text, notes = _native.apply(path, json.dumps(self.summary), own, list(only), calibration, accept_empirical)
        self.notes.extend(note for note in notes if note not in self.notes)
        return text

    def apply(
        self,
        model: Union[Scenario, PathLike, None] = None,
        path: Optional[PathLike] = None,
        *,
        only: Sequence[str] = (),
        calibration: bool = True,
        accept_empirical: bool = False,
        overwrite: bool = False,
    ) -> Scenario:
        """The scenario with what was found, in a file `path`.

        Without a path it is a file of its own beside the model, ``MODEL-applied.toml``. A model is the one that was
        diagnosed, with the same changes: another is refused (``apply-model``), since sizes are told relative to it.
        """
        origin = Path(self._model(model)[0])
        target = origin.with_name(f"{origin.stem}-applied.toml") if path is None else Path(path)
        text = self.apply_text(model, only=only, calibration=calibration, accept_empirical=accept_empirical)
        return Scenario(_put(target, text.encode(), overwrite))

    def _model(self, model: Union[Scenario, PathLike, None]) -> tuple[str, list[str]]:
        if isinstance(model, Scenario):
            return model.path, changes(model.changes)
        return (self._models[0] if model is None else os.fspath(model)), self._set


def diagnose(
    models: Union[PathLike, Sequence[PathLike]],
    data: Data,
    set: Optional[Changes] = None,
    *,
    group: Optional[str] = None,
    holdout: float = 0.0,
    holdout_data: Optional[PathLike] = None,
    seed: int = 1,
    definitions: Sequence[PathLike] = (),
    propose: Optional[PathLike] = None,
    overwrite: bool = False,
) -> Diagnosis:
    """Which effect a nominal model leaves out, or that it cannot be told, as ``toolroom gap diagnose``.

    `data` is a table or the folder of the tables of several models. `verdict` is ``cannot_tell`` where too little was
    measured. `definitions` are files in which effects of your own are defined. Where no cause is known, terms that describe
    the gap are sought for the file `propose`; it is written only where some are found (`Diagnosis.proposed`). After Ctrl-C
    the work goes on unseen to its end; its result is dropped.
    """
    target = None if propose is None else _free(Path(propose), overwrite)
    one = isinstance(models, (str, os.PathLike))
    files = [os.fspath(models)] if one else [os.fspath(model) for model in models]  # type: ignore[arg-type, union-attr]
    beside = None if holdout_data is None else os.fspath(holdout_data)
    with as_file(data) as path:
        own, terms = [os.fspath(file) for file in definitions], None if target is None else str(target)
        made, proposed = _native.diagnose(files, path, changes(set), group, holdout, beside, seed, own, terms)
    if target is not None and proposed is not None:
        _put(target, proposed.encode(), overwrite)
    return Diagnosis(made, files, changes(set), proposed)


def apply(
    diagnosis: Union[Diagnosis, PathLike],
    model: Union[Scenario, PathLike],
    *,
    only: Sequence[str] = (),
    calibration: bool = True,
    accept_empirical: bool = False,
) -> str:
    """The text of a model with what a diagnosis, or a file ``diagnosis.json``, has found."""
    if isinstance(diagnosis, Diagnosis):
        return diagnosis.apply_text(model, only=only, calibration=calibration, accept_empirical=accept_empirical)
    own = changes(model.changes) if isinstance(model, Scenario) else []
    path = model.path if isinstance(model, Scenario) else os.fspath(model)
    found = Path(diagnosis).read_text(encoding="utf-8")
    return _native.apply(path, found, own, list(only), calibration, accept_empirical)[0]


def export_fmu(
    model: str,
    folder: PathLike = "out/fmu",
    *,
    fmi: Sequence[int] = (2, 3),
    parameters: Sequence[PathLike] = (),
    library: Optional[PathLike] = None,
    overwrite: bool = False,
) -> list[Path]:
    """Packages ``turning``, ``milling``, ``infeed`` or ``controller`` as FMI units for this machine; returns their paths.

    `parameters` are files of sets that are packed beside the shipped ones, `library` is the compiled library of
    units where the package was built without its own.
    """
    sets = [os.fspath(path) for path in parameters]
    made = _native.export_fmu(model, list(fmi), sets, None if library is None else os.fspath(library))
    return [_put(Path(folder) / name, contents, overwrite) for name, contents in made]


def check(file: PathLike, set: Optional[Changes] = None) -> str:
    """Reads a file of any kind and says what it is; raises `Error` with every fault."""
    kind, summary = _native.check(os.fspath(file), changes(set))
    return f"{kind}: {summary}"
