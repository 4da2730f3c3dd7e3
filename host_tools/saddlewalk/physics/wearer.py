"""A wearer whose body, feet and contacts are MuJoCo's; plan, XCoM law and inverse dynamics move it.

Where to step, when, and what each foot carries is the plan's; but a foot has landed when it
carries, and the CoM moves as the joint torques make it.
"""

import cmath
import math
from collections import deque
from dataclasses import replace
from typing import Any

import numpy as np

from saddlewalk.contract import GRAVITY_M_S2, LEFT, RIGHT
from saddlewalk.emulation import wearer as emulation
from saddlewalk.emulation.wearer import STEP_S, Measurement, Noise, Plan, PlanAt, Push
from saddlewalk.physics.gains import Gains
from saddlewalk.physics.inverse_dynamics import Contact, FootTarget, InverseDynamics, Targets, Yaw
from saddlewalk.physics.plant import Plant
from saddlewalk.physics.poses import Pose
from saddlewalk.physics.swing import PlannedSwing, Swing

CONTROL_STEPS = 4  # of physics, per quadratic programme and sensing; they divide a tick
CONTROL_S = CONTROL_STEPS * STEP_S
POSE_STEPS = 40  # from a recorded pose to the next
CONTACT_N = 30.0  # load from which a sole's switch closes
SIDES = (LEFT, RIGHT)


