"""Where a page's ticks come from: LCM as it comes, or a log."""

import asyncio
from pathlib import Path
from typing import Any

from saddlewalk.errors import UserError
from saddlewalk.transport.lcm_log import LcmLog
from saddlewalk.transport.lcmbus import receive
from saddlewalk.view.rows import Rows
from saddlewalk.view.server import Control, LiveTicks, LogTicks, Server
from saddlewalk.view.words import hello

LCM_QUEUE = 2000
CHANNELS = "SADDLEWALK_.*"


class Live:
    """Publishes what LCM brings to a server's pages, a row a tick."""

    def __init__(self, bus: Any, source: str, control: Control | None = None) -> None:
        self._bus, self._rows, self._ticks = bus, Rows(), LiveTicks()
        self.server = Server(self._ticks, hello(source, live=True), control)
        bus.subscribe(CHANNELS, self._take).set_queue_capacity(LCM_QUEUE)

    def listen(self) -> None:
        """Take messages from now on, in the running event loop."""
        asyncio.get_running_loop().add_reader(self._bus.fileno(), receive, self._bus)

    def _take(self, channel: str, data: bytes) -> None:
        height_m = self._rows.body_height_m
        row = self._rows.feed(channel, data)
        if self._rows.body_height_m != height_m:
            self.server.tell(body_height_m=self._rows.body_height_m)
        if row is not None:
            self._ticks.add(row)
            self.server.publish(self._ticks.end - 1, row.tobytes())


def log_server(path: Path) -> Server:
    """The server of a log, all of which is read first. Raises UserError if it holds no tick."""
    log, rows, ticks = LcmLog(path), Rows(), LogTicks()
    for event in log:
        row = rows.feed(event.channel, event.data)
        if row is not None:
            ticks.add(row)
    last = rows.end()
    if last is not None:
        ticks.add(last)
    if not ticks.end:
        raise UserError(f"{path}: no message of the firmware is in it: give a log of a walk")
    words = f"{path.name}; incomplete: {log.broken}" if log.broken else path.name
    return Server(
        ticks,
        {
            **hello(words, live=False),
            "body_height_m": rows.body_height_m,
            "spans": _spans(ticks),
        },
    )


def _spans(ticks: LogTicks) -> list[tuple[int, int, int]]:
    """(level, first tick, tick after the last) of each level in a row."""
    spans: list[tuple[int, int, int]] = []
    first = 0
    levels = [int(level) if level == level else 0 for level in ticks.column("verdict.level")]
    for tick, level in enumerate([*levels, None]):
        if tick and level != levels[first]:
            spans.append((levels[first], first, tick))
            first = tick
    return spans
