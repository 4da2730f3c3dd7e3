"""The picture of a body's walk: from the side and from above, with the margin of its balance."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from saddlewalk.emulation.wearer import Push
from saddlewalk.physics.poses import Pose, side_view
from saddlewalk.physics.wearer import PhysicalWearer
from saddlewalk.pictures import walk as pictures

APART_S = 0.32  # between two poses of the strip
TRUNK = "0.45"
HEIGHTS_M = (-0.35, 1.95)
BALANCE_SHARE, LEVEL_SHARE = 0.7, 0.5  # of the figure, in its metres


def draw_strip(csv_path: Path, png_path: Path, wearer: PhysicalWearer, config: Any) -> None:
    """About the first push. csv_path: walk.csv; the wearer has recorded its poses."""
    fell_s = wearer.fell_at_s if wearer.fallen else None
    walk = pictures.until_fall(pictures.read_walk(csv_path), fell_s)
    shown = pictures.shown(walk["t_s"], wearer.pushes, fell_s)
    closely = {name: column[shown] for name, column in walk.items()}
    from_s, to_s = closely["t_s"][[0, -1]]
    seen_rad = pictures.heading_of(closely)
    closely = pictures.seen_in(seen_rad, closely)
    poses = [pose.seen_in(seen_rad) for pose in wearer.poses or () if from_s <= pose.time_s <= to_s]
    figure = Figure(figsize=(13, 10), dpi=110, layout="constrained")
    above_m = np.ptp(pictures.lateral_limits(closely))
    ratios = (np.ptp(HEIGHTS_M), above_m, BALANCE_SHARE, LEVEL_SHARE)
    side, above, balance, level = figure.subplots(4, 1, height_ratios=ratios)
    figure.suptitle(f"The body {wearer.plant.body.name}, moved by MuJoCo, walks by the plan")
    _draw_side(side, wearer.plant.model, poses, wearer.pushes)
    pictures.draw_above(above, closely, wearer.pushes, config)
    side.set_xlim(above.get_xlim())
    pictures.draw_balance(balance, closely["t_s"], closely["margin"], closely["caution_below"])
    pictures.draw_level(level, closely)
    level.set(xlabel="time (s)")
    for axes in (balance, level):
        pictures.mark(axes, wearer.pushes, fell_s)
    balance.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    figure.savefig(png_path)


def _draw_side(axes: Axes, model: Any, poses: Sequence[Pose], pushes: Sequence[Push]) -> None:
    colours = {**dict(pictures.FEET), "": TRUNK}
    next_s = poses[0].time_s if poses else 0.0
    for pose in poses:
        if pose.time_s < next_s - 1e-9:
            continue
        next_s += APART_S
        for outline in side_view(model, pose):
            colour = colours[outline.side]
            axes.add_patch(Polygon(outline.points_m, fc=colour, ec="white", alpha=0.6, lw=0.4))
        pushed = any(0 <= pose.time_s - push.time_s < APART_S for push in pushes)
        words = f"{pose.time_s:.1f} s" + ("\npushed" if pushed else "")
        axes.text(
            float(pose.qpos[0]),
            -0.08,
            words,
            ha="center",
            va="top",
            size="x-small",
            color=pictures.PINK if pushed else "black",
        )
    axes.axhline(0, color="0.3", lw=1.0)
    axes.set_aspect("equal")
    axes.set(ylabel="height (m)", ylim=HEIGHTS_M)
