"""Every field of an output reaches the signals and members that belong to it, and no others.

A field is changed alone, the output is encoded for CAN and LCM by the host's own code, decoded
here, and compared with the one before. That finds a field that is mapped twice, to another's place
or not at all, and a signal that no field reaches.
"""

import functools
import math

import can
import cantools
import pytest

from saddlewalk import paths
from saddlewalk.contract import OUTPUT_FRAMES
from saddlewalk.firmware import ffi, library
from saddlewalk.transport import lcm_types, wire

pytestmark = pytest.mark.firmware

# Field of saddle_output_t, signal on CAN, members on LCM; -: not on that bus. What is added to a
# struct fails here until it has a line.
FIELDS = """
    status                      HEALTH.STATUS                   -
    limits                      HEALTH.LIMITS                   -
    faults                      SCORES_FORCE.FAULTS             -
    plan.valid                  PLAN_STEP.VALID                 plan.valid
    plan.mode                   PLAN_EVENTS.MODE                plan.mode
    plan.phase                  PLAN_STEP.PHASE                 plan.phase
    plan.support                PLAN_STEP.SUPPORT               plan.support
    plan.step_count             PLAN_STEP.STEP_COUNT            plan.step_count
    plan.stride_count           -                               plan.stride_count
    plan.theta_rad              PLAN_STEP.THETA                 plan.theta_rad
    plan.origin_x_nm            -                               plan.origin_x_m
    plan.origin_y_nm            -                               way.origin_y_m
    plan.heading_rad            PLAN_WAY.HEADING                way.heading_rad
    plan.curvature_1_m[0]       PLAN_WAY.CURVATURE_BEHIND       way.curvature_1_m[0]
    plan.curvature_1_m[1]       PLAN_WAY.CURVATURE_AHEAD        way.curvature_1_m[1]
    plan.speed_m_s              PLAN_ANKLE.SPEED                plan.speed_m_s
    plan.step_length_m          PLAN_STEP.STEP_LENGTH           plan.step_length_m
    plan.step_width_m           PLAN_LAST_STEP.WIDTH                         plan.step_width_m
    plan.com_m.x                PLAN_COM.X                      plan.com_m[0]
    plan.com_m.y                PLAN_COM.Y                      plan.com_m[1]
    plan.com_m.z                PLAN_COM.Z                      plan.com_m[2]
    plan.com_velocity_m_s.x     PLAN_COM_VELOCITY.VX            plan.com_velocity_m_s[0]
    plan.com_velocity_m_s.y     PLAN_COM_VELOCITY.VY            plan.com_velocity_m_s[1]
    plan.com_velocity_m_s.z     PLAN_COM_VELOCITY.VZ            plan.com_velocity_m_s[2]
    plan.foot_m[0].x            PLAN_LEFT.X                     plan.left_m[0]
    plan.foot_m[0].y            PLAN_LEFT.Y                     plan.left_m[1]
    plan.foot_m[0].z            PLAN_LEFT.Z                     plan.left_m[2]
    plan.foot_m[1].x            PLAN_RIGHT.X                    plan.right_m[0]
    plan.foot_m[1].y            PLAN_RIGHT.Y                    plan.right_m[1]
    plan.foot_m[1].z            PLAN_RIGHT.Z                    plan.right_m[2]
    plan.foot_pitch_rad[0]      PLAN_PITCH.LEFT                 plan.foot_pitch_rad[0]
    plan.foot_pitch_rad[1]      PLAN_PITCH.RIGHT                plan.foot_pitch_rad[1]
    plan.foot_yaw_rad[0]        PLAN_YAW.LEFT                   way.foot_yaw_rad[0]
    plan.foot_yaw_rad[1]        PLAN_YAW.RIGHT                  way.foot_yaw_rad[1]
    plan.pelvis_yaw_rad         PLAN_YAW.PELVIS                 way.pelvis_yaw_rad
    plan.swing_velocity_m_s.x   PLAN_SWING.VX                   plan.swing_velocity_m_s[0]
    plan.swing_velocity_m_s.y   PLAN_SWING.VY                   plan.swing_velocity_m_s[1]
    plan.swing_velocity_m_s.z   PLAN_SWING.VZ                   plan.swing_velocity_m_s[2]
    plan.leg_length_m           PLAN_LANDING.LEG_LENGTH         plan.leg_length_m
    plan.knee_flexion_m         PLAN_PITCH.KNEE_FLEXION         plan.knee_flexion_m
    plan.toe_off_rad            PLAN_ANKLE.TOE_OFF              plan.toe_off_rad
    plan.heel_strike_rad        PLAN_ANKLE.HEEL_STRIKE          plan.heel_strike_rad
    plan.time_to_via_point_s    PLAN_EVENTS.TIME_TO_VIA_POINT   plan.time_to_via_point_s
    plan.time_to_heel_strike_s  PLAN_EVENTS.TIME_TO_HEEL_STRIKE plan.time_to_heel_strike_s
    plan.time_to_toe_off_s      PLAN_EVENTS.TIME_TO_TOE_OFF     plan.time_to_toe_off_s
    plan.landing_m.x            PLAN_LANDING.X                  plan.landing_m[0]
    plan.landing_m.y            PLAN_LANDING.Y                  plan.landing_m[1]
    plan.acceleration_m_s2      PLAN_REFERENCE_COM.RATE         plan.acceleration_m_s2
    plan.last_step_m.x          PLAN_LAST_STEP.X                plan.last_step_m[0]
    plan.last_step_m.y          PLAN_LAST_STEP.Y                plan.last_step_m[1]
    plan.reference.com_m.x      PLAN_REFERENCE_COM.X            plan.reference_com_m[0]
    plan.reference.com_m.y      PLAN_REFERENCE_COM.Y            plan.reference_com_m[1]
    plan.reference.xcom_m.x     PLAN_REFERENCE_XCOM.X           plan.reference_xcom_m[0]
    plan.reference.xcom_m.y     PLAN_REFERENCE_XCOM.Y           plan.reference_xcom_m[1]
    plan.reference.cop_m.x      PLAN_REFERENCE_COP.X            plan.reference_cop_m[0]
    plan.reference.cop_m.y      PLAN_REFERENCE_COP.Y            plan.reference_cop_m[1]
    plan.reference.load[0]      PLAN_REFERENCE_XCOM.LOAD_LEFT   plan.load[0]
    plan.reference.load[1]      PLAN_REFERENCE_COP.LOAD_RIGHT   plan.load[1]
    scores.v_comp_m_s           SCORES_MARGIN.V_COMP            scores.v_comp_m_s
    scores.s_pend               SCORES_STEP.S_PEND              scores.s_pend
    scores.s_jump               SCORES_STEP.S_JUMP              scores.s_jump
    scores.s_sw                 SCORES_STEP.S_SW                scores.s_sw
    scores.mos_com_m            SCORES_MARGIN.MOS_COM           scores.mos_com_m
    scores.mos_xcom_m           SCORES_MARGIN.MOS_XCOM          scores.mos_xcom_m
    scores.gravity_n.x          SCORES_FORCE.GRAVITY_X          scores.gravity_n[0]
    scores.gravity_n.y          SCORES_FORCE.GRAVITY_Y          scores.gravity_n[1]
    scores.excess_stop_j        SCORES_ENERGY.EXCESS_STOP       verdict.excess_stop_j
    scores.can_stop             SCORES_ENERGY.CAN_STOP          verdict.can_stop
    scores.paper_stable         SCORES_ENERGY.PAPER_STABLE      verdict.paper_stable
    scores.xcom_m.x             -                               scores.xcom_m[0]
    scores.xcom_m.y             -                               scores.xcom_m[1]
    verdict.level               VERDICT.LEVEL                   verdict.level
    verdict.reason              VERDICT.REASON                  verdict.reason
    verdict.driver              BALANCE.DRIVER                  balance.driver
    verdict.margin              BALANCE.BALANCE_MARGIN          balance.margin
    verdict.caution_below       BALANCE.CAUTION_BELOW           balance.caution_below
    verdict.compared            VERDICT.COMPARED                verdict.compared
    verdict.on_track            SCORES_ENERGY.ON_TRACK          verdict.on_track
    verdict.excess_track_j      SCORES_ENERGY.EXCESS_TRACK      verdict.excess_track_j
    verdict.ebos_com_m          SCORES_EXPECTED.EBOS_COM        verdict.ebos_com_m
    verdict.ebos_xcom_m         SCORES_EXPECTED.EBOS_XCOM       verdict.ebos_xcom_m
    verdict.xcom_deviation_m.x  VERDICT.XCOM_DEVIATION_X        verdict.xcom_deviation_m[0]
    verdict.xcom_deviation_m.y  VERDICT.XCOM_DEVIATION_Y        verdict.xcom_deviation_m[1]
    verdict.recovery.found      RECOVERY.FOUND                  verdict.recovery_found
    verdict.recovery.stops      RECOVERY.STOPS                  verdict.recovery_stops
    verdict.recovery.foot       RECOVERY.FOOT                   verdict.recovery_foot
    verdict.recovery.landing_m.x RECOVERY.X                     verdict.recovery_landing_m[0]
    verdict.recovery.landing_m.y RECOVERY.Y                     verdict.recovery_landing_m[1]
    verdict.recovery.margin_m   RECOVERY.MARGIN  verdict.recovery_margin_m balance.recovery_margin_m
    walk.velocity_m_s.x         LEARNED_MEAN.VX                 balance.walk_velocity_m_s[0]
    walk.velocity_m_s.y         LEARNED_MEAN.VY                 balance.walk_velocity_m_s[1]
    walk.height_m               LEARNED_MEAN.HEIGHT             balance.walk_height_m
    walk.ripple                 LEARNED_STEADINESS.RIPPLE       balance.walk_ripple
    walk.step_time_s            LEARNED_STEP.TIME               balance.walk_step_time_s
    walk.step_length_m          LEARNED_STEP.LENGTH             balance.walk_step_length_m
    walk.step_width_m           LEARNED_STEP.WIDTH              balance.walk_step_width_m
    walk.step_margin            LEARNED_STEADINESS.STEP_MARGIN  balance.walk_step_margin
"""
MAPPED = {
    field: (signal, set(members) - {"-"})
    for field, signal, *members in map(str.split, FIELDS.strip().splitlines())
}
DATABASE = cantools.database.load_file(paths.CHECKOUT / "firmware/wire/saddlewalk.dbc")
# Not on LCM from here: SADDLEWALK_HEALTH has them beside the host's own counts, see test_host.
ON_HEALTH = {"status", "limits", "faults"}
# Not on CAN: they do not fit in 16 bits, or follow from other signals.
ON_LCM_ALONE = {
    *("plan.stride_count", "plan.origin_x_nm", "plan.origin_y_nm"),
    *("scores.xcom_m.x", "scores.xcom_m.y"),
}
# Drawn as a polygon by LCM, and not on CAN.
POLYGON = "scores.bos."
# Fields that say whether others are valid.
SWITCHES = {"plan.valid", "scores.valid", "verdict.compared", "verdict.margin_known"} | {
    "verdict.recovery.found"
}
# What the host adds.
OF_THE_HOST = {"TIMING", "RECEIVED", "INPUTS"}
OF_EVERY_FRAME = {"CRC", "COUNTER", "WIRE_VERSION", "LATE_TICKS", "REJECTED_FRAMES"}


