"""An emulated wearer and exoskeleton: a body that follows the firmware's plan and can fall.

The CoM is a linear inverted pendulum about the CoP, which stays within the standing feet.
The feet follow the planned swing with a lag and stay where they land. The wearer balances by
moving the CoP (ankle strategy). The firmware decides where to step: one kind of wearer keeps to the
planned steps, the other takes the firmware's recovery step, within its legs' reach and speed.

Points of the transverse plane are complex numbers, x forward + 1j * y to the left, in metres: a
step of 1 ms in plain floats is ten times faster than in arrays. World frame: x from the start,
y from the first walking line, z from the ground. A device measures in the axes of the pelvis, which
has the planned heading.
"""

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.contract import GRAVITY_M_S2, LEFT, RIGHT, STARTING

STEP_S = 1e-3
STANCE_M = 0.11  # from the middle to each foot of a wearer who stands and waits
NEARBY_M = 0.08 + 0.05j  # a recovery step this close to the planned one is ignored
IN_NEED_M = 0.13 + 0.07j  # the wearer hurries if the XCoM is off the planned one by more
BUS_ROUNDING_M = 1e-3  # of a point on CAN, at most
ARRIVED_M = 0.02  # within this distance a step has reached its place


@dataclass(frozen=True)
class Body:
    """The wearer. Mass to double support are as in the firmware's configuration."""

    mass_kg: float = 63.3
    height_m: float = 1.79
    pendulum_ratio: float = 0.57
    foot_half_length_m: float = 0.10  # reach of the CoP from the middle of the foot
    foot_half_width_m: float = 0.03
    double_support: float = 0.16  # share of a step after heel strike with both feet loaded
    cop_gain: float = 1.5  # XCoM errors shrink at cop_gain * natural frequency
    cop_lag_s: float = 0.03
    foot_lag_s: float = 0.03
    detour_speed_m_s: float = 3.0  # at which a swing can leave the planned one
    reach: complex = 0.56 + 0.30j  # largest step from the stance foot, of the body's height
    fall_height: float = 0.75  # of the pendulum length: lower is a fall

    @classmethod
    def of(cls, config: Any) -> "Body":
        """The body that a saddle_config_t describes."""
        return cls(
            mass_kg=config.body_mass_kg,
            height_m=config.body_height_m,
            pendulum_ratio=config.pendulum_ratio,
            foot_half_length_m=config.cop_range_m,
            double_support=config.double_support_share,
        )

    @property
    def pendulum_m(self) -> float:
        return self.pendulum_ratio * self.height_m

    @property
    def natural_frequency_rad_s(self) -> float:
        return math.sqrt(GRAVITY_M_S2 / self.pendulum_m)


@dataclass(frozen=True)
class Noise:
    """Standard deviations of what is measured, and of the wearer's own unsteadiness."""

    position_m: float = 0.002
    velocity_m_s: float = 0.02
    cop_m: float = 0.004  # of the commanded CoP, correlated over cop_time_s
    cop_time_s: float = 0.2

    def scaled(self, factor: float) -> "Noise":
        return Noise(
            self.position_m * factor,
            self.velocity_m_s * factor,
            self.cop_m * factor,
            self.cop_time_s,
        )


@dataclass(frozen=True)
class Skeleton:
    """Where the joints of a body are, in the world; of each leg by side, (2, 3)."""

    hip_m: np.ndarray
    knee_m: np.ndarray
    ankle_m: np.ndarray
    heel_m: np.ndarray
    toe_m: np.ndarray
    trunk_up: np.ndarray  # (3,): unit vector from the hips to the shoulders


@dataclass(frozen=True)
class Push:
    """An impulse on the CoM, spread evenly over STEPS of physics from `time_s` of the walk on."""

    STEPS = 100
    impulse_n_s: float
    time_s: float
    direction_deg: float  # of the wearer's heading: 0 forward, 90 to the left

    @property
    def vector_n_s(self) -> complex:
        angle = math.radians(self.direction_deg)
        return self.impulse_n_s * complex(math.cos(angle), math.sin(angle))


