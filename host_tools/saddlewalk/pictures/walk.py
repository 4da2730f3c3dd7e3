"""The picture of a recorded walk: from above, whole and in detail; speed, height, scores, level.

The detail is seen in the heading that the walk has in its middle.
"""

import cmath
import csv
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Polygon

from saddlewalk.contract import LEVELS, MODES, STANDING, STARTING, STOPPING
from saddlewalk.core import bos_polygon
from saddlewalk.emulation.wearer import Push
from saddlewalk.verdict import REASON_WORDS

matplotlib.use("Agg")

# Okabe and Ito's colours, which colour-blind people can distinguish; line styles differ as well.
BLUE, SKY, GREEN, ORANGE, RED, PINK = "#0072B2 #56B4E9 #009E73 #E69F00 #D55E00 #CC79A7".split()
BEFORE_S, AFTER_S = 1.2, 3.0  # the part shown in detail, around the first push
LYING_S = 0.5  # shown after a fall
FOOT_M = (0.26, 0.09)
BODY = ("com", "left", "right")
MARGIN_SHOWN_M = -0.8  # during a fall it goes far below
FEET = (("left", GREEN), ("right", RED))
MARGINS = (
    ("mos_com_m", "CoM"),
    ("mos_xcom_m", "XCoM"),
    ("ebos_xcom_m", "XCoM at the next\nheel strike"),
)
# From the lowest lane up; alarms have a pattern as well.
LANES: dict[str, dict[str, Any]] = {
    "unknown": {"color": "0.6"},
    "stable": {"color": GREEN},
    "caution": {"facecolor": ORANGE, "hatch": "///"},
    "unstable": {"facecolor": RED, "hatch": "xxx"},
}
# Columns without a meaning for a wearer on the ground.
OF_A_POSTURE = (
    *("s_pend", "s_jump", "s_sw", "level", "margin", "caution_below"),
    *("true_com_vx_m_s", "true_com_z_m"),
    *(name for name, _ in MARGINS),
)
BALANCE_SHOWN = (-0.3, 1.0)
SHADES = {STANDING: "0.85", STARTING: "#DDEEDD", STOPPING: "#F6E3D5"}

Columns = dict[str, np.ndarray]


def read_walk(path: Path) -> Columns:
    """The numbers of walk.csv by column: NaN where a cell is empty, names by their number; and the
    driver of the margin by its name."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    codes = {"left": "0", "right": "1"} | {
        name: str(number) for names in (MODES, LEVELS) for number, name in enumerate(names)
    }
    columns = {
        name: np.array([float(codes.get(row[name], row[name]) or "nan") for row in rows])
        for name in rows[0]
        if name not in ("reason", "driver", "faults", "limits")
    }
    return columns | {"driver": np.array([row["driver"] for row in rows])}


def seen_in(heading_rad: float, walk: Columns) -> Columns:
    """The walk in axes of that heading, about the same origin."""
    turned = dict(walk)
    to_heading = cmath.rect(1.0, -heading_rad)
    for point in (f"{whose}_{part}" for whose in ("plan", "true") for part in BODY):
        x, y = f"{point}_x_m", f"{point}_y_m"
        places = (walk[x] + 1j * walk[y]) * to_heading
        turned |= {x: places.real, y: places.imag}
    yaws = [name for name in walk if name.endswith("_yaw_rad")]
    return turned | {name: walk[name] - heading_rad for name in yaws}


def heading_of(walk: Columns) -> float:
    """In the middle."""
    return float(walk["true_pelvis_yaw_rad"][len(walk["t_s"]) // 2])


def until_fall(walk: Columns, fell_s: float | None) -> Columns:
    """The walk without numbers that have no meaning after a fall."""
    if fell_s is None:
        return walk
    upright = walk["t_s"] <= fell_s
    return walk | {name: np.where(upright, walk[name], np.nan) for name in OF_A_POSTURE}


def draw_walk(
    csv_path: Path,
    png_path: Path,
    pushes: Sequence[Push],
    config: Any,
    fell_s: float | None = None,
) -> None:
    """Draw walk.csv, which may be incomplete. config: the walker's saddle_config_t."""
    figure_of(read_walk(csv_path), pushes, config, fell_s).savefig(png_path)


