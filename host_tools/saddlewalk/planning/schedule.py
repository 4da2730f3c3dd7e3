"""A schedule of walking speeds, and the walk from standing that follows it.

A schedule is a CSV file with the columns `t_s` (from 0, increasing), `speed_m_s` (0: stand) and, if
the walk turns, `turn_rad_s` (to the left): each row is commanded from its time on.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from saddlewalk.contract import SIDES, STARTING, STOPPING, TICK_S
from saddlewalk.core import Command, Core, Measurement
from saddlewalk.errors import UserError
from saddlewalk.table import read_any_series

LONGEST_S = 1e6
FASTEST_TURN_RAD_S = 10.0
_COLUMNS = (("t_s", "speed_m_s", "turn_rad_s"), ("t_s", "speed_m_s"))
_SAME_TIME_S = 1e-9

# (start time, s, from 0; speed, m/s, 0: stand; turning rate, rad/s, if the walk turns)
Speeds = Sequence[tuple[float, float] | tuple[float, float, float]]
Schedule = Callable[[float], Command]  # the command at a time of the walk, s


def schedule_of(speeds: Speeds, heel_strike_rad: float) -> Schedule:
    """The command at any time from 0 on."""
    starts_s = [from_s for from_s, *_ in speeds]

    def at(time_s: float) -> Command:
        _, speed_m_s, *turn_rad_s = speeds[bisect_right(starts_s, time_s + _SAME_TIME_S) - 1]
        return Command(speed_m_s, heel_strike_rad, *turn_rad_s)

    return at


@dataclass(frozen=True)
class SpeedChange:
    """One row of a schedule."""

    line: int
    from_s: float
    speed_m_s: float
    turn_rad_s: float = 0.0


@dataclass(frozen=True)
class Event:
    """`heel_strike_left`, `toe_off_right`, ...: t_s is finer than the ticks."""

    name: str
    t_s: float


@dataclass(frozen=True)
class Instant:
    """The walk at t_s: the core's saddle_output_t, and the events since the instant before."""

    t_s: float
    output: Any
    wish: SpeedChange
    events: tuple[Event, ...]


def read_schedule(source: str) -> list[SpeedChange]:
    """Raises UserError naming the file, the line and the column that is wrong."""
    changes: list[SpeedChange] = []
    for line, cells in read_any_series(source, _COLUMNS, LONGEST_S):
        t_s, speed_m_s = cells["t_s"], cells["speed_m_s"]
        turn_rad_s = cells.get("turn_rad_s", 0.0)
        if not changes and t_s != 0:
            raise UserError(f"{source}: line {line}, t_s: {t_s:g} must be 0: where the walk begins")
        if not 0 <= speed_m_s < math.inf:
            raise UserError(
                f"{source}: line {line}, speed_m_s: {speed_m_s:g} must be 0 or more, finite"
            )
        if not abs(turn_rad_s) <= FASTEST_TURN_RAD_S:
            raise UserError(
                f"{source}: line {line}, turn_rad_s: {turn_rad_s:g} must be in "
                f"-{FASTEST_TURN_RAD_S:g} to {FASTEST_TURN_RAD_S:g}"
            )
        changes.append(SpeedChange(line, t_s, speed_m_s, turn_rad_s))
    if not changes:
        raise UserError(f"{source}: no rows: give at least 0 in t_s and a speed_m_s")
    return changes


def check_straight(source: str, changes: list[SpeedChange], what: str) -> None:
    """Raises UserError if the schedule turns, which `what` cannot."""
    for wish in changes:
        if wish.turn_rad_s:
            raise UserError(
                f"{source}: line {wish.line}, turn_rad_s: {wish.turn_rad_s:g} must be 0 with {what}"
            )


def speeds_of(changes: list[SpeedChange]) -> Speeds:
    return [(wish.from_s, wish.speed_m_s, wish.turn_rad_s) for wish in changes]


def walk(
    core: Core, changes: list[SpeedChange], heel_strike_rad: float, dt_s: float
) -> Iterator[Instant]:
    """Instants from standing at t = k dt, without end; with ticks in between if dt is long."""
    starts_s = [wish.from_s for wish in changes]
    ticks_per_row = math.ceil(dt_s / TICK_S - _SAME_TIME_S)
    tick_s = dt_s / ticks_per_row
    before: Any = None
    events: list[Event] = []
    tick = 0
    while True:
        t_s = tick * tick_s
        wish = changes[bisect_right(starts_s, t_s + _SAME_TIME_S) - 1]
        command = Command(wish.speed_m_s, heel_strike_rad, wish.turn_rad_s)
        output = core.tick(round(t_s * 1e6), command, Measurement())
        if before is not None:
            since_s = t_s - tick_s
            events += [
                Event(name, since_s + min(after_s, tick_s))
                for name, after_s in _events(before.plan, output.plan)
            ]
        if tick % ticks_per_row == 0:
            yield Instant(tick // ticks_per_row * dt_s, output, wish, tuple(events))
            events = []
        before, tick = output, tick + 1


def _events(before: Any, after: Any) -> list[tuple[str, float]]:
    """Events between two plans a tick apart, with the time to them that the first predicts."""
    swung, swings = _swing_foot(before), _swing_foot(after)
    stepped_on = (before.mode, after.mode) == (STOPPING, STARTING)
    changed = swings != swung or stepped_on
    events = []
    if swung and not _has_struck(before) and (changed or _has_struck(after)):
        strike_s = min(before.time_to_heel_strike_s, before.time_to_via_point_s)
        events.append((f"heel_strike_{swung}", strike_s))
    if swings and changed:
        events.append((f"toe_off_{swings}", before.time_to_via_point_s))
    return events


def _swing_foot(plan: Any) -> str | None:
    """The swing foot; None in double support."""
    return SIDES[1 - plan.support] if plan.step_length_m > 0 else None


def _has_struck(plan: Any) -> bool:
    """The swing foot's heel is on the ground, and its CoP not yet."""
    return plan.time_to_heel_strike_s == 0
