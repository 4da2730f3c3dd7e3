"""Which wearer walks: a point mass, or a body in MuJoCo."""

import argparse
import importlib.util
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from saddlewalk.config import given_legs
from saddlewalk.emulation.wearer import Body, Noise, Push, Wearer
from saddlewalk.errors import UserError
from saddlewalk.lockstep_host import LockstepHost
from saddlewalk.options import JOINTS, MUJOCO, WINTER
from saddlewalk.paths import install_command


@dataclass(frozen=True)
class PlantChoice:
    """The point mass, or one of physics.bodies.BODIES in MuJoCo. What is below is MuJoCo's."""

    body: str | None = None  # None: the point mass
    drives_joints: bool = False  # by firmware/joints, see physics.joint_drive
    sensor_delay_s: float = 0.0
    torque_delay_s: float = 0.0  # of the joint commands where it drives joints
    mass_error: float = 0.0  # by which share firmware/joints believes the body heavier,
    leg_error_m: float = 0.0  # and its legs longer
    legs: Mapping[str, float] = field(default_factory=dict)  # measured, of body and firmware/joints

    @property
    def is_mujoco(self) -> bool:
        return self.body is not None

    @property
    def fields(self) -> Mapping[str, float | int]:
        """Fields of saddle_config_t that this wearer needs, under those that a user gives."""
        if self.body is None:
            return MappingProxyType({})
        from saddlewalk.physics.bodies import BODIES

        if self.drives_joints:
            from saddlewalk.physics.joint_drive import FIELDS

            return FIELDS
        return BODIES[self.body].fields()

    def joint_core(self, config: Any) -> LockstepHost | None:
        """The core of the controller of its joints; the point mass has none."""
        return LockstepHost(config) if self.is_mujoco else None

    def wearer(
        self,
        config: Any,
        noise: Noise | None = None,
        pushes: tuple[Push, ...] = (),
        seed: int = 0,
        **behaviour: Any,
    ) -> Wearer:
        """With the body that the firmware's configuration describes; behaviour: as of Wearer."""
        if self.body is None:
            return Wearer(Body.of(config), noise, pushes, seed, **behaviour)
        from saddlewalk.physics.bodies import BODIES
        from saddlewalk.physics.plant import Plant
        from saddlewalk.physics.wearer import PhysicalWearer

        if self.drives_joints:
            from saddlewalk.physics.body import winter
            from saddlewalk.physics.joint_drive import BodyErrors, JointWearer

            plant = Plant(winter(config.body_height_m, config.body_mass_kg, self.legs))
            behaviour["command_delay_s"] = self.torque_delay_s
            behaviour["wrong"] = BodyErrors(self.mass_error, self.leg_error_m)
            behaviour["legs"] = self.legs
            return JointWearer(plant, config, noise, pushes, seed, **behaviour)
        plant = Plant(BODIES[self.body].make(config), self.torque_delay_s)
        behaviour["sensor_delay_s"] = self.sensor_delay_s
        return PhysicalWearer(plant, config, noise, pushes, seed, **behaviour)


POINT_MASS = PlantChoice()


def chosen_plant(args: argparse.Namespace) -> PlantChoice:
    """The choice of --plant, --body and --drive. Raises UserError if it is not possible."""
    if args.plant != MUJOCO:
        if args.drive is not None:
            raise UserError(f"--drive {args.drive}: only with --plant {MUJOCO}")
        if args.body is not None:
            raise UserError(f"--body {args.body}: only with --plant {MUJOCO}")
        return POINT_MASS
    for package in ("mujoco", "piqp"):
        if importlib.util.find_spec(package) is None:
            raise UserError(f"--plant {MUJOCO} needs {package}: {install_command('physics')}")
    choice = PlantChoice(args.body or WINTER, args.drive == JOINTS)
    if choice.drives_joints:
        choice = replace(choice, legs=given_legs(args))
    if choice.drives_joints and choice.body != WINTER:
        raise UserError(f"--drive {JOINTS}: only with the body {WINTER}, whose segments it knows")
    if choice.body != WINTER and (args.height, args.mass) != (None, None):
        option = "--mass" if args.height is None else "--height"
        raise UserError(f"{option}: the body {choice.body} has its own, leave it out")
    return choice
