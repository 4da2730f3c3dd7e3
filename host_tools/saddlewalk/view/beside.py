"""A live page beside a command that walks: its server in a process of its own, which a busy walk
does not hold up and which holds up no walk.
"""

import argparse
import asyncio
import contextlib
import multiprocessing
import os
import signal
from collections.abc import Iterator
from multiprocessing.connection import Connection
from typing import Any

from saddlewalk.errors import UserError
from saddlewalk.transport.lcmbus import ROUTE, open_lcm
from saddlewalk.transport.private_network import inside
from saddlewalk.view.browser import open_page

START_S = 20.0


class PageBeside:
    """The parent's end of a page."""

    def __init__(self, connection: Connection, url: str) -> None:
        self._connection = connection
        self.url = url

    def tell(self, **news: Any) -> None:
        """Send something to the pages. A server that has ended is not needed for the walk."""
        with contextlib.suppress(OSError):
            self._connection.send(news)

    def controls(self) -> Iterator[dict[str, Any]]:
        """What the pages commanded since the last call."""
        with contextlib.suppress(EOFError, OSError):
            while self._connection.poll():
                yield self._connection.recv()

    def show_until_interrupted(self) -> None:
        """The walk has ended; its pages can go back in it until Ctrl-C."""
        self.tell(ended=True)
        print(f"the page shows the walk until Ctrl-C: {self.url}", flush=True)
        with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):
            while True:
                self._connection.recv()


@contextlib.contextmanager
def page_beside(args: argparse.Namespace, source: str, controls: bool) -> Iterator[PageBeside]:
    """Serve what comes on LCM while the block runs. Raises UserError if that cannot start.

    args: of add_view_options(); source: in words; controls: PageBeside.controls() yields what the
    pages command.
    """
    if inside():
        raise UserError(
            "--view: this machine has no multicast route, and a browser does not reach the private "
            f"network in which the walk would run: run `{ROUTE}`"
        )
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    served = (theirs, args.lcm, args.port, source, controls)
    process = context.Process(target=_process, args=served, daemon=True)
    process.start()
    theirs.close()
    try:
        page = PageBeside(ours, _started(ours))
        print(page.url, flush=True)
        if not args.no_browser:
            open_page(page.url)
        yield page
    finally:
        ours.close()  # which ends it
        process.join()


def _started(connection: Connection) -> str:
    """The URL."""
    if not connection.poll(START_S):
        raise UserError(f"--view: the page's server did not start in {START_S:g} s")
    try:
        started: str | UserError = connection.recv()
    except EOFError as error:
        raise UserError("--view: the page's server has ended") from error
    if isinstance(started, UserError):
        raise started
    return started


def _process(
    connection: Connection, lcm_url: str | None, port: int, source: str, controls: bool
) -> None:
    """The server's process, until the other end of the pipe closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the walk, and with it the pipe
    os.nice(5)  # the walk comes first
    asyncio.run(_serve(connection, lcm_url, port, source, controls))


async def _serve(
    connection: Connection, lcm_url: str | None, port: int, source: str, controls: bool
) -> None:
    from saddlewalk.view.sources import Live

    ended = asyncio.Event()
    try:
        live = Live(open_lcm(lcm_url), source, connection.send if controls else None)
        async with live.server.running("127.0.0.1", port) as url:
            connection.send(url)
            live.listen()

            def hear() -> None:
                try:
                    live.server.tell(**connection.recv())
                except (EOFError, OSError):
                    asyncio.get_running_loop().remove_reader(connection.fileno())
                    ended.set()

            asyncio.get_running_loop().add_reader(connection.fileno(), hear)
            await ended.wait()
    except UserError as error:
        connection.send(error)