@dataclass(frozen=True)
class RecoveryStep:
    """Where the firmware wants a foot so that the walk can go on: the planned place, or near it."""

    foot: int
    landing_m: complex  # from the stance CoP
    xcom_deviation_m: complex  # from the planned one


@dataclass(frozen=True)
class Reference:
    """What to balance by: CoP within the feet, and XCoM of the pendulum that takes the steps."""

    cop_m: complex
    xcom_m: complex
    load: tuple[float, float]  # share of the weight that each foot carries


@dataclass(frozen=True)
class Plan:
    """The firmware's plan at one tick: x from the planned stance CoP in the heading of that foot, y
    from the walking line."""

    mode: int
    support: int
    heading_rad: float  # of x, in the world
    yaw_rad: tuple[float, float]  # of the feet, from x
    pelvis_yaw_rad: float
    step_length_m: float
    speed_m_s: float  # exactly 0 while both feet stand
    com_m: complex
    velocity_m_s: complex
    feet_m: tuple[complex, complex]
    foot_heights_m: tuple[float, float]
    swing_velocity_m_s: complex
    swing_rise_m_s: float
    time_to_via_point_s: float
    time_to_landing_s: float  # not planned for a last swing
    landing_m: complex
    leg_length_m: float
    height_m: float  # of the CoM
    pitch_rad: tuple[float, float]  # of the soles, positive heel up
    reference: Callable[[float], Reference]  # that many seconds after this plan
    recovery: RecoveryStep | None = None  # None: no place helps, or nothing to compare with

    def agrees(self, other: "Plan") -> bool:
        """The same but for what a bus rounds."""
        points = zip((self.com_m, *self.feet_m), (other.com_m, *other.feet_m), strict=True)
        same = (self.mode, self.support) == (other.mode, other.support)
        return same and all(abs(one - another) < BUS_ROUNDING_M for one, another in points)

    @property
    def ahead(self) -> complex:
        """The direction of x in the world."""
        return cmath.rect(1.0, self.heading_rad)

    @property
    def both_feet_stand(self) -> bool:
        return self.speed_m_s == 0.0

    @property
    def lands_beside(self) -> bool:
        """The running swing is the last one and ends beside the stance foot."""
        return self.landing_m.real <= 0.0

    @property
    def landing_in_s(self) -> float:
        """Time until the swing foot comes down."""
        return self.time_to_via_point_s if self.lands_beside else self.time_to_landing_s

    @property
    def half_width_m(self) -> float:
        """To the left, from the stance foot to midway between it and the landing."""
        return (self.landing_m - self.feet_m[self.support]).imag / 2

    @property
    def step_s(self) -> float:
        """Duration of a whole step at the present speed."""
        return self.step_length_m / self.speed_m_s


PlanAt = Callable[[float], Plan | None]  # so many seconds after a tick, up to the next one


@dataclass(frozen=True)
class Measurement:
    """Readings of the exoskeleton's sensors: x in the heading of the pelvis, feet from the CoM."""

    height_m: float
    velocity_m_s: complex
    feet_m: tuple[complex, complex]
    contact: tuple[bool, bool]


@dataclass
class Foot:
    position_m: complex
    yaw_rad: float = 0.0
    height_m: float = 0.0
    velocity_m_s: complex = 0j
    contact: bool = True
    leg_m: float = 0.0  # length of the leg when it last carried

    def land(self) -> None:
        self.height_m, self.velocity_m_s, self.contact = 0.0, 0j, True


def limited(point: complex, limit: complex) -> complex:
    return complex(
        min(max(point.real, -limit.real), limit.real), min(max(point.imag, -limit.imag), limit.imag)
    )


