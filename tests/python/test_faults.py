"""`saddlewalk faults`: faults of frames, the checker, and the firmware's reaction."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from host_node import QUICK, Host, own_lcm
from saddlewalk import core
from saddlewalk.cli import main
from saddlewalk.config import configuration
from saddlewalk.errors import UserError
from saddlewalk.faults.campaign import Device, campaign, rows_of, run
from saddlewalk.faults.checker import BAD_PLAN, NO_STOP, OLD_SCORE, SILENT_STOP, Checker
from saddlewalk.faults.live import live_walks, run_live
from saddlewalk.faults.scenario import (
    INPUTS,
    KINDS,
    MESSAGES,
    Fault,
    Line,
    Occurrence,
    read_scenario,
)
from saddlewalk.transport import wire
from saddlewalk.workers import Workers

pytestmark = pytest.mark.firmware

EXAMPLE = Path(__file__).parents[2] / "examples/faults.toml"
CONFIG = configuration({})
BODY = core.body_of(CONFIG)
FRAMES = 400
STANDING = {
    "COMMAND": {"MODE": 0, "SPEED": 0.0, "HEEL_STRIKE": 0.0},
    "MEASURED_COM": {"HEIGHT": 1.0, "VX": 0.0, "VY": 0.0},
    "MEASURED_LEFT": {"CONTACT": 1, "X": 0.0, "Y": 0.11},
    "MEASURED_RIGHT": {"CONTACT": 1, "X": 0.0, "Y": -0.11},
}


def sent_by(kind: str, strength: float, begin_s: float = 0.0, name: str = "MEASURED_LEFT"):
    """FRAMES frames, one every 10 ms, whose X is the time; what arrives, in order."""
    occurrence = Occurrence(kind, strength, MESSAGES, begin_s, math.inf)
    line, sender = Line([occurrence], np.random.default_rng(1)), wire.Sender()
    for number in range(FRAMES):
        line.send(sender.frame(name, CONTACT=1, X=number / 1000, Y=0.1), number / 100)
    return line, line.due(math.inf)


def test_a_fault_does_nothing_before_it_begins():
    for kind, of in KINDS.items():
        if of.disturb:
            line, arrivals = sent_by(kind, of.high, begin_s=1e9)
            assert [arrival.time_s for arrival in arrivals] == [n / 100 for n in range(FRAMES)]
            assert line.onset_s == math.inf


def test_loss_drops_its_share_of_frames():
    assert len(sent_by("loss", 1.0)[1]) == 0
    assert len(sent_by("loss", 0.3)[1]) == pytest.approx(0.7 * FRAMES, abs=0.08 * FRAMES)


def test_a_burst_drops_all_frames_for_its_duration():
    _, arrivals = sent_by("burst", 0.5)
    gaps_s = np.diff([0.0] + [arrival.time_s for arrival in arrivals])
    assert gaps_s[0] == pytest.approx(0.5)
    assert sorted(set(np.round(gaps_s[1:], 2)))[0] == 0.01
    assert all(gap_s > 0.4 for gap_s in gaps_s if gap_s > 0.015)


def test_delay_keeps_the_order_and_reordering_does_not():
    _, arrivals = sent_by("delay", 0.25)
    assert [a.time_s - a.born_s for a in arrivals] == pytest.approx([0.25] * FRAMES)
    assert [a.born_s for a in arrivals] == sorted(a.born_s for a in arrivals)
    _, arrivals = sent_by("reorder", 0.25)
    assert all(0 <= a.time_s - a.born_s <= 0.25 for a in arrivals)
    assert [a.born_s for a in arrivals] != sorted(a.born_s for a in arrivals)


def test_duplicates_are_rejected_by_their_counter():
    _, arrivals = sent_by("duplicate", 3)
    receiver = wire.Receiver()
    taken = [receiver.accept(arrival.frame) is not None for arrival in arrivals]
    assert len(taken) == 4 * FRAMES
    assert (sum(taken), receiver.bad_counter) == (FRAMES, 3 * FRAMES)


def accepted(arrivals) -> list[dict[str, float]]:
    """The signals of frames that all are good."""
    receiver = wire.Receiver()
    received = [receiver.accept(arrival.frame) for arrival in arrivals]
    assert all(received)
    return [signals for _, signals in received]


def test_a_stuck_sensor_repeats_its_first_values_in_valid_frames():
    line, arrivals = sent_by("stuck", 0, begin_s=1.0)
    positions = [signals["X"] for signals in accepted(arrivals)]
    assert positions[:101] == pytest.approx([number / 1000 for number in range(101)])
    assert positions[101:] == pytest.approx([0.1] * (FRAMES - 101))
    assert line.onset_s == 1.01
    assert {arrival.born_s for arrival in arrivals[101:]} == {1.0}


def test_noise_and_bias_have_their_stated_size():
    for kind, mean in (("noise", 0.0), ("bias", 0.05)):
        off_m = [
            signals["X"] - number / 1000
            for number, signals in enumerate(accepted(sent_by(kind, 0.05)[1]))
        ]
        assert abs(np.mean(off_m)) == pytest.approx(mean, abs=0.01)
        assert np.std(off_m) == pytest.approx(0.05 - mean, abs=0.006)


@pytest.mark.parametrize("bits", [1, 2])
def test_one_or_two_flipped_bits_never_pass_the_crc(bits):
    _, arrivals = sent_by("flip", bits)
    forged = [arrival for arrival in arrivals if arrival.forged]
    assert len(forged) == pytest.approx(FRAMES / 2, abs=FRAMES / 10)
    receiver = wire.Receiver()
    assert not any(receiver.accept(arrival.frame) for arrival in forged)
    assert receiver.bad_crc == len(forged)


def test_spoofed_frames_have_a_valid_crc_and_are_rejected_by_counter():
    _, arrivals = sent_by("spoof", 1.0)
    receiver = wire.Receiver()
    taken = {False: 0, True: 0}
    for arrival in arrivals:
        taken[arrival.forged] += receiver.accept(arrival.frame) is not None
    assert taken == {False: FRAMES, True: 0}
    assert (receiver.bad_crc, receiver.bad_counter) == (0, FRAMES)


def test_a_nan_is_sent_as_not_available():
    received = accepted(sent_by("nan", 1.0)[1])
    assert all(math.isnan(signals["X"]) != math.isnan(signals["Y"]) for signals in received)


def test_the_example_has_every_class_of_fault():
    scenario = read_scenario(EXAMPLE)
    assert {fault.kind for fault in scenario.faults} == set(KINDS)
    assert len(scenario.faults) * 20 >= 1000
    assert {"clock", "none", "stall"} & {
        scenario.faults[index].kind for index, _ in live_walks(scenario, 2)
    } == {"none", "stall"}


WALK = "[walk]\nspeed_m_s = 1.0\nduration_s = 9\n"
FAULT = '[[fault]]\nclass = "loss"\nstrength = 0.5\nfrom_s = 1\nfor_s = 2\n'


@pytest.mark.parametrize(
    ("text", "named"),
    [
        (FAULT, "[walk]: no speed_m_s: give it in 0.1 to 2"),
        (WALK, "give at least one [[fault]]"),
        (WALK + FAULT.replace('"loss"', '"lost"'), "[[fault]] 1: class = 'lost' must be one of"),
        (WALK + FAULT.replace("0.5", "1.5"), "[[fault]] 1: strength = 1.5 must be in 0 to 1"),
        (WALK + FAULT.replace("0.5", "[]"), "[[fault]] 1: strength = [] must be in 0 to 1"),
        (WALK + FAULT.replace("0.5", '"a"'), "[[fault]] 1: strength = 'a' must be in 0 to 1"),
        (WALK + FAULT + "size = 3\n", "[[fault]] 1: size is not one of "),
        (WALK + FAULT + 'messages = ["HEALTH"]\n', "messages = ['HEALTH'] must be of COMMAND"),
        (WALK + FAULT.replace("from_s = 1", "from_s = [3, 1]"), "one number, or two rising"),
        (WALK + FAULT.replace("for_s = 2", "for_s = [1, 2]"), "for_s = [1.0, 2.0] must be one"),
        ("walk = 3\n" + FAULT, "[walk]: must be a table"),
        ("fault = 3\n" + WALK, "give at least one [[fault]]"),
        ("[walk", "not TOML"),
    ],
)
def test_a_wrong_scenario_is_named(tmp_path, text, named):
    path = tmp_path / "scenario.toml"
    path.write_text(text)
    with pytest.raises(UserError) as error:
        read_scenario(path)
    assert str(error.value).startswith(str(path)) and named in str(error.value)
    assert "\n" not in str(error.value)


def test_the_device_reports_the_ages_of_what_it_was_given():
    device, sender = Device(CONFIG), wire.Sender()
    for late_us, name in enumerate(INPUTS):
        assert device.take(sender.frame(name, **STANDING[name]), 1_000_000 + late_us * 10_000)
    repeated = sender.frame("MEASURED_LEFT", **STANDING["MEASURED_LEFT"])
    assert device.take(repeated, 1_040_000) and not device.take(repeated, 1_050_000)
    messages = device.tick(1_060_000)
    ages = [messages["INPUTS"][f"{name}_AGE"] for name in ("COMMAND", "COM", "LEFT", "RIGHT")]
    assert ages == [60, 50, 20, 30]
    assert messages["HEALTH"]["REJECTED_FRAMES"] == messages["RECEIVED"]["BAD_COUNTER"] == 1
    assert messages["PLAN_STEP"]["VALID"] == 1


@pytest.fixture(scope="module")
def steady():
    """The ticks of a walk without a fault, and its checker."""
    return run(scenario_of("none", 0), 0, 0, 1, CONFIG)


def scenario_of(kind: str, *strengths: float, messages: tuple[str, ...] = ()):
    """Of all messages that the class happens to, unless some are given."""
    messages = messages or KINDS[kind].messages
    faults = tuple(Fault(kind, strength, messages, (3.0, 3.5), 4.5) for strength in strengths)
    return replace(read_scenario(EXAMPLE), duration_s=8.0, faults=faults)


def test_no_violation_without_a_fault(steady):
    outcome, history = steady
    assert outcome.violations == () and outcome.detected is None and not outcome.fell
    assert outcome.state in ("walked on", "caution")
    assert (outcome.blind, outcome.forged, len(history)) == (0, 0, 100)


def violations_in(
    history, since_s: float = 0.0, usable: bool = True, commanded: bool = True
) -> set[str]:
    """The violations of ticks whose inputs all came at since_s at the latest."""
    checker = Checker(CONFIG, BODY, 0.0, walk_commanded=commanded)
    for number, messages in enumerate(history):
        now_s = number * 0.08
        for of in checker.records.values():
            of.came_s = of.born_s = min(now_s, since_s or now_s)
            of.usable_s = of.came_s if usable or now_s < 2 else 2.0
        checker.tick(messages, now_s, now_s)
    return set(checker.violations)


def changed(history, number: int, part: str, **signals: float):
    """The same ticks with one changed."""
    messages = dict(history[number])
    messages[part] = messages[part] | signals
    return [*history[:number], messages, *history[number + 1 :]]


def test_the_checker_finds_every_violation(steady):
    history = steady[1]
    assert violations_in(history) == set()
    assert violations_in(changed(history, 60, "PLAN_COM", Z=math.nan)) == {BAD_PLAN}
    assert violations_in(changed(history, 60, "PLAN_ANKLE", SPEED=2.5)) == {BAD_PLAN}
    assert violations_in(changed(history, 60, "PLAN_RIGHT", X=-1.9)) == {BAD_PLAN}
    assert violations_in(changed(history, 60, "PLAN_STEP", VALID=0)) == {BAD_PLAN}
    assert violations_in(changed(history, 60, "HEALTH", STATUS=4)) == {BAD_PLAN}
    assert violations_in(changed(history, 60, "PLAN_EVENTS", MODE=3)) == {SILENT_STOP}
    assert violations_in(changed(history, 60, "PLAN_EVENTS", MODE=3), commanded=False) == set()
    assert violations_in(history, since_s=4.0) == {OLD_SCORE, NO_STOP}
    assert violations_in(history, usable=False) == {NO_STOP}


def test_a_reported_stop_that_never_ends_is_a_violation(steady):
    history = steady[1]
    for number in range(20, len(history)):
        history = changed(history, number, "HEALTH", LIMITS=1 << 5)
    assert violations_in(history) == {NO_STOP}


@pytest.mark.parametrize("messages", [MESSAGES, *((name,) for name in MESSAGES)])
def test_any_lost_input_stops_the_walk_in_time(messages):
    scenario = scenario_of("loss", 1.0, messages=messages)
    outcome, _ = run(scenario, 0, 0, 1, CONFIG)
    assert outcome.violations == ()
    assert (outcome.detected, outcome.state) == (3, "safe stop")


@pytest.mark.parametrize(
    ("kind", "strength", "detected", "state"),
    [
        ("nan", 1.0, 0, "safe stop"),
        ("stuck", 0, 3, "safe stop"),
        ("duplicate", 16, 0, None),
        ("spoof", 1.0, 0, None),
        ("flip", 2, None, "safe stop"),
        ("clock", -1.0, 0, "no plan"),
        ("clock", 3000.0, 0, None),
        ("stall", 0.5, 0, None),
        ("delay", 0.6, 3, "safe stop"),
    ],
)
def test_a_fault_is_detected_and_nothing_is_unsafe(kind, strength, detected, state):
    outcome, _ = run(scenario_of(kind, strength), 0, 0, 3, CONFIG)
    assert outcome.violations == () and outcome.forged == 0
    assert outcome.detected == (outcome.detected if detected is None else detected) is not None
    assert state is None or outcome.state == state


@pytest.mark.parametrize(
    ("kind", "strength", "messages", "index", "number"),
    [
        ("loss", 0.2, (), 2, 2),  # toe-off beyond upright, a step beyond reach
        ("burst", 0.32, (), 9, 3),  # the swing foot further behind than the leg is long
        ("reorder", 0.04, (), 17, 2),
        ("reorder", 0.5, (), 20, 2),
        ("reorder", 0.5, (), 20, 3),
        ("stuck", 0, ("MEASURED_COM",), 27, 0),  # the swing foot behind the leg's reach
        ("stuck", 0, ("MEASURED_LEFT",), 28, 2),
        ("flip", 32, (), 44, 0),
        ("stall", 0.5, (), 64, 3),
        ("delay", 0.6, (), 16, 15),  # the swing foot running backwards
    ],
)
def test_walks_whose_plan_was_out_of_bounds_once(kind, strength, messages, index, number):
    fault = Fault(kind, strength, messages, (1.0, 5.0), 5.0)
    scenario = replace(read_scenario(EXAMPLE), duration_s=14.0, faults=(fault,) * (index + 1))
    outcome, _ = run(scenario, index, number, 1, CONFIG)
    assert outcome.violations == ()


def test_a_level_from_data_that_are_late_unnoticed_is_a_blind_tick(steady):
    checker = Checker(CONFIG, BODY, 0.0, walk_commanded=True)
    for number, messages in enumerate(steady[1]):
        now_s = number * 0.08
        for of in checker.records.values():
            of.came_s = of.usable_s = now_s
            of.born_s = now_s - 0.6
        checker.tick(messages, now_s, now_s)
    levels = sum(messages["VERDICT"]["LEVEL"] > 0 for messages in steady[1])
    assert checker.blind == levels > 50


@pytest.mark.parametrize(
    ("kind", "strength", "state"),
    [
        ("delay", 0.3, "safe stop"),
        ("delay", 3.0, "safe stop"),
        ("reorder", 0.24, None),
        ("reorder", 1.0, "safe stop"),
        ("jitter", 0.5, "safe stop"),
        ("batch", 1.0, "safe stop"),
    ],
)
def test_the_firmware_sees_that_data_are_late(kind, strength, state):
    for number in range(3):
        outcome, _ = run(scenario_of(kind, strength), 0, number, 1, CONFIG)
        assert (outcome.blind, outcome.violations) == (0, ())
        assert state is None or outcome.state == state


@pytest.mark.parametrize(
    ("kind", "strength"), [("drift", 100.0), ("drift", -100.0), ("jump", 100.0), ("jump", -100.0)]
)
def test_a_walk_bears_what_the_clock_of_its_sender_does(kind, strength):
    outcome, history = run(scenario_of(kind, strength), 0, 0, 1, CONFIG)
    assert (outcome.blind, outcome.fell, outcome.violations) == (0, False, ())
    assert outcome.state in ("walked on", "caution")
    assert all(messages["INPUTS"]["COM_AGE"] < 5 for messages in history)


def test_the_campaign_does_not_depend_on_its_workers():
    scenario = replace(scenario_of("loss", 0.3, 0.9), duration_s=5.0)
    alone = campaign(scenario, 2, 5, CONFIG, Workers(1), lambda _: None)
    seen = []
    assert campaign(scenario, 2, 5, CONFIG, Workers(2), seen.append) == alone
    assert seen == [2, 4]
    assert alone != campaign(scenario, 2, 6, CONFIG, Workers(1), lambda _: None)
    rows = rows_of(alone)
    assert [(row.fault.strength, row.runs, row.unsafe) for row in rows] == [
        (0.3, 2, 0),
        (0.9, 2, 0),
    ]
    assert rows[1].states == {"safe stop": 2}


def test_the_command_prints_its_table(tmp_path, capsys):
    path = tmp_path / "scenario.toml"
    path.write_text(WALK + FAULT.replace("0.5", "1"))
    assert main(["faults", "--scenario", str(path), "--runs", "1", "--jobs", "1"]) == 0
    out = capsys.readouterr().out
    row = next(line for line in out.splitlines() if "loss" in line)
    assert row.split()[1:8] == ["1", "1", "1", "3", "3", "safe", "stop"]
    assert out.splitlines()[-1] == "1 walks, seed 1: 0 with an unsafe output"
    assert main(["faults", "--scenario", str(tmp_path / "none.toml")]) == 2
    assert "No such file" in capsys.readouterr().err


def test_emulate_injects_faults_into_its_bus(tmp_path, capsys):
    url, path = own_lcm(), tmp_path / "scenario.toml"
    lost = FAULT.replace("0.5", "1").replace("from_s = 1", "from_s = 2")
    path.write_text(WALK + lost)
    with Host("--lcm", url, *QUICK) as host:
        options = ["--can", host.spec, "--lcm", url, "--faults", str(path), "--duration", "3"]
        main(["emulate", *options])
        printed = capsys.readouterr().out
        assert "  walking" in printed and "  stopping" in printed


@pytest.mark.parametrize(
    ("fault", "options", "named"),
    [
        (FAULT, ["--clock", "lockstep"], "--faults needs --clock realtime"),
        (FAULT.replace("loss", "stall"), [], "stall is a fault of the firmware"),
    ],
)
def test_faults_that_emulate_cannot_inject_are_rejected(tmp_path, capsys, fault, options, named):
    path = tmp_path / "scenario.toml"
    path.write_text(WALK + fault)
    assert main(["emulate", "--lcm", own_lcm(), "--faults", str(path), *options]) == 2
    assert named in capsys.readouterr().err


def test_the_host_process_stops_a_live_walk_whose_frames_are_lost():
    own_lcm()
    scenario = scenario_of("loss", 1.0)
    fault = replace(scenario.faults[0], from_s=(2.0, 2.0))
    scenario = replace(scenario, duration_s=4.0, faults=(fault,))
    outcome = run_live(scenario, 0, 0, 1, CONFIG)
    assert outcome.violations == () and outcome.live
    assert outcome.state == "safe stop" and 2 <= outcome.detected <= 4
