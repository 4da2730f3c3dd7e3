"""Put the three headers of FMI 2.0 into a folder, checked byte for byte.

usage: fetch_fmi.py OUT_DIR

They come from the package fmpy on PyPI; their licence, in each of them, is BSD's with two clauses.
"""

import sys
from pathlib import Path

from pinned_files import write_from_wheel

PACKAGE = "fmpy==0.3.32"
FOLDER = "fmpy/c-code"
SHA256 = {
    "fmi2FunctionTypes.h": "756da446057a5a6dec47a5938e099ba3a9b1882326672b393c6f7dd8571e3456",
    "fmi2Functions.h": "9df3cb9d50d810ef993e1fc2925d19b5886e08809b31ac10de361ceeba62ad1a",
    "fmi2TypesPlatform.h": "50a180641623f47f2e48fc445707549ce4ec2e27358e2451a2dad5b6dfc55287",
}


if __name__ == "__main__":
    write_from_wheel(Path(sys.argv[1]), PACKAGE, FOLDER, SHA256)
