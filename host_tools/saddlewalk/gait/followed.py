"""Tracking errors of several recordings, before and after calibration, in the units people read."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.gait.measures import WalkMeasures
from saddlewalk.gait.tracking_error import Deviation, deviation

# Name in JSON -> field of Deviation, and what a device that leads a person should keep within.
QUANTITIES = {
    "y_mm": "com_y_m",
    "z_mm": "com_z_m",
    "shape_mm": "com_z_shape_m",
    "swing_mm": "swing_x_m",
    "landing_mm": "landing_m",
    "strike_ms": "heel_strike_s",
}
GOALS = {"y_mm": 5.0, "z_mm": 5.0, "swing_mm": 30.0, "strike_ms": 20.0}

Numbers = Mapping[str, float]  # by QUANTITIES; NaN where nothing can be compared


@dataclass(frozen=True)
class Followed:
    """One recording beside the plans of several configurations, by name, the default first."""

    source: str
    speed_m_s: float
    steps: int
    deviations: Mapping[str, Deviation]

    def numbers(self, configuration: str) -> Numbers:
        found = self.deviations[configuration]
        return {name: 1e3 * getattr(found, column) for name, column in QUANTITIES.items()}


def follow(
    walks: Sequence[WalkMeasures],
    configurations: Mapping[str, Callable[[int], Any]],
    hs_angle_deg: float,
) -> list[Followed]:
    """Each configuration is made for the walk with that index."""
    followed = []
    for index, walk in enumerate(walks):
        found = {
            name: deviation(walk, make(index), hs_angle_deg)
            for name, make in configurations.items()
        }
        followed.append(Followed(walk.source, walk.speed_m_s, len(walk.curves), found))
    return followed


def medians(followed: Sequence[Followed], configuration: str) -> Numbers:
    known = _known(followed, configuration)
    return {name: float(np.median(v)) if len(v) else math.nan for name, v in known.items()}


def within(followed: Sequence[Followed], configuration: str) -> Numbers:
    """Share of the recordings within each goal."""
    known = _known(followed, configuration)
    return {
        name: float(np.mean(known[name] <= goal)) if len(known[name]) else math.nan
        for name, goal in GOALS.items()
    }


def _known(followed: Sequence[Followed], configuration: str) -> dict[str, np.ndarray]:
    rows = [one.numbers(configuration) for one in followed]
    columns = {name: np.array([row[name] for row in rows]) for name in QUANTITIES}
    return {name: values[np.isfinite(values)] for name, values in columns.items()}


def summary(followed: Sequence[Followed]) -> dict[str, Any]:
    """As JSON: `before` is the default, `after` the last configuration; each under its name too."""
    names = list(followed[0].deviations)
    return {
        "recordings": [
            {
                "recording": one.source,
                "speed_m_s": one.speed_m_s,
                "steps": one.steps,
                **_by_name(names, {name: one.numbers(name) for name in names}),
            }
            for one in followed
        ],
        "goals": GOALS,
        "medians": _by_name(names, {name: medians(followed, name) for name in names}),
        "within": _by_name(names, {name: within(followed, name) for name in names}),
    }


def _by_name(names: Sequence[str], numbers: Mapping[str, Numbers]) -> dict[str, Any]:
    """JSON has no NaN: null."""
    plain = {
        name.replace(" ", "_"): {
            quantity: None if math.isnan(value) else round(value, 3)
            for quantity, value in numbers[name].items()
        }
        for name in names
    }
    return {"before": plain[names[0].replace(" ", "_")], "after": list(plain.values())[-1], **plain}
