"""`saddlewalk faults`: fault injection into frames, clocks and processes, and the results."""

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.config import add_body_options, load_config
from saddlewalk.errors import UserError
from saddlewalk.options import (
    JOINTS,
    MUJOCO,
    WINTER,
    add_campaign_options,
    add_plant_options,
    whole_number_in,
    workers_of,
)
from saddlewalk.outputs import add_input
from saddlewalk.progress import progress_bar

if TYPE_CHECKING:
    from saddlewalk.faults.campaign import Outcome, Row
    from saddlewalk.faults.joint_campaign import Outcome as JointOutcome
    from saddlewalk.faults.joint_campaign import Row as JointRow
    from saddlewalk.faults.scenario import Scenario
    from saddlewalk.physics.plants import PlantChoice

RUNS = 20
LIVE_RUNS = 0
FILE_WIDTH = 132


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "faults",
        help="inject faults into many walks: which are detected, and is any output unsafe?",
    )
    add_input(
        parser,
        "--scenario",
        type=Path,
        metavar="FILE",
        help="TOML with the faults, as examples/faults.toml, the default, explains",
    )
    parser.add_argument(
        "--runs",
        type=whole_number_in(1, 100_000),
        default=RUNS,
        metavar="N",
        help=f"walks in lockstep for each strength of each fault (default {RUNS})",
    )
    parser.add_argument(
        "--live",
        type=whole_number_in(0, 1000),
        default=LIVE_RUNS,
        metavar="N",
        help="walks in real time for each class, with saddlewalk-host over UDP and LCM "
        f"(default {LIVE_RUNS})",
    )
    parser.add_argument(
        "--joints",
        action="store_true",
        help="instead the faults of a device's sensors and joint commands: a body in MuJoCo on CAN",
    )
    add_campaign_options(parser)
    add_plant_options(parser)
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Exit status 1 if an output was unsafe."""
    from rich.console import Console

    from saddlewalk.faults.campaign import rows_of
    from saddlewalk.faults.scenario import read_scenario
    from saddlewalk.paths import source
    from saddlewalk.physics.plants import chosen_plant

    if args.joints:
        return _of_joints(args)
    plant = chosen_plant(args)
    if plant.is_mujoco and args.live:
        raise UserError(f"--live: walks in real time, not with --plant {args.plant}")
    config = load_config(args, body=plant.fields)
    scenario = read_scenario(args.scenario or source("examples/faults.toml"))
    console = Console(width=None if sys.stdout.isatty() else FILE_WIDTH)
    outcomes = _in_lockstep(args, scenario, config, plant)
    console.print(_table(rows_of(outcomes), "In lockstep"))
    if args.live:
        live = _live(args, scenario, config)
        console.print(_table(rows_of(live), "In real time, by saddlewalk-host"))
        outcomes += live
    console.print(_summary(outcomes, args.seed))
    return 1 if any(outcome.violations for outcome in outcomes) else 0


def _of_joints(args: argparse.Namespace) -> int:
    """Exit status 1 if an output was unsafe."""
    from rich.console import Console

    from saddlewalk.faults.joint_campaign import CLASSES, campaign, rows_of
    from saddlewalk.physics.plants import chosen_plant

    given = (("live", args.live or None), ("scenario", args.scenario), ("body", args.body))
    for option, value in given:
        if value is not None:
            raise UserError(f"--{option} {value}: not with --joints, leave it out")
    args.plant, args.body, args.drive = MUJOCO, WINTER, JOINTS
    config = load_config(args, body=chosen_plant(args).fields)
    workers = workers_of(args)
    with progress_bar("walks", args.runs * len(CLASSES)) as progress:
        outcomes = campaign(args.runs, args.seed, config, workers, progress)
    console = Console(width=None if sys.stdout.isatty() else FILE_WIDTH)
    console.print(_joint_table(rows_of(outcomes)))
    console.print(_summary(outcomes, args.seed))
    return 1 if any(outcome.violations for outcome in outcomes) else 0


def _joint_table(rows: list["JointRow"]) -> Any:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD)
    for name in ("of", "fault"):
        table.add_column(name)
    for name in (
        *("strength", "walks", "detected", "median ms", "max ms"),
        *("fallback", "max ms", "unsafe", "fell"),
    ):
        table.add_column(name, justify="right")
    for row in rows:
        table.add_row(
            *(row.what, row.kind, f"{row.strength:g}", f"{row.walks}", f"{row.detected}"),
            *(_milliseconds(row.detected_ms), _milliseconds(row.detected_max_ms)),
            *(f"{row.fallbacks}", _milliseconds(row.fallback_max_ms)),
            *(f"{row.unsafe}", f"{row.fell}"),
        )
    return table


def _milliseconds(value: float) -> str:
    return f"{value:.0f}" if math.isfinite(value) else "-"


def _in_lockstep(
    args: argparse.Namespace, scenario: "Scenario", config: Any, plant: "PlantChoice"
) -> list["Outcome"]:
    from saddlewalk.faults.campaign import campaign

    workers = workers_of(args)
    with progress_bar("walks", args.runs * len(scenario.faults)) as progress:
        return campaign(scenario, args.runs, args.seed, config, workers, progress, plant)


def _live(args: argparse.Namespace, scenario: "Scenario", config: Any) -> list["Outcome"]:
    from saddlewalk.faults.live import live_campaign, live_walks

    total = len(live_walks(scenario, args.live))
    with progress_bar("walks in real time", total) as progress:
        return live_campaign(scenario, args.live, args.seed, config, progress)


def _table(rows: list["Row"], title: str) -> Any:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD)
    table.add_column("fault")
    for name in ("strength", "walks", "detected", "median", "max ticks"):
        table.add_column(name, justify="right")
    table.add_column("state reached")
    for name in ("unsafe", "blind", "forged", "fell"):
        table.add_column(name, justify="right")
    for row in rows:
        table.add_row(
            _name(row),
            f"{row.fault.strength:g}",
            f"{row.runs}",
            f"{row.detected}",
            _number(row.median_ticks),
            _number(row.max_ticks),
            ", ".join(f"{state} {count}" for state, count in row.states.items()),
            f"{row.unsafe}",
            "-" if row.live else f"{row.blind}",
            "-" if row.live else f"{row.forged}",
            f"{row.fell}",
        )
    return table


def _name(row: "Row") -> str:
    """The class, and its messages if the scenario names them."""
    from saddlewalk.faults.scenario import KINDS

    fault = row.fault
    if not fault.messages or fault.messages == KINDS[fault.kind].messages:
        return fault.kind
    names = (name.removeprefix("MEASURED_").lower() for name in fault.messages)
    return f"{fault.kind} {' '.join(names)}"


def _number(value: float) -> str:
    return f"{value:g}" if math.isfinite(value) else "-"


def _summary(outcomes: "Sequence[Outcome | JointOutcome]", seed: int) -> str:
    from collections import Counter

    unsafe = [outcome for outcome in outcomes if outcome.violations]
    violations = Counter(violation for outcome in unsafe for violation in outcome.violations)
    words = ", ".join(f"{violation} {count}" for violation, count in violations.items())
    detail = f": {words}" if words else ""
    return f"{len(outcomes)} walks, seed {seed}: {len(unsafe)} with an unsafe output{detail}"
