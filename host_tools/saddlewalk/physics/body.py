"""Bodies for MuJoCo, and what a controller has to know of each."""

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np

from saddlewalk.config import ANKLES
from saddlewalk.contract import GRAVITY_M_S2, SIDES

TIMESTEP_S = 1e-3
# Contacts: as stiff as a step of 1 ms allows, November 2026; friction of a shoe on a dry floor.
SOLREF, SOLIMP = (0.008, 1.0), (0.9, 0.99, 0.002, 0.5, 2.0)
FRICTION = (1.0, 0.005, 0.0001)
CORNER_RADIUS_M = 0.01

# Winter, Biomechanics and Motor Control of Human Movement, 2009, table 4.1: mass
# of the whole body's, CoM of the length from the proximal end, radius of gyration about it.
THIGH, SHANK, FOOT = (0.100, 0.433, 0.323), (0.0465, 0.433, 0.302), (0.0145, 0.5, 0.475)
UPPER_BODY = (0.678, 0.626, 0.496)  # head, arms and trunk, from the hips
# Drillis and Contini, Body Segment Parameters, 1966: of the body's height.
THIGH_LENGTH, SHANK_LENGTH, ANKLE_HEIGHT, TRUNK_LENGTH = 0.245, 0.246, 0.039, 0.288
FOOT_LENGTH, FOOT_WIDTH = 0.152, 0.055
HIP_HALF_WIDTH = 0.055  # between the joint centres, narrower than the pelvis
ANKLE_BEHIND = 0.25  # of the foot's length, behind its middle

# Joint -> axis, range in rad, greatest torque in N m. Order from hip to foot.
JOINTS: Mapping[str, tuple[tuple[float, float, float], tuple[float, float], float]] = {
    "hip_yaw": ((0, 0, 1), (-0.7, 0.7), 80.0),
    "hip_roll": ((1, 0, 0), (-0.8, 0.8), 180.0),
    "hip_pitch": ((0, 1, 0), (-2.1, 0.7), 220.0),
    "knee": ((0, 1, 0), (0.0, 2.4), 220.0),
    "ankle_pitch": ((0, 1, 0), (-0.7, 1.0), 180.0),
    "ankle_roll": ((1, 0, 0), (-0.5, 0.5), 60.0),
}
JOINT_DAMPING, JOINT_ARMATURE = 0.5, 0.02  # N m s/rad, kg m2

# Fields of saddle_config_t for any body. A late foot reaches down until it carries; to wait for it
# until the tick after would be longer.
WALK_FIELDS: Mapping[str, float | int] = {
    "ankle": ANKLES["cycloid"],
    "swing_approach": 0.3,
    "landing_late_s": 0.0,
}
# Knees bent enough for the steps of 1.6 m/s, and braking that nearly straight legs bear; a step's
# width that hips with torque limits bear.
WINTER_FIELDS: Mapping[str, float | int] = {
    **WALK_FIELDS,
    "pendulum_ratio": 0.53,
    "acceleration_m_s2": 0.35,
    "step_width_fast_m": 0.16,
}


@dataclass(frozen=True)
class Leg:
    """Names in the model. corners_m: of the sole in the foot's frame, the two at the toe first."""

    foot: str
    knee: str
    corners_m: np.ndarray  # (4, 3)

    @functools.cached_property
    def toe_m(self) -> np.ndarray:
        return np.asarray(self.corners_m[:2].mean(axis=0))

    @functools.cached_property
    def heel_m(self) -> np.ndarray:
        return np.asarray(self.corners_m[2:].mean(axis=0))

    @functools.cached_property
    def sole_m(self) -> np.ndarray:
        """The middle of the sole, which stands for the foot in plans and measurements."""
        return np.asarray(self.corners_m.mean(axis=0))

    @functools.cached_property
    def half_length_m(self) -> float:
        return float(np.ptp(self.corners_m[:, 0]) / 2)


