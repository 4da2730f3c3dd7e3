"""The live view: what it shows of made-up messages, of silence, and how the command ends."""

import io
import math
import os
import pty
import re
import signal
import subprocess
import sys
import time

import lcm
import pytest
from rich.console import Console

from saddlewalk import contract, dashboard, status_text
from saddlewalk.banner import banner
from saddlewalk.commands.monitor import CHANNELS, Listener
from saddlewalk.dashboard import Heard
from saddlewalk.transport.lcm_types import (
    balance_t,
    health_t,
    plan_t,
    scores_t,
    status_t,
    verdict_t,
)

MONITOR = [
    sys.executable,
    "-c",
    "from saddlewalk.cli import main; raise SystemExit(main())",
    "monitor",
]
SILENT = "memq://"


def plan() -> plan_t:
    message = plan_t()
    message.valid = 1
    message.mode = plan_t.MODE_WALKING
    message.phase, message.support, message.step_count = 2, plan_t.RIGHT, 17
    message.theta_rad = 1.2 * math.pi
    message.speed_m_s = 1.2
    message.time_to_heel_strike_s = 0.31
    return message


def scores() -> scores_t:
    message = scores_t()
    message.s_pend, message.s_jump, message.s_sw = 0.62, 1.25, math.nan
    message.mos_com_m, message.mos_xcom_m = 0.083, -0.214
    return message


def verdict() -> verdict_t:
    message = verdict_t()
    message.level, message.reason = verdict_t.LEVEL_CAUTION, verdict_t.REASON_XCOM_ML
    message.compared = message.on_track = message.recovery_found = 1
    message.excess_stop_j, message.excess_track_j = 31.24, -4.5
    message.ebos_com_m, message.ebos_xcom_m = 0.097, -0.031
    message.recovery_foot = verdict_t.RIGHT
    message.recovery_landing_m, message.recovery_margin_m = [0.703, -0.148], 0.214
    return message


def balance() -> balance_t:
    message = balance_t()
    message.driver = verdict_t.REASON_LEFT
    message.margin, message.caution_below = 0.053, 0.1
    message.recovery_margin_m = 0.214
    return message


def health() -> health_t:
    message = health_t()
    message.tick, message.measurement_age_us, message.late_ticks = 512, 4200, 3
    message.frames_bad_crc, message.frames_bad_counter, message.frames_malformed = 1, 2, 4
    return message


def status() -> status_t:
    message = status_t()
    message.period_us, message.latency_us, message.latency_max_us = 80012, 130, 1900
    message.latencies = [0, 0, 0, 0, 0, 0, 50, 149, 0, 0, 1] + [0] * 6
    message.command_source, message.command_age_us = status_t.SOURCE_LCM, 40_400
    message.com_age_us = message.left_age_us = 8000
    message.right_age_us = status_t.NEVER
    message.can_transport, message.can_link = status_t.TRANSPORT_UDP, status_t.LINK_UP
    message.lcm_link, message.lcm_losses = status_t.LINK_DOWN, 2
    message.frames_accepted, message.frames_bad_version, message.other_version = 900, 5, 3
    message.frames_no_room, message.wire_version = 7, 5
    return message


def heard(**changed) -> Heard:
    """All messages, or those given."""
    made = {
        "plan": plan,
        "scores": scores,
        "verdict": verdict,
        "balance": balance,
        "health": health,
        "status": status,
    }
    messages = {name: make() for name, make in made.items()}
    return Heard(**messages | changed)


def drawn(heard_: Heard, width: int = 120) -> str:
    console = Console(file=io.StringIO(), width=width)
    console.print(dashboard.render(heard_))
    return console.file.getvalue()


SHOWN = ["step 17 (right)", "phase 60%", "1.20 m/s", "0.31 s", "0.62", "1.25", "n/a"]
SHOWN += ["+0.053 (unstable at 0, caution at 0.100)"]
SHOWN += ["largest departure: left"]
SHOWN += ["+0.083 m", "-0.214 m", "data age 4 ms", "late ticks 3", "frames rejected 7"]
SHOWN += ["plan: walking", "tick 512", "+0.097 m", "-0.031 m"]
SHOWN += ["sideways motion deviates from the expected"]
SHOWN += ["to stop +31.2 J (ankles cannot)", "to the plan -4.5 J (ankles can)"]
SHOWN += ["right foot 0.70 m ahead, 0.15 m right of the left, 0.21 m spare"]


SHOWN += ["every 80.0 ms", "latency 0.13 ms (99% below 0.256 ms, worst 1.90 ms)"]
SHOWN += ["commands from LCM 40 ms ago", "CoM 8 ms ago", "right foot never"]
SHOWN += [
    "wire version 3 rejected, this firmware has 5",
    "CAN by UDP up",
    "LCM DOWN (lost 2 times)",
]
SHOWN += ["dropped 7 frames without room"]


