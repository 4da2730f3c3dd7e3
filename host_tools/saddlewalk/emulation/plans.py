"""The plan of the core, from its structs."""

from typing import Any

from saddlewalk.emulation.wearer import Plan, RecoveryStep


def plan_of(output: Any) -> Plan:
    """The plan and the recovery step of a saddle_output_t."""
    plan = planned(output.plan, _recovery_of(output.verdict))
    assert plan is not None  # a tick that did not fail has one
    return plan


def planned(plan: Any, recovery: RecoveryStep | None = None) -> Plan | None:
    """A saddle_plan_t; None if it is not valid."""
    if not plan.valid:
        return None
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
        height_m=plan.com_m.z,
        pitch_rad=tuple(plan.foot_pitch_rad),
        recovery=recovery,
    )


def _recovery_of(verdict: Any) -> RecoveryStep | None:
    step = verdict.recovery
    if not step.found:
        return None
    return RecoveryStep(step.foot, _point(step.landing_m), _point(verdict.xcom_deviation_m))


def _point(vector: Any) -> complex:
    return complex(vector.x, vector.y)
