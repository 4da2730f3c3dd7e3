"""A recording played to the firmware over CAN as a live wearer would send it, and its answers."""

import contextlib
import math
import socket
import time
from collections.abc import Iterator

import can
import numpy as np

from saddlewalk.bus import DEFAULT_GROUP
from saddlewalk.errors import UserError
from saddlewalk.recording import Recording
from saddlewalk.wire import Receiver, Sender

TICK_S = 0.08
ANSWER_TIMEOUT_S = 2.0

Signals = dict[str, float]
Messages = dict[str, Signals]


def private_udp() -> str:
    """A UDP bus on a port that nobody uses now."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        return f"udp:{DEFAULT_GROUP}:{probe.getsockname()[1]}"


def measurements(recording: Recording, contact: np.ndarray) -> Iterator[tuple[float, Messages]]:
    """Every TICK_S from the start of the trial: (seconds since then, the messages of one set).

    The wearer follows no plan, so the command is to stand. What the recording does not hold within
    half a tick is NaN, which is sent as not available.
    """
    since_start_s = recording.time_s - recording.time_s[0]
    for tick in range(math.floor(recording.duration_s / TICK_S + 1e-9) + 1):
        time_s = tick * TICK_S
        index = int(np.argmin(np.abs(since_start_s - time_s)))
        measured = abs(since_start_s[index] - time_s) <= TICK_S / 2
        com_m, velocity_m_s = recording.com_m[index], recording.com_velocity_m_s[index]
        missing = 0.0 if measured else math.nan
        left_m, right_m = recording.cop_m[:, index] - com_m[:2] + missing
        yield (
            time_s,
            {
                "COMMAND": {"MODE": 0, "SPEED": 0.0, "HEEL_STRIKE": 0.0},
                "MEASURED_COM": {
                    "HEIGHT": com_m[2] + missing,
                    "VX": velocity_m_s[0] + missing,
                    "VY": velocity_m_s[1] + missing,
                },
                "MEASURED_LEFT": {"X": left_m[0], "Y": left_m[1], "CONTACT": contact[0, index]},
                "MEASURED_RIGHT": {"X": right_m[0], "Y": right_m[1], "CONTACT": contact[1, index]},
            },
        )


class TickReader:
    """Gathers the frames of a tick; HEALTH is its last."""

    SCORES = ("SCORES_STEP", "SCORES_MARGIN", "SCORES_FORCE")

    def __init__(self) -> None:
        self._receiver = Receiver()
        self._latest: dict[str, Signals] = {}

    def feed(self, frame: can.Message) -> Signals | None:
        """The scores of a tick once all of it has come. A tick with a lost frame gives none."""
        accepted = self._receiver.accept(frame)
        if accepted is None:
            return None
        name, signals = accepted
        self._latest[name] = signals
        if name != "HEALTH":
            return None
        tick = [self._latest.get(part) for part in self.SCORES]
        if any(part is None or part["COUNTER"] != signals["COUNTER"] for part in tick):
            return None
        return {name: value for part in tick for name, value in part.items()}


def play_lockstep(
    bus: can.BusABC, sets: Iterator[tuple[float, Messages]]
) -> Iterator[tuple[float, Signals]]:
    """Send each set once the one before is answered; yields (time of the set, its scores)."""
    sender, reader = Sender(), TickReader()
    for time_s, messages in sets:
        _send(bus, sender, messages)
        yield time_s, _answer(bus, reader, time_s)


def play_realtime(
    bus: can.BusABC, sets: Iterator[tuple[float, Messages]]
) -> Iterator[tuple[float, Signals]]:
    """Send each set when it is due; yields (time of the latest set, scores as they come)."""
    sender, reader = Sender(), TickReader()
    start_s = time.monotonic()
    for time_s, messages in sets:
        _send(bus, sender, messages)
        while (left_s := start_s + time_s + TICK_S - time.monotonic()) > 0:
            frame = bus.recv(left_s)
            scores = reader.feed(frame) if frame else None
            if scores:
                yield time_s, scores


def _send(bus: can.BusABC, sender: Sender, messages: Messages) -> None:
    """A frame that the bus has no room for is lost; the firmware sees that by its age."""
    for name, signals in messages.items():
        with contextlib.suppress(can.CanOperationError):
            bus.send(sender.frame(name, **signals))


def _answer(bus: can.BusABC, reader: TickReader, time_s: float) -> Signals:
    deadline_s = time.monotonic() + ANSWER_TIMEOUT_S
    while (left_s := deadline_s - time.monotonic()) > 0:
        frame = bus.recv(left_s)
        scores = reader.feed(frame) if frame else None
        if scores:
            return scores
    raise UserError(
        f"the firmware did not answer the measurements at {time_s:.2f} s in {ANSWER_TIMEOUT_S:g} s"
    )
