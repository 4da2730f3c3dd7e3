"""What `saddlewalk bench` found, as text and as data: times, instructions, and the aims."""

import platform
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from saddlewalk.benchmark.instructions import ALL_TICKS, Group
from saddlewalk.benchmark.timing import (
    CORE,
    FLOOR,
    HORIZONS,
    NUMPY,
    NUMPY_AT_ONCE,
    QPS,
    SPEED_M_S,
    Timing,
    instants,
)
from saddlewalk.contract import TICK_S

ONE, TEN = HORIZONS


@dataclass(frozen=True)
class Aim:
    """found is a ratio; None: not measured here."""

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
    timings: dict[str, Timing]
    groups: list[Group]
    no_instructions: str | None

    def ratio(self, name: str, strides: int) -> float | None:
        """Median of this neighbour over the core's."""
        timing = self.timings[name]
        if timing.missing is not None:
            return None
        return timing.median_s(strides) / self.timings[CORE].median_s(strides)

    def _fastest_qp(self, strides: int) -> float | None:
        ratios = [self.ratio(name, strides) for name in QPS]
        return min((ratio for ratio in ratios if ratio is not None), default=None)

    def _qp_at_each_tick(self) -> float | None:
        """A stride's QP, solved anew at each tick, over one update of the core."""
        fastest = self._fastest_qp(ONE)
        if fastest is None:
            return None
        core = self.timings[CORE]
        return fastest * core.median_s(ONE) / (core.median_s(TEN) / len(instants(TEN)))

    def aims(self) -> list[Aim]:
        floor = self.ratio(FLOOR, TEN)
        core_over_floor = None if floor is None else 1 / floor
        found = {group.name: group for group in self.groups}
        every = found.get(ALL_TICKS)
        return [
            Aim("fastest QP / core, 1 stride", 100, True, self._fastest_qp(ONE)),
            Aim("fastest QP / core, 10 strides", 100, True, self._fastest_qp(TEN)),
            Aim("fastest QP of a stride at each tick / core", 100, True, self._qp_at_each_tick()),
            Aim(f"{NUMPY} / core, 10 strides", 1000, True, self.ratio(NUMPY, TEN)),
            Aim(f"{NUMPY_AT_ONCE} / core, 10 strides", 1000, True, self.ratio(NUMPY_AT_ONCE, TEN)),
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
        yield f"gravity and margins; {self.rounds} rounds, interleaved, on {processor()}"
        yield ""
        heads = "".join(
            f" | {_strides(strides):>10} {'most':>9} {'/ core':>7}" for strides in HORIZONS
        )
        yield f"{'median and largest time, us':<28}{heads}"
        for timing in self.timings.values():
            yield f"{timing.name:<28}" + self._times(timing)
        yield ""
        yield from self._instruction_lines()
        yield ""
        yield "Aims"
        yield from (f"  {aim.line()}" for aim in self.aims())

    def _times(self, timing: Timing) -> str:
        if timing.missing is not None:
            return f" | not measured: {timing.missing}"
        return "".join(
            f" | {timing.median_s(strides) * 1e6:10,.1f} {timing.worst_s(strides) * 1e6:9,.1f} "
            f"{_ratio(self.ratio(timing.name, strides)):>7}"
            for strides in HORIZONS
        )

    def _instruction_lines(self) -> Iterator[str]:
        if self.no_instructions is not None:
            yield f"Instructions: not counted: {self.no_instructions}"
            return
        heads = "".join(f"{head:>9}" for head in ("least", "median", "most", "floor"))
        yield f"{'instructions':<24} {'times':>6}{heads}"
        for group in self.groups:
            floor = "" if group.floor is None else f"{group.floor:8,.0f}"
            yield (
                f"{group.name:<24} {group.updates:6} {group.least:8,} {group.median:8,.0f} "
                f"{group.most:8,} {floor:>8}"
            )

    def as_dict(self) -> dict[str, Any]:
        return {
            "processor": processor(),
            "speed_m_s": SPEED_M_S,
            "period_s": TICK_S,
            "rounds": self.rounds,
            "planning": [self._timing_dict(timing) for timing in self.timings.values()],
            "instructions": [asdict(group) for group in self.groups],
            "instructions_missing": self.no_instructions,
            "aims": [{**asdict(aim), "met": aim.met} for aim in self.aims()],
        }

    def _timing_dict(self, timing: Timing) -> dict[str, Any]:
        if timing.missing is not None:
            return {"name": timing.name, "missing": timing.missing}
        horizons = {
            str(strides): {
                "median_s": timing.median_s(strides),
                "most_s": timing.worst_s(strides),
                "of_core": self.ratio(timing.name, strides),
            }
            for strides in HORIZONS
        }
        return {"name": timing.name, "missing": None, "strides": horizons}


def _strides(count: int) -> str:
    return "1 stride" if count == 1 else f"{count} strides"


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
