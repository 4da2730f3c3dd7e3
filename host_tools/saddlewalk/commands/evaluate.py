"""`saddlewalk evaluate`: how well the supervisor predicts falls, and whether its claims hold."""

import argparse
import functools
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.atomic_write import write_text
from saddlewalk.config import add_body_options, given_fields, load_config
from saddlewalk.json_text import json_text
from saddlewalk.options import (
    add_campaign_options,
    add_plant_options,
    number_in,
    speed_range,
    whole_number_in,
    workers_of,
)
from saddlewalk.outputs import OutputFolder, add_input, add_output
from saddlewalk.printable import printable
from saddlewalk.progress import progress_bar

if TYPE_CHECKING:
    from rich.console import Console

    from saddlewalk.evaluation.cross_validation import CrossValidation
    from saddlewalk.evaluation.detection import Detection
    from saddlewalk.evaluation.gait_trials import GaitTrial
    from saddlewalk.evaluation.recorded_falls import Scored as ScoredWalk
    from saddlewalk.evaluation.scoring import Score
    from saddlewalk.evaluation.walks import Setting, Walk

WALKS = 1000
KINDS_DRAWN = ("misses", "false-alarms")
DRAWN = 10  # number of misses and of false alarms that are drawn
EMULATED_FILES = ("evaluation.json", "walks.csv", "roc.png", "region.png")
FALLS_FILES = ("falls.csv", "falls-roc.png")
RELIABILITY = "reliability.png"
DRAWINGS = {kind: [f"{kind}/{k + 1:02}.png" for k in range(DRAWN)] for kind in KINDS_DRAWN}
FILES = (
    "scores.json",
    RELIABILITY,
    *EMULATED_FILES,
    *FALLS_FILES,
    *itertools.chain(*DRAWINGS.values()),
)
Figures = Mapping[str, Any]
Writer = Callable[[Path], Iterable[str]]  # writes to a new folder; yields file names with captions


@dataclass(frozen=True)
class Part:
    """Some walkers by name: their figures, their scores for exact inputs, and a writer of files."""

    figures: dict[str, Figures]
    scores: dict[str, Sequence["Score"]]
    write: Writer


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "evaluate", help="detection rate, false alarms and lead time over many emulated walks"
    )
    parser.add_argument(
        "--walks",
        type=whole_number_in(1, 100_000),
        metavar="N",
        help=f"pushed walks of each kind of emulated wearer (default {WALKS}; with --falls none)",
    )
    parser.add_argument(
        "--speeds",
        type=speed_range,
        default="0.5:1.6",
        metavar="LOW:HIGH",
        help="of the emulated walks, m/s (default 0.5:1.6)",
    )
    parser.add_argument(
        "--delay",
        type=number_in(0.0, 0.2, "s"),
        default=0.0,
        metavar="S",
        help="how late the emulated wearer's measurements arrive: sensor_latency_s of it, and the "
        "rest as their age (default 0)",
    )
    parser.add_argument(
        "--turn",
        type=number_in(0.0, 1.0, "rad/s"),
        default=0.0,
        metavar="RAD/S",
        help="turning rate of the emulated walks, half of them to the left, as far as their speeds "
        "bear it (default 0)",
    )
    add_campaign_options(parser)
    add_plant_options(parser)
    add_input(
        parser,
        "--falls",
        type=Path,
        metavar="FOLDER",
        help="recorded falls: walkers.csv, walks.csv, states/WALKER.csv.gz. Each walker has its "
        "own mass and height, unless --config, --mass or --height give them",
    )
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
        help=f"for scores.json; of emulated wearers {', '.join(EMULATED_FILES)}; of --falls "
        f"{', '.join(FALLS_FILES)}, and a plot of each of the worst misses and false alarms",
    )
    add_output(
        parser,
        "--json",
        metavar="FILE",
        help="all figures as JSON; - for standard output",
    )
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from rich.console import Console

    from saddlewalk.evaluation.cross_validation import leave_one_out, table
    from saddlewalk.evaluation.gait_trials import score_folder
    from saddlewalk.evaluation.walks import Setting
    from saddlewalk.physics.plants import chosen_plant

    console = Console(stderr=args.json == "-")
    plant = chosen_plant(args)
    config = load_config(args, body=plant.fields)
    trials = score_folder(args.gait, config) if args.gait else []
    parts = []
    if args.walks or not args.falls:
        parts.append(
            _emulate(
                console, args, Setting(plant, args.speeds, args.delay, args.turn), config, trials
            )
        )
    if args.falls:
        parts.append(_score_falls(args))
    results = {name: figures for part in parts for name, figures in part.figures.items()}
    if trials:
        results |= _print_trials(console, trials)
    _print_side_by_side(console, results)
    found = leave_one_out({name: each for part in parts for name, each in part.scores.items()})
    if found:
        console.print(table(found))
    text = json_text(
        {name: {**each, **_cross_validation(found.get(name))} for name, each in results.items()}
    )
    if args.json:
        write_text("--json", args.json, text)
    if args.out:
        writers = [part.write for part in parts]
        _write(console, args.out, [*writers, functools.partial(_write_scores, text, found)])
    return 0


