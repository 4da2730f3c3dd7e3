"""Emulated walks with random pushes, and the supervisor's output before the wearer fell.

Everything follows from a seed and the number of walks. A walk begins from standing; once it is
steady the wearer is pushed. Even walks draw any push, the same for both kinds of wearer. Odd walks
are near the wearer's limit: each cell of speed and direction is a staircase (Dixon and Mood 1948),
in which the next push is harder if the wearer stayed up and weaker if it fell, so that about half
fall and the pushes gather where half do.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from saddlewalk.contract import STANDING, TICK_S, WALKING
from saddlewalk.core import config_bytes, config_from, library
from saddlewalk.emulation import closed_loop
from saddlewalk.emulation.wearer import Body, Noise, Push, Wearer
from saddlewalk.evaluation import scoring
from saddlewalk.evaluation.baselines import half_foot_m, hof_margin_m, hull_margin_m
from saddlewalk.evaluation.emulated import TickRecorder
from saddlewalk.evaluation.scoring import Announced, Score, one_tick_late, score
from saddlewalk.physics.plants import POINT_MASS, PlantChoice
from saddlewalk.planning.schedule import Speeds, schedule_of
from saddlewalk.workers import Workers, run_tasks

KINDS = ("planned", "recovery")
SPEEDS_M_S = (0.5, 1.6)
SPEED_BINS = 4
DIRECTIONS = {  # degrees from straight ahead, to either side
    "forward": (0.0, 22.5),
    "oblique": (22.5, 67.5),
    "sideways": (67.5, 112.5),
    "oblique back": (112.5, 157.5),
    "back": (157.5, 180.0),
}
CELLS = SPEED_BINS * len(DIRECTIONS)
ANY_PUSH_M_S = 0.7  # the hardest of all: N s per kg
FIRST_PUSH_M_S = 0.3  # of a staircase
STAIR, FINE_STAIR = 1.5, 1.15  # until the first turn, and from then on
PUSH_FROM_S, PUSH_TO_S = 6.0, 8.0  # after several steady strides; longer than a stride
OBSERVED_S = 6.0  # after a push
EVIDENCE_S = 3.0  # margins are searched for this long after a push, or until the fall
WARNING_MIN_S = 3 * TICK_S  # later, the CoM itself shows the fall
SOON_S = 5 * TICK_S  # first part of the evidence, from the beginning of the push
WINDOWS = ("to the fall", "to 0.24 s before", "first 0.4 s")
HEEL_STRIKE_RAD = math.radians(10)
CALM_SHARE = 0.1  # walks without a push, as a share of those with one
EXACT_SENSORS = Noise(position_m=0.0, velocity_m_s=0.0)
START_S, TURN_S, STOP_S, CALM_S = 1.0, 3.0, 25.0, 30.0

FIELDS = (
    "time_s mode com_vx_m_s com_vy_m_s left_x_m left_y_m right_x_m right_y_m left_contact "
    "right_contact faults level reason compared paper_stable can_stop on_track s_pend s_jump s_sw "
    "mos_com_m mos_xcom_m ebos_com_m ebos_xcom_m excess_stop_j excess_track_j xcom_off_x_m "
    "xcom_off_y_m recovery_found recovery_stops recovery_foot recovery_x_m recovery_y_m "
    "recovery_margin_m hull_com_m hof_xcom_m planned_landing_x_m planned_landing_y_m "
    "true_xcom_x_m true_xcom_y_m true_com_x_m true_com_y_m"
).split()
TICK = np.dtype([(name, float) for name in FIELDS])

# Margins by their name in tables; lower is worse.
MARGINS: dict[str, Callable[[Any], Any]] = {
    "XCoM in I-BoS": lambda ticks: ticks["mos_xcom_m"],
    "XCoM in E-BoS": lambda ticks: ticks["ebos_xcom_m"],
    "CoM in E-BoS": lambda ticks: ticks["ebos_com_m"],
    "excess energy to stop": lambda ticks: -ticks["excess_stop_j"],
    "excess energy to track": lambda ticks: -ticks["excess_track_j"],
    "S_SW": lambda ticks: ticks["s_sw"],
    "recovery margin": lambda ticks: ticks["recovery_margin_m"],
    "announced level": lambda ticks: -np.where(ticks["level"] > 0, ticks["level"], np.nan),
    "paper's verdict": lambda ticks: ticks["paper_stable"],
    "baseline: CoM in the feet's hull": lambda ticks: ticks["hull_com_m"],
    "baseline: Hof's margin": lambda ticks: ticks["hof_xcom_m"],
}


@dataclass(frozen=True)
class Trial:
    """Parameters of an emulated walk. impulse_n_s 0: no push, and the walk is stopped at STOP_S."""

    kind: str
    index: int
    cell: int  # of its staircase; -1: none
    speed_m_s: float
    direction_deg: float
    push_time_s: float
    impulse_n_s: float
    wearer_seed: int


@dataclass(frozen=True)
class Setting:
    """What is common to all walks: which wearer walks, and how fast."""

    plant: PlantChoice = POINT_MASS
    speeds_m_s: tuple[float, float] = SPEEDS_M_S
    delay_s: float = 0.0  # of every measurement
    turn_rad_s: float = 0.0  # from TURN_S on, half of the walks to the left


POINT_MASS_WALKS = Setting()


@dataclass(frozen=True)
class Course:
    """How a walk went, up to the fall or the end."""

    ticks: np.ndarray  # of TICK
    fell_at_s: float  # NaN: did not
    parts: list[tuple[scoring.Walk, Announced]]  # as every walker is scored


@dataclass(frozen=True)
class Walk:
    """A trial and what came of it. Times in s from the start; NaN: did not happen."""

    trial: Trial
    fell_at_s: float
    alarm_at_s: float  # first tick announced unstable after the push and before a fall
    least: dict[str, dict[str, float]]  # by window, each margin's minimum after the push
    walking_levels: dict[int, int]  # ticks of steady walking before a push, by saddle_level_t
    walking_reasons: dict[int, int]  # and by saddle_reason_t
    moving_levels: dict[int, int]  # starts and stops included
    scores: dict[str, list[Score]]  # by INPUTS, as every walker is scored

    @property
    def fell(self) -> bool:
        return math.isfinite(self.fell_at_s)

    @property
    def lead_s(self) -> float:
        return self.fell_at_s - self.alarm_at_s

    def row(self) -> dict[str, Any]:
        return {
            **asdict(self.trial),
            "fell_at_s": self.fell_at_s,
            "alarm_at_s": self.alarm_at_s,
            **{
                f"{name}, {window}": value
                for window, margins in self.least.items()
                for name, value in margins.items()
            },
        }


def course_of(seed: int, index: int, kind: str, config: Any) -> tuple[Trial, Course]:
    """The pushed walk `index` and how it went."""
    chain = next(chain for chain in _chains(index + 1) if index in chain)
    *_, last = _walk_chain(seed, chain, kind, config)
    return last


def evaluate(
    seed: int,
    walks: int,
    config: Any,
    workers: Workers,
    progress: Callable[[int], None],
    setting: Setting = POINT_MASS_WALKS,
) -> list[Walk]:
    """Both kinds of wearer, pushed `walks` times each and unperturbed; progress(walks done).

    The same walks in the same order, whatever the workers.
    """
    image = config_bytes(config)
    chains = _chains(walks) + [[-1 - k] for k in range(calm_walks(walks))]
    tasks = [(seed, chain, kind, image, setting) for kind in KINDS for chain in chains]
    done = run_tasks(_work, tasks, workers, progress)
    return sorted(done, key=lambda walk: (walk.trial.kind, walk.trial.index))


def calm_walks(walks: int) -> int:
    """Number of unperturbed walks of a kind, for a number of pushed ones."""
    return max(math.ceil(walks * CALM_SHARE), 1)


def _work(seed: int, chain: list[int], kind: str, image: bytes, setting: Setting) -> list[Walk]:
    config = config_from(image)
    walks = []
    for trial, course in _walk_chain(seed, chain, kind, config, setting):
        # A body's physics takes seconds for a walk: it walks once.
        again = None if setting.plant.is_mujoco else run(trial, config, EXACT_SENSORS, setting)
        walks.append(evaluated_walk(trial, course, again))
    return walks


def run(
    trial: Trial, config: Any, noise: Noise | None = None, setting: Setting = POINT_MASS_WALKS
) -> Course:
    """noise: the wearer's own by default."""
    pushed = trial.impulse_n_s > 0
    push = Push(trial.impulse_n_s, trial.push_time_s, trial.direction_deg)
    wearer = setting.plant.wearer(
        config,
        noise,
        pushes=(push,) if pushed else (),
        seed=trial.wearer_seed,
        takes_recovery_step=trial.kind == "recovery",
    )
    stop = [] if pushed else [(STOP_S, 0.0)]
    turn_rad_s = setting.turn_rad_s * (1 if trial.wearer_seed % 2 else -1)
    turning = (TURN_S, trial.speed_m_s, turn_rad_s)
    speeds: Speeds = [(0.0, 0.0), (START_S, trial.speed_m_s), turning, *stop]
    schedule = schedule_of(speeds, HEEL_STRIKE_RAD)
    end_s = trial.push_time_s + OBSERVED_S if pushed else CALM_S
    rows, witness = [], TickRecorder(config)
    for tick in closed_loop.walk(config, wearer, schedule, delay_s=setting.delay_s):
        if tick.time_s >= end_s or wearer.fallen:
            break
        rows.append(_row(tick, wearer))
        witness.see(tick, wearer)
    ticks = np.array(rows, dtype=TICK)
    _add_baselines(ticks, config)
    push_s = trial.push_time_s if pushed else math.nan
    parts = witness.parts(_scored_kind(trial), push_s, wearer.fell_at_s)
    return Course(ticks, wearer.fell_at_s, parts)


