"""`saddlewalk supervise`: scores of recorded states, from the C core."""

import argparse
import sys
from typing import Any

from saddlewalk.config import add_body_options, load_config
from saddlewalk.options import add_markers, speed
from saddlewalk.outputs import add_input, add_output
from saddlewalk.table import write_table

COLUMNS = """\
columns of states, in any order; an empty cell is a missing measurement:
  t_s                        time, rising
  com_x_m com_y_m com_z_m    CoM: x forward, y to the left, z from the ground
  com_vx_m_s com_vy_m_s      its velocity
  left_x_m left_y_m right_x_m right_y_m
                             middles of the soles
  left_contact right_contact 1: on the ground; 0: in the air
  pelvis_yaw_rad             heading of the pelvis, to the left of x; may be left out

columns of the result; an empty cell is a missing result:
  t_s                        time
  v_comp_m_s                 mean speed of the CoM over the last completed step
  s_pend s_jump s_sw         step scores: 1 as in a steady walk, 0 the limit
  mos_com_m mos_xcom_m       CoM and XCoM inside the base of support; negative: outside
  ebos_com_m ebos_xcom_m     the same in the base of support of the next heel strike
  excess_stop_j excess_track_j
                             energy to lose in order to stop, and to return to the plan
  can_stop on_track          1: the ankles can absorb that; 0: they cannot
  level                      stable, caution, unstable, unknown
  flags                      hexadecimal: bits 0-15 saddle_fault_t, 16-23 saddle_limit_t,
                             24-31 the saddle_reason_t that decided the level
  recovery_margin_m          reach that a recovery step has left; negative: what is lacking
  margin                     decides the level: larger is safer, unstable at 0 and below
"""


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "supervise",
        help="score recorded states",
        description="Score recorded states, as CSV.",
        epilog=COLUMNS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
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
