"""What the firmware says about one walk, for people: `render` for a terminal, `summary` as a line.

Both take LCM messages (plan_t, scores_t, health_t, or None while one has not come) and how long the
firmware has been silent. They draw what the messages hold and judge nothing: colour repeats the
sign of a number and is never the only sign of anything.
"""

import math

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from saddlewalk.core import TIME_MAX_S

SILENT_AFTER_S = 1.0

# By number, as saddle_status_t and saddle_mode_t; bit 0 first, as saddle_limit_t, saddle_fault_t.
STATUSES = (
    "OK",
    "ERROR_NULL",
    "ERROR_CONFIG",
    "ERROR_UNINITIALISED",
    "ERROR_TIME",
    "ERROR_COMMAND",
)
MODES = ("standing", "starting", "walking", "stopping")
LIMITS = ("SPEED", "HEEL_STRIKE", "TOE_OFF", "FEET", "TICK_GAP")
FAULTS = (
    "COMMAND",
    "COM_STALE",
    "COM_RANGE",
    "LEFT_STALE",
    "LEFT_RANGE",
    "RIGHT_STALE",
    "RIGHT_RANGE",
    "FEET_TOGETHER",
    "SPEED_INFEASIBLE",
)

SCORES = (("S_pend", "s_pend"), ("S_jump", "s_jump"), ("S_SW", "s_sw"))
MARGINS = (("CoM in BoS", "mos_com_m"), ("XCoM in BoS", "mos_xcom_m"))
MARGIN_SCALE_M = 0.4
BAR_CELLS = 25
NOT_AVAILABLE = "n/a"


def render(plan, scores, health, silent_s: float = 0.0) -> RenderableType:
    """A panel with gait phase, scores, margins and health; its border says when data are old."""
    if plan is None and scores is None and health is None:
        return Panel(Text(waiting(silent_s)), title="saddlewalk", border_style="yellow")
    silent = silent_s > SILENT_AFTER_S
    parts = [Text(gait(plan)), _levels(scores), Text(condition(health))]
    if silent:
        parts.append(Text(waiting(silent_s), style="bold red"))
    border = "red" if silent else "green"
    return Panel(Group(*parts), title="saddlewalk", border_style=border)


def summary(plan, scores, health, silent_s: float = 0.0) -> str:
    """The same on one line of plain text."""
    if silent_s > SILENT_AFTER_S or (plan is None and scores is None and health is None):
        return waiting(silent_s)
    numbers = [f"{label} {_number(scores, name)}" for label, name in (*SCORES, *MARGINS)]
    return " | ".join((gait(plan), "  ".join(numbers), condition(health)))


def waiting(silent_s: float) -> str:
    return f"no message from the firmware for {silent_s:.1f} s"


def gait(plan) -> str:
    """Where in the stride the plan is."""
    if plan is None:
        return "plan: none yet"
    if not plan.valid:
        return "plan: none"
    mode = MODES[plan.mode] if 0 <= plan.mode < len(MODES) else f"mode {plan.mode}"
    if plan.mode == plan.MODE_STANDING:
        return f"plan: {mode} after {plan.step_count} steps"
    support = "left" if plan.support == plan.LEFT else "right"
    turn = plan.theta_rad / (2 * math.pi)
    return (
        f"plan: {mode}, step {plan.step_count}, phase {plan.phase} ({turn:4.0%} of the stride), "
        f"support {support}, {plan.speed_m_s:.2f} m/s, {_heel_strike(plan)}"
    )


def _heel_strike(plan) -> str:
    foreseen = plan.time_to_heel_strike_s < TIME_MAX_S
    return f"heel strike in {plan.time_to_heel_strike_s:.2f} s" if foreseen else "no heel strike"


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
        parts.append(f"status {_status_name(health.status)}")
    parts += [
        f"{label} {' '.join(names)}"
        for label, names in (
            ("limits", bit_names(health.limits, LIMITS)),
            ("faults", bit_names(health.faults, FAULTS)),
        )
        if names
    ]
    return "health: " + ", ".join(parts)


def bit_names(bits: int, names: tuple[str, ...]) -> list[str]:
    """Names of the bits that are set; a bit without a name is given as its number."""
    return [
        names[bit] if bit < len(names) else f"bit{bit}"
        for bit in range(bits.bit_length())
        if bits >> bit & 1
    ]


def _status_name(status: int) -> str:
    return STATUSES[status] if 0 <= status < len(STATUSES) else str(status)


def _levels(scores) -> Table:
    table = Table.grid(padding=(0, 1))
    table.add_column(min_width=12)
    table.add_column()
    table.add_column(justify="right", min_width=8)
    for label, name in SCORES:
        value = _value(scores, name)
        table.add_row(label, level_bar(value), _number(scores, name))
    for label, name in MARGINS:
        value = _value(scores, name)
        table.add_row(label, margin_bar(value), _number(scores, name))
    return table


def level_bar(value: float) -> Text:
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


def _value(scores, name: str) -> float:
    return math.nan if scores is None else getattr(scores, name)


def _number(scores, name: str) -> str:
    value = _value(scores, name)
    if math.isnan(value):
        return NOT_AVAILABLE
    return f"{value:+.3f} m" if name.endswith("_m") else f"{value:.2f}"
