"""The C codec and saddlewalk.transport.wire agree on every bit, in both directions."""

import functools
import math
import random
import re

import can
import numpy as np
import pytest
from cffi import FFI

from saddlewalk import paths, ticks
from saddlewalk.transport import wire

pytestmark = pytest.mark.firmware

SEED = 20261122
OUTPUTS = 1000  # of 31 frames
INPUTS = 3000  # of 4 frames

NUMBERS = {
    "PLAN_COM": {"X": "plan.com_m.x", "Y": "plan.com_m.y", "Z": "plan.com_m.z"},
    "PLAN_COM_VELOCITY": {
        "VX": "plan.com_velocity_m_s.x",
        "VY": "plan.com_velocity_m_s.y",
        "VZ": "plan.com_velocity_m_s.z",
    },
    "PLAN_LEFT": {"X": "plan.foot_m.0.x", "Y": "plan.foot_m.0.y", "Z": "plan.foot_m.0.z"},
    "PLAN_RIGHT": {"X": "plan.foot_m.1.x", "Y": "plan.foot_m.1.y", "Z": "plan.foot_m.1.z"},
    "PLAN_SWING": {
        "VX": "plan.swing_velocity_m_s.x",
        "VY": "plan.swing_velocity_m_s.y",
        "VZ": "plan.swing_velocity_m_s.z",
    },
    "PLAN_LANDING": {
        "X": "plan.landing_m.x",
        "Y": "plan.landing_m.y",
        "LEG_LENGTH": "plan.leg_length_m",
    },
    "PLAN_ANKLE": {
        "TOE_OFF": "plan.toe_off_rad",
        "HEEL_STRIKE": "plan.heel_strike_rad",
        "SPEED": "plan.speed_m_s",
    },
    "PLAN_STEP": {"THETA": "plan.theta_rad", "STEP_LENGTH": "plan.step_length_m"},
    "PLAN_EVENTS": {
        "TIME_TO_VIA_POINT": "plan.time_to_via_point_s",
        "TIME_TO_HEEL_STRIKE": "plan.time_to_heel_strike_s",
        "TIME_TO_TOE_OFF": "plan.time_to_toe_off_s",
    },
    "PLAN_PITCH": {
        "LEFT": "plan.foot_pitch_rad.0",
        "RIGHT": "plan.foot_pitch_rad.1",
        "KNEE_FLEXION": "plan.knee_flexion_m",
    },
    "PLAN_REFERENCE_XCOM": {
        "X": "plan.reference.xcom_m.x",
        "Y": "plan.reference.xcom_m.y",
        "LOAD_LEFT": "plan.reference.load.0",
    },
    "PLAN_REFERENCE_COP": {
        "X": "plan.reference.cop_m.x",
        "Y": "plan.reference.cop_m.y",
        "LOAD_RIGHT": "plan.reference.load.1",
    },
    "PLAN_REFERENCE_COM": {
        "X": "plan.reference.com_m.x",
        "Y": "plan.reference.com_m.y",
        "RATE": "plan.acceleration_m_s2",
    },
    "PLAN_LAST_STEP": {
        "X": "plan.last_step_m.x",
        "Y": "plan.last_step_m.y",
        "WIDTH": "plan.step_width_m",
    },
    "PLAN_WAY": {
        "HEADING": "plan.heading_rad",
        "CURVATURE_BEHIND": "plan.curvature_1_m.0",
        "CURVATURE_AHEAD": "plan.curvature_1_m.1",
    },
    "PLAN_YAW": {
        "LEFT": "plan.foot_yaw_rad.0",
        "RIGHT": "plan.foot_yaw_rad.1",
        "PELVIS": "plan.pelvis_yaw_rad",
    },
    "SCORES_STEP": {"S_PEND": "scores.s_pend", "S_JUMP": "scores.s_jump", "S_SW": "scores.s_sw"},
    "SCORES_MARGIN": {
        "MOS_COM": "scores.mos_com_m",
        "MOS_XCOM": "scores.mos_xcom_m",
        "V_COMP": "scores.v_comp_m_s",
    },
    "SCORES_FORCE": {"GRAVITY_X": "scores.gravity_n.x", "GRAVITY_Y": "scores.gravity_n.y"},
    "SCORES_ENERGY": {
        "EXCESS_STOP": "scores.excess_stop_j",
        "EXCESS_TRACK": "verdict.excess_track_j",
    },
    "SCORES_EXPECTED": {"EBOS_COM": "verdict.ebos_com_m", "EBOS_XCOM": "verdict.ebos_xcom_m"},
    "VERDICT": {
        "XCOM_DEVIATION_X": "verdict.xcom_deviation_m.x",
        "XCOM_DEVIATION_Y": "verdict.xcom_deviation_m.y",
    },
    "RECOVERY": {
        "X": "verdict.recovery.landing_m.x",
        "Y": "verdict.recovery.landing_m.y",
        "MARGIN": "verdict.recovery.margin_m",
    },
    "BALANCE": {"BALANCE_MARGIN": "verdict.margin", "CAUTION_BELOW": "verdict.caution_below"},
    "LEARNED_MEAN": {
        "VX": "walk.velocity_m_s.x",
        "VY": "walk.velocity_m_s.y",
        "HEIGHT": "walk.height_m",
    },
    "LEARNED_STEP": {
        "TIME": "walk.step_time_s",
        "LENGTH": "walk.step_length_m",
        "WIDTH": "walk.step_width_m",
    },
    "LEARNED_STEADINESS": {"RIPPLE": "walk.ripple", "STEP_MARGIN": "walk.step_margin"},
    "TIMING": {},
    "RECEIVED": {},
    "INPUTS": {},
    "HEALTH": {},
}
VALID_BIT = {
    "S_PEND": "SADDLE_VALID_STEP",
    "S_JUMP": "SADDLE_VALID_STEP",
    "S_SW": "SADDLE_VALID_S_SW",
    "MOS_COM": "SADDLE_VALID_MOS_COM",
    "MOS_XCOM": "SADDLE_VALID_MOS_XCOM",
    "V_COMP": "SADDLE_VALID_V_COMP",
    "GRAVITY_X": "SADDLE_VALID_GRAVITY",
    "GRAVITY_Y": "SADDLE_VALID_GRAVITY",
    "EXCESS_STOP": "SADDLE_VALID_STOP",
}
# Fields that are known while another one, of the same output, is above 0.
KNOWN_BY = {
    "verdict.margin": "verdict.margin_known",
    "verdict.caution_below": "verdict.margin_known",
    **dict.fromkeys(
        ("walk.velocity_m_s.x", "walk.velocity_m_s.y", "walk.height_m"), "walk.height_m"
    ),
    **dict.fromkeys(
        ("walk.step_time_s", "walk.step_length_m", "walk.step_width_m", "walk.step_margin"),
        "walk.step_time_s",
    ),
    "walk.ripple": "walk.ripple",
}
MEASURED = {
    "MEASURED_COM": {
        "HEIGHT": "com.height_m",
        "VX": "com.velocity_m_s.x",
        "VY": "com.velocity_m_s.y",
    },
    "MEASURED_LEFT": {"X": "foot.0.cop_m.x", "Y": "foot.0.cop_m.y", "GROUND": "foot.0.ground_m_s"},
    "MEASURED_RIGHT": {"X": "foot.1.cop_m.x", "Y": "foot.1.cop_m.y", "GROUND": "foot.1.ground_m_s"},
}
JOINTS = "HIP_YAW HIP_ROLL HIP_PITCH KNEE ANKLE_PITCH ANKLE_ROLL".split()
SIDES = ("LEFT", "RIGHT")
SENSED = {
    "SENSED_GYRO": {axis: f"gyro_rad_s.{axis.lower()}" for axis in "XYZ"},
    "SENSED_ACCELEROMETER": {axis: f"accelerometer_m_s2.{axis.lower()}" for axis in "XYZ"},
    "SENSED_LOADS": {side: f"load_n.{number}" for number, side in enumerate(SIDES)},
} | {
    f"SENSED_{side}_{part}": {
        joint.removeprefix("HIP_"): f"angle_rad.{number}.{JOINTS.index(joint)}" for joint in joints
    }
    for number, side in enumerate(SIDES)
    for part, joints in (("HIP", JOINTS[:3]), ("LEG", JOINTS[3:]))
}
JOINT = {"ANGLE": "angle_rad", "RATE": "rate_rad_s", "TORQUE": "torque_nm"}
GAINS = {
    "STIFFNESS": "stiffness",
    "DAMPING": "damping",
    "TORQUE_MIN": "torque_min_nm",
    "TORQUE_MAX": "torque_max_nm",
}
COMMANDED = {
    f"{kind}_{side}_{joint}": {
        signal: f"joint.{number}.{JOINTS.index(joint)}.{field}" for signal, field in fields.items()
    }
    for kind, fields in (("JOINT", JOINT), ("GAINS", GAINS))
    for number, side in enumerate(SIDES)
    for joint in JOINTS
}
# Counts and codes: field of saddle_wire_health_t, the largest number that is sent (None: modulo
# 65536), how much of the field is one unit of the signal.
COUNTS = {
    "HEALTH": {
        "LATE_TICKS": ("late_ticks", 65535, 1),
        "REJECTED_FRAMES": ("rejected_frames", 65535, 1),
    },
    "RECEIVED": {
        "ACCEPTED": ("accepted", None, 1),
        "MALFORMED": ("malformed", 255, 1),
        "BAD_CRC": ("bad_crc", 255, 1),
        "BAD_VERSION": ("bad_version", 255, 1),
        "BAD_COUNTER": ("bad_counter", 255, 1),
    },
    "INPUTS": {
        "COMMAND_SOURCE": ("command_source", 3, 1),
        "SENDER_CLOCK": ("sender_clock", 1, 1),
        "MEASURED_BY": ("by_sensors", 1, 1),
        "COMMAND_AGE": ("input_age_us.0", 4095, 1000),
        "COM_AGE": ("input_age_us.1", 4095, 1000),
        "LEFT_AGE": ("input_age_us.2", 4095, 1000),
        "RIGHT_AGE": ("input_age_us.3", 4095, 1000),
    },
}
TIMES = {"PERIOD": "period_us", "LATENCY": "latency_us", "LATENCY_MAX": "latency_max_us"}
COMMAND = {
    "SPEED": "speed_m_s",
    "HEEL_STRIKE": "heel_strike_rad",
    "TURN_RATE": "turn_rate_rad_s",
}
BYTE = {"TURN_RATE", "TORQUE_MIN", "TORQUE_MAX"}  # numbers of 8 bits; the others have 16

