"""Joint torques for wanted accelerations: weighted least squares under the body's dynamics.

Unknowns are the accelerations q'' of the model and the forces at the corners of the loaded soles.
The quadratic programme keeps the dynamics of the floating base, forces that push and lie within
the friction pyramid, the load that each foot may carry, the motors' torques, and bent knees.
"""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any

import mujoco
import numpy as np
import piqp

from saddlewalk.contract import GRAVITY_M_S2
from saddlewalk.physics.body import Body
from saddlewalk.physics.gains import Gains

UNLIMITED = 1e31  # piqp takes bounds from 1e30 on as none
ITERATIONS_MAX = 40
TOLERANCE_ABSOLUTE, TOLERANCE_RELATIVE = 1e-5, 1e-6


class Contact(Enum):
    AIR = 0
    SOLE = 1
    TOE = 2  # heel-off: on the two corners at the toe


@dataclass(frozen=True)
class Yaw:
    """In the world."""

    rad: float = 0.0
    rad_s: float = 0.0


@dataclass(frozen=True)
class FootTarget:
    """Where a foot is to be. A loaded one stays where it is: only its angles and load count."""

    contact: Contact
    pitch_rad: float = 0.0
    yaw: Yaw = Yaw()
    load_max_n: float = UNLIMITED
    position_m: np.ndarray | None = None  # of the sole's middle
    velocity_m_s: np.ndarray | None = None
    acceleration_m_s2: np.ndarray | None = None


@dataclass(frozen=True)
class Targets:
    com_acceleration_m_s2: np.ndarray  # (3,)
    feet: tuple[FootTarget, FootTarget]
    pelvis: Yaw = Yaw()


