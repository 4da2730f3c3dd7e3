"""Put Unity 2.7.0 (unity.c and its two headers) into a folder, checked byte for byte.

usage: fetch_unity.py OUT_DIR [UNITY_SRC_DIR]

Without UNITY_SRC_DIR the files come from the source package of pytest-unity on PyPI.
"""

import hashlib
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

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
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet", "download"]
    name = PACKAGE.partition("==")[0]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([*pip, "--no-deps", "--no-binary", name, "-d", folder, PACKAGE], check=True)
        (archive,) = Path(folder).glob("*.tar.gz")
        with tarfile.open(archive) as tar:
            root = tar.getnames()[0].split("/")[0]
            return {name: tar.extractfile(f"{root}/{FOLDER}/{name}").read() for name in SHA256}


def main() -> None:
    out, *source = map(Path, sys.argv[1:])
    files = from_folder(source[0]) if source else from_pypi()
    for name, content in files.items():
        found = hashlib.sha256(content).hexdigest()
        if found != SHA256[name]:
            sys.exit(f"{name} is not Unity 2.7.0's: sha256 {found}, expected {SHA256[name]}")
    out.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (out / name).write_bytes(content)


if __name__ == "__main__":
    main()