class PhysicalWearer(emulation.Wearer):
    """With the emulated wearer's interface. Between two ticks it needs the plan at any time."""

    def __init__(
        self,
        plant: Plant,
        config: Any,
        noise: Noise | None = None,
        pushes: tuple[Push, ...] = (),
        seed: int = 0,
        takes_recovery_step: bool = True,
        right_ahead_m: float = 0.0,
        sensor_delay_s: float = 0.0,
    ) -> None:
        """config: the firmware's saddle_config_t; noise: of the sensors alone."""
        pendulum = replace(
            emulation.Body.of(config),
            foot_half_width_m=plant.body.sole_half_width_m,
        )
        noise = replace(noise or Noise(), cop_m=0.0)
        super().__init__(pendulum, noise, pushes, seed, takes_recovery_step, right_ahead_m)
        self.plant, self.gains = plant, Gains()
        self._dynamics = InverseDynamics(plant.body, self.gains)
        self._weight_n = plant.body.mass_kg * GRAVITY_M_S2
        self._torques = np.zeros(plant.model.nu)
        left_m = 1j * config.step_width_slow_m / 2 - right_ahead_m / 2
        plant.stand((left_m, -left_m), np.array([0.0, 0.0, pendulum.pendulum_m]))
        self.poses: list[Pose] | None = None  # a list is filled
        self._plan_at: PlanAt | None = None
        self._tick_plan: Plan | None = None
        self._since_tick_s = 0.0
        self._until_control = 0  # steps of physics
        self._programmes = 0
        self._swings: list[Swing | None] = [None, None]  # also of a foot that still reaches down
        self._landed_early: int | None = None  # the swing foot that stands before the plan says so
        self._light_s = [0.0, 0.0]
        self._yaws_rad = [0.0, 0.0, 0.0]  # wanted last, of the feet and the pelvis
        self._sense()
        self._height_m, self._height_m_s = self.height_m, 0.0  # the filtered reference
        self._seen = deque([self._exact_now()], maxlen=1 + round(sensor_delay_s / CONTROL_S))

    @property
    def unsolved_share(self) -> float:
        """Of the quadratic programmes so far, without an optimum."""
        return self._dynamics.unsolved / max(self._programmes, 1)

    def skeleton(self) -> emulation.Skeleton:
        return self.plant.skeleton()

    def peaks(self) -> dict[str, tuple[float, float, float]]:
        return self.plant.peaks_of_joints()

    @property
    def heading_rad(self) -> float:
        """Of the pelvis."""
        return self.plant.pelvis_yaw_rad

    def exact(self) -> Measurement:
        """What sensors without noise give, with their delay."""
        return self._seen[0]

    def _exact_now(self) -> Measurement:
        to_pelvis = cmath.rect(1.0, -self.heading_rad)
        left, right = ((foot.position_m - self.com_m) * to_pelvis for foot in self.feet)
        loads_n = self.plant.loads_n
        contact = (loads_n[LEFT] > CONTACT_N, loads_n[RIGHT] > CONTACT_N)
        return Measurement(self.height_m, self.velocity_m_s * to_pelvis, (left, right), contact)

    def follow(self, plan: Plan | None, plan_at: PlanAt | None = None) -> None:
        self._plan = self._tick_plan = plan
        self._plan_at = plan_at
        self._plan_age_s = self._since_tick_s = 0.0
        self._until_control = 0
        self._started = self._started or plan is not None

    def step(self) -> None:
        self._advance_time()
        if self.fallen:
            return
        if self._until_control == 0:
            self._control()
            self._until_control = CONTROL_STEPS
        self._until_control -= 1
        sensed = self._until_control == 0
        self.plant.step(self._torques, self._push(), sensed)
        self._plan_age_s += STEP_S
        self._since_tick_s += STEP_S
        if sensed:
            self._sense()
            self._seen.append(self._exact_now())
        self._record_pose()

    def _record_pose(self) -> None:
        if self.poses is not None and self._steps % POSE_STEPS == 0:
            self.poses.append(Pose(self.time_s, self.plant.data.qpos.copy()))

    def _push(self) -> complex:
        """The force of this step, through the CoM."""
        force_n = 0j
        for push in self.pushes:
            if 0 < self._steps - round(push.time_s / STEP_S) <= Push.STEPS:
                impulse = push.vector_n_s * cmath.rect(1.0, self.heading_rad) / Push.STEPS
                self.pushed_n_s += impulse
                force_n += impulse / STEP_S
        return force_n

    def _sense(self) -> None:
        com, velocity = self.plant.com_m, self.plant.com_velocity_m_s
        self.com_m, self.height_m = complex(com[0], com[1]), float(com[2])
        self.velocity_m_s, self.rise_m_s = complex(velocity[0], velocity[1]), float(velocity[2])
        for side, foot in enumerate(self.feet):
            sole = self.plant.sole_m(side)
            foot.position_m, foot.height_m = complex(sole[0], sole[1]), max(float(sole[2]), 0.0)
        if self.height_m < self.body.fall_height * self.body.pendulum_m:
            self.fallen, self.fell_at_s = True, self.time_s
            self.velocity_m_s, self.rise_m_s = 0j, 0.0

    # -- control ----------------------------------------------------------------------------------

    def _control(self) -> None:
        self._renew_plan()
        self._step_feet()
        self._place_frame()
        self._swing_on()
        self._balance()
        torques = self._dynamics.torques(self.plant.data, self._targets())
        self._torques = self._torques if torques is None else torques
        self._programmes += 1

    def _renew_plan(self) -> None:
        """The plan of now; where to recover to is only known at a tick."""
        if self._since_tick_s > self.PLAN_MAX_AGE_S:
            self._plan = None
        elif self._plan_at is not None and self._since_tick_s > 0:
            plan, tick = self._plan_at(self._since_tick_s), self._tick_plan
            if plan is not None and tick is not None and plan.support == tick.support:
                plan = replace(plan, recovery=tick.recovery)
            if plan is not None:
                self._plan, self._plan_age_s = plan, 0.0

    def _place_frame(self) -> None:
        """The plan's frame against the foot that it steps on or, once that has landed, steps to."""
        plan = self._plan
        if plan is None:
            return
        if self._landed_early is None:
            foot, place = plan.support, plan.feet_m[plan.support]
        else:
            foot, place = self._landed_early, plan.landing_m
        self._ahead = plan.ahead
        self._origin_m = self.feet[foot].position_m - place * self._ahead
        for side in SIDES:
            self.feet[side].yaw_rad = plan.heading_rad + plan.yaw_rad[side]

    def _balance(self) -> None:
        """The CoP that is wanted: the reference's and more by the XCoM's error, within the feet."""
        cop_m = self._reference(self._plan_age_s + self.body.cop_lag_s).cop_m
        reference = self._reference(self._plan_age_s)
        self.xcom_error_m = self.xcom_m - reference.xcom_m
        wanted = cop_m + (1 + self.body.cop_gain) * self.xcom_error_m
        cop_m = self.cop_m + (wanted - self.cop_m) * (CONTROL_S / self.body.cop_lag_s)
        stance = LEFT if self._plan is None else self._plan.support
        other, middle_m = 1 - stance, self.feet[stance].position_m
        share = self._share(other)
        if share > 0:
            apart_m = self.feet[other].position_m - middle_m
            along = ((cop_m - middle_m) * apart_m.conjugate()).real / abs(apart_m) ** 2
            middle_m += min(max(along, 0.0), share) * apart_m
        self.cop_m = middle_m + self._within_sole(self.feet[stance], cop_m - middle_m)

    def _share(self, side: int) -> float:
        """The most of the weight that a foot may carry which the plan does not step on."""
        plan = self._plan
        if not self.feet[side].contact:
            return 0.0
        if plan is None or plan.both_feet_stand or self._landed_early is not None:
            return 1.0
        return plan.reference(self._plan_age_s).load[side]

    # -- feet: planned, then as the ground has it -------------------------------------------------

    def _step_feet(self) -> None:
        plan = self._plan
        for side in SIDES:
            light = self.plant.loads_n[side] < self.gains.lifted_n
            self._light_s[side] = self._light_s[side] + CONTROL_S if light else 0.0
            if self.plant.loads_n[side] > self.gains.landed_n and self.feet[side].contact:
                self._swings[side] = None
        if plan is None or plan.both_feet_stand:
            for side in SIDES:
                self.feet[side].contact = True
            self._landed_early = None
            return
        self.feet[plan.support].contact = True
        if self._landed_early == plan.support:
            self._landed_early = None
        side = 1 - plan.support
        if self.feet[side].contact:
            if self._may_lift(plan, side):
                self._lift_off(side)
        else:
            self._touch_down(plan, side)

    def _may_lift(self, plan: Plan, side: int) -> bool:
        """It has handed over its load, or carries nothing any more before its time; not while the
        foot that is to carry has not found the ground."""
        due = self._plan_age_s >= plan.landing_in_s
        if due or self._landed_early == side or self._swings[plan.support]:
            return False
        if self._share(side) <= 0.0:
            return True
        carried = self.plant.loads_n[plan.support] > self.gains.carrying_n
        return self._light_s[side] > self.gains.lifted_s and carried and not plan.lands_beside

    def _lift_off(self, side: int) -> None:
        self.feet[side].contact = False
        self._recovery_shift_m, self._hurries = 0j, False
        sole_m, pitch_rad = self.plant.sole_m(side), self.plant.sole_pitch_rad(side)
        self._swings[side] = Swing(self.gains, CONTROL_S, sole_m, pitch_rad)

    def _touch_down(self, plan: Plan, side: int) -> None:
        left_s = plan.landing_in_s - self._plan_age_s
        if left_s <= 0:
            self.feet[side].contact = True
        elif (
            left_s < self.gains.early_max_s
            and self.plant.loads_n[side] > self.plant.body.landed_early_n
        ):
            self.feet[side].contact = True
            self._swings[side], self._landed_early = None, side

    def _swing_on(self) -> None:
        """Moves the target of a foot in the air."""
        plan, age_s = self._plan, self._plan_age_s
        if plan is None:
            return
        side = 1 - plan.support
        swing = self._swings[side]
        if swing is None or self.feet[side].contact:
            return
        rate = plan.swing_velocity_m_s * self._ahead
        place = self.in_world(plan.feet_m[side]) + rate * age_s
        height_m = plan.foot_heights_m[side] + plan.swing_rise_m_s * age_s
        height_m += min(self.plant.sole_rise_m(side), self.gains.sole_rise_max_m)
        planned = PlannedSwing(
            position_m=np.array([place.real, place.imag, height_m]),
            velocity_m_s=np.array([rate.real, rate.imag, plan.swing_rise_m_s]),
            landing_in_s=plan.landing_in_s - age_s,
        )
        swing.step(planned, self._landing_shift(plan, side))

    def _landing_shift(self, plan: Plan, side: int) -> complex:
        """The recovery step where the walk is in need of one, else in proportion to the error."""
        if not self.takes_recovery_step:
            return 0j
        recovery = self._recovery_shift(plan, side) * self._ahead
        return recovery if self._hurries else self.gains.step_gain * self.xcom_error_m

    # -- targets of the programme -----------------------------------------------------------------

    def _targets(self) -> Targets:
        gains = self.gains
        level = (self.com_m - self.cop_m) * self.body.natural_frequency_rad_s**2
        planned_m = self._plan.height_m if self._plan else self.body.pendulum_m
        rate = gains.height_filter_rad_s
        pull = rate * rate * (planned_m - self._height_m) - 2 * rate * self._height_m_s
        self._height_m_s += pull * CONTROL_S
        self._height_m += self._height_m_s * CONTROL_S
        rise = gains.height_stiffness * (self._height_m - self.height_m)
        rise += gains.height_damping * (self._height_m_s - self.rise_m_s)
        left, right, pelvis = self._yaws()
        feet = (self._foot_target(LEFT, left), self._foot_target(RIGHT, right))
        return Targets(np.array([level.real, level.imag, rise]), feet, pelvis)

    def _yaws(self) -> list[Yaw]:
        """Of the feet and the pelvis, as planned."""
        before_rad, plan = self._yaws_rad, self._plan
        if plan is None:
            return [Yaw(rad) for rad in before_rad]
        self._yaws_rad = [plan.heading_rad + yaw for yaw in (*plan.yaw_rad, plan.pelvis_yaw_rad)]
        return [
            Yaw(now, math.remainder(now - before, math.tau) / CONTROL_S)
            for now, before in zip(self._yaws_rad, before_rad, strict=True)
        ]

    def _foot_target(self, side: int, yaw: Yaw) -> FootTarget:
        foot, swing, plan = self.feet[side], self._swings[side], self._plan
        if swing is not None and foot.contact:
            return self._reach_down(side, swing, yaw)
        if swing is not None and plan is not None:
            swing.turn_sole(plan.pitch_rad[side], CONTROL_S)
            return FootTarget(
                Contact.AIR,
                pitch_rad=swing.pitch_rad,
                yaw=yaw,
                position_m=swing.position_m,
                velocity_m_s=swing.velocity_m_s,
                acceleration_m_s2=swing.acceleration_m_s2,
            )
        if plan is not None and self._trails(plan, side):
            share = max(self._share(side), self.gains.trailing_share_min)
            load_max_n = share * self.gains.trailing_reserve * self._weight_n
            return FootTarget(Contact.TOE, plan.pitch_rad[side], yaw, load_max_n)
        return FootTarget(Contact.SOLE, yaw=yaw)

    def _trails(self, plan: Plan, side: int) -> bool:
        """Hands its load over to a foot that has landed."""
        if plan.both_feet_stand or self._swings[1 - side]:
            return False
        leading = plan.support if self._landed_early is None else self._landed_early
        return side != leading

    def _reach_down(self, side: int, swing: Swing, yaw: Yaw) -> FootTarget:
        position_m = swing.position_m.copy()
        position_m[2] = self.plant.sole_m(side)[2] - self.gains.reach_down_m
        down_m_s = np.array([0.0, 0.0, -self.gains.reach_down_m_s])
        return FootTarget(
            Contact.AIR,
            yaw=yaw,
            position_m=position_m,
            velocity_m_s=down_m_s,
            acceleration_m_s2=np.zeros(3),
        )
