"""CSV in and out: strict reading, all-or-nothing writing."""

import contextlib
import csv
import itertools
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TextIO

from saddlewalk.atomic_write import whole_file
from saddlewalk.errors import UserError

RESOLUTION_S = 0.5e-6  # the firmware counts microseconds
Cell = float | int | str | None


def format_cell(value: Cell) -> str:
    """Shortest text that reads back to the same number; None and NaN are empty."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return repr(value) if isinstance(value, float) else str(value)


def write_table(out: str | None, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Write CSV to the file `out`, whole or not at all; None or "-": stream to standard output."""
    with whole_file("--out", out or "-") as file:
        _write_rows(file, columns, rows)


def _write_rows(file: TextIO, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    rows = iter(rows)
    first = list(itertools.islice(rows, 1))  # input that is bad from the start gives no header
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([format_cell(cell) for cell in row] for row in itertools.chain(first, rows))


def read_table(source: str, columns: Sequence[str]) -> Iterator[tuple[int, dict[str, float]]]:
    """Rows of a CSV file, or of standard input ("-"), as (line number, column -> number).

    An empty cell is NaN. Further columns are ignored. Raises UserError naming the file, the line,
    the column and the text that is not a number.
    """
    return _read_rows(source, [columns])


def _read_rows(
    source: str, layouts: Sequence[Sequence[str]]
) -> Iterator[tuple[int, dict[str, float]]]:
    """The columns of the first layout that the header has, or else of the one it nearly has."""
    name = _name(source)
    try:
        with _open(source) as file:
            reader = csv.DictReader(file, strict=True)
            header = reader.fieldnames or ()
            columns = min(layouts, key=lambda names: len(set(names) - set(header)))
            _check_header(name, header, columns)
            for row in reader:
                yield reader.line_num, _numbers(name, reader.line_num, row, columns)
    except OSError as error:
        raise UserError(f"{name}: {error.strerror}") from error
    except (csv.Error, UnicodeDecodeError) as error:
        raise UserError(f"{name}: not CSV: {error}") from error


def read_series(
    source: str, columns: Sequence[str], longest_s: float
) -> Iterator[tuple[int, dict[str, float]]]:
    """A read_table() whose first column is a time in seconds that increases, by up to longest_s."""
    return read_any_series(source, [columns], longest_s)


def read_any_series(
    source: str, layouts: Sequence[Sequence[str]], longest_s: float
) -> Iterator[tuple[int, dict[str, float]]]:
    """A read_series() of the first of several layouts that the file has."""
    start_s = last_s = None
    for line, numbers in _read_rows(source, layouts):
        time, now_s = next(iter(numbers.items()))
        where = f"{_name(source)}: line {line}, {time}: {now_s:.9g}"
        if not math.isfinite(now_s):
            raise UserError(f"{where} must be a finite time in seconds")
        if last_s is not None and now_s - last_s < RESOLUTION_S:
            raise UserError(f"{where} must be later than {last_s:.9g} s")
        start_s, last_s = now_s if start_s is None else start_s, now_s
        if now_s - start_s > longest_s:
            raise UserError(f"{where} must be within {longest_s:g} s of the first, {start_s:.9g} s")
        yield line, numbers


def _name(source: str) -> str:
    return "standard input" if source == "-" else source


def _check_header(name: str, header: Sequence[str], columns: Sequence[str]) -> None:
    for column in columns:
        if column not in header:
            raise UserError(f"{name}: no column {column}; needed: {', '.join(columns)}")
        if header.count(column) > 1:
            raise UserError(f"{name}: {header.count(column)} columns {column}; one is needed")


def _open(source: str) -> contextlib.AbstractContextManager[TextIO]:
    if source == "-":
        if sys.stdin is None:
            raise UserError("standard input is closed: give a file")
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
