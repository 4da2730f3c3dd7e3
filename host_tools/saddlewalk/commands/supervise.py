"""`saddlewalk supervise`: scores of recorded states, from the C core."""

import argparse
import sys
from typing import Any

from saddlewalk.config import add_body_options, load_config
from saddlewalk.options import add_markers, speed
from saddlewalk.outputs import add_input, add_output
from saddlewalk.table import write_table


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "supervise",
        help="score recorded states",
        description="Score recorded states, as CSV. An empty cell is a missing result. "
        "flags: bits 0-15 saddle_fault_t, 16-23 saddle_limit_t, 24-31 the saddle_reason_t that "
        "decided the level.",
    )
    add_input(
        parser,
        "--in",
        dest="source",
        required=True,
        metavar="FILE",
        help="states as CSV, or what plan, replay and demo write, or a recording: .c3d, .trc or "
        "CSV with t, com_x ... rtoe_z in s and m; - reads CSV from stdin",
    )
    add_markers(parser)
    add_output(parser, "--out", metavar="FILE", help="default: standard output")
    parser.add_argument(
        "--speed",
        type=speed,
        metavar="M/S",
        help="compare with the steady walk planned at this speed, with the left foot under "
        "the CoM in the first row; default: with the recorded walk's own last step",
    )
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.core import Command, body_of
    from saddlewalk.gait.motion_capture import read_markers
    from saddlewalk.gait.states import read_measurements
    from saddlewalk.recorded_states import SCORE_COLUMNS, recording_core, scored_rows

    config = load_config(args)
    core = recording_core(config)
    command = Command(args.speed)
    if args.speed is not None:
        core.join(command)
        ceiling_m_s = body_of(config).speed_ceiling_m_s
        if args.speed >= ceiling_m_s:
            limited = f"not feasible for this body: limited below {ceiling_m_s:.4g} m/s"
            _note(f"--speed {args.speed:g} is {limited}")
    measurements = read_measurements(args.source, read_markers(args.markers), _note)
    rows = scored_rows(core, command, measurements)
    write_table(args.out, SCORE_COLUMNS, rows)
    return 0


def _note(text: str) -> None:
    print(f"saddlewalk supervise: {text}", file=sys.stderr)
