"""A person's gait model from recorded walks: fields of saddle_config_t with the quality of the fit.

With several speeds the regressions are the person's; with one, the paper's slopes are kept and the
offsets fitted. Every recording counts at its own mean speed, with a weight of its steps.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.config import DEFAULT_HEIGHT_M, DEFAULT_MASS_KG, configuration
from saddlewalk.errors import UserError
from saddlewalk.gait import shape
from saddlewalk.gait.fit import Fit, fields_of
from saddlewalk.gait.in_sample import errors, no_worse
from saddlewalk.gait.measures import WalkMeasures
from saddlewalk.gait.planned_time import TimedStep, timed_steps

SPEED_SPREAD_M_S = 0.2  # speeds that differ by less count as one speed
FEWEST_STEPS = 1
FEWEST_STEPS_OF_A_FOOT = 3
ONE_SPEED = "one speed: the offset, with the paper's slope"
NARROWEST_M = 0.02  # the core treats narrower steps as this wide
PENDULUM_RATIO = (0.45, 0.65)  # ratio of a person's CoM height to body height


@dataclass(frozen=True)
class _Samples:
    """Samples of a quantity: one for each step in which it was measured."""

    speed_m_s: np.ndarray
    value: np.ndarray

    @property
    def several_speeds(self) -> bool:
        return bool(np.ptp(self.speed_m_s) >= SPEED_SPREAD_M_S)


@dataclass(frozen=True)
class _Line:
    slope: float
    intercept: float
    r2: float = np.nan
    note: str = ""

    def at(self, speed_m_s: float) -> float:
        return self.slope * speed_m_s + self.intercept


def calibrate(
    walks: Sequence[WalkMeasures],
    height_m: float | None = None,
    mass_kg: float | None = None,
    ripples: Sequence[float] = (),
) -> list[Fit]:
    """Fit everything that one person's walks show. ripples: one for each walk, NaN if unknown.

    Raises UserError naming a value that is impossible for humans.
    """
    paper = configuration({})
    given = {"body_height_m": height_m, "body_mass_kg": mass_kg}
    default = configuration({name: value for name, value in given.items() if value is not None})
    fits = [_body(walks, height_m, mass_kg)]
    fits += _lengths(walks, fits, default)
    fits += [_step_width(walks, paper), _half_foot(walks)]
    fits.append(_vertical(walks, paper, checked(fits)))
    checked(fits)
    return [
        *fits,
        *no_worse(fits, _shapes(walks, fits), walks, default),
        _ripple(walks, ripples),
    ]


def _shapes(walks: Sequence[WalkMeasures], fits: Sequence[Fit]) -> dict[str, list[Fit]]:
    """Candidates by the column of Deviation that they are for."""

    def steps(fits: Sequence[Fit]) -> list[TimedStep]:
        config = configuration(fields_of(fits))
        return [step for walk in walks for step in timed_steps(walk, config)]

    sway = shape.sway(steps(fits))
    swaying = steps([*fits, sway[0]])
    return {
        "com_y_m": sway,
        "com_z_m": shape.height(swaying),
        "swing_x_m": shape.swing(swaying),
        "heel_strike_s": shape.strike(swaying),
    }


def checked(fits: Sequence[Fit]) -> Any:
    """The saddle_config_t of the fits. Raises UserError naming the field that the core rejects."""
    from saddlewalk.core import describe_bad_field, ffi, library

    config = configuration(fields_of(fits))
    bad_field = library().saddle_config_check(config)
    if bad_field != ffi().NULL:
        text = describe_bad_field(ffi().string(bad_field).decode(), config)
        raise UserError(f"these walks give no usable gait model: {text}")
    return config


def _body(walks: Sequence[WalkMeasures], height_m: float | None, mass_kg: float | None) -> Fit:
    """The leg is a pendulum from the CoP to the CoM at its highest point, [E1]."""
    given = {"body_height_m": height_m or DEFAULT_HEIGHT_M, "body_mass_kg": mass_kg}
    fields = {name: value for name, value in given.items() if value is not None}
    mass = "" if mass_kg else f"; mass not given: the paper's {DEFAULT_MASS_KG} kg"
    pendulum_m = np.concatenate([_pendulums_m(walk) for walk in walks])
    if not len(pendulum_m):
        return Fit("pendulum length", fields, note=_why(walks, "CoM height") + mass)
    length_m = float(pendulum_m.mean())
    text = f"{length_m:.3f} m"
    if height_m is None:
        fields["body_height_m"] = length_m / configuration({}).pendulum_ratio
        note = f"{text}; height not given: {fields['body_height_m']:.2f} m follows from it"
        return Fit("pendulum length", fields, len(pendulum_m), note=note + mass)
    ratio = length_m / height_m
    low, high = PENDULUM_RATIO
    if not low <= ratio <= high:
        raise UserError(
            f"--height {height_m:g}: the CoM is {length_m:.3f} m high, {ratio:.2f} of it; "
            f"human: {low} to {high}"
        )
    fields["pendulum_ratio"] = ratio
    return Fit("pendulum length", fields, len(pendulum_m), note=text + mass)


def _pendulums_m(walk: WalkMeasures) -> np.ndarray:
    aside_m = _mean_or_zero(walk.width_m) / 2 - _mean_or_zero(walk.lateral_m)
    return np.hypot(walk.com_top_m, aside_m)


def _lengths(walks: Sequence[WalkMeasures], fits: Sequence[Fit], default: Any) -> list[Fit]:
    """By every step. Where the plan, with `fits`, would then land farther off than the default, by
    those that it is compared with: the first and the last of a recording may be unlike the rest.
    """
    paper = configuration({})
    for chosen in (walks, [walk.compared() for walk in walks]):
        length = _step_length(chosen, paper)
        lengths = [length, _asymmetry(chosen, configuration(length.fields))]
        config = checked([*fits, *lengths])
        if not errors(config, walks)["landing_m"] > errors(default, walks)["landing_m"]:
            break
    return lengths


def _step_length(walks: Sequence[WalkMeasures], paper: Any) -> Fit:
    samples = _samples(walks, [walk.length_m / 2 for walk in walks])
    if len(samples.value) < FEWEST_STEPS:
        return _too_few(walks, "step length", samples)
    line = _fit_line(samples, paper.half_step_slope_s, lowest=0.01, flattest=0.001)
    fields = {"half_step_slope_s": line.slope, "half_step_intercept_m": line.intercept}
    return _regression("step length", fields, samples, line)


def _step_width(walks: Sequence[WalkMeasures], paper: Any) -> Fit:
    samples = _samples(walks, [walk.width_m for walk in walks])
    if len(samples.value) < FEWEST_STEPS:
        return _too_few(walks, "step width", samples)
    if samples.several_speeds:
        line = _fit_line(samples, paper.step_width_slope_s, lowest=-np.inf)
        slow_m_s, fast_m_s = float(samples.speed_m_s.min()), float(samples.speed_m_s.max())
        widths_m = line.at(slow_m_s), line.at(fast_m_s)
        return _regression(
            "step width", _width_fields(line, slow_m_s, fast_m_s, *widths_m), samples, line
        )
    return Fit("step width", _offset_width(samples, paper), len(samples.value), note=ONE_SPEED)


def _width_fields(
    line: _Line, slow_m_s: float, fast_m_s: float, slow_m: float, fast_m: float
) -> dict[str, float]:
    """Fields of the width, which is constant beyond the two speeds, [E3]."""
    return {
        "step_width_slow_m": slow_m,
        "step_width_fast_m": fast_m,
        "step_width_slow_speed_m_s": slow_m_s,
        "step_width_fast_speed_m_s": fast_m_s,
        "step_width_slope_s": line.slope,
        "step_width_intercept_m": line.intercept,
    }


def _offset_width(samples: _Samples, paper: Any) -> dict[str, float]:
    """The paper's regression with an offset; the slope ends where steps would become too narrow."""
    from saddlewalk.core import library, model_of

    model = model_of(paper)
    printed_m = [library().saddle_step_width_m(model, v) for v in samples.speed_m_s]
    offset_m = float(np.mean(samples.value - printed_m))
    line = _Line(paper.step_width_slope_s, paper.step_width_intercept_m + offset_m)
    slow_m_s, fast_m_s = paper.step_width_slow_speed_m_s, paper.step_width_fast_speed_m_s
    narrow_m_s = (NARROWEST_M - line.intercept) / line.slope
    return _width_fields(
        line,
        slow_m_s,
        max(slow_m_s, min(fast_m_s, narrow_m_s)),
        max(NARROWEST_M, paper.step_width_slow_m + offset_m),
        max(NARROWEST_M, paper.step_width_fast_m + offset_m),
    )


