"""Steps and the way of a run: as measured, or as planned where no measurement was logged."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from saddlewalk.dashboard import FAULTS, MODES, SILENT_AFTER_S, bit_names
from saddlewalk.gait.measures import LONGEST_STEP_S
from saddlewalk.session.runs import Run

SIDES = ("left", "right")
SWING_MIN_S = 0.12  # as the firmware has it: contact that is lost for less ends no stance
STEADY_M_S = 0.01  # by which the planned speed varies in a steady step
QUANTITIES = {"length_m": "step length (m)", "width_m": "step width (m)", "time_s": "step time (s)"}


@dataclass(frozen=True)
class Step:
    """A step by the foot that lands; NaN where it is not known.

    length_m is the landed foot ahead of the other and width_m the left one left of the right, both
    along the axes of the walk; time_s since the other foot landed, way_m that of the CoM meanwhile.
    """

    landed_s: float
    side: int  # of SIDES
    length_m: float
    width_m: float
    time_s: float
    way_m: float
    steady: bool  # the plan walks at one speed all the while


@dataclass(frozen=True)
class Way:
    """What was walked in a run."""

    measured: bool  # else planned
    steps: list[Step]
    distance_m: float  # of the CoM, along x
    unknown_s: float  # during which it was not known

    @property
    def speed_m_s(self) -> float:
        """Mean over the steps whose time is known; NaN if there are none."""
        timed = [step for step in self.steps if step.time_s > 0]
        time_s = sum(step.time_s for step in timed)
        return sum(step.way_m for step in timed) / time_s if timed else np.nan


@dataclass(frozen=True)
class Variability:
    """NaN where there are too few steps."""

    steps: int
    mean: float
    sd: float
    cv: float  # SD by mean


def variability(values: list[float]) -> Variability:
    """Of the values that are known; the SD is the sample's."""
    known = np.array([value for value in values if np.isfinite(value)])
    mean = float(known.mean()) if len(known) else np.nan
    sd = float(known.std(ddof=1)) if len(known) > 1 else np.nan
    return Variability(len(known), mean, sd, sd / mean if mean > 0 else np.nan)


def walked(run: Run) -> Way | None:
    """As measured if that tells of the feet, else as planned; None if neither was logged."""
    if any(_known(run, side).any() for side in SIDES):
        return _measured(run)
    return _planned(run) if run.has("plan") else None


def _known(run: Run, part: str) -> np.ndarray:
    """Ticks with a fresh measurement of a part (com, left, right) in which no fault was seen."""
    age_us = run.column("input", f"{part}_age_us")
    faulty = [name for name in FAULTS if name.startswith(part.upper() + "_")]
    faults = [
        any(name in faulty for name in bit_names(bits, FAULTS))
        for bits in run.bits("health", "faults").tolist()
    ]
    return (age_us >= 0) & (age_us <= SILENT_AFTER_S * 1e6) & ~np.array(faults)


def _measured(run: Run) -> Way:
    velocity_m_s = np.where(_known(run, "com"), run.column("input", "com_velocity_m_s", 0), np.nan)
    means_m_s = (velocity_m_s[1:] + velocity_m_s[:-1]) / 2
    moved_m = np.append(0.0, means_m_s * np.diff(run.time_s))
    moved_m[np.append(0.0, run.silent_s[:-1]) > 0] = np.nan
    left, right = (
        np.array(
            [
                np.where(_known(run, side), run.column("input", f"{side}_m", i), np.nan)
                for i in (0, 1)
            ]
        )
        for side in SIDES
    )
    apart_m = left - right
    strikes = sorted(
        {index: side for side in (1, 0) for index in _strikes(run, SIDES[side])}.items()
    )
    steps = [
        _Landing(index, float(run.time_s[index]), side, *_of_landed(apart_m[:, index], side))
        for index, side in strikes
    ]
    return _way(run, True, steps, moved_m)


def _of_landed(apart_m: np.ndarray, side: int) -> tuple[float, float]:
    ahead_m = apart_m[0] if side == 0 else -apart_m[0]
    return float(ahead_m), float(apart_m[1])


def _strikes(run: Run, side: str) -> Iterator[int]:
    """Ticks at which a foot that swung is seen on the ground again."""
    contact, known = run.column("input", f"{side}_contact") > 0, _known(run, side)
    since_s = np.append(0.0, np.diff(run.time_s))
    silent = np.append(0.0, run.silent_s[:-1]) > 0
    airborne_s = 0.0
    for index in range(len(contact)):
        if silent[index]:
            airborne_s = 0.0
        if not known[index]:
            continue
        if not contact[index]:
            airborne_s += since_s[index]
            continue
        if airborne_s >= SWING_MIN_S:
            yield index
        airborne_s = 0.0


def _planned(run: Run) -> Way:
    valid = run.column("plan", "valid") == 1
    origin_m = np.where(valid, run.column("plan", "origin_x_m"), np.nan)
    way_m = origin_m + run.column("plan", "com_m", 0)
    moved_m = np.append(0.0, np.diff(way_m))
    count, support = run.column("plan", "step_count"), run.column("plan", "support")
    lateral_m = np.where(
        support == 0, run.column("plan", "left_m", 1), run.column("plan", "right_m", 1)
    )
    due_s = run.time_s + run.column("plan", "time_to_toe_off_s")
    landings = [
        _Landing(
            index,
            float(np.fmin(due_s[index - 1], run.time_s[index])),
            int(support[index] == 1),
            float(origin_m[index] - origin_m[index - 1]),
            float(abs(lateral_m[index] - lateral_m[index - 1])),
        )
        for index in np.flatnonzero(np.diff(count) == 1) + 1
        if valid[index - 1 : index + 1].all()
    ]
    return _way(run, False, landings, moved_m)


@dataclass(frozen=True)
class _Landing:
    tick: int  # index in the run at which it is seen
    time_s: float
    side: int
    length_m: float
    width_m: float


def _way(run: Run, measured: bool, landings: list[_Landing], moved_m: np.ndarray) -> Way:
    """moved_m: of the CoM since the tick before."""
    unknown = np.isnan(moved_m)
    steps = [
        _step(run, before, landing, moved_m)
        for before, landing in zip([None, *landings], landings, strict=False)
    ]
    unknown_s = float(np.diff(run.time_s)[unknown[1:]].sum())
    return Way(measured, steps, float(np.nansum(moved_m)), unknown_s)


def _step(run: Run, before: _Landing | None, landing: _Landing, moved_m: np.ndarray) -> Step:
    time_s = way_m = np.nan
    steady = False
    if before and before.side != landing.side:
        meanwhile = slice(before.tick + 1, landing.tick + 1)
        took_s, came_m = landing.time_s - before.time_s, float(moved_m[meanwhile].sum())
        if took_s <= LONGEST_STEP_S and np.isfinite(came_m):
            time_s, way_m = took_s, came_m
            steady = _steady(run, slice(before.tick, landing.tick + 1))
    return Step(
        landing.time_s, landing.side, landing.length_m, landing.width_m, time_s, way_m, steady
    )


def _steady(run: Run, ticks: slice) -> bool:
    plans = [tick.messages.get("plan") for tick in run.ticks[ticks]]
    walking = MODES.index("walking")
    if not all(plan and plan.valid and plan.mode == walking for plan in plans):
        return False
    speeds_m_s = [plan.speed_m_s for plan in plans]
    return max(speeds_m_s) - min(speeds_m_s) <= STEADY_M_S
