"""A CAN log of a run in lockstep recomputed: from frames to frames, bit for bit.

The log must begin with the host process. Of HEALTH, LATE_TICKS and REJECTED_FRAMES count what no
log shows, and are taken as they were recorded.
"""

from collections.abc import Iterable
from typing import Any

import can

from saddlewalk.contract import TICK_US
from saddlewalk.core import AGE_NEVER_US
from saddlewalk.errors import UserError
from saddlewalk.firmware import Firmware, config_of, ffi, library
from saddlewalk.logs.rerun import Difference, Report
from saddlewalk.ticks import MESSAGES
from saddlewalk.transport import wire

NO_IDENTIFIER = 0xFFFFFFFF  # what the host makes of a frame that is not a classic data frame
_INPUTS = "COMMAND MEASURED_COM MEASURED_LEFT MEASURED_RIGHT".split()


def rerun_can(frames: Iterable[can.Message], config: Any) -> Report:
    """Compute a run again with a configuration of saddlewalk.config.

    Raises UserError if no tick of it can be.
    """
    report = Report(source="CAN", runs=1)
    node, answer = _Node(config), {}
    for frame in frames:
        name = wire.message_name(frame.arbitration_id) if _is_ours(frame) else None
        if name not in MESSAGES:
            node.take(frame)
            continue
        answer[name] = bytes(frame.data)
        if name == "HEALTH" and not _compare(report, node, answer):
            break
        answer = {} if name == "HEALTH" else answer
    if not report.ticks:
        raise UserError(_nothing(report, node))
    if node.waiting and not report.gaps:
        report.lacks("the log ends before the answer to its last measurements")
    return report


def _is_ours(frame: can.Message) -> bool:
    """A classic data frame of our length; any other is the host's to refuse."""
    return _is_classic(frame) and len(frame.data) == wire.FRAME_LENGTH


def _is_classic(frame: can.Message) -> bool:
    return not (
        frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd
    )


def _nothing(report: Report, node: "_Node") -> str:
    if report.gaps:
        return report.gaps[0]
    if node.inputs == 0:
        return f"it has none of the frames {', '.join(_INPUTS)} of which a run is recomputed"
    return "it has no whole set of measurements with the HEALTH that answers it"


class _Node:
    """The host process in lockstep: takes frames, ticks when a set of measurements is whole."""

    def __init__(self, config: Any) -> None:
        self.firmware = Firmware(config_of(config))
        self.ticks = 0  # computed
        self.waiting = 0  # of them, not yet compared
        self.inputs = 0  # frames
        self._receiver = ffi().new("saddle_wire_receiver_t *")
        self._input = ffi().new("saddle_input_t *")
        self._set: set[int] = set()
        self._set_counter = 0
        self._command_us: int | None = None  # the time of the tick after it

    def take(self, frame: can.Message) -> None:
        lib = library()
        identifier = frame.arbitration_id if _is_classic(frame) else NO_IDENTIFIER
        data = bytes(frame.data)
        message = lib.saddle_wire_accept(self._receiver, identifier, data, len(data))
        if message == lib.SADDLE_WIRE_NONE:
            return
        self.inputs += 1
        if message == lib.SADDLE_WIRE_COMMAND:
            self._take_command(data)
        elif message != lib.SADDLE_WIRE_COMMAND_CODE:
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
        if len(self._set) == len(_INPUTS) - 1:
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


def _compare(report: Report, node: _Node, answer: dict[str, bytes]) -> bool:
    """One tick's frames. False: what follows cannot be computed, which the report then states."""
    tick = node.ticks - 1
    recorded = wire.raw_signals(wire.identifier("HEALTH"), answer["HEALTH"])
    if not _in_lockstep(report, node, recorded["COUNTER"]):
        return False
    node.waiting = 0
    report.ticks += 1
    counts = recorded["LATE_TICKS"], recorded["REJECTED_FRAMES"]
    first = None
    for identifier, data in node.firmware.frames(tick % wire.COUNTERS, *counts).items():
        name = wire.known_name(identifier)
        if name not in answer:
            report.misses(name, tick)
            continue
        report.compared += 1
        if answer[name] != data and first is None:
            first = _difference(tick, identifier, answer[name], data)
    if first:
        report.differs(first)
    return True


def _in_lockstep(report: Report, node: _Node, counter: int) -> bool:
    """Whether an answer is that of the one set of measurements since the answer before."""
    tick = node.ticks - 1
    where = f"before answer {report.ticks}"
    if node.waiting != 1:
        report.lacks(
            f"{node.waiting} sets of measurements came {where}, in lockstep it is 1: the run was "
            "in real time (rerun its LCM log, which has the ages) or frames are missing; "
            "no more was computed"
        )
    elif counter != tick % wire.COUNTERS:
        report.lacks(
            f"answer {report.ticks} has counter {counter}, not {tick % wire.COUNTERS}: the log "
            "begins in mid-run or frames are missing; no more was computed"
        )
    else:
        return True
    return False


def _difference(tick: int, identifier: int, recorded: bytes, recomputed: bytes) -> Difference:
    """Names the first signal that differs; CRC only if that alone does."""
    name = wire.known_name(identifier)
    theirs, ours = (wire.raw_signals(identifier, data) for data in (recorded, recomputed))
    different = [signal for signal in ours if ours[signal] != theirs[signal]]
    signal = next((signal for signal in different if signal != "CRC"), "CRC")
    if not different:  # a bit that no signal has
        return Difference(tick, name, recorded.hex(), recomputed.hex())
    return Difference(tick, f"{name} {signal}", f"{theirs[signal]} (raw)", f"{ours[signal]} (raw)")
