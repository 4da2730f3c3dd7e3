"""The results of `saddlewalk bench` as text and as JSON: times, instructions, and aims."""

import platform
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from saddlewalk.benchmark.instructions import ALL_TICKS, Group
from saddlewalk.benchmark.timing import (
    COLD,
    CORE,
    EVICTING_BYTES,
    FLOOR,
    NUMPY,
    NUMPY_AT_ONCE,
    QPS,
    SPEED_M_S,
    STRIDES,
    TASKS,
    UPDATE,
    WARM,
    Timing,
)
from saddlewalk.contract import TICK_S

ONE, TEN = STRIDES
CACHES = (COLD, WARM)
TITLES = {
    UPDATE: "one update of a walk, us",
    ONE: "a stride planned anew, us",
    TEN: "ten strides planned anew, us",
}


@dataclass(frozen=True)
class Aim:
    """An aim for a ratio. found: None if it was not measured."""

    what: str
    wanted: float
    at_least: bool
    found: float | None

    @property
    def met(self) -> bool | None:
        if self.found is None:
            return None
        return self.found >= self.wanted if self.at_least else self.found <= self.wanted

    def line(self) -> str:
        bound = "at least" if self.at_least else "at most"
        wanted = f"{self.what}: {bound} {self.wanted:,g}"
        if self.found is None:
            return f"{wanted:<66} not measured"
        return f"{wanted:<66} {_ratio(self.found):>8}  {'met' if self.met else 'not met'}"


@dataclass(frozen=True)
class Report:
    rounds: int
    timings: list[Timing]
    groups: list[Group]
    no_instructions: str | None

    def ratio(self, name: str, task: str, caches: str) -> float | None:
        """This planner's median time divided by the core's."""
        medians = {
            timing.name: timing.median_s(task, caches)
            for timing in self.timings
            if task in timing.seconds
        }
        return medians[name] / medians[CORE] if name in medians else None

    def _fastest_qp(self, task: str) -> float | None:
        """Ratio of the fastest QP to the core, cold or warm, whichever is less."""
        return _least(self.ratio(name, task, caches) for name in QPS for caches in CACHES)

    def _least_ratio(self, name: str, task: str) -> float | None:
        return _least(self.ratio(name, task, caches) for caches in CACHES)

    def aims(self) -> list[Aim]:
        floor = self._least_ratio(FLOOR, TEN)
        core_over_floor = None if floor is None else 1 / floor
        found = {group.name: group for group in self.groups}
        every = found.get(ALL_TICKS)
        return [
            Aim("fastest QP / core, an update", 100, True, self._fastest_qp(UPDATE)),
            Aim("fastest QP / core, 1 stride", 100, True, self._fastest_qp(ONE)),
            Aim("fastest QP / core, 10 strides", 100, True, self._fastest_qp(TEN)),
            Aim(f"{NUMPY} / core, 10 strides", 1000, True, self._least_ratio(NUMPY, TEN)),
            Aim(
                f"{NUMPY_AT_ONCE} / core, 10 strides",
                1000,
                True,
                self._least_ratio(NUMPY_AT_ONCE, TEN),
            ),
            Aim("core / floor, 10 strides", 2, False, core_over_floor),
            Aim(
                "instructions of the median tick / of the median floor",
                2,
                False,
                every.median / every.floor if every and every.floor else None,
            ),
            Aim(
                "instructions of the slowest tick / of the median",
                1.5,
                False,
                every.most / every.median if every else None,
            ),
        ]

    def lines(self) -> Iterator[str]:
        yield f"A walk at {SPEED_M_S} m/s, planned every {round(TICK_S * 1e3)} ms with scores,"
        yield f"gravity and margins; {self.rounds} rounds, interleaved, on {processor()}."
        yield f"Cold: after {EVICTING_BYTES >> 20} MiB of other data were read; warm: run again."
        for task in TASKS:
            yield ""
            yield from self._task_lines(task)
        yield ""
        for timing in self.timings:
            if timing.missing is not None:
                yield f"{timing.name}: not measured: {timing.missing}"
        yield from self._instruction_lines()
        yield ""
        yield "Aims, by the less favourable of cold and warm"
        yield from (f"  {aim.line()}" for aim in self.aims())

    def _task_lines(self, task: str) -> Iterator[str]:
        heads = "".join(f" | {caches:>10} {'largest':>9} {'/ core':>7}" for caches in CACHES)
        yield f"{TITLES[task]:<28}{heads}"
        for timing in self.timings:
            if task in timing.seconds:
                yield f"{timing.name:<28}" + "".join(
                    f" | {timing.median_s(task, caches) * 1e6:10,.2f} "
                    f"{timing.worst_s(task, caches) * 1e6:9,.1f} "
                    f"{_ratio(self.ratio(timing.name, task, caches)):>7}"
                    for caches in CACHES
                )

    def _instruction_lines(self) -> Iterator[str]:
        if self.no_instructions is not None:
            yield f"Instructions: not counted: {self.no_instructions}"
            return
        heads = "".join(f"{head:>9}" for head in ("least", "median", "largest", "floor"))
        yield f"{'instructions':<24} {'updates':>7}{heads}"
        for group in self.groups:
            floor = "-" if group.floor is None else f"{group.floor:8,.0f}"
            yield (
                f"{group.name:<24} {group.updates:7} {group.least:8,} {group.median:8,.0f} "
                f"{group.most:8,} {floor:>8}"
            )

    def as_dict(self) -> dict[str, Any]:
        return {
            "processor": processor(),
            "speed_m_s": SPEED_M_S,
            "period_s": TICK_S,
            "rounds": self.rounds,
            "planning": [self._timing_dict(timing) for timing in self.timings],
            "instructions": [asdict(group) for group in self.groups],
            "instructions_missing": self.no_instructions,
            "aims": [{**asdict(aim), "met": aim.met} for aim in self.aims()],
        }

    def _timing_dict(self, timing: Timing) -> dict[str, Any]:
        tasks = {
            task: {
                caches: {
                    "median_s": timing.median_s(task, caches),
                    "largest_s": timing.worst_s(task, caches),
                    "of_core": self.ratio(timing.name, task, caches),
                }
                for caches in CACHES
            }
            for task in timing.seconds
        }
        return {"name": timing.name, "missing": timing.missing, "tasks": tasks}


def _least(ratios: Iterable[float | None]) -> float | None:
    return min((ratio for ratio in ratios if ratio is not None), default=None)


def _ratio(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def processor() -> str:
    """The processor's name, from Linux."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = (line.partition(": ")[2] for line in lines if line.startswith("model name"))
    return next(names, platform.machine())
