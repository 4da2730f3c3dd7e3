"""Checks of a walk that the demo prints at its end."""

from collections import Counter
from pathlib import Path
from typing import Any

from saddlewalk.contract import MODES, STANDING
from saddlewalk.emulation.exoskeleton import Exoskeleton
from saddlewalk.emulation.wearer import Wearer
from saddlewalk.errors import UserError
from saddlewalk.logs.can_log import CanLog
from saddlewalk.logs.recorder import CHANNELS, Recorder
from saddlewalk.logs.rerun import rerun_lcm
from saddlewalk.logs.rerun_can import rerun_can
from saddlewalk.transport.lcm_log import LcmLog, is_lcm_log

LATE_SHARE_MAX = 0.05
Check = tuple[bool, str]  # passed, and its text


def walk_checks(wearer: Wearer, exoskeleton: Exoskeleton, stops: bool) -> list[Check]:
    """Checks of the walk itself. stops: it should end standing."""
    if wearer.fallen:
        return [(False, _fall(wearer.fell_at_s, exoskeleton))]
    return [(True, "the wearer stayed up"), *([_standing(exoskeleton)] if stops else [])]


def _fall(time_s: float, exoskeleton: Exoskeleton) -> str:
    """Mentions a stall of this computer, during which the wearer cannot step."""
    punctuality = exoskeleton.punctuality
    stall = punctuality.stall_before(time_s) if punctuality else None
    if stall is None:
        return f"the wearer fell at {time_s:.2f} s"
    return (
        f"the wearer fell at {time_s:.2f} s, {time_s - stall.time_s:.2f} s after this computer had "
        f"stalled the wearer's process for {stall.late_s:.2f} s: try again when it is less busy"
    )


def _standing(exoskeleton: Exoskeleton) -> Check:
    if exoskeleton.mode == STANDING:
        return True, "stands at the end"
    last = "without a plan" if exoskeleton.mode is None else MODES[exoskeleton.mode]
    return False, f"is {last} at the end, not standing"


def transport_checks(exoskeleton: Exoskeleton, recorder: Recorder) -> list[Check]:
    """Checks of frames and ticks, and of their records."""
    health = exoskeleton.health
    late, rejected_by_firmware = int(health["LATE_TICKS"]), int(health["REJECTED_FRAMES"])
    rejected = exoskeleton.reader.receiver.rejected
    ticks = exoskeleton.ticks
    frames = sum(1 for _ in CanLog(recorder.can_path))
    return [
        (
            rejected == rejected_by_firmware == 0,
            f"{rejected} frames rejected by the wearer, {rejected_by_firmware} by the firmware",
        ),
        (late <= LATE_SHARE_MAX * ticks, f"{late} of {ticks} ticks late"),
        (recorder.rows == ticks > 0, f"{recorder.rows} rows of CSV"),
        (frames == recorder.frames > 0, f"{frames} CAN frames read again"),
    ]


def log_checks(recorder: Recorder, config: Any, by_can: bool) -> list[Check]:
    """Checks of the LCM messages, and the firmware's outputs recomputed from the logged inputs."""
    channels = Counter(event.channel for event in LcmLog(recorder.lcm_path))
    expected = ["SADDLEWALK_TRUTH"] if by_can else CHANNELS
    missing = [name for name in expected if not channels[name]]
    return [
        (
            sum(channels.values()) == recorder.lcm_messages and not missing,
            f"{sum(channels.values())} LCM messages read again"
            + (f", none on {', '.join(missing)}" if missing else ""),
        ),
        _rerun(recorder.can_path if by_can else recorder.lcm_path, config),
    ]


def _rerun(log: Path, config: Any) -> Check:
    """Whether the logged inputs reproduce the logged outputs. Gaps in the log are no failure."""
    try:
        report = rerun_lcm(LcmLog(log)) if is_lcm_log(log) else rerun_can(CanLog(log), config)
    except UserError as error:
        return False, f"{log.name} cannot be rerun: {error}"
    if report.first:
        return False, f"rerun of the log: {report.first}"
    words = f"{report.ticks} ticks recomputed from the log: the same bits"
    return True, "; not compared: ".join([words, *report.not_compared])
