"""Tracking error between the planner's steady walk and a recorded one.

The plan starts as the core does, at the foot via point: at every instant at which the recorded CoM
passes a foot that lies flat, the plan of the recording's mean speed is laid there, over that foot
and the line midway between the feet, and compared until the CoM passes the next foot.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from saddlewalk.core import Core, library
from saddlewalk.gait.events import FootEvents, foot_events, mean_speed, passing, placements
from saddlewalk.gait.measures import LONGEST_STEP_S
from saddlewalk.gait.recording import Recording
from saddlewalk.planning.steady import walk

PLAN_STEP_S = 0.005


@dataclass(frozen=True)
class Deviation:
    """RMS of recorded minus planned over all steps; NaN where nothing can be compared."""

    steps: int
    com_y_m: float
    com_z_m: float
    com_z_shape_m: float  # without the mean difference in height
    swing_x_m: float  # of the swing foot from the stance foot, over the swing
    landing_m: float  # where it then lies
    heel_strike_s: float
    limited: bool  # the speed is not feasible for this configuration, and the plan is slower


@dataclass(frozen=True)
class _Step:
    """The recorded walk between passing one foot and the next."""

    side: int  # that is passed first
    elapsed_s: np.ndarray  # (n,)
    com_y_m: np.ndarray  # from the line midway between the feet
    com_z_m: np.ndarray
    foot_x_m: np.ndarray  # (2, n) from the foot that is passed
    landing_m: float  # the next foot from the one that is passed
    heel_strike_s: float  # NaN: not seen


class SteadyPlan:
    """Some strides of the core at one speed, from a left foot via point."""

    def __init__(self, config: Any, speed_m_s: float, hs_angle_deg: float) -> None:
        outputs = walk(Core(config), speed_m_s, hs_angle_deg, PLAN_STEP_S)
        time_s, first = next(outputs)
        self.limited = bool(first.limits & library().SADDLE_LIMIT_SPEED)
        points = [_point(time_s, first.plan)]
        stride_s = 2 * first.plan.step_length_m / first.plan.speed_m_s
        while points[-1][0] < stride_s + LONGEST_STEP_S:
            time_s, output = next(outputs)
            points.append(_point(time_s, output.plan))
        columns = np.array(points).T
        self._time_s, theta_rad, self._strike_s, self._support = columns[:4]
        self._com_m, self._foot_x_m = columns[4:7], columns[7:9]
        self._via_s = np.interp([0, math.pi, 2 * math.pi], theta_rad, self._time_s)

    def heel_strike_s(self, side: int) -> float:
        """From passing the foot `side` to the heel strike of the other."""
        index = np.searchsorted(self._time_s, self._via_s[side])
        return float(self._strike_s[index] - self._via_s[side])

    def differences(self, step: _Step) -> dict[str, np.ndarray]:
        """Recorded minus planned at the step's samples."""
        at_s = self._via_s[step.side] + step.elapsed_s
        com_m = [np.interp(at_s, self._time_s, curve) for curve in self._com_m]
        stance_x_m = np.interp(self._via_s[step.side], self._time_s, self._com_m[0])
        foot_x_m = [np.interp(at_s, self._time_s, curve) - stance_x_m for curve in self._foot_x_m]
        landed_s = self._via_s[step.side + 1]
        landing_m = np.interp(landed_s, self._time_s, self._foot_x_m[1 - step.side]) - stance_x_m
        index = np.searchsorted(self._time_s, at_s, side="right") - 1
        right_swings = self._support[index] == 0
        return {
            "com_y_m": step.com_y_m - com_m[1],
            "com_z_m": step.com_z_m - com_m[2],
            "swing_x_m": np.where(right_swings, *(step.foot_x_m - foot_x_m)[::-1]),
            "landing_m": np.array([step.landing_m - landing_m]),
            "heel_strike_s": np.array([step.heel_strike_s - self.heel_strike_s(step.side)]),
        }


def deviation(recording: Recording, config: Any, hs_angle_deg: float) -> Deviation:
    """`config` has passed saddle_config_check(); the recording's mean speed is known."""
    events = (foot_events(recording, 0), foot_events(recording, 1))
    plan = SteadyPlan(config, mean_speed(recording, events), hs_angle_deg)
    steps = list(_steps(recording, events))
    by_step = [plan.differences(step) for step in steps]
    pooled = {
        name: np.concatenate([differences[name] for differences in by_step] or [np.array([])])
        for name in ("com_y_m", "com_z_m", "swing_x_m", "landing_m", "heel_strike_s")
    }
    return Deviation(
        steps=len(steps),
        com_z_shape_m=_rms(pooled["com_z_m"] - _mean(pooled["com_z_m"])),
        limited=plan.limited,
        **{name: _rms(values) for name, values in pooled.items()},
    )


def _steps(recording: Recording, events: tuple[FootEvents, FootEvents]) -> Iterator[_Step]:
    placed = placements(recording)
    for i, (stance, to) in enumerate(pairwise(placed)):
        passed, next_passed = passing(recording, stance), passing(recording, to)
        if stance.side == to.side or passed is None or next_passed is None:
            continue
        (first, start_s), (end, end_s) = passed, next_passed
        if not 0 < end_s - start_s <= LONGEST_STEP_S:
            continue
        span = slice(first, end)
        before = placed[i - 1] if i and placed[i - 1].side == to.side else to
        line_y_m = stance.cop_m[1] / 2 + (before.cop_m[1] + to.cop_m[1]) / 4
        strikes = events[to.side].heel_strikes
        struck = strikes[(strikes >= first) & (strikes < end)]
        yield _Step(
            side=stance.side,
            elapsed_s=recording.time_s[span] - start_s,
            com_y_m=recording.com_m[span, 1] - line_y_m,
            com_z_m=recording.com_m[span, 2],
            foot_x_m=recording.cop_m[:, span, 0] - stance.cop_m[0],
            landing_m=to.cop_m[0] - stance.cop_m[0],
            heel_strike_s=float(recording.time_s[struck[0]] - start_s) if len(struck) else np.nan,
        )


def _point(time_s: float, plan: Any) -> tuple[float, ...]:
    """Time, unwrapped phase, time of the next heel strike, support, CoM x y z, feet's x."""
    origin_m = plan.origin_x_nm * 1e-9
    com, (left, right) = plan.com_m, plan.foot_m
    return (
        time_s,
        2 * math.pi * plan.stride_count + plan.theta_rad,
        time_s + plan.time_to_heel_strike_s,
        plan.support,
        origin_m + com.x,
        com.y,
        com.z,
        origin_m + left.x,
        origin_m + right.x,
    )


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else np.nan


def _rms(values: np.ndarray) -> float:
    return math.sqrt(_mean(values**2))
