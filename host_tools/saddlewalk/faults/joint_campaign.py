"""Faults of a device's sensors and joint commands on CAN, and whether the firmware stayed safe.

A body in MuJoCo walks by the firmware's own code in this process: inbox, codec, core, joints and
their fast loop, by a simulated clock. Nothing but the faults decides when a frame arrives.
"""

import itertools
import math
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import can
import numpy as np

from saddlewalk import core
from saddlewalk.contract import OUTPUT_FRAMES, TICK_S
from saddlewalk.faults.scenario import Fault, Line, Occurrence, draw
from saddlewalk.firmware import config_of, ffi, library
from saddlewalk.physics.joint_chain import JOINT_NAMES, SIDE_NAMES, Course, walk
from saddlewalk.physics.joint_drive import STANDS_FIRST_S
from saddlewalk.transport import wire
from saddlewalk.workers import Workers, run_tasks

RATE_HZ = 250
SPEED_M_S, DISTANCE_M, STOPPING_S = 0.8, 2.0, 2.0
BEGINS_S = (STANDS_FIRST_S + 2.0, STANDS_FIRST_S + 2.8)  # somewhere in a stride
LASTS_S = 1.0
CLOCK_BEGIN_S = 100.0
JOINT_FRAMES = 25
# A pass later than it must be, and one more for what is on its way.
GRACE_S = 2 / RATE_HZ

IMU = ("SENSED_GYRO", "SENSED_ACCELEROMETER")
LEFT_ENCODERS = ("SENSED_LEFT_HIP", "SENSED_LEFT_LEG")
ALL = (*IMU, "SENSED_LOADS", *LEFT_ENCODERS, "SENSED_RIGHT_HIP", "SENSED_RIGHT_LEG")
KNEE = ("JOINT_LEFT_KNEE", "GAINS_LEFT_KNEE")
EVERY_JOINT = tuple(
    f"{kind}_{side}_{joint}"
    for kind in ("JOINT", "GAINS")
    for side in SIDE_NAMES
    for joint in JOINT_NAMES
)
# Whose frames, what happens to them, and how strongly.
CLASSES: Sequence[tuple[str, tuple[str, ...], str, float]] = (
    ("nothing", ALL, "none", 0.0),
    *(
        (name, messages, kind, strength)
        for name, messages, bias in (
            ("gyroscope", IMU[:1], 0.2),
            ("accelerometer", IMU[1:], 2.0),
            ("foot loads", ("SENSED_LOADS",), 100.0),
            ("left hip's encoders", LEFT_ENCODERS[:1], 0.05),
            ("left leg's encoders", LEFT_ENCODERS[1:], 0.05),
            ("all sensors", ALL, 0.05),
        )
        for kind, strength in (
            ("loss", 1.0),
            ("loss", 0.2),
            ("delay", 0.03),
            ("stuck", 0.0),
            ("nan", 1.0),
            ("flip", 3.0),
            ("bias", bias),
        )
    ),
    ("knee's commands", KNEE, "loss", 1.0),
    ("knee's commands", KNEE, "flip", 3.0),
    ("all commands", EVERY_JOINT, "loss", 0.2),
    ("all commands", EVERY_JOINT, "delay", 0.008),
)


@dataclass(frozen=True)
class Outcome:
    """What came of one walk; times from when the fault took effect, NaN: never."""

    place: int  # of CLASSES
    detected_s: float  # JOINTS_STATE has a fault, or a frame was rejected
    fallback_s: float
    violations: tuple[str, ...]  # empty: safe
    fell: bool


