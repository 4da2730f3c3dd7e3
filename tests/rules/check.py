"""Gate of `make rules`: MISRA C:2012 by cppcheck's addon, and the compiler's analysis of paths.

usage: check.py BUILD

MISRA's required rules hold in core, wire and joints; gcc's -fanalyzer reads all the firmware that
was compiled in BUILD, with its flags. What is not followed is in deviations.toml with its reason.
Exit status 1 if a finding is not listed there, or if something listed is found no more.
"""

import json
import re
import shlex
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
FIRMWARE = ROOT / "firmware"
DEVIATIONS = Path(__file__).with_name("deviations.toml")
PARTS = ("core", "wire", "joints")
WORKERS = 2
ADVISORY = set(
    """1.5 2.3 2.4 2.5 2.6 2.7 4.2 5.9 8.7 8.9 8.11 8.13 8.19 10.5 11.4 11.5 12.1 12.3 12.4 13.3
    13.4 15.1 15.4 15.5 17.5 17.8 17.11 18.4 18.5 19.2 20.1 20.5 20.10 21.12 23.1 23.3 23.5
    23.7""".split()
)


class Finding(NamedTuple):
    """rule: MISRA's number, or gcc's warning."""

    rule: str
    file: str
    line: int


def name_of(file: str) -> str:
    return str((ROOT / file).resolve().relative_to(ROOT))


def misra(part: str, build: Path) -> Iterable[Finding]:
    """The whole part at once: some rules are about all of its files."""
    folders = ["firmware/core/src", f"firmware/{part}/src", f"{build}/firmware/wire/signals"]
    folders += [f"firmware/{name}/include" for name in PARTS]
    version = re.search(r'^VERSION "(\d+)"', (FIRMWARE / "wire/saddlewalk.dbc").read_text(), re.M)
    command = ["cppcheck", "--std=c99", "--addon=misra", "--quiet", "--template={file}:{line}:{id}"]
    command += [*(f"-I{folder}" for folder in folders)]
    command += [f"-DSADDLE_WIRE_VERSION={version and version[1]}", f"firmware/{part}/src"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    if "misra-config" in done.stderr or "ddon" in done.stderr + done.stdout:
        sys.exit(f"cppcheck's addon failed:\n{done.stdout}{done.stderr}")
    for file, line, rule in re.findall(r"^(.+):(\d+):misra-c2012-([\d.]+)$", done.stderr, re.M):
        yield Finding(rule, name_of(file), int(line))


def analysed(entry: dict[str, str]) -> Iterable[Finding]:
    """A file, as the build compiles it."""
    words = shlex.split(entry["command"])
    words[words.index("-o") + 1] = "/dev/null"
    flags = ["-fanalyzer", "-Wno-error", "-fdiagnostics-path-format=none"]
    done = subprocess.run(
        [*words, *flags], cwd=entry["directory"], capture_output=True, text=True, check=True
    )
    for file, line, rule in re.findall(
        r"^(.+?):(\d+):\d+: warning: .*\[(-W[\w-]+)\]$", done.stderr, re.M
    ):
        yield Finding(rule, name_of(file), int(line))


def sources_of(build: Path) -> list[dict[str, str]]:
    entries = json.loads((ROOT / build / "compile_commands.json").read_text(encoding="utf-8"))
    compiled = (e for e in entries if Path(e["directory"], e["output"]).exists())
    ours = {e["file"]: e for e in compiled if Path(e["file"]).is_relative_to(FIRMWARE)}
    return list(ours.values())


def main() -> None:
    build = Path(sys.argv[1])
    sources = sources_of(build)
    with ThreadPoolExecutor(max_workers=WORKERS) as pool:
        answers = list(pool.map(lambda part: list(misra(part, build)), PARTS))
        answers += pool.map(lambda entry: list(analysed(entry)), sources)
    found = {finding for answer in answers for finding in answer}
    listed = tomllib.loads(DEVIATIONS.read_text(encoding="utf-8"))["deviation"]
    allowed = {(d["rule"], file) for d in listed for file in d["files"]}
    binding = sorted(f for f in found if f.rule not in ADVISORY)
    opened = [f for f in binding if (f.rule, f.file) not in allowed]
    stale = allowed - {(f.rule, f.file) for f in binding}
    for rule, file, line in opened:
        print(f"{file}:{line}: {rule}")
    for rule, file in sorted(stale):
        print(f"{DEVIATIONS.name}: {rule}: nothing found any more in {file}")
    advisory = Counter(f.rule for f in found if f.rule in ADVISORY)
    print(
        f"rules: {len(opened)} open; {len(binding) - len(opened)} by {len(listed)} deviations; "
        f"{advisory.total()} of advisory rules; {len(sources)} files through -fanalyzer"
    )
    sys.exit(bool(opened or stale))


if __name__ == "__main__":
    main()
