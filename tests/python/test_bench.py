"""`saddlewalk bench`: all planners plan the same walk, and the table is complete."""

import dataclasses
import functools
import itertools
import json
import math
import shutil
import sys

import numpy as np
import pytest

from saddlewalk.benchmark import instructions
from saddlewalk.benchmark import timing as bench
from saddlewalk.benchmark.baselines import MissingError
from saddlewalk.benchmark.baselines.numpy_plan import margin, plan
from saddlewalk.benchmark.baselines.octave_plan import ROWS, Octave
from saddlewalk.benchmark.baselines.walking_qp import (
    JERK_WEIGHT_S6,
    SOLVERS,
    VELOCITY_WEIGHT_S2,
    Axis,
    Preview,
    WalkingQp,
)
from saddlewalk.benchmark.timing import (
    BODY,
    CorePlan,
    calls_of_plan,
    instants,
    planners,
)
from saddlewalk.cli import main
from saddlewalk.contract import GRAVITY_M_S2, LEVELS, MODES, TICK_S
from saddlewalk.paths import build_dir
from saddlewalk.planning.steady import COLUMNS, row_of
from twin import bos_margin

SPEEDS = (0.7, 1.0, 1.2, 1.6)
ANGLES_DEG = (5, 10, 15)

# Float arithmetic on metres and radians of order 1 to 10: the golden runs' stated tolerance.
TOLERANCE = 2e-5
FORCE_TOLERANCE_N = 400 * TOLERANCE
SLOWEST_OVER_MEDIAN = 1.5  # instructions


def tolerance(column: str) -> float:
    return FORCE_TOLERANCE_N if column.endswith("_n") else TOLERANCE


@functools.cache
def core_plan(speed: float, angle_deg: float) -> dict[str, np.ndarray]:
    """The plan of a stride in the benchmark, by columns."""
    core = CorePlan(speed, math.radians(angle_deg))
    assert core.plan(len(stride(speed))) > 0
    rows = [
        row_of(t_s, core.outputs[k].plan, core.scores[k]) for k, t_s in enumerate(stride(speed))
    ]
    return dict(zip(COLUMNS, zip(*rows, strict=True), strict=True))


def stride(speed: float) -> np.ndarray:
    return np.arange(0, 4 * (0.1802 * speed + 0.1351) / speed, TICK_S)


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("angle", ANGLES_DEG)
def test_numpy_plans_what_the_core_plans(speed, angle):
    core = core_plan(speed, angle)
    at_once = plan(BODY, speed, math.radians(angle), stride(speed))
    one_by_one = [plan(BODY, speed, math.radians(angle), t_s) for t_s in stride(speed)]
    assert set(at_once) == set(COLUMNS[4:]) - {"com_vz_m_s"}
    for column, values in at_once.items():
        assert values == pytest.approx(np.array(core[column]), abs=tolerance(column)), column
        each = np.array([row[column] for row in one_by_one])
        assert each == pytest.approx(np.broadcast_to(values, each.shape), abs=1e-12), column


def test_octave_plans_what_numpy_plans():
    if shutil.which("octave-cli") is None:
        pytest.skip("GNU Octave: apt install octave")
    octave = Octave()
    for speed in SPEEDS:
        numpy_plan = plan(BODY, speed, 0.2, stride(speed))
        octave_plan = octave.plan(speed, 0.2, stride(speed))
        assert list(numpy_plan) == ROWS
        for column, values in octave_plan.items():
            expected = np.broadcast_to(numpy_plan[column], values.shape)
            assert values == pytest.approx(expected, abs=1e-9), column
    assert octave.seconds(1.2, 0.2, stride(1.2), at_once=True) > 0


