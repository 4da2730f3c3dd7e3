"""The firmware on an emulated controller, `firmware/port_mcu`, and its serial line."""

import contextlib
import itertools
import math
import re
import socket
import statistics
import subprocess
import time
from pathlib import Path

import can
import pytest

from host_node import MESSAGES_PER_TICK, STANDING, WALK, own_lcm
from saddlewalk.cli import main
from saddlewalk.config import configuration
from saddlewalk.contract import TICK_S
from saddlewalk.emulation import exoskeleton, qemu
from saddlewalk.errors import UserError
from saddlewalk.ticks import TickReader, next_tick
from saddlewalk.transport.bus import private_udp
from saddlewalk.transport.slcan import SlcanBus, frame_of, text_of
from saddlewalk.transport.wire import FRAME_LENGTH, Sender, message_name

pytestmark = pytest.mark.firmware

on_controller = pytest.mark.targets
START_S = 10.0  # timeout for a starting emulator
WAIT_S = 2.0
MEASURED_S = 0.01
EXCEPTION_FRAME = 8 * 4 + 18 * 4 + 4  # core and FPU registers, and the gap that aligns them


def demo(folder: Path, *options: str) -> int:
    return main(["demo", "--out", str(folder), "--lcm", own_lcm(), *options])


def firmware_frames(folder: Path) -> list[can.Message]:
    with can.CanutilsLogReader(folder / "walk.candump.log") as log:
        return [frame for frame in log if frame.arbitration_id >= 0x120]


@on_controller
def test_a_walk_has_the_same_frames_as_the_host_process(tmp_path, capsys):
    """With another body than the image's default, so that the configuration matters."""
    walk = ["--height", "1.6", "--mass", "50", "--speed", "1.1", "--duration", "8"]
    walk += ["--push", "12@5:90"]
    by_host = demo(tmp_path / "host", "--clock", "lockstep", "--can", private_udp(), *walk)
    by_controller = demo(tmp_path / "controller", "--firmware", "qemu-m4", *walk)
    assert_same_frames(firmware_frames(tmp_path / "host"), firmware_frames(tmp_path / "controller"))
    one, other = (tmp_path / name / "walk.csv" for name in ("host", "controller"))
    assert one.read_bytes() == other.read_bytes()
    printed = capsys.readouterr().out
    assert by_host == by_controller == 0, printed
    assert f"controller: {round(8 / TICK_S)} ticks, 0 late, 0 missed" in printed
    assert "a controller has no LCM" in printed


def assert_same_frames(by_host: list[can.Message], by_controller: list[can.Message]) -> None:
    assert len(by_host) == MESSAGES_PER_TICK * round(8 / TICK_S)
    pairs = zip(by_host, by_controller, strict=True)
    for number, (one, other) in enumerate(pairs):
        place = f"{message_name(one.arbitration_id)} of tick {number // MESSAGES_PER_TICK}"
        assert one.arbitration_id == other.arbitration_id, f"instead of {place}"
        assert one.data.hex() == other.data.hex(), place


def send_measurement(bus: SlcanBus, sender: Sender) -> None:
    for name, values in STANDING.items():
        bus.send(sender.frame(name, **values))


@on_controller
def test_a_body_in_mujoco_walks_by_its_plan(tmp_path):
    """Chip, bus and physics: the joints' controller checks each plan against its own core's."""
    for package in ("mujoco", "piqp"):
        pytest.importorskip(package, reason="MuJoCo is missing: run `make physics`")
    walk = ["--plant", "mujoco", "--speed", "0.8", "--duration", "2.4"]
    assert demo(tmp_path / "out", "--firmware", "qemu-m4", *walk) == 0


