"""The kernel's own CAN: the whole demo, can-utils, lost links and full queues."""

import contextlib
import itertools
import re
import select
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import can
import pytest

from host_node import (
    MESSAGES_PER_TICK,
    STANDING,
    TICK_S,
    WAIT_S,
    WALK,
    Host,
    lockstep,
)
from saddlewalk import paths
from saddlewalk.cli import main
from saddlewalk.errors import UserError
from saddlewalk.transport.bus import open_bus

pytestmark = pytest.mark.socketcan

CLASSIC, FD = "socketcan:vcan0", "socketcan:vcan1"
START_S = 90.0  # for a program in Python to start in the guest
DATABASE = paths.CHECKOUT / "firmware/wire/saddlewalk.dbc"


def run(command: str) -> None:
    subprocess.run(command.split(), check=True)


def as_text(frame: can.Message) -> str:
    """As candump -L and cansend write a classic data frame."""
    return f"{frame.arbitration_id:03X}#{frame.data.hex().upper()}"


class Candump:
    """candump -L on vcan0, which listens once the block begins."""

    LISTENING, END = (can.Message(arbitration_id=i, is_extended_id=False) for i in (0x7FE, 0x7FF))

    def __enter__(self) -> "Candump":
        command = ["candump", "-L", "vcan0"]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self._bus = open_bus(CLASSIC)
        deadline_s = time.monotonic() + WAIT_S
        while not select.select([self._process.stdout], [], [], 0.01)[0]:
            assert time.monotonic() < deadline_s
            self._bus.send(self.LISTENING)
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.communicate()
        self._bus.shutdown()

    def frames(self) -> list[str]:
        """What was on the bus until now."""
        self._bus.send(self.END)
        texts = (line.split()[2] for line in self._process.stdout)
        heard = itertools.takewhile(lambda text: text != as_text(self.END), texts)
        return [text for text in heard if text != as_text(self.LISTENING)]


def test_candump_shows_the_firmwares_input_and_output():
    with Candump() as candump, lockstep(spec=CLASSIC) as host:
        sent = [host.send("COMMAND", **WALK)]
        sent += [host.send(name, **values) for name, values in STANDING.items()]
        answer = host.tick_frames()
        assert len(answer) == MESSAGES_PER_TICK
        assert candump.frames() == [as_text(frame) for frame in (*sent, *answer)]


def test_cansend_moves_the_firmware():
    with lockstep(spec=CLASSIC) as host:
        command = host.sender.frame("COMMAND", **WALK)
        measured = [host.sender.frame(name, **values) for name, values in STANDING.items()]
        for frame in (command, *measured):
            run(f"cansend vcan0 {as_text(frame)}")
        tick = host.tick()
        assert len(tick) == 4 + MESSAGES_PER_TICK  # what cansend sent is heard too
        assert tick["PLAN_EVENTS"]["MODE"] == 1
        assert tick["HEALTH"]["REJECTED_FRAMES"] == 0


def test_the_documented_cansend_starts_a_walk():
    page = (paths.CHECKOUT / "docs/bus.md").read_text()
    with lockstep(spec=CLASSIC) as host:
        run(re.search(r"^ *(cansend vcan0 \S+)", page, re.MULTILINE)[1])
        host.measure()
        tick = host.tick()
        assert tick["COMMAND"]["SPEED"] == pytest.approx(1.2)
        assert tick["PLAN_EVENTS"]["MODE"] == 1
        assert " 1 applied" in host.stop()


def test_cansend_cannot_harm_the_firmware():
    classic = ["110#", "110#11", "110#R", "110#R8", "00000110#1122334455667788", "7FF#00"]
    for spec, strangers in (
        (CLASSIC, classic),
        (FD, [*classic, "110##0", "110##1" + "00" * 8, "110##3" + "FF" * 64]),
    ):
        with lockstep(spec=spec) as host:
            for frame in strangers:
                run(f"cansend {spec.partition(':')[2]} {frame}")
            host.measure()
            assert len(host.tick_frames()) == len(strangers) + MESSAGES_PER_TICK
            assert f" {len(strangers)} malformed" in host.stop()


