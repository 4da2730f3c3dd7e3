"""Command-line options that commands share, and types whose errors state what is accepted."""

import argparse
import math
import os
from collections.abc import Callable

from saddlewalk.outputs import add_input
from saddlewalk.workers import Workers

SAMPLE_NAMES = ("healthy", "stroke")


def number_in(low: float, high: float, unit: str = "") -> Callable[[str], float]:
    """An argparse type: a finite number in [low, high]."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text!r} must be {low:g} to {high:g} {unit}".strip())
        return value

    return parse


def list_of(kind: Callable[[str], float]) -> Callable[[str], tuple[float, ...]]:
    """An argparse type: values of a kind, separated by commas."""
    return lambda text: tuple(kind(part) for part in text.split(","))


def whole_number_in(low: int, high: int) -> Callable[[str], int]:
    """An argparse type: a whole number in [low, high]."""

    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = low - 1
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text!r} must be a whole number, {low} to {high}")
        return value

    return parse


MUJOCO, WINTER = "mujoco", "winter"
TORQUES, JOINTS = "torques", "joints"


def add_plant_options(parser: argparse.ArgumentParser, default: str = "pendulum") -> None:
    """--plant, --body and --drive, for chosen_plant()."""
    parser.add_argument(
        "--plant",
        choices=("pendulum", MUJOCO),
        default=default,
        help="the wearer: a point mass, or a body with segments, contacts and torque limits in "
        f"MuJoCo (default {default}): docs/physics.md",
    )
    parser.add_argument(
        "--body",
        choices=(WINTER, "dm_control"),
        help=f"of --plant mujoco: average proportions, or dm_control's humanoid (default {WINTER})",
    )
    parser.add_argument(
        "--drive",
        choices=(TORQUES, JOINTS),
        help=f"of --plant mujoco: {TORQUES} of a quadratic programme that knows the body's "
        f"state, or {JOINTS}: firmware/joints, from sensors to drives, docs/joints.md "
        f"(default {TORQUES})",
    )


speed = number_in(1e-3, 10, "m/s")


def speed_range(text: str) -> tuple[float, float]:
    """An argparse type: LOW:HIGH in m/s."""
    low, _, high = text.partition(":")
    try:
        found = speed(low), speed(high)
    except argparse.ArgumentTypeError:
        found = (1.0, 0.0)
    if found[0] > found[1]:
        raise argparse.ArgumentTypeError(f"{text!r} must be LOW:HIGH in m/s such as 0.6:1.2")
    return found


def add_gait_options(parser: argparse.ArgumentParser, default_pace: str | None = None) -> None:
    """--speed or --schedule, one of them required unless there is a default, and --hs-angle."""
    default = "" if default_pace is None else f" (default {default_pace})"
    pace = parser.add_mutually_exclusive_group(required=default_pace is None)
    pace.add_argument("--speed", type=speed, metavar="M/S", help="walking speed" + default)
    add_input(
        pace,
        "--schedule",
        metavar="FILE",
        help="CSV with the columns t_s (from 0, increasing) and speed_m_s (0: stand)",
    )
    parser.add_argument(
        "--hs-angle",
        type=number_in(0, 30, "degrees"),
        default=10.0,
        metavar="DEG",
        help="foot angle at heel strike (default 10)",
    )


def add_campaign_options(parser: argparse.ArgumentParser) -> None:
    """--seed, and --jobs or --scheduler for workers_of()."""
    parser.add_argument(
        "--seed",
        type=whole_number_in(0, 2**32 - 1),
        default=1,
        metavar="N",
        help="random seed (default 1)",
    )
    parser.add_argument(
        "--jobs",
        type=whole_number_in(1, 1024),
        default=len(os.sched_getaffinity(0)),
        metavar="N",
        help="processes that share the work (default: one for each core)",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="run on the workers of this dask scheduler, such as tcp://10.0.0.5:8786, instead of "
        "--jobs; same results",
    )


def workers_of(args: argparse.Namespace) -> Workers:
    return Workers(args.jobs, args.scheduler)


def add_recordings(parser: argparse.ArgumentParser) -> None:
    """RECORDING... or --sample, and --markers, for recorded_walks()."""
    given = parser.add_mutually_exclusive_group(required=True)
    add_input(
        given,
        "recordings",
        nargs="*",
        default=[],
        metavar="RECORDING",
        help="a steady walk: .c3d, .trc, or CSV with t, com_x ... rtoe_z in s and m",
    )
    add_sample(given)
    add_markers(parser)


def add_sample(given: "argparse._MutuallyExclusiveGroup") -> None:
    """--sample, beside the recordings that it stands for."""
    given.add_argument(
        "--sample", choices=SAMPLE_NAMES, help="a recorded person from the package gaitkit"
    )


def add_markers(parser: argparse.ArgumentParser) -> None:
    """--markers, for read_markers()."""
    add_input(
        parser,
        "--markers",
        metavar="FILE",
        help="TOML with the markers of front, rear, left_heel, left_toe, right_heel, right_toe "
        "where a C3D or TRC file does not use a usual name",
    )
