"""LCM for the host tools."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

import lcm

from saddlewalk.errors import UserError

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"
ROUTE = "sudo ip route add 224.0.0.0/4 dev lo"


def open_lcm(url: str | None = None) -> lcm.LCM:
    """LCM at a URL; by default the usual multicast group, not leaving this machine.

    Raises UserError with the remedy when LCM cannot start, as without a multicast route.
    """
    url = url or DEFAULT_URL
    try:
        with _standard_error_silent():
            return lcm.LCM(url)
    except RuntimeError as error:
        right = f"for a multicast route, run `{ROUTE}`"
        if not url.startswith("udpm:"):
            right = f"give an LCM URL such as {DEFAULT_URL}"
        raise UserError(f"LCM {url} cannot be opened: {right}") from error


@contextlib.contextmanager
def _standard_error_silent() -> Iterator[None]:
    """The LCM library explains at length why it cannot start; the error does so in one line."""
    saved = os.dup(2)
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
