"""A steady walk as the paper plans it, and the row of a plan in a table."""

import math
from collections.abc import Iterator
from typing import Any

from saddlewalk.contract import TICK_S
from saddlewalk.core import Command, Measurement
from saddlewalk.planning.ground import place_of, turned
from saddlewalk.table import Cell

COLUMNS = (
    "t_s phase theta_rad support com_x_m com_y_m com_z_m com_vx_m_s com_vy_m_s com_vz_m_s "
    "left_x_m left_y_m left_z_m right_x_m right_y_m right_z_m leg_length_m theta_to_rad "
    "theta_hs_rad s_pend s_jump s_sw mos_com_m mos_xcom_m gravity_x_n gravity_y_n"
).split()


def walk(
    core: Any, speed_m_s: float, hs_angle_deg: float, dt_s: float
) -> Iterator[tuple[float, Any]]:
    """(t_s, saddle_output_t) at t = k dt, without end; with ticks in between if dt is long."""
    command = Command(speed_m_s, math.radians(hs_angle_deg))
    no_measurement = Measurement()
    core.join(command)
    ticks_per_row = math.ceil(dt_s / TICK_S)
    yield 0.0, core.tick(0, command, no_measurement)
    row = 0
    while True:
        for i in range(1, ticks_per_row + 1):
            time_s = (row + i / ticks_per_row) * dt_s
            output = core.tick(round(time_s * 1e6), command, no_measurement)
        row += 1
        yield row * dt_s, output


def row_of(t_s: float, plan: Any, scores: Any) -> list[Cell]:
    """The cells of COLUMNS: a saddle_plan_t and its saddle_scores_t, from where the way began."""
    left, right = plan.foot_m
    return [
        t_s,
        plan.phase,
        2.0 * math.pi * plan.stride_count + plan.theta_rad,
        "right" if plan.support else "left",
        *place_of(plan, plan.com_m),
        plan.com_m.z,
        *turned(plan, plan.com_velocity_m_s),
        plan.com_velocity_m_s.z,
        *place_of(plan, left),
        left.z,
        *place_of(plan, right),
        right.z,
        plan.leg_length_m,
        plan.toe_off_rad,
        plan.heel_strike_rad,
        scores.s_pend,
        scores.s_jump,
        scores.s_sw,
        scores.mos_com_m,
        scores.mos_xcom_m,
        *turned(plan, scores.gravity_n),
    ]
