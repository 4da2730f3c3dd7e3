"""LCM for the host tools."""

import lcm

from saddlewalk.errors import UserError

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"
ROUTE = "sudo ip route add 224.0.0.0/4 dev lo"


def open_lcm(url: str | None = None) -> lcm.LCM:
    """LCM at a URL; by default the usual multicast group, not leaving this machine.

    Raises UserError with the remedy when LCM cannot start, as without a multicast route.
    """
    try:
        return lcm.LCM(url or DEFAULT_URL)
    except RuntimeError as error:
        raise UserError(
            f"LCM cannot use {url or DEFAULT_URL}: without a multicast route, run `{ROUTE}`"
        ) from error
