"""The reference pages of the site, from what the code says."""

import argparse
import functools
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path

import cantools
from c_headers import LIBRARIES, entries, page

from saddlewalk import cli, config, contract, core
from saddlewalk.verdict import REASON_WORDS

ROOT = Path(__file__).resolve().parents[1]
# What programs use of the Python package.
PYTHON = {
    "core": "Core Command Measurement bos_polygon field_ranges",
    "config": "configuration",
    "contract": "name_of bit_names",
    "joints": "legs inverse forward Estimator Controller commands",
    "transport.lcm_log": "LcmLog Event",
    "logs.messages": "decode kinds Kind",
}


def _table(head: str, rows: list[list[str]]) -> str:
    cells = [head.split("|"), ["---"] * (head.count("|") + 1), *rows]
    return "\n".join(f"| {' | '.join(str(cell).strip() for cell in row)} |" for row in cells) + "\n"


def _said(type_name: str) -> dict[str, str]:
    """What types.h says beside each member or enumerator."""
    said = {part.name: part.text for part in entries("core")[type_name].parts}
    silent = [name for name, text in said.items() if not text]
    if silent:
        sys.exit(f"saddlewalk: site: types.h does not say what these mean: {', '.join(silent)}")
    return said


def configuration() -> str:
    default = config.configuration({})
    said = _said("saddle_config_t")
    rows = [
        [f"`{name}`", f"{getattr(default, name):.6g}", f"{low:g} to {high:g}", said[name]]
        for name, (low, high) in core.field_ranges().items()
    ]
    ankles = ", ".join(f"`{name}`" for name in config.ANKLES)
    rows.append(["`ankle`", "`erf`", ankles, said["ankle"]])
    return (
        "# Configuration\n\nThe fields of saddle_config_t, for `--config`, `--set` and C. The "
        "default is that of a body of 1.79 m and 63.3 kg.\n\n"
        + _table("field|default|accepted|meaning", rows)
    )


def codes() -> str:
    parts = ["# Levels, reasons, faults and limits\n"]
    rows = [[str(n), f"`{name}`", REASON_WORDS[name]] for n, name in enumerate(contract.REASONS)]
    parts += ["## Reasons\n", _table("code|reason|what it says", rows)]
    for title, enum, prefix, names in (
        ("Levels", "saddle_level_t", "SADDLE_LEVEL_", [name.upper() for name in contract.LEVELS]),
        ("Faults", "saddle_fault_t", "SADDLE_FAULT_", contract.FAULTS),
        ("Limits", "saddle_limit_t", "SADDLE_LIMIT_", contract.LIMITS),
        ("Statuses", "saddle_status_t", "SADDLE_", contract.STATUSES),
    ):
        said = _said(enum)
        rows = [[str(n), f"`{name}`", said[prefix + name]] for n, name in enumerate(names)]
        parts += [f"## {title}\n", _table("bit or code|name|meaning", rows)]
    return "\n".join(parts)


def can() -> str:
    database = cantools.database.load_file(ROOT / "firmware/wire/saddlewalk.dbc")
    parts = [
        f"# CAN messages\n\nWire version {database.version}, from `saddlewalk.dbc`. "
        "[bus.md](bus.md) says when each is sent, what `CRC` and `COUNTER` are, and what is sent "
        "for a number that is not available.\n"
    ]
    for message in database.messages:
        sender = " and ".join(message.senders).lower()
        parts += [
            f"## {message.name}\n\nIdentifier 0x{message.frame_id:X}, from the {sender}. "
            f"{message.comment}\n",
            _table(
                "signal|start, bits|scale|unit|range|meaning",
                [_signal(signal) for signal in message.signals],
            ),
        ]
    return "\n".join(parts)


def _signal(signal: cantools.database.can.Signal) -> list[str]:
    choices = {number: str(word) for number, word in (signal.choices or {}).items() if number >= 0}
    words = ", ".join(f"{number} `{word}`" for number, word in choices.items())
    return [
        f"`{signal.name}`",
        f"{signal.start}, {signal.length}",
        f"{signal.scale:g}",
        signal.unit or "",
        f"{signal.minimum:.10g} to {signal.maximum:.10g}",
        ": ".join(" ".join(said.split()) for said in (signal.comment, words) if said),
    ]


def lcm() -> str:
    parts = ["# LCM types\n\nFrom `lcm_types`, whose `.lcm` files `lcm-gen` reads.\n"]
    for path in sorted((ROOT / "lcm_types").glob("*.lcm")):
        said, members = re.search(r"((?://.*\n)+)(struct.*)", path.read_text(), re.DOTALL).groups()
        text = said.replace("//", "").strip()
        parts.append(f"## {path.stem}\n\n{text}\n\n```c\n{members}```\n")
    return "\n".join(parts)


def commands() -> str:
    os.environ["COLUMNS"] = "90"
    (choices,) = (
        action.choices
        for action in cli.parser()._actions
        if isinstance(action, argparse._SubParsersAction)
    )
    return "# Commands\n\n" + "\n".join(
        f"## {name}\n\n```text\n{command.format_help()}```\n" for name, command in choices.items()
    )


def python() -> str:
    """Directives that mkdocstrings fills."""
    modules = (
        f"::: saddlewalk.{name}\n    options:\n      members: [{', '.join(members.split())}]\n"
        for name, members in PYTHON.items()
    )
    head = "# Python\n\nWhat programs use of the package; [the tutorial](tutorial.md) shows it."
    return "\n\n".join([head, *modules])


def tutorial() -> str:
    """examples/tutorial.py, a cell that begins with `# %%` after the other."""
    text = (ROOT / "examples/tutorial.py").read_text()
    return "\n".join(map(_cell, re.split(r"^# %%", text, flags=re.MULTILINE)[1:]))


def _cell(cell: str) -> str:
    title, _, body = cell.partition("\n")
    said, code = re.fullmatch(r"((?:#[^\n]*\n)*)(.*)", body, re.DOTALL).groups()
    text = re.sub(r"^# ?", "", said, flags=re.MULTILINE)
    if "[markdown]" in title:
        return text
    return f"## {title.strip()}\n\n{text}\n```python\n{code.strip()}\n```\n"


WRITTEN: dict[str, Callable[[], str]] = {
    "tutorial": tutorial,
    "reference-commands": commands,
    "reference-configuration": configuration,
    "reference-codes": codes,
    "reference-can": can,
    "reference-lcm": lcm,
    "reference-python": python,
    **{f"reference-c-{library}": functools.partial(page, library) for library in LIBRARIES},
}
