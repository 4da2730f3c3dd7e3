"""Steps and distance of a run: measured, or planned if no measurement was logged."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from saddlewalk.contract import FAULTS, SIDES, WALKING
from saddlewalk.dashboard import SILENT_AFTER_S
from saddlewalk.gait.step_curves import LONGEST_STEP_S
from saddlewalk.session.runs import Run

SWING_MIN_S = 0.12  # as in the firmware: a shorter loss of contact does not end the stance
ROUNDING_S = 1e-6  # of sums over a day
STEADY_M_S = 0.01  # variation of the planned speed that is still steady
QUANTITIES = {"length_m": "step length (m)", "width_m": "step width (m)", "time_s": "step time (s)"}


@dataclass(frozen=True)
class Steps:
    """Steps as columns, each by the foot that lands; NaN where unknown.

    length_m is the landed foot ahead of the other and width_m the left one left of the right, both
    along the axes of the walk; time_s since the other foot landed, distance_m walked by the CoM
    since then.
    """

    landed_s: np.ndarray
    side: np.ndarray  # of SIDES
    length_m: np.ndarray
    width_m: np.ndarray
    time_s: np.ndarray
    distance_m: np.ndarray
    steady: np.ndarray  # the plan's speed is constant during the step

    def __len__(self) -> int:
        return len(self.landed_s)

    def where(self, chosen: np.ndarray) -> "Steps":
        return Steps(*(getattr(self, field.name)[chosen] for field in dataclasses.fields(self)))

    @property
    def speed_m_s(self) -> float:
        """Mean over the steps whose time is known; NaN if there are none."""
        timed = self.time_s > 0
        time_s = self.time_s[timed].sum()
        return float(self.distance_m[timed].sum() / time_s) if timed.any() else np.nan


@dataclass(frozen=True)
class Walked:
    """What was walked in a run."""

    measured: bool  # else planned
    steps: Steps
    distance_m: float  # of the CoM, along x
    unknown_s: float  # time during which it is unknown

    @property
    def speed_m_s(self) -> float:
        return self.steps.speed_m_s


@dataclass(frozen=True)
class Variability:
    """Mean, SD and CV; NaN if there are too few steps."""

    steps: int
    mean: float
    sd: float
    cv: float  # SD by mean


def variability(values: Sequence[float] | np.ndarray) -> Variability:
    """Of the values that are known; the SD is the sample's."""
    known = np.asarray(values, float)
    known = known[np.isfinite(known)]
    mean = float(known.mean()) if len(known) else np.nan
    sd = float(known.std(ddof=1)) if len(known) > 1 else np.nan
    return Variability(len(known), mean, sd, sd / mean if mean > 0 else np.nan)


def walked(run: Run) -> Walked | None:
    """As measured if the feet were, else as planned; None if neither was logged."""
    if any(fresh(run, side).any() for side in SIDES):
        return _measured(run)
    return _planned(run) if run.has("plan") else None


def fresh(run: Run, part: str) -> np.ndarray:
    """Ticks with a fresh measurement of a part (com, left, right) in which no fault was seen."""
    age_us = run.column("input", f"{part}_age_us")
    faulty = sum(1 << bit for bit, name in enumerate(FAULTS) if name.startswith(f"{part.upper()}_"))
    faults = run.bits("health", "faults") & faulty
    return (age_us >= 0) & (age_us <= SILENT_AFTER_S * 1e6) & (faults == 0)


def _measured(run: Run) -> Walked:
    strikes = [_strikes(run, side) for side in SIDES]
    ticks, chosen = np.unique(np.concatenate(strikes), return_index=True)  # both at once: left
    side = (chosen >= len(strikes[0])).astype(int)
    ahead_m, width_m = (_apart(run, axis)[ticks] for axis in (0, 1))
    length_m = np.where(side == 0, ahead_m, -ahead_m)
    landings = _Landings(ticks, run.time_s[ticks], side, length_m, width_m)
    return _from_landings(run, True, landings, _moved(run))


def _moved(run: Run) -> np.ndarray:
    """The CoM's movement along x since the previous tick."""
    seen_m_s = _wide(run.column("input", "com_velocity_m_s", 0))
    velocity_m_s = np.where(fresh(run, "com"), seen_m_s, np.nan)
    means_m_s = (velocity_m_s[1:] + velocity_m_s[:-1]) / 2
    moved_m = np.append(0.0, means_m_s * np.diff(run.time_s))
    moved_m[run.after_silence] = np.nan
    return moved_m