def figure_of(
    walk: Columns, pushes: Sequence[Push], config: Any, fell_s: float | None = None
) -> Figure:
    walk = until_fall(walk, fell_s)
    there = shown(walk["t_s"], pushes, fell_s)
    closely = {name: column[there] for name, column in walk.items()}
    seen_rad = heading_of(closely)
    closely = seen_in(seen_rad, closely)
    ratios = (1.0, 0.6, _height(walk, 0.6), _height(closely, 1.7), 0.8, 0.8, 0.9, 0.9)
    figure = Figure(figsize=(13, 15 / 7.3 * sum(ratios)), dpi=110, layout="constrained")
    balance, level, whole, above, speed, height, scores, margins = figure.subplots(
        8, 1, height_ratios=ratios
    )
    fate = "" if fell_s is None else f" and falls at {fell_s:.2f} s"
    figure.suptitle(f"A walk: the plan, and the wearer who follows it{fate}")
    draw_balance(balance, walk["t_s"], walk["margin"], walk["caution_below"])
    _name_lowest(balance, walk)
    draw_level(level, walk)
    mark(level, pushes, fell_s)
    _draw_whole(whole, walk, there)
    draw_above(above, closely, pushes, config)
    if fell_s is not None:
        _draw_fall(whole, walk)
        _draw_fall(above, seen_in(seen_rad, walk))
    walk |= {"forward_m_s": _forward_m_s(walk)}
    _draw_lines(speed, walk, (("forward_m_s", "true"), ("plan_speed_m_s", "planned")), modes=True)
    speed.set(ylabel="speed (m/s)")
    _draw_height(height, closely)
    _draw_lines(scores, walk, (("s_pend", "S_pend"), ("s_jump", "S_jump"), ("s_sw", "S_SW")))
    scores.set(ylabel="stability score\n(1 reference, 0 limit)", ylim=(-0.5, 1.6))
    _draw_lines(margins, walk, MARGINS)
    margins.set(ylabel="margin in the base\nof support (m)", xlabel="time (s)")
    margins.set_ylim(bottom=max(margins.get_ylim()[0], MARGIN_SHOWN_M))
    for axes in (balance, speed, height, scores, margins):
        mark(axes, pushes, fell_s)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    return figure


def _height(walk: Columns, least: float) -> float:
    """Of a view from above, in which a metre is as long across as along: of the figure's shares."""
    return min(max(least, 5.0 * np.ptp(lateral_limits(walk)) / np.ptp(_forward_limits(walk))), 4.0)


def _forward_limits(walk: Columns) -> tuple[float, float]:
    return walk["true_com_x_m"].min() - 0.3, walk["true_com_x_m"].max() + 0.3


def _forward_m_s(walk: Columns) -> np.ndarray:
    """Speed in the wearer's heading."""
    heading_rad = walk["true_pelvis_yaw_rad"]
    velocity = walk["true_com_vx_m_s"], walk["true_com_vy_m_s"]
    return velocity[0] * np.cos(heading_rad) + velocity[1] * np.sin(heading_rad)


def _footprint(colour: str) -> dict[str, Any]:
    return {"color": colour, "alpha": 0.55, "lw": 0}


def _draw_whole(axes: Axes, walk: Columns, there: np.ndarray) -> None:
    """The whole walk from above, with the part that is shown in detail marked."""
    for side, colour in FEET:
        _draw_stood(axes, walk, "true", side, walk[f"{side}_contact"] > 0, _footprint(colour))
    com_m = walk["true_com_x_m"], walk["true_com_y_m"]
    axes.plot(*com_m, color=BLUE, lw=1.2)
    marker: dict[str, Any] = {"color": "0.9", "solid_capstyle": "butt", "zorder": 0}
    axes.plot(*(column[there] for column in com_m), lw=30, **marker)
    axes.set_aspect("equal")
    axes.set(ylabel="to the left (m)")
    axes.set_xlim(*_forward_limits(walk))
    axes.set_ylim(*lateral_limits(walk))


def shown(time_s: np.ndarray, pushes: Sequence[Push], fell_s: float | None) -> np.ndarray:
    """The time shown in detail: around the first push or the middle, up to a fall."""
    centre_s = pushes[0].time_s if pushes else (time_s[-1] + BEFORE_S - AFTER_S) / 2
    from_s, to_s = centre_s - BEFORE_S, centre_s + AFTER_S
    if fell_s is not None:
        from_s, to_s = min(from_s, fell_s - AFTER_S), max(to_s, fell_s + LYING_S)
    there = (time_s >= from_s) & (time_s <= to_s)
    return there if there.any() else np.ones_like(there)


