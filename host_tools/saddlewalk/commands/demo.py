"""`saddlewalk demo`: firmware and wearer walk together; live scores, a picture and logs."""

import argparse
import contextlib
import math
import shlex
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.commands.emulate import (
    add_walk_options,
    clock_of,
    events_printer,
    host_clock_of,
    speeds_of,
    summary,
    treadmill_of,
    wearer_of,
)
from saddlewalk.commands.view import add_view_options
from saddlewalk.config import host_arguments, load_config
from saddlewalk.errors import UserError
from saddlewalk.logs.run_files import (
    CAN_LOG,
    FILM,
    LCM_LOG,
    LEARNED,
    PICTURE,
    STRIP,
    TABLE,
    run_names,
)
from saddlewalk.outputs import OutputFolder, add_input, add_output
from saddlewalk.paths import in_checkout
from saddlewalk.printable import printable

if TYPE_CHECKING:
    from saddlewalk.atomic_write import RunFolder
    from saddlewalk.emulation.exoskeleton import Exoskeleton
    from saddlewalk.emulation.wearer import Wearer
    from saddlewalk.logs.recorder import Recorder
    from saddlewalk.logs.soundness import Check
    from saddlewalk.physics.film import Camera
    from saddlewalk.physics.plants import PlantChoice
    from saddlewalk.view.beside import PageBeside

VIEWED_S = 600.0
VIEWED_SPEEDS = [(0.0, 0.0), (1.0, 0.8), (6.0, 1.2)]
SPEEDS = [(0.0, 0.0), (1.0, 0.8), (6.0, 1.2), (16.0, 0.0)]
DURATION_S = 22.0
# Hard enough for caution and recovery steps, and survived: each paced walk is the same.
PUSH_TIMES_S = (10.1, 13.6)
PUSH_N_S_KG = 28.0 / 63.3
PUSH_DIRECTION_DEG = 180.0
REFRESH_S = 0.2
LINE_S = 2.0
LISTEN_S = 0.25

HOST, EMULATED = "host", "qemu-m4"
NEW_KEY = ""  # --command-key without a file


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "demo", help="one walk of firmware and emulated wearer, with picture and logs"
    )
    add_output(
        parser,
        "--out",
        output=lambda _: OutputFolder(run_names()),
        type=Path,
        default=Path("out/demo"),
        metavar="FOLDER",
        help="folder for the picture and the logs (default out/demo)",
    )
    parser.add_argument(
        "--firmware",
        choices=(HOST, EMULATED),
        default=HOST,
        help="the process saddlewalk-host, or an emulated Cortex-M4F in QEMU, without LCM and in "
        "lockstep (default host)",
    )
    add_walk_options(
        parser,
        pace=", ".join(f"{speed_m_s:g} m/s from {from_s:g} s" for from_s, speed_m_s in SPEEDS),
        duration_s=DURATION_S,
        clock="paced",
        push=f"{PUSH_N_S_KG:.3f} N s/kg backward at {' and '.join(map(str, PUSH_TIMES_S))} s, "
        "unless --speed or --schedule is given",
    )
    parser.add_argument(
        "--film",
        action="store_true",
        help=f"of --plant mujoco: draw the whole walk as {FILM} too, without a display",
    )
    add_input(
        parser,
        "--command-key",
        nargs="?",
        const=NEW_KEY,
        metavar="FILE",
        help="authenticate the commands with the key in FILE, or with a new key: "
        "docs/authentication.md",
    )
    parser.add_argument(
        "--learn",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="let the plan follow the wearer: share=0.05 of what each stride departs; the other "
        "names, which saddlewalk-host --help lists, say how far each field may go; repeatable. "
        f"{LEARNED} has the configuration as learned, for --config",
    )
    add_view_options(
        parser,
        f"show the walk in the browser, with controls; it goes on for {VIEWED_S:g} s unless "
        "--duration is given",
    )
    parser.set_defaults(run=run, clock=None, duration=None)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.physics.plants import chosen_plant

    plant = chosen_plant(args)
    if args.duration is None:
        args.duration = VIEWED_S if args.view else DURATION_S
    config = load_config(args, body=plant.fields)
    if args.push is None and args.speed is None and args.schedule is None:
        impulse_n_s = PUSH_N_S_KG * config.body_mass_kg
        times_s = [time_s for time_s in PUSH_TIMES_S if time_s < args.duration]
        args.push = [(impulse_n_s, time_s, PUSH_DIRECTION_DEG) for time_s in times_s]
    args.clock = _clock(args)
    lcm = _open_lcm(args.lcm)
    with _key_file(args.command_key) as args.command_key, _page(args) as page:
        status = _walk(args, plant, config, lcm, page)
        if page:
            page.show_until_interrupted()
    return status


