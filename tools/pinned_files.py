"""Files of a package on PyPI, checked byte for byte before they are used."""

import hashlib
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def downloaded(package: str, *options: str) -> Iterator[Path]:
    """The archive of a pinned package, without its dependencies, while the context lasts."""
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet", "download"]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([*pip, "--no-deps", *options, "-d", folder, package], check=True)
        (archive,) = Path(folder).iterdir()
        yield archive


def write_from_wheel(out: Path, package: str, folder: str, sha256: Mapping[str, str]) -> None:
    """Files of a folder of a pinned package's wheel, checked."""
    with downloaded(package) as archive, zipfile.ZipFile(archive) as wheel:
        files = {name: wheel.read(f"{folder}/{name}") for name in sha256}
    write_checked(out, files, sha256)


def write_checked(out: Path, files: Mapping[str, bytes], sha256: Mapping[str, str]) -> None:
    """Write files into a folder; end the program if one is not what it should be."""
    for name, content in files.items():
        found = hashlib.sha256(content).hexdigest()
        if found != sha256[name]:
            sys.exit(f"{name}: sha256 {found}, expected {sha256[name]}")
    out.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (out / name).write_bytes(content)
