"""`saddlewalk spy`: lcm-spy with our types compiled in."""

import argparse
import os
import sys
from typing import Any


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "spy",
        help="open lcm-spy with our types (needs Java)",
        description="Open lcm-spy, LCM's window of live channels, fields and plots, with "
        "saddlewalk's types compiled in. Needs a Java development kit and a display; in a "
        "terminal, `saddlewalk monitor` shows the scores.",
    )
    parser.add_argument("--lcm", metavar="URL", help="default: udpm on this machine")
    parser.add_argument(
        "--jar",
        action="store_true",
        help="only compile the types and print where their jar is, for other LCM tools in Java",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.errors import UserError
    from saddlewalk.transport.java_types import lcm_program, types_jar
    from saddlewalk.transport.lcmbus import DEFAULT_URL, open_lcm

    jar = types_jar()
    if args.jar:
        print(jar)
        return 0
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        raise UserError("lcm-spy needs a display and DISPLAY is not set: use `saddlewalk monitor`")
    open_lcm(args.lcm)  # an error in one line, instead of Java's trace
    url = args.lcm or DEFAULT_URL
    environment = os.environ | {"CLASSPATH": str(jar)}
    os.execve(lcm_program("lcm-spy"), ["lcm-spy", f"--lcm-url={url}"], environment)
