"""`saddlewalk view`: a walk in the browser, live from LCM or from a log."""

import argparse
import asyncio
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saddlewalk.errors import UserError
from saddlewalk.options import whole_number_in
from saddlewalk.outputs import add_input

if TYPE_CHECKING:
    from saddlewalk.view.server import Server


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "view",
        help="a walk in the browser, live from LCM or from a log",
        description="Serve a page that shows a walk: live from LCM, or an LCM log with a slider. "
        "The first line is the page's URL; only who has its token can open it. Ctrl-C ends it.",
    )
    add_input(
        parser,
        "log",
        nargs="?",
        type=Path,
        metavar="LOG",
        help="an LCM log (default: live from LCM)",
    )
    parser.add_argument("--lcm", metavar="URL", help="default: udpm on this machine")
    add_page_options(parser)
    parser.add_argument(
        "--allow-network",
        action="store_true",
        help="serve other machines too, unencrypted; by default only this one can open the page",
    )
    parser.set_defaults(run=run)


def add_page_options(container: Any) -> None:
    """--port and --no-browser, of every command that serves a page."""
    container.add_argument(
        "--port",
        type=whole_number_in(0, 65535),
        default=0,
        metavar="N",
        help="of the page (default: one that is free)",
    )
    container.add_argument("--no-browser", action="store_true", help="open no browser")


def add_view_options(parser: argparse.ArgumentParser, words: str) -> None:
    """--view of a command that walks, and the page's options."""
    parser.add_argument("--view", action="store_true", help=f"{words}; the page stays until Ctrl-C")
    add_page_options(parser)


def run(args: argparse.Namespace) -> int:
    if args.log is not None and args.lcm is not None:
        raise UserError("--lcm: not with a log, leave one of them out")
    asyncio.run(_serve(args))
    return 0


async def _serve(args: argparse.Namespace) -> None:
    from saddlewalk.transport.lcmbus import DEFAULT_URL, open_lcm
    from saddlewalk.view.browser import open_page
    from saddlewalk.view.sources import Live, log_server

    live = None
    if args.log is None:
        live = Live(open_lcm(args.lcm), f"live from {args.lcm or DEFAULT_URL}")
    server: Server = live.server if live else log_server(args.log)
    address = "0.0.0.0" if args.allow_network else "127.0.0.1"
    async with server.running(address, args.port) as url:
        print(url, flush=True)
        if live:
            live.listen()
        if not args.no_browser:
            open_page(url)
        await _interrupted()


async def _interrupted() -> None:
    """Until Ctrl-C, or a signal that asks a command to end."""
    came, loop = asyncio.Event(), asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        loop.add_signal_handler(number, came.set)
    await came.wait()