def leaves(kind, path: str = "") -> list[str]:
    """Of a struct, as `plan.foot_m[0].x`."""
    if kind.kind == "struct":
        dot = f"{path}." if path else ""
        return [leaf for name, field in kind.fields for leaf in leaves(field.type, f"{dot}{name}")]
    if kind.kind == "array":
        return [leaf for i in range(kind.length) for leaf in leaves(kind.item, f"{path}[{i}]")]
    return [path]


LEAVES = leaves(ffi().typeof("saddle_output_t"))


def parent_and_key(output, path: str):
    """Where a leaf is, and its name or index there."""
    steps = path.replace("[", ".[").split(".")
    for step in steps[:-1]:
        output = output[int(step[1:-1])] if step[0] == "[" else getattr(output, step)
    return output, steps[-1]


def get(output, path: str) -> float:
    parent, key = parent_and_key(output, path)
    return parent[int(key[1:-1])] if key[0] == "[" else getattr(parent, key)


def put(output, path: str, value: float) -> None:
    parent, key = parent_and_key(output, path)
    if key[0] == "[":
        parent[int(key[1:-1])] = value
    else:
        setattr(parent, key, value)


def is_number(path: str) -> bool:
    return isinstance(get(base(), path), float)


def base():
    """An output in which every number is known and no two are the same."""
    output = ffi().new("saddle_output_t *")
    for index, path in enumerate(LEAVES):
        value = get(output, path)
        if isinstance(value, float):
            put(output, path, 0.15 + 0.02 * index)
        elif isinstance(value, bool):
            put(output, path, True)
    output.plan.origin_x_nm = 12_345_678_901
    output.scores.valid = library().SADDLE_VALID_ALL
    bos = output.scores.bos
    bos.axis_x.x, bos.axis_x.y, bos.radius_m, bos.half_depth_m = 1.0, 0.0, 0.3, 0.1
    return output


