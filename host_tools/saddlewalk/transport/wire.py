"""Saddlewalk's CAN messages, as `firmware/wire/saddlewalk.dbc` lays them out.

The counterpart of `firmware/wire`, equal to it in every bit: numbers are scaled in single
precision, saturate at the ends of their range, and are -32768 (-128 of 8 bits) on the wire and NaN
here when not available. `<saddlewalk/wire.h>` states the frame layout and the rule of the alive
counter.
"""

import math
from dataclasses import dataclass, field
from typing import cast

import can
import cantools
import numpy as np

from saddlewalk import paths
from saddlewalk.core import defined

FRAME_LENGTH = 8
COUNTERS = 16
ROUNDS = 8
TIMES = 1 << 32  # microseconds after which MEASURED_TIME wraps
COUNTER_STEP_MAX = 4

_database = cantools.database.load_file(paths.source("firmware/wire/saddlewalk.dbc"))
assert isinstance(_database, cantools.database.can.Database)
WIRE_VERSION = int(str(_database.version))
OLDEST_VERSION = int(defined("SADDLE_WIRE_OLDEST_VERSION", "wire/include/saddlewalk/wire.h"))


def _crc_of_byte(byte: int) -> int:
    for _ in range(8):
        byte = (byte << 1) ^ (0x11D if byte & 0x80 else 0)
    return byte


_CRC_TABLE = bytes(_crc_of_byte(byte) for byte in range(256))


def crc(data: bytes | bytearray) -> int:
    """CRC-8 SAE J1850. b"123456789" gives 0x4B."""
    value = 0xFF
    for byte in data:
        value = _CRC_TABLE[value ^ byte]
    return value ^ 0xFF


def frame_crc(identifier: int, data: bytes | bytearray) -> int:
    """Byte 0 of a frame: the CRC of its identifier, low byte first, and bytes 1 to 7."""
    return crc(identifier.to_bytes(2, "little") + data[1:])


class _Signal:
    """Physical value to raw and back. Signed signals are numbers, the others counts and codes."""

    def __init__(self, signal: cantools.database.can.Signal) -> None:
        self.is_number = signal.is_signed
        self._scale = np.float32(signal.scale)
        self._not_available = -(1 << (signal.length - 1))
        self._limit = float(np.float32(-1 - self._not_available) * self._scale)
        self._code_max = (1 << signal.length) - 1

    def raw(self, value: float | None) -> int:
        if not self.is_number:
            return min(max(int(value or 0), 0), self._code_max)
        if value is None or not math.isfinite(value):
            return self._not_available
        limited = np.float32(min(max(value, -self._limit), self._limit))
        scaled = float(limited / self._scale)
        return int(math.copysign(math.floor(abs(scaled) + 0.5), scaled))

    def value(self, raw: int) -> float:
        if not self.is_number:
            return raw
        return math.nan if raw == self._not_available else float(np.float32(raw) * self._scale)


class _Message:
    """One message of the database."""

    def __init__(self, message: cantools.database.can.Message) -> None:
        self.id = message.frame_id
        self.name = message.name
        self.signals = {signal.name: _Signal(signal) for signal in message.signals}
        self._codec = message

    def encode(self, counter: int, values: dict[str, float | None]) -> bytes:
        known: dict[str, float | None] = {
            "CRC": 0,
            "COUNTER": counter,
            "WIRE_VERSION": WIRE_VERSION,
            "ROUND": 0,
        }
        given = known | values
        raw = {name: signal.raw(given[name]) for name, signal in self.signals.items()}
        data = bytearray(self._codec.encode(raw, scaling=False, strict=False))
        data[0] = frame_crc(self.id, data)
        return bytes(data)

    def raw(self, data: bytes | bytearray) -> dict[str, int]:
        raw = self._codec.decode(bytes(data), decode_choices=False, scaling=False)
        return cast(dict[str, int], raw)

    def decode(self, data: bytes | bytearray) -> dict[str, float]:
        raw = self.raw(data)
        return {name: self.signals[name].value(raw[name]) for name in raw if name != "CRC"}


_messages = [_Message(message) for message in _database.messages]
_by_name = {message.name: message for message in _messages}
_by_id = {message.id: message for message in _messages}
_OWN = {"CRC", "COUNTER", "ROUND", "WIRE_VERSION"}
_IF_MISSING: dict[str, float | None] = {"TURN_RATE": 0.0, "GROUND": 0.0}


