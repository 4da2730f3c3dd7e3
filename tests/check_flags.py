"""Every file of the core was compiled with the flags that make it give the same bits everywhere.

usage: check_flags.py COMPILE_COMMANDS_JSON CORE_SOURCE_FOLDER
"""

import json
import shlex
import sys
from pathlib import Path

REQUIRED = {"-std=c99", "-ffp-contract=off", "-fno-math-errno", "-Wdouble-promotion", "-Werror"}
FORBIDDEN = {"-ffast-math", "-Ofast", "-funsafe-math-optimizations", "-fassociative-math"}


def main() -> None:
    commands = {
        Path(entry["file"]).resolve(): set(shlex.split(entry["command"]))
        for entry in json.loads(Path(sys.argv[1]).read_text())
    }
    sources = sorted(Path(sys.argv[2]).resolve().glob("*.c"))
    complaints = [f"{folder} has no sources" for folder in sys.argv[2:] if not sources]
    for source in sources:
        flags = commands.get(source)
        if flags is None:
            complaints.append(f"{source.name} is not compiled")
            continue
        complaints += [f"{source.name} lacks {flag}" for flag in sorted(REQUIRED - flags)]
        complaints += [f"{source.name} has {flag}" for flag in sorted(FORBIDDEN & flags)]
    print("\n".join(complaints))
    sys.exit(bool(complaints))


if __name__ == "__main__":
    main()
