"""`saddlewalk plan`: a walk row by row from the C core, steady or by a schedule of speeds."""

import argparse
import functools
import itertools
import math
import operator
import sys
from collections.abc import Iterator
from typing import Any

from saddlewalk.config import ANKLES, add_body_options, load_config
from saddlewalk.errors import UserError
from saddlewalk.options import add_gait_options, number_in, whole_number_in
from saddlewalk.outputs import OutputFile, add_output
from saddlewalk.table import Cell, write_table

EVENT_COLUMNS = "mode time_to_heel_strike_s time_to_toe_off_s event event_t_s".split()
TURN_COLUMNS = "heading_rad left_yaw_rad right_yaw_rad pelvis_yaw_rad".split()
SHORTEST_DT_S = 1e-5


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "plan",
        help="plan a walk as CSV",
        description="Plan a walk as CSV: a steady walk in progress, or a walk from standing by "
        "a schedule of speeds. With a schedule, `event` names the events since the row before and "
        "`event_t_s` says when, finer than the rows; several are separated by a space.",
    )
    add_gait_options(parser)
    parser.add_argument(
        "--strides",
        type=whole_number_in(1, 10**6),
        metavar="N",
        help="with --speed (default 1)",
    )
    parser.add_argument(
        "--duration",
        type=number_in(0, 1e6, "s"),
        metavar="S",
        help="with --schedule (default: until standing again, or 5 s after the last row)",
    )
    add_output(
        parser,
        "--picture",
        output=OutputFile((".png", ".svg", ".pdf")),
        metavar="FILE",
        help="with --schedule: draw the walk, as PNG, SVG or PDF",
    )
    parser.add_argument(
        "--dt",
        type=number_in(SHORTEST_DT_S, 1e4, "s"),
        default=0.08,
        metavar="S",
        help="time between rows (default 0.08)",
    )
    parser.add_argument("--ankle", choices=ANKLES, help="ankle strategy (default erf)")
    add_body_options(parser)
    add_output(parser, "--out", metavar="FILE", help="default: standard output")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    _reject_mixed_options(args)
    return _plan_schedule(args) if args.schedule is not None else _plan_steady(args)


def _reject_mixed_options(args: argparse.Namespace) -> None:
    """Raise UserError for an option that does not apply to this kind of walk."""
    scheduled = args.schedule is not None
    if scheduled and args.strides is not None:
        raise UserError("--strides goes with --speed; with --schedule give --duration")
    for option in ("duration", "picture"):
        if not scheduled and getattr(args, option) is not None:
            raise UserError(f"--{option} goes with --schedule")


def _plan_steady(args: argparse.Namespace) -> int:
    from saddlewalk.core import Core, library
    from saddlewalk.planning.steady import COLUMNS, row_of, walk

    core = Core(load_config(args, args.ankle))
    outputs = walk(core, args.speed, args.hs_angle, args.dt)
    first = next(outputs)
    limits = first[1].limits
    if limits & library().SADDLE_LIMIT_SPEED:
        _note(
            f"--speed {args.speed:g} is not feasible for this body: "
            f"limited to {first[1].plan.speed_m_s:.4g} m/s"
        )
    _note_angles(args, limits)
    plan = first[1].plan
    duration_s = (args.strides or 1) * 2.0 * plan.step_length_m / plan.speed_m_s
    further = math.floor(duration_s / args.dt + 1e-9)
    rows = itertools.chain([first], itertools.islice(outputs, further))
    plans = ((t_s, output.plan) for t_s, output in rows)
    write_table(
        args.out, COLUMNS, (row_of(t_s, plan, core.score_plan(plan)) for t_s, plan in plans)
    )
    return 0


def _plan_schedule(args: argparse.Namespace) -> int:
    from saddlewalk.core import Core, library
    from saddlewalk.planning import schedule
    from saddlewalk.planning.steady import COLUMNS

    changes = schedule.read_schedule(args.schedule)
    core = Core(load_config(args, args.ankle))
    walked = list(_until_the_end(args, changes, core))
    rows = (_schedule_row(core, instant) for instant in walked)
    write_table(args.out, [*COLUMNS, *EVENT_COLUMNS, *TURN_COLUMNS], rows)
    _note_limited(args, walked, library().SADDLE_LIMIT_SPEED, "speed_m_s", "for this body")
    _note_limited(args, walked, library().SADDLE_LIMIT_TURN, "turn_rad_s", "at this speed")
    _note_angles(args, functools.reduce(operator.or_, (i.output.limits for i in walked)))
    if args.picture is not None:
        from saddlewalk.pictures.schedule import draw_schedule

        draw_schedule(args.picture, changes, walked)
    return 0


def _note_limited(
    args: argparse.Namespace, walked: list[Any], limit: int, column: str, reason: str
) -> None:
    """Name each row of the schedule that the core could not follow."""
    limited = {instant.wish for instant in walked if instant.output.limits & limit}
    for wish in sorted(limited, key=lambda wish: wish.line):
        _note(
            f"{args.schedule}: line {wish.line}, {column}: {getattr(wish, column):g} is not "
            f"feasible {reason}: limited"
        )


def _until_the_end(args: argparse.Namespace, changes: list[Any], core: Any) -> Iterator[Any]:
    """The instants of the walk: --duration, else until it stands or 5 s after the last row."""
    from saddlewalk.contract import STANDING
    from saddlewalk.planning import schedule

    last = changes[-1]
    until_stand = args.duration is None and last.speed_m_s == 0
    duration_s = last.from_s + 5.0 if args.duration is None else args.duration
    for instant in schedule.walk(core, changes, math.radians(args.hs_angle), args.dt):
        if not until_stand and instant.t_s > duration_s + 1e-9:
            return
        yield instant
        if until_stand and instant.wish is last and instant.output.plan.mode == STANDING:
            return


def _note_angles(args: argparse.Namespace, limits: int) -> None:
    from saddlewalk.core import library

    if limits & library().SADDLE_LIMIT_HEEL_STRIKE:
        _note(f"--hs-angle {args.hs_angle:g} exceeds heel_strike_max_rad: limited")
    if limits & library().SADDLE_LIMIT_TOE_OFF:
        _note("the toe-off angle of this gait exceeds the ankle's range: limited")


def _note(text: str) -> None:
    print(f"saddlewalk plan: {text}", file=sys.stderr)


def _schedule_row(core: Any, instant: Any) -> list[Cell]:
    from saddlewalk.contract import MODES, TIME_MAX_S
    from saddlewalk.core import library
    from saddlewalk.planning.ground import yaws_of
    from saddlewalk.planning.steady import COLUMNS, row_of

    plan = instant.output.plan
    scores = core.score_plan(plan)
    row = row_of(instant.t_s, plan, scores)
    if (
        not scores.valid & library().SADDLE_VALID_STEP
    ):  # as before the first step and after the last
        for name in ("s_pend", "s_jump"):
            row[COLUMNS.index(name)] = None
    times_s = (plan.time_to_heel_strike_s, plan.time_to_toe_off_s)
    return [
        *row,
        MODES[plan.mode],
        *(time_s if time_s < TIME_MAX_S else None for time_s in times_s),
        " ".join(event.name for event in instant.events),
        " ".join(f"{event.t_s:.6f}" for event in instant.events),
        plan.heading_rad,
        *yaws_of(plan),
        plan.heading_rad + plan.pelvis_yaw_rad,
    ]
