"""Recomputes logged runs from their inputs and compares each output, bit for bit.

An LCM log holds all that a run was given: SADDLEWALK_CONFIG, and with each tick SADDLEWALK_INPUT.
So it can be recomputed on any machine, whatever its clock was. A CAN log holds the frames that
came. That is all that a run in lockstep was given, but for its configuration; in real time the
ages of the measurements, and commands by LCM, were inputs too, which are in no frame.
"""

import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from saddlewalk import __version__
from saddlewalk.config import ANKLES
from saddlewalk.contract import TICK_S
from saddlewalk.errors import UserError
from saddlewalk.firmware import Firmware, default_config, ffi, library
from saddlewalk.logs.messages import decode
from saddlewalk.transport.lcm_log import Event

TIME_MAX_US = 2**63 - 1  # of LCM's signed times
GAPS_MAX = 20  # gaps that are listed separately
# Channels that older firmware did not publish: a log without them is still complete.
ADDED_CHANNELS = {"SADDLEWALK_BALANCE", "SADDLEWALK_WAY"}
# What input_t does not have. Without them, as in older logs, the walk is straight and on a floor.
ADDED_INPUTS = {"SADDLEWALK_TURN": "turn", "SADDLEWALK_FEET": "feet"}
HEALTH_FIELDS = ("tick", "status", "limits", "faults")  # the core's; the others are the host's
_PACKED = {"float": ">f", "double": ">d", "int8_t": ">b", "int32_t": ">i", "int64_t": ">q"}


@dataclass(frozen=True)
class Difference:
    """A tick's first output that differs from what the core computes."""

    tick: int
    name: str  # the message and its field
    recorded: str
    recomputed: str

    def __str__(self) -> str:
        return (
            f"tick {self.tick} ({self.tick * TICK_S:.2f} s), {self.name}: "
            f"recorded {self.recorded}, recomputed {self.recomputed}"
        )


@dataclass
class Report:
    """The result: what was recomputed, the first difference, and what could not be compared."""

    source: str = ""
    runs: int = 0
    ticks: int = 0
    compared: int = 0  # messages or frames
    different_ticks: int = 0
    first: Difference | None = None
    gaps: list[str] = field(default_factory=list)  # the first of them
    further_gaps: int = 0
    missing: dict[str, "Missing"] = field(default_factory=dict)  # by the output's name
    not_logged: list[str] = field(default_factory=list)  # of ADDED_CHANNELS

    @property
    def not_compared(self) -> list[str]:
        """The parts of the log that could not be compared, as text."""
        further = [f"{self.further_gaps} further gaps"] if self.further_gaps else []
        lost = (
            f"{name} of {lack.ticks} ticks is not in the log, the first time of tick {lack.first}"
            for name, lack in self.missing.items()
        )
        return [*self.gaps, *further, *lost]

    @property
    def sound(self) -> bool:
        """Every recorded output was recomputed and is equal."""
        return self.first is None and not self.not_compared

    def add_difference(self, difference: Difference) -> None:
        self.first = self.first or difference
        self.different_ticks += 1

    def add_gap(self, gap: str) -> None:
        """Report a part of the log that cannot be compared."""
        if len(self.gaps) < GAPS_MAX:
            self.gaps.append(gap)
        else:
            self.further_gaps += 1

    def add_missing(self, name: str, tick: int) -> None:
        """Report a tick without this output."""
        self.missing.setdefault(name, Missing(tick)).ticks += 1


@dataclass
class Missing:
    """Ticks without an output."""

    first: int
    ticks: int = 0


@dataclass
class LoggedTick:
    """One tick of an LCM log."""

    number: int  # from 0 in each run
    inputs: Any  # saddle_input_t
    config: Any  # the config_t that came with it, or None
    outputs: dict[str, Any] = field(default_factory=dict)  # channel -> Event


def rerun_lcm(events: Iterable[Event]) -> Report:
    """Recompute the runs of an LCM log. Raises UserError if no tick can be recomputed."""
    rerun = _LcmRerun()
    for tick in logged_ticks(events):
        rerun.take(tick)
    rerun.end_run()
    rerun.ignore_added_channels()
    if not rerun.report.ticks:
        raise UserError(
            rerun.report.gaps[0]
            if rerun.report.gaps
            else "no SADDLEWALK_INPUT, from which a run is recomputed: it was "
            "logged without that channel, or by a firmware that did not publish it"
        )
    return rerun.report


