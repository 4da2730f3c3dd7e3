"""Faults between the emulated wearer and the firmware, from a scenario file.

A scenario is a TOML file, such as `examples/faults.toml`: a `[walk]`, and `[[fault]]` tables, each
of a class of KINDS with its strengths. Faults happen to frames, between what is measured and the
bus; only `clock` and `stall` happen to the firmware itself. Times are seconds of the walk.
"""

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import can
import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.toml_file import read_toml
from saddlewalk.transport import wire

INPUTS = ("COMMAND", "MEASURED_COM", "MEASURED_LEFT", "MEASURED_RIGHT")
MEASURED = INPUTS[1:]
CLOCK = ("MEASURED_TIME",)
MESSAGES = INPUTS + CLOCK
FRAME_BITS = 8 * wire.FRAME_LENGTH
BURSTS_HZ = 1.0
FLIPPED_SHARE = 0.5  # of the frames have flipped bits
LONGEST_S = 3600.0

_NUMBERS = {
    "COMMAND": ("SPEED", "HEEL_STRIKE"),
    "MEASURED_COM": ("HEIGHT", "VX", "VY"),
    "MEASURED_LEFT": ("X", "Y"),
    "MEASURED_RIGHT": ("X", "Y"),
}


@dataclass(frozen=True, order=True)
class Arrival:
    """A frame that reaches the firmware at time_s."""

    time_s: float
    order: int  # order of simultaneous arrivals
    frame: can.Message = field(compare=False)
    born_s: float = field(compare=False)  # when its content was measured
    forged: bool = field(default=False, compare=False)  # bits flipped, or from another sender


Disturbance = Callable[[Arrival], list[Arrival]]  # the same object if it is unchanged


@dataclass(frozen=True)
class Kind:
    """A class of faults. disturb: None for faults of the firmware, not of frames."""

    strength: str  # meaning of the strength, with its unit
    low: float
    high: float
    disturb: Callable[[float, np.random.Generator], Disturbance] | None
    messages: tuple[str, ...] = MESSAGES


def _none(_: float, __: np.random.Generator) -> Disturbance:
    return lambda arrival: [arrival]


def _loss(share: float, random: np.random.Generator) -> Disturbance:
    return lambda arrival: [] if random.random() < share else [arrival]


def _burst(length_s: float, random: np.random.Generator) -> Disturbance:
    """All frames are lost for a while: at once, and again at random times."""
    begin_s = -math.inf

    def disturb(arrival: Arrival) -> list[Arrival]:
        nonlocal begin_s
        if math.isinf(begin_s):
            begin_s = arrival.time_s
        while arrival.time_s >= begin_s + length_s:
            begin_s += length_s + random.exponential(1 / BURSTS_HZ)
        return [] if arrival.time_s >= begin_s else [arrival]

    return disturb


def _delay(delay_s: float, _: np.random.Generator) -> Disturbance:
    return lambda arrival: [replace(arrival, time_s=arrival.time_s + delay_s)]


def _reorder(within_s: float, random: np.random.Generator) -> Disturbance:
    return lambda arrival: [replace(arrival, time_s=arrival.time_s + random.random() * within_s)]


def _jitter(within_s: float, random: np.random.Generator) -> Disturbance:
    """Random delays, in order: none overtakes another."""
    last_s = -math.inf

    def disturb(arrival: Arrival) -> list[Arrival]:
        nonlocal last_s
        last_s = max(last_s, arrival.time_s + random.random() * within_s)
        return [replace(arrival, time_s=last_s)]

    return disturb


def _batch(every_s: float, _: np.random.Generator) -> Disturbance:
    """A gateway that keeps frames and forwards them together, every so often."""

    def disturb(arrival: Arrival) -> list[Arrival]:
        return [replace(arrival, time_s=math.ceil(arrival.time_s / every_s) * every_s)]

    return disturb


def _of_clock(arrival: Arrival, off_s: float) -> list[Arrival]:
    time_us = wire.signals(arrival.frame)["TIME"] + round(off_s * 1e6)
    return [replace(arrival, frame=wire.changed(arrival.frame, TIME=time_us % wire.TIMES))]


