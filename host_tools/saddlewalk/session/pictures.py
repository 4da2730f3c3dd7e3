"""The pictures of a run: level and reasons, speed, scores, margins and energies, steps."""

import io
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from saddlewalk.contract import LEVELS
from saddlewalk.pictures.walk import BALANCE_SHOWN, BLUE, FEET, GREEN, LANES, ORANGE, RED
from saddlewalk.session.quality import Problem
from saddlewalk.session.runs import Run, Span, Spans
from saddlewalk.session.steps import QUANTITIES, Walked
from saddlewalk.verdict import level_name, reason_words

SHADES = {LEVELS.index("caution"): 0.15, LEVELS.index("unstable"): 0.35}
STYLES = ((BLUE, "-"), (ORANGE, "--"), (GREEN, "-."))
SHOWN_M = (-0.8, 0.6)  # of margins; after a fall they are far below
SHOWN_J = (-60.0, 120.0)
SHOWN_SCORES = (-0.5, 1.6)
NO_NUMBERS = "not known"
LONG_S = 60.0  # in a longer run the worst alarms are also drawn in detail
WORST = 3
DRAWN, ACROSS = 8, 4  # small pictures of alarms, and in a row
AROUND_S = 3.0  # shown before and after an alarm
CLOSELY_S = 15.0  # at most
COLUMNS = 1500  # of pixels, roughly, across the axes

Line = tuple[str, np.ndarray]  # label, a number of each tick


@dataclass(frozen=True)
class Picture:
    caption: str
    png: bytes


def draw(run: Run, walk: Walked | None, problems: Sequence[Problem]) -> dict[str, Picture]:
    """The pictures by name; steps, problems and alarms only if there are any."""
    pictures = {
        "level": Picture(_LEVEL, _draw_level(run)),
        "scores": Picture(_SCORES, _draw_scores(run)),
    }
    alarms = run.spans(run.levels)
    alarms = alarms.where(np.isin(alarms.value, list(SHADES)))
    if len(alarms):
        pictures["alarms"] = Picture(_ALARMS.format(DRAWN), _draw_alarms(run, alarms.worst(DRAWN)))
    for number, span in enumerate(alarms.worst(WORST) if run.duration_s >= LONG_S else ()):
        caption = _ALARM.format(level_name(span.value), span.start_s)
        pictures[f"alarm-{number + 1}"] = Picture(caption, _draw_scores(run, *_about(span)))
    if walk and len(walk.steps):
        caption = _STEPS.format("as measured" if walk.measured else "as planned")
        pictures["steps"] = Picture(caption, _draw_steps(run, walk))
    if problems:
        pictures["problems"] = Picture(_TROUBLES, _draw_problems(run, problems))
    return pictures


_LEVEL = (
    "The margin that decides the level (a share of the CoM's usual height; 0 and below is red: "
    "unstable), the announced level, and what decided it. Empty: no verdict, or the "
    "firmware was silent."
)
_SCORES = (
    "The margin that decides the level; speed; scores (1: the reference, 0: the limit); margins in "
    "the base of support and the reach that a recovery step has left (negative: outside, or "
    "lacking); energy beyond that of standing still and beyond the plan's. Shaded: the alarms, "
    "caution lightly and unstable darkly. Values far outside are cut off."
)
_ALARMS = (
    "Each alarm (the worst {} if there are more): the margin, solid, and the limit below which it "
    "is caution, dashed. Red: unstable. Grey: the alarm."
)
_ALARM = "Detail: {} from {:.2f} s."
_STEPS = "Each step, {}, by the foot that landed."
_TROUBLES = "When each fault and limit was reported."


def _draw_level(run: Run) -> bytes:
    reasons = run.column("verdict", "reason")
    known = [int(number) for number in np.unique(reasons[reasons > 0])]
    figure = Figure(figsize=(13, 4.6 + 0.3 * len(known)), dpi=110, layout="constrained")
    heights = (8, len(LANES), max(len(known), 1))
    margin, level, reason = figure.subplots(3, 1, height_ratios=heights, sharex=True)
    _draw_margin(margin, run, (0.0, run.duration_s))
    for lane, (name, style) in enumerate(LANES.items()):
        _bar(level, _spans(run, run.levels == LEVELS.index(name)), run.duration_s, lane, style)
    level.set(ylabel="level", ylim=(-0.5, len(LANES) - 0.5))
    level.set_yticks(range(len(LANES)), LANES)
    for lane, number in enumerate(known):
        _bar(reason, _spans(run, reasons == number), run.duration_s, lane, {"color": BLUE})
    reason.set(ylabel="reason", ylim=(-0.5, max(len(known), 1) - 0.5))
    reason.set_yticks(range(len(known)), [reason_words(number) for number in known])
    _finish_time(figure, run)
    return _png(figure)


