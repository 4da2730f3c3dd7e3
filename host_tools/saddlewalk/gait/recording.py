"""Recorded walking trials: markers over time in the task frame (x forward, y left, z up; SI)."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.printable import printable
from saddlewalk.table import read_series

LONGEST_S = 86400.0
ABSURD_M = 1e6
AXES = ("x", "y", "z")
POINTS = ("com", "lheel", "ltoe", "rheel", "rtoe")
COLUMNS = ("t", *(f"{point}_{axis}" for point in POINTS for axis in AXES))


@dataclass(frozen=True)
class Recording:
    """One trial of n samples; index 0 of a pair of feet is the left. NaN: not measured."""

    source: str  # description and credit, in one line
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
        """(n, 3) by central differences; NaN where a sample is missing."""
        return np.gradient(self.com_m, self.time_s, axis=0)

    @property
    def duration_s(self) -> float:
        return float(self.time_s[-1] - self.time_s[0])


def load_recording(source: str) -> Recording:
    """Read a trial with the columns t, com_x ... rtoe_z in seconds and metres; "-": standard input.

    A cell that is empty, not finite or absurd is a missing measurement. Raises UserError naming
    file, line, column and value for anything else that is not a trial.
    """
    rows = read_series(source, COLUMNS, LONGEST_S)
    return recording_of(source, (list(cells.values()) for _, cells in rows))


def recording_of(source: str, cells: Iterable[Sequence[float]]) -> Recording:
    """A trial from its rows of COLUMNS."""
    name = "standard input" if source == "-" else source
    rows = list(cells)
    if len(rows) < 2:
        raise UserError(f"{name}: {len(rows)} samples; a trial needs at least 2")
    table = np.array(rows)
    table[:, 1:][~(np.abs(table[:, 1:]) < ABSURD_M)] = np.nan
    markers = {point: table[:, 1 + 3 * i : 4 + 3 * i] for i, point in enumerate(POINTS)}
    return Recording(
        source=printable(Path(name).name),
        time_s=table[:, 0],
        com_m=markers["com"],
        heel_m=np.stack([markers["lheel"], markers["rheel"]]),
        toe_m=np.stack([markers["ltoe"], markers["rtoe"]]),
    )
