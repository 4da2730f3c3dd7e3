"""`saddlewalk emulate`: an emulated wearer for firmware that is already running."""

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.config import add_body_options, load_config
from saddlewalk.errors import UserError
from saddlewalk.options import (
    JOINTS,
    MUJOCO,
    add_gait_options,
    add_plant_options,
    number_in,
    whole_number_in,
)
from saddlewalk.outputs import add_input

if TYPE_CHECKING:
    from saddlewalk.emulation.treadmill import Treadmill
    from saddlewalk.emulation.wearer import Noise, Push, Wearer
    from saddlewalk.faults.scenario import Occurrence
    from saddlewalk.physics.plants import PlantChoice
    from saddlewalk.planning.schedule import Speeds

SPEED_M_S = 1.2
IMPULSE_MAX_N_S = 1000.0
DURATION_MAX_S = 86400.0
RIGHT_AHEAD_M = (
    0.02  # well above the sensor noise, so that the noise does not decide which foot steps first
)


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser("emulate", help="emulate a wearer for running firmware")
    add_walk_options(parser, pace=f"{SPEED_M_S:g} m/s", duration_s=20.0, clock="realtime")
    parser.add_argument(
        "--noise-scale",
        type=number_in(0, 100),
        default=1.0,
        metavar="X",
        help="factor on the sensor noise and on the wearer's unsteadiness (default 1)",
    )
    add_input(
        parser,
        "--faults",
        type=Path,
        metavar="FILE",
        help="TOML with faults, all in the same walk; examples/faults.toml explains the format",
    )
    add_input(
        parser,
        "--command-key",
        type=Path,
        metavar="FILE",
        help="authenticate the commands with the firmware's key: docs/authentication.md",
    )
    parser.set_defaults(run=run)


def add_walk_options(
    parser: argparse.ArgumentParser, pace: str, duration_s: float, clock: str, push: str = ""
) -> None:
    """Options of emulate and demo; `pace`, `clock` and `push` describe the defaults."""
    parser.add_argument(
        "--can", default="auto", metavar="SPEC", help="auto, socketcan:INTERFACE, udp[:GROUP:PORT]"
    )
    parser.add_argument("--lcm", metavar="URL", help="default: udpm on this machine")
    parser.add_argument(
        "--clock",
        choices=("realtime", "paced", "lockstep"),
        help="realtime: firmware and wearer by their own clocks; lockstep: in turns, as fast as "
        "the firmware answers; paced: in turns, no faster than real time, so that a busy computer "
        f"slows both down (default {clock}; with --plant mujoco lockstep, and no other)",
    )
    add_plant_options(parser)
    add_gait_options(parser, default_pace=pace)
    add_body_options(parser)
    parser.add_argument(
        "--duration",
        type=number_in(0.08, DURATION_MAX_S, "s"),
        default=duration_s,
        metavar="S",
        help=f"of the walk (default {duration_s:g})",
    )
    parser.add_argument(
        "--push",
        type=push_text,
        action="append",
        metavar="N.S@S:DEG",
        help="push: impulse, time and direction (0 forward, 90 to the left); repeatable"
        + (f" (default {push})" if push else ""),
    )
    parser.add_argument(
        "--treadmill",
        action="store_true",
        help="walk on a treadmill whose belt runs at the commanded speed; default: on a floor",
    )
    parser.add_argument(
        "--seed",
        type=whole_number_in(0, 2**32 - 1),
        default=0,
        metavar="N",
        help="random seed (default 0)",
    )


def push_text(text: str) -> tuple[float, float, float]:
    """An argparse type: IMPULSE@TIME:DIRECTION in N s, s and degrees."""
    impulse_text, at, rest = text.partition("@")
    time_text, colon, direction_text = rest.partition(":")
    try:
        impulse, time_s, direction = map(float, (impulse_text, time_text, direction_text))
    except ValueError:
        impulse = time_s = direction = math.nan
    good = 0 < impulse <= IMPULSE_MAX_N_S and 0 <= time_s <= DURATION_MAX_S
    if not (at and colon and good and -360 <= direction <= 360):
        raise argparse.ArgumentTypeError(
            f"{text!r} must be IMPULSE@TIME:DIRECTION such as 20@8:90, "
            f"up to {IMPULSE_MAX_N_S:g} N s, from 0 s, -360 to 360 degrees"
        )
    return impulse, time_s, direction


def run(args: argparse.Namespace) -> int:
    from saddlewalk.emulation.exoskeleton import Exoskeleton
    from saddlewalk.emulation.wearer import Noise
    from saddlewalk.faults.live import faulty
    from saddlewalk.physics.plants import chosen_plant
    from saddlewalk.planning.schedule import schedule_of
    from saddlewalk.transport.authentication import read_key
    from saddlewalk.transport.bus import describe, open_bus
    from saddlewalk.transport.lcmbus import open_lcm

    key = read_key(args.command_key) if args.command_key else None
    plant = chosen_plant(args)
    args.clock = clock_of(args, "realtime")
    config = load_config(args, body=plant.fields)
    wearer = wearer_of(args, plant, config, Noise().scaled(args.noise_scale))
    schedule = schedule_of(speeds_of(args, [(0.0, SPEED_M_S)]), math.radians(args.hs_angle))
    lcm = open_lcm(args.lcm)
    occurrences = _occurrences(args)
    with open_bus(args.can) as bus:
        print(f"CAN: {describe(bus)}; clock: {args.clock}", flush=True)
        events = events_printer(wearer)
        ways = faulty(bus, lcm, occurrences, args.seed) if occurrences else (bus, lcm)
        host_clock = host_clock_of(args.clock)
        start = f"start saddlewalk-host there with --clock {host_clock} and the same --lcm"
        exoskeleton = Exoskeleton(
            *(ways[0], wearer, config, schedule, ways[1], [events]),
            fresh=False,
            if_silent=start,
            key=key,
            joint_core=plant.joint_core(config),
            treadmill=treadmill_of(args, config),
        )
        exoskeleton.run(args.clock, args.duration)
    print(summary(wearer, exoskeleton))
    return 1 if wearer.fallen else 0


