"""Planning times of the core and other planners, in one process, interleaved, cold and warm.

The walk is the paper's: the mean person at 1.2 m/s and 10 degrees, an instant every 80 ms.
"""

import functools
import itertools
import math
import statistics
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import cffi
import numpy as np

from saddlewalk.benchmark.baselines import MissingError
from saddlewalk.benchmark.baselines.numpy_plan import Body, plan, step_width
from saddlewalk.benchmark.baselines.octave_plan import Octave
from saddlewalk.benchmark.baselines.placo_walk import FOOT_LENGTH_M, FOOT_WIDTH_M, PlacoWalk
from saddlewalk.benchmark.baselines.walking_qp import SOLVERS, Axis, Preview, WalkingQp
from saddlewalk.contract import TICK_S
from saddlewalk.errors import UserError
from saddlewalk.paths import built

SPEED_M_S = 1.2
HEEL_STRIKE_RAD = math.radians(10)
TICK_US = round(TICK_S * 1e6)
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

# What is timed: the next instant of a walk in progress, and walks planned from their first instant.
UPDATE = "update"
STRIDES = {"1 stride": 1, "10 strides": 10}
TASKS = (UPDATE, *STRIDES)
COLD, WARM = "cold", "warm"
EVICTING_BYTES = 64 * 2**20  # more than the caches of one core hold
WARM_UP = 3  # runs before the one that counts

Plan = Callable[[int], float]  # strides -> seconds
Runs = dict[str, Callable[[], float]]  # of TASKS, those that the planner can do -> seconds


def qp_name(solver: str) -> str:
    return f"walking QP, {solver}"


QPS = (*map(qp_name, SOLVERS), PLACO)


def instants(strides: int) -> np.ndarray:
    """The instants of a plan of so many strides, s."""
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
        most = len(instants(max(STRIDES.values())))
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
        """Plan so many instants into outputs and scores; returns the time in seconds."""
        return self._checked(
            _library()[1].saddle_bench_plan_ns(
                self._context, self._command, TICK_US, count, self.outputs, self.scores
            )
        )

    def update(self) -> float:
        """Compute the next instant into outputs[0] and scores[0]; returns the time in seconds."""
        return self._checked(
            _library()[1].saddle_bench_update_ns(
                self._context, self._command, TICK_US, self.outputs, self.scores
            )
        )

    @staticmethod
    def _checked(nanoseconds: int) -> float:
        if nanoseconds == 0:
            raise ValueError("the core rejects the walk")
        return nanoseconds * 1e-9


def recorded_calls() -> str:
    """The output of saddlewalk-bench-calls: lines of walk, update, function, argument."""
    program = built("bin/saddlewalk-bench-calls")
    done = subprocess.run([program], capture_output=True, text=True)
    if done.returncode != 0:
        raise UserError(f"{program} ended with {done.returncode}: {done.stderr[-200:].strip()}")
    return done.stdout


def calls_of_plan() -> list[list[list[float]]]:
    """For each update of the planned walk, the arguments of each of FUNCTIONS."""
    updates: dict[str, list[list[float]]] = {}
    for line in recorded_calls().splitlines():
        walk, update, function, argument = line.split()
        if walk == "0":
            arguments = updates.setdefault(update, [[] for _ in FUNCTIONS])
            arguments[int(function)].append(float(argument))
    return list(updates.values())


class Floor:
    """Repeats the recorded calls of the plan's updates."""

    def __init__(self) -> None:
        ffi, _ = _library()
        updates = calls_of_plan()
        counts = [[[len(arguments) for arguments in update]] for update in updates]
        self._calls = ffi.new("saddle_bench_calls_t[]", counts)
        flat = [x for update in updates for arguments in update for x in arguments]
        self._arguments = ffi.new("float[]", flat)
        self._sum = ffi.new("float *")
        totals = (sum(map(len, update)) for update in updates)
        begins = itertools.accumulate(totals, initial=0)
        self._updates = itertools.cycle(list(zip(range(len(updates)), begins, strict=False)))

    def seconds(self, strides: int) -> float:
        return self._seconds(0, 0, len(instants(strides)))

    def update(self) -> float:
        return self._seconds(*next(self._updates), 1)

    def _seconds(self, first: int, argument: int, updates: int) -> float:
        nanoseconds = _library()[1].saddle_bench_floor_ns(
            self._calls + first, self._arguments + argument, updates, self._sum
        )
        return nanoseconds * 1e-9


def runs_of(plan: Plan, update: Callable[[], float] | None) -> Runs:
    plans: Runs = {name: functools.partial(plan, strides) for name, strides in STRIDES.items()}
    return plans if update is None else {UPDATE: update, **plans}


