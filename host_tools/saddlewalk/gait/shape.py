"""The shape of a person's walk between the landings, fitted in the plan's own time.

Each function gives candidates for one quantity, the most individual first; in_sample.py takes the
first that is no worse on the recordings than the default plan. Where the recordings are too short,
fields keep the population's value, its median in 58 natural trials of adults.
"""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from saddlewalk.config import ANKLES
from saddlewalk.gait.fit import Fit, r_squared
from saddlewalk.gait.planned_time import TimedStep

LATERAL_DELAY_RAD = 0.18
VERTICAL_DELAY_RAD = 0.19
STRIKE_SHARE = 0.362
SWING = {"swing_begin": -0.32, "swing_end": 1.04, "swing_skew": 1.47}

# The scatter of the feet across moves the offset by some millimetres a step, and the delay more. A
# step on one foot alone cannot tell them apart: both bring the CoM to one side.
OFFSET_STEPS = 1  # on each foot
DELAY_STEPS = 2

LARGEST_OFFSET_M = 0.1  # what the core accepts
LARGEST_DELAY_RAD = 1.5
FACTOR = (0.1, 5.0)
SWING_BOUNDS = ((-1.0, 0.6, 0.3), (0.4, 2.0, 4.0))  # what the core accepts
SHARE = (0.05, 0.5)  # later, the plan's foot has landed
SAME_STEP_S = 0.02  # steps whose times differ by less show no line through the origin
KEPT = "the population's {}"


def sway(steps: Sequence[TimedStep]) -> list[Fit]:
    """lateral_factor, and offset and delay of the path, [E7]."""
    seen = [step for step in steps if np.isfinite(step.curve.com_y_m).all()]
    if not seen:
        return [_unknown("sway", {"lateral_delay_rad": LATERAL_DELAY_RAD})]
    feet = Counter(step.curve.side for step in seen)
    of_each = min(feet[0], feet[1])
    fitted = _sway(seen, offset=True, delay_rad=None)
    candidates = [
        fitted if of_each >= DELAY_STEPS else None,
        _sway(seen, offset=of_each >= OFFSET_STEPS, delay_rad=LATERAL_DELAY_RAD),
        _sway(seen, offset=False, delay_rad=LATERAL_DELAY_RAD),
        _sway(seen, offset=False, delay_rad=0.0),
        fitted if of_each >= OFFSET_STEPS else None,
    ]
    usable = [fit for fit in candidates if fit is not None]
    against = "the CoM is not nearer to the foot that it passes than before and after"
    return [*usable, Fit("sway", note=against if not usable else _paper("sway"))]


def _sway(steps: Sequence[TimedStep], offset: bool, delay_rad: float | None) -> Fit | None:
    """Least squares; delay_rad None: fitted. None if the core would not take it."""
    y_m = np.concatenate([step.curve.com_y_m for step in steps])
    printed_m = [
        step.curve.outward * step.quarter.width_m / (2 * np.pi * step.speed_m_s) for step in steps
    ]

    def wave_m(lag_rad: float) -> np.ndarray:
        pairs = zip(printed_m, steps, strict=True)
        return np.concatenate([size_m * np.cos(step.angle_rad - lag_rad) for size_m, step in pairs])

    lags_rad = [0.0, np.pi / 2] if delay_rad is None else [delay_rad]
    columns = [wave_m(lag_rad) for lag_rad in lags_rad] + [np.ones_like(y_m)] * offset
    solution = np.linalg.lstsq(np.stack(columns, axis=1), y_m)[0]
    lag_rad = float(np.arctan2(*solution[1::-1])) if delay_rad is None else delay_rad
    offset_m = float(solution[-1]) if offset else 0.0
    wave = wave_m(lag_rad)
    factor, beyond = _factor(steps, y_m - offset_m, wave)
    if not FACTOR[0] <= factor <= FACTOR[1] or not _takes(offset_m, lag_rad):
        return None
    fields = {
        "lateral_factor": factor,
        "lateral_offset_m": offset_m,
        "lateral_delay_rad": lag_rad,
    }
    notes = [
        KEPT.format("delay") if delay_rad == LATERAL_DELAY_RAD else "",
        "" if offset or delay_rad == 0 else "no offset",
        f"{beyond} beyond tangency, d/pi, which bounds the plan" if beyond else "",
    ]
    r2 = r_squared(y_m - offset_m - factor * wave, y_m)
    return Fit("sway", fields, len(steps), r2, "; ".join(note for note in notes if note))


