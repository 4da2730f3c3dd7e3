"""cantools and python-can's logger know Saddlewalk by its DBC alone, and read any of its buses."""

import contextlib
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from host_node import MESSAGES_PER_TICK, Host
from saddlewalk import paths

START_S = 90.0  # for a program in Python, on an emulated processor with cold caches too
DATABASE = str(paths.CHECKOUT / "firmware/wire/saddlewalk.dbc")


def program(name: str) -> str:
    return str(Path(sys.executable).with_name(name))


def interface_options(spec: str) -> list[str]:
    """The bus as python-can's programs, and cantools with them, are given it."""
    kind, _, channel = spec.partition(":")
    return ["-i", {"udp": "saddlewalk_udp"}.get(kind, kind), "-c", channel]


@contextlib.contextmanager
def on_a_terminal(command: list[str]) -> Iterator[int]:
    """The file descriptor of a terminal of 120 rows and 200 columns, on which a command runs."""
    screen, terminal = pty.openpty()
    size = {"TERM": "xterm", "LINES": "120", "COLUMNS": "200"}
    process = subprocess.Popen(
        command, stdin=terminal, stdout=terminal, stderr=terminal, env=os.environ | size
    )
    os.close(terminal)
    try:
        yield screen
    finally:
        process.kill()
        process.wait()
        os.close(screen)


def until_shown(screen: int, patterns: list[str]) -> str:
    """The terminal's output until it shows all patterns, or until a timeout."""
    text = ""
    deadline_s = time.monotonic() + START_S
    while (left_s := deadline_s - time.monotonic()) > 0:
        if select.select([screen], [], [], left_s)[0]:
            text += os.read(screen, 65536).decode(errors="replace")
        if all(re.search(pattern, text) for pattern in patterns):
            break
    return text


def test_cantools_monitor_shows_the_live_firmware(spec):
    command = [program("cantools"), "monitor", "-s", *interface_options(spec), DATABASE]
    with Host("--lcm=none", spec=spec), on_a_terminal(command) as screen:
        expected = [
            r"HEALTH\(CRC: \d+, COUNTER: \d+, STATUS: OK, ",
            r"PLAN_COM\(CRC: \d+, COUNTER: \d+, X: 0\.0 m, Y: 0\.0 m, Z: 1\.0\d+ m\)",
            r"PLAN_EVENTS\(.*MODE: STANDING, ",
            r"VERDICT\(.*LEVEL: UNKNOWN, REASON: INPUT, XCOM_DEVIATION_X: NOT_AVAILABLE",
            r"SCORES_FORCE\(.*FAULTS: \d+",
        ]
        shown = until_shown(screen, expected)
        for pattern in expected:
            assert re.search(pattern, shown)
        assert "Discarded: 0, Errors: 0" in shown


def test_cantools_decode_reads_what_can_logger_wrote(spec, tmp_path):
    log = tmp_path / "walk.log"
    command = [program("can_logger"), *interface_options(spec), "-f", str(log)]
    with Host("--lcm=none", spec=spec), subprocess.Popen(command) as logger:
        deadline_s = time.monotonic() + START_S
        while not log.exists() or log.read_text().count(" 140#") < 3:  # HEALTH ends a tick
            assert time.monotonic() < deadline_s
            time.sleep(0.05)
        logger.send_signal(signal.SIGINT)
    frames = log.read_text().splitlines()
    assert len(frames) > 2 * MESSAGES_PER_TICK
    decode = [program("cantools"), "decode", "-s", DATABASE]
    done = subprocess.run(decode, input=log.read_text(), capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert [line.split(" ::")[0] for line in lines] == frames
    assert all(re.search(r":: [A-Z_]+\(CRC: \d+, COUNTER: \d+, ", line) for line in lines)
    assert " PLAN_COM(" in done.stdout and " VERDICT(" in done.stdout