def draw_above(axes: Axes, walk: Columns, pushes: Sequence[Push], config: Any) -> None:
    """Base of support and footprints, planned and true, and the pushes."""
    for index in range(len(walk["t_s"])):
        bos_m = _bos(walk, index, config)
        axes.add_patch(Polygon(bos_m, color=SKY, alpha=0.10, lw=0))
        axes.add_patch(Polygon(bos_m, fill=False, ec=SKY, alpha=0.35, lw=0.5))
    for index, (side, colour) in enumerate(FEET):
        planned = walk["support"] == index
        _draw_feet(axes, walk, planned, side, colour)
    axes.plot([], [], color=SKY, lw=8, alpha=0.4, label="base of support")
    axes.plot(walk["plan_com_x_m"], walk["plan_com_y_m"], "k--", lw=1.2, label="CoM, planned")
    axes.plot(walk["true_com_x_m"], walk["true_com_y_m"], color=BLUE, lw=2.2, label="CoM")
    for push in pushes:
        if walk["t_s"][0] <= push.time_s <= walk["t_s"][-1]:
            _draw_push(axes, walk, push)
    axes.set_aspect("equal")
    axes.set(xlabel="forward (m)", ylabel="to the left (m)")
    axes.set_xlim(walk["true_com_x_m"].min() - 0.2, walk["true_com_x_m"].max() + 0.2)
    axes.set_ylim(*lateral_limits(walk))
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=6, frameon=False)


def _bos(walk: Columns, index: int, config: Any) -> np.ndarray:
    """Base of support of the true feet, from the C core, in the wearer's heading."""
    ahead = cmath.rect(1.0, walk["true_pelvis_yaw_rad"][index])
    cops = [
        complex(walk[f"true_{side}_x_m"][index], walk[f"true_{side}_y_m"][index]) / ahead
        for side, _ in FEET
    ]
    vertices = [complex(*v) * ahead for v in bos_polygon(config, [(c.real, c.imag) for c in cops])]
    return np.array([(vertex.real, vertex.imag) for vertex in vertices])


def _draw_feet(axes: Axes, walk: Columns, planned: np.ndarray, side: str, colour: str) -> None:
    """Footprints: filled where the foot stood, outlined where it was planned."""
    outline = {"fill": False, "ec": "black", "ls": "--", "lw": 0.8}
    _draw_stood(axes, walk, "true", side, walk[f"{side}_contact"] > 0, _footprint(colour))
    _draw_stood(axes, walk, "plan", side, planned, outline)
    axes.plot([], [], "o", color=colour, alpha=0.55, ms=9, label=f"{side} foot")


def _draw_stood(
    axes: Axes, walk: Columns, whose: str, side: str, there: np.ndarray, style: dict[str, Any]
) -> None:
    names = (f"{whose}_{side}_{name}" for name in ("x_m", "y_m", "yaw_rad"))
    places = np.column_stack([walk[name] for name in names])
    for x_m, y_m, yaw_rad in np.unique(places[there].round(3), axis=0):
        axes.add_patch(Ellipse((x_m, y_m), *FOOT_M, angle=math.degrees(yaw_rad), **style))


def _draw_fall(axes: Axes, walk: Columns) -> None:
    """Mark where the CoM came down."""
    at = walk["true_com_x_m"][-1], walk["true_com_y_m"][-1]
    axes.plot(*at, "X", color="black", ms=11, mec="white", zorder=5)
    axes.annotate("fell", at, (8, 8), textcoords="offset points", weight="bold")


def lateral_limits(walk: Columns) -> tuple[float, float]:
    """Lateral limits with room for the feet and for a CoM that falls away from them."""
    names = ("true_com_y_m", *(f"true_{side}_y_m" for side, _ in FEET))
    lateral = np.concatenate([walk[name] for name in names])
    middle = float(np.median(walk["true_com_y_m"]))
    return min(lateral.min() - 0.15, middle - 0.5), max(lateral.max() + 0.15, middle + 0.5)


def draw_arrow(axes: Axes, text: str, tail: complex, at: complex) -> None:
    """The arrow of a push; complex numbers are x forward + 1j * y to the left."""
    along = abs((at - tail).real) > abs((at - tail).imag)  # the text would hide the walk
    axes.annotate(
        "" if along else text,
        xy=(at.real, at.imag),
        xytext=(tail.real, tail.imag),
        arrowprops={"arrowstyle": "-|>", "color": PINK, "lw": 3},
        color=PINK,
        ha="center",
        va="center",
        weight="bold",
    )
    if along:
        below: dict[str, Any] = {"ha": "center", "va": "center", "weight": "bold", "clip_on": True}
        axes.text(tail.real, tail.imag - 0.3, text, color=PINK, **below)


def _draw_push(axes: Axes, walk: Columns, push: Push) -> None:
    index = int(np.argmin(np.abs(walk["t_s"] - push.time_s)))
    at = complex(walk["true_com_x_m"][index], walk["true_com_y_m"][index])
    ahead = cmath.rect(1.0, walk["true_pelvis_yaw_rad"][index])
    tail = at - 0.4 * ahead * push.vector_n_s / abs(push.vector_n_s)
    draw_arrow(axes, f"push\n{push.impulse_n_s:.3g} N·s", tail, at)


