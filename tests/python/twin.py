"""The model once more, in double precision and as functions of time: the core's independent twin.

Written from the equations (docs/equations.md), not from the core: no phase accumulator, no frame
of the stance foot, the library's erf, and the margin found among the candidate border points.
"""

import math
from dataclasses import dataclass

import numpy as np

GRAVITY = 9.80665


@dataclass(frozen=True)
class Twin:
    """A steady walk at one speed; Phase0 = 0 with the left foot at x = 0."""

    speed: float
    heel_strike: float
    ankle: str = "erf"
    height: float = 1.79
    mass: float = 63.3
    d_h: float = 0.10

    @property
    def pendulum(self) -> float:
        return 0.57 * self.height

    @property
    def frequency(self) -> float:
        return math.sqrt(GRAVITY / self.pendulum)

    @property
    def width(self) -> float:
        if self.speed < 0.6:
            return 0.22
        return 0.10 if self.speed > 1.1 else -0.2128 * self.speed + 0.3456

    @property
    def step(self) -> float:
        return 2.0 * (0.1802 * self.speed + 0.1351)

    @property
    def amplitude(self) -> float:
        return min(self.width / (2.0 * math.pi * self.speed), self.width / math.pi)

    @property
    def step_time(self) -> float:
        return self.step / self.speed

    def com_xy(self, t: float) -> np.ndarray:
        return np.array([self.speed * t, self.amplitude * math.cos(math.pi * t / self.step_time)])

    def com_xy_velocity(self, t: float) -> np.ndarray:
        rate = math.pi / self.step_time
        return np.array([self.speed, -self.amplitude * rate * math.sin(rate * t)])

    def steps_taken(self, t: float) -> int:
        return math.floor(t / self.step_time + 0.5)

    def feet(self, t: float) -> dict[str, np.ndarray]:
        """CoPs: the stance foot where it landed, the swing foot on the line through the CoM."""
        steps = self.steps_taken(t)
        stance, swing = ("left", "right") if steps % 2 == 0 else ("right", "left")
        side = {"left": 0.5 * self.width, "right": -0.5 * self.width}
        stance_xy = np.array([steps * self.step, side[stance]])
        com = self.com_xy(t)
        share = (side[swing] - stance_xy[1]) / (com[1] - stance_xy[1])
        return {stance: stance_xy, swing: stance_xy + share * (com - stance_xy)}

    def swing_height(self, t: float, clearance: float = 0.05) -> float:
        share = t / self.step_time + 0.5 - self.steps_taken(t)
        s = 2.0 * min(share, 1.0 - share)
        return clearance * (10 * s**3 - 15 * s**4 + 6 * s**5)

    def support(self, t: float) -> str:
        return "left" if self.steps_taken(t) % 2 == 0 else "right"

    def toe_off_angle(self) -> float:
        t_hs = 0.5 * self.step_time - self.d_h * (1 - math.cos(self.heel_strike)) / self.speed
        com = self.com_xy(t_hs)
        rise = self.pendulum - (0.02656 * self.speed + 0.002575)
        l_p0 = math.hypot(rise, com[0], com[1] - 0.5 * self.width)
        return 2.0 * math.asin((l_p0 - self.pendulum) / (2.0 * self.d_h))

    def ankle_angles(self, t: float) -> tuple[float, float]:
        if self.ankle == "rigid":
            return 0.0, 0.0
        saddle = (math.floor(t / self.step_time) + 0.5) * self.step_time
        t_hs = saddle - self.d_h * (1 - math.cos(self.heel_strike)) / self.speed
        rise = math.erf((t - t_hs) / 0.11)
        return self.toe_off_angle() * (1 + rise), self.heel_strike * (1 - rise)

    def in_second_half(self, t: float) -> bool:
        """After the saddle via point of the running half cycle: phases 1 and 3."""
        return t / self.step_time % 1 >= 0.5

    def leg(self, t: float) -> float:
        toe_off, heel_strike = self.ankle_angles(t)
        angle = heel_strike if self.in_second_half(t) else toe_off
        return self.pendulum + 2.0 * self.d_h * math.sin(0.5 * angle)

    def com_z(self, t: float) -> float:
        return math.sqrt(self.leg(t) ** 2 - float(np.sum(self._from_stance(t) ** 2)))

    def com_vz(self, t: float, h: float = 1e-6) -> float:
        """One-sided within the phase, so that the jump at a saddle via point is no derivative."""
        ahead = self.in_second_half(t) == self.in_second_half(t + h)
        first, last = (t, t + h) if ahead else (t - h, t)
        return (self.com_z(last) - self.com_z(first)) / h

    def _from_stance(self, t: float) -> np.ndarray:
        return self.com_xy(t) - self.feet(t)[self.support(t)]

    def xcom(self, t: float) -> np.ndarray:
        return self.com_xy(t) + self.com_xy_velocity(t) / self.frequency

    def gravity(self, t: float) -> np.ndarray:
        offset = self._from_stance(t)
        height = math.sqrt(self.pendulum**2 - float(np.sum(offset**2)))
        return self.mass * GRAVITY * offset / height

    def margin(self, t: float, point: np.ndarray) -> float:
        feet = self.feet(t)
        return bos_margin(feet["left"], feet["right"], self.d_h, point)

    def s_sw(self, t: float) -> float:
        feet = self.feet(t)
        middle = 0.5 * (feet["left"][1] + feet["right"][1])
        return 1.0 - 2.0 * abs(self.com_xy(t)[1] - middle) / self.width


def to_saddle(left: np.ndarray, right: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Task space to saddle space: x_S forward when the feet are side by side, y_S to the left."""
    y_axis = (left - right) / np.linalg.norm(left - right)
    x_axis = np.array([y_axis[1], -y_axis[0]])
    offset = point - 0.5 * (left + right)
    return np.array([offset @ x_axis, offset @ y_axis])


def bos_margin(left: np.ndarray, right: np.ndarray, d_h: float, point: np.ndarray) -> float:
    """Signed distance to the border: the nearest among all candidate points that lie on it."""
    x, y = to_saddle(left, right, point)
    radius = 0.5 * float(np.linalg.norm(left - right))
    inside = math.hypot(x, y) <= radius and abs(x) <= d_h
    angle = math.atan2(y, x)
    candidates = [(radius * math.cos(angle), radius * math.sin(angle))]
    if radius > d_h:
        edge = math.sqrt(radius**2 - d_h**2)
        candidates += [(sx * d_h, sy * edge) for sx in (-1, 1) for sy in (-1, 1)]
        candidates += [(sx * d_h, y) for sx in (-1, 1)]
    on_border = [
        (cx, cy)
        for cx, cy in candidates
        if abs(cx) <= d_h + 1e-12 and math.hypot(cx, cy) <= radius + 1e-12
    ]
    distance = min(math.hypot(cx - x, cy - y) for cx, cy in on_border)
    return distance if inside else -distance
