"""The pictures of a run: level and reasons, speed, scores, margins and energies, steps."""

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from saddlewalk.pictures.walk import BLUE, FEET, GREEN, LANES, ORANGE
from saddlewalk.session.quality import Trouble
from saddlewalk.session.runs import Run, Span
from saddlewalk.session.steps import QUANTITIES, Way
from saddlewalk.verdict import LEVELS, level_name, reason_words

SHADES = {LEVELS.index("caution"): 0.15, LEVELS.index("unstable"): 0.35}
STYLES = ((BLUE, "-"), (ORANGE, "--"), (GREEN, "-."))
SHOWN_M = (-0.8, 0.6)  # margins; after a fall they are far below
SHOWN_J = (-60.0, 120.0)
SHOWN_SCORES = (-0.5, 1.6)
NO_NUMBERS = "not known"
LONG_S = 60.0  # a longer run's worst alarms are also shown closely
WORST = 3
AROUND_S = 3.0  # shown before and after an alarm
CLOSELY_S = 15.0  # at most

Line = tuple[str, np.ndarray]  # label, a number of each tick


@dataclass(frozen=True)
class Picture:
    caption: str
    png: bytes


def draw(run: Run, way: Way | None, troubles: Sequence[Trouble]) -> dict[str, Picture]:
    """By what they show; steps, troubles and alarms only where there are some."""
    pictures = {
        "level": Picture(_LEVEL, _draw_level(run)),
        "scores": Picture(_SCORES, _draw_scores(run)),
    }
    for number, span in enumerate(_worst(run), start=1):
        caption = _ALARM.format(level_name(span.value), span.start_s)
        pictures[f"alarm-{number}"] = Picture(caption, _draw_scores(run, *_about(span)))
    if way and way.steps:
        caption = _STEPS.format("as measured" if way.measured else "as planned")
        pictures["steps"] = Picture(caption, _draw_steps(run, way))
    if troubles:
        pictures["troubles"] = Picture(_TROUBLES, _draw_troubles(run, troubles))
    return pictures


_LEVEL = (
    "The level that was announced, and what decided it. Empty: no verdict came, or the firmware "
    "was silent."
)
_SCORES = (
    "Speed; scores (1: the reference, 0: the limit); margins in the base of support and the reach "
    "that a recovery step has left (negative: outside, or lacking); energy beyond that of standing "
    "still and beyond the plan's. Shaded: the alarms, caution lightly and unstable darkly. "
    "What lies far beyond is cut off."
)
_ALARM = "The same closely: {} from {:.2f} s."
_STEPS = "Each step, {}, by the foot that landed."
_TROUBLES = "When each fault and limit was told."


def _draw_level(run: Run) -> bytes:
    reasons = run.column("verdict", "reason")
    known = [int(number) for number in np.unique(reasons[reasons > 0])]
    figure = Figure(figsize=(13, 2.2 + 0.3 * len(known)), dpi=110, layout="constrained")
    heights = (len(LANES), max(len(known), 1))
    level, reason = figure.subplots(2, 1, height_ratios=heights, sharex=True)
    for lane, (name, style) in enumerate(LANES.items()):
        _bar(level, _spans(run, run.levels == LEVELS.index(name)), lane, style)
    level.set(ylabel="level", ylim=(-0.5, len(LANES) - 0.5))
    level.set_yticks(range(len(LANES)), LANES)
    for lane, number in enumerate(known):
        _bar(reason, _spans(run, reasons == number), lane, {"color": BLUE})
    reason.set(ylabel="reason", ylim=(-0.5, max(len(known), 1) - 0.5))
    reason.set_yticks(range(len(known)), [reason_words(number) for number in known])
    _finish_time(figure, run)
    return _png(figure)


def _spans(run: Run, there: np.ndarray) -> list[Span]:
    return [span for span in run.spans(there) if span.value]


def _bar(axes: Axes, spans: Sequence[Span], lane: int, style: dict) -> None:
    extents = [(span.start_s, span.duration_s) for span in spans]
    axes.broken_barh(extents, (lane - 0.4, 0.8), lw=0, **style)


def _worst(run: Run) -> list[Span]:
    """The alarms of a long run that matter most, in the order of their coming."""
    if run.duration_s < LONG_S:
        return []
    found = [span for span in run.spans(run.levels) if span.value in SHADES]
    found.sort(key=lambda span: (span.value, span.duration_s), reverse=True)
    return sorted(found[:WORST], key=lambda span: span.start_s)


def _about(span: Span) -> tuple[float, float]:
    from_s = max(span.start_s - AROUND_S, 0.0)
    return from_s, min(span.start_s + span.duration_s + AROUND_S, from_s + CLOSELY_S)