def _walk(
    args: argparse.Namespace,
    plant: "PlantChoice",
    config: Any,
    lcm: Any,
    page: "PageBeside | None",
) -> int:
    from saddlewalk.atomic_write import RunFolder
    from saddlewalk.emulation.exoskeleton import Exoskeleton
    from saddlewalk.emulation.wearer import Noise
    from saddlewalk.logs.soundness import log_checks, transport_checks, walk_checks
    from saddlewalk.pictures.walk import draw_walk
    from saddlewalk.planning.schedule import schedule_of
    from saddlewalk.transport.authentication import read_key
    from saddlewalk.transport.bus import describe
    from saddlewalk.view.steering import Steering

    key = read_key(args.command_key) if args.command_key else None
    by_can = args.firmware == EMULATED
    wearer = wearer_of(args, plant, config, Noise())
    camera = _camera(args, plant, wearer)
    speeds = speeds_of(args, VIEWED_SPEEDS if args.view else SPEEDS)
    schedule = schedule_of(speeds, math.radians(args.hs_angle))
    firmware = _host if args.firmware == HOST else _controller
    with RunFolder("--out", args.out, run_names()) as run_folder:
        walking = firmware(args, config, lcm, run_folder)
        with walking as (bus, recorder), _display(args, lcm) as display:
            authenticated = "; commands: authenticated, by CAN" if key else ""
            print(f"CAN: {describe(bus)}; clock: {args.clock}{authenticated}", flush=True)
            events = events_printer(wearer)
            observers = [recorder, events, display]
            if page:
                schedule = Steering(schedule, wearer, page)
                observers.append(schedule)
            exoskeleton = Exoskeleton(
                *(bus, wearer, config, schedule, lcm, observers),
                key=key,
                joint_core=plant.joint_core(config),
                treadmill=treadmill_of(args, config),
            )
            exoskeleton.run(args.clock, args.duration)
        stops = not page and schedule(args.duration).speed_m_s == 0
        checks = walk_checks(wearer, exoskeleton, stops)
        checks += [*transport_checks(exoskeleton, recorder), *log_checks(recorder, config, by_can)]
        picture = recorder.csv_path.with_name(PICTURE)
        fell_s = wearer.fell_at_s if wearer.fallen else None
        draw_walk(recorder.csv_path, picture, wearer.pushes, config, fell_s)
        if plant.is_mujoco:
            _draw_body(recorder.csv_path, wearer, config, camera)
    status = _finish(args.out, wearer, exoskeleton, recorder, checks)
    print(_seen(wearer, recorder, events.recovery_steps))
    print(_what_next(args.out))
    return status


def _camera(args: argparse.Namespace, plant: "PlantChoice", wearer: "Wearer") -> "Camera | None":
    """That of --film. A body records its poses from now on."""
    if not plant.is_mujoco:
        if args.film:
            raise UserError("--film: only with --plant mujoco")
        return None
    from saddlewalk.physics.wearer import PhysicalWearer

    assert isinstance(wearer, PhysicalWearer)
    wearer.poses = []
    if not args.film:
        return None
    from saddlewalk.physics.film import Camera

    return Camera(wearer.plant.model)