ffi = FFI()


@pytest.fixture(scope="module")
def codec():
    """The C codec."""
    ffi.cdef(paths.built("saddlewalk_wire_cdef.h").read_text())
    return ffi.dlopen(str(paths.built("lib/libsaddlewalk_wire_shared.so")))


def step(struct, name: str):
    return struct[int(name)] if name.isdigit() else getattr(struct, name)


def put(struct, path: str, value: float) -> None:
    *parents, last = path.split(".")
    parent = functools.reduce(step, parents, struct)
    if last.isdigit():
        parent[int(last)] = value
    else:
        setattr(parent, last, value)


def get(struct, path: str) -> float:
    return functools.reduce(step, path.split("."), struct)


def same(a: float, b: float) -> bool:
    return a == b or (math.isnan(a) and math.isnan(b))


@functools.cache
def scale_of(message: str, signal: str) -> float:
    """Read from the DBC's text, apart from the code under test."""
    text = (paths.CHECKOUT / "firmware/wire/saddlewalk.dbc").read_text()
    bits = 8 if signal in BYTE else 16
    pattern = rf"BO_ \d+ {message}:.*?SG_ {signal} : \d+\|{bits}@1- \(([^,]+),0\)"
    return float(re.search(pattern, text, re.DOTALL)[1])


