"""MuJoCo's side of a walk: a body on the floor, its motors and pushes, and what can be measured."""

import math
from collections import deque

import mujoco
import numpy as np

from saddlewalk.contract import LEFT, RIGHT, SIDES
from saddlewalk.emulation.wearer import Skeleton
from saddlewalk.physics.body import TIMESTEP_S, Body

POSE_ITERATIONS, POSE_STEP_MAX, POSE_TOLERANCE = 200, 0.2, 1e-4
POSE_DAMPING = 1e-4
KNEE_BEND_RAD = 0.5  # where the search for a pose begins


class Plant:
    """A body in MuJoCo, 1 ms a step. World frame: x forward, y to the left, z up, floor at 0."""

    def __init__(self, body: Body, torque_delay_s: float = 0.0) -> None:
        self.body, self.model = body, body.model
        self.data = mujoco.MjData(self.model)
        self.loads_n = [0.0, 0.0]
        # Greatest torque (N m), power (W) and speed (rad/s) of each motor so far.
        self.peaks = np.zeros((3, self.model.nu))
        steps = round(torque_delay_s / TIMESTEP_S)
        self._torques = deque([np.zeros(self.model.nu)] * (steps + 1), maxlen=steps + 1)
        self._feet = [self.model.body(leg.foot).id for leg in body.legs]
        self._pelvis = self.model.body(body.pelvis).id
        # Side of each geom; of all that is no foot -1.
        self._foot_of_geom = np.full(self.model.ngeom, -1)
        for side, foot in enumerate(self._feet):
            self._foot_of_geom[self.model.geom_bodyid == foot] = side

    @property
    def com_m(self) -> np.ndarray:
        return np.asarray(self.data.subtree_com[0])

    @property
    def com_velocity_m_s(self) -> np.ndarray:
        return np.asarray(self.data.subtree_linvel[0])

    def sole_m(self, side: int) -> np.ndarray:
        """The middle of the sole."""
        return self._at_foot(side, self.body.legs[side].sole_m)

    def sole_pitch_rad(self, side: int) -> float:
        """Positive: heel up."""
        forward = self.data.xmat[self._feet[side]].reshape(3, 3)[:, 0]
        return math.atan2(-forward[2], math.hypot(forward[0], forward[1]))

    @property
    def pelvis_yaw_rad(self) -> float:
        """In the world."""
        forward = self.data.xmat[self._pelvis].reshape(3, 3)[:, 0]
        return math.atan2(forward[1], forward[0])

    def sole_rise_m(self, side: int) -> float:
        """Of the middle of the sole over its lower end."""
        return self.body.legs[side].half_length_m * abs(math.sin(self.sole_pitch_rad(side)))

    def skeleton(self) -> Skeleton:
        """Of the joints' axes, and the ends of the soles."""
        legs = [self._leg(side) for side in (LEFT, RIGHT)]
        hips, knees, ankles, heels, toes = (np.array(part) for part in zip(*legs, strict=True))
        upwards = self.data.xmat[self._pelvis].reshape(3, 3)[:, 2]
        return Skeleton(hips, knees, ankles, heels, toes, upwards)

    def _leg(self, side: int) -> tuple[np.ndarray, ...]:
        """Hip, knee, ankle, heel and toe."""
        model, data, leg = self.model, self.data, self.body.legs[side]
        knee, foot = model.joint(leg.knee), self._feet[side]
        thigh = model.body_parentid[knee.bodyid[0]]
        return (
            data.xpos[thigh],
            data.xanchor[knee.id],
            data.xanchor[model.body_jntadr[foot]],
            self._at_foot(side, leg.heel_m),
            self._at_foot(side, leg.toe_m),
        )

    def _at_foot(self, side: int, local_m: np.ndarray) -> np.ndarray:
        foot = self._feet[side]
        return np.asarray(self.data.xpos[foot] + self.data.xmat[foot].reshape(3, 3) @ local_m)

    def stand(self, soles_m: tuple[complex, complex], com_m: np.ndarray) -> None:
        """At rest with level soles there, the pelvis upright and the CoM at com_m, (3,)."""
        model, data = self.model, self.data
        data.qpos[:] = model.qpos0
        data.qvel[:] = 0
        for leg in self.body.legs:
            data.qpos[model.joint(leg.knee).qposadr[0]] = self.body.knee_sign * KNEE_BEND_RAD
        for _ in range(POSE_ITERATIONS):
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            jacobian, error = self._pose_error(soles_m, com_m)
            if np.abs(error).max() < POSE_TOLERANCE:
                break
            damped = jacobian.T @ jacobian + POSE_DAMPING * np.eye(model.nv)
            change = np.linalg.solve(damped, jacobian.T @ error)
            limited = np.clip(change, -POSE_STEP_MAX, POSE_STEP_MAX)
            mujoco.mj_integratePos(model, data.qpos, limited, 1.0)
        mujoco.mj_forward(model, data)
        mujoco.mj_subtreeVel(model, data)

    def _pose_error(
        self, soles_m: tuple[complex, complex], com_m: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        model, data = self.model, self.data
        moving, turning = np.zeros((2, 3, model.nv))
        mujoco.mj_jacSubtreeCom(model, data, moving, 0)
        rows, errors = [moving.copy()], [com_m - data.subtree_com[0]]
        for side in (LEFT, RIGHT):
            point, place = self.sole_m(side), soles_m[side]
            mujoco.mj_jac(model, data, moving, turning, point, self._feet[side])
            rows += [moving.copy(), turning.copy()]
            errors += [np.array([place.real, place.imag, 0.0]) - point]
            errors += [_to_level(data.xquat[self._feet[side]])]
        mujoco.mj_jacBody(model, data, moving, turning, self._pelvis)
        return np.vstack([*rows, turning]), np.concatenate(
            [*errors, _to_level(data.xquat[self._pelvis])]
        )

    def step(self, torques: np.ndarray, push_n: complex, sensed: bool = True) -> None:
        """1 ms with these torques, delayed, and a force through the CoM of the whole body.

        sensed: loads and the CoM's velocity are wanted after it, and else stay as they were.
        """
        data = self.data
        self._torques.append(torques)
        data.ctrl[:] = self._torques[0]
        rates = data.qvel[-self.model.nu :]
        done = np.abs((data.ctrl, data.ctrl * rates, rates))
        self.peaks = np.maximum(self.peaks, done)
        lever_m = self.com_m - data.xipos[self._pelvis]
        data.xfrc_applied[self._pelvis] = (
            *(push_n.real, push_n.imag, 0.0),
            *(-lever_m[2] * push_n.imag, lever_m[2] * push_n.real),
            lever_m[0] * push_n.imag - lever_m[1] * push_n.real,
        )
        mujoco.mj_step2(self.model, data)
        if sensed:
            self._weigh()
        mujoco.mj_step1(self.model, data)
        if sensed:
            mujoco.mj_subtreeVel(self.model, data)

    def peaks_of_joints(self) -> dict[str, tuple[float, float, float]]:
        """By the joint's name without its side: the greatest torque, power and speed of both."""
        peaks: dict[str, np.ndarray] = {}
        for motor, of_motor in enumerate(self.peaks.T):
            side, _, name = self.model.actuator(motor).name.partition("_")
            joint = name if side in SIDES else self.model.actuator(motor).name
            peaks[joint] = np.maximum(peaks.get(joint, of_motor), of_motor)
        return {joint: tuple(found.tolist()) for joint, found in peaks.items()}

    def _weigh(self) -> None:
        """Load of each foot, from the contacts of the step that was just made."""
        contacts, forces_n = self.data.contact, self.data.efc_force
        soles = self._foot_of_geom[contacts.geom].max(axis=1)  # the floor's is -1
        address = contacts.efc_address
        normal_n = np.where(address >= 0, forces_n[address], 0.0) if len(address) else address
        self.loads_n = [float(normal_n[soles == side].sum()) for side in (LEFT, RIGHT)]


def _to_level(quaternion: np.ndarray) -> np.ndarray:
    """The rotation vector, in the world, to the level orientation."""
    inverse, error = np.zeros(4), np.zeros(3)
    mujoco.mju_negQuat(inverse, quaternion)
    mujoco.mju_quat2Vel(error, inverse, 1.0)
    return error
