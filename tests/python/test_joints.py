"""The library of the joints through its binding: a posture there and back, and rejected bodies."""

import math

import pytest

from saddlewalk import joints
from saddlewalk.core import ffi
from saddlewalk.errors import UserError

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
        ({"tigh_m": 0.4}, "tigh_m is no field of the legs; they have thigh_m, shank_m"),
        ({"shank_m": 4.0}, "shank_m = 4 must be in 0.1 to 0.8"),
        ({"knee_min_rad": 3.0}, "knee_min_rad = 3 does not fit the other fields of the legs"),
        ({"foot_kg": math.nan}, "foot_kg = nan must be in 0.05 to 30"),
    ],
)
def test_a_body_that_is_none_is_rejected_by_name(measured, message):
    with pytest.raises(UserError, match=message):
        joints.legs(1.79, 63.3, measured)
