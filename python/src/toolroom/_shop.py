"""Scenarios of shops: compared, run, swept."""

from __future__ import annotations

import itertools
import json
import numbers
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, Sequence, Union

from . import _native
from ._error import Error
from ._study import Changes, PathLike, Study, changes
from ._table import Table

#: `True` for a bar on standard error, or a function of the runs done and all runs.
Progress = Union[bool, Callable[[int, int], object], None]


class Comparison(Study):
    """Policies on common random numbers: key figures with 95 % intervals, tables, report."""

    def __init__(self, folder: "tempfile.TemporaryDirectory[str]", summary: str, text: str, complete: bool) -> None:
        super().__init__(json.loads(summary), text)
        self._folder = folder
        #: Whether every replication was run.
        self.complete = complete

    @property
    def files(self) -> list[str]:
        """Names of the files, those of ``toolroom compare``."""
        return sorted(path.name for path in Path(self._folder.name).iterdir() if path.is_file())

    def read(self, name: str) -> bytes:
        """A file of the result."""
        return (Path(self._folder.name) / name).read_bytes()

    def _table(self, name: str) -> Table:
        return Table.read(Path(self._folder.name) / name)

    @property
    def kpi(self) -> Table:
        """Every key figure of every policy and replication."""
        return self.table("kpi")

    @property
    def operations(self) -> Table:
        """Operations of the logged replications."""
        return self.table("operations")

    @property
    def tools(self) -> Table:
        """Edges of the logged replications."""
        return self.table("tools")

    @property
    def jobs(self) -> Table:
        """Jobs of the logged replications."""
        return self.table("jobs")

    @property
    def states(self) -> Table:
        """States of the machines in the logged replications."""
        return self.table("states")

    @property
    def events(self) -> Table:
        """Events of the logged replications."""
        return self.table("events")

    @property
    def policies(self) -> dict[str, dict[str, Any]]:
        """Key figures of each policy: mean and `ci95`."""
        return {policy["name"]: policy["kpi"] for policy in self.summary["policies"]}


def _is_number(value: object) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def _like(written: str, value: object) -> object:
    """A bare number with the unit of the text `written`; as it is where that has none, or is no number."""
    number, _, unit = written.partition(" ")
    try:
        float(number)
    except ValueError:
        return value
    return f"{value} {unit}" if unit else value


class Scenario:
    """A scenario file with changes: ``s["tool.insert.edge_cost"] = "9 EUR"``.

    Reading an item gives the changed value, or the value of the file as it was understood, as text with its unit. A bare
    number stands in the unit that the file writes there: ``s["tool.insert.edge_cost"] = 9`` is ``"9 EUR"`` where it
    counts in EUR. Of a value that the file leaves out the unit has to be said.
    """

    def __init__(self, path: PathLike, set: Optional[Changes] = None) -> None:
        self.path = os.fspath(path)
        #: Values that replace those of the file.
        self.changes: dict[str, object] = self._with_units(dict(set or {}))
        self.name, self.seed, self.replications, self.policies, _ = self._echo()

    def _echo(self) -> tuple[str, int, int, list[str], list[tuple[str, str, Optional[str]]]]:
        return _native.echo(self.path, changes(self.changes))

    def _with_units(self, set: dict[str, object]) -> dict[str, object]:
        """The changes, each bare number with the unit that the file gives the value that it replaces."""
        if not any(_is_number(value) for value in set.values()):
            return set
        written = {key: text for key, _, text in _native.echo(self.path, [])[4] if text is not None}
        return {key: _like(written.get(key, ""), value) if _is_number(value) else value for key, value in set.items()}

    @property
    def values(self) -> dict[str, str]:
        """Every value of the scenario as it is understood, defaults included."""
        return {key: value for key, value, _ in self._echo()[4]}

    def __getitem__(self, key: str) -> object:
        return self.changes[key] if key in self.changes else self.values[key]

    def __setitem__(self, key: str, value: object) -> None:
        changed = Scenario(self.path, {**self.changes, key: value})
        self.changes = changed.changes
        self.name, self.seed = changed.name, changed.seed
        self.replications, self.policies = changed.replications, changed.policies

    def changed(self, set: Changes) -> "Scenario":
        """A copy with more changes."""
        return Scenario(self.path, {**self.changes, **set})

    def compare(
        self,
        replications: Optional[int] = None,
        *,
        policies: Sequence[str] = (),
        until: Optional[str] = None,
        tune: bool = False,
        seed: Optional[int] = None,
        threads: int = 0,
        logged: Optional[int] = None,
        csv: bool = False,
        progress: Progress = None,
    ) -> Comparison:
        """Compares policies on common random numbers, as ``toolroom compare``.

        `until` stops when the key figures are known well enough (``"half-width 2%"``; of one figure
        ``"cost_per_part half-width 2%"``), `tune` first finds the best settings of every policy, `logged` is the number of
        replications with full tables, `threads` 0 stands for one a processor; the result does not depend on it. Ctrl-C
        ends the study.
        """
        return self._study("compare", replications, policies, until, tune, seed, threads, logged, csv, progress)

    def run(
        self,
        replications: Optional[int] = None,
        *,
        policies: Sequence[str] = (),
        seed: Optional[int] = None,
        threads: int = 0,
        logged: Optional[int] = None,
        csv: bool = False,
        progress: Progress = None,
    ) -> Comparison:
        """Runs policies with the full tables of every replication, as ``toolroom run``."""
        return self._study("run", replications, policies, None, False, seed, threads, logged, csv, progress)

    def _study(
        self,
        verb: str,
        replications: Optional[int],
        policies: Sequence[str],
        until: Optional[str],
        tune: bool,
        seed: Optional[int],
        threads: int,
        logged: Optional[int],
        csv: bool,
        progress: Progress,
    ) -> Comparison:
        own = changes(self.changes)
        own += [] if seed is None else [f"shop.seed={seed}"]
        own += [] if replications is None else [f"shop.replications={replications}"]
        folder = tempfile.TemporaryDirectory(prefix="toolroom-")
        options = {
            "verb": verb,
            "file": self.path,
            "set": own,
            "policy": list(policies),
            "until": until,
            "tune": tune,
            "logged": logged,
            "threads": threads,
            "csv": csv,
            "out": folder.name,
        }
        reporter = _Bar() if progress is True else progress or None
        try:
            summary, text, complete = _native.study(options, reporter)
        except BaseException:
            folder.cleanup()
            raise
        finally:
            if isinstance(reporter, _Bar):
                reporter.end()
        return Comparison(folder, summary, text, complete)

    def __repr__(self) -> str:
        changed = "".join(f", {key} = {value}" for key, value in self.changes.items())
        return f"scenario {self.name!r} of {self.path}{changed}: {', '.join(self.policies)}"


