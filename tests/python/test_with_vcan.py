"""tools/vcan/with-vcan: commands that run in it, and its messages where it is not available."""

import shutil
import subprocess
import sys

import pytest

from saddlewalk.paths import CHECKOUT

WITH_VCAN = str(CHECKOUT / "tools/vcan/with-vcan")


def with_vcan(*arguments: object, **options) -> subprocess.CompletedProcess:
    command = [WITH_VCAN, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def test_missing_requirements_are_a_one_line_error(tmp_path):
    for program in ("bash", "dirname", "mkdir"):
        (tmp_path / program).symlink_to(shutil.which(program))
    done = with_vcan(tmp_path / "out", "true", env={"PATH": str(tmp_path)})
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "missing: " in done.stderr and "candump" in done.stderr
    assert "apt-get install -y --no-install-recommends" in done.stderr
    assert "can-utils" in done.stderr


def test_too_few_arguments_are_a_one_line_error(tmp_path):
    done = with_vcan(tmp_path)
    assert (done.returncode, done.stderr) == (2, "with-vcan: usage: with-vcan OUT COMMAND...\n")


@pytest.mark.socketcan
def test_a_kernel_that_has_vcan_serves_itself(tmp_path):
    """Where this runs there is one, if only in the guest: no second guest is booted."""
    script = "echo printed; echo complained >&2; echo written >$0/file; ip -br link; exit 7"
    done = with_vcan(tmp_path, "sh", "-c", script, tmp_path)
    assert done.returncode == 7
    assert done.stdout.startswith("with-vcan: vcan of this machine's kernel, ")
    assert "printed\n" in done.stdout and "vcan1 " in done.stdout
    assert done.stderr == "complained\n"
    assert (tmp_path / "file").read_text() == "written\n"
    assert not (tmp_path / "guest").exists()


@pytest.mark.socketcan
def test_the_bus_tests_run_there_too(tmp_path):
    tests = ["tests/python/test_bus.py", "-m", "socketcan", "-k", "the_firmware and not bits"]
    pytest_here = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q"]
    done = with_vcan(tmp_path, *pytest_here, *tests, cwd=CHECKOUT)
    assert done.returncode == 0, done.stdout
    assert "4 passed" in done.stdout and "skipped" not in done.stdout
