"""`saddlewalk follow`: tracking error of recorded walks, with default and calibrated models."""

import argparse
import json
import math
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from saddlewalk.config import ANKLES, add_body_options, load_config
from saddlewalk.errors import UserError
from saddlewalk.options import add_recordings, number_in
from saddlewalk.outputs import add_output

if TYPE_CHECKING:
    from saddlewalk.gait.followed import Followed
    from saddlewalk.gait.measures import WalkMeasures
    from saddlewalk.table import Cell

RMS_COLUMNS = "com_y_m com_z_m com_z_shape_m swing_x_m landing_m heel_strike_s".split()
COLUMNS = ["recording", "speed_m_s", "steps", "configuration", *RMS_COLUMNS, "limited"]
WIDEST = 1000  # characters


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "follow",
        help="tracking error of recorded walks, with the default and the calibrated gait model",
        description="For each recorded walk, RMS of recorded minus planned with the paper's "
        "defaults and with a model calibrated to that walk (with --leave-out also to the other "
        "recordings, which must be of the same person) or given by --config. CoM y, CoM z, "
        "its shape (without the mean difference), the swing foot's x from the stance foot over "
        "the swing and at landing, and the time from passing the stance foot to heel strike.",
    )
    add_recordings(parser)
    add_body_options(parser)
    parser.add_argument(
        "--hs-angle",
        type=number_in(0, 30, "degrees"),
        default=10.0,
        metavar="DEG",
        help="foot angle at heel strike (default 10)",
    )
    parser.add_argument(
        "--ankle", choices=ANKLES, help="of the calibrated plan (default: as it was calibrated)"
    )
    parser.add_argument(
        "--leave-out",
        action="store_true",
        help="also calibrate to all recordings but the one that is followed",
    )
    parser.add_argument(
        "--halves",
        action="store_true",
        help="split each recording's steps in two halves, and calibrate also to one half to follow "
        "the other: for a person of whom there is one recording",
    )
    add_output(parser, "--out", metavar="FILE", help="the table as CSV")
    add_output(
        parser, "--json", metavar="FILE", help="errors, medians and shares within the goals as JSON"
    )
    add_output(
        parser,
        "--picture",
        metavar="FILE",
        help="a stride of the first recording and its plan over each other, as PNG, SVG or PDF",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.atomic_write import write_text
    from saddlewalk.gait.followed import follow, summary
    from saddlewalk.gait.measures import measure
    from saddlewalk.gait.samples import recorded_walks
    from saddlewalk.table import write_table

    _check_left_out(args)
    recordings = recorded_walks(args.recordings, args.sample, args.markers)
    walks = [measure(recording) for recording in recordings]
    if args.halves:
        walks = _halves(walks)
    configurations = _configurations(args, walks)
    followed = follow(walks, configurations, args.hs_angle)
    if args.picture:
        from saddlewalk.pictures.film_strip import draw_film_strip

        names = list(configurations)
        shown = {name: configurations[name](0) for name in (names[0], names[-1])}
        draw_film_strip(args.picture, walks[0], followed[0], shown, args.hs_angle)
    if args.out:
        write_table(args.out, COLUMNS, [row for one in followed for row in _rows(one)])
    if args.json:
        write_text("--json", args.json, json.dumps(summary(followed), indent=2) + "\n")
    _print(followed, sys.stderr if "-" in (args.out, args.json) else sys.stdout)
    return 0


def _check_left_out(args: argparse.Namespace) -> None:
    if args.leave_out and args.halves:
        raise UserError("--leave-out and --halves: only one of them")
    for option, given in (("--leave-out", args.leave_out), ("--halves", args.halves)):
        if given and args.config:
            raise UserError(f"{option} calibrates by itself: leave --config out")
    if args.leave_out and len(args.recordings) < 2:
        raise UserError("--leave-out needs two recordings of the same person or more")
    if args.leave_out and len(set(args.recordings)) < len(args.recordings):
        raise UserError("--leave-out: a recording is given twice and would not be left out")


def _halves(walks: "list[WalkMeasures]") -> "list[WalkMeasures]":
    halves = [half for walk in walks if len(walk.curves) > 1 for half in walk.halves()]
    if not halves:
        raise UserError("--halves needs a recording with two steps or more")
    for walk in walks:
        if len(walk.curves) < 2:
            print(f"{walk.source}: left out: it has no two steps to split", file=sys.stderr)
    return halves


def _configurations(
    args: argparse.Namespace, walks: "list[WalkMeasures]"
) -> dict[str, Callable[[int], Any]]:
    """By name, for the walk with an index; the default first, the most telling last."""
    from saddlewalk.gait.calibration import calibrate, checked

    def calibrated(chosen: "list[WalkMeasures]") -> Any:
        config = checked(calibrate(chosen, args.height, args.mass))
        if args.ankle:
            config.ankle = ANKLES[args.ankle]
        return config

    default = load_config(argparse.Namespace(**{**vars(args), "config": None}))
    if args.config:
        given = load_config(args, args.ankle)
        return {"default": lambda _: default, "calibrated": lambda _: given}
    configurations: dict[str, Callable[[int], Any]] = {
        "default": lambda _: default,
        "calibrated": lambda index: calibrated([walks[index]]),
    }
    if args.halves:
        configurations["left out"] = lambda index: calibrated([walks[index ^ 1]])
    if args.leave_out:
        configurations["left out"] = lambda index: calibrated(walks[:index] + walks[index + 1 :])
    return configurations


def _rows(one: "Followed") -> "list[list[Cell]]":
    return [
        [
            one.source,
            one.speed_m_s,
            one.steps,
            name,
            *(getattr(found, column) for column in RMS_COLUMNS),
            int(found.limited),
        ]
        for name, found in one.deviations.items()
    ]


def _print(followed: "list[Followed]", stream: Any) -> None:
    from rich.console import Console

    console = Console(file=stream)
    for table in (_table(followed), _goal_table(followed)):
        if not console.is_terminal:  # names need not fold in a file or a pipe
            options = console.options.update(max_width=WIDEST)
            console.width = table.__rich_measure__(console, options).maximum
        console.print(table)


def _table(followed: "list[Followed]") -> Any:
    from rich.box import SIMPLE
    from rich.markup import escape
    from rich.table import Table

    from saddlewalk.gait.followed import QUANTITIES

    names = list(followed[0].deviations)
    table = Table(
        box=SIMPLE, padding=0, title=f"RMS of recorded minus planned: {' → '.join(names)}"
    )
    table.add_column("recording", overflow="fold")
    for name in ("speed", "steps", *(name.replace("_", "\n") for name in QUANTITIES)):
        table.add_column(name, justify="right", no_wrap=True)
    for one in followed:
        numbers = [one.numbers(name) for name in names]
        table.add_row(
            escape(one.source),
            f"{one.speed_m_s:.2f}",
            str(one.steps),
            *("→".join(_whole(row[quantity]) for row in numbers) for quantity in QUANTITIES),
        )
    limited = ", ".join(
        f"{one.source} ({name})"
        for one in followed
        for name, found in one.deviations.items()
        if found.limited
    )
    if limited:
        table.caption = escape(f"The plan cannot reach the speed and is slower: {limited}")
    return table


def _goal_table(followed: "list[Followed]") -> Any:
    from rich.box import SIMPLE
    from rich.table import Table

    from saddlewalk.gait.followed import GOALS, medians, within

    names = list(followed[0].deviations)
    table = Table(box=SIMPLE, padding=0, title="Median, and recordings within the goal")
    table.add_column("")
    for name in ("goal", *names):
        table.add_column(name, justify="right", no_wrap=True)
    by_name = [(medians(followed, name), within(followed, name)) for name in names]
    for quantity, goal in GOALS.items():
        what, unit = quantity.split("_")
        cells = [
            f"{median[quantity]:.1f}, {100 * share[quantity]:.0f} %" for median, share in by_name
        ]
        table.add_row(what, f"{goal:g} {unit}", *cells)
    return table


def _whole(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.0f}"
