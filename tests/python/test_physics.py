"""A body in MuJoCo that walks by the plan: its statics, its balance, its walk, and the wire."""

import csv
import importlib.util
import json
import math
from pathlib import Path

import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.config import configuration
from saddlewalk.contract import GRAVITY_M_S2, LEFT, RIGHT, STANDING, TICK_S
from saddlewalk.emulation import closed_loop
from saddlewalk.emulation.wearer import Noise, Push
from saddlewalk.physics.plants import PlantChoice
from saddlewalk.planning.schedule import schedule_of
from saddlewalk.transport.lcm_log import LcmLog
from saddlewalk.view.rows import NAMES, Rows

BODIES = ("winter", "dm_control")
STEADY = Noise(position_m=0.0, velocity_m_s=0.0)

needs_mujoco = pytest.mark.skipif(
    importlib.util.find_spec("mujoco") is None or importlib.util.find_spec("piqp") is None,
    reason="MuJoCo is missing: run `make physics`",
)


def wearer_with(body="winter", fields=None, **options):
    plant = PlantChoice(body)
    config = configuration({**plant.fields, **(fields or {})})
    return config, plant.wearer(config, options.pop("noise", STEADY), **options)


def walked(config, wearer, speeds, duration_s):
    """The last tick before the end or the fall."""
    last = None
    for tick in closed_loop.walk(config, wearer, schedule_of(speeds, 0.17)):
        if tick.time_s >= duration_s or wearer.fallen:
            return last
        last = tick


@needs_mujoco
def test_segments_are_those_of_the_tables():
    """Winter 2009, table 4.1; the arms and the head are in the upper body's."""
    _, wearer = wearer_with(fields={"body_height_m": 1.6, "body_mass_kg": 80.0})
    model = wearer.plant.model
    masses = {model.body(k).name: model.body_mass[k] for k in range(1, model.nbody)}
    assert sum(masses.values()) == pytest.approx(80.0)
    assert masses["left_thigh"] == pytest.approx(8.0)
    assert masses["right_foot"] == pytest.approx(1.16)
    assert masses["pelvis"] == pytest.approx(54.24)
    legs = model.body("left_shank").pos, model.body("left_foot").pos
    assert [-leg[2] for leg in legs] == pytest.approx([0.245 * 1.6, 0.246 * 1.6])


@needs_mujoco
@pytest.mark.parametrize("body", BODIES)
def test_a_body_stands_upright_with_its_weight_on_both_soles(body):
    config, wearer = wearer_with(body)
    tick = walked(config, wearer, [(0.0, 0.0)], 1.0)
    weight_n = wearer.plant.body.mass_kg * GRAVITY_M_S2
    assert wearer.plant.body.mass_kg == pytest.approx(config.body_mass_kg)
    assert wearer.plant.loads_n == pytest.approx([weight_n / 2] * 2, rel=0.02)
    assert wearer.height_m == pytest.approx(wearer.body.pendulum_m, abs=0.015)
    assert abs(wearer.com_m) < 0.005 and abs(wearer.velocity_m_s) < 0.01
    assert tick.exact.contact == (True, True)
    for side, outward in ((LEFT, 1), (RIGHT, -1)):
        assert wearer.feet[side].position_m.imag * outward == pytest.approx(
            config.step_width_slow_m / 2, abs=0.002
        )


@needs_mujoco
def test_the_com_accelerates_as_the_quadratic_programme_asks():
    """The momentum of the floating base is that of the whole body."""
    from saddlewalk.physics.inverse_dynamics import Contact, FootTarget, Targets

    _, wearer = wearer_with()
    plant, stance = wearer.plant, FootTarget(Contact.SOLE)
    for _ in range(300):  # until the contacts have settled
        hold = Targets(np.array([0, 0, 20 * (wearer.height_m - plant.com_m[2])]), (stance,) * 2)
        plant.step(wearer._dynamics.torques(plant.data, hold), 0j)
    before = plant.com_velocity_m_s.copy()
    asked = np.array([0.3, -0.2, 0.4])
    for _ in range(20):
        plant.step(wearer._dynamics.torques(plant.data, Targets(asked, (stance,) * 2)), 0j)
    assert (plant.com_velocity_m_s - before) / 0.02 == pytest.approx(asked, abs=0.08)


