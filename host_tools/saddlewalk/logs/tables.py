"""An LCM log as tables for other tools: one per channel, a row a message, units in column names.

Columns are the members of the LCM type, behind `logged_s`: when the message was logged, seconds
since 1970. An array becomes a column for each element, whose name stands before the unit:
com_m[3] is com_x_m, com_y_m, com_z_m. Numbers that are not known are NaN.

A log is read twice, block by block, so that its size does not matter: for what it holds, and to
write it.
"""

import contextlib
import csv
import importlib.util
import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from saddlewalk.atomic_write import atomic_file, atomic_folder
from saddlewalk.contract import SIDES
from saddlewalk.errors import UserError
from saddlewalk.logs.messages import Kind, UnknownMessages, kinds
from saddlewalk.logs.run_files import table_names
from saddlewalk.paths import install_command
from saddlewalk.transport.lcm_log import Event

UNITS = tuple(f"_{unit}" for unit in "m_s n_s m rad s us n j kg".split())  # longest first
AXES = ("x", "y", "z")
BY_SIDE = {"foot_pitch_rad", "foot_yaw_rad", "load"}  # pairs that are not of x and y

BLOCK = 8192  # rows of a table in memory
COLUMNS_MAX = 1000  # of SADDLEWALK_CONFIG, whose columns are in the message
LOGGED = "logged_s"
TIME_MAX_NS = 2**64 - 1  # of MCAP

Value = float | int | str


@dataclass(frozen=True)
class Block:
    """Some rows of a table."""

    logged_us: np.ndarray
    columns: dict[str, Any]  # of each an array, or a list in which None is no value

    def lists(self, unknown: Callable[[Any], Any]) -> Iterator[list[Value | None]]:
        """The columns, with `unknown` floats as None."""
        for values in self.columns.values():
            listed = values if isinstance(values, list) else values.tolist()
            if isinstance(values, list):
                listed = [None if isinstance(v, float) and unknown(v) else v for v in values]
            elif values.dtype.kind == "f":
                for index in np.flatnonzero(unknown(values)).tolist():
                    listed[index] = None
            yield listed


class Table:
    """One channel of a log, a block of rows at a time."""

    def __init__(self, kind: Kind) -> None:
        self.channel, self.name = kind.channel, kind.name
        self.kinds = {LOGGED: "double"}  # column -> LCM's name of its type
        self._kind = kind
        self._logged_us: list[int] = []
        self._rows: list[Any] = []  # encoded messages of a fixed layout, else cells
        if kind.layout is not None:
            self.kinds |= {name: of for name, (of, _) in columns_of(kind.type()).items()}

    def learn(self, event: Event) -> bool:
        """Whether the event is a row. A row that names its own columns adds them to the table."""
        row = self._row(event)
        if row is None or isinstance(row, bytes):
            return row is not None
        if len(self.kinds.keys() | row.keys()) > COLUMNS_MAX:
            return False
        for column, (kind, _) in row.items():
            self.kinds.setdefault(column, kind)
        return True

    def add(self, event: Event) -> None:
        """Add the event's row, if it has the table's columns."""
        row = self._row(event)
        if isinstance(row, bytes) or (row is not None and row.keys() <= self.kinds.keys()):
            self._logged_us.append(event.logged_us)
            self._rows.append(row)

    @property
    def full(self) -> bool:
        return len(self._rows) >= BLOCK

    def take(self) -> Block:
        """The rows since the last block."""
        rows, logged_us = self._rows, np.array(self._logged_us, np.int64)
        self._rows, self._logged_us = [], []
        columns = self._lists(rows) if self._kind.layout is None else self._arrays(rows)
        return Block(logged_us, {LOGGED: logged_us / 1e6, **columns})

    def _row(self, event: Event) -> Any:
        if self._kind.layout is not None:
            return event.data if self._kind.is_whole(event.data) else None
        message = self._kind.decode(event.data)
        if message is None:
            return None
        cells = _config_columns(message) if self.name == "config" else columns_of(message)
        cells.pop(LOGGED, None)
        return cells

    def _lists(self, rows: list[dict[str, Any]]) -> dict[str, Any]:
        columns = [column for column in self.kinds if column != LOGGED]
        return {column: [row.get(column, (None, None))[1] for row in rows] for column in columns}

    def _arrays(self, rows: list[bytes]) -> dict[str, Any]:
        messages = np.frombuffer(b"".join(rows), self._kind.layout)
        columns: dict[str, Any] = {}
        for name in self._kind.type.__slots__:
            values = messages[name].astype(messages[name].dtype.newbyteorder("="))
            if values.ndim == 1:
                columns[name] = values
            else:
                parts = element_names(name, values.shape[1])
                columns |= dict(zip(parts, values.T, strict=True))
        return columns