def any_number(rng: random.Random, scale: float, last: int = 32767) -> float:
    """Ordinary, on and beyond the ends of the range, halfway between two steps, or no number."""
    end = last * scale
    kinds = (
        lambda: rng.uniform(-end, end),
        lambda: rng.randint(-last - 1, last + 1) * scale,
        lambda: (rng.randint(-last - 1, last) + 0.5) * scale,
        lambda: rng.choice((-1, 1)) * (end + rng.uniform(-2, 2) * scale),
        lambda: rng.choice((-1, 1)) * end * 10 ** rng.uniform(0, 30),
        lambda: rng.choice((0.0, -0.0, 1e-45, -1e-39, 3.4e38, math.inf, -math.inf, math.nan)),
    )
    return float(np.float32(rng.choice(kinds)()))


def message_of(frame) -> can.Message:
    return can.Message(arbitration_id=frame.id, is_extended_id=False, data=bytes(frame.data))


def last_of(signal: str) -> int:
    """The largest raw value of a number."""
    return 127 if signal in BYTE else 32767


def assert_decoded(expected: float, value: float, scale: float, last: int = 32767) -> None:
    """Within half a step, or the end of the range, or nothing: independent of both codecs."""
    end = last * scale
    if not math.isfinite(value):
        assert math.isnan(expected)
    else:
        # 1e-6 of the number: two single-precision roundings, of the quotient and of the product.
        nearest = min(max(value, -end), end)
        assert abs(expected - nearest) <= scale / 2 + 1e-6 * abs(nearest)