@needs_mujoco
def test_a_push_gives_the_body_its_impulse():
    _, wearer = wearer_with()
    plant = wearer.plant
    rest = plant.com_velocity_m_s.copy()
    plant.data.qpos[2] += 1.0  # in the air nothing else accelerates it sideways
    for _ in range(100):
        plant.step(np.zeros(plant.model.nu), 60 + 30j)
    gained = plant.com_velocity_m_s - rest
    mass_kg = plant.body.mass_kg
    assert gained == pytest.approx([6 / mass_kg, 3 / mass_kg, -0.1 * GRAVITY_M_S2], rel=0.01)


@needs_mujoco
def test_torques_arrive_after_their_delay():
    from saddlewalk.physics.body import winter
    from saddlewalk.physics.plant import Plant

    plant = Plant(winter(1.79, 63.3), torque_delay_s=0.003)
    plant.stand((0.1j, -0.1j), np.array([0.0, 0.0, 0.97]))
    for number in range(1, 6):
        plant.step(np.full(plant.model.nu, float(number)), 0j)
        assert plant.data.ctrl[0] == max(number - 3, 0)


@needs_mujoco
def test_it_walks_is_pushed_and_recovers_and_a_seed_gives_the_same_bits():
    ends = []
    for _ in range(2):
        push = Push(10.0, 3.0, 90.0)
        config, wearer = wearer_with(pushes=(push,), noise=Noise(), seed=3)
        tick = walked(config, wearer, [(0.0, 0.0), (0.4, 0.9)], 5.2)
        assert not wearer.fallen
        assert wearer.com_m.real > 1.5
        assert wearer.velocity_m_s.real == pytest.approx(0.9, abs=0.25)
        assert tick.plan.step_length_m > 0.4
        ends.append((wearer.com_m, wearer.velocity_m_s, *wearer.plant.data.qpos))
    assert ends[0] == ends[1]


@needs_mujoco
@pytest.mark.parametrize("turn_rad_s", [0.35, -0.35])
def test_it_turns_with_its_feet_and_pelvis_on_the_way(turn_rad_s):
    config, wearer = wearer_with(fields={"turn_acceleration_rad_s2": 0.5})
    speeds = [(0.0, 0.0), (0.4, 0.7), (2.0, 0.7, turn_rad_s)]
    tick = walked(config, wearer, speeds, 7.0)
    plan = tick.plan
    assert not wearer.fallen and abs(plan.heading_rad) > 1.0
    planned = [plan.heading_rad + yaw for yaw in (plan.yaw_rad[plan.support], plan.pelvis_yaw_rad)]
    forward = wearer.plant.data.body(wearer.plant.body.legs[plan.support].foot).xmat[[0, 3]]
    stance_rad = math.atan2(forward[1], forward[0])
    # Where a tick ago the plan had them, and the pelvis has turned on since.
    assert stance_rad == pytest.approx(planned[0], abs=0.04)
    assert wearer.heading_rad == pytest.approx(planned[1], abs=0.04 + abs(turn_rad_s) * TICK_S)
    measured = wearer.exact().velocity_m_s
    assert measured.real > 0.4 and abs(measured.imag) < 0.3


@needs_mujoco
def test_it_stops_and_stands():
    config, wearer = wearer_with()
    tick = walked(config, wearer, [(0.0, 0.0), (0.4, 0.8), (2.5, 0.0)], 7.0)
    assert not wearer.fallen
    assert tick.plan.mode == STANDING and abs(wearer.velocity_m_s) < 0.02


