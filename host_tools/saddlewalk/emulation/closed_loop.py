"""The core and an emulated wearer in one process, without buses, tick by tick."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from saddlewalk import core
from saddlewalk.contract import LEFT, RIGHT, TICK_S
from saddlewalk.emulation import wearer as emulator
from saddlewalk.emulation.wearer import STEP_S, Plan, RecoveryStep, Wearer
from saddlewalk.planning.schedule import Schedule

STEPS_A_TICK = round(TICK_S / STEP_S)


@dataclass(frozen=True)
class Tick:
    """Input and output of the core at time_s of the walk, before the wearer moves."""

    time_s: float
    measured: emulator.Measurement
    exact: emulator.Measurement  # the same without the sensors' noise
    output: Any  # saddle_output_t
    plan: Plan


AfterStep = Callable[[Tick, int], None]


def walk(
    config: Any, wearer: Wearer, schedule: Schedule, after_step: AfterStep | None = None
) -> Iterator[Tick]:
    """Endless; the wearer moves on by a tick when the next one is asked for.

    config: saddle_config_t; after_step(tick, steps since it): called after every step of physics.
    """
    firmware, index = core.Core(config), 0
    while True:
        exact, measured = wearer.exact(), wearer.measure()
        time_s = index * TICK_S
        output = firmware.tick(round(time_s * 1e6), schedule(time_s), measurement_of(measured))
        tick = Tick(time_s, measured, exact, output, plan_of(output))
        wearer.follow(tick.plan)
        yield tick
        for step in range(1, STEPS_A_TICK + 1):
            wearer.step()
            if after_step:
                after_step(tick, step)
        index += 1


def measurement_of(measured: emulator.Measurement) -> core.Measurement:
    velocity, (left, right) = measured.velocity_m_s, measured.feet_m
    return core.Measurement(
        com_height_m=measured.height_m,
        com_velocity_m_s=(velocity.real, velocity.imag),
        left_cop_m=(left.real, left.imag),
        right_cop_m=(right.real, right.imag),
        left_contact=measured.contact[LEFT],
        right_contact=measured.contact[RIGHT],
    )


def plan_of(output: Any) -> Plan:
    """The plan and the recovery step of a saddle_output_t."""
    plan = output.plan
    left, right = plan.foot_m
    return Plan(
        mode=plan.mode,
        support=plan.support,
        step_length_m=plan.step_length_m,
        speed_m_s=plan.speed_m_s,
        com_m=_point(plan.com_m),
        velocity_m_s=_point(plan.com_velocity_m_s),
        feet_m=(_point(left), _point(right)),
        foot_heights_m=(left.z, right.z),
        swing_velocity_m_s=_point(plan.swing_velocity_m_s),
        swing_rise_m_s=plan.swing_velocity_m_s.z,
        time_to_via_point_s=plan.time_to_via_point_s,
        time_to_landing_s=plan.time_to_toe_off_s,
        landing_m=_point(plan.landing_m),
        leg_length_m=plan.leg_length_m,
        recovery=_recovery_of(output.verdict),
    )


def _recovery_of(verdict: Any) -> RecoveryStep | None:
    step = verdict.recovery
    if not step.found:
        return None
    return RecoveryStep(step.foot, _point(step.landing_m), _point(verdict.xcom_deviation_m))


def _point(vector: Any) -> complex:
    return complex(vector.x, vector.y)
