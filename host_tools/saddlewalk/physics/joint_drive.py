"""A MuJoCo body walked by firmware/joints: its sensors in, joint commands out, each joint's loop
closed in its drive.

The core ticks by the estimator's numbers, and nothing of the simulation but its sensors reaches the
C library.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from saddlewalk import joints
from saddlewalk.contract import GRAVITY_M_S2, LEFT, RIGHT
from saddlewalk.core import ffi
from saddlewalk.emulation.wearer import STEP_S, Measurement, Noise, Plan, Push
from saddlewalk.physics.body import WINTER_FIELDS
from saddlewalk.physics.plant import Plant
from saddlewalk.physics.wearer import CONTACT_N, SIDES, PhysicalWearer

STANDS_FIRST_S = 2.0  # before the first plan: tilt and bias of the gyroscope are found
LEG_JOINTS = 6

# The gains of firmware/joints were found with straighter knees.
FIELDS: Mapping[str, float | int] = {**WINTER_FIELDS, "pendulum_ratio": 0.545}


@dataclass(frozen=True)
class SensorErrors:
    """Standard deviations: noise of each sample, and biases that are drawn once."""

    gyro_rad_s: float = 0.005
    accelerometer_m_s2: float = 0.05
    encoder_rad: float = 0.001
    load_share: float = 0.02
    gyro_bias_rad_s: float = 0.003
    accelerometer_bias_m_s2: float = 0.03
    encoder_bias_rad: float = 0.002


@dataclass(frozen=True)
class BodyErrors:
    """By which the C library's body differs from the real one."""

    mass_share: float = 0.0
    leg_m: float = 0.0  # thigh and shank together are longer by as much


class Device:
    """The sensors of a body: what a device would read at every step of physics."""

    def __init__(self, plant: Plant, imu_m: np.ndarray, errors: SensorErrors, seed: int) -> None:
        self._plant, self._errors = plant, errors
        x, y, z = imu_m
        self._arm_m = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])  # angular velocity -> velocity
        self._random = np.random.default_rng((seed, 1))
        draw = self._random.normal
        self._gyro_bias = draw(0, errors.gyro_bias_rad_s, 3)
        self._accelerometer_bias = draw(0, errors.accelerometer_bias_m_s2, 3)
        self._encoder_bias = draw(0, errors.encoder_bias_rad, 2 * LEG_JOINTS)
        self._velocity_m_s = self._imu_velocity(self._rotation())

    def _rotation(self) -> np.ndarray:
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, self._plant.data.qpos[3:7])
        return rotation.reshape(3, 3)

    def _imu_velocity(self, rotation: np.ndarray) -> np.ndarray:
        data = self._plant.data
        return np.asarray(data.qvel[:3] + rotation @ (self._arm_m @ data.qvel[3:6]))

    def read(self, sensors: Any, time_us: int) -> None:
        """Into a saddle_sensors_t."""
        data, errors, draw = self._plant.data, self._errors, self._random.standard_normal
        rotation = self._rotation()
        velocity = self._imu_velocity(rotation)
        force = (velocity - self._velocity_m_s) / STEP_S + np.array([0, 0, GRAVITY_M_S2])
        self._velocity_m_s = velocity
        noise = draw(3 + 3 + 2 * LEG_JOINTS + 2)
        gyro = data.qvel[3:6] + self._gyro_bias + errors.gyro_rad_s * noise[:3]
        accelerometer = rotation.T @ force + self._accelerometer_bias
        accelerometer += errors.accelerometer_m_s2 * noise[3:6]
        angles = data.qpos[7:] + self._encoder_bias + errors.encoder_rad * noise[6:-2]
        sensors.time_us = time_us
        for name, values in (("gyro_rad_s", gyro), ("accelerometer_m_s2", accelerometer)):
            vector = getattr(sensors, name)
            vector.x, vector.y, vector.z = values.tolist()
        sensors.angle_rad = angles.reshape(2, LEG_JOINTS).tolist()
        for side in SIDES:
            load_n = self._plant.loads_n[side] * (1 + errors.load_share * noise[side - 2])
            sensors.load_n[side] = max(load_n, 0.0)