class Sender:
    """Makes sealed frames. Each message name has its own alive counter, from 0, and round."""

    def __init__(self) -> None:
        self._sent: dict[str, int] = {}

    def frame(self, name: str, **values: float | None) -> can.Message:
        """The next frame of a message, with every signal but CRC, COUNTER, ROUND and WIRE_VERSION
        given; without TURN_RATE a COMMAND goes straight on, and without GROUND a foot is on a
        floor.

        Numbers in SI units and rad; None or not finite is sent as not available. Raises ValueError
        for a name that the database does not have or a signal that is missing or too many.
        """
        if name not in _by_name:
            raise ValueError(f"message {name} is not one of {', '.join(_by_name)}")
        message = _by_name[name]
        expected = message.signals.keys() - _OWN
        values = {name: _IF_MISSING[name] for name in expected & _IF_MISSING.keys()} | values
        if values.keys() != expected:
            raise ValueError(f"{name} has {sorted(values)}: give {sorted(expected)}")
        sent = self._sent.get(name, 0)
        self._sent[name] = sent + 1
        rounds = {"ROUND": sent // COUNTERS % ROUNDS}
        data = message.encode(sent % COUNTERS, values | rounds)
        return can.Message(arbitration_id=message.id, is_extended_id=False, data=data)


def _follows(counter: int, before: int) -> bool:
    return 1 <= (counter - before) % COUNTERS <= COUNTER_STEP_MAX


@dataclass
class _Alive:
    """Alive counter of one received message: the last accepted, and the last out of step."""

    last: int
    candidate: int

    def accept(self, counter: int) -> bool:
        if counter == self.last:
            return False
        accepted = _follows(counter, self.last) or _follows(counter, self.candidate)
        self.candidate = counter
        if accepted:
            self.last = counter
        return accepted


@dataclass
class Receiver:
    """Checks frames by the rules of `saddle_wire_accept()`, for every message of the database."""

    accepted: int = 0
    malformed: int = 0  # not a classic 8-byte data frame, or an identifier not in the database
    bad_crc: int = 0
    bad_version: int = 0  # carries the wire version of another firmware
    bad_counter: int = 0  # repeated, or out of step
    _alive: dict[int, _Alive] = field(default_factory=dict, repr=False)

    @property
    def rejected(self) -> int:
        return self.malformed + self.bad_crc + self.bad_version + self.bad_counter

    def accept(self, frame: can.Message) -> tuple[str, dict[str, float]] | None:
        """(message name, its signals but the CRC), or None for a rejected frame, which is counted.

        A number that is not available is NaN.
        """
        message = _by_id.get(frame.arbitration_id)
        special = frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame
        if message is None or special or frame.is_fd or len(frame.data) != FRAME_LENGTH:
            self.malformed += 1
            return None
        if frame.data[0] != frame_crc(message.id, frame.data):
            self.bad_crc += 1
            return None
        values = message.decode(frame.data)
        oldest = OLDEST_VERSION if message.name == "COMMAND" else WIRE_VERSION
        if not oldest <= values.get("WIRE_VERSION", WIRE_VERSION) <= WIRE_VERSION:
            self.bad_version += 1
            return None
        if not self._in_step(message.id, int(values["COUNTER"])):
            self.bad_counter += 1
            return None
        self.accepted += 1
        return message.name, values

    def _in_step(self, identifier: int, counter: int) -> bool:
        if identifier not in self._alive:
            self._alive[identifier] = _Alive(counter, counter)
            return True
        return self._alive[identifier].accept(counter)


def raw_signals(identifier: int, data: bytes) -> dict[str, int]:
    """All signals of a frame as they are on the wire, CRC and COUNTER included, without checks."""
    return _by_id[identifier].raw(data)


def signals(frame: can.Message) -> dict[str, float]:
    """All signals but the CRC of a frame of ours, without checks."""
    return _by_id[frame.arbitration_id].decode(frame.data)


def changed(frame: can.Message, **values: float | None) -> can.Message:
    """A frame of ours with other values of some signals, COUNTER too if given, and sealed anew."""
    message = _by_id[frame.arbitration_id]
    data = message.encode(0, {**message.decode(frame.data), **values})
    return can.Message(frame.timestamp, message.id, is_extended_id=False, data=data)


def known_name(identifier: int) -> str:
    """The name of an identifier that is in the database."""
    return _by_id[identifier].name


def numbers(name: str) -> tuple[str, ...]:
    """The signals of a message of the database that are numbers, not counts or codes."""
    signals_of = _by_name[name].signals
    return tuple(signal for signal, codec in signals_of.items() if codec.is_number)


def message_name(identifier: int) -> str | None:
    """The name that the database has for an identifier, if any."""
    return _by_id[identifier].name if identifier in _by_id else None


def identifier(name: str) -> int:
    """Of a message of the database."""
    return _by_name[name].id
