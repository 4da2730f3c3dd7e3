"""A library's compile flags took effect: same bits everywhere, and each layer sees only its own.

usage: check_flags.py COMPILE_COMMANDS_JSON SOURCE_FOLDER ONE_FILE
"""

import json
import shlex
import sys
from pathlib import Path

REQUIRED = {"-std=c99", "-ffp-contract=off", "-fno-math-errno", "-Wdouble-promotion", "-Werror"}
TARGETS = ["saddle_layer_", "saddle_one_file", "saddlewalk_joints.dir"]
FORBIDDEN = {"-ffast-math", "-Ofast", "-funsafe-math-optimizations", "-fassociative-math"}


def complaints(flags: set[str]) -> list[str]:
    folders = {flag for flag in flags if flag.startswith("-I") and "/layers/" not in flag}
    lacks = [f"lacks {flag}" for flag in sorted(REQUIRED - flags)]
    return lacks + [f"has {flag}" for flag in sorted(FORBIDDEN & flags | folders)]


def main() -> None:
    commands = {
        Path(entry["file"]).resolve(): set(shlex.split(entry["command"]))
        for entry in json.loads(Path(sys.argv[1]).read_text())
        # tests compile the sources in ways of their own
        if any(target in entry["command"] for target in TARGETS)
    }
    sources = sorted(Path(sys.argv[2]).resolve().rglob("*.c"))
    if not sources:
        sys.exit(f"{sys.argv[2]} has no sources")
    found = [f"{file.name} {what}" for file in sources for what in complaints(commands[file])]
    one_file = commands[Path(sys.argv[3]).resolve()]
    found += [f"the one file lacks {flag}" for flag in sorted(REQUIRED - one_file)]
    found += [f"the one file has {flag}" for flag in sorted(FORBIDDEN & one_file)]
    sys.exit("\n".join(found) or None)


if __name__ == "__main__":
    main()
