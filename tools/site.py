#!/usr/bin/env python3
"""The documentation as a site: the pages of docs, and a reference from what the code says.

usage: tools/site.py OUT_FOLDER

Needs `make build`, the extra `site` and doxygen. A link that leads nowhere is an error.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from c_headers import LIBRARIES, entries
from site_reference import WRITTEN

from saddlewalk.formulas import drawn

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"(!?)\[([^\]]+)\]\(([^)#\s]+)(#[^)]*)?\)")
FRONT = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
}
WITH_FORMULAS = ("equations.md", "joints.md", "glossary.md")


def main() -> None:
    out = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        pages = Path(folder) / "docs"
        shutil.copytree(ROOT / "docs", pages)
        for name, page in FRONT.items():
            (pages / page).write_text((ROOT / name).read_text().replace("](docs/", "]("))
        for name, written in WRITTEN.items():
            (pages / f"{name}.md").write_text(written())
        targets = _targets(pages)
        for page in pages.glob("*.md"):
            text = LINK.sub(lambda link: _link(link, pages), page.read_text())
            text = _with_links(text, targets)
            page.write_text(drawn(text) if page.name in WITH_FORMULAS else text)
        playground = ROOT / "build/playground.html"
        if playground.exists():
            shutil.copy(playground, pages)
            with (pages / "index.md").open("a") as index:
                index.write("\n[Open the playground](playground.html)\n")
        shutil.copy(ROOT / "tools/site.css", pages)
        settings = Path(folder) / "mkdocs.yml"
        settings.write_text((ROOT / "tools/mkdocs.yml").read_text())
        mkdocs = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet"]
        read = {"HOST_TOOLS": str(ROOT / "host_tools")}
        quiet = {"NO_MKDOCS_2_WARNING": "1", "DISABLE_MKDOCS_2_WARNING": "true"}
        environment = os.environ | read | quiet
        subprocess.run([*mkdocs, "-f", settings, "-d", out], check=True, env=environment)
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


# An equation's row; what stays as it is; an equation's tag; a name of the C interface.
ROW = re.compile(r"^\| \[([EJ]\d+)\] \|", re.MULTILINE)
STAYS = r"^```.*?^```$|^#[^\n]*|\[[^\]\n]*\]\([^)\n]*\)"
REFERS = re.compile(
    rf"{STAYS}|`(?P<code>saddle_\w+)(?:\(\))?`|`[^`\n]*`|\[(?P<tag>[EJ]\d+)\]|\b(?P<name>saddle_\w+)(?:\(\))?",
    re.MULTILINE | re.DOTALL,
)


def _targets(pages: Path) -> dict[str, str]:
    """Where each equation and each name of the C interface is explained."""
    found = {
        tag: f"{page}#{tag.lower()}"
        for page in ("equations.md", "joints.md")
        for tag in ROW.findall((pages / page).read_text())
    }
    for library in LIBRARIES:
        found |= {name: f"reference-c-{library}.md#{name.lower()}" for name in entries(library)}
    return found


def _with_links(text: str, targets: dict[str, str]) -> str:
    def linked(found: re.Match[str]) -> str:
        target = targets.get(found["code"] or found["tag"] or found["name"] or "")
        if target is None:
            return found[0]
        return f"[{found['tag'] or found[0]}]({target})"

    text = ROW.sub(lambda row: f'| <a id="{row[1].lower()}"></a>{row[1]} |', text)
    return REFERS.sub(linked, text)


if __name__ == "__main__":
    main()
