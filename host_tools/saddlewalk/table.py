"""CSV in and out: strict reading, all-or-nothing writing."""

import contextlib
import csv
import math
import os
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TextIO

from saddlewalk.errors import UserError

Cell = float | int | str | None


def format_cell(value: Cell) -> str:
    """Shortest text that reads back to the same number; None and NaN are empty."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return repr(value) if isinstance(value, float) else str(value)


def write_table(out: str | None, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Write CSV to the file `out` in one piece, or stream it to standard output (None or "-")."""
    if out is None or out == "-":
        _write_rows(sys.stdout, columns, rows)
        return
    path = Path(out)
    try:
        descriptor, partial = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise UserError(f"--out {out}: {error.strerror}") from error
    try:
        with os.fdopen(descriptor, "w", newline="") as file:
            _write_rows(file, columns, rows)
        mask = os.umask(0)
        os.umask(mask)
        Path(partial).chmod(0o666 & ~mask)
        Path(partial).replace(path)
    except OSError as error:
        raise UserError(f"--out {out}: {error.strerror}") from error
    finally:
        Path(partial).unlink(missing_ok=True)


def _write_rows(file: TextIO, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([format_cell(cell) for cell in row] for row in rows)


def read_table(source: str, columns: Sequence[str]) -> Iterator[tuple[int, dict[str, float]]]:
    """Rows of a CSV file, or of standard input ("-"), as (line number, column -> number).

    An empty cell is NaN. Further columns are ignored. Raises UserError naming the file, the line,
    the column and the text that is not a number.
    """
    name = "standard input" if source == "-" else source
    try:
        with _open(source) as file:
            reader = csv.DictReader(file, strict=True)
            missing = [column for column in columns if column not in (reader.fieldnames or ())]
            if missing:
                raise UserError(f"{name}: no column {missing[0]}; needed: {', '.join(columns)}")
            for row in reader:
                yield reader.line_num, _numbers(name, reader.line_num, row, columns)
    except OSError as error:
        raise UserError(f"{name}: {error.strerror}") from error
    except (csv.Error, UnicodeDecodeError) as error:
        raise UserError(f"{name}: not CSV: {error}") from error


def _open(source: str) -> contextlib.AbstractContextManager[TextIO]:
    if source == "-":
        return contextlib.nullcontext(sys.stdin)
    return Path(source).open(newline="", encoding="utf-8-sig")


def _numbers(name: str, line: int, row: dict[str, str], columns: Sequence[str]) -> dict[str, float]:
    if None in row or None in row.values():
        raise UserError(f"{name}: line {line}: not as many cells as the header has columns")
    numbers = {}
    for column in columns:
        text = row[column].strip()
        try:
            numbers[column] = float(text) if text else math.nan
        except ValueError:
            raise UserError(
                f"{name}: line {line}, {column}: {text!r} is not a number (empty: not measured)"
            ) from None
    return numbers