def _draw_body(table: Path, wearer: Any, config: Any, camera: "Camera | None") -> None:
    """The strip, and the film of the part that it shows."""
    from saddlewalk.physics.picture import draw_strip

    draw_strip(table, table.with_name(STRIP), wearer, config)
    if camera:
        from saddlewalk.physics.film import film

        print("drawing the film", flush=True)
        film(table.with_name(FILM), camera, wearer.poses)


def _page(args: argparse.Namespace) -> "contextlib.AbstractContextManager[PageBeside | None]":
    from saddlewalk.view.beside import page_beside

    if not args.view:
        return contextlib.nullcontext()
    return page_beside(args, "an emulated wearer, live", controls=True)


def _clock(args: argparse.Namespace) -> str:
    """The chosen clock, or the firmware's default; a controller has lockstep only."""
    if args.firmware == HOST:
        return clock_of(args, "paced")
    given = (
        ("clock", args.clock, "lockstep"),
        ("can", args.can, "auto"),
        ("command-key", args.command_key, None),
        ("view", "" if args.view else None, None),
        ("learn", " ".join(args.learn), ""),
    )
    for option, value, default in given:
        if value not in (None, default):
            words = f"--{option} {value}".rstrip()
            raise UserError(f"{words}: not with --firmware {args.firmware}, leave it out")
    return "lockstep"


@contextlib.contextmanager
def _key_file(given: str | None) -> Iterator[Path | None]:
    """The file of --command-key; a new key's is removed at the end."""
    from saddlewalk.transport.authentication import write_new_key

    if given != NEW_KEY:
        yield None if given is None else Path(given)
        return
    with tempfile.TemporaryDirectory(prefix="saddlewalk-") as folder:
        path = Path(folder) / "command.key"
        write_new_key(path)
        yield path


@contextlib.contextmanager
def _host(
    args: argparse.Namespace, config: Any, lcm: Any, run_folder: "RunFolder"
) -> "Iterator[tuple[Any, Recorder]]":
    """The bus of a new host process, and the recorder of its messages from the first on."""
    from saddlewalk.emulation.host import running_host
    from saddlewalk.transport.bus import open_bus

    options = [f"--can={args.can}", f"--clock={host_clock_of(args.clock)}", *host_arguments(config)]
    options += [f"--lcm={args.lcm}"] if args.lcm else []
    options += [f"--command-key={args.command_key}"] if args.command_key else []
    options += [f"--learn={bound}" for bound in args.learn]
    with open_bus(args.can) as bus:
        _check_bus_is_free(bus, lcm)
        with _recorder(run_folder, lcm) as recorder:
            options += [f"--learned={recorder.csv_path.with_name(LEARNED)}"] if args.learn else []
            with running_host(*options):
                yield bus, recorder


@contextlib.contextmanager
def _controller(
    args: argparse.Namespace, config: Any, lcm: Any, run_folder: "RunFolder"
) -> "Iterator[tuple[Any, Recorder]]":
    """The bus of an emulated controller, and its recorder."""
    from saddlewalk.emulation.qemu import running_controller

    with running_controller(config) as controller:
        _check_bus_is_free(controller.bus, lcm)
        with _recorder(run_folder, lcm) as recorder:
            print("LCM: only from the wearer; a controller has no LCM")
            yield controller.bus, recorder
    print(f"controller: {controller.words}")


def _recorder(run_folder: "RunFolder", lcm: Any) -> "Recorder":
    from saddlewalk.logs.recorder import Recorder

    if run_folder.earlier:
        print(
            f"{run_folder.folder} holds an earlier run; this one replaces it and what was made of "
            "its log, when it has ended",
            flush=True,
        )
    return Recorder(run_folder.start(), lcm)


def _open_lcm(url: str | None) -> Any:
    """LCM; without a multicast route, in a private network, in which run() restarts."""
    from saddlewalk.transport import private_network
    from saddlewalk.transport.lcmbus import open_lcm

    try:
        return open_lcm(url)
    except UserError:
        if url or not private_network.possible():
            raise
        print("no multicast route: running in a private network of its own", flush=True)
        private_network.enter()


