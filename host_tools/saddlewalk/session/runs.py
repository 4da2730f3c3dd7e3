"""The runs that an LCM log holds, tick by tick, as columns of numbers."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from saddlewalk.dashboard import SILENT_AFTER_S
from saddlewalk.errors import UserError
from saddlewalk.logs.messages import CHANNEL_PREFIX, Event, decode, load_lcm_log
from saddlewalk.ticks import TICK_S
from saddlewalk.verdict import reason_words

FIRMWARE = tuple("config input plan scores verdict bos health status".split())
NUMBERED = ("health", "status", "input")  # messages that tell their tick's number
RUNS_MAX = 20  # more are two firmware processes that were logged at once


@dataclass
class Tick:
    """What the firmware published at one time."""

    utime_us: int
    messages: dict[str, Any]  # by the name of their channel, as `plan`

    @property
    def number(self) -> int | None:
        """From 0 at the start of the firmware; None if no message tells."""
        told = (self.messages[name].tick for name in NUMBERED if name in self.messages)
        return next(told, None)


@dataclass(frozen=True)
class Span:
    """Ticks after one another that share a value."""

    value: Any
    ticks: slice
    start_s: float
    duration_s: float


@dataclass(frozen=True)
class Run:
    """One run of the firmware, at least one tick. Times are since its first tick in the log."""

    ticks: list[Tick]

    @cached_property
    def time_s(self) -> np.ndarray:
        return np.array([(tick.utime_us - self.ticks[0].utime_us) / 1e6 for tick in self.ticks])

    @cached_property
    def silent_s(self) -> np.ndarray:
        """How long nothing came after each tick, if that is too long for it to hold; else 0."""
        after_s = np.diff(self.time_s)
        return np.append(np.where(after_s > SILENT_AFTER_S, after_s - TICK_S, 0.0), 0.0)

    @cached_property
    def hold_s(self) -> np.ndarray:
        """For how long each tick's messages hold: to the next tick, or one period."""
        return np.diff(self.time_s, append=self.time_s[-1] + TICK_S) - self.silent_s

    @property
    def duration_s(self) -> float:
        return float(self.time_s[-1]) + TICK_S

    def has(self, name: str) -> bool:
        return any(name in tick.messages for tick in self.ticks)

    def last(self, name: str) -> Any:
        """The last message of a channel, or None."""
        told = (tick.messages[name] for tick in reversed(self.ticks) if name in tick.messages)
        return next(told, None)

    def column(self, name: str, member: str, element: int | None = None) -> np.ndarray:
        """A number of each tick; NaN where it is not known."""
        numbers = np.array(
            [_number(tick.messages.get(name), member, element) for tick in self.ticks]
        )
        return np.where(np.isfinite(numbers), numbers, np.nan)

    def bits(self, name: str, member: str) -> np.ndarray:
        """A message's bits of each tick; 0 where it did not come."""
        return np.array(
            [getattr(tick.messages.get(name), member, 0) for tick in self.ticks], dtype=np.int64
        )

    def spans(self, values: np.ndarray) -> list[Span]:
        """Of one value a tick; silence ends a span."""
        silences = np.cumsum(np.append(0, self.silent_s[:-1] > 0))
        spans, first = [], 0
        for (value, _), group in groupby(zip(values.tolist(), silences, strict=True)):
            ticks = slice(first, first + len(list(group)))
            held_s = float(self.hold_s[ticks].sum())
            spans.append(Span(value, ticks, float(self.time_s[first]), held_s))
            first = ticks.stop
        return spans

    @cached_property
    def levels(self) -> np.ndarray:
        """The level announced, as verdict.LEVELS; -1: no verdict came."""
        return np.nan_to_num(self.column("verdict", "level"), nan=-1).astype(int)

    def reasons(self, ticks: slice) -> list[str]:
        """In words, in the order of their coming."""
        told = (t.messages["verdict"].reason for t in self.ticks[ticks] if "verdict" in t.messages)
        return [words for words in map(reason_words, dict.fromkeys(told)) if words]


@dataclass(frozen=True)
class Session:
    """A whole log."""

    runs: list[Run]
    logged_us: tuple[int, int]  # first and last event, since 1970
    events: int
    unreadable: Counter[str]  # channel -> messages of no type that this version has
    truth: list[Any]  # truth_t of an emulated wearer
    broken: str  # why the log could not be read to its end


def load_session(path: Path) -> Session:
    """Raises UserError for a file that is no LCM log, or holds nothing of the firmware's."""
    log = load_lcm_log(path)
    unreadable: Counter[str] = Counter()
    truth: list[Any] = []
    runs = list(_runs(_ticks(_told(log.records, unreadable, truth))))
    if not runs:
        others = f", on {', '.join(map(repr, sorted(unreadable)[:5]))}," if unreadable else ""
        raise UserError(
            f"{path}: none of its {len(log.records)} messages{others} is one that "
            "this version's firmware sends: give a log of SADDLEWALK_ channels"
        )
    if len(runs) > RUNS_MAX:
        raise UserError(
            f"{path}: {len(runs)} runs, as when two firmware processes are logged at once: give a "
            f"log of up to {RUNS_MAX}"
        )
    logged_us = log.records[0].logged_us, log.records[-1].logged_us
    return Session(runs, logged_us, len(log.records), unreadable, truth, log.broken)


def _told(
    events: list[Event], unreadable: Counter[str], truth: list[Any]
) -> Iterator[tuple[str, Any]]:
    """(name, message) of what the firmware says; the rest is counted or set apart."""
    for event in events:
        name, message = event.channel.removeprefix(CHANNEL_PREFIX).lower(), decode(event)
        if message is None:
            unreadable[event.channel] += 1
        elif name in FIRMWARE:
            yield name, message
        elif name == "truth":
            truth.append(message)


def _ticks(told: Iterator[tuple[str, Any]]) -> Iterator[Tick]:
    """Messages of one time, none twice, are one tick; a config_t alone is none."""
    tick = Tick(0, {})
    for name, message in told:
        if message.utime_us != tick.utime_us or name in tick.messages:
            if tick.messages.keys() - {"config"}:
                yield tick
            tick = Tick(message.utime_us, {})
        tick.messages[name] = message
    if tick.messages.keys() - {"config"}:
        yield tick


def _runs(ticks: Iterator[Tick]) -> Iterator[Run]:
    """A run ends where time or the ticks' number goes back."""
    run: list[Tick] = []
    number = -1
    for tick in ticks:
        again = tick.number is not None and tick.number <= number
        if run and (again or tick.utime_us <= run[-1].utime_us):
            yield Run(run)
            run, number = [], -1
        run.append(tick)
        number = number if tick.number is None else tick.number
    if run:
        yield Run(run)


def _number(message: Any, member: str, element: int | None) -> float:
    if message is None:
        return np.nan
    value = getattr(message, member)
    return float(value if element is None else value[element])
