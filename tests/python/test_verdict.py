"""`saddlewalk supervise`'s energies, expected margins and levels against the model in numpy."""

import csv
import io
import math
from dataclasses import dataclass

import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.recorded_states import STATE_COLUMNS
from twin import GRAVITY, Twin, bos_margin, to_saddle

pytestmark = pytest.mark.firmware

SPEEDS = [0.5, 0.7, 1.0, 1.2, 1.6]
DT_S = 0.08
D_H_M = 0.10
HORIZON_S = 0.4
MARGIN_TOLERANCE_M = 2e-5
ENERGY_TOLERANCE_J = 5e-3  # the states' rounding: 500 N over 10 um

# What the tests below count on, whatever the defaults are.
CONFIG = f"""
previous_level = 1
level_hold_ticks = 1
prediction_horizon_s = {HORIZON_S}
caution_xcom_ap_m = 0.13
caution_xcom_ml_m = 0.07
cop_shift_ap_m = 0.10
cop_shift_ml_m = 0.03
"""

State = dict[str, float]
Row = dict[str, str]


# ---- the model page's section 7, in double ---------------------------------------------------


def ray_exit(left, right, point, velocity) -> np.ndarray:
    """Where a ray from inside leaves the base of support: its first intersection."""
    (x, y), radius = to_saddle(left, right, point), 0.5 * float(np.linalg.norm(left - right))
    centre = 0.5 * (left + right)
    ux, uy = to_saddle(left, right, centre + velocity / np.linalg.norm(velocity))
    along = x * ux + y * uy
    ways = [math.sqrt(radius**2 - x * x - y * y + along**2) - along]
    if ux != 0:
        ways += [way for way in ((D_H_M - x) / ux, (-D_H_M - x) / ux) if way >= 0]
    return point + min(ways) * velocity / np.linalg.norm(velocity)


def nearest_border(left, right, point) -> np.ndarray:
    """By the margin's gradient: the way out is the margin, whichever region the point is in."""
    margin, h = bos_margin(left, right, D_H_M, point), 1e-6
    slope = [
        bos_margin(left, right, D_H_M, point + step) - bos_margin(left, right, D_H_M, point - step)
        for step in (np.array([h, 0.0]), np.array([0.0, h]))
    ]
    return point - margin * np.array(slope) / (2 * h)


def potential_j(twin: Twin, left, right, point) -> float:
    """U = m g z_s, the higher of the pendulums over the two feet."""
    lever = min(float(np.linalg.norm(point - foot)) for foot in (left, right))
    return twin.mass * GRAVITY * math.sqrt(twin.pendulum**2 - lever**2)


def border_potential_j(twin: Twin, left, right, point, velocity) -> float:
    inside = bos_margin(left, right, D_H_M, point) >= 0
    exit_m = (
        ray_exit(left, right, point, velocity) if inside else nearest_border(left, right, point)
    )
    return potential_j(twin, left, right, exit_m)


def kinetic_j(twin: Twin, velocity) -> float:
    return 0.5 * twin.mass * float(velocity @ velocity)


@dataclass(frozen=True)
class Landing:
    """The posture at the next heel strike of a planned walk at time t."""

    twin: Twin
    t: float

    @property
    def time_s(self) -> float:
        return (self.twin.steps_taken(self.t) + 0.5) * self.twin.step_time

    def feet(self) -> tuple[np.ndarray, np.ndarray]:
        """Left and right: the stance foot and the place to land."""
        taken, half_width = self.twin.steps_taken(self.t), 0.5 * self.twin.width
        stance_x, landing_x = taken * self.twin.step, (taken + 1) * self.twin.step
        left_x, right_x = (stance_x, landing_x) if taken % 2 == 0 else (landing_x, stance_x)
        return np.array([left_x, half_width]), np.array([right_x, -half_width])

    def margin(self, point) -> float:
        return bos_margin(*self.feet(), D_H_M, point)


