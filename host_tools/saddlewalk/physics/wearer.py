"""A wearer whose body, feet and contacts are MuJoCo's: the plan, the XCoM law and a programme of
inverse dynamics make it walk.

Where to step and where the CoP is to be is decided as by the emulated wearer; but a foot has landed
when it carries, not when it was to, and the CoM moves as the joint torques make it.
"""

from collections import deque
from dataclasses import replace
from typing import Any

import numpy as np

from saddlewalk.contract import GRAVITY_M_S2, LEFT, RIGHT
from saddlewalk.emulation import wearer as emulation
from saddlewalk.emulation.wearer import STEP_S, Measurement, Noise, Plan, PlanAt, Push
from saddlewalk.physics.gains import Gains
from saddlewalk.physics.inverse_dynamics import Contact, FootTarget, InverseDynamics, Targets
from saddlewalk.physics.plant import Plant
from saddlewalk.physics.poses import Pose
from saddlewalk.physics.swing import PlannedSwing, Swing

CONTROL_STEPS = 2  # of physics, per quadratic programme
POSE_STEPS = 40  # from a recorded pose to the next
CONTACT_N = 30.0  # load from which a sole's switch closes
SIDES = (LEFT, RIGHT)


class PhysicalWearer(emulation.Wearer):
    """With the emulated wearer's interface. Between two ticks it needs the plan at every step."""

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
        self._torques = np.zeros(plant.model.nu)
        left_m = 1j * config.step_width_slow_m / 2 - right_ahead_m / 2
        plant.stand((left_m, -left_m), np.array([0.0, 0.0, pendulum.pendulum_m]))
        self.poses: list[Pose] | None = None  # a list is filled
        self._plan_at: PlanAt | None = None
        self._since_tick_s = 0.0
        self._tick_plan: Plan | None = None
        self._swings: list[Swing | None] = [None, None]  # also of a foot that still reaches down
        self._light_steps = [0, 0]
        self._height_m = self._height_m_s = 0.0  # the filtered reference
        self._sense()
        self._height_m = self.height_m
        self._seen = deque([self._exact_now()], maxlen=1 + round(sensor_delay_s / STEP_S))

    @property
    def unsolved_share(self) -> float:
        """Of the quadratic programmes so far, without an optimum."""
        return self._dynamics.unsolved / max(self._steps / CONTROL_STEPS, 1)

    def exact(self) -> Measurement:
        """What sensors without noise give, with their delay."""
        return self._seen[0]

    def _exact_now(self) -> Measurement:
        left, right = (foot.position_m - self.com_m for foot in self.feet)
        loads_n = self.plant.loads_n
        contact = (loads_n[LEFT] > CONTACT_N, loads_n[RIGHT] > CONTACT_N)
        return Measurement(self.height_m, self.velocity_m_s, (left, right), contact)

    def follow(self, plan: Plan | None, plan_at: PlanAt | None = None) -> None:
        self._tick_plan, self._plan_at, self._since_tick_s = plan, plan_at, 0.0
        super().follow(plan)

    def step(self) -> None:
        if self._started:
            self._steps += 1
            self.time_s = self._steps * STEP_S
        if self.fallen:
            return
        self._renew_plan()
        self._plan_age_s += STEP_S
        self._since_tick_s += STEP_S
        self._since_landing_s += STEP_S
        cop = self._reference(self._plan_age_s + self.body.cop_lag_s).cop_m
        self.xcom_error_m = self.xcom_m - self._reference(self._plan_age_s).xcom_m
        self._step_feet()
        self._move_cop(cop + (1 + self.body.cop_gain) * self.xcom_error_m)
        if (self._steps - 1) % CONTROL_STEPS == 0:
            torques = self._dynamics.torques(self.plant.data, self._targets())
            self._torques = self._torques if torques is None else torques
        self.plant.step(self._torques, self._push())
        self._sense()
        self._seen.append(self._exact_now())
        if self.poses is not None and self._steps % POSE_STEPS == 0:
            self.poses.append(Pose(self.time_s, self.plant.data.qpos.copy()))

    def _renew_plan(self) -> None:
        """The plan of this step of physics; where to recover to is only known at a tick."""
        if self._since_tick_s > self.PLAN_MAX_AGE_S:
            self._plan = None
        elif self._plan_at is not None and self._since_tick_s > 0:
            plan, tick = self._plan_at(self._since_tick_s), self._tick_plan
            if plan is not None and tick is not None and plan.support == tick.support:
                plan = replace(plan, recovery=tick.recovery)
            if plan is not None:
                super().follow(plan)

    def _push(self) -> complex:
        """The force of this step, through the CoM."""
        force_n = 0j
        for push in self.pushes:
            if 0 < self._steps - round(push.time_s / STEP_S) <= Push.STEPS:
                impulse = push.vector_n_s / Push.STEPS
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

    # -- feet: planned, then as the ground has it -------------------------------------------------

    def _step_feet(self) -> None:
        stood = [foot.contact for foot in self.feet]
        self._move_feet()
        for side in SIDES:
            self._count_light_steps(side)
            if self._may_lift(side):
                self.feet[side].contact = False
        for side in SIDES:
            self._touch_down(side, stood[side])
        for side in SIDES:
            if stood[side] and not self.feet[side].contact:
                self._lift_off(side)

    def _count_light_steps(self, side: int) -> None:
        light = self.plant.loads_n[side] < self.gains.lifted_n
        self._light_steps[side] = self._light_steps[side] + 1 if light else 0

    def _may_lift(self, side: int) -> bool:
        """The trailing foot carries nothing any more, before its time."""
        plan, other = self._plan, 1 - side
        if plan is None or plan.both_feet_stand or plan.lands_beside or self._is_first_swing:
            return False
        return (
            self.feet[side].contact
            and plan.support == self._leading == other
            and self._since_landing_s > 0
            and self._light_steps[side] * STEP_S > self.gains.lifted_s
            and self.plant.loads_n[other] > self.gains.carrying_n
        )

    def _touch_down(self, side: int, stood: bool) -> None:
        foot, load_n, plan = self.feet[side], self.plant.loads_n[side], self._plan
        if foot.contact:
            if self._swings[side] and load_n > self.gains.landed_n:
                self._swings[side] = None
        elif load_n > self.gains.landed_early_n and plan is not None and not self._is_first_swing:
            early_s = plan.landing_in_s - self._plan_age_s
            if 0 < early_s < self.gains.early_max_s:
                self._land(side, early_s)
                self._hold(plan)
                self._swings[side] = None

    def _lift_off(self, side: int) -> None:
        """Unless the other foot, which should carry, has not found the ground yet."""
        if self._swings[1 - side]:
            self.feet[side].contact = True
        elif self._plan is not None:
            sole_m, pitch_rad = self.plant.sole_m(side), self.plant.sole_pitch_rad(side)
            self._swings[side] = Swing(self.gains, STEP_S, sole_m, pitch_rad)
            self._swing(self._plan, side, self.feet[side])

    def _swing(self, plan: Plan, side: int, foot: emulation.Foot) -> bool:
        """Moves the target of a foot in the air; when it has landed, the ground tells."""
        swing, age_s = self._swings[side], self._plan_age_s
        if swing is None:
            return False
        rate = plan.swing_velocity_m_s
        place = self._origin_m + plan.feet_m[side] + rate * age_s
        height_m = plan.foot_heights_m[side] + plan.swing_rise_m_s * age_s
        planned = PlannedSwing(
            position_m=np.array([place.real, place.imag, height_m]),
            velocity_m_s=np.array([rate.real, rate.imag, plan.swing_rise_m_s]),
            landing_m=self._origin_m + plan.landing_m,
            landing_in_s=plan.landing_in_s - age_s,
        )
        swing.step(planned, self._landing_shift(plan, side))
        return False

    def _landing_shift(self, plan: Plan, side: int) -> complex:
        """The recovery step where the walk is in need of one, else in proportion to the error."""
        if not self.takes_recovery_step:
            return 0j
        recovery = self._recovery_shift(plan, side)
        return recovery if self._hurries else self.gains.step_gain * self.xcom_error_m

    # -- targets of the programme -----------------------------------------------------------------

    def _targets(self) -> Targets:
        gains, step_s = self.gains, CONTROL_STEPS * STEP_S
        level = (self.com_m - self.cop_m) * self.body.natural_frequency_rad_s**2
        planned_m = self._plan.height_m if self._plan else self.body.pendulum_m
        rate = gains.height_filter_rad_s
        pull = rate * rate * (planned_m - self._height_m) - 2 * rate * self._height_m_s
        self._height_m_s += pull * step_s
        self._height_m += self._height_m_s * step_s
        rise = gains.height_stiffness * (self._height_m - self.height_m)
        rise += gains.height_damping * (self._height_m_s - self.rise_m_s)
        feet = (self._foot_target(LEFT, step_s), self._foot_target(RIGHT, step_s))
        return Targets(np.array([level.real, level.imag, rise]), feet)

    def _foot_target(self, side: int, step_s: float) -> FootTarget:
        foot, swing = self.feet[side], self._swings[side]
        if swing is not None and foot.contact:
            return self._reach_down(side, swing)
        if swing is not None and self._plan is not None:
            swing.turn_sole(self._plan.pitch_rad[side], step_s)
            return FootTarget(
                Contact.AIR,
                pitch_rad=swing.pitch_rad,
                position_m=swing.position_m,
                velocity_m_s=swing.velocity_m_s,
                acceleration_m_s2=swing.acceleration_m_s2,
            )
        if self._carries_by_the_toe(side) and self._plan is not None:
            share = max(self._trailing_share(), self.gains.trailing_share_min)
            weight_n = self.plant.body.mass_kg * GRAVITY_M_S2
            load_max_n = share * self.gains.trailing_reserve * weight_n
            return FootTarget(Contact.TOE, self._plan.pitch_rad[side], load_max_n)
        return FootTarget(Contact.SOLE)

    def _reach_down(self, side: int, swing: Swing) -> FootTarget:
        position_m = swing.position_m.copy()
        position_m[2] = self.plant.sole_m(side)[2] - self.gains.reach_down_m
        down_m_s = np.array([0.0, 0.0, -self.gains.reach_down_m_s])
        return FootTarget(
            Contact.AIR,
            position_m=position_m,
            velocity_m_s=down_m_s,
            acceleration_m_s2=np.zeros(3),
        )

    def _carries_by_the_toe(self, side: int) -> bool:
        plan, leading = self._plan, self._leading
        if plan is None or plan.both_feet_stand or self._is_first_swing or side == leading:
            return False
        return self._swings[leading] is None and not self._must_wait(plan)