def logged_ticks(events: Iterable[Event]) -> Iterator[LoggedTick]:
    """Each SADDLEWALK_INPUT with the messages of the same time, which are those of its tick."""
    tick, config = None, None
    for event in events:
        if event.channel == "SADDLEWALK_CONFIG":
            config = event
        elif event.channel == "SADDLEWALK_INPUT":
            if tick:
                yield tick
            tick, config = _begun(event, config), None
        elif tick and _utime_us(event) == tick.inputs.time_us:
            if event.channel in ADDED_INPUTS:
                _add(event, tick.inputs)
            tick.outputs[event.channel] = event
    if tick:
        yield tick


def _begun(event: Event, config: Event | None) -> LoggedTick:
    inputs, number = ffi().new("saddle_input_t *"), ffi().new("int32_t *")
    if not library().saddle_lcm_decode_input(event.data, len(event.data), inputs, number):
        raise UserError(
            f"a message of {len(event.data)} bytes on SADDLEWALK_INPUT is not an input_t as "
            f"saddlewalk {__version__} has it"
        )
    if inputs.time_us > TIME_MAX_US:
        raise UserError(
            f"tick {number[0]} on SADDLEWALK_INPUT has a negative time: the log is damaged"
        )
    if config is not None and _utime_us(config) != inputs.time_us:
        config = None
    return LoggedTick(number[0], inputs, None if config is None else decode(config))


def _add(event: Event, inputs: Any) -> None:
    name = ADDED_INPUTS[event.channel]
    if not getattr(library(), f"saddle_lcm_decode_{name}")(event.data, len(event.data), inputs):
        raise UserError(
            f"a message of {len(event.data)} bytes on {event.channel} is not a {name}_t as "
            f"saddlewalk {__version__} has it"
        )


def _utime_us(event: Event) -> int:
    """utime_us of an encoded message: the first member, after LCM's fingerprint of the type."""
    return int.from_bytes(event.data[8:16], "big", signed=True)


class _LcmRerun:
    """Takes the ticks of a log, one run after another."""

    def __init__(self) -> None:
        self.report = Report()
        self._firmware: Firmware | None = None  # None: the state of the core is not known
        self._config: Any = None  # config_t of the run
        self._why = ""  # it is not known
        self._first_unknown = 0
        self._last: int | None = None

    def take(self, tick: LoggedTick) -> None:
        if tick.number == 0:
            self._begin_run(tick)
        elif self._last is None:
            self._lose(tick.number, "the log begins in mid-run, without the state of the core")
        elif tick.number != self._last + 1:
            self._lose(tick.number, f"tick {self._last} is followed by tick {tick.number}")
        self._last = tick.number
        if self._firmware:
            self._compute(self._firmware, tick)

    def end_run(self) -> None:
        """Report the ticks that could not be computed."""
        if self._why:
            self.report.add_gap(
                f"{self._why}: ticks {self._first_unknown} to {self._last} cannot be computed"
            )
        self._why, self._firmware, self._last = "", None, None

    def ignore_added_channels(self) -> None:
        """An added channel that came with no tick was not published: no gap."""
        for channel in ADDED_CHANNELS & self.report.missing.keys():
            if self.report.missing[channel].ticks == self.report.ticks:
                del self.report.missing[channel]
                self.report.not_logged.append(channel)

    def _begin_run(self, tick: LoggedTick) -> None:
        self.end_run()
        if tick.config is None:
            self._lose(0, "no config_t came with tick 0")
            return
        self._config = tick.config
        self._firmware = Firmware(_core_config(tick.config))
        self.report.source = _source(tick.config)
        self.report.runs += 1

    def _lose(self, number: int, why: str) -> None:
        if not self._why:
            self._why, self._first_unknown = why, number
        self._firmware = None

    def _compute(self, firmware: Firmware, tick: LoggedTick) -> None:
        output = firmware.tick(tick.inputs)
        self.report.ticks += 1
        differences = [
            self._compare(tick, channel, data)
            for channel, data in firmware.messages(tick.inputs.time_us).items()
        ]
        health = (tick.number, output.status, output.limits, output.faults)
        differences.append(self._compare_health(tick, health))
        first = next(filter(None, differences), None)
        if first:
            self.report.add_difference(first)
        if tick.config and _fields(tick.config) != _fields(self._config):
            self._adapt(firmware, tick)

    def _adapt(self, firmware: Firmware, tick: LoggedTick) -> None:
        """The plan follows what was learned of the wearer, from the next tick on."""
        if firmware.adapt(_core_config(tick.config)):
            self._config = tick.config
        else:
            self.report.add_gap(f"the configuration changes at tick {tick.number}")

    def _recorded(self, tick: LoggedTick, channel: str) -> Event | None:
        event = tick.outputs.get(channel)
        if event is None:
            self.report.add_missing(channel, tick.number)
        else:
            self.report.compared += 1
        return event

    def _compare(self, tick: LoggedTick, channel: str, recomputed: bytes) -> Difference | None:
        event = self._recorded(tick, channel)
        if event is None or event.data == recomputed:
            return None
        return _difference(tick.number, event, recomputed)

    def _compare_health(self, tick: LoggedTick, recomputed: tuple[int, ...]) -> Difference | None:
        event = self._recorded(tick, "SADDLEWALK_HEALTH")
        if event is None:
            return None
        health = decode(event)
        if health is None:
            return _unreadable(tick.number, event)
        for name, value in zip(HEALTH_FIELDS, recomputed, strict=True):
            if getattr(health, name) != value:
                values = (str(getattr(health, name)), str(value))
                return Difference(tick.number, f"{event.channel} {name}", *values)
        return None


