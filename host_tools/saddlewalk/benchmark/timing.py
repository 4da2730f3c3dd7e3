"""Planning times of the core and other planners, in one process, interleaved.

The walk is the paper's: the mean person at 1.2 m/s and 10 degrees, an instant every 80 ms.
"""

import functools
import math
import statistics
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import cffi
import numpy as np

from saddlewalk.benchmark.neighbours import MissingError
from saddlewalk.benchmark.neighbours.numpy_plan import Body, plan, step_width
from saddlewalk.benchmark.neighbours.octave_plan import Octave
from saddlewalk.benchmark.neighbours.placo_walk import FOOT_LENGTH_M, FOOT_WIDTH_M, PlacoWalk
from saddlewalk.benchmark.neighbours.walking_qp import SOLVERS, Axis, Preview, WalkingQp
from saddlewalk.contract import TICK_S
from saddlewalk.errors import UserError
from saddlewalk.paths import built

SPEED_M_S = 1.2
HEEL_STRIKE_RAD = math.radians(10)
HORIZONS = (1, 10)  # strides
BODY = Body()
STEP_M = 2 * (0.1802 * SPEED_M_S + 0.1351)
STEP_TIME_S = STEP_M / SPEED_M_S
WIDTH_M = step_width(SPEED_M_S)
PENDULUM_M = 0.57 * BODY.height_m
FUNCTIONS = ("sin", "cos", "sin_cos", "asin", "erf", "exp", "sqrt")  # in the order of floor.h

CORE, FLOOR = "core", "floor of the core"
NUMPY, NUMPY_AT_ONCE = "numpy, instant by instant", "numpy, all instants at once"
OCTAVE, OCTAVE_AT_ONCE = "Octave, instant by instant", "Octave, all instants at once"
PLACO = "placo's walk planner"

Run = Callable[[int], float]  # strides -> seconds of one plan


def qp_name(solver: str) -> str:
    return f"walking QP, {solver}"


QPS = (*map(qp_name, SOLVERS), PLACO)


def instants(strides: int) -> np.ndarray:
    """When the plan is wanted, s: from 0, while the strides last."""
    return TICK_S * np.arange(math.floor(strides * 2 * STEP_TIME_S / TICK_S + 1e-9) + 1)


@functools.cache
def _library() -> tuple[cffi.FFI, Any]:
    ffi = cffi.FFI()
    ffi.cdef(built("saddlewalk_bench_cdef.h").read_text())
    return ffi, ffi.dlopen(str(built("lib/libsaddlewalk_bench.so")))


class CorePlan:
    """The core, ticked in C."""

    def __init__(self, speed_m_s: float = SPEED_M_S, hs_rad: float = HEEL_STRIKE_RAD) -> None:
        ffi, library = _library()
        most = len(instants(HORIZONS[-1]))
        self.outputs = ffi.new("saddle_output_t[]", most)
        self.scores = ffi.new("saddle_scores_t[]", most)
        self._context = ffi.new("saddle_context_t *")
        self._command = ffi.new("saddle_command_t *")
        self._command.mode = library.SADDLE_COMMAND_WALK
        self._command.speed_m_s, self._command.heel_strike_rad = speed_m_s, hs_rad
        config = ffi.new("saddle_config_t *")
        config[0] = library.saddle_config_default(BODY.height_m, BODY.mass_kg)
        library.saddle_init(self._context, config)

    def seconds(self, strides: int) -> float:
        return self.plan(len(instants(strides)))

    def plan(self, count: int) -> float:
        """Seconds; the plan is in outputs and scores."""
        nanoseconds = _library()[1].saddle_bench_plan_ns(
            self._context, self._command, round(TICK_S * 1e6), count, self.outputs, self.scores
        )
        if nanoseconds == 0:
            raise ValueError("the core refuses to plan")
        return nanoseconds * 1e-9


def told_calls() -> str:
    """The output of saddlewalk-bench-calls: lines of walk, update, function, argument."""
    program = built("bin/saddlewalk-bench-calls")
    done = subprocess.run([program], capture_output=True, text=True)
    if done.returncode != 0:
        raise UserError(f"{program} ended with {done.returncode}: {done.stderr[-200:].strip()}")
    return done.stdout


def calls_of_plan() -> list[list[list[float]]]:
    """Of each update of the plan's walk: the arguments of each of FUNCTIONS."""
    updates: dict[str, list[list[float]]] = {}
    for line in told_calls().splitlines():
        walk, update, function, argument = line.split()
        if walk == "0":
            arguments = updates.setdefault(update, [[] for _ in FUNCTIONS])
            arguments[int(function)].append(float(argument))
    return list(updates.values())