class InverseDynamics:
    """Torques of one body. `unsolved` counts programmes that ended without an optimum."""

    def __init__(self, body: Body, gains: Gains) -> None:
        model = body.model
        self._body, self._gains, self._model = body, gains, model
        self._mass_kg = body.mass_kg
        self._pelvis = model.body(body.pelvis).id
        self._feet = [model.body(leg.foot).id for leg in body.legs]
        self._knees = [model.joint(leg.knee) for leg in body.legs]
        self._torque_max = model.actuator_ctrlrange[:, 1].copy()
        self._inertia = np.zeros((model.nv, model.nv))
        self._programmes: dict[tuple[int, ...], _Programme] = {}
        self.unsolved = 0

    def torques(self, data: Any, targets: Targets) -> np.ndarray | None:
        """None where the programme has no finite answer. data: after mj_step1()."""
        tasks, loaded = _Tasks(), list[_Loaded]()
        mujoco.mj_fullM(self._model, data, self._inertia)
        bias = data.qfrc_bias - data.qfrc_passive
        self._add_com(tasks, bias, targets.com_acceleration_m_s2)
        self._add_upright(tasks, data, targets.pelvis)
        for side, foot in enumerate(targets.feet):
            if foot.contact is Contact.AIR:
                self._add_swing(tasks, data, side, foot)
            else:
                self._add_stance(tasks, data, side, foot)
                loaded.append(_Loaded(self._corners(data, side, foot.contact), foot.load_max_n))
        return self._solve(data, tasks, bias, loaded)

    def _add_com(self, tasks: "_Tasks", bias: np.ndarray, wanted: np.ndarray) -> None:
        """The floating base's momentum is the body's: its first rows are mass times the CoM's
        acceleration less gravity."""
        jacobian = self._inertia[:3] / self._mass_kg
        drift = bias[:3] / self._mass_kg - (0, 0, GRAVITY_M_S2)
        weights = (self._gains.com_weight, self._gains.com_weight, self._gains.height_weight)
        tasks.add(jacobian, wanted - drift, weights)

    def _add_upright(self, tasks: "_Tasks", data: Any, yaw: Yaw) -> None:
        gains = self._gains
        _, turning = self._jacobians(data, data.xpos[self._pelvis], self._pelvis)
        _, drift = self._drifts(data, data.xpos[self._pelvis], self._pelvis)
        error = _rotation_to(data.xquat[self._pelvis], 0.0, yaw.rad)
        wanted = gains.upright_stiffness * error - gains.upright_damping * (turning @ data.qvel)
        wanted[2] += gains.upright_damping * yaw.rad_s
        tasks.add(turning, wanted - drift, (gains.upright_weight,) * 3)

    def _add_swing(self, tasks: "_Tasks", data: Any, side: int, foot: FootTarget) -> None:
        gains, body = self._gains, self._feet[side]
        point = self._point(data, side, self._body.legs[side].sole_m)
        moving, turning = self._jacobians(data, point, body)
        moving_drift, turning_drift = self._drifts(data, point, body)
        wanted = (
            foot.acceleration_m_s2
            + gains.swing_stiffness * (foot.position_m - point)
            + gains.swing_damping * (foot.velocity_m_s - moving @ data.qvel)
        )
        tasks.add(moving, wanted - moving_drift, (gains.swing_weight,) * 3)
        level = self._levelling(data, side, foot, turning)
        tasks.add(turning, level - turning_drift, (gains.sole_weight,) * 3)

    def _add_stance(self, tasks: "_Tasks", data: Any, side: int, foot: FootTarget) -> None:
        gains, body, leg = self._gains, self._feet[side], self._body.legs[side]
        on_toe = foot.contact is Contact.TOE
        point = self._point(data, side, leg.toe_m if on_toe else leg.sole_m)
        moving, turning = self._jacobians(data, point, body)
        moving_drift, turning_drift = self._drifts(data, point, body)
        wanted = -gains.stance_damping * (moving @ data.qvel)
        wanted[2] -= gains.stance_height_stiffness * point[2]
        tasks.add(moving, wanted - moving_drift, (gains.stance_weight,) * 3)
        level = self._levelling(data, side, foot, turning)
        pitch_weight = gains.heel_off_weight if on_toe else gains.stance_weight
        weights = (gains.stance_weight, pitch_weight, gains.stance_weight)
        to_foot = _yaw_matrix(-foot.yaw.rad)
        tasks.add(to_foot @ turning, to_foot @ (level - turning_drift), weights)

    def _levelling(self, data: Any, side: int, foot: FootTarget, turning: np.ndarray) -> np.ndarray:
        error = _rotation_to(data.xquat[self._feet[side]], foot.pitch_rad, foot.yaw.rad)
        gains = self._gains
        level = gains.sole_stiffness * error - gains.sole_damping * (turning @ data.qvel)
        level[2] += gains.sole_damping * foot.yaw.rad_s
        return np.asarray(level)

    def _corners(self, data: Any, side: int, contact: Contact) -> list[np.ndarray]:
        """Jacobians of the corners that may carry."""
        corners_m = self._body.legs[side].corners_m[: 2 if contact is Contact.TOE else 4]
        points = (self._point(data, side, corner_m) for corner_m in corners_m)
        return [self._jacobians(data, point, self._feet[side])[0] for point in points]

    def _point(self, data: Any, side: int, local_m: np.ndarray) -> np.ndarray:
        body = self._feet[side]
        return np.asarray(data.xpos[body] + data.xmat[body].reshape(3, 3) @ local_m)

    def _jacobians(self, data: Any, point: np.ndarray, body: int) -> tuple[np.ndarray, np.ndarray]:
        moving, turning = np.zeros((2, 3, self._model.nv))
        mujoco.mj_jac(self._model, data, moving, turning, point, body)
        return moving, turning

    def _drifts(self, data: Any, point: np.ndarray, body: int) -> tuple[np.ndarray, np.ndarray]:
        """Accelerations of the point and of the body's orientation while q'' is 0."""
        moving, turning = np.zeros((2, 3, self._model.nv))
        mujoco.mj_jacDot(self._model, data, moving, turning, point, body)
        return moving @ data.qvel, turning @ data.qvel

    def _solve(
        self, data: Any, tasks: "_Tasks", bias: np.ndarray, loaded: list["_Loaded"]
    ) -> np.ndarray | None:
        layout = tuple(len(foot.corners) for foot in loaded)
        programme = self._programmes.get(layout) or self._new_programme(layout)
        corners = [jacobian for foot in loaded for jacobian in foot.corners]
        forces = np.vstack(corners) if corners else np.zeros((0, self._model.nv))
        dynamics = np.hstack([self._inertia, -forces.T])  # of q'' and forces; plus bias: torques
        programme.set_tasks(tasks)
        programme.set_dynamics(dynamics, bias, self._torque_max)
        programme.set_loads([foot.load_max_n for foot in loaded])
        programme.set_knees([self._knee_least(data, knee) for knee in self._knees])
        answer, solved = programme.solve()
        self.unsolved += not solved
        if not np.isfinite(answer).all():
            return None
        return np.clip(dynamics[6:] @ answer + bias[6:], -self._torque_max, self._torque_max)

    def _new_programme(self, layout: tuple[int, ...]) -> "_Programme":
        knees = [int(knee.dofadr[0]) for knee in self._knees]
        made = _Programme(self._model.nv, layout, knees, self._body.knee_sign, self._gains)
        return self._programmes.setdefault(layout, made)

    def _knee_least(self, data: Any, knee: Any) -> float:
        """The least acceleration that bends it, by which it stays bent."""
        gains, sign = self._gains, self._body.knee_sign
        bend, rate = sign * data.qpos[knee.qposadr[0]], sign * data.qvel[knee.dofadr[0]]
        missing = gains.knee_bend_min_rad - bend
        return float(gains.knee_stiffness * missing - gains.knee_damping * rate)


@dataclass(frozen=True)
class _Loaded:
    corners: list[np.ndarray]  # Jacobians of those that may carry
    load_max_n: float


class _Tasks:
    """Wanted accelerations, as rows of a weighted least squares."""

    def __init__(self) -> None:
        self._rows: list[np.ndarray] = []
        self._wanted: list[np.ndarray] = []

    def add(self, jacobian: np.ndarray, wanted: np.ndarray, weights: tuple[float, ...]) -> None:
        scale = np.sqrt(weights)
        self._rows.append(jacobian * scale[:, None])
        self._wanted.append(wanted * scale)

    def least_squares(self) -> tuple[np.ndarray, np.ndarray]:
        """Hessian and gradient, the latter at 0 and downwards."""
        rows = np.vstack(self._rows)
        return rows.T @ rows, rows.T @ np.concatenate(self._wanted)