def is_known(codec, output, signal: str, field: str) -> bool:
    """Whether the output holds that number at all."""
    if field.startswith("plan."):
        return output.plan.valid
    if field in KNOWN_BY:
        return get(output, KNOWN_BY[field]) > 0
    if signal in VALID_BIT:
        return bool(output.scores.valid & getattr(codec, VALID_BIT[signal]))
    found = output.verdict.recovery.found or "landing" not in field
    stop = output.scores.valid & codec.SADDLE_VALID_STOP or "excess" not in field
    return bool(output.verdict.compared and found and stop)


def random_states(rng: random.Random):
    """A saddle_output_t with everything but its numbers."""
    output = ffi.new("saddle_output_t *")
    output.status = rng.randrange(5)
    output.limits, output.faults = rng.randrange(32), rng.randrange(2**14)
    plan, scores, verdict = output.plan, output.scores, output.verdict
    plan.valid = rng.random() < 0.8
    plan.mode, plan.phase, plan.support = rng.randrange(4), rng.randrange(4), rng.randrange(2)
    plan.step_count = rng.randrange(2**32)
    scores.valid = rng.randrange(128)
    scores.can_stop, scores.paper_stable = rng.randrange(2), rng.randrange(2)
    verdict.level, verdict.reason = rng.randrange(4), rng.randrange(17)
    verdict.driver, verdict.margin_known = rng.randrange(17), rng.random() < 0.8
    verdict.compared, verdict.on_track = rng.random() < 0.8, rng.randrange(2)
    recovery = verdict.recovery
    recovery.found, recovery.stops, recovery.foot = (rng.randrange(2) for _ in range(3))
    return output


def random_output(codec, rng: random.Random):
    """A saddle_output_t, and what its frames must say, by the names of the DBC."""
    output = random_states(rng)
    plan, scores, verdict = output.plan, output.scores, output.verdict
    expected = {}
    for message, signals in NUMBERS.items():
        expected[message] = {}
        for signal, field in signals.items():
            expected[message][signal] = any_number(rng, scale_of(message, signal))
            put(output, field, expected[message][signal])
    for message, signals in NUMBERS.items():
        for signal, field in signals.items():
            if not is_known(codec, output, signal, field):
                expected[message][signal] = math.nan
    expected["PLAN_STEP"] |= {"VALID": plan.valid, "SUPPORT": plan.support, "PHASE": plan.phase}
    expected["PLAN_STEP"]["STEP_COUNT"] = plan.step_count % 65536
    expected["PLAN_EVENTS"]["MODE"] = plan.mode
    expected["SCORES_FORCE"]["FAULTS"] = output.faults
    expected["SCORES_ENERGY"] |= {"CAN_STOP": scores.can_stop, "ON_TRACK": verdict.on_track}
    expected["SCORES_ENERGY"]["PAPER_STABLE"] = scores.paper_stable
    expected["VERDICT"] |= {"LEVEL": verdict.level, "REASON": verdict.reason}
    expected["VERDICT"]["COMPARED"] = verdict.compared
    expected["BALANCE"]["DRIVER"] = verdict.driver
    recovery = verdict.recovery
    expected["RECOVERY"] |= {
        "FOUND": recovery.found,
        "STOPS": recovery.stops,
        "FOOT": recovery.foot,
    }
    expected["HEALTH"] = {"STATUS": output.status, "LIMITS": output.limits}
    return output, expected