@dataclass(frozen=True)
class Body:
    """A compiled model of a body on a floor with a torque motor at every joint of its legs."""

    name: str
    model: Any  # mujoco.MjModel
    pelvis: str
    legs: tuple[Leg, Leg]
    knee_sign: float  # of the joint angle of a bent knee
    sole_half_width_m: float  # within which the CoP is kept
    landed_early_n: float  # load of a foot that has landed before its time

    @property
    def mass_kg(self) -> float:
        return float(self.model.body_mass.sum())


@dataclass(frozen=True)
class LegLengths:
    """By the names of saddle_legs_t."""

    thigh_m: float
    shank_m: float
    ankle_height_m: float
    hip_half_width_m: float
    foot_length_m: float
    ankle_to_middle_m: float
    foot_width_m: float

    @classmethod
    def of(cls, height_m: float, measured: Mapping[str, float]) -> "LegLengths":
        """Average ones; what was measured takes their place."""
        average = cls(
            THIGH_LENGTH * height_m,
            SHANK_LENGTH * height_m,
            ANKLE_HEIGHT * height_m,
            HIP_HALF_WIDTH * height_m,
            FOOT_LENGTH * height_m,
            ANKLE_BEHIND * (FOOT_LENGTH * height_m),
            FOOT_WIDTH * height_m,
        )
        known = {name: value for name, value in measured.items() if hasattr(average, name)}
        return replace(average, **known)


def winter(
    height_m: float, mass_kg: float, legs: Mapping[str, float] = MappingProxyType({})
) -> Body:
    """A person of average proportions; the upper body is one segment.

    legs: measured lengths, by the names of saddle_legs_t, in place of the average ones.
    """
    spec = new_world()
    lengths, trunk_m = LegLengths.of(height_m, legs), TRUNK_LENGTH * height_m
    hips_m = lengths.thigh_m + lengths.shank_m + lengths.ankle_height_m
    pelvis = spec.worldbody.add_body(name="pelvis", pos=(0, 0, hips_m))
    pelvis.add_freejoint()
    mass, com, gyration = UPPER_BODY
    inertia = mass * mass_kg * (gyration * trunk_m) ** 2
    _set_inertia(pelvis, mass * mass_kg, (0, 0, com * trunk_m), (inertia, inertia, inertia / 4))
    _add_shape(pelvis, mujoco.mjtGeom.mjGEOM_CAPSULE, (0.12,), (0, 0, 0.05), (0, 0, trunk_m))
    _add_shape(pelvis, mujoco.mjtGeom.mjGEOM_SPHERE, (0.1,), (0, 0, trunk_m + 0.22))
    both = tuple(_add_leg(pelvis, name, lengths, mass_kg) for name in SIDES)
    torques = {f"{side}_{name}": torque for side in SIDES for name, (*_, torque) in JOINTS.items()}
    model = compiled(spec, torques)
    return Body("winter", model, "pelvis", (both[0], both[1]), 1.0, 0.040, 60.0)


def _add_leg(pelvis: Any, side: str, lengths: LegLengths, mass_kg: float) -> Leg:
    thigh_m, shank_m, ankle_m = lengths.thigh_m, lengths.shank_m, lengths.ankle_height_m
    length_m, width_m = lengths.foot_length_m, lengths.foot_width_m

    outward = 1 if side == "left" else -1
    hip_m = (0, outward * lengths.hip_half_width_m, 0)
    thigh = _add_segment(pelvis, f"{side}_thigh", hip_m, thigh_m, (*THIGH, 0.15), mass_kg)
    shank = _add_segment(thigh, f"{side}_shank", (0, 0, -thigh_m), shank_m, (*SHANK, 0.1), mass_kg)
    foot = shank.add_body(name=f"{side}_foot", pos=(0, 0, -shank_m))
    _add_joints(thigh, side, "hip_yaw hip_roll hip_pitch")
    _add_joints(shank, side, "knee")
    _add_joints(foot, side, "ankle_pitch ankle_roll")

    ahead_m = lengths.ankle_to_middle_m  # the middle of the foot, from the ankle
    share, _, gyration = FOOT
    inertia = share * mass_kg * (gyration * length_m) ** 2
    _set_inertia(
        foot, share * mass_kg, (ahead_m, 0, -ankle_m / 2), (0.3 * inertia, inertia, inertia)
    )
    half = (length_m / 2 - 0.01, width_m / 2 - 0.005, ankle_m / 2 - 0.012)
    _add_shape(foot, mujoco.mjtGeom.mjGEOM_BOX, half, (ahead_m, 0, -ankle_m / 2))
    along_m, across_m = length_m / 2 - CORNER_RADIUS_M, width_m / 2 - 0.002
    corners_m = np.array(
        [(ahead_m + x, y, -ankle_m) for x in (along_m, -along_m) for y in (across_m, -across_m)]
    )
    for corner in corners_m:
        foot.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=(CORNER_RADIUS_M, 0, 0),
            pos=corner + np.array([0, 0, CORNER_RADIUS_M]),
            mass=0,
            **contact(1, 2),
        )
    return Leg(f"{side}_foot", f"{side}_knee", corners_m)