def _spans(run: Run, there: np.ndarray) -> Spans:
    spans = run.spans(there)
    return spans.where(spans.value)


def _bar(axes: Axes, spans: Spans, shown_s: float, lane: int, style: dict[str, Any]) -> None:
    axes.broken_barh(_extents(spans, shown_s), (lane - 0.4, 0.8), lw=0, **style)


def _extents(spans: Spans, shown_s: float) -> list[tuple[float, float]]:
    """(start, duration) of bars at least a pixel wide; bars closer than a pixel are merged."""
    if not len(spans):
        return []
    pixel_s = shown_s / COLUMNS
    end_s = spans.start_s + np.maximum(spans.duration_s, pixel_s)
    apart = np.flatnonzero(spans.start_s[1:] - end_s[:-1] >= pixel_s)
    start_s = spans.start_s[np.append(0, apart + 1)]
    return list(zip(start_s, end_s[np.append(apart, -1)] - start_s, strict=True))


def _draw_alarms(run: Run, alarms: Spans) -> bytes:
    """The margin about each, small."""
    rows = math.ceil(len(alarms) / ACROSS)
    figure = Figure(figsize=(13, 0.4 + 1.9 * rows), dpi=110, layout="constrained")
    panels = figure.subplots(rows, ACROSS, squeeze=False).flat
    for axes, alarm in itertools.zip_longest(panels, alarms):
        if alarm is None:
            axes.set_axis_off()
            continue
        shown = _about(alarm)
        _draw_margin(axes, run, shown)
        axes.get_legend().remove()
        axes.set(xlim=shown, title=f"{alarm.start_s:.1f} s: {level_name(alarm.value)}")
    return _png(figure)


def _about(span: Span) -> tuple[float, float]:
    from_s = max(span.start_s - AROUND_S, 0.0)
    return from_s, min(span.start_s + span.duration_s + AROUND_S, from_s + CLOSELY_S)


def _draw_scores(run: Run, from_s: float = 0.0, to_s: float | None = None) -> bytes:
    """The whole run, or a part of it."""
    figure = Figure(figsize=(13, 13), dpi=110, layout=ConstrainedLayoutEngine(w_pad=0.1))
    balance, speed, scores, margins, energy = figure.subplots(5, 1, sharex=True)
    shown = (from_s, to_s or run.duration_s)
    _draw_margin(balance, run, shown)
    _lines(speed, run, _speeds(run), shown, ylabel="speed (m/s)")
    _lines(scores, run, _columns(run, "scores", _SHOWN_SCORES), shown, ylabel="stability score")
    _cut_off(scores, SHOWN_SCORES)
    _lines(margins, run, _margins(run), shown, ylabel="margin (m)")
    _cut_off(margins, SHOWN_M)
    energies = _columns(run, "verdict", _SHOWN_ENERGIES)
    _lines(energy, run, energies, shown, ylabel="excess energy (J)")
    _cut_off(energy, SHOWN_J)
    _finish_time(figure, run)
    energy.set_xlim(shown)
    return _png(figure)


def _draw_margin(axes: Axes, run: Run, shown: tuple[float, float]) -> None:
    """The margin that decides the level, and its limits: unstable at 0, caution below a line."""
    _lines(axes, run, _columns(run, "balance", _SHOWN_BALANCE), shown, ylabel="margin")
    _cut_off(axes, BALANCE_SHOWN)
    axes.axhspan(min(axes.get_ylim()[0], -0.05), 0, color=RED, alpha=0.15, lw=0, zorder=0)


_SHOWN_BALANCE = {"margin; unstable\nfrom 0 down": "margin", "caution below": "caution_below"}
_SHOWN_SCORES = {"S_pend": "s_pend", "S_jump": "s_jump", "S_SW": "s_sw"}
_SHOWN_MARGINS = {"CoM": "mos_com_m", "XCoM": "mos_xcom_m"}
_SHOWN_ENERGIES = {"to stop": "excess_stop_j", "to the plan": "excess_track_j"}


def _columns(run: Run, channel: str, members: dict[str, str]) -> Iterator[Line]:
    """Read one after the other, since each is long."""
    for label, member in members.items():
        yield label, run.column(channel, member)


