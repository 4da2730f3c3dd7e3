"""Tracking error between the planner's steady walk and a recorded one.

The plan starts as the core does, at the foot via point: at every instant at which the recorded CoM
passes a foot that lies flat, the plan at the recording's mean speed is aligned with that foot and
the line midway between the feet, and compared until the CoM passes the next foot.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.core import Core, library
from saddlewalk.gait.measures import WalkMeasures
from saddlewalk.gait.step_curves import LONGEST_STEP_S, StepCurve
from saddlewalk.planning.steady import walk

PLAN_STEP_S = 0.005


@dataclass(frozen=True)
class Deviation:
    """RMS of recorded minus planned, over all steps; NaN if nothing can be compared."""

    steps: int
    com_y_m: float
    com_z_m: float
    com_z_shape_m: float  # without the mean difference in height
    swing_x_m: float  # of the swing foot from the stance foot, over the swing
    landing_m: float  # position of the landed foot
    heel_strike_s: float
    limited: bool  # the speed is not feasible for this configuration, and the plan is slower


@dataclass(frozen=True)
class PlannedStep:
    """The plan at a step's samples, in the step's frame."""

    com_m: np.ndarray  # (3, n)
    foot_m: np.ndarray  # (2, n, 3)
    swing: np.ndarray  # (n,) the foot that swings


class SteadyPlan:
    """Some strides planned by the core at one speed, from a left foot via point."""

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
        self._com_m, self._foot_m = columns[4:7], columns[7:13].reshape(2, 3, -1)
        self._via_s = np.interp([0, math.pi, 2 * math.pi], theta_rad, self._time_s)

    def heel_strike_s(self, side: int) -> float:
        """Time from passing the foot `side` to the other foot's heel strike."""
        index = np.searchsorted(self._time_s, self._via_s[side])
        return float(self._strike_s[index] - self._via_s[side])

    def landing_m(self, side: int) -> float:
        """Where the other foot lies then, from the foot `side`."""
        landed_m = self._at(self._via_s[side + 1], self._foot_m[1 - side, 0])
        return float(landed_m - self._at(self._via_s[side], self._com_m[0]))

    def at(self, step: StepCurve) -> PlannedStep:
        at_s = self._via_s[step.side] + step.elapsed_s
        origin_m = np.array([self._at(self._via_s[step.side], self._com_m[0]), 0.0, 0.0])
        index = np.searchsorted(self._time_s, at_s, side="right") - 1
        return PlannedStep(
            com_m=np.array([self._at(at_s, curve) for curve in self._com_m]) - origin_m[:, None],
            foot_m=np.array(
                [[self._at(at_s, curve) for curve in foot_m] for foot_m in self._foot_m]
            ).transpose(0, 2, 1)
            - origin_m,
            swing=np.where(self._support[index] == 0, 1, 0),
        )

    def _at(self, time_s: Any, curve: np.ndarray) -> Any:
        return np.interp(time_s, self._time_s, curve)


def deviation(measured: WalkMeasures, config: Any, hs_angle_deg: float) -> Deviation:
    """`config` has passed saddle_config_check()."""
    plan = SteadyPlan(config, measured.speed_m_s, hs_angle_deg)
    by_step = [_differences(plan, step) for step in measured.curves]
    pooled = {
        name: np.concatenate([differences[name] for differences in by_step] or [np.array([])])
        for name in ("com_y_m", "com_z_m", "swing_x_m", "landing_m", "heel_strike_s")
    }
    return Deviation(
        steps=len(measured.curves),
        com_z_shape_m=_rms(pooled["com_z_m"] - _mean(pooled["com_z_m"])),
        limited=plan.limited,
        **{name: _rms(values) for name, values in pooled.items()},
    )


def _differences(plan: SteadyPlan, step: StepCurve) -> dict[str, np.ndarray]:
    """Recorded minus planned at the step's samples."""
    planned = plan.at(step)
    samples = np.arange(len(step.elapsed_s))
    swing_m = (step.foot_m - planned.foot_m)[planned.swing, samples, 0]
    return {
        "com_y_m": step.com_y_m - planned.com_m[1],
        "com_z_m": step.com_z_m - planned.com_m[2],
        "swing_x_m": swing_m,
        "landing_m": np.array([step.landing_m - plan.landing_m(step.side)]),
        "heel_strike_s": np.array([step.heel_strike_s - plan.heel_strike_s(step.side)]),
    }


def _point(time_s: float, plan: Any) -> tuple[float, ...]:
    """Time, unwrapped phase, time of the next heel strike, support, CoM x y z, left and right foot
    likewise."""
    origin_m = plan.origin_x_nm * 1e-9
    com, (left, right) = plan.com_m, plan.foot_m
    return (
        time_s,
        2 * math.pi * plan.stride_count + plan.theta_rad,
        time_s + plan.time_to_heel_strike_s,
        plan.support,
        *(
            value
            for point in (com, left, right)
            for value in (origin_m + point.x, point.y, point.z)
        ),
    )


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else np.nan


def _rms(values: np.ndarray) -> float:
    return math.sqrt(_mean(values**2))
