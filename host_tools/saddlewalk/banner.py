"""Words three lines high, to be read from across the room."""

GAP = " "
# Row by row; as many letters as the names of the levels, and a fall, need.
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
    """Three lines of text; a word with a letter that is not here stays as it is."""
    if not set(word) <= LETTERS.keys():
        return word
    letters = [LETTERS[letter] for letter in word]
    return "\n".join(GAP.join(rows) for rows in zip(*letters, strict=True))
