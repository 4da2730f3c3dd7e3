"""Two textbook margins to compare with, from the same measurements: outlines of the feet alone.

A foot is a rectangle about its CoP. Of a person it is 0.152 of the body's height long and 0.055
broad (Drillis and Contini 1966, as in Winter, Biomechanics and Motor Control of Human Movement).
"""

import numpy as np

FOOT_LENGTH = 0.152  # of the body's height
FOOT_BREADTH = 0.055


def half_foot_m(height_m: float) -> np.ndarray:
    """Half the length and breadth of the foot, for a body height."""
    return np.array([FOOT_LENGTH, FOOT_BREADTH]) * height_m / 2


def hull_margin_m(point_m: np.ndarray, cop_m: np.ndarray, half_m: np.ndarray) -> np.ndarray:
    """Signed distance of each point to the border of the convex hull of two feet, positive inside.

    point_m: (n, 2); cop_m: (n, 2, 2), left and right; the same CoP twice: one foot. half_m: (2,),
    half of a foot's length and breadth.
    """
    corners_m = hull_corners_m(cop_m[:, 1] - cop_m[:, 0], half_m)
    return convex_margin_m(point_m - cop_m[:, 0], corners_m)


def hof_margin_m(
    xcom_m: np.ndarray, cop_m: np.ndarray, contact: np.ndarray, half_m: np.ndarray
) -> np.ndarray:
    """Hof's margin of stability (2005): of the XCoM in the hull of the feet on the ground.

    NaN if no foot is. contact: (n, 2) of bool.
    """
    standing_m = np.where(contact[..., None], cop_m, cop_m[:, ::-1])
    margin_m = hull_margin_m(xcom_m, standing_m, half_m)
    return np.where(contact.any(axis=1), margin_m, np.nan)


def hull_corners_m(apart_m: np.ndarray, half_m: np.ndarray) -> np.ndarray:
    """(n, 6, 2): the hull of two upright rectangles, the first about 0, counter-clockwise.

    apart_m: (n, 2), from the first to the second; half_m: (2,), their half sides.
    """
    sign = np.where(apart_m < 0, -1.0, 1.0)
    along = np.abs(apart_m)
    x, y = half_m
    first = np.array([(-x, y), (-x, -y), (x, -y)])
    second = np.array([(x, -y), (x, y), (-x, y)])
    corners = np.concatenate(
        [np.broadcast_to(first, (len(along), 3, 2)), along[:, None, :] + second], axis=1
    )
    mirrored = corners * sign[:, None, :]
    turned = sign.prod(axis=1) < 0
    mirrored[turned] = mirrored[turned, ::-1]
    return mirrored


def convex_margin_m(point_m: np.ndarray, corners_m: np.ndarray) -> np.ndarray:
    """Signed distance of (n, 2) points to the border of (n, k, 2) convex polygons, positive inside.

    Corners counter-clockwise; edges of no length are allowed.
    """
    edge = np.roll(corners_m, -1, axis=1) - corners_m
    offset = point_m[:, None, :] - corners_m
    squared = (edge**2).sum(axis=2)
    along = np.divide((offset * edge).sum(axis=2), squared, where=squared > 0, out=0 * squared)
    nearest = np.clip(along, 0, 1)[..., None] * edge
    distance = np.sqrt(((offset - nearest) ** 2).sum(axis=2)).min(axis=1)
    left_of = edge[..., 0] * offset[..., 1] - edge[..., 1] * offset[..., 0]
    return np.where((left_of >= 0).all(axis=1), distance, -distance)
