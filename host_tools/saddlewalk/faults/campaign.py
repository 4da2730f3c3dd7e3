"""Emulated walks with injected faults, and whether the firmware stayed safe.

In lockstep a walk has a simulated clock, in one process: frames and their codec, CRC, counters
and ages are those of the firmware's libraries, and nothing else decides when a frame arrives.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import can
import numpy as np

from saddlewalk import core
from saddlewalk.contract import OUTPUT_FRAMES, STANDING, TICK_S
from saddlewalk.emulation.closed_loop import STEPS_A_TICK
from saddlewalk.emulation.exoskeleton import plan_of
from saddlewalk.emulation.plans import planned
from saddlewalk.emulation.wearer import Plan, Wearer
from saddlewalk.faults.checker import STATES, Checker
from saddlewalk.faults.scenario import MEASURED, Fault, Line, Occurrence, Scenario, draw
from saddlewalk.firmware import config_of, ffi, library
from saddlewalk.physics.plants import POINT_MASS, PlantChoice
from saddlewalk.ticks import Messages, TickReader
from saddlewalk.transport import wire
from saddlewalk.workers import Workers, run_tasks

HEEL_STRIKE_RAD = 0.17
CLOCK_BEGIN_S = 4000.0  # so that the clock may jump back


@dataclass(frozen=True)
class Outcome:
    """Result of one walk. Ticks count from the one after the fault began, which is 0."""

    fault: Fault
    live: bool
    detected: int | None  # tick in which the firmware reported a problem
    state: str  # of STATES
    violations: tuple[str, ...]  # empty: safe
    blind: (
        int  # ticks with a level from data that are older than the limit, unknown to the firmware
    )
    forged: int  # accepted frames from other senders
    fell: bool


class Device:
    """The firmware as saddlewalk-host runs it, in this process and by the caller's clock."""

    def __init__(self, config: Any) -> None:
        """config: a saddle_config_t of saddlewalk.config."""
        lib = library()
        self.core = core.Core(config)  # for what a plan says of the time after it
        self._context = ffi().new("saddle_context_t *")
        self._inbox = ffi().new("saddle_inbox_t *")
        self._output = ffi().new("saddle_output_t *")
        self._health = ffi().new("saddle_wire_health_t *")
        self._frames = ffi().new("saddle_frame_t[]", OUTPUT_FRAMES)
        self._plan = ffi().new("saddle_plan_t *")
        self._reader = TickReader()
        self._ticks = self._tick_us = 0
        lib.saddle_init(self._context, config_of(config))
        lib.saddle_inbox_init(self._inbox, lib.SADDLE_SOURCE_NONE)

    def take(self, frame: can.Message, time_us: int) -> bool:
        """Receive a frame at time_us; returns whether it was accepted and not too late."""
        before = self._used()
        data = bytes(frame.data)
        library().saddle_inbox_take_frame(
            self._inbox, frame.arbitration_id, data, len(data), time_us
        )
        return self._used() != before

    def _used(self) -> int:
        return int(self._inbox.receiver.accepted - self._inbox.frames_late)

    def tick(self, time_us: int) -> Messages:
        """Run one tick; returns its messages as sent on CAN."""
        lib, output = library(), self._output
        self._tick_us = time_us
        lib.saddle_tick(self._context, lib.saddle_inbox_read(self._inbox, time_us), output)
        self._publish_health()
        lib.saddle_wire_encode_output(output, self._health, self._ticks % 16, self._frames)
        self._ticks += 1
        if output.faults & lib.SADDLE_FAULT_COMMAND_STALE and output.plan.mode == STANDING:
            lib.saddle_inbox_release(self._inbox)
        messages: Messages | None = None
        for frame in self._frames:
            message = can.Message(arbitration_id=frame.id, is_extended_id=False, data=frame.data)
            messages = self._reader.feed(message)
        assert messages is not None  # the frames of one output are a whole tick
        return messages

    def plan_at(self, since_s: float) -> Plan | None:
        """The plan so long after the last tick, as a controller of the joints has it."""
        time_us = self._tick_us + round(since_s * 1e6)
        library().saddle_plan_at(self._context, time_us, self._plan)
        return planned(self._plan[0], self.core)

    def _publish_health(self) -> None:
        health, inbox, receiver = self._health, self._inbox, self._inbox.receiver
        measured = inbox.input.measurement
        health.rejected_frames = library().saddle_inbox_rejected(inbox)
        health.input_age_us = (
            inbox.input.command_age_us,
            measured.com.age_us,
            measured.foot[0].age_us,
            measured.foot[1].age_us,
        )
        health.command_source = inbox.authority
        health.sender_clock = inbox.sender_clock
        for count in ("accepted", "malformed", "bad_crc", "bad_version", "bad_counter"):
            setattr(health, count, getattr(receiver, count))


