"""The shape of a person's walk between the landings, fitted in the plan's own time.

Each function gives candidates for one quantity, the most individual first; in_sample.py takes the
first that is no worse on the recordings than the default plan. Where the recordings are too short,
fields keep the population's value, its median in 58 natural trials of adults.
"""

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

# Standard deviations from step to step, since feet scatter, and between persons. Steps that are
# left out are followed equally well with half and twice these.
PATH_SCATTER_M = 0.006
OFFSET_SPREAD_M = 0.010
DELAY_SPREAD_RAD = 0.6
FACTOR_SPREAD = 0.5
SWING_SCATTER_M = 0.02
SWING_SPREAD = (0.2, 0.1, 0.4)

LARGEST_OFFSET_M = 0.1  # what the core accepts
LARGEST_DELAY_RAD = 1.5
FACTOR = (0.1, 5.0)
SWING_BOUNDS = ((-1.0, 0.6, 0.3), (0.4, 2.0, 4.0))  # what the core accepts
SHARE = (0.05, 0.75)  # what the core accepts
SAME_STEP_S = 0.02  # steps whose times differ by less show no line through the origin
KEPT = "the population's {}"


def sway(steps: Sequence[TimedStep]) -> list[Fit]:
    """lateral_factor, and offset and delay of the path, [E7]."""
    seen = [step for step in steps if np.isfinite(step.curve.com_y_m).all()]
    if not seen:
        return [_unknown("sway", {"lateral_delay_rad": LATERAL_DELAY_RAD})]
    candidates = [_sway(seen, _path(seen)), _sway(seen, (0.0, 0.0))]
    usable = [fit for fit in candidates if fit is not None]
    against = "the CoM is not nearer to the foot that it passes than before and after"
    return [*usable, Fit("sway", note=against if not usable else _paper("sway"))]


def _path(steps: Sequence[TimedStep]) -> tuple[float, float]:
    """Offset and delay, by least squares. Every step counts as one measurement beside what is known
    of people: one on each foot tells an offset from a delay, one alone hardly does."""
    weights = [1 / (PATH_SCATTER_M * np.sqrt(len(step.angle_rad))) for step in steps]
    waves_m = [_waves_m(step) * weight for step, weight in zip(steps, weights, strict=True)]
    y_m = [step.curve.com_y_m * weight for step, weight in zip(steps, weights, strict=True)]
    cosine, sine = np.cos(LATERAL_DELAY_RAD), np.sin(LATERAL_DELAY_RAD)
    usual = np.array(
        [
            [cosine / FACTOR_SPREAD, sine / FACTOR_SPREAD, 0],
            [-sine / DELAY_SPREAD_RAD, cosine / DELAY_SPREAD_RAD, 0],
            [0, 0, 1 / OFFSET_SPREAD_M],
        ]
    )
    known = np.concatenate([*y_m, [1 / FACTOR_SPREAD, 0, 0]])
    in_phase, late, offset_m = np.linalg.lstsq(np.concatenate([*waves_m, usual]), known)[0]
    return float(offset_m), float(np.arctan2(late, in_phase))


def _waves_m(step: TimedStep) -> np.ndarray:
    """(n, 3): the path at lateral_factor 1, the same a quarter of a stride later, an offset."""
    size_m = step.curve.outward * step.quarter.width_m / (2 * np.pi * step.speed_m_s)
    columns = (size_m * np.cos(step.angle_rad), size_m * np.sin(step.angle_rad))
    return np.stack([*columns, np.ones_like(step.angle_rad)], axis=1)


def _sway(steps: Sequence[TimedStep], path: tuple[float, float]) -> Fit | None:
    """lateral_factor beside that offset and delay. None if the core would not take it."""
    offset_m, delay_rad = path
    y_m = np.concatenate([step.curve.com_y_m for step in steps])
    turned = np.array([np.cos(delay_rad), np.sin(delay_rad), 0])
    wave_m = np.concatenate([_waves_m(step) @ turned for step in steps])
    factor, beyond = _factor(steps, y_m - offset_m, wave_m)
    if not FACTOR[0] <= factor <= FACTOR[1] or not _takes(offset_m, delay_rad):
        return None
    fields = {
        "lateral_factor": factor,
        "lateral_offset_m": offset_m,
        "lateral_delay_rad": delay_rad,
    }
    note = f"{beyond} beyond tangency, d/pi, which bounds the plan" if beyond else ""
    r2 = r_squared(y_m - offset_m - factor * wave_m, y_m)
    return Fit("sway", fields, len(steps), r2, note)


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
    share = float(step_s @ struck_s / (step_s @ step_s))
    left_over_s = struck_s - share * step_s
    note = f"{1e3 * left_over_s.std():.0f} ms scatter"
    r2 = r_squared(left_over_s, struck_s) if np.ptp(step_s) > SAME_STEP_S else np.nan
    fitted = Fit("heel strike", {"strike_share": share}, len(seen), r2, note)
    within = SHARE[0] <= share <= SHARE[1]
    return [*[fitted] * within, population, Fit("heel strike", note=_paper("time"))]


def swing(steps: Sequence[TimedStep]) -> list[Fit]:
    """When the foot begins and ends to move along x, and how late it does the most of it, [E44]."""
    samples = [_swing_samples(step) for step in steps]
    progress, x_m, length_m, line_m = np.concatenate([np.empty((4, 0)), *samples], axis=1)
    population = _unknown("swing", SWING)
    if not len(x_m):
        return [population]

    def left_over_m(coefficients: np.ndarray) -> np.ndarray:
        return x_m - length_m * (2 * swing_profile(progress, *coefficients) - 1)

    usual = np.array(list(SWING.values()))
    weight = np.sqrt(len(samples) / len(x_m)) / SWING_SCATTER_M

    def unlikely(coefficients: np.ndarray) -> np.ndarray:
        beside_usual = (coefficients - usual) / SWING_SPREAD
        return np.concatenate([weight * left_over_m(coefficients), beside_usual])

    found = least_squares(unlikely, usual, bounds=SWING_BOUNDS)
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
