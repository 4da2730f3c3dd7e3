"""Text from outside, as a terminal or a page can show it without acting on it."""


def printable(text: object) -> str:
    """On one line, with an escape such as \\x1b in the place of each character that is not printed.

    Log contents, channel and file names may hold terminal sequences, line ends, C1 controls,
    direction marks, and bytes that are no text.
    """
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in str(text))
