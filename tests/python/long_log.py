"""Logs made from other logs, byte by byte: long ones and damaged ones."""

import struct
from collections.abc import Iterable
from pathlib import Path

from saddlewalk.transport.lcm_log import SYNC, Event, LcmLog

HEADER = struct.Struct(">4sQqII")
TICK_US = 80_000
NUMBERED = ("SADDLEWALK_INPUT", "SADDLEWALK_HEALTH", "SADDLEWALK_STATUS")


def encoded(event: Event, number: int = 0) -> bytes:
    """An event as it stands in a log."""
    name = event.channel.encode()
    header = HEADER.pack(SYNC, number, event.logged_us, len(name), len(event.data))
    return header + name + event.data


def write_long_log(path: Path, source: Path, size: int) -> int:
    """One run of at least that many bytes, the run of another log over and over; its ticks."""
    events = list(LcmLog(source))
    ticks = sum(event.channel == NUMBERED[0] for event in events)
    past = written = 0
    with path.open("wb") as file:
        while written < size:
            block = b"".join(encoded(_later(event, past)) for event in events)
            written += file.write(block)
            past += ticks
    return past


def _later(event: Event, ticks: int) -> Event:
    data = bytearray(event.data)
    _add(data, ">q", 8, ticks * TICK_US)
    if event.channel in NUMBERED:
        _add(data, ">i", 16, ticks)
    return Event(event.logged_us + ticks * TICK_US, event.channel, bytes(data))


def _add(data: bytearray, form: str, at: int, more: int) -> None:
    (number,) = struct.unpack_from(form, data, at)
    struct.pack_into(form, data, at, number + more)


def write_log(path: Path, events: Iterable[Event]) -> Path:
    path.write_bytes(b"".join(map(encoded, events)))
    return path
