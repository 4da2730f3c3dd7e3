"""A walk in real time: the same each time, and a computer that did not keep up is named."""

import re
import signal
import subprocess
import sys
import time

import pytest

from host_node import own_lcm
from saddlewalk.cli import main
from saddlewalk.contract import RIGHT, STARTING, TICK_S
from saddlewalk.emulation.exoskeleton import Exoskeleton, Observer
from saddlewalk.emulation.host import running_host
from saddlewalk.emulation.pace import Pace
from saddlewalk.emulation.paced_ticks import ARRIVALS, WAKE_UP_S, PacedTicks
from saddlewalk.emulation.punctuality import Punctuality, Stall
from saddlewalk.errors import UserError
from saddlewalk.transport.bus import open_bus, private_udp
from saddlewalk.transport.lcmbus import open_lcm

pytestmark = pytest.mark.firmware


class Ticking:
    """A bus on which a tick comes every 80 ms, of which some are lost; a frame is its number.

    Number 0 waits when a PacedTicks begins, and ARRIVALS more set its clock.
    """

    def __init__(self, lost: tuple[int, ...] = ()) -> None:
        self._begin_s, self._next, self._lost = time.monotonic(), 0, lost

    def recv(self, timeout: float) -> int | None:
        due_s = self._begin_s + self._next * TICK_S
        time.sleep(max(0.0, min(timeout, due_s - time.monotonic())))
        if time.monotonic() < due_s:
            return None
        self._next += 1
        return self._next - 1

    def hear(self, number: int):
        return None if number in self._lost else {"HEALTH": {"COUNTER": number % 16}, "is": number}


def places(bus: Ticking, wake_ups: int, stalled: tuple[int, float] = (0, 0.0)) -> dict[int, int]:
    """At which wake-up each tick was handed out; stalled: before which wake-up, for how long."""
    ticks = PacedTicks(bus, bus.hear, 1.0)
    taken = {}
    for wake_up in range(wake_ups):
        if wake_up == stalled[0]:
            time.sleep(stalled[1])
        for messages in ticks.at(wake_up, ticks.begin_s + wake_up * WAKE_UP_S):
            taken[messages["is"]] = wake_up
    return taken


def test_each_tick_has_its_own_wake_up():
    assert places(Ticking(), 41) == {ARRIVALS + n: 8 * n for n in range(1, 6)}


def test_after_a_stall_ticks_wait_for_their_time():
    """The walk catches up; it does not follow plans of a time that is yet to come for it."""
    assert places(Ticking(), 57, (12, 0.2)) == {ARRIVALS + n: 8 * n for n in range(1, 8)}


def test_a_lost_tick_does_not_shift_others():
    expected = {ARRIVALS + n: 8 * n for n in range(1, 6)}
    del expected[6]
    assert places(Ticking(lost=(6,)), 41) == expected


def test_no_ticks_are_an_error():
    bus = Ticking(lost=tuple(range(10)))
    with pytest.raises(UserError):
        PacedTicks(bus, bus.hear, 0.2)


class Start(Observer):
    """When the walk started, and on which foot."""

    def __init__(self) -> None:
        self.seen: tuple[float, int] | None = None

    def tick(self, tick, wearer) -> None:
        if self.seen is None and tick.plan and tick.plan.mode == STARTING:
            self.seen = round(tick.time_s, 2), tick.plan.support


@pytest.mark.parametrize(("clock", "seed"), [("lockstep", 0), *(("realtime", n) for n in range(4))])
def test_a_walk_starts_at_the_same_tick_on_the_same_foot(clock, seed):
    """Whatever the clock, the noise, and how long the firmware has been running."""
    import argparse

    from saddlewalk.commands.emulate import wearer_of
    from saddlewalk.config import load_config
    from saddlewalk.emulation.wearer import Noise
    from saddlewalk.physics.plants import PlantChoice
    from saddlewalk.planning.schedule import schedule_of

    config = load_config(argparse.Namespace(height=None, mass=None, config=None))
    wearer = wearer_of(argparse.Namespace(push=None, seed=seed), PlantChoice(), config, Noise())
    spec, url, start = private_udp(), own_lcm(), Start()
    with running_host(f"--can={spec}", f"--lcm={url}", f"--clock={clock}"), open_bus(spec) as bus:
        time.sleep(0.02 * seed)
        schedule = schedule_of([(0.0, 0.0), (1.0, 0.8)], 0.17)
        exoskeleton = Exoskeleton(bus, wearer, config, schedule, open_lcm(url), [start])
        exoskeleton.run(clock, 1.5)
    assert start.seen == (1.04, RIGHT)