def tables_of(events: Iterable[Event]) -> tuple[dict[str, Table], UnknownMessages]:
    """Empty tables in the order of their channels, and the counts of unknown messages."""
    tables: dict[str, Table] = {}
    others = UnknownMessages()
    for event in events:
        kind = kinds().get(event.channel)
        table = tables.get(event.channel) or (Table(kind) if kind else None)
        if table and table.learn(event):
            tables[event.channel] = table
        else:
            others.add(event.channel)
    return {channel: tables[channel] for channel in sorted(tables)}, others


def columns_of(message: Any) -> dict[str, tuple[str, Value]]:
    """Column -> (LCM's name of its type, value), in the order of the type's members."""
    columns: dict[str, tuple[str, Value]] = {}
    for name, kind in zip(message.__slots__, message.__typenames__, strict=True):
        value = getattr(message, name)
        if isinstance(value, list | tuple):
            names = element_names(name, len(value))
            columns |= {part: (kind, v) for part, v in zip(names, value, strict=True)}
        else:
            columns[name] = (kind, value)
    return columns


def _config_columns(config: Any) -> dict[str, tuple[str, Value]]:
    """Columns of config_t, which carries the names of its fields."""
    kinds = dict(zip(config.__slots__, config.__typenames__, strict=True))
    members = ("utime_us", "library_version", "wire_version", "lockstep", "ankle")
    single = {name: (kinds[name], getattr(config, name)) for name in members}
    named = zip(config.name, config.value, strict=True)
    return single | {name: (kinds["value"], value) for name, value in named} | single


def element_names(name: str, count: int) -> list[str]:
    """Names of an array's elements."""
    unit = next((unit for unit in UNITS if name.endswith(unit)), "")
    stem = name.removesuffix(unit)
    parts = SIDES if name in BY_SIDE else AXES
    if count > len(parts):
        parts = tuple(map(str, range(count)))
    return [f"{stem}_{part}{unit}" for part in parts[:count]]


class Writer(Protocol):
    """Writes the tables of a log in one format, to one or more files."""

    paths: list[Path]

    def write(self, table: Table, block: Block) -> None: ...

    def finish(self) -> None: ...


def export(log: Iterable[Event], tables: dict[str, Table], form: str, out: Path) -> list[Path]:
    """Write the tables of a log, atomically; returns the files."""
    missing = {"csv": None, "parquet": "pyarrow", "mcap": "mcap"}[form]
    if missing and not importlib.util.find_spec(missing):
        raise _missing(form, missing)
    with contextlib.ExitStack() as files:
        writer = _WRITERS[form](list(tables.values()), out, files)
        for event in log:
            if table := tables.get(event.channel):
                table.add(event)
                if table.full:
                    writer.write(table, table.take())
        for table in tables.values():
            writer.write(table, table.take())
        writer.finish()
    return writer.paths


