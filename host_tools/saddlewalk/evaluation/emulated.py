"""An emulated walk in the terms by which every walker is scored.

Two supervisors watch it: the one that leads the wearer, by noisy sensors, and one beside it that is
given the same commands and the exact state.
"""

from typing import Any

import numpy as np

from saddlewalk.core import Core
from saddlewalk.emulation import closed_loop
from saddlewalk.emulation.wearer import WALKING, Body, Measurement, Wearer
from saddlewalk.evaluation.baselines import half_foot_m
from saddlewalk.evaluation.scoring import (
    INPUTS,
    Score,
    Walk,
    announced,
    scores_by_inputs,
    states_of,
)
from saddlewalk.planning.schedule import Schedule
from saddlewalk.recorded_states import score_row
from saddlewalk.table import Cell


class Witness:
    """Sees every tick of a walk, and scores it when it is over."""

    def __init__(self, config: Any, schedule: Schedule) -> None:
        body = Body.of(config)
        self._pendulum_m, self._half_sole_m = body.pendulum_m, half_foot_m(body.height_m)
        self._beside, self._schedule = Core(config), schedule
        self._modes: list[int] = []
        self._exact: list[tuple[float, ...]] = []
        self._noisy: list[tuple[float, ...]] = []
        self._said_of_exact: list[list[Cell]] = []
        self._said_of_noisy: list[list[Cell]] = []

    def see(self, tick: closed_loop.Tick, wearer: Wearer) -> None:
        measured = closed_loop.measurement_of(tick.exact)
        now_us, command = round(tick.time_s * 1e6), self._schedule(tick.time_s)
        beside = self._beside.tick(now_us, command, measured)
        self._modes.append(tick.plan.mode)
        self._exact.append(_numbers(tick.time_s, wearer.com_m, tick.exact))
        self._noisy.append(_numbers(tick.time_s, wearer.com_m, tick.measured))
        self._said_of_exact.append(score_row(tick.time_s, beside))
        self._said_of_noisy.append(score_row(tick.time_s, tick.output))

    def scores(self, kind: str, push_s: float, fall_s: float) -> dict[str, list[Score]]:
        """By INPUTS, from the first tick of walking on; "start_stop" is whole, and also "calm"."""
        walking = np.array(self._modes) == WALKING
        if kind == "start_stop":
            parts = {"calm": walking, kind: np.ones_like(walking)}
        else:
            parts = {kind: np.logical_or.accumulate(walking)}
        fate = {"push_s": push_s, "fall_s": fall_s, "ground_s": np.nan}
        scored = [
            self._score(np.flatnonzero(there), name="", kind=part, **fate)
            for part, there in parts.items()
            if there.any()
        ]
        return {name: [each[name] for each in scored] for name in INPUTS}

    def _score(self, there: np.ndarray, **fields: Any) -> dict[str, Score]:
        exact, noisy = (states_of([rows[k] for k in there]) for rows in (self._exact, self._noisy))
        walk = Walk(
            **fields, states=exact, half_sole_m=self._half_sole_m, pendulum_m=self._pendulum_m
        )
        said = (
            announced(walk, [rows[k] for k in there], seen)
            for rows, seen in ((self._said_of_exact, exact), (self._said_of_noisy, noisy))
        )
        return scores_by_inputs(walk, *said)


def _numbers(time_s: float, com_m: complex, seen: Measurement) -> tuple[float, ...]:
    """In the order of STATE_COLUMNS."""
    left_m, right_m = (com_m + foot_m for foot_m in seen.feet_m)
    return (
        *(time_s, com_m.real, com_m.imag, seen.height_m),
        *(seen.velocity_m_s.real, seen.velocity_m_s.imag),
        *(left_m.real, left_m.imag, right_m.real, right_m.imag, *seen.contact),
    )
