"""`saddlewalk endure`: many walks from standing to standing, and whether they end so."""

import argparse
import math
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.config import add_body_options, load_config
from saddlewalk.errors import UserError
from saddlewalk.json_text import json_text
from saddlewalk.options import (
    JOINTS,
    MUJOCO,
    WINTER,
    add_campaign_options,
    add_plant_options,
    list_of,
    number_in,
    speed,
    whole_number_in,
    workers_of,
)
from saddlewalk.outputs import OutputFolder, add_input, add_output
from saddlewalk.printable import printable
from saddlewalk.progress import progress_bar

if TYPE_CHECKING:
    from saddlewalk.evaluation.endurance import Course, Outcome
    from saddlewalk.physics.plants import PlantChoice
    from saddlewalk.planning.schedule import Speeds

SPEEDS_M_S = (0.3, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6)
DISTANCE_M, REPEATS = 15.0, 5
FILE_WIDTH = 140
FILES = ("endurance.json", "endurance.csv")


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "endure", help="many walks from standing to standing: do they end standing, how steadily?"
    )
    parser.add_argument(
        "--speeds",
        type=list_of(speed),
        default=SPEEDS_M_S,
        metavar="M/S,...",
        help=f"default {','.join(map(str, SPEEDS_M_S))}",
    )
    how = parser.add_mutually_exclusive_group()
    how.add_argument(
        "--distance",
        type=number_in(1, 100_000, "m"),
        default=DISTANCE_M,
        metavar="M",
        help=f"of each walk (default {DISTANCE_M:g})",
    )
    how.add_argument(
        "--stops",
        type=whole_number_in(1, 10_000),
        metavar="N",
        help="instead stop N walks, by turns at the speeds, at N phases of their steps",
    )
    add_input(
        how,
        "--schedules",
        nargs="+",
        metavar="FILE",
        help="instead follow these schedules, as of plan --schedule, which end with a speed of 0",
    )
    parser.add_argument(
        "--repeats",
        type=whole_number_in(1, 10_000),
        default=REPEATS,
        metavar="N",
        help=f"seeds at each speed or schedule (default {REPEATS})",
    )
    parser.add_argument(
        "--heights",
        type=list_of(number_in(0.5, 2.5, "m")),
        metavar="M,...",
        help=f"body heights, of the body {WINTER} (default: that of the configuration)",
    )
    for what in ("sensor", "torque"):
        parser.add_argument(
            f"--{what}-delays",
            type=list_of(number_in(0, 200, "ms")),
            default=(0.0,),
            metavar="MS,...",
            help=f"delays of the {what}s, with --plant {MUJOCO} (default 0)"
            + (f"; of the joint commands with --drive {JOINTS}" if what == "torque" else ""),
        )
    parser.add_argument(
        "--mass-error",
        type=number_in(-20, 20, "%"),
        metavar="%",
        help=f"with --drive {JOINTS}: it takes the body for so much heavier than it is",
    )
    parser.add_argument(
        "--leg-error",
        type=number_in(-50, 50, "mm"),
        metavar="MM",
        help=f"with --drive {JOINTS}: it takes the legs for so much longer than they are",
    )
    add_plant_options(parser, default=MUJOCO)
    add_campaign_options(parser)
    add_output(
        parser,
        "--out",
        output=OutputFolder(FILES),
        type=Path,
        metavar="FOLDER",
        help=f"for {' and '.join(FILES)}",
    )
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """1: a walk ended in a fall, or not standing."""
    from rich.console import Console

    from saddlewalk.evaluation.endurance import endure, figures, grouped, peaks_of
    from saddlewalk.physics.plants import chosen_plant
    from saddlewalk.workers import identity

    plant = chosen_plant(args)
    _check(args, plant)
    plant = replace(
        plant,
        mass_error=(args.mass_error or 0.0) / 100,
        leg_error_m=(args.leg_error or 0.0) / 1000,
    )
    config = load_config(args, body=plant.fields)
    courses = _courses(args, config)
    with progress_bar("walks", len(courses)) as progress:
        outcomes = endure(courses, plant, config, workers_of(args), progress)
    console = Console(width=None if sys.stdout.isatty() else FILE_WIDTH)
    console.print(f"saddlewalk {identity()}")
    groups = list(grouped(outcomes))
    console.print(_table(groups, f"{plant.body or 'point mass'}, seed {args.seed}"))
    if peaks := peaks_of(outcomes):
        console.print(_peaks_table(peaks))
    total = figures(outcomes)
    console.print(
        f"{total['walks']} walks, {total['distance_m']:.0f} m: {total['falls']} falls, "
        f"{total['standing']} stand at the end; {total['stable_pct']:.2f} % of the ticks stable"
    )
    if args.out:
        _write(args.out, groups, outcomes)
        for name in FILES:
            console.print(f"  {printable(args.out / name)}", markup=False)
    return 0 if total["standing"] == total["walks"] else 1