def _scored_kind(trial: Trial) -> str:
    if trial.impulse_n_s == 0:
        return "start_stop"
    return "random" if trial.cell < 0 else "staircase"


def _row(tick: closed_loop.Tick, wearer: Wearer) -> tuple[float, ...]:
    core, output, seen, plan = library(), tick.output, tick.measured, tick.plan
    scores, verdict = output.scores, output.verdict
    recovery = verdict.recovery
    left, right = seen.feet_m
    landing = plan.landing_m - plan.feet_m[plan.support]

    def scored(value: float, bit: int) -> float:
        return value if scores.valid & bit else math.nan

    def compared(value: float) -> float:
        return value if verdict.compared else math.nan

    step, stop = core.SADDLE_VALID_STEP, core.SADDLE_VALID_STOP
    return (
        *(tick.time_s, plan.mode, seen.velocity_m_s.real, seen.velocity_m_s.imag),
        *(left.real, left.imag, right.real, right.imag, *seen.contact),
        *(output.faults, verdict.level, verdict.reason, verdict.compared, scores.paper_stable),
        scored(scores.can_stop, stop),
        *map(compared, (verdict.on_track,)),
        *(scored(scores.s_pend, step), scored(scores.s_jump, step)),
        scored(scores.s_sw, core.SADDLE_VALID_S_SW),
        scored(scores.mos_com_m, core.SADDLE_VALID_MOS_COM),
        scored(scores.mos_xcom_m, core.SADDLE_VALID_MOS_XCOM),
        *map(compared, (verdict.ebos_com_m, verdict.ebos_xcom_m)),
        scored(scores.excess_stop_j, stop),
        compared(verdict.excess_track_j),
        *map(compared, (verdict.xcom_deviation_m.x, verdict.xcom_deviation_m.y)),
        *map(compared, (recovery.found, recovery.stops, recovery.foot)),
        *map(compared, (recovery.landing_m.x, recovery.landing_m.y, recovery.margin_m)),
        *(math.nan, math.nan, landing.real, landing.imag),
        *(wearer.xcom_m.real, wearer.xcom_m.imag, wearer.com_m.real, wearer.com_m.imag),
    )