def _wide(column: np.ndarray) -> np.ndarray:
    """In double precision, where sums and differences of any two floats are finite."""
    return column.astype(float)


def _apart(run: Run, axis: int) -> np.ndarray:
    """Distance from the right foot to the left one."""
    left_m, right_m = (
        np.where(fresh(run, side), _wide(run.column("input", f"{side}_m", axis)), np.nan)
        for side in SIDES
    )
    return left_m - right_m


def _strikes(run: Run, side: str) -> np.ndarray:
    """Ticks at which a foot is first seen on the ground after a swing. Its time in the air counts
    the ticks with a known contact; contact and silence reset it.
    """
    known = fresh(run, side)
    contact = known & (run.column("input", f"{side}_contact") > 0)
    air_s = np.append(0.0, np.diff(run.time_s))
    air_s[contact | ~known] = 0.0
    total_s = np.cumsum(air_s)
    begun_s = np.append(0.0, np.where(contact[:-1], total_s[:-1], 0.0))
    silent = np.flatnonzero(run.after_silence)
    begun_s[silent] = total_s[silent] - air_s[silent]
    airborne_s = total_s - np.maximum.accumulate(begun_s, out=begun_s)
    return np.flatnonzero(contact & (airborne_s >= SWING_MIN_S - ROUNDING_S))


def _planned(run: Run) -> Walked:
    valid = run.column("plan", "valid") == 1
    origin_m = np.where(valid, run.column("plan", "origin_x_m"), np.nan)
    distance_m = origin_m + run.column("plan", "com_m", 0)
    count, support = run.column("plan", "step_count"), run.column("plan", "support")
    lateral_m = np.where(
        support == 0, run.column("plan", "left_m", 1), run.column("plan", "right_m", 1)
    )
    due_s = run.time_s + run.column("plan", "time_to_toe_off_s")
    after = np.flatnonzero((np.diff(count) == 1) & valid[1:] & valid[:-1]) + 1
    landings = _Landings(
        after,
        np.fmin(due_s[after - 1], run.time_s[after]),
        (support[after] == 1).astype(int),
        origin_m[after] - origin_m[after - 1],
        np.abs(lateral_m[after] - lateral_m[after - 1]),
    )
    return _from_landings(run, False, landings, np.append(0.0, np.diff(distance_m)))


@dataclass(frozen=True)
class _Landings:
    tick: np.ndarray  # at which it is seen
    time_s: np.ndarray
    side: np.ndarray
    length_m: np.ndarray
    width_m: np.ndarray


def _from_landings(run: Run, measured: bool, landings: _Landings, moved_m: np.ndarray) -> Walked:
    """moved_m: of the CoM since the tick before."""
    time_s, distance_m = (np.full(len(landings.tick), np.nan) for _ in range(2))
    steady = np.zeros(len(landings.tick), bool)
    if len(landings.tick) > 1:
        bounds = landings.tick[:-1], landings.tick[1:]
        took_s = np.diff(landings.time_s)
        came_m = _over(np.add, moved_m, bounds[0] + 1, bounds[1] + 1)
        known = (np.diff(landings.side) != 0) & (took_s <= LONGEST_STEP_S) & np.isfinite(came_m)
        time_s[1:], distance_m[1:] = (
            np.where(known, took_s, np.nan),
            np.where(known, came_m, np.nan),
        )
        steady[1:] = known & _steady(run, bounds[0], bounds[1] + 1)
    steps = Steps(
        *(landings.time_s, landings.side, landings.length_m, landings.width_m),
        *(time_s, distance_m, steady),
    )
    unknown_s = float(np.diff(run.time_s)[np.isnan(moved_m[1:])].sum())
    return Walked(measured, steps, float(np.nansum(moved_m)), unknown_s)


def _steady(run: Run, first: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Whether the plan's speed is constant from each tick `first` to before `end`."""
    walking = run.column("plan", "mode") == WALKING
    walks = walking & (run.column("plan", "valid") == 1)
    speed_m_s = run.column("plan", "speed_m_s")
    varies_m_s = _over(np.maximum, speed_m_s, first, end) - _over(np.minimum, speed_m_s, first, end)
    return _over(np.logical_and, walks, first, end) & (varies_m_s <= STEADY_M_S)


def _over(of: np.ufunc, values: np.ndarray, first: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The ufunc's reduction over each values[first:end]; none may be empty."""
    bounds = np.column_stack((first, end)).ravel()
    return of.reduceat(np.append(values, values[-1]), bounds)[::2]
