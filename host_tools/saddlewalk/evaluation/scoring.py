"""How well falls were announced: one set of definitions for emulated, simulated and recorded walks.

A Walk is what happened, Announced is the supervisor's output for it, tick by tick. Evidence is
the output after the push, up to 0.24 s before the fall: after that the fall is obvious.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from saddlewalk.contract import GRAVITY_M_S2, LEVELS, REASONS, TICK_S, UNKNOWN, UNSTABLE
from saddlewalk.evaluation.baselines import hof_margin_m, hull_margin_m
from saddlewalk.recorded_states import SCORE_COLUMNS, STATE_COLUMNS
from saddlewalk.table import Cell
from saddlewalk.verdict import level_name, reason_name

TIMELY_S = 3 * TICK_S
ROUNDING_S = 1e-6  # of differences between times of a table
EVIDENCE_S = 3.0  # after a push
# Name of a window -> the longest time after the push in which evidence is collected.
WINDOWS = {"roc_to_0.24_s_before": EVIDENCE_S, "roc_to_0.24_s_before_in_first_0.4_s": 0.4}
SETTLED_S = {"calm": 2.0, "start_stop": 0.0}  # by kind of walk: time before its levels count
INPUTS = ("exact", "noise", "one_tick_late")
STUMBLE_S = 1.0  # before and after an alarm
STUMBLE_M = 0.05  # distance of the XCoM outside the feet
WIDE_STEP = 2.0  # share of the usual width
FIRST_ROWS_S = 0.5  # first part of a recording, which is not steady yet

# Margin -> column of the supervisor's scores, and its sign: lower is nearer to a fall.
SCORED_MARGINS = {
    "level": ("level", -1),
    "ebos_xcom": ("ebos_xcom_m", 1),
    "ebos_com": ("ebos_com_m", 1),
    "mos_xcom": ("mos_xcom_m", 1),
    "mos_com": ("mos_com_m", 1),
    "excess_track": ("excess_track_j", -1),
    "s_sw": ("s_sw", 1),
    "recovery_margin": ("recovery_margin_m", 1),
    "margin": ("margin", 1),
}
BASELINES = ("hull_com", "hof_xcom")
MARGINS = (
    *(name for name, (column, _) in SCORED_MARGINS.items() if column in SCORE_COLUMNS),
    *BASELINES,
)

Levels = dict[str, dict[str, int]]  # level -> reason -> ticks


@dataclass(frozen=True)
class States:
    """The walker at each of n ticks; feet: left and right."""

    t_s: np.ndarray
    com_m: np.ndarray  # (n, 3)
    velocity_m_s: np.ndarray  # (n, 2)
    feet_m: np.ndarray  # (n, 2, 2)
    contact: np.ndarray  # (n, 2) of bool


@dataclass(frozen=True)
class Walk:
    """What happened. Times in s; NaN: did not happen."""

    name: str
    kind: str  # calm, start_stop, staircase or random
    push_s: float
    fall_s: float
    ground_s: float  # first ground contact of another part than a foot
    states: States
    half_sole_m: np.ndarray  # half of its length and width
    pendulum_m: float
    push_n_s: complex = 0j  # x forward + 1j * y to the left

    @property
    def fell(self) -> bool:
        return math.isfinite(self.fall_s)

    def xcom_m(self, states: States) -> np.ndarray:
        return states.com_m[:, :2] + states.velocity_m_s * math.sqrt(self.pendulum_m / GRAVITY_M_S2)


@dataclass(frozen=True)
class Announced:
    """The supervisor's output at each tick: indices of LEVELS and REASONS, and each margin."""

    level: np.ndarray
    reason: np.ndarray
    margins: dict[str, np.ndarray]


@dataclass(frozen=True)
class Stumble:
    """What happened within STUMBLE_S of an alarm without a fall."""

    xcom_out: bool  # the XCoM left the feet by STUMBLE_M
    further_out: bool  # this much more than before the push
    wide_step: bool