def random_health(rng: random.Random):
    """A saddle_wire_health_t, and what its frames must say."""
    health = ffi.new("saddle_wire_health_t *")
    expected = {}
    for message, signals in COUNTS.items():
        expected[message] = {}
        for signal, (field, largest, unit) in signals.items():
            bits = {1: 1, 3: 2}.get(largest) or rng.randint(1, 32)
            value = rng.randrange(2**bits)
            put(health, field, value)
            sent = value // unit
            expected[message][signal] = sent % 65536 if largest is None else min(sent, largest)
    expected["TIMING"] = {}
    for signal, field in TIMES.items():
        time_us = rng.randrange(2 ** rng.randint(1, 32))
        put(health, field, time_us)
        expected["TIMING"][signal] = float(np.float32(time_us) * np.float32(1e-6))
    return health, expected


def test_output_from_c_to_python(codec):
    rng = random.Random(SEED)
    frames = ffi.new("saddle_frame_t[]", len(NUMBERS))
    sender, receiver = wire.Sender(), wire.Receiver()
    for counter in range(OUTPUTS):
        output, expected = random_output(codec, rng)
        health, process = random_health(rng)
        for name, values in process.items():
            expected[name] = expected.get(name, {}) | values
        codec.saddle_wire_encode_output(output, health, counter % 256, frames)
        for frame, (name, values) in zip(frames, expected.items(), strict=True):
            assert sender.frame(name, **values).data == bytes(frame.data), (name, values)
            received_name, received = receiver.accept(message_of(frame))
            assert (received_name, received["COUNTER"]) == (name, counter % 16)
            for signal in values:
                if signal in NUMBERS[name] or signal in TIMES:
                    assert_decoded(received[signal], values[signal], scale_of(name, signal))
                else:
                    assert received[signal] == values[signal], signal
    assert receiver.accepted == OUTPUTS * len(NUMBERS)


def test_python_and_c_have_the_same_messages_per_tick(codec):
    header = paths.CHECKOUT / "firmware/wire/include/saddlewalk/wire.h"
    (frames,) = re.findall(r"#define SADDLE_WIRE_OUTPUT_FRAMES (\d+)u", header.read_text())
    assert int(frames) == len(ticks.MESSAGES) == len(NUMBERS)
    assert NUMBERS.keys() == ticks.MESSAGES


def random_measurement(rng: random.Random):
    measurement = ffi.new("saddle_measurement_t *")
    expected = {}
    for message, signals in MEASURED.items():
        expected[message] = {name: any_number(rng, scale_of(message, name)) for name in signals}
        for name, field in signals.items():
            put(measurement, field, expected[message][name])
    for side, message in enumerate(("MEASURED_LEFT", "MEASURED_RIGHT")):
        measurement.foot[side].contact = expected[message]["CONTACT"] = rng.random() < 0.5
    return measurement, expected


def test_measurement_both_ways(codec):
    rng = random.Random(SEED + 1)
    frames = ffi.new("saddle_frame_t[]", len(MEASURED))
    decoded = ffi.new("saddle_measurement_t *")
    sender, python = wire.Sender(), wire.Receiver()
    c = ffi.new("saddle_wire_receiver_t *")
    for counter in range(INPUTS):
        measurement, expected = random_measurement(rng)
        codec.saddle_wire_encode_measurement(measurement, counter % 256, frames)
        for frame, (name, values) in zip(frames, expected.items(), strict=True):
            sent = sender.frame(name, **values)
            assert sent.data == bytes(frame.data), (name, values)
            message = codec.saddle_wire_accept(c, sent.arbitration_id, bytes(sent.data), 8)
            assert message == getattr(codec, f"SADDLE_WIRE_{name}")
            codec.saddle_wire_decode_measured(message, bytes(sent.data), decoded)
            _, received = python.accept(sent)
            for signal, field in MEASURED[name].items():
                assert same(get(decoded, field), received[signal])
                assert_decoded(received[signal], values[signal], scale_of(name, signal))
    assert c.accepted == python.accepted == INPUTS * len(MEASURED)


def random_numbers(rng: random.Random, struct, messages):
    """Fills the fields of a struct; what its frames must say."""
    expected = {}
    for message, signals in messages.items():
        expected[message] = {}
        for name, field in signals.items():
            value = any_number(rng, scale_of(message, name), last_of(name))
            expected[message][name] = value
            put(struct, field, value)
    return expected


