"""Linear model-predictive control of walking, as a quadratic programme over the whole horizon.

The linear inverted pendulum under piecewise constant jerk; the CoP stays within the stance foot and
near its middle, the CoM at its speed, the jerk small (Wieber 2006; Herdt et al. 2010). Feet are
given. The axes are independent, so each has its own programme.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from saddlewalk.benchmark.baselines import MissingError
from saddlewalk.contract import GRAVITY_M_S2

SOLVERS = ("quadprog", "daqp", "osqp")
INSTALL = "not installed: make bench-baselines"

# Weights relative to the squared distance of the CoP from the middle of the foot, m^2.
JERK_WEIGHT_S6 = 1e-6
VELOCITY_WEIGHT_S2 = 1e-2


@dataclass(frozen=True)
class Axis:
    """One axis of the task: present position, velocity and acceleration; stance CoP at each
    instant.
    """

    state: np.ndarray
    velocity_m_s: float
    stance_m: np.ndarray
    half_foot_m: float


@dataclass(frozen=True)
class Preview:
    """The matrices that all programmes of a horizon share. Instants are period_s apart, from
    period_s on.
    """

    instants: int
    period_s: float
    height_m: float

    @cached_property
    def _free(self) -> tuple[np.ndarray, np.ndarray]:
        """Velocity and CoP at each instant as linear functions of the state, without jerk:
        (instants, 3).
        """
        t = self.period_s * np.arange(1, self.instants + 1)
        one, zero = np.ones_like(t), np.zeros_like(t)
        velocity = np.column_stack([zero, one, t])
        cop = np.column_stack([one, t, t**2 / 2 - self.height_m / GRAVITY_M_S2])
        return velocity, cop

    @cached_property
    def _forced(self) -> tuple[np.ndarray, np.ndarray]:
        """Velocity and CoP at each instant for a unit jerk in each period: (instants, instants)."""
        later = np.subtract.outer(np.arange(self.instants), np.arange(self.instants))
        period = self.period_s
        velocity = (1 + 2 * later) * period**2 / 2
        cop = (1 + 3 * later + 3 * later**2) * period**3 / 6
        cop = cop - period * self.height_m / GRAVITY_M_S2
        return np.where(later >= 0, velocity, 0), np.where(later >= 0, cop, 0)

    @cached_property
    def hessian(self) -> np.ndarray:
        velocity, cop = self._forced
        jerk = JERK_WEIGHT_S6 * np.eye(self.instants)
        return jerk + VELOCITY_WEIGHT_S2 * velocity.T @ velocity + cop.T @ cop

    @cached_property
    def constraints(self) -> np.ndarray:
        cop = self._forced[1]
        return np.vstack([cop, -cop])

    def gradient_and_bounds(self, axis: Axis) -> tuple[np.ndarray, np.ndarray]:
        """q and h of: minimise x' hessian x / 2 + q' x, constraints x <= h."""
        velocity, cop = self._forced
        free_velocity, free_cop = (matrix @ axis.state for matrix in self._free)
        to_middle = axis.stance_m - free_cop
        q = -VELOCITY_WEIGHT_S2 * velocity.T @ (axis.velocity_m_s - free_velocity)
        q -= cop.T @ to_middle
        return q, np.concatenate([to_middle + axis.half_foot_m, axis.half_foot_m - to_middle])

    def cop_m(self, axis: Axis, jerk: np.ndarray) -> np.ndarray:
        return self._free[1] @ axis.state + self._forced[1] @ jerk


class WalkingQp:
    """The programmes of a horizon, for one solver of qpsolvers."""

    def __init__(self, solver: str, preview: Preview) -> None:
        try:
            import qpsolvers
        except ImportError as error:
            raise MissingError(f"qpsolvers is {INSTALL}") from error
        if solver not in qpsolvers.available_solvers:
            raise MissingError(f"{solver} is {INSTALL}")
        self._solve_qp = qpsolvers.solve_qp
        self._solver = solver
        self._preview = preview
        self._matrices = preview.hessian, preview.constraints
        if solver == "osqp":
            from scipy.sparse import csc_matrix

            self._matrices = tuple(csc_matrix(matrix) for matrix in self._matrices)

    def jerk(self, axis: Axis) -> np.ndarray:
        """The jerk in each period. Raises MissingError if the solver finds none."""
        q, h = self._preview.gradient_and_bounds(axis)
        hessian, constraints = self._matrices
        found = self._solve_qp(hessian, q, constraints, h, solver=self._solver)
        if found is None:
            raise MissingError(f"{self._solver} finds no walk of {len(h) // 2} instants")
        return found
