"""The page of the reproduced paper: verdict, numbers, findings, figures, people, readings."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from saddlewalk import html_page
from saddlewalk.formulas import drawn
from saddlewalk.html_page import table
from saddlewalk.paper.figures import Picture
from saddlewalk.paper.numbers import Finding, Number, Simulations
from saddlewalk.paper.people import Trial
from saddlewalk.paper.readings import readings
from saddlewalk.paper.simulations import gait, simulate

TITLE = "The paper, reproduced"
ONLY_ORENDURFF = (
    "Without a folder of trials (`--gait`), people are shown only by the points of Orendurff 2004 "
    "and the paper's regressions."
)

_ABOUT = """
C. Tiseo, K. C. Veluvolu, W. T. Ang, “Motor Control Insights on Walking Planner and its Stability”.
Every curve and number of the model comes from the C core of Saddlewalk: mean body (1.79 m,
63.3 kg), Phase0 = 0, two steps, 0.7, 1.0, 1.2 and 1.6 m/s, heel strike at 5, 10 and 15°, the
paper's step of 80 ms, finer for curves.
"""

_SOURCES = """
*Stated*: the number, or the formula that gives it at this speed, is in the paper's text.
*As read*: the paper shows it in a figure or defines it by an equation; the number beside ours was
worked from the equations in double precision, with the readings below. Constants are recovered from
planned walks, within a ten-thousandth of their value; the others are the same within half a unit of
the last digit given.
"""

_NOT_OURS = """
Other numbers of the paper are not the planner's. They belong to its recordings (KIT data base, 58
walks of 6 people: R² of 0.157 for step width, 0.98 for step length, 0.2015 for vertical amplitude)
or to its computer (the text gives no planning time).
"""

_READINGS = (
    "From `docs/equations.md`, which has every equation under the tag that the code carries."
)


def write_page(
    numbers: Sequence[Number],
    findings: Sequence[Finding],
    simulations: Simulations,
    pictures: Sequence[Picture],
    trials: Sequence[Trial],
) -> str:
    """The whole page as HTML."""
    sections = [
        f"# {TITLE}\n{_ABOUT}",
        f"**{verdict(numbers, findings)}**",
        f"## Figures\n\n{'' if trials else ONLY_ORENDURFF}",
        *(html_page.picture(each.name, each.caption) for each in pictures),
        f"## Every number\n{_SOURCES}\n{_numbers_table(numbers)}\n{_NOT_OURS}",
        f"## The paper's findings\n\n{_findings_table(findings)}",
        f"## The twelve simulations\n\n{_simulations_table(simulations)}",
        *([_people(trials)] if trials else []),
        f"## Ambiguities in the paper, and how we read them\n\n{_READINGS}\n{_readings_table()}",
    ]
    embedded = {each.name: each.png for each in pictures}
    return html_page.page(TITLE, "\n\n".join(sections), embedded)


def verdict(numbers: Sequence[Number], findings: Sequence[Finding]) -> str:
    """One line: what was compared, and what is outside its tolerance."""
    off = [f"{n.what} {n.case}".strip() for n in numbers if not n.sound]
    fallen = [finding.claim for finding in findings if not finding.holds]
    stated = sum(number.stated for number in numbers)
    sound = (
        f"{len(numbers) - len(off)} of {len(numbers)} numbers ({stated} stated in the paper, "
        f"{len(numbers) - stated} as read) are within their tolerance, "
        f"{len(findings) - len(fallen)} of {len(findings)} findings hold"
    )
    return "; ".join([sound, *(f"off: {words}" for words in off + fallen)])


def _numbers_table(numbers: Sequence[Number]) -> str:
    header = ("what", "where", "source", "paper", "ours", "difference", "tolerance", "verdict")
    return table(header, [_number_row(number) for number in numbers])


def _number_row(number: Number) -> list[str]:
    unit = f" {number.unit}" if number.unit else ""
    return [
        number.what,
        number.case,
        f"{'stated' if number.stated else 'as read'}, {number.source}",
        f"{number.paper}{unit}",
        f"{number.ours:.5g}{unit}",
        f"{number.difference:+.1e}",
        f"{number.tolerance:.1e}",
        "same" if number.sound else "**off**",
    ]


def _findings_table(findings: Sequence[Finding]) -> str:
    rows = [[each.claim, each.ours, "holds" if each.holds else "**off**"] for each in findings]
    return table(("the paper", "ours", "verdict"), rows)


def _simulations_table(simulations: Simulations) -> str:
    header = (
        "speed (m/s)",
        "heel strike (°)",
        "step (s)",
        "heel strike at (s)",
        "toe-off (°)",
        "vertical (mm)",
        "rigid (mm)",
        "jump of z (mm)",
        "least S_SW",
        "XCoM in the BoS (%)",
    )
    rows = [
        [
            f"{speed_m_s}",
            f"{angle_deg:g}",
            f"{walk.step_s:.3f}",
            f"{walk.heel_strike_s:.3f}",
            f"{math.degrees(walk.toe_off_rad):.1f}",
            f"{1e3 * walk.vertical_m:.1f}",
            f"{1e3 * simulations.rigid[speed_m_s].vertical_m:.1f}",
            f"{1e3 * walk.jump_m:.1f}",
            f"{walk.s_sw_min:.3f}",
            f"{100 * walk.share_inside('mos_xcom_m'):.0f}",
        ]
        for (speed_m_s, angle_deg), walk in simulations.walks.items()
    ]
    return table(header, rows)


def _people(trials: Sequence[Trial]) -> str:
    rows = [
        [
            trial.name,
            trial.about.get("group", ""),
            f"{trial.speed_m_s:.2f}",
            str(trial.steps),
            *(
                _known(value, decimals)
                for value, decimals in (
                    (trial.step_length_m, 3),
                    (trial.step_width_m, 3),
                    (1e3 * trial.vertical_m, 1),
                    (trial.s_sw_min, 2),
                )
            ),
            trial.about.get("note", ""),
        ]
        for trial in trials
    ]
    header = (
        "trial",
        "who",
        "speed (m/s)",
        "steps",
        "step length (m)",
        "step width (m)",
        "vertical (mm)",
        "least S_SW",
        "note",
    )
    return "\n\n".join(
        [
            "## Recorded people",
            table(header, rows),
            "Measured minus model at each person's speed, without the children and without speeds "
            "that are not feasible for the mean body:",
            _departures_table([trial for trial in trials if not trial.child]),
            _credits(trials),
        ]
    )


def _departures_table(trials: Sequence[Trial]) -> str:
    """Difference of people from the model: bias and RMSE over the trials with a measurement."""
    walking = [trial for trial in trials if gait(trial.speed_m_s).planned]
    model = [(gait(trial.speed_m_s), simulate(trial.speed_m_s)) for trial in walking]
    quantities: dict[str, Callable[[Any, Any, Any], float]] = {
        "half step length (mm)": lambda t, g, _: 1e3 * (t.step_length_m / 2 - g.half_step_m),
        "step width (mm)": lambda t, g, _: 1e3 * (t.step_width_m - g.width_m),
        "vertical, regression (mm)": lambda t, g, _: 1e3 * (t.vertical_m - g.vertical_m),
        "vertical, planner (mm)": lambda t, _, w: 1e3 * (t.vertical_m - w.vertical_m),
        "least S_SW": lambda t, _, w: t.s_sw_min - w.s_sw_min,
    }
    rows = []
    for name, departure in quantities.items():
        off = np.array([departure(trial, *of) for trial, of in zip(walking, model, strict=True)])
        off = off[np.isfinite(off)]
        if len(off):
            rms = np.sqrt(np.mean(off**2))
            rows.append([name, str(len(off)), f"{off.mean():+.2g}", f"{rms:.2g}"])
    return table(("what", "trials", "bias", "RMSE"), rows)


def _credits(trials: Sequence[Trial]) -> str:
    datasets = {
        f"{trial.about['dataset']} ({trial.about.get('licence', '')})"
        for trial in trials
        if trial.about.get("dataset")
    }
    return "The recordings are of " + "; ".join(sorted(datasets)) + "." if datasets else ""


def _readings_table() -> str:
    rows = [[each.tag, each.label, each.equation, each.words] for each in readings()]
    return drawn(table(("tag", "paper", "equation", "reading and range"), rows))


def _known(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}" if math.isfinite(value) else ""
