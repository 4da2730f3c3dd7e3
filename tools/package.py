#!/usr/bin/env python3
"""The library as PlatformIO and Arduino take it, with the version of version.h.

usage: tools/package.py platformio       put the version into library.json
       tools/package.py arduino FOLDER   write the Arduino library to a new FOLDER
"""

import re
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from amalgamate import amalgamation

CHECKOUT = Path(__file__).resolve().parents[1]
CORE = CHECKOUT / "firmware/core"
PORT = CHECKOUT / "firmware/port_arduino"


def version() -> str:
    header = CORE / "include/saddlewalk/version.h"
    return re.search(r'SADDLE_VERSION "([0-9.]+)"', header.read_text())[1]


def platformio(manifest: Path = CHECKOUT / "library.json") -> None:
    text = manifest.read_text()
    manifest.write_text(re.sub(r'(?<="version": ")[^"]*', version(), text))


def arduino(folder: Path) -> None:
    """Everything that Arduino compiles and includes lies in src; it knows no include folder."""
    shutil.copytree(PORT, folder, ignore=shutil.ignore_patterns("*.in"))
    shutil.copytree(CORE / "include/saddlewalk", folder / "src/saddlewalk")
    (folder / "src/saddlewalk.c").write_text(amalgamation())
    shutil.copy(CHECKOUT / "LICENSE", folder)
    properties = (PORT / "library.properties.in").read_text().replace("@version@", version())
    (folder / "library.properties").write_text(properties)


def main(arguments: list[str]) -> None:
    match arguments:
        case ["platformio"]:
            platformio()
        case ["arduino", folder] if not Path(folder).exists():
            arduino(Path(folder))
        case ["arduino", folder]:
            sys.exit(f"{folder} exists already: name a new folder")
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