def run(
    scenario: Scenario,
    index: int,
    number: int,
    seed: int,
    config: Any,
    plant: PlantChoice = POINT_MASS,
) -> tuple[Outcome, list[Messages]]:
    """Walk `number` with the scenario's fault `index` in lockstep: outcome and messages of all
    ticks.
    """
    random = np.random.default_rng([seed, index, number])
    fault = scenario.faults[index]
    occurrence = draw(fault, random)
    line = Line([occurrence], random)
    asked = EndlessWalk(float(random.uniform(*scenario.speed_m_s)))
    wearer = plant.wearer(config, seed=int(random.integers(2**32)))
    device, sender = Device(config), wire.Sender()
    checker = Checker(config, core.body_of(config), occurrence.begin_s)
    history = []
    for tick in range(round(scenario.duration_s / TICK_S)):
        walk_s = tick * TICK_S
        for name, signals in (asked.signals, _time_of(walk_s), *measured_signals(wearer)):
            line.send(sender.frame(name, **signals), walk_s)
        if not _stalled(occurrence, walk_s):
            for arrival in line.due(walk_s):
                came_s = _clock_s(occurrence, arrival.time_s)
                if device.take(arrival.frame, round(came_s * 1e6)):
                    checker.arrived(arrival, came_s)
            clock_s = _clock_s(occurrence, walk_s)
            history.append(device.tick(round(clock_s * 1e6)))
            checker.begin_s = max(occurrence.begin_s, _onset_s(occurrence, line))
            checker.tick(history[-1], walk_s, clock_s)
            wearer.follow(plan_of(history[-1], device.core), device.plan_at)
        for _ in range(STEPS_A_TICK):
            wearer.step()
    return outcome_of(fault, False, checker, wearer), history


@dataclass(frozen=True)
class EndlessWalk:
    """A walk command that never changes."""

    speed_m_s: float

    @property
    def signals(self) -> tuple[str, dict[str, float]]:
        values = {"MODE": 1, "SPEED": self.speed_m_s, "HEEL_STRIKE": HEEL_STRIKE_RAD}
        return "COMMAND", values


def measured_signals(wearer: Wearer) -> list[tuple[str, dict[str, float]]]:
    """The wearer's sensor readings, as CAN messages."""
    measured = wearer.measure()
    velocity = measured.velocity_m_s
    com = {"HEIGHT": measured.height_m, "VX": velocity.real, "VY": velocity.imag}
    feet = (
        (name, {"CONTACT": contact, "X": foot.real, "Y": foot.imag})
        for name, contact, foot in zip(MEASURED[1:], measured.contact, measured.feet_m, strict=True)
    )
    return [("MEASURED_COM", com), *feet]


def _time_of(walk_s: float) -> tuple[str, dict[str, float]]:
    return "MEASURED_TIME", {"TIME": round(walk_s * 1e6), "CODE": 0}


def _stalled(occurrence: Occurrence, walk_s: float) -> bool:
    stalls = occurrence.kind == "stall"
    return stalls and occurrence.begin_s <= walk_s < occurrence.begin_s + occurrence.strength


def _clock_s(occurrence: Occurrence, walk_s: float) -> float:
    """The firmware's clock."""
    jumped = occurrence.kind == "clock" and walk_s >= occurrence.begin_s
    return CLOCK_BEGIN_S + walk_s + (occurrence.strength if jumped else 0.0)


def _onset_s(occurrence: Occurrence, line: Line) -> float:
    """When the fault first took effect."""
    return line.onset_s if occurrence.is_of_frames and occurrence.kind != "none" else 0.0


def outcome_of(fault: Fault, live: bool, checker: Checker, wearer: Wearer) -> Outcome:
    return Outcome(
        fault=fault,
        live=live,
        detected=checker.detected,
        state=checker.state,
        violations=tuple(sorted(checker.violations)),
        blind=checker.blind,
        forged=checker.forged,
        fell=wearer.fallen,
    )


def campaign(
    scenario: Scenario,
    runs: int,
    seed: int,
    config: Any,
    workers: Workers,
    progress: Callable[[int], None],
    plant: PlantChoice = POINT_MASS,
) -> list[Outcome]:
    """`runs` walks with each fault, in lockstep. progress(walks done). Independent of `workers`."""
    image = core.config_bytes(config)
    tasks = [(scenario, index, runs, seed, image, plant) for index in range(len(scenario.faults))]
    return run_tasks(_work, tasks, workers, progress)


def _work(
    scenario: Scenario, index: int, runs: int, seed: int, image: bytes, plant: PlantChoice
) -> list[Outcome]:
    config = core.config_from(image)
    return [run(scenario, index, number, seed, config, plant)[0] for number in range(runs)]


@dataclass(frozen=True)
class Row:
    """All walks with one fault."""

    fault: Fault
    live: bool
    runs: int
    detected: int
    median_ticks: float  # to detection; NaN: none was detected
    max_ticks: float
    states: dict[str, int]  # of STATES, those reached
    unsafe: int  # walks with a violation
    violations: dict[str, int]
    blind: int  # ticks, maximum over the walks
    forged: int
    fell: int


def rows_of(outcomes: Iterable[Outcome]) -> list[Row]:
    """One row for each fault, in the order of the outcomes."""
    groups: dict[tuple[Fault, bool], list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault((outcome.fault, outcome.live), []).append(outcome)
    return [_row(fault, live, group) for (fault, live), group in groups.items()]


def _row(fault: Fault, live: bool, outcomes: list[Outcome]) -> Row:
    ticks = [outcome.detected for outcome in outcomes if outcome.detected is not None]
    states = Counter(outcome.state for outcome in outcomes)
    return Row(
        fault=fault,
        live=live,
        runs=len(outcomes),
        detected=len(ticks),
        median_ticks=float(np.median(ticks)) if ticks else math.nan,
        max_ticks=float(max(ticks, default=math.nan)),
        states={state: states[state] for state in STATES if states[state]},
        unsafe=sum(bool(outcome.violations) for outcome in outcomes),
        violations=dict(
            Counter(violation for outcome in outcomes for violation in outcome.violations)
        ),
        blind=max(outcome.blind for outcome in outcomes),
        forged=sum(outcome.forged for outcome in outcomes),
        fell=sum(outcome.fell for outcome in outcomes),
    )
