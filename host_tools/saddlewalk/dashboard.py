"""What the firmware says about one walk, for people: `render` for a terminal, `summary` as a line.

Both take LCM messages (plan_t, scores_t, verdict_t, health_t, status_t, or None while one has not
come), how long the firmware has been silent, and whether the wearer is known to have fallen. They
draw what the messages hold and judge nothing, except that silence makes the level unknown, and that
no score says anything after a fall. Colour repeats a word or the sign of a number and is never the
only sign of anything.
"""

import math

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from saddlewalk import process_words
from saddlewalk.contract import (
    FAULTS,
    LEVELS,
    LIMITS,
    MODES,
    SIDES,
    STATUSES,
    TIME_MAX_S,
    bit_names,
    name_of,
)
from saddlewalk.letters import large
from saddlewalk.verdict import level_name, reason_words

SILENT_AFTER_S = 1.0

MISSING = {
    "COMMAND_STALE": "commands",
    **dict.fromkeys(("COM_STALE", "COM_RANGE", "COM_FROZEN"), "the CoM's measurement"),
    **dict.fromkeys(("LEFT_STALE", "LEFT_RANGE", "LEFT_FROZEN"), "the left foot's"),
    **dict.fromkeys(("RIGHT_STALE", "RIGHT_RANGE", "RIGHT_FROZEN"), "the right foot's"),
}

SCORES = (("S_pend", "s_pend"), ("S_jump", "s_jump"), ("S_SW", "s_sw"))
MARGINS = (("CoM in BoS", "mos_com_m"), ("XCoM in BoS", "mos_xcom_m"))
EXPECTED = (("CoM in E-BoS", "ebos_com_m"), ("XCoM in E-BoS", "ebos_xcom_m"))
FELL = "fell"  # in the place of a level
LEVEL_STYLES = dict(zip(LEVELS, ("magenta", "green", "yellow", "red"), strict=True))
LEVEL_STYLES[FELL] = "red"
MARGIN_SCALE_M = 0.4
BAR_CELLS = 25
NOT_AVAILABLE = "n/a"


def render(
    plan, scores, verdict, health, status, silent_s: float = 0.0, fallen: bool = False
) -> RenderableType:
    """A panel: the level, large, and what decided it; gait, scores, margins, energy and health."""
    if all(message is None for message in (plan, scores, verdict, health, status)):
        return Panel(Text(waiting(silent_s)), title="saddlewalk", border_style="yellow")
    level, words = announced(verdict, silent_s, fallen)
    style = LEVEL_STYLES.get(level, "")
    scores, verdict = (None, None) if fallen else (scores, verdict)
    parts = [
        Text(large(level.upper()), style=f"bold {style}"),
        Text(f"level: {level}{words and f', {words}'}", style="bold"),
        Text(gait(plan)),
        _bars(scores, verdict),
        Text(f"energy: {energy(verdict)}"),
        Text(f"recovery step: {recovery_step(verdict)}"),
        Text(condition(health)),
        *(Text(line) for line in process_words.lines(status)),
    ]
    return Panel(Group(*parts), title="saddlewalk", border_style=style)


def summary(
    plan, scores, verdict, health, status, silent_s: float = 0.0, fallen: bool = False
) -> str:
    """The same on one line of plain text."""
    nothing = all(message is None for message in (plan, scores, verdict, health, status))
    if silent_s > SILENT_AFTER_S or nothing:
        return waiting(silent_s)
    level, words = announced(verdict, silent_s, fallen)
    scores, verdict = (None, None) if fallen else (scores, verdict)
    return " | ".join(
        (
            f"{level.upper()}{words and f': {words}'}",
            gait(plan),
            "  ".join(f"{label} {_number(*of)}" for label, *of in _numbers(scores, verdict)),
            f"energy: {energy(verdict)}",
            f"recovery step: {recovery_step(verdict)}",
            condition(health),
            *process_words.lines(status),
        )
    )


def announced(verdict, silent_s: float, fallen: bool) -> tuple[str, str]:
    """The level and what decided it, in words. What is old is not known any more."""
    if fallen:
        return FELL, "the wearer lies on the ground, scores are not available"
    if silent_s > SILENT_AFTER_S:
        return LEVELS[0], waiting(silent_s)
    if verdict is None:
        return LEVELS[0], "no verdict yet"
    return level_name(verdict.level), reason_words(verdict.reason)


def waiting(silent_s: float) -> str:
    return f"no message from the firmware for {silent_s:.1f} s"


def gait(plan) -> str:
    """Where in the stride the plan is."""
    if plan is None:
        return "plan: none yet"
    if not plan.valid:
        return "plan: none"
    mode = name_of(plan.mode, MODES, "mode")
    if plan.mode == plan.MODE_STANDING:
        return f"plan: {mode} after {plan.step_count} steps"
    support = SIDES[plan.support == plan.RIGHT]
    turn = plan.theta_rad / (2 * math.pi)
    return (
        f"plan: {mode}, step {plan.step_count}, phase {plan.phase} ({turn:4.0%} of the stride), "
        f"support {support}, {plan.speed_m_s:.2f} m/s, {_heel_strike(plan)}"
    )


