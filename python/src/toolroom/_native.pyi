"""The compiled part of the package; its classes and functions are used through `toolroom`."""

from typing import Any, Callable, Iterator, Optional, Sequence, TypedDict

__version__: str

_Progress = Optional[Callable[[int, int], object]]

class Made(TypedDict):
    summary: str
    text: str
    notes: list[str]
    files: dict[str, bytes]

class Column:
    name: str
    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> Any: ...
    def __iter__(self) -> Iterator[Any]: ...

class Table:
    columns: list[str]
    units: dict[str, str]
    @staticmethod
    def read(path: str) -> Table: ...
    @staticmethod
    def from_csv(text: bytes) -> Table: ...
    @staticmethod
    def from_arrow(data: object) -> Table: ...
    def __len__(self) -> int: ...
    def __getitem__(self, name: str) -> Column: ...
    def row(self, index: int) -> dict[str, Any]: ...
    def csv(self) -> bytes: ...
    def write_parquet(self, path: str) -> None: ...
    def __arrow_c_schema__(self) -> object: ...
    def __arrow_c_stream__(self, requested_schema: Optional[object] = None) -> object: ...

def point(
    process: str,
    tool: Optional[str],
    axes: Sequence[tuple[str, bytes, str]],
    changes: Sequence[str],
    effects: Sequence[str],
    definitions: Sequence[str],
    advance: Optional[str],
    life_model: str,
) -> Table: ...
def study(options: dict[str, Any], progress: _Progress = None) -> tuple[str, str, bool]: ...
def echo(file: str, set: Sequence[str]) -> tuple[str, int, int, list[str], list[tuple[str, str, Optional[str]]]]: ...
def check(file: str, set: Sequence[str]) -> tuple[str, str]: ...
def life(
    file: str, set: Sequence[str], lives: Optional[int], statistics: dict[str, Any], threads: int, parts: str
) -> Made: ...
def lobes(file: str, set: Sequence[str], threads: int) -> Made: ...
def verdict(file: str, set: Sequence[str], speed: str, depth: str) -> str: ...
def identify(
    data: str, forces: Optional[str], basis: str, error: Sequence[str], resamples: int, seed: int
) -> Made: ...
def calibrate(
    data: str,
    model: str,
    name: str,
    map: Optional[str],
    limit: Optional[str],
    law: Sequence[str],
    fix: Sequence[str],
    draws: int,
    seed: int,
) -> Made: ...
def diagnose(
    models: Sequence[str],
    data: str,
    set: Sequence[str],
    group: Optional[str],
    holdout: float,
    holdout_data: Optional[str],
    seed: int,
    definitions: Sequence[str],
    propose: Optional[str],
) -> tuple[Made, Optional[str]]: ...
def apply(
    model: str, diagnosis: str, set: Sequence[str], only: Sequence[str], calibration: bool, accept_empirical: bool
) -> tuple[str, list[str]]: ...
def export_fmu(
    model: str, versions: Sequence[int], parameters: Sequence[str], library: Optional[str]
) -> list[tuple[str, bytes]]: ...