class FaultyFirmware:
    """The firmware that drives joints, behind a faulty line, as a bus: what is sent goes to it,
    and when nothing waits any more it makes its next pass.
    """

    channel_info = "the firmware in this process"

    def __init__(
        self, config: Any, occurrences: Sequence[Occurrence], random: np.random.Generator
    ) -> None:
        lib = library()
        self._context = ffi().new("saddle_context_t *")
        self._inbox = ffi().new("saddle_inbox_t *")
        self._loop = ffi().new("saddle_joint_loop_t *")
        self._output = ffi().new("saddle_output_t *")
        self._health = ffi().new("saddle_wire_health_t *")
        self._output_frames = ffi().new("saddle_frame_t[]", OUTPUT_FRAMES)
        self._joint_frames = ffi().new("saddle_frame_t[]", JOINT_FRAMES)
        self._line, self._back = Line(occurrences, random), Line(occurrences, random)
        self._waiting: deque[can.Message] = deque()
        self._passes = 0
        # When the last of each that was accepted was measured. A reading that repeats itself cannot
        # be told from a new one: it counts as new.
        self._imu_s = dict.fromkeys(IMU, 0.0)
        self._repeats = any(occurrence.kind == "stuck" for occurrence in occurrences)
        self._faults_before = 0
        self.detected_s = self.fallback_s = math.nan
        self.violations: dict[str, None] = {}
        settings = ffi().new("saddle_joint_loop_config_t *")
        settings[0] = lib.saddle_joint_loop_default(config_of(config))
        settings.passes = round(RATE_HZ * TICK_S)
        self._settings = settings
        lib.saddle_init(self._context, config_of(config))
        lib.saddle_inbox_init(self._inbox, lib.SADDLE_SOURCE_CAN)
        self._inbox.by_sensors = True
        lib.saddle_joint_loop_init(self._loop, settings)

    @property
    def now_s(self) -> float:
        return self._passes / RATE_HZ

    @property
    def _onset_s(self) -> float:
        return min(self._line.onset_s, self._back.onset_s)

    def send(self, frame: can.Message) -> None:
        self._line.send(frame, self.now_s)

    def recv(self, timeout: float | None = None) -> can.Message:
        if not self._waiting:
            self._make_pass()
        return self._waiting.popleft()

    def _clock_us(self) -> int:
        return round((CLOCK_BEGIN_S + self.now_s) * 1e6)

    def _take(self) -> None:
        for arrival in self._line.due(self.now_s):
            data, before = bytes(arrival.frame.data), self._inbox.receiver.accepted
            identifier = arrival.frame.arbitration_id
            library().saddle_inbox_take_frame(
                self._inbox, identifier, data, len(data), self._clock_us()
            )
            name = wire.known_name(identifier)
            if name in self._imu_s and self._inbox.receiver.accepted > before:
                readings = wire.signals(arrival.frame)
                if all(map(math.isfinite, readings.values())):
                    measured_s = arrival.time_s if self._repeats else arrival.born_s
                    self._imu_s[name] = max(self._imu_s[name], measured_s)

    def _make_pass(self) -> None:
        lib, time_us = library(), self._clock_us()
        self._take()
        sensors = lib.saddle_inbox_sense(self._inbox, time_us)
        self._inbox.input.measurement = lib.saddle_joint_loop_sense(self._loop, sensors)[0]
        frames: list[Any] = []
        if self._passes % self._settings.passes == 0:
            given = lib.saddle_inbox_read(self._inbox, time_us)
            lib.saddle_tick(self._context, given, self._output)
            lib.saddle_joint_loop_tick(self._loop, self._output)
            counter = self._passes // self._settings.passes % 256
            lib.saddle_wire_encode_output(self._output, self._health, counter, self._output_frames)
            frames = list(self._output_frames)
        lib.saddle_joint_loop_drive(self._loop, self._context, time_us)
        lib.saddle_wire_encode_joints(
            *(ffi().addressof(self._loop, part) for part in ("commands", "estimate")),
            *(self._passes % 256, self._joint_frames),
        )
        self._check()
        self._deliver([*frames, *self._joint_frames])
        self._passes += 1

    def _deliver(self, frames: Iterable[Any]) -> None:
        """JOINTS_STATE ends the pass, whatever is still on its way."""
        *others, last = (
            can.Message(arbitration_id=frame.id, is_extended_id=False, data=bytes(frame.data))
            for frame in frames
        )
        for frame in others:
            self._back.send(frame, self.now_s)
        self._waiting.extend(arrival.frame for arrival in self._back.due(self.now_s))
        self._waiting.append(last)

    # -- what the firmware did --------------------------------------------------------------------

    def _check(self) -> None:
        faults, rejected = self._loop.estimate.faults, library().saddle_inbox_rejected(self._inbox)
        if math.isinf(self._onset_s):
            self._faults_before = rejected
            if faults and self.now_s > STANDS_FIRST_S:
                self.violations["fault without a cause"] = None
        elif math.isnan(self.detected_s) and (faults or rejected > self._faults_before):
            self.detected_s = self.now_s - self._onset_s
        fallback = self._loop.commands.fallback
        if fallback and self.now_s > STANDS_FIRST_S and math.isnan(self.fallback_s):
            self.fallback_s = self.now_s - self._onset_s
        silent_s = self.now_s - min(self._imu_s.values())
        longest_s = self._settings.estimator.max_age_s + self._settings.drive.max_age_s + GRACE_S
        if silent_s > longest_s and not fallback:
            self.violations["walked on without an IMU"] = None
        for name in self._beyond_limits():
            self.violations[f"{name} beyond its limits"] = None

    def _beyond_limits(self) -> Iterable[str]:
        legs, drive = self._settings.legs, self._settings.drive
        for side, leg in enumerate(self._loop.commands.joint):
            for place, command in enumerate(leg):
                limits, most_nm = legs.joint[place], drive.joint[place].torque_max_nm
                low, high = limits.min_rad, limits.max_rad
                if side == 1 and JOINT_NAMES[place].endswith(("YAW", "ROLL")):
                    low, high = -high, -low
                torque_nm = command.torque_nm
                within = (
                    low <= command.angle_rad <= high
                    and abs(command.rate_rad_s) <= limits.rate_max_rad_s
                    and -most_nm <= command.torque_min_nm <= torque_nm <= command.torque_max_nm
                    and command.torque_max_nm <= most_nm
                    and 0 <= command.stiffness < math.inf
                    and 0 <= command.damping < math.inf
                )
                if not within:
                    yield JOINT_NAMES[place].lower()


