"""The paper's simulations, and the gait model's curves over speed, all from the C core.

Mean body of the paper, Phase0 = 0, one stride of two steps. SI units and radians.
"""

import itertools
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from saddlewalk.config import ANKLES, DEFAULT_HEIGHT_M, DEFAULT_MASS_KG
from saddlewalk.core import Core, ffi, library, model_of
from saddlewalk.planning.steady import COLUMNS, row_of, walk

SPEEDS_M_S = (0.7, 1.0, 1.2, 1.6)
HEEL_STRIKES_DEG = (5, 10, 15)
FIGURE_HEEL_STRIKE_DEG = 10
PAPER_STEP_S = 0.08
SPEED_FLOOR_M_S = 0.01  # SADDLE_SPEED_FLOOR_M_S
FINE_SAMPLES = 2000  # a stride
COARSE_SAMPLES = 200  # for a curve over many speeds


def mean_body(ankle: str = "erf") -> Any:
    """A saddle_config_t: the paper's defaults for the mean height and mass of its subjects."""
    config = ffi().new("saddle_config_t *")
    config[0] = library().saddle_config_default(DEFAULT_HEIGHT_M, DEFAULT_MASS_KG)
    config.ankle = ANKLES[ankle]
    return config


@dataclass(frozen=True)
class Gait:
    """The gait model at one speed."""

    half_step_m: float
    half_step_min_m: float  # XCoM limit
    half_step_max_m: float  # reach limit
    width_m: float
    vertical_m: float  # of the human regression, peak to peak
    planned: bool  # the core plans this speed without limiting it


def gait(speed_m_s: float) -> Gait:
    model, core = model_of(mean_body()), library()
    bounds = core.saddle_step_bounds(model, speed_m_s)
    width_m = core.saddle_step_width_m(model, speed_m_s)
    quarter = ffi().new(
        "saddle_quarter_t *",
        core.saddle_quarter(model, core.SADDLE_LEFT, bounds.reference_m, width_m, speed_m_s),
    )
    return Gait(
        half_step_m=bounds.reference_m,
        half_step_min_m=bounds.min_m,
        half_step_max_m=bounds.max_m,
        width_m=width_m,
        vertical_m=quarter.vertical_m,
        planned=bool(bounds.feasible) and speed_m_s >= SPEED_FLOOR_M_S,
    )


