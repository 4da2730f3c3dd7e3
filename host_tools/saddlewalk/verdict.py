"""The supervisor's verdict in names and words, and as the cells of a table."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping

from saddlewalk.contract import LEVELS, REASONS, name_of
from saddlewalk.table import Cell

REASON_WORDS = {
    "none": "",
    "input": "a measurement is missing or implausible",
    "no_walk": "no plan, and neither standing nor a complete step was measured",
    "no_step": "the next step cannot catch the body",
    "speed": "this body cannot walk at this speed",
    "s_pend": "the steps are almost too short for this speed",
    "s_jump": "the steps are almost too long for this speed",
    "s_sw": "the body is too far to one side for the width of the step",
    "xcom_ap": "forward motion deviates from the expected",
    "xcom_ml": "sideways motion deviates from the expected",
    "off_track": "more energy than the ankles can absorb to return to the plan",
    "settling": "no level has lasted long enough yet",
    "forward": "the body departs forward of the feet",
    "backward": "the body departs backward of the feet",
    "left": "the body departs to the left of the feet",
    "right": "the body departs to the right of the feet",
    "sinking": "the body sinks",
}

COLUMNS = (
    "ebos_com_m ebos_xcom_m excess_stop_j excess_track_j can_stop on_track level reason "
    "margin caution_below driver".split()
)


def level_name(level: int) -> str:
    return name_of(level, LEVELS, "level")


def reason_name(reason: int) -> str:
    return name_of(reason, REASONS, "reason")


def reason_words(reason: int) -> str:
    """What decided the level, as text; empty for no reason."""
    name = reason_name(reason)
    return REASON_WORDS.get(name, name)


def level_words(signals: Mapping[str, float]) -> str:
    """The level and what decided it, from a tick's score signals by their names on CAN."""
    name, why = level_name(int(signals["LEVEL"])), reason_words(int(signals["REASON"]))
    return f"{name}: {why}" if why else name


def cells(signals: Mapping[str, float]) -> list[Cell]:
    """In the order of COLUMNS, from a tick's score signals by their names on CAN."""
    return [
        *(signals[name] for name in ("EBOS_COM", "EBOS_XCOM", "EXCESS_STOP", "EXCESS_TRACK")),
        known_bit(signals["CAN_STOP"], signals["EXCESS_STOP"]),
        known_bit(signals["ON_TRACK"], signals["EXCESS_TRACK"]),
        level_name(int(signals["LEVEL"])),
        reason_name(int(signals["REASON"])),
        signals["BALANCE_MARGIN"],
        signals["CAUTION_BELOW"],
        _driver(signals),
    ]


def _driver(signals: Mapping[str, float]) -> str | None:
    """As a reason, while there is a margin that it drives."""
    known = not math.isnan(signals["BALANCE_MARGIN"])
    return reason_name(int(signals["DRIVER"])) if known else None


def known_bit(bit: float, number: float) -> int | None:
    """A bit that is known if its number is."""
    return None if math.isnan(number) else int(bit)


def ticks_in(levels: Iterable[str]) -> dict[str, int]:
    """Number of ticks in each level, from stable to unstable, unknown last."""
    counts = Counter(levels)
    return {name: counts[name] for name in (*LEVELS[1:], LEVELS[0])}
