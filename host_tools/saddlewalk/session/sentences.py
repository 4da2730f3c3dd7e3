"""What a session's run was like, in sentences for someone who reads no tables."""

from collections.abc import Iterator

import numpy as np

from saddlewalk.contract import LEVELS
from saddlewalk.session import gait
from saddlewalk.session.runs import Run, Spans
from saddlewalk.session.steps import Walked

MEANING = {
    "unstable": "*Unstable*: at that moment a fall was likely.",
    "caution": "*Caution*: the body departed further from this person's own walk than steady "
    "steps do.",
    "unknown": "*Unknown*: what the sensors gave was not enough to say.",
}


def sentences(run: Run, walk: Walked | None, alarms: Spans) -> Iterator[str]:
    yield _walked(run, walk)
    if run.fell_s is not None:
        yield f"The wearer fell, {run.fell_s:.1f} s after the beginning."
    if run.has("verdict"):
        yield from _balance(run, alarms)
    if walk and walk.measured and len(walk.steps):
        yield from _evenness(run, walk)


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
    stable = run.levels == LEVELS.index("stable")
    share = run.hold_s[stable].sum() / run.duration_s
    if not len(alarms):
        yield f"Balance was stable for {share:.0%} of the time, without an alarm."
        return
    counts = {
        name: int((alarms.value == LEVELS.index(name)).sum())
        for name in ("unstable", "caution", "unknown")
    }
    episodes = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
    yield f"Balance was stable for {share:.0%} of the time; other episodes: {episodes}."
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


def _duration(time_s: float) -> str:
    return f"{time_s:.0f} s" if time_s < 120 else f"{time_s / 60:.1f} minutes"