@dataclass(frozen=True)
class Walk:
    """One stride at constant speed from the left foot via point (theta = 0) to the next."""

    speed_m_s: float
    heel_strike_deg: float
    columns: dict[str, np.ndarray]  # those of `saddlewalk plan`
    heel_strike_s: float  # when the right heel strikes

    def __getitem__(self, column: str) -> np.ndarray:
        return self.columns[column]

    @property
    def step_length_m(self) -> float:
        """From the left foot's position to the right foot's landing."""
        return float(self["right_x_m"][self._middle] - self["left_x_m"][0])

    @property
    def step_width_m(self) -> float:
        return float(self["left_y_m"][0] - self["right_y_m"][self._middle])

    @property
    def step_s(self) -> float:
        return self.step_length_m / self.speed_m_s

    @property
    def saddles_s(self) -> tuple[float, float]:
        return self.step_s / 2, 3 * self.step_s / 2

    @property
    def com_z_at_saddles_m(self) -> np.ndarray:
        """(2, 2): CoM height just before and just after each saddle via point."""
        time_s, z_m, rate_m_s = self["t_s"], self["com_z_m"], self["com_vz_m_s"]
        heights_m = []
        for saddle_s, last in zip(self.saddles_s, self._last_before_saddles, strict=True):
            beside = [last, last + 1]
            heights_m.append(z_m[beside] + rate_m_s[beside] * (saddle_s - time_s[beside]))
        return np.array(heights_m)

    @property
    def jump_m(self) -> float:
        """Jump of the CoM's height at the first saddle via point."""
        before_m, after_m = self.com_z_at_saddles_m[0]
        return float(after_m - before_m)

    @property
    def vertical_m(self) -> float:
        """Peak to peak of the CoM's height."""
        return float(np.ptp(np.concatenate([self["com_z_m"], self.com_z_at_saddles_m.ravel()])))

    @property
    def toe_off_rad(self) -> float:
        """Angle of the left foot when the right heel strikes."""
        return float(np.interp(self.heel_strike_s, *self._toe_off))

    @property
    def ankle_time_constant_s(self) -> float:
        """Time from a toe-off angle of 1 - erf(1) times that at heel strike, to heel strike."""
        time_s, angle_rad = self._toe_off
        share = 1 - math.erf(1)
        return float(self.heel_strike_s - np.interp(share * self.toe_off_rad, angle_rad, time_s))

    @property
    def s_sw_min(self) -> float:
        return float(self["s_sw"].min())

    @property
    def com_off_saddle_m(self) -> float:
        """Maximum distance of the CoM from the line through the CoPs, y_Saddle."""
        feet_x_m, feet_y_m = (
            [self[f"{side}_{axis}_m"] for side in ("left", "right")] for axis in "xy"
        )
        along = np.array([feet_x_m[0] - feet_x_m[1], feet_y_m[0] - feet_y_m[1]])
        to_com = np.array([self["com_x_m"] - feet_x_m[1], self["com_y_m"] - feet_y_m[1]])
        off_m = (along[0] * to_com[1] - along[1] * to_com[0]) / np.hypot(*along)
        return float(np.abs(off_m).max())

    def share_inside(self, margin: str) -> float:
        """Share of the time in which a margin of stability is positive."""
        return float(np.mean(self[margin] > 0))

    @property
    def _middle(self) -> int:
        return int(np.argmin(np.abs(self["theta_rad"] - math.pi)))

    @property
    def _last_before_saddles(self) -> np.ndarray:
        phase = self["phase"]
        return np.flatnonzero((phase[:-1] % 2 == 0) & (phase[1:] % 2 == 1))

    @cached_property
    def _toe_off(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and angles until the first saddle via point: there the angle rises.

        The heel strikes some milliseconds before the saddle, often after the last sample; the
        angle at the saddle is that of the slope before it.
        """
        until = self._last_before_saddles[0] + 1
        time_s, angle_rad = self["t_s"][:until], self["theta_to_rad"][:until]
        slope_rad_s = (angle_rad[-1] - angle_rad[-2]) / (time_s[-1] - time_s[-2])
        saddle_s = self.saddles_s[0]
        at_saddle_rad = angle_rad[-1] + slope_rad_s * (saddle_s - time_s[-1])
        return np.append(time_s, saddle_s), np.append(angle_rad, at_saddle_rad)


def simulate(
    speed_m_s: float,
    heel_strike_deg: float = FIGURE_HEEL_STRIKE_DEG,
    ankle: str = "erf",
    samples: int = FINE_SAMPLES,
) -> Walk:
    """A stride in equal time steps. gait(speed_m_s).planned holds."""
    stride_s = 4 * gait(speed_m_s).half_step_m / speed_m_s
    return _simulate(speed_m_s, heel_strike_deg, ankle, stride_s / samples, samples)


def simulate_as_the_paper(speed_m_s: float, heel_strike_deg: float) -> Walk:
    """A stride in time steps of PAPER_STEP_S; the last one may end before the stride."""
    stride_s = 4 * gait(speed_m_s).half_step_m / speed_m_s
    return _simulate(speed_m_s, heel_strike_deg, "erf", PAPER_STEP_S, int(stride_s / PAPER_STEP_S))


def _simulate(
    speed_m_s: float, heel_strike_deg: float, ankle: str, dt_s: float, samples: int
) -> Walk:
    core = Core(mean_body(ankle))
    outputs = walk(core, speed_m_s, heel_strike_deg, dt_s)
    instants = list(itertools.islice(outputs, samples + 1))
    rows = (row_of(t_s, out.plan, core.score_plan(out.plan)) for t_s, out in instants)
    columns = zip(COLUMNS, zip(*rows, strict=True), strict=True)
    return Walk(
        speed_m_s=speed_m_s,
        heel_strike_deg=heel_strike_deg,
        columns={name: np.array(values) for name, values in columns},
        heel_strike_s=instants[0][1].plan.time_to_heel_strike_s,
    )
