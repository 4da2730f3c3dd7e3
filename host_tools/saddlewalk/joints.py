"""The C library of the joints in this process: segments, joint angles, estimates and commands."""

from collections.abc import Mapping
from typing import Any

from saddlewalk.core import ffi, library
from saddlewalk.emulation.wearer import Plan, RecoveryStep
from saddlewalk.errors import UserError


def fields() -> dict[str, Any]:
    """Every field of saddle_legs_t: its saddle_config_field_t, with place and accepted range."""
    found: dict[str, Any] = {}
    while (field := library().saddle_legs_field(len(found))) != ffi().NULL:
        found[ffi().string(field.name).decode()] = field
    return found


def legs(height_m: float, mass_kg: float, measured: Mapping[str, float] | None = None) -> Any:
    """The saddle_legs_t * of a body; measured lengths replace the defaults.

    Raises UserError for an unknown field and for a value that is not accepted.
    """
    result = ffi().new("saddle_legs_t *", library().saddle_legs_default(height_m, mass_kg))
    known = fields()
    for name, value in (measured or {}).items():
        if name not in known:
            raise UserError(f"{name} is not a field of the legs; fields are {', '.join(known)}")
        ffi().cast("float *", ffi().cast("char *", result) + known[name].offset)[0] = value
    bad = library().saddle_legs_check(result)
    if bad != ffi().NULL:
        name = ffi().string(bad).decode()
        value = ffi().cast("float *", ffi().cast("char *", result) + known[name].offset)[0]
        low, high = known[name].min, known[name].max
        if low <= value <= high:
            raise UserError(f"{name} = {value:g} does not fit the other fields of the legs")
        raise UserError(f"{name} = {value:g} must be in {low:g} to {high:g}")
    return result


def loop_settings(
    config: Any, measured: Mapping[str, float] | None = None
) -> list[tuple[str, str, float]]:
    """Part, name and value of every field of saddle_joint_loop_default() for a
    saddle_config_t, in the order of a controller's settings. measured: fields of the legs.
    """
    lib, body = library(), (config.body_height_m, config.body_mass_kg)
    segments = ffi().new("saddle_legs_t *", lib.saddle_legs_default(*body))
    walk = ffi().new("saddle_joint_walk_config_t *", lib.saddle_joint_walk_default())
    walk.double_support_share = config.double_support_share
    estimator = ffi().new("saddle_estimator_config_t *", lib.saddle_estimator_default())
    drive = ffi().new("saddle_drive_config_t *", lib.saddle_drive_default())
    settings = []
    for part, field_at, values in (
        ("legs", lib.saddle_legs_field, segments),
        ("estimator", lib.saddle_estimator_field, estimator),
        ("walk", lib.saddle_joint_walk_field, walk),
        ("drive", lib.saddle_drive_field, drive),
    ):
        index = 0
        while (field := field_at(index)) != ffi().NULL:
            place = ffi().cast("float *", ffi().cast("char *", values) + field.offset)
            name = ffi().string(field.name).decode()
            given = (measured or {}).get(name) if part == "legs" else None
            settings.append((part, name, place[0] if given is None else given))
            index += 1
    return settings


def inverse(body: Any, trunk: Any, feet: Any) -> tuple[Any, Any]:
    """saddle_inverse(): the saddle_joints_t * of a saddle_trunk_t * and two saddle_foot_t, and what
    had to give way, a saddle_reach_t.
    """
    joints = ffi().new("saddle_joints_t *")
    return joints, library().saddle_inverse(body, trunk, feet, joints)


def forward(body: Any, trunk: Any, joints: Any) -> Any:
    """saddle_forward(): the saddle_whole_body_t * of a saddle_trunk_t * and a saddle_joints_t *."""
    posture = ffi().new("saddle_whole_body_t *")
    library().saddle_forward(body, trunk, joints, posture)
    return posture


