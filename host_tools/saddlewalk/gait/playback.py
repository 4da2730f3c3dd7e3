"""Sends a recording to the firmware over CAN as a live wearer would, and receives its answers."""

import contextlib
import math
import time
from collections.abc import Iterable, Iterator

import can
import numpy as np

from saddlewalk.contract import TICK_S
from saddlewalk.errors import UserError
from saddlewalk.gait.recording import Recording
from saddlewalk.gait.states import State, nothing_at, state_at
from saddlewalk.ticks import Messages, Signals, TickReader, next_tick, scores_of
from saddlewalk.transport.wire import TIMES, Sender

ANSWER_TIMEOUT_S = 2.0


def states_at_ticks(recording: Recording, contact: np.ndarray) -> Iterator[State]:
    """The state at every tick from the start of the trial. Without a sample within half a tick it
    was not measured.
    """
    since_start_s = recording.time_s - recording.time_s[0]
    for tick in range(math.floor(recording.duration_s / TICK_S + 1e-9) + 1):
        time_s = tick * TICK_S
        index = int(np.argmin(np.abs(since_start_s - time_s)))
        measured = abs(since_start_s[index] - time_s) <= TICK_S / 2
        yield state_at(recording, contact, index, time_s) if measured else nothing_at(time_s)


def measurements(states: Iterable[State]) -> Iterator[tuple[float, Messages]]:
    """(time, messages of one set). NaN is sent as not available, with no contact.

    The wearer follows no plan, so the command is to stand.
    """
    for state in states:
        yield (
            state["t_s"],
            {
                "COMMAND": {"MODE": 0, "SPEED": 0.0, "HEEL_STRIKE": 0.0},
                "MEASURED_TIME": {"TIME": round(state["t_s"] * 1e6) % TIMES, "CODE": 0},
                "MEASURED_COM": {
                    "HEIGHT": state["com_z_m"],
                    "VX": state["com_vx_m_s"],
                    "VY": state["com_vy_m_s"],
                },
                "MEASURED_LEFT": _foot(state, "left"),
                "MEASURED_RIGHT": _foot(state, "right"),
            },
        )


def _foot(state: State, side: str) -> dict[str, float]:
    return {
        "X": state[f"{side}_x_m"] - state["com_x_m"],
        "Y": state[f"{side}_y_m"] - state["com_y_m"],
        "CONTACT": state[f"{side}_contact"] == 1,
    }


def play_lockstep(
    bus: can.BusABC, sets: Iterator[tuple[float, Messages]]
) -> Iterator[tuple[float, Signals]]:
    """Send each set when the previous one is answered; yields (time of the set, its scores).

    Raises UserError when no answer comes.
    """
    sender, reader = Sender(), TickReader()
    for time_s, measured in sets:
        _send(bus, sender, measured)
        messages = next_tick(bus, reader.feed, ANSWER_TIMEOUT_S)
        if messages is None:
            raise UserError(
                f"the firmware did not answer the measurements at {time_s:.2f} s in "
                f"{ANSWER_TIMEOUT_S:g} s: {reader.receiver.accepted} frames were received, "
                f"{reader.receiver.rejected} were rejected"
            )
        yield time_s, scores_of(messages)


def play_realtime(
    bus: can.BusABC, sets: Iterator[tuple[float, Messages]]
) -> Iterator[tuple[float, Signals]]:
    """Send each set when it is due; yields (time of the latest set, scores) as received."""
    sender, reader = Sender(), TickReader()
    start_s = time.monotonic()
    for time_s, measured in sets:
        _send(bus, sender, measured)
        due_s = start_s + time_s + TICK_S
        while messages := next_tick(bus, reader.feed, due_s - time.monotonic()):
            yield time_s, scores_of(messages)


def _send(bus: can.BusABC, sender: Sender, messages: Messages) -> None:
    """Send frames. If the bus has no room a frame is lost; the firmware sees its age."""
    for name, signals in messages.items():
        with contextlib.suppress(can.CanOperationError):
            bus.send(sender.frame(name, **signals))
