"""Landings before or after their time: the plan takes over the foot then, without a jump."""

import itertools
import math

import pytest

from saddlewalk.config import configuration
from saddlewalk.contract import LEFT, RIGHT, TICK_S
from saddlewalk.core import Command, Core, Measurement, ffi, library

SPEED_M_S = 1.0


class Walk:
    """A wearer exactly on the plan, but for the contacts that a test gives its swing foot."""

    def __init__(self, **fields: float) -> None:
        defaults = {"lost_inputs_stop": 0, "landing_early_s": 0.12}
        self.firmware = Core(configuration(defaults | fields))
        self.ticks = 0
        self.plan = None
        self.nudge_m = 0.0  # numbers that stay the same are frozen sensors
        for _ in range(60):
            self.tick()
        while not 0.3 < self.to_landing_s() < 0.38:
            self.tick()

    def to_landing_s(self) -> float:
        return self.plan.time_to_toe_off_s

    def tick(self, in_air: bool | None = None):
        """in_air: the swing foot; None: as planned, without double support."""
        plan = self.plan
        measured = Measurement()
        if plan is not None and plan.speed_m_s > 0:
            ahead = self.ahead()
            feet = [self.place(ahead, side) - self.com(ahead) for side in (LEFT, RIGHT)]
            contact = [side == ahead.support for side in (LEFT, RIGHT)]
            if in_air is not None:
                contact = [True, True]
                contact[1 - plan.support] = not in_air
            self.nudge_m = 1e-5 - self.nudge_m
            measured = Measurement(
                1.0 + self.nudge_m,
                (ahead.com_velocity_m_s.x + self.nudge_m, ahead.com_velocity_m_s.y),
                *((foot.real + self.nudge_m, foot.imag) for foot in feet),
                *contact,
            )
        output = self.firmware.tick(round(self.ticks * TICK_S * 1e6), Command(SPEED_M_S), measured)
        self.ticks += 1
        self.plan = output.plan
        self.output = output
        return self.plan

    def ahead(self):
        """What the plan says of the tick to come."""
        plan = ffi().new("saddle_plan_t *")
        time_us = round(self.ticks * TICK_S * 1e6)
        library().saddle_plan_at(self.firmware._context, time_us, plan)
        return plan

    @staticmethod
    def com(plan) -> complex:
        return complex(plan.origin_x_nm * 1e-9 + plan.com_m.x, plan.com_m.y)

    @staticmethod
    def place(plan, side: int) -> complex:
        foot = plan.foot_m[side]
        return complex(plan.origin_x_nm * 1e-9 + foot.x, foot.y)


def test_a_foot_that_lands_early_carries_at_once_and_nothing_jumps():
    walk = Walk()
    while walk.to_landing_s() > 0.16:
        walk.tick(in_air=True)
    before, steps = walk.ahead(), walk.plan.step_count
    assert before.step_count == steps and 0 < before.time_to_toe_off_s < 0.12
    com, feet = walk.com(before), [walk.place(before, side) for side in (LEFT, RIGHT)]
    velocity = before.com_velocity_m_s.y
    after = walk.tick(in_air=False)
    assert after.step_count == steps + 1 and after.support != before.support
    assert walk.com(after) == pytest.approx(com, abs=1e-5)
    for side in (LEFT, RIGHT):
        assert walk.place(after, side) == pytest.approx(feet[side], abs=3e-5)
    assert after.com_velocity_m_s.y == pytest.approx(velocity, abs=1e-3)
    assert after.foot_m[after.support].z == 0.0
    # The walk goes on by planned steps.
    for _ in range(20):
        walk.tick()
    assert walk.plan.speed_m_s == pytest.approx(SPEED_M_S)
    assert walk.plan.step_count >= steps + 3 and not walk.output.limits


@pytest.mark.parametrize(("early_s", "carries"), [(0.12, False), (0.3, True)])
def test_only_a_little_early(early_s, carries):
    walk = Walk(landing_early_s=early_s)
    walk.tick(in_air=True)
    steps, left_s = walk.plan.step_count, walk.ahead().time_to_toe_off_s
    assert 0.15 < left_s < 0.3
    assert (walk.tick(in_air=False).step_count == steps + 1) == carries


def test_a_foot_that_never_lifted_has_not_landed():
    walk = Walk()
    for in_air in (None, False):  # to the next landing, then with the foot on the ground
        count = walk.plan.step_count
        while walk.plan.step_count == count:
            left_s = walk.to_landing_s()
            walk.tick(in_air)
    assert left_s < TICK_S + 1e-3


