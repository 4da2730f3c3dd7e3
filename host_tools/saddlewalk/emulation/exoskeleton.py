"""The live node: an emulated wearer on the firmware's CAN bus and on LCM."""

import importlib
import itertools
import math
import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import can
import numpy as np

from saddlewalk import core
from saddlewalk.contract import LEFT, RIGHT, STAND, STANDING, TICK_S, WALK
from saddlewalk.emulation import plans
from saddlewalk.emulation.pace import Pace
from saddlewalk.emulation.paced_ticks import WAKE_UP_S, PacedTicks
from saddlewalk.emulation.punctuality import Punctuality
from saddlewalk.emulation.treadmill import Treadmill
from saddlewalk.emulation.wearer import STEP_S, Measurement, Plan, PlanAt, Skeleton, Wearer
from saddlewalk.errors import UserError
from saddlewalk.lockstep_host import LockstepHost
from saddlewalk.planning.schedule import Schedule
from saddlewalk.ticks import PLAN_MESSAGES, FrameBus, Messages, Signals, TickReader, next_tick
from saddlewalk.transport.authentication import Authenticator
from saddlewalk.transport.wire import TIMES, Sender, identifier

SILENCE_S = 3.0
START_TICKS = 125  # without following commands, after which the walk is given up: 10 s
RESEND_S = 0.25
COMMAND_S = 1.5 * TICK_S  # time from the last command to the next one, if no tick comes


@dataclass(frozen=True)
class Tick:
    """One tick of the firmware: its messages by name, and the time in the wearer's walk."""

    time_s: float
    messages: Messages
    plan: Plan | None


class Observer:
    """Callbacks during a walk; the base class does nothing."""

    finished = False  # True: end the walk now

    def frame(self, frame: can.Message) -> None:
        """Every frame sent (is_rx False) and received (True)."""

    def tick(self, tick: Tick, wearer: Wearer) -> None:
        """After the firmware's tick has come and before the wearer moves on."""

    def poll(self) -> None:
        """Called at least once a tick, to read other inputs."""


def plan_of(messages: Messages, own_core: core.Core) -> Plan | None:
    """The plan of one tick; None if the tick failed or a number of it is not available.

    own_core: any with its configuration, for what the plan says between ticks.
    """
    numbers = [value for part in PLAN_MESSAGES for value in messages[part].values()]
    if not messages["PLAN_STEP"]["VALID"] or not all(map(math.isfinite, numbers)):
        return None
    return plans.plan_of(output_of(messages), own_core)


def output_of(messages: Messages) -> Any:
    """The saddle_output_t as far as a wearer needs it: plan, XCoM deviation and recovery step."""
    output = core.ffi().new("saddle_output_t *")
    plan, verdict = output.plan, output.verdict
    step, events, pendulum, way = (
        messages[f"PLAN_{part}"] for part in ("STEP", "EVENTS", "REFERENCE_COM", "WAY")
    )
    plan.valid, plan.mode = True, int(events["MODE"])
    plan.support, plan.phase = int(step["SUPPORT"]), int(step["PHASE"])
    plan.speed_m_s, plan.acceleration_m_s2 = messages["PLAN_ANKLE"]["SPEED"], pendulum["RATE"]
    plan.step_length_m = step["STEP_LENGTH"]
    plan.step_width_m = messages["PLAN_LAST_STEP"]["WIDTH"]
    plan.time_to_via_point_s = events["TIME_TO_VIA_POINT"]
    plan.time_to_toe_off_s = events["TIME_TO_TOE_OFF"]
    plan.leg_length_m = messages["PLAN_LANDING"]["LEG_LENGTH"]
    plan.foot_pitch_rad = [messages["PLAN_PITCH"][side] for side in ("LEFT", "RIGHT")]
    plan.foot_yaw_rad = [messages["PLAN_YAW"][side] for side in ("LEFT", "RIGHT")]
    plan.pelvis_yaw_rad, plan.heading_rad = messages["PLAN_YAW"]["PELVIS"], way["HEADING"]
    plan.curvature_1_m = [way[f"CURVATURE_{part}"] for part in ("BEHIND", "AHEAD")]
    for vector, name in (
        (plan.com_m, "PLAN_COM"),
        (plan.com_velocity_m_s, "PLAN_COM_VELOCITY"),
        (plan.foot_m[LEFT], "PLAN_LEFT"),
        (plan.foot_m[RIGHT], "PLAN_RIGHT"),
        (plan.swing_velocity_m_s, "PLAN_SWING"),
        (plan.landing_m, "PLAN_LANDING"),
        (plan.last_step_m, "PLAN_LAST_STEP"),
        (verdict.recovery.landing_m, "RECOVERY"),
        (verdict.xcom_deviation_m, "VERDICT"),
    ):
        _fill(vector, messages[name])
    verdict.recovery.found = bool(messages["RECOVERY"]["FOUND"])
    verdict.recovery.foot = int(messages["RECOVERY"]["FOOT"])
    return output