def _factor(steps: Sequence[TimedStep], y_m: np.ndarray, wave_m: np.ndarray) -> tuple[float, int]:
    """By least squares over the steps, each bounded by tangency; and how many would be beyond."""
    index = np.repeat(np.arange(len(steps)), [len(step.angle_rad) for step in steps])
    square = np.bincount(index, wave_m**2)
    factors = np.bincount(index, wave_m * y_m) / square
    tangent = np.array([2 * step.speed_m_s for step in steps])
    factor = float(np.average(np.minimum(factors, tangent), weights=square))
    return factor, int((factors > tangent).sum())


def height(steps: Sequence[TimedStep]) -> list[Fit]:
    """Offset and delay of the CoM's height, and the ankle model that has a path of its own, [E24].

    The amplitude is that of wave_heights_m().
    """
    seen = [step for step in steps if np.isfinite(step.curve.com_z_m).all()]
    if not seen:
        fields = {"vertical_delay_rad": VERTICAL_DELAY_RAD, "ankle": ANKLES["cycloid"]}
        return [_unknown("height", fields)]
    candidates = [_height(seen, delay_rad) for delay_rad in (vertical_delay_rad(seen), 0.0)]
    return [fit for fit in candidates if fit is not None] + [Fit("height", note=_paper("height"))]


def _height(steps: Sequence[TimedStep], delay_rad: float) -> Fit | None:
    z_m = np.concatenate([step.curve.com_z_m for step in steps])
    planned_m = np.concatenate([_planned_height_m(step, delay_rad) for step in steps])
    offset_m = float(np.mean(z_m - planned_m))
    if not _takes(offset_m, delay_rad):
        return None
    fields = {
        "vertical_offset_m": offset_m,
        "vertical_delay_rad": delay_rad,
        "ankle": ANKLES["cycloid"],
    }
    r2 = r_squared(z_m - planned_m - offset_m, z_m)
    return Fit("height", fields, len(steps), r2)


def _planned_height_m(step: TimedStep, delay_rad: float) -> np.ndarray:
    gap_m = step.quarter.width_m / 2 - step.quarter.amplitude_m
    top_m = np.sqrt(step.pendulum_m**2 - gap_m**2)
    lag_rad = step.angle_rad - delay_rad / 2
    return np.asarray(top_m - step.quarter.vertical_m * np.sin(lag_rad) ** 2)


def vertical_delay_rad(steps: Sequence[TimedStep]) -> float:
    """Of the mean wave of the steps; the population's without any."""
    waves_m = [_wave_m(step) for step in steps if np.isfinite(step.curve.com_z_m).all()]
    return float(np.arctan2(*np.sum(waves_m, axis=0)[::-1])) if waves_m else VERTICAL_DELAY_RAD


def wave_heights_m(steps: Sequence[TimedStep], delay_rad: float) -> np.ndarray:
    """Peak to peak of each step's wave at twice the gait's phase, as far as it has that delay."""
    direction = np.array([np.cos(delay_rad), np.sin(delay_rad)])
    known = [step for step in steps if np.isfinite(step.curve.com_z_m).all()]
    return np.array([2 * direction @ _wave_m(step) for step in known])


def _wave_m(step: TimedStep) -> np.ndarray:
    """Cosine and sine amplitude."""
    angle_rad = 2 * step.angle_rad
    shapes = np.stack([np.cos(angle_rad), np.sin(angle_rad), np.ones_like(angle_rad)], axis=1)
    return np.asarray(np.linalg.lstsq(shapes, step.curve.com_z_m)[0][:2])


