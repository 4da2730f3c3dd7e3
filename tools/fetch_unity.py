"""Put Unity 2.7.0 (unity.c and its two headers) into a folder, checked byte for byte.

usage: fetch_unity.py OUT_DIR [UNITY_SRC_DIR]

Without UNITY_SRC_DIR the files come from the source package of pytest-unity on PyPI.
"""

import sys
import tarfile
from pathlib import Path

from pinned_files import downloaded, write_checked

PACKAGE = "pytest-unity==0.1.0"
FOLDER = "vendor/unity/src"
SHA256 = {
    "unity.c": "a6cc4b143075a03317d72c760b5ed67a4a12eeda1242f575464ad23f34042275",
    "unity.h": "b30ba4db1e0be1a1f6c862d359d73c91025a114977e41d3dad17103363804334",
    "unity_internals.h": "35bffad23ebc533977291e7a848c646027513572268fbfa9bd03d5ec21ee818a",
}


def from_folder(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in SHA256}


def from_pypi() -> dict[str, bytes]:
    package = PACKAGE.partition("==")[0]
    with downloaded(PACKAGE, "--no-binary", package) as archive, tarfile.open(archive) as tar:
        root = tar.getnames()[0].split("/")[0]
        return {name: tar.extractfile(f"{root}/{FOLDER}/{name}").read() for name in SHA256}


def main() -> None:
    out, *source = map(Path, sys.argv[1:])
    write_checked(out, from_folder(source[0]) if source else from_pypi(), SHA256)


if __name__ == "__main__":
    main()
