"""`saddlewalk evaluate`: how well the supervisor foretells falls, and what its claims are worth."""

import argparse
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.config import add_body_options, load_config
from saddlewalk.options import add_campaign_options, whole_number_in
from saddlewalk.outputs import OutputFolder, add_input, add_output

if TYPE_CHECKING:
    from rich.console import Console

    from saddlewalk.evaluation.detection import Detection
    from saddlewalk.evaluation.gait_trials import GaitTrial
    from saddlewalk.evaluation.walks import Walk

WALKS = 1000
FILES = ("evaluation.json", "walks.csv", "roc.png", "region.png")


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "evaluate", help="detection rate, false alarms and lead time over many emulated walks"
    )
    parser.add_argument(
        "--walks",
        type=whole_number_in(1, 100_000),
        default=WALKS,
        metavar="N",
        help=f"pushed walks of each kind of wearer (default {WALKS})",
    )
    add_campaign_options(parser)
    add_input(
        parser,
        "--gait",
        type=Path,
        metavar="FOLDER",
        help="recorded trials of people who did not fall, CSV as for replay",
    )
    add_output(
        parser,
        "--out",
        output=OutputFolder(FILES),
        type=Path,
        metavar="FOLDER",
        help=f"for {', '.join(FILES)}",
    )
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from rich.console import Console

    from saddlewalk.evaluation.detection import detection_of, push_limits, recovery_worth
    from saddlewalk.evaluation.gait_trials import judge_folder
    from saddlewalk.evaluation.region import CLAIMS, POSTURES, explore, grid
    from saddlewalk.evaluation.walks import KINDS

    config = load_config(args)
    console = Console()
    console.print(f"seed {args.seed}, {args.walks} pushed walks of each kind, {args.jobs} jobs")
    trials = judge_folder(args.gait, config) if args.gait else []
    walks = _walk(args, config)
    detections = {
        kind: detection_of(walk for walk in walks if walk.trial.kind == kind) for kind in KINDS
    }
    worth, limits = recovery_worth(walks), push_limits(walks)
    regions = [explore(posture, grid(), config) for posture in POSTURES]
    confusions = {
        region.posture.name: {claim: region.confusion(claim) for claim in CLAIMS}
        for region in regions
    }
    _tell_detection(console, detections)
    _tell_areas(console, detections)
    _tell_limits(console, limits, worth)
    _tell_confusions(console, confusions)
    if trials:
        _tell_trials(console, trials)
    if args.out:
        result = {
            "seed": args.seed,
            "walks": args.walks,
            "detection": {
                kind: {**asdict(found), "alarm_share": found.alarm_share}
                for kind, found in detections.items()
            },
            "recovery_worth": worth,
            "push_limits_n_s": limits,
            "region": confusions,
            "gait": [asdict(trial) for trial in trials],
        }
        _write(console, args.out, result, walks, config)
    return 0


def _walk(args: argparse.Namespace, config: Any) -> list["Walk"]:
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress, TimeRemainingColumn

    from saddlewalk.evaluation.walks import KINDS, calm_walks, evaluate

    columns = (*Progress.get_default_columns()[:2], MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        total = len(KINDS) * (args.walks + calm_walks(args.walks))
        task = bar.add_task("walks", total=total)
        return evaluate(
            args.seed, args.walks, config, args.jobs, lambda done: bar.update(task, completed=done)
        )


def _table(title: str, *columns: str) -> Any:
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index == 0 else "right")
    return table


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if math.isfinite(share) else "-"


def _tell_detection(console: "Console", detections: dict[str, "Detection"]) -> None:
    table = _table("Falls foretold", "the wearer takes", *(f"{kind} steps" for kind in detections))
    rows = {
        "pushed walks": lambda d: f"{d.pushed}",
        "falls": lambda d: f"{d.fallen}",
        "sensitivity: falls with an alarm before": lambda d: _percent(d.sensitivity),
        "... at least 0.24 s before": lambda d: _percent(d.timely),
        "lead time, median": lambda d: f"{_number(d.lead_median_s, 2)} s",
        "lead time, 10th percentile": lambda d: f"{_number(d.lead_tenth_s, 2)} s",
        "alarms among those who stayed up": lambda d: _percent(d.false_alarms),
        "false alarms: of unperturbed steady walking": lambda d: f"{100 * d.alarm_share:.2f} %",
        "... starts and stops included": lambda d: f"{100 * d.moving_alarm_share:.2f} %",
        "falls without a push": lambda d: f"{d.calm_falls}",
    }
    for name, cell in rows.items():
        table.add_row(name, *map(cell, detections.values()))
    console.print(table)


