"""`saddlewalk plan`: a steady walk at constant speed, row by row, from the C core."""

import argparse
import itertools
import math
import sys
from collections.abc import Iterator
from typing import Any

from saddlewalk.config import ANKLES, add_body_options, load_config
from saddlewalk.options import number_in, whole_number_in
from saddlewalk.table import Cell, write_table

COLUMNS = (
    "t_s phase theta_rad support com_x_m com_y_m com_z_m com_vx_m_s com_vy_m_s com_vz_m_s "
    "left_x_m left_y_m left_z_m right_x_m right_y_m right_z_m leg_length_m theta_to_rad "
    "theta_hs_rad s_pend s_jump s_sw mos_com_m mos_xcom_m gravity_x_n gravity_y_n"
).split()

LONGEST_TICK_S = 0.08
SHORTEST_DT_S = 1e-5


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser("plan", help="plan a steady walk as CSV")
    parser.add_argument("--speed", type=number_in(1e-9, 100, "m/s"), required=True, metavar="M/S")
    parser.add_argument(
        "--hs-angle",
        type=number_in(0, 30, "degrees"),
        default=10.0,
        metavar="DEG",
        help="foot angle at heel strike (default 10)",
    )
    parser.add_argument("--strides", type=whole_number_in(1, 10**6), default=1, metavar="N")
    parser.add_argument("--dt", type=number_in(SHORTEST_DT_S, 1e4, "s"), default=0.08, metavar="S")
    parser.add_argument("--ankle", choices=ANKLES, help="ankle strategy (default erf)")
    add_body_options(parser)
    parser.add_argument("--out", metavar="FILE", help="default: standard output")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.core import Core, library

    outputs = walk(Core(load_config(args, args.ankle)), args.speed, args.hs_angle, args.dt)
    first = next(outputs)
    _note_limits(args, first[1], library())
    plan = first[1].plan
    duration_s = args.strides * 2.0 * plan.step_length_m / plan.speed_m_s
    further = math.floor(duration_s / args.dt + 1e-9)
    rows = itertools.chain([first], itertools.islice(outputs, further))
    write_table(args.out, COLUMNS, (_row(t_s, output) for t_s, output in rows))
    return 0


def walk(core: Any, speed_m_s: float, hs_angle_deg: float, dt_s: float) -> Iterator[tuple]:
    """Endless (t_s, saddle_output_t) at t = k dt, ticking in between where dt is long."""
    from saddlewalk.core import Command, Measurement

    command = Command(speed_m_s, math.radians(hs_angle_deg))
    nobody = Measurement()
    core.join(command)
    ticks_per_row = math.ceil(dt_s / LONGEST_TICK_S)
    yield 0.0, core.tick(0, command, nobody)
    row = 0
    while True:
        for i in range(1, ticks_per_row + 1):
            time_s = (row + i / ticks_per_row) * dt_s
            output = core.tick(round(time_s * 1e6), command, nobody)
        row += 1
        yield row * dt_s, output


def _note_limits(args: argparse.Namespace, output: Any, core: Any) -> None:
    if output.limits & core.SADDLE_LIMIT_SPEED:
        print(
            f"saddlewalk plan: --speed {args.speed:g} is not feasible for this body: "
            f"limited to {output.plan.speed_m_s:.4g} m/s",
            file=sys.stderr,
        )
    if output.limits & core.SADDLE_LIMIT_HEEL_STRIKE:
        print(
            f"saddlewalk plan: --hs-angle {args.hs_angle:g} exceeds heel_strike_max_rad: limited",
            file=sys.stderr,
        )
    if output.limits & core.SADDLE_LIMIT_TOE_OFF:
        print(
            "saddlewalk plan: the toe-off angle that this gait asks for is outside the ankle's "
            "geometry: limited",
            file=sys.stderr,
        )


def _row(t_s: float, output: Any) -> list[Cell]:
    plan, scores = output.plan, output.plan_scores
    origin_m = plan.origin_x_nm * 1e-9
    com, velocity = plan.com_m, plan.com_velocity_m_s
    left, right = plan.foot_m
    return [
        t_s,
        plan.phase,
        2.0 * math.pi * plan.stride_count + plan.theta_rad,
        "right" if plan.support else "left",
        origin_m + com.x,
        com.y,
        com.z,
        velocity.x,
        velocity.y,
        velocity.z,
        origin_m + left.x,
        left.y,
        left.z,
        origin_m + right.x,
        right.y,
        right.z,
        plan.leg_length_m,
        plan.toe_off_rad,
        plan.heel_strike_rad,
        scores.s_pend,
        scores.s_jump,
        scores.s_sw,
        scores.mos_com_m,
        scores.mos_xcom_m,
        scores.gravity_n.x,
        scores.gravity_n.y,
    ]