def test_sensors_both_ways(codec):
    rng = random.Random(SEED + 4)
    frames = ffi.new("saddle_frame_t[]", len(SENSED))
    sensors, decoded = ffi.new("saddle_sensors_t *"), ffi.new("saddle_sensors_t *")
    sender, python = wire.Sender(), wire.Receiver()
    c = ffi.new("saddle_wire_receiver_t *")
    for number in range(INPUTS):
        expected = random_numbers(rng, sensors, SENSED)
        codec.saddle_wire_encode_sensors(sensors, number % 256, frames)
        for frame, (name, values) in zip(frames, expected.items(), strict=True):
            sent = sender.frame(name, **values)
            assert sent.data == bytes(frame.data), (name, values)
            message = codec.saddle_wire_accept(c, frame.id, frame.data, 8)
            assert message == getattr(codec, f"SADDLE_WIRE_{name}")
            codec.saddle_wire_decode_sensors(message, frame.data, decoded)
            _, received = python.accept(sent)
            for signal, field in SENSED[name].items():
                assert same(get(decoded, field), received[signal])
                assert_decoded(received[signal], values[signal], scale_of(name, signal))
    assert c.accepted == python.accepted == INPUTS * len(SENSED)


def test_joint_commands_from_c_to_python(codec):
    rng = random.Random(SEED + 5)
    frames = ffi.new("saddle_frame_t[]", len(COMMANDED) + 1)
    commands, estimate = ffi.new("saddle_joint_commands_t *"), ffi.new("saddle_estimate_t *")
    sender, receiver = wire.Sender(), wire.Receiver()
    for counter in range(OUTPUTS):
        expected = random_numbers(rng, commands, COMMANDED)
        commands.fallback = rng.random() < 0.5
        estimate.faults, estimate.lost_joints = rng.randrange(2**16), rng.randrange(2**12)
        expected["JOINTS_STATE"] = {
            "FALLBACK": commands.fallback,
            "FAULTS": estimate.faults,
            "LOST_JOINTS": estimate.lost_joints,
        }
        codec.saddle_wire_encode_joints(commands, estimate, counter % 256, frames)
        for frame, (name, values) in zip(frames, expected.items(), strict=True):
            assert sender.frame(name, **values).data == bytes(frame.data), (name, values)
            received_name, received = receiver.accept(message_of(frame))
            assert received_name == name
            for signal, value in values.items():
                if name == "JOINTS_STATE":
                    assert received[signal] == value
                else:
                    scale = scale_of(name, signal)
                    assert_decoded(received[signal], value, scale, last_of(signal))
    assert receiver.accepted == OUTPUTS * (len(COMMANDED) + 1)


def test_command_both_ways(codec):
    rng = random.Random(SEED + 2)
    frame = ffi.new("saddle_frame_t *")
    command, decoded = ffi.new("saddle_command_t *"), ffi.new("saddle_command_t *")
    sender, python = wire.Sender(), wire.Receiver()
    c = ffi.new("saddle_wire_receiver_t *")
    for counter in range(INPUTS):
        values = {
            name: any_number(rng, scale_of("COMMAND", name), last_of(name)) for name in COMMAND
        }
        for name, field in COMMAND.items():
            put(command, field, values[name])
        command.mode = rng.choice((0, 1, 2, 15, 16, 17, 255))
        sent = sender.frame("COMMAND", MODE=command.mode, **values)
        codec.saddle_wire_encode_command(command, counter % 256, frame)
        assert sent.data == bytes(frame.data), values
        assert codec.saddle_wire_accept(c, frame.id, frame.data, 8) == codec.SADDLE_WIRE_COMMAND
        codec.saddle_wire_decode_command(frame.data, decoded)
        assert decoded.mode == min(command.mode, 15)
        _, received = python.accept(sent)
        for name, field in COMMAND.items():
            assert same(get(decoded, field), received[name])
    assert c.accepted == INPUTS


def test_every_raw_value_decodes_alike(codec):
    sender = wire.Sender()
    decoded = ffi.new("saddle_command_t *")
    frame = sender.frame("COMMAND", MODE=1, SPEED=0.0, HEEL_STRIKE=0.0)
    for raw in range(-32768, 32768):
        frame.data[2:4] = raw.to_bytes(2, "little", signed=True)
        frame.data[0] = wire.frame_crc(frame.arbitration_id, frame.data)
        codec.saddle_wire_decode_command(bytes(frame.data), decoded)
        _, values = wire.Receiver().accept(frame)
        assert same(decoded.speed_m_s, values["SPEED"])


