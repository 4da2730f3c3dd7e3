"""A status_t of the host process as text."""

from collections.abc import Sequence
from typing import Any

LINKS = ("unused", "up", "DOWN", "BUS-OFF")
SOURCES = ("none", "CAN", "LCM")
TRANSPORTS = ("SocketCAN", "UDP")
REJECTED = {
    "malformed": "frames_malformed",
    "bad CRC": "frames_bad_crc",
    "bad counter": "frames_bad_counter",
    "bad version": "frames_bad_version",
    "bad code": "frames_bad_code",
    "unusable commands": "commands_unusable",
    "commands of the source without authority": "commands_ignored",
    "commands from other machines": "commands_foreign",
}
DROPPED = {
    "frames without room": "frames_no_room",
    "frames without link": "frames_no_link",
    "LCM messages": "messages_not_sent",
}
LONG_US = 10_000_000  # longer ages are given in seconds
USUAL = 0.99  # share of ticks whose maximum latency is shown with the worst


def lines(status: Any) -> list[str]:
    """Timing, inputs and transports; empty before the first status_t."""
    return [timing(status), inputs(status), transports(status)] if status else []


def timing(status: Any) -> str:
    """Timing of the ticks. In lockstep the process has no clock, and nothing takes time."""
    if status.latency_max_us == status.work_us == 0:
        return f"timing: in lockstep, {status.missed_ticks} ticks missed"
    below_us = latency_below_us(status.latencies, USUAL)
    usual = "" if below_us is None else f"{USUAL:.0%} below {below_us / 1000:g} ms, "
    parts = [
        f"timing: every {status.period_us / 1000:.1f} ms",
        f"latency {status.latency_us / 1000:.2f} ms "
        f"({usual}worst {status.latency_max_us / 1000:.2f} ms)",
        f"work {status.work_us / 1000:.2f} ms",
        f"{status.missed_ticks} ticks missed",
    ]
    if status.fifo_priority:
        parts.append(f"SCHED_FIFO {status.fifo_priority}")
    return ", ".join(parts) + (", memory locked" if status.memory_locked else "")


def latency_below_us(latencies: Sequence[int], share: float) -> int | None:
    """Upper end of the bin below which that share of the ticks lies; None for the last bin."""
    counted = 0
    for exponent, ticks in enumerate(latencies[:-1], start=1):
        counted += ticks
        if counted >= share * sum(latencies):
            return 2**exponent
    return None


def inputs(status: Any) -> str:
    """The source that commands, the age of each input, and what was rejected."""
    ages = (
        ("CoM", status.com_age_us),
        ("left foot", status.left_age_us),
        ("right foot", status.right_age_us),
    )
    return ", ".join(
        [
            f"inputs: {commands(status)}",
            *(f"{name} {_age(status, age_us)}" for name, age_us in ages),
            f"{status.frames_accepted} frames accepted",
            *_counts(status, REJECTED),
            *_other_version(status),
        ]
    )


def commands(status: Any) -> str:
    """The source that commands, and the age of its last command."""
    if status.command_age_us == status.NEVER:
        return "no commands yet"
    age = _age(status, status.command_age_us)
    if status.command_source == status.SOURCE_NONE:
        return f"no commands now, the last {age}"
    return f"commands from {_name(SOURCES, status.command_source)} {age}"


def transports(status: Any) -> str:
    """State of CAN and LCM, and what was dropped."""
    can = f"CAN by {_name(TRANSPORTS, status.can_transport)}"
    parts = [
        _link(can, status.can_link, status.can_losses),
        _link("LCM", status.lcm_link, status.lcm_losses),
    ]
    dropped = _counts(status, DROPPED)
    return "transports: " + ", ".join(
        parts + ([f"dropped {', '.join(dropped)}"] if dropped else [])
    )


def _link(name: str, state: int, losses: int) -> str:
    lost = f" (lost {losses} times)" if losses else ""
    return f"{name} {_name(LINKS, state)}{lost}"


def _other_version(status: Any) -> list[str]:
    if not status.other_version:
        return []
    if not status.frames_bad_version:
        return [
            f"commands of wire version {status.other_version}, this firmware has "
            f"{status.wire_version}"
        ]
    return [
        f"wire version {status.other_version} rejected, this firmware has {status.wire_version}"
    ]


def _age(status: Any, age_us: int) -> str:
    if age_us == status.NEVER:
        return "never"
    return f"{age_us / 1e3:.0f} ms ago" if age_us < LONG_US else f"{age_us / 1e6:.0f} s ago"


def _counts(status: Any, names: dict[str, str]) -> list[str]:
    return [
        f"{getattr(status, field)} {words}"
        for words, field in names.items()
        if getattr(status, field)
    ]


def _name(names: tuple[str, ...], number: int) -> str:
    return names[number] if 0 <= number < len(names) else str(number)
