"""Lockstep at the pace of real time."""

import time

from saddlewalk.contract import TICK_S

NOTICEABLE_S = 0.05  # any computer is late by some milliseconds


class Pace:
    """A walk that is late stays late: wearer and firmware stand still together while this computer
    is busy with something else, so what is seen is the firmware's doing.
    """

    def __init__(self) -> None:
        self.lent_s = 0.0  # by which the walk took longer than its own time
        self._due_s = time.monotonic()

    def wait(self) -> None:
        """Until a tick after the last return, if that is still to come."""
        self._due_s += TICK_S
        late_s = time.monotonic() - self._due_s
        if late_s > 0:
            self.lent_s += late_s
            self._due_s += late_s
        else:
            time.sleep(-late_s)

    def words(self) -> str:
        if self.lent_s < NOTICEABLE_S:
            return "in real time"
        return f"slower than real time by {self.lent_s:.2f} s, as this computer was busy"