def _heel_strike(plan) -> str:
    foreseen = plan.time_to_heel_strike_s < TIME_MAX_S
    return f"heel strike in {plan.time_to_heel_strike_s:.2f} s" if foreseen else "no heel strike"


def energy(verdict) -> str:
    """What there is beyond a stop and beyond the plan, and whether the ankles can take it."""
    if verdict is None:
        return NOT_AVAILABLE
    parts = (
        (verdict.excess_stop_j, "to stop", verdict.can_stop),
        (verdict.excess_track_j, "to the plan", verdict.on_track),
    )
    return ", ".join(
        f"{what} {NOT_AVAILABLE}"
        if math.isnan(excess_j)
        else f"{what} {excess_j:+.1f} J ({'within' if absorbed else 'beyond'} the ankles' work)"
        for excess_j, what, absorbed in parts
    )


def recovery_step(verdict) -> str:
    """Where to put which foot, or that no place within reach will do."""
    if verdict is None or not verdict.compared:
        return NOT_AVAILABLE
    if not verdict.recovery_found:
        return f"none within reach, {-verdict.recovery_margin_m:.2f} m lacking"
    foot = verdict.recovery_foot == verdict.RIGHT
    x_m, y_m = verdict.recovery_landing_m
    return (
        f"{SIDES[foot]} foot {abs(x_m):.2f} m {'behind' if x_m < 0 else 'ahead'} and "
        f"{abs(y_m):.2f} m to the {'right' if y_m < 0 else 'left'} of the {SIDES[not foot]} one, "
        f"{verdict.recovery_margin_m:.2f} m of reach left"
        + (", ends the walk" if verdict.recovery_stops else "")
    )


def condition(health) -> str:
    """Whether the firmware keeps its time and gets good data."""
    if health is None:
        return "health: none yet"
    age_us = health.measurement_age_us
    age = "never measured" if age_us < 0 else f"data age {age_us / 1000:.0f} ms"
    rejected = health.frames_bad_crc + health.frames_bad_counter + health.frames_malformed
    parts = [
        f"tick {health.tick}",
        age,
        f"late ticks {health.late_ticks}",
        f"frames rejected {rejected}",
    ]
    if health.status:
        parts.append(f"status {name_of(health.status, STATUSES)}")
    parts += [
        f"{label} {' '.join(names)}"
        for label, names in (
            ("limits", bit_names(health.limits, LIMITS)),
            ("faults", bit_names(health.faults, FAULTS)),
        )
        if names
    ]
    return "health: " + ", ".join(parts) + safe_stop(health)


def safe_stop(health) -> str:
    """That the firmware ends the walk by itself, and for want of what; empty otherwise."""
    if not health.limits >> LIMITS.index("SAFE_STOP") & 1:
        return ""
    faults = bit_names(health.faults, FAULTS)
    missing = [words for fault, words in MISSING.items() if fault in faults]
    why = " and ".join(missing) + " missing" if missing else "inputs not yet good for long enough"
    return f"; SAFE STOP, the walk ends: {why}"


def _numbers(scores, verdict) -> list[tuple[str, object, str]]:
    """(label, message, field) of what is shown as a bar."""
    named = [(scores, SCORES), (scores, MARGINS), (verdict, EXPECTED)]
    return [(label, message, name) for message, names in named for label, name in names]


def _bars(scores, verdict) -> Table:
    table = Table.grid(padding=(0, 1))
    table.add_column(min_width=13)
    table.add_column()
    table.add_column(justify="right", min_width=8)
    for label, message, name in _numbers(scores, verdict):
        bar = margin_bar if name.endswith("_m") else score_bar
        table.add_row(label, bar(_value(message, name)), _number(message, name))
    return table


def score_bar(value: float) -> Text:
    """A score: empty at 0 (the limit of stability) and below, full at 1 (the reference)."""
    if math.isnan(value):
        return Text("·" * BAR_CELLS, style="dim")
    cells = round(min(max(value, 0.0), 1.0) * BAR_CELLS)
    return Text("█" * cells, style="green").append("░" * (BAR_CELLS - cells), style="dim")


def margin_bar(value_m: float) -> Text:
    """A signed margin from the middle: to the right inside the base of support, left outside."""
    if math.isnan(value_m):
        return Text("·" * BAR_CELLS, style="dim")
    half = BAR_CELLS // 2
    cells = round(min(abs(value_m) / MARGIN_SCALE_M, 1.0) * half)
    filled, empty = "█" * cells, "░" * (half - cells)
    left, right = (empty + filled, "░" * half) if value_m < 0 else ("░" * half, filled + empty)
    return Text(f"{left}│{right}", style="cyan")


def _value(message, name: str) -> float:
    return math.nan if message is None else getattr(message, name)


def _number(message, name: str) -> str:
    value = _value(message, name)
    if math.isnan(value):
        return NOT_AVAILABLE
    return f"{value:+.3f} m" if name.endswith("_m") else f"{value:.2f}"
