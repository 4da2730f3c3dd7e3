"""`saddlewalk demo` and `emulate` end to end, with the real firmware process on private ports."""

import argparse
import csv
import functools
import itertools
import math
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import can
import lcm
import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.commands.demo import PUSH_TIMES_S
from saddlewalk.config import configuration, load_config
from saddlewalk.contract import REASONS, TICK_S
from saddlewalk.emulation.wearer import Push
from saddlewalk.logs.messages import decode
from saddlewalk.logs.recorder import CHANNELS, COLUMNS
from saddlewalk.paths import CHECKOUT
from saddlewalk.transport.bus import open_bus, private_udp
from saddlewalk.transport.lcm_log import LcmLog
from saddlewalk.transport.wire import Receiver
from saddlewalk.verdict import REASON_WORDS

FILES = {"walk.lcmlog", "walk.candump.log", "walk.csv", "walk.png"}


@pytest.fixture
def ports() -> list[str]:
    """--can and --lcm that no other walk uses."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        port = probe.getsockname()[1]
    return ["--can", private_udp(), "--lcm", f"udpm://239.255.76.67:{port}?ttl=0"]


WALK = ["--speed", "1.2", "--duration", "5", "--push", "8@4:90"]


def demo(folder: Path, ports: list[str], *options: str) -> int:
    return main(["demo", "--clock", "lockstep", "--out", str(folder), *ports, *options])


def rows(folder: Path) -> list[dict[str, str]]:
    return list(csv.DictReader((folder / "walk.csv").open(newline="")))


def test_the_plan_learns_the_wearer_and_the_log_is_recomputed(tmp_path, ports, capsys):
    """Who does not sway as far to the left as the plan has it, and whose height is another."""
    fields = {"lateral_offset_m": 0.02, "vertical_offset_m": 0.01, "swing_skew": 1.47}
    person, learned = tmp_path / "person.toml", tmp_path / "walk/learned.toml"
    person.write_text(
        "".join(f"{name} = {value}\n" for name, value in fields.items()) + 'ankle = "cycloid"\n'
    )
    bounds = ["--learn", "share=0.2", "--learn", "lateral_delay_rad=0.01"]
    options = ["--config", str(person), *bounds]
    assert demo(learned.parent, ports, "--speed", "1.1", "--duration", "40", *options) == 0
    assert "500 ticks recomputed from the log: the same bits\n" in capsys.readouterr().out
    found = load_config(argparse.Namespace(config=learned, height=None, mass=None))
    assert 0 <= found.lateral_offset_m < 0.01
    assert abs(found.lateral_delay_rad) == pytest.approx(0.01)
    assert found.swing_begin != configuration({}).swing_begin
    assert found.ankle == configuration({"ankle": 2}).ankle


def test_what_cannot_be_learned_is_rejected(tmp_path, ports, capsys):
    assert demo(tmp_path, ports, "--learn", "share=2") == 2
    assert "--learn share=2: give a number from 0 to 0.3" in capsys.readouterr().err
    options = ["--out", str(tmp_path), "--firmware", "qemu-m4", "--learn", "share=0.1"]
    assert main(["demo", *options]) == 2
    assert "--learn share=0.1: not with --firmware qemu-m4" in capsys.readouterr().err


def test_demo_records_a_sound_walk_that_reads_back(tmp_path, ports, capsys):
    assert demo(tmp_path, ports) == 0
    shown = capsys.readouterr().out
    assert "did not fall" in shown and "BAD" not in shown
    assert shown.count("s  push of 28 N s backward\n") == 2
    for push_s in PUSH_TIMES_S:
        step = rf"{int(push_s)}\.\d\d s  recovery step, 0\.[1-9]\d m from the planned landing\n"
        assert re.search(step, shown)
    assert re.search(r"1[0-4]\.\d\d s  caution: the body departs backward of the feet\n", shown)
    assert "stands at the end" in shown
    seen, *following = shown.splitlines()[-4:]
    assert re.fullmatch("seen: 2 pushes, worst level caution, [2-4] recovery steps, no fall", seen)
    assert f" view {tmp_path}/walk.lcmlog  # in the browser" in following[0]
    assert f"{round(22 / TICK_S)} ticks recomputed from the log: the same bits\n" in shown
    assert_levels_printed(shown, [row["level"] for row in rows(tmp_path)])
    assert {path.name for path in tmp_path.iterdir()} == FILES

    walk = rows(tmp_path)
    assert list(walk[0]) == COLUMNS
    modes = [row["mode"] for row in walk]
    assert [mode for mode, _ in itertools.groupby(modes)] == [
        "standing",
        "starting",
        "walking",
        "stopping",
        "standing",
    ]
    speeds = {float(row["t_s"]): float(row["plan_speed_m_s"]) for row in walk}
    assert len(walk) == round(22 / TICK_S) == len(speeds)
    at = [speeds[time_s] for time_s in (0.96, 6.0, 10.0, 21.92)]
    assert at == pytest.approx([0.0, 0.8, 1.2, 0.0], abs=1e-4)  # the wire's resolution
    pushed = next(i for i, row in enumerate(walk) if float(row["t_s"]) > PUSH_TIMES_S[0])
    walked_m = sum(list(speeds.values())[:pushed]) * TICK_S
    assert float(walk[pushed]["true_com_x_m"]) == pytest.approx(walked_m, abs=0.2)
    pushed_n_s = [float(walk[-1][f"pushed_{axis}_n_s"]) for axis in "xy"]
    assert math.hypot(*pushed_n_s) == pytest.approx(2 * 28.0, rel=1e-7)  # by float mass

    with can.CanutilsLogReader(tmp_path / "walk.candump.log") as log:
        frames = [frame.arbitration_id for frame in log]
    ticks = len(walk)
    assert [frames.count(name) for name in (0x110, 0x111, 0x112, 0x140)] == [ticks] * 4
    assert frames.count(0x100) == ticks + 1  # the last command is to stand

    log = lcm.EventLog(str(tmp_path / "walk.lcmlog"), "r")
    heard = [event.channel for event in log]
    log.close()
    assert set(heard) == set(CHANNELS)
    assert heard.count("SADDLEWALK_TRUTH") == heard.count("SADDLEWALK_PLAN") == ticks


def test_the_tutorial_runs_on_a_log_of_the_demo(walk):
    command = [sys.executable, CHECKOUT / "examples/tutorial.py", walk / "walk.lcmlog"]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert "0.4 m/s to the left: XCoM in base -0.025 m, can stop: True\n" in printed
    assert f"{len(rows(walk))} plans, at most 1.20 m/s\n" in printed


def assert_levels_printed(shown: str, levels: list[str]) -> None:
    """The time of each level, in a walk that is mostly stable."""
    line = next(line for line in shown.splitlines() if line.startswith("level: "))
    for name in ("stable", "caution", "unstable", "unknown"):
        assert f"{name} {levels.count(name) * TICK_S:.1f} s" in line
    assert levels.count("stable") > 0.5 * len(levels)


def test_demo_in_lockstep_gives_the_same_bits_each_time(tmp_path, ports):
    for folder in ("one", "two"):
        demo(tmp_path / folder, ports, *WALK, "--seed", "5")
    demo(tmp_path / "other", ports, *WALK, "--seed", "6")
    one, two, other = (
        (tmp_path / folder / "walk.csv").read_bytes() for folder in ("one", "two", "other")
    )
    assert one == two != other


def test_a_paced_demo_takes_its_time_and_gives_the_bits_of_lockstep(tmp_path, ports, capsys):
    demo(tmp_path / "lockstep", ports, *WALK)
    capsys.readouterr()
    begin_s = time.monotonic()
    assert demo(tmp_path / "paced", ports, *WALK, "--clock", "paced") == 0
    assert time.monotonic() - begin_s > 5.0
    assert "timing: " in capsys.readouterr().out
    one, two = ((tmp_path / name / "walk.csv").read_bytes() for name in ("lockstep", "paced"))
    assert one == two


def test_who_walks_on_a_treadmill_is_judged_as_on_the_floor(tmp_path, ports):
    """The measurements are rounded to 0.2 mm/s in another place."""
    demo(tmp_path / "floor", ports, *WALK)
    demo(tmp_path / "belt", ports, *WALK, "--treadmill")
    for floor, belt in zip(rows(tmp_path / "floor"), rows(tmp_path / "belt"), strict=True):
        assert floor["level"] == belt["level"]
        assert float(floor["margin"]) == pytest.approx(float(belt["margin"]), abs=0.01)
    with can.CanutilsLogReader(tmp_path / "belt" / "walk.candump.log") as log:
        receiver = Receiver()
        frames = [receiver.accept(frame) for frame in log]
    belts = [signals["GROUND"] for name, signals in filter(None, frames) if name == "MEASURED_LEFT"]
    assert min(belts) == pytest.approx(-1.2, abs=0.001) and belts[0] > -0.05


def test_a_fall_is_reported_and_is_not_sound(tmp_path, ports, capsys, monkeypatch):
    from saddlewalk.commands import demo as command

    monkeypatch.setattr(command, "LINE_S", 0.0)
    assert demo(tmp_path, ports, "--speed", "1.2", "--duration", "6", "--push", "80@3:90") == 1
    shown = capsys.readouterr().out
    assert "fell at" in shown and "BAD  the wearer fell" in shown
    assert "stands at the end" not in shown  # though the plan stands
    assert_nothing_is_scored_after_the_fall(shown, rows(tmp_path))
    assert {path.name for path in tmp_path.iterdir()} == FILES
    walk = rows(tmp_path)
    assert walk[-1]["fallen"] == "1"
    alarms = {row["level"] for row in walk if row["fallen"] == "0" and float(row["t_s"]) > 3}
    assert "unstable" in alarms and {row["reason"] for row in walk} >= {"none", "no_step"}


def assert_nothing_is_scored_after_the_fall(shown: str, walk: list[dict[str, str]]) -> None:
    """In the live line and in the times of the levels; walk.csv has what the firmware published."""
    upright = [row["level"] for row in walk if row["fallen"] == "0"]
    levels = next(line for line in shown.splitlines() if line.startswith("level: "))
    assert levels.endswith(", until the fall")
    times_s = [float(word) for word in levels.split() if word[0].isdigit()]
    assert sum(times_s) == pytest.approx(len(upright) * TICK_S, abs=0.2)
    live = [line for line in shown.splitlines() if line.startswith("FELL: ")]
    assert live and all("S_pend n/a" in line and "energy: n/a" in line for line in live)


def test_the_picture_marks_the_fall_and_keeps_the_com_in_view(tmp_path, ports):
    from saddlewalk.pictures.walk import figure_of, read_walk, until_fall

    assert demo(tmp_path, ports, "--speed", "1.2", "--duration", "6", "--push", "80@3:90") == 1
    walk = read_walk(tmp_path / "walk.csv")
    fell_s = walk["t_s"][walk["fallen"] > 0][0]
    shown = until_fall(walk, fell_s)
    for name in ("s_pend", "mos_xcom_m", "ebos_xcom_m", "level", "margin", "true_com_z_m"):
        assert np.isfinite(walk[name][walk["t_s"] > fell_s]).any(), name
        assert np.isnan(shown[name][walk["t_s"] > fell_s]).all(), name
    config = load_config(argparse.Namespace(height=None, mass=None, config=None))
    figure = figure_of(walk, [Push(80, 3, 90)], config, fell_s)
    balance, level, whole, above, *over_time = figure.axes
    over_time += [balance, level]
    lowest = int(np.nanargmin(shown["margin"]))
    margin, words = walk["margin"][lowest], REASON_WORDS[walk["driver"][lowest]]
    title = balance.get_title(loc="left")
    assert title == f"Lowest margin {margin:.2f} at {walk['t_s'][lowest]:.2f} s: {words}"
    assert margin < 0 and walk["t_s"][lowest] <= fell_s
    low, high = balance.get_ylim()
    assert low < 0 < walk["caution_below"][0] < high
    for axes in (whole, above):
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        x_m, y_m = walk["true_com_x_m"][-1], walk["true_com_y_m"][-1]
        assert left < x_m < right and bottom < y_m < top
        assert "fell" in [text.get_text() for text in axes.texts]
    for axes in over_time:
        marks = [line.get_xdata() for line in axes.lines if line.get_label() == "fell"]
        assert [list(mark) for mark in marks] == [[fell_s, fell_s]]


def test_the_part_from_above_has_the_pushes_of_its_time_alone(walk):
    from saddlewalk.pictures.walk import figure_of, read_walk

    config = load_config(argparse.Namespace(height=None, mass=None, config=None))
    pushes = [Push(8, 5, 90), Push(9, 12, 90)]
    above = figure_of(read_walk(walk / "walk.csv"), pushes, config, None).axes[3]
    words = [text.get_text() for text in above.texts]
    assert [text for text in words if text.startswith("push")] == ["push\n8 N·s"]


def test_the_table_has_the_margin_as_lcm_has_it(walk):
    balances = [
        decode(event)
        for event in LcmLog(walk / "walk.lcmlog")
        if event.channel == "SADDLEWALK_BALANCE"
    ]
    for row, message in zip(rows(walk), balances, strict=True):
        half_step = 1.01 * 0.5e-4  # of the CAN signals
        assert float(row["margin"]) == pytest.approx(message.margin, abs=half_step)
        assert float(row["caution_below"]) == pytest.approx(message.caution_below, abs=half_step)
        shown_m = float(row["recovery_margin_m"] or "nan")
        assert shown_m == pytest.approx(message.recovery_margin_m, abs=half_step, nan_ok=True)
        assert row["driver"] == REASONS[message.driver]
    assert len({row["driver"] for row in rows(walk)}) > 2


def test_demo_in_real_time(tmp_path, ports):
    options = ["--clock", "realtime", "--out", str(tmp_path), *ports, "--duration", "2"]
    options += ["--push", "5@1:0"]
    program = [sys.executable, "-c", "from saddlewalk.cli import main; raise SystemExit(main())"]
    done = subprocess.run([*program, "demo", *options], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert {path.name for path in tmp_path.iterdir()} == FILES
    assert len(rows(tmp_path)) >= 2 / TICK_S - 2


def test_demo_rejects_a_bus_with_another_walk(tmp_path, ports, capsys):
    from saddlewalk.emulation.host import running_host

    assert demo(tmp_path, ports, "--duration", "1") == 0
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    capsys.readouterr()
    other_can = private_udp()
    for options in (
        [f"--can={ports[1]}", "--lcm=none"],
        [f"--can={other_can}", f"--lcm={ports[3]}"],
    ):
        with running_host(*options):
            assert demo(tmp_path, ports, "--duration", "1") == 2
        shown = capsys.readouterr().err
        assert shown.count("\n") == 1 and "busy with another walk" in shown
    assert before == {path: path.read_bytes() for path in tmp_path.iterdir()}


def test_firmware_and_wearer_have_the_body_that_was_asked_for(tmp_path, ports):
    (tmp_path / "person.toml").write_text("pendulum_ratio = 0.6\nstep_width_fast_m = 0.13\n")
    body = ["--height", "1.5", "--mass", "45", "--config", str(tmp_path / "person.toml")]
    assert demo(tmp_path, ports, "--duration", "13", *body) == 0
    walk = rows(tmp_path)
    standing_m = math.sqrt((0.6 * 1.5) ** 2 - 0.11**2)
    assert float(walk[0]["true_com_z_m"]) == pytest.approx(standing_m, abs=1e-4)
    steady = [row for row in walk if 6 < float(row["t_s"]) < PUSH_TIMES_S[0]]
    widths = [float(row["plan_left_y_m"]) - float(row["plan_right_y_m"]) for row in steady]
    assert sorted(widths)[len(widths) // 2] == pytest.approx(0.13, abs=0.01)
    assert all(0.8 < float(row["plan_com_z_m"]) < 0.95 for row in walk[1:])
    # Without --push: as much as 28 N s are to 63.3 kg.
    pushed_n_s = [float(walk[-1][f"pushed_{axis}_n_s"]) for axis in "xy"]
    assert math.hypot(*pushed_n_s) == pytest.approx(28 * 45 / 63.3, abs=1e-6)


def test_demo_reports_where_it_cannot_write(tmp_path, ports, capsys):
    (tmp_path / "file").write_text("")
    assert demo(tmp_path / "file" / "demo", ports) == 2
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1 and str(tmp_path / "file" / "demo") in shown


def test_the_record_is_kept_when_the_firmware_dies(tmp_path, ports, capsys, monkeypatch):
    from saddlewalk.emulation import exoskeleton, host

    monkeypatch.setattr(exoskeleton, "SILENCE_S", 0.5)
    started = []
    popen = host.subprocess.Popen

    def starting(*args, **kwargs):
        started.append(popen(*args, **kwargs))
        return started[-1]

    monkeypatch.setattr(host.subprocess, "Popen", starting)
    advance = exoskeleton.Exoskeleton._advance

    def advancing(self, steps):
        advance(self, steps)
        if self.ticks == 20:
            started[0].kill()

    monkeypatch.setattr(exoskeleton.Exoskeleton, "_advance", advancing)
    assert demo(tmp_path, ports, "--duration", "4") == 2
    assert "silent" in capsys.readouterr().err
    assert len(rows(tmp_path)) == 20
    with can.CanutilsLogReader(tmp_path / "walk.candump.log") as log:
        assert sum(1 for _ in log) >= 20 * 16


def test_demo_makes_its_own_network_where_lcm_has_no_route(tmp_path):
    unshare = ["unshare", "--user", "--map-root-user", "--net"]
    trial = subprocess.run([*unshare, "true"], capture_output=True, check=False)
    if trial.returncode != 0:
        pytest.skip("no user namespaces here")
    options = ["demo", "--clock", "lockstep", "--duration", "1", "--out", str(tmp_path)]
    script = Path(sys.executable).with_name("saddlewalk")
    done = subprocess.run(
        [*unshare, str(script), *options], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "private network" in done.stdout


def test_firmware_that_starts_slowly_is_sent_each_measurement_once(ports):
    from saddlewalk.emulation.exoskeleton import Exoskeleton
    from saddlewalk.emulation.host import running_host
    from saddlewalk.emulation.wearer import Wearer
    from saddlewalk.planning.schedule import schedule_of

    options = (f"--can={ports[1]}", "--lcm=none", "--clock=lockstep")
    with running_host(*options) as host, open_bus(ports[1]) as bus:
        host.send_signal(signal.SIGSTOP)
        threading.Timer(0.8, host.send_signal, [signal.SIGCONT]).start()
        exoskeleton = Exoskeleton(bus, Wearer(), configuration({}), schedule_of([(0.0, 0.0)], 0.0))
        exoskeleton.run("lockstep", 0.8)
    assert exoskeleton.ticks == 10
    assert exoskeleton.frames_sent == 10 * 5 + 1  # command, time and measurements; the last command


def test_emulate_without_firmware_reports_it(ports, capsys, monkeypatch):
    from saddlewalk.emulation import exoskeleton

    monkeypatch.setattr(exoskeleton, "SILENCE_S", 0.3)
    for clock in ("lockstep", "realtime"):
        assert main(["emulate", "--clock", clock, *ports]) == 2
        shown = capsys.readouterr().err
        assert shown.count("\n") == 1 and "silent" in shown and "saddlewalk-host" in shown


def test_emulate_gives_up_if_the_firmware_does_not_receive(ports, capsys, monkeypatch):
    from saddlewalk.emulation import exoskeleton
    from saddlewalk.emulation.host import running_host

    monkeypatch.setattr(exoskeleton, "START_TICKS", 5)
    with running_host(f"--can={ports[1]}", "--lcm=none"):
        assert main(["emulate", *ports]) == 2
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1 and "does not follow the commands" in shown and "--lcm" in shown


@pytest.fixture
def key_file(tmp_path) -> str:
    from saddlewalk.transport.authentication import write_new_key

    write_new_key(tmp_path / "command.key")
    return str(tmp_path / "command.key")


@pytest.mark.parametrize("clock", ["lockstep", "realtime"])
def test_demo_with_a_new_key_sends_only_authenticated_commands(tmp_path, ports, capsys, clock):
    from saddlewalk.transport.lcm_types import status_t

    options = ["--clock", clock, "--command-key", "--duration", "4", "--speed", "1.2"]
    assert main(["demo", "--out", str(tmp_path), *ports, *options]) == 0
    assert "commands: authenticated, by CAN" in capsys.readouterr().out
    assert "walking" in [row["mode"] for row in rows(tmp_path)]
    with can.CanutilsLogReader(tmp_path / "walk.candump.log") as log:
        frames = [frame.arbitration_id for frame in log]
    assert frames.count(0x0FF) == frames.count(0x100) >= 4 / TICK_S - 4
    log = lcm.EventLog(str(tmp_path / "walk.lcmlog"), "r")
    heard = list(log)
    log.close()
    assert "SADDLEWALK_COMMAND_TURN" not in {event.channel for event in heard}
    statuses = [
        status_t.decode(event.data) for event in heard if event.channel == "SADDLEWALK_STATUS"
    ]
    last = statuses[-1]
    assert (last.codes_demanded, last.command_source) == (1, last.SOURCE_CAN)
    assert last.commands_obeyed >= 4 / TICK_S - 4 and last.frames_bad_code == 0


def test_emulate_commands_with_the_key_of_the_firmware(ports, capsys, key_file, monkeypatch):
    from saddlewalk.emulation import exoskeleton
    from saddlewalk.emulation.host import running_host

    walk = ["emulate", *ports, "--duration", "2"]
    other = Path(key_file).with_name("other.key")
    other.write_text("0" * 32)
    other.chmod(0o600)
    with running_host(f"--can={ports[1]}", f"--lcm={ports[3]}", f"--command-key={key_file}"):
        for options in ([], ["--command-key", str(other)]):
            with monkeypatch.context() as patch:
                patch.setattr(exoskeleton, "START_TICKS", 5)
                assert main([*walk, *options]) == 2
            shown = capsys.readouterr().err
            assert shown.count("\n") == 1 and "give both the same --command-key" in shown
        assert main([*walk, "--command-key", key_file]) == 0


def test_a_controller_needs_no_authentication(tmp_path, capsys):
    options = ["--firmware", "qemu-m4", "--command-key", "--out", str(tmp_path)]
    assert main(["demo", *options]) == 2
    assert "--command-key: not with --firmware qemu-m4, leave it out" in capsys.readouterr().err


def test_emulate_ends_with_status_1_after_a_fall(ports, capsys):
    from saddlewalk.emulation.host import running_host

    walk = ["emulate", "--clock", "lockstep", *ports, "--duration", "6"]
    with running_host(f"--can={ports[1]}", f"--lcm={ports[3]}", "--clock=lockstep"):
        assert main([*walk, "--push", "80@3:270"]) == 1
        assert "fell" in capsys.readouterr().out
        # The same firmware, still running, takes another wearer.
        assert main(walk) == 0


@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_demo_keeps_its_logs_and_stops_the_firmware(tmp_path, ports, by):
    script = Path(sys.executable).with_name("saddlewalk")
    program = [str(script), "demo", "--out", str(tmp_path), *ports]
    default_action = functools.partial(
        signal.signal, by, signal.SIG_DFL
    )  # nohup's children ignore SIGHUP
    with subprocess.Popen(
        program, stdout=subprocess.PIPE, text=True, preexec_fn=default_action
    ) as process:
        while "starting" not in process.stdout.readline():
            assert process.poll() is None
        time.sleep(0.5)
        process.send_signal(by)
        process.communicate(timeout=10)
        assert process.returncode == 130
    assert len(rows(tmp_path)) >= 4
    with can.CanutilsLogReader(tmp_path / "walk.candump.log") as log:
        assert sum(1 for _ in log) >= 4 * 12
    log = lcm.EventLog(str(tmp_path / "walk.lcmlog"), "r")
    assert {event.channel for event in log} == set(CHANNELS)
    log.close()
    with open_bus(ports[1]) as bus:
        assert bus.recv(3 * TICK_S) is None


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_a_complete_run_replaces_the_previous_one(tmp_path, ports, capsys):
    """With the files made from its log, and no other file."""
    assert demo(tmp_path, ports, "--duration", "2") == 0
    log = str(tmp_path / "walk.lcmlog")
    for words in (["report", log], *(["export", log, "--format", x] for x in ("csv", "mcap"))):
        assert main(words) == 0
    theirs = {"notes.txt", "walk-csv/notes.txt"}
    for name in theirs:
        (tmp_path / name).write_text("mine")
    before = contents(tmp_path)
    assert {"walk.lcmlog.html", "walk.mcap", "walk-csv/plan.csv"} < set(before)

    script = Path(sys.executable).with_name("saddlewalk")
    program = [str(script), "demo", "--out", str(tmp_path), *ports]
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as process:
        shown = ""
        while "starting" not in shown:
            shown += process.stdout.readline()
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        shown += process.communicate(timeout=10)[0]
    assert "holds an earlier run" in shown and f"is in {tmp_path / 'unfinished'}\n" in shown
    after = contents(tmp_path)
    assert before.items() < after.items()
    logs = {"walk.csv", "walk.lcmlog", "walk.candump.log"}
    assert after.keys() - before.keys() == {f"unfinished/{name}" for name in logs}

    capsys.readouterr()
    assert demo(tmp_path, ports, "--duration", "1") == 0
    assert "holds an earlier run" in capsys.readouterr().out
    assert set(contents(tmp_path)) == FILES | theirs
    assert len(rows(tmp_path)) == 13
    assert not (tmp_path / "unfinished").exists()


def test_two_runs_are_not_recorded_in_one_folder_at_once(tmp_path, ports, capsys):
    from saddlewalk.atomic_write import RunFolder

    with RunFolder("--out", tmp_path, ["walk.csv"]) as other:
        (other.start() / "walk.csv").write_text("theirs")
        assert demo(tmp_path, ports, "--duration", "1") == 2
        shown = capsys.readouterr().err
        assert shown.count("\n") == 1 and "another run is being recorded there" in shown
    assert (tmp_path / "walk.csv").read_text() == "theirs"


def test_a_walk_that_did_not_stop_is_not_sound(tmp_path, ports, capsys):
    schedule = tmp_path / "schedule.csv"
    schedule.write_text("t_s,speed_m_s\n0,1.0\n4,0\n")
    options = ["--schedule", str(schedule), "--duration"]
    assert demo(tmp_path / "short", ports, *options, "5") == 1
    assert "BAD  is stopping at the end, not standing" in capsys.readouterr().out
    assert demo(tmp_path / "long", ports, *options, "12") == 0
