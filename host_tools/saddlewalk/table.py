"""CSV in and out: strict reading, all-or-nothing writing."""

import contextlib
import csv
import gzip
import itertools
import math
import sys
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any, TextIO

from saddlewalk.atomic_write import atomic_file
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
    with atomic_file("--out", out or "-") as file:
        _write_rows(file, columns, rows)


def _write_rows(file: IO[Any], columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    rows = iter(rows)
    first = list(itertools.islice(rows, 1))  # no header if the first row fails
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
    for line, row in read_texts(source, *layouts):
        yield line, numbers_of(source, line, row, list(row))


def read_texts(source: str, *layouts: Sequence[str]) -> Iterator[tuple[int, dict[str, str]]]:
    """Rows of a CSV file, compressed if it ends in .gz, as (line number, column -> text).

    The columns of the first layout that the header matches, or else of the closest one. Raises
    UserError naming the file and the column that is missing or the line that is damaged.
    """
    name = _name(source)
    try:
        with _open(source) as file:
            reader = csv.DictReader(file, strict=True)
            header = reader.fieldnames or ()
            columns = min(layouts, key=lambda names: len(set(names) - set(header)))
            _check_header(name, header, columns)
            for row in reader:
                if None in row or None in row.values():
                    where = f"{name}: line {reader.line_num}"
                    raise UserError(f"{where}: not as many cells as the header has columns")
                yield reader.line_num, {column: row[column] for column in columns}
    except (gzip.BadGzipFile, zlib.error, EOFError) as error:
        raise UserError(f"{name}: not a whole gzip file: {error}") from error
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
    if source.endswith(".gz"):
        return gzip.open(source, "rt", newline="", encoding="utf-8-sig")
    return Path(source).open(newline="", encoding="utf-8-sig")


def numbers_of(
    source: str, line: int, row: Mapping[str, str], columns: Sequence[str]
) -> dict[str, float]:
    """The numbers of these columns; an empty cell is NaN. UserError: a text is no number."""
    numbers = {}
    for column in columns:
        text = row[column].strip()
        try:
            numbers[column] = float(text) if text else math.nan
        except ValueError:
            where = f"{_name(source)}: line {line}, {column}"
            raise UserError(f"{where}: {text!r} is not a number (empty: not measured)") from None
    return numbers
