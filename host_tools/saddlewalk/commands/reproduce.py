"""`saddlewalk reproduce`: the paper's figures and numbers from the C core, on one page."""

import argparse
from pathlib import Path
from typing import Any

from saddlewalk.outputs import OutputFolder, add_input, add_output
from saddlewalk.printable import printable

PAGE = "paper.html"
PICTURES = (
    *("steps.png", "lateral-stability.png", "vertical-amplitude.png"),
    *("vertical-motion.png", "from-above.png", "toe-off.png"),
)


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "reproduce",
        help="the paper's figures and numbers, from the C core",
        description="Draw the paper's figures from the C core and compare every number that the "
        f"paper states. Writes {PAGE}, a self-contained page, and each figure as PNG. Exit "
        "status 1 if a number is outside its tolerance or a finding does not hold.",
    )
    add_output(
        parser,
        "--out",
        output=OutputFolder((PAGE, *PICTURES)),
        type=Path,
        default=Path("out/paper"),
        metavar="FOLDER",
        help="folder for the page and the figures (default out/paper)",
    )
    add_input(
        parser,
        "--gait",
        type=Path,
        metavar="FOLDER",
        help="recorded trials to compare with the plan: CSV files as for `saddlewalk replay`, and "
        "manifest.csv, which describes them, if present",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.atomic_write import atomic_folder
    from saddlewalk.paper.figures import draw_all
    from saddlewalk.paper.numbers import findings, numbers, simulate_all
    from saddlewalk.paper.page import ONLY_ORENDURFF, verdict, write_page
    from saddlewalk.paper.people import load_trials

    trials = load_trials(args.gait) if args.gait else []
    simulations = simulate_all()
    compared, found = numbers(simulations), findings(simulations)
    pictures = draw_all(simulations, trials)
    page = write_page(compared, found, simulations, pictures, trials)
    files = {PAGE: page.encode()} | {each.name: each.png for each in pictures}
    with atomic_folder("--out", args.out, (PAGE, *PICTURES)) as folder:
        for name, content in files.items():
            (folder / name).write_bytes(content)
    print(verdict(compared, found))
    print(f"{len(trials)} recorded trials" if trials else ONLY_ORENDURFF)
    print(*(f"  {printable(args.out / name)}" for name in files), sep="\n")
    return 0 if all(each.sound for each in compared) and all(each.holds for each in found) else 1