def _draw_height(axes: Axes, walk: Columns) -> None:
    axes.plot(walk["t_s"], walk["plan_com_z_m"], "k--o", ms=3, lw=1.0, label="planned")
    axes.plot(walk["t_s"], walk["true_com_z_m"], "-o", color=BLUE, ms=3, lw=1.6, label="true")
    axes.set(ylabel="height of\nthe CoM (m)")
    axes.set_xlim(walk["t_s"][0], walk["t_s"][-1])


def _draw_lines(
    axes: Axes, walk: Columns, names: Sequence[tuple[str, str]], modes: bool = False
) -> None:
    """Lines over the whole walk, shaded by the plan's modes. modes: label the shades."""
    styles = ((BLUE, "-"), (ORANGE, "--"), (GREEN, "-."))
    for (name, label), (colour, style) in zip(names, styles, strict=False):
        axes.plot(walk["t_s"], walk[name], color=colour, ls=style, lw=1.6, label=label)
    axes.axhline(0, color="0.4", lw=0.8)
    axes.set_xlim(walk["t_s"][0], walk["t_s"][-1])
    for mode, shade in SHADES.items():
        for start_s, end_s in _spans(walk["t_s"], walk["mode"] == mode):
            axes.axvspan(start_s, end_s, color=shade, lw=0, zorder=0)
        if modes:
            axes.fill_between([], [], color=shade, label=MODES[mode])


def draw_balance(
    axes: Axes, time_s: np.ndarray, margin: np.ndarray, caution_below: np.ndarray
) -> None:
    """The margin that decides the level, with the caution band and the unstable region below 0."""
    low, high = BALANCE_SHOWN
    band: dict[str, Any] = {"lw": 0, "zorder": 0}
    axes.fill_between(time_s, 0, caution_below, alpha=0.35, **band, **LANES["caution"])
    axes.axhspan(low, 0, alpha=0.2, **band, **LANES["unstable"])
    axes.plot(time_s, margin, color=BLUE, lw=1.8, label="margin")
    axes.fill_between([], [], label="caution", alpha=0.35, **LANES["caution"])
    axes.fill_between([], [], label="unstable", alpha=0.2, **LANES["unstable"])
    axes.axhline(0, color="0.4", lw=0.8)
    known = margin[np.isfinite(margin)]
    least, most = (known.min(), known.max()) if len(known) else (0.0, high)
    axes.set_ylim(max(min(least - 0.05, -0.1), low), min(most + 0.1, high))
    axes.set(ylabel="margin (share of\nthe CoM's height)")
    axes.set_xlim(time_s[0], time_s[-1])


def _name_lowest(axes: Axes, walk: Columns) -> None:
    """Annotate the lowest margin with its driver."""
    if np.isnan(walk["margin"]).all():
        return
    index = int(np.nanargmin(walk["margin"]))
    at_s, margin = walk["t_s"][index], walk["margin"][index]
    words = REASON_WORDS.get(str(walk["driver"][index]), "")
    axes.plot(at_s, max(margin, axes.get_ylim()[0]), "o", color=BLUE, ms=6)
    axes.set_title(
        f"Lowest margin {margin:.2f} at {at_s:.2f} s: {words}", loc="left", size="medium"
    )


def draw_level(axes: Axes, walk: Columns) -> None:
    """A lane for each level, filled while it was announced."""
    for lane, (name, style) in enumerate(LANES.items()):
        there = walk["level"] == LEVELS.index(name)
        spans = [(start_s, end_s - start_s) for start_s, end_s in _spans(walk["t_s"], there)]
        axes.broken_barh(spans, (lane - 0.4, 0.8), lw=0, **style)
    axes.set(ylabel="level", ylim=(-0.5, len(LANES) - 0.5))
    axes.set_yticks(range(len(LANES)), LANES)
    axes.set_xlim(walk["t_s"][0], walk["t_s"][-1])


def _spans(time_s: np.ndarray, there: np.ndarray) -> list[tuple[float, float]]:
    """Begin and end of each run of True; a run ends where the next sample is."""
    edges = np.flatnonzero(np.diff(there, prepend=False, append=False))
    last = len(time_s) - 1
    return [(time_s[a], time_s[min(b, last)]) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def mark(axes: Axes, pushes: Sequence[Push], fell_s: float | None) -> None:
    """Pushes and a fall, over time."""
    for push in pushes:
        axes.axvline(push.time_s, color=PINK, lw=2.5, zorder=1)
    if fell_s is not None:
        axes.axvline(fell_s, color="black", lw=1.5, ls=":", label="fell")
    axes.grid(alpha=0.25)