def timed(work: Callable[[], object]) -> float:
    began_ns = time.perf_counter_ns()
    work()
    return (time.perf_counter_ns() - began_ns) * 1e-9


def _core() -> Runs:
    walking = CorePlan()
    walking.plan(1)
    return runs_of(CorePlan().seconds, walking.update)


def _floor() -> Runs:
    floor = Floor()
    return runs_of(floor.seconds, floor.update)


def _by_instants(seconds: Callable[[np.ndarray, bool], float], at_once: bool) -> Runs:
    """seconds(instants, at_once) plans them all at once or one by one; the former has no update."""
    times = {strides: instants(strides) for strides in STRIDES.values()}
    single = itertools.cycle(np.split(times[1], len(times[1])))
    update = None if at_once else lambda: seconds(next(single), False)
    return runs_of(lambda strides: seconds(times[strides], at_once), update)


def _numpy(at_once: bool) -> Runs:
    def seconds(t_s: np.ndarray, at_once: bool) -> float:
        parts = [t_s] if at_once else t_s
        return timed(lambda: [plan(BODY, SPEED_M_S, HEEL_STRIKE_RAD, part) for part in parts])

    return _by_instants(seconds, at_once)


def _octave(at_once: bool) -> Runs:
    octave = Octave()

    def seconds(t_s: np.ndarray, at_once: bool) -> float:
        return octave.seconds(SPEED_M_S, HEEL_STRIKE_RAD, t_s.tolist(), at_once)

    return _by_instants(seconds, at_once)


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


def _by_horizon(plan: Plan) -> Runs:
    """A planner by optimisation solves a stride's horizon at each update (receding horizon)."""
    return runs_of(plan, functools.partial(plan, 1))


def _walking_qp(solver: str) -> Runs:
    programmes = {n: WalkingQp(solver, preview(n)) for n in STRIDES.values()}
    walks = {n: axes(n) for n in STRIDES.values()}

    def seconds(strides: int) -> float:
        return timed(lambda: [programmes[strides].jerk(axis) for axis in walks[strides]])

    return _by_horizon(seconds)


def _placo() -> Runs:
    walk = PlacoWalk(STEP_M, STEP_TIME_S, WIDTH_M, PENDULUM_M, TICK_S)
    return _by_horizon(lambda strides: timed(lambda: walk.plan(2 * strides)))


def planners() -> dict[str, Callable[[], Runs]]:
    """Constructors of all planners, by name; one that is not installed raises MissingError."""
    qps = {qp_name(solver): functools.partial(_walking_qp, solver) for solver in SOLVERS}
    return {
        CORE: _core,
        FLOOR: _floor,
        NUMPY: lambda: _numpy(at_once=False),
        NUMPY_AT_ONCE: lambda: _numpy(at_once=True),
        OCTAVE: lambda: _octave(at_once=False),
        OCTAVE_AT_ONCE: lambda: _octave(at_once=True),
        **qps,
        PLACO: _placo,
    }


@dataclass
class Timing:
    """Times of a planner's runs by task and caches, in seconds; or why it was not measured."""

    name: str
    seconds: dict[str, dict[str, list[float]]] = field(default_factory=dict)
    missing: str | None = None

    def add(self, task: str, caches: str, seconds: float) -> None:
        self.seconds.setdefault(task, {COLD: [], WARM: []})[caches].append(seconds)

    def median_s(self, task: str, caches: str) -> float:
        return statistics.median(self.seconds[task][caches])

    def worst_s(self, task: str, caches: str) -> float:
        return max(self.seconds[task][caches])


def measure(rounds: int) -> list[Timing]:
    """Every planner of planners(), interleaved, `rounds` times.

    Cold: after as much other data were read as the caches hold. Warm: right after the same run.
    """
    timings = {name: Timing(name) for name in planners()}
    made = dict(_make(timings))
    other_data = np.ones(EVICTING_BYTES // 8)
    for _ in range(rounds):
        for task in TASKS:
            for name, runs in made.items():
                if task in runs:
                    other_data.sum()
                    timings[name].add(task, COLD, runs[task]())
                    for _ in range(WARM_UP):
                        runs[task]()
                    timings[name].add(task, WARM, runs[task]())
    return list(timings.values())


def _make(timings: dict[str, Timing]) -> Iterator[tuple[str, Runs]]:
    for name, make in planners().items():
        try:
            runs = make()
            for run in runs.values():
                run()
        except MissingError as missing:
            timings[name].missing = str(missing)
        else:
            yield name, runs
