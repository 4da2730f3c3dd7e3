"""Quality of a run's data: lost ticks, faults, ages, rejected frames, missing channels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from saddlewalk import status_text
from saddlewalk.contract import FAULTS, LIMITS, STATUSES, TICK_S, name_of
from saddlewalk.session.runs import Run, Spans

GAP_S = 1.5 * TICK_S
AGES = {
    "command": "command",
    "com": "CoM",
    "left": "left foot",
    "right": "right foot",
}
LACKS = {
    "verdict": "levels, alarms, energies and the recovery step are not known",
    "balance": "the margin that decides the level and its driver are not known",
    "scores": "S_pend, S_jump, S_SW and the margins are not known",
    "plan": "the planned speed and which steps were steady are not known",
    "input": "measurements and their ages are not known",
    "health": "faults, limits and late ticks are not known",
    "status": "details of timing and of rejected frames are not known",
    "config": "configuration and versions are not known",
}
FAULT_WORDS = {
    "COMMAND": "an unusable command",
    "COM_STALE": "the CoM's measurement is too old",
    "COM_RANGE": "the CoM's measurement is not finite or out of range",
    "LEFT_STALE": "the left foot's measurement is too old",
    "LEFT_RANGE": "the left foot's measurement is not finite or out of range",
    "RIGHT_STALE": "the right foot's measurement is too old",
    "RIGHT_RANGE": "the right foot's measurement is not finite or out of range",
    "FEET_TOGETHER": "the feet are at the same place",
    "SPEED_INFEASIBLE": "this body cannot walk at the measured speed",
    "COM_FROZEN": "the CoM's measurement stays the same while the feet move",
    "LEFT_FROZEN": "the left foot's measurement stays the same while the CoM moves",
    "RIGHT_FROZEN": "the right foot's measurement stays the same while the CoM moves",
    "AIRBORNE": "both feet are in the air for too long",
    "FEET_CROSSED": "the feet are crossed",
    "COMMAND_STALE": "no usable command for too long",
    "COM_LOW": "the CoM is below the knees",
}
LIMIT_WORDS = {
    "SPEED": "the commanded speed is not feasible: the nearest feasible one was planned",
    "HEEL_STRIKE": "the commanded heel-strike angle is out of range",
    "TOE_OFF": "the ankle's angle is outside the geometry",
    "FEET": "no plan can start or continue from the measured feet",
    "TICK_GAP": "a late tick: the plan advanced by less than the elapsed time",
    "SAFE_STOP": "inputs were lost: the plan ended the walk",
    "TURN": "the commanded turning rate is more than a walk at that speed bears",
}


@dataclass(frozen=True)
class Problem:
    """A fault, a limit or an error, and when it was reported."""

    name: str
    words: str
    spans: Spans


@dataclass(frozen=True)
class Age:
    """Age of an input at the ticks, in milliseconds; NaN if it never came."""

    what: str
    median_ms: float
    usual_ms: float  # 95 % are younger
    oldest_ms: float
    never: int  # ticks before the first one


@dataclass(frozen=True)
class Gap:
    start_s: float
    duration_s: float
    words: str


@dataclass(frozen=True)
class Gaps:
    count: int
    duration_s: float  # of all
    longest: list[Gap]  # in order of time


def missing(run: Run) -> list[str]:
    """A sentence for each channel that is not in the log: what is unknown without it."""
    return [
        f"Nothing readable was received on SADDLEWALK_{name.upper()}: {lack}."
        for name, lack in LACKS.items()
        if not run.has(name)
    ]


def problems(run: Run) -> list[Problem]:
    """Reported faults, limits and errors, by kind."""
    found = [
        *_bits(run, "faults", FAULTS, FAULT_WORDS),
        *_bits(run, "limits", LIMITS, LIMIT_WORDS),
    ]
    statuses = run.bits("health", "status")
    for status in np.unique(statuses[statuses != 0]).tolist():
        name = name_of(status, STATUSES, "status")
        found.append(_problem(run, name, "the tick failed", statuses == status))
    return found


def gaps(run: Run, most: int) -> Gaps:
    """Missing ticks, and whether the log or the firmware lost them."""
    after_s = np.diff(run.time_s)
    found = np.flatnonzero(after_s > GAP_S)
    duration_s = after_s[found] - TICK_S
    longest = np.sort(found[np.argsort(-duration_s, kind="stable")[:most]])
    return Gaps(len(found), float(duration_s.sum()), [_gap(run, index) for index in longest])


def _gap(run: Run, index: int) -> Gap:
    """The gap after a tick."""
    before, after = run.number(index), run.number(index + 1)
    words = "cause not logged"
    if before is not None and after is not None:
        lost = after - before - 1
        words = f"{lost} ticks are not in the log" if lost else "the firmware missed ticks"
    start_s = float(run.time_s[index]) + TICK_S
    return Gap(start_s, float(run.time_s[index + 1]) - start_s, words)


def ages(run: Run) -> list[Age]:
    """The ages of each input, over the ticks that were logged with their inputs."""
    return [_age(run, part, what) for part, what in AGES.items() if run.has("input")]


def rejected(run: Run) -> str:
    """Frames accepted and rejected since the firmware's start, by reason; empty if not logged."""
    status, health = run.last("status"), run.last("health")
    counters = status or health
    if counters is None:
        return ""
    counts = [
        f"{getattr(counters, member)} {words}"
        for words, member in status_text.REJECTED.items()
        if getattr(counters, member, 0)
    ]
    return f"{counters.frames_accepted} frames accepted, rejected: {', '.join(counts) or 'none'}"


def late(run: Run) -> str:
    """Timing of the firmware since its start; empty if not logged."""
    status, health = run.last("status"), run.last("health")
    if status:
        return (
            f"{status.late_ticks} ticks late, {status.missed_ticks} missed; at most "
            f"{status.latency_max_us / 1000:.2f} ms latency and {status.work_max_us / 1000:.2f} ms "
            "work"
        )
    return f"{health.late_ticks} ticks late" if health else ""


def _bits(run: Run, member: str, names: Sequence[str], words: dict[str, str]) -> list[Problem]:
    bits = run.bits("health", member)
    found = []
    for bit in range(32):
        there = (bits >> bit & 1) > 0
        if there.any():
            name = names[bit] if bit < len(names) else f"bit {bit}"
            found.append(_problem(run, name, words.get(name, "not known here"), there))
    return found


def _problem(run: Run, name: str, words: str, there: np.ndarray) -> Problem:
    spans = run.spans(there)
    return Problem(name, words, spans.where(spans.value))


def _age(run: Run, part: str, what: str) -> Age:
    age_us = run.logged("input", f"{part}_age_us")
    known_us = age_us[age_us >= 0]
    never = int((age_us < 0).sum())
    if not len(known_us):
        return Age(what, np.nan, np.nan, np.nan, never)
    median, usual, oldest = np.percentile(known_us, (50, 95, 100), overwrite_input=True) / 1000
    return Age(what, float(median), float(usual), float(oldest), never)
