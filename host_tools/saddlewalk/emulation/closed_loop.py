"""The core and an emulated wearer in one process, without buses, tick by tick."""

import functools
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from saddlewalk import core
from saddlewalk.contract import LEFT, RIGHT, TICK_S
from saddlewalk.emulation import wearer as emulator
from saddlewalk.emulation.plans import plan_of, planned
from saddlewalk.emulation.wearer import STEP_S, Plan, Wearer
from saddlewalk.planning.schedule import Schedule

STEPS_A_TICK = round(TICK_S / STEP_S)


@dataclass(frozen=True)
class Tick:
    """Input and output of the core at time_s of the walk, before the wearer moves."""

    time_s: float
    measured: emulator.Measurement
    exact: emulator.Measurement  # without delay and the sensors' noise
    output: Any  # saddle_output_t
    plan: Plan


AfterStep = Callable[[Tick, int], None]


def walk(
    config: Any,
    wearer: Wearer,
    schedule: Schedule,
    after_step: AfterStep | None = None,
    delay_s: float = 0.0,
) -> Iterator[Tick]:
    """Endless; the wearer moves on by a tick when the next one is asked for.

    config: saddle_config_t; after_step(tick, steps since it): called after every step of physics.
    delay_s: from sampling to the tick; what of it sensor_latency_s does not say is the
    measurements' age.
    """
    firmware, index = core.Core(config), 0
    delay_steps = round(delay_s / STEP_S)
    age_s = max(delay_s - config.sensor_latency_s, 0.0)
    under_way = deque([wearer.measure()], maxlen=delay_steps // STEPS_A_TICK + 1)
    while True:
        exact, measured = wearer.exact(), under_way[0]
        time_s = index * TICK_S
        time_us = round(time_s * 1e6)
        output = firmware.tick(time_us, schedule(time_s), measurement_of(measured, age_s))
        tick = Tick(time_s, measured, exact, output, plan_of(output, firmware))
        wearer.follow(tick.plan, functools.partial(_plan_at, firmware, time_us))
        yield tick
        for step in range(1, STEPS_A_TICK + 1):
            wearer.step()
            if after_step:
                after_step(tick, step)
            if (step + delay_steps) % STEPS_A_TICK == 0:
                under_way.append(wearer.measure())
        index += 1


def measurement_of(measured: emulator.Measurement, age_s: float = 0.0) -> core.Measurement:
    velocity, (left, right) = measured.velocity_m_s, measured.feet_m
    return core.Measurement(
        com_height_m=measured.height_m,
        com_velocity_m_s=(velocity.real, velocity.imag),
        left_cop_m=(left.real, left.imag),
        right_cop_m=(right.real, right.imag),
        left_contact=measured.contact[LEFT],
        right_contact=measured.contact[RIGHT],
        age_us=round(age_s * 1e6),
    )


def _plan_at(firmware: core.Core, time_us: int, since_s: float) -> Plan | None:
    return planned(firmware.plan_at(time_us + round(since_s * 1e6))[0], firmware)
