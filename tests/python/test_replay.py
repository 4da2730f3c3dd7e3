"""Replaying a recording: what is sent, what comes back, and the host process against the core."""

import collections
import csv
import dataclasses
import math
import re
import subprocess
import sys
import time
from pathlib import Path

import can
import cantools
import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.contract import TICK_S
from saddlewalk.core import Command, Core, Measurement, ffi, library
from saddlewalk.errors import UserError
from saddlewalk.gait import playback
from saddlewalk.gait.events import analyse
from saddlewalk.gait.playback import (
    measurements,
    play_lockstep,
    play_realtime,
    states_at_ticks,
)
from saddlewalk.gait.replayed import SCORE_COLUMNS
from saddlewalk.paths import CHECKOUT
from saddlewalk.recorded_states import STATE_COLUMNS
from saddlewalk.table import format_cell
from saddlewalk.ticks import LEARNED_MESSAGES, PLAN_MESSAGES, Messages
from saddlewalk.transport.bus import open_bus, private_udp
from saddlewalk.transport.wire import Receiver, Sender
from synthetic_walk import Walk, csv_text

HEIGHT_M, MASS_KG = 1.79, 63.3
DATABASE = cantools.database.load_file(CHECKOUT / "firmware/wire/saddlewalk.dbc")
NO_PLAN_NOR_LEARNED_WALK = {
    name: {
        signal.name: 0.0
        for signal in DATABASE.get_message_by_name(name).signals
        if signal.name not in ("CRC", "COUNTER")
    }
    for name in (*PLAN_MESSAGES, *LEARNED_MESSAGES)
}


PROCESS = {
    "TIMING": dict.fromkeys(("PERIOD", "LATENCY", "LATENCY_MAX"), 0.0),
    "RECEIVED": dict.fromkeys(
        ("ACCEPTED", "MALFORMED", "BAD_CRC", "BAD_VERSION", "BAD_COUNTER"), 0
    ),
    "INPUTS": dict.fromkeys(
        (
            "COMMAND_SOURCE",
            "SENDER_CLOCK",
            "MEASURED_BY",
            "COMMAND_AGE",
            "COM_AGE",
            "LEFT_AGE",
            "RIGHT_AGE",
        ),
        0,
    ),
}


class OfflineFirmware:
    """A bus with the core behind it: a lockstep firmware without process or network."""

    def __init__(self, lose: frozenset[str] = frozenset()) -> None:
        config = ffi().new("saddle_config_t *")
        config[0] = library().saddle_config_default(HEIGHT_M, MASS_KG)
        self._core = Core(config)
        self._receiver, self._sender = Receiver(), Sender()
        self._got: dict[str, dict[str, float]] = {}
        self._answers: collections.deque[can.Message] = collections.deque()
        self._ticks = 0
        self._lose = lose
        self.commands: list[dict[str, float]] = []
        self.times_us: list[float] = []

    def send(self, frame: can.Message) -> None:
        name, signals = self._receiver.accept(frame)
        if name == "COMMAND":
            self.commands.append(signals)
            return
        if name == "MEASURED_TIME":
            self.times_us.append(signals["TIME"])
            return
        self._got[name] = signals
        if len(self._got) == 3:
            self._tick(**self._got)
            self._got = {}

    def recv(self, timeout: float) -> can.Message | None:
        return self._answers.popleft() if self._answers else None

    def _tick(self, MEASURED_COM, MEASURED_LEFT, MEASURED_RIGHT) -> None:  # noqa: N803
        measurement = Measurement(
            com_height_m=MEASURED_COM["HEIGHT"],
            com_velocity_m_s=(MEASURED_COM["VX"], MEASURED_COM["VY"]),
            left_cop_m=(MEASURED_LEFT["X"], MEASURED_LEFT["Y"]),
            right_cop_m=(MEASURED_RIGHT["X"], MEASURED_RIGHT["Y"]),
            left_contact=bool(MEASURED_LEFT["CONTACT"]),
            right_contact=bool(MEASURED_RIGHT["CONTACT"]),
        )
        output = self._core.tick(self._ticks * 80_000, Command(), measurement)
        self._ticks += 1
        for name, values in self._messages(output).items():
            if name not in self._lose:
                self._answers.append(self._sender.frame(name, **values))

    @staticmethod
    def _messages(output) -> Messages:
        scores, core = output.scores, library()

        def valid(value: float, bit: int, also: int = 0) -> float:
            return value if scores.valid & bit or also else math.nan

        infeasible = output.faults & core.SADDLE_FAULT_SPEED_INFEASIBLE
        stop = core.SADDLE_VALID_STOP
        return {
            **NO_PLAN_NOR_LEARNED_WALK,
            **verdict_signals(output.verdict),
            "SCORES_ENERGY": {
                "CAN_STOP": scores.can_stop,
                "ON_TRACK": output.verdict.on_track,
                "PAPER_STABLE": scores.paper_stable,
                "EXCESS_STOP": valid(scores.excess_stop_j, stop),
                "EXCESS_TRACK": output.verdict.excess_track_j
                if output.verdict.compared
                else math.nan,
            },
            "SCORES_STEP": {
                "S_PEND": valid(scores.s_pend, core.SADDLE_VALID_STEP, infeasible),
                "S_JUMP": valid(scores.s_jump, core.SADDLE_VALID_STEP, infeasible),
                "S_SW": valid(scores.s_sw, core.SADDLE_VALID_S_SW),
            },
            "SCORES_MARGIN": {
                "MOS_COM": valid(scores.mos_com_m, core.SADDLE_VALID_MOS_COM),
                "MOS_XCOM": valid(scores.mos_xcom_m, core.SADDLE_VALID_MOS_XCOM),
                "V_COMP": valid(scores.v_comp_m_s, core.SADDLE_VALID_V_COMP),
            },
            "SCORES_FORCE": {
                "GRAVITY_X": valid(scores.gravity_n.x, core.SADDLE_VALID_GRAVITY),
                "GRAVITY_Y": valid(scores.gravity_n.y, core.SADDLE_VALID_GRAVITY),
                "FAULTS": output.faults,
            },
            **PROCESS,
            "HEALTH": {"STATUS": 0, "LIMITS": 0, "LATE_TICKS": 0, "REJECTED_FRAMES": 0},
        }