def test_commands_of_an_older_wire_version_are_mentioned():
    older = status()
    older.frames_bad_version = 0
    assert "commands of wire version 3, this firmware has 5" in status_text.inputs(older)


@pytest.mark.parametrize("text", SHOWN)
def test_every_number_is_shown_drawn_or_as_a_line(text):
    assert text in drawn(heard())
    assert text in dashboard.summary(heard())


def test_the_line_is_one_line():
    assert "\n" not in dashboard.summary(heard())


@pytest.mark.parametrize("silent_s", [0.0, 1.0])
def test_fresh_data_are_not_called_old(silent_s):
    assert "no message" not in drawn(heard(silent_s=silent_s))
    assert "no message" not in dashboard.summary(heard(silent_s=silent_s))


def test_silence_of_more_than_a_second_is_reported():
    words = "no message from the firmware for 1.4 s"
    assert words in drawn(heard(silent_s=1.4))
    assert words in dashboard.summary(heard(silent_s=1.4))
    assert words in drawn(Heard(silent_s=1.4))


SHOWN_OF = {
    "plan": "phase 60%",
    "scores": "0.62",
    "verdict": "31.2 J",
    "balance": "+0.053",
    "health": "tick 512",
    "status": "900 frames accepted",
}


@pytest.mark.parametrize("missing", SHOWN_OF)
def test_a_channel_that_is_silent_hides_no_other(missing):
    text = drawn(heard(**{missing: None}))
    assert [name for name, shown in SHOWN_OF.items() if shown not in text] == [missing]


def test_all_of_it_fits_a_small_terminal():
    """24 lines of 80 characters with every number, a last step and a host with problems."""
    message = verdict()
    message.level, message.recovery_stops = verdict_t.LEVEL_UNSTABLE, 1
    lines = drawn(heard(verdict=message), width=80).splitlines()
    assert len(lines) <= 24 and {len(line) for line in lines} == {80}


def test_the_level_comes_first_and_large_and_in_words():
    text = drawn(heard())
    rows = [line.strip("│ ") for line in text.splitlines()[1:7]]
    assert rows[:4] == [
        *(row.strip() for row in banner("CAUTION").splitlines()),
        "level: caution, sideways motion deviates from the expected",
    ]
    assert (
        rows[4].split() == "margin ░░░░│█▒▒░░░░░░░░░░░░░░░░░ +0.053".split() + rows[4].split()[3:]
    )
    assert rows[5].startswith("largest departure: ")
    line = dashboard.summary(heard())
    assert line.startswith("CAUTION: sideways motion deviates from the expected | margin +0.053 (")


@pytest.mark.parametrize(
    ("value", "bar"),
    [
        (-3.0, "████│▒▒▒" + "░" * 17),
        (-0.04, "░░░█│▒▒▒" + "░" * 17),
        (0.0, "░░░░│▒▒▒" + "░" * 17),
        (0.08, "░░░░│██▒" + "░" * 17),
        (0.4, "░░░░│" + "█" * 10 + "░" * 10),
        (3.0, "░░░░│" + "█" * 20),
    ],
)
def test_the_margin_starts_at_unstable_and_shows_the_caution_band(value, bar):
    assert dashboard.balance_bar(value, 0.1).plain == bar


def test_a_margin_that_is_not_known_has_no_bar_and_no_driver():
    message = balance()
    message.margin = message.caution_below = math.nan
    text = drawn(heard(balance=message))
    assert re.search(r"margin +·{25} n/a", text) and "largest departure: n/a" in text


@pytest.mark.parametrize("name", contract.LEVELS)
def test_every_level_can_be_written_banner(name):
    rows = banner(name.upper()).splitlines()
    assert len(rows) == 3 and len({len(row) for row in rows}) == 1


def test_a_level_without_a_reason_stands_alone():
    message = verdict()
    message.level, message.reason = verdict_t.LEVEL_STABLE, verdict_t.REASON_NONE
    assert "level: stable\n" in re.sub(r" *│", "", drawn(heard(verdict=message)))
    assert dashboard.summary(heard(verdict=message)).startswith("STABLE | margin")


def test_after_a_fall_no_score_is_shown():
    """The firmware goes on scoring the posture of a wearer who lies on the ground."""
    for text in (drawn(heard(fallen=True)), dashboard.summary(heard(fallen=True))):
        assert "fell" in text.lower() and "scores are not available" in text
        for label in ("S_pend", "S_jump", "S_SW", "CoM in BoS", "XCoM in E-BoS"):
            assert re.search(rf"{re.escape(label)} .*?n/a", text), label
        assert "energy: n/a" in text and "recovery: n/a" in text
        for number in ("0.62", "+0.083 m", "-4.5 J", "0.21 m of reach", "CAUTION"):
            assert number not in text
    assert banner("FELL") != "FELL"
    assert "█" not in drawn(heard(fallen=True)).split("S_pend")[1]


