"""Cross-validation of thresholds and probabilities on synthetic walks."""

import math

import numpy as np
import pytest

from saddlewalk.evaluation.cross_validation import leave_one_out
from saddlewalk.evaluation.scoring import Score

pytestmark = pytest.mark.firmware

TICK_S = 0.08
PUSH_S = 10.0


def walk(margin, fall_after_s: float = math.nan) -> Score:
    """A pushed walk whose margin took this course, a number a tick."""
    after_s = TICK_S * np.arange(len(margin))
    return Score(
        name="",
        kind="random",
        push_s=PUSH_S,
        fall_s=PUSH_S + fall_after_s,
        ground_s=math.nan,
        alarm_s=math.nan,
        alarm_at_push=False,
        least={},
        levels={},
        exposed={},
        course=np.column_stack([after_s, np.array(margin, dtype=float)]),
        stumble=None,
        out_before_push=False,
    )


def walker(limit: float, count: int = 60) -> list[Score]:
    """Falls below the limit, 0.4 s after its margin got there."""
    lowest = np.linspace(limit - 0.2, limit + 0.2, count)
    walks = []
    for low in lowest:
        way = np.r_[np.linspace(0.4, low, 6), np.full(20, low)]
        fell = low < limit
        walks.append(walk(way[:10] if fell else way, 10 * TICK_S if fell else math.nan))
    return walks


def test_the_threshold_is_fitted_to_the_other_walkers():
    found = leave_one_out({"a": walker(0.05), "b": walker(-0.05)})
    assert found["a"].threshold == pytest.approx(-0.05, abs=0.011)
    assert found["b"].threshold == pytest.approx(0.05, abs=0.011)
    assert found["a"].timely_pct < 60 and found["a"].alarm_though_upright_pct == 0
    assert found["b"].timely_pct == 100 and found["b"].alarm_though_upright_pct > 40


def test_emulated_wearers_are_not_fitted_to_each_other():
    scores = {"emulated_planned": walker(0.0), "emulated_recovery": walker(0.0)}
    assert leave_one_out(scores) == {}
    found = leave_one_out({**scores, "robot": walker(0.08)})
    assert found["emulated_planned"].threshold == pytest.approx(0.08, abs=0.011)
    assert found["robot"].threshold == pytest.approx(0.0, abs=0.011)


def test_walkers_without_pushes_or_falls_are_not_fitted():
    upright = [walk([0.2] * 20)]
    assert leave_one_out({"a": walker(0.0), "b": upright}) == {}


def test_probability_is_calibrated_between_walkers_of_a_kind_and_not_between_others():
    """Falls drawn by a logistic law of the margin; the same law, and one that is shifted by 0.3."""

    def drawn(shift: float, seed: int) -> list[Score]:
        random = np.random.default_rng(seed)
        walks = []
        for margin in random.uniform(-0.4, 0.4, 3000):
            fell = random.random() < 1 / (1 + math.exp(10 * (margin - shift)))
            walks.append(walk([margin], 0.5 if fell else math.nan))
        return walks

    same = leave_one_out({"a": drawn(0.0, 1), "b": drawn(0.0, 2)})["a"]
    assert same.zero_margin_probability == pytest.approx(0.5, abs=0.03)
    assert same.brier < 0.6 * same.brier_of_base_rate
    assert all(abs(predicted - true) < 0.1 for predicted, true, _ in same.reliability)
    assert sum(ticks for *_, ticks in same.reliability) == 3000
    other = leave_one_out({"a": drawn(0.0, 1), "b": drawn(0.3, 2)})["a"]
    assert other.zero_margin_probability == pytest.approx(0.95, abs=0.02)
    assert other.brier > 2 * same.brier
