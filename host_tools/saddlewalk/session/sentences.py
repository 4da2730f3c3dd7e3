"""What a session's run was like, in sentences for someone who reads no tables."""

from collections.abc import Iterator, Sequence

import numpy as np

from saddlewalk.contract import LEVELS
from saddlewalk.session import gait
from saddlewalk.session.quality import FAULT_WORDS, Problem, gaps
from saddlewalk.session.quality import missing as missing_channels
from saddlewalk.session.runs import Run, Spans
from saddlewalk.session.steps import Walked

MEANING = {
    "unstable": "*Unstable*: at that moment a fall was likely.",
    "caution": "*Caution*: the body departed further from this person's own walk than steady "
    "steps do.",
    "unknown": "*Unknown*: what the sensors gave was not enough to say.",
}


IN_LEVEL = {
    "stable": "stable",
    "caution": "in caution",
    "unstable": "unstable",
    "unknown": "not known",
}
TOLD = 3  # problems of the data


def sentences(
    run: Run, walk: Walked | None, alarms: Spans, problems: Sequence[Problem]
) -> Iterator[str]:
    """problems: of the data."""
    yield _walked(run, walk)
    if run.fell_s is not None:
        yield f"The wearer fell, {run.fell_s:.1f} s after the beginning."
    if run.has("verdict"):
        yield from _balance(run, alarms)
    if walk and walk.measured and len(walk.steps):
        yield from _evenness(run, walk)
    yield _data(run, problems)


def _walked(run: Run, walk: Walked | None) -> str:
    if walk is None or not len(walk.steps):
        return f"In {_duration(run.duration_s)} no step was seen."
    who = "The person took" if walk.measured else "The plan was"
    steps = gait.described(walk)
    found = f"{who} {len(walk.steps)} steps in {_duration(run.duration_s)}"
    if np.isfinite(walk.distance_m):
        found += f" and covered {walk.distance_m:.1f} m"
    cadence = gait.cadence(steps)
    if np.isfinite(cadence) and np.isfinite(steps.speed_m_s):
        which = "steady steps" if walk.steps.steady.any() else "steps"
        found += f". The {which} came at {cadence:.0f} a minute, at {steps.speed_m_s:.1f} m/s"
    return f"{found}."


def _balance(run: Run, alarms: Spans) -> Iterator[str]:
    counts = {name: int((alarms.value == LEVELS.index(name)).sum()) for name in MEANING}
    parts = []
    for name, words in IN_LEVEL.items():
        held_s = float(run.hold_s[run.levels == LEVELS.index(name)].sum())
        times = f" ({counts[name]} times)" if counts.get(name, 0) > 1 else ""
        parts += [f"{words} for {_duration(held_s)}{times}"] if held_s else []
    yield f"Balance was {_list(parts)}{'' if len(alarms) else ', without an alarm'}."
    if not len(alarms):
        return
    yield " ".join(MEANING[name] for name, count in counts.items() if count)
    (worst,) = alarms.worst(1)
    lowest = run.lowest_margin(worst.ticks)
    why = f": {lowest[2]}" if lowest else ""
    yield f"The worst began at {worst.start_s:.1f} s and lasted {worst.duration_s:.1f} s{why}."


def _evenness(run: Run, walk: Walked) -> Iterator[str]:
    for row in gait.rows(run, walk):
        if row.quantity == "symmetry index, step length" and np.isfinite(row.measured):
            longer = "left" if row.measured > 0 else "right"
            usual = "not more" if abs(row.measured) <= gait.SYMMETRY_PERCENT else "more"
            yield (
                f"The {longer} foot's steps were longer by {abs(row.measured):.0f} %, which is "
                f"{usual} than healthy adults have ({gait.SYMMETRY_PERCENT} %)."
            )


def _data(run: Run, problems: Sequence[Problem]) -> str:
    """The quality of the data, the longest problems first."""
    missing, lacks = gaps(run, 0), missing_channels(run)
    told = [f"{_duration(missing.duration_s)} are not in the log"] if missing.count else []
    told += ["not all channels were logged"] if lacks else []
    faults = [each for each in problems if each.name in FAULT_WORDS]
    lasting = sorted(faults, key=lambda each: -each.spans.duration_s.sum())
    told += [f"{each.words} ({_duration(each.spans.duration_s.sum())})" for each in lasting[:TOLD]]
    found = "; ".join(told) or "no measurement was missing, late or implausible"
    return f"Data quality: {found}."


def _list(parts: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(parts[:-1]), *parts[-1:])))


def _duration(time_s: float) -> str:
    if time_s < 10:
        return f"{time_s:.1f} s"
    return f"{time_s:.0f} s" if time_s < 120 else f"{time_s / 60:.1f} minutes"