def _cross_validation(found: "CrossValidation | None") -> dict[str, Any]:
    return {"cross_validation": asdict(found)} if found else {}


def _emulate(
    console: "Console",
    args: argparse.Namespace,
    setting: "Setting",
    config: Any,
    trials: Sequence["GaitTrial"],
) -> Part:
    """Run the walks and print the results of the emulated wearer, by kind."""
    from saddlewalk.evaluation.detection import detection_of, push_limits, recovery_benefit
    from saddlewalk.evaluation.region import CLAIMS, POSTURES, explore, grid
    from saddlewalk.evaluation.side_by_side import walker_figures
    from saddlewalk.evaluation.walks import KINDS
    from saddlewalk.workers import identity

    count = args.walks or WALKS
    console.print(
        f"saddlewalk {identity()}: seed {args.seed}, {count} pushed walks of each kind, "
        f"{workers_of(args)}"
    )
    walks = _walk(args, count, setting, config)
    by_kind = {kind: [walk for walk in walks if walk.trial.kind == kind] for kind in KINDS}
    detections = {kind: detection_of(by_kind[kind]) for kind in KINDS}
    benefit, limits = recovery_benefit(walks), push_limits(walks)
    regions = [explore(posture, grid(), config) for posture in POSTURES]
    confusions = {
        region.posture.name: {claim: region.confusion(claim) for claim in CLAIMS}
        for region in regions
    }
    _print_detection(console, detections)
    _print_areas(console, detections)
    _print_limits(console, limits, benefit, setting.speeds_m_s)
    _print_confusions(console, confusions)
    result = {
        "seed": args.seed,
        "walks": count,
        "detection": {
            kind: {**asdict(found), "alarm_share": found.alarm_share}
            for kind, found in detections.items()
        },
        "recovery_benefit": benefit,
        "push_limits_n_s": limits,
        "region": confusions,
        "gait": [asdict(trial) for trial in trials],
    }
    given = {name: str(value) for name, value in given_fields(args).items()}
    name = setting.plant.body or "emulated"
    scores = {f"{name}_{kind}": _scores_by_inputs(by_kind[kind]) for kind in KINDS}
    return Part(
        {name: walker_figures(each, given) for name, each in scores.items()},
        {name: each["exact"] for name, each in scores.items() if "exact" in each},
        functools.partial(_write_emulated, result, walks, config),
    )


def _scores_by_inputs(walks: Sequence["Walk"]) -> dict[str, list["Score"]]:
    from saddlewalk.evaluation.scoring import INPUTS

    given = [name for name in INPUTS if name in walks[0].scores]
    return {name: [part for walk in walks for part in walk.scores[name]] for name in given}


