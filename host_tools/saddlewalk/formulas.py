"""Formulas in Markdown, drawn by the browser alone: LaTeX between dollars becomes MathML."""

import re

from latex2mathml.converter import convert

# Code, which stays; a formula; a symbol with an index, such as d_SW.
_PARTS = re.compile(
    r"`[^`\n]*`|\$(?P<formula>[^$\n]+)\$|\b(?P<symbol>[^\W\d_]{1,2})_(?P<index>[^\W_]+(?:,[a-z]+)?)\b"
)


def drawn(markdown: str) -> str:
    """The same Markdown with HTML for its formulas, and for symbols that stand in the text."""
    return _PARTS.sub(_part, markdown)


def _part(part: re.Match[str]) -> str:
    if part["formula"]:
        # All that it puts over a symbol are accents: dots, bars and tildes.
        return convert(part["formula"]).replace("<mover>", '<mover accent="true">')
    if part["symbol"]:
        return f"<i>{part['symbol']}</i><sub>{part['index']}</sub>"
    return part[0]
