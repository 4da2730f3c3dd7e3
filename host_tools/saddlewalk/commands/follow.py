"""`saddlewalk follow`: tracking error of recorded walks, by default and calibrated."""

import argparse
import math
import sys
from typing import TYPE_CHECKING, Any

from saddlewalk.config import ANKLES, add_body_options, load_config
from saddlewalk.options import add_recordings, number_in
from saddlewalk.outputs import add_output

if TYPE_CHECKING:
    from saddlewalk.gait.recording import Recording
    from saddlewalk.gait.tracking_error import Deviation
    from saddlewalk.table import Cell

RMS_COLUMNS = "com_y_m com_z_m com_z_shape_m swing_x_m landing_m heel_strike_s".split()
COLUMNS = ["recording", "speed_m_s", "steps", "configuration", *RMS_COLUMNS, "limited"]
WIDEST = 1000  # characters
SHOWN = ("y\nmm", "z\nmm", "shape\nmm", "swing\nmm", "landing\nmm", "strike\nms")


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "follow",
        help="tracking error of recorded walks, by default and calibrated",
        description="For each recorded walk, RMS of recorded minus planned with the paper's "
        "defaults and after calibration: to that walk itself or, with --config, before. CoM y, "
        "CoM z, its shape (without the mean difference), the swing foot's x from the stance foot "
        "over the swing and at landing, and the time from passing the stance foot to heel strike.",
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
    parser.add_argument("--ankle", choices=ANKLES, help="of the calibrated plan (default erf)")
    add_output(parser, "--out", metavar="FILE", help="the table as CSV")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from rich.console import Console

    from saddlewalk.gait.measures import measure
    from saddlewalk.gait.motion_capture import load_walk, read_markers
    from saddlewalk.gait.tracking_error import deviation
    from saddlewalk.table import write_table

    markers = read_markers(args.markers)
    defaults = load_config(argparse.Namespace(**{**vars(args), "config": None}))
    rows = []
    for source in args.recordings:
        recording = load_walk(source, markers)
        walk = measure(recording)
        for name, config in (("default", defaults), ("calibrated", _calibrated(args, walk))):
            found = deviation(recording, config, args.hs_angle)
            rows.append(_row(recording, walk.speed_m_s, name, found))
    if args.out:
        write_table(args.out, COLUMNS, rows)
    stream = sys.stderr if args.out == "-" else sys.stdout
    console, table = Console(file=stream), _table(rows)
    if not console.is_terminal:  # a file or a pipe has no width that names would have to fold to
        console.width = table.__rich_measure__(
            console, console.options.update(max_width=WIDEST)
        ).maximum
    console.print(table)
    return 0


def _calibrated(args: argparse.Namespace, walk: Any) -> Any:
    from saddlewalk.gait.calibration import calibrate, checked

    if args.config:
        return load_config(args, args.ankle)
    config = checked(calibrate([walk], args.height, args.mass))
    if args.ankle:
        config.ankle = ANKLES[args.ankle]
    return config


def _row(recording: "Recording", speed_m_s: float, name: str, found: "Deviation") -> list["Cell"]:
    numbers = [getattr(found, column) for column in RMS_COLUMNS]
    return [recording.source, speed_m_s, found.steps, name, *numbers, int(found.limited)]


def _table(rows: list[list[Any]]) -> Any:
    from rich.box import SIMPLE
    from rich.markup import escape
    from rich.table import Table

    table = Table(
        box=SIMPLE,
        padding=0,
        title="RMS of recorded minus planned: paper's defaults → calibrated",
    )
    table.add_column("recording", overflow="fold")
    for name in ("speed", "steps", *SHOWN):
        table.add_column(name, justify="right", no_wrap=True)
    first = COLUMNS.index(RMS_COLUMNS[0])
    for default, calibrated in zip(rows[::2], rows[1::2], strict=True):
        pairs = zip(default[first:-1], calibrated[first:-1], strict=True)
        table.add_row(
            escape(default[0]),
            f"{default[1]:.2f}",
            str(default[2]),
            *(f"{_thousandths(before)}→{_thousandths(after)}" for before, after in pairs),
        )
    limited = ", ".join(f"{row[0]} ({row[3]})" for row in rows if row[-1])
    if limited:
        table.caption = escape(f"Plan slower than the walk, which it can't reach: {limited}")
    return table


def _thousandths(value: float) -> str:
    return "-" if math.isnan(value) else f"{1e3 * value:.0f}"
