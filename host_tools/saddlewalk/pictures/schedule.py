"""The picture of a walk by a schedule: speed, steps from above, height of the CoM, turning rate."""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from saddlewalk.atomic_write import atomic_file
from saddlewalk.contract import MODES
from saddlewalk.pictures.walk import BLUE, FEET, FOOT_M, ORANGE, PINK, SKY
from saddlewalk.planning.ground import place_of, yaws_of
from saddlewalk.planning.schedule import Instant, SpeedChange

MODE_COLOURS = {"standing": "0.6", "starting": PINK, "walking": SKY, "stopping": ORANGE}
SHADE = 0.16
LATERAL_M = 0.26  # shown to each side


def draw_schedule(path: str, changes: Sequence[SpeedChange], walked: Sequence[Instant]) -> None:
    """Draw to a file whose suffix names the format; PNG without a suffix."""
    time_s = np.array([instant.t_s for instant in walked])
    com_m = np.array([_com_m(instant) for instant in walked])
    turns = any(instant.output.plan.heading_rad != 0 for instant in walked)
    ratios = (1.0, _height(com_m), 1.0, 1.0) if turns else (1.0, 1.25, 1.0)
    figure = Figure(figsize=(12, 8 / 3.25 * sum(ratios)), dpi=100, layout="constrained")
    speed, above, height, *turning = figure.subplots(len(ratios), 1, height_ratios=ratios)
    figure.suptitle("A planned walk: start, change of speed, stop")
    _draw_speed(speed, changes, walked, time_s)
    _draw_above(above, walked, com_m, turns)
    height.plot(time_s, com_m[:, 2], color=BLUE, lw=1.6)
    height.set(ylabel="height of\nthe CoM (m)", xlabel="time (s)")
    for axes in turning:
        _draw_turning(axes, changes, walked, time_s)
    for axes in (speed, height, *turning):
        _shade(axes, walked, time_s)
    if not turns:
        _shade(above, walked, com_m[:, 0])
    _label_modes(speed, walked, time_s)
    with atomic_file("--picture", path, "wb") as file:
        figure.savefig(file, format=Path(path).suffix.lower().removeprefix(".") or "png")


def _height(com_m: np.ndarray) -> float:
    """Of a view from above that is to scale: of the figure's shares."""
    along_m, across_m = np.ptp(com_m[:, :2], axis=0) + 0.5
    return float(min(max(1.0, 4.3 * across_m / along_m), 4.0))


def _com_m(instant: Instant) -> tuple[float, float, float]:
    plan = instant.output.plan
    return *place_of(plan, plan.com_m), plan.com_m.z


def _draw_speed(
    axes: Axes, changes: Sequence[SpeedChange], walked: Sequence[Instant], time_s: np.ndarray
) -> None:
    starts_s = [wish.from_s for wish in changes] + [max(time_s[-1], changes[-1].from_s)]
    speeds_m_s = [wish.speed_m_s for wish in changes]
    axes.stairs(speeds_m_s, starts_s, baseline=None, color="black", ls="--", label="wanted")
    planned_m_s = [instant.output.plan.speed_m_s for instant in walked]
    axes.plot(time_s, planned_m_s, color=BLUE, lw=2, label="planned")
    for name, colour in FEET:
        strikes_s = [
            event.t_s
            for instant in walked
            for event in instant.events
            if event.name == f"heel_strike_{name}"
        ]
        axes.plot(strikes_s, [0] * len(strikes_s), "^", color=colour, ms=6, label=f"{name} heel")
    axes.set(ylabel="speed (m/s)")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def _draw_turning(
    axes: Axes, changes: Sequence[SpeedChange], walked: Sequence[Instant], time_s: np.ndarray
) -> None:
    starts_s = [wish.from_s for wish in changes] + [max(time_s[-1], changes[-1].from_s)]
    rates = [wish.turn_rad_s for wish in changes]
    axes.stairs(rates, starts_s, baseline=None, color="black", ls="--", label="wanted")
    plans = [instant.output.plan for instant in walked]
    planned = [plan.curvature_1_m[1] * plan.speed_m_s for plan in plans]
    axes.plot(time_s, planned, color=BLUE, lw=2, label="planned")
    axes.set(ylabel="turning rate,\nto the left (rad/s)", xlabel="time (s)")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def _draw_above(axes: Axes, walked: Sequence[Instant], com_m: np.ndarray, turns: bool) -> None:
    """A walk straight on is long and narrow, and not to scale."""
    for index, (name, colour) in enumerate(FEET):
        for x_m, y_m, yaw_rad in _footholds(walked, index):
            angle = math.degrees(yaw_rad)
            foot = Ellipse((x_m, y_m), *FOOT_M, angle=angle, color=colour, alpha=0.55, lw=0)
            axes.add_patch(foot)
        axes.plot([], [], "o", color=colour, alpha=0.55, ms=9, label=f"{name} foot")
    axes.plot(com_m[:, 0], com_m[:, 1], color=BLUE, lw=1.8, label="CoM")
    axes.set(xlabel="forward (m)", ylabel="to the left (m)" + ("" if turns else ",\nenlarged"))
    if turns:
        axes.set_aspect("equal")
        axes.grid(alpha=0.25)
    else:
        axes.set_ylim(-LATERAL_M, LATERAL_M)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def _footholds(walked: Sequence[Instant], index: int) -> set[tuple[float, ...]]:
    """Places and headings of the feet that stand, rounded to millimetres and mrad."""
    places = set()
    for instant in walked:
        plan = instant.output.plan
        if plan.step_length_m == 0 or plan.support == index:
            foot = (*place_of(plan, plan.foot_m[index]), yaws_of(plan)[index])
            places.add(tuple(round(number, 3) for number in foot))
    return places


def _spans(walked: Sequence[Instant], along: np.ndarray) -> Iterator[tuple[str, float, float]]:
    """(mode, from, to) of each stretch of one mode."""
    stretches = [
        (mode, next(group)[0])
        for mode, group in groupby(
            enumerate(walked), key=lambda pair: MODES[pair[1].output.plan.mode]
        )
    ]
    for (mode, start), (_, end) in pairwise([*stretches, ("", len(walked) - 1)]):
        yield mode, along[start], along[end]


def _shade(axes: Axes, walked: Sequence[Instant], along: np.ndarray) -> None:
    for mode, start, end in _spans(walked, along):
        axes.axvspan(start, end, color=MODE_COLOURS[mode], alpha=SHADE, lw=0, zorder=0)
    axes.margins(x=0.01)
    axes.grid(alpha=0.25)


def _label_modes(axes: Axes, walked: Sequence[Instant], time_s: np.ndarray) -> None:
    for mode, start_s, end_s in _spans(walked, time_s):
        place = ((start_s + end_s) / 2, 1.02)
        transform = axes.get_xaxis_transform()
        axes.text(*place, mode, transform=transform, ha="center", va="bottom", fontsize=9)