def _score_falls(args: argparse.Namespace) -> Part:
    """Every recorded walk, by walker."""
    from saddlewalk.evaluation.recorded_falls import read_walkers, read_walks, score_walks
    from saddlewalk.evaluation.scoring import INPUTS
    from saddlewalk.evaluation.side_by_side import walker_figures

    given = {name: str(value) for name, value in given_fields(args).items()}
    walkers = read_walkers(args.falls)
    configs = {
        walker.name: load_config(args, body={key: float(text) for key, text in walker.body.items()})
        for walker in walkers
    }
    walks = read_walks(args.falls, walkers)
    tasks = [(walk, configs[name]) for name, each in walks.items() for walk in each]
    with progress_bar("recorded walks", len(tasks)) as done:
        scored = iter(score_walks(tasks, args.seed, workers_of(args), done))
    by_walker = {name: list(itertools.islice(scored, len(each))) for name, each in walks.items()}
    scores = {
        name: {inputs: [walk.scores[inputs] for walk in each] for inputs in INPUTS}
        for name, each in by_walker.items()
    }
    return Part(
        {
            walker.name: walker_figures(scores[walker.name], walker.body | given)
            for walker in walkers
        },
        {name: each["exact"] for name, each in scores.items()},
        functools.partial(_write_falls, by_walker),
    )


def _walk(args: argparse.Namespace, count: int, setting: "Setting", config: Any) -> list["Walk"]:
    from saddlewalk.evaluation.walks import KINDS, calm_walks, evaluate

    total = len(KINDS) * (count + calm_walks(count))
    with progress_bar("walks", total) as done:
        return evaluate(args.seed, count, config, workers_of(args), done, setting)


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


def _print_detection(console: "Console", detections: dict[str, "Detection"]) -> None:
    table = _table("Predicted falls", "the wearer takes", *(f"{kind} steps" for kind in detections))
    rows = {
        "pushed walks": lambda d: f"{d.pushed}",
        "falls": lambda d: f"{d.fallen}",
        "sensitivity: falls with an alarm before": lambda d: _percent(d.sensitivity),
        "... at least 0.24 s before": lambda d: _percent(d.timely),
        "lead time, median": lambda d: f"{_number(d.lead_median_s, 2)} s",
        "lead time, 10th percentile": lambda d: f"{_number(d.lead_tenth_s, 2)} s",
        "alarms in walks without a fall": lambda d: _percent(d.false_alarms),
        "false alarms: of unperturbed steady walking": lambda d: f"{100 * d.alarm_share:.2f} %",
        "... starts and stops included": lambda d: f"{100 * d.moving_alarm_share:.2f} %",
        "falls without a push": lambda d: f"{d.calm_falls}",
    }
    for name, cell in rows.items():
        table.add_row(name, *map(cell, detections.values()))
    console.print(table)


def _print_areas(console: "Console", detections: dict[str, "Detection"]) -> None:
    from saddlewalk.evaluation.walks import MARGINS, WINDOWS

    for kind, detection in detections.items():
        table = _table(
            f"Area under the ROC, {kind} steps; evidence after the push", "least", *WINDOWS
        )
        for name in MARGINS:
            table.add_row(name, *(_number(detection.areas[window][name], 3) for window in WINDOWS))
        console.print(table)


def _print_limits(
    console: "Console",
    limits: dict[str, dict[int, float]],
    benefit: dict[str, float],
    speeds_m_s: tuple[float, float],
) -> None:
    from saddlewalk.evaluation.walks import DIRECTIONS, SPEED_BINS

    low, high = speeds_m_s
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
        f"Of {benefit['pushes']} uniformly random pushes, "
        f"{_percent(benefit['both_survive'])} are survived by both kinds of wearer, "
        f"{_percent(benefit['both_fall'])} by neither, "
        f"{_percent(benefit['recovery_alone_survives'])} only with the recovery step, "
        f"{_percent(benefit['planned_alone_survives'])} only with the planned steps."
    )


