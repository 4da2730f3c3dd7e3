"""The plan's reference: a pendulum that takes the planned steps, its CoP within the soles."""

import functools
import math

import numpy as np
import pytest

from saddlewalk.config import configuration
from saddlewalk.contract import LEFT, RIGHT, STANDING, STARTING, TICK_S
from saddlewalk.core import Command, Core, Measurement, ffi, library

pytestmark = pytest.mark.firmware

STEP_S = 1e-3
STEPS_A_TICK = round(TICK_S / STEP_S)
CONFIG = configuration({})
W = math.sqrt(9.80665 / (CONFIG.pendulum_ratio * CONFIG.body_height_m))
SOLE = complex(CONFIG.cop_range_m, CONFIG.cop_shift_ml_m)
# Speeds by time: from standing, faster, slower, to standing.
WALK = ((0.0, 0.6), (5.0, 1.2), (10.0, 0.8), (14.0, 0.0))


def complexes(*points) -> list[complex]:
    return [complex(point.x, point.y) for point in points]


@functools.cache
def trace(speeds=WALK, duration_s: float = 19.0, **fields: float) -> dict[str, np.ndarray]:
    """The plan every millisecond, in the frame of the first stance foot."""
    firmware, plan = Core(configuration(fields)), ffi().new("saddle_plan_t *")
    rows = []
    for tick in range(round(duration_s / TICK_S)):
        speed = [speed for time_s, speed in speeds if time_s <= tick * TICK_S + 1e-9][-1]
        time_us = round(tick * TICK_S * 1e6)
        firmware.tick(time_us, Command(speed or None, 0.17), Measurement())
        for step in range(STEPS_A_TICK):
            status = library().saddle_plan_at(firmware._context, time_us + step * 1000, plan)
            assert status == library().SADDLE_OK
            reference, origin = plan.reference, plan.origin_x_nm * 1e-9
            points = complexes(reference.com_m, reference.xcom_m, reference.cop_m, *plan.foot_m)
            rows.append(
                [
                    *(origin + point for point in points),
                    *reference.load,
                    *(plan.mode, plan.support, plan.speed_m_s, plan.acceleration_m_s2),
                    complex(plan.com_m.x + origin, plan.com_m.y),
                ]
            )
    names = "com xcom cop left right load_left load_right mode support speed rate planned".split()
    traced = dict(zip(names, np.array(rows).T, strict=True))
    return traced | {"middle": middle_of_the_soles(traced)}


def middle_of_the_soles(rows: dict[str, np.ndarray]) -> np.ndarray:
    """Of those that carry, by their loads. A foot stands where it stood until it carries none."""
    stood = []
    for side, name in ((LEFT, "left"), (RIGHT, "right")):
        places = rows[name].copy()
        stands = (rows["support"].real == side) | (rows["speed"].real == 0)
        last = np.maximum.accumulate(np.where(stands, np.arange(len(places)), 0))
        stood.append(rows[f"load_{name}"] * places[last])
    return stood[LEFT] + stood[RIGHT]