def _occurrences(args: argparse.Namespace) -> "list[Occurrence]":
    """The faults of --faults, each at a random time by --seed."""
    import numpy as np

    from saddlewalk.faults.scenario import draw, read_scenario

    if args.faults is None:
        return []
    if args.clock != "realtime":
        raise UserError(
            "--faults needs --clock realtime: in lockstep the firmware waits for a lost frame"
        )
    random = np.random.default_rng(args.seed)
    occurrences = [draw(fault, random) for fault in read_scenario(args.faults).faults]
    for occurrence in occurrences:
        if not occurrence.is_of_frames:
            raise UserError(
                f"{args.faults}: {occurrence.kind} is a fault of the firmware, but emulate only "
                "sends frames: use saddlewalk faults"
            )
    return occurrences


def clock_of(args: argparse.Namespace, default: str) -> str:
    """The choice of --clock; MuJoCo has a simulated clock only."""
    if args.plant != MUJOCO:
        return args.clock or default
    if args.clock not in (None, "lockstep"):
        raise UserError(f"--clock {args.clock}: not with --plant {MUJOCO}, leave it out")
    return "lockstep"


def host_clock_of(clock: str) -> str:
    """saddlewalk-host's: it takes its turns whatever the pace is."""
    return "realtime" if clock == "realtime" else "lockstep"


def wearer_of(
    args: argparse.Namespace, plant: "PlantChoice", config: Any, noise: "Noise"
) -> "Wearer":
    """The wearer of `args` with the body that the firmware's configuration describes."""
    from saddlewalk.emulation.wearer import Push

    pushes = tuple(Push(*push) for push in args.push or ())
    for push in pushes:
        if push.time_s >= args.duration:
            raise UserError(
                f"--push at {push.time_s:g} s: give a time before the end, --duration "
                f"{args.duration:g} s"
            )
    return plant.wearer(config, noise, pushes, args.seed, right_ahead_m=RIGHT_AHEAD_M)


def treadmill_of(args: argparse.Namespace, config: Any) -> "Treadmill | None":
    """That of --treadmill, which speeds up as the walk does."""
    from saddlewalk.emulation.treadmill import Treadmill

    return Treadmill(config.acceleration_m_s2) if args.treadmill else None


def speeds_of(args: argparse.Namespace, default: "Speeds") -> "Speeds":
    """The speeds and turning rates of --schedule, or the speed of --speed."""
    from saddlewalk.planning import schedule

    if args.schedule:
        changes = schedule.read_schedule(args.schedule)
        if args.drive == JOINTS:
            schedule.check_straight(args.schedule, changes, f"--drive {JOINTS}")
        return schedule.speeds_of(changes)
    return default if args.speed is None else [(0.0, args.speed)]


def events_printer(wearer: "Wearer") -> Any:
    """An observer that prints changes of mode and level, pushes, recovery steps and a fall."""
    from saddlewalk.contract import MODES
    from saddlewalk.emulation.exoskeleton import Observer
    from saddlewalk.ticks import scores_of
    from saddlewalk.verdict import level_words

    class Events(Observer):
        def __init__(self) -> None:
            self._due = sorted(wearer.pushes, key=lambda push: push.time_s)
            self._mode: int | None = None
            self._level = 0
            self._fallen = self._recovering = False
            self.recovery_steps = 0

        def tick(self, tick: Any, wearer: "Wearer") -> None:
            if tick.plan and tick.plan.mode != self._mode:
                self._mode = tick.plan.mode
                self._print(tick, MODES[tick.plan.mode])
            while self._due and self._due[0].time_s < tick.time_s:
                self._print(tick, push_words(self._due.pop(0)))
            scores = scores_of(tick.messages)
            if scores["LEVEL"] != self._level and not self._fallen:
                self._level = int(scores["LEVEL"])
                self._print(tick, level_words(scores))
            shift_m = abs(wearer.recovery_shift_m)
            if shift_m and not self._recovering:
                self.recovery_steps += 1
                self._print(tick, f"recovery step, {shift_m:.2f} m from the planned landing")
            self._recovering = shift_m > 0
            if wearer.fallen and not self._fallen:
                self._fallen = True
                self._print(tick, "fell")

        def _print(self, tick: Any, words: str) -> None:
            print(f"{tick.time_s:7.2f} s  {words}", flush=True)

    return Events()


def push_words(push: "Push") -> str:
    direction = {0.0: "forward", 90.0: "to the left", 180.0: "backward", 270.0: "to the right"}
    words = direction.get(push.direction_deg % 360, f"to {push.direction_deg:g} degrees")
    return f"push of {push.impulse_n_s:.3g} N s {words}"


def summary(wearer: "Wearer", exoskeleton: Any) -> str:
    receiver = exoskeleton.reader.receiver
    fell = f"fell at {wearer.fell_at_s:.2f} s" if wearer.fallen else "did not fall"
    return (
        f"walked {wearer.time_s:.1f} s, to {abs(wearer.com_m):.1f} m from the start; {fell}; "
        f"{exoskeleton.ticks} ticks, {exoskeleton.frames_sent} frames sent, "
        f"{receiver.accepted} received, {receiver.rejected} rejected"
    )
