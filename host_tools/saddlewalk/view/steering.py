"""What a page commands of an emulated wearer, in the place of its schedule."""

import cmath
import math
from dataclasses import replace

from saddlewalk.core import Command
from saddlewalk.emulation.exoskeleton import Observer
from saddlewalk.emulation.wearer import Push, Wearer
from saddlewalk.planning.schedule import Schedule
from saddlewalk.view.beside import PageBeside

SCHEDULE, PAGE = "by the schedule", "by this page"


class Steering(Observer):
    """A schedule until a page commands another speed; pushes the wearer, and ends the walk.

    The page shows who commands.
    """

    def __init__(self, schedule: Schedule, wearer: Wearer, page: PageBeside) -> None:
        self._schedule, self._wearer, self._page = schedule, wearer, page
        self._speed_m_s: float | None = None  # None: the schedule's
        page.tell(commander=SCHEDULE)

    def __call__(self, time_s: float) -> Command:
        command = self._schedule(time_s)
        if self._speed_m_s is None:
            return command
        return replace(command, speed_m_s=self._speed_m_s or None)

    def poll(self) -> None:
        for control in self._page.controls():
            if "push" in control:
                size, angle = cmath.polar(complex(*control["push"]))
                push = Push(size, self._wearer.time_s, math.degrees(angle))
                self._wearer.pushes = (*self._wearer.pushes, push)
            if "speed" in control:
                self._speed_m_s = control["speed"]
                self._page.tell(commander=SCHEDULE if self._speed_m_s is None else PAGE)
            self.finished = self.finished or "end" in control
