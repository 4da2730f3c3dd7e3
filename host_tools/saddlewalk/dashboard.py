"""The state of one walk from the firmware's messages: `render` for a terminal, `summary` as a line.

Both begin with the level and the margin that decides it. They only display the messages, with two
exceptions: silence makes the level unknown, and scores are not shown after a fall. Colour is never
the only sign: it repeats a word or the sign of a number.
"""

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from saddlewalk import status_text
from saddlewalk.banner import banner
from saddlewalk.contract import (
    FAULTS,
    LEVELS,
    LIMITS,
    MODES,
    SIDES,
    STATUSES,
    TIME_MAX_S,
    UNKNOWN,
    bit_names,
    name_of,
)
from saddlewalk.verdict import level_name, reason_name, reason_words

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
FELL = "fell"  # instead of a level
LEVEL_STYLES = dict(zip(LEVELS, ("magenta", "green", "yellow", "red"), strict=True))
LEVEL_STYLES[FELL] = "red"
MARGIN_SCALE_M = 0.4
BAR_CELLS = 13
BALANCE_CELLS = 25
UNSTABLE_CELLS = 4  # of them, below 0
BALANCE_PER_CELL = 0.04
NOT_AVAILABLE = "n/a"


@dataclass(frozen=True)
class Heard:
    """The newest LCM message of each channel, None before the first, and what else is known."""

    plan: Any = None
    scores: Any = None
    verdict: Any = None
    balance: Any = None
    health: Any = None
    status: Any = None
    silent_s: float = 0.0  # since the last message
    fallen: bool = False  # the wearer is on the ground

    @property
    def nothing(self) -> bool:
        messages = (self.plan, self.scores, self.verdict, self.balance, self.health, self.status)
        return all(message is None for message in messages)

    def still_true(self) -> "Heard":
        """The state without scores after a fall, and without an old margin."""
        if self.fallen:
            return replace(self, scores=None, verdict=None, balance=None)
        return replace(self, balance=None) if self.silent_s > SILENT_AFTER_S else self


def render(heard: Heard) -> RenderableType:
    """A panel of 24 lines of 80 characters: the level in large letters, its reason, the margin, the
    rest.
    """
    if heard.nothing:
        return Panel(Text(waiting(heard.silent_s)), title="saddlewalk", border_style="yellow")
    level, words = announced(heard)
    style = LEVEL_STYLES.get(level, "")
    current = heard.still_true()
    parts: list[RenderableType] = [
        Text(banner(level.upper()), style=f"bold {style}"),
        Text(f"level: {level}{words and f', {words}'}", style="bold"),
        _margin_row(current.balance),
        Text(f"largest departure: {driver(current.balance)}"),
        _bars(current),
        Text(f"recovery: {recovery_step(current.verdict)}"),
        Text(f"energy: {energy(current.verdict)}"),
        Text(gait(current.plan)),
        Text(condition(current.health)),
        *(Text(line) for line in status_text.lines(current.status)),
    ]
    return Panel(Group(*parts), title="saddlewalk", border_style=style)


def summary(heard: Heard) -> str:
    """The same as a line of plain text."""
    if heard.silent_s > SILENT_AFTER_S or heard.nothing:
        return waiting(heard.silent_s)
    level, words = announced(heard)
    current = heard.still_true()
    return " | ".join(
        (
            f"{level.upper()}{words and f': {words}'}",
            f"margin {margin(current.balance)}, largest departure: {driver(current.balance)}",
            "  ".join(f"{label} {_number(of, name)}" for label, of, name in _numbers(current)),
            f"recovery: {recovery_step(current.verdict)}",
            f"energy: {energy(current.verdict)}",
            gait(current.plan),
            condition(current.health),
            *status_text.lines(current.status),
        )
    )


def announced(heard: Heard) -> tuple[str, str]:
    """The level and what decided it, as text; unknown if the messages are old."""
    if heard.fallen:
        return FELL, "the wearer is on the ground, scores are not available"
    if heard.silent_s > SILENT_AFTER_S:
        return LEVELS[UNKNOWN], waiting(heard.silent_s)
    if heard.verdict is None:
        return LEVELS[UNKNOWN], "no verdict yet"
    return level_name(heard.verdict.level), reason_words(heard.verdict.reason)


def margin(balance: Any) -> str:
    """The margin that decides the level, and its limits."""
    if balance is None or math.isnan(balance.margin):
        return NOT_AVAILABLE
    return f"{balance.margin:+.3f} (unstable at 0, caution at {balance.caution_below:.3f})"


def driver(balance: Any) -> str:
    """The largest part of the departure from the wearer's own walk; not an alarm by itself."""
    if balance is None or math.isnan(balance.margin):
        return NOT_AVAILABLE
    return reason_name(balance.driver).replace("_", " ")


def waiting(silent_s: float) -> str:
    return f"no message from the firmware for {silent_s:.1f} s"


def gait(plan: Any) -> str:
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
        f"plan: {mode} {plan.speed_m_s:.2f} m/s, step {plan.step_count} ({support}), "
        f"phase {turn:.0%}, {_heel_strike(plan)}"
    )


def _heel_strike(plan: Any) -> str:
    predicted = plan.time_to_heel_strike_s < TIME_MAX_S
    return f"heel strike in {plan.time_to_heel_strike_s:.2f} s" if predicted else "no heel strike"


