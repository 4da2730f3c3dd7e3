"""Emulated walks in the common form for scoring."""

from typing import Any

import numpy as np

from saddlewalk.contract import WALKING
from saddlewalk.emulation import closed_loop
from saddlewalk.emulation.wearer import Body, Measurement, Wearer
from saddlewalk.evaluation.baselines import half_foot_m
from saddlewalk.evaluation.scoring import Announced, Walk, announced, states_of
from saddlewalk.recorded_states import score_row
from saddlewalk.table import Cell


class TickRecorder:
    """Records every tick of a walk with the supervisor's output."""

    def __init__(self, config: Any) -> None:
        body = Body.of(config)
        self._pendulum_m, self._half_sole_m = body.pendulum_m, half_foot_m(body.height_m)
        self._modes: list[int] = []
        self._true: list[tuple[float, ...]] = []
        self._seen: list[tuple[float, ...]] = []
        self._said: list[list[Cell]] = []

    def see(self, tick: closed_loop.Tick, wearer: Wearer) -> None:
        self._modes.append(tick.plan.mode)
        self._true.append(_numbers(tick.time_s, wearer.com_m, tick.exact))
        self._seen.append(_numbers(tick.time_s, wearer.com_m, tick.measured))
        self._said.append(score_row(tick.time_s, tick.output))

    def parts(self, kind: str, push_s: float, fall_s: float) -> list[tuple[Walk, Announced]]:
        """The walk from its first walking tick on; a "start_stop" walk whole, and its steady part
        as "calm".
        """
        walking = np.array(self._modes) == WALKING
        if kind == "start_stop":
            there = {"calm": walking, kind: np.ones_like(walking)}
        else:
            there = {kind: np.logical_or.accumulate(walking)}
        fate = {"push_s": push_s, "fall_s": fall_s, "ground_s": np.nan}
        return [
            self._part(np.flatnonzero(ticks), name="", kind=part, **fate)
            for part, ticks in there.items()
            if ticks.any()
        ]

    def _part(self, ticks: np.ndarray, **fields: Any) -> tuple[Walk, Announced]:
        walk = Walk(
            **fields,
            states=states_of([self._true[k] for k in ticks]),
            half_sole_m=self._half_sole_m,
            pendulum_m=self._pendulum_m,
        )
        seen = states_of([self._seen[k] for k in ticks])
        return walk, announced(walk, [self._said[k] for k in ticks], seen)


def _numbers(time_s: float, com_m: complex, seen: Measurement) -> tuple[float, ...]:
    """Values in the order of STATE_COLUMNS."""
    left_m, right_m = (com_m + foot_m for foot_m in seen.feet_m)
    return (
        *(time_s, com_m.real, com_m.imag, seen.height_m),
        *(seen.velocity_m_s.real, seen.velocity_m_s.imag),
        *(left_m.real, left_m.imag, right_m.real, right_m.imag, *seen.contact),
    )