class Estimator:
    """One saddle_estimator_t: what the core measures a wearer by, from a device's sensors.

    `sensors` is the saddle_sensors_t * that the caller fills before each `update()`.
    """

    def __init__(self, body: Any, settings: Any | None = None) -> None:
        config = settings or ffi().new(
            "saddle_estimator_config_t *", library().saddle_estimator_default()
        )
        bad = library().saddle_estimator_check(config)
        if bad != ffi().NULL:
            raise UserError(f"{ffi().string(bad).decode()} is out of its range")
        self.config = config
        self._state = ffi().new("saddle_estimator_t *")
        self.sensors = ffi().new("saddle_sensors_t *")
        library().saddle_estimator_init(self._state, body, config)

    def update(self) -> Any:
        """saddle_estimator_update(): the saddle_estimate_t * of the sensors as they are."""
        estimate = ffi().new("saddle_estimate_t *")
        library().saddle_estimator_update(self._state, self.sensors, estimate)
        return estimate


def commands(body: Any, drive: Any, estimate: Any, intent: Any) -> Any:
    """saddle_joint_commands(): the saddle_joint_commands_t * for a saddle_drive_config_t *, a
    saddle_estimate_t * and a saddle_intent_t *.
    """
    result = ffi().new("saddle_joint_commands_t *")
    library().saddle_joint_commands(body, drive, estimate, intent, result)
    return result


class Controller:
    """Walking layer and joint commands of one body, from the plan and the estimate.

    `walk` and `drive` are their configurations; change them before the first `commands()`. `intent`
    is the last saddle_intent_t *.
    """

    def __init__(self, body: Any, double_support_share: float) -> None:
        lib = library()
        self.drive = ffi().new("saddle_drive_config_t *", lib.saddle_drive_default())
        self.walk = ffi().new("saddle_joint_walk_config_t *", lib.saddle_joint_walk_default())
        self.walk.double_support_share = double_support_share
        self._body = body
        self._state = ffi().new("saddle_joint_walk_t *")
        self._input = ffi().new("saddle_joint_walk_input_t *")
        self._plan = ffi().new("saddle_plan_t *")
        self._verdict = ffi().new("saddle_verdict_t *")
        self.intent = ffi().new("saddle_intent_t *")
        self._commands = ffi().new("saddle_joint_commands_t *")

    def commands(
        self, time_us: int, plan: Plan | None, estimate: Any, takes_recovery_step: bool = True
    ) -> Any:
        """saddle_joint_walk_update() and saddle_joint_commands(): a saddle_joint_commands_t * that
        is reused.
        """
        lib = library()
        if not self._state.initialised:
            lib.saddle_joint_walk_init(self._state, self._body, self.walk)
        self._input.time_us = time_us
        self._input.plan = ffi().NULL if plan is None else _fill_plan(self._plan, plan)
        recovery = plan.recovery if plan and takes_recovery_step else None
        self._input.verdict = _fill_verdict(self._verdict, recovery) if recovery else ffi().NULL
        lib.saddle_joint_walk_update(self._state, self._input, estimate, self.intent)
        lib.saddle_joint_commands(self._body, self.drive, estimate, self.intent, self._commands)
        return self._commands


def _fill_plan(target: Any, plan: Plan) -> Any:
    """What the walking layer reads of a plan."""
    target.valid = True
    target.mode, target.support = plan.mode, plan.support
    target.speed_m_s, target.step_length_m = plan.speed_m_s, plan.step_length_m
    target.com_m.z = plan.height_m
    for foot, place_m, height_m in zip(
        target.foot_m, plan.feet_m, plan.foot_heights_m, strict=True
    ):
        foot.x, foot.y, foot.z = place_m.real, place_m.imag, height_m
    target.foot_pitch_rad = plan.pitch_rad
    rate = plan.swing_velocity_m_s
    swing = target.swing_velocity_m_s
    swing.x, swing.y, swing.z = rate.real, rate.imag, plan.swing_rise_m_s
    target.time_to_via_point_s = plan.time_to_via_point_s
    target.time_to_toe_off_s = plan.time_to_landing_s
    _fill_point(target.landing_m, plan.landing_m)
    reference = plan.reference(0.0)
    _fill_point(target.reference.cop_m, reference.cop_m)
    _fill_point(target.reference.xcom_m, reference.xcom_m)
    return target


def _fill_verdict(target: Any, step: RecoveryStep) -> Any:
    target.recovery.found, target.recovery.foot = True, step.foot
    _fill_point(target.recovery.landing_m, step.landing_m)
    _fill_point(target.xcom_deviation_m, step.xcom_deviation_m)
    return target


def _fill_point(target: Any, point: complex) -> None:
    target.x, target.y = point.real, point.imag