def test_margins_are_distances_to_every_part_of_the_border():
    left, right = (0.1, 0.2), (-0.1, -0.2)
    points = np.random.default_rng(5).uniform(-0.5, 0.5, (2, 300))
    expected = [bos_margin(np.array(left), np.array(right), 0.1, point) for point in points.T]
    assert margin(left, right, 0.1, *points) == pytest.approx(np.array(expected), abs=1e-12)
    if shutil.which("octave-cli") is not None:
        x, y = (" ".join(map(repr, row.tolist())) for row in points)
        feet = [f"[{x}; {y}] * ones(1, 300)" for x, y in (left, right)]
        text = Octave()._ask(f"printf('%.17g ', margin({feet[0]}, {feet[1]}, 0.1, [{x}], [{y}]))")
        assert np.array(text.split(), float) == pytest.approx(np.array(expected), abs=1e-12)


def installed_solvers() -> list[str]:
    import qpsolvers

    return [solver for solver in SOLVERS if solver in qpsolvers.available_solvers]


def pendulum(axis: Axis, preview: Preview, jerk: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and CoP at each instant by integration, not by the programme's matrices."""
    position, velocity, acceleration = axis.state
    period, reached = preview.period_s, []
    for rate in jerk:
        position += period * velocity + period**2 / 2 * acceleration + period**3 / 6 * rate
        velocity += period * acceleration + period**2 / 2 * rate
        acceleration += period * rate
        reached.append((velocity, position - preview.height_m / GRAVITY_M_S2 * acceleration))
    return tuple(np.array(reached).T)


@pytest.mark.parametrize("half_foot_m", [0.1, 0.04])
@pytest.mark.parametrize("strides", bench.STRIDES.values())
def test_walking_qp_keeps_the_cop_in_the_foot(strides, half_foot_m):
    preview = bench.preview(strides)
    along = dataclasses.replace(bench.axes(strides)[0], half_foot_m=half_foot_m)
    q, _ = preview.gradient_and_bounds(along)
    costs = []
    for solver in installed_solvers():
        jerk = WalkingQp(solver, preview).jerk(along)
        off_m = np.abs(pendulum(along, preview, jerk)[1] - along.stance_m)
        assert off_m.max() <= half_foot_m + (1e-3 if solver == "osqp" else 1e-6), solver
        if half_foot_m == 0.04:
            assert off_m.max() >= 0.0399, "the foot's border limits the CoP"
        costs.append(jerk @ preview.hessian @ jerk / 2 + q @ jerk)
    assert costs == pytest.approx([costs[0]] * len(costs), rel=1e-3)


def test_walking_qp_minimises_jerk_cop_error_and_speed_error():
    preview = bench.preview(1)
    for axis in bench.axes(1):
        q, _ = preview.gradient_and_bounds(axis)

        def cost(jerk, axis=axis):
            velocity, cop = pendulum(axis, preview, jerk)
            off = VELOCITY_WEIGHT_S2 * np.sum((velocity - axis.velocity_m_s) ** 2)
            off += np.sum((cop - axis.stance_m) ** 2)
            return (JERK_WEIGHT_S6 * np.sum(jerk**2) + off) / 2

        jerk = np.sin(np.arange(preview.instants))
        rise = cost(jerk) - cost(np.zeros(preview.instants))
        assert jerk @ preview.hessian @ jerk / 2 + q @ jerk == pytest.approx(rise, rel=1e-9)


def test_floor_repeats_the_calls_of_the_core():
    """An argument of erf recorded for each instant gives the heel-strike angle planned there."""
    updates = calls_of_plan()
    count = len(instants(10))
    assert len(updates) >= count
    core = CorePlan()
    core.plan(count)
    erf = bench.FUNCTIONS.index("erf")
    for k in range(count):
        angles = [bench.HEEL_STRIKE_RAD * (1 - math.erf(x)) for x in updates[k][erf]]
        planned = core.outputs[k].plan.heel_strike_rad
        assert any(planned == pytest.approx(angle, abs=1e-6) for angle in angles), k
    assert all(updates[k][bench.FUNCTIONS.index("sqrt")] for k in range(count))


def test_updates_are_the_instants_of_the_plan():
    count = len(instants(1))
    whole, walking = CorePlan(), CorePlan()
    whole.plan(count)
    walking.plan(1)
    for k in range(1, count):
        assert walking.update() > 0
        updated = row_of(0, walking.outputs[0].plan, walking.scores[0])
        assert updated == row_of(0, whole.outputs[k].plan, whole.scores[k])


def test_instructions_of_every_kind_of_tick():
    if shutil.which("valgrind") is None:
        pytest.skip("instructions: apt install valgrind")
    if "sanitize" in build_dir().name:  # a sanitizer's build does not run in valgrind
        with pytest.raises(MissingError, match="callgrind ended with"):
            instructions.count()
        return
    groups = {group.name: group for group in instructions.count()}
    kinds = [*MODES, *LEVELS, "invalid inputs"]
    assert {f"tick, {kind}" for kind in kinds} < set(groups)
    every = groups[instructions.ALL_TICKS]
    assert every.updates == 5 * 160
    for group in groups.values():
        assert group.updates > 0 and 0 < group.least <= group.median <= group.most
        assert group.floor is None or 0 < group.floor < group.median
    assert every.most / every.median <= SLOWEST_OVER_MEDIAN
    init = groups[instructions.INIT]
    assert init.least == init.most


def test_missing_planners_are_named_in_a_complete_table(monkeypatch, capsys, tmp_path):
    for package in ("qpsolvers", "placo"):
        monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setenv("PATH", str(tmp_path))
    file = tmp_path / "bench.json"
    assert main(["bench", "--rounds", "2", "--json", str(file)]) == 0
    printed, found = capsys.readouterr().out, json.loads(file.read_text())
    planning = {entry["name"]: entry for entry in found["planning"]}
    assert list(planning) == list(planners())
    here = {bench.CORE, bench.FLOOR, bench.NUMPY, bench.NUMPY_AT_ONCE}
    for name, entry in planning.items():
        line = next(line for line in printed.splitlines() if line.startswith(name))
        assert (entry["missing"] is None) == (name in here) == ("not measured" not in line)
        assert name in here or ("install" in entry["missing"] and entry["missing"] in line)
    for task, caches in itertools.product(bench.TASKS, (bench.COLD, bench.WARM)):
        assert planning[bench.CORE]["tasks"][task][caches]["of_core"] == 1
        assert planning[bench.NUMPY]["tasks"][task][caches]["of_core"] > 10
    assert set(planning[bench.NUMPY_AT_ONCE]["tasks"]) == set(bench.STRIDES)
    update = planning[bench.CORE]["tasks"][bench.UPDATE]
    assert update[bench.COLD]["median_s"] > update[bench.WARM]["median_s"]
    assert "valgrind is not installed" in printed and found["instructions"] == []
    aims = {aim["what"]: aim for aim in found["aims"]}
    assert aims["fastest QP / core, 10 strides"]["met"] is None
    assert aims["core / floor, 10 strides"]["found"] > 1
    numpy = planning[bench.NUMPY]["tasks"]["10 strides"].values()
    found_numpy = aims[f"{bench.NUMPY} / core, 10 strides"]["found"]
    assert found_numpy == min(caches["of_core"] for caches in numpy)
    assert all(aim["what"] in printed for aim in found["aims"])


def test_json_on_standard_output_is_nothing_else(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(sys.modules, "qpsolvers", None)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert main(["bench", "--rounds", "1", "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["rounds"] == 1


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--rounds", "0"], "--rounds"),
        (["--rounds", "1", "--json", "no/such/folder/bench.json"], "no/such/folder/bench.json"),
    ],
)
def test_a_bad_option_is_a_one_line_error(options, named, monkeypatch, capsys, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    try:
        status = main(["bench", *options])
    except SystemExit as exit_:
        status = exit_.code
    captured = capsys.readouterr()
    assert (status, captured.out) == (2, "")
    assert captured.err.count("\n") == 1 and named in captured.err
