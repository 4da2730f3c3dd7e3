"""A MuJoCo body as a node on CAN: its sensors go out, its drives do what the firmware commands.

Nothing else of the simulation reaches the firmware, and nothing else of the firmware the joints.
"""

import hashlib
import math
import struct
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import can
import numpy as np

from saddlewalk.contract import GRAVITY_M_S2, STAND, STANDING, TICK_S, WALK
from saddlewalk.core import ffi
from saddlewalk.emulation.wearer import STEP_S, Body, Push
from saddlewalk.errors import UserError
from saddlewalk.joints import Estimator, legs
from saddlewalk.physics.body import winter
from saddlewalk.physics.joint_drive import (
    LEG_JOINTS,
    STANDS_FIRST_S,
    Device,
    SensorErrors,
    drive_torques,
)
from saddlewalk.physics.plant import Plant
from saddlewalk.ticks import FrameBus
from saddlewalk.transport.wire import Receiver, Sender, identifier

HEEL_STRIKE_RAD = 0.17
START_S = 1.0  # from when the body stands by itself until it is to walk
STARTS_AND_STOPS_S = 1.5  # that a walk takes longer for than at its speed throughout
STOPPING_S = 8.0
STILL_M_S = 0.03
SILENCE_S = 5.0
SIDE_NAMES = ("LEFT", "RIGHT")
JOINT_NAMES = "HIP_YAW HIP_ROLL HIP_PITCH KNEE ANKLE_PITCH ANKLE_ROLL".split()


@dataclass(frozen=True)
class Course:
    """Of a walk from standing to standing."""

    speed_m_s: float
    distance_m: float
    rate_hz: int  # of the sensors and the joint commands
    seed: int = 0
    stopping_s: float = STOPPING_S  # from the command to stop to the end
    push: Push | None = None
    legs: Mapping[str, float] = field(default_factory=dict)  # measured, of the body

    @property
    def stop_s(self) -> float:
        return START_S + STARTS_AND_STOPS_S + self.distance_m / self.speed_m_s

    def command(self, time_s: float) -> dict[str, float]:
        walks = START_S <= time_s < self.stop_s
        speed_m_s = self.speed_m_s if walks else 0.0
        mode = WALK if walks else STAND
        return {"MODE": mode, "SPEED": speed_m_s, "HEEL_STRIKE": HEEL_STRIKE_RAD}


@dataclass(frozen=True)
class Outcome:
    fell_at_s: float  # NaN: it did not
    stands: bool  # at the end
    distance_m: float
    walked_s: float
    passes: int
    fallbacks: int  # passes of the walk without commands to walk by
    unsound: int  # passes of the walk with a fault of the sensors
    digest: str  # of every bit that the firmware sent

    @property
    def fell(self) -> bool:
        return math.isfinite(self.fell_at_s)