def values_of(output) -> dict[str, float]:
    """Every signal and member, decoded, by its name: PLAN_COM.X, plan.com_m[0]."""
    frames = ffi().new("saddle_frame_t[]", OUTPUT_FRAMES)
    library().saddle_wire_encode_output(output, ffi().new("saddle_wire_health_t *"), 0, frames)
    values = {}
    for frame in frames:
        name = wire.message_name(frame.id)
        restored = can.Message(
            arbitration_id=frame.id, is_extended_id=False, data=bytes(frame.data)
        )
        signals = wire.signals(restored)
        values |= {f"{name}.{signal}": value for signal, value in signals.items()}
    room = ffi().new("uint8_t[]", library().SADDLE_LCM_MESSAGE_MAX)
    for part in range(library().SADDLE_LCM_OUTPUTS):
        size = library().saddle_lcm_encode_output(part, output, 0, room)
        channel = ffi().string(library().saddle_lcm_channel(part)).decode()
        name = channel.removeprefix("SADDLEWALK_").lower()
        message = getattr(lcm_types, f"{name}_t").decode(bytes(ffi().buffer(room, size)))
        for member in message.__slots__:
            value = getattr(message, member)
            elements = enumerate(value) if isinstance(value, list | tuple) else [(None, value)]
            for i, element in elements:
                values[f"{name}.{member}" + ("" if i is None else f"[{i}]")] = element
    return values


