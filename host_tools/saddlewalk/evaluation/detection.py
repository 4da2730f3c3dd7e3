"""Prediction of falls: rates, lead times and ROC of the evaluated walks."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from saddlewalk.evaluation.scoring import area, known
from saddlewalk.evaluation.walks import KINDS, MARGINS, WARNING_MIN_S, WINDOWS, Walk
from saddlewalk.verdict import level_name, reason_name


@dataclass(frozen=True)
class Detection:
    """Results for one kind of wearer. Shares are from 0 to 1, NaN without any walk."""

    pushed: int
    fallen: int
    sensitivity: float  # falls with an alarm between push and fall
    timely: float  # falls with an alarm at least WARNING_MIN_S before
    false_alarms: float  # pushed walks with an alarm but no fall
    lead_median_s: float  # from the first alarm to the fall
    lead_tenth_s: float  # 10th percentile
    walking_levels: dict[str, int]  # ticks of unperturbed steady walking
    walking_reasons: dict[str, int]
    moving_levels: dict[str, int]  # starts and stops included
    calm_falls: int  # unperturbed walks that ended in a fall
    areas: dict[str, dict[str, float]]  # under each margin's ROC curve, by window of evidence

    @property
    def alarm_share(self) -> float:
        """Share of unperturbed steady walking that is announced unstable."""
        return _share(self.walking_levels.get("unstable", 0), sum(self.walking_levels.values()))

    @property
    def moving_alarm_share(self) -> float:
        return _share(self.moving_levels.get("unstable", 0), sum(self.moving_levels.values()))


def detection_of(walks: Iterable[Walk]) -> Detection:
    """The results for the walks of one kind of wearer."""
    walks = list(walks)
    pushed = [walk for walk in walks if walk.trial.impulse_n_s > 0]
    fallen = [walk for walk in pushed if walk.fell]
    upright = [walk for walk in pushed if not walk.fell]
    leads_s = np.array([walk.lead_s for walk in fallen if math.isfinite(walk.lead_s)])
    return Detection(
        pushed=len(pushed),
        fallen=len(fallen),
        sensitivity=_share(len(leads_s), len(fallen)),
        timely=_share(int((leads_s >= WARNING_MIN_S).sum()), len(fallen)),
        false_alarms=_share(sum(math.isfinite(walk.alarm_at_s) for walk in upright), len(upright)),
        lead_median_s=float(np.median(leads_s)) if len(leads_s) else math.nan,
        lead_tenth_s=float(np.percentile(leads_s, 10)) if len(leads_s) else math.nan,
        walking_levels=_total((walk.walking_levels for walk in walks), level_name),
        walking_reasons=_total((walk.walking_reasons for walk in walks), reason_name),
        moving_levels=_total((walk.moving_levels for walk in walks), level_name),
        calm_falls=sum(walk.fell for walk in walks if walk.trial.impulse_n_s == 0),
        areas={
            window: {name: area(*evidence(pushed, window, name)) for name in MARGINS}
            for window in WINDOWS
        },
    )


def recovery_benefit(walks: Iterable[Walk]) -> dict[str, float]:
    """Effect of the recovery step on uniformly random pushes."""
    fell: dict[int, dict[str, bool]] = {}
    for walk in walks:
        if walk.trial.impulse_n_s > 0 and walk.trial.cell < 0:
            fell.setdefault(walk.trial.index, {})[walk.trial.kind] = walk.fell
    planned = np.array([by_kind[KINDS[0]] for by_kind in fell.values()], dtype=bool)
    recovery = np.array([by_kind[KINDS[1]] for by_kind in fell.values()], dtype=bool)
    return {
        "pushes": len(fell),
        "both_survive": _share((~planned & ~recovery).sum(), len(fell)),
        "recovery_alone_survives": _share((planned & ~recovery).sum(), len(fell)),
        "planned_alone_survives": _share((~planned & recovery).sum(), len(fell)),
        "both_fall": _share((planned & recovery).sum(), len(fell)),
    }


def push_limits(walks: Iterable[Walk]) -> dict[str, dict[int, float]]:
    """Impulse at which half fall, N s, by kind and cell: the staircase's mean after a turn."""
    stairs: dict[str, dict[int, list[Walk]]] = {kind: {} for kind in KINDS}
    for walk in walks:
        if walk.trial.cell >= 0:
            stairs[walk.trial.kind].setdefault(walk.trial.cell, []).append(walk)
    return {
        kind: {cell: _height(stair) for cell, stair in sorted(cells.items())}
        for kind, cells in stairs.items()
    }


def evidence(walks: Sequence[Walk], window: str, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Whether each walk ended in a fall, and its lowest margin; without walks of unknown margin."""
    fell = np.array([walk.fell for walk in walks], dtype=bool)
    least = np.array([walk.least[window][name] for walk in walks])
    return known(fell, least)


def _height(stair: list[Walk]) -> float:
    """Geometric mean of the pushes from the first turn on; NaN if there was none."""
    stair = sorted(stair, key=lambda walk: walk.trial.index)
    turns = [k for k in range(1, len(stair)) if stair[k].fell != stair[k - 1].fell]
    if not turns:
        return math.nan
    heights = [walk.trial.impulse_n_s for walk in stair[turns[0] :]]
    return float(np.exp(np.mean(np.log(heights))))


def _total(counts: Iterable[dict[int, int]], name: Callable[[int], str]) -> dict[str, int]:
    total: Counter[int] = Counter()
    for each in counts:
        total.update(each)
    return {name(code): total[code] for code in sorted(total)}


def _share(part: float, whole: int) -> float:
    return float(part) / whole if whole else math.nan