def _add_baselines(ticks: np.ndarray, config: Any) -> None:
    body = Body.of(config)
    cop_m = np.stack(
        [np.stack([ticks[f"{side}_{axis}_m"] for axis in "xy"], 1) for side in ("left", "right")], 1
    )
    velocity_m_s = np.stack([ticks["com_vx_m_s"], ticks["com_vy_m_s"]], 1)
    contact = np.stack([ticks["left_contact"], ticks["right_contact"]], 1) > 0
    xcom_m = velocity_m_s / body.natural_frequency_rad_s
    half_m = half_foot_m(body.height_m)
    ticks["hull_com_m"] = hull_margin_m(np.zeros_like(xcom_m), cop_m, half_m)
    ticks["hof_xcom_m"] = hof_margin_m(xcom_m, cop_m, contact, half_m)


def evaluated_walk(trial: Trial, course: Course, exact: Course | None) -> Walk:
    """The evaluation of a walk, and of the same walk with exact sensors, if it was made."""
    ticks, fell_at_s = course.ticks, course.fell_at_s
    time_s, level = ticks["time_s"], ticks["level"]
    pushed = np.full(len(ticks), trial.impulse_n_s > 0) & (time_s >= trial.push_time_s)
    alarms = time_s[pushed & (level == library().SADDLE_LEVEL_UNSTABLE)]
    seen = pushed & (time_s < trial.push_time_s + EVIDENCE_S)
    early = seen & ~(time_s >= fell_at_s - WARNING_MIN_S)
    soon = early & (time_s < trial.push_time_s + SOON_S)
    walking, moving = ~pushed & (ticks["mode"] == WALKING), ~pushed & (ticks["mode"] != STANDING)
    return Walk(
        trial=trial,
        fell_at_s=fell_at_s,
        alarm_at_s=float(alarms[0]) if len(alarms) else math.nan,
        least={
            window: _least(ticks[part])
            for window, part in zip(WINDOWS, (seen, early, soon), strict=True)
        },
        walking_levels=_counts(level[walking]),
        walking_reasons=_counts(ticks["reason"][walking]),
        moving_levels=_counts(level[moving]),
        scores=_scores(course, exact),
    )