class _Programme:
    """The quadratic programme for one number of corners under each loaded foot."""

    def __init__(
        self, nv: int, layout: tuple[int, ...], knees: list[int], knee_sign: float, gains: Gains
    ) -> None:
        corners, joints = sum(layout), nv - 6
        self._nv, self._size = nv, nv + 3 * corners
        self._gains = gains
        self._hessian = np.zeros((self._size, self._size))
        np.fill_diagonal(self._hessian[nv:, nv:], gains.force_weight)
        self._gradient = np.zeros(self._size)
        rows = np.cumsum([0, 4 * corners, len(layout), len(knees), joints])
        self._loads, self._knees, self._torques = (slice(rows[k], rows[k + 1]) for k in range(1, 4))
        self._limits = np.zeros((rows[-1], self._size))
        self._low, self._high = np.full(rows[-1], -UNLIMITED), np.full(rows[-1], UNLIMITED)
        self._limit_friction(corners)
        self._limit_loads(layout)
        for row, knee in enumerate(knees):
            self._limits[self._knees.start + row, knee] = knee_sign
        self._least = np.full(self._size, -UNLIMITED)
        self._least[nv + 2 :: 3] = 0.0  # the floor pushes
        self._most = np.full(self._size, UNLIMITED)

    def _limit_friction(self, corners: int) -> None:
        """Four faces of a pyramid for each corner."""
        for corner in range(corners):
            x = self._nv + 3 * corner
            for face, (axis, sign) in enumerate(((0, 1), (0, -1), (1, 1), (1, -1))):
                self._limits[4 * corner + face, x + axis] = sign
                self._limits[4 * corner + face, x + 2] = -self._gains.friction
        self._high[: 4 * corners] = 0.0

    def _limit_loads(self, layout: tuple[int, ...]) -> None:
        first = self._nv
        for row, corners in enumerate(layout):
            self._limits[self._loads.start + row, first + 2 : first + 3 * corners : 3] = 1.0
            first += 3 * corners
        self._low[self._loads] = 0.0

    def set_tasks(self, tasks: _Tasks) -> None:
        nv = self._nv
        hessian, gradient = tasks.least_squares()
        self._hessian[:nv, :nv] = hessian
        self._hessian[range(nv), range(nv)] += self._gains.acceleration_weight
        self._gradient[:nv] = -gradient

    def set_dynamics(self, dynamics: np.ndarray, bias: np.ndarray, torque_max: np.ndarray) -> None:
        self._base, self._base_forces = dynamics[:6], -bias[:6]
        self._limits[self._torques] = dynamics[6:]
        self._low[self._torques] = -torque_max - bias[6:]
        self._high[self._torques] = torque_max - bias[6:]

    def set_loads(self, most_n: list[float]) -> None:
        self._high[self._loads] = most_n

    def set_knees(self, least: list[float]) -> None:
        self._low[self._knees] = least

    def solve(self) -> tuple[np.ndarray, bool]:
        """Accelerations and forces, and whether they are the optimum."""
        solver = piqp.DenseSolver()
        solver.settings.verbose = False
        solver.settings.max_iter = ITERATIONS_MAX
        solver.settings.preconditioner_iter = 0  # it costs a third, and more iterations
        solver.settings.check_duality_gap = False  # the residuals decide; the gap stalls at 1e-4
        solver.settings.eps_abs, solver.settings.eps_rel = TOLERANCE_ABSOLUTE, TOLERANCE_RELATIVE
        solver.setup(
            *(self._hessian, self._gradient, self._base, self._base_forces),
            *(self._limits, self._low, self._high, self._least, self._most),
        )
        solved = solver.solve() == piqp.PIQP_SOLVED
        return solver.result.x, solved


def _rotation_to(quaternion: np.ndarray, pitch_rad: float, yaw_rad: float) -> np.ndarray:
    """The rotation vector, in the world, from an orientation to a level one with that pitch, which
    is then turned to that yaw."""
    pitch = math.cos(pitch_rad / 2), math.sin(pitch_rad / 2)
    yaw = math.cos(yaw_rad / 2), math.sin(yaw_rad / 2)
    wanted = np.array([yaw[0] * pitch[0], -yaw[1] * pitch[1], yaw[0] * pitch[1], yaw[1] * pitch[0]])
    inverse, turn, error = np.zeros(4), np.zeros(4), np.zeros(3)
    mujoco.mju_negQuat(inverse, quaternion)
    mujoco.mju_mulQuat(turn, wanted, inverse)
    mujoco.mju_quat2Vel(error, turn, 1.0)
    return error


def _yaw_matrix(yaw_rad: float) -> np.ndarray:
    cosine, sine = math.cos(yaw_rad), math.sin(yaw_rad)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
