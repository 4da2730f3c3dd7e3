"""The picture of a walk by a schedule: its speed, its steps from above, the height of its CoM."""

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
from saddlewalk.planning.schedule import Instant, SpeedChange

MODE_COLOURS = {"standing": "0.6", "starting": PINK, "walking": SKY, "stopping": ORANGE}
SHADE = 0.16
LATERAL_M = 0.26  # shown to each side


def draw_schedule(path: str, changes: Sequence[SpeedChange], walked: Sequence[Instant]) -> None:
    """Draw to a file whose suffix names the format; PNG without a suffix."""
    figure = Figure(figsize=(12, 8), dpi=100, layout="constrained")
    speed, above, height = figure.subplots(3, 1, height_ratios=(1, 1.25, 1))
    time_s = np.array([instant.t_s for instant in walked])
    com_m = np.array([_com_m(instant) for instant in walked])
    figure.suptitle("A planned walk: start, change of speed, stop")
    _draw_speed(speed, changes, walked, time_s)
    _draw_above(above, walked, com_m)
    height.plot(time_s, com_m[:, 2], color=BLUE, lw=1.6)
    height.set(ylabel="height of\nthe CoM (m)", xlabel="time (s)")
    for axes in (speed, height):
        _shade(axes, walked, time_s)
    _shade(above, walked, com_m[:, 0])
    _label_modes(speed, walked, time_s)
    with atomic_file("--picture", path, "wb") as file:
        figure.savefig(file, format=Path(path).suffix.lower().removeprefix(".") or "png")


def _com_m(instant: Instant) -> tuple[float, float, float]:
    plan = instant.output.plan
    return plan.origin_x_nm * 1e-9 + plan.com_m.x, plan.com_m.y, plan.com_m.z


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


def _draw_above(axes: Axes, walked: Sequence[Instant], com_m: np.ndarray) -> None:
    """Not to scale: the walk is long and narrow."""
    for index, (name, colour) in enumerate(FEET):
        for place in _footholds_m(walked, index):
            axes.add_patch(Ellipse(place, *FOOT_M, color=colour, alpha=0.55, lw=0))
        axes.plot([], [], "o", color=colour, alpha=0.55, ms=9, label=f"{name} foot")
    axes.plot(com_m[:, 0], com_m[:, 1], color=BLUE, lw=1.8, label="CoM")
    axes.set(
        xlabel="forward (m)", ylabel="to the left (m),\nenlarged", ylim=(-LATERAL_M, LATERAL_M)
    )
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def _footholds_m(walked: Sequence[Instant], index: int) -> set[tuple[float, float]]:
    """Footholds, rounded to a millimetre."""
    places = set()
    for instant in walked:
        plan = instant.output.plan
        if plan.step_length_m == 0 or plan.support == index:
            foot = plan.foot_m[index]
            places.add((round(plan.origin_x_nm * 1e-9 + foot.x, 3), round(foot.y, 3)))
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
