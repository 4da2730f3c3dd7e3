"""Marker positions as in a laboratory's file, before the markers are identified."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from saddlewalk.errors import UserError

METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
UNIT_WORDS = {
    "met": "m",
    "cent": "cm",
    "mil": "mm",
}  # prefixes: a C3D file may cut the text to four characters


@dataclass(frozen=True)
class Capture:
    """Markers in the laboratory's axes and unit; NaN: not visible."""

    time_s: np.ndarray  # (n,)
    markers: dict[str, np.ndarray]  # name -> (n, 3)
    unit: str  # of METRES; empty: not in the file


def unit_of(path: Path, text: str) -> str:
    """A key of METRES. Raises UserError for another text."""
    plain = text.strip().strip("\0").lower()
    if plain in METRES:
        return plain
    for beginning, unit in UNIT_WORDS.items():
        if plain.startswith(beginning):
            return unit
    raise UserError(f"{path}: unit {text!r} must be one of {', '.join(METRES)}")
