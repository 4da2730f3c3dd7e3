"""The paper's figures, drawn from the C core, with recorded people for comparison."""

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from saddlewalk.core import bos_polygon
from saddlewalk.gait.events import Placement, step_pairs
from saddlewalk.paper.numbers import ORENDURFF_M, Simulations
from saddlewalk.paper.people import Trial, step_samples
from saddlewalk.paper.simulations import (
    COARSE_SAMPLES,
    FIGURE_HEEL_STRIKE_DEG,
    HEEL_STRIKES_DEG,
    SPEEDS_M_S,
    Gait,
    Walk,
    gait,
    mean_body,
    simulate,
    simulate_as_the_paper,
)
from saddlewalk.pictures.walk import BLUE, GREEN, ORANGE, PINK, RED, SKY

SPEED_COLOURS = dict(zip(SPEEDS_M_S, (BLUE, GREEN, ORANGE, RED), strict=True))
ANGLE_COLOURS = dict(zip(HEEL_STRIKES_DEG, (SKY, BLUE, PINK), strict=True))
CURVE_SPEEDS_M_S = np.arange(0.3, 1.901, 0.05)
LIMIT_SPEEDS_M_S = np.arange(0.002, 3.301, 0.002)
FIGURE_SPEED_M_S = 1.2  # of the step seen from above, with the person whose speed is nearest


@dataclass(frozen=True)
class Picture:
    """A figure of the paper: its file and its caption."""

    name: str
    caption: str
    png: bytes


def draw_all(simulations: Simulations, trials: Sequence[Trial]) -> list[Picture]:
    curves = _Curves()
    return [
        Picture("steps.png", _STEPS, _draw_steps(trials)),
        Picture("lateral-stability.png", _LATERAL, _draw_lateral(simulations, curves, trials)),
        Picture("vertical-amplitude.png", _VERTICAL, _draw_vertical(simulations, curves, trials)),
        Picture("vertical-motion.png", _HEIGHT, _draw_height(simulations)),
        Picture("from-above.png", _ABOVE, _draw_above(simulations, trials)),
        Picture("toe-off.png", _TOE_OFF, _draw_toe_off(simulations, curves)),
    ]


_STEPS = (
    "Step width against speed (the paper's fig:04); half the step length between the XCoM limit "
    "and the reach (fig:05), which meet at 3 m/s. Squares: the paper's speeds."
)
_LATERAL = (
    "The least lateral stability S_SW of a stride against speed (fig:07). It is constant below "
    "0.5 m/s by our reading of the lateral amplitude, E7."
)
_VERTICAL = (
    "Peak-to-peak height of the CoM against speed (fig:08): planner, rigid pendulum, the paper's "
    "regression of people; Orendurff et al. 2004, mean and standard deviation."
)
_HEIGHT = (
    "Height of the CoM over two steps (fig:09n) at each speed and heel-strike angle; dots: the "
    "paper's step of 80 ms. Grey: the rigid pendulum, and a cycloid of the human amplitude."
)
_ABOVE = (
    "The step seen from above, from the right foot via point to the left one, every 80 ms: base of "
    "support and the line between the CoPs, y_Saddle (fig:09); a person likewise (fig:10)."
)
_TOE_OFF = (
    "Toe-off angle of the left foot in the first step (fig:12), and its value when the right heel "
    "strikes (marked) against speed; heel-strike angle 10°."
)


class _Curves:
    """The planner and the rigid pendulum over the range of speeds."""

    @cached_property
    def planner(self) -> list[Walk]:
        return [simulate(v, samples=COARSE_SAMPLES) for v in CURVE_SPEEDS_M_S]

    @cached_property
    def rigid(self) -> list[Walk]:
        return [simulate(v, ankle="rigid", samples=COARSE_SAMPLES) for v in CURVE_SPEEDS_M_S]

    @cached_property
    def gaits(self) -> list[Gait]:
        return [gait(v) for v in CURVE_SPEEDS_M_S]


