"""Names and constants from the firmware's headers.

Nothing is repeated here, so nothing can differ from the firmware.
"""

from saddlewalk.core import defined, ffi


def _enumerators(enum: str, prefix: str) -> dict[int, str]:
    """Number -> name without its prefix, by number."""
    elements = ffi().typeof(enum).elements
    return {number: elements[number].removeprefix(prefix) for number in sorted(elements)}


def _names(enum: str, prefix: str) -> tuple[str, ...]:
    """Names by number, from 0 without a gap."""
    named = _enumerators(enum, prefix)
    assert list(named) == list(range(len(named))), enum
    return tuple(named.values())


def _bits(enum: str, prefix: str) -> tuple[str, ...]:
    """Names of bits, bit 0 first."""
    named = _enumerators(enum, prefix)
    assert list(named) == [1 << bit for bit in range(len(named))], enum
    return tuple(named.values())


def _words(enum: str, prefix: str) -> tuple[str, ...]:
    return tuple(name.lower() for name in _names(enum, prefix))


SIDES = _words("saddle_side_t", "SADDLE_")
COMMAND_MODES = _words("saddle_command_mode_t", "SADDLE_COMMAND_")
MODES = _words("saddle_mode_t", "SADDLE_MODE_")
LEVELS = _words("saddle_level_t", "SADDLE_LEVEL_")
REASONS = _words("saddle_reason_t", "SADDLE_REASON_")
STATUSES = _names("saddle_status_t", "SADDLE_")
FAULTS = _bits("saddle_fault_t", "SADDLE_FAULT_")
SENSOR_FAULTS = _bits("saddle_sensor_fault_t", "SADDLE_SENSOR_")
LIMITS = _bits("saddle_limit_t", "SADDLE_LIMIT_")

LEFT, RIGHT = map(SIDES.index, ("left", "right"))
STAND, WALK = map(COMMAND_MODES.index, ("stand", "walk"))
STANDING, STARTING, WALKING, STOPPING = map(
    MODES.index, ("standing", "starting", "walking", "stopping")
)
UNKNOWN, STABLE, CAUTION, UNSTABLE = map(LEVELS.index, ("unknown", "stable", "caution", "unstable"))

GRAVITY_M_S2 = defined("SADDLE_GRAVITY_M_S2")
TIME_MAX_S = defined("SADDLE_TIME_MAX_S")  # of an event that is not predicted
TICK_US = int(defined("SADDLE_TICK_US", "port_common/timing.h"))
TICK_S = TICK_US / 1e6
OUTPUT_FRAMES = int(defined("SADDLE_WIRE_OUTPUT_FRAMES", "wire/include/saddlewalk/wire.h"))


def name_of(number: int, names: tuple[str, ...], kind: str = "") -> str:
    """A name; for a number that is unknown here, as from other firmware, `kind number`."""
    return names[number] if 0 <= number < len(names) else f"{kind} {number}".strip()


def bit_names(bits: int, names: tuple[str, ...]) -> list[str]:
    """Names of the bits that are set; a bit without a name is given as its number."""
    return [
        names[bit] if bit < len(names) else f"bit{bit}"
        for bit in range(bits.bit_length())
        if bits >> bit & 1
    ]