@dataclass(frozen=True)
class Deviation:
    """Of the CoM from the plan, and what free fall makes of it."""

    place_m: np.ndarray
    velocity_m_s: np.ndarray

    def grown(self, frequency: float, time_s: float) -> "Deviation":
        cosh, sinh = math.cosh(frequency * time_s), math.sinh(frequency * time_s)
        return Deviation(
            self.place_m * cosh + self.velocity_m_s / frequency * sinh,
            self.place_m * frequency * sinh + self.velocity_m_s * cosh,
        )

    def xcom_m(self, frequency: float) -> np.ndarray:
        return self.place_m + self.velocity_m_s / frequency


NO_DEVIATION = Deviation(np.zeros(2), np.zeros(2))


def expected(twin: Twin, t: float, deviation: Deviation) -> dict[str, float]:
    """The new columns for a wearer who is off the plan, on the plan's feet."""
    feet = twin.feet(t)
    left, right = feet["left"], feet["right"]
    planned_m, planned_m_s = twin.com_xy(t), twin.com_xy_velocity(t)
    com_m, velocity_m_s = planned_m + deviation.place_m, planned_m_s + deviation.velocity_m_s
    landing = Landing(twin, t)
    grown = deviation.grown(twin.frequency, min(landing.time_s - t, HORIZON_S))
    u_com = potential_j(twin, left, right, com_m)
    k = kinetic_j(twin, velocity_m_s)
    return {
        "excess_stop_j": k + u_com - border_potential_j(twin, left, right, com_m, velocity_m_s),
        "excess_track_j": k
        - kinetic_j(twin, planned_m_s)
        + u_com
        - border_potential_j(twin, left, right, planned_m, planned_m_s),
        "ebos_com_m": landing.margin(twin.com_xy(landing.time_s) + grown.place_m),
        "ebos_xcom_m": landing.margin(twin.xcom(landing.time_s) + grown.xcom_m(twin.frequency)),
    }


def ankle_work_j(twin: Twin) -> float:
    return twin.mass * GRAVITY * D_H_M**2 / twin.pendulum


# ---- running the commands --------------------------------------------------------------------


def planned_states(capsys, speed: float, strides: int, dt_s: float = DT_S) -> list[State]:
    """`saddlewalk plan` as a recording: the stance foot is on the ground."""
    options = ["--speed", str(speed), "--strides", str(strides), "--dt", str(dt_s)]
    assert main(["plan", *options]) == 0
    states = []
    for row in csv.DictReader(io.StringIO(capsys.readouterr().out)):
        state = {name: float(row[name]) for name in STATE_COLUMNS if name in row}
        state |= {f"{side}_contact": int(row["support"] == side) for side in ("left", "right")}
        states.append(state)
    return states


def standing_states(count: int) -> list[State]:
    both = {"left_x_m": 0.0, "left_y_m": 0.11, "right_x_m": 0.0, "right_y_m": -0.11}
    still = {"com_x_m": 0.0, "com_y_m": 0.0, "com_z_m": 1.0, "com_vx_m_s": 0.0, "com_vy_m_s": 0.0}
    contact = {"left_contact": 1, "right_contact": 1}
    return [{"t_s": k * DT_S, **both, **still, **contact} for k in range(count)]


def supervise(capsys, tmp_path, states: list[State], *options: str) -> list[Row]:
    source, config = tmp_path / "states.csv", tmp_path / "config.toml"
    config.write_text(CONFIG)
    with source.open("w", newline="") as file:
        writer = csv.DictWriter(file, STATE_COLUMNS)
        writer.writeheader()
        writer.writerows(states)
    assert main(["supervise", "--in", str(source), "--config", str(config), *options]) == 0
    return list(csv.DictReader(io.StringIO(capsys.readouterr().out)))


def deviate(states: list[State], deviation: Deviation) -> None:
    for state in states:
        for axis, name in enumerate(("x", "y")):
            state[f"com_{name}_m"] += deviation.place_m[axis]
            state[f"com_v{name}_m_s"] += deviation.velocity_m_s[axis]


