"""The host process when commands, buses, networks or the processor fail."""

import contextlib
import ctypes
import itertools
import os
import resource
import signal
import subprocess
import threading
import time
from pathlib import Path

import pytest
from can.interfaces.udp_multicast.utils import pack_message

from host_node import (
    COMMAND_HOLDS,
    MESSAGES_PER_TICK,
    QUICK,
    SILENCE_S,
    STANDING,
    TICK_S,
    WAIT_S,
    WALK,
    Host,
    LcmNode,
    own_lcm,
)
from private_test_network import (
    bring_up,
    in_private_network,
    rename_loopback,
    route,
    take_down,
    unroute,
)
from saddlewalk import paths
from saddlewalk.transport.bus import describe, private_udp
from saddlewalk.transport.lcm_types import plan_t, status_t
from saddlewalk.transport.wire import WIRE_VERSION, Receiver, frame_crc
from sanitizer import SANITIZED

pytestmark = pytest.mark.firmware

FAULT_COMMAND_STALE, LIMIT_SAFE_STOP = 1 << 14, 1 << 5
STAND = {"MODE": 0, "SPEED": 0.0, "HEEL_STRIKE": 0.0}
STANDING_MODE, STOPPING = 0, 3
FLOOD_HZ = 5000


def until(node: LcmNode, channel: str, is_so, ticks: int = 60):
    """The first message of a channel of which something is so; fails if none is in time."""
    for _ in range(ticks):
        message = node.take().get(f"SADDLEWALK_{channel}")
        if message is not None and is_so(message):
            return message
    raise AssertionError(f"{channel} never was so in {ticks} ticks")


def test_a_command_timeout_stops_the_walk_in_the_reported_tick():
    with Host("--lcm=none", "--clock=lockstep", *QUICK) as host:
        for _ in range(20):
            host.send("COMMAND", **WALK)
            host.measure()
            assert not host.tick()["HEALTH"]["LIMITS"] & LIMIT_SAFE_STOP
        ticks = []
        for _ in range(40):
            host.measure()
            ticks.append(host.tick())
        ages_ms = [tick["INPUTS"]["COMMAND_AGE"] for tick in ticks]
        assert ages_ms == [80 * (number + 1) for number in range(40)]
        stale = [bool(tick["SCORES_FORCE"]["FAULTS"] & FAULT_COMMAND_STALE) for tick in ticks]
        stopped = [bool(tick["HEALTH"]["LIMITS"] & LIMIT_SAFE_STOP) for tick in ticks]
        assert stale == stopped == [False] * 3 + [True] * 37
        modes = [tick["PLAN_EVENTS"]["MODE"] for tick in ticks]
        assert STOPPING in modes[3:] and modes[-1] == STANDING_MODE


def test_the_first_source_commands_and_the_other_is_counted():
    url = own_lcm()
    with Host("--lcm", url, COMMAND_HOLDS, *QUICK) as host:
        node = LcmNode(url)
        node.command(1, 0.8)
        until(node, "STATUS", lambda status: status.command_source == status_t.SOURCE_LCM)
        for _ in range(3):
            host.send("COMMAND", **WALK)
        status = until(node, "STATUS", lambda status: status.commands_ignored == 3)
        assert status.command_source == status.SOURCE_LCM
        until(node, "PLAN", lambda plan: plan.speed_m_s == pytest.approx(0.8))
        assert "commands: 1 applied, 0 unusable, 3 ignored, " in host.stop()


def test_another_source_may_command_after_the_walk_has_ended():
    """While the walk ends, a new source is ignored: the walk that is stopping stays stopped."""
    url = own_lcm()
    with Host("--lcm", url, *QUICK) as host:
        node = LcmNode(url)
        for _ in range(12):
            node.command(1, 0.8)
            node.take()
        sources = []
        while len(sources) < 80 and status_t.SOURCE_CAN not in sources:
            host.send("COMMAND", **WALK)
            heard = node.take()
            sources.append(heard["SADDLEWALK_STATUS"].command_source)
            if sources[-1] == status_t.SOURCE_LCM:
                assert heard["SADDLEWALK_PLAN"].speed_m_s < 0.81
                mode = heard["SADDLEWALK_PLAN"].mode
        assert sources[-1] == status_t.SOURCE_CAN and mode == plan_t.MODE_STANDING
        assert sources.count(status_t.SOURCE_LCM) > 4


@pytest.mark.parametrize("chosen", ["can", "lcm"])
def test_only_the_chosen_source_commands(chosen):
    url = own_lcm()
    with Host("--lcm", url, "--command-from", chosen, COMMAND_HOLDS) as host:
        node = LcmNode(url)
        node.take()
        host.send("COMMAND", **STAND)
        node.command(0, 0.0)
        status = until(node, "STATUS", lambda status: status.commands_obeyed == 1)
        status = until(node, "STATUS", lambda status: status.commands_ignored == 1)
        assert status.command_source == {"can": 1, "lcm": 2}[chosen]
        assert status.commands_obeyed == 1