@functools.cache
def before() -> dict[str, float]:
    return values_of(base())


def differences(output) -> dict[str, float]:
    after = values_of(output)
    return {
        name: value
        for name, value in after.items()
        if value != before()[name] and not (math.isnan(value) and math.isnan(before()[name]))
    }


def expected(path: str) -> set[str]:
    signal, members = MAPPED[path]
    return members | ({signal} - {"-"})


def test_every_field_has_a_place_or_a_listed_reason():
    polygon = {path for path in LEAVES if path.startswith(POLYGON)}
    assert set(LEAVES) == MAPPED.keys() | polygon | {"scores.valid", "verdict.margin_known"}
    assert {path for path, (signal, _) in MAPPED.items() if signal == "-"} == ON_LCM_ALONE
    assert {path for path, (_, members) in MAPPED.items() if not members} == ON_HEALTH


@pytest.mark.parametrize("path", sorted(MAPPED.keys() - SWITCHES))
def test_a_field_reaches_only_its_own_signals(path):
    output = base()
    value = get(output, path)
    if isinstance(value, float):
        put(output, path, value + 1.0)
    elif isinstance(value, bool):
        put(output, path, False)
    else:
        put(output, path, value + (1_000_000_000 if path.endswith("_nm") else 1))
    new = get(output, path) / (1e9 if path.endswith("_nm") else 1)
    found = differences(output)
    assert found.keys() == expected(path)
    for name, value in found.items():
        assert value == pytest.approx(new, abs=resolution(name))