def _drift(ppm: float, _: np.random.Generator) -> Disturbance:
    return lambda arrival: _of_clock(arrival, arrival.born_s * ppm / 1e6)


def _jump(off_s: float, _: np.random.Generator) -> Disturbance:
    return lambda arrival: _of_clock(arrival, off_s)


def _duplicate(copies: float, _: np.random.Generator) -> Disturbance:
    return lambda arrival: [arrival, *[replace(arrival) for _ in range(round(copies))]]


def _stuck(_: float, __: np.random.Generator) -> Disturbance:
    """Every frame repeats the values of the first one, with a new counter."""
    first: dict[int, Arrival] = {}

    def disturb(arrival: Arrival) -> list[Arrival]:
        held = first.setdefault(arrival.frame.arbitration_id, arrival)
        if held is arrival:
            return [arrival]
        signals = wire.signals(arrival.frame)
        own = {name: signals[name] for name in ("COUNTER", "ROUND")}
        frame = wire.changed(held.frame, **own)
        return [replace(arrival, frame=frame, born_s=held.born_s)]

    return disturb


def _numbers(frame: can.Message) -> tuple[str, ...]:
    """What an input of CoM and feet measures or commands, and every number of another frame."""
    name = wire.known_name(frame.arbitration_id)
    return _NUMBERS.get(name) or wire.numbers(name)


def _added(arrival: Arrival, amount: Callable[[str], float]) -> list[Arrival]:
    """The frame with amount(signal) added to each number, in its unit."""
    values = wire.signals(arrival.frame)
    names = _numbers(arrival.frame)
    numbers = {name: values[name] + amount(name) for name in names}
    return [replace(arrival, frame=wire.changed(arrival.frame, **numbers))]


def _noise(deviation: float, random: np.random.Generator) -> Disturbance:
    return lambda arrival: _added(arrival, lambda _: random.normal(0.0, deviation))


def _bias(size: float, random: np.random.Generator) -> Disturbance:
    """A constant offset of random sign for each number of each message."""
    signs: dict[tuple[int, str], float] = {}

    def disturb(arrival: Arrival) -> list[Arrival]:
        identifier = arrival.frame.arbitration_id
        return _added(
            arrival,
            lambda name: size * signs.setdefault((identifier, name), random.choice((-1.0, 1.0))),
        )

    return disturb


