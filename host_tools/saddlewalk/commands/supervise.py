"""`saddlewalk supervise`: scores of recorded states, from the C core."""

import argparse
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from saddlewalk.config import add_body_options, load_config
from saddlewalk.options import speed
from saddlewalk.outputs import add_input, add_output
from saddlewalk.table import read_series, write_table

if TYPE_CHECKING:
    from saddlewalk.core import Measurement

LONGEST_S = 1e9


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "supervise",
        help="score recorded states as CSV",
        description="Score recorded states as CSV. An empty cell is a result that is not there. "
        "flags: bits 0-15 saddle_fault_t, 16-23 saddle_limit_t, 24-31 the saddle_reason_t that "
        "decided the level.",
    )
    add_input(
        parser,
        "--in",
        dest="source",
        required=True,
        metavar="FILE",
        help="states as CSV; - reads stdin",
    )
    add_output(parser, "--out", metavar="FILE", help="default: standard output")
    parser.add_argument(
        "--speed",
        type=speed,
        metavar="M/S",
        help="compare with the steady walk that is planned at this speed, its left foot under the "
        "CoM in the first row; default: with the recorded walk's own last step",
    )
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.core import Command, body_of
    from saddlewalk.recorded_states import SCORE_COLUMNS, recording_core, scored_rows

    config = load_config(args)
    core = recording_core(config)
    command = Command(args.speed)
    if args.speed is not None:
        core.join(command)
        ceiling_m_s = body_of(config).speed_ceiling_m_s
        if args.speed >= ceiling_m_s:
            note = f"is not feasible for this body: limited below {ceiling_m_s:.4g} m/s"
            print(f"saddlewalk supervise: --speed {args.speed:g} {note}", file=sys.stderr)
    rows = scored_rows(core, command, _measurements(args.source))
    write_table(args.out, SCORE_COLUMNS, rows)
    return 0


def _measurements(source: str) -> Iterator[tuple[float, "Measurement"]]:
    from saddlewalk.recorded_states import STATE_COLUMNS, measurement_of

    for line, state in read_series(source, STATE_COLUMNS, LONGEST_S):
        yield state["t_s"], measurement_of(f"{source}: line {line}", state)
