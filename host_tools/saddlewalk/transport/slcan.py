"""CAN frames as text on a stream: SLCAN, `tIIILDD..` and a carriage return, hexadecimal digits.

python-can's own `slcan` bus reads a byte at a time, which is ten times as slow with a controller
that QEMU emulates.
"""

import collections
import contextlib
import select
import socket
import time

import can

from saddlewalk.errors import UserError

_CHUNK = 65536
_LEAVE_S = 2.0
_HEADER = 5  # characters of tIIIL


class SlcanBus(can.BusABC):
    """A connected socket with a controller at the other end, which this bus closes.

    `malformed` counts lines that are not a classic data frame with an 11-bit identifier.
    """

    def __init__(self, line: socket.socket, description: str) -> None:
        self.channel_info = description
        self.malformed = 0
        self._line = line
        self._begun = b""  # the line that has not ended yet
        self._frames: collections.deque[can.Message] = collections.deque()
        super().__init__(channel=description)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Raises UserError if the other end has closed."""
        try:
            self._line.sendall(text_of(msg))
        except OSError as error:
            raise self._gone() from error

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self._frames:
            left = None if deadline is None else max(0.0, deadline - time.monotonic())
            if not select.select([self._line], [], [], left)[0]:
                return None, False
            self._take(self._line.recv(_CHUNK))
        return self._frames.popleft(), False

    def _take(self, text: bytes) -> None:
        if not text:
            raise self._gone()
        *lines, self._begun = (self._begun + text).split(b"\r")
        for line in lines:
            frame = frame_of(line)
            self.malformed += frame is None
            if frame:
                self._frames.append(frame)

    def _gone(self) -> UserError:
        return UserError(f"{self.channel_info} has ended")

    def fileno(self) -> int:
        return self._line.fileno()

    def shutdown(self) -> None:
        """Close the channel, and wait for the other side to disconnect."""
        super().shutdown()
        if self._line.fileno() < 0:
            return
        self._line.settimeout(_LEAVE_S)
        with contextlib.suppress(OSError):
            self._line.sendall(b"C\r")
            while self._line.recv(_CHUNK):
                pass
        self._line.close()


def text_of(frame: can.Message) -> bytes:
    """The line of a classic data frame."""
    return f"t{frame.arbitration_id:03X}{frame.dlc}{frame.data.hex().upper()}\r".encode()


def frame_of(line: bytes) -> can.Message | None:
    """The frame of a line without its carriage return, stamped now; None if it is not a frame."""
    try:
        identifier, length = int(line[1:4], 16), int(line[4:_HEADER])
        data = bytes.fromhex(line[_HEADER:].decode())
    except ValueError:
        return None
    if line[:1] != b"t" or identifier > 0x7FF or len(data) != length or length > 8:
        return None
    return can.Message(
        arbitration_id=identifier, is_extended_id=False, data=data, timestamp=time.time()
    )
