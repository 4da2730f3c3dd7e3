"""The server of the page: HTTP for the document, a WebSocket for ticks and controls.

Both need the token of the URL. To the page go JSON texts (`hello` with names and words, then
news) and binary blocks: float32, first the number of the block's first tick, then its rows in the
order of rows.NAMES. From the page come JSON texts: {"want": [first, end]} for ticks of a log, and
the controls of an emulated wearer.
"""

import asyncio
import contextlib
import hmac
import json
import math
import secrets
import struct
from array import array
from collections import deque
from collections.abc import AsyncIterator, Callable
from http import HTTPStatus
from typing import Any, Protocol
from urllib.parse import parse_qs, urlsplit

from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from saddlewalk.errors import UserError
from saddlewalk.view.page import document
from saddlewalk.view.rows import NAMES

BEHIND_MAX = 250  # messages that a slow page may be behind; then it misses some
MESSAGE_MAX = 4096  # bytes from the page
WANT_MAX = 2048  # ticks at once
HISTORY_TICKS = 7500  # that a live page can go back: 10 minutes
CLOSE_S = 1.0  # that a page has to say goodbye
PUSH_MAX_N_S = 100.0
SPEED_MAX_M_S = 3.0
TURN_MAX_RAD_S = 1.0

Control = Callable[[dict[str, Any]], None]


class Ticks(Protocol):
    """Rows by the number of their tick, of which the first may be gone."""

    @property
    def first(self) -> int: ...

    @property
    def end(self) -> int: ...

    def block(self, first: int, end: int) -> bytes:
        """The rows of [first, end), one after another."""
        ...


class LiveTicks:
    """The newest HISTORY_TICKS rows."""

    def __init__(self) -> None:
        self._rows: deque[bytes] = deque(maxlen=HISTORY_TICKS)
        self.end = 0

    @property
    def first(self) -> int:
        return self.end - len(self._rows)

    def add(self, row: "array[float]") -> None:
        self._rows.append(row.tobytes())
        self.end += 1

    def block(self, first: int, end: int) -> bytes:
        skipped = first - self.first
        return b"".join(list(self._rows)[skipped : skipped + end - first])


class LogTicks:
    """All rows of a log."""

    first = 0

    def __init__(self) -> None:
        self._rows = bytearray()

    @property
    def end(self) -> int:
        return len(self._rows) // (4 * len(NAMES))

    def add(self, row: "array[float]") -> None:
        self._rows += row.tobytes()

    def block(self, first: int, end: int) -> bytes:
        size = 4 * len(NAMES)
        return bytes(self._rows[first * size : end * size])

    def column(self, name: str) -> "array[float]":
        numbers = array("f", bytes(self._rows))
        return numbers[NAMES.index(name) :: len(NAMES)]