@needs_mujoco
def test_a_hard_push_is_a_fall():
    config, wearer = wearer_with(pushes=(Push(120.0, 0.5, 90.0),))
    walked(config, wearer, [(0.0, 0.0)], 3.0)
    assert wearer.fallen and 0.5 < wearer.fell_at_s < 2.5
    assert wearer.height_m < 0.75 * wearer.body.pendulum_m


@needs_mujoco
def test_measurements_come_late_by_the_sensors_delay():
    plant = PlantChoice("winter", sensor_delay_s=0.04)
    config = configuration(plant.fields)
    wearer, heights = plant.wearer(config, STEADY), []
    for tick in closed_loop.walk(config, wearer, schedule_of([(0.0, 0.0)], 0.0)):
        heights.append((wearer.height_m, tick.exact.height_m))
        if tick.time_s >= 3 * TICK_S:
            break
    assert all(now != late for now, late in heights[1:])


@needs_mujoco
def test_the_demo_walks_a_body_over_the_wire(tmp_path, capsys):
    from host_node import own_lcm
    from saddlewalk.transport.bus import private_udp

    options = ["--can", private_udp(), "--lcm", own_lcm(), "--out", str(tmp_path / "demo")]
    walk = ["--duration", "3.2", "--speed", "0.8", "--plant", "mujoco"]
    assert main(["demo", *options, *walk]) == 0
    assert (tmp_path / "demo/body.png").stat().st_size > 20_000
    shown = capsys.readouterr().out
    assert "ok   the wearer stayed up" in shown and "clock: lockstep" in shown
    from saddlewalk.physics.body import SHANK_LENGTH, THIGH_LENGTH

    rows = view_rows(tmp_path / "demo/walk.lcmlog")
    joint = {
        name: np.array([rows[f"left_{name}_{axis}_m"] for axis in "xz"])
        for name in ("hip", "knee", "ankle", "heel", "toe")
    }
    known = np.isfinite(joint["hip"][0])
    assert known.sum() == len(known) - 1  # all but the first tick's
    for upper, lower, share in (("hip", "knee", THIGH_LENGTH), ("knee", "ankle", SHANK_LENGTH)):
        length_m = np.hypot(*(joint[upper] - joint[lower]))[known]
        assert np.allclose(length_m, share * 1.79, rtol=0.01)  # seen from the side
    middle_m = (joint["heel"][0] + joint["toe"][0]) / 2
    assert np.abs(middle_m - rows["left_x_m"])[known].max() < 0.03  # held where it was measured
    assert (rows["trunk_up_z"][known] > 0.97).all()


def view_rows(log: Path) -> dict[str, np.ndarray]:
    reader = Rows()
    rows = [reader.feed(event.channel, event.data) for event in LcmLog(log)]
    return dict(zip(NAMES, np.array([row for row in rows if row]).T, strict=True))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--body", "winter"], "--body winter: only with --plant mujoco"),
        (["--plant", "mujoco", "--clock", "realtime"], "--clock realtime: not with"),
        (["--plant", "mujoco", "--body", "dm_control", "--mass", "70"], "--mass: the body"),
    ],
)
def test_options_that_do_not_go_together_are_named(options, words, tmp_path, capsys):
    if "mujoco" in options and importlib.util.find_spec("mujoco") is None:
        pytest.skip("MuJoCo is missing: run `make physics`")
    assert main(["demo", "--out", str(tmp_path / "demo"), *options]) == 2
    assert words in capsys.readouterr().err


def test_without_mujoco_the_remedy_is_named(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["demo", "--plant", "mujoco", "--out", str(tmp_path / "demo")]) == 2
    assert "--plant mujoco needs mujoco: run" in capsys.readouterr().err