def _vertical(walks: Sequence[WalkMeasures], paper: Any, config: Any) -> Fit:
    """The wave that the plan has; peak to peak of the recording where that is all there is."""
    by_walk = [list(timed_steps(walk, config)) for walk in walks]
    delay_rad = shape.vertical_delay_rad([step for steps in by_walk for step in steps])
    waves_m = [shape.wave_heights_m(steps, delay_rad) for steps in by_walk]
    heights_m = [
        wave_m if len(wave_m) else walk.vertical_m
        for walk, wave_m in zip(walks, waves_m, strict=True)
    ]
    samples = _samples(walks, heights_m)
    if not len(samples.value):
        return Fit("vertical amplitude", note=_why(walks, "vertical amplitude"))
    line = _fit_line(samples, paper.vertical_slope_s, lowest=0.0)
    fields = {"vertical_slope_s": line.slope, "vertical_intercept_m": line.intercept}
    return _regression("vertical amplitude", fields, samples, line)


def _half_foot(walks: Sequence[WalkMeasures]) -> Fit:
    half_m = np.concatenate([walk.half_foot_m for walk in walks])
    if not len(half_m):
        return Fit("half foot length", note=_why(walks, "half foot length"))
    note = "heel to metatarsus, halved"
    return Fit("half foot length", {"cop_range_m": float(half_m.mean())}, len(half_m), note=note)


