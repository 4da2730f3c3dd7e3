"""Instruction counts of the core's updates, by valgrind's callgrind. Unlike times, they are
repeatable.
"""

import os
import re
import shutil
import statistics
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from saddlewalk.benchmark.baselines import MissingError
from saddlewalk.benchmark.timing import recorded_calls
from saddlewalk.contract import LEVELS, MODES
from saddlewalk.paths import built

UPDATE, FLOOR, INIT = "saddle_bench_update", "saddle_bench_floor", "saddle_init"
PLAN_WALK, INVALID_WALK = 0, 5  # walks.h
ALL_TICKS = "every tick"

_DUMP = re.compile(r"^desc: Trigger: --dump-after=.*?^summary: (\d+)$", re.S | re.M)


@dataclass(frozen=True)
class Update:
    """One update of one walk, and its result."""

    walk: int
    mode: int
    level: int
    instructions: int
    floor: int


@dataclass(frozen=True)
class Group:
    """Instruction counts of one kind of update."""

    name: str
    updates: int
    least: int
    median: float
    most: int
    floor: float | None  # median

    @classmethod
    def of(cls, name: str, updates: list[Update]) -> "Group":
        counts = [update.instructions for update in updates]
        floor = statistics.median(update.floor for update in updates)
        return cls(name, len(counts), min(counts), statistics.median(counts), max(counts), floor)


def count() -> list[Group]:
    """Counts for each kind of update and saddle_init(). Raises MissingError without valgrind."""
    calls = recorded_calls()
    printed, instructions = _callgrind(UPDATE, calls)
    _, floors = _callgrind(FLOOR, calls)
    _, init = _callgrind(INIT, calls)
    updates = [
        Update(walk, mode, level, each, floor)
        for (walk, _, _, mode, level, _), each, floor in zip(
            printed, instructions, floors, strict=True
        )
    ]
    median = statistics.median(init)
    return [*_groups(updates), Group(INIT, len(init), min(init), median, max(init), None)]


def _groups(updates: list[Update]) -> Iterator[Group]:
    ticks = [update for update in updates if update.walk != PLAN_WALK]
    usable = [update for update in ticks if update.walk != INVALID_WALK]
    kinds = {"plan and its scores": [u for u in updates if u.walk == PLAN_WALK]}
    kinds |= {f"tick, {mode}": [u for u in usable if u.mode == n] for n, mode in enumerate(MODES)}
    kinds |= {f"tick, {name}": [u for u in usable if u.level == n] for n, name in enumerate(LEVELS)}
    kinds |= {"tick, invalid inputs": [u for u in ticks if u.walk == INVALID_WALK]}
    kinds |= {ALL_TICKS: ticks}
    for name, those in kinds.items():
        yield Group.of(name, those)


def _callgrind(function: str, calls: str) -> tuple[list[list[int]], list[int]]:
    """What saddlewalk-bench-updates prints, and the instructions of each call of a function.

    callgrind separates the calls of one function at a time.
    """
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        raise MissingError("valgrind is not installed: apt install valgrind")
    with tempfile.TemporaryDirectory() as folder:
        profile = Path(folder) / "callgrind.out"
        options = ["--tool=callgrind", "--combine-dumps=yes", f"--callgrind-out-file={profile}"]
        options += [f"--toggle-collect={function}", f"--dump-after={function}"]
        ended = subprocess.run(
            [valgrind, *options, built("bin/saddlewalk-bench-updates")],
            input=calls,
            capture_output=True,
            text=True,
            env={**os.environ, "LD_BIND_NOW": "1"},
        )
        if ended.returncode != 0:
            raise MissingError(f"callgrind ended with {ended.returncode}")
        dumps = _DUMP.findall(profile.read_text())
    printed = [[int(cell) for cell in line.split()] for line in ended.stdout.splitlines()]
    return printed, [int(instructions) for instructions in dumps]