def energy(verdict: Any) -> str:
    """Excess energy to stop and to the plan, and whether the ankles can absorb it."""
    if verdict is None:
        return NOT_AVAILABLE
    parts = (
        (verdict.excess_stop_j, "to stop", verdict.can_stop),
        (verdict.excess_track_j, "to the plan", verdict.on_track),
    )
    return ", ".join(
        f"{what} {NOT_AVAILABLE}"
        if math.isnan(excess_j)
        else f"{what} {excess_j:+.1f} J (ankles {'can' if absorbed else 'cannot'})"
        for excess_j, what, absorbed in parts
    )


def recovery_step(verdict: Any) -> str:
    """Which foot to place where, or that no place within reach suffices."""
    if verdict is None or not verdict.compared:
        return NOT_AVAILABLE
    if not verdict.recovery_found:
        return f"none within reach, {-verdict.recovery_margin_m:.2f} m short"
    foot = verdict.recovery_foot == verdict.RIGHT
    x_m, y_m = verdict.recovery_landing_m
    return (
        f"{SIDES[foot]} foot {abs(x_m):.2f} m {'behind' if x_m < 0 else 'ahead'}, "
        f"{abs(y_m):.2f} m {'right' if y_m < 0 else 'left'} of the {SIDES[not foot]}, "
        f"{verdict.recovery_margin_m:.2f} m spare"
        + (", ends the walk" if verdict.recovery_stops else "")
    )


def condition(health: Any) -> str:
    """Timing and input data of the firmware."""
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


def safe_stop(health: Any) -> str:
    """Why the firmware stops the walk by itself; empty if it does not."""
    if not health.limits >> LIMITS.index("SAFE_STOP") & 1:
        return ""
    faults = bit_names(health.faults, FAULTS)
    missing = [words for fault, words in MISSING.items() if fault in faults]
    why = " and ".join(missing) + " missing" if missing else "inputs not yet valid for long enough"
    return f"; SAFE STOP, the walk ends: {why}"


def _numbers(current: Heard) -> list[tuple[str, Any, str]]:
    """(label, message, field) of each bar next to or below the margin."""
    named = [(current.scores, SCORES), (current.scores, MARGINS), (current.verdict, EXPECTED)]
    return [(label, message, name) for message, names in named for label, name in names]


def _margin_row(balance: Any) -> Table:
    row = Table.grid(padding=(0, 1))
    known = balance is not None and not math.isnan(balance.margin)
    bar = balance_bar(balance.margin, balance.caution_below) if known else _no_bar(BALANCE_CELLS)
    row.add_row("margin", bar, Text(margin(balance), style="bold"))
    return row


def _bars(current: Heard) -> Table:
    """Scores in the left column, margins in the right one."""
    table = Table.grid(padding=(0, 1))
    for width in (6, BAR_CELLS, 8, 13, BAR_CELLS, 8):
        table.add_column(min_width=width, justify="right" if width == 8 else "left")
    cells = [
        (label, (margin_bar if name.endswith("_m") else score_bar)(_value(message, name)),
         _number(message, name))
        for label, message, name in _numbers(current)
    ]  # fmt: skip
    scores, margins = cells[: len(SCORES)], cells[len(SCORES) :]
    for left, right in itertools.zip_longest(scores, margins, fillvalue=("", "", "")):
        table.add_row(*left, *right)
    return table


def balance_bar(value: float, caution_below: float) -> Text:
    """The margin from 0, which is marked, to the right; below 0 to the left. The caution band is
    hatched where the margin does not fill it."""
    cells = round(value / BALANCE_PER_CELL)
    below = min(max(-cells, 0), UNSTABLE_CELLS)
    band = math.ceil(max(caution_below, 0.0) / BALANCE_PER_CELL)
    above = min(max(cells, 0), BALANCE_CELLS - UNSTABLE_CELLS - 1)
    style = "red" if value <= 0 else "yellow" if value <= caution_below else "green"
    bar = Text("░" * (UNSTABLE_CELLS - below), style="dim").append("█" * below, style="red")
    bar.append("│").append("█" * above, style=style)
    bar.append("▒" * max(band - above, 0), style="yellow")
    return bar.append("░" * (BALANCE_CELLS - len(bar)), style="dim")


def _no_bar(cells: int) -> Text:
    return Text("·" * cells, style="dim")


def score_bar(value: float) -> Text:
    """A score: empty at and below 0 (the limit of stability), full at 1 (the reference)."""
    if math.isnan(value):
        return _no_bar(BAR_CELLS)
    cells = round(min(max(value, 0.0), 1.0) * BAR_CELLS)
    return Text("█" * cells, style="green").append("░" * (BAR_CELLS - cells), style="dim")


def margin_bar(value_m: float) -> Text:
    """A signed margin from the middle: to the right inside the base of support, left outside."""
    if math.isnan(value_m):
        return _no_bar(BAR_CELLS)
    half = BAR_CELLS // 2
    cells = round(min(abs(value_m) / MARGIN_SCALE_M, 1.0) * half)
    filled, empty = "█" * cells, "░" * (half - cells)
    left, right = (empty + filled, "░" * half) if value_m < 0 else ("░" * half, filled + empty)
    return Text(f"{left}│{right}", style="cyan")


def _value(message: Any, name: str) -> float:
    return math.nan if message is None else getattr(message, name)


def _number(message: Any, name: str) -> str:
    value = _value(message, name)
    if math.isnan(value):
        return NOT_AVAILABLE
    return f"{value:+.3f} m" if name.endswith("_m") else f"{value:.2f}"