def resolution(name: str) -> float:
    """Half a step of a number on CAN; a float of LCM is exact."""
    message, signal = name.split(".")
    if not message.isupper():
        return 1e-9
    signal = DATABASE.get_message_by_name(message).get_signal_by_name(signal)
    return 0.501 * signal.scale if signal.is_signed else 0.0


def numbers_of(*prefixes: str) -> set[str]:
    return {path for path in MAPPED if path.startswith(prefixes) and is_number(path)}


@pytest.mark.parametrize(
    ("switch", "numbers"),
    [
        ("verdict.margin_known", {"verdict.margin", "verdict.caution_below"}),
        ("verdict.compared", numbers_of("verdict.") - {"verdict.margin", "verdict.caution_below"}),
        ("verdict.recovery.found", numbers_of("verdict.recovery.landing_m")),
    ],
)
def test_unknown_values_are_nan_on_both_buses(switch, numbers):
    output = base()
    put(output, switch, False)
    found = differences(output)
    itself = expected(switch) if switch in MAPPED else set()
    assert found.keys() == itself | set().union(*map(expected, numbers))
    assert all(math.isnan(value) for name, value in found.items() if name not in itself)


def test_a_plan_that_is_not_valid_has_no_numbers_on_can():
    output = base()
    output.plan.valid = False
    found = differences(output)
    numbers = {MAPPED[path][0] for path in numbers_of("plan.")} - {"-"}
    assert found.keys() == numbers | expected("plan.valid")
    assert all(math.isnan(found[name]) for name in numbers)


def test_scores_depend_on_their_valid_bits():
    seen = set()
    for bit in range(library().SADDLE_VALID_ALL.bit_length()):
        output = base()
        output.scores.valid &= ~(1 << bit)
        found = differences(output)
        found.pop("scores.valid", None)  # without the bit of energies, which are in verdict_t
        assert found and all(math.isnan(value) for value in found.values())
        seen |= found.keys()
    scored = numbers_of("scores.") | {"verdict.excess_track_j"}
    assert seen == set().union(*map(expected, scored))


def test_the_base_of_support_is_a_polygon_by_lcm():
    reached = set()
    for path in LEAVES:
        if path.startswith(POLYGON):
            output = base()
            value = get(output, path)
            put(output, path, not value if isinstance(value, bool) else value + 0.1)
            found = differences(output)
            assert found and all(name.startswith("bos.") for name in found), path
            reached |= found.keys()
    assert {"bos.defined", "bos.x_m[0]", "bos.y_m[15]"} <= reached


def test_no_signal_is_without_a_field():
    """Values of the messages about the walker."""
    reached = set().union(*map(expected, MAPPED)) | {"scores.valid"}
    silent = {
        name
        for name in before()
        if name not in reached
        and not name.startswith("bos.")
        and not name.endswith(".utime_us")
        and name.split(".")[0] not in OF_THE_HOST
        and name.split(".")[1] not in OF_EVERY_FRAME
    }
    assert silent == set()