def test_a_computer_that_is_busy_is_lent_the_time(monkeypatch):
    """Ticks of 80 ms, one of which takes 0.5 s; the walk goes on from there."""
    now_s, slept_s = 10.0, []

    def sleep(for_s):
        nonlocal now_s
        slept_s.append(for_s)
        now_s += for_s

    monkeypatch.setattr(time, "monotonic", lambda: now_s)
    monkeypatch.setattr(time, "sleep", sleep)
    pace = Pace()
    for work_s in (0.01, 0.0, 0.5, 0.03):
        now_s += work_s
        pace.wait()
    assert slept_s == pytest.approx([0.07, 0.08, 0.05])
    assert pace.lent_s == pytest.approx(0.42)
    assert pace.words() == "slower than real time by 0.42 s, as this computer was busy"
    assert Pace().words() == "in real time"


def test_stalls_are_kept_with_their_time_and_the_longest_before_a_fall_is_found():
    punctuality = Punctuality()
    late_s = {1.0: 0.01, 1.01: 0.3, 1.02: 0.29, 1.3: 0.09, 1.4: 0.02, 4.0: 0.1, 4.2: 0.0, 8.0: 0.5}
    for time_s, late in late_s.items():
        punctuality.measured(time_s, late)
    assert punctuality.stalls == [Stall(1.01, 0.3), Stall(4.0, 0.1), Stall(8.0, 0.5)]
    assert punctuality.stall_before(4.1) == Stall(4.0, 0.1)
    assert punctuality.stall_before(4.0) == Stall(1.01, 0.3)
    assert punctuality.stall_before(7.5) is None
    for now_s in (10.0, 10.08, 10.24, 10.3):
        punctuality.ticked(now_s)
    assert punctuality.words() == (
        "measurements at most 500 ms late, 3 stalls, ticks at most 160 ms apart"
    )


def stopped_demo(folder, until: str, *options: str) -> tuple[int, str]:
    """Status and output of a demo whose process stands still for 0.5 s after that word."""
    program = [sys.executable, "-c", "from saddlewalk.cli import main; raise SystemExit(main())"]
    ports = ["--can", private_udp(), "--lcm", own_lcm(), "--out", str(folder)]
    command = [*program, "demo", *options, *ports]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        while until not in process.stdout.readline():
            assert process.poll() is None
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.5)
        process.send_signal(signal.SIGCONT)
        printed = process.stdout.read()
    return process.returncode, printed


def test_a_paced_walk_that_stood_still_goes_on_as_if_it_had_not(tmp_path):
    walk = ["--speed", "1.2", "--duration", "4"]
    status, printed = stopped_demo(tmp_path / "paced", "starting", *walk)
    late_s = float(re.search(r"slower than real time by (\S+) s", printed)[1])
    assert status == 0 and late_s > 0.35
    ports = ["--can", private_udp(), "--lcm", own_lcm(), "--out", str(tmp_path / "whole")]
    assert main(["demo", *walk, "--clock", "lockstep", *ports]) == 0
    one, two = ((tmp_path / name / "walk.csv").read_bytes() for name in ("paced", "whole"))
    assert one == two


def test_a_fall_after_a_stall_mentions_the_stall(tmp_path):
    walk = ["--clock", "realtime", "--speed", "1.2", "--duration", "4.5", "--push", "80@3:90"]
    status, printed = stopped_demo(tmp_path, "push of", *walk)
    assert status == 1
    stalled = re.search(
        r"BAD  the wearer fell at (\S+) s, (\S+) s after this computer had stalled the wearer's "
        r"process for (\S+) s",
        printed,
    )
    fell_s, before_s, for_s = map(float, stalled.groups())
    assert fell_s - before_s == pytest.approx(3.1, abs=0.15) and for_s >= 0.4