class Floor:
    """The calls of the plan's updates, once more."""

    def __init__(self) -> None:
        ffi, _ = _library()
        updates = calls_of_plan()
        counts = [[[len(arguments) for arguments in update]] for update in updates]
        self._calls = ffi.new("saddle_bench_calls_t[]", counts)
        flat = [x for update in updates for arguments in update for x in arguments]
        self._arguments = ffi.new("float[]", flat)
        self._sum = ffi.new("float *")

    def seconds(self, strides: int) -> float:
        nanoseconds = _library()[1].saddle_bench_floor_ns(
            self._calls, self._arguments, len(instants(strides)), self._sum
        )
        return nanoseconds * 1e-9


def timed(work: Callable[[int], object]) -> Run:
    def run(strides: int) -> float:
        began_ns = time.perf_counter_ns()
        work(strides)
        return (time.perf_counter_ns() - began_ns) * 1e-9

    return run


def _numpy(at_once: bool) -> Run:
    times = {strides: instants(strides) for strides in HORIZONS}

    def work(strides: int) -> None:
        for t_s in [times[strides]] if at_once else times[strides]:
            plan(BODY, SPEED_M_S, HEEL_STRIKE_RAD, t_s)

    return timed(work)


def _octave(at_once: bool) -> Run:
    octave = Octave()
    return lambda strides: octave.seconds(
        SPEED_M_S, HEEL_STRIKE_RAD, instants(strides).tolist(), at_once
    )


def preview(strides: int) -> Preview:
    return Preview(len(instants(strides)), TICK_S, PENDULUM_M)


def axes(strides: int) -> tuple[Axis, Axis]:
    """The paper's walk for the walking QP: from the left foot via point, over the same feet."""
    t_s = instants(strides) + TICK_S
    steps = np.floor(t_s / STEP_TIME_S + 0.5)
    side = np.where(np.mod(steps, 2) == 0, WIDTH_M / 2, -WIDTH_M / 2)
    start = plan(BODY, SPEED_M_S, HEEL_STRIKE_RAD, np.zeros(1))
    y = float(start["com_y_m"][0])
    pull = -y * (math.pi / STEP_TIME_S) ** 2
    along = Axis(np.array([0, SPEED_M_S, 0]), SPEED_M_S, steps * STEP_M, FOOT_LENGTH_M / 2)
    return along, Axis(np.array([y, 0, pull]), 0.0, side, FOOT_WIDTH_M / 2)


def _walking_qp(solver: str) -> Run:
    programmes = {strides: WalkingQp(solver, preview(strides)) for strides in HORIZONS}
    walks = {strides: axes(strides) for strides in HORIZONS}
    return timed(lambda strides: [programmes[strides].jerk(axis) for axis in walks[strides]])


def _placo() -> Run:
    walk = PlacoWalk(STEP_M, STEP_TIME_S, WIDTH_M, PENDULUM_M, TICK_S)
    return timed(lambda strides: walk.plan(2 * strides))


def neighbours() -> dict[str, Callable[[], Run]]:
    """What is measured, by name: each is made once, or raises MissingError."""
    qps = {qp_name(solver): functools.partial(_walking_qp, solver) for solver in SOLVERS}
    return {
        CORE: lambda: CorePlan().seconds,
        FLOOR: lambda: Floor().seconds,
        NUMPY: lambda: _numpy(at_once=False),
        NUMPY_AT_ONCE: lambda: _numpy(at_once=True),
        OCTAVE: lambda: _octave(at_once=False),
        OCTAVE_AT_ONCE: lambda: _octave(at_once=True),
        **qps,
        PLACO: _placo,
    }


@dataclass
class Timing:
    """Seconds of every plan, by strides; or why there is none."""

    name: str
    seconds: dict[int, list[float]] = field(default_factory=lambda: {n: [] for n in HORIZONS})
    missing: str | None = None

    def median_s(self, strides: int) -> float:
        return statistics.median(self.seconds[strides])

    def worst_s(self, strides: int) -> float:
        return max(self.seconds[strides])


def measure(rounds: int) -> dict[str, Timing]:
    """Every installed planner, interleaved, `rounds` times after one warm-up."""
    timings = {name: Timing(name) for name in neighbours()}
    runs = dict(_make(timings))
    for _ in range(rounds):
        for name, run in runs.items():
            for strides in HORIZONS:
                timings[name].seconds[strides].append(run(strides))
    return timings


def _make(timings: dict[str, Timing]) -> Iterator[tuple[str, Run]]:
    for name, make in neighbours().items():
        try:
            run = make()
            for strides in HORIZONS:
                run(strides)
        except MissingError as missing:
            timings[name].missing = str(missing)
        else:
            yield name, run