def verdict_signals(verdict) -> Messages:
    """What needs a walk to compare with."""
    recovery, deviation_m = verdict.recovery, verdict.xcom_deviation_m

    def compared(value: float, also: bool = True) -> float:
        return value if verdict.compared and also else math.nan

    return {
        "SCORES_EXPECTED": {
            "EBOS_COM": compared(verdict.ebos_com_m),
            "EBOS_XCOM": compared(verdict.ebos_xcom_m),
        },
        "VERDICT": {
            "COMPARED": verdict.compared,
            "LEVEL": verdict.level,
            "REASON": verdict.reason,
            "XCOM_DEVIATION_X": compared(deviation_m.x),
            "XCOM_DEVIATION_Y": compared(deviation_m.y),
        },
        "BALANCE": {
            "DRIVER": verdict.driver,
            "BALANCE_MARGIN": verdict.margin if verdict.margin_known else math.nan,
            "CAUTION_BELOW": verdict.caution_below if verdict.margin_known else math.nan,
        },
        "RECOVERY": {
            "FOUND": recovery.found,
            "STOPS": recovery.stops,
            "FOOT": recovery.foot,
            "X": compared(recovery.landing_m.x, recovery.found),
            "Y": compared(recovery.landing_m.y, recovery.found),
            "MARGIN": compared(recovery.margin_m),
        },
    }


def sets_of(walk: Walk) -> list[tuple[float, Messages]]:
    recording = walk.recording()
    return list(measurements(states_at_ticks(recording, analyse(recording).contact)))


def same(a: list[tuple], b: list[tuple]) -> bool:
    """NaN equals NaN; the alive counters are the transport's own."""
    names = [name for name in a[0][1] if name != "COUNTER"]
    values = [[[t, *(scores[n] for n in names)] for t, scores in rows] for rows in (a, b)]
    return np.array_equal(*values, equal_nan=True)


def parsed(text: str) -> dict[str, str]:
    """name -> value of the printed lines."""
    return {line.split()[0]: line.split()[1] for line in text.splitlines()}


def test_a_set_holds_the_recordings_state_at_its_time():
    walk = Walk(duration_s=1.0)
    recording = walk.recording()
    contact = walk.contact()
    sets = list(measurements(states_at_ticks(recording, contact)))
    assert [t for t, _ in sets] == pytest.approx(np.arange(13) * 0.08)
    for time_s, messages in sets:
        i = round(time_s * walk.rate_hz)
        com, left, right = (messages[f"MEASURED_{part}"] for part in ("COM", "LEFT", "RIGHT"))
        assert com["HEIGHT"] == recording.com_m[i, 2]
        assert (com["VX"], com["VY"]) == tuple(recording.com_velocity_m_s[i, :2])
        for side, foot in enumerate((left, right)):
            assert foot["X"] == pytest.approx(recording.cop_m[side, i, 0] - recording.com_m[i, 0])
            assert foot["Y"] == pytest.approx(recording.cop_m[side, i, 1] - recording.com_m[i, 1])
            assert foot["CONTACT"] == contact[side, i]