def test_cantools_decodes_what_candump_sees():
    cantools = Path(sys.executable).with_name("cantools")
    with Host("--lcm=none", spec=CLASSIC):
        done = subprocess.run(
            f"candump -n {2 * MESSAGES_PER_TICK} vcan0 | {cantools} decode {DATABASE}",
            shell=True,
            capture_output=True,
            text=True,
            timeout=START_S,
            check=True,
        )
    for name in ("PLAN_COM", "SCORES_STEP", "VERDICT", "HEALTH"):
        assert done.stdout.count(f"::\n{name}(") == 2


def test_the_demo_uses_vcan0_by_default(tmp_path, capsys):
    """In lockstep: an emulated processor may be too slow for a wearer in real time."""
    assert main(["demo", "--clock=lockstep", f"--out={tmp_path}"]) == 0
    printed = capsys.readouterr().out
    assert "CAN: socketcan channel 'vcan0'" in printed
    assert "did not fall" in printed and "BAD" not in printed and "stands at the end" in printed
    with can.CanutilsLogReader(tmp_path / "walk.candump.log") as log:
        assert sum(1 for _ in log) > 20 / TICK_S * MESSAGES_PER_TICK


@contextlib.contextmanager
def interface_down() -> Iterator[None]:
    run("ip link set vcan0 down")
    try:
        yield
    finally:
        run("ip link set vcan0 up")


def test_an_interface_that_is_down_is_one_line():
    with interface_down():
        with pytest.raises(UserError, match="vcan0 is not there or not up"):
            open_bus(CLASSIC)
        command = [paths.built("bin/saddlewalk-host"), "--can", CLASSIC, "--lcm=none"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=WAIT_S, check=False)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
        assert "vcan0 is not there or not up" in done.stderr


LOST_AND_BACK = ("CAN vcan0 is lost: ", "CAN vcan0 is back")


def test_the_firmware_ticks_on_while_its_interface_is_down():
    with Host("--lcm=none", spec=CLASSIC) as host:
        host.tick()
        begun_s = time.monotonic()
        with interface_down():
            time.sleep(5 * TICK_S)
        words = assert_all_ticks_come_again(host, begun_s, LOST_AND_BACK)
        assert count_of("without link", words) > 3 * MESSAGES_PER_TICK


def test_the_firmware_reopens_a_recreated_interface():
    with Host("--lcm=none", spec=CLASSIC) as host:
        host.tick()
        begun_s = time.monotonic()
        run("ip link delete vcan0")
        time.sleep(5 * TICK_S)
        run("ip link add dev vcan0 type vcan")
        run("ip link set vcan0 mtu 16 up")
        words = assert_all_ticks_come_again(host, begun_s, LOST_AND_BACK)
        assert count_of("without link", words) > 3 * MESSAGES_PER_TICK


def test_a_full_queue_loses_frames_but_no_tick():
    with Host("--lcm=none", spec=CLASSIC) as host:
        host.tick()
        begun_s = time.monotonic()
        # 100 bytes a second and room for ten frames, where 25 frames of 16 bytes come in 80 ms.
        run("tc qdisc add dev vcan0 root tbf rate 800bit burst 100 limit 160")
        try:
            discard(host.bus)
            time.sleep(8 * TICK_S)
            assert discard(host.bus) < MESSAGES_PER_TICK
        finally:
            run("tc qdisc delete dev vcan0 root")
        words = assert_all_ticks_come_again(host, begun_s)
        assert count_of("frames without room", words) > 6 * MESSAGES_PER_TICK


def count_of(what: str, summary: str) -> int:
    return int(re.search(rf"(\d+) {what}", summary)[1])


def discard(bus: can.BusABC) -> int:
    """Forget what waits to be received; how many frames that was."""
    return sum(1 for _ in iter(lambda: bus.recv(0), None))


def assert_all_ticks_come_again(host: Host, begun_s: float, announced: tuple[str, ...] = ()) -> str:
    """On a bus opened anew whole ticks come, and next to none was left out since begun_s.

    announced: how each line of the host's on the way begins. Returns its summary line.
    """
    host.bus.shutdown()
    host.bus = open_bus(host.spec)
    host.tick_frames()
    for _ in range(3):
        assert len(host.tick_frames()) == MESSAGES_PER_TICK
    passed = int((time.monotonic() - begun_s) / TICK_S)
    words = host.stop(announced=announced)
    assert int(words.split()[0]) >= passed - 2
    return words