def _fill(vector: Any, signals: Signals) -> None:
    """From the signals X, VX or XCOM_DEVIATION_X, and so on."""
    for name, value in signals.items():
        if name[-1] in "XYZ" and hasattr(vector, name[-1].lower()):
            setattr(vector, name[-1].lower(), value)


class Exoskeleton:
    """Sends the wearer's measurements, follows the plan that comes back, publishes the truth.

    A walk in progress is stopped first: ours begins when the firmware plans to stand.
    config: the firmware's saddle_config_t.
    fresh: the firmware was started for this walk and has not received anything yet.
    if_silent: what the user can do when no firmware answers.
    key: authenticates the commands, which then go by CAN alone.
    joint_core: of a controller that drives the joints between two ticks. It hears the same frames,
    so in lockstep it has the firmware's plan at every instant, and may do without the bus.
    treadmill: the wearer walks on it; None: on a floor.
    """

    def __init__(
        self,
        bus: FrameBus,
        wearer: Wearer,
        config: Any,
        schedule: Schedule,
        lcm: Any = None,
        observers: Iterable[Observer] = (),
        fresh: bool = True,
        if_silent: str = "",
        key: bytes | None = None,
        joint_core: LockstepHost | None = None,
        treadmill: Treadmill | None = None,
    ) -> None:
        self.reader = TickReader()
        self.frames_sent = 0
        self.ticks = 0
        self._sets = 0
        self.health: dict[str, float] = {}  # the newest
        self.mode: int | None = None  # of the newest plan; None without one
        self.punctuality: Punctuality | None = None  # in real time
        self.pace: Pace | None = None  # if that is kept
        self._bus, self._lcm, self._wearer, self._schedule = bus, lcm, wearer, schedule
        self._observers = tuple(observers)
        self._fresh, self._if_silent = fresh, if_silent
        self._sender = Sender()
        self._authenticator = None if key is None else Authenticator(key)
        self._own_core = core.Core(config)
        self._joint_core = joint_core
        self._treadmill = treadmill
        self._codes_demanded = False
        self._begun = False
        self._ignored_ticks = 0  # number of successive ticks
        self._pushed_n_s = 0j

    def run(self, clock: str, duration_s: float) -> None:
        """Walk for duration_s by the clock `realtime`, or in `lockstep`, or `paced`: in lockstep no
        faster than real time.

        Raises UserError if the firmware is silent or plans no walk.
        """
        if clock == "realtime":
            self._run_realtime(duration_s)
        else:
            self.pace = Pace() if clock == "paced" else None
            self._run_lockstep(duration_s)

    def _run_lockstep(self, duration_s: float) -> None:
        """One set of measurements, one tick, 80 ms of physics, as fast as the firmware answers."""
        while self._goes_on(duration_s):
            self._take(self._exchange())
            self._advance(round(TICK_S / STEP_S))
            self._publish_truth()
            self._poll()
            if self.pace:
                self.pace.wait()
        self._begun = False
        self._send_command_frame(self._wearer.time_s)

    def _run_realtime(self, duration_s: float) -> None:
        """By the wall clock, on absolute deadlines; each command answers a tick, as in lockstep."""
        importlib.import_module("saddlewalk.transport.lcm_types")  # which takes longer than a tick
        try:
            ticks = PacedTicks(self._bus, self._hear, SILENCE_S)
        except UserError as error:
            raise self._silent() from error
        punctuality = self.punctuality = Punctuality()
        heard_s, commanded_s = time.monotonic(), -math.inf
        for wake_up in itertools.count():
            if not self._goes_on(duration_s):
                break
            deadline_s = ticks.begin_s + wake_up * WAKE_UP_S
            taken = ticks.at(wake_up, deadline_s)
            now_s = time.monotonic()
            for messages in taken:
                punctuality.ticked(now_s)
                self._take(messages)
            punctuality.measured(self._wearer.time_s, now_s - deadline_s)
            self._advance(round(WAKE_UP_S / STEP_S))
            self._send_measurement(WAKE_UP_S)
            self._publish_truth()
            if taken:
                heard_s = now_s
            elif now_s - heard_s > SILENCE_S:
                raise self._silent()
            if taken or now_s - commanded_s > COMMAND_S:
                commanded_s = now_s
                self._command_in_real_time()
                self._poll()
        self._begun = False
        self._command_in_real_time()

    def _goes_on(self, duration_s: float) -> bool:
        finished = any(observer.finished for observer in self._observers)
        return not finished and self._wearer.time_s < duration_s - STEP_S / 2

    def _silent(self) -> UserError:
        silent = f"the firmware has been silent for {SILENCE_S:g} s on {self._bus.channel_info}"
        return UserError(": ".join(filter(None, [silent, self._if_silent])))

    def _exchange(self) -> Messages:
        """Send what is measured and wait for the firmware's tick.

        Firmware that had another wearer before rejects the first set, whose counters are new; so
        the set is repeated until the first answer. Fresh firmware would tick for each.
        """
        deadline_s = time.monotonic() + SILENCE_S
        patience_s = SILENCE_S if self.ticks or self._fresh else RESEND_S
        while time.monotonic() < deadline_s:
            self._send_command_frame(self._wearer.time_s)
            self._send_measurement(TICK_S)
            messages = next_tick(self._bus, self._hear, patience_s)
            if messages:
                return messages
        raise self._silent()

    def _hear(self, frame: can.Message) -> Messages | None:
        for observer in self._observers:
            observer.frame(frame)
        self._codes_demanded |= frame.arbitration_id == identifier("SESSION")
        if self._authenticator:
            self._authenticator.hear(frame)
        return self.reader.feed(frame)

    def _take(self, messages: Messages) -> None:
        plan = plan_of(messages, self._own_core)
        self._begun = self._begun or (plan is not None and plan.mode == STANDING)
        plan = plan if self._begun else None
        self.ticks += 1
        self._ignored_ticks = self._ignored_ticks + 1 if self._ignores_command(plan) else 0
        if self._ignored_ticks > START_TICKS:
            raise self._wrong_response()
        self.health = messages["HEALTH"]
        self.mode = plan.mode if plan else None
        self._wearer.follow(plan, self._plan_at(plan))
        tick = Tick(self._wearer.time_s, messages, plan)
        for observer in self._observers:
            observer.tick(tick, self._wearer)

    def _plan_at(self, plan: Plan | None) -> PlanAt | None:
        """That of the joint controller's core, until the next tick; it must agree with `plan`."""
        joint_core, own_core = self._joint_core, self._own_core
        if joint_core is None or plan is None:
            return None
        own = plans.planned(joint_core.plan_at(0.0)[0], own_core)
        if own is None or not own.agrees(plan):
            raise UserError(
                f"the firmware on {self._bus.channel_info} plans differently from the joint "
                "controller, which received the same frames: restart it with the same configuration"
            )
        return lambda since_s: plans.planned(joint_core.plan_at(since_s)[0], own_core)

    def _wrong_response(self) -> UserError:
        options = "--command-key" if self._codes_demanded else "--clock and --lcm"
        return UserError(
            f"the firmware on {self._bus.channel_info} answers but does not follow the commands: "
            f"give both the same {options}"
        )

    def _ignores_command(self, plan: Plan | None) -> bool:
        """The firmware does not stand before the walk, or stands despite a walk command."""
        to_walk = self._command(self._wearer.time_s)["MODE"] == WALK
        return not self._begun or (to_walk and plan is not None and plan.mode == STANDING)

    def _advance(self, steps: int) -> None:
        for _ in range(steps):
            self._wearer.step()

    def _poll(self) -> None:
        for observer in self._observers:
            observer.poll()

    def _send(self, frame: can.Message) -> None:
        frame.is_rx, frame.timestamp = False, time.time()
        try:
            self._bus.send(frame)
        except (
            can.CanOperationError
        ):  # no room: the frame is lost, and the firmware sees that by the age
            return
        self.frames_sent += 1
        if self._joint_core:
            self._joint_core.take(frame)
        for observer in self._observers:
            observer.frame(frame)

    def _command(self, time_s: float) -> dict[str, float]:
        """The signals of the COMMAND at that time of the walk."""
        asked = self._schedule(time_s)
        speed_m_s = asked.speed_m_s or 0.0
        walk = self._begun and speed_m_s > 0
        return {
            "MODE": WALK if walk else STAND,
            "SPEED": speed_m_s,
            "HEEL_STRIKE": asked.heel_strike_rad,
            "TURN_RATE": asked.turn_rate_rad_s,
        }

    def _send_command_frame(self, time_s: float) -> None:
        """With authentication nothing is sent before the firmware has opened a session."""
        command = self._command(time_s)
        if self._authenticator:
            frames = self._authenticator.frames(self._sender, **command)
        else:
            frames = [self._sender.frame("COMMAND", **command)]
        for frame in frames:
            self._send(frame)

    def _time_frames(self, sampled_s: float) -> list[can.Message]:
        time_us = round(sampled_s * 1e6) % TIMES
        if self._authenticator:
            return self._authenticator.time_frames(self._sender, time_us)
        return [self._sender.frame("MEASURED_TIME", TIME=time_us, CODE=0)]

    def _send_measurement(self, every_s: float) -> None:
        """One set; the sender's clock counts them. A set that is sent late was sampled in time."""
        measured: Measurement = self._wearer.measure()
        self._sets += 1
        for frame in self._time_frames(self._sets * every_s):
            self._send(frame)
        belt_m_s = self._belt_m_s(every_s)
        velocity = measured.velocity_m_s + belt_m_s
        com = {"HEIGHT": measured.height_m, "VX": velocity.real, "VY": velocity.imag}
        self._send(self._sender.frame("MEASURED_COM", **com))
        for side, name in ((LEFT, "MEASURED_LEFT"), (RIGHT, "MEASURED_RIGHT")):
            foot, contact = measured.feet_m[side], measured.contact[side]
            values = {"CONTACT": contact, "X": foot.real, "Y": foot.imag, "GROUND": belt_m_s}
            self._send(self._sender.frame(name, **values))

    def _belt_m_s(self, every_s: float) -> float:
        if self._treadmill is None:
            return 0.0
        command = self._command(self._wearer.time_s)
        self._treadmill.run(command["SPEED"] if command["MODE"] == WALK else 0.0, every_s)
        return self._treadmill.belt_m_s

    def _command_in_real_time(self) -> None:
        """The command for the next tick."""
        tick_s = (round(self._wearer.time_s / TICK_S) + 1) * TICK_S
        (self._send_command_frame if self._authenticator else self._publish_command)(tick_s)

    def _publish_command(self, time_s: float) -> None:
        from saddlewalk.transport.lcm_types import command_turn_t

        command = self._command(time_s)
        message = command_turn_t()
        message.utime_us = time.time_ns() // 1000
        message.mode, message.speed_m_s = int(command["MODE"]), command["SPEED"]
        message.heel_strike_rad = command["HEEL_STRIKE"]
        message.turn_rate_rad_s = command["TURN_RATE"]
        self._lcm.publish("SADDLEWALK_COMMAND_TURN", message.encode())

    def _publish_truth(self) -> None:
        if self._lcm is None:
            return
        message = truth_message(self._wearer, self._wearer.pushed_n_s - self._pushed_n_s)
        self._pushed_n_s = self._wearer.pushed_n_s
        self._lcm.publish("SADDLEWALK_TRUTH", message.encode())
        skeleton = self._wearer.skeleton()
        if skeleton is not None:
            message = skeleton_message(skeleton, self._wearer.com_m)
            self._lcm.publish("SADDLEWALK_SKELETON", message.encode())