def test_time_counts_from_the_first_sample():
    recording = Walk(duration_s=1.0).recording()
    later = dataclasses.replace(recording, time_s=recording.time_s + 1e4)
    contact = Walk(duration_s=1.0).contact()
    sent, sent_later = (
        list(measurements(states_at_ticks(trial, contact))) for trial in (recording, later)
    )
    assert [t for t, _ in sent] == [t for t, _ in sent_later]
    assert sent[5][1]["MEASURED_LEFT"] == sent_later[5][1]["MEASURED_LEFT"]


def test_a_gap_in_the_recording_is_sent_as_not_available():
    recording = Walk(duration_s=1.0).recording()
    kept = np.r_[0:20, 50:101]
    holed = dataclasses.replace(
        recording,
        time_s=recording.time_s[kept],
        com_m=recording.com_m[kept],
        heel_m=recording.heel_m[:, kept],
        toe_m=recording.toe_m[:, kept],
    )
    holed.toe_m[1, -1] = np.nan
    sets = dict(measurements(states_at_ticks(holed, np.ones((2, len(kept)), dtype=bool))))
    missing = {
        round(t, 2)
        for t, messages in sets.items()
        if all(math.isnan(messages["MEASURED_COM"][name]) for name in ("HEIGHT", "VX", "VY"))
        and math.isnan(messages["MEASURED_LEFT"]["X"])
    }
    assert missing == {0.24, 0.32, 0.4}
    answers = list(play_lockstep(OfflineFirmware(), iter(sets.items())))
    unscored = {round(t, 2) for t, scores in answers if math.isnan(scores["MOS_COM"])}
    assert unscored == missing
    faulty = {round(t, 2) for t, scores in answers if scores["FAULTS"]}
    assert faulty == missing


def test_the_wearer_is_commanded_to_stand():
    bus = OfflineFirmware()
    ticks = list(play_lockstep(bus, iter(sets_of(Walk(duration_s=0.5)))))
    assert len(bus.commands) == len(ticks) == 7
    assert all(command["MODE"] == 0 and command["SPEED"] == 0 for command in bus.commands)


def test_in_real_time_the_answers_are_those_of_lockstep():
    sets = sets_of(Walk(duration_s=0.5))
    start_s = time.monotonic()
    live = list(play_realtime(OfflineFirmware(), iter(sets)))
    assert time.monotonic() - start_s == pytest.approx(len(sets) * TICK_S, abs=0.07)
    assert same(live, list(play_lockstep(OfflineFirmware(), iter(sets))))


def test_a_tick_with_a_lost_frame_is_discarded(monkeypatch):
    monkeypatch.setattr(playback, "ANSWER_TIMEOUT_S", 0.05)
    bus = OfflineFirmware(lose=frozenset({"SCORES_MARGIN"}))
    with pytest.raises(UserError, match=r"did not answer the measurements at 0\.00 s"):
        list(play_lockstep(bus, iter(sets_of(Walk(duration_s=0.5)))))


def test_a_replayed_walk_is_scored_as_it_was_walked():
    walk = Walk(speed_m_s=1.2, step_length_m=0.65, duration_s=6)
    ticks = list(play_lockstep(OfflineFirmware(), iter(sets_of(walk))))
    speeds = [scores["V_COMP"] for _, scores in ticks if not math.isnan(scores["V_COMP"])]
    assert len(speeds) > 50
    assert speeds[5:] == pytest.approx([1.2] * len(speeds[5:]), rel=0.02)


