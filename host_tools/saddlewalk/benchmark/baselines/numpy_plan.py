"""The paper's plan in plain numpy, one function per group of equations.

A steady walk, Phase0 = 0, the left foot at x = 0 (docs/equations.md names the tags). Every function
of time takes one instant or an array of them, in seconds.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.contract import GRAVITY_M_S2

ANKLE_TIME_CONSTANT_S = 0.11
CLEARANCE_M = 0.05

_erf = np.vectorize(math.erf, otypes=[float])


@dataclass(frozen=True)
class Body:
    """The paper's mean person."""

    height_m: float = 1.79
    mass_kg: float = 63.3
    d_h_m: float = 0.10
    peak_speed_m_s: float = 3.0


def plan(
    body: Body, speed_m_s: float, heel_strike_rad: float, t_s: np.ndarray
) -> dict[str, np.ndarray]:
    """Plan, scores, gravity and margins at t_s, under the names of `saddlewalk plan`'s columns."""
    pendulum = 0.57 * body.height_m  # [E1]
    frequency = np.sqrt(GRAVITY_M_S2 / pendulum)  # [E2]
    width = step_width(speed_m_s)
    half_step = 0.1802 * speed_m_s + 0.1351  # [E4]
    step_time = 2 * half_step / speed_m_s

    x, y, vx, vy = com_path(speed_m_s, width, step_time, t_s)
    left, right, stance = feet(width, half_step, step_time, x, y, t_s)
    leg, toe_off, heel_strike = ankles(body, speed_m_s, width, step_time, heel_strike_rad, t_s)
    z = np.sqrt(leg**2 - (x - stance[0]) ** 2 - (y - stance[1]) ** 2)  # [E14]
    xcom = x + vx / frequency, y + vy / frequency  # [E19]
    s_pend, s_jump = step_scores(body, speed_m_s, half_step, frequency)
    gravity_x, gravity_y = gravity(body, pendulum, stance, x, y)
    return {
        "com_x_m": x,
        "com_y_m": y,
        "com_z_m": z,
        "com_vx_m_s": vx,
        "com_vy_m_s": vy,
        "left_x_m": left[0],
        "left_y_m": left[1],
        "left_z_m": left[2],
        "right_x_m": right[0],
        "right_y_m": right[1],
        "right_z_m": right[2],
        "leg_length_m": leg,
        "theta_to_rad": toe_off,
        "theta_hs_rad": heel_strike,
        "s_pend": s_pend,
        "s_jump": s_jump,
        "s_sw": 1 - 2 * np.abs(y - (left[1] + right[1]) / 2) / width,  # [E21]
        "mos_com_m": margin(left, right, body.d_h_m, x, y),
        "mos_xcom_m": margin(left, right, body.d_h_m, *xcom),
        "gravity_x_n": gravity_x,
        "gravity_y_n": gravity_y,
    }


def step_width(speed_m_s: float) -> float:
    """[E3]"""
    if speed_m_s < 0.6:
        return 0.22
    return 0.10 if speed_m_s > 1.1 else 0.3456 - 0.2128 * speed_m_s


def com_path(speed_m_s: float, width: float, step_time: float, t_s: np.ndarray) -> tuple[Any, ...]:
    """x, y and their velocities, [E7]."""
    amplitude = min(width / (2 * np.pi * speed_m_s), width / np.pi)
    rate = np.pi / step_time
    vx = speed_m_s * np.ones_like(t_s)
    vy = -amplitude * rate * np.sin(rate * t_s)
    return speed_m_s * t_s, amplitude * np.cos(rate * t_s), vx, vy