def _check(args: argparse.Namespace, plant: "PlantChoice") -> None:
    if args.heights and plant.body not in (None, WINTER):
        raise UserError(f"--heights: the body {plant.body} has its own, leave it out")
    if args.heights and args.height is not None:
        raise UserError("--height and --heights: give one of them")
    delayed = next((what for what in ("sensor", "torque") if any(_delays(args, what))), None)
    if delayed and not plant.is_mujoco:
        raise UserError(f"--{delayed}-delays: only with --plant {MUJOCO}")
    for option in ("mass_error", "leg_error"):
        if getattr(args, option) is not None and not plant.drives_joints:
            raise UserError(f"--{option.replace('_', '-')}: only with --drive {JOINTS}")
    if any(_delays(args, "sensor")) and plant.drives_joints:
        raise UserError(f"--sensor-delays: not with --drive {JOINTS}, which has its own sensors")


def _delays(args: argparse.Namespace, what: str) -> list[float]:
    return [delay_ms / 1000 for delay_ms in getattr(args, f"{what}_delays")]


def _courses(args: argparse.Namespace, config: Any) -> list["Course"]:
    from saddlewalk.evaluation.endurance import (
        Course,
        by_schedule,
        over_distance,
        stopped_anywhere,
    )

    bases = [
        Course(0.0, height_m, args.seed, 0.0, sensor_s, torque_s)
        for height_m in args.heights or (round(config.body_height_m, 6),)
        for sensor_s in _delays(args, "sensor")
        for torque_s in _delays(args, "torque")
    ]
    if args.stops:
        return [each for base in bases for each in stopped_anywhere(args.stops, args.speeds, base)]
    if args.schedules:
        schedules = [(Path(file).stem, _speeds_of(args, file)) for file in args.schedules]
        return [
            each
            for base in bases
            for name, speeds in schedules
            for each in by_schedule(name, speeds, args.repeats, base)
        ]
    return [
        each
        for base in bases
        for each in over_distance(args.distance, args.speeds, args.repeats, base)
    ]


def _speeds_of(args: argparse.Namespace, file: str) -> "Speeds":
    """Of a schedule that ends with a stop."""
    from saddlewalk.planning.schedule import check_straight, read_schedule, speeds_of

    changes = read_schedule(file)
    last = changes[-1]
    if last.speed_m_s != 0:
        raise UserError(f"{file}: line {last.line}, speed_m_s: the last one must be 0, a stop")
    if args.drive == JOINTS:
        check_straight(file, changes, f"--drive {JOINTS}")
    return speeds_of(changes)


COLUMNS: dict[str, Callable[[dict[str, Any]], str]] = {
    "m/s": lambda row: row["schedule"] or f"{row['asked_m_s']:g}",
    "height m": lambda row: f"{row['height_m']:.2f}",
    "delays ms": lambda row: f"{1e3 * row['sensor_delay_s']:g}, {1e3 * row['torque_delay_s']:g}",
    "walks": lambda row: f"{row['walks']}",
    "falls": lambda row: f"{row['falls']}",
    "stand": lambda row: f"{row['standing']}",
    "speed": lambda row: _number(row["speed_m_s"], 3),
    "XCoM along mm": lambda row: _number(1e3 * row["xcom_sd_x_m"], 1),
    "across": lambda row: _number(1e3 * row["xcom_sd_y_m"], 1),
    "stable %": lambda row: _number(row["stable_pct"], 2),
    "unstable": lambda row: _number(row["unstable_pct"], 2),
    "unsolved %": lambda row: _number(row["unsolved_pct"], 2),
}


def _table(groups: list[dict[str, Any]], title: str) -> Any:
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for name in COLUMNS:
        table.add_column(name, justify="right")
    for row in groups:
        table.add_row(*(cell(row) for cell in COLUMNS.values()))
    return table


def _peaks_table(peaks: dict[str, tuple[float, ...]]) -> Any:
    from rich.table import Table

    table = Table(title="greatest, of the walks that stayed up", title_justify="left")
    for name in ("joint", "N m", "W", "rad/s"):
        table.add_column(name, justify="right")
    for joint, (torque_nm, power_w, speed_rad_s) in peaks.items():
        table.add_row(joint, f"{torque_nm:.0f}", f"{power_w:.0f}", f"{speed_rad_s:.1f}")
    return table


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"


def _write(folder: Path, groups: list[dict[str, Any]], outcomes: list["Outcome"]) -> None:
    from saddlewalk.atomic_write import atomic_folder
    from saddlewalk.table import write_table

    rows = [outcome.row() for outcome in outcomes]
    with atomic_folder("--out", folder, FILES) as new:
        (new / FILES[0]).write_text(json_text({"groups": groups, "walks": rows}))
        write_table(str(new / FILES[1]), list(rows[0]), (list(row.values()) for row in rows))