def _tell_areas(console: "Console", detections: dict[str, "Detection"]) -> None:
    from saddlewalk.evaluation.walks import MARGINS, WINDOWS

    for kind, detection in detections.items():
        table = _table(
            f"Area under the ROC, {kind} steps; evidence after the push", "least", *WINDOWS
        )
        for name in MARGINS:
            table.add_row(name, *(_number(detection.areas[window][name], 3) for window in WINDOWS))
        console.print(table)


def _tell_limits(
    console: "Console", limits: dict[str, dict[int, float]], worth: dict[str, float]
) -> None:
    from saddlewalk.evaluation.walks import DIRECTIONS, SPEED_BINS, SPEEDS_M_S

    low, high = SPEEDS_M_S
    for kind, cells in limits.items():
        table = _table(f"Push that half survive, {kind} steps, N s", "m/s", *DIRECTIONS)
        for bin_ in range(SPEED_BINS):
            ends = (low + (high - low) * k / SPEED_BINS for k in (bin_, bin_ + 1))
            row = (cells.get(bin_ * len(DIRECTIONS) + k, math.nan) for k in range(len(DIRECTIONS)))
            table.add_row(
                "-".join(f"{end:.2f}" for end in ends), *(_number(limit, 0) for limit in row)
            )
        console.print(table)
    console.print(
        f"The recovery step saves {_percent(worth['recovery_alone_survives'])} of "
        f"{worth['pushes']} pushes drawn without regard to a limit: both kinds survive "
        f"{_percent(worth['both_survive'])}, both fall to {_percent(worth['both_fall'])}, on the "
        f"planned steps alone {_percent(worth['planned_alone_survives'])} are survived."
    )


def _tell_confusions(console: "Console", confusions: dict[str, dict[str, dict[str, int]]]) -> None:
    from saddlewalk.evaluation.region import CLAIMS

    names = ("rightly_safe", "wrongly_safe", "cautious", "rightly_unsafe")
    columns = [name.replace("_", " ") for name in names]
    for posture, claims in confusions.items():
        table = _table(f"States that can be brought to rest: {posture}", "said safe if", *columns)
        for claim, counts in claims.items():
            table.add_row(CLAIMS[claim], *(str(counts[name]) for name in names))
        console.print(table)


def _tell_trials(console: "Console", trials: Sequence["GaitTrial"]) -> None:
    levels = list(trials[0].levels)
    table = _table("Recorded people who did not fall, ticks", "trial", "m/s", *levels, "because")
    for trial in trials:
        reasons = ", ".join(f"{name} {count}" for name, count in trial.reasons.items())
        counts = (str(trial.levels[level]) for level in levels)
        table.add_row(trial.name, f"{trial.speed_m_s:.2f}", *counts, reasons)
    totals = [sum(trial.levels[level] for trial in trials) for level in levels]
    shares = (_percent(total / max(sum(totals), 1)) for total in totals)
    table.add_row("all", "", *shares, "")
    console.print(table)


def _write(
    console: "Console", folder: Path, result: dict[str, Any], walks: list["Walk"], config: Any
) -> None:
    from saddlewalk.atomic_write import whole_folder
    from saddlewalk.evaluation.pictures import draw_region, draw_rocs
    from saddlewalk.table import write_table

    rows = [walk.row() for walk in walks]
    with whole_folder("--out", folder, FILES) as new:
        write_table(str(new / "walks.csv"), list(rows[0]), (list(row.values()) for row in rows))
        text = json.dumps(_without_nan(result), indent=1)
        (new / "evaluation.json").write_text(text + "\n")
        draw_rocs(walks, new / "roc.png")
        draw_region(config, new / "region.png")
    for name in FILES:
        console.print(f"  {folder / name}")


def _without_nan(value: Any) -> Any:
    """What is not known is null: JSON has no NaN."""
    if isinstance(value, dict):
        return {key: _without_nan(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_without_nan(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
