"""Walks in real time with faults in the emulated wearer's frames or in the host process."""

import math
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import can
import numpy as np

from saddlewalk import core
from saddlewalk.config import host_arguments
from saddlewalk.emulation.exoskeleton import Exoskeleton, Observer, Tick
from saddlewalk.emulation.host import running_host
from saddlewalk.emulation.wearer import Body, Wearer
from saddlewalk.faults.campaign import HEEL_STRIKE_RAD, Outcome, outcome_of
from saddlewalk.faults.checker import Checker
from saddlewalk.faults.scenario import INPUTS, KINDS, Line, Occurrence, Scenario, draw
from saddlewalk.planning.schedule import schedule_of
from saddlewalk.transport import wire
from saddlewalk.transport.bus import open_bus, private_udp
from saddlewalk.transport.lcmbus import open_lcm
from saddlewalk.workers import Workers, run_tasks

AT_ONCE = 4  # processes that mostly sleep, and must not wait for each other
SLACK_S = 0.1  # from the firmware's tick until it is checked
STALL_MAX_S = 2.0  # a firmware that is silent for longer ends the wearer's walk
OF_FRAMES_ONLY = ("duplicate", "flip", "spoof")  # faults of frames; commands are sent by LCM
_AGES = dict(zip(INPUTS, ("COMMAND_AGE", "COM_AGE", "LEFT_AGE", "RIGHT_AGE"), strict=True))


class FaultyBus:
    """A bus that sends frames through a Line. Delayed ones are sent at the next call."""

    def __init__(self, bus: can.BusABC, line: Line, now_s: Callable[[], float]) -> None:
        self._bus, self._line, self._now_s = bus, line, now_s
        self.sent_s: dict[str, float] = {}  # when each message was last sent
        self.channel_info = bus.channel_info

    def send(self, frame: can.Message) -> None:
        self._line.send(frame, self._now_s())
        self._forward()

    def recv(self, timeout: float | None = None) -> can.Message | None:
        self._forward()
        return self._bus.recv(timeout)

    def _forward(self) -> None:
        for arrival in self._line.due(self._now_s()):
            self._bus.send(arrival.frame)
            self.sent_s[wire.known_name(arrival.frame.arbitration_id)] = self._now_s()


class FaultyLcm:
    """LCM that sends commands through a Line. They have no CRC and no counter."""

    def __init__(self, lcm: Any, line: Line, now_s: Callable[[], float]) -> None:
        self._lcm, self._line, self._now_s = lcm, line, now_s
        self._sender = wire.Sender()

    def publish(self, channel: str, data: bytes) -> None:
        from saddlewalk.transport.lcm_types import command_turn_t

        if channel != "SADDLEWALK_COMMAND_TURN":
            self._lcm.publish(channel, data)
            return
        command = command_turn_t.decode(data)
        numbers = {
            "SPEED": command.speed_m_s,
            "HEEL_STRIKE": command.heel_strike_rad,
            "TURN_RATE": command.turn_rate_rad_s,
        }
        self._line.send(self._sender.frame("COMMAND", MODE=command.mode, **numbers), self._now_s())
        for arrival in self._line.due(self._now_s()):
            if arrival.forged:  # UDP drops corrupted datagrams, and there is no other sender
                continue
            signals = wire.signals(arrival.frame)
            command.mode, command.speed_m_s = int(signals["MODE"]), signals["SPEED"]
            command.heel_strike_rad = signals["HEEL_STRIKE"]
            command.turn_rate_rad_s = signals["TURN_RATE"]
            self._lcm.publish(channel, command.encode())


def faulty(
    bus: can.BusABC, lcm: Any, occurrences: Sequence[Occurrence], seed: int
) -> tuple[FaultyBus, FaultyLcm]:
    """Bus and LCM with all of these faults, starting now."""
    begin_s = time.monotonic()

    def now_s() -> float:
        return time.monotonic() - begin_s

    frames, commands = (Line(occurrences, np.random.default_rng([seed, way])) for way in range(2))
    return FaultyBus(bus, frames, now_s), FaultyLcm(lcm, commands, now_s)


