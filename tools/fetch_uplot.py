"""Put uPlot, the charts of the live page, into a folder, checked byte for byte.

usage: fetch_uplot.py OUT_DIR

uPlot 1.6 (MIT licence, Leon Sorokin) comes from the wheel of uplot-python on PyPI, of which nothing
else is used.
"""

import sys
from pathlib import Path

from pinned_files import write_from_wheel

PACKAGE = "uplot-python==1.1.1"
FOLDER = "uplot/static"
SHA256 = {
    "uPlot.iife.js": "655bc8aa33781e8721c5af6b59f1699c03c9bda951aa74a6ab518ac20cc4326d",
    "uPlot.min.css": "3f121cd4a997b634e07a887658850018e475c26f0bddd874109a8d382c19de87",
}


if __name__ == "__main__":
    write_from_wheel(Path(sys.argv[1]), PACKAGE, FOLDER, SHA256)
