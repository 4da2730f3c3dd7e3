"""The firmware's ticks in real time, each processed at its own time of the walk."""

import time
from collections.abc import Callable

import can

from saddlewalk.contract import TICK_S
from saddlewalk.errors import UserError
from saddlewalk.ticks import FrameBus, Messages, next_tick

WAKE_UP_S = 0.01  # measurements at 100 Hz
WAKE_UPS_A_TICK = round(TICK_S / WAKE_UP_S)
GRACE_S = 0.025  # maximum wait after a tick's time, since the firmware may be late too
ARRIVALS = 3  # ticks of which the earliest sets the clock
_COUNTS = 16  # of the alive counter


class PacedTicks:
    """Synchronises a clock to the firmware's ticks and returns each at its own wake-up.

    So a walk does not depend on when its process was started, nor, within limits, on how late one
    of the two is: a process that was late finds ticks in the queue whose time is yet to come.

    `begin_s`: when wake-up 0 is, by the monotonic clock. The firmware ticks midway between two
    wake-ups, so that each measurement is in time for the same tick.
    """

    def __init__(
        self, bus: FrameBus, hear: Callable[[can.Message], Messages | None], silence_s: float
    ) -> None:
        """Raises UserError if no tick comes for silence_s. hear() makes ticks of frames."""
        self._bus, self._hear = bus, hear
        self._held: Messages | None = None
        while next_tick(bus, hear, 0.0):  # their arrival times are unknown
            pass
        messages: Messages | None = None
        arrivals: list[float] = []
        while len(arrivals) < ARRIVALS:
            messages = next_tick(bus, hear, silence_s)
            if messages is None:
                raise UserError(f"no tick for {silence_s:g} s")
            arrivals.append(time.monotonic() - len(arrivals) * TICK_S)
        self.begin_s = min(arrivals) + (ARRIVALS - 1) * TICK_S + WAKE_UP_S / 2
        assert messages is not None
        self._counter, self._place = messages["HEALTH"]["COUNTER"], 0

    def at(self, wake_up: int, deadline_s: float) -> list[Messages]:
        """The ticks for this wake-up; returns at its deadline, or soon after."""
        ticks: list[Messages] = []
        while self._has_next(wake_up, deadline_s) and self._held is not None:
            ticks.append(self._held)
            self._held = None
        time.sleep(max(0.0, deadline_s - time.monotonic()))
        return ticks

    def _has_next(self, wake_up: int, deadline_s: float) -> bool:
        if self._held is None:
            self._receive(wake_up, deadline_s)
        return self._held is not None and self._place <= wake_up

    def _receive(self, wake_up: int, deadline_s: float) -> None:
        """Receive the next tick and keep it. A late process first catches up to its time."""
        now_s, due = time.monotonic(), self._place + WAKE_UPS_A_TICK
        if now_s >= deadline_s and wake_up < due:
            return
        until_s = max(now_s, deadline_s) + GRACE_S if wake_up == due else deadline_s
        self._held = next_tick(self._bus, self._hear, until_s - now_s)
        if self._held is None:
            return
        counter = self._held["HEALTH"]["COUNTER"]
        ticks = int(counter - self._counter) % _COUNTS or _COUNTS
        self._counter = counter
        on_time = time.monotonic() < deadline_s
        self._place = wake_up if on_time else self._place + ticks * WAKE_UPS_A_TICK