def _png(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()


def _finish(axes: Axes, **labels: str) -> None:
    axes.set(**labels)
    axes.grid(alpha=0.25)
    axes.legend(frameon=False, fontsize=9)


def _draw_people(axes: Axes, trials: Sequence[Trial], quantity: str, factor: float = 1.0) -> None:
    """A dot for each trial, hollow for children."""
    styles: dict[bool, dict[str, Any]] = {
        False: {"color": "0.25"},
        True: {"mfc": "white", "mec": "0.25"},
    }
    for children, style in styles.items():
        group = [trial for trial in trials if trial.child == children]
        if group:
            axes.plot(
                [trial.speed_m_s for trial in group],
                [factor * getattr(trial, quantity) for trial in group],
                "o",
                ms=5,
                ls="",
                label="recorded, children" if children else "recorded people",
                **style,
            )


def _draw_steps(trials: Sequence[Trial]) -> bytes:
    figure = Figure(figsize=(12, 4.6), layout="constrained")
    width, length = figure.subplots(1, 2)
    gaits = [gait(v) for v in LIMIT_SPEEDS_M_S]
    shown = LIMIT_SPEEDS_M_S <= 2.0
    width.plot(
        LIMIT_SPEEDS_M_S[shown],
        np.array([g.width_m for g in gaits])[shown],
        color=BLUE,
        label="planner",
    )
    _draw_people(width, trials, "step_width_m")
    width.set_ylim(bottom=0)
    _finish(width, xlabel="speed (m/s)", ylabel="step width (m)")
    lowest, highest = (
        [getattr(g, n) for g in gaits] for n in ("half_step_min_m", "half_step_max_m")
    )
    length.fill_between(
        LIMIT_SPEEDS_M_S, lowest, highest, where=np.less(lowest, highest), color="0.93"
    )
    length.plot(LIMIT_SPEEDS_M_S, lowest, color=RED, ls="--", label="XCoM limit")
    length.plot(LIMIT_SPEEDS_M_S, highest, color=ORANGE, ls="-.", label="reach limit")
    length.plot(LIMIT_SPEEDS_M_S, [g.half_step_m for g in gaits], color=BLUE, label="planner")
    length.plot(SPEEDS_M_S, [gait(v).half_step_m for v in SPEEDS_M_S], "s", color=BLUE, ms=5)
    _draw_people(length, trials, "step_length_m", factor=0.5)
    length.set_ylim(0, 0.75)
    _finish(length, xlabel="speed (m/s)", ylabel="half the step length (m)")
    return _png(figure)


def _draw_lateral(simulations: Simulations, curves: _Curves, trials: Sequence[Trial]) -> bytes:
    figure = Figure(figsize=(7, 4.6), layout="constrained")
    axes = figure.subplots()
    least = [walk.s_sw_min for walk in curves.planner]
    axes.plot(CURVE_SPEEDS_M_S, least, color=BLUE, label="planner")
    axes.plot(SPEEDS_M_S, [simulations.at(v).s_sw_min for v in SPEEDS_M_S], "s", color=BLUE, ms=5)
    _draw_people(axes, trials, "s_sw_min")
    axes.axhline(0, color="0.4", lw=0.8)
    axes.set_ylim(top=1)
    _finish(axes, xlabel="speed (m/s)", ylabel="least lateral stability S_SW")
    return _png(figure)


def _draw_vertical(simulations: Simulations, curves: _Curves, trials: Sequence[Trial]) -> bytes:
    figure = Figure(figsize=(7, 4.6), layout="constrained")
    axes = figure.subplots()
    for walks, marked, colour, style, label in (
        (curves.rigid, simulations.rigid, RED, "--", "rigid pendulum"),
        (curves.planner, {v: simulations.at(v) for v in SPEEDS_M_S}, BLUE, "-", "planner"),
    ):
        axes.plot(
            CURVE_SPEEDS_M_S,
            [100 * walk.vertical_m for walk in walks],
            color=colour,
            ls=style,
            label=label,
        )
        at_m = [100 * marked[v].vertical_m for v in SPEEDS_M_S]
        axes.plot(SPEEDS_M_S, at_m, "s", color=colour, ms=5)
    human_cm = [100 * g.vertical_m for g in curves.gaits]
    axes.plot(CURVE_SPEEDS_M_S, human_cm, color=GREEN, ls="-.", label="people, regression")
    means_cm, deviations_cm = 100 * np.array(list(ORENDURFF_M.values())).T
    axes.errorbar(
        list(ORENDURFF_M),
        means_cm,
        deviations_cm,
        fmt="D",
        color="black",
        capsize=4,
        label="people, Orendurff 2004",
    )
    _draw_people(axes, trials, "vertical_m", factor=100)
    axes.set_ylim(bottom=0)
    _finish(axes, xlabel="speed (m/s)", ylabel="CoM height, peak to peak (cm)")
    return _png(figure)


def _draw_height(simulations: Simulations) -> bytes:
    figure = Figure(figsize=(12, 8), layout="constrained")
    for axes, speed_m_s in zip(figure.subplots(2, 2, sharey=True).flat, SPEEDS_M_S, strict=True):
        rigid, smooth = simulations.rigid[speed_m_s], simulate(speed_m_s, ankle="cycloid")
        axes.plot(rigid["t_s"], rigid["com_z_m"], color="0.5", ls="--", label="rigid pendulum")
        axes.plot(smooth["t_s"], smooth["com_z_m"], color="0.5", ls=":", label="cycloid")
        for angle, colour in ANGLE_COLOURS.items():
            walk, coarse = (
                simulations.walks[speed_m_s, angle],
                simulate_as_the_paper(speed_m_s, angle),
            )
            axes.plot(walk["t_s"], walk["com_z_m"], color=colour, label=f"heel strike {angle}°")
            axes.plot(coarse["t_s"], coarse["com_z_m"], "o", color=colour, ms=3)
        axes.set_title(f"{speed_m_s} m/s", fontsize=10)
        axes.grid(alpha=0.25)
        axes.set(xlabel="time (s)", ylabel="height of the CoM (m)")
    figure.axes[0].legend(frameon=False, fontsize=9)
    return _png(figure)


def _draw_above(simulations: Simulations, trials: Sequence[Trial]) -> bytes:
    person = _person_like(trials)
    figure = Figure(figsize=(12 if person else 7, 3.8), layout="constrained")
    panels = figure.subplots(1, 2 if person else 1, squeeze=False, sharex=True, sharey=True)[0]
    panels[0].set_title(f"planner, {FIGURE_SPEED_M_S} m/s", fontsize=10)
    _draw_planned_step(panels[0], simulations.at(FIGURE_SPEED_M_S))
    if person:
        panels[1].set_title(f"a person, {person.speed_m_s:.2f} m/s ({person.name})", fontsize=10)
        _draw_recorded_step(panels[1], person)
    for axes in panels:
        axes.set_aspect("equal")
        axes.set(xlabel="forward of the right foot (m)", ylabel="to the left (m)")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return _png(figure)


def _person_like(trials: Sequence[Trial]) -> Trial | None:
    """The adult with a step from right to left whose speed is nearest to the figure's."""
    able = [
        trial
        for trial in trials
        if trial.speed_m_s > 0 and not trial.child and _right_to_left(trial)
    ]
    return min(able, key=lambda trial: abs(trial.speed_m_s - FIGURE_SPEED_M_S), default=None)


def _right_to_left(trial: Trial) -> list[tuple[Placement, Placement]]:
    return [pair for pair in step_pairs(trial.placed) if pair[0].side == 1]


def _draw_planned_step(axes: Axes, walk: Walk) -> None:
    coarse = simulate_as_the_paper(walk.speed_m_s, walk.heel_strike_deg)
    origin_x_m = walk["right_x_m"][np.argmin(np.abs(walk["theta_rad"] - math.pi))]
    from_above = []
    for each in (walk, coarse):
        there = each["theta_rad"] >= math.pi
        points = [
            np.column_stack([each[f"{name}_x_m"] - origin_x_m, each[f"{name}_y_m"]])[there]
            for name in ("com", "left", "right")
        ]
        from_above.append(points)
    (com_m, left_m, _), (_, *feet_m) = from_above
    _draw_funnel(axes, np.stack(feet_m, axis=1))
    axes.plot(*left_m.T, color=GREEN, lw=1.2, label="swing foot, left")
    axes.plot(*com_m.T, color=BLUE, lw=2, label="CoM")


def _draw_recorded_step(axes: Axes, trial: Trial) -> None:
    recording = trial.recording
    a, b = _right_to_left(trial)[0]
    step = step_samples(a, b)
    origin_m = np.array([a.cop_m[0], (a.cop_m[1] + b.cop_m[1]) / 2])
    feet_m = np.moveaxis(recording.cop_m[:, step] - origin_m, 0, 1)
    time_s = recording.time_s[step] - recording.time_s[step][0]
    every = np.searchsorted(time_s, np.arange(0, time_s[-1], 0.08))
    _draw_funnel(axes, feet_m[every])
    axes.plot(*feet_m[:, 0].T, color=GREEN, lw=1.2)
    axes.plot(*(recording.com_m[step, :2] - origin_m).T, color=BLUE, lw=2)


def _draw_funnel(axes: Axes, feet_m: np.ndarray) -> None:
    """feet_m: (n, 2, 2), left and right CoP at each instant."""
    config = mean_body()
    for cops_m in feet_m[np.isfinite(feet_m).all(axis=(1, 2))]:
        axes.add_patch(Polygon(bos_polygon(config, cops_m), color=SKY, alpha=0.12, lw=0))
        axes.add_patch(Polygon(bos_polygon(config, cops_m), fill=False, ec=SKY, alpha=0.5, lw=0.6))
        axes.plot(*cops_m.T, color="0.6", lw=0.6)
    axes.plot([], [], color=SKY, lw=8, alpha=0.4, label="base of support")
    axes.plot(*feet_m[:, 1].T, "s", color=RED, ms=5, label="stance foot, right")
    axes.plot(*feet_m[:, 0].T, "o", color=GREEN, ms=3)


def _draw_toe_off(simulations: Simulations, curves: _Curves) -> bytes:
    figure = Figure(figsize=(12, 4.6), layout="constrained")
    over_time, over_speed = figure.subplots(1, 2)
    for speed_m_s, colour in SPEED_COLOURS.items():
        walk = simulations.at(speed_m_s)
        first_step = walk["theta_rad"] < math.pi
        over_time.plot(
            walk["t_s"][first_step],
            np.degrees(walk["theta_to_rad"][first_step]),
            color=colour,
            label=f"{speed_m_s} m/s",
        )
        at_deg = math.degrees(walk.toe_off_rad)
        over_time.plot(walk.heel_strike_s, at_deg, "o", color=colour)
        over_speed.plot(speed_m_s, at_deg, "o", color=colour)
    over_speed.plot(
        CURVE_SPEEDS_M_S,
        [math.degrees(walk.toe_off_rad) for walk in curves.planner],
        color="0.3",
        label=f"heel strike {FIGURE_HEEL_STRIKE_DEG}°",
        zorder=0,
    )
    _finish(over_time, xlabel="time from the left foot via point (s)", ylabel="toe-off angle (°)")
    _finish(over_speed, xlabel="speed (m/s)", ylabel="toe-off angle at heel strike (°)")
    return _png(figure)