def _check_bus_is_free(bus: Any, lcm: Any) -> None:
    """Reject buses on which another walk is running. Before anything is written."""
    from saddlewalk.transport.lcmbus import receive

    heard: list[str] = []
    subscription = lcm.subscribe("SADDLEWALK_.*", lambda channel, _: heard.append(channel))
    if bus.recv(LISTEN_S) is not None:
        heard.append(str(bus.channel_info))
    receive(lcm, 0)
    lcm.unsubscribe(subscription)
    if heard:
        raise UserError(
            f"{heard[-1]} is busy with another walk: end it, or give other --can and --lcm"
        )


@contextlib.contextmanager
def _display(args: argparse.Namespace, lcm: Any) -> Iterator[Any]:
    """An observer that shows the firmware's messages: a live panel, or a line every few seconds."""
    from rich.live import Live

    from saddlewalk.commands.monitor import Listener
    from saddlewalk.emulation.exoskeleton import Observer

    if args.firmware == EMULATED:
        yield Observer()
        return
    listener = Listener()
    listener.subscribe(lcm)
    listener.line()  # imported now, so that it does not delay the walk
    on_terminal = sys.stdout.isatty()
    live = Live(listener.panel(), auto_refresh=False) if on_terminal else None

    class Display(Observer):
        due_s = time.monotonic()

        def poll(self) -> None:
            if time.monotonic() < self.due_s:
                return
            if live:
                live.update(listener.panel(), refresh=True)
            elif listener.complete:
                print(listener.line(), flush=True)
            self.due_s = time.monotonic() + (REFRESH_S if live else LINE_S)

    with live or contextlib.nullcontext():
        yield Display()


def _finish(
    folder: Path,
    wearer: "Wearer",
    exoskeleton: "Exoskeleton",
    recorder: "Recorder",
    checks: "list[Check]",
) -> int:
    """Print the result; returns 0 only if all checks passed."""
    print(summary(wearer, exoskeleton))
    print(level_times(recorder) + (", until the fall" if wearer.fallen else ""))
    timing = exoskeleton.punctuality or exoskeleton.pace
    if timing:
        print(f"timing: {timing.words()}")
    for good, words in checks:
        print(f"  {'ok ' if good else 'BAD'}  {words}")
    for path in (
        folder / name for name in (PICTURE, STRIP, FILM, TABLE, CAN_LOG, LCM_LOG, LEARNED)
    ):
        if path.exists():
            print(f"  {printable(path)}  {path.stat().st_size / 1024:.0f} KiB")
    return 0 if all(good for good, _ in checks) else 1


def _seen(wearer: "Wearer", recorder: "Recorder", recovery_steps: int) -> str:
    """The walk in a line."""
    from saddlewalk.contract import LEVELS

    worst = max(recorder.levels, key=LEVELS.index, default=LEVELS[0])
    pushes, steps = (
        _count(len(wearer.pushes), "push", "es"),
        _count(recovery_steps, "recovery step", "s"),
    )
    fate = "a fall" if wearer.fallen else "no fall"
    return f"seen: {pushes}, worst level {worst}, {steps}, {fate}"


def _count(number: int, noun: str, plural: str) -> str:
    return f"{number or 'no'} {noun}{'' if number == 1 else plural}"


def _what_next(folder: Path) -> str:
    own = "saddlewalk" if not in_checkout() else ".venv/bin/saddlewalk"
    commands = {
        f"{own} view {shlex.quote(printable(folder / LCM_LOG))}": "in the browser",
        f"{own} replay --sample healthy": "a recorded person",
        f"{own} calibrate --sample healthy": "their gait",
    }
    width = max(map(len, commands))
    lines = [f"{command:<{width}}  # {words}" for command, words in commands.items()]
    return "next: " + "\n      ".join(lines)


def level_times(recorder: "Recorder") -> str:
    """How long each level was announced, as text."""
    from saddlewalk.contract import TICK_S
    from saddlewalk.verdict import ticks_in

    ticks_by_level = ticks_in(recorder.levels).items()
    return "level: " + ", ".join(f"{name} {ticks * TICK_S:.1f} s" for name, ticks in ticks_by_level)
