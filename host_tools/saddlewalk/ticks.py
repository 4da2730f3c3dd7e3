"""The firmware's ticks from CAN, each complete or not at all."""

import time
from collections.abc import Callable
from typing import Protocol

import can

from saddlewalk.transport.wire import Receiver

PLAN_MESSAGES = (
    "PLAN_COM PLAN_COM_VELOCITY PLAN_LEFT PLAN_RIGHT PLAN_SWING PLAN_LANDING PLAN_ANKLE PLAN_STEP "
    "PLAN_EVENTS PLAN_PITCH PLAN_REFERENCE_XCOM PLAN_REFERENCE_COP PLAN_REFERENCE_COM "
    "PLAN_LAST_STEP PLAN_WAY PLAN_YAW"
).split()
SCORE_MESSAGES = (
    "SCORES_STEP SCORES_MARGIN SCORES_FORCE SCORES_ENERGY SCORES_EXPECTED VERDICT RECOVERY BALANCE"
).split()
LEARNED_MESSAGES = "LEARNED_MEAN LEARNED_STEP LEARNED_STEADINESS".split()
PROCESS_MESSAGES = "TIMING RECEIVED INPUTS HEALTH".split()
MESSAGES = {*PLAN_MESSAGES, *SCORE_MESSAGES, *LEARNED_MESSAGES, *PROCESS_MESSAGES}

Signals = dict[str, float]
Messages = dict[str, Signals]  # message name -> signal name -> value


def scores_of(messages: Messages) -> Signals:
    """All signals of SCORE_MESSAGES, no two of which share a name but COUNTER."""
    return {name: value for part in SCORE_MESSAGES for name, value in messages[part].items()}


class FrameBus(Protocol):
    """What a walk needs of a bus: `can.BusABC` is one."""

    channel_info: str

    def send(self, frame: can.Message, /) -> None: ...

    def recv(self, timeout: float | None = None) -> can.Message | None: ...


class TickReader:
    """Collects the frames of a tick; HEALTH is the last one."""

    def __init__(self) -> None:
        self.receiver = Receiver()
        self._latest: Messages = {}

    def feed(self, frame: can.Message) -> Messages | None:
        """All messages of a tick when they are complete; None before, and if one was lost."""
        accepted = self.receiver.accept(frame)
        if accepted is None:
            return None
        name, signals = accepted
        self._latest[name] = signals
        if name != "HEALTH":
            return None
        messages, self._latest = self._latest, {}
        counters = {part["COUNTER"] for name, part in messages.items() if name in MESSAGES}
        whole = messages.keys() >= MESSAGES and len(counters) == 1
        return messages if whole else None


def next_tick(
    bus: FrameBus, feed: Callable[[can.Message], Messages | None], within_s: float
) -> Messages | None:
    """The next tick that `feed` assembles from the bus's frames; None if none is complete in time.

    Reads at least one waiting frame, and returns in time even if the bus is flooded.
    """
    deadline_s = time.monotonic() + within_s
    while True:
        left_s = deadline_s - time.monotonic()
        frame = bus.recv(max(0.0, left_s))
        messages = feed(frame) if frame else None
        if messages or left_s <= 0:
            return messages