@dataclass(frozen=True)
class Score:
    """The score of a walk and its announcements."""

    name: str
    kind: str
    push_s: float
    fall_s: float
    ground_s: float
    alarm_s: float  # first unstable tick between the push and a fall
    alarm_at_push: bool
    least: dict[str, dict[str, float]]  # by window and margin
    levels: Levels  # of a walk without a push, after its first part
    exposed: Levels  # from the push to the fall, or to the end
    course: np.ndarray  # (n, 2): time after the push and margin, up to the fall or the end
    stumble: Stumble | None  # of an alarm without a fall
    out_before_push: bool  # the XCoM left the feet by STUMBLE_M

    @property
    def pushed(self) -> bool:
        return math.isfinite(self.push_s)

    @property
    def fell(self) -> bool:
        return math.isfinite(self.fall_s)

    @property
    def alarmed(self) -> bool:
        return math.isfinite(self.alarm_s)

    @property
    def lead_s(self) -> float:
        return self.fall_s - self.alarm_s

    @property
    def lead_to_ground_s(self) -> float:
        """Lead time to the fall or to ground contact, whichever comes first after the push."""
        ground_s = self.ground_s if self.ground_s > self.push_s else self.fall_s
        return min(self.fall_s, ground_s) - self.alarm_s

    def row(self) -> dict[str, Cell]:
        """A row of a table of walks."""
        return {
            **{name: getattr(self, name) for name in "name kind push_s fall_s alarm_s".split()},
            **{
                f"{name}, {longest_s:g} s": self.least[window][name]
                for window, longest_s in WINDOWS.items()
                for name in MARGINS
            },
        }


def states_of(rows: Sequence[Sequence[float]]) -> States:
    """From rows of STATE_COLUMNS."""
    columns = dict(zip(STATE_COLUMNS, np.array(rows, dtype=float).T, strict=True))

    def pick(*names: str) -> np.ndarray:
        return np.stack([columns[name] for name in names], axis=1)

    feet_m = [pick(f"{side}_x_m", f"{side}_y_m") for side in ("left", "right")]
    return States(
        t_s=columns["t_s"],
        com_m=pick("com_x_m", "com_y_m", "com_z_m"),
        velocity_m_s=pick("com_vx_m_s", "com_vy_m_s"),
        feet_m=np.stack(feet_m, axis=1),
        contact=pick("left_contact", "right_contact") > 0,
    )


def announced(walk: Walk, rows: Sequence[Sequence[Cell]], seen: States) -> Announced:
    """From rows of SCORE_COLUMNS, and the states that the supervisor was given."""
    columns: dict[str, Any] = dict(zip(SCORE_COLUMNS, zip(*rows, strict=True), strict=True))
    level = np.array([LEVELS.index(name) for name in columns["level"]])
    columns["level"] = np.where(level == UNKNOWN, np.nan, level)
    margins = {
        name: sign * np.array(columns[column], dtype=float)  # None becomes NaN
        for name, (column, sign) in SCORED_MARGINS.items()
        if column in columns
    }
    half = walk.half_sole_m
    margins["hull_com"] = hull_margin_m(seen.com_m[:, :2], seen.feet_m, half)
    margins["hof_xcom"] = hof_margin_m(walk.xcom_m(seen), seen.feet_m, seen.contact, half)
    reason = np.array([int(flags, 16) >> 24 for flags in columns["flags"]])
    return Announced(level, reason, margins)


def one_tick_late(announced: Announced) -> Announced:
    """The announcements if every measurement came a tick later; the first tick has none."""

    def delayed(values: np.ndarray, first: float) -> np.ndarray:
        return np.concatenate([[first], values[:-1]]).astype(values.dtype)

    return Announced(
        delayed(announced.level, UNKNOWN),
        delayed(announced.reason, REASONS.index("input")),
        {name: delayed(values, math.nan) for name, values in announced.margins.items()},
    )


def score(walk: Walk, announced: Announced) -> Score:
    t_s = walk.states.t_s
    after = t_s >= walk.push_s
    exposed = after & (t_s < walk.fall_s) if walk.fell else after
    alarms_s = t_s[exposed & (announced.level == UNSTABLE)]
    alarm_s = float(alarms_s[0]) if len(alarms_s) else math.nan
    before = np.flatnonzero(t_s < walk.push_s)
    out_m = hull_margin_m(walk.xcom_m(walk.states), walk.states.feet_m, walk.half_sole_m)
    usual = (t_s < walk.push_s) & (t_s > t_s[0] + FIRST_ROWS_S)
    stumbled = len(alarms_s) and not walk.fell
    settled = t_s > t_s[0] + SETTLED_S.get(walk.kind, math.inf)
    return Score(
        **{field: getattr(walk, field) for field in "name kind push_s fall_s ground_s".split()},
        alarm_s=alarm_s,
        alarm_at_push=bool(len(before)) and bool(announced.level[before[-1]] == UNSTABLE),
        least={window: _least(walk, announced, longest_s) for window, longest_s in WINDOWS.items()},
        levels=_levels_at(announced, settled),
        exposed=_levels_at(announced, exposed),
        course=np.column_stack([t_s - walk.push_s, announced.margins["margin"]])[exposed],
        stumble=_stumble(walk, out_m, usual, alarm_s) if stumbled else None,
        out_before_push=bool(out_m[usual].min(initial=math.inf) < -STUMBLE_M),
    )


