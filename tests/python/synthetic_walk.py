"""A walk whose events, steps and speed are known, as a recording."""

import math
from dataclasses import dataclass

import numpy as np

from saddlewalk.gait.recording import COLUMNS, Recording


@dataclass(frozen=True)
class Walk:
    """Constant speed; feet lie still, then fly straight on. So the extrema of heel and toe about
    the CoM, the events, are corners at known times. The left foot strikes at `phase` steps."""

    speed_m_s: float = 1.2
    step_length_m: float = 0.65
    step_width_m: float = 0.12
    stance: float = 0.6  # of the stride
    phase: float = 0.0
    duration_s: float = 6.0
    rate_hz: float = 100.0

    @property
    def step_s(self) -> float:
        return self.step_length_m / self.speed_m_s

    def times_s(self) -> np.ndarray:
        return np.arange(round(self.duration_s * self.rate_hz) + 1) / self.rate_hz

    def strides(self, side: int) -> np.ndarray:
        """Unwrapped phase of a foot, in strides; whole numbers are heel strikes."""
        return (self.times_s() / self.step_s - self.phase - side) / 2

    def contact(self) -> np.ndarray:
        return np.stack([np.mod(self.strides(side), 1) < self.stance for side in (0, 1)])

    def heel_strikes_s(self, side: int) -> np.ndarray:
        return self._events_s(side, 0.0)

    def toe_offs_s(self, side: int) -> np.ndarray:
        return self._events_s(side, self.stance)

    def _events_s(self, side: int, share: float) -> np.ndarray:
        first = math.ceil(self.strides(side)[0] - share)
        events = (np.arange(first, first + 100) + share) * 2 * self.step_s
        events += (self.phase + side) * self.step_s
        return events[events < self.duration_s]

    def foot_x_m(self, side: int) -> np.ndarray:
        whole, part = np.divmod(self.strides(side), 1)
        flight = np.maximum(part - self.stance, 0) / (1 - self.stance)
        landing_m = (2 * whole + self.phase + side) * self.step_length_m
        return landing_m + 0.5 * self.step_length_m + 2 * self.step_length_m * flight

    def recording(self, noise_m: float = 0.0, seed: int = 0) -> Recording:
        time_s = self.times_s()
        sway = np.cos(np.pi * (time_s / self.step_s - self.phase))
        com_m = np.stack(
            [self.speed_m_s * time_s, 0.02 * sway, 0.95 + 0.01 * np.cos(2 * np.pi * time_s)], axis=1
        )
        y_m = np.array([0.5, -0.5]) * self.step_width_m
        middle = np.stack(
            [
                np.stack([self.foot_x_m(s), np.full_like(time_s, y_m[s]), 0 * time_s], axis=1)
                for s in (0, 1)
            ]
        )
        rng = np.random.default_rng(seed)
        half_foot_m = np.array([0.1, 0.0, 0.0])
        return Recording(
            source="a synthetic walk",
            time_s=time_s,
            com_m=com_m + rng.normal(0, noise_m, com_m.shape),
            heel_m=middle - half_foot_m + rng.normal(0, noise_m, middle.shape),
            toe_m=middle + half_foot_m + rng.normal(0, noise_m, middle.shape),
        )


def csv_text(recording: Recording) -> str:
    """The recording as a trial file; NaN is an empty cell."""
    points = [
        recording.com_m,
        recording.heel_m[0],
        recording.toe_m[0],
        recording.heel_m[1],
        recording.toe_m[1],
    ]
    rows = np.column_stack([recording.time_s, *points])
    lines = [",".join("" if math.isnan(x) else f"{x:.4f}" for x in row) for row in rows]
    return "\n".join([",".join(COLUMNS), *lines, ""])
