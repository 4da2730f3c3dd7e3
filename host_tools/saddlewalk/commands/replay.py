"""`saddlewalk replay`: a recorded walk, sent through CAN to the firmware as a live wearer would."""

import argparse
import sys
from typing import TYPE_CHECKING, Any

from saddlewalk.config import add_body_options
from saddlewalk.options import add_markers
from saddlewalk.outputs import add_input, add_output

if TYPE_CHECKING:
    from saddlewalk.gait.recording import Recording

SAMPLE_NAMES = ("healthy", "stroke")


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser("replay", help="send a recorded walk over CAN to the firmware")
    trial = parser.add_mutually_exclusive_group(required=True)
    add_input(
        trial,
        "recording",
        nargs="?",
        metavar="RECORDING",
        help=".c3d, .trc, or CSV with t, com_x ... rtoe_z in s and m; - reads CSV from stdin",
    )
    trial.add_argument("--sample", choices=SAMPLE_NAMES, help="a recorded person of gaitkit's data")
    add_markers(parser)
    parser.add_argument(
        "--can",
        metavar="SPEC",
        help="auto, socketcan:INTERFACE, udp or udp:GROUP:PORT (default: a private UDP bus)",
    )
    parser.add_argument(
        "--clock",
        choices=("lockstep", "realtime"),
        default="lockstep",
        help="as fast as the firmware answers, or in real time, with LCM (default lockstep)",
    )
    add_body_options(parser)
    add_output(parser, "--out", metavar="FILE", help="states and scores of every tick as CSV")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.config import host_arguments, load_config
    from saddlewalk.emulation.host import running_host
    from saddlewalk.gait.events import analyse
    from saddlewalk.gait.measures import implausible
    from saddlewalk.gait.playback import (
        measurements,
        play_lockstep,
        play_realtime,
        states_at_ticks,
    )
    from saddlewalk.gait.replayed import SCORE_COLUMNS, report, score_row
    from saddlewalk.recorded_states import STATE_COLUMNS
    from saddlewalk.table import write_table
    from saddlewalk.transport.bus import open_bus, private_udp

    recording = _load(args)
    gait = analyse(recording)
    for line in implausible(recording, gait):
        print(f"saddlewalk replay: {line}", file=sys.stderr)
    states = {state["t_s"]: state for state in states_at_ticks(recording, gait.contact)}
    options = host_arguments(load_config(args))
    spec = args.can or private_udp()
    lcm = ["--lcm=none"] if args.clock == "lockstep" else []
    play = play_lockstep if args.clock == "lockstep" else play_realtime
    with (
        open_bus(spec) as bus,
        running_host(f"--can={spec}", f"--clock={args.clock}", *lcm, *options),
    ):
        answers = list(play(bus, measurements(states.values())))
    rows = [score_row(*answer) for answer in answers]
    if args.out:
        measured = STATE_COLUMNS[1:]
        write_table(
            args.out,
            [*SCORE_COLUMNS, *measured],
            (
                [*row, *(states[time_s][name] for name in measured)]
                for row, (time_s, _) in zip(rows, answers, strict=True)
            ),
        )
    stream = sys.stderr if args.out == "-" else sys.stdout
    print("\n".join(report(recording, gait, rows)), file=stream)
    return 0


def _load(args: argparse.Namespace) -> "Recording":
    if args.sample:
        from saddlewalk.gait.samples import load_sample

        return load_sample(args.sample)
    from saddlewalk.gait.motion_capture import load_walk, read_markers

    return load_walk(args.recording, read_markers(args.markers))
