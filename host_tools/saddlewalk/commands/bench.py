"""`saddlewalk bench`: planning time of the core and other planners, and its instructions."""

import argparse
from typing import Any

from saddlewalk.options import whole_number_in
from saddlewalk.outputs import add_output


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "bench",
        help="planning time of the core and other planners, and its instructions",
        description="Measure the time of one update, and of planning 1 and 10 strides with scores, "
        "gravity and margins, with cold and warm caches. For comparison: the same equations in "
        "numpy and GNU Octave, walking QPs (make bench-baselines), placo, and a floor: only the "
        "core's calls of sin, exp, sqrt and the like. What is not installed is named and skipped. "
        "Times depend on the machine's load; the instruction counts, by valgrind, do not.",
    )
    parser.add_argument(
        "--rounds",
        type=whole_number_in(1, 10**5),
        default=50,
        metavar="N",
        help="rounds, each with one cold and one warm run of every planner (default 50)",
    )
    add_output(parser, "--json", metavar="FILE", help="the results as JSON; - for standard output")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    import json

    from saddlewalk.atomic_write import write_text
    from saddlewalk.benchmark import instructions
    from saddlewalk.benchmark import report as bench_report
    from saddlewalk.benchmark.baselines import MissingError
    from saddlewalk.benchmark.timing import measure

    timings = measure(args.rounds)
    try:
        groups, missing = instructions.count(), None
    except MissingError as error:
        groups, missing = [], str(error)
    report = bench_report.Report(args.rounds, timings, groups, missing)
    if args.json is not None:
        write_text("--json", args.json, json.dumps(report.as_dict(), indent=2) + "\n")
    if args.json != "-":
        print(*report.lines(), sep="\n")
    return 0
