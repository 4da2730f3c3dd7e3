#!/usr/bin/env python3
"""The documentation as a site: the pages of docs, and a reference from what the code says.

usage: tools/site.py OUT_FOLDER

Needs `make build`, and the extra `site`. A link that leads nowhere is an error.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import cantools

from saddlewalk import cli, config, contract, core
from saddlewalk.verdict import REASON_WORDS

ROOT = Path(__file__).resolve().parents[1]
TYPES = ROOT / "firmware/core/include/saddlewalk/types.h"
LINK = re.compile(r"(!?)\[([^\]]+)\]\(([^)#\s]+)(#[^)]*)?\)")
FRONT = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
}


def main() -> None:
    out = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        pages = Path(folder) / "docs"
        shutil.copytree(ROOT / "docs", pages)
        for name, page in FRONT.items():
            (pages / page).write_text((ROOT / name).read_text().replace("](docs/", "]("))
        for name, written in REFERENCE.items():
            (pages / f"reference-{name}.md").write_text(written())
        for page in pages.glob("*.md"):
            page.write_text(LINK.sub(lambda link: _link(link, pages), page.read_text()))
        playground = ROOT / "build/playground.html"
        if playground.exists():
            shutil.copy(playground, pages)
            with (pages / "index.md").open("a") as index:
                index.write("\n[Open the playground](playground.html)\n")
        settings = Path(folder) / "mkdocs.yml"
        settings.write_text((ROOT / "tools/mkdocs.yml").read_text())
        mkdocs = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet"]
        quiet = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "DISABLE_MKDOCS_2_WARNING": "true"}
        subprocess.run([*mkdocs, "-f", settings, "-d", out], check=True, env=quiet)
    for page in out.glob("*.html"):
        text = page.read_text()
        elsewhere = re.search(r'<(?:script|link|img)[^>]* (?:src|href)="https?:[^"]*"', text)
        if elsewhere:
            sys.exit(f"{page.name} asks for something from elsewhere: {elsewhere[0]}")
    print(f"{out}: {len(list(out.rglob('*.html')))} pages, no warning")


def _link(link: re.Match[str], pages: Path) -> str:
    """A link to a page of the site; of a link to a source, its text alone."""
    image, text, target, part = link.groups()
    if target.startswith(("http:", "https:", "mailto:")):
        return link[0]
    name = Path(target).name
    name = FRONT.get(name, name)
    if (pages / name).exists():
        return f"{image}[{text}]({name}{part or ''})"
    return text


# ---- the reference


def _table(head: str, rows: list[list[str]]) -> str:
    cells = [head.split("|"), ["---"] * (head.count("|") + 1), *rows]
    return "\n".join(f"| {' | '.join(str(cell).strip() for cell in row)} |" for row in cells) + "\n"


def _comments(prefix: str) -> dict[str, str]:
    """What types.h says beside each enumerator."""
    text = TYPES.read_text()
    found = re.findall(rf"\b{prefix}(\w+) = [^,/]*,?\s*/\*\*< (.*?)\*/", text, re.DOTALL)
    return {name: " ".join(words.split()) for name, words in found}


def configuration() -> str:
    struct = re.search(r"typedef struct \{([^}]*)\} saddle_config_t;", TYPES.read_text())[1]
    said = dict(re.findall(r"\bfloat (?:\w+, )*(\w+);\s*(?:/\*\*< (.*?)\*/)?", struct, re.DOTALL))
    default = config.configuration({})
    rows = [
        [
            f"`{name}`",
            f"{getattr(default, name):.6g}",
            f"{low:g} to {high:g}",
            " ".join(said.get(name, "").split()),
        ]
        for name, (low, high) in core.field_ranges().items()
    ]
    return (
        "# Configuration\n\nThe fields of `saddle_config_t`, for `--config`, `--set` and C. The "
        "default is that of a body of 1.79 m and 63.3 kg.\n\n"
        + _table("field|default|accepted|meaning", rows)
    )


def codes() -> str:
    parts = ["# Levels, reasons, faults and limits\n"]
    rows = [[str(n), f"`{name}`", REASON_WORDS[name]] for n, name in enumerate(contract.REASONS)]
    parts += ["## Reasons\n", _table("code|reason|what it says", rows)]
    for title, prefix, names in (
        ("Levels", "SADDLE_LEVEL_", [name.upper() for name in contract.LEVELS]),
        ("Faults", "SADDLE_FAULT_", contract.FAULTS),
        ("Limits", "SADDLE_LIMIT_", contract.LIMITS),
        ("Statuses", "SADDLE_", contract.STATUSES),
    ):
        said = _comments(prefix)
        rows = [[str(n), f"`{name}`", said.get(name, "")] for n, name in enumerate(names)]
        parts += [f"## {title}\n", _table("bit or code|name|meaning", rows)]
    return "\n".join(parts)


def can() -> str:
    database = cantools.database.load_file(ROOT / "firmware/wire/saddlewalk.dbc")
    parts = [f"# CAN messages\n\nWire version {database.version}, from `saddlewalk.dbc`.\n"]
    for message in database.messages:
        rows = [
            [
                f"`{signal.name}`",
                f"{signal.start}, {signal.length}",
                f"{signal.scale:g}",
                signal.unit or "",
                (signal.comment or "").replace("\n", " "),
            ]
            for signal in message.signals
        ]
        parts += [
            f"## {message.name}\n\nIdentifier 0x{message.frame_id:X}. {message.comment or ''}\n",
            _table("signal|start, bits|scale|unit|meaning", rows),
        ]
    return "\n".join(parts)


def lcm() -> str:
    types = sorted((ROOT / "lcm_types").glob("*.lcm"))
    return "# LCM types\n\n" + "\n".join(
        f"## {path.stem}\n\n```c\n{path.read_text()}```\n" for path in types
    )


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


def c_interface() -> str:
    headers = [TYPES.with_name("saddlewalk.h"), TYPES]
    return "# C interface\n\n" + "\n".join(
        f"## {path.name}\n\n```c\n{path.read_text()}```\n" for path in headers
    )


REFERENCE: dict[str, Callable[[], str]] = {
    "commands": commands,
    "configuration": configuration,
    "codes": codes,
    "can": can,
    "lcm": lcm,
    "c": c_interface,
}

if __name__ == "__main__":
    main()
