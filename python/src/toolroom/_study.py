"""What studies have in common: a summary, a text, the files of the command line, pictures."""

from __future__ import annotations

import json
import os
import re
from html import escape
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

from . import _native
from ._error import Error
from ._table import Table

PathLike = Union[str, "os.PathLike[str]"]
#: Values that replace those of a file: ``{"tool.insert.edge_cost": "9 EUR"}``.
Changes = Mapping[str, object]


def changes(values: Optional[Changes]) -> list[str]:
    """Changes as ``--set`` takes them."""
    return [f"{key}={_value(value)}" for key, value in (values or {}).items()]


def _value(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(json.dumps(one) if isinstance(one, str) else _value(one) for one in value) + "]"
    return str(value)


class Pictures:
    """Pictures of a report as SVG; a notebook shows them."""

    def __init__(self, page: str) -> None:
        self._style = "".join(re.findall(r"<style>.*?</style>", page, re.S))
        #: The pictures, in the order of the report.
        self.svg: list[str] = re.findall(r"<svg.*?</svg>", page, re.S)

    def __len__(self) -> int:
        return len(self.svg)

    def __repr__(self) -> str:
        return f"{len(self)} pictures"

    def _repr_html_(self) -> str:
        page = f"<!doctype html><meta charset='utf-8'>{self._style}" + "".join(self.svg)
        return _frame(page, 460 * max(1, len(self)))


def _frame(page: str, height: int) -> str:
    """A page within a notebook, whose styles it neither changes nor takes."""
    return f'<iframe srcdoc="{escape(page)}" style="width:100%;height:{height}px;border:0"></iframe>'


class Study:
    """A finished study: `summary` for programs, `text` for people, `files` as the command line writes them."""

    #: The result for programs, as ``--json`` prints it.
    summary: dict[str, Any]
    #: The result for people, as the terminal shows it.
    text: str
    #: What was noted about the data.
    notes: list[str]

    def __init__(self, summary: dict[str, Any], text: str, notes: Sequence[str] = ()) -> None:
        self.summary = summary
        self.text = text.rstrip("\n")
        self.notes = list(notes)

    @property
    def files(self) -> list[str]:
        """Names of the files."""
        raise NotImplementedError

    def read(self, name: str) -> bytes:
        """A file of the result."""
        raise NotImplementedError

    def table(self, name: str) -> Table:
        """A table of the result by the name of its file, with or without ending."""
        found = [own for own in self.files if own == name or Path(own).stem == name and own.endswith((".csv", ".parquet"))]
        if not found:
            raise KeyError(f"{name}; the files are {', '.join(self.files)}")
        return self._table(found[0])

    def _table(self, name: str) -> Table:
        return Table(_native.Table.from_csv(self.read(name)))

    def _page(self) -> str:
        name = next(own for own in self.files if own.endswith("report.html"))
        return self.read(name).decode()

    def report(self, path: PathLike, *, overwrite: bool = False) -> Path:
        """Writes the report, one HTML file, and returns its path."""
        return _put(Path(path), self._page().encode(), overwrite)

    def write(self, folder: PathLike, *, overwrite: bool = False) -> Path:
        """Writes every file into a folder, and returns it; files that are there are replaced only if told."""
        folder = Path(folder)
        taken = [name for name in self.files if (folder / name).exists()]
        if taken and not overwrite:
            raise Error(f"{folder / taken[0]} is there already", code="argument", help="give overwrite=True, or another folder")
        for name in self.files:
            _put(folder / name, self.read(name), True)
        return folder

    def plot(self) -> Pictures:
        """The pictures of the report."""
        return Pictures(self._page())

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return _frame(self._page(), 900)


def _free(path: Path, overwrite: bool) -> Path:
    """A place that nobody has taken."""
    if path.exists() and not overwrite:
        raise Error(f"{path} is there already", code="argument", help="give overwrite=True, or another place")
    return path


def _put(path: Path, contents: bytes, overwrite: bool) -> Path:
    _free(path, overwrite)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(contents)
    return path


class Kept(Study):
    """A study whose files are held in memory."""

    def __init__(self, made: _native.Made) -> None:
        super().__init__(json.loads(made["summary"]), made["text"], made["notes"])
        self._files = made["files"]

    @property
    def files(self) -> list[str]:
        """Names of the files."""
        return list(self._files)

    def read(self, name: str) -> bytes:
        """A file of the result."""
        return self._files[name]

    def _table(self, name: str) -> Table:
        if name.endswith(".parquet"):
            import tempfile

            with tempfile.TemporaryDirectory(prefix="toolroom-") as folder:
                path = _put(Path(folder) / "table.parquet", self.read(name), True)
                return Table.read(path)
        return super()._table(name)
