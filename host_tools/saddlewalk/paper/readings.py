"""The decisions in docs/equations.md where the paper is ambiguous, wrong or incomplete."""

import re
from dataclasses import dataclass

from saddlewalk.errors import UserError
from saddlewalk.paths import source

PAGE = source("docs/equations.md")
MARK = "*reading*"
_ROW = re.compile(r"\| \[(?P<tag>E\d+)\] \| (?P<equation>.+) \| (?P<label>.+) \| (?P<words>.+) \|")


@dataclass(frozen=True)
class Reading:
    """A row of the page with a reading in its last column, as Markdown."""

    tag: str
    equation: str
    label: str  # of the paper
    words: str


def readings() -> list[Reading]:
    """Raises UserError if the page is missing or has no readings."""
    try:
        text = PAGE.read_text(encoding="utf-8")
    except OSError as error:
        raise UserError(f"{PAGE}: {error.strerror}; it has the readings of the paper") from error
    rows = (_ROW.fullmatch(line) for line in text.splitlines())
    found = [Reading(**row.groupdict()) for row in rows if row and MARK in row["words"]]
    if not found:
        raise UserError(f"{PAGE}: no row of a table with {MARK}")
    return found
