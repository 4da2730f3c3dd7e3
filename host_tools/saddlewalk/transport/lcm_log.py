"""Reads LCM event logs in blocks. Every length is checked against the file before it is used.

A log is events one after another, each big endian: sync word, event number (64 bits), timestamp
(64 bits, microseconds since 1970), length of the channel name and of the data (32 bits each),
channel name, data. The lcm package's own reader trusts these lengths and crashes on some.
"""

import os
import stat
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from saddlewalk.errors import UserError

SYNC = bytes.fromhex("eda1da01")
CHANNEL_MAX = 63  # bytes, as LCM has it
DATA_MAX = 1 << 20  # longer data are cut; our messages are much shorter
BLOCK = 4 << 20
START = 1 << 16
_HEADER = struct.Struct(">4sQqII")


class Event(NamedTuple):
    """One message of an LCM log."""

    logged_us: int
    channel: str
    data: bytes


def is_lcm_log(path: Path) -> bool:
    """Whether an event may begin in its first bytes, of which some may be damaged.

    Raises UserError for a file that is empty or cannot be read.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise UserError(f"{path} is not an ordinary file: give a log")
        with path.open("rb") as file:
            start = file.read(START)
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    if not start:
        raise UserError(f"{path} is empty: give a log with messages")
    return SYNC in start


class LcmLog:
    """The events of a log, in order; iterate as often as needed.

    An event is valid if its lengths are possible and the next event or the end of the file follows
    it. Other bytes are skipped up to the next event.
    """

    def __init__(self, path: Path) -> None:
        """Raises UserError for a file that is not an LCM log, or has no event."""
        if not is_lcm_log(path):
            raise UserError(
                f"{path} is not an LCM log: give one from lcm-logger or `saddlewalk demo`"
            )
        self.path = path
        self.events = 0  # read so far, as are all of these
        self.lost = 0  # bytes that are not an event
        self._first_lost = 0
        if next(iter(self), None) is None:
            raise UserError(f"{path}: none of its events can be read: {self.broken}")

    @property
    def broken(self) -> str:
        """What could not be read, as text; empty if all was read."""
        if not self.lost:
            return ""
        return (
            f"{self.lost} bytes of the log are not an event, as where one was cut or damaged; "
            f"the first is byte {self._first_lost}"
        )

    def __iter__(self) -> Iterator[Event]:
        self.events = self.lost = place = 0
        with self.path.open("rb", buffering=0) as file:
            blocks = _Blocks(file.fileno())
            while place < blocks.size:
                found = _event(blocks, place)
                if found is None:
                    place = self._skip(blocks, place)
                    continue
                event, place = found
                self.events += 1
                yield event

    def _skip(self, blocks: "_Blocks", place: int) -> int:
        """The place of the next sync word, or the end."""
        following = blocks.find(SYNC, place + 1)
        if not self.lost:
            self._first_lost = place
        self.lost += following - place
        return following


def _event(blocks: "_Blocks", place: int) -> tuple[Event, int] | None:
    """The event at a place and where it ends, if it is whole."""
    header = blocks.read(place, _HEADER.size)
    if len(header) < _HEADER.size:
        return None
    sync, _, logged_us, name_size, data_size = _HEADER.unpack(header)
    name_at = place + _HEADER.size
    end = name_at + name_size + data_size
    if sync != SYNC or not 0 < name_size <= CHANNEL_MAX or end > blocks.size:
        return None
    if not SYNC.startswith(blocks.peek(end, len(SYNC))):  # the end of the file, or a cut sync word
        return None
    body = blocks.read(name_at, name_size + min(data_size, DATA_MAX))
    channel = body[:name_size].decode(errors="backslashreplace")
    return Event(logged_us, channel, body[name_size:]), end


class _Blocks:
    """Random access to a file's bytes, with one block in memory."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self.size = os.fstat(descriptor).st_size
        self._block, self._first = b"", 0

    def read(self, place: int, size: int) -> bytes:
        """Up to `size` bytes, at most BLOCK."""
        at = place - self._first
        if at < 0 or at + size > len(self._block):
            self._block, self._first, at = self._load(place), place, 0
        return self._block[at : at + size]

    def peek(self, place: int, size: int) -> bytes:
        """As read(), without moving the block."""
        at = place - self._first
        if at >= 0 and at + size <= len(self._block):
            return self._block[at : at + size]
        return os.pread(self._descriptor, size, place)

    def find(self, wanted: bytes, place: int) -> int:
        """The next place of `wanted`; the end of the file if there is none."""
        while place < self.size:
            at = place - self._first
            if not 0 <= at <= len(self._block) - len(wanted):
                self._block, self._first, at = self._load(place), place, 0
            found = self._block.find(wanted, at)
            if found >= 0:
                return self._first + found
            if len(self._block) < len(wanted):
                break
            place = self._first + len(self._block) - len(wanted) + 1
        return self.size

    def _load(self, place: int) -> bytes:
        return os.pread(self._descriptor, min(BLOCK, self.size - place), place)