def assert_equal_the_model(rows: list[Row], twin: Twin, deviation: Deviation) -> None:
    for row in rows:
        model = expected(twin, float(row["t_s"]), deviation)
        for column, value in model.items():
            tolerance = ENERGY_TOLERANCE_J if column.endswith("_j") else MARGIN_TOLERANCE_M
            assert float(row[column]) == pytest.approx(value, abs=tolerance), (column, row["t_s"])
        work = ankle_work_j(twin)
        for bit, energy in (("can_stop", "excess_stop_j"), ("on_track", "excess_track_j")):
            if abs(model[energy] - work) > ENERGY_TOLERANCE_J:
                assert int(row[bit]) == (model[energy] <= work), (bit, row["t_s"])


# ---- against the model -----------------------------------------------------------------------


@pytest.mark.parametrize("speed", SPEEDS)
def test_a_planned_walk_matches_the_twin(speed, capsys, tmp_path):
    states = planned_states(capsys, speed, 4)
    rows = supervise(capsys, tmp_path, states, "--speed", str(speed))
    assert len(rows) == len(states)
    assert_equal_the_model(rows, Twin(speed, 0.0), NO_DEVIATION)


DEVIATIONS = {
    "ahead": Deviation(np.array([0.05, 0.0]), np.array([0.15, 0.0])),
    "behind": Deviation(np.array([-0.04, 0.01]), np.array([-0.3, 0.0])),
    "aslant": Deviation(np.array([0.0, -0.02]), np.array([0.1, 0.12])),
}


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("name", DEVIATIONS)
def test_deviation_from_the_plan_grows_as_in_the_twin(speed, name, capsys, tmp_path):
    states = planned_states(capsys, speed, 3)
    deviate(states, DEVIATIONS[name])
    rows = supervise(capsys, tmp_path, states, "--speed", str(speed))
    assert_equal_the_model(rows, Twin(speed, 0.0), DEVIATIONS[name])


@pytest.mark.parametrize("speed", SPEEDS)
def test_an_own_walk_matches_the_twin(speed, capsys, tmp_path):
    """Without a plan, from the last step: as exact as a heel strike is seen, here within 2 ms."""
    states = planned_states(capsys, speed, 2, 0.002)
    rows = supervise(capsys, tmp_path, states)
    known = [row for row in rows if row["v_comp_m_s"]]
    assert len(known) > len(rows) / 4
    for row in known:
        model = expected(Twin(speed, 0.0), float(row["t_s"]), NO_DEVIATION)
        for column, value in model.items():
            tolerance = 0.01 if column.endswith("_j") else 3e-4
            assert float(row[column]) == pytest.approx(value, abs=tolerance), (column, row["t_s"])


# ---- levels ----------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", SPEEDS)
def test_following_a_steady_plan_is_stable(speed, capsys, tmp_path):
    """But for where even the planned CoM is higher above the border than the ankles can absorb."""
    twin = Twin(speed, 0.0)
    rows = supervise(capsys, tmp_path, planned_states(capsys, speed, 10), "--speed", str(speed))
    for row in rows:
        excess_j = expected(twin, float(row["t_s"]), NO_DEVIATION)["excess_track_j"]
        if abs(excess_j - ankle_work_j(twin)) > ENERGY_TOLERANCE_J:
            level = "stable" if excess_j < ankle_work_j(twin) else "caution"
            assert row["level"] == level, row["t_s"]


@pytest.mark.parametrize("speed", SPEEDS)
def test_an_own_steady_walk_is_never_unstable(speed, capsys, tmp_path):
    """Without a plan: unknown until a step is complete, and known from then on."""
    rows = supervise(capsys, tmp_path, planned_states(capsys, speed, 10))
    levels = [row["level"] for row in rows]
    known = next(k for k, row in enumerate(rows) if row["v_comp_m_s"])
    assert set(levels[:known]) == {"unknown"}
    assert set(levels[known:]) <= {"stable", "caution"}


