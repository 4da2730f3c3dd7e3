"""Marker positions from a TRC file: tab-separated text."""

import math
from pathlib import Path

import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.gait.capture import Capture, unit_of


def read_trc(path: Path) -> Capture:
    """Three header lines, one of marker names, one of axes, then frames. Raises UserError."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: not TRC: {error}") from error
    if len(lines) < 6 or not lines[0].startswith("PathFileType"):
        raise UserError(f"{path}: not TRC: the first line must begin with PathFileType")
    header = dict(zip(lines[1].split(), lines[2].split(), strict=False))
    if "Units" not in header:
        raise UserError(f"{path}: not TRC: no Units in line 2")
    names = [name for name in lines[3].rstrip().split("\t")[2:] if name.strip()]
    rows = np.array(
        [_row(path, i, line, len(names)) for i, line in enumerate(lines[5:], 6) if line.strip()]
    ).reshape(-1, 1 + 3 * len(names))
    backwards = np.flatnonzero(~(np.diff(rows[:, 0]) > 0))
    if len(backwards):
        raise UserError(f"{path}: frame {backwards[0] + 2}: the time must be later than before")
    points = rows[:, 1:].reshape(len(rows), len(names), 3)
    points[~points.any(axis=2)] = (
        math.nan
    )  # some programs write zeros for a marker that was not visible
    return Capture(
        time_s=rows[:, 0],
        markers={name: points[:, i] for i, name in enumerate(names)},
        unit=unit_of(path, header["Units"]),
    )


def _row(path: Path, line: int, text: str, markers: int) -> list[float]:
    """Time and coordinates of a frame; an empty cell is a marker that was not visible."""
    cells = text.split("\t")[1:]
    cells += [""] * (1 + 3 * markers - len(cells))
    try:
        row = [float(cell) if cell.strip() else math.nan for cell in cells[: 1 + 3 * markers]]
    except ValueError as error:
        raise UserError(f"{path}: line {line}: {error}") from None
    if not math.isfinite(row[0]):
        raise UserError(f"{path}: line {line}: the time must be a number of seconds")
    return row
