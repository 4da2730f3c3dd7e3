"""LCM for the host tools."""

import select
import time
from pathlib import Path

import lcm

from saddlewalk.errors import UserError
from saddlewalk.stderr_redirect import stderr_silenced
from saddlewalk.transport.lcm_log import LcmLog

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"
ROUTE = "sudo ip route add 224.0.0.0/4 dev lo"


def open_lcm(url: str | None = None) -> lcm.LCM:
    """LCM at a URL; by default the usual multicast group, not leaving this machine.

    Raises UserError with the remedy when LCM cannot start, as without a multicast route.
    """
    url = url or DEFAULT_URL
    _check_log(url)
    try:
        with stderr_silenced():
            return lcm.LCM(url)
    except RuntimeError as error:
        right = f"for a multicast route, run `{ROUTE}`"
        if not url.startswith("udpm:"):
            right = f"give an LCM URL such as {DEFAULT_URL}"
        raise UserError(f"LCM {url} cannot be opened: {right}") from error


def _check_log(url: str) -> None:
    """Read a log to its end before lcm plays it, since lcm trusts the lengths in it."""
    scheme, _, rest = url.partition("://")
    path, _, options = rest.partition("?")
    if scheme != "file" or "mode=w" in options:
        return
    log = LcmLog(Path(path))
    for _ in log:
        pass
    if log.broken:
        raise UserError(f"LCM {url} cannot be played: {log.broken}")


def receive(bus: lcm.LCM, within_s: float = 0.0) -> bool:
    """Pass a message to its subscribers if one comes in time; returns whether one did.

    Replaces lcm's handle_timeout(), in which Ctrl-C breaks the interpreter.
    """
    if not select.select([bus], [], [], within_s)[0]:
        return False
    bus.handle()
    return True


def listen(bus: lcm.LCM, for_s: float) -> None:
    """Pass messages to their subscribers for that long."""
    deadline_s = time.monotonic() + for_s
    while (left_s := deadline_s - time.monotonic()) > 0:
        receive(bus, left_s)