def test_the_host_answers_as_the_core_fed_offline_with_the_same_frames(capsys, tmp_path):
    walk = Walk(duration_s=4)
    trial, out = tmp_path / "trial.csv", tmp_path / "scores.csv"
    recording = walk.recording()
    recording.toe_m[0, 96] = np.nan  # tick 12
    trial.write_text(csv_text(recording))
    assert main(["replay", str(trial), "--out", str(out)]) == 0
    printed = parsed(capsys.readouterr().out)

    from saddlewalk.gait.recording import load_recording
    from saddlewalk.gait.replayed import report, score_row

    read = load_recording(str(trial))
    gait = analyse(read)
    states = list(states_at_ticks(read, gait.contact))
    offline = play_lockstep(OfflineFirmware(), measurements(states))
    rows = [score_row(*tick) for tick in offline]
    assert printed == parsed("\n".join(report(read, gait, rows)))
    assert int(printed["ticks"]) == 51
    assert int(printed["ticks_scored"]) == 50
    assert float(printed["speed"]) == pytest.approx(1.2, rel=0.01)
    with out.open() as file:
        written = list(csv.DictReader(file))
    assert list(written[0]) == [*SCORE_COLUMNS, *STATE_COLUMNS[1:]]
    for line, row, state in zip(written, rows, states, strict=True):
        cells = [*row, *(state[name] for name in STATE_COLUMNS[1:])]
        assert list(line.values()) == [format_cell(cell) for cell in cells]
    levels = [line["level"] for line in written]
    for line in written:
        known = line["level"] != "unknown"
        assert (line["margin"] != "") == (line["caution_below"] != "") == known
        assert (float(line["margin"] or 1) <= 0) == (line["level"] == "unstable")
    assert float(written[-1]["recovery_margin_m"]) != 0
    assert levels[12] == "unknown" and written[12]["reason"] == "input"
    assert written[12]["can_stop"] == written[12]["on_track"] == ""
    assert {written[-1]["can_stop"], written[-1]["on_track"]} <= {"0", "1"}
    assert {"stable", "caution"} & set(levels)
    for name in ("stable", "caution", "unstable", "unknown"):
        assert float(printed[name]) == pytest.approx(100 * levels.count(name) / 51, abs=0.01)


def test_a_replay_gives_the_same_bits_each_time(capsys, tmp_path):
    trial = tmp_path / "trial.csv"
    trial.write_text(csv_text(Walk(duration_s=3).recording(0.002)))
    written = []
    for run in "ab":
        assert main(["replay", str(trial), "--out", str(tmp_path / run)]) == 0
        written.append((tmp_path / run).read_bytes())
    assert written[0] == written[1]


def test_a_replay_s_log_is_reported_and_recomputed(capsys, tmp_path):
    walk, log = tmp_path / "walk.csv", tmp_path / "walk.lcmlog"
    walk.write_text(csv_text(Walk(speed_m_s=1.1, duration_s=8).recording()))
    assert main(["replay", str(walk), "--log", str(log)]) == 0
    assert main(["rerun", str(log)]) == 0
    capsys.readouterr()
    assert main(["report", str(log)]) == 0
    steps = int(re.search(r", (\d+) steps, 8\.\d m;", capsys.readouterr().out)[1])
    assert steps > 10
    assert "The person took" in (tmp_path / "walk.lcmlog.html").read_text()
    assert main(["replay", str(walk), "--log", str(log), "--view"]) == 2
    assert "--log is written in lockstep" in capsys.readouterr().err


def test_implausible_walks_are_reported(capsys, tmp_path):
    walk = Walk(speed_m_s=1200.0, step_length_m=650.0)
    path = tmp_path / "millimetres.csv"
    path.write_text(csv_text(walk.recording()))
    assert main(["replay", str(path)]) == 0
    printed = capsys.readouterr().err.splitlines()
    for quantity in ("walking speed 1200 m/s", "step length 650 m"):
        assert any(f"millimetres.csv: {quantity} is not a person's" in line for line in printed), (
            printed
        )


def test_a_replay_that_is_ended_ends_the_firmware(tmp_path):
    trial = tmp_path / "trial.csv"
    trial.write_text(csv_text(Walk(duration_s=60).recording()))
    spec = private_udp()
    script = Path(sys.executable).with_name("saddlewalk")
    program = [script, "replay", str(trial), "--can", spec, "--clock", "realtime"]
    with open_bus(spec) as bus, subprocess.Popen(program, stdout=subprocess.PIPE) as process:
        assert bus.recv(10)
        process.terminate()
        assert process.wait(10) == 130
        while bus.recv(0):
            pass
        assert bus.recv(3 * TICK_S) is None


def test_body_options_reach_the_firmware(capsys, tmp_path):
    trial = tmp_path / "trial.csv"
    trial.write_text(csv_text(Walk(duration_s=3).recording()))
    out = tmp_path / "scores.csv"
    written = set()
    for height in ("1.2", "1.9"):
        assert main(["replay", str(trial), "--height", height, "--out", str(out)]) == 0
        written.add(out.read_text())
    assert len(written) == 2
    assert main(["replay", str(trial), "--height", "17"]) == 2
    assert "17" in capsys.readouterr().err
