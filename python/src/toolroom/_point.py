"""Processes at operating points: turning, milling, plunge grinding."""

from __future__ import annotations

import os
from array import array
from typing import Any, Mapping, Optional, Sequence, Union

from . import _native
from ._study import PathLike
from ._table import Table


class Process:
    """A process with a parameter set, evaluated at operating points."""

    def __init__(
        self, name: str, tool: Optional[str], effects: Mapping[str, object], definitions: Sequence[PathLike] = ()
    ) -> None:
        self.name = name
        self.tool = tool
        self._definitions = [os.fspath(path) for path in definitions]
        self._effects = [f"{effect}={size}" for effect, size in effects.items()]

    def point(
        self,
        values: Optional[Mapping[str, object]] = None,
        *,
        unit: Union[str, Mapping[str, str], None] = None,
        advance: Optional[str] = None,
        life_model: str = "quasi_steady",
        **more: object,
    ) -> Table:
        """Inputs, state and outputs, a row a point.

        A value is a text with its unit (``flank_wear="0.2 mm"``), a number or a sequence of numbers (numpy arrays,
        lists), or a pair of one of these and its unit (``(speeds, "m/min")``). `unit` is that of numbers without
        one; a mapping gives it by name. Sequences are equally long: point i takes the i-th value of each. Names with a
        dot, such as ``limits.wear_limit``, are parameters and go into `values`. `advance` is a time by which the
        process is advanced, `life_model` is ``quasi_steady`` or ``ode``.
        """
        axes: list[tuple[str, bytes, str]] = []
        changes: list[str] = []
        for key, value in {**(values or {}), **more}.items():
            own = unit.get(key, "") if isinstance(unit, Mapping) else unit or ""
            if isinstance(value, tuple) and len(value) == 2 and isinstance(value[1], str):
                value, own = value
            if isinstance(value, str):
                changes.append(f"{key}={value}")
            elif getattr(value, "ndim", None) == 0 or isinstance(value, (int, float)):
                changes.append(f"{key}={float(value)!r} {own}".rstrip())  # type: ignore[arg-type]
            else:
                axes.append((key, _doubles(value), own))
        tool, effects, definitions = self.tool, self._effects, self._definitions
        return Table(_native.point(self.name, tool, axes, changes, effects, definitions, advance, life_model))

    def __repr__(self) -> str:
        return f"{self.name} with {self.tool or 'the set of the demo'}"


def _doubles(values: Any) -> bytes:
    """Numbers as the bytes of 64-bit numbers of this machine."""
    if hasattr(values, "__array__"):
        import numpy

        return bytes(numpy.ascontiguousarray(values, dtype=numpy.float64).tobytes())
    return array("d", values).tobytes()


def _tool(tool: Optional[PathLike]) -> Optional[str]:
    return None if tool is None else os.fspath(tool)


def turning(
    tool: Optional[PathLike] = "ni_vk6om",
    effects: Optional[Mapping[str, object]] = None,
    definitions: Sequence[PathLike] = (),
) -> Process:
    """Turning with a shipped parameter set, or with the file of one.

    `effects` are sizes by id; `definitions` are files in which effects of your own are defined.
    """
    return Process("turning", _tool(tool), effects or {}, definitions)


def milling(
    tool: Optional[PathLike] = None,
    effects: Optional[Mapping[str, object]] = None,
    definitions: Sequence[PathLike] = (),
) -> Process:
    """Milling, as `turning`."""
    return Process("milling", _tool(tool), effects or {}, definitions)


def infeed(
    tool: Optional[PathLike] = None,
    effects: Optional[Mapping[str, object]] = None,
    definitions: Sequence[PathLike] = (),
) -> Process:
    """Plunge grinding, as `turning`."""
    return Process("infeed", _tool(tool), effects or {}, definitions)