class _LiveChecker(Observer):
    """The checker of a live walk: ages are those that the firmware reports, but none is younger
    than the last frame that was sent."""

    def __init__(self, checker: Checker, occurrence: Occurrence, lines: tuple[Line, ...]) -> None:
        self.sent_s: dict[str, float] = {}
        self._checker, self._happening, self._lines = checker, occurrence, lines
        self._begin_s = time.monotonic()

    def now_s(self) -> float:
        return time.monotonic() - self._begin_s

    def tick(self, tick: Tick, wearer: Wearer) -> None:
        now_s, records = self.now_s(), self._checker.records
        for name, age in _AGES.items():
            came_s = now_s - tick.messages["INPUTS"][age] / 1000
            if name != "COMMAND":
                came_s = min(came_s, self.sent_s.get(name, -math.inf) + SLACK_S)
            records[name].came_s, records[name].born_s, records[name].usable_s = (
                came_s,
                now_s,
                now_s,
            )
        self._checker.walk_commanded = tick.plan is not None and not self._is_misled()
        self._checker.begin_s = self._onset_s()
        self._checker.tick(tick.messages, now_s, now_s)

    def _is_misled(self) -> bool:
        """A fault may have changed a command to stand."""
        occurrence = self._happening
        return occurrence.kind in ("noise", "bias") and "COMMAND" in occurrence.messages

    def _onset_s(self) -> float:
        if not self._happening.is_of_frames or self._happening.kind == "none":
            return self._happening.begin_s
        return min(line.onset_s for line in self._lines)


def live_walks(scenario: Scenario, each: int) -> list[tuple[int, int]]:
    """(fault index, number): `each` walks of each class, over the range of its strengths."""
    walks = []
    for kind in dict.fromkeys(fault.kind for fault in scenario.faults):
        indices = [
            index
            for index, fault in enumerate(scenario.faults)
            if fault.kind == kind and _can_happen(kind, fault.strength)
        ]
        if indices:
            chosen = np.linspace(len(indices) - 1, 0, each).round().astype(int)
            walks += [(indices[place], number) for number, place in enumerate(chosen)]
    return walks


def _can_happen(kind: str, strength: float) -> bool:
    return kind != "clock" and not (kind == "stall" and strength > STALL_MAX_S)


def live_campaign(
    scenario: Scenario, each: int, seed: int, config: Any, progress: Callable[[int], None]
) -> list[Outcome]:
    """AT_ONCE walks at a time, each on its own bus and LCM group. progress(walks done)."""
    image = core.config_bytes(config)
    tasks = [(scenario, *walk, seed, image) for walk in live_walks(scenario, each)]
    return run_tasks(_work, tasks, Workers(AT_ONCE), progress)


def _work(scenario: Scenario, index: int, number: int, seed: int, image: bytes) -> list[Outcome]:
    return [run_live(scenario, index, number, seed, core.config_from(image))]


def run_live(scenario: Scenario, index: int, number: int, seed: int, config: Any) -> Outcome:
    """Walk `number` with the scenario's fault `index`, with saddlewalk-host, by the wall clock.

    Raises UserError if the host or LCM cannot run.
    """
    random = np.random.default_rng([seed, index, number, 1])
    fault = scenario.faults[index]
    occurrence = draw(fault, random)
    if occurrence.kind in OF_FRAMES_ONLY:
        measured = tuple(name for name in KINDS[occurrence.kind].messages if name != "COMMAND")
        occurrence = replace(occurrence, messages=measured)
    frames, commands = (Line([occurrence], random) for _ in range(2))
    wearer = Wearer(Body.of(config), seed=int(random.integers(2**32)))
    speed_m_s = float(random.uniform(*scenario.speed_m_s))
    checker = Checker(config, core.body_of(config), math.inf)
    spec = private_udp()
    url = f"udpm://239.255.76.67:{spec.rpartition(':')[2]}?ttl=0"
    options = (f"--can={spec}", f"--lcm={url}", *host_arguments(config))
    with running_host(*options) as host, open_bus(spec) as bus:
        observer = _LiveChecker(checker, occurrence, (frames, commands))
        faulty_bus = FaultyBus(bus, frames, observer.now_s)
        observer.sent_s = faulty_bus.sent_s
        exoskeleton = Exoskeleton(
            faulty_bus,
            wearer,
            config,
            schedule_of([(0.0, speed_m_s)], HEEL_STRIKE_RAD),
            FaultyLcm(open_lcm(url), commands, observer.now_s),
            [observer],
        )
        stalls = _stalls(host, occurrence)
        exoskeleton.run("realtime", scenario.duration_s)
        for stall in stalls:
            stall.join()
    return outcome_of(fault, True, checker, wearer)


def _stalls(host: subprocess.Popen[str], occurrence: Occurrence) -> list[threading.Timer]:
    """Timers that stop the process and resume it."""
    if occurrence.kind != "stall":
        return []
    begin_s, end_s = occurrence.begin_s, occurrence.begin_s + occurrence.strength
    timers = [
        threading.Timer(begin_s, host.send_signal, [signal.SIGSTOP]),
        threading.Timer(end_s, host.send_signal, [signal.SIGCONT]),
    ]
    for timer in timers:
        timer.start()
    return timers
