"""The documents say what the code does: equation tags both ways, the README's program."""

import re
from pathlib import Path

CHECKOUT = Path(__file__).parents[2]
TAG = re.compile(r"\[E\d+\]")


CORE = CHECKOUT / "firmware/core"
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
FUNCTION = re.compile(
    r"^(?!else |return )[a-z][\w *]*?(\w+)\(([^{};]*?)\)(?: *;|\n\{)", re.MULTILINE
)
PARAMETERS_MAX = 5


def test_code_and_equations_page_name_the_same_tags_once():
    documented = TAG.findall((CHECKOUT / "docs/equations.md").read_text())
    used = {tag for source in CORE.rglob("*.[ch]") for tag in TAG.findall(source.read_text())}
    assert sorted(documented) == sorted(set(documented))
    assert set(documented) == used


def test_each_equation_s_tag_stands_where_it_is_computed():
    """In a source, not only at a declaration or a field."""
    documented = set(TAG.findall((CHECKOUT / "docs/equations.md").read_text()))
    computed = {tag for source in CORE.rglob("*.c") for tag in TAG.findall(source.read_text())}
    assert documented == computed


def test_no_function_of_the_core_takes_more_than_five_parameters():
    counts = {
        f"{source.name} {name}": parameters.count(",") + 1
        for source in CORE.rglob("*.[ch]")
        for name, parameters in FUNCTION.findall(COMMENT.sub("", source.read_text()))
    }
    assert len(counts) > 200
    assert {name: count for name, count in counts.items() if count > PARAMETERS_MAX} == {}


def test_readme_shows_the_program_that_is_compiled():
    readme = (CHECKOUT / "README.md").read_text()
    program = re.search(r"```c\n(.*?)```", readme, re.DOTALL).group(1)
    assert program == (CHECKOUT / "examples/minimal.c").read_text()
    assert program.count("\n") <= 23


PAGES = [*CHECKOUT.glob("*.md"), *(CHECKOUT / "docs").glob("*.md")]
LINK = re.compile(r"\]\((?!https?:)([^)#]+)")
TARGET = re.compile(r"`make ([a-z-]+)")
FILE = re.compile(r"`((?:firmware|tests|tools|host_tools|examples)/[\w/.-]+)")


def test_links_between_pages_and_files_lead_somewhere():
    links = [page.parent / link for page in PAGES for link in LINK.findall(page.read_text())]
    assert len(links) > 50
    assert [str(link) for link in links if not link.exists()] == []


def test_files_and_make_targets_that_pages_name_exist():
    makefile = (CHECKOUT / "Makefile").read_text()
    targets = {*re.findall(r"^([a-z-]+):", makefile, re.MULTILINE)}
    text = "".join(page.read_text() for page in PAGES)
    assert {*TARGET.findall(text)} - targets == set()
    assert [name for name in FILE.findall(text) if not (CHECKOUT / name).exists()] == []
