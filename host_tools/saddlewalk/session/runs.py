"""The runs in an LCM log, as columns of the numbers that the report needs, tick by tick.

A day of walking is a million ticks, so of each only these numbers are kept, none wider than
needed: some 120 bytes of the 1500 or so that are logged.
"""

from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from saddlewalk.contract import TICK_S
from saddlewalk.dashboard import SILENT_AFTER_S
from saddlewalk.errors import UserError
from saddlewalk.logs.messages import Kind, UnknownMessages, kinds
from saddlewalk.transport.lcm_log import LcmLog
from saddlewalk.verdict import reason_words

FIRMWARE = tuple("config input plan scores verdict balance bos health status".split())
NUMBERED = ("health", "status", "input")  # messages that carry their tick's number
NO_NUMBER = -(2**31)
RUNS_MAX = 20  # more are two firmware processes that were logged at once
BLOCK = 4096  # messages of a channel that are kept before they are reduced

# Available columns of each channel: members, or elements of an array by index.
KEPT: dict[str, tuple[str | tuple[str, int], ...]] = {
    "input": (
        *("command_age_us", "com_age_us", "left_age_us", "right_age_us"),
        *(("com_velocity_m_s", 0), ("left_m", 0), ("left_m", 1), ("right_m", 0), ("right_m", 1)),
        *("left_contact", "right_contact"),
    ),
    "plan": (
        *("valid", "mode", "support", "step_count", "origin_x_m", "speed_m_s"),
        *(("com_m", 0), ("left_m", 1), ("right_m", 1), "time_to_toe_off_s"),
    ),
    "scores": ("s_pend", "s_jump", "s_sw", "mos_com_m", "mos_xcom_m"),
    "verdict": (
        *("level", "reason", "compared", "excess_stop_j", "excess_track_j", "recovery_margin_m"),
    ),
    "balance": ("driver", "margin", "caution_below"),
    "health": ("status", "limits", "faults"),
}


@dataclass(frozen=True)
class Span:
    """Successive ticks with the same value."""

    value: Any
    ticks: slice
    start_s: float
    duration_s: float


@dataclass(frozen=True)
class Spans:
    """Spans in order of time, as columns."""

    value: np.ndarray
    first: np.ndarray  # tick
    end: np.ndarray  # the tick after the last
    start_s: np.ndarray
    duration_s: np.ndarray

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self) -> Iterator[Span]:
        columns = (self.value, self.first, self.end, self.start_s, self.duration_s)
        rows = zip(*(column.tolist() for column in columns), strict=True)
        for value, first, end, start_s, duration_s in rows:
            yield Span(value, slice(first, end), start_s, duration_s)

    def where(self, chosen: np.ndarray) -> "Spans":
        """The spans selected by a mask or by indices."""
        return Spans(
            self.value[chosen],
            self.first[chosen],
            self.end[chosen],
            self.start_s[chosen],
            self.duration_s[chosen],
        )

    def worst(self, most: int) -> "Spans":
        """Up to `most` spans: those with the largest values, then the longest; in order of time."""
        order = np.lexsort((-self.duration_s, -self.value))
        return self.where(np.sort(order[:most]))


class Channel:
    """The messages of one channel in a run."""

    def __init__(self, kind: Kind) -> None:
        self.kind = kind
        self.last = b""  # message
        self._ticks = 0  # of the run, up to the last message
        self._without = array("I")  # of these, the ticks in which none came
        self._columns = {key: bytearray() for key in KEPT.get(kind.name, ())}
        self._block: list[bytes] = []

    def add(self, tick: int, data: bytes) -> None:
        self._without.extend(range(self._ticks, tick))
        self._ticks = tick + 1
        self.last = data
        if self._columns:
            self._block.append(data)
            if len(self._block) == BLOCK:
                self._keep()

    def kept(self, key: str | tuple[str, int]) -> np.ndarray:
        """A number of each message."""
        self._keep()
        return np.frombuffer(self._columns[key], self._type(key))

    def there(self, ticks: int) -> np.ndarray:
        """The ticks of the run that have a message."""
        there = np.zeros(ticks, bool)
        there[: self._ticks] = True
        there[np.frombuffer(self._without, np.uint32)] = False
        return there

    def _keep(self) -> None:
        """Reduce the messages that are held to the numbers that are needed."""
        messages = np.frombuffer(b"".join(self._block), self.kind.layout)
        self._block = []
        for key, column in self._columns.items():
            member, *element = (key,) if isinstance(key, str) else key
            numbers = messages[member]
            numbers = numbers[:, element[0]] if element else numbers
            column += numbers.astype(self._type(key)).tobytes()

    def _type(self, key: str | tuple[str, int]) -> np.dtype:
        """The LCM type, except for ages: float, for milliseconds."""
        member = key if isinstance(key, str) else key[0]
        assert self.kind.layout is not None  # of a kind that is KEPT
        logged = self.kind.layout[member].base.newbyteorder("=")
        return np.dtype(np.float32) if logged == np.int64 else logged


