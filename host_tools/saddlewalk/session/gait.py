"""The gait of a run as gait laboratories describe it, beside the configuration and published
norms."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.config import configuration
from saddlewalk.contract import SIDES
from saddlewalk.core import field_ranges, library, model_of
from saddlewalk.session.runs import Run
from saddlewalk.session.steps import Steps, Walked, fresh, variability

# Schulz 2012: mean and SD of healthy adults at their preferred speed, lengths in leg lengths. A leg
# is 0.53 of the body height (Drillis and Contini 1966).
LEG = 0.53
STEP_LENGTH = (0.856, 0.100)
STEP_WIDTH = (0.140, 0.031)
STEP_TIME_S = (0.56, 0.05)
LENGTH_SD = (0.039, 0.013)
WIDTH_SD = (0.038, 0.011)  # younger men; younger women 0.037
SYMMETRY_PERCENT = 10  # Patterson 2008
DOUBLE_SUPPORT_PERCENT = 20  # Wollesen 2019

NORMS = """
*Published*: mean ± SD of healthy adults at their preferred speed, about 1.4 m/s, for a leg of 0.53
body heights. Step length, width, time and their SD: Schulz 2012, J NeuroEng Rehabil 9:69. Symmetry:
95 % of 24 healthy adults lie within 10 % (Patterson et al. 2008, Arch Phys Med Rehabil 89:304).
Double support: about 20 % of the gait cycle (Wollesen et al. 2019, Eur Rev Aging Phys Act 16:11);
slower walks have more. They are no limits: speed, age and height move every one of them.
"""


@dataclass(frozen=True)
class Row:
    """One quantity; NaN where it is not known, "" where there is no such value."""

    quantity: str
    unit: str
    measured: float
    configured: float
    published: str
    meaning: str

    @property
    def decimals(self) -> int:
        return 3 if self.unit == "m" else 1


@dataclass(frozen=True)
class Configured:
    """What the run's configuration says at the walked speed."""

    calibrated: bool  # a field of the gait model is not the default
    leg_m: float
    length_m: float
    width_m: float
    symmetry_percent: float


def described(walk: Walked) -> Steps:
    """The steady steps; all where there are none."""
    return walk.steps.where(walk.steps.steady) if walk.steps.steady.any() else walk.steps


def configured(run: Run, speed_m_s: float) -> Configured | None:
    """None if no configuration was logged, or it is none of this version's."""
    message = run.last("config")
    if message is None:
        return None
    known = field_ranges()
    fields = {
        name: value
        for name, value in zip(message.name, message.value, strict=True)
        if name in known and known[name][0] <= value <= known[name][1]
    }
    config = configuration(fields)
    default = configuration({})
    factors = (config.step_length_factor_left, config.step_length_factor_right)
    regressed_m = config.half_step_slope_s * speed_m_s + config.half_step_intercept_m
    return Configured(
        calibrated=any(
            getattr(config, name) != getattr(default, name)
            for name in ("half_step_intercept_m", "step_width_intercept_m", "lateral_factor")
        ),
        leg_m=LEG * config.body_height_m,
        length_m=sum(factors) * regressed_m,
        width_m=library().saddle_step_width_m(model_of(config), speed_m_s),
        symmetry_percent=_symmetry_percent(*factors),
    )


def cadence(steps: Steps) -> float:
    """Steps a minute; NaN if no step's time is known."""
    return _ratio(60, _mean(steps.time_s))


def rows(run: Run, walk: Walked) -> Iterator[Row]:
    steps = described(walk)
    of = configured(run, steps.speed_m_s)
    nothing = np.nan
    leg_m = of.leg_m if of else nothing
    yield Row(
        "step length",
        "m",
        _mean(steps.length_m),
        of.length_m if of else nothing,
        _norm(STEP_LENGTH, leg_m, 2),
        "How far the landing foot is ahead of the other. Steps get longer with speed.",
    )
    yield Row(
        "step width",
        "m",
        _mean(steps.width_m),
        of.width_m if of else nothing,
        _norm(STEP_WIDTH, leg_m, 2),
        "How far apart the feet land across. Wide steps are steadier and cost more.",
    )
    yield Row(
        "cadence",
        "steps/min",
        cadence(steps),
        60 * _ratio(steps.speed_m_s, of.length_m) if of else nothing,
        f"{60 / STEP_TIME_S[0]:.0f} ± {60 / STEP_TIME_S[0] ** 2 * STEP_TIME_S[1]:.0f}",
        "How many steps a minute. Speed is cadence times step length.",
    )
    yield from _symmetry(steps, of)
    yield Row(
        "double support",
        "% of the time",
        double_support_percent(run, steps) if walk.measured else nothing,
        nothing,
        f"about {DOUBLE_SUPPORT_PERCENT}",
        "The share in which both feet carry. People who feel unsafe keep both down for longer.",
    )
    yield from _variability(steps, leg_m)


def _symmetry(steps: Steps, of: Configured | None) -> Iterator[Row]:
    for quantity, values, configured_percent in (
        ("length", steps.length_m, of.symmetry_percent if of else np.nan),
        ("time", steps.time_s, np.nan),
    ):
        left, right = (_mean(values[steps.side == side]) for side in range(len(SIDES)))
        yield Row(
            f"symmetry index, step {quantity}",
            "%",
            _symmetry_percent(left, right),
            configured_percent,
            f"-{SYMMETRY_PERCENT} to {SYMMETRY_PERCENT}",
            "Left less right, of their mean: 0 is even, above 0 the left foot's steps are "
            + ("longer." if quantity == "length" else "slower."),
        )


def _variability(steps: Steps, leg_m: float) -> Iterator[Row]:
    spreads = (
        ("SD of step length", "m", variability(steps.length_m).sd, _norm(LENGTH_SD, leg_m, 3)),
        ("SD of step width", "m", variability(steps.width_m).sd, _norm(WIDTH_SD, leg_m, 3)),
        ("CV of step time", "%", 100 * variability(steps.time_s).cv, ""),
    )
    for quantity, unit, value, published in spreads:
        meaning = "How much it varies from step to step. An even walk is a controlled one."
        yield Row(quantity, unit, value, np.nan, published, meaning)


def double_support_percent(run: Run, steps: Steps) -> float:
    """Share of the ticks of the steps whose time is known in which both feet carry."""
    walked = np.zeros(run.ticks, bool)
    timed = steps.time_s > 0
    ends_s = steps.landed_s[timed]
    starts_s = ends_s - steps.time_s[timed]
    for start, end in np.searchsorted(run.time_s, np.column_stack((starts_s, ends_s))):
        walked[start:end] = True
    down = [run.column("input", f"{side}_contact") > 0 for side in SIDES]
    seen = walked & fresh(run, SIDES[0]) & fresh(run, SIDES[1])
    return 100 * float((down[0] & down[1])[seen].mean()) if seen.any() else np.nan


def _symmetry_percent(left: float, right: float) -> float:
    """Robinson's index, signed."""
    return 200 * _ratio(left - right, left + right)


def _ratio(a: float, b: float) -> float:
    return a / b if b > 0 else np.nan


def _mean(values: Any) -> float:
    return variability(values).mean


def _norm(norm: tuple[float, float], leg_m: float, decimals: int) -> str:
    if np.isnan(leg_m):
        return f"{norm[0]:.3f} ± {norm[1]:.3f} leg lengths"
    mean, sd = (value * leg_m for value in norm)
    return f"{mean:.{decimals}f} ± {sd:.{decimals}f}"