def drive_torques(plant: Plant, command: np.ndarray) -> np.ndarray:
    """What each joint's drive makes of its command, by its own encoder.

    command: (7, 12), the fields of saddle_joint_command_t.
    """
    angle, rate, torque, stiffness, damping, low, high = command
    data = plant.data
    wanted = torque + stiffness * (angle - data.qpos[7:]) + damping * (rate - data.qvel[6:])
    return np.asarray(np.clip(wanted, low, high))


class JointWearer(PhysicalWearer):
    """With the interface of PhysicalWearer; its measurements are the estimator's."""

    def __init__(
        self,
        plant: Plant,
        config: Any,
        noise: Noise | None = None,
        pushes: tuple[Push, ...] = (),
        seed: int = 0,
        takes_recovery_step: bool = True,
        right_ahead_m: float = 0.0,
        command_delay_s: float = 0.0,
        wrong: BodyErrors | None = None,
        legs: Mapping[str, float] | None = None,
    ) -> None:
        """config: the firmware's saddle_config_t; noise: of the point mass, not of this device;
        legs: fields of saddle_legs_t that were measured.
        """
        super().__init__(plant, config, noise, pushes, seed, takes_recovery_step, right_ahead_m)
        wrong = wrong or BodyErrors()
        mass_kg = config.body_mass_kg * (1 + wrong.mass_share)
        body = joints.legs(config.body_height_m, mass_kg, legs)
        body.thigh_m += wrong.leg_m / 2
        body.shank_m += wrong.leg_m / 2
        self._estimator = joints.Estimator(body)
        self._controller = joints.Controller(body, config.double_support_share)
        if not takes_recovery_step:
            self._controller.walk.step_gain = 0.0
        imu = self._estimator.config
        imu_m = np.array([imu.imu_x_m, imu.imu_y_m, imu.imu_z_m])
        self._device = Device(plant, imu_m, SensorErrors(), seed)
        self._clock_us = 0
        plant.loads_n = [plant.body.mass_kg * GRAVITY_M_S2 / 2] * 2  # as it stands, before any step
        for _ in range(round(STANDS_FIRST_S / STEP_S)):
            self._read()
        first = self._commands(None)
        self._queue = deque([first], maxlen=1 + round(command_delay_s / STEP_S))

    def measure(self) -> Measurement:
        found = self._estimate.measurement
        velocity = complex(found.com.velocity_m_s.x, found.com.velocity_m_s.y)
        left, right = (complex(foot.cop_m.x, foot.cop_m.y) for foot in found.foot)
        contact = (found.foot[LEFT].contact, found.foot[RIGHT].contact)
        return Measurement(found.com.height_m, velocity, (left, right), contact)

    def _read(self) -> None:
        self._clock_us += round(STEP_S * 1e6)
        self._device.read(self._estimator.sensors, self._clock_us)
        self._estimate = self._estimator.update()

    def _commands(self, plan: Plan | None) -> np.ndarray:
        """(7, 12): the fields of saddle_joint_command_t."""
        found = self._controller.commands(
            self._clock_us, plan, self._estimate, self.takes_recovery_step
        )
        table = np.frombuffer(ffi().buffer(found.joint), dtype=np.float32)
        return table.reshape(2 * LEG_JOINTS, -1).T.astype(float)

    def step(self) -> None:
        self._advance_time()
        if self.fallen:
            return
        self._renew_plan()
        self._plan_age_s += STEP_S
        self._since_tick_s += STEP_S
        self._queue.append(self._commands(self._plan))
        self._note_reference()
        self.plant.step(drive_torques(self.plant, self._queue[0]), self._push())
        self._sense()
        self._read()
        for side, foot in enumerate(self.feet):
            foot.contact = self.plant.loads_n[side] > CONTACT_N
        self._seen.append(self._exact_now())
        self._record_pose()

    def _note_reference(self) -> None:
        """Where the C library has the plan's frame, against the foot that it measures from."""
        side = self._estimate.anchor_foot
        sole, wanted = self._estimate.body.foot[side].sole_m, self._controller.intent.xcom_m
        planned_m = self.feet[side].position_m + complex(wanted.x - sole.x, wanted.y - sole.y)
        self.xcom_error_m = self.xcom_m - planned_m
        if self._plan is not None:
            self._origin_m = planned_m - self._plan.reference(self._plan_age_s).xcom_m