def strike(steps: Sequence[TimedStep]) -> list[Fit]:
    """When the heel strikes, [E38]."""
    seen = [step for step in steps if np.isfinite(step.curve.heel_strike_s)]
    struck_s = np.array([step.curve.heel_strike_s for step in seen])
    step_s = np.array([step.duration_s for step in seen])
    population = _unknown("heel strike", {"strike_share": STRIKE_SHARE})
    if not seen:
        return [population]
    mean = float(step_s @ struck_s / (step_s @ step_s))
    share = min(mean, SHARE[1])
    left_over_s = struck_s - share * step_s
    note = f"{1e3 * left_over_s.std():.0f} ms scatter"
    if mean > share:
        note += f"; {mean:.2f}, after the plan's foot has landed"
    r2 = r_squared(left_over_s, struck_s) if np.ptp(step_s) > SAME_STEP_S else np.nan
    fits = [Fit("heel strike", {"strike_share": share}, len(seen), r2, note)]
    return [*fits[share < SHARE[0] :], population, Fit("heel strike", note=_paper("time"))]


def swing(steps: Sequence[TimedStep]) -> list[Fit]:
    """When the foot begins and ends to move along x, and how late it does the most of it, [E44]."""
    samples = [_swing_samples(step) for step in steps]
    progress, x_m, length_m, line_m = np.concatenate([np.empty((4, 0)), *samples], axis=1)
    population = _unknown("swing", SWING)
    if not len(x_m):
        return [population]

    def left_over_m(coefficients: np.ndarray) -> np.ndarray:
        return x_m - length_m * (2 * swing_profile(progress, *coefficients) - 1)

    found = least_squares(left_over_m, list(SWING.values()), bounds=SWING_BOUNDS)
    fields = dict(zip(SWING, map(float, found.x), strict=True))
    rest_m = left_over_m(found.x)
    fitted = Fit("swing", fields, len(steps), r_squared(rest_m, x_m))
    line = Fit("swing", note=_paper("line"))
    if np.linalg.norm(x_m - line_m) < np.linalg.norm(rest_m):
        return [line, fitted]
    return [fitted, population, line]


def swing_profile(progress: np.ndarray, begin: float, end: float, skew: float) -> np.ndarray:
    """Share of the way; 1 where the swing ends."""

    def reached(at: np.ndarray) -> np.ndarray:
        s = np.clip((at - begin) / (end - begin), 0, 1) ** skew
        return np.asarray(s**3 * (10 + s * (6 * s - 15)))

    return reached(progress) / reached(np.ones(1))


def _swing_samples(step: TimedStep) -> np.ndarray:
    """(4, n): progress of the planned swing, x of the foot from the stance foot, the step's length,
    and x of the paper's line, [E9].

    Until the other foot lands it swings, from then on the one that was passed.
    """
    share = step.angle_rad / np.pi
    ahead = share < 0.5
    x_m = np.where(ahead, step.curve.foot_m[1 - step.curve.side, :, 0], 0.0)
    x_m += np.where(ahead, 0.0, step.curve.foot_m[step.curve.side, :, 0] - step.length_m)
    since = np.where(ahead, share, share - 1)  # the foot via point, in steps
    rise_m = step.quarter.width_m / 2 - step.quarter.amplitude_m * np.cos(np.pi * since)
    line_m = step.quarter.width_m * step.length_m * since / rise_m
    samples = np.stack([since + 0.5, x_m, np.full_like(x_m, step.length_m), line_m])
    return samples[:, np.isfinite(x_m) & (share < 1.5)]


def _takes(offset_m: float, delay_rad: float) -> bool:
    return abs(offset_m) <= LARGEST_OFFSET_M and abs(delay_rad) <= LARGEST_DELAY_RAD


def _unknown(quantity: str, fields: dict[str, float]) -> Fit:
    return Fit(quantity, fields, note=KEPT.format("value"))


def _paper(what: str) -> str:
    return f"the paper's {what}, which is nearer to these walks"