def test_endure_counts_falls_and_stands(tmp_path, capsys):
    out = tmp_path / "out"
    options = ["--plant", "pendulum", "--distance", "6", "--repeats", "2", "--jobs", "1"]
    assert main(["endure", *options, "--speeds", "0.8,1.2", "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    assert "4 walks" in shown and "0 falls, 4 stand at the end" in shown
    walks = json.loads((out / "endurance.json").read_text())
    assert [group["asked_m_s"] for group in walks["groups"]] == [0.8, 1.2]
    for group in walks["groups"]:
        assert group["walks"] == group["standing"] == 2
        assert group["distance_m"] > 2 * 6
        assert group["speed_m_s"] == pytest.approx(group["asked_m_s"], abs=0.1)
    rows = list(csv.DictReader((out / "endurance.csv").open()))
    assert len(rows) == 4 and all(row["stands"] == "True" for row in rows)


def test_endure_follows_a_schedule_with_turns(tmp_path, capsys):
    schedule = tmp_path / "bend.csv"
    schedule.write_text("t_s,speed_m_s,turn_rad_s\n0,0,0\n1,0.8,0\n3,0.8,0.3\n12,0,0\n")
    out = tmp_path / "out"
    options = ["--plant", "pendulum", "--repeats", "2", "--jobs", "1", "--out", str(out)]
    assert main(["endure", *options, "--schedules", str(schedule)]) == 0
    assert "0 falls, 2 stand at the end" in capsys.readouterr().out
    (group,) = json.loads((out / "endurance.json").read_text())["groups"]
    assert group["schedule"] == "bend" and group["stable_pct"] == 100
    assert group["speed_m_s"] == pytest.approx(
        0.8, abs=0.02
    )  # along the way, not as the crow flies
    assert group["distance_m"] / 2 == pytest.approx(0.8 * 11, rel=0.06)


def schedule_file(tmp_path, rows: str) -> str:
    path = tmp_path / "schedule.csv"
    path.write_text(f"t_s,speed_m_s,turn_rad_s\n{rows}\n")
    return str(path)


@needs_mujoco
@pytest.mark.parametrize(
    ("rows", "options", "words"),
    [
        ("0,0.8,0", [], "line 2, speed_m_s: the last one must be 0, a stop"),
        ("0,0.8,0.2\n5,0,0", ["--drive", "joints"], "line 2, turn_rad_s: 0.2 must be 0 with --dri"),
    ],
)
def test_a_schedule_that_endure_cannot_follow_is_named(rows, options, words, tmp_path, capsys):
    assert main(["endure", "--schedules", schedule_file(tmp_path, rows), *options]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--plant", "pendulum", "--torque-delays", "5"], "--torque-delays: only with --plant"),
        (["--heights", "1.6", "--height", "1.7", "--plant", "pendulum"], "give one of them"),
        (["--speeds", "1,fast"], "'fast' must be 0.001 to 10 m/s"),
    ],
)
def test_what_endure_cannot_do_is_named(options, words, capsys):
    try:
        assert main(["endure", *options]) == 2
    except SystemExit as ended:
        assert ended.code == 2
    assert words in capsys.readouterr().err


@needs_mujoco
def test_late_torques_make_a_body_fall(capsys):
    options = ["--speeds", "0.8", "--distance", "2", "--repeats", "1", "--jobs", "1"]
    assert main(["endure", *options, "--torque-delays", "60"]) == 1
    assert "1 falls, 0 stand at the end" in capsys.readouterr().out


@needs_mujoco
def test_outlines_are_those_of_the_limbs():
    from saddlewalk.physics.poses import Pose, side_view

    _, wearer = wearer_with()
    model = wearer.plant.model
    seen = list(side_view(model, Pose(0.0, wearer.plant.data.qpos)))
    limbs = [shape for shape in seen if np.ptp(shape.points_m[:, 1]) > 0.1]
    assert {shape.side for shape in seen} == {"left", "right", ""}
    # A thigh's capsule of 0.245 by 1.79 m and two caps of 0.06 m, whatever its tilt.
    assert max(
        math.hypot(*np.ptp(shape.points_m, axis=0)) for shape in limbs if shape.side
    ) == pytest.approx(0.245 * 1.79 + 0.12, abs=0.06)
    lowest_m = min(shape.points_m[:, 1].min() for shape in seen)
    assert lowest_m == pytest.approx(0.0, abs=0.002)
    top_m = wearer.plant.data.qpos[2] + 0.288 * 1.79 + 0.22 + 0.10  # hips, trunk, head
    assert max(shape.points_m[:, 1].max() for shape in seen) == pytest.approx(top_m, abs=0.005)


@needs_mujoco
def test_a_film_shows_the_body_or_names_what_is_missing(tmp_path):
    from PIL import Image

    from saddlewalk.errors import UserError
    from saddlewalk.physics.film import Camera, film
    from saddlewalk.physics.poses import Pose

    _, wearer = wearer_with()
    model, qpos = wearer.plant.model, wearer.plant.data.qpos
    try:
        camera = Camera(model)
    except UserError as error:
        assert "libegl1" in str(error)
        pytest.skip("no EGL: as root, apt-get install -y libegl1 libgl1-mesa-dri")
    poses = [Pose(0.0, qpos.copy()), Pose(0.04, qpos + np.eye(len(qpos))[2] * 0.3)]
    film(tmp_path / "body.gif", camera, poses)
    camera.close()
    with Image.open(tmp_path / "body.gif") as pictures:
        assert pictures.n_frames == 2 and pictures.info["duration"] == 40
        assert len(pictures.getcolors(1000) or range(99)) > 10


@needs_mujoco
def test_a_body_walks_through_the_fault_campaign(tmp_path):
    """Without a fault, so that it gets the plans of the firmware's own tick and between them."""
    from saddlewalk.faults.campaign import run
    from saddlewalk.faults.scenario import read_scenario

    text = "[walk]\nspeed_m_s = [0.7, 0.7]\nduration_s = 4.0\n"
    text += '[[fault]]\nclass = "none"\nstrength = 0\nfrom_s = [1.0, 2.0]\nfor_s = 1.0\n'
    (tmp_path / "none.toml").write_text(text)
    plant = PlantChoice("winter")
    scenario = read_scenario(tmp_path / "none.toml")
    outcome, history = run(scenario, 0, 0, 1, configuration(plant.fields), plant)
    assert not outcome.fell and not outcome.violations
    assert len(history) == 50


def test_walks_without_exact_inputs_are_shown_with_noise_alone():
    """As those of a body, which walks once."""
    from saddlewalk.evaluation.side_by_side import tables, walker_figures
    from saddlewalk.evaluation.walks import Trial, evaluated_walk, run

    trial = Trial("recovery", 0, -1, 1.0, 90.0, 3.0, 30.0, 5)
    config = configuration({})
    walk = evaluated_walk(trial, run(trial, config), None)
    assert set(walk.scores) == {"noise"}
    results = {"winter_recovery": walker_figures(walk.scores, {})}
    assert tables(results, "exact") == []
    assert [table.row_count > 5 for table in tables(results, "noise")] == [True, True]


@needs_mujoco
def test_a_pushed_walk_of_a_body_is_evaluated_at_its_speeds():
    from saddlewalk.evaluation.walks import Setting, Trial, draw, run

    speeds = [draw(1, k, "recovery", 63.3, (0.6, 1.2)).speed_m_s for k in range(40)]
    assert 0.6 <= min(speeds) < 0.75 and 1.05 < max(speeds) <= 1.2
    plant = PlantChoice("winter")
    trial = Trial("planned", 0, -1, 0.8, 90.0, 3.0, 60.0, 5)
    course = run(trial, configuration(plant.fields), setting=Setting(plant))
    assert 3.0 < course.fell_at_s < 5.0
    assert course.ticks["time_s"][-1] < course.fell_at_s
