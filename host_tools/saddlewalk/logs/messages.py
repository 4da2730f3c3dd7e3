"""Logs of runs, read to their end: LCM event logs, and CAN logs as python-can reads them."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import can
import lcm

from saddlewalk.errors import UserError
from saddlewalk.standard_error import standard_error_silent

LCM_START = bytes.fromhex("eda1da01")
CHANNEL_PREFIX = "SADDLEWALK_"
_EVENT_HEADER = 28  # bytes before the channel and the data


@dataclass(frozen=True)
class Event:
    """One message of an LCM log."""

    logged_us: int
    channel: str
    data: bytes


@dataclass(frozen=True)
class Log:
    """What could be read of a log, and in words what could not; empty: it was read to its end."""

    records: list[Any]  # Event or can.Message
    broken: str = ""


def is_lcm_log(path: Path) -> bool:
    """By its first bytes. Raises UserError for a file that is empty or cannot be read."""
    try:
        with path.open("rb") as file:
            start = file.read(len(LCM_START))
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    if not start:
        raise UserError(f"{path} is empty: give a log with something in it")
    return start == LCM_START


def load_lcm_log(path: Path) -> Log:
    """Every event of an LCM log. Raises UserError if there is none."""
    if not is_lcm_log(path):
        raise UserError(f"{path} is no LCM log: give one of lcm-logger or of `saddlewalk demo`")
    with standard_error_silent():
        events, broken = _collect(_lcm_events(path))
    left = path.stat().st_size - sum(map(_size, events))
    if left and not broken:
        broken = f"{left} bytes of the log are no event, as where one was cut or damaged"
    if not events:
        raise UserError(f"{path}: not one event of it can be read: {broken}")
    return Log(events, broken)


def load_can_log(path: Path) -> Log:
    """Every frame of a CAN log, of the format that its suffix names. Raises UserError if none."""
    try:
        reader = can.LogReader(path)
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    except Exception as error:  # each format's reader has errors of its own
        raise UserError(
            f"{path} is neither an LCM log nor a CAN log that python-can reads "
            f"(.log of candump, .blf, .asc, .trc, .csv, .db): {_one_line(error)}"
        ) from error
    with reader:
        frames, broken = _collect(reader)
    if not frames:
        raise UserError(f"{path} holds no CAN frame{broken and f': {broken}'}")
    return Log(frames, broken)


def decode(event: Event) -> Any:
    """The message of an event, by its channel's type; None if it is none of that type."""
    from saddlewalk.transport import lcm_types

    name = f"{event.channel.removeprefix(CHANNEL_PREFIX).lower()}_t"
    message_type = getattr(lcm_types, name, None)
    if message_type is None or not event.channel.startswith(CHANNEL_PREFIX):
        return None
    try:
        return message_type.decode(event.data)
    except Exception:  # the generated decoders raise ValueError, struct.error or IndexError
        return None


def _collect(records: Any) -> tuple[list[Any], str]:
    """What comes until a reader stumbles, and over what."""
    collected: list[Any] = []
    try:
        for record in records:
            collected.append(record)
    except Exception as error:  # whatever a reader makes of bytes that are no log
        return collected, f"it cannot be read on after {len(collected)} records: {_one_line(error)}"
    return collected, ""


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _lcm_events(path: Path) -> Iterator[Event]:
    log = lcm.EventLog(str(path), "r")
    try:
        for event in log:
            yield Event(event.timestamp, event.channel, event.data)
    finally:
        log.close()


def _size(event: Event) -> int:
    return _EVENT_HEADER + len(event.channel.encode()) + len(event.data)
