"""A calibrated plan is no farther from the walks that it was fitted to than the default, in each
quantity, as far as the model can be."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from saddlewalk.config import configuration
from saddlewalk.gait.fit import Fit, fields_of
from saddlewalk.gait.measures import WalkMeasures
from saddlewalk.gait.tracking_error import deviation

HEEL_STRIKE_DEG = 10.0  # as `follow` compares by default


def no_worse(
    fits: Sequence[Fit],
    candidates: Mapping[str, Sequence[Fit]],
    walks: Sequence[WalkMeasures],
    default: Any,
) -> list[Fit]:
    """Of the candidates for each column of Deviation, beside `fits`, the first that is as near to
    the walks as the default plan; if none is, the nearest."""
    before = errors(default, walks)
    rounds = []
    for turn in range(max(map(len, candidates.values()))):
        taken = [choices[min(turn, len(choices) - 1)] for choices in candidates.values()]
        rounds.append(errors(configuration(fields_of([*fits, *taken])), walks))
        if all(_first(rounds, column, before) is not None for column in candidates):
            break
    chosen = []
    for column, choices in candidates.items():
        first = _first(rounds, column, before)
        left = [found[column] for found in rounds[: len(choices)]]
        chosen.append(choices[int(np.argmin(left)) if first is None else first])
    return chosen


def _first(
    rounds: Sequence[Mapping[str, float]], column: str, before: Mapping[str, float]
) -> int | None:
    """The first round that is no worse; NaN is none of it."""
    return next((i for i, found in enumerate(rounds) if not found[column] > before[column]), None)


def errors(config: Any, walks: Sequence[WalkMeasures]) -> dict[str, float]:
    """RMS over all walks by column of Deviation; NaN where nothing can be compared."""
    found = [deviation(walk, config, HEEL_STRIKE_DEG) for walk in walks]
    return {
        column: _pooled([(getattr(one, column), one.steps) for one in found])
        for column in ("com_y_m", "com_z_m", "swing_x_m", "landing_m", "heel_strike_s")
    }


def _pooled(found: Sequence[tuple[float, int]]) -> float:
    known = np.array([(error, steps) for error, steps in found if not math.isnan(error)])
    return math.sqrt(np.average(known[:, 0] ** 2, weights=known[:, 1])) if len(known) else math.nan