@dataclass(frozen=True)
class Run:
    """One run of the firmware, of at least one tick. Times count from its first tick in the log."""

    utime_us: "array[int]"  # of each tick
    numbers: "array[int]"  # of ticks, from 0 at the firmware's start; NO_NUMBER: unknown
    channels: dict[str, Channel]  # by name, as `plan`
    falls: "array[int]"  # ticks during which an emulated wearer fell

    @property
    def fell_s(self) -> float | None:
        """The tick's time at which an emulated wearer fell; None if it did not."""
        if not self.falls:
            return None
        return float(self.time_s[min(self.falls[0], self.ticks - 1)])

    @property
    def ticks(self) -> int:
        return len(self.utime_us)

    @cached_property
    def time_s(self) -> np.ndarray:
        utime_us = np.frombuffer(self.utime_us, np.uint64)  # whose differences cannot overflow
        return (utime_us - utime_us[0]) / 1e6

    @cached_property
    def silent_s(self) -> np.ndarray:
        """The silence after each tick, if it is too long for the tick's values to hold; else 0."""
        after_s = np.diff(self.time_s)
        return np.append(np.where(after_s > SILENT_AFTER_S, after_s - TICK_S, 0.0), 0.0)

    @cached_property
    def after_silence(self) -> np.ndarray:
        """The ticks that follow such a silence."""
        return np.append(False, self.silent_s[:-1] > 0)

    @cached_property
    def hold_s(self) -> np.ndarray:
        """How long each tick's values hold: to the next tick, or one period before a silence."""
        return np.diff(self.time_s, append=self.time_s[-1] + TICK_S) - self.silent_s

    @property
    def duration_s(self) -> float:
        return float(self.time_s[-1]) + TICK_S

    def number(self, tick: int) -> int | None:
        """The tick's number since the firmware's start; None if not logged."""
        number = self.numbers[tick]
        return None if number == NO_NUMBER else number

    def has(self, name: str) -> bool:
        return name in self.channels

    def last(self, name: str) -> Any:
        """The last message of a channel, or None."""
        channel = self.channels.get(name)
        return channel.kind.decode(channel.last) if channel else None

    def column(self, name: str, member: str, element: int | None = None) -> np.ndarray:
        """One of KEPT for each tick; NaN where it is unknown."""
        if name not in self.channels:
            return np.full(self.ticks, np.nan, np.float32)
        kept = self.channels[name].kept(member if element is None else (member, element))
        exact = kept.dtype == np.float32 or kept.dtype.itemsize < 4
        numbers = np.full(self.ticks, np.nan, np.float32 if exact else np.float64)
        numbers[self.channels[name].there(self.ticks)] = kept
        numbers[~np.isfinite(numbers)] = np.nan  # also a signalling NaN
        return numbers

    def bits(self, name: str, member: str) -> np.ndarray:
        """The bits of a message for each tick; 0 where it did not come."""
        bits = np.zeros(self.ticks, np.int32)
        if name in self.channels:
            bits[self.channels[name].there(self.ticks)] = self.channels[name].kept(member)
        return bits

    def logged(self, name: str, member: str) -> np.ndarray:
        """A number of each message that was logged."""
        return self.channels[name].kept(member)

    def spans(self, values: np.ndarray) -> Spans:
        """Spans of equal values; a silence ends a span."""
        ends = (values[1:] != values[:-1]) | self.after_silence[1:]
        first = np.append(0, np.flatnonzero(ends) + 1)
        held_s = np.add.reduceat(self.hold_s, first)
        return Spans(
            values[first], first, np.append(first[1:], self.ticks), self.time_s[first], held_s
        )

    @cached_property
    def levels(self) -> np.ndarray:
        """The announced level of each tick, an index of verdict.LEVELS; -1: no verdict."""
        return np.nan_to_num(self.column("verdict", "level"), nan=-1).astype(np.int8)

    def reasons(self, ticks: slice) -> list[str]:
        """The reasons during these ticks as text, in order of time."""
        codes = self._reasons[ticks]
        numbers, first = np.unique(codes[codes >= 0], return_index=True)
        words = (reason_words(int(number)) for number in numbers[np.argsort(first)])
        return [each for each in words if each]

    def lowest_margin(self, ticks: slice) -> tuple[int, float, str] | None:
        """(tick, margin, its driver as text) of the lowest margin; None if no margin is known."""
        margins = self._margins[ticks]
        if not np.isfinite(margins).any():
            return None
        tick = ticks.start + int(np.nanargmin(margins))
        driver = int(self.column("balance", "driver")[tick])
        return tick, float(self._margins[tick]), reason_words(driver)

    @cached_property
    def upright(self) -> slice:
        """The ticks before an emulated wearer fell, or all."""
        return slice(0, min(self.falls[0], self.ticks) if self.falls else self.ticks)

    @cached_property
    def _margins(self) -> np.ndarray:
        return self.column("balance", "margin")

    @cached_property
    def _reasons(self) -> np.ndarray:
        return np.nan_to_num(self.column("verdict", "reason"), nan=-1).astype(np.int16)