def test_every_byte_decodes_alike(codec):
    decoded = ffi.new("saddle_command_t *")
    frame = wire.Sender().frame("COMMAND", MODE=1, SPEED=0.0, HEEL_STRIKE=0.0)
    for raw in range(256):
        frame.data[7] = raw
        frame.data[0] = wire.frame_crc(frame.arbitration_id, frame.data)
        codec.saddle_wire_decode_command(bytes(frame.data), decoded)
        _, values = wire.Receiver().accept(frame)
        assert same(decoded.turn_rate_rad_s, values["TURN_RATE"])
        signed = raw - 256 if raw > 127 else raw
        assert raw == 128 or values["TURN_RATE"] == pytest.approx(0.01 * signed)


def test_counter_rule_on_both_sides(codec):
    """Random sequences of losses, repeats, restarts and noise are checked alike."""
    rng = random.Random(SEED + 3)
    frames = [wire.Sender().frame("COMMAND", MODE=1, SPEED=1.2, HEEL_STRIKE=0.1) for _ in range(16)]
    for counter, frame in enumerate(frames):
        frame.data[1] = frame.data[1] & 0xF0 | counter
        frame.data[0] = wire.frame_crc(frame.arbitration_id, frame.data)
    for _ in range(300):
        c, python = ffi.new("saddle_wire_receiver_t *"), wire.Receiver()
        counter = rng.randrange(16)
        for _ in range(100):
            counter += rng.choice((1, 1, 1, 0, 2, 4, 5, rng.randrange(16)))
            frame = frames[counter % 16]
            in_c = codec.saddle_wire_accept(c, frame.arbitration_id, bytes(frame.data), 8)
            assert (in_c == codec.SADDLE_WIRE_COMMAND) == (python.accept(frame) is not None)
        assert (c.accepted, c.bad_counter) == (python.accepted, python.bad_counter)
        assert python.bad_counter > 0


def test_arbitrary_bytes_are_checked_alike(codec):
    """Random identifiers, lengths and bytes, some with the right CRC."""
    rng = random.Random(SEED + 4)
    c, python = ffi.new("saddle_wire_receiver_t *"), wire.Receiver()
    for _ in range(5000):
        identifier = rng.choice((0x100, 0x110, 0x111, 0x112, 0x000, 0x7FF))
        data = bytearray(rng.randbytes(rng.choice((8, 8, 8, 8, 8, 8, 0, 7))))
        if len(data) == 8 and rng.random() < 0.7:
            data[6] = rng.choice((wire.OLDEST_VERSION, wire.WIRE_VERSION, data[6]))
            data[0] = wire.frame_crc(identifier, data)
        frame = can.Message(arbitration_id=identifier, is_extended_id=False, data=data)
        in_c = codec.saddle_wire_accept(c, identifier, bytes(data), len(data))
        assert (in_c != codec.SADDLE_WIRE_NONE) == (python.accept(frame) is not None)
    for count in ("accepted", "malformed", "bad_crc", "bad_version", "bad_counter"):
        assert getattr(c, count) == getattr(python, count) > 0


def test_crc_check_value():
    assert wire.crc(b"123456789") == 0x4B


@pytest.mark.parametrize("flag", ["is_extended_id", "is_remote_frame", "is_error_frame", "is_fd"])
def test_only_classic_data_frames_are_accepted(flag):
    receiver = wire.Receiver()
    frame = wire.Sender().frame("COMMAND", MODE=0, SPEED=0.0, HEEL_STRIKE=0.0)
    setattr(frame, flag, True)
    assert receiver.accept(frame) is None
    assert receiver.malformed == receiver.rejected == 1


@pytest.mark.parametrize(
    ("name", "values", "named"),
    [
        ("COMAND", {}, "COMAND"),
        ("MEASURED_LEFT", {"CONTACT": 1, "X": 0.0}, "'Y'"),
        ("MEASURED_LEFT", {"CONTACT": 1, "X": 0.0, "Y": 0.0, "Z": 0.0}, "'Z'"),
    ],
)
def test_the_sender_names_a_wrong_signal(name, values, named):
    with pytest.raises(ValueError, match=named):
        wire.Sender().frame(name, **values)
