"""`saddlewalk replay`: a recorded walk, sent through CAN to the firmware as a live wearer would."""

import argparse
import math
import sys
from typing import TYPE_CHECKING, Any

from saddlewalk import verdict
from saddlewalk.config import add_body_options
from saddlewalk.options import add_markers
from saddlewalk.outputs import add_input, add_output

if TYPE_CHECKING:
    import numpy as np

    from saddlewalk.gait.events import Gait
    from saddlewalk.gait.recording import Recording

SAMPLE_NAMES = ("healthy", "stroke")
NUMBER_COLUMNS = "t_s v_comp_m_s s_pend s_jump s_sw mos_com_m mos_xcom_m".split()
SCORE_COLUMNS = [*NUMBER_COLUMNS, *verdict.COLUMNS, "faults"]


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "replay", help="send a recorded walk through CAN to the firmware"
    )
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
        help="as fast as the firmware answers, or as it was walked, with LCM (default lockstep)",
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
    told = sys.stderr if args.out == "-" else sys.stdout
    print("\n".join(report(recording, gait, rows)), file=told)
    return 0


def _load(args: argparse.Namespace) -> "Recording":
    if args.sample:
        from saddlewalk.gait.samples import load_sample

        return load_sample(args.sample)
    from saddlewalk.gait.motion_capture import load_walk, read_markers

    return load_walk(args.recording, read_markers(args.markers))


def score_row(time_s: float, scores: dict[str, float]) -> list:
    """One line of --out, in the order of SCORE_COLUMNS."""
    names = ("V_COMP", "S_PEND", "S_JUMP", "S_SW", "MOS_COM", "MOS_XCOM")
    return [
        round(time_s, 6),
        *(scores[name] for name in names),
        *verdict.cells(scores),
        f"0x{scores['FAULTS']:04x}",
    ]


def report(recording: "Recording", gait: "Gait", rows: list[list]) -> list[str]:
    """Lines `name value unit`: the walk from the markers, the rest from the firmware's scores."""
    import numpy as np

    numbers = np.array([row[: len(NUMBER_COLUMNS)] for row in rows])
    columns = dict(zip(NUMBER_COLUMNS, numbers.T, strict=True))
    scored = np.isfinite(columns["mos_com_m"])
    levels = verdict.ticks_in(row[SCORE_COLUMNS.index("level")] for row in rows)
    return [
        f"source {recording.source}",
        _line("duration", recording.duration_s, "s"),
        _line("speed", gait.speed_m_s, "m/s"),
        _line("step_length", gait.step_length_m, "m"),
        _line("step_width", gait.step_width_m, "m"),
        _line("min_s_sw", _least(columns["s_sw"])),
        _line("com_in_bos", _share_positive(columns["mos_com_m"]), "%"),
        _line("xcom_in_bos", _share_positive(columns["mos_xcom_m"]), "%"),
        *(_line(name, 100.0 * ticks / len(rows), "%") for name, ticks in levels.items()),
        f"ticks_scored {scored.sum()}",
        f"ticks {len(rows)}",
    ]


def _line(name: str, value: float, unit: str = "") -> str:
    text = "n/a" if math.isnan(value) else f"{value:.4g}"
    return f"{name} {text} {unit}".rstrip()


def _least(values: "np.ndarray") -> float:
    return min((value for value in values if math.isfinite(value)), default=math.nan)


def _share_positive(values: "np.ndarray") -> float:
    """Percent of the values that are there; NaN if none is."""
    there = values[values == values]
    return 100.0 * float((there > 0).mean()) if len(there) else math.nan
