"""CAN logs, read by python-can, with limits on the memory and time that a file can make it use."""

import logging
import struct
import zlib
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import IO, Any

import can
from can.io.generic import FileIOMessageReader

from saddlewalk.errors import UserError

# Not python-can's .db: in a database, a view can run code in place of a table.
SUFFIXES = (".log", ".blf", ".asc", ".trc", ".csv")
LINE_MAX = 4096  # characters
IDENTIFIERS = 1 << 29
FRAME_MAX = 64  # bytes of data, of CAN FD
CONTAINER_MAX = 16 << 20  # bytes of BLF, packed and unpacked; writers take 128 KiB
OBJECT_MAX = 1 << 18  # bytes within a container; a frame has some 100
_BLF_OBJECT = struct.Struct("<4sHHLL")  # also the start of a container
_BLF_CONTAINER = struct.Struct("<H14x")
_CONTAINER, _DEFLATED = 10, 2


class CanLog:
    """The frames of a CAN log in order. Its suffix names the format."""

    def __init__(self, path: Path) -> None:
        """Raises UserError for a file that is not a CAN log, or holds no frame."""
        self.path = path
        self.frames = 0  # read so far
        self.broken = ""  # what could not be read, as text; empty: all was read
        if next(iter(self), None) is None:
            raise UserError(f"{path} holds no CAN frame{self.broken and f': {self.broken}'}")

    def __iter__(self) -> Iterator[can.Message]:
        remarks = _Remarks()
        reader = self._open()
        logger = logging.getLogger("can")
        logger.addHandler(remarks)
        propagated, logger.propagate = logger.propagate, False
        self.frames, self.broken = 0, ""
        try:
            with reader:
                yield from self._read(reader)
        finally:
            logger.removeHandler(remarks)
            logger.propagate = propagated
        if remarks.count and not self.broken:
            self.broken = f"{remarks.count} entries cannot be read; the first: {remarks.first}"

    def _read(self, reader: Any) -> Iterator[can.Message]:
        frames = iter(reader)
        while True:
            try:
                frame = _checked(next(frames))
            except StopIteration:
                return
            except Exception as error:  # readers raise any exception for bytes that are not a log
                self.broken = f"it cannot be read beyond {self.frames} records: {_words(error)}"
                return
            self.frames += 1
            yield frame

    def _open(self) -> Any:
        suffix = self.path.suffix.lower()
        try:
            if suffix not in SUFFIXES:
                raise ValueError(f"{suffix or 'no suffix'} is none of these")
            if suffix == ".blf":
                return _Blf(self.path)
            reader = can.LogReader(self.path)
        except OSError as error:
            raise UserError(f"{self.path}: {error.strerror}") from error
        except Exception as error:  # each format's reader raises its own exceptions
            raise UserError(
                f"{self.path} is neither an LCM log nor a CAN log that can be read "
                f"({', '.join(SUFFIXES)}): {_words(error)}"
            ) from error
        if isinstance(reader, FileIOMessageReader):
            reader.file = _Lines(reader.file)
        return reader


class _Remarks(logging.Handler):
    """Counts python-can's warnings: one for each entry that it skips."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.count, self.first = 0, ""

    def emit(self, record: logging.LogRecord) -> None:
        self.count += 1
        self.first = self.first or record.getMessage()


class _Lines:
    """The lines of a text file, with a limit on their length."""

    def __init__(self, file: IO[str]) -> None:
        self._file = file

    def __iter__(self) -> "_Lines":
        return self

    def __next__(self) -> str:
        line = self._file.readline(LINE_MAX)
        if not line:
            raise StopIteration
        if len(line) == LINE_MAX and not line.endswith("\n"):
            raise ValueError(f"a line is longer than {LINE_MAX} characters")
        return line

    def close(self) -> None:
        self._file.close()


def _checked(frame: can.Message) -> can.Message:
    """The frame, if it is valid on CAN: python-can does not check what it reads."""
    if not 0 <= frame.arbitration_id < IDENTIFIERS:
        raise ValueError(f"a frame has identifier {frame.arbitration_id:#x}")
    if len(frame.data) > FRAME_MAX:
        raise ValueError(f"a frame has {len(frame.data)} bytes of data")
    return frame


class _Blf(can.BLFReader):
    """python-can's BLF reader, with the sizes in the file checked first, which it trusts."""

    def __init__(self, path: Path) -> None:
        try:
            super().__init__(path)
        except Exception:
            self.file.close()
            raise

    def __iter__(self) -> Generator[can.Message, None, None]:
        while header := self.file.read(_BLF_OBJECT.size):
            signature, _, _, size, kind = _BLF_OBJECT.unpack(header)
            if signature != b"LOBJ":
                raise ValueError("an object does not begin as one")
            _check_size(size, CONTAINER_MAX)
            body = self.file.read(size - _BLF_OBJECT.size)
            self.file.read(size % 4)
            if kind == _CONTAINER:
                data = _unpacked(body)
                _check_objects(self._tail + data)
                yield from self._parse_container(data)
            if len(body) + _BLF_OBJECT.size < size:
                raise ValueError("the log ends within an object")


def _check_size(size: int, most: int) -> None:
    if not _BLF_OBJECT.size <= size <= most:
        raise ValueError(f"an object has {size} bytes")


def _unpacked(body: bytes) -> bytes:
    (method,) = _BLF_CONTAINER.unpack_from(body)
    data = body[_BLF_CONTAINER.size :]
    if method != _DEFLATED:
        return data
    inflating = zlib.decompressobj()
    data = inflating.decompress(data, CONTAINER_MAX)
    if inflating.unconsumed_tail:
        raise ValueError(f"a container has more than {CONTAINER_MAX} bytes")
    return data


def _check_objects(data: bytes) -> None:
    at = 0
    while (at := data.find(b"LOBJ", at, at + 8)) >= 0 and at + _BLF_OBJECT.size <= len(data):
        size = _BLF_OBJECT.unpack_from(data, at)[3]
        _check_size(size, OBJECT_MAX)
        at += size


def _words(error: Exception) -> str:
    return str(error) or type(error).__name__
