"""The documents say what the code does: equation tags both ways, the README's program."""

import re
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).parents[2]
# The page of a library, its sources and the letter of its tags.
LIBRARIES = [
    ("docs/equations.md", CHECKOUT / "firmware/core", "E"),
    ("docs/joints.md", CHECKOUT / "firmware/joints", "J"),
]
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
FUNCTION = re.compile(
    r"^(?!else |return )[a-z][\w *]*?(\w+)\(([^{};]*?)\)(?: *;|\n\{)", re.MULTILINE
)
PARAMETERS_MAX = 5


def tags_in(text: str, letter: str) -> list[str]:
    return re.findall(rf"\[{letter}\d+\]", text)


@pytest.mark.parametrize(("page", "library", "letter"), LIBRARIES)
def test_code_and_page_name_the_same_tags_once(page, library, letter):
    documented = tags_in((CHECKOUT / page).read_text(), letter)
    sources = library.rglob("*.[ch]")
    used = {tag for source in sources for tag in tags_in(source.read_text(), letter)}
    assert sorted(documented) == sorted(set(documented))
    assert set(documented) == used


@pytest.mark.parametrize(("page", "library", "letter"), LIBRARIES)
def test_each_equation_s_tag_stands_where_it_is_computed(page, library, letter):
    """Each tag is in a source file, not only in a header."""
    documented = set(tags_in((CHECKOUT / page).read_text(), letter))
    sources = library.rglob("*.c")
    computed = {tag for source in sources for tag in tags_in(source.read_text(), letter)}
    assert documented == computed


@pytest.mark.parametrize(("library", "least"), [("core", 200), ("joints", 50)])
def test_no_function_takes_more_than_five_parameters(library, least):
    counts = {
        f"{source.name} {name}": parameters.count(",") + 1
        for source in (CHECKOUT / "firmware" / library).rglob("*.[ch]")
        for name, parameters in FUNCTION.findall(COMMENT.sub("", source.read_text()))
    }
    assert len(counts) > least
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


def test_links_have_a_target():
    links = [page.parent / link for page in PAGES for link in LINK.findall(page.read_text())]
    assert len(links) > 50
    assert [str(link) for link in links if not link.exists()] == []


def test_files_and_make_targets_that_pages_name_exist():
    makefile = (CHECKOUT / "Makefile").read_text()
    targets = {*re.findall(r"^([a-z-]+):", makefile, re.MULTILINE)}
    text = "".join(page.read_text() for page in PAGES)
    assert {*TARGET.findall(text)} - targets == set()
    assert [name for name in FILE.findall(text) if not (CHECKOUT / name).exists()] == []