def test_another_wire_version_is_rejected_and_reported_once():
    url = own_lcm()
    with Host("--lcm", url) as host:
        node = LcmNode(url)
        for _ in range(5):
            frame = host.sender.frame("COMMAND", **STAND)
            frame.data[6] = 3
            frame.data[0] = frame_crc(frame.arbitration_id, frame.data)
            host.bus.send(frame)
        status = until(node, "STATUS", lambda status: status.frames_bad_version == 5)
        assert (status.other_version, status.wire_version) == (3, WIRE_VERSION)
        host.stop(announced=("COMMAND of wire version 3 rejected: this firmware has version ",))


def test_frames_queued_during_a_stall_keep_their_age():
    with Host("--lcm=none") as host:
        host.tick()
        host.process.send_signal(signal.SIGSTOP)
        host.measure()
        time.sleep(1.0)
        while host.bus.recv(0.0):
            pass
        host.process.send_signal(signal.SIGCONT)
        tick = host.tick()
        ages_ms = [tick["INPUTS"][age] for age in ("COM_AGE", "LEFT_AGE", "RIGHT_AGE")]
        assert all(900 < age_ms < 2000 for age_ms in ages_ms)
        assert tick["TIMING"]["PERIOD"] == pytest.approx(0.32767)  # the end of the range
        assert int(host.stop().split(" late, ")[1].split()[0]) >= 10


def test_queued_lcm_commands_keep_their_age():
    url = own_lcm()
    with Host("--lcm", url) as host:
        node = LcmNode(url)
        node.command(0, 0.0)
        until(node, "STATUS", lambda status: status.commands_obeyed == 1)
        until(node, "STATUS", lambda status: status.tick > 5)
        host.process.send_signal(signal.SIGSTOP)
        time.sleep(0.05)
        node.command(0, 0.0)
        time.sleep(0.6)
        host.process.send_signal(signal.SIGCONT)
        status = until(node, "STATUS", lambda status: status.commands_obeyed == 2)
        assert status.command_age_us > 500_000
        assert status.missed_ticks >= 5


