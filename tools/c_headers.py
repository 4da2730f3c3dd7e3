"""The public C headers as Doxygen reads them, and pages of them in Markdown.

Doxygen's XML, not a plugin's pages of it: those are one to each struct, and take [E12] for a link.
"""

import functools
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[1]
LIBRARIES = {
    "core": ["core/include/saddlewalk/saddlewalk.h", "core/include/saddlewalk/types.h"],
    "joints": [
        f"joints/include/saddlewalk/{name}.h"
        for name in ("joints", "estimator", "joint_command", "joint_walk")
    ],
    "wire": [f"wire/include/saddlewalk/{name}.h" for name in ("wire", "wire_joints", "cmac")],
}
SETTINGS = """
INPUT = {headers}
OUTPUT_DIRECTORY = {folder}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
OPTIMIZE_OUTPUT_FOR_C = YES
EXTRACT_ALL = YES
QUIET = YES
WARN_AS_ERROR = YES
# A header begins with what it is about.
INPUT_FILTER = "sed '1s|/[*][*]|/** @file\\n|'"
"""


@dataclass
class Entry:
    """A function, type, macro, member or enumerator, and what its comment says, in Markdown."""

    name: str
    kind: str  # as Doxygen calls it
    declared: str  # C
    text: str
    line: int
    parts: list["Entry"] = field(default_factory=list)  # of a struct or an enum


@dataclass
class Header:
    name: str
    text: str
    entries: list[Entry]  # in the header's order


@functools.cache
def headers(library: str) -> list[Header]:
    if not shutil.which("doxygen"):
        sys.exit("saddlewalk: missing: doxygen; as root: apt-get install -y doxygen")
    sources = [ROOT / "firmware" / name for name in LIBRARIES[library]]
    with tempfile.TemporaryDirectory() as folder:
        settings = SETTINGS.format(headers=" ".join(map(str, sources)), folder=folder)
        subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)
        trees = [ElementTree.parse(file).getroot() for file in Path(folder, "xml").glob("*.xml")]
    compounds = [compound for tree in trees for compound in tree.iter("compounddef")]
    files = {c.findtext("compoundname"): c for c in compounds if c.get("kind") == "file"}
    structs = [c for c in compounds if c.get("kind") == "struct"]
    return [_header(files[source.name], structs) for source in sources]


def entries(library: str) -> dict[str, Entry]:
    """All of a library, by name."""
    return {entry.name: entry for header in headers(library) for entry in header.entries}


def _header(file: ElementTree.Element, structs: list[ElementTree.Element]) -> Header:
    path = file.find("location").get("file")
    inside = [s for s in structs if s.find("location").get("file") == path]
    found = [_entry(member) for member in file.iter("memberdef") if member.get("kind") != "typedef"]
    found += [_struct(struct) for struct in inside]
    known = [entry for entry in found if not entry.name.endswith("_H")]  # include guards
    return Header(file.findtext("compoundname"), _text(file), sorted(known, key=lambda e: e.line))


def _entry(member: ElementTree.Element) -> Entry:
    kind, name = member.get("kind"), member.findtext("name")
    written = "".join(member.find("type").itertext()) if member.find("type") is not None else ""
    declared = {
        "function": f"{written} {name}{member.findtext('argsstring')};".replace("* ", "*"),
        "define": f"#define {name} {member.findtext('initializer') or ''}",
        "variable": written + (member.findtext("argsstring") or ""),
        "enum": f"enum {name}",
    }[kind]
    parts = [
        Entry(value.findtext("name"), "value", value.findtext("initializer") or "", _text(value), 0)
        for value in member.iter("enumvalue")
    ]
    return Entry(name, kind, declared, _text(member), _line(member), parts)


def _struct(struct: ElementTree.Element) -> Entry:
    name = struct.findtext("compoundname")
    members = [_entry(member) for member in struct.iter("memberdef")]
    return Entry(name, "struct", f"struct {name}", _text(struct), _line(struct), members)


def _line(element: ElementTree.Element) -> int:
    return int(element.find("location").get("line"))


# ---- Doxygen's text as Markdown


def _text(element: ElementTree.Element) -> str:
    texts = (element.find(name) for name in ("briefdescription", "detaileddescription"))
    paragraphs = [para for text in texts for para in text.iter("para")]
    joined = "\n\n".join(_inline(paragraph).strip() for paragraph in paragraphs)
    return re.sub(r"(?<=\n) (?=\S)", "", joined).strip()


def _inline(element: ElementTree.Element) -> str:
    words = _plain(element.text)
    for child in element:
        inner = _inline(child)
        words += {
            "verbatim": f"\n\n```text\n{textwrap.dedent(child.text).strip()}\n```\n\n",
            "ref": f"`{''.join(child.itertext())}`",
            "computeroutput": f"`{''.join(child.itertext())}`",
            "ndash": "\N{EN DASH}",
            "orderedlist": inner,
            "itemizedlist": inner,
            "listitem": f"\n- {inner}",
            "para": inner,
        }[child.tag]
        words += _plain(child.tail)
    return words


def _plain(text: str | None) -> str:
    return (text or "").replace("*", "\\*").replace("<", "&lt;")


# ---- pages


def page(library: str) -> str:
    """Each header in its order: functions as declared, structs and enums as tables."""
    title = {"core": "The core", "joints": "The joints", "wire": "The wire"}[library]
    parts = [f"# {title}\n\nFrom the headers of `firmware/{library}/include/saddlewalk`.\n"]
    for header in headers(library):
        parts.append(f"## {header.name}\n\n{header.text}\n")
        parts += [_section(entry) for entry in header.entries]
    return "\n".join(parts)


def _section(entry: Entry) -> str:
    if entry.kind == "function" and not entry.text:
        sys.exit(f"saddlewalk: site: {entry.name}() has no comment in its header")
    if not entry.parts:
        return f"### {entry.name}\n\n```c\n{entry.declared}\n```\n\n{entry.text}\n"
    if entry.kind == "enum":
        rows = [f"| `{p.name}` | `{p.declared}` | {_cell(p.text)} |" for p in entry.parts]
        head = "| name | value | meaning |"
    else:
        rows = [_row(members) for members in _lines(entry.parts)]
        head = "| member | type | meaning |"
    table = "\n".join([head, "| --- | --- | --- |", *rows])
    return f"### {entry.name}\n\n{entry.text}\n\n{table}\n"


def _lines(members: list[Entry]) -> list[list[Entry]]:
    """Members that are declared in one line share its comment."""
    lines: dict[int, list[Entry]] = {}
    for member in members:
        lines.setdefault(member.line, []).append(member)
    return list(lines.values())


def _row(members: list[Entry]) -> str:
    names = ", ".join(f"`{member.name}`" for member in members)
    return f"| {names} | `{members[-1].declared}` | {_cell(members[-1].text)} |"


def _cell(text: str) -> str:
    return " ".join(text.replace("|", "&#124;").split())
