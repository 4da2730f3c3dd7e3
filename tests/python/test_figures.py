"""Figures in the README are those of the pages that it cites, and those of the commands' output."""

import math
import re

import pytest

from saddlewalk import paths

README = (paths.CHECKOUT / "README.md").read_text()
TEXT = " ".join(README.split())


def row(page: str, name: str) -> list[float]:
    """The numbers of a table's row, by its first cell."""
    text = (paths.CHECKOUT / "docs" / page).read_text()
    cells = re.search(rf"^\| {re.escape(name)} \|(.*)\|$", text, re.MULTILINE)
    assert cells, f"{page}: no row {name}"
    return [float(number.replace(",", "")) for number in re.findall(r"\d[\d,]*\.?\d*", cells[1])]


def readme(pattern: str) -> list[float]:
    found = re.search(pattern, TEXT)
    assert found, pattern
    return [float(number.replace(",", "")) for number in found.groups()]


def test_the_costs_of_a_tick():
    median, most, context = readme(
        r"some ([\d,]+) instructions on a Cortex-M4F, at most ([\d,]+), "
        r"in ([\d,]+) bytes of context"
    )
    assert median == round(row("costs.md", "tick of a walk, -O2, median")[0], -2)
    assert most == 100 * math.ceil(row("costs.md", "any tick, -O2, maximum")[0] / 100)
    assert context == row("costs.md", "context, bytes")[0]


def test_the_prediction_of_falls():
    planned, recovery = readme(r"(\d+) % of the falls .*? and (\d+) % if it takes")
    assert [planned, recovery] == [round(x) for x in row("evaluation.md", ALARMS)]
    medians = readme(r"median warning ([\d.]+) s and ([\d.]+) s")
    planned_lead, _, recovery_lead, _ = row("evaluation.md", LEADS)
    assert medians == [planned_lead, recovery_lead]
    (minutes,) = readme(r"false alarm in (\d+) minutes of steady unperturbed walking")
    planned_share, planned_min, recovery_share, recovery_min = row("evaluation.md", STEADY)
    assert (planned_share, recovery_share, planned_min + recovery_min) == (0, 0, minutes)


ALARMS = "falls with an alarm before"
LEADS = "lead time, median and 10th percentile"
STEADY = "unperturbed steady walking announced unstable"


def machines(name: str) -> list[list[float]]:
    """Numbers of h1's and apollo's cells in the side-by-side table."""
    page = (paths.CHECKOUT / "docs/evaluation.md").read_text().partition("side by side\n")[2]
    line = re.search(rf"^\| {re.escape(name)} \|(.*)\|$", page, re.MULTILINE)
    assert line, name
    cells = line[1].split("|")[2:4]
    return [[float(n) for n in re.findall(r"[\d.]+", cell)] for cell in cells]


def test_the_falls_of_machines():
    pushes, falls, timely = readme(
        r"pushed (\d+) times .*? every one of their (\d+) falls is announced, (\d+) % at least"
    )
    counts = machines("pushed walks, falls")
    assert [pushes, falls] == [sum(each) for each in zip(*counts, strict=True)]
    assert [each[0] for each in machines("falls with an alarm before")] == [100, 100]
    assert [round(each[0]) for each in machines("at least 0.24 s before")] == [timely, timely]
    alarms = readme(r"alarm in (\d+) % \(h1\) and (\d+) % \(apollo\)")
    assert alarms == [round(each[0]) for each in machines("an alarm without a fall")]
    (minutes,) = readme(r"none in (\d+) minutes of steady walking")
    (h1, apollo) = machines("steady walking: unstable")
    assert (h1[0], apollo[0], h1[1] + apollo[1]) == (0, 0, minutes)


def test_the_effect_of_the_recovery_step():
    (share,) = readme(r"recovery step prevents the fall for (\d+) % of the pushes")
    text = (paths.CHECKOUT / "docs/evaluation.md").read_text()
    found = re.search(r"\*\*([\d.]+) %\*\* only\s+with the recovery step", text)
    assert found and share == round(float(found[1]))


def fastest_qp(task: str) -> list[float]:
    """Over the core, cold and warm, from the page's table of this task."""
    text = (paths.CHECKOUT / "docs/benchmark.md").read_text()
    table = re.search(rf"^{task}, us .*?\n\n", text, re.MULTILINE | re.DOTALL)
    assert table, task
    rows = [line.split("|")[1:] for line in table[0].splitlines() if line.startswith("walking QP")]
    return [min(float(row[k].split()[-1].replace(",", "")) for row in rows) for k in (0, 1)]


def test_the_planning_time():
    update_cold, update_warm, stride_cold, stride_warm = readme(
        r"An update .*? (\d+) times .*? cold .*? (\d+) times with warm .*? "
        r"stride anew .*? (\d+) times as fast cold and (\d+) times warm"
    )
    assert [update_cold, update_warm] == [round(x) for x in fastest_qp("one update of a walk")]
    assert [stride_cold, stride_warm] == [round(x) for x in fastest_qp("a stride planned anew")]


def test_no_figure_goes_unchecked():
    """A number with a unit among the README's claims stands in one of the tests above."""
    claims = TEXT.partition("## How good it is")[2].partition("## Where to go from here")[0]
    assert len(re.findall(r"\d[\d,.]* (?:%|s\b|minutes|instructions|bytes|times)", claims)) == 18
    with pytest.raises(AssertionError):
        readme(r"never in the README (\d)")
