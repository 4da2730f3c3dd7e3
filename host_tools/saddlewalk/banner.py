"""Words in letters of three lines."""

GAP = " "
# The letters of the levels' names and of FELL, row by row.
LETTERS = {
    "A": ("▄▀▄", "█▀█", "▀ ▀"),
    "B": ("█▀▄", "█▀▄", "▀▀ "),
    "C": ("▄▀▀", "█  ", " ▀▀"),
    "E": ("█▀▀", "█▀▀", "▀▀▀"),
    "F": ("█▀▀", "█▀ ", "▀  "),
    "I": ("█", "█", "▀"),
    "K": ("█ █", "█▀▄", "▀ ▀"),
    "L": ("█  ", "█  ", "▀▀▀"),
    "N": ("█▄ █", "█ ▀█", "▀  ▀"),
    "O": ("▄▀▄", "█ █", " ▀ "),
    "S": ("▄▀▀", " ▀▄", "▀▀ "),
    "T": ("▀█▀", " █ ", " ▀ "),
    "U": ("█ █", "█ █", " ▀ "),
    "W": ("█   █", "█ █ █", " ▀ ▀ "),
}


def banner(word: str) -> str:
    """Three lines of text; a word with a letter that is missing here is returned unchanged."""
    if not set(word) <= LETTERS.keys():
        return word
    letters = [LETTERS[letter] for letter in word]
    return "\n".join(GAP.join(rows) for rows in zip(*letters, strict=True))
