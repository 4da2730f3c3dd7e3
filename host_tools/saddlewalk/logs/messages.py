"""Decoding the events of a log by saddlewalk's LCM types."""

import functools
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.transport.lcm_log import Event

CHANNEL_PREFIX = "SADDLEWALK_"
MESSAGE_MAX = 1 << 14  # bytes; the longest, config_t, has some 3000
NAMES_MAX = 50  # unknown channels that are counted separately
FURTHER = "further channels"
_NUMPY = {"float": ">f4", "double": ">f8", "byte": "u1", "boolean": "i1"} | {
    f"int{bits}_t": f">i{bits // 8}" for bits in (8, 16, 32, 64)
}
_FINGERPRINT = "fingerprint"


@dataclass(frozen=True)
class Kind:
    """The message type of a channel."""

    channel: str
    type: Any  # the generated class
    layout: np.dtype | None  # layout of the encoded message; None: its size varies

    @property
    def name(self) -> str:
        """Such as `plan` for SADDLEWALK_PLAN."""
        return self.channel.removeprefix(CHANNEL_PREFIX).lower()

    @functools.cached_property
    def fingerprint(self) -> bytes:
        return self.type._get_packed_fingerprint()

    def is_whole(self, data: bytes) -> bool:
        """Whether data has the size and fingerprint of this type."""
        whole = self.layout is not None and len(data) == self.layout.itemsize
        return whole and data.startswith(self.fingerprint)

    def decode(self, data: bytes) -> Any:
        """The message; None if data is not of this type."""
        if len(data) > MESSAGE_MAX or (self.layout is not None and not self.is_whole(data)):
            return None
        try:
            return self.type.decode(data)
        except Exception:  # the generated decoders raise ValueError, struct.error or IndexError
            return None


class UnknownMessages(Counter[str]):
    """Counts messages of unknown types by channel, for any number of channels."""

    def add(self, channel: str) -> None:
        self[channel if channel in self or len(self) < NAMES_MAX else FURTHER] += 1


@functools.cache
def kinds() -> dict[str, Kind]:
    """All message types, by channel."""
    from saddlewalk.transport import lcm_types

    found = {}
    for type_name, generated in vars(lcm_types).items():
        if hasattr(generated, "__typenames__"):
            channel = CHANNEL_PREFIX + type_name.removesuffix("_t").upper()
            found[channel] = Kind(channel, generated, _layout(generated))
    return found


def decode(event: Event) -> Any:
    """The message of an event; None if it is not of its channel's type."""
    kind = kinds().get(event.channel)
    return kind.decode(event.data) if kind else None


def _layout(generated: Any) -> np.dtype | None:
    """Layout of the encoded message: the type's fingerprint, then member by member."""
    members: list[tuple[Any, ...]] = [(_FINGERPRINT, ">u8")]
    described = (generated.__slots__, generated.__typenames__, generated.__dimensions__)
    for name, kind, dimensions in zip(*described, strict=True):
        dimensions = dimensions or []
        if kind not in _NUMPY or not all(isinstance(size, int) for size in dimensions):
            return None
        members.append((name, _NUMPY[kind], tuple(dimensions)))
    return np.dtype(members)
