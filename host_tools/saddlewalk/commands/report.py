"""`saddlewalk report`: an LCM log as one HTML page that needs nothing else."""

import argparse
import sys
from pathlib import Path
from typing import Any

from saddlewalk.errors import UserError


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "report",
        help="an LCM log of a session as one HTML page",
        description="Write a log of `saddlewalk demo` or of lcm-logger as one HTML page with "
        "everything in it: scores, levels and alarms with their reasons, steps and their "
        "variability, distance, data quality, configuration. Exit status 1 if the log is "
        "incomplete; the page then says so.",
    )
    parser.add_argument("log", type=Path, metavar="LOG", help="an LCM log")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="report.html",
        help="the page (default: beside LOG, as walk.lcmlog.html of walk.lcmlog)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.session.page import in_words, write_page
    from saddlewalk.session.runs import load_session

    session = load_session(args.log)
    out = args.out or args.log.with_name(f"{args.log.name}.html")
    if out.exists() and out.samefile(args.log):
        raise UserError(f"--out {out} is the log itself: give another")
    _write(out, write_page(args.log, session))
    print(*in_words(session), out, sep="\n")
    if session.broken:
        print(f"incomplete: {session.broken}", file=sys.stderr)
    return 1 if session.broken else 0


def _write(out: Path, page: str) -> None:
    from saddlewalk.table import whole_file

    try:
        with whole_file(out, "wb") as file:
            file.write(page.encode())
    except OSError as error:
        raise UserError(f"--out {out}: {error.strerror}") from error
