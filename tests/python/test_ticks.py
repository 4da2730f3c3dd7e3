"""A tick of the firmware comes whole or not at all, and waiting for one ends."""

import math
import time

import can
import pytest

from saddlewalk.config import configuration
from saddlewalk.core import Core
from saddlewalk.emulation.exoskeleton import plan_of
from saddlewalk.ticks import MESSAGES, TickReader, next_tick
from saddlewalk.transport.wire import Sender

pytestmark = pytest.mark.firmware

FIRMWARE = Core(configuration({}))


def tick_frames(sender: Sender, **changed: float) -> list[can.Message]:
    """All frames of one tick of a walk; changed: signals of PLAN_COM."""
    values = {
        "PLAN_COM": {"X": 0.0, "Y": 0.01, "Z": 1.0} | changed,
        "PLAN_COM_VELOCITY": {"VX": 1.2, "VY": 0.0, "VZ": 0.0},
        "PLAN_LEFT": {"X": 0.0, "Y": 0.05, "Z": 0.0},
        "PLAN_RIGHT": {"X": 0.0, "Y": -0.05, "Z": 0.05},
        "PLAN_SWING": {"VX": 2.4, "VY": 0.0, "VZ": 0.0},
        "PLAN_LANDING": {"X": 0.7, "Y": -0.05, "LEG_LENGTH": 1.02},
        "PLAN_ANKLE": {"TOE_OFF": 0.0, "HEEL_STRIKE": 0.0, "SPEED": 1.2},
        "PLAN_STEP": {
            "VALID": 1,
            "SUPPORT": 0,
            "PHASE": 0,
            "THETA": 0,
            "STEP_LENGTH": 0.7,
            "STEP_COUNT": 7,
        },
        "PLAN_EVENTS": {
            "MODE": 2,
            "TIME_TO_VIA_POINT": 0.3,
            "TIME_TO_HEEL_STRIKE": 0.3,
            "TIME_TO_TOE_OFF": 0.3,
        },
        "PLAN_PITCH": {"LEFT": 0.0, "RIGHT": 0.0, "KNEE_FLEXION": 0.0},
        "PLAN_REFERENCE_XCOM": {"X": 0.39, "Y": 0.02, "LOAD_LEFT": 1.0},
        "PLAN_REFERENCE_COP": {"X": 0.02, "Y": 0.05, "LOAD_RIGHT": 0.0},
        "PLAN_REFERENCE_COM": {"X": 0.0, "Y": 0.02, "RATE": 0.0},
        "PLAN_LAST_STEP": {"X": 0.7, "Y": 0.1, "WIDTH": 0.1},
        "PLAN_WAY": {"HEADING": 0.1, "CURVATURE_BEHIND": 0.2, "CURVATURE_AHEAD": 0.3},
        "PLAN_YAW": {"LEFT": 0.0, "RIGHT": -0.05, "PELVIS": 0.01},
        "SCORES_STEP": {"S_PEND": 1.0, "S_JUMP": 1.0, "S_SW": 1.0},
        "SCORES_MARGIN": {"MOS_COM": 0.1, "MOS_XCOM": 0.1, "V_COMP": 1.2},
        "SCORES_FORCE": {"GRAVITY_X": 0.0, "GRAVITY_Y": 0.0, "FAULTS": 0},
        "SCORES_ENERGY": {
            "CAN_STOP": 0,
            "ON_TRACK": 1,
            "PAPER_STABLE": 1,
            "EXCESS_STOP": 40.0,
            "EXCESS_TRACK": 0.0,
        },
        "SCORES_EXPECTED": {"EBOS_COM": 0.1, "EBOS_XCOM": 0.1},
        "VERDICT": {
            "COMPARED": 1,
            "LEVEL": 1,
            "REASON": 0,
            "XCOM_DEVIATION_X": 0.0,
            "XCOM_DEVIATION_Y": 0.0,
        },
        "RECOVERY": {"FOUND": 1, "STOPS": 0, "FOOT": 1, "X": 0.7, "Y": -0.1, "MARGIN": 0.2},
        "BALANCE": {"DRIVER": 12, "BALANCE_MARGIN": 0.3, "CAUTION_BELOW": 0.1},
        "LEARNED_MEAN": {"VX": 1.2, "VY": 0.0, "HEIGHT": 1.0},
        "LEARNED_STEP": {"TIME": 0.56, "LENGTH": 0.67, "WIDTH": 0.15},
        "LEARNED_STEADINESS": {"RIPPLE": 0.03, "STEP_MARGIN": 0.25},
        "TIMING": {"PERIOD": 0.08, "LATENCY": 1e-4, "LATENCY_MAX": 3e-4},
        "RECEIVED": {
            "MALFORMED": 0,
            "BAD_CRC": 0,
            "BAD_VERSION": 0,
            "BAD_COUNTER": 0,
            "ACCEPTED": 40,
        },
        "INPUTS": {
            "COMMAND_SOURCE": 1,
            "COMMAND_AGE": 0,
            "COM_AGE": 0,
            "LEFT_AGE": 0,
            "RIGHT_AGE": 0,
            "SENDER_CLOCK": 1,
            "MEASURED_BY": 0,
        },
        "HEALTH": {"STATUS": 0, "LIMITS": 0, "LATE_TICKS": 0, "REJECTED_FRAMES": 0},
    }
    return [sender.frame(name, **signals) for name, signals in values.items()]


@pytest.mark.parametrize("lost", range(len(MESSAGES)))
def test_a_tick_with_a_lost_frame_is_not_used(lost):
    sender, reader = Sender(), TickReader()
    first, second, third = (tick_frames(sender) for _ in range(3))
    assert [reader.feed(frame) is not None for frame in first] == [False] * (len(MESSAGES) - 1) + [
        True
    ]
    assert not any(reader.feed(frame) for frame in second[:lost] + second[lost + 1 :])
    heard = [reader.feed(frame) for frame in third]
    assert not any(heard[:-1])
    assert plan_of(heard[-1], FIRMWARE).speed_m_s == pytest.approx(1.2)


def test_a_plan_with_an_unavailable_number_is_not_a_plan():
    sender, reader = Sender(), TickReader()
    heard = [reader.feed(frame) for frame in tick_frames(sender, Y=math.nan)]
    assert plan_of(heard[-1], FIRMWARE) is None


class Flooded:
    """A bus that is never empty."""

    def __init__(self, frame: can.Message) -> None:
        self._frame = frame

    def recv(self, timeout: float) -> can.Message:
        return self._frame


@pytest.mark.parametrize("within_s", [-1.0, 0.0, 0.1])
def test_a_flood_without_a_tick_does_not_delay(within_s):
    bus = Flooded(can.Message(arbitration_id=0x7FF, is_extended_id=False, data=bytes(8)))
    reader = TickReader()
    start_s = time.monotonic()
    assert next_tick(bus, reader.feed, within_s) is None
    assert max(within_s, 0.0) <= time.monotonic() - start_s < max(within_s, 0.0) + 0.5
    assert reader.receiver.malformed >= 1


def test_a_waiting_tick_is_returned_even_after_the_deadline():
    frames = iter(tick_frames(Sender()))

    class Waiting:
        def recv(self, timeout: float) -> can.Message | None:
            return next(frames, None)

    bus, reader = Waiting(), TickReader()
    heard = [next_tick(bus, reader.feed, -1.0) is not None for _ in MESSAGES]
    assert heard == [False] * (len(MESSAGES) - 1) + [True]