def _add_segment(
    parent: Any,
    name: str,
    pos_m: Sequence[float],
    length_m: float,
    shares: tuple[float, float, float, float],
    mass_kg: float,
) -> Any:
    """A limb that hangs from its proximal joint; shares: mass, CoM, gyration, slenderness."""
    share, com, gyration, slender = shares
    inertia = share * mass_kg * (gyration * length_m) ** 2
    limb = parent.add_body(name=name, pos=pos_m)
    _set_inertia(
        limb, share * mass_kg, (0, 0, -com * length_m), (inertia, inertia, slender * inertia)
    )
    radius_m = 0.06 if "thigh" in name else 0.045
    _add_shape(limb, mujoco.mjtGeom.mjGEOM_CAPSULE, (radius_m,), (0, 0, 0), (0, 0, -length_m))
    return limb


def _set_inertia(
    body: Any, mass_kg: float, com_m: Sequence[float], inertia: Sequence[float]
) -> None:
    body.explicitinertial = True
    body.mass, body.ipos, body.inertia = mass_kg, com_m, inertia


def _add_joints(body: Any, side: str, names: str) -> None:
    for name in names.split():
        axis, limits, _ = JOINTS[name]
        body.add_joint(
            name=f"{side}_{name}",
            axis=axis,
            range=limits,
            limited=True,
            damping=(JOINT_DAMPING, 0, 0),
            armature=JOINT_ARMATURE,
        )


def _add_shape(
    body: Any,
    kind: Any,
    size: Sequence[float],
    from_m: Sequence[float],
    to_m: Sequence[float] | None = None,
) -> None:
    """Something to see; it has no mass and touches nothing."""
    place = {"pos": from_m} if to_m is None else {"fromto": (*from_m, *to_m)}
    size = (*size, *(0.0,) * (3 - len(size)))
    body.add_geom(
        type=kind, size=size, mass=0, contype=0, conaffinity=0, rgba=(0.6, 0.6, 0.7, 1), **place
    )


def contact(kind: int, with_kind: int) -> dict[str, Any]:
    """Of a geom: which kind of contact it is, and with which kinds it collides."""
    return {
        "contype": kind,
        "conaffinity": with_kind,
        "condim": 3,
        "friction": FRICTION,
        "solref": SOLREF,
        "solimp": SOLIMP,
    }


def new_world() -> Any:
    """A mujoco.MjSpec with a floor and light."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.worldbody.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(50, 50, 1), **contact(2, 1)
    )
    spec.worldbody.add_light(pos=(0, 0, 4), dir=(0, 0, -1))
    return spec


def compiled(spec: Any, torques: Mapping[str, float]) -> Any:
    """The mujoco.MjModel of a body, with a motor of the greatest torque at each joint named."""
    spec.option.timestep = TIMESTEP_S
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10
    spec.option.iterations, spec.option.ls_iterations = 100, 50
    spec.option.gravity = (0, 0, -GRAVITY_M_S2)
    hinges = [joint for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_HINGE]
    for joint in hinges:  # in the model's order, so that motors and joints have the same
        greatest = torques[joint.name]
        spec.add_actuator(
            name=joint.name,
            target=joint.name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            ctrllimited=True,
            ctrlrange=(-greatest, greatest),
        )
    return spec.compile()