def _flip(bits: float, random: np.random.Generator) -> Disturbance:
    def disturb(arrival: Arrival) -> list[Arrival]:
        if random.random() >= FLIPPED_SHARE:
            return [arrival]
        data = bytearray(arrival.frame.data)
        for bit in random.choice(FRAME_BITS, round(bits), replace=False).tolist():
            data[bit // 8] ^= 1 << bit % 8
        frame = can.Message(arrival.frame.timestamp, arrival.frame.arbitration_id, False, data=data)
        return [replace(arrival, frame=frame, forged=True)]

    return disturb


def _spoof(share: float, random: np.random.Generator) -> Disturbance:
    """A share of the frames is followed by one from another sender, with a valid CRC, a counter out
    of sequence and other values.
    """

    def disturb(arrival: Arrival) -> list[Arrival]:
        if random.random() >= share:
            return [arrival]
        values = wire.signals(arrival.frame)
        steps = (0, *range(wire.COUNTER_STEP_MAX + 1, wire.COUNTERS))
        other = {"COUNTER": (values["COUNTER"] + int(random.choice(steps))) % wire.COUNTERS}
        name = wire.known_name(arrival.frame.arbitration_id)
        if name == "COMMAND":
            other |= {"MODE": int(random.integers(2)), "SPEED": float(random.uniform(0, 2))}
        else:
            numbers = {
                signal: float(random.normal(values[signal], 0.5)) for signal in _NUMBERS[name]
            }
            other |= numbers
        return [arrival, replace(arrival, frame=wire.changed(arrival.frame, **other), forged=True)]

    return disturb


def _nan(share: float, random: np.random.Generator) -> Disturbance:
    def disturb(arrival: Arrival) -> list[Arrival]:
        if random.random() >= share:
            return [arrival]
        names = _numbers(arrival.frame)
        broken = {str(random.choice(names)): math.nan}
        return [replace(arrival, frame=wire.changed(arrival.frame, **broken))]

    return disturb


KINDS = {
    "none": Kind("unused", 0, 0, _none),
    "loss": Kind("share of the frames that are lost", 0, 1, _loss),
    "burst": Kind("how long all frames are lost, about once a second, s", 0, LONGEST_S, _burst),
    "delay": Kind("delay of the frames, s", 0, LONGEST_S, _delay),
    "duplicate": Kind("copies of each frame", 0, 100, _duplicate),
    "reorder": Kind("maximum of the random delay of each frame, s", 0, 60, _reorder),
    "jitter": Kind("maximum of the random delay of each frame, in order, s", 0, 60, _jitter),
    "batch": Kind("between two forwardings of a gateway, s", 0.001, LONGEST_S, _batch),
    "drift": Kind("rate of the sender's clock less 1, ppm", -1e6, 1e6, _drift, CLOCK),
    "jump": Kind("by which the sender's clock is off, s", -LONGEST_S, LONGEST_S, _jump, CLOCK),
    "stuck": Kind("unused: it repeats its first values", 0, 1, _stuck, MEASURED),
    "noise": Kind("standard deviation in m, m/s and rad", 0, 1000, _noise, INPUTS),
    "bias": Kind("added to or taken from each number, m, m/s and rad", 0, 1000, _bias, INPUTS),
    "flip": Kind(f"bits flipped in {FLIPPED_SHARE:.0%} of the frames", 1, FRAME_BITS, _flip),
    "spoof": Kind("share of frames that another sender's follow", 0, 1, _spoof, INPUTS),
    "nan": Kind("share of the frames with a NaN", 0, 1, _nan, INPUTS),
    "clock": Kind("by which the firmware's clock jumps once, s", -LONGEST_S, LONGEST_S, None),
    "stall": Kind("how long the firmware's process stalls, s", 0, LONGEST_S, None),
}


@dataclass(frozen=True)
class Fault:
    """A fault at one strength. messages: the affected frames; empty: one of its class's, or all."""

    kind: str
    strength: float
    messages: tuple[str, ...]
    from_s: tuple[float, float]  # range of its start
    for_s: float


@dataclass(frozen=True)
class Scenario:
    """Each run is a walk at a random speed in a range, with one of the faults."""

    speed_m_s: tuple[float, float]
    duration_s: float
    faults: tuple[Fault, ...]


@dataclass(frozen=True)
class Occurrence:
    """A fault drawn for one walk."""

    kind: str
    strength: float
    messages: tuple[str, ...]
    begin_s: float
    end_s: float

    @property
    def is_of_frames(self) -> bool:
        return KINDS[self.kind].disturb is not None


def draw(fault: Fault, random: np.random.Generator) -> Occurrence:
    """Draw the time of a fault and the messages that it affects: one input, or all messages."""
    messages, known = fault.messages, KINDS[fault.kind].messages
    if not messages:
        inputs = tuple(name for name in known if name in INPUTS) or known
        one = int(random.integers(2 * len(inputs)))
        messages = inputs[one : one + 1] or known
    begin_s = float(random.uniform(*fault.from_s))
    return Occurrence(fault.kind, fault.strength, messages, begin_s, begin_s + fault.for_s)


class Line:
    """The path of frames to the firmware, with its faults. Deterministic for a seed."""

    def __init__(self, occurrences: Sequence[Occurrence], random: np.random.Generator) -> None:
        self.onset_s = math.inf  # when a frame was first affected
        self._waiting: list[Arrival] = []
        self._sent = itertools.count()
        self._disturbances = [
            (occurrence, disturb(occurrence.strength, random))
            for occurrence in occurrences
            if (disturb := KINDS[occurrence.kind].disturb) is not None
        ]

    def send(self, frame: can.Message, time_s: float) -> None:
        arrivals = [Arrival(time_s, 0, frame, time_s)]
        name = wire.known_name(frame.arbitration_id)
        for occurrence, disturb in self._disturbances:
            if occurrence.begin_s <= time_s < occurrence.end_s and name in occurrence.messages:
                before = arrivals
                arrivals = [after for arrival in before for after in disturb(arrival)]
                if [*map(id, before)] != [*map(id, arrivals)]:
                    self.onset_s = min(self.onset_s, time_s)
        for arrival in arrivals:
            heapq.heappush(self._waiting, replace(arrival, order=next(self._sent)))

    def due(self, time_s: float) -> list[Arrival]:
        """The frames that arrive by time_s, in order."""
        arrivals = []
        while self._waiting and self._waiting[0].time_s <= time_s:
            arrivals.append(heapq.heappop(self._waiting))
        return arrivals


def read_scenario(path: Path) -> Scenario:
    """Raises UserError naming the file, the table, the key and what is accepted."""
    top = _Table(str(path), read_toml(path), {"walk", "fault"})
    walk = _Table(f"{path}: [walk]", top.get("walk", {}), {"speed_m_s", "duration_s"})
    faults = top.get("fault", [])
    if not isinstance(faults, list) or not faults:
        raise UserError(f"{path}: give at least one [[fault]]")
    return Scenario(
        speed_m_s=walk.span("speed_m_s", 0.1, 2.0),
        duration_s=walk.number("duration_s", 1.0, LONGEST_S),
        faults=tuple(
            fault
            for index, table in enumerate(faults, 1)
            for fault in _faults(f"{path}: [[fault]] {index}", table)
        ),
    )


def _faults(where: str, table: Any) -> list[Fault]:
    """A fault for each strength."""
    keys = {"class", "strength", "messages", "from_s", "for_s"}
    fault = _Table(where, table, keys)
    name = fault.get("class", None)
    if name not in KINDS:
        raise UserError(f"{where}: class = {name!r} must be one of {', '.join(KINDS)}")
    kind = KINDS[name]
    messages = fault.get("messages", [])
    if not isinstance(messages, list) or any(one not in kind.messages for one in messages):
        raise UserError(f"{where}: messages = {messages!r} must be of {', '.join(kind.messages)}")
    return [
        Fault(
            kind=name,
            strength=strength,
            messages=tuple(messages),
            from_s=fault.span("from_s", 0.0, LONGEST_S),
            for_s=fault.number("for_s", 0.0, LONGEST_S),
        )
        for strength in fault.numbers("strength", kind.low, kind.high)
    ]


class _Table:
    """A TOML table; `where` names it in errors."""

    def __init__(self, where: str, table: Any, keys: set[str]) -> None:
        if not isinstance(table, dict):
            raise UserError(f"{where}: must be a table")
        for name in table.keys() - keys:
            raise UserError(f"{where}: {name} is not one of {', '.join(sorted(keys))}")
        self._where, self._table = where, table

    def get(self, name: str, default: Any) -> Any:
        return self._table.get(name, default)

    def numbers(self, name: str, low: float, high: float) -> list[float]:
        """A number or a list of numbers."""
        if name not in self._table:
            raise UserError(f"{self._where}: no {name}: give it in {low:g} to {high:g}")
        value = self._table[name]
        values = value if isinstance(value, list) else [value]
        good = values and all(
            isinstance(one, int | float) and not isinstance(one, bool) and low <= one <= high
            for one in values
        )
        if not good:
            raise UserError(f"{self._where}: {name} = {value!r} must be in {low:g} to {high:g}")
        return [float(one) for one in values]

    def number(self, name: str, low: float, high: float) -> float:
        numbers = self.numbers(name, low, high)
        if len(numbers) != 1:
            raise UserError(f"{self._where}: {name} = {numbers} must be one number")
        return numbers[0]

    def span(self, name: str, low: float, high: float) -> tuple[float, float]:
        """A range: two numbers, or one for both ends."""
        numbers = self.numbers(name, low, high)
        if len(numbers) > 2 or numbers != sorted(numbers):
            raise UserError(f"{self._where}: {name} = {numbers} must be one number, or two rising")
        return numbers[0], numbers[-1]
