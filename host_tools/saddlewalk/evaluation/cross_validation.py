"""Leave-one-out cross-validation: each kind of walker is evaluated with the fit to the others.

It shows whether one threshold fits all, and whether the margin predicts the probability of a fall.

Emulated wearers are one kind, with planned or recovery steps; every recorded walker is its own
kind.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from rich.table import Table

from saddlewalk.evaluation.scoring import EVIDENCE_S, ROUNDING_S, TIMELY_S, Score, percent

HORIZON_S = 1.0  # of the probability: a fall within so long
THRESHOLDS = np.arange(-0.1, 0.1001, 0.01)  # of the margin
BINS = np.linspace(0.0, 1.0, 11)
LEAST_IN_BIN = 20  # ticks in a bin that is shown
EMULATED = "emulated"


@dataclass(frozen=True)
class CrossValidation:
    """A walker's figures with the threshold and the probability fitted to the others."""

    threshold: float  # of the margin: best timely minus false alarms of the others
    timely_pct: float
    alarm_though_upright_pct: float
    zero_margin_probability: float  # of a fall within HORIZON_S at margin 0, fitted to the others
    brier: float  # mean square of probability minus outcome, over the ticks after a push
    brier_of_base_rate: float  # of a constant prediction: the walker's own share of falls
    reliability: list[tuple[float, float, int]]  # predicted share, observed share, ticks


def leave_one_out(scores: Mapping[str, Sequence[Score]]) -> dict[str, CrossValidation]:
    """Figures by walker; empty unless there are two kinds of pushed walkers."""
    pushed = {name: [s for s in each if s.pushed] for name, each in scores.items()}
    pushed = {name: each for name, each in pushed.items() if _both(each)}
    found = {}
    for name, mine in pushed.items():
        others = [each for other, each in pushed.items() if _kind(other) != _kind(name)]
        if others:
            found[name] = _figures(mine, others)
    return found


def _both(scores: Sequence[Score]) -> bool:
    return any(each.fell for each in scores) and not all(each.fell for each in scores)


def _kind(name: str) -> str:
    return EMULATED if name.startswith(EMULATED) else name


def _figures(mine: Sequence[Score], others: Sequence[Sequence[Score]]) -> CrossValidation:
    gains = [[np.subtract(*_rates(each, at)) for at in THRESHOLDS] for each in others]
    threshold = float(THRESHOLDS[np.argmax(np.mean(gains, axis=0))])
    timely_pct, false_pct = _rates(mine, threshold)
    line = _fit([_ticks(each) for each in others])
    margin, falls = _ticks(mine)
    predicted = _probability(line, margin)
    return CrossValidation(
        threshold=threshold,
        timely_pct=timely_pct,
        alarm_though_upright_pct=false_pct,
        zero_margin_probability=float(_probability(line, np.zeros(1))[0]),
        brier=float(np.mean((predicted - falls) ** 2)),
        brier_of_base_rate=float(np.mean((falls.mean() - falls) ** 2)),
        reliability=_reliability(predicted, falls),
    )


def _rates(scores: Sequence[Score], threshold: float) -> tuple[float, float]:
    """Percentage of falls with a timely alarm, and of other walks with any alarm."""
    first_s = [_first_alarm_s(each, threshold) for each in scores]
    pairs = list(zip(scores, first_s, strict=True))
    latest_s = TIMELY_S - ROUNDING_S
    return (
        percent(s.fall_s - s.push_s - at_s >= latest_s for s, at_s in pairs if s.fell),
        percent(math.isfinite(at_s) for s, at_s in pairs if not s.fell),
    )


def _first_alarm_s(score: Score, threshold: float) -> float:
    """Time of the first alarm after the push; infinite if there is none."""
    after_s, margin = score.course.T
    alarms_s = after_s[margin <= threshold]
    return float(alarms_s[0]) if len(alarms_s) else math.inf


def _ticks(scores: Sequence[Score]) -> tuple[np.ndarray, np.ndarray]:
    """Margins in the first EVIDENCE_S after each push, and whether a fall came within HORIZON_S."""
    margins, falls = [], []
    for each in scores:
        after_s, margin = each.course.T
        there = np.isfinite(margin) & (after_s < EVIDENCE_S)
        margins.append(margin[there])
        falls.append(after_s[there] >= each.fall_s - each.push_s - HORIZON_S)  # NaN: never
    return np.concatenate(margins), np.concatenate(falls).astype(float)


def _probability(line: np.ndarray, margin: np.ndarray) -> np.ndarray:
    return 1.0 / (1.0 + np.exp(-np.clip(line[0] + line[1] * margin, -30.0, 30.0)))


def _fit(walkers: Sequence[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Logistic regression of falls on the margin by Newton's method; equal weight per walker."""
    margin, falls = (np.concatenate(parts) for parts in zip(*walkers, strict=True))
    weight = np.concatenate([np.full(len(m), 1.0 / len(m)) for m, _ in walkers])
    design = np.column_stack([np.ones_like(margin), margin])
    line = np.zeros(2)
    for _ in range(30):
        predicted = _probability(line, margin)
        slope = design.T @ (weight * (falls - predicted))
        bend = (design * (weight * predicted * (1.0 - predicted))[:, None]).T @ design
        line = line + np.linalg.solve(bend + 1e-9 * np.eye(2), slope)
    return line


def _reliability(predicted: np.ndarray, falls: np.ndarray) -> list[tuple[float, float, int]]:
    where = np.clip(np.digitize(predicted, BINS) - 1, 0, len(BINS) - 2)
    shown = [where == index for index in range(len(BINS) - 1)]
    return [
        (float(predicted[there].mean()), float(falls[there].mean()), int(there.sum()))
        for there in shown
        if there.sum() >= LEAST_IN_BIN
    ]


def table(found: Mapping[str, CrossValidation]) -> Table:
    shown = Table(
        title="Leave-one-out: each kind of walker with the threshold from the others",
        title_justify="left",
    )
    shown.add_column("")
    for name in found:
        shown.add_column(name.replace("_", " "), justify="right")
    rows = {
        "alarm at a margin of": lambda f: f"{f.threshold:+.2f}",
        "... falls 0.24 s before": lambda f: f"{f.timely_pct:.1f} %",
        "... walks without a fall": lambda f: f"{f.alarm_though_upright_pct:.1f} %",
        "probability of a fall at margin 0": lambda f: f"{f.zero_margin_probability:.2f}",
        "Brier score": lambda f: f"{f.brier:.3f}",
        "... of a constant prediction": lambda f: f"{f.brier_of_base_rate:.3f}",
    }
    for label, cell in rows.items():
        shown.add_row(label, *map(cell, found.values()))
    return shown
