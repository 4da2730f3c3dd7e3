"""Put the kernel of FreeRTOS 11.2 for a Cortex-M4F into a folder.

usage: fetch_freertos.py OUT_DIR

It comes from freertos-next on crates.io, whose checksum cargo verifies; both are under MIT.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PACKAGE = "freertos-next"
VERSION = "0.12.0"
SHA256 = "b7824fb42660c16e1b3b573eef99c2fe5c5cba6294a631c309084635f6bfcbb0"
PARTS = ("tasks.c", "queue.c", "list.c", "include", "portable/GCC/ARM_CM4F", "LICENSE.md")
MANIFEST = f"""[package]
name = "fetch"
version = "0.0.0"
[dependencies]
{PACKAGE} = "={VERSION}"
"""


def main() -> None:
    out = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "src").mkdir()
        (folder / "src/lib.rs").touch()
        (folder / "Cargo.toml").write_text(MANIFEST)
        vendor = ["cargo", "vendor", "--quiet", "vendor"]
        subprocess.run(vendor, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        package = folder / "vendor" / PACKAGE
        found = json.loads((package / ".cargo-checksum.json").read_text())["package"]
        if found != SHA256:
            sys.exit(f"{PACKAGE} {VERSION}: sha256 {found}, expected {SHA256}")
        for part in PARTS:
            source, copy = package / "FreeRTOS-Kernel" / part, out / part
            copy.parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, copy, dirs_exist_ok=True)
            else:
                shutil.copy(source, copy)


if __name__ == "__main__":
    main()