def _asymmetry(walks: Sequence[WalkMeasures], config: Any) -> Fit:
    """Ratio of each foot's step length to the regression, [E4]."""
    foot = np.concatenate([walk.foot for walk in walks])
    counts = [int((foot == side).sum()) for side in (0, 1)]
    if min(counts) < FEWEST_STEPS_OF_A_FOOT:
        note = (
            f"left {counts[0]}, right {counts[1]} steps; {FEWEST_STEPS_OF_A_FOOT} each are needed"
        )
        return Fit("asymmetry", note=note)
    samples = _samples(walks, [walk.length_m / 2 for walk in walks])
    fitted_m = config.half_step_slope_s * samples.speed_m_s + config.half_step_intercept_m
    left, right = (float((samples.value / fitted_m)[foot == side].mean()) for side in (0, 1))
    mean = (left + right) / 2
    fields = {"step_length_factor_left": left / mean, "step_length_factor_right": right / mean}
    note = f"the left foot's steps are {left / right:.3f} of the right's"
    return Fit("asymmetry", fields, len(foot), note=note)


def _ripple(walks: Sequence[WalkMeasures], ripples: Sequence[float]) -> Fit:
    """The supervisor's initial value of the ripple, [E32]."""
    known = [
        (ripple, len(walk.length_m))
        for walk, ripple in zip(walks, ripples, strict=False)
        if np.isfinite(ripple) and len(walk.length_m)
    ]
    if not known:
        return Fit("ripple of the speed", note="no recording of a second or more with a step")
    values, steps = np.array(known).T
    mean = float(np.average(values, weights=steps))
    note = f"{100 * mean:.1f} % of sqrt(g h)"
    return Fit("ripple of the speed", {"learn_ripple_start": mean}, int(steps.sum()), note=note)


def _samples(walks: Sequence[WalkMeasures], values: Sequence[np.ndarray]) -> _Samples:
    speeds = [np.full(len(v), walk.speed_m_s) for walk, v in zip(walks, values, strict=True)]
    return _Samples(np.concatenate(speeds), np.concatenate(values))


def _fit_line(
    samples: _Samples, paper_slope: float, lowest: float, flattest: float = -np.inf
) -> _Line:
    """Least squares with a slope and an intercept of at least these; at one speed, and where the
    slope would be less, with the paper's slope."""
    speed_m_s, value = samples.speed_m_s, samples.value
    slope, note = paper_slope, ONE_SPEED
    if samples.several_speeds:
        slope, note = float(np.polyfit(speed_m_s, value, 1)[0]), ""
        if slope < flattest:
            note = f"the slope would be {slope:.3g} s: the paper's"
            slope = paper_slope
    intercept = float(np.mean(value - slope * speed_m_s))
    if intercept < lowest:
        note = f"the intercept would be {intercept:.3g} m: {lowest:g} m, and the slope to it"
        intercept = lowest
        slope = float(speed_m_s @ (value - lowest) / (speed_m_s @ speed_m_s))
    left_over = value - (slope * speed_m_s + intercept)
    about_mean = value - value.mean()
    several = samples.several_speeds and about_mean.any()
    r2 = 1 - left_over @ left_over / (about_mean @ about_mean) if several else np.nan
    return _Line(slope, intercept, float(r2), note)


def _regression(quantity: str, fields: dict[str, float], samples: _Samples, line: _Line) -> Fit:
    return Fit(quantity, fields, len(samples.value), line.r2, line.note)


def _too_few(walks: Sequence[WalkMeasures], quantity: str, samples: _Samples) -> Fit:
    if len(samples.value):
        return Fit(quantity, note=f"{len(samples.value)} step; {FEWEST_STEPS} are needed")
    return Fit(quantity, note=_why(walks, quantity))


def _why(walks: Sequence[WalkMeasures], quantity: str) -> str:
    return "; ".join(dict.fromkeys(walk.missing.get(quantity, "") for walk in walks))


def _mean_or_zero(values: np.ndarray) -> float:
    return float(values.mean()) if len(values) else 0.0
