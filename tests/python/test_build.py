"""Products and messages of the build: declarations for cffi, errors of the set-up, the summary."""

import graphlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import cffi
import pytest

from saddlewalk import paths
from saddlewalk.errors import UserError

TESTS = Path(__file__).parents[1]
BOOTSTRAP = paths.CHECKOUT / "tools" / "bootstrap.sh"

PASSED = '<testcase name="a"/>'
FAILED = '<testcase name="b"><failure/></testcase>'
SKIPPED = '<testcase name="c"><skipped/></testcase>'


def test_every_declared_function_is_in_the_library():
    ffi = cffi.FFI()
    ffi.cdef(paths.built("saddlewalk_cdef.h").read_text())
    library = ffi.dlopen(str(paths.built("lib/libsaddlewalk.so")))
    assert {"saddle_init", "saddle_tick", "saddle_bos_polygon"} <= set(dir(library))
    for name in dir(library):
        getattr(library, name)


def test_a_missing_product_is_named_with_the_command_that_makes_it(monkeypatch, tmp_path):
    monkeypatch.setenv("SADDLEWALK_BUILD", str(tmp_path))
    with pytest.raises(UserError, match=r"bin/saddlewalk-host.*make build"):
        paths.built("bin/saddlewalk-host")


@pytest.mark.parametrize(
    ("now", "then", "message"),
    [
        ("SPEED : 16|16@1- (0.0001,0)", "SPEED : 16|16@1- (0.0001,1)", "has offset 1: must be 0"),
        ("SPEED : 16|16@1-", "SPEED : 16|12@1-", "is signed with 12 bits: must be 16"),
        ("SPEED : 16|16@1-", "SPEED : 23|16@0-", "must be a little-endian integer"),
        ("VERSION : 48|8@1+ (1,0)", "VERSION : 48|8@1+ (2,0)", "unsigned with scale 2: must be 1"),
        ("COUNTER : 8|4@1+", "COUNTER : 8|3@1+", "SENSED_GYRO must begin with CRC, 0|8, and COUN"),
        ('VAL_ 256 SPEED -32768 "NOT_AVAILABLE" ;', "", "signed without a word for -32768"),
        (
            "BO_ 308 SCORES_EXPECTED: 8",
            "BO_ 308 SCORES_EXPECTED: 7",
            "must be a classic frame of 8 b",
        ),
        (
            "SG_ ROLL : 32|16@1- (0.0001,0)",
            "SG_ ROLL : 32|16@1- (0.001,0)",
            "as those of SENSED_LEFT",
        ),
        ("BO_ 150 JOINT_RIGHT", "BO_ 150 OTHER", "identifiers of JOINT_xxx must be one after the"),
    ],
)
def test_a_dbc_that_the_wire_cannot_pack_fails_the_build(now, then, message, tmp_path):
    text = (paths.CHECKOUT / "firmware/wire/saddlewalk.dbc").read_text()
    changed = tmp_path / "changed.dbc"
    changed.write_text(text.replace(now, then, 1))
    generator = paths.CHECKOUT / "tools/wire_signals.py"
    command = [sys.executable, generator, changed, tmp_path / "wire_signals.h"]
    result = subprocess.run(command, capture_output=True, text=True)
    assert text.count(now) and result.returncode == 1
    assert message in result.stderr and "Traceback" not in result.stderr
    assert not (tmp_path / "wire_signals.h").exists()


def test_make_build_builds_everything_that_pytest_loads():
    """A product of the target `tests` alone would be out of date after `make build`."""
    ninja = Path(sys.executable).with_name("ninja")
    command = [ninja, "-C", paths.build_dir(), "-t", "inputs", "all"]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    made = {Path(line).name for line in result.stdout.splitlines()}
    loaded = set()
    for test in (TESTS / "python").glob("*.py"):
        loaded |= set(re.findall(r'paths\.built\(\s*f?"(?:lib/|bin/)?([\w.-]+)"', test.read_text()))
    assert {"libsaddlewalk_wire_shared.so", "saddlewalk_wire_cdef.h"} <= loaded
    assert loaded <= made


def test_firmware_files_have_no_circular_dependency():
    """A .c and its .h are one module; headers of the same name count as one."""
    needs: dict[str, set[str]] = {}
    for file in (paths.CHECKOUT / "firmware").rglob("*.[ch]"):
        included = re.findall(r'#include ["<](?:saddlewalk/)?(\w+)\.h[">]', file.read_text())
        needs.setdefault(file.stem, set()).update({*included} - {file.stem})
    assert needs["bus"] and needs["saddlewalk"] and len(needs) > 50
    graphlib.TopologicalSorter(needs).prepare()