PUSHES = {"forward": (0.1, 0.0), "backward": (-0.1, 0.0), "sideways": (0.0, 0.03)}
HARDEST = 40  # times that


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("name", PUSHES)
def test_push_makes_the_walk_unstable(speed, name, capsys, tmp_path):
    """Sideways is over the stance foot, where the other one cannot land."""
    states = planned_states(capsys, speed, 4)[:21]
    outward = 1 if states[-1]["left_contact"] else -1
    levels = []
    for times in range(HARDEST):
        pushed = [dict(state) for state in states]
        pushed[-1]["com_vx_m_s"] += times * PUSHES[name][0]
        pushed[-1]["com_vy_m_s"] += times * PUSHES[name][1] * outward
        rows = supervise(capsys, tmp_path, pushed, "--speed", str(speed))
        levels.append(rows[-1]["level"])
    severity = [("stable", "caution", "unstable").index(level) for level in levels]
    assert severity == sorted(severity), "a harder push is no smaller danger"
    assert severity[0] == 0 and severity[-1] == 2


@pytest.mark.parametrize("column", STATE_COLUMNS[1:])
@pytest.mark.parametrize("led", [True, False])
def test_a_missing_cell_is_unknown_in_its_tick_only(column, led, capsys, tmp_path):
    states = planned_states(capsys, 1.0, 6)
    options = ("--speed", "1.0") if led else ()
    undisturbed = supervise(capsys, tmp_path, states, *options)
    states[-3][column] = ""
    rows = supervise(capsys, tmp_path, states, *options)
    assert rows[-3]["level"] == "unknown"
    assert int(rows[-3]["flags"], 16) >> 24 == 1  # SADDLE_REASON_INPUT
    for name in ("ebos_com_m", "ebos_xcom_m", "excess_stop_j", "excess_track_j", "on_track"):
        assert rows[-3][name] == "", name
    assert [row["level"] for row in rows[:-3]] == [row["level"] for row in undisturbed[:-3]]
    assert {row["level"] for row in rows[-2:]} <= {"stable", "caution"}


# ---- standing --------------------------------------------------------------------------------


def test_standing_still_is_stable_and_can_stop(capsys, tmp_path):
    rows = supervise(capsys, tmp_path, standing_states(30))
    assert {row["level"] for row in rows} == {"stable"}
    assert {row["can_stop"] for row in rows} == {"1"}
    twin = Twin(1.0, 0.0)
    for row in rows:  # at rest midway: down to the border d_h ahead
        fall = math.sqrt(twin.pendulum**2 - 0.0121) - math.sqrt(twin.pendulum**2 - 0.0221)
        assert float(row["excess_stop_j"]) == pytest.approx(twin.mass * GRAVITY * fall, abs=1e-3)


@pytest.mark.parametrize("push_m_s", [(2.5, 0.0), (-2.5, 0.0), (0.0, 2.5), (0.0, -2.5)])
def test_push_of_a_standing_person_ends_in_unstable(push_m_s, capsys, tmp_path):
    states = standing_states(30)
    for k, state in enumerate(states[20:], start=1):
        state["com_vx_m_s"], state["com_vy_m_s"] = push_m_s
        state["com_x_m"], state["com_y_m"] = (DT_S * k * speed for speed in push_m_s)
    rows = supervise(capsys, tmp_path, states)
    assert {row["level"] for row in rows[:20]} == {"stable"}
    assert rows[20]["level"] == "unstable" and rows[20]["can_stop"] == "0"


def test_the_level_is_known_after_a_stand_or_a_step(capsys, tmp_path):
    states = standing_states(10)
    for k, state in enumerate(states):
        state["com_vx_m_s"], state["com_x_m"] = 0.5, 0.5 * DT_S * k
    rows = supervise(capsys, tmp_path, states)
    assert {row["level"] for row in rows} == {"unknown"}
    assert {int(row["flags"], 16) >> 24 for row in rows} == {2}  # SADDLE_REASON_NO_WALK
    assert all(row["excess_stop_j"] and not row["excess_track_j"] for row in rows)
