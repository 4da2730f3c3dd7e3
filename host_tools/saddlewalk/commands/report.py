"""`saddlewalk report`: an LCM log as one self-contained HTML page."""

import argparse
import sys
from pathlib import Path
from typing import Any

from saddlewalk.logs.run_files import reported
from saddlewalk.outputs import add_input, add_output
from saddlewalk.printable import printable


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "report",
        help="an LCM log of a session as one HTML page",
        description="Write a log of `saddlewalk demo`, `replay --log` or lcm-logger as one "
        "HTML page with everything embedded: scores, levels and alarms, steps and their "
        "variability, distance, data quality, configuration. Exit status 1 if the log is "
        "incomplete; the page then says so.",
    )
    add_input(parser, "log", type=Path, metavar="LOG", help="an LCM log")
    add_output(
        parser,
        "--out",
        default_path=lambda args: reported(args.log),
        type=Path,
        metavar="report.html",
        help="the page (default: in LOG's folder; for walk.lcmlog walk.lcmlog.html)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.atomic_write import atomic_file
    from saddlewalk.session.page import summary_lines, write_page
    from saddlewalk.session.runs import load_session

    session = load_session(args.log)
    page = write_page(args.log, session)
    with atomic_file("--out", args.out, "wb") as file:
        file.write(page.encode())
    stream = sys.stderr if str(args.out) == "-" else sys.stdout
    print(*summary_lines(session), printable(args.out), sep="\n", file=stream)
    if session.broken:
        print(f"incomplete: {session.broken}", file=sys.stderr)
    return 1 if session.broken else 0
