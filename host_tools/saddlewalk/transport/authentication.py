"""Authenticated commands and times, as `docs/authentication.md` describes them: the sender.

The counterpart of the guard in `<saddlewalk/wire.h>`.
"""

import re
import secrets
import struct
from pathlib import Path

import can
from cryptography.hazmat.primitives.ciphers.algorithms import AES
from cryptography.hazmat.primitives.cmac import CMAC

from saddlewalk.errors import UserError
from saddlewalk.transport.wire import Receiver, Sender, changed, identifier

KEY_BYTES = 16
FRESHNESS_MAX = 65535


def read_key(path: Path) -> bytes:
    """The key in a file, under the conditions of saddlewalk-host's --command-key."""
    try:
        text, mode = path.read_text().strip(), path.stat().st_mode
    except (OSError, UnicodeDecodeError):
        text, mode = "", 0
    if not re.fullmatch(f"[0-9a-fA-F]{{{2 * KEY_BYTES}}}", text) or mode & 0o077:
        raise UserError(
            f"--command-key {path}: give a file with {2 * KEY_BYTES} hexadecimal digits that only "
            "its owner may read (chmod 600)"
        )
    return bytes.fromhex(text)


def write_new_key(path: Path) -> None:
    """A random key in a new file that only its owner may read."""
    path.touch(mode=0o600, exist_ok=False)
    path.write_text(secrets.token_hex(KEY_BYTES) + "\n")


class Authenticator:
    """Makes each COMMAND and the COMMAND_CODE that precedes it, and each MEASURED_TIME.

    The codes are for the session in the firmware's SESSION frames: give hear() every frame that is
    received.
    """

    def __init__(self, key: bytes) -> None:
        """key: 16 bytes, the firmware's. Raises UserError for another length."""
        if len(key) != KEY_BYTES:
            raise UserError(f"the command key has {len(key)} bytes: give {KEY_BYTES}")
        self._key = key
        self._receiver = Receiver()
        self._session: int | None = None
        self._freshness = 0

    def hear(self, frame: can.Message) -> None:
        """Remember the session; other frames are ignored."""
        if frame.arbitration_id != identifier("SESSION"):
            return
        accepted = self._receiver.accept(frame)
        if accepted and accepted[1]["SESSION"] != self._session:
            self._session, self._freshness = int(accepted[1]["SESSION"]), 0

    def frames(self, sender: Sender, **command: float) -> list[can.Message]:
        """COMMAND_CODE and COMMAND, to be sent in this order; empty without a session."""
        if self._session is None or self._freshness == FRESHNESS_MAX:
            return []
        self._freshness += 1
        frame = sender.frame("COMMAND", **command)
        code = code_of(self._key, self._session, self._freshness, frame)
        return [sender.frame("COMMAND_CODE", FRESHNESS=self._freshness, CODE=code), frame]

    def time_frames(self, sender: Sender, time_us: int) -> list[can.Message]:
        """MEASURED_TIME; empty without a session."""
        frame = sender.frame("MEASURED_TIME", TIME=time_us, CODE=0)
        if self._session is None:
            return []
        return [changed(frame, CODE=time_code_of(self._key, self._session, frame))]


def code_of(key: bytes, session: int, freshness: int, command: can.Message) -> int:
    """The first 4 bytes of the AES-128-CMAC of session, freshness, identifier and frame."""
    cmac = CMAC(AES(key))
    cmac.update(struct.pack("<IHH", session, freshness, command.arbitration_id))
    cmac.update(bytes(command.data))
    return int.from_bytes(cmac.finalize()[:4], "big")


def time_code_of(key: bytes, session: int, frame: can.Message) -> int:
    """The first 2 bytes, likewise, of a MEASURED_TIME without its CRC and code; freshness is 0."""
    covered = bytes(1) + bytes(frame.data[1:6]) + bytes(2)
    covered_frame = can.Message(arbitration_id=frame.arbitration_id, data=covered)
    return code_of(key, session, 0, covered_frame) >> 16