class _Bar:
    """A bar on standard error with the time that is left."""

    def __init__(self) -> None:
        self._start = time.monotonic()

    def __call__(self, done: int, total: int) -> None:
        if done and total:
            left = (time.monotonic() - self._start) * (total - done) / done
            print(f"\r{done}/{total} runs, {left:.0f} s left   ", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        print(file=sys.stderr)


def scenario(path: PathLike, set: Optional[Changes] = None) -> Scenario:
    """Reads a scenario: a path, or ``builtin:NAME`` of a shipped one."""
    return Scenario(path, set)


class Sweep:
    """Comparisons over values of keys; `table` has a row a policy and combination."""

    def __init__(self, keys: list[str], table: Table, comparisons: list[Comparison]) -> None:
        self.keys = keys
        #: Values of the keys, policy, and mean and 95 % interval of every key figure.
        self.table = table
        #: The comparisons, in the order of the combinations.
        self.comparisons = comparisons

    def plot(self, kpi: str = "cost_per_part") -> Any:
        """A figure of matplotlib: a key figure with its 95 % intervals over the first key.

        Every policy has a line, for each combination of the further keys. Needs matplotlib; `Error` without it, and for a key
        figure that the table does not have.
        """
        lines: dict[str, list[dict[str, Any]]] = {}
        for row in self.table.rows():
            if kpi not in row:
                known = ", ".join(name for name in row if f"{name} low" in row)
                raise Error(f"there is no key figure `{kpi}`", code="argument", help=f"one of {known}")
            further = [f"{key} = {row[key]}" for key in self.keys[1:]]
            lines.setdefault(", ".join([row["policy"], *further]), []).append(row)
        try:
            from matplotlib import pyplot
        except ImportError as missing:
            message = "pictures of a sweep need matplotlib"
            raise Error(message, code="work", help="pip install matplotlib") from missing
        figure, axes = pyplot.subplots()
        for name, rows in lines.items():
            low, middle, high = (
                [float("nan") if row[column] is None else row[column] for row in rows]
                for column in (f"{kpi} low", kpi, f"{kpi} high")
            )
            error = [[m - l for m, l in zip(middle, low)], [h - m for h, m in zip(high, middle)]]
            axes.errorbar([row[self.keys[0]] for row in rows], middle, yerr=error, label=name, marker="o", capsize=3)
        axes.set_xlabel(self.keys[0])
        axes.set_ylabel(kpi)
        axes.legend()
        # A notebook shows what a cell returns; an open figure would be shown a second time.
        pyplot.close(figure)
        return figure

    def __repr__(self) -> str:
        return repr(self.table)

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def sweep(
    scenario: Union[Scenario, PathLike], keys: Mapping[str, Sequence[object]], **options: Any
) -> Sweep:
    """Compares at every combination of values: ``{"tool.insert.edge_cost": [4, 6, 9]}``.

    A bare number stands in the unit that the file writes there; texts such as ``"4 EUR"`` bring their own. `options` are those of `Scenario.compare`. All comparisons share their random numbers.
    """
    base = scenario if isinstance(scenario, Scenario) else Scenario(scenario)
    rows: list[dict[str, object]] = []
    comparisons = []
    for values in itertools.product(*keys.values()):
        chosen = dict(zip(keys, values))
        done = base.changed(chosen).compare(**{"logged": 0, **options})
        comparisons.append(done)
        for policy, figures in done.policies.items():
            row: dict[str, object] = {**chosen, "policy": policy}
            for kpi, figure in figures.items():
                low, high = figure.get("ci95") or (None, None)
                row.update({kpi: figure["mean"], f"{kpi} low": low, f"{kpi} high": high})
            rows.append(row)
    return Sweep(list(keys), _table_of(rows), comparisons)


def _table_of(rows: list[dict[str, object]]) -> Table:
    import csv
    import io

    heads = list(dict.fromkeys(itertools.chain.from_iterable(rows)))
    text = io.StringIO()
    writer = csv.DictWriter(text, heads)
    writer.writeheader()
    writer.writerows(rows)
    return Table(_native.Table.from_csv(text.getvalue().encode()))