@on_controller
def test_in_real_time_the_timer_drives_the_ticks_and_ages_grow():
    reader, sender, ticks = TickReader(), Sender(), []
    with qemu.running_controller(configuration({}), "realtime") as controller:
        bus = controller.bus
        assert next_tick(bus, reader.feed, START_S)
        begun_s = time.monotonic()
        while (now_s := time.monotonic()) < begun_s + 2.0:
            bus.send(sender.frame("COMMAND", **WALK))
            send_measurement(bus, sender)
            while messages := next_tick(bus, reader.feed, now_s + MEASURED_S - time.monotonic()):
                ticks.append(messages)
        silent = [next_tick(bus, reader.feed, WAIT_S) for _ in range(12)]
        ran_s = time.monotonic() - begun_s
    made, missed = map(
        int, re.match(r"(\d+) ticks, \d+ late, (\d+) missed", controller.words).groups()
    )
    assert made + missed == pytest.approx(ran_s / TICK_S, abs=3)
    assert ticks[-1]["HEALTH"]["REJECTED_FRAMES"] == 0
    periods_s = [tick["TIMING"]["PERIOD"] for tick in ticks[5:]]
    assert statistics.median(periods_s) == pytest.approx(TICK_S, abs=0.002)
    assert statistics.median(tick["INPUTS"]["COM_AGE"] for tick in ticks) < 30
    ages_ms = [tick["INPUTS"]["COM_AGE"] for tick in silent[-5:]]
    growth_ms = {later - age for age, later in itertools.pairwise(ages_ms)}
    assert growth_ms <= {
        80.0,
        160.0,
        240.0,
    }  # more than one tick's if a busy machine missed some


def tool(name: str, *options: str) -> str:
    """Output of a compiler tool for the image."""
    return subprocess.check_output([f"arm-none-eabi-{name}", *options, qemu.IMAGE], text=True)


@on_controller
def test_no_interrupt_comes_between_the_timers_flag_and_its_count():
    function = tool("objdump", "--no-show-raw-insn", "--disassemble=mps2_timer_came_round")
    happens = re.findall(r"\tstr|interrupts_(?:hold|restore)(?=>$)", function, re.MULTILINE)
    assert happens == ["interrupts_hold", "\tstr", "\tstr", "interrupts_restore"]


@on_controller
def test_its_stack_stays_below_the_worst_case_and_it_has_no_heap(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[1] / "targets")
    import stack

    graph = stack.of_image(tool("objdump", "-d", "--no-show-raw-insn"))
    interrupts = ("on_timer", "on_uart_received", "mps2_uart_sent")
    worst = (
        graph.frames["_start"]
        + graph.frames["main"]
        + graph.worst("saddle_controller_step")
        + EXCEPTION_FRAME
        + max(map(graph.worst, interrupts))
    )
    sender = Sender()
    with qemu.running_controller(configuration({})) as controller:
        reader = TickReader()
        for _ in range(100):
            controller.bus.send(sender.frame("COMMAND", **WALK))
            send_measurement(controller.bus, sender)
            assert next_tick(controller.bus, reader.feed, WAIT_S)
    used, size = map(int, re.search(r"stack: (\d+) of (\d+) bytes", controller.words).groups())
    assert 1000 < used <= worst < size
    names = tool("nm").split()
    assert not {"malloc", "calloc", "realloc", "free", "sbrk", "_sbrk"} & set(names)


def test_a_branch_is_not_taken_for_a_call(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[1] / "targets")
    import stack

    graph = stack.of_image(
        "00001000 <outer>:\n    1000:\tpush\t{r4, lr}\n    1002:\tbeq.n\t1006 <__bss_size>\n"
        "    1004:\tbl\t1008 <__data_size>\n    1006:\tpop\t{r4, pc}\n"
        "00001008 <inner>:\n    1008:\tsub\tsp, #16\n"
    )
    assert graph.calls["outer"] == {"inner"} and graph.worst("outer") == 8 + 16


@on_controller
def test_a_configuration_that_saddle_init_rejects_is_reported():
    with (
        pytest.raises(UserError, match=r"saddle_init: status 2, body_mass_kg"),
        qemu.running_controller(configuration({"body_mass_kg": math.nan})),
    ):
        pass


