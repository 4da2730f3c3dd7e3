"""`saddlewalk rerun`: a logged run, recomputed from its inputs and compared bit for bit."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.config import add_body_options
from saddlewalk.errors import UserError
from saddlewalk.outputs import add_input
from saddlewalk.printable import printable

if TYPE_CHECKING:
    from saddlewalk.logs.rerun import Report


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "rerun",
        help="recompute a logged run and compare every output, bit for bit",
        description="Recompute a logged run from its inputs and compare every output "
        "bit for bit. Status 0: every output in the log was recomputed and is equal; 1: one "
        "differs or could not be computed; 2: not a log of a run. An LCM log has all inputs of "
        "any run. A CAN log (candump's .log, .blf, .asc, ...) holds those of a run in lockstep "
        "from its start, except the configuration, which the options give; in HEALTH, the counts "
        "of late ticks and rejected frames are not compared.",
    )
    add_input(parser, "log", type=Path, metavar="LOG", help="an LCM log or a CAN log")
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.config import load_config
    from saddlewalk.logs.can_log import CanLog
    from saddlewalk.transport.lcm_log import LcmLog, is_lcm_log

    if is_lcm_log(args.log):
        from saddlewalk.logs.rerun import rerun_lcm

        _reject_body_options(args)
        log: LcmLog | CanLog = LcmLog(args.log)
        report = _named(args.log, rerun_lcm, log)
    else:
        from saddlewalk.logs.rerun_can import rerun_can

        log = CanLog(args.log)
        report = _named(args.log, rerun_can, log, load_config(args))
    if log.broken:
        report.add_gap(log.broken)
    print("\n".join(map(printable, summary(report))))
    return 0 if report.sound else 1


def _reject_body_options(args: argparse.Namespace) -> None:
    for option in ("height", "mass", "config"):
        value = getattr(args, option)
        if value is not None:
            raise UserError(f"--{option} {value}: an LCM log has its own configuration")


def _named(log: Path, compute: Any, *arguments: Any) -> "Report":
    try:
        return compute(*arguments)
    except UserError as error:
        raise UserError(f"{log}: {error}") from error


def summary(report: "Report") -> list[str]:
    """The report in lines: the first difference, then what follows from it."""
    runs = "1 run" if report.runs == 1 else f"{report.runs} runs"
    lines = [f"{report.source}: {runs}, {report.ticks} ticks recomputed"]
    if report.first:
        lines += [
            str(report.first),
            f"{report.different_ticks} of {report.ticks} ticks differ from what was recorded",
        ]
    lines += [f"not compared: {gap}" for gap in report.not_compared]
    lines += [f"{channel} is not in the log and was not compared" for channel in report.not_logged]
    if report.sound:
        lines.append(f"all {report.compared} recorded outputs are equal, bit for bit")
    return lines
