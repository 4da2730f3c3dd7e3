"""What a page receives first: names and sentences, from the one place where each is written."""

from typing import Any

from saddlewalk.contract import FAULTS, LEVELS, LIMITS, MODES, REASONS, TICK_S, TIME_MAX_S
from saddlewalk.status_text import LINKS, SOURCES, TRANSPORTS
from saddlewalk.verdict import reason_words
from saddlewalk.view.rows import VERTICES

WITHOUT_REASON = {
    "unknown": "There is no level yet.",
    "stable": "The walk is as usual.",
    "caution": "The body departs further than usual.",
    "unstable": "A fall is likely.",
}


def hello(source: str, live: bool) -> dict[str, Any]:
    """source: where the ticks come from, in words."""
    return {
        "source": source,
        "live": live,
        "tick_s": TICK_S,
        "time_max_s": TIME_MAX_S,
        "vertices": VERTICES,
        "levels": LEVELS,
        "reasons": [sentence(reason_words(number)) for number in range(len(REASONS))],
        "without_reason": WITHOUT_REASON,
        "modes": MODES,
        "faults": FAULTS,
        "limits": LIMITS,
        "links": LINKS,
        "sources": SOURCES,
        "transports": TRANSPORTS,
    }


def sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}." if words else ""