def _speeds(run: Run) -> Iterator[Line]:
    known = run.column("input", "com_age_us") >= 0
    yield "measured", np.where(known, run.column("input", "com_velocity_m_s", 0), np.nan)
    valid = run.column("plan", "valid") == 1
    yield "planned", np.where(valid, run.column("plan", "speed_m_s"), np.nan)


def _margins(run: Run) -> Iterator[Line]:
    yield from _columns(run, "scores", _SHOWN_MARGINS)
    compared = run.column("verdict", "compared") == 1
    margin_m = np.where(compared, run.column("verdict", "recovery_margin_m"), np.nan)
    yield "recovery step", margin_m


def _lines(
    axes: Axes, run: Run, lines: Iterable[Line], shown: tuple[float, float], ylabel: str
) -> None:
    """shown: a slice of the ticks."""
    ticks = slice(*np.searchsorted(run.time_s, shown))
    at_s, silent = run.time_s[ticks], np.flatnonzero(run.silent_s[ticks][:-1]) + 1
    for (name, numbers), (colour, style) in zip(lines, STYLES, strict=False):
        if np.isfinite(numbers[ticks]).any():
            broken = np.insert(numbers[ticks], silent, np.nan)
            line = _thinned(np.insert(at_s, silent, at_s[silent]), broken)
            axes.plot(*line, color=colour, ls=style, label=name)
        else:
            axes.plot([], [], color=colour, ls=style, label=f"{name}, {NO_NUMBERS}")
    axes.axhline(0, color="0.4", lw=0.8)
    _shade(axes, run, shown)
    axes.set(ylabel=ylabel)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def _shade(axes: Axes, run: Run, shown: tuple[float, float]) -> None:
    heights = axes.get_ylim()
    for level, alpha in SHADES.items():
        spans = _spans(run, run.levels == level)
        ends_s = spans.start_s + spans.duration_s
        spans = spans.where((spans.start_s < shown[1]) & (ends_s > shown[0]))
        extents = _extents(spans, shown[1] - shown[0])
        bars: dict[str, Any] = {"color": "0.5", "alpha": alpha, "lw": 0}
        axes.broken_barh(extents, (0, 1), transform=axes.get_xaxis_transform(), **bars)
    axes.set_ylim(heights)


def _thinned(at_s: np.ndarray, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve reduced to the minimum and maximum of each pixel."""
    if len(numbers) <= 4 * COLUMNS:
        return at_s, numbers
    edges_s = np.linspace(at_s[0], at_s[-1], COLUMNS, endpoint=False)
    first = np.searchsorted(at_s, edges_s)
    empty = np.append(first[1:], len(at_s)) == first
    both = np.column_stack([of.reduceat(numbers, first) for of in (np.fmin, np.fmax)])
    both[empty] = np.nan
    return np.repeat(edges_s, 2), both.ravel()


def _cut_off(axes: Axes, most: tuple[float, float]) -> None:
    low, high = axes.get_ylim()
    axes.set_ylim(max(low, most[0]), min(high, most[1]))


def _draw_steps(run: Run, walk: Walked) -> bytes:
    figure = Figure(figsize=(13, 6.5), dpi=110, layout="constrained")
    for axes, (member, label) in zip(
        figure.subplots(len(QUANTITIES), 1, sharex=True), QUANTITIES.items(), strict=True
    ):
        for side, (name, colour) in enumerate(FEET):
            steps = walk.steps.side == side
            line = _thinned(walk.steps.landed_s[steps], getattr(walk.steps, member)[steps])
            axes.plot(*line, "<>"[side], color=colour, ls=":", lw=0.8, label=name)
        axes.set(ylabel=label)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    _finish_time(figure, run)
    return _png(figure)


def _draw_problems(run: Run, problems: Sequence[Problem]) -> bytes:
    figure = Figure(figsize=(13, 1 + 0.3 * len(problems)), dpi=110, layout="constrained")
    axes = figure.subplots()
    for lane, trouble in enumerate(problems):
        _bar(axes, trouble.spans, run.duration_s, lane, {"color": BLUE})
    axes.set_ylim(-0.5, len(problems) - 0.5)
    axes.set_yticks(range(len(problems)), [trouble.name for trouble in problems])
    _finish_time(figure, run)
    return _png(figure)


def _finish_time(figure: Figure, run: Run) -> None:
    for axes in figure.axes:
        axes.set_xlim(0, run.duration_s)
        axes.grid(alpha=0.25)
        if run.fell_s is not None:
            axes.axvline(run.fell_s, color="black", lw=1.5, ls=":")
    figure.axes[-1].set(xlabel="time (s)")


def _png(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()
