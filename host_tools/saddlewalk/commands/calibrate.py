"""`saddlewalk calibrate`: a person's gait model from recorded walks."""

import argparse
import math
import sys
from typing import TYPE_CHECKING, Any

from saddlewalk.errors import UserError
from saddlewalk.options import add_recordings, number_in
from saddlewalk.outputs import add_output

if TYPE_CHECKING:
    import numpy as np

    from saddlewalk.gait.fit import Fit
    from saddlewalk.gait.measures import WalkMeasures


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "calibrate",
        help="fit the gait model to a person's recorded walks",
        description="Fit the gait model to one person's recorded walks, each at a steady speed. "
        "With speeds that differ by 0.2 m/s or more the regressions are the person's; with one "
        "speed the paper's slopes are kept.",
    )
    add_recordings(parser)
    parser.add_argument(
        "--height",
        type=number_in(0.7, 2.5, "m"),
        metavar="M",
        help="body height, m (default: from the height of the CoM)",
    )
    parser.add_argument(
        "--mass", type=number_in(5, 300, "kg"), metavar="KG", help="body mass, kg (default 63.3)"
    )
    add_output(
        parser,
        "--out",
        default="-",
        metavar="FILE",
        help="the gait model as TOML, for --config (default: standard output)",
    )
    add_output(
        parser, "--header", metavar="FILE", help="the gait model as a C header, for firmware"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from rich.console import Console

    from saddlewalk.atomic_write import write_text
    from saddlewalk.gait.calibration import calibrate, checked
    from saddlewalk.gait.measures import measure
    from saddlewalk.gait.person_file import header_text, toml_text
    from saddlewalk.gait.ripple import learned_ripple
    from saddlewalk.gait.samples import recorded_walks

    for source in args.recordings:
        if args.recordings.count(source) > 1:
            raise UserError(f"{source} is given twice: its steps would count twice")
    recordings = recorded_walks(args.recordings, args.sample, args.markers)
    walks = [measure(recording) for recording in recordings]
    ripples = [learned_ripple(recording) for recording in recordings]
    fits = calibrate(walks, args.height, args.mass, ripples)
    config = checked(fits)
    sources = [walk.source for walk in walks]
    write_text("--out", args.out, toml_text(fits, sources))
    if args.header:
        write_text("--header", args.header, header_text(fits, sources, args.header))
    console = Console(file=sys.stderr if "-" in (args.out, args.header) else sys.stdout)
    console.print(_walk_table(walks))
    console.print(_fit_table(fits))
    for line in (*_missing_quantities(walks), *_too_fast(walks, config)):
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    return 0


def _walk_table(walks: "list[WalkMeasures]") -> Any:
    from rich.box import SIMPLE
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=SIMPLE, title="Measured: speed in m/s; mean ± deviation of the steps in mm")
    table.add_column("recording", overflow="fold")
    for name in ("speed", "steps", "length", "width", "vertical", "lateral"):
        table.add_column(name, justify="right", no_wrap=True)
    for walk in walks:
        per_step = (walk.length_m, walk.width_m, walk.vertical_m, walk.lateral_m)
        table.add_row(
            escape(walk.source),
            f"{walk.speed_m_s:.3f}",
            str(len(walk.length_m)),
            *(_mean_and_deviation(values) for values in per_step),
        )
    return table


def _fit_table(fits: "list[Fit]") -> Any:
    from rich.box import SIMPLE
    from rich.table import Table

    table = Table(box=SIMPLE, title="Fitted")
    for name in ("quantity", "steps", "R²", "remark"):
        table.add_column(name, justify="right" if name in ("steps", "R²") else "left")
    for fit in fits:
        r2 = "" if math.isnan(fit.r2) else f"{fit.r2:.2f}"
        table.add_row(fit.quantity, str(fit.steps or "none"), r2, fit.note)
    return table


def _missing_quantities(walks: "list[WalkMeasures]") -> list[str]:
    return [
        f"{walk.source}: no {quantity}: {reason}"
        for walk in walks
        for quantity, reason in walk.missing.items()
    ]


def _too_fast(walks: "list[WalkMeasures]", config: Any) -> list[str]:
    from saddlewalk.core import body_of

    ceiling_m_s = body_of(config).speed_ceiling_m_s
    return [
        f"{walk.source}: {walk.speed_m_s:.3g} m/s is above the fitted gait's ceiling, "
        f"{ceiling_m_s:.3g} m/s: a plan at it is limited"
        for walk in walks
        if walk.speed_m_s >= ceiling_m_s
    ]


def _mean_and_deviation(values: "np.ndarray") -> str:
    return f"{1e3 * values.mean():.0f} ± {1e3 * values.std():.0f}" if len(values) else "-"
