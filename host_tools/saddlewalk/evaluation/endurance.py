"""Walks from standing to standing without a push: whether they end standing, and how they went.

Everything follows from a seed. A walk covers a distance, is stopped at some phase of its step, or
follows a schedule.
"""

import cmath
import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from saddlewalk.contract import LEVELS, STANDING, TICK_S
from saddlewalk.core import ffi
from saddlewalk.emulation import closed_loop
from saddlewalk.physics.plants import PlantChoice
from saddlewalk.planning.schedule import Speeds, schedule_of
from saddlewalk.table import Cell
from saddlewalk.workers import Workers, run_tasks

HEEL_STRIKE_RAD = 0.17
START_S = 1.0
STARTS_AND_STOPS_S = 1.5  # that a walk takes longer for than at its speed throughout
STOPPING_S = 8.0  # from the command to stop until it must stand
SETTLED_S = 4.0  # after the command to walk
STOPPED_AT_S = 6.0  # the first of the stops from every phase
STILL_M_S = 0.03
FIGURES = (
    "walks falls standing speed_m_s xcom_sd_x_m xcom_sd_y_m stable_pct caution_pct unstable_pct "
    "unknown_pct unsolved_pct distance_m"
).split()


@dataclass(frozen=True)
class Course:
    """Parameters of a walk."""

    speed_m_s: float  # from START_S to stop_s, without a schedule
    height_m: float
    seed: int
    stop_s: float
    sensor_delay_s: float = 0.0
    torque_delay_s: float = 0.0
    schedule: str = ""  # its name
    speeds: Speeds = ()  # and what it says; it stands from stop_s on

    @property
    def group(self) -> tuple[float | str, ...]:
        own = self.speed_m_s, self.height_m, self.sensor_delay_s, self.torque_delay_s
        return self.schedule, *own


@dataclass(frozen=True)
class Outcome:
    """What came of it; NaN: did not happen, or not known."""

    course: Course
    fell_at_s: float
    stands: bool  # at the end
    distance_m: float
    speed_m_s: float  # mean, from SETTLED_S until the stop
    xcom_sd_x_m: float  # of the XCoM about its reference, over the same time
    xcom_sd_y_m: float
    ticks: dict[str, int]  # by level, from start to stop
    unsolved_share: float  # of the quadratic programmes
    peaks: dict[str, tuple[float, float, float]]  # joint -> N m, W, rad/s; of both legs

    @property
    def fell(self) -> bool:
        return math.isfinite(self.fell_at_s)

    def row(self) -> dict[str, Cell]:
        own = {k: value for k, value in asdict(self).items() if k not in ("ticks", "peaks")}
        course = own.pop("course")
        del course["speeds"]
        asked = {f"asked_{name}": value for name, value in course.items()}
        peaks = {
            f"{joint}_{unit}": peak
            for joint, each in self.peaks.items()
            for unit, peak in zip(("nm", "w", "rad_s"), each, strict=True)
        }
        return {**asked, **own, **self.ticks, **peaks}


def over_distance(
    distance_m: float, speeds_m_s: Sequence[float], repeats: int, base: Course
) -> list[Course]:
    return [
        replace(base, speed_m_s=speed_m_s, seed=base.seed + repeat, stop_s=stop_s)
        for speed_m_s in speeds_m_s
        for stop_s in [START_S + STARTS_AND_STOPS_S + distance_m / speed_m_s]
        for repeat in range(repeats)
    ]


def stopped_anywhere(stops: int, speeds_m_s: Sequence[float], base: Course) -> list[Course]:
    """Stops at even distances over a tick and several steps, by turns at the speeds."""
    return [
        replace(
            base,
            speed_m_s=speeds_m_s[number % len(speeds_m_s)],
            seed=base.seed + number,
            stop_s=STOPPED_AT_S + number * 2.0 / stops,
        )
        for number in range(stops)
    ]


def by_schedule(name: str, speeds: Speeds, repeats: int, base: Course) -> list[Course]:
    """speeds: they end with a stop."""
    own = replace(base, schedule=name, speeds=speeds, stop_s=speeds[-1][0])
    return [replace(own, seed=base.seed + repeat) for repeat in range(repeats)]


def endure(
    courses: Sequence[Course],
    plant: PlantChoice,
    config: Any,
    workers: Workers,
    progress: Callable[[int], None],
) -> list[Outcome]:
    """In the order of the courses. config: a saddle_config_t for any height."""
    image = bytes(ffi().buffer(config))
    return run_tasks(_work, [(course, plant, image) for course in courses], workers, progress)


