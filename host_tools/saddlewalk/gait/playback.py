"""A recording played to the firmware over CAN as a live wearer would send it, and its answers."""

import contextlib
import math
import time
from collections.abc import Iterator

import can
import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.gait.recording import Recording
from saddlewalk.ticks import TICK_S, Messages, Signals, TickReader, next_tick, scores_of
from saddlewalk.transport.wire import Sender

ANSWER_TIMEOUT_S = 2.0


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


def play_lockstep(
    bus: can.BusABC, sets: Iterator[tuple[float, Messages]]
) -> Iterator[tuple[float, Signals]]:
    """Send each set once the one before is answered; yields (time of the set, its scores).

    Raises UserError when no answer comes.
    """
    sender, reader = Sender(), TickReader()
    for time_s, measured in sets:
        _send(bus, sender, measured)
        messages = next_tick(bus, reader.feed, ANSWER_TIMEOUT_S)
        if messages is None:
            raise UserError(
                f"the firmware did not answer the measurements at {time_s:.2f} s in "
                f"{ANSWER_TIMEOUT_S:g} s: {reader.receiver.accepted} frames came whole, "
                f"{reader.receiver.rejected} were refused"
            )
        yield time_s, scores_of(messages)


def play_realtime(
    bus: can.BusABC, sets: Iterator[tuple[float, Messages]]
) -> Iterator[tuple[float, Signals]]:
    """Send each set when it is due; yields (time of the latest set, scores as they come)."""
    sender, reader = Sender(), TickReader()
    start_s = time.monotonic()
    for time_s, measured in sets:
        _send(bus, sender, measured)
        due_s = start_s + time_s + TICK_S
        while messages := next_tick(bus, reader.feed, due_s - time.monotonic()):
            yield time_s, scores_of(messages)


def _send(bus: can.BusABC, sender: Sender, messages: Messages) -> None:
    """A frame that the bus has no room for is lost; the firmware sees that by its age."""
    for name, signals in messages.items():
        with contextlib.suppress(can.CanOperationError):
            bus.send(sender.frame(name, **signals))
