"""Recorded walking trials: markers over time in the task frame (x forward, y left, z up; SI)."""

import csv
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from saddlewalk.errors import UserError

SIDES = ("left", "right")
AXES = ("x", "y", "z")
POINTS = ("com", "lheel", "ltoe", "rheel", "rtoe")
COLUMNS = ("t", *(f"{point}_{axis}" for point in POINTS for axis in AXES))


@dataclass(frozen=True)
class Recording:
    """One trial of n samples; index 0 of a pair of feet is the left. NaN: not measured."""

    source: str  # what it is and whom to credit, one line
    time_s: np.ndarray  # (n,), finite and increasing
    com_m: np.ndarray  # (n, 3)
    heel_m: np.ndarray  # (2, n, 3)
    toe_m: np.ndarray  # (2, n, 3)

    @cached_property
    def cop_m(self) -> np.ndarray:
        """(2, n, 2): the CoP of each foot, taken midway between heel and toe."""
        return (self.heel_m[..., :2] + self.toe_m[..., :2]) / 2

    @cached_property
    def com_velocity_m_s(self) -> np.ndarray:
        """(n, 3) by central differences; NaN where a sample that it needs is missing."""
        return np.gradient(self.com_m, self.time_s, axis=0)

    @property
    def duration_s(self) -> float:
        return float(self.time_s[-1] - self.time_s[0])


def load_recording(path: Path) -> Recording:
    """Read a trial with the columns t, com_x ... rtoe_z in seconds and metres; others are ignored.

    An empty or non-finite cell is a missing measurement. Raises UserError naming file, line,
    column and value for anything else that is not a trial.
    """
    table = _read_table(path)
    time_s = table[:, 0]
    markers = {p: table[:, 1 + 3 * i : 4 + 3 * i] for i, p in enumerate(POINTS)}
    return Recording(
        source=path.name,
        time_s=time_s,
        com_m=markers["com"],
        heel_m=np.stack([markers["lheel"], markers["rheel"]]),
        toe_m=np.stack([markers["ltoe"], markers["rtoe"]]),
    )


def _read_table(path: Path) -> np.ndarray:
    """One row a sample, columns in the order of COLUMNS."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            header = [name.strip() for name in next(reader, [])]
            places = _column_places(path, header)
            rows = []
            for cells in reader:
                if len(cells) != len(header):
                    raise UserError(
                        f"{path}: line {reader.line_num} has {len(cells)} cells, "
                        f"the header has {len(header)}"
                    )
                where = f"{path}: line {reader.line_num}"
                rows.append([_number(where, name, cells[at]) for name, at in places])
                _check_time(where, rows)
    except OSError as error:
        raise UserError(f"{path}: {error.strerror or error}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise UserError(f"{path}: not a CSV text file ({error})") from error
    if len(rows) < 2:
        raise UserError(f"{path}: {len(rows)} samples, a trial needs at least 2")
    return np.array(rows)


def _column_places(path: Path, header: list[str]) -> list[tuple[str, int]]:
    for name in COLUMNS:
        if header.count(name) != 1:
            fault = "is missing" if name not in header else "appears more than once"
            raise UserError(f"{path}: line 1: column {name} {fault}; needed: {', '.join(COLUMNS)}")
    return [(name, header.index(name)) for name in COLUMNS]


def _number(where: str, column: str, cell: str) -> float:
    if not cell.strip():
        return math.nan
    try:
        value = float(cell)
    except ValueError:
        raise UserError(
            f"{where}, column {column}: {cell!r} is not a number; leave a missing one empty"
        ) from None
    return value if math.isfinite(value) else math.nan


def _check_time(where: str, rows: list[list[float]]) -> None:
    now = rows[-1][0]
    if math.isnan(now):
        raise UserError(f"{where}, column t: every sample needs a finite time in seconds")
    if len(rows) > 1 and now <= rows[-2][0]:
        raise UserError(f"{where}, column t: {now:g} s does not come after {rows[-2][0]:g} s")