def jumps(rows: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """What the XCoM moves in each millisecond, less what the CoP makes it; and where that is more
    than what a corner of the CoP's path does: it crosses at 5 m/s, for a millisecond of it."""
    xcom, cop = rows["xcom"], (rows["cop"][1:] + rows["cop"][:-1]) / 2
    excess = xcom[1:] - (cop + (xcom[:-1] - cop) * math.exp(W * STEP_S))
    return excess, np.abs(excess) > 3e-4


@pytest.mark.parametrize("speed", [0.3, 0.6, 1.0, 1.4, 1.8])
def test_a_steady_walk_is_a_pendulum_and_each_step_the_mirror_image_of_the_last(speed):
    rows = trace(((0.0, speed),), 16.0)
    steady = slice(10_000, None)
    excess, _ = jumps(rows)
    # Positions are floats of a few metres here: 2^-21 m.
    assert np.abs(excess[steady]).max() < 1e-4
    assert np.median(np.abs(excess[steady])) < 2e-6
    landings = np.flatnonzero(np.diff(rows["support"].real)) + 1
    first, second, third = landings[-3:]
    place = rows["xcom"] - np.where(rows["support"].real == LEFT, rows["left"], rows["right"])
    count = min(second - first, third - second)
    one, other = place[first : first + count], place[second : second + count].conjugate()
    # They begin within a millisecond.
    assert np.abs(one - other).max() < 2 * (speed + 0.6) * STEP_S


def test_xcom_follows_the_cop_but_at_events_that_are_known_and_by_so_much():
    """Where a walk's speed changes at 0.5 m/s^2 its landings surprise the steady step before them;
    braking takes toes off the CoP's way at once."""
    rows = trace()
    excess, jumped = jumps(rows)
    landed = np.diff(rows["support"].real) != 0
    paced = np.diff(rows["rate"].real) != 0
    begun = np.diff(rows["speed"].real != 0) != 0
    assert not np.any(jumped & ~landed & ~paced & ~begun)
    assert np.abs(excess.real)[landed].max() < 0.031 and np.abs(excess.imag)[landed].max() < 0.008
    assert np.abs(excess.real)[paced & ~landed].max() < 0.020
    # The CoM stands further inward than the foot's edge, from where the first swing falls.
    assert np.abs(excess[begun]).max() < 0.012


def test_com_follows_the_xcom():
    rows = trace()
    com, xcom = rows["com"], rows["xcom"]
    excess = com[1:] - com[:-1] - W * STEP_S * ((xcom - com)[1:] + (xcom - com)[:-1]) / 2
    assert np.abs(excess).max() < 0.020
    # While the speed changes, what the change makes of the steady CoM is left out: 3 cm of CoP.
    assert np.quantile(np.abs(excess), 0.99) < 0.03 * W * STEP_S
    assert np.median(np.abs(excess)) < 2e-6
    assert np.abs(com - rows["planned"]).max() < 0.07


@pytest.mark.parametrize("fields", [{}, {"cop_range_m": 0.05}, {"body_height_m": 1.5}])
def test_cop_is_within_the_soles_that_carry_and_their_loads_are_all(fields):
    rows = trace(**fields)
    config = configuration(fields)
    offset = rows["cop"] - rows["middle"]
    assert np.abs(offset.real).max() <= config.cop_range_m + 1e-6
    assert np.abs(offset.imag).max() <= config.cop_shift_ml_m + 1e-6
    loads = [rows[name].real.astype(np.float32) for name in ("load_left", "load_right")]
    assert np.all(loads[0] + loads[1] == 1)
    assert np.all((rows["load_left"].real >= 0) & (rows["load_right"].real >= 0))
    swings = (rows["mode"].real != STANDING) & (rows["speed"].real > 0)
    for side, name in ((LEFT, "left"), (RIGHT, "right")):
        alone = swings & (rows[f"load_{name}"] == 1)
        assert np.all(rows["support"].real[alone] == side)


@pytest.mark.parametrize("gain", [0.5, 1.5])
@pytest.mark.parametrize("fields", [{}, {"acceleration_m_s2": 0.3}, {"body_height_m": 1.5}])
def test_a_pendulum_that_is_driven_by_it_stays_on_it_from_standing_to_standing(gain, fields):
    rows = trace(**fields)
    config = configuration(fields)
    w = math.sqrt(9.80665 / (config.pendulum_ratio * config.body_height_m))
    sole = complex(config.cop_range_m, config.cop_shift_ml_m)
    com = xcom = rows["com"][0]
    errors = []
    for cop, wanted, foot in zip(rows["cop"], rows["xcom"], rows["middle"], strict=True):
        errors.append(xcom - wanted)
        offset = cop + (1 + gain) * errors[-1] - foot
        cop = foot + complex(
            min(max(offset.real, -sole.real), sole.real),
            min(max(offset.imag, -sole.imag), sole.imag),
        )
        com += (xcom - com) * (1 - math.exp(-w * STEP_S))
        xcom = cop + (xcom - cop) * math.exp(w * STEP_S)
    errors = np.array(errors)
    # A jump of 31 mm, and what a foot's length cannot take back of it at once.
    assert np.abs(errors.real).max() < 0.05 and np.abs(errors.imag).max() < 0.02
    assert abs(xcom - com) < 1e-3 and abs(com - (rows["left"][-1] + rows["right"][-1]) / 2) < 2e-3


def test_a_walk_that_starts_with_the_feet_apart_stays_within_them():
    firmware = Core(configuration({"lost_inputs_stop": 0}))
    apart = Measurement(1.0, (0.0, 0.0), (0.15, 0.11), (-0.15, -0.11), True, True)
    seen = []
    for tick in range(40):
        measured = apart if tick == 0 else Measurement()
        plan = firmware.tick(round(tick * TICK_S * 1e6), Command(0.8), measured).plan
        if plan.mode != STARTING or plan.speed_m_s == 0:
            continue
        (cop, left, right) = complexes(plan.reference.cop_m, *plan.foot_m)
        offset = cop - (plan.reference.load[LEFT] * left + plan.reference.load[RIGHT] * right)
        assert abs(offset.real) <= SOLE.real + 1e-6 and abs(offset.imag) <= SOLE.imag + 1e-6
        seen.append(plan.phase)
    assert 3 in seen and 0 in seen


def test_a_plan_alone_tells_the_reference_of_the_ticks_to_come():
    firmware = Core(CONFIG)
    plan = ffi().new("saddle_plan_t *")
    worst = 0.0
    for tick in range(120):
        time_us = round(tick * TICK_S * 1e6)
        output = firmware.tick(time_us, Command(1.0 if tick < 70 else None), Measurement())
        support, mode = output.plan.support, output.plan.mode
        for step in range(0, STEPS_A_TICK, 8):
            library().saddle_plan_at(firmware._context, time_us + step * 1000, plan)
            later = firmware.reference_after(ffi().addressof(output.plan), step * STEP_S)
            if step == 0:
                same = ffi().addressof(output.plan, "reference")
                assert bytes(ffi().buffer(later)) == bytes(ffi().buffer(same))
            if (plan.support, plan.mode) == (support, mode):
                (now, then) = complexes(plan.reference.xcom_m, later.xcom_m)
                worst = max(worst, abs(now - then))
    # The end of a change of speed within a tick is not foreseen.
    assert worst < 0.012


@pytest.mark.parametrize("after_s", [-0.001, 0.501, math.nan, math.inf])
def test_another_time_than_the_next_half_second_is_an_error(after_s):
    firmware = Core(CONFIG)
    output = firmware.tick(0, Command(1.0), Measurement())
    with pytest.raises(ValueError, match="status 4"):
        firmware.reference_after(ffi().addressof(output.plan), after_s)


def test_a_plan_that_is_not_valid_has_no_reference():
    with pytest.raises(ValueError, match="status 4"):
        Core(CONFIG).reference_after(ffi().new("saddle_plan_t *"), 0.0)


@pytest.mark.parametrize("height_m", [1.2, 1.79, 2.5])
@pytest.mark.parametrize("speed", [0.01, 0.05, 3.9])
@pytest.mark.parametrize(("ratio", "acceleration"), [(0.5, 5.0), (0.7, 0.01)])
def test_any_configuration_gives_numbers_within_the_soles(height_m, speed, ratio, acceleration):
    fields = {"body_height_m": height_m, "pendulum_ratio": ratio} | {
        "acceleration_m_s2": acceleration
    }
    firmware = Core(configuration(fields))
    for tick in range(250):
        speed_m_s = speed if tick < 180 else None
        plan = firmware.tick(round(tick * TICK_S * 1e6), Command(speed_m_s), Measurement()).plan
        left, right = complexes(*plan.foot_m)
        (cop, xcom, com) = complexes(
            plan.reference.cop_m, plan.reference.xcom_m, plan.reference.com_m
        )
        load = plan.reference.load
        offset = cop - (load[LEFT] * left + load[RIGHT] * right)
        if load[LEFT] not in (0, 1) or plan.speed_m_s == 0:
            continue  # a foot in the swing is not where it stood
        assert abs(offset.real) <= SOLE.real + 1e-5 and abs(offset.imag) <= SOLE.imag + 1e-5
        assert abs(xcom - cop) < 2 and abs(com - cop) < 2
