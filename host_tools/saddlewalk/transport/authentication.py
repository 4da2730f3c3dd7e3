"""Commands that are vouched for, as `docs/authentication.md` lays down: the commanding side.

Needs the extra `authentication`. The counterpart of the guard in `<saddlewalk/wire.h>`.
"""

import struct

import can

from saddlewalk.errors import UserError
from saddlewalk.paths import install_command
from saddlewalk.transport.wire import Receiver, Sender, identifier

KEY_BYTES = 16
FRESHNESS_MAX = 65535


class Voucher:
    """Makes each COMMAND together with the COMMAND_CODE that goes before it.

    It speaks in the session that the firmware's SESSION frames tell: give hear() every frame that
    is received.
    """

    def __init__(self, key: bytes) -> None:
        """key: 16 bytes, the firmware's. Raises UserError for another length."""
        if len(key) != KEY_BYTES:
            raise UserError(f"the key of commands has {len(key)} bytes: give {KEY_BYTES}")
        self._key = key
        self._receiver = Receiver()
        self._session: int | None = None
        self._freshness = 0

    def hear(self, frame: can.Message) -> None:
        """Take note of the session; anything else is passed over."""
        if frame.arbitration_id != identifier("SESSION"):
            return
        accepted = self._receiver.accept(frame)
        if accepted and accepted[1]["SESSION"] != self._session:
            self._session, self._freshness = accepted[1]["SESSION"], 0

    def frames(self, sender: Sender, **command: float) -> list[can.Message]:
        """COMMAND_CODE and COMMAND, to be sent in this order; none while there is no session."""
        if self._session is None or self._freshness == FRESHNESS_MAX:
            return []
        self._freshness += 1
        told = sender.frame("COMMAND", **command)
        code = code_of(self._key, self._session, self._freshness, told)
        return [sender.frame("COMMAND_CODE", FRESHNESS=self._freshness, CODE=code), told]


def code_of(key: bytes, session: int, freshness: int, command: can.Message) -> int:
    """The first 4 bytes of the AES-128-CMAC of session, freshness, identifier and frame."""
    try:
        from cryptography.hazmat.primitives.ciphers.algorithms import AES
        from cryptography.hazmat.primitives.cmac import CMAC
    except ImportError as error:
        raise UserError(
            f"codes of commands need cryptography: {install_command('authentication')}"
        ) from error
    cmac = CMAC(AES(key))
    cmac.update(struct.pack("<IHH", session, freshness, command.arbitration_id))
    cmac.update(bytes(command.data))
    return int.from_bytes(cmac.finalize()[:4], "big")
