"""A plan on the ground: from the axes of its stance foot to those where the way began."""

import math
from typing import Any


def turned(plan: Any, vector: Any) -> tuple[float, float]:
    """A vector of a saddle_plan_t."""
    if plan.heading_rad == 0:
        return vector.x, vector.y
    cosine, sine = math.cos(plan.heading_rad), math.sin(plan.heading_rad)
    return cosine * vector.x - sine * vector.y, sine * vector.x + cosine * vector.y


def place_of(plan: Any, point: Any) -> tuple[float, float]:
    """A point of a saddle_plan_t."""
    x, y = turned(plan, point)
    return plan.origin_x_nm * 1e-9 + x, plan.origin_y_nm * 1e-9 + y


def yaws_of(plan: Any) -> tuple[float, float]:
    """Heading of the left and the right foot, without a jump within half a turn of each other."""
    left, right = plan.foot_yaw_rad
    return plan.heading_rad + left, plan.heading_rad + right
