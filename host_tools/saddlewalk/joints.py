"""The C library of the joints in this process: segments, joint angles, estimates and commands."""

from collections.abc import Mapping
from typing import Any

from saddlewalk.core import ffi, library
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