class _CsvFiles:
    """FOLDER/plan.csv and so on; an unknown number is an empty cell."""

    def __init__(self, tables: list[Table], folder: Path, files: contextlib.ExitStack) -> None:
        self.paths = [folder / f"{table.name}.csv" for table in tables]
        new = files.enter_context(atomic_folder("--out", folder, table_names("csv")))
        self._writers = {}
        for table in tables:
            file = files.enter_context((new / f"{table.name}.csv").open("w", newline=""))
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(table.kinds)
            self._writers[table.name] = writer

    def write(self, table: Table, block: Block) -> None:
        self._writers[table.name].writerows(zip(*block.lists(np.isnan), strict=True))

    def finish(self) -> None:
        pass


class _ParquetFiles:
    """FOLDER/plan.parquet and so on, each column of its LCM type."""

    def __init__(self, tables: list[Table], folder: Path, files: contextlib.ExitStack) -> None:
        import pyarrow.parquet

        self.paths = [folder / f"{table.name}.parquet" for table in tables]
        new = files.enter_context(atomic_folder("--out", folder, table_names("parquet")))
        self._writers = {}
        for table in tables:
            schema = pyarrow.schema(
                (column, pyarrow.type_for_alias(_ARROW.get(kind, kind.removesuffix("_t"))))
                for column, kind in table.kinds.items()
            )
            file = files.enter_context((new / f"{table.name}.parquet").open("wb"))
            self._writers[table.name] = pyarrow.parquet.ParquetWriter(file, schema)

    def write(self, table: Table, block: Block) -> None:
        import pyarrow

        writer = self._writers[table.name]
        arrays = [
            pyarrow.array(values, field.type)
            for values, field in zip(block.columns.values(), writer.schema, strict=True)
        ]
        writer.write_batch(pyarrow.record_batch(arrays, schema=writer.schema))

    def finish(self) -> None:
        for writer in self._writers.values():
            writer.close()


class _McapFile:
    """One file of JSON messages with a JSON schema a channel; an unknown number is left out."""

    def __init__(self, tables: list[Table], path: Path, files: contextlib.ExitStack) -> None:
        from mcap.writer import Writer

        self.paths = [path]
        self._writer = Writer(files.enter_context(atomic_file("--out", path, "wb")))
        self._writer.start(library="saddlewalk")
        self._channels = {table.name: self._channel(table) for table in tables}
        self._rows = dict.fromkeys(self._channels, 0)

    def _channel(self, table: Table) -> int:
        properties = {column: {"type": _json_type(kind)} for column, kind in table.kinds.items()}
        schema = {"type": "object", "title": table.name, "properties": properties}
        schema_id = self._writer.register_schema(
            f"saddlewalk.{table.name}", "jsonschema", json.dumps(schema).encode()
        )
        return self._writer.register_channel(table.channel, "json", schema_id)

    def write(self, table: Table, block: Block) -> None:
        columns = block.lists(lambda values: ~np.isfinite(values))
        rows = zip(block.logged_us.tolist(), *columns, strict=True)
        for sequence, (logged_us, *row) in enumerate(rows, start=self._rows[table.name]):
            known = {n: v for n, v in zip(table.kinds, row, strict=True) if v is not None}
            time_ns = min(max(0, logged_us) * 1000, TIME_MAX_NS)
            data = json.dumps(known, allow_nan=False).encode()
            channel = self._channels[table.name]
            self._writer.add_message(channel, time_ns, data, time_ns, sequence)
        self._rows[table.name] += len(block.logged_us)

    def finish(self) -> None:
        finish: Callable[[], None] = self._writer.finish  # which has no types
        finish()


_WRITERS: dict[str, Callable[[list[Table], Path, contextlib.ExitStack], Writer]] = {
    "csv": _CsvFiles,
    "parquet": _ParquetFiles,
    "mcap": _McapFile,
}
_ARROW = {"float": "float32", "double": "float64"}


def _json_type(kind: str) -> str:
    return {"float": "number", "double": "number", "string": "string"}.get(kind, "integer")


def _missing(form: str, package: str) -> UserError:
    return UserError(f"--format {form} needs {package}: {install_command('export')}")
