"""The error of every call."""

from __future__ import annotations

from typing import Any, Optional, Sequence


class Error(Exception):
    """Why a call did not do its work.

    `code` is a word of ``toolroom explain`` for a fault of a file, ``argument`` for an argument, ``work`` where the
    input is right and the work failed all the same. `file`, `line` and `column` (both from 1) say where the first
    fault is, `help` is the likely fix, and `problems` has every fault of a file with the same keys.
    """

    def __init__(
        self,
        message: str,
        *,
        code: Optional[str] = None,
        file: Optional[str] = None,
        line: Optional[int] = None,
        column: Optional[int] = None,
        help: Optional[str] = None,
        problems: Sequence[dict[str, Any]] = (),
    ) -> None:
        super().__init__(message)
        self.code = code
        self.file = file
        self.line = line
        self.column = column
        self.help = help
        self.problems = list(problems)

    def __str__(self) -> str:
        message = super().__str__()
        return f"{message}\n  help: {self.help}" if self.help else message

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, (self.args[0], self.__dict__))


def _again(message: str, about: dict[str, Any]) -> Error:
    """An error that was pickled."""
    return Error(message, **about)