def bootstrap(python: str, venv: Path, **environment: str) -> subprocess.CompletedProcess:
    command = [BOOTSTRAP, python, venv]
    return subprocess.run(command, env=os.environ | environment, capture_output=True, text=True)


def test_missing_system_packages_are_named_in_one_line(tmp_path):
    result = bootstrap(sys.executable, tmp_path / "venv", CC="no-such-compiler")
    assert result.returncode == 1
    assert result.stderr.count("\n") == 1
    assert "a C compiler" in result.stderr
    assert "apt-get install -y gcc libc6-dev" in result.stderr
    assert not (tmp_path / "venv").exists()


def test_a_missing_python_is_named(tmp_path):
    result = bootstrap("no-such-python", tmp_path / "venv")
    assert (result.returncode, result.stderr.count("\n")) == (1, 1)
    assert "no-such-python" in result.stderr


@pytest.fixture
def bare(tmp_path) -> Path:
    """A folder of programs: a python without glib until apt-get has installed it, and `id`."""
    programs = {
        "python": f'case "$*" in *libglib*) test -e {tmp_path}/glib ;; esac',
        "apt-get": f'echo "$*" >>{tmp_path}/installed; touch {tmp_path}/glib',
        "id": "echo 0",
    }
    folder = tmp_path / "bin"
    folder.mkdir()
    for name, script in programs.items():
        (folder / name).write_text(f"#!/bin/sh\n{script}\n")
        (folder / name).chmod(0o755)
    return folder


def test_root_gets_glib_installed_with_a_one_line_notice(bare, tmp_path):
    result = bootstrap("python", tmp_path / "venv", PATH=f"{bare}:{os.environ['PATH']}")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.count("\n") == 1 and "installing libglib2.0-0" in result.stdout
    assert (tmp_path / "installed").read_text() == "install -qq -y libglib2.0-0\n"


def test_other_users_are_asked_for_glib_in_one_line(bare, tmp_path):
    (bare / "id").write_text("#!/bin/sh\necho 1000\n")
    result = bootstrap("python", tmp_path / "venv", PATH=f"{bare}:{os.environ['PATH']}")
    assert (result.returncode, result.stdout, result.stderr.count("\n")) == (1, "", 1)
    assert "libglib-2.0 (for LCM); as root: apt-get install -y libglib2.0-0" in result.stderr
    assert not (tmp_path / "installed").exists()


def test_a_missing_cross_compiler_is_named_before_configuring(tmp_path):
    make = [shutil.which("make"), "-C", paths.CHECKOUT, "controller"]
    environment = {"PATH": str(tmp_path), "HOME": str(tmp_path)}
    result = subprocess.run(make, env=environment, capture_output=True, text=True)
    printed = [line for line in result.stderr.splitlines() if not line.startswith("make")]
    assert result.returncode == 2 and len(printed) == 1
    assert "apt-get install -y gcc-arm-none-eabi picolibc-arm-none-eabi" in printed[0]


def summary(*reports: Path, **environment: str) -> tuple[int, str]:
    command = [sys.executable, TESTS / "summary.py", *reports]
    result = subprocess.run(command, env=environment, capture_output=True, text=True)
    return result.returncode, result.stdout.splitlines()[-1]


@pytest.mark.parametrize(
    ("cases", "environment", "expected"),
    [
        (PASSED, {}, (0, "1 passed, 0 failed")),
        (PASSED + FAILED, {}, (1, "1 passed, 1 failed")),
        (PASSED + SKIPPED, {}, (0, "1 passed, 0 failed, 1 skipped")),
        (PASSED + SKIPPED, {"CI": "true"}, (1, "1 passed, 0 failed, 1 skipped")),
        ("", {}, (1, "0 passed, 1 failed")),
    ],
)
def test_the_summary_adds_up_and_fails_when_it_should(tmp_path, cases, environment, expected):
    report = tmp_path / "report.xml"
    report.write_text(f"<testsuite>{cases}</testsuite>")
    assert summary(report, **environment) == expected


def test_a_missing_test_report_is_a_failure(tmp_path):
    assert summary(tmp_path / "missing.xml") == (1, "0 passed, 1 failed")
