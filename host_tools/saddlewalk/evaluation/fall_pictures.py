"""Pictures of recorded falls: ROC curves, and single walks with the supervisor's output."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from saddlewalk.contract import LEVELS
from saddlewalk.evaluation.recorded_falls import Scored
from saddlewalk.evaluation.scoring import (
    MARGINS,
    TIMELY_S,
    WINDOWS,
    Score,
    Walk,
    area,
    evidence,
    roc,
)
from saddlewalk.pictures.walk import (
    BLUE,
    FEET,
    GREEN,
    LANES,
    MARGIN_SHOWN_M,
    ORANGE,
    PINK,
    RED,
    SKY,
    draw_arrow,
    draw_level,
)
from saddlewalk.verdict import reason_name

matplotlib.use("Agg")

COLOURS = ("black", BLUE, SKY, GREEN, ORANGE, RED, PINK, "0.5")
DASHES = ("-", "--")
WORDS = {  # of the margins
    "level": "announced level",
    "ebos_xcom": "XCoM in E-BoS",
    "ebos_com": "CoM in E-BoS",
    "mos_xcom": "XCoM in BoS",
    "mos_com": "CoM in BoS",
    "excess_stop": "energy to stop",
    "excess_track": "energy to the plan",
    "s_sw": "S_SW",
    "hull_com": "CoM in the feet's hull",
    "hof_xcom": "Hof's margin",
}
BEFORE_S, AFTER_S, FALLEN_S = 0.8, 2.4, 0.3  # shown before the push and after a fall
FALL_HEIGHT = 0.75  # share of the usual height
MARGIN_STYLES: dict[str, dict[str, Any]] = {
    "margin": {"color": "black", "lw": 2.6, "label": "margin, of the height"},
    "recovery_margin": {"color": ORANGE, "ls": "--"},
    "ebos_xcom": {"color": SKY},
    "mos_xcom": {"color": BLUE, "ls": ":"},
    "mos_com": {"color": GREEN, "ls": "-."},
}
LEVEL_COLOURS = {name: style.get("color", style.get("facecolor")) for name, style in LANES.items()}


def draw_rocs(walkers: Mapping[str, Sequence[Score]], path: Path) -> None:
    """ROC curves: a row for each walker, a column for each window of evidence."""
    figure = Figure(figsize=(9 * len(WINDOWS), 6 * len(walkers)), dpi=90, layout="constrained")
    rows = figure.subplots(len(walkers), len(WINDOWS), squeeze=False)
    for row, (walker, scores) in zip(rows, walkers.items(), strict=True):
        pushed = [each for each in scores if each.pushed]
        for axes, (window, longest_s) in zip(row, WINDOWS.items(), strict=True):
            for index, name in enumerate(MARGINS):
                found = evidence(pushed, window, name)
                false, true = (np.append(rates, 1.0) for rates in roc(*found))
                style = {"color": COLOURS[index % 8], "ls": DASHES[index // 8]}
                label = f"{area(*found):.3f}  {WORDS.get(name, name.replace('_', ' '))}"
                axes.plot(false, true, label=label, **style)
            axes.plot([0, 1], [0, 1], color="0.8", lw=0.8)
            axes.set(
                title=f"{walker}: {longest_s:g} s from the push, to 0.24 s before the fall",
                xlabel="alarms in walks without a fall",
                ylabel="falls announced",
                aspect="equal",
            )
            _legend_by_area(axes)
    figure.savefig(path)


def _legend_by_area(axes: Axes) -> None:
    """The best first, beside the curves: they fill the whole panel."""
    handles, labels = axes.get_legend_handles_labels()
    best_first = sorted(zip(labels, handles, strict=True), key=lambda each: each[0], reverse=True)
    axes.legend(
        [handle for _, handle in best_first],
        [label for label, _ in best_first],
        loc="center left",
        bbox_to_anchor=(1.0, 0.5),
        frameon=False,
        title="area under the curve",
        fontsize=11,
    )


def worst_misses(walks: Sequence[Scored]) -> list[Scored]:
    """Falls without a timely alarm, the worst first: without any alarm, then by lead time."""
    late = [each for each in walks if _is_late(each.scores["exact"])]
    return sorted(late, key=lambda each: np.nan_to_num(each.scores["exact"].lead_s, nan=-1))


def _is_late(score: Score) -> bool:
    return score.pushed and score.fell and not score.lead_s >= TIMELY_S


def worst_false_alarms(walks: Sequence[Scored]) -> list[Scored]:
    """Walks with an alarm but no fall, the longest alarms first."""

    def unstable_ticks(each: Scored) -> int:
        return sum(each.scores["exact"].exposed["unstable"].values())

    upright = [each for each in walks if each.scores["exact"].stumble]
    return sorted(upright, key=unstable_ticks, reverse=True)


def draw_walk(scored: Scored, path: Path) -> None:
    """Draw the time around the push: from above, height, margins, and level with reason."""
    walk, announced = scored.walk, scored.exact
    t_s = walk.states.t_s
    end_s = min(walk.push_s + AFTER_S, walk.fall_s + FALLEN_S if walk.fell else np.inf)
    shown = np.flatnonzero((t_s >= walk.push_s - BEFORE_S) & (t_s <= end_s))
    figure = Figure(figsize=(12, 13), dpi=90, layout="constrained")
    figure.suptitle(title_of(scored))
    above, height, margins, level = figure.subplots(4, 1, height_ratios=(2.2, 0.7, 1.2, 1.5))
    _draw_above(above, scored, shown)
    height.plot(t_s[shown], walk.states.com_m[shown, 2], "-o", color=BLUE, ms=3)
    height.axhline(FALL_HEIGHT * walk.pendulum_m, color="0.4", ls=":", lw=1)
    height.set(ylabel="height of\nthe CoM (m)")
    for name, style in MARGIN_STYLES.items():
        if name in announced.margins:
            line = {"label": WORDS.get(name, name.replace("_", " ")), "marker": "."} | style
            margins.plot(t_s[shown], announced.margins[name][shown], **line)
    margins.axhline(0, color="0.4", lw=0.8)
    margins.set(ylabel="margins (m)")
    margins.set_ylim(bottom=max(margins.get_ylim()[0], MARGIN_SHOWN_M))
    margins.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    draw_level(level, {"t_s": t_s[shown], "level": announced.level[shown]})
    _name_reasons(level, t_s[shown], announced.level[shown], announced.reason[shown])
    level.set(xlabel="time (s)")
    for axes in (height, margins, level):
        axes.set_xlim(t_s[shown[0]], t_s[shown[-1]])
        _mark(axes, walk)
    figure.savefig(path)


def title_of(scored: Scored) -> str:
    walk, score = scored.walk, scored.scores["exact"]
    alarm = f"alarm {score.alarm_s - walk.push_s:.2f} s later" if score.alarmed else "no alarm"
    fate = f"fall {walk.fall_s - walk.push_s:.2f} s later" if walk.fell else "no fall"
    return f"{walk.name} ({walk.kind}), push of {abs(walk.push_n_s):.3g} N·s: {alarm}, {fate}"


def _draw_above(axes: Axes, scored: Scored, shown: np.ndarray) -> None:
    walk, states = scored.walk, scored.walk.states
    for side, (name, colour) in enumerate(FEET):
        standing = shown[states.contact[shown, side]]
        for corner in states.feet_m[standing, side] - walk.half_sole_m:
            axes.add_patch(Rectangle(corner, *(2 * walk.half_sole_m), color=colour, alpha=0.15))
        axes.plot([], [], "s", color=colour, alpha=0.5, ms=9, label=f"{name} sole")
    com_m, xcom_m = states.com_m[shown, :2], walk.xcom_m(states)[shown]
    axes.plot(*xcom_m.T, color="0.3", ls="--", lw=1, label="XCoM")
    axes.plot(*com_m.T, color=BLUE, lw=1, label="CoM")
    for level, name in enumerate(LEVELS):
        there = scored.exact.level[shown] == level
        axes.plot(*com_m[there].T, "o", color=LEVEL_COLOURS[name], ms=6, label=name)
    _draw_push(axes, walk)
    axes.set(xlabel="forward (m)", ylabel="to the left (m)", aspect="equal")
    axes.autoscale_view()
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=8, frameon=False)


def _draw_push(axes: Axes, walk: Walk) -> None:
    if walk.push_n_s == 0:
        return
    index = np.flatnonzero(walk.states.t_s >= walk.push_s)[0]
    at = complex(*walk.states.com_m[index, :2])
    tail = at - 0.3 * walk.push_n_s / abs(walk.push_n_s)
    draw_arrow(axes, "push", tail, at)


def _name_reasons(axes: Axes, t_s: np.ndarray, level: np.ndarray, reason: np.ndarray) -> None:
    """Write level and reason above the lanes where either changes."""
    top = len(LANES) - 0.4
    changed = np.flatnonzero(np.diff(level, prepend=-1) | np.diff(reason, prepend=-1))
    for k in changed:
        text = (
            f"{LEVELS[level[k]]}: {reason_name(int(reason[k]))}" if reason[k] else LEVELS[level[k]]
        )
        axes.text(t_s[k], top, text, rotation=90, va="bottom", ha="left", fontsize=8)
    axes.set_ylim(-0.5, len(LANES) + 3.2)


def _mark(axes: Axes, walk: Walk) -> None:
    axes.axvline(walk.push_s, color=PINK, lw=2.5, zorder=1)
    if walk.fell:
        axes.axvline(walk.fall_s, color="black", lw=2.5, zorder=1)
    axes.grid(alpha=0.25)
