"""Recomputes a CAN log of a run in lockstep: from frames to frames, bit for bit.

The log must begin with the host process. LATE_TICKS and REJECTED_FRAMES of HEALTH do not follow
from a log, and are not compared.
"""

from collections.abc import Iterable
from typing import Any

import can

from saddlewalk.errors import UserError
from saddlewalk.lockstep_host import INPUTS, LockstepHost, is_classic
from saddlewalk.logs.rerun import Difference, Report
from saddlewalk.ticks import MESSAGES
from saddlewalk.transport import wire


def rerun_can(frames: Iterable[can.Message], config: Any) -> Report:
    """Recompute a run with a configuration of saddlewalk.config.

    Raises UserError if no tick can be recomputed.
    """
    report = Report(source="CAN", runs=1)
    node, answer = LockstepHost(config), {}
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
        raise UserError(_why_not_rerun(report, node))
    if node.waiting and not report.gaps:
        report.add_gap("the log ends before the answer to its last measurements")
    return report


def _is_ours(frame: can.Message) -> bool:
    """Whether it is a classic data frame of 8 bytes; the host rejects any other."""
    return is_classic(frame) and len(frame.data) == wire.FRAME_LENGTH


def _why_not_rerun(report: Report, node: LockstepHost) -> str:
    if report.gaps:
        return report.gaps[0]
    if node.inputs == 0:
        return f"it has none of the frames {', '.join(INPUTS)}, from which a run is recomputed"
    return "it has no complete set of measurements followed by HEALTH"


def _compare(report: Report, node: LockstepHost, answer: dict[str, bytes]) -> bool:
    """Compare one tick's frames. False: the rest cannot be computed; the report says why."""
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
            report.add_missing(name, tick)
            continue
        report.compared += 1
        if answer[name] != data and first is None:
            first = _difference(tick, identifier, answer[name], data)
    if first:
        report.add_difference(first)
    return True


def _in_lockstep(report: Report, node: LockstepHost, counter: int) -> bool:
    """Whether exactly one set of measurements came since the previous answer."""
    tick = node.ticks - 1
    where = f"before answer {report.ticks}"
    if node.waiting != 1:
        report.add_gap(
            f"{node.waiting} sets of measurements came {where}, in lockstep it is 1: the run was "
            "in real time (rerun its LCM log, which has the ages) or frames are missing; "
            "the rest was not computed"
        )
    elif counter != tick % wire.COUNTERS:
        report.add_gap(
            f"answer {report.ticks} has counter {counter}, not {tick % wire.COUNTERS}: the log "
            "begins in mid-run or frames are missing; the rest was not computed"
        )
    else:
        return True
    return False


def _difference(tick: int, identifier: int, recorded: bytes, recomputed: bytes) -> Difference:
    """The first signal that differs; the CRC only if nothing else does."""
    name = wire.known_name(identifier)
    theirs, ours = (wire.raw_signals(identifier, data) for data in (recorded, recomputed))
    different = [signal for signal in ours if ours[signal] != theirs[signal]]
    signal = next((signal for signal in different if signal != "CRC"), "CRC")
    if not different:  # a bit that no signal has
        return Difference(tick, name, recorded.hex(), recomputed.hex())
    return Difference(tick, f"{name} {signal}", f"{theirs[signal]} (raw)", f"{ours[signal]} (raw)")
