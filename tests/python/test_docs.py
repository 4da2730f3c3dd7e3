"""The documents say what the code does: equation tags both ways, the README's program."""

import re
from pathlib import Path

CHECKOUT = Path(__file__).parents[2]
TAG = re.compile(r"\[E\d+\]")


def test_code_and_equations_page_name_the_same_tags_once():
    documented = TAG.findall((CHECKOUT / "docs/equations.md").read_text())
    sources = (CHECKOUT / "firmware/core").rglob("*.[ch]")
    used = {tag for source in sources for tag in TAG.findall(source.read_text())}
    assert sorted(documented) == sorted(set(documented))
    assert set(documented) == used


def test_readme_shows_the_program_that_is_compiled():
    readme = (CHECKOUT / "README.md").read_text()
    program = re.search(r"```c\n(.*?)```", readme, re.DOTALL).group(1)
    assert program == (CHECKOUT / "examples/minimal.c").read_text()
    assert program.count("\n") <= 23