def feet(
    width: float, half_step: float, step_time: float, x: np.ndarray, y: np.ndarray, t_s: np.ndarray
) -> tuple[Any, ...]:
    """Left, right and stance foot, each x, y, z: [E8], [E9], [E10]."""
    steps = np.floor(t_s / step_time + 0.5)
    left_stands = np.mod(steps, 2) == 0
    stance_x = steps * 2 * half_step
    stance_y = np.where(left_stands, width / 2, -width / 2)
    swing_x = stance_x - 2 * stance_y * (x - stance_x) / (y - stance_y)
    share = t_s / step_time + 0.5 - steps
    s = 2 * np.minimum(share, 1 - share)
    swing_z = CLEARANCE_M * (10 * s**3 - 15 * s**4 + 6 * s**5)
    left = (
        np.where(left_stands, stance_x, swing_x),
        width / 2 * np.ones_like(t_s),
        np.where(left_stands, 0, swing_z),
    )
    right = (
        np.where(left_stands, swing_x, stance_x),
        -width / 2 * np.ones_like(t_s),
        np.where(left_stands, swing_z, 0),
    )
    return left, right, (stance_x, stance_y)


def ankles(
    body: Body,
    speed_m_s: float,
    width: float,
    step_time: float,
    heel_strike_rad: float,
    t_s: np.ndarray,
) -> tuple[Any, ...]:
    """Leg length, toe-off and heel-strike angle: [E11], [E12], [E13]."""
    pendulum = 0.57 * body.height_m
    until_strike = step_time / 2 - body.d_h_m * (1 - np.cos(heel_strike_rad)) / speed_m_s
    x, y, _, _ = com_path(speed_m_s, width, step_time, until_strike)
    height = pendulum - (0.02656 * speed_m_s + 0.002575)  # [E5]
    longest = np.sqrt(height**2 + x**2 + (y - width / 2) ** 2)
    toe_off = 2 * np.arcsin((longest - pendulum) / (2 * body.d_h_m))

    t_0 = np.floor(t_s / step_time) * step_time
    progress = _erf((t_s - t_0 - until_strike) / ANKLE_TIME_CONSTANT_S)
    toe_off_now = toe_off * (1 + progress)
    heel_strike_now = heel_strike_rad * (1 - progress)
    struck = t_s - t_0 >= step_time / 2
    acting = np.where(struck, heel_strike_now, toe_off_now)
    return pendulum + 2 * body.d_h_m * np.sin(acting / 2), toe_off_now, heel_strike_now


def step_scores(
    body: Body, speed_m_s: float, half_step: float, frequency: float
) -> tuple[Any, ...]:
    """S_pend and S_jump of a step that is the reference, [E20]."""
    shortest = speed_m_s / (2 * frequency)  # [E6]
    longest = body.peak_speed_m_s / (2 * frequency)
    measured = half_step
    s_pend = (measured - shortest) / (half_step - shortest)
    s_jump = (measured - longest) / (half_step - longest)
    return s_pend, s_jump


def gravity(
    body: Body, pendulum: float, stance: tuple[Any, ...], x: np.ndarray, y: np.ndarray
) -> tuple[Any, ...]:
    """Force along the surface of potential energy, [E18]."""
    dx, dy = x - stance[0], y - stance[1]
    surface = np.sqrt(pendulum**2 - dx**2 - dy**2)
    weight = body.mass_kg * GRAVITY_M_S2
    return weight * dx / surface, weight * dy / surface


def margin(
    left: tuple[Any, ...], right: tuple[Any, ...], d_h_m: float, x: np.ndarray, y: np.ndarray
) -> np.ndarray:
    """Signed distance to the border of the base of support: [E15], [E16], [E17]."""
    across_x, across_y = left[0] - right[0], left[1] - right[1]
    distance = np.hypot(across_x, across_y)
    across_x, across_y = across_x / distance, across_y / distance
    dx, dy = x - (left[0] + right[0]) / 2, y - (left[1] + right[1]) / 2
    x_s = np.abs(dx * across_y - dy * across_x)
    y_s = np.abs(dx * across_x + dy * across_y)

    radius = distance / 2
    from_origin = np.hypot(x_s, y_s)
    corner_y = np.sqrt(np.maximum(radius**2 - d_h_m**2, 0))
    inside = np.minimum(radius - from_origin, d_h_m - x_s)
    beside_arc = x_s * radius <= d_h_m * from_origin
    beside_edge = y_s <= corner_y
    to_corner = np.hypot(x_s - d_h_m, y_s - corner_y)
    outside = np.where(
        beside_arc, from_origin - radius, np.where(beside_edge, x_s - d_h_m, to_corner)
    )
    return np.where(inside >= 0, inside, -outside)
