"""`saddlewalk export`: an LCM log for other tools, as CSV, Parquet or MCAP."""

import argparse
import sys
from pathlib import Path
from typing import Any

from saddlewalk.logs.run_files import TABLE_FORMATS, exported, table_names
from saddlewalk.outputs import Output, OutputFile, OutputFolder, add_input, add_output
from saddlewalk.printable import printable


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "export",
        help="an LCM log as CSV, Parquet or MCAP",
        description="Write an LCM log for other tools: a table per channel, a row per message, "
        "units in the column names. MCAP (JSON with schemas) opens in Foxglove and PlotJuggler. "
        "Parquet and MCAP need the optional packages of saddlewalk[export].",
    )
    add_input(parser, "log", type=Path, metavar="LOG", help="an LCM log")
    parser.add_argument("--format", choices=(*TABLE_FORMATS, "mcap"), required=True)
    add_output(
        parser,
        "--out",
        output=_output,
        default_path=lambda args: exported(args.log, args.format),
        type=Path,
        metavar="OUT",
        help="mcap: the file; csv and parquet: the folder, which gets a file for each channel "
        "(default: in LOG's folder; for walk.lcmlog walk.mcap, walk-csv or walk-parquet)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.errors import UserError
    from saddlewalk.logs.tables import export, tables_of
    from saddlewalk.transport.lcm_log import LcmLog

    log = LcmLog(args.log)
    tables, others = tables_of(log)
    if not tables:
        raise UserError(
            f"{args.log}: none of its {log.events} messages, on {', '.join(others)}, is of "
            "a saddlewalk type"
        )
    stream = sys.stderr if str(args.out) == "-" else sys.stdout
    for path in export(log, tables, args.format, args.out):
        print(printable(path), file=stream)
    remarks = [
        f"skipped: {count} messages on {channel}, of unknown type"
        for channel, count in others.items()
    ]
    remarks += [f"incomplete: {log.broken}"] if log.broken else []
    for remark in remarks:
        print(printable(remark), file=sys.stderr)
    return 1 if log.broken else 0


def _output(args: argparse.Namespace) -> Output:
    return OutputFile() if args.format == "mcap" else OutputFolder(table_names(args.format))