class Wearer:
    """Stands until the first plan comes, and follows it.

    The plan's frame is attached to the actual stance foot, so that landing errors do not
    accumulate, and turned to the planned heading. `follow(plan)` gives the newest plan, `step()`
    advances by 1 ms. One seed and sequence of calls give the same bits. A fall is final: `fallen`
    when the CoM is lower over every supporting foot than `fall_height` of the pendulum, that is too
    far away from them to be carried.
    """

    PLAN_MAX_AGE_S = 0.3  # an older plan is not followed any more

    def __init__(
        self,
        body: Body | None = None,
        noise: Noise | None = None,
        pushes: tuple[Push, ...] = (),
        seed: int = 0,
        takes_recovery_step: bool = True,
        right_ahead_m: float = 0.0,
    ) -> None:
        """right_ahead_m: by which the right foot stands ahead of the left one at first."""
        self.body = body or Body()
        self.noise = noise or Noise()
        self.pushes = pushes
        self.takes_recovery_step = takes_recovery_step
        self.time_s = 0.0  # since the first plan
        self.com_m = self.cop_m = 0j
        self.velocity_m_s = 0j
        self.rise_m_s = 0.0
        pendulum_m = self.body.pendulum_m
        left = 1j * STANCE_M - right_ahead_m / 2
        self.feet = [Foot(place, leg_m=pendulum_m) for place in (left, -left)]
        self.height_m = self._height_over(self.feet[LEFT])
        self.fallen = False
        self.fell_at_s = math.nan
        self.pushed_n_s = 0j  # impulse received so far
        self.xcom_error_m = 0j
        self._random = np.random.default_rng(seed)
        self._plan: Plan | None = None
        self._plan_age_s = 0.0
        self._origin_m = 0j  # of the plan's frame, in the world,
        self._ahead = 1 + 0j  # and the direction of its x
        self._heading_rad = self._turn_rad_s = 0.0  # of the pelvis at the newest plan; since then
        self._leading = LEFT  # the foot that landed last
        self._since_landing_s = math.inf  # since standing: inf
        self._recovery_shift_m = 0j  # of the landing of the running swing
        self._hurries = False  # to the recovery step, and lands before its time
        self._detour_m = 0j  # of the swing foot from the planned swing
        self._unsteadiness = 0j
        self._steps = 0
        self._started = False
        wt = self.body.natural_frequency_rad_s * STEP_S
        self._cosh, self._sinh = math.cosh(wt), math.sinh(wt)

    @property
    def unsolved_share(self) -> float:
        """Of the controller's programmes, without an optimum: a pendulum needs none."""
        return 0.0

    def peaks(self) -> dict[str, tuple[float, float, float]]:
        """Greatest torque, power and speed of each joint so far: a pendulum has none."""
        return {}

    def skeleton(self) -> Skeleton | None:
        """A pendulum has no joints."""
        return None

    @property
    def recovery_shift_m(self) -> complex:
        """Of the landing in the plan's axes, while a recovery step is taken in need; else 0."""
        return self._recovery_shift_m if self._hurries else 0j

    @property
    def heading_rad(self) -> float:
        """Of the pelvis. Until the next plan it turns on as between the last two."""
        return self._heading_rad + self._turn_rad_s * self._plan_age_s

    @property
    def xcom_m(self) -> complex:
        return self.com_m + self.velocity_m_s / self.body.natural_frequency_rad_s

    def measure(self) -> Measurement:
        """Noisy sensor readings; every call draws new noise."""
        position, velocity = self.noise.position_m, self.noise.velocity_m_s
        draw = [float(value) for value in self._random.standard_normal(7)]
        exact = self.exact()
        left, right = exact.feet_m
        return Measurement(
            height_m=exact.height_m + position * draw[0],
            velocity_m_s=exact.velocity_m_s + velocity * complex(draw[1], draw[2]),
            feet_m=(
                left + position * complex(draw[3], draw[4]),
                right + position * complex(draw[5], draw[6]),
            ),
            contact=exact.contact,
        )

    def exact(self) -> Measurement:
        """Sensor readings without noise."""
        to_pelvis = cmath.rect(1.0, -self.heading_rad)
        left, right = ((foot.position_m - self.com_m) * to_pelvis for foot in self.feet)
        return Measurement(
            height_m=self.height_m,
            velocity_m_s=self.velocity_m_s * to_pelvis,
            feet_m=(left, right),
            contact=(self.feet[LEFT].contact, self.feet[RIGHT].contact),
        )

    def in_world(self, point_m: complex) -> complex:
        """A point of the plan."""
        return self._origin_m + point_m * self._ahead

    def _along(self, vector: complex) -> complex:
        """A vector of the world in the axes of the plan."""
        return vector * self._ahead.conjugate()

    def _at(self, along_m: float, vector: complex) -> complex:
        """A vector of the world with another part along the plan's x."""
        return complex(along_m, self._along(vector).imag) * self._ahead

    def follow(self, plan: Plan | None, plan_at: PlanAt | None = None) -> None:
        """Take the newest plan; None while there is none.

        plan_at: the plan until the next tick, of which this wearer needs nothing.
        """
        since_s, self._plan_age_s = self._plan_age_s, 0.0
        self._plan = plan
        if plan is None or self.fallen:
            return
        self._started = True
        self._face(plan, since_s)
        if plan.both_feet_stand:
            self._stand()
        if plan.both_feet_stand or plan.mode == STARTING:
            self._leading, self._since_landing_s = plan.support, math.inf
        elif not self.feet[plan.support].contact:
            self._land(plan.support)
        elif plan.support == self._leading:
            self._since_landing_s = max(self._since_landing_s, 0.0)
        self._hold(plan)

    def _face(self, plan: Plan, since_s: float) -> None:
        """Feet and pelvis to the planned headings; since_s: since the plan before."""
        for foot, yaw_rad in zip(self.feet, plan.yaw_rad, strict=True):
            foot.yaw_rad = plan.heading_rad + yaw_rad
        heading_rad = plan.heading_rad + plan.pelvis_yaw_rad
        turned_rad = math.remainder(heading_rad - self._heading_rad, math.tau)
        self._turn_rad_s = turned_rad / since_s if since_s > 0 else 0.0
        self._heading_rad = heading_rad

    def _hold(self, plan: Plan) -> None:
        """The plan's frame against the foot that it steps on or, once that has landed, steps to."""
        stance, swing = plan.support, 1 - plan.support
        foot, place = (stance, plan.feet_m[stance])
        if self._since_landing_s <= 0 and self._leading == swing:
            foot, place = swing, plan.landing_m
        self._ahead = plan.ahead
        self._origin_m = self.feet[foot].position_m - place * self._ahead

    @property
    def _is_first_swing(self) -> bool:
        return math.isinf(self._since_landing_s)

    def _advance_time(self) -> None:
        """By a step, from the first plan on."""
        if self._started:
            self._steps += 1
            self.time_s = self._steps * STEP_S

    def step(self) -> None:
        """Advance by STEP_S."""
        self._advance_time()
        if self.fallen:
            return
        self._plan_age_s += STEP_S
        self._since_landing_s += STEP_S
        if self._plan_age_s > self.PLAN_MAX_AGE_S:
            self._plan = None
        cop = self._reference(self._plan_age_s + self.body.cop_lag_s).cop_m
        self.xcom_error_m = self.xcom_m - self._reference(self._plan_age_s).xcom_m
        self._move_feet()
        self._move_cop(cop + (1 + self.body.cop_gain) * self.xcom_error_m)
        self._move_com()
        self._carry()

    def _reference(self, age: float) -> Reference:
        """What to balance by, in the world: midway between the feet if there is no plan."""
        if self._plan is None:
            middle = (self.feet[LEFT].position_m + self.feet[RIGHT].position_m) / 2
            return Reference(middle, middle, (0.5, 0.5))
        planned = self._plan.reference(age)
        return Reference(self.in_world(planned.cop_m), self.in_world(planned.xcom_m), planned.load)

    def _move_feet(self) -> None:
        plan = self._plan
        if plan is None:
            self._stand()
        if plan is None or plan.both_feet_stand:
            return
        swing = RIGHT if plan.support == LEFT else LEFT
        foot = self.feet[swing]
        due = self._plan_age_s >= plan.landing_in_s
        if foot.contact:
            foot.contact = due or self._trailing_share() > 0
        else:
            arrived = self._swing(plan, swing, foot)
            if due or arrived:
                self._land(swing, early_s=max(plan.landing_in_s - self._plan_age_s, 0.0))
                self._hold(plan)

    def _swing(self, plan: Plan, side: int, foot: Foot) -> bool:
        """Critically damped pursuit of the planned swing, or of the way to the recovery step.

        True when a foot that hurries to a recovery step is there.
        """
        age = self._plan_age_s
        rate = plan.swing_velocity_m_s * self._ahead
        path = self.in_world(plan.feet_m[side]) + rate * age
        planned = self.in_world(plan.landing_m)
        shift = self._recovery_shift(plan, side) * self._ahead
        landing = planned + shift
        hurries = self._hurries and not self._is_first_swing
        self._turn_to(landing - path if hurries else shift)
        target = path + self._detour_m
        limit_m = self._along(landing).real
        if self._along(target).real > limit_m >= self._along(foot.position_m).real:
            target, rate = self._at(limit_m, target), self._at(0.0, rate)
        lag = self.body.foot_lag_s
        pull = (target - foot.position_m) / lag + 2 * (rate - foot.velocity_m_s)
        foot.velocity_m_s += pull * (STEP_S / lag)
        if self._along(foot.position_m).real >= limit_m and self._along(foot.velocity_m_s).real > 0:
            foot.velocity_m_s = self._at(0.0, foot.velocity_m_s)
        foot.position_m += foot.velocity_m_s * STEP_S
        foot.height_m = max(plan.foot_heights_m[side] + plan.swing_rise_m_s * age, 0.0)
        return hurries and abs(foot.position_m - landing) < ARRIVED_M

    def _recovery_shift(self, plan: Plan, side: int) -> complex:
        """From the planned landing to the recovery step's, as far as the leg reaches; plan's axes.

        0 if that is near the planned landing. Once no place helps any more, the foot goes on to
        the last that would have.
        """
        step = plan.recovery
        if self.takes_recovery_step and step is not None and step.foot == side:
            reach_m = self.body.reach * self.body.height_m
            planned_m = plan.landing_m - plan.feet_m[1 - side]
            shift_m = limited(step.landing_m, reach_m) - planned_m
            self._recovery_shift_m = 0j if shift_m == limited(shift_m, NEARBY_M) else shift_m
            deviation_m = step.xcom_deviation_m
            in_need = deviation_m != limited(deviation_m, IN_NEED_M)
            self._hurries = in_need and self._recovery_shift_m != 0
        return self._recovery_shift_m

    def _turn_to(self, detour_m: complex) -> None:
        """Leave the planned swing by as much, or return to it, no faster than the leg can."""
        change_m, fastest_m = detour_m - self._detour_m, self.body.detour_speed_m_s * STEP_S
        self._detour_m += change_m * min(fastest_m / (abs(change_m) or 1.0), 1.0)

    def _stand(self) -> None:
        for side in (LEFT, RIGHT):
            if not self.feet[side].contact:
                self._land(side)

    def _land(self, side: int, early_s: float = 0.0) -> None:
        """early_s: before the plan has the foot land; until it steps on it, the other one stays."""
        self.feet[side].land()
        self._leading = side
        self._since_landing_s = -early_s
        self._detour_m = self._recovery_shift_m = 0j
        self._hurries = False

    def _trailing_share(self) -> float:
        """The most of the load that the trailing foot may carry: it hands over what it has."""
        if not self.feet[1 - self._leading].contact:
            return 0.0
        if self._plan is None or self._plan.both_feet_stand or self._must_wait(self._plan):
            return 1.0
        duration_s = self.body.double_support * self._plan.step_s
        return min(max(1.0 - self._since_landing_s / duration_s, 0.0), 1.0)

    def _must_wait(self, plan: Plan) -> bool:
        """The last swing is slow: while it lasts the XCoM must fall neither out nor past it."""
        if not plan.lands_beside:
            return False
        half_width_m = plan.half_width_m
        lever_m = self._along(self.xcom_m - self.feet[plan.support].position_m).imag
        inward_m = lever_m * math.copysign(1.0, half_width_m)
        edge_m = self.body.foot_half_width_m
        left_s = max(plan.landing_in_s - self._plan_age_s, 0.0)
        grown = math.exp(self.body.natural_frequency_rad_s * left_s)
        return inward_m < -edge_m or edge_m + (inward_m - edge_m) * grown > abs(half_width_m)

    def _move_cop(self, wanted: complex) -> None:
        """Follow the wanted CoP with a lag, within the hull of the feet that stand."""
        noise = self.noise
        if noise.cop_m:
            mix = STEP_S / noise.cop_time_s
            x, y = self._random.standard_normal(2)
            kick = noise.cop_m * math.sqrt(2 * mix)
            self._unsteadiness += complex(x, y) * kick - self._unsteadiness * mix
        cop = self.cop_m + (wanted + self._unsteadiness - self.cop_m) * (
            STEP_S / self.body.cop_lag_s
        )
        middle = self.feet[self._leading].position_m
        share = self._trailing_share()
        if share > 0:
            apart = self.feet[1 - self._leading].position_m - middle
            along = ((cop - middle) * apart.conjugate()).real / (abs(apart) ** 2 or 1.0)
            middle += min(max(along, 0.0), share) * apart
        self.cop_m = middle + self._within_sole(self.feet[self._leading], cop - middle)

    def _within_sole(self, foot: Foot, offset_m: complex) -> complex:
        """From the middle of a sole, in the world."""
        sole_m = complex(self.body.foot_half_length_m, self.body.foot_half_width_m)
        forward = cmath.rect(1.0, foot.yaw_rad)
        return limited(offset_m * forward.conjugate(), sole_m) * forward

    def _move_com(self) -> None:
        """The pendulum's closed form over one step, and the pushes."""
        w = self.body.natural_frequency_rad_s
        lever, velocity = self.com_m - self.cop_m, self.velocity_m_s
        self.com_m = self.cop_m + lever * self._cosh + velocity * (self._sinh / w)
        self.velocity_m_s = lever * (w * self._sinh) + velocity * self._cosh
        for push in self.pushes:
            if 0 < self._steps - round(push.time_s / STEP_S) <= Push.STEPS:
                impulse = push.vector_n_s * cmath.rect(1.0, self.heading_rad) / Push.STEPS
                self.velocity_m_s += impulse / self.body.mass_kg
                self.pushed_n_s += impulse

    def _carry(self) -> None:
        """Height from the supporting legs; a fall if there is none."""
        reach = self.body.pendulum_m * math.sqrt(1 - self.body.fall_height**2)
        leading, trailing = self.feet[self._leading], self.feet[1 - self._leading]
        if self._plan is not None and self._plan.support == self._leading:
            leading.leg_m = self._plan.leg_length_m
        distances = [
            abs(self.com_m - foot.position_m) for foot in (leading, trailing) if foot.contact
        ]
        if min(distances) > reach:
            self.fallen, self.fell_at_s = True, self.time_s
            self.velocity_m_s, self.rise_m_s = 0j, 0.0
            return
        height = self._height_over(leading)
        if trailing.contact:
            apart = trailing.position_m - leading.position_m
            along = ((self.cop_m - leading.position_m) * apart.conjugate()).real / abs(apart) ** 2
            share = min(max(along, 0.0), 1.0)
            height += share * (self._height_over(trailing) - height)
        self.rise_m_s = (height - self.height_m) / STEP_S
        self.height_m = height

    def _height_over(self, foot: Foot) -> float:
        squared = foot.leg_m**2 - abs(self.com_m - foot.position_m) ** 2
        return math.sqrt(max(squared, 0.0))
