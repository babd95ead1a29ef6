"""Tables that pandas, polars, pyarrow and duckdb take without copying."""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from html import escape
from pathlib import Path
from typing import Any, Iterator, Optional, Union

from . import _native

#: A path, or a frame of pandas, polars, pyarrow or duckdb.
Data = Union[str, "os.PathLike[str]", object]

_SHOWN = 20


class Table:
    """A table of named columns; a header has its unit in brackets: ``cutting_speed [m/min]``.

    The table crosses by Arrow's PyCapsule interface, so that ``pandas.DataFrame.from_arrow(table)``,
    ``polars.DataFrame(table)``, ``pyarrow.table(table)`` and duckdb take it. ``table["cutting_speed"]`` is a column,
    with or without its unit; ``numpy.asarray(table["cutting_speed"])`` shares its memory.
    """

    def __init__(self, own: _native.Table) -> None:
        self._own = own

    @classmethod
    def read(cls, path: Union[str, "os.PathLike[str]"]) -> "Table":
        """Reads a Parquet file, or a CSV file with a header."""
        return cls(_native.Table.read(os.fspath(path)))

    @classmethod
    def of(cls, data: object) -> "Table":
        """A table from a frame of pandas, polars, pyarrow or duckdb."""
        return data if isinstance(data, cls) else cls(_native.Table.from_arrow(data))

    @property
    def columns(self) -> list[str]:
        """Headers of the columns."""
        return self._own.columns

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column that has one, by header."""
        return self._own.units

    def __len__(self) -> int:
        return len(self._own)

    def __getitem__(self, name: str) -> _native.Column:
        return self._own[name]

    def rows(self) -> Iterator[dict[str, Any]]:
        """The rows, each by header; `None` where a cell is empty."""
        return (self._own.row(index) for index in range(len(self)))

    def to_arrow(self) -> Any:
        """The table for pyarrow."""
        import pyarrow

        return pyarrow.table(self)

    def to_pandas(self) -> Any:
        """The table for pandas."""
        import pandas

        if hasattr(pandas.DataFrame, "from_arrow"):
            return pandas.DataFrame.from_arrow(self)
        return self.to_arrow().to_pandas()

    def to_polars(self) -> Any:
        """The table for polars."""
        import polars

        return polars.DataFrame(self)

    def write(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes a CSV file, or a Parquet file where the name ends so."""
        path = os.fspath(path)
        if path.endswith(".parquet"):
            self._own.write_parquet(path)
        else:
            Path(path).write_bytes(self._own.csv())

    def __arrow_c_schema__(self) -> object:
        return self._own.__arrow_c_schema__()

    def __arrow_c_stream__(self, requested_schema: Optional[object] = None) -> object:
        return self._own.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        shown = [self._own.row(index) for index in range(min(len(self), _SHOWN))]
        lines = ["  ".join(_short(cell) for cell in row.values()) for row in shown]
        more = [f"… {len(self)} rows"] if len(self) > _SHOWN else []
        return "\n".join(["  ".join(self.columns), *lines, *more])

    def _repr_html_(self) -> str:
        shown = [self._own.row(index) for index in range(min(len(self), _SHOWN))]
        head = "".join(f"<th>{escape(name)}</th>" for name in self.columns)
        body = "".join("<tr>" + "".join(f"<td>{escape(_short(cell))}</td>" for cell in row.values()) + "</tr>" for row in shown)
        more = f"<p>{len(self)} rows</p>" if len(self) > _SHOWN else ""
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def _short(cell: object) -> str:
    """A cell for people: four significant digits."""
    if cell is None:
        return ""
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)


@contextmanager
def as_file(data: Data, name: str = "frame") -> Iterator[str]:
    """The path of data: as it was given, or of a CSV file of the frame that is gone afterwards."""
    if isinstance(data, (str, os.PathLike)):
        yield os.fspath(data)
        return
    with tempfile.TemporaryDirectory(prefix="toolroom-") as folder:
        path = os.path.join(folder, f"{name}.csv")
        Table.of(data).write(path)
        yield path
