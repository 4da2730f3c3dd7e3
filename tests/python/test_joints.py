"""The library of the joints through its binding: a posture there and back, and rejected bodies."""

import math

import pytest

from saddlewalk import core, joints
from saddlewalk.core import ffi
from saddlewalk.errors import UserError

pytestmark = pytest.mark.firmware

UPRIGHT = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def test_a_squat_by_the_law_of_cosines():
    """Hips straight above the ankles: thigh, shank and the height make a triangle."""
    body = joints.legs(1.79, 63.3)
    thigh, shank = body.thigh_m, body.shank_m
    height = 0.7
    trunk = ffi().new("saddle_trunk_t *", {"hips_m": (0, 0, height), "axes": UPRIGHT})
    half = body.hip_half_width_m
    ankle = (body.ankle_to_middle_m, -body.ankle_height_m)  # of the sole from the ankle: x, z
    feet = ffi().new(
        "saddle_foot_t[2]", [{"position_m": (ankle[0], y, ankle[1])} for y in (half, -half)]
    )
    found, reach = joints.inverse(body, trunk, feet)
    assert reach.valid and not reach.angle_limits
    knee = math.pi - math.acos((thigh**2 + shank**2 - height**2) / (2 * thigh * shank))
    hip = -math.acos((thigh**2 + height**2 - shank**2) / (2 * thigh * height))
    for side in (0, 1):
        expected = [0, 0, hip, knee, -hip - knee, 0]
        assert list(found.angle_rad[side]) == pytest.approx(expected, abs=1e-5)
    posture = joints.forward(body, trunk, found)
    assert posture.foot[1].sole_m.y == pytest.approx(-half, abs=1e-6)
    assert posture.foot[1].sole_m.x == pytest.approx(ankle[0], abs=1e-6)


def test_what_was_measured_takes_the_place_of_the_default():
    assert joints.legs(1.79, 63.3, {"thigh_m": 0.41}).thigh_m == pytest.approx(0.41)


@pytest.mark.parametrize(
    ("measured", "message"),
    [
        ({"tigh_m": 0.4}, "tigh_m is not a field of the legs; fields are thigh_m, shank_m"),
        ({"shank_m": 4.0}, "shank_m = 4 must be in 0.1 to 0.8"),
        ({"knee_min_rad": 3.0}, "knee_min_rad = 3 does not fit the other fields of the legs"),
        ({"foot_kg": math.nan}, "foot_kg = nan must be in 0.05 to 30"),
    ],
)
def test_a_body_that_is_none_is_rejected_by_name(measured, message):
    with pytest.raises(UserError, match=message):
        joints.legs(1.79, 63.3, measured)


def test_somebody_who_stands_is_measured_once_the_tilt_has_settled():
    body = joints.legs(1.79, 63.3)
    estimator = joints.Estimator(body)
    sensors = estimator.sensors
    sensors.accelerometer_m_s2.z = 9.80665
    sensors.load_n[0], sensors.load_n[1] = 300.0, 320.0
    ages = []
    for k in range(100):
        sensors.time_us = 10_000 * k
        measured = estimator.update().measurement
        ages.append(measured.com.age_us)
    assert ages[30] == core.AGE_NEVER_US and ages[-1] == 0
    upright = joints.forward(
        body, ffi().new("saddle_trunk_t *", {"axes": UPRIGHT}), ffi().new("saddle_joints_t *")
    )
    height = upright.com.position_m.z - upright.foot[0].sole_m.z
    assert measured.com.height_m == pytest.approx(height, abs=1e-4)
    assert measured.com.velocity_m_s.x == pytest.approx(0, abs=1e-3)
    assert [foot.contact for foot in measured.foot] == [True, True]
    half = body.hip_half_width_m
    assert [foot.cop_m.y for foot in measured.foot] == pytest.approx([half, -half], abs=1e-4)


def test_a_setting_that_is_out_of_its_range_is_named():
    settings = ffi().new("saddle_estimator_config_t *", core.library().saddle_estimator_default())
    settings.slip_m_s = 9.0
    with pytest.raises(UserError, match="slip_m_s is out of its range"):
        joints.Estimator(joints.legs(1.79, 63.3), settings)
