"""Recorded falls of independent walkers, scored by the core without a command.

A folder holds walkers.csv, walks.csv and states/WALKER.csv.gz, 50 rows a second. Every fourth row
is a tick; the first tick is one of a run's first four rows, in turn.
"""

import cmath
import math
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from saddlewalk.contract import TICK_S
from saddlewalk.core import Command, config_bytes, config_from
from saddlewalk.emulation.wearer import Noise
from saddlewalk.errors import UserError
from saddlewalk.evaluation.scoring import (
    Announced,
    Score,
    States,
    Walk,
    announced,
    one_tick_late,
    score,
    states_of,
)
from saddlewalk.recorded_states import (
    STATE_COLUMNS,
    measurement_of,
    recording_core,
    scored_rows,
)
from saddlewalk.table import numbers_of, read_texts
from saddlewalk.workers import Workers, run_tasks

ROWS_A_TICK = round(TICK_S / 0.02)
COM_HEIGHT = 0.57  # of the body's height
DECIMALS = 4  # decimals of the core's inputs, as in the recordings
PUSHED_KINDS = ("staircase", "random")
KINDS = ("calm", "start_stop", *PUSHED_KINDS)
RUNS_A_TASK = 20
WALKER_NUMBERS = "mass_kg com_height_walking_m sole_length_m sole_width_m".split()
WALK_TEXTS = "run walker kind".split()
WALK_NUMBERS = (
    "push_time_s push_direction_deg push_n_s fell fall_time_s ground_contact_time_s "
    "normal_com_height_m"
).split()


@dataclass(frozen=True)
class Walker:
    name: str
    body: dict[str, str]  # fields of saddle_config_t
    half_sole_m: np.ndarray


@dataclass(frozen=True)
class Scored:
    """A run, the supervisor's output for exact inputs, and its scores by INPUTS."""

    walk: Walk
    exact: Announced
    scores: dict[str, Score]


def read_walkers(folder: Path) -> list[Walker]:
    """Raises UserError if the folder does not hold recorded falls."""
    source = str(folder / "walkers.csv")
    walkers = []
    for line, row in read_texts(source, ["walker", *WALKER_NUMBERS]):
        numbers = _positive(source, line, row)
        half_sole_m = np.array([numbers["sole_length_m"], numbers["sole_width_m"]]) / 2
        body_height_m = numbers["com_height_walking_m"] / COM_HEIGHT
        body = {"body_mass_kg": row["mass_kg"], "body_height_m": f"{body_height_m:.4f}"}
        walkers.append(Walker(row["walker"], body, half_sole_m))
    if not walkers:
        raise UserError(f"{source}: no walkers")
    return walkers


def _positive(source: str, line: int, row: Mapping[str, str]) -> dict[str, float]:
    numbers = numbers_of(source, line, row, WALKER_NUMBERS)
    for column, value in numbers.items():
        if not 0 < value < math.inf:
            raise UserError(f"{source}: line {line}, {column}: {row[column]!r} must be above 0")
    return numbers


def read_walks(folder: Path, walkers: Sequence[Walker]) -> dict[str, list[Walk]]:
    """The walks of each walker, in the order of walks.csv. Each file is read once."""
    source = str(folder / "walks.csv")
    rows: dict[str, dict[str, dict[str, Any]]] = {walker.name: {} for walker in walkers}
    for line, row in read_texts(source, [*WALK_TEXTS, *WALK_NUMBERS]):
        where = f"{source}: line {line}"
        if row["walker"] not in rows:
            raise UserError(f"{where}, walker: {row['walker']!r} is not in walkers.csv")
        if row["run"] in rows[row["walker"]]:
            raise UserError(f"{where}, run: {row['run']!r} is there twice")
        rows[row["walker"]][row["run"]] = {
            **_walk_fields(where, row, numbers_of(source, line, row, WALK_NUMBERS)),
            "first_row": _run_number(where, row["run"]) % ROWS_A_TICK,
        }
    return {walker.name: _walks_of(folder, walker, rows[walker.name]) for walker in walkers}


def _run_number(where: str, run: str) -> int:
    number = run.rsplit("-", 1)[-1]
    if not number.isdecimal():
        raise UserError(f"{where}, run: {run!r} must end in - and a number")
    return int(number)


def _walk_fields(
    where: str, row: Mapping[str, str], numbers: Mapping[str, float]
) -> dict[str, Any]:
    _check_walk(where, row, numbers)
    angle_rad = math.radians(numbers["push_direction_deg"])
    pushed = row["kind"] in PUSHED_KINDS
    return {
        "name": row["run"],
        "kind": row["kind"],
        "push_s": numbers["push_time_s"],
        "fall_s": numbers["fall_time_s"],
        "ground_s": numbers["ground_contact_time_s"],
        "push_n_s": cmath.rect(numbers["push_n_s"], angle_rad) if pushed else 0j,
        "pendulum_m": numbers["normal_com_height_m"],
    }