def test_the_listener_shows_a_fall_while_it_is_reported():
    from saddlewalk.transport.lcm_types import truth_t

    listener, truth = Listener(), truth_t()
    for fallen in (0, 1, 0, 1):
        truth.fallen = fallen
        listener.take("SADDLEWALK_TRUTH", truth.encode())
        assert listener.fallen == bool(fallen) and not listener.complete
    listener.truth = (listener.truth[0] - dashboard.SILENT_AFTER_S, truth)
    assert not listener.fallen


def test_an_old_level_is_not_shown():
    text = drawn(heard(silent_s=1.4))
    assert "level: unknown, no message from the firmware for 1.4 s" in text
    assert "caution" not in text.lower()
    assert banner("CAUTION").splitlines()[0] not in text


def test_a_level_and_a_reason_of_other_firmware_are_given_by_number():
    message = verdict()
    message.level, message.reason = 9, 99
    assert "level: level 9, reason 99" in drawn(heard(verdict=message))


def test_a_missing_recovery_step_is_reported_with_the_missing_distance():
    message = verdict()
    message.recovery_found, message.recovery_margin_m = 0, -0.12
    assert dashboard.recovery_step(message) == "none within reach, 0.12 m short"
    message.compared = 0
    assert dashboard.recovery_step(message) == "n/a"


def test_a_recovery_step_back_to_the_left_that_ends_the_walk():
    message = verdict()
    message.recovery_foot, message.recovery_stops = verdict_t.LEFT, 1
    message.recovery_landing_m = [-0.2, 0.3]
    text = dashboard.recovery_step(message)
    assert "left foot 0.20 m behind, 0.30 m left of the right" in text
    assert text.endswith(", ends the walk")


def test_unknown_energies_are_not_compared():
    message = verdict()
    message.excess_stop_j = message.excess_track_j = math.nan
    assert dashboard.energy(message) == "to stop n/a, to the plan n/a"


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (("COMMAND_STALE",), "commands missing"),
        (("COM_RANGE", "LEFT_STALE"), "the CoM's measurement and the left foot's missing"),
        ((), "inputs not yet valid for long enough"),
    ],
)
def test_a_safe_stop_is_reported_with_what_is_missing(faults, words):
    message = health()
    assert "SAFE STOP" not in dashboard.condition(message)
    message.limits = 1 << contract.LIMITS.index("SAFE_STOP")
    message.faults = sum(1 << contract.FAULTS.index(fault) for fault in faults)
    assert dashboard.condition(message).endswith(f"; SAFE STOP, the walk ends: {words}")


def test_what_was_rejected_is_reported_by_cause():
    assert "900 frames accepted, 5 bad version, wire" in status_text.inputs(status())


def test_a_former_command_source_is_not_shown_as_current():
    """Authority ends with the walk that nobody commands any more."""
    message = status()
    message.command_source, message.command_age_us = status_t.SOURCE_NONE, 377_548_000
    assert status_text.inputs(message).startswith("inputs: no commands now, the last 378 s ago, ")
    message.command_age_us = status_t.NEVER
    assert status_text.inputs(message).startswith("inputs: no commands yet, ")


def test_commands_from_other_machines_are_reported():
    message = status()
    message.commands_foreign = 20
    assert "20 commands from other machines" in status_text.inputs(message)


def test_a_process_in_lockstep_shows_no_times_of_a_clock():
    message = status_t()
    message.period_us, message.missed_ticks = 80_000, 0
    assert status_text.timing(message) == "timing: in lockstep, 0 ticks missed"


def test_a_healthy_process_reports_no_problems():
    message = status_t()
    message.can_link = message.lcm_link = status_t.LINK_UP
    message.fifo_priority, message.memory_locked, message.work_us = 20, 1, 90
    timing, inputs, transports = status_text.lines(message)
    assert timing.endswith("0 ticks missed, SCHED_FIFO 20, memory locked")
    assert inputs.endswith("0 frames accepted")
    assert transports == "transports: CAN by SocketCAN up, LCM up"


def test_codes_of_other_firmware_are_given_by_number():
    message = status()
    message.command_source, message.can_link = 9, 8
    assert "commands from 9" in status_text.inputs(message)
    assert "UDP 8" in status_text.transports(message)


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        ("LINK", status_text.LINKS),
        ("SOURCE", status_text.SOURCES),
        ("TRANSPORT", status_text.TRANSPORTS),
    ],
)
def test_names_are_those_of_the_status(kind, names):
    for number, name in enumerate(names):
        assert getattr(status_t, f"{kind}_{name.upper().replace('-', '_')}") == number