def _least(walk: Walk, announced: Announced, longest_s: float) -> dict[str, float]:
    end_s = walk.push_s + longest_s
    if walk.fell:
        end_s = min(end_s, walk.fall_s - TIMELY_S)
    t_s = walk.states.t_s
    evidence = (t_s >= walk.push_s) & (t_s < end_s - ROUNDING_S)
    return {
        name: float(np.fmin.reduce(values[evidence], initial=np.nan))
        for name, values in announced.margins.items()
    }


def _stumble(walk: Walk, out_m: np.ndarray, usual: np.ndarray, alarm_s: float) -> Stumble:
    states = walk.states
    near = (states.t_s >= walk.push_s) & (abs(states.t_s - alarm_s) <= STUMBLE_S)
    struck = np.zeros(len(states.t_s), dtype=bool)
    struck[1:] = (states.contact[1:] & ~states.contact[:-1]).any(axis=1)
    width_m = states.feet_m[:, 0, 1] - states.feet_m[:, 1, 1]
    widest_m = width_m[struck & near].max(initial=-math.inf)
    usual_m = np.median(width_m[struck & usual]) if (struck & usual).any() else math.nan
    least_m = out_m[near].min()
    return Stumble(
        xcom_out=bool(least_m < -STUMBLE_M),
        further_out=bool(least_m < out_m[usual].min(initial=math.inf) - STUMBLE_M),
        wide_step=bool(widest_m > WIDE_STEP * usual_m),
    )


def _levels_at(announced: Announced, there: np.ndarray) -> Levels:
    return levels_in(np.column_stack([announced.level, announced.reason])[there].tolist())


def levels_in(announced: Iterable[Iterable[int]]) -> Levels:
    """Number of ticks at each level, by reason."""
    levels: Levels = {name: {} for name in LEVELS}
    for (level, reason), ticks in Counter(map(tuple, announced)).most_common():
        levels[level_name(level)][reason_name(reason)] = ticks
    return levels


def figures(scores: Sequence[Score], config: Mapping[str, str]) -> dict[str, Any]:
    """All figures of a walker by name, in percent or seconds; NaN without data.

    config: the configuration of its supervisor, as text.
    """
    pushed = [each for each in scores if each.pushed]
    return {
        "config": dict(config),
        "columns": SCORE_COLUMNS,
        "pushed": len(pushed),
        **_falls([each for each in pushed if each.fell]),
        **_upright([each for each in pushed if not each.fell]),
        "already_alarmed_at_push_pct": percent(each.alarm_at_push for each in pushed),
        "xcom_out_5cm_before_any_push_pct": percent(each.out_before_push for each in pushed),
        **_steady(scores),
        **_unknown([each.exposed for each in pushed]),
        **{window: _areas(pushed, window) for window in WINDOWS},
    }


def _falls(falls: Sequence[Score]) -> dict[str, Any]:
    lead_s = np.array([each.lead_s for each in falls])
    to_ground_s = np.array([each.lead_to_ground_s for each in falls])
    known_s = lead_s[np.isfinite(lead_s)]
    return {
        "falls": len(falls),
        "announced_pct": percent(np.isfinite(lead_s)),
        "timely_pct": percent(lead_s >= TIMELY_S - ROUNDING_S),
        "timely_before_ground_pct": percent(to_ground_s >= TIMELY_S - ROUNDING_S),
        "lead_median_s": float(np.median(known_s)) if len(known_s) else math.nan,
        "lead_p10_s": float(np.percentile(known_s, 10)) if len(known_s) else math.nan,
        "push_to_fall_median_s": float(np.median([each.fall_s - each.push_s for each in falls]))
        if falls
        else math.nan,
    }