def _check_walk(where: str, row: Mapping[str, str], numbers: Mapping[str, float]) -> None:
    if row["kind"] not in KINDS:
        raise UserError(f"{where}, kind: {row['kind']!r} must be one of {', '.join(KINDS)}")
    if numbers["fell"] != float(math.isfinite(numbers["fall_time_s"])):
        raise UserError(f"{where}, fell: {row['fell']!r} must be 1 with a fall_time_s, else 0")
    for column in ("push_time_s", "push_direction_deg", "push_n_s"):
        if math.isfinite(numbers[column]) != (row["kind"] in PUSHED_KINDS):
            pushed = " and ".join(PUSHED_KINDS)
            raise UserError(f"{where}, {column}: {row[column]!r} must be given in {pushed} only")
    if not 0 < numbers["normal_com_height_m"] < math.inf:
        text = row["normal_com_height_m"]
        raise UserError(f"{where}, normal_com_height_m: {text!r} must be above 0")


def _walks_of(folder: Path, walker: Walker, runs: dict[str, dict[str, Any]]) -> list[Walk]:
    path = folder / "states" / f"{walker.name}.csv.gz"
    first_rows = {run: fields.pop("first_row") for run, fields in runs.items()}
    states = _read_states(str(path), first_rows)
    for run in runs:
        if not states[run]:
            raise UserError(f"{path}: no rows of {run}, which is in walks.csv")
    return [
        Walk(**fields, states=states_of(states[run]), half_sole_m=walker.half_sole_m)
        for run, fields in runs.items()
    ]


def _read_states(source: str, first_rows: Mapping[str, int]) -> dict[str, list[list[float]]]:
    """The ticks of each run in first_rows, from its first row on."""
    counts = dict.fromkeys(first_rows, 0)
    ticks: dict[str, list[list[float]]] = {run: [] for run in first_rows}
    for line, row in read_texts(source, ["run", *STATE_COLUMNS]):
        run = row["run"]
        if run not in counts:
            continue
        if counts[run] % ROWS_A_TICK == first_rows[run]:
            numbers = numbers_of(source, line, row, STATE_COLUMNS)
            last_s = ticks[run][-1][0] if ticks[run] else -math.inf
            _check_state(f"{source}: line {line}", numbers, last_s)
            ticks[run].append(list(numbers.values()))
        counts[run] += 1
    return ticks


def _check_state(where: str, numbers: Mapping[str, float], last_s: float) -> None:
    """Reject a row without the numbers that scores need; others may be missing."""
    if not last_s < numbers["t_s"] < math.inf:
        raise UserError(f"{where}, t_s: {numbers['t_s']:g} must be a time after {last_s:g} s")
    for column in ("left_contact", "right_contact"):
        if numbers[column] not in (0, 1):
            raise UserError(f"{where}, {column}: {numbers[column]:g} must be 0 or 1")


def score_walks(
    walks: Sequence[tuple[Walk, Any]], seed: int, workers: Workers, progress: Callable[[int], None]
) -> list[Scored]:
    """Each walk with the saddle_config_t of its walker; progress(walks done).

    The same scores in the same order, whatever the workers.
    """
    runs = [(walk, config_bytes(config), seed) for walk, config in walks]
    tasks = [(runs[first : first + RUNS_A_TASK],) for first in range(0, len(runs), RUNS_A_TASK)]
    return run_tasks(_work, tasks, workers, progress)


def _work(runs: Sequence[tuple[Walk, bytes, int]]) -> list[Scored]:
    return [_score(*run) for run in runs]


def _score(walk: Walk, image: bytes, seed: int) -> Scored:
    config = config_from(image)
    random = np.random.default_rng([seed, zlib.crc32(walk.name.encode())])
    exact = supervise(walk, walk.states, config)
    noisy = supervise(walk, _with_noise(walk.states, random), config)
    inputs = {"exact": exact, "noise": noisy, "one_tick_late": one_tick_late(exact)}
    return Scored(walk, exact, {name: score(walk, each) for name, each in inputs.items()})


def supervise(walk: Walk, seen: States, config: Any) -> Announced:
    """The output for these states of a supervisor without commands."""
    rows = scored_rows(recording_core(config), Command(), _measurements(walk.name, seen))
    return announced(walk, list(rows), seen)


def _measurements(name: str, seen: States) -> Iterator[tuple[float, Any]]:
    numbers = np.column_stack(
        [seen.t_s, seen.com_m, seen.velocity_m_s, seen.feet_m.reshape(-1, 4), seen.contact]
    )
    for values in numbers.tolist():
        state = dict(zip(STATE_COLUMNS, (round(each, DECIMALS) for each in values), strict=True))
        yield state["t_s"], measurement_of(name, state)


def _with_noise(states: States, random: np.random.Generator) -> States:
    """The states with the noise of the emulated wearer's sensors; contacts are unchanged."""
    noise, ticks = Noise(), len(states.t_s)
    height_m = random.normal(0, noise.position_m, (ticks, 1))
    return States(
        t_s=states.t_s,
        com_m=states.com_m + np.concatenate([np.zeros((ticks, 2)), height_m], axis=1),
        velocity_m_s=states.velocity_m_s + random.normal(0, noise.velocity_m_s, (ticks, 2)),
        feet_m=states.feet_m + random.normal(0, noise.position_m, (ticks, 2, 2)),
        contact=states.contact,
    )