class Server:
    """Serves one source of ticks to any number of pages.

    hello: what a page receives first, beside the names of a row. control: receives what the pages
    command; None: they cannot.
    """

    def __init__(self, ticks: Ticks, hello: dict[str, Any], control: Control | None = None) -> None:
        self.token = secrets.token_urlsafe(16)
        self.hello = {"names": NAMES, "controls": control is not None, **hello}
        self._ticks, self._control = ticks, control
        self._pages: set[asyncio.Queue[str | bytes]] = set()

    @contextlib.asynccontextmanager
    async def running(self, address: str, port: int) -> AsyncIterator[str]:
        """Listen for the length of the block; yields the page's URL. port 0: any that is free."""
        try:
            server = await serve(
                self._page,
                address,
                port,
                process_request=self._answer,
                max_size=MESSAGE_MAX,
                compression=None,
                close_timeout=CLOSE_S,
                server_header=None,
            )
        except OSError as error:
            raise UserError(
                f"--port {port}: {error.strerror}: give another, or 0 for any"
            ) from error
        async with server:
            number = next(iter(server.sockets)).getsockname()[1]
            yield f"http://{address}:{number}/?token={self.token}"

    def publish(self, first: int, rows: bytes) -> None:
        """Send new rows to all pages."""
        self._broadcast(_block(first, rows))

    def tell(self, **news: Any) -> None:
        """Send something to all pages, and to later ones in their hello."""
        self.hello |= news
        self._broadcast(json.dumps(news))

    def _broadcast(self, message: str | bytes) -> None:
        for queue in self._pages:
            if queue.full():
                queue.get_nowait()
            queue.put_nowait(message)

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        url = urlsplit(request.path)
        given = parse_qs(url.query).get("token", [""])[0]
        if not hmac.compare_digest(given.encode(), self.token.encode()):
            return connection.respond(
                HTTPStatus.FORBIDDEN, "Use the whole URL that saddlewalk printed, with its token.\n"
            )
        if url.path == "/ticks":
            return None
        if url.path != "/":
            return connection.respond(HTTPStatus.NOT_FOUND, "There is only one page, /.\n")
        return _document()

    async def _page(self, connection: ServerConnection) -> None:
        """One page, until it closes."""
        queue: asyncio.Queue[str | bytes] = asyncio.Queue(BEHIND_MAX)
        ticks = self._ticks
        begin = ticks.first if self.hello["live"] else ticks.end
        hello = {**self.hello, "first": ticks.first, "end": ticks.end}
        queue.put_nowait(json.dumps({"hello": hello}))
        if begin < ticks.end:
            queue.put_nowait(_block(begin, ticks.block(begin, ticks.end)))
        self._pages.add(queue)
        sender = asyncio.create_task(_send(connection, queue))
        try:
            async for text in connection:
                self._take(text, queue)
        except ConnectionClosed:
            pass
        finally:
            self._pages.discard(queue)
            sender.cancel()

    def _take(self, text: str | bytes, queue: "asyncio.Queue[str | bytes]") -> None:
        """What a page sent. Anything else is ignored."""
        try:
            asked = json.loads(text)
        except ValueError:
            return
        if not isinstance(asked, dict):
            return
        wanted = asked.get("want")
        if wanted is not None and not queue.full():
            block = _wanted(self._ticks, wanted)
            if block:
                queue.put_nowait(block)
        elif self._control and _is_control(asked):
            self._control(asked)


async def _send(connection: ServerConnection, queue: "asyncio.Queue[str | bytes]") -> None:
    with contextlib.suppress(ConnectionClosed):
        while True:
            await connection.send(await queue.get())


def _block(first: int, rows: bytes) -> bytes:
    return struct.pack("<f", first) + rows


def _wanted(ticks: Ticks, wanted: Any) -> bytes | None:
    """A block of a log; None for numbers that it does not have."""
    if not (isinstance(wanted, list) and len(wanted) == 2 and all(type(n) is int for n in wanted)):
        return None
    first, end = wanted
    if not ticks.first <= first < end <= min(ticks.end, first + WANT_MAX):
        return None
    return _block(first, ticks.block(first, end))


def _is_control(asked: dict[str, Any]) -> bool:
    """{"push": [x, y] in N s}, {"end": true}, {"speed": m/s} or {"turn": rad/s}.

    Speed or turn null: the schedule's.
    """
    if len(asked) != 1:
        return False
    ((name, value),) = asked.items()
    if name == "push":
        return (
            isinstance(value, list)
            and len(value) == 2
            and all(map(_is_number, value))
            and 0 < math.hypot(*value) <= PUSH_MAX_N_S
        )
    if name == "speed":
        return value is None or (_is_number(value) and 0 <= value <= SPEED_MAX_M_S)
    if name == "turn":
        return value is None or (_is_number(value) and abs(value) <= TURN_MAX_RAD_S)
    return name == "end" and value is True


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _document() -> Response:
    nonce = secrets.token_urlsafe(16)
    body = document(nonce).encode()
    policy = (
        f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'unsafe-inline'; "
        "connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'"
    )
    headers = Headers(
        {
            "Content-Type": "text/html; charset=utf-8",
            "Content-Length": str(len(body)),
            "Content-Security-Policy": policy,
            "Referrer-Policy": "no-referrer",
            "Cache-Control": "no-store",
            "Connection": "close",
        }
    )
    return Response(HTTPStatus.OK, "OK", headers, body)
