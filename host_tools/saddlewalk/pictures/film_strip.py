"""A stride of a recorded walk and its plan over each other, instant by instant, from the side and
from above; before and after calibration."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from saddlewalk.atomic_write import atomic_file
from saddlewalk.errors import UserError
from saddlewalk.gait.followed import Followed
from saddlewalk.gait.measures import WalkMeasures
from saddlewalk.gait.step_curves import StepCurve
from saddlewalk.gait.tracking_error import SteadyPlan
from saddlewalk.pictures.walk import BLUE

FRAMES_A_STEP = 5
RECORDED = "0.35"
HALF_WIDTH_M = 0.72  # shown about the recorded CoM
ASIDE_M = 0.24
HIGH_M = 1.2
AXES = {"from the side": 2, "from above": 1}  # the view's second axis


@dataclass(frozen=True)
class _Instant:
    """CoM, left and right foot, (3, 3) each, in the frame of the foot that was passed last."""

    recorded_m: np.ndarray
    planned_m: np.ndarray


def draw_film_strip(
    path: str, walk: WalkMeasures, followed: Followed, configs: Mapping[str, Any], angle_deg: float
) -> None:
    """Draw a stride to a file whose suffix names the format, PNG without one.

    configs: those of the first and the last of followed.deviations.
    """
    stride = _stride(walk)
    frames = FRAMES_A_STEP * len(stride)
    figure = Figure(figsize=(1.3 * frames, 7), dpi=100, layout="constrained")
    axes = figure.subplots(
        2 * len(configs),
        frames,
        squeeze=False,
        gridspec_kw={"height_ratios": [HIGH_M, 2 * ASIDE_M] * len(configs)},
    )
    for index, (name, config) in enumerate(configs.items()):
        plan = SteadyPlan(config, walk.speed_m_s, angle_deg)
        instants = [one for step in stride for one in _instants(plan, step)]
        for row, view in zip(axes[2 * index : 2 * index + 2], AXES, strict=True):
            for frame, instant in zip(row, instants, strict=True):
                _draw(frame, instant, view)
            row[0].set_ylabel(f"{name},\n{view}")
        numbers = followed.numbers(name)
        axes[2 * index][len(axes[0]) // 2].set_title(
            f"{name}: y {numbers['y_mm']:.0f} mm, z {numbers['z_mm']:.0f} mm, "
            f"swing {numbers['swing_mm']:.0f} mm, heel strike {numbers['strike_ms']:.0f} ms (RMS)"
        )
    figure.suptitle(
        f"{walk.source}, {walk.speed_m_s:.2f} m/s: a stride as recorded (grey) and as planned "
        "(blue); left foot filled"
    )
    with atomic_file("--picture", path, "wb") as file:
        figure.savefig(file, format=Path(path).suffix.lower().removeprefix(".") or "png")


def _stride(walk: WalkMeasures) -> Sequence[StepCurve]:
    """Two steps in a row that were seen all the way, or the one."""
    seen = [np.isfinite(c.com_z_m).all() and np.isfinite(c.foot_m).all() for c in walk.curves]
    for i, (first, then) in enumerate(pairwise(walk.curves)):
        if seen[i] and seen[i + 1] and first.side != then.side:
            return [first, then]
    if any(seen):
        return [walk.curves[seen.index(True)]]
    raise UserError(f"--picture: no step of {walk.source} was seen from foot to foot")


def _instants(plan: SteadyPlan, step: StepCurve) -> list[_Instant]:
    planned = plan.at(step)
    com_m = np.stack([step.com_x_m, step.com_y_m, step.com_z_m])
    frames = np.linspace(0, len(step.elapsed_s) - 1, FRAMES_A_STEP, endpoint=False).astype(int)
    return [
        _Instant(
            recorded_m=np.array([com_m[:, k], *step.foot_m[:, k]]),
            planned_m=np.array([planned.com_m[:, k], *planned.foot_m[:, k]]),
        )
        for k in frames
    ]


def _draw(axes: Axes, instant: _Instant, view: str) -> None:
    second = AXES[view]
    for points_m, colour, width in (
        (instant.recorded_m, RECORDED, 3.0),
        (instant.planned_m, BLUE, 1.4),
    ):
        com, *feet = points_m[:, [0, second]] * (1, 1)
        for foot, filled in zip(feet, (colour, "white"), strict=True):
            axes.plot(*zip(com, foot, strict=True), color=colour, lw=width, solid_capstyle="round")
            axes.plot(*foot, "o", color=colour, mfc=filled, ms=5)
        axes.plot(*com, "o", color=colour, ms=8)
    middle_m = instant.recorded_m[0, 0]
    low, high = (-0.08, HIGH_M) if second == 2 else (-ASIDE_M, ASIDE_M)
    axes.set(xlim=(middle_m - HALF_WIDTH_M, middle_m + HALF_WIDTH_M), ylim=(low, high))
    axes.set(xticks=[], yticks=[])
    axes.axhline(0, color="0.8", lw=0.8, zorder=0)
    for spine in axes.spines.values():
        spine.set_color("0.85")