def test_a_failed_tick_is_reported_and_no_numbers_of_a_plan():
    assert dashboard.gait(plan_t()) == "plan: none"


def test_standing_is_reported_without_the_numbers_of_a_step():
    message = plan()
    message.mode = plan_t.MODE_STANDING
    assert dashboard.gait(message) == "plan: standing after 17 steps"


def test_an_unpredicted_heel_strike_has_no_time():
    message = plan()
    message.mode, message.time_to_heel_strike_s = plan_t.MODE_STARTING, 1000.0
    assert dashboard.gait(message).endswith("no heel strike")


def test_faults_limits_and_status_are_named():
    message = health()
    message.measurement_age_us = -1
    message.status, message.limits, message.faults = 2, 0b1001, 0b110
    text = dashboard.condition(message)
    for name in ("ERROR_CONFIG", "limits SPEED FEET", "faults COM_STALE COM_RANGE"):
        assert name in text
    assert "never measured" in text
    message.status, message.limits = 99, -1
    assert "status 99" in dashboard.condition(message)


@pytest.mark.parametrize(
    ("value", "full"), [(-3.0, 0), (0.0, 0), (0.5, 6), (1.0, 13), (7.0, 13), (math.inf, 13)]
)
def test_a_score_is_full_at_the_reference_and_empty_at_the_limit(value, full):
    bar = dashboard.score_bar(value).plain
    assert bar == "█" * full + "░" * (13 - full)


@pytest.mark.parametrize("value_m", [0.1, 0.4, 3.0, math.inf])
def test_a_margin_points_right_inside_and_left_outside(value_m):
    inside, outside = (dashboard.margin_bar(v).plain for v in (value_m, -value_m))
    assert inside == outside[::-1]
    left, right = inside.split("│")
    assert "█" not in left
    assert right.count("█") == {0.1: 2}.get(value_m, 6)


def test_no_number_draws_no_bar():
    assert set(dashboard.score_bar(math.nan).plain) == {"·"}
    assert set(dashboard.margin_bar(math.nan).plain) == {"·"}


def test_the_listener_keeps_the_newest_and_counts_what_it_cannot_read():
    listener = Listener()
    for tick in (1, 2):
        message = health()
        message.tick = tick
        listener.take("SADDLEWALK_HEALTH", message.encode())
    listener.take("SADDLEWALK_HEALTH", b"")
    listener.take("SADDLEWALK_HEALTH", scores().encode())
    listener.take("SADDLEWALK_HEALTH", health().encode()[:-1])
    assert "tick 2," in listener.line()
    assert "3 LCM messages could not be read" in listener.line()
    assert not listener.complete


def test_the_listener_measures_silence():
    listener = Listener()
    listener.take("SADDLEWALK_PLAN", plan().encode())
    assert "no message" not in listener.line()
    listener.heard_s = time.monotonic() - 5
    assert re.search(r"no message from the firmware for 5\.\d s", listener.line())
    listener.take("SADDLEWALK_PLAN", b"unreadable")
    assert "no message" in listener.line()
    listener.take("SADDLEWALK_PLAN", plan().encode())
    assert "no message" not in listener.line()


def test_once_prints_one_line_of_a_log(tmp_path):
    log = lcm.EventLog(str(tmp_path / "log"), "w", overwrite=True)
    messages = heard()
    messages = [getattr(messages, kind.removesuffix("_t")) for kind in CHANNELS.values()]
    for channel, message in zip(CHANNELS, messages, strict=True):
        log.write_event(0, channel, message.encode())
    log.close()
    url = f"file://{tmp_path / 'log'}?speed=0"
    done = subprocess.run([*MONITOR, "--once", "--lcm", url], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines() == [dashboard.summary(heard())]


def test_once_fails_without_messages():
    done = subprocess.run([*MONITOR, "--once", "--lcm", SILENT], capture_output=True, text=True)
    assert done.returncode == 1
    assert re.fullmatch(r"no message from the firmware for \d\.\d s\n", done.stdout)


def test_lines_without_a_terminal_until_ctrl_c():
    process = subprocess.Popen([*MONITOR, "--lcm", SILENT], stdout=-1, stderr=-1, text=True)
    assert "no message from the firmware" in process.stdout.readline()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=10)
    assert (process.returncode, errors) == (0, "")


def test_a_panel_on_a_terminal_until_ctrl_c():
    terminal, end = pty.openpty()
    process = subprocess.Popen([*MONITOR, "--lcm", SILENT], stdout=end, stderr=end)
    os.close(end)
    shown = b""
    while "╯".encode() not in shown:
        shown += os.read(terminal, 4096)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=10) == 0
    os.close(terminal)
    assert b"no message from the firmware" in shown


def test_an_unusable_url_is_one_line():
    done = subprocess.run([*MONITOR, "--lcm", "nonsense"], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "nonsense" in done.stderr
