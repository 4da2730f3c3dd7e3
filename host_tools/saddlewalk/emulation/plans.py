"""The plan of the core, from its structs."""

from typing import Any

from saddlewalk.core import Core, ffi
from saddlewalk.emulation.wearer import Plan, RecoveryStep, Reference
from saddlewalk.planning.ground import on_arc


def plan_of(output: Any, core: Core) -> Plan:
    """The plan and the recovery step of a saddle_output_t; core: any with its configuration."""
    plan = planned(output.plan, core, _recovery_of(output))
    assert plan is not None  # a tick that did not fail has one
    return plan


def planned(plan: Any, core: Core, recovery: RecoveryStep | None = None) -> Plan | None:
    """A saddle_plan_t, which may be reused; None if it is not valid.

    core: any with its configuration, for what the plan says of the time after it.
    """
    if not plan.valid:
        return None
    left, right = plan.foot_m
    kept = ffi().new("saddle_plan_t *")
    ffi().memmove(kept, ffi().addressof(plan), ffi().sizeof(kept[0]))

    def reference(after_s: float) -> Reference:
        predicted = core.reference_after(kept, after_s)
        load = tuple(predicted.load)
        return Reference(_point(predicted.cop_m), _point(predicted.xcom_m), load)

    return Plan(
        mode=plan.mode,
        support=plan.support,
        heading_rad=plan.heading_rad,
        yaw_rad=tuple(plan.foot_yaw_rad),
        pelvis_yaw_rad=plan.pelvis_yaw_rad,
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
        reference=reference,
        recovery=recovery,
    )


def _recovery_of(output: Any) -> RecoveryStep | None:
    """The core says it along and across the way."""
    step, plan = output.verdict.recovery, output.plan
    if not step.found:
        return None
    landing_m, stance_m = _point(step.landing_m), _point(plan.foot_m[plan.support])
    curvature_1_m = plan.curvature_1_m[landing_m.real >= 0]
    landing_m = on_arc(curvature_1_m, landing_m + stance_m) - stance_m
    return RecoveryStep(step.foot, landing_m, _point(output.verdict.xcom_deviation_m))


def _point(vector: Any) -> complex:
    return complex(vector.x, vector.y)
