"""The body as it is drawn: its shapes in a pose, in the world."""

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from saddlewalk.contract import SIDES

ROUND = [math.pi * k / 12 for k in range(13)]  # of a cap or, twice, of a sphere


@dataclass(frozen=True)
class Pose:
    time_s: float
    qpos: np.ndarray

    def seen_in(self, heading_rad: float) -> "Pose":
        """In axes of that heading, about the same origin."""
        to_heading = cmath.rect(1.0, -heading_rad)
        qpos, place = self.qpos.copy(), complex(*self.qpos[:2]) * to_heading
        qpos[:2] = place.real, place.imag
        turn = np.array([math.cos(heading_rad / 2), 0.0, 0.0, -math.sin(heading_rad / 2)])
        mujoco.mju_mulQuat(qpos[3:7], turn, self.qpos[3:7])
        return Pose(self.time_s, qpos)


@dataclass(frozen=True)
class Outline:
    """Of one shape, seen from the side."""

    side: str  # left, right, or empty: of the trunk
    points_m: np.ndarray  # (n, 2): forward and up


def side_view(model: Any, pose: Pose) -> Iterator[Outline]:
    """The shapes of all limbs, those on the far side first."""
    data = mujoco.MjData(model)
    data.qpos[:] = pose.qpos
    mujoco.mj_kinematics(model, data)
    floor = model.geom("floor").id
    for geom in sorted(set(range(model.ngeom)) - {floor}, key=lambda g: -data.geom_xpos[g][1]):
        points_m = _outline(model, data, geom)
        if len(points_m):
            yield Outline(_side(model.body(model.geom_bodyid[geom]).name), points_m)


def _side(body: str) -> str:
    return next((side for side in SIDES if body.startswith(side)), "")


def _outline(model: Any, data: Any, geom: int) -> np.ndarray:
    """Convex; empty for shapes that a body does not have."""
    kind, size = int(model.geom_type[geom]), model.geom_size[geom]
    centre, rotation = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return _hull((centre + (signs * size) @ rotation.T)[:, [0, 2]])
    if kind not in map(int, (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_CAPSULE)):
        return np.zeros((0, 2))
    half = rotation[:, 2] * size[1] if kind == mujoco.mjtGeom.mjGEOM_CAPSULE else np.zeros(3)
    ends = (centre + half)[[0, 2]], (centre - half)[[0, 2]]
    along = ends[0] - ends[1]
    turn = math.atan2(along[1], along[0]) - math.pi / 2
    return np.array(
        [
            end + size[0] * np.array([math.cos(turn + begin + a), math.sin(turn + begin + a)])
            for end, begin in zip(ends, (0.0, math.pi), strict=True)
            for a in ROUND
        ]
    )


def _hull(points: np.ndarray) -> np.ndarray:
    """Counterclockwise, by angle about the middle: right for the corners of a box."""
    away = points - points.mean(axis=0)
    order = np.argsort(np.arctan2(away[:, 1], away[:, 0]))
    far = np.hypot(away[:, 0], away[:, 1])
    kept = [k for k in order if far[k] > 0.6 * far.max()]
    return points[kept]
