"""`saddlewalk replay`: a recorded walk, sent through CAN to the firmware as a live wearer would."""

import argparse
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.commands.view import add_view_options
from saddlewalk.config import add_body_options
from saddlewalk.errors import UserError
from saddlewalk.options import add_markers, add_sample
from saddlewalk.outputs import add_input, add_output

if TYPE_CHECKING:
    from saddlewalk.gait.events import Gait
    from saddlewalk.gait.recording import Recording
    from saddlewalk.gait.states import State
    from saddlewalk.ticks import Signals


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
    add_sample(trial)
    add_markers(parser)
    parser.add_argument(
        "--can",
        metavar="SPEC",
        help="auto, socketcan:INTERFACE, udp or udp:GROUP:PORT (default: a private UDP bus)",
    )
    parser.add_argument(
        "--clock",
        choices=("lockstep", "realtime"),
        help="as fast as the firmware answers, or in real time, with LCM (default lockstep, with "
        "--view realtime)",
    )
    parser.add_argument("--lcm", metavar="URL", help="in real time (default: udpm on this machine)")
    add_view_options(parser, "show the walk in the browser, in real time")
    add_body_options(parser)
    add_output(parser, "--out", metavar="FILE", help="states and scores of every tick as CSV")
    add_output(
        parser,
        "--log",
        metavar="FILE",
        help="in lockstep: what the firmware publishes as an LCM log, for report and view",
    )
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
    from saddlewalk.gait.samples import recorded_walks
    from saddlewalk.transport.bus import open_bus, private_udp
    from saddlewalk.view.beside import page_beside

    clock = _clock(args)
    files = [args.recording] if args.recording else []
    (recording,) = recorded_walks(files, args.sample, args.markers)
    gait = analyse(recording)
    for line in implausible(recording, gait):
        print(f"saddlewalk replay: {line}", file=sys.stderr)
    states = {state["t_s"]: state for state in states_at_ticks(recording, gait.contact)}
    options = host_arguments(load_config(args))
    spec = args.can or private_udp()
    play = play_lockstep if clock == "lockstep" else play_realtime
    page = page_beside(args, recording.source, controls=False) if args.view else nullcontext()
    with page as shown:
        with _log(args.log) as log:
            lcm = log or ("none" if clock == "lockstep" else args.lcm)
            options += [f"--lcm={lcm}"] if lcm else []
            host = running_host(f"--can={spec}", f"--clock={clock}", *options)
            with open_bus(spec) as bus, host:
                answers = list(play(bus, measurements(states.values())))
        _finish(args, recording, gait, states, answers)
        if shown:
            shown.show_until_interrupted()
    return 0


def _clock(args: argparse.Namespace) -> str:
    """The chosen clock; a page shows real time."""
    if args.view and args.clock == "lockstep":
        raise UserError("--view shows a walk in real time: leave --clock lockstep out")
    clock: str = args.clock or ("realtime" if args.view else "lockstep")
    if args.log and clock != "lockstep":
        raise UserError("--log is written in lockstep: leave --view and --clock realtime out")
    return clock


@contextmanager
def _log(path: str | None) -> Iterator[str | None]:
    """An LCM URL by which the host writes a log; it is at `path` when the host has ended."""
    from saddlewalk.atomic_write import atomic_file

    if path is None:
        yield None
        return
    with tempfile.TemporaryDirectory(prefix="saddlewalk-") as folder:
        log = Path(folder) / "walk.lcmlog"
        yield f"file://{log}?mode=w"
        with atomic_file("--log", path, "wb") as file:
            file.write(log.read_bytes())


def _finish(
    args: argparse.Namespace,
    recording: "Recording",
    gait: "Gait",
    states: "dict[float, State]",
    answers: "list[tuple[float, Signals]]",
) -> None:
    """Write --out and print the report."""
    from saddlewalk.gait.replayed import SCORE_COLUMNS, report, score_row
    from saddlewalk.recorded_states import STATE_COLUMNS
    from saddlewalk.table import write_table

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