def run(place: int, number: int, seed: int, config: Any) -> Outcome:
    """Walk `number` of a class of CLASSES."""
    _, messages, kind, strength = CLASSES[place]
    random = np.random.default_rng([seed, place, number])
    occurrence = draw(Fault(kind, strength, messages, BEGINS_S, LASTS_S), random)
    firmware = FaultyFirmware(config, [occurrence], random)
    course = Course(SPEED_M_S, DISTANCE_M, RATE_HZ, int(random.integers(2**32)), STOPPING_S)
    outcome = walk(firmware, config, course)
    return Outcome(
        place, firmware.detected_s, firmware.fallback_s, tuple(firmware.violations), outcome.fell
    )


@dataclass(frozen=True)
class Row:
    """The walks of one class."""

    what: str
    kind: str
    strength: float
    walks: int
    detected: int
    detected_ms: float  # median and greatest, of those that were
    detected_max_ms: float
    fallbacks: int
    fallback_max_ms: float
    unsafe: int
    fell: int


def rows_of(outcomes: Iterable[Outcome]) -> list[Row]:
    """A row for each class, in their order."""
    groups: dict[int, list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault(outcome.place, []).append(outcome)
    return [_row(*CLASSES[place], group) for place, group in sorted(groups.items())]


def _row(
    what: str, _: tuple[str, ...], kind: str, strength: float, group: Sequence[Outcome]
) -> Row:
    detected = [o.detected_s * 1e3 for o in group if math.isfinite(o.detected_s)]
    fallbacks = [o.fallback_s * 1e3 for o in group if math.isfinite(o.fallback_s)]
    return Row(
        *(what, kind, strength, len(group), len(detected)),
        *(float(np.median(detected)) if detected else math.nan, max(detected, default=math.nan)),
        *(len(fallbacks), max(fallbacks, default=math.nan)),
        *(sum(bool(o.violations) for o in group), sum(o.fell for o in group)),
    )


def campaign(
    runs: int, seed: int, config: Any, workers: Workers, progress: Callable[[int], None]
) -> list[Outcome]:
    """`runs` walks of each class, in their order. config: a saddle_config_t."""
    image = core.config_bytes(config)
    tasks = itertools.product(range(len(CLASSES)), range(runs), [seed], [image])
    return run_tasks(_work, list(tasks), workers, progress)


def _work(place: int, number: int, seed: int, image: bytes) -> list[Outcome]:
    return [run(place, number, seed, core.config_from(image))]
