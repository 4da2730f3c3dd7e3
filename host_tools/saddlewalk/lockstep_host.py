"""The host process in lockstep, in this process: the same frames in, the same bits out."""

from typing import Any

import can

from saddlewalk.contract import TICK_US
from saddlewalk.core import AGE_NEVER_US
from saddlewalk.firmware import Firmware, config_of, ffi, library

NO_IDENTIFIER = 0xFFFFFFFF  # what the host makes of a frame that is not a classic data frame
INPUTS = "COMMAND MEASURED_COM MEASURED_LEFT MEASURED_RIGHT".split()


def is_classic(frame: can.Message) -> bool:
    return not (
        frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd
    )


class LockstepHost:
    """Takes frames, and ticks when a set of measurements is whole."""

    def __init__(self, config: Any) -> None:
        self.firmware = Firmware(config_of(config))
        self.ticks = 0  # computed
        self.waiting = 0  # of them, not yet compared
        self.inputs = 0  # frames
        self._receiver = ffi().new("saddle_wire_receiver_t *")
        self._input = ffi().new("saddle_input_t *")
        self._measured = [getattr(library(), f"SADDLE_WIRE_{name}") for name in INPUTS[1:]]
        self._set: set[int] = set()
        self._set_counter = 0
        self._command_us: int | None = None  # the time of the tick after it

    def take(self, frame: can.Message) -> None:
        lib = library()
        identifier = frame.arbitration_id if is_classic(frame) else NO_IDENTIFIER
        data = bytes(frame.data)
        message = lib.saddle_wire_accept(self._receiver, identifier, data, len(data))
        if message == lib.SADDLE_WIRE_NONE:
            return
        self.inputs += 1
        if message == lib.SADDLE_WIRE_COMMAND:
            self._take_command(data)
        elif message in self._measured:
            self._take_measured(message, data)

    def _take_command(self, data: bytes) -> None:
        command = ffi().new("saddle_command_t *")
        library().saddle_wire_decode_command(data, command)
        if library().saddle_command_usable(command):
            self._input.command = command[0]
            self._command_us = self.ticks * TICK_US

    def _take_measured(self, message: int, data: bytes) -> None:
        lib = library()
        lib.saddle_wire_decode_measured(
            message, data, ffi().addressof(self._input[0], "measurement")
        )
        counter = lib.saddle_wire_counter(data)
        if counter != self._set_counter:
            self._set, self._set_counter = set(), counter
        self._set.add(message)
        if len(self._set) == len(INPUTS) - 1:
            self._set = set()
            self._tick()

    def _tick(self) -> None:
        time_us = self.ticks * TICK_US
        self._input.time_us = time_us
        received_us = self._command_us
        age_us = AGE_NEVER_US if received_us is None else time_us - received_us
        self._input.command_age_us = age_us
        self.firmware.tick(self._input)
        self.ticks += 1
        self.waiting += 1

    def plan_at(self, since_s: float) -> Any:
        """saddle_plan_at(), so long after the last tick: a saddle_plan_t that is reused."""
        since_us = round(since_s * 1e6)
        return self.firmware.plan_at((self.ticks - 1) * TICK_US + since_us)
