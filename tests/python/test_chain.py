"""The whole chain: a body's sensors by CAN to the firmware, its joint commands by CAN back."""

import argparse
import re

import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.config import configuration
from saddlewalk.core import config_bytes
from saddlewalk.emulation.wearer import Push
from saddlewalk.physics.plants import PlantChoice

chain_pushes = pytest.importorskip(
    "saddlewalk.evaluation.chain_pushes", reason="MuJoCo is missing: run `make physics`"
)
joint_campaign = pytest.importorskip(
    "saddlewalk.faults.joint_campaign", reason="MuJoCo is missing: run `make physics`"
)

joint_chain = pytest.importorskip("saddlewalk.physics.joint_chain", reason="as above")

pytestmark = pytest.mark.firmware


def test_a_body_on_can_walks_and_stops(capsys):
    assert main(["chain", "--distance", "1", "--rate", "250"]) == 0
    printed = capsys.readouterr().out
    distance_m = float(re.match(r"host: ([\d.]+) m in", printed)[1])
    assert 1.0 < distance_m < 2.0
    assert "stands at the end" in printed
    assert "0 with the fallback, 0 with a fault of the sensors" in printed


def test_measured_legs_are_those_of_the_body_and_of_the_firmware(tmp_path, capsys):
    """Longer shanks, shorter thighs: with average ones for the firmware alone it would fall."""
    person = tmp_path / "person.toml"
    person.write_text("[legs]\nthigh_m = 0.39\nshank_m = 0.49\nfoot_length_m = 0.29\n")
    options = ["chain", "--distance", "1", "--rate", "250", "--config", str(person)]
    assert main(options) == 0
    assert "stands at the end" in capsys.readouterr().out
    walk = joint_chain.walk(
        joint_campaign.FaultyFirmware(body(), [], np.random.default_rng(1)),
        body(),
        joint_chain.Course(0.8, 1.0, 250, legs={"thigh_m": 0.39, "shank_m": 0.52}),
    )
    assert walk.fell


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[legs]\ntigh_m = 0.4", "[legs]: tigh_m is not a field of saddle_legs_t"),
        ("[legs]\nthigh_m = 4", "[legs]: thigh_m = 4 must be in 0.1 to 0.8"),
        ("[legs]\nthigh_m = 'long'", "[legs]: thigh_m = 'long' must be in 0.1 to 0.8"),
        ("legs = 0.4", "legs = 0.4 must be a table"),
    ],
)
def test_legs_that_are_wrong_are_named(text, words, tmp_path, capsys):
    person = tmp_path / "person.toml"
    person.write_text(text)
    assert main(["chain", "--config", str(person)]) == 2
    assert words in capsys.readouterr().err


def test_a_fall_is_told(monkeypatch, capsys):
    """Of a body whose drives do nothing."""
    idle = lambda plant, _: np.zeros(plant.model.nu)  # noqa: E731
    monkeypatch.setattr("saddlewalk.physics.joint_chain.drive_torques", idle)
    assert main(["chain", "--distance", "1", "--rate", "250"]) == 1
    assert re.search(r"m in [\d.]+ s, fell at [\d.]+ s", capsys.readouterr().out)


@pytest.mark.targets
def test_host_and_cortex_m4_send_the_same_bits(monkeypatch, capsys):
    """While standing and in the first step: one in 250 passes of the figure in docs/joints.md."""
    monkeypatch.setattr("saddlewalk.physics.joint_chain.STARTS_AND_STOPS_S", -6.0)
    main(["chain", "--distance", "1", "--rate", "250", "--speed", "1", "--firmware", "both"])
    printed = capsys.readouterr().out
    assert printed.endswith("bits of both: equal\n")
    assert "0 lost, 0 not sent" in printed


def test_lost_sensors_are_found_and_give_the_fallback_in_the_stated_time():
    """estimator.max_age_s, 20 ms, and drive.max_age_s, 240 ms, in passes of 4 ms."""
    outcome = joint_campaign.run(class_of("all sensors", "loss", 1.0), 0, 1, body())
    assert outcome.violations == ()
    assert 0.016 <= outcome.detected_s <= 0.028
    assert 0.24 <= outcome.fallback_s <= 0.268