def truth_message(wearer: Wearer, push_n_s: complex) -> Any:
    """The wearer as a truth_t."""
    from saddlewalk.transport.lcm_types import truth_t

    def point(plane: complex, height: float) -> list[float]:
        return [plane.real, plane.imag, height]

    left, right = wearer.feet
    message = truth_t()
    message.utime_us = time.time_ns() // 1000
    message.com_m = point(wearer.com_m, wearer.height_m)
    message.com_velocity_m_s = point(wearer.velocity_m_s, wearer.rise_m_s)
    message.left_m = point(left.position_m, left.height_m)
    message.right_m = point(right.position_m, right.height_m)
    message.cop_m = [wearer.cop_m.real, wearer.cop_m.imag]
    message.push_n_s = [push_n_s.real, push_n_s.imag]
    message.left_contact, message.right_contact = left.contact, right.contact
    message.fallen = wearer.fallen
    return message


def skeleton_message(skeleton: Skeleton, com_m: complex) -> Any:
    """A skeleton_t, from the CoM."""
    from saddlewalk.transport.lcm_types import skeleton_t

    com = np.array([com_m.real, com_m.imag, 0.0])
    message = skeleton_t()
    message.utime_us = time.time_ns() // 1000
    for name in ("hip_m", "knee_m", "ankle_m", "heel_m", "toe_m"):
        setattr(message, name, (getattr(skeleton, name) - com).tolist())
    message.trunk_up = skeleton.trunk_up.tolist()
    return message
