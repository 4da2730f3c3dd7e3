"""Recorded steps in the plan's own time: the phase that a steady plan at the recording's speed has
at each of their samples."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.contract import TICK_S
from saddlewalk.core import Core, library, model_of
from saddlewalk.gait.measures import WalkMeasures
from saddlewalk.gait.step_curves import StepCurve
from saddlewalk.planning import steady


@dataclass(frozen=True)
class TimedStep:
    curve: StepCurve
    speed_m_s: float
    length_m: float  # of the planned step
    duration_s: float
    angle_rad: np.ndarray  # (n,) gait phase since the foot was passed
    quarter: Any  # saddle_quarter_t: the plan's width and amplitudes
    pendulum_m: float


def timed_steps(walk: WalkMeasures, config: Any) -> Iterator[TimedStep]:
    """Every step of the walk, by the gait model of a checked `config`."""
    model = model_of(config)
    _, first = next(steady.walk(Core(config), walk.speed_m_s, 0, TICK_S))
    speed_m_s = first.plan.speed_m_s  # limited to what is feasible
    width_m = library().saddle_step_width_m(model, speed_m_s)
    regressed_m = config.half_step_slope_s * speed_m_s + config.half_step_intercept_m
    factors = (config.step_length_factor_left, config.step_length_factor_right)
    for curve in walk.curves:
        half_m = factors[1 - curve.side] * regressed_m
        duration_s = 2 * half_m / speed_m_s
        yield TimedStep(
            curve=curve,
            speed_m_s=speed_m_s,
            length_m=2 * half_m,
            duration_s=duration_s,
            angle_rad=np.pi * curve.elapsed_s / duration_s,
            quarter=library().saddle_quarter(model, curve.side, half_m, width_m, speed_m_s),
            pendulum_m=model.body.pendulum_m,
        )
