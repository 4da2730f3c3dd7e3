"""Tables that compare emulated wearers, walking machines and recorded people."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rich.table import Table

from saddlewalk.evaluation.gait_trials import GaitTrial
from saddlewalk.evaluation.scoring import (
    INPUTS,
    MARGINS,
    WINDOWS,
    Score,
    calm_figures,
    figures,
)

PEOPLE = "people"
TITLES = {
    "exact": "exact inputs",
    "noise": "with the emulated wearer's sensor noise",
    "one_tick_late": "exact inputs, one tick late",
}
LEVELS = ("unstable", "caution", "unknown")
Figures = Mapping[str, Any]


def walker_figures(scores: Mapping[str, Sequence[Score]], config: Mapping[str, str]) -> Figures:
    """Figures for exact inputs, if any, and for the other INPUTS under their names.

    scores: by INPUTS.
    """
    by_inputs = {name: figures(scores[name], config) for name in INPUTS if name in scores}
    return {**by_inputs.pop("exact", {}), **by_inputs}


def people_figures(trials: Sequence[GaitTrial]) -> Figures:
    """Figures of people who did not fall: steady walking only."""
    return {
        "trials": len(trials),
        "level_known_after_s": max(trial.level_after_s for trial in trials),
        **calm_figures([trial.settled for trial in trials]),
    }


def tables(results: Mapping[str, Figures], inputs: str) -> list[Table]:
    """Tables of all walkers, for one of INPUTS. People are only in those of exact inputs."""
    shown = {
        name: result if inputs == "exact" else result[inputs]
        for name, result in results.items()
        if inputs in result or (inputs == "exact" and "calm" in result)
    }
    if not shown:
        return []
    announced = _table(f"Falls announced, {TITLES[inputs]}", shown)
    for label, cell in ROWS if inputs == "exact" else ROWS[:BRIEF]:
        cells = [_cell(cell, result) for result in shown.values()]
        if any(text != "-" for text in cells):
            announced.add_row(label, *cells)
    pushed = {name: result for name, result in shown.items() if result.get("pushed")}
    areas = _table("Area under the ROC: to 0.24 s before the fall; first 0.4 s", pushed)
    for name in MARGINS:
        found = ([result[key][name] for key in WINDOWS] for result in pushed.values())
        areas.add_row(name, *("; ".join(map(_area, pair)) for pair in found))
    return [announced, areas] if pushed else [announced]


def _table(title: str, shown: Mapping[str, Figures]) -> Table:
    table = Table(title=title, title_justify="left")
    table.add_column("")
    for name in shown:
        table.add_column(name.replace("_", " "), justify="right")
    return table


def _cell(cell: Callable[[Figures], str], result: Figures) -> str:
    """A walker's figure; "-" if its recordings do not have it."""
    try:
        return cell(result)
    except KeyError:
        return "-"


def _area(value: float) -> str:
    return f"{value:.3f}" if math.isfinite(value) else "-"


def _percent(*keys: str) -> Callable[[Figures], str]:
    def cell(result: Figures) -> str:
        value: Any = result
        for key in keys:
            value = value[key]
        return f"{value:.1f} %" if math.isfinite(value) else "-"

    return cell


def _seconds(key: str) -> Callable[[Figures], str]:
    return lambda result: f"{result[key]:.2f} s" if math.isfinite(result[key]) else "-"


def _count(*keys: str) -> Callable[[Figures], str]:
    return lambda result: ", ".join(str(result[key]) for key in keys)


ROWS: tuple[tuple[str, Callable[[Figures], str]], ...] = (
    ("pushed walks, falls", _count("pushed", "falls")),
    ("falls with an alarm before", _percent("announced_pct")),
    ("... at least 0.24 s before", _percent("timely_pct")),
    ("lead time, median", _seconds("lead_median_s")),
    ("lead time, 10th percentile", _seconds("lead_p10_s")),
    ("an alarm without a fall", _percent("alarm_though_upright_pct")),
    ("... of random pushes", _percent("of_random_pushes_pct")),
    *((f"steady walking {level}", _percent("calm", f"{level}_pct")) for level in LEVELS),
    ("... of so many minutes", lambda result: f"{result['calm']['minutes']:.1f}"),
    ("level known at the latest after", _seconds("level_known_after_s")),
    ("0.24 s before the ground, too", _percent("timely_before_ground_pct")),
    ("push to fall, median", _seconds("push_to_fall_median_s")),
    ("alarms: it stumbled, or not", _count("real_stumbles_as_defined", "no_stumble_as_defined")),
    ("... more than before the push", _count("real_stumbles_by_change", "no_stumble_by_change")),
    ("alarm on at the push", _percent("already_alarmed_at_push_pct")),
    ("unknown, push to fall", _percent("unknown_from_push_to_fall_pct")),
    *((f"start to stop {level}", _percent("start_stop", f"{level}_pct")) for level in LEVELS),
)
BRIEF = 11  # of them, where inputs are not exact
