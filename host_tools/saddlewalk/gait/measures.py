"""Measures of a recorded walk, step by step, for fitting the gait model."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.gait.events import (
    FootEvents,
    Gait,
    Placement,
    foot_events,
    mean_speed,
    passing,
    placements,
    step_pairs,
)
from saddlewalk.gait.recording import Recording
from saddlewalk.gait.steadiness import unsteady
from saddlewalk.gait.step_curves import LONGEST_STEP_S, StepCurve, step_curves

# Range of means in walking people, from a child of two to the tallest adult.
HUMAN = {
    "walking speed": (0.1, 3.0, "m/s"),
    "step length": (0.1, 1.3, "m"),
    "step width": (0.02, 0.5, "m"),
    "vertical amplitude": (0.002, 0.15, "m"),
    "lateral amplitude": (0.001, 0.15, "m"),
    "CoM height": (0.35, 1.4, "m"),
    "half foot length": (0.03, 0.15, "m"),
}
ONE_POINT_M = 0.01
HEEL_HEIGHT_M = (-0.03, 0.15)  # of a heel marker while the foot lies flat


@dataclass(frozen=True)
class WalkMeasures:
    """Measures of one recording. Arrays have one value per step; empty: not measured."""

    source: str
    speed_m_s: float
    foot: np.ndarray  # that made the step: 0 left, 1 right
    length_m: np.ndarray  # between placements
    width_m: np.ndarray  # between placements, left minus right
    vertical_m: np.ndarray  # peak to peak from heel strike to heel strike
    lateral_m: np.ndarray  # amplitude of the sway in the plan's phase
    com_top_m: np.ndarray  # greatest height
    half_foot_m: (
        np.ndarray
    )  # one per placement: half the distance from heel to middle of the metatarsus
    missing: dict[str, str]  # quantity -> why it could not be measured
    curves: list[StepCurve]  # steps from passing one foot to passing the next

    def compared(self) -> "WalkMeasures":
        """With the lengths of the steps of `curves` alone."""
        return replace(
            self,
            foot=np.array([1 - curve.side for curve in self.curves], dtype=int),
            length_m=np.array([curve.landing_m for curve in self.curves]),
        )

    def halves(self) -> "list[WalkMeasures]":
        """The first and the second half of the steps, at the speed of the whole walk. What was
        measured once belongs to both."""
        split: dict[str, Any] = {
            name: (values[: max(1, len(values) // 2)], values[len(values) // 2 :])
            for name, values in vars(self).items()
            if isinstance(values, np.ndarray | list)
        }
        return [
            replace(
                self,
                source=f"{self.source}, {which} half",
                **{name: values[index] for name, values in split.items()},
            )
            for index, which in enumerate(("first", "second"))
        ]


def measure(recording: Recording) -> WalkMeasures:
    """Raises UserError if it is not a walk, or if a mean is impossible for humans."""
    events = (foot_events(recording, 0), foot_events(recording, 1))
    placed = placements(recording)
    pairs = step_pairs(placed)
    runs = _strikes_in_turn(recording, events)
    spans = [run[i : i + 2] for run in runs for i in range(len(run) - 1)]
    heights_m = [recording.com_m[first : end + 1, 2] for first, end in spans]
    high_m = [z_m for z_m in heights_m if np.isfinite(z_m).all()]
    curves = step_curves(recording, events)
    tops_m = [z_m.max() for z_m in high_m or _heights_m(curves)]
    sways_m, no_sway = _sways(recording, placed)
    grounded = _heels_on_ground(recording, placed)
    measures = WalkMeasures(
        source=recording.source,
        speed_m_s=mean_speed(recording, events),
        foot=np.array([to.side for _, to in pairs], dtype=int),
        length_m=np.array([to.cop_m[0] - stance.cop_m[0] for stance, to in pairs]),
        width_m=np.array([_width_m(stance, to) for stance, to in pairs]),
        vertical_m=np.array([np.ptp(z_m) for z_m in high_m]),
        lateral_m=sways_m,
        com_top_m=np.array(tops_m if grounded else []),
        half_foot_m=_half_foot_m(recording, placed),
        missing=_missing(recording, bool(pairs), bool(high_m), bool(tops_m), grounded) | no_sway,
        curves=curves,
    )
    _reject_implausible(measures, unsteady(recording, events, placed))
    return measures


def check_human_range(source: str, quantity: str, value: float) -> None:
    """Raise UserError for a value that is impossible for human gait."""
    problem = out_of_range(quantity, value)
    if problem:
        raise UserError(f"{source}: {problem}")


def out_of_range(quantity: str, value: float) -> str:
    """The message for a value that is impossible for human gait; empty for a possible one."""
    low, high, unit = HUMAN[quantity]
    if low <= value <= high:
        return ""
    if quantity == "step width" and low <= -value <= high:
        return (
            f"step width {value:.4g} m: left and right seem swapped; exchange the names of the "
            "feet, or the sign of y, which points to the left"
        )
    return f"{quantity} {value:.4g} {unit} is not a person's: {low:g} to {high:g} {unit}"


def implausible(recording: Recording, gait: Gait) -> list[str]:
    """A warning for each value that is impossible for human gait, usually due to a wrong unit."""
    means = (
        ("walking speed", gait.speed_m_s),
        ("step length", gait.step_length_m),
        ("step width", gait.step_width_m),
    )
    problems = [out_of_range(quantity, value) for quantity, value in means if not np.isnan(value)]
    return [
        f"{recording.source}: {text}; t in s, markers in m, x forward, y to the left?"
        for text in problems
        if text
    ]


def _reject_implausible(measures: WalkMeasures, reasons: list[str]) -> None:
    """An impossible speed usually comes from a wrong unit, and affects all other values."""
    if np.isnan(measures.speed_m_s):
        raise UserError(f"{measures.source}: no walk: fewer than two heel strikes along +x")
    speed = out_of_range("walking speed", measures.speed_m_s)
    if speed and (not reasons or abs(measures.speed_m_s) > HUMAN["walking speed"][1]):
        raise UserError(f"{measures.source}: {speed}")
    if reasons:
        problems = "; ".join([speed] * bool(speed) + reasons)
        raise UserError(f"{measures.source}: not one steady straight walk: {problems}")
    for quantity, values in (
        ("step length", measures.length_m),
        ("step width", measures.width_m),
        ("vertical amplitude", measures.vertical_m),
        ("lateral amplitude", measures.lateral_m),
        ("CoM height", measures.com_top_m),
        ("half foot length", measures.half_foot_m),
    ):
        if len(values):
            check_human_range(measures.source, quantity, float(np.mean(values)))


def _missing(
    recording: Recording, placed: bool, struck: bool, high: bool, grounded: bool
) -> dict[str, str]:
    """Quantity -> why it is missing, except for the sway."""
    step = "no step from heel strike to heel strike with the CoM visible throughout"
    flat = "no two successive feet lay flat"
    off_ground = "the heels do not stand at z = 0"
    toes = "one or both toes were never visible" if not _both_seen(recording.toe_m) else None
    reasons = {
        "step length": None if placed else toes or flat,
        "step width": None if placed else toes or flat,
        "vertical amplitude": None if struck else step,
        "CoM height": step if not high else None if grounded else toes or off_ground,
        "half foot length": toes or _one_point(recording),
    }
    return {quantity: reason for quantity, reason in reasons.items() if reason is not None}


def _both_seen(points_m: np.ndarray) -> bool:
    return bool(np.isfinite(points_m).any(axis=(1, 2)).all())


def _one_point(recording: Recording) -> str | None:
    apart_m = np.linalg.norm(recording.toe_m - recording.heel_m, axis=2)
    apart_m = apart_m[np.isfinite(apart_m)]
    if not len(apart_m):
        return "heel and toe are never visible together"
    return "heel and toe are one point" if np.median(apart_m) < ONE_POINT_M else None


def _heights_m(curves: list[StepCurve]) -> list[np.ndarray]:
    return [curve.com_z_m for curve in curves if np.isfinite(curve.com_z_m).all()]


def _strikes_in_turn(
    recording: Recording, events: tuple[FootEvents, FootEvents]
) -> list[list[int]]:
    """Samples of alternating heel strikes; a new run begins where one was missed."""
    runs: list[list[int]] = []
    last = None
    strikes = [(int(i), side) for side in (0, 1) for i in events[side].heel_strikes]
    for index, side in sorted(strikes):
        if last is None or last == side or _longer(recording, runs[-1][-1], index):
            runs.append([])
        runs[-1].append(index)
        last = side
    return runs


def _longer(recording: Recording, first: int, end: int) -> bool:
    return bool(recording.time_s[end] - recording.time_s[first] > LONGEST_STEP_S)


def _width_m(stance: Placement, to: Placement) -> float:
    return (stance.cop_m[1] - to.cop_m[1]) * (1 if stance.side == 0 else -1)


def _sways(recording: Recording, placed: list[Placement]) -> tuple[np.ndarray, dict[str, str]]:
    """The sway of each stride, from passing a foot to passing it again, or why there is none.

    Least squares in the plan's phase: people sway farthest up to a tenth of a stride before or
    after they pass the foot, which the plan does not.
    """
    sways_m = []
    for stance, other, again in zip(placed, placed[1:], placed[2:], strict=False):
        passed, passed_again = passing(recording, stance), passing(recording, again)
        if stance.side == other.side or stance.side != again.side or not passed or not passed_again:
            continue
        (first, start_s), (end, end_s) = passed, passed_again
        y_m = recording.com_m[first:end, 1]
        if 0 < end_s - start_s <= 2 * LONGEST_STEP_S and np.isfinite(y_m).all():
            share = (recording.time_s[first:end] - start_s) / (end_s - start_s)
            sways_m.append(_cosine_m(share, y_m) * (1 if stance.side == 0 else -1))
    if not sways_m:
        why = "no stride from passing a foot to passing it again with the CoM visible throughout"
    elif np.mean(sways_m) < HUMAN["lateral amplitude"][0]:
        why = "the CoM is not nearest to the foot when it passes it"
    else:
        return np.array(sways_m), {}
    return np.array([]), {"lateral amplitude": why}


def _cosine_m(share: np.ndarray, y_m: np.ndarray) -> float:
    """Amplitude of the cosine over one period, without drift (the part that is odd about the
    middle).
    """
    shapes = np.stack([np.cos(2 * np.pi * share), np.ones_like(share)], axis=1)
    return float(np.linalg.lstsq(shapes, y_m)[0][0])


def _heels_on_ground(recording: Recording, placed: list[Placement]) -> bool:
    heights_m = [recording.heel_m[p.side, p.first : p.end, 2] for p in placed]
    if not heights_m or not np.isfinite(np.concatenate(heights_m)).any():
        return False
    low, high = HEEL_HEIGHT_M
    return bool(low <= np.nanmedian(np.concatenate(heights_m)) <= high)


def _half_foot_m(recording: Recording, placed: list[Placement]) -> np.ndarray:
    if not _both_seen(recording.toe_m) or _one_point(recording):
        return np.array([])
    feet_m = [
        recording.toe_m[p.side, p.first : p.end, :2] - recording.heel_m[p.side, p.first : p.end, :2]
        for p in placed
    ]
    return np.array([np.median(np.linalg.norm(foot_m, axis=1)) / 2 for foot_m in feet_m])