@dataclass(frozen=True)
class Session:
    """A whole log."""

    runs: list[Run]
    logged_us: tuple[int, int]  # first and last event, since 1970
    events: int
    unreadable: UnknownMessages  # messages of unknown types
    fell: bool | None  # the emulated wearer; None: there was none
    broken: str  # what could not be read, as text


def load_session(path: Path) -> Session:
    """Raises UserError for a file that is not an LCM log, or has no message from the firmware."""
    log = LcmLog(path)
    gathered = _Gathered()
    logged_us: list[int] = []  # of the first event and the last
    for event in log:
        logged_us[1:] = [event.logged_us]
        gathered.take(event.channel, event.data)
        if len(gathered.runs) > RUNS_MAX:
            raise UserError(
                f"{path}: more than {RUNS_MAX} runs, as when two firmware processes are logged at "
                f"once: give a log of up to {RUNS_MAX}"
            )
    gathered.end_tick()
    unreadable = gathered.unreadable
    if not gathered.runs:
        others = f", on {', '.join(map(repr, sorted(unreadable)[:5]))}," if unreadable else ""
        raise UserError(
            f"{path}: none of its {log.events} messages{others} is one that "
            "this version's firmware sends: give a log of SADDLEWALK_ channels"
        )
    return Session(
        gathered.runs,
        (logged_us[0], logged_us[-1]),
        log.events,
        unreadable,
        gathered.fell,
        log.broken,
    )


class _Gathered:
    """Sorts messages into runs.

    Messages with the same time are one tick, unless one comes twice; a config_t alone is not a
    tick. A run ends where the time or the tick's number goes back.
    """

    def __init__(self) -> None:
        self.runs: list[Run] = []
        self.unreadable = UnknownMessages()
        self.fell: bool | None = None
        self._lies = False
        self._utime_us = 0
        self._tick: dict[str, bytes] = {}  # messages of the current tick, by name
        self._number = -1  # the last in the run

    def take(self, channel: str, data: bytes) -> None:
        kind = kinds().get(channel)
        if kind is None or not _is_message(kind, data):
            self.unreadable.add(channel)
        elif kind.name in FIRMWARE:
            utime_us = _integer(data, 8, 8)
            if utime_us != self._utime_us or kind.name in self._tick:
                self.end_tick()
                self._utime_us = utime_us
            self._tick[kind.name] = data
        elif kind.name == "truth":
            self._take_truth(bool(kind.decode(data).fallen))

    def _take_truth(self, fallen: bool) -> None:
        if fallen and not self._lies and self.runs:
            self.runs[-1].falls.append(self.runs[-1].ticks)
        self._lies = fallen
        self.fell = self.fell or fallen

    def end_tick(self) -> None:
        """The current tick is complete."""
        tick, self._tick = self._tick, {}
        if not tick.keys() - {"config"}:
            return
        number = next((_integer(tick[name], 16, 4) for name in NUMBERED if name in tick), None)
        run = self.runs[-1] if self.runs else None
        again = number is not None and number <= self._number
        if run is None or again or self._utime_us <= run.utime_us[-1]:
            run = Run(array("q"), array("i"), {}, array("I"))
            self.runs.append(run)
            self._number = -1
        self._number = self._number if number is None else number
        for name, data in tick.items():
            if name not in run.channels:
                run.channels[name] = Channel(kinds()[f"SADDLEWALK_{name.upper()}"])
            run.channels[name].add(run.ticks, data)
        run.utime_us.append(self._utime_us)
        run.numbers.append(NO_NUMBER if number is None else number)


def _is_message(kind: Kind, data: bytes) -> bool:
    return kind.is_whole(data) if kind.layout is not None else kind.decode(data) is not None


def _integer(data: bytes, at: int, size: int) -> int:
    """An integer of an encoded message. utime_us is the first member; in NUMBERED, tick is the
    second.
    """
    return int.from_bytes(data[at : at + size], "big", signed=True)
