"""A MuJoCo body walked by firmware/joints: sensors in, joint commands out."""

import importlib.util

import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.config import configuration
from saddlewalk.contract import STANDING
from saddlewalk.emulation import closed_loop
from saddlewalk.physics.plants import PlantChoice
from saddlewalk.planning.schedule import schedule_of

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("mujoco") is None or importlib.util.find_spec("piqp") is None,
    reason="MuJoCo is missing: run `make physics`",
)

LATE_AND_WRONG = {"torque_delay_s": 0.005, "mass_error": 0.05, "leg_error_m": 0.01}


def wearer_with(seed=0, **options):
    plant = PlantChoice("winter", drives_joints=True, **options)
    config = configuration(plant.fields)
    return config, plant.wearer(config, seed=seed)


def walked(config, wearer, speeds, duration_s, look=lambda wearer: None):
    """The last tick before the end or the fall; look(wearer) after each step of physics."""
    last = None
    schedule = schedule_of(speeds, 0.17)
    after = lambda tick, step: look(wearer)  # noqa: E731
    for tick in closed_loop.walk(config, wearer, schedule, after):
        if tick.time_s >= duration_s or wearer.fallen:
            return last
        last = tick


def test_late_commands_of_a_wrong_body_walk_and_stop():
    ends = []
    for _ in range(2):
        config, wearer = wearer_with(seed=4, **LATE_AND_WRONG)
        tick = walked(config, wearer, [(0.0, 0.0), (0.4, 0.8), (3.0, 0.0)], 7.5)
        assert not wearer.fallen and wearer.com_m.real > 1.4
        assert tick.plan.mode == STANDING and abs(wearer.velocity_m_s) < 0.03
        ends.append((wearer.com_m, *wearer.plant.data.qpos))
    assert ends[0] == ends[1]


def test_torques_stay_within_the_drives():
    config, wearer = wearer_with()
    walked(config, wearer, [(0.0, 0.0), (0.4, 1.0)], 3.0)
    peaks = wearer.peaks()
    assert list(peaks) == "hip_yaw hip_roll hip_pitch knee ankle_pitch ankle_roll".split()
    for (torque_nm, power_w, speed_rad_s), most_nm in zip(
        peaks.values(), (80, 180, 220, 220, 180, 60), strict=True
    ):
        assert 5 < torque_nm <= most_nm
        assert 0 < power_w < torque_nm * speed_rad_s * 1.001


def test_the_core_is_given_the_estimator_s_numbers():
    config, wearer = wearer_with()
    errors = []

    def note(wearer):
        given, exact = wearer.measure(), wearer.exact()
        difference = given.velocity_m_s - exact.velocity_m_s
        feet = [one - other for one, other in zip(given.feet_m, exact.feet_m, strict=True)]
        errors.append((difference.real, difference.imag, feet[0].real, feet[0].imag))

    walked(config, wearer, [(0.0, 0.0), (0.4, 0.8)], 4.0, note)
    along, across, foot_along, foot_across = np.sqrt(np.mean(np.square(errors), axis=0))
    assert 0.002 < along < 0.035 and 0.001 < across < 0.015  # an estimate, and a good one
    assert 0.0002 < foot_along < 0.006 and 0.0002 < foot_across < 0.005


@pytest.mark.parametrize("stiffness", [0.0, 1.0])
def test_a_lost_imu_gives_the_configured_behaviour_in_time(stiffness):
    """max_age_s is 0.24 s from the last sound estimate, which is as old as a reading may be."""
    config, wearer = wearer_with()
    controller, sensors = wearer._controller, wearer._estimator.sensors
    controller.drive.fallback_stiffness = stiffness
    before, fell_back = [], []

    def lose(wearer):
        if wearer.time_s >= 0.5:
            sensors.imu_age_us = 30_000
            fell_back.append(bool(controller._commands.fallback))
        else:
            before.append(bool(controller._commands.fallback))

    walked(config, wearer, [(0.0, 0.0)], 1.0, lose)
    assert not any(before)
    assert 0.23 < fell_back.index(True) / 1000 <= 0.242 and all(fell_back[245:])
    command = controller._commands.joint[0][3]
    assert command.torque_nm == 0.0
    assert command.stiffness == stiffness * controller.drive.joint[3].stance_stiffness
    assert command.damping == controller.drive.joint[3].stance_damping


def test_a_body_that_is_not_known_falls_sooner():
    """So the errors reach the controller: legs believed 25 % too long."""
    config, wearer = wearer_with(leg_error_m=0.22)
    walked(config, wearer, [(0.0, 0.0), (0.4, 0.8)], 5.0)
    assert wearer.fallen


def test_endure_prints_peaks(tmp_path, capsys):
    options = ["--drive", "joints", "--speeds", "0.8", "--distance", "1", "--repeats", "1"]
    wrong = ["--torque-delays", "5", "--mass-error", "5", "--leg-error", "10"]
    out = ["--jobs", "1", "--out", str(tmp_path / "out")]
    assert main(["endure", *options, *wrong, *out]) == 0
    shown = capsys.readouterr().out
    assert "0 falls, 1 stand at the end" in shown
    assert "ankle_pitch" in shown and "rad/s" in shown
    assert "knee_nm" in (tmp_path / "out/endurance.csv").read_text().splitlines()[0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--plant", "pendulum", "--drive", "joints"], "--drive joints: only with --plant mujoco"),
        (
            ["--body", "dm_control", "--drive", "joints"],
            "--drive joints: only with the body winter",
        ),
        (["--mass-error", "5"], "--mass-error: only with --drive joints"),
        (
            ["--drive", "joints", "--sensor-delays", "40"],
            "--sensor-delays: not with --drive joints",
        ),
    ],
)
def test_options_that_do_not_go_together_are_named(options, words, capsys):
    assert main(["endure", *options]) == 2
    assert words in capsys.readouterr().err
