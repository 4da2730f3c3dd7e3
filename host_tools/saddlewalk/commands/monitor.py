"""`saddlewalk monitor`: what the firmware publishes on LCM, live in the terminal."""

import argparse
import sys
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from saddlewalk.dashboard import Heard

REFRESH_S = 0.2
LINE_S = 1.0
ONCE_S = 2.0
CHANNELS = {
    "SADDLEWALK_PLAN": "plan_t",
    "SADDLEWALK_SCORES": "scores_t",
    "SADDLEWALK_VERDICT": "verdict_t",
    "SADDLEWALK_BALANCE": "balance_t",
    "SADDLEWALK_HEALTH": "health_t",
    "SADDLEWALK_STATUS": "status_t",
}
TRUTH = "SADDLEWALK_TRUTH"  # of an emulated wearer, who may have fallen


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser("monitor", help="show what the firmware publishes, live")
    parser.add_argument("--lcm", metavar="URL", help="default: udpm on this machine")
    parser.add_argument(
        "--once",
        action="store_true",
        help=f"print one line and exit; status 1 if a channel is missing after {ONCE_S:g} s",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.transport.lcmbus import open_lcm

    bus = open_lcm(args.lcm)
    listener = Listener()
    listener.subscribe(bus)
    if args.once:
        return _once(bus, listener)
    try:
        _watch(bus, listener)
    except KeyboardInterrupt:
        return 0


@dataclass
class Listener:
    """The newest message of each channel, the time of the last one, and unreadable ones."""

    latest: dict[str, Any] = field(default_factory=dict)
    truth: tuple[float, Any] | None = None  # when it came, and what
    heard_s: float = field(default_factory=time.monotonic)
    malformed: int = 0

    def subscribe(self, bus: Any) -> None:
        for channel in (*CHANNELS, TRUTH):
            bus.subscribe(channel, self.take)

    def take(self, channel: str, data: bytes) -> None:
        """A message that cannot be decoded is counted and changes nothing else."""
        from saddlewalk.transport import lcm_types

        try:
            message = getattr(lcm_types, CHANNELS.get(channel, "truth_t")).decode(data)
        except Exception:  # the generated decoders raise ValueError, struct.error or IndexError
            self.malformed += 1
            return
        if channel == TRUTH:
            self.truth = time.monotonic(), message
            return
        self.latest[channel] = message
        self.heard_s = time.monotonic()

    @property
    def fallen(self) -> bool:
        """Whether the wearer has fallen, by messages that are not old."""
        from saddlewalk.dashboard import SILENT_AFTER_S

        if self.truth is None:
            return False
        told_s, truth = self.truth
        return bool(truth.fallen) and time.monotonic() - told_s < SILENT_AFTER_S

    @property
    def complete(self) -> bool:
        return self.latest.keys() == CHANNELS.keys()

    def line(self) -> str:
        """What was received, as a line of plain text."""
        from saddlewalk.dashboard import summary

        return summary(self._heard()) + (f" | {self._note()}" if self.malformed else "")

    def panel(self) -> Any:
        """What was received, as a panel for a terminal."""
        from rich.console import Group

        from saddlewalk.dashboard import render

        panel = render(self._heard())
        return Group(panel, self._note()) if self.malformed else panel

    def _heard(self) -> "Heard":
        from saddlewalk.dashboard import Heard

        latest = {kind.removesuffix("_t"): self.latest.get(c) for c, kind in CHANNELS.items()}
        return Heard(**latest, silent_s=time.monotonic() - self.heard_s, fallen=self.fallen)

    def _note(self) -> str:
        return f"{self.malformed} LCM messages could not be read"


def _once(bus: Any, listener: Listener) -> int:
    from saddlewalk.transport.lcmbus import receive

    deadline_s = time.monotonic() + ONCE_S
    while not listener.complete and (left_s := deadline_s - time.monotonic()) > 0:
        receive(bus, left_s)
    print(listener.line())
    return 0 if listener.complete else 1


def _watch(bus: Any, listener: Listener) -> NoReturn:
    """Until Ctrl-C: a live panel on a terminal, else a line per second."""
    if sys.stdout.isatty():
        _watch_panel(bus, listener)
    else:
        _watch_lines(bus, listener)


def _watch_panel(bus: Any, listener: Listener) -> NoReturn:
    from rich.live import Live

    from saddlewalk.transport.lcmbus import listen

    with Live(listener.panel(), auto_refresh=False) as live:
        while True:
            listen(bus, REFRESH_S)
            live.update(listener.panel(), refresh=True)


def _watch_lines(bus: Any, listener: Listener) -> NoReturn:
    from saddlewalk.transport.lcmbus import listen

    while True:
        listen(bus, LINE_S)
        print(listener.line(), flush=True)
