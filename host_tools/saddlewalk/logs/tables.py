"""An LCM log as tables for other tools: one per channel, a row a message, units in column names.

Columns are the members of the LCM type, behind `logged_s`: when the message was logged, seconds
since 1970. An array becomes a column for each element, whose name stands before the unit:
com_m[3] is com_x_m, com_y_m, com_z_m. Numbers that are not known are NaN.
"""

import json
import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from saddlewalk.atomic_write import whole_file, whole_folder
from saddlewalk.errors import UserError
from saddlewalk.logs.messages import CHANNEL_PREFIX, Event, decode
from saddlewalk.logs.run_files import table_names
from saddlewalk.paths import install_command
from saddlewalk.table import write_table

UNITS = tuple(f"_{unit}" for unit in "m_s n_s m rad s us n j kg".split())  # longest first
SIDES = ("left", "right")
AXES = ("x", "y", "z")
BY_SIDE = {"foot_pitch_rad"}  # pairs that are not of x and y

TIME_MAX_NS = 2**64 - 1  # of MCAP

Value = float | int | str


@dataclass
class Table:
    """One channel of a log."""

    channel: str
    kinds: dict[str, str] = field(default_factory=dict)  # column -> LCM's name of its type
    rows: list[dict[str, Value]] = field(default_factory=list)

    @property
    def name(self) -> str:
        """As a file is named: plan, scores, ..."""
        return self.channel.removeprefix(CHANNEL_PREFIX).lower()

    def add(self, event: Event, message: Any) -> None:
        columns = _config_columns if self.name == "config" else columns_of
        cells = {"logged_s": ("double", event.logged_us / 1e6), **columns(message)}
        for column, (kind, _) in cells.items():
            self.kinds.setdefault(column, kind)
        self.rows.append({column: value for column, (_, value) in cells.items()})


def tables_of(events: Iterable[Event]) -> tuple[list[Table], Counter[str]]:
    """Tables in the order of their channels' names, and how many messages have no type of ours."""
    tables: dict[str, Table] = {}
    left_out: Counter[str] = Counter()
    for event in events:
        message = decode(event)
        if message is None:
            left_out[event.channel] += 1
        else:
            tables.setdefault(event.channel, Table(event.channel)).add(event, message)
    return [tables[channel] for channel in sorted(tables)], left_out


def columns_of(message: Any) -> dict[str, tuple[str, Value]]:
    """Column -> (LCM's name of its type, value), in the order of the type's members."""
    columns = {}
    for name, kind in zip(message.__slots__, message.__typenames__, strict=True):
        value = getattr(message, name)
        if isinstance(value, list | tuple):
            names = element_names(name, len(value))
            columns |= {part: (kind, v) for part, v in zip(names, value, strict=True)}
        else:
            columns[name] = (kind, value)
    return columns


def _config_columns(config: Any) -> dict[str, tuple[str, Value]]:
    """Those of config_t, which has the names of its fields beside their values."""
    single = ("utime_us", "library_version", "wire_version", "lockstep", "ankle")
    kinds = dict(zip(config.__slots__, config.__typenames__, strict=True))
    named = zip(config.name, config.value, strict=True)
    return {name: (kinds[name], getattr(config, name)) for name in single} | {
        name: (kinds["value"], value) for name, value in named
    }


def element_names(name: str, count: int) -> list[str]:
    """Names of an array's elements."""
    unit = next((unit for unit in UNITS if name.endswith(unit)), "")
    stem = name.removesuffix(unit)
    parts = SIDES if name in BY_SIDE else AXES
    if count > len(parts):
        parts = tuple(map(str, range(count)))
    return [f"{stem}_{part}{unit}" for part in parts[:count]]


def write_csv(tables: list[Table], folder: Path) -> list[Path]:
    """FOLDER/plan.csv and so on; an unknown number is an empty cell."""
    with whole_folder("--out", folder, table_names("csv")) as new:
        for table in tables:
            rows = ([row.get(column) for column in table.kinds] for row in table.rows)
            write_table(str(new / f"{table.name}.csv"), list(table.kinds), rows)
    return [folder / f"{table.name}.csv" for table in tables]


def write_parquet(tables: list[Table], folder: Path) -> list[Path]:
    """FOLDER/plan.parquet and so on, each column of its LCM type."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise _missing("parquet", "pyarrow") from error
    arrow = {"float": "float32", "double": "float64"}
    with whole_folder("--out", folder, table_names("parquet")) as new:
        for table in tables:
            columns = {
                column: pyarrow.array(
                    [row.get(column) for row in table.rows],
                    pyarrow.type_for_alias(arrow.get(kind, kind.removesuffix("_t"))),
                )
                for column, kind in table.kinds.items()
            }
            pyarrow.parquet.write_table(pyarrow.table(columns), new / f"{table.name}.parquet")
    return [folder / f"{table.name}.parquet" for table in tables]


def write_mcap(tables: list[Table], path: Path) -> list[Path]:
    """One file of JSON messages with a JSON schema a channel; an unknown number is left out."""
    try:
        from mcap.writer import Writer
    except ImportError as error:
        raise _missing("mcap", "mcap") from error
    with whole_file("--out", path, "wb") as file:
        writer = Writer(file)
        writer.start(library="saddlewalk")
        for table in tables:
            _add_channel(writer, table)
        writer.finish()
    return [path]


def _add_channel(writer: Any, table: Table) -> None:
    schema = {
        "type": "object",
        "title": table.name,
        "properties": {column: {"type": _json_type(kind)} for column, kind in table.kinds.items()},
    }
    schema_id = writer.register_schema(
        f"saddlewalk.{table.name}", "jsonschema", json.dumps(schema).encode()
    )
    channel_id = writer.register_channel(table.channel, "json", schema_id)
    for sequence, row in enumerate(table.rows):
        known = {name: value for name, value in row.items() if _is_known(value)}
        time_ns = min(max(0, round(row["logged_s"] * 1e6) * 1000), TIME_MAX_NS)
        data = json.dumps(known, allow_nan=False).encode()
        writer.add_message(channel_id, time_ns, data, time_ns, sequence)


def _is_known(value: Value) -> bool:
    return isinstance(value, str) or math.isfinite(value)


def _json_type(kind: str) -> str:
    return {"float": "number", "double": "number", "string": "string"}.get(kind, "integer")


def _missing(form: str, package: str) -> UserError:
    return UserError(f"--format {form} needs {package}: {install_command('export')}")
