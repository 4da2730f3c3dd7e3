"""The way of a foot through the air: the planned one, from where the foot really left the ground to
where it shall land."""

from dataclasses import dataclass, field

import numpy as np

from saddlewalk.physics.gains import Gains


@dataclass(frozen=True)
class PlannedSwing:
    """The plan at one instant, in the world."""

    position_m: np.ndarray  # (3,)
    velocity_m_s: np.ndarray
    landing_in_s: float


@dataclass
class Swing:
    """One swing, from lift-off on. `step()` once per step of the control gives the next targets."""

    gains: Gains
    step_s: float
    lift_off_m: np.ndarray  # where the sole was
    pitch_rad: float
    position_m: np.ndarray = field(init=False)
    velocity_m_s: np.ndarray = field(default_factory=lambda: np.zeros(3))
    acceleration_m_s2: np.ndarray = field(default_factory=lambda: np.zeros(3))
    _mismatch_m: np.ndarray | None = None  # of the lift-off and the plan
    _fade_s: float = 0.0
    _age_s: float = 0.0
    _shift_m: complex = 0j
    _detour_m: complex = 0j
    _detour_m_s: complex = 0j

    def __post_init__(self) -> None:
        self.position_m = self.lift_off_m.copy()

    def step(self, planned: PlannedSwing, shift_m: complex) -> None:
        """shift_m: of the landing, from the planned one; frozen shortly before it."""
        path_m, rate_m_s = planned.position_m, planned.velocity_m_s
        before_m_s = None if self._mismatch_m is None else self.velocity_m_s
        if self._mismatch_m is None:
            self._mismatch_m = self.lift_off_m - path_m
            self._fade_s = self.gains.lift_off_share * max(planned.landing_in_s, 0.05)
        left, fading = _minimum_jerk(min(self._age_s / self._fade_s, 1.0))
        if planned.landing_in_s >= self.gains.landing_frozen_s:
            self._shift_m = shift_m
        self._turn()
        detour_m = np.array([self._detour_m.real, self._detour_m.imag, 0.0])
        detour_m_s = np.array([self._detour_m_s.real, self._detour_m_s.imag, 0.0])
        self.position_m = path_m + self._mismatch_m * left + detour_m
        self.position_m[2] = max(self.position_m[2], 0.0)
        self.velocity_m_s = rate_m_s + self._mismatch_m * (fading / self._fade_s) + detour_m_s
        if before_m_s is not None:
            most = self.gains.swing_acceleration_max_m_s2
            gained = np.clip((self.velocity_m_s - before_m_s) / self.step_s, -most, most)
            self.acceleration_m_s2 += self.gains.feed_forward * (gained - self.acceleration_m_s2)
        self._age_s += self.step_s

    def _turn(self) -> None:
        """The detour follows the shift, critically damped."""
        rate = self.gains.detour_filter_rad_s
        pull = rate * rate * (self._shift_m - self._detour_m) - 2 * rate * self._detour_m_s
        self._detour_m_s += pull * self.step_s
        self._detour_m += self._detour_m_s * self.step_s

    def turn_sole(self, pitch_rad: float, step_s: float) -> None:
        self.pitch_rad += (pitch_rad - self.pitch_rad) * (step_s / self.gains.pitch_time_s)


def _minimum_jerk(progress: float) -> tuple[float, float]:
    """From 1 to 0, and its rate."""
    s = progress
    return 1 - s**3 * (10 - 15 * s + 6 * s**2), -30 * s**2 * (1 - s) ** 2