@on_controller
@pytest.mark.parametrize("bit", [0, 32 * 4 + 7])  # of the CRC, of the height
def test_a_damaged_settings_page_is_rejected(tmp_path, monkeypatch, capsys, bit):
    written = qemu.settings_page

    def damaged(*given):
        page = bytearray(written(*given))
        page[bit // 8] ^= 1 << bit % 8
        return bytes(page)

    monkeypatch.setattr(qemu, "settings_page", damaged)
    assert demo(tmp_path / "out", "--firmware", "qemu-m4") == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and "settings: the page is damaged" in printed


def test_a_silent_controller_is_reported_without_advice_about_the_host(
    tmp_path, monkeypatch, capsys, line
):
    @contextlib.contextmanager
    def silent(config):
        yield qemu.Controller(line[0])

    monkeypatch.setattr(qemu, "running_controller", silent)
    monkeypatch.setattr(exoskeleton, "SILENCE_S", 0.2)
    assert demo(tmp_path / "out", "--firmware", "qemu-m4") == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and "silent for 0.2 s on a line" in printed
    assert "saddlewalk-host" not in printed


def test_what_is_missing_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(qemu, "IMAGE", tmp_path / "image")
    for program in ("qemu-system-arm", "arm-none-eabi-gcc"):
        monkeypatch.setenv("PATH", str(tmp_path))
        assert demo(tmp_path / "out", "--firmware", "qemu-m4") == 2
        printed = capsys.readouterr().err
        assert printed.count("\n") == 1 and program in printed and "apt-get install" in printed
        (tmp_path / program).write_text("#!/bin/sh\n")
        (tmp_path / program).chmod(0o755)
    assert demo(tmp_path / "out", "--firmware", "qemu-m4") == 2
    assert "run `make controller`" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", [["--clock", "realtime"], ["--can", "udp"]])
def test_what_a_controller_cannot_do_is_rejected(tmp_path, capsys, option):
    assert demo(tmp_path / "out", "--firmware", "qemu-m4", *option) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and " ".join(option) in printed


@pytest.fixture
def line():
    """A bus and the other end of its line."""
    ours, theirs = socket.socketpair()
    with theirs, SlcanBus(ours, "a line") as bus:
        yield bus, theirs
        theirs.close()


def test_frames_go_over_a_line_as_text(line):
    bus, theirs = line
    bus.send(can.Message(arbitration_id=0x7A, data=b"\x01\xfe", is_extended_id=False))
    assert theirs.recv(100) == b"t07A201FE\r"
    theirs.sendall(b"t1403FE009A\rt7FF0\rt10")
    first, second = bus.recv(WAIT_S), bus.recv(WAIT_S)
    assert (first.arbitration_id, bytes(first.data)) == (0x140, b"\xfe\x00\x9a")
    assert (second.arbitration_id, bytes(second.data)) == (0x7FF, b"")
    assert bus.recv(0.01) is None
    theirs.sendall(b"01FF\r")
    assert text_of(bus.recv(WAIT_S)) == b"t1001FF\r"


@pytest.mark.parametrize(
    "text",
    ["", "t", "x1001FF", "t1002FF", "t8000", "t100900112233445566778899", "t1001F", "t1001é"],
)
def test_an_invalid_line_is_counted(line, text):
    bus, theirs = line
    assert frame_of(text.encode()) is None
    theirs.sendall(text.encode() + b"\rt1001FF\r")
    assert bus.recv(WAIT_S).arbitration_id == 0x100
    assert bus.malformed == 1


def test_a_disconnected_line_is_named(line):
    bus, theirs = line
    theirs.close()
    with pytest.raises(UserError, match="a line has ended"):
        bus.recv(WAIT_S)
    with pytest.raises(UserError, match="a line has ended"):
        bus.send(can.Message(arbitration_id=1, data=bytes(FRAME_LENGTH), is_extended_id=False))


def test_closing_a_bus_closes_the_line_cleanly(line):
    bus, theirs = line
    theirs.sendall(b"t1001FF\r" * 100)
    theirs.shutdown(socket.SHUT_WR)
    bus.shutdown()
    assert theirs.recv(100) == b"C\r"
