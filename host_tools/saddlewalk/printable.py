"""Untrusted text, made safe to show on a terminal or a page."""


def printable(text: object) -> str:
    """On one line, with an escape such as \\x1b for each character that is not printable.

    Log contents, channel and file names may hold terminal sequences, line ends, C1 controls,
    direction marks, and bytes that are not text.
    """
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in str(text))
