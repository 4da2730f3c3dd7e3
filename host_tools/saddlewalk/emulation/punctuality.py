"""Whether the computer kept up with a walk in real time."""

import math
from dataclasses import dataclass, field

STALL_S = 0.02  # later measurements reach the tick after the one on an idle computer
BEFORE_S = 3.0  # a fall takes up to two steps


@dataclass
class Stall:
    """The wearer's process did not run for late_s, at time_s of the walk."""

    time_s: float
    late_s: float


@dataclass
class Punctuality:
    """How late the wearer's process measures, and the longest gap between ticks."""

    worst_s: float = 0.0
    gap_s: float = 0.0  # longest time between two ticks, as received
    stalls: list[Stall] = field(default_factory=list)
    _late_s: float = 0.0
    _tick_s: float = math.nan

    def measured(self, time_s: float, late_s: float) -> None:
        """A measurement was sent at time_s of the walk, late_s late."""
        self.worst_s = max(self.worst_s, late_s)
        if late_s > STALL_S and self._late_s <= STALL_S:
            self.stalls.append(Stall(time_s, late_s))
        elif late_s > STALL_S:  # not yet caught up, or stalled again
            self.stalls[-1].late_s = max(self.stalls[-1].late_s, late_s)
        self._late_s = late_s

    def ticked(self, now_s: float) -> None:
        """A tick was received, by the monotonic clock."""
        self.gap_s = max(self.gap_s, now_s - self._tick_s)  # NaN for the first
        self._tick_s = now_s

    def stall_before(self, time_s: float) -> Stall | None:
        """The longest stall in the last seconds before time_s."""
        near = [stall for stall in self.stalls if 0 <= time_s - stall.time_s <= BEFORE_S]
        return max(near, key=lambda stall: stall.late_s, default=None)

    def words(self) -> str:
        stalled = f", {len(self.stalls)} stalls" if self.stalls else ""
        return (
            f"measurements at most {self.worst_s * 1e3:.0f} ms late{stalled}, ticks at most "
            f"{self.gap_s * 1e3:.0f} ms apart"
        )
