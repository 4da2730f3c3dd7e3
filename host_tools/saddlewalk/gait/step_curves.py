"""The recorded walk between passing one foot and the next, curve by curve: what a plan is compared
with and a person's shape fitted to."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from saddlewalk.gait.events import FootEvents, Placement, passing, placements
from saddlewalk.gait.recording import Recording

LONGEST_STEP_S = 3.0  # between heel strikes further apart one was missed


@dataclass(frozen=True)
class StepCurve:
    """From the instant at which the CoM passes a foot that lies flat until it passes the next."""

    side: int  # that is passed first
    elapsed_s: np.ndarray  # (n,)
    com_x_m: np.ndarray  # from the foot that is passed
    com_y_m: np.ndarray  # from the line midway between the feet
    com_z_m: np.ndarray
    foot_m: (
        np.ndarray
    )  # (2, n, 3) x from the foot that is passed, y from that line, z from the ground
    landing_m: float  # x of the next foot from the one that is passed
    heel_strike_s: float  # NaN: not seen

    @property
    def outward(self) -> int:
        """Of the foot that is passed: 1 for the left, whose side is that of +y."""
        return 1 - 2 * self.side


def step_curves(recording: Recording, events: tuple[FootEvents, FootEvents]) -> list[StepCurve]:
    placed = placements(recording)
    curves = []
    for i, (stance, to) in enumerate(pairwise(placed)):
        passed, next_passed = passing(recording, stance), passing(recording, to)
        if stance.side == to.side or passed is None or next_passed is None:
            continue
        (first, start_s), (end, end_s) = passed, next_passed
        if not 0 < end_s - start_s <= LONGEST_STEP_S:
            continue
        span = slice(first, end)
        share = (recording.time_s[span] - start_s) / (end_s - start_s)
        line_y_m = (1 - share) * _midway_m(placed, i) + share * _midway_m(placed, i + 1)
        strikes = events[to.side].heel_strikes
        struck = strikes[(strikes >= first) & (strikes < end)]
        origin_m = np.stack(
            [np.full_like(share, stance.cop_m[0]), line_y_m, np.zeros_like(share)], axis=1
        )
        com_m = recording.com_m[span] - origin_m
        curves.append(
            StepCurve(
                side=stance.side,
                elapsed_s=recording.time_s[span] - start_s,
                com_x_m=com_m[:, 0],
                com_y_m=com_m[:, 1],
                com_z_m=com_m[:, 2],
                foot_m=(recording.heel_m[:, span] + recording.toe_m[:, span]) / 2 - origin_m,
                landing_m=to.cop_m[0] - stance.cop_m[0],
                heel_strike_s=recording.time_s[struck[0]] - start_s if len(struck) else np.nan,
            )
        )
    return curves


def _midway_m(placed: Sequence[Placement], index: int) -> float:
    """y midway between a foot and the other one, which lands before and after it; beyond the first
    and the last placement the other foot is taken to drift aside as this one does."""
    at_m = {}
    for k in range(max(-2, -index), min(3, len(placed) - index)):
        if (placed[index + k].side == placed[index].side) == (k % 2 == 0):
            at_m[k] = float(placed[index + k].cop_m[1])
    others_m = [at_m[k] for k in (-1, 1) if k in at_m]
    if len(others_m) == 1:
        k = 1 if 1 in at_m else -1
        others_m.append(at_m[k] + at_m[0] - at_m.get(2 * k, at_m[0]))
    return (at_m[0] + sum(others_m) / len(others_m)) / 2
