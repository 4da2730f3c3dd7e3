"""The LCM types in Java, for lcm-spy and LCM's other tools in that language."""

import shutil
import subprocess
import tempfile
from pathlib import Path

import lcm

from saddlewalk import paths
from saddlewalk.errors import UserError

_LCM = Path(lcm.__file__).parents[1]  # its wheel installs programs and jars relative to this folder


def lcm_program(name: str) -> Path:
    """A program of the lcm package, such as lcm-gen."""
    return _LCM / "bin" / name


def types_jar() -> Path:
    """The compiled types; made now if they are not there or older than `lcm_types`.

    Raises UserError if the Java development kit is missing.
    """
    jar = paths.build_dir().absolute() / "lcm" / "java" / "saddlewalk.jar"
    types = sorted(paths.source("lcm_types").glob("*.lcm"))
    newest_s = max(path.stat().st_mtime for path in types)
    if not jar.exists() or jar.stat().st_mtime < newest_s:
        _make(jar, types)
    return jar


def _make(jar: Path, types: list[Path]) -> None:
    missing = [tool for tool in ("java", "javac", "jar") if shutil.which(tool) is None]
    if missing:
        raise UserError(
            f"needs Java, and {missing[0]} is missing: as root, apt-get install -y default-jdk"
        )
    jar.parent.mkdir(parents=True, exist_ok=True)
    lcm_jar = _LCM / "share/java/lcm.jar"
    with tempfile.TemporaryDirectory(dir=jar.parent) as folder:
        work = Path(folder)
        _run(lcm_program("lcm-gen"), "--java", "--jpath", work, *types)
        _run("javac", "-nowarn", "-cp", lcm_jar, "-d", work / "classes", *work.rglob("*.java"))
        _run("jar", "cf", work / jar.name, "-C", work / "classes", ".")
        (work / jar.name).replace(jar)


def _run(*command: str | Path) -> None:
    done = subprocess.run(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if done.returncode != 0:
        words = done.stdout.strip().splitlines() or [f"status {done.returncode}"]
        raise UserError(f"{Path(command[0]).name}: {words[0]}")
