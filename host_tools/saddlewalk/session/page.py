"""The page of a session: the walk, the alarms, the steps, and the quality of the data."""

import datetime
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from saddlewalk import __version__, html_page
from saddlewalk.config import ANKLES
from saddlewalk.contract import LEVELS, SIDES
from saddlewalk.html_page import on_screen, table
from saddlewalk.printable import printable
from saddlewalk.session import gait, quality
from saddlewalk.session.pictures import draw
from saddlewalk.session.runs import NO_NUMBER, Run, Session, Spans
from saddlewalk.session.sentences import sentences
from saddlewalk.session.steps import QUANTITIES, Steps, Walked, variability, walked

TITLE = "Session report"
LISTED = 200  # alarms or gaps, the worst ones
NO_DEVICE = (
    "**Saddlewalk is not a medical device.** It has not been certified or tested on patients, and "
    "this page is not a diagnosis: it shows the content of one log."
)
NO_VERDICT = "no verdict"
SILENT = "silent"
NO_STEPS = "No step was detected in this run."
UNKNOWN = "not known"

_STEPS = """
A *left* step ends where the left foot lands. *Length*: how far it is then ahead of the other foot;
*width*: how far the left foot is left of the right one; *time*: since the other foot landed. SD is
the sample's, CV is SD by mean.
"""
_MEASURED = """
From the measured feet of SADDLEWALK_INPUT, seen once a tick: each step time is within 80 ms, so an
SD of step time below about 33 ms cannot be distinguished from the tick's. Length and width are
taken at the landing, as for the scores; from footprint to footprint a step is longer by as much as
the CoP of the other foot has moved forward by then.
"""
_PLANNED = """
**From the plan**, not from the person: the log holds no measurement of the feet. A person who does
not follow the plan walks differently.
"""
_STEADY = "*Steady*: the plan was walking at one speed from one landing to the next."


def write_page(log: Path, session: Session) -> str:
    """The whole page as HTML."""
    several = len(session.runs) > 1
    sections = [f"# {TITLE}\n\n{NO_DEVICE}", _about(log, session)]
    embedded: dict[str, bytes] = {}
    for number, run in enumerate(session.runs, start=1):
        sections += [f"# Run {number} of {len(session.runs)}"] if several else []
        walk, found = walked(run), quality.problems(run)
        pictures = draw(run, walk, found)
        names = {kind: f"run-{number}-{kind}.png" for kind in pictures}
        embedded |= {names[kind]: each.png for kind, each in pictures.items()}
        shown = {
            kind: html_page.picture(names[kind], each.caption) for kind, each in pictures.items()
        }
        sections += [
            "## What was seen\n\n" + "\n\n".join(sentences(run, walk, alarms(run), found)),
            on_screen(f"## Summary\n\n{_summary(run, walk)}"),
            f"## Levels and alarms\n\n{shown['level']}\n\n{_levels(run)}\n\n{_alarms(run)}",
            shown.get("alarms", ""),
            on_screen(f"## Scores\n\n{shown['scores']}"),
            *(on_screen(words) for kind, words in shown.items() if kind.startswith("alarm-")),
            f"## Gait\n\n{_gait(run, walk)}",
            on_screen(f"## Steps\n\n{_steps(walk)}\n\n{shown.get('steps', '')}"),
            on_screen(f"## Data quality\n\n{_quality(run, found)}\n\n{shown.get('problems', '')}"),
            on_screen(f"## Configuration\n\n{_configuration(run)}"),
        ]
    return html_page.page(f"{TITLE}: {printable(_name(log))}", "\n\n".join(sections), embedded)


def summary_lines(session: Session) -> Iterator[str]:
    """A line per run."""
    for run in session.runs:
        walk = walked(run)
        levels = ", ".join(f"{name} {held_s:.1f} s" for name, held_s in time_in_levels(run).items())
        steps = f"{len(walk.steps)} steps, {walk.distance_m:.1f} m" if walk else "steps not known"
        yield f"{run.ticks} ticks, {run.duration_s:.1f} s, {steps}; {levels}"


def time_in_levels(run: Run) -> dict[str, float]:
    """Seconds in each level, and without a level if there were any."""
    times_s = {
        name: float(run.hold_s[run.levels == LEVELS.index(name)].sum())
        for name in (*LEVELS[1:], LEVELS[0])
    }
    strange = ~np.isin(run.levels, range(len(LEVELS)))
    rest = {NO_VERDICT: float(run.hold_s[strange].sum()), SILENT: float(run.silent_s.sum())}
    return times_s | {name: held_s for name, held_s in rest.items() if held_s > 0}


def alarms(run: Run) -> Spans:
    """Periods in which the level was caution, unstable or unknown."""
    troubled = [LEVELS.index(name) for name in LEVELS if name != "stable"]
    spans = run.spans(run.levels)
    return spans.where(np.isin(spans.value, troubled))


