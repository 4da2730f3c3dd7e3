"""`saddlewalk chain`: MuJoCo's sensors to the firmware by CAN, and its joint commands back."""

import argparse
import contextlib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from saddlewalk.config import add_body_options, given_legs, host_arguments, load_config
from saddlewalk.errors import UserError
from saddlewalk.options import (
    JOINTS,
    MUJOCO,
    WINTER,
    add_campaign_options,
    number_in,
    whole_number_in,
    workers_of,
)
from saddlewalk.progress import progress_bar

if TYPE_CHECKING:
    from saddlewalk.physics.joint_chain import Outcome
    from saddlewalk.ticks import FrameBus

HOST, EMULATED, BOTH = "host", "qemu-m4", "both"
SPEED_M_S, DISTANCE_M, DEFAULT_RATE_HZ = 0.8, 15.0, 500


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "chain",
        help="a body in MuJoCo as a device on CAN: sensors to the firmware, joint commands back",
    )
    parser.add_argument(
        "--firmware",
        choices=(HOST, EMULATED, BOTH),
        default=HOST,
        help="the process saddlewalk-host, an emulated Cortex-M4F in QEMU, or one after the other, "
        "whose bits must be equal (default host)",
    )
    parser.add_argument(
        "--speed",
        type=number_in(0.1, 3, "m/s"),
        default=SPEED_M_S,
        metavar="M/S",
        help=f"default {SPEED_M_S:g}",
    )
    parser.add_argument(
        "--distance",
        type=number_in(1, 10_000, "m"),
        default=DISTANCE_M,
        metavar="M",
        help=f"default {DISTANCE_M:g}",
    )
    parser.add_argument(
        "--rate",
        type=int,
        choices=(125, 200, 250, 500, 1000),
        default=DEFAULT_RATE_HZ,
        help=f"sets of sensors, and of joint commands, in a second (default {DEFAULT_RATE_HZ})",
    )
    parser.add_argument(
        "--pushes",
        type=whole_number_in(8, 1000),
        metavar="N",
        help="instead N walks with a push in each of four directions: what do half survive?",
    )
    add_campaign_options(parser)
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """1: it fell, did not end standing, or the bits differ."""
    from saddlewalk.physics.joint_chain import Course, walk
    from saddlewalk.physics.plants import chosen_plant

    args.plant, args.body, args.drive = MUJOCO, WINTER, JOINTS
    config = load_config(args, body=chosen_plant(args).fields)
    if args.pushes:
        return _pushed(args, config)
    measured = given_legs(args)
    course = Course(args.speed, args.distance, args.rate, args.seed, legs=measured)
    outcomes: list[Outcome] = []
    for firmware in (HOST, EMULATED) if args.firmware == BOTH else (args.firmware,):
        running = _host if firmware == HOST else _controller
        with running(config, args.rate, measured) as bus:
            outcomes.append(walk(bus, config, course))
        print(f"{firmware}: {_words(outcomes[-1])}", flush=True)
    same = len({(outcome.digest, outcome.distance_m) for outcome in outcomes}) == 1
    if len(outcomes) > 1:
        print("bits of both: " + ("equal" if same else "NOT equal"))
    sound = all(outcome.stands for outcome in outcomes)
    return 0 if sound and same else 1


def _pushed(args: argparse.Namespace, config: Any) -> int:
    from saddlewalk.evaluation.chain_pushes import DIRECTIONS, survived
    from saddlewalk.faults.joint_campaign import RATE_HZ

    for option, value, default in (
        ("firmware", args.firmware, HOST),
        ("distance", args.distance, DISTANCE_M),
        ("rate", args.rate, DEFAULT_RATE_HZ),
    ):
        if value != default:
            raise UserError(f"--{option} {value}: not with --pushes, leave it out")
    workers = workers_of(args)
    with progress_bar("directions", len(DIRECTIONS)) as progress:
        found = survived(args.pushes, args.speed, args.seed, config, workers, progress)
    words = ", ".join(f"{direction} {impulse:.0f}" for direction, impulse in found.items())
    print(f"half survive, N s, at {args.speed:g} m/s and {RATE_HZ} Hz: {words}")
    return 0


def _words(outcome: "Outcome") -> str:
    end = "stands at the end" if outcome.stands else "does not stand at the end"
    end = f"fell at {outcome.fell_at_s:.2f} s" if outcome.fell else end
    return (
        f"{outcome.distance_m:.2f} m in {outcome.walked_s:.1f} s, {end}; {outcome.passes} passes, "
        f"{outcome.fallbacks} with the fallback, {outcome.unsound} with a fault of the sensors; "
        f"frames SHA-256 {outcome.digest[:16]}"
    )


@contextlib.contextmanager
def _host(config: Any, rate_hz: int, measured: "Mapping[str, float]") -> "Iterator[FrameBus]":
    from saddlewalk.emulation.host import running_host
    from saddlewalk.transport.bus import open_bus

    options = ["--lcm=none", "--clock=lockstep", f"--joints={rate_hz}", *host_arguments(config)]
    options += [f"--joint=legs.{name}={value:.9g}" for name, value in measured.items()]
    with open_bus("udp") as bus, running_host("--can=udp", *options):
        yield bus


@contextlib.contextmanager
def _controller(config: Any, rate_hz: int, measured: "Mapping[str, float]") -> "Iterator[FrameBus]":
    from saddlewalk.emulation.qemu import running_controller

    with running_controller(config, joints_hz=rate_hz, measured_legs=measured) as controller:
        yield controller.bus
    print(f"controller: {controller.words}")
