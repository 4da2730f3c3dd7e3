"""Put uPlot, the charts of the live page, into a folder, checked byte for byte.

usage: fetch_uplot.py OUT_DIR

uPlot 1.6 (MIT licence, Leon Sorokin) comes from the wheel of uplot-python on PyPI, of which nothing
else is used.
"""

import hashlib
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

PACKAGE = "uplot-python==1.1.1"
FOLDER = "uplot/static"
SHA256 = {
    "uPlot.iife.js": "655bc8aa33781e8721c5af6b59f1699c03c9bda951aa74a6ab518ac20cc4326d",
    "uPlot.min.css": "3f121cd4a997b634e07a887658850018e475c26f0bddd874109a8d382c19de87",
}


def main() -> None:
    out = Path(sys.argv[1])
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet", "download"]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([*pip, "--no-deps", "-d", folder, PACKAGE], check=True)
        (wheel,) = Path(folder).glob("*.whl")
        with zipfile.ZipFile(wheel) as archive:
            files = {name: archive.read(f"{FOLDER}/{name}") for name in SHA256}
    for name, content in files.items():
        found = hashlib.sha256(content).hexdigest()
        if found != SHA256[name]:
            sys.exit(f"{name} of {PACKAGE}: sha256 {found}, expected {SHA256[name]}")
    out.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (out / name).write_bytes(content)


if __name__ == "__main__":
    main()