def _work(course: Course, plant: PlantChoice, image: bytes) -> list[Outcome]:
    config = ffi().new("saddle_config_t *")
    ffi().memmove(config, image, len(image))
    return [walked(course, plant, config)]


def walked(course: Course, plant: PlantChoice, config: Any) -> Outcome:
    """One walk."""
    config.body_height_m = course.height_m
    plant = replace(
        plant, sensor_delay_s=course.sensor_delay_s, torque_delay_s=course.torque_delay_s
    )
    wearer = plant.wearer(config, seed=course.seed)
    straight = [(0.0, 0.0), (START_S, course.speed_m_s), (course.stop_s, 0.0)]
    schedule = schedule_of(course.speeds or straight, HEEL_STRIKE_RAD)
    levels: Counter[str] = Counter()
    places, errors, mode = [], [], STANDING
    walked_m, before_m = 0.0, wearer.com_m
    for tick in closed_loop.walk(config, wearer, schedule):
        if wearer.fallen or tick.time_s > course.stop_s + STOPPING_S:
            break
        mode = tick.plan.mode
        to_plan = cmath.rect(1.0, -tick.plan.heading_rad - tick.plan.pelvis_yaw_rad)
        walked_m += ((wearer.com_m - before_m) * to_plan).real
        before_m = wearer.com_m
        if tick.time_s >= START_S:
            levels[LEVELS[tick.output.verdict.level]] += 1
        if START_S + SETTLED_S <= tick.time_s <= course.stop_s:
            places.append(walked_m)
            error_m = wearer.xcom_error_m * to_plan
            errors.append((error_m.real, error_m.imag))
    deviation = np.std(errors, axis=0) if errors else (math.nan, math.nan)
    passed_s = (len(places) - 1) * TICK_S
    return Outcome(
        course=course,
        fell_at_s=wearer.fell_at_s,
        stands=mode == STANDING and abs(wearer.velocity_m_s) < STILL_M_S and not wearer.fallen,
        distance_m=walked_m,
        speed_m_s=(places[-1] - places[0]) / passed_s if len(places) > 1 else math.nan,
        xcom_sd_x_m=float(deviation[0]),
        xcom_sd_y_m=float(deviation[1]),
        ticks={level: levels[level] for level in LEVELS},
        unsolved_share=wearer.unsolved_share,
        peaks=wearer.peaks(),
    )


def grouped(outcomes: Sequence[Outcome]) -> Iterator[dict[str, Any]]:
    """Figures of the walks of each speed or schedule, height and delay, in their order."""
    groups: dict[tuple[float | str, ...], list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault(outcome.course.group, []).append(outcome)
    for group in groups.values():
        asked = group[0].course
        yield {
            "schedule": asked.schedule,
            "asked_m_s": asked.speed_m_s,
            "height_m": asked.height_m,
            "sensor_delay_s": asked.sensor_delay_s,
            "torque_delay_s": asked.torque_delay_s,
            **figures(group),
        }


def peaks_of(outcomes: Sequence[Outcome]) -> dict[str, tuple[float, ...]]:
    """Of each joint, the greatest torque (N m), power (W) and speed (rad/s) of walks without
    a fall; nothing of a point mass.
    """
    upright = [outcome.peaks for outcome in outcomes if not outcome.fell]
    return {
        joint: tuple(np.max([peaks[joint] for peaks in upright], axis=0).tolist())
        for joint in (upright[0] if upright else ())
    }


def figures(outcomes: Sequence[Outcome]) -> dict[str, float]:
    ticks: Counter[str] = Counter()
    for outcome in outcomes:
        ticks.update(outcome.ticks)
    upright = [outcome for outcome in outcomes if not outcome.fell]

    def mean(name: str) -> float:
        values = [getattr(outcome, name) for outcome in upright]
        known = [value for value in values if math.isfinite(value)]
        return float(np.mean(known)) if known else math.nan

    return {
        "walks": len(outcomes),
        "falls": len(outcomes) - len(upright),
        "standing": sum(outcome.stands for outcome in outcomes),
        **{name: mean(name) for name in ("speed_m_s", "xcom_sd_x_m", "xcom_sd_y_m")},
        **{f"{level}_pct": 100 * ticks[level] / max(ticks.total(), 1) for level in LEVELS},
        "unsolved_pct": 100 * mean("unsolved_share"),
        "distance_m": sum(outcome.distance_m for outcome in outcomes),
    }