def _scores(course: Course, exact: Course | None) -> dict[str, list[Score]]:
    """In the order of INPUTS."""
    noise = [score(*part) for part in course.parts]
    if exact is None:
        return {"noise": noise}
    late = [(walk, one_tick_late(announced)) for walk, announced in exact.parts]
    return {
        "exact": [score(*part) for part in exact.parts],
        "noise": noise,
        "one_tick_late": [score(*part) for part in late],
    }


def _least(ticks: np.ndarray) -> dict[str, float]:
    return {
        name: float(np.fmin.reduce(margin(ticks), initial=np.nan))
        for name, margin in MARGINS.items()
    }


def _counts(codes: np.ndarray) -> dict[int, int]:
    values, counts = np.unique(codes.astype(int), return_counts=True)
    return dict(zip(values.tolist(), counts.tolist(), strict=True))


def _chains(walks: int) -> list[list[int]]:
    """Indices of the walks that must follow each other: a staircase each, and any push alone."""
    near = range(1, walks, 2)
    chains = [list(near[cell::CELLS]) for cell in range(CELLS)]
    return [chain for chain in chains if chain] + [[index] for index in range(0, walks, 2)]


def _walk_chain(
    seed: int,
    chain: list[int],
    kind: str,
    config: Any,
    setting: Setting = POINT_MASS_WALKS,
) -> Iterator[tuple[Trial, Course]]:
    stair_n_s, factor, fell_before = FIRST_PUSH_M_S * config.body_mass_kg, STAIR, None
    for index in chain:
        trial = draw(seed, index, kind, config.body_mass_kg, setting.speeds_m_s)
        if trial.cell >= 0:
            trial = replace(trial, impulse_n_s=stair_n_s)
        course = run(trial, config, setting=setting)
        yield trial, course
        fell = math.isfinite(course.fell_at_s)
        factor = FINE_STAIR if fell_before not in (None, fell) else factor
        stair_n_s *= 1 / factor if fell else factor
        fell_before = fell


def draw(
    seed: int,
    index: int,
    kind: str,
    mass_kg: float,
    speeds_m_s: tuple[float, float] = SPEEDS_M_S,
) -> Trial:
    """Walk `index`, but for the push of a staircase; an index below 0: no push."""
    random = np.random.default_rng([seed, abs(index), int(index < 0)])
    speed, direction, time, hardness = random.random(4).tolist()
    side = 1 if random.random() < 0.5 else -1
    near = index > 0 and index % 2 == 1
    cell = index // 2 % CELLS if near else -1
    if near:
        speed_bin, direction_bin = divmod(cell, len(DIRECTIONS))
        speed = (speed_bin + speed) / SPEED_BINS
        low_deg, high_deg = list(DIRECTIONS.values())[direction_bin]
    else:
        low_deg, high_deg = 0.0, 180.0
    return Trial(
        kind=kind,
        index=index,
        cell=cell,
        speed_m_s=speeds_m_s[0] + speed * (speeds_m_s[1] - speeds_m_s[0]),
        direction_deg=side * (low_deg + direction * (high_deg - low_deg)),
        push_time_s=PUSH_FROM_S + time * (PUSH_TO_S - PUSH_FROM_S),
        impulse_n_s=0.0 if index < 0 else hardness * ANY_PUSH_M_S * mass_kg,
        wearer_seed=int(random.integers(2**32)),
    )