def _source(config: Any) -> str:
    clock = "lockstep" if config.lockstep else "real time"
    text = f"saddlewalk {config.library_version}, wire {config.wire_version}, {clock}"
    return text if config.library_version == __version__ else f"{text}; this is {__version__}"


def _fields(config: Any) -> list[tuple[str, float]]:
    return [("ankle", config.ankle), *zip(config.name, config.value, strict=True)]


def _core_config(message: Any) -> Any:
    """A config_t as saddle_config_t. Raises UserError if its fields differ from this version's."""
    config = default_config()
    fields = dict(_fields(message))
    known = {name for name, _ in ffi().typeof(config).item.fields}
    for names, fault in ((fields.keys() - known, "is not"), (known - fields.keys(), "is")):
        if names:
            raise UserError(
                f"its configuration is of saddlewalk {message.library_version}, and {min(names)} "
                f"{fault} a field of {__version__}'s: give a log of the same version"
            )
    if fields["ankle"] not in ANKLES.values():
        raise UserError(f"its configuration has ankle {fields['ankle']}: the log is damaged")
    for name, value in fields.items():
        setattr(config, name, value)
    return config


def _difference(tick: int, event: Event, recomputed: bytes) -> Difference:
    """Names the first field that differs."""
    recorded = decode(event)
    if recorded is None:
        return _unreadable(tick, event)
    ours = _flat(type(recorded).decode(recomputed))
    for name, (kind, value) in _flat(recorded).items():
        if _bits(kind, value) != _bits(*ours[name]):
            values = _text(kind, value), _text(*ours[name])
            return Difference(tick, f"{event.channel} {name}", *values)
    return Difference(tick, event.channel, event.data.hex(), recomputed.hex())


def _unreadable(tick: int, event: Event) -> Difference:
    return Difference(tick, event.channel, f"{len(event.data)} bytes of no such type", "a message")


def _flat(message: Any) -> dict[str, tuple[str, Any]]:
    """Fields of an LCM message and elements of arrays: name -> (LCM type, value)."""
    flat: dict[str, tuple[str, Any]] = {}
    for name, kind in zip(message.__slots__, message.__typenames__, strict=True):
        value = getattr(message, name)
        if isinstance(value, list | tuple):
            flat |= {f"{name}[{i}]": (kind, element) for i, element in enumerate(value)}
        else:
            flat[name] = (kind, value)
    return flat


def _bits(kind: str, value: float) -> bytes:
    return struct.pack(_PACKED[kind], value)


def _text(kind: str, value: float) -> str:
    if isinstance(value, int):
        return str(value)
    return f"{value:.{9 if kind == 'float' else 17}g} (0x{_bits(kind, value).hex()})"