def test_without_a_fault_nothing_is_found():
    outcome = joint_campaign.run(class_of("nothing", "none", 0.0), 0, 1, body())
    assert outcome.violations == () and not outcome.fell
    assert np.isnan(outcome.detected_s) and np.isnan(outcome.fallback_s)


def test_the_checker_finds_a_command_beyond_its_limits(monkeypatch):
    """Of drives that are weaker than the firmware was told."""
    weaker = joint_campaign.FaultyFirmware._beyond_limits

    def stricter(firmware):
        before = firmware._settings.drive.joint[3].torque_max_nm
        firmware._settings.drive.joint[3].torque_max_nm = 20.0
        found = list(weaker(firmware))
        firmware._settings.drive.joint[3].torque_max_nm = before
        return found

    monkeypatch.setattr(joint_campaign.FaultyFirmware, "_beyond_limits", stricter)
    outcome = joint_campaign.run(class_of("nothing", "none", 0.0), 0, 1, body())
    assert outcome.violations == ("knee beyond its limits",)


def test_the_checker_finds_that_no_fallback_came(monkeypatch):
    """Of a firmware that waits longer than the checker is told."""
    monkeypatch.setattr(joint_campaign, "GRACE_S", -0.1)
    place = class_of("gyroscope", "loss", 1.0)
    outcome = joint_campaign.run(place, 0, 1, body())
    assert "walked on without an IMU" in outcome.violations


def body():
    return configuration(PlantChoice("winter", drives_joints=True).fields)


def class_of(*wanted) -> int:
    """Its place among the classes of faults."""
    (place,) = (
        place
        for place, (what, _, kind, strength) in enumerate(joint_campaign.CLASSES)
        if (what, kind, strength) == wanted
    )
    return place


def test_faults_prints_the_classes_of_sensors_and_joints(monkeypatch, capsys):
    monkeypatch.setattr(joint_campaign, "CLASSES", joint_campaign.CLASSES[:2])
    monkeypatch.setattr(joint_campaign, "campaign", in_this_process)
    assert main(["faults", "--joints", "--runs", "1", "--seed", "1"]) == 0
    nothing, gyroscope, *_ = capsys.readouterr().out.splitlines()[3:]
    assert nothing.split() == "nothing none 0 1 0 - - 0 - 0 0".split()
    assert gyroscope.split()[:4] == "gyroscope loss 1 1".split()
    assert gyroscope.split()[4] == "1" and int(gyroscope.split()[8]) <= 268


def in_this_process(runs, seed, config, _, progress):
    progress(0)
    places = range(len(joint_campaign.CLASSES))
    return [joint_campaign.run(place, run, seed, config) for place in places for run in range(runs)]


def test_pushes_find_what_half_survive(monkeypatch, capsys):
    """Of a body that falls at 30 N s and more, whatever the direction."""

    def walk(_, __, course):
        return argparse.Namespace(fell=course.push.impulse_n_s >= 30.0)

    monkeypatch.setattr(chain_pushes, "walk", walk)
    impulse_n_s = chain_pushes.staircase("left", 20, 0.8, 1, config_bytes(body()))
    assert impulse_n_s == [pytest.approx(30.0, abs=2.0)]
    assert main(["chain", "--pushes", "8", "--rate", "250"]) == 2
    assert "--rate 250: not with --pushes" in capsys.readouterr().err


def test_a_hard_push_fells_and_a_soft_one_does_not():
    config = body()
    fell = []
    for impulse_n_s in (2.0, 200.0):
        course = joint_chain.Course(0.8, 2.0, 250, 1, 0.0, Push(impulse_n_s, 3.2, 90.0))
        firmware = joint_campaign.FaultyFirmware(config, [], np.random.default_rng(1))
        fell.append(joint_chain.walk(firmware, config, course).fell)
    assert fell == [False, True]


@pytest.mark.parametrize("option", [["--live", "3"], ["--body", "winter"]])
def test_options_that_do_not_go_with_joints_are_named(option, capsys):
    assert main(["faults", "--joints", *option]) == 2
    assert f"{' '.join(option)}: not with --joints" in capsys.readouterr().err