def _print_confusions(console: "Console", confusions: dict[str, dict[str, dict[str, int]]]) -> None:
    from saddlewalk.evaluation.region import CLAIMS

    names = ("true_safe", "false_safe", "false_unsafe", "true_unsafe")
    columns = [name.replace("_", " ") for name in names]
    for posture, claims in confusions.items():
        table = _table(
            f"States that can be brought to rest: {posture}", "criterion for safe", *columns
        )
        for claim, counts in claims.items():
            table.add_row(CLAIMS[claim], *(str(counts[name]) for name in names))
        console.print(table)


def _print_trials(console: "Console", trials: Sequence["GaitTrial"]) -> dict[str, Figures]:
    from saddlewalk.evaluation.side_by_side import PEOPLE, people_figures

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
    return {PEOPLE: people_figures(trials)}


def _print_side_by_side(console: "Console", results: dict[str, Figures]) -> None:
    from saddlewalk.evaluation.scoring import INPUTS
    from saddlewalk.evaluation.side_by_side import tables

    for inputs in INPUTS:
        for table in tables(results, inputs):
            console.print(table)


def _write(console: "Console", folder: Path, writers: Sequence[Writer]) -> None:
    from saddlewalk.atomic_write import atomic_folder

    with atomic_folder("--out", folder, FILES) as new:
        lines = [line for writer in writers for line in writer(new)]
    for line in lines:
        console.print(f"  {printable(folder / line)}", markup=False)


def _write_scores(text: str, found: dict[str, "CrossValidation"], new: Path) -> Iterator[str]:
    from saddlewalk.evaluation.pictures import draw_reliability

    (new / "scores.json").write_text(text)
    yield "scores.json"
    if found:
        draw_reliability(found, new / RELIABILITY)
        yield RELIABILITY


def _write_emulated(
    result: dict[str, Any], walks: list["Walk"], config: Any, new: Path
) -> Iterator[str]:
    from saddlewalk.evaluation.pictures import draw_region, draw_rocs
    from saddlewalk.table import write_table

    rows = [walk.row() for walk in walks]
    write_table(str(new / "walks.csv"), list(rows[0]), (list(row.values()) for row in rows))
    (new / "evaluation.json").write_text(json_text(result))
    draw_rocs(walks, new / "roc.png")
    draw_region(config, new / "region.png")
    yield from EMULATED_FILES


def _write_falls(by_walker: dict[str, list["ScoredWalk"]], new: Path) -> Iterator[str]:
    from saddlewalk.evaluation.fall_pictures import (
        draw_rocs,
        draw_walk,
        title_of,
        worst_false_alarms,
        worst_misses,
    )
    from saddlewalk.table import write_table

    exact = {name: [each.scores["exact"] for each in walks] for name, walks in by_walker.items()}
    rows = [{"walker": name, **each.row()} for name, scores in exact.items() for each in scores]
    write_table(str(new / "falls.csv"), list(rows[0]), (list(row.values()) for row in rows))
    draw_rocs(exact, new / "falls-roc.png")
    yield from FALLS_FILES
    for kind, worst in zip(KINDS_DRAWN, (worst_misses, worst_false_alarms), strict=True):
        (new / kind).mkdir()
        walks = _interleaved([worst(walks) for walks in by_walker.values()])
        for name, walk in zip(DRAWINGS[kind], walks, strict=False):
            draw_walk(walk, new / name)
            yield f"{name}  {title_of(walk)}"


def _interleaved(lists: Sequence[Sequence[Any]]) -> Iterator[Any]:
    """The first of each, then the second of each, and so on."""
    nothing = object()
    turns = itertools.chain.from_iterable(itertools.zip_longest(*lists, fillvalue=nothing))
    return (each for each in turns if each is not nothing)
