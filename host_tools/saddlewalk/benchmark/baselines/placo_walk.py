"""placo's walk planner, used as in its examples: footsteps, supports, and the CoM by its QP.

It walks from standing to standing, so its plan is a first and a last double support longer than the
strides requested. It plans for a robot; this one is the simplest that it accepts.
"""

import numpy as np

from saddlewalk.benchmark.baselines import MissingError
from saddlewalk.stderr_redirect import stderr_silenced

# The foot, also for the walking QP, in m; placo's feet point along x.
FOOT_WIDTH_M = 0.08
FOOT_LENGTH_M = 0.20

_INERTIA = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'
_LIMIT = '<limit lower="-2" upper="2" effort="100" velocity="10"/>'


class PlacoWalk:
    """One walk at constant speed on flat ground."""

    def __init__(
        self, step_m: float, step_time_s: float, width_m: float, height_m: float, period_s: float
    ) -> None:
        try:
            with stderr_silenced():
                import placo

                self._robot = placo.HumanoidRobot(
                    "", placo.Flags.ignore_collisions, _biped(width_m, height_m)
                )
        except ImportError as error:
            raise MissingError("placo is not installed: pip install placo") from error
        self._placo = placo
        self._step_m = step_m
        self._height_m = height_m
        self._feet = np.eye(4), np.eye(4)
        self._feet[0][1, 3], self._feet[1][1, 3] = width_m / 2, -width_m / 2
        parameters = placo.HumanoidParameters()
        parameters.single_support_duration = step_time_s
        parameters.single_support_timesteps = round(step_time_s / period_s)
        parameters.double_support_ratio = 0.0
        parameters.walk_com_height = height_m
        parameters.walk_max_dx_forward = step_m
        parameters.feet_spacing = width_m
        parameters.foot_length, parameters.foot_width = FOOT_LENGTH_M, FOOT_WIDTH_M
        parameters.zmp_margin = 0.0
        self._parameters = parameters

    def plan(self, steps: int) -> object:
        """placo's trajectory for this number of steps. Raises MissingError if it finds none."""
        placo, parameters = self._placo, self._parameters
        parameters.planned_timesteps = (steps + 2) * parameters.single_support_timesteps
        planner = placo.FootstepsPlannerRepetitive(parameters)
        planner.configure(self._step_m, 0.0, 0.0, steps)
        footsteps = planner.plan(placo.HumanoidRobot_Side.left, *self._feet)
        supports = placo.FootstepsPlanner.make_supports(footsteps, 0.0, True, False, True)
        generator = placo.WalkPatternGenerator(self._robot, parameters)
        try:
            return generator.plan(supports, np.array([0.0, 0.0, self._height_m]), 0.0)
        except RuntimeError as error:
            raise MissingError(f"placo finds no walk of {steps} steps: {error}") from error


def _biped(width_m: float, height_m: float) -> str:
    """URDF: a trunk, and two legs with a hip and an ankle."""
    parts = [_link("trunk", 50)]
    for side, y in (("left", width_m / 2), ("right", -width_m / 2)):
        leg, foot = f"{side}_leg", f"{side}_foot"
        parts += [_link(leg, 5), _link(foot, 1)]
        parts += [_joint("trunk", leg, f"0 {y} 0"), _joint(leg, foot, f"0 0 {-height_m}")]
    return f'<robot name="biped">{"".join(parts)}</robot>'


def _link(name: str, mass_kg: float) -> str:
    return f'<link name="{name}"><inertial><mass value="{mass_kg}"/>{_INERTIA}</inertial></link>'


def _joint(parent: str, child: str, place: str) -> str:
    return (
        f'<joint name="to_{child}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{place}"/><axis xyz="0 1 0"/>{_LIMIT}</joint>'
    )