def _upright(upright: Sequence[Score]) -> dict[str, Any]:
    stumbles = [each.stumble for each in upright if each.stumble]
    defined = sum(each.xcom_out or each.wide_step for each in stumbles)
    changed = sum(each.further_out or each.wide_step for each in stumbles)
    return {
        "alarm_though_upright_pct": percent(each.alarmed for each in upright),
        "of_random_pushes_pct": percent(each.alarmed for each in upright if each.kind == "random"),
        "alarms_though_upright": len(stumbles),
        "of_them_xcom_out_5cm": sum(each.xcom_out for each in stumbles),
        "of_them_xcom_5cm_further_out_than_before": sum(each.further_out for each in stumbles),
        "of_them_wide_step": sum(each.wide_step for each in stumbles),
        "real_stumbles_as_defined": defined,
        "no_stumble_as_defined": len(stumbles) - defined,
        "real_stumbles_by_change": changed,
        "no_stumble_by_change": len(stumbles) - changed,
    }


def _steady(scores: Sequence[Score]) -> dict[str, Any]:
    calm = [each.levels for each in scores if each.kind == "calm"]
    moving = [each for each in scores if each.kind == "start_stop"]
    there_and_back = [each.levels for each in moving if not each.fell]
    return {
        **calm_figures(calm),
        "start_stop_falls": sum(each.fell for each in moving),
        "start_stop": shares(there_and_back),
        **{
            f"start_stop_{level}_reasons": reason_shares(there_and_back, level)
            for level in ("unstable", "unknown")
        },
    }


def calm_figures(levels: Sequence[Levels]) -> dict[str, Any]:
    """Figures of steady walking without a push."""
    return {
        "calm": shares(levels),
        **{
            f"calm_{level}_reasons": reason_shares(levels, level)
            for level in ("unstable", "caution", "unknown")
        },
    }


def _unknown(levels: Sequence[Levels]) -> dict[str, Any]:
    return {
        "unknown_from_push_to_fall_pct": shares(levels)["unknown_pct"],
        "unknown_from_push_to_fall_reasons": dict(_reasons(levels, "unknown").most_common()),
    }


def shares(levels: Sequence[Levels]) -> dict[str, float]:
    ticks = {name: _reasons(levels, name).total() for name in LEVELS}
    total = sum(ticks.values())
    return {
        "minutes": total * TICK_S / 60,
        **{f"{name}_pct": 100 * ticks[name] / total if total else math.nan for name in LEVELS},
    }


def reason_shares(levels: Sequence[Levels], level: str) -> dict[str, float]:
    """Percentage of all ticks at this level, by reason."""
    total = sum(_reasons(levels, name).total() for name in LEVELS)
    return {why: 100 * n / total for why, n in _reasons(levels, level).most_common()}


def _reasons(levels: Iterable[Levels], level: str) -> Counter[str]:
    counts: Counter[str] = Counter()
    for each in levels:
        counts.update(each[level])
    return counts


def _areas(pushed: Sequence[Score], window: str) -> dict[str, float]:
    return {name: area(*evidence(pushed, window, name)) for name in MARGINS}


def evidence(pushed: Sequence[Score], window: str, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Whether each walk ended in a fall, and its lowest margin."""
    return known(
        np.array([each.fell for each in pushed], dtype=bool),
        np.array([each.least[window][name] for each in pushed]),
    )


def known(fell: np.ndarray, least: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Leave out walks whose margin was never known."""
    there = np.isfinite(least)
    return fell[there], least[there]


def area(fell: np.ndarray, least: np.ndarray) -> float:
    """Area under the ROC curve: the share of pairs of a fall and a walk without, in which the fall
    had the lower margin.

    A tie counts half; NaN without any pair.
    """
    if not fell.any() or fell.all():
        return math.nan
    below = least[fell][:, None] - least[~fell][None, :]
    return float(((below < 0) + 0.5 * (below == 0)).mean())


def roc(fell: np.ndarray, least: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rates of false alarms and of announced falls, by rising threshold of a margin."""
    thresholds = np.unique(least)
    below = least[None, :] <= thresholds[:, None]
    false = below[:, ~fell].mean(axis=1) if (~fell).any() else np.zeros(len(thresholds))
    true = below[:, fell].mean(axis=1) if fell.any() else np.zeros(len(thresholds))
    return np.concatenate([[0.0], false]), np.concatenate([[0.0], true])


def percent(values: Iterable[Any]) -> float:
    values = list(values)
    return 100 * sum(map(float, values)) / len(values) if values else math.nan