def _name(log: Path) -> str:
    return os.fsencode(log.name).decode(errors="replace")


def _plain(text: str) -> str:
    """Text from a log, escaped so that Markdown and HTML show it as it is."""
    return "".join(c if c.isalnum() or c in " .,:-" else f"&#{ord(c)};" for c in printable(text))


def _about(log: Path, session: Session) -> str:
    first, last = map(_date, session.logged_us)
    lines = [
        f"{_plain(_name(log))}: {session.events} messages, logged from {first} to {last}. "
        f"Times below are seconds since the first tick of a run."
    ]
    if session.broken:
        lines.append(f"**The log is incomplete:** {_plain(session.broken)}.")
    if session.fell is not None:
        fate = "fell" if session.fell else "did not fall"
        lines.append(f"The wearer was emulated (SADDLEWALK_TRUTH) and {fate}.")
    if session.unreadable:
        channels = ", ".join(
            f"{count} on {_plain(name)}" for name, count in session.unreadable.items()
        )
        lines.append(
            f"Not read, since saddlewalk {__version__} does not know their type: {channels}."
        )
    return "\n\n".join(lines)


def _date(logged_us: int) -> str:
    try:
        date = datetime.datetime.fromtimestamp(logged_us / 1e6, datetime.UTC)
    except (OverflowError, ValueError, OSError):
        return f"{logged_us} µs"
    return f"{date:%Y-%m-%d %H:%M:%S} UTC"


_LYING = "scores, levels and steps from then on are those of someone on the ground"


def _summary(run: Run, walk: Walked | None) -> str:
    rows = [["duration", f"{run.duration_s:.2f} s"]]
    if run.fell_s is not None:
        rows.append(["the wearer fell", f"at {run.fell_s:.2f} s: {_LYING}"])
    if walk:
        source = "measured" if walk.measured else "planned"
        unknown = f"; not known during {walk.unknown_s:.2f} s" if walk.unknown_s else ""
        rows += [
            ["steps", f"{len(walk.steps)}, {source}"],
            ["distance of the CoM", f"{walk.distance_m:.2f} m, {source}{unknown}"],
            ["mean speed, over the steps", f"{_known(walk.speed_m_s, 3)} m/s"],
        ]
    else:
        rows.append(["steps, distance, speed", UNKNOWN])
    rows.append(["lowest margin", _lowest(run)])
    found = alarms(run)
    counts = {name: int((found.value == LEVELS.index(name)).sum()) for name in LEVELS}
    times = [f"{name} {counts[name]}" for name in ("unstable", "caution", "unknown")]
    rows.append(["episodes by level", ", ".join(times) if run.has("verdict") else UNKNOWN])
    return table(("what", "how much"), rows)


def _lowest(run: Run) -> str:
    """The lowest margin, when it was, and what drove it."""
    lowest = run.lowest_margin(run.upright)
    if lowest is None:
        return UNKNOWN
    tick, margin, words = lowest
    return f"{margin:.3f} at {run.time_s[tick]:.2f} s: {words}; unstable begins at 0"


def _lowest_cells(run: Run, ticks: slice) -> list[str]:
    lowest = run.lowest_margin(ticks)
    return [UNKNOWN, UNKNOWN] if lowest is None else [f"{lowest[1]:.3f}", lowest[2]]


def _levels(run: Run) -> str:
    if not run.has("verdict"):
        return "No verdict was logged."
    rows = [
        [name, f"{held_s:.2f}", f"{held_s / run.duration_s:.1%}"]
        for name, held_s in time_in_levels(run).items()
    ]
    return table(("level", "time (s)", "share"), rows)


def _alarms(run: Run) -> str:
    if not run.has("verdict"):
        return ""
    found = alarms(run)
    if not len(found):
        return "No alarm."
    listed = found.worst(LISTED)
    rows = [
        [
            f"{each.start_s:.2f}",
            f"{each.duration_s:.2f}",
            f"**{LEVELS[each.value]}**" if LEVELS[each.value] == "unstable" else LEVELS[each.value],
            *_lowest_cells(run, each.ticks),
            "; ".join(map(_plain, run.reasons(each.ticks))),
        ]
        for each in listed
    ]
    header = ("start (s)", "duration (s)", "level", "lowest margin", "driven by", "reason")
    return table(header, rows) + _not_listed(
        len(found), "alarms: the worst are listed, the longest first"
    )


def _not_listed(count: int, which: str) -> str:
    """The note below a table that shows only LISTED of its rows."""
    return f"\n{LISTED} of {count} {which}." if count > LISTED else ""


def _steps(walk: Walked | None) -> str:
    if walk is None:
        return "Neither measured feet nor a plan was logged."
    words = [_MEASURED if walk.measured else _PLANNED]
    if not len(walk.steps):
        return "\n\n".join([*words, NO_STEPS])
    steady = walk.steps.steady
    groups = {"all": np.ones(len(walk.steps), bool)} | ({"steady": steady} if steady.any() else {})
    rows = [
        row for name, chosen in groups.items() for row in _variabilities(name, walk.steps, chosen)
    ]
    header = ("steps", "foot", "what", "number", "mean", "SD", "CV")
    return "\n\n".join([_STEPS, *words, *([_STEADY] if steady.any() else []), table(header, rows)])