class Flood:
    """FLOOD_HZ frames a second from a thread: valid, repeated, damaged and foreign ones."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self.sent = 0

    def __enter__(self) -> "Flood":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        bus = self._host.bus
        datagrams = itertools.cycle([pack_message(frame) for frame in _frames(self._host)])
        begin_s = time.monotonic()
        while not self._over.wait(0.002):
            due = int((time.monotonic() - begin_s) * FLOOD_HZ)
            for datagram in itertools.islice(datagrams, due - self.sent):
                bus._sending.sendto(datagram, bus._address)
            self.sent = due


def _frames(host: Host) -> list:
    """Sixteen rounds, so that the counters of the good ones go on when they begin anew."""
    frames = []
    for _ in range(16):
        frames += [host.sender.frame(name, **values) for name, values in STANDING.items()]
        frames.append(host.sender.frame("COMMAND", **STAND))
        broken = host.sender.frame("COMMAND", **STAND)
        broken.data[3] ^= 1
        foreign = host.sender.frame("COMMAND", **STAND)
        foreign.arbitration_id = 0x7FF
        frames += [broken, foreign, frames[-1]]
    return frames


def flood(seconds: float) -> None:
    with Host("--lcm=none") as host:
        first = host.tick()["HEALTH"]["COUNTER"]
        with Flood(host) as sent:
            begin_s = time.monotonic()
            counters = []
            while time.monotonic() < begin_s + seconds:
                counters.append(host.tick()["HEALTH"]["COUNTER"])
            lasted_s = time.monotonic() - begin_s
        assert counters == [(first + 1 + i) % 16 for i in range(len(counters))]
        assert len(counters) == pytest.approx(lasted_s / TICK_S, abs=1.5)
        assert sent.sent > 0.9 * FLOOD_HZ * seconds
        summary = host.stop(announced=("the measurements come without MEASURED_TIME, ",))
        assert " 0 missed; " in summary
        came = [int(word) for word in summary.partition("frames: ")[2].split() if word.isdigit()]
        accepted, *rejected = came[:6]
        assert accepted > 0.5 * sent.sent and sum(rejected) > 0.3 * sent.sent
        assert accepted + sum(rejected) == pytest.approx(sent.sent, rel=0.01)


def test_a_flood_loses_no_tick():
    flood(3.0)


@pytest.mark.flood
def test_a_flood_of_a_minute_loses_no_tick():
    flood(60.0)


@in_private_network
def test_loopback_that_goes_down_and_comes_back():
    with Host("--lcm=udpm://239.255.76.67:7667?ttl=0", COMMAND_HOLDS) as host:
        host.tick()
        take_down()
        time.sleep(5 * TICK_S)
        bring_up()
        for _ in range(5):
            host.tick_frames()
        host.receiver = Receiver()
        host.send("COMMAND", **STAND)
        host.measure()
        assert [host.tick() for _ in range(2)][-1]["INPUTS"]["COM_AGE"] < 300
        summary = host.stop(
            announced=("CAN over UDP", "LCM is lost", "CAN over UDP", "LCM is back")
        )
        assert " 0 without link" not in summary and " 0 missed" in summary


@in_private_network
def test_an_lcm_route_that_is_lost_and_comes_back():
    url = own_lcm()
    with Host("--lcm", url, COMMAND_HOLDS) as host:
        assert f"LCM {url} on this machine;" in host.first_line
        node = LcmNode(url)
        node.take()
        unroute()
        ticks = [host.tick() for _ in range(5)]
        assert all(len(tick) == MESSAGES_PER_TICK for tick in ticks)
        assert node.take(SILENCE_S) == {}
        route()
        node.command(0, 0.0)
        until(node, "STATUS", lambda status: status.commands_obeyed == 1)
        status = until(node, "STATUS", lambda status: status.lcm_link == status.LINK_UP)
        assert status.lcm_losses == 1
        assert status.messages_not_sent >= 5 * 7
        host.stop(announced=("LCM is lost: ", "LCM is back"))


def full_pipe() -> tuple[int, int]:
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writing, bytes(4096))
    os.set_blocking(writing, True)
    return reading, writing


@pytest.mark.parametrize("read", [True, False])
def test_the_host_goes_on_if_nobody_reads_its_output(read):
    """Neither a full pipe nor one without a reader holds up a tick."""
    reading, writing = full_pipe()
    with Host("--lcm=none", stderr=writing) as host:
        if not read:
            os.close(reading)
        frame = host.sender.frame("COMMAND", **STAND)
        frame.data[6] = 3
        frame.data[0] = frame_crc(frame.arbitration_id, frame.data)
        host.bus.send(frame)
        ticks = [host.tick() for _ in range(3)]
        assert ticks[-1]["RECEIVED"]["BAD_VERSION"] == 1
    os.close(writing)
    if read:
        os.close(reading)


def may_schedule() -> bool:
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        return False
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    return True


def test_fifo_and_locked_memory():
    if not may_schedule():
        pytest.skip("SCHED_FIFO is not permitted here")
    with Host("--lcm=none", "--fifo=20") as host:
        assert "; SCHED_FIFO 20; memory locked\n" in host.first_line
        assert os.sched_getscheduler(host.process.pid) == os.SCHED_FIFO
        status = Path(f"/proc/{host.process.pid}/status").read_text()
        assert SANITIZED or int(status.partition("VmLck:")[2].split()[0]) > 1000  # kB
        host.stop()


def without_rights() -> None:
    """As an ordinary user has them, even where the tests run as root."""
    pr_capbset_drop, cap_ipc_lock, cap_sys_nice = 24, 14, 23
    libc = ctypes.CDLL(None)
    for right in (cap_ipc_lock, cap_sys_nice):
        libc.prctl(pr_capbset_drop, right, 0, 0, 0)
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
    resource.setrlimit(resource.RLIMIT_MEMLOCK, (0, 0))


def test_missing_privileges_are_reported_and_the_host_goes_on():
    command = [paths.built("bin/saddlewalk-host"), "--lcm=none", "--can=udp", "--fifo=20"]
    process = subprocess.Popen(command, stdout=-1, stderr=-1, text=True, preexec_fn=without_rights)
    first_line = process.stdout.readline()
    process.terminate()
    _, errors = process.communicate(timeout=WAIT_S)
    assert process.returncode == 0 and "FIFO" not in first_line
    assert "--fifo 20: Operation not permitted: " in errors
    assert SANITIZED or "memory cannot be locked (" in errors
    assert errors.count("\n") == (1 if SANITIZED else 2)


@in_private_network
def test_a_named_interface_is_reported_as_leaving_this_machine():
    """Loopback under another name, in place of another interface."""
    spec = private_udp()
    with Host("--lcm=none", spec=f"{spec}@lo") as host:
        assert f"CAN UDP {spec[4:]}@lo on loopback;" in host.first_line
    take_down()
    rename_loopback("d0")
    command = [paths.built("bin/saddlewalk-host"), "--lcm=none", "--can", f"{spec}@d0"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "sudo ip link set d0 up" in done.stderr
    bring_up("d0")
    with Host("--lcm=none", spec=f"{spec}@d0") as host:
        assert describe(host.bus) == f"UDP {spec[4:]} on d0: leaves this machine"
        assert f"CAN UDP {spec[4:]}@d0, which leaves this machine; " in host.first_line
        assert "; commands: anyone on the network (CAN over UDP); " in host.first_line
        assert len(host.tick()) == MESSAGES_PER_TICK
