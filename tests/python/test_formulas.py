"""Formulas of the pages become MathML, whole."""

import re

import pytest

from saddlewalk.formulas import drawn
from saddlewalk.paths import CHECKOUT

PAGES = [CHECKOUT / "docs" / name for name in ("equations.md", "joints.md")]
# An axis, a distance, the level of an old version; proportions, an iteration, rules.
IN_WORDS = {"E15", "E17", "E36", "J1", "J8", "J15", "J24", "J25"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_each_equation_is_drawn(page):
    rows = re.findall(r"^\| \[([EJ]\d+)\] \| (.*?) \| ", page.read_text(), re.MULTILINE)
    assert len(rows) >= 25
    for tag, equation in rows:
        html = drawn(equation)
        assert ("<math" in html) == (tag not in IN_WORDS), tag
        # A command that is not known, or a dollar without its other, would be left.
        assert not set("\\$") & set(html), tag


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("at d_SW beyond", "at <i>d</i><sub>SW</sub> beyond"),
        ("U_MoS,plan, at rest", "<i>U</i><sub>MoS,plan</sub>, at rest"),
        ("`d_h` and can_stop", "`d_h` and can_stop"),
        ("costs `a$b` $", "costs `a$b` $"),
    ],
)
def test_symbols_have_an_index_and_code_stays(text, html):
    assert drawn(text) == html
