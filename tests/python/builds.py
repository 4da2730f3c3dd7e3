"""The library built by other means than its own build."""

import json
import os
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest

from saddlewalk import paths
from sanitizer import WITHOUT

CONSUMERS = paths.CHECKOUT / "tests/consumers"
PROGRAM = paths.CHECKOUT / "examples/minimal.c"


@cache
def cached(name: str) -> str:
    """What the build under test was configured with."""
    text = (paths.build_dir() / "CMakeCache.txt").read_text()
    return re.search(rf"^{name}:\w+=(.*)$", text, re.MULTILINE)[1]


def run(*command: str | Path, check: bool = True, **options) -> subprocess.CompletedProcess:
    """Without the sanitizer's runtime: if it was loaded for the tests, it is not for compilers."""
    result = subprocess.run(command, env=WITHOUT, capture_output=True, text=True, **options)
    if check and result.returncode != 0:
        pytest.fail(f"{command}\n{result.stdout}{result.stderr}")
    return result


def compile_c(target: Path, *arguments: str | Path, check: bool = True):
    return run(cached("CMAKE_C_COMPILER"), *arguments, "-o", target, "-lm", check=check)


@cache
def cpp() -> list[str]:
    """A compiler of C++, which needs no library of C++."""
    for compiler in (cached("CMAKE_C_COMPILER"), "gcc", "clang"):
        command = [compiler, "-x", "c++", "-std=c++11", "-fno-exceptions", "-Wall", "-Werror"]
        if shutil.which(compiler) and not run(*command, "-E", os.devnull, check=False).returncode:
            return command
    pytest.skip("no compiler of C++: apt-get install clang")


def arduino_sketch(library: Path, folder: Path) -> list[str]:
    """What the library's example prints. As Arduino builds it: src is on the include path, all
    below it is compiled, and a sketch is C++.
    """
    include = [f"-I{library / 'src'}", f"-I{CONSUMERS / 'arduino'}"]
    sketch, compiled = library / "examples/Stand/Stand.ino", folder / "sketch.o"
    run(*cpp(), *include, "-include", "Arduino.h", "-c", sketch, "-o", compiled)
    sources = (library / "src").rglob("*.c")
    compile_c(folder / "sketch", *include, "-ffp-contract=off", compiled, *sources)
    return run(folder / "sketch").stdout.splitlines()


def platformio_walk(library: Path, folder: Path) -> str:
    """What the README's program prints with a library that is built by its library.json."""
    build = json.loads((library / "library.json").read_text())["build"]
    flags = [flag.replace("-I", f"-I{library}/") for flag in build["flags"]]
    sources = sorted((library / build["srcDir"]).rglob("*.c"))
    include = f"-I{library / build['includeDir']}"
    compile_c(folder / "walk", *flags, include, PROGRAM, *sources)
    return run(folder / "walk").stdout
