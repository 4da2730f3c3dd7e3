"""Formulas of the pages become MathML, whole."""

import re

import pytest

from saddlewalk.formulas import drawn
from saddlewalk.paths import CHECKOUT

PAGE = (CHECKOUT / "docs/equations.md").read_text()
IN_WORDS = {"E15", "E17", "E36"}  # an axis, a distance, the level of an old version


def test_each_equation_is_drawn():
    rows = re.findall(r"^\| \[(E\d+)\] \| (.*?) \| ", PAGE, re.MULTILINE)
    assert len(rows) > 40
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
