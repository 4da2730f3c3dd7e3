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
    """A schedule until a page commands another speed or turn; pushes the wearer, and ends the walk.

    The page shows who commands.
    """

    def __init__(self, schedule: Schedule, wearer: Wearer, page: PageBeside) -> None:
        self._schedule, self._wearer, self._page = schedule, wearer, page
        self._speed_m_s: float | None = None  # None: the schedule's
        self._turn_rad_s: float | None = None
        page.tell(commander=SCHEDULE)

    def __call__(self, time_s: float) -> Command:
        command = self._schedule(time_s)
        if self._speed_m_s is not None:
            command = replace(command, speed_m_s=self._speed_m_s or None)
        if self._turn_rad_s is not None:
            command = replace(command, turn_rate_rad_s=self._turn_rad_s)
        return command

    def poll(self) -> None:
        for control in self._page.controls():
            if "push" in control:
                size, angle = cmath.polar(complex(*control["push"]))
                push = Push(size, self._wearer.time_s, math.degrees(angle))
                self._wearer.pushes = (*self._wearer.pushes, push)
            self._speed_m_s = control.get("speed", self._speed_m_s)
            self._turn_rad_s = control.get("turn", self._turn_rad_s)
            scheduled = self._speed_m_s is None and self._turn_rad_s is None
            self._page.tell(commander=SCHEDULE if scheduled else PAGE)
            self.finished = self.finished or "end" in control
