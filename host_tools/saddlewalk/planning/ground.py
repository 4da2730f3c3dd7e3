"""A plan on the ground: from the axes of its stance foot to those where the way began."""

import cmath
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


def on_arc(curvature_1_m: float, place_m: complex) -> complex:
    """[E47] A place along (real) and across (imaginary) an arc, in the axes of its origin."""
    turn_rad = curvature_1_m * place_m.real
    if turn_rad == 0:
        return place_m
    half_turn = cmath.rect(1.0, turn_rad / 2)
    chord_m = 2 * math.sin(turn_rad / 2) / curvature_1_m
    return chord_m * half_turn + 1j * place_m.imag * half_turn**2


def yaws_of(plan: Any) -> tuple[float, float]:
    """Heading of the left and the right foot, without a jump within half a turn of each other."""
    left, right = plan.foot_yaw_rad
    return plan.heading_rad + left, plan.heading_rad + right