def _draw_scores(run: Run, from_s: float = 0.0, to_s: float | None = None) -> bytes:
    """The whole run, or a part of it."""
    figure = Figure(figsize=(13, 11), dpi=110, layout="constrained")
    figure.get_layout_engine().set(w_pad=0.1)
    speed, scores, margins, energy = figure.subplots(4, 1, sharex=True)
    planned_m_s = np.where(
        run.column("plan", "valid") == 1, run.column("plan", "speed_m_s"), np.nan
    )
    measured_m_s = np.where(
        run.column("input", "com_age_us") >= 0, run.column("input", "com_velocity_m_s", 0), np.nan
    )
    _lines(speed, run, [("measured", measured_m_s), ("planned", planned_m_s)], "speed (m/s)")
    named = (("S_pend", "s_pend"), ("S_jump", "s_jump"), ("S_SW", "s_sw"))
    lines = [(label, run.column("scores", member)) for label, member in named]
    _lines(scores, run, lines, "stability score", SHOWN_SCORES)
    lines = [
        ("CoM", run.column("scores", "mos_com_m")),
        ("XCoM", run.column("scores", "mos_xcom_m")),
        ("recovery step", _recovery_m(run)),
    ]
    _lines(margins, run, lines, "margin (m)", SHOWN_M)
    lines = [
        ("to stop", run.column("verdict", "excess_stop_j")),
        ("to the plan", run.column("verdict", "excess_track_j")),
    ]
    _lines(energy, run, lines, "excess energy (J)", SHOWN_J)
    _finish_time(figure, run)
    energy.set_xlim(from_s, to_s or run.duration_s)
    return _png(figure)


def _recovery_m(run: Run) -> np.ndarray:
    compared = run.column("verdict", "compared") == 1
    return np.where(compared, run.column("verdict", "recovery_margin_m"), np.nan)


def _lines(
    axes: Axes,
    run: Run,
    lines: list[Line],
    label: str,
    shown: tuple[float, float] | None = None,
) -> None:
    """shown: what is beyond is cut off."""
    at_s, silent = run.time_s, np.flatnonzero(run.silent_s) + 1
    for (name, numbers), (colour, style) in zip(lines, STYLES, strict=False):
        if np.isfinite(numbers).any():
            broken = np.insert(numbers, silent, np.nan)
            axes.plot(np.insert(at_s, silent, np.nan), broken, color=colour, ls=style, label=name)
        else:
            axes.plot([], [], color=colour, ls=style, label=f"{name}, {NO_NUMBERS}")
    axes.axhline(0, color="0.4", lw=0.8)
    if shown:
        low, high = axes.get_ylim()
        axes.set_ylim(max(low, shown[0]), min(high, shown[1]))
    for level, alpha in SHADES.items():
        for span in _spans(run, run.levels == level):
            end_s = span.start_s + span.duration_s
            axes.axvspan(span.start_s, end_s, color="0.5", alpha=alpha, lw=0)
    axes.set(ylabel=label)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def _draw_steps(run: Run, way: Way) -> bytes:
    figure = Figure(figsize=(13, 6.5), dpi=110, layout="constrained")
    for axes, (member, label) in zip(
        figure.subplots(len(QUANTITIES), 1, sharex=True), QUANTITIES.items(), strict=True
    ):
        for side, (name, colour) in enumerate(FEET):
            steps = [step for step in way.steps if step.side == side]
            at_s = [step.landed_s for step in steps]
            values = [getattr(step, member) for step in steps]
            axes.plot(at_s, values, "<>"[side], color=colour, ls=":", lw=0.8, label=name)
        axes.set(ylabel=label)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    _finish_time(figure, run)
    return _png(figure)


def _draw_troubles(run: Run, troubles: Sequence[Trouble]) -> bytes:
    figure = Figure(figsize=(13, 1 + 0.3 * len(troubles)), dpi=110, layout="constrained")
    axes = figure.subplots()
    for lane, trouble in enumerate(troubles):
        _bar(axes, trouble.spans, lane, {"color": BLUE})
    axes.set_ylim(-0.5, len(troubles) - 0.5)
    axes.set_yticks(range(len(troubles)), [trouble.name for trouble in troubles])
    _finish_time(figure, run)
    return _png(figure)


def _finish_time(figure: Figure, run: Run) -> None:
    for axes in figure.axes:
        axes.set_xlim(0, run.duration_s)
        axes.grid(alpha=0.25)
    figure.axes[-1].set(xlabel="time (s)")


def _png(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()