def _variabilities(group: str, steps: Steps, chosen: np.ndarray) -> Iterator[list[str]]:
    sides = {"both": chosen} | {
        name: chosen & (steps.side == side) for side, name in enumerate(SIDES)
    }
    for member, label in QUANTITIES.items():
        for side, landed in sides.items():
            spread = variability(getattr(steps, member)[landed])
            numbers = (
                _known(spread.mean, 3),
                _known(spread.sd, 4),
                _known(100 * spread.cv, 1, " %"),
            )
            yield [group, side, label, str(spread.steps), *numbers]


def _gait(run: Run, walk: Walked | None) -> str:
    if walk is None or not len(walk.steps):
        return NO_STEPS
    steps = gait.described(walk)
    of = gait.configured(run, steps.speed_m_s)
    configured = "calibration" if of and of.calibrated else "default, not calibrated"
    cells = [
        [
            row.quantity,
            row.unit,
            _known(row.measured, row.decimals),
            "" if np.isnan(row.configured) else f"{row.configured:.{row.decimals}f}",
            row.published,
            row.meaning,
        ]
        for row in gait.rows(run, walk)
    ]
    header = ("what", "unit", "measured" if walk.measured else "planned", configured, "published")
    speed = f"{len(steps)} steps at {_known(steps.speed_m_s, 2)} m/s in the mean"
    which = "The steady ones" if steps.steady.any() else "No step was steady: all"
    shown = table((*header, "what it means"), cells)
    return f"{which}, {speed}.\n\n{shown}\n\n{gait.NORMS}"


def _quality(run: Run, problems: Sequence[quality.Problem]) -> str:
    numbers = np.frombuffer(run.numbers, np.int32)
    numbers = numbers[numbers != NO_NUMBER]
    numbering = f"numbers {numbers[0]} to {numbers[-1]}" if len(numbers) else "without numbers"
    found = quality.gaps(run, LISTED)
    rows = [["ticks in the log", f"{run.ticks}, {numbering}"]]
    rows += [
        [what, words]
        for what, words in (
            ("timing, since the firmware's start", quality.late(run)),
            ("CAN, since the firmware's start", quality.rejected(run)),
        )
        if words
    ]
    rows.append(["gaps", f"{found.count}, {found.duration_s:.2f} s in all"])
    parts = [*quality.missing(run), table(("what", "how much"), rows)]
    if found.count:
        cells = [[f"{g.start_s:.2f}", f"{g.duration_s:.2f}", g.words] for g in found.longest]
        parts.append(
            table(("gap from (s)", "duration (s)", "which"), cells)
            + _not_listed(found.count, "gaps: the longest are listed")
        )
    return "\n\n".join([*parts, _problems(run, problems), _ages(run)])


def _problems(run: Run, found: Sequence[quality.Problem]) -> str:
    if not found:
        return "No faults or limits were reported." if run.has("health") else ""
    rows = [
        [
            each.name,
            each.words,
            str(len(each.spans)),
            f"{each.spans.duration_s.sum():.2f}",
            f"{each.spans.start_s[0]:.2f}",
            f"{each.spans.start_s[-1]:.2f}",
        ]
        for each in found
    ]
    header = ("fault or limit", "meaning", "times", "total (s)", "first at (s)", "last at (s)")
    return table(header, rows)


def _ages(run: Run) -> str:
    rows = [
        [each.what, *map(_known, (each.median_ms, each.usual_ms, each.oldest_ms)), str(each.never)]
        for each in quality.ages(run)
    ]
    header = (
        "age of",
        "median (ms)",
        "95 % below (ms)",
        "oldest (ms)",
        "ticks before the first one",
    )
    return table(header, rows) if rows else ""


def _configuration(run: Run) -> str:
    config, status = run.last("config"), run.last("status")
    if config is None:
        of_status = f"Saddlewalk {_plain(status.library_version)}. " if status else ""
        return f"{of_status}No configuration was logged."
    clock = "lockstep" if config.lockstep else "real time"
    ankle = {number: name for name, number in ANKLES.items()}.get(config.ankle, str(config.ankle))
    rows = [
        ["library", _plain(config.library_version)],
        ["wire", str(config.wire_version)],
        ["clock", clock],
        ["ankle", ankle],
        *([_plain(n), f"{v:.7g}"] for n, v in zip(config.name, config.value, strict=True)),
    ]
    return table(("what", "value"), rows)


def _known(number: float, decimals: int = 0, unit: str = "") -> str:
    return f"{number:.{decimals}f}{unit}" if np.isfinite(number) else UNKNOWN