def test_a_late_foot_is_waited_for_and_nothing_jumps():
    walk = Walk()
    steps = walk.plan.step_count
    late_s, last = 0.0, None
    while walk.plan.step_count == steps:
        due = walk.ahead()
        last = (walk.com(walk.plan), [walk.place(walk.plan, side) for side in (LEFT, RIGHT)])
        overdue = due.step_count > steps or late_s > 0
        late_s += TICK_S if overdue else 0.0
        walk.tick(in_air=True)
        moved = walk.com(walk.plan) - last[0]
        assert moved.real == pytest.approx(SPEED_M_S * TICK_S, abs=1e-3)
        assert abs(moved.imag) < 0.02
        if walk.plan.step_count == steps and overdue:
            assert walk.plan.time_to_toe_off_s == 0.0
            assert walk.place(walk.plan, 1 - walk.plan.support) == pytest.approx(
                complex(walk.plan.origin_x_nm * 1e-9 + walk.plan.landing_m.x,
                        walk.plan.landing_m.y), abs=1e-4)  # fmt: skip
    # Not for longer than the configuration says: to a tick.
    assert late_s + TICK_S > 0.12 and late_s <= 0.12 + 2 * TICK_S and late_s > TICK_S


def test_a_foot_is_not_late_while_the_measurement_is_older_than_the_landing():
    walk = Walk()
    walk.firmware._input.measurement.foot[LEFT].age_us = 0
    steps = walk.plan.step_count
    while walk.ahead().step_count == steps:
        walk.tick(in_air=True)
    time_us = round(walk.ticks * TICK_S * 1e6)
    due = walk.ahead()
    left_s = walk.to_landing_s()
    inputs = walk.firmware._input
    inputs.time_us = time_us
    for side in (LEFT, RIGHT):
        place = Walk.place(due, side) - Walk.com(due)
        inputs.measurement.foot[side].cop_m.x, inputs.measurement.foot[side].cop_m.y = (
            place.real, place.imag,
        )  # fmt: skip
        inputs.measurement.foot[side].contact = side == walk.plan.support
        inputs.measurement.foot[side].age_us = round((TICK_S - left_s) * 1e6) + 1000
    output = ffi().new("saddle_output_t *")
    library().saddle_tick(walk.firmware._context, inputs, output)
    assert output.plan.step_count == steps + 1


@pytest.mark.parametrize("fields", [{}, {"landing_early_s": 0.0, "landing_late_s": 0.0}])
def test_nothing_changes_for_a_wearer_in_time_or_without_measurements(fields):
    plain, walk = Core(configuration({})), Walk(**fields)
    for _ in range(30):
        walk.tick()
    for tick in range(walk.ticks):
        alone = plain.tick(round(tick * TICK_S * 1e6), Command(SPEED_M_S), Measurement())
    assert alone.plan.step_count == walk.plan.step_count
    assert walk.com(alone.plan) == pytest.approx(walk.com(walk.plan), abs=1e-3)
    assert math.isclose(alone.plan.theta_rad, walk.plan.theta_rad, abs_tol=2e-3)


def last_of_swings(**fields: float) -> list[tuple[float, float, float]]:
    """Way that is left, height and forward speed of the swing foot, 60 ms before each landing."""
    firmware, plan = Core(configuration(fields)), ffi().new("saddle_plan_t *")
    seen, heights = [], []
    for tick in range(150):
        speed = SPEED_M_S if tick < 110 else None
        planned = firmware.tick(round(tick * TICK_S * 1e6), Command(speed), Measurement()).plan
        for step in range(80):
            time_us = round(tick * TICK_S * 1e6) + step * 1000
            library().saddle_plan_at(firmware._context, time_us, plan)
            foot = plan.foot_m[1 - plan.support]
            heights.append(foot.z)
            if planned.speed_m_s > 0 and abs(plan.time_to_toe_off_s - 0.06) < 5e-4:
                left_m = plan.landing_m.x - foot.x
                if left_m > 0.04:  # the first swing is a slower half
                    seen.append((left_m, foot.z, plan.swing_velocity_m_s.z))
    steps = [abs(after - before) for before, after in itertools.pairwise(heights)]
    assert max(steps) < 2e-3  # 1.4 m/s at the steepest
    return seen


def test_a_foot_can_come_down_from_above():
    skimming, approaching = last_of_swings(), last_of_swings(swing_approach=0.3)
    assert len(skimming) == len(approaching) >= 8
    for (left_m, low_m, _), (same_m, height_m, rate_m_s) in zip(skimming, approaching, strict=True):
        assert left_m == same_m and low_m < 0.005
        assert height_m == pytest.approx(min(0.3 * left_m, 0.03), rel=1e-3)
        assert rate_m_s < 0.0