class BusDevice:
    """Sensors and drives of a body on a bus, in lockstep with the firmware: one set of sensors, one
    set of commands.
    """

    def __init__(self, bus: FrameBus, plant: Plant, config: Any, course: Course) -> None:
        imu = Estimator(legs(config.body_height_m, config.body_mass_kg, course.legs)).config
        imu_m = np.array([imu.imu_x_m, imu.imu_y_m, imu.imu_z_m])
        self._bus, self._course = bus, course
        self._sensors = ffi().new("saddle_sensors_t *")
        self._device = Device(plant, imu_m, SensorErrors(), course.seed)
        self._sender, self._receiver = Sender(), Receiver()
        self._bits = hashlib.sha256()
        self._passes_a_tick = round(course.rate_hz * TICK_S)
        self.passes = 0
        self.mode = STANDING
        self.state: dict[str, float] = {}
        self.commands = np.zeros((7, 2 * LEG_JOINTS))  # the fields of saddle_joint_command_t
        self._places = {
            f"{kind}_{side}_{joint}": (rows, place)
            for kind, rows in (("JOINT", slice(0, 3)), ("GAINS", slice(3, 7)))
            for place, (side, joint) in enumerate(
                (side, joint) for side in SIDE_NAMES for joint in JOINT_NAMES
            )
        }

    @property
    def digest(self) -> str:
        return self._bits.hexdigest()

    def sense(self) -> None:
        """After every step of physics."""
        self._device.read(self._sensors, 0)

    def exchange(self, time_s: float) -> None:
        """One pass: the sensors out, the commands in. time_s: of the walk."""
        if self.passes % self._passes_a_tick == 0:
            self._send("COMMAND", **self._course.command(time_s))
        sampled_us = round(self.passes * 1e6 / self._course.rate_hz) % 2**32
        self._send("MEASURED_TIME", TIME=sampled_us, CODE=0)
        for name, values in self._sensed().items():
            self._send(name, **values)
        self.passes += 1
        deadline_s = time.monotonic() + SILENCE_S
        while not self._take(self._bus.recv(SILENCE_S)):
            if time.monotonic() > deadline_s:
                raise UserError(
                    f"no joint commands for {SILENCE_S:g} s on {self._bus.channel_info}: start the "
                    "firmware with --joints"
                )

    def _sensed(self) -> dict[str, dict[str, float]]:
        sensors = self._sensors
        found = {
            "SENSED_GYRO": _vector(sensors.gyro_rad_s),
            "SENSED_ACCELEROMETER": _vector(sensors.accelerometer_m_s2),
            "SENSED_LOADS": dict(zip(SIDE_NAMES, sensors.load_n, strict=True)),
        }
        for side, angles in zip(SIDE_NAMES, sensors.angle_rad, strict=True):
            hip = (name.removeprefix("HIP_") for name in JOINT_NAMES[:3])
            found[f"SENSED_{side}_HIP"] = dict(zip(hip, list(angles)[:3], strict=True))
            found[f"SENSED_{side}_LEG"] = dict(zip(JOINT_NAMES[3:], list(angles)[3:], strict=True))
        return found

    def _send(self, name: str, **values: float) -> None:
        frame = self._sender.frame(name, **values)
        frame.is_rx = False
        self._bus.send(frame)

    def _take(self, frame: can.Message | None) -> bool:
        """Whether this was the last frame of the pass."""
        accepted = None if frame is None else self._receiver.accept(frame)
        if frame is None or accepted is None:
            return False
        self._bits.update(struct.pack("<H", frame.arbitration_id) + frame.data)
        name, signals = accepted
        if name in self._places:
            rows, place = self._places[name]
            self.commands[rows, place] = [signals[key] for key in signals if key != "COUNTER"]
        elif name == "PLAN_EVENTS":
            self.mode = int(signals["MODE"])
        elif name == "JOINTS_STATE":
            self.state = signals
        return frame.arbitration_id == identifier("JOINTS_STATE")


def _force(push: Push | None, time_s: float) -> complex:
    """Through the CoM, in N."""
    lasts_s = Push.STEPS * STEP_S
    if push is None or not push.time_s <= time_s < push.time_s + lasts_s:
        return 0j
    return push.vector_n_s / lasts_s


def _vector(vector: Any) -> dict[str, float]:
    return {"X": vector.x, "Y": vector.y, "Z": vector.z}


def walk(bus: FrameBus, config: Any, course: Course) -> Outcome:
    """From standing to standing; config: the firmware's saddle_config_t."""
    pendulum = Body.of(config)
    plant = Plant(winter(config.body_height_m, config.body_mass_kg, course.legs))
    left_m = 1j * config.step_width_slow_m / 2
    plant.stand((left_m, -left_m), np.array([0.0, 0.0, pendulum.pendulum_m]))
    plant.loads_n = [plant.body.mass_kg * GRAVITY_M_S2 / 2] * 2
    device = BusDevice(bus, plant, config, course)
    steps = round(1 / (course.rate_hz * STEP_S))
    for _ in range(round(STANDS_FIRST_S * course.rate_hz)):  # held, while it finds its tilt
        for _ in range(steps):
            device.sense()
        device.exchange(0.0)
    passes, fallbacks, unsound, fell_at_s = 0, 0, 0, math.nan
    end_s = course.stop_s + course.stopping_s
    for passes in range(round(end_s * course.rate_hz)):
        device.exchange(passes / course.rate_hz)
        fallbacks += int(device.state["FALLBACK"])
        unsound += device.state["FAULTS"] != 0
        for _ in range(steps):
            plant.step(drive_torques(plant, device.commands), _force(course.push, plant.data.time))
            device.sense()
        if plant.com_m[2] < pendulum.fall_height * pendulum.pendulum_m:
            fell_at_s = passes / course.rate_hz
            break
    still = math.hypot(*plant.com_velocity_m_s[:2]) < STILL_M_S
    return Outcome(
        fell_at_s=fell_at_s,
        stands=still and device.mode == STANDING and math.isnan(fell_at_s),
        distance_m=float(plant.com_m[0]),
        walked_s=passes / course.rate_hz,
        passes=device.passes,
        fallbacks=fallbacks,
        unsound=unsound,
        digest=device.digest,
    )
