"""The sources' layout, types and static checks, with the tools that requirements.lock pins."""

import subprocess
import sys
from pathlib import Path

import pytest

from saddlewalk import paths

TOOLS = Path(sys.executable).parent


def sources(*patterns: str) -> list[str]:
    """Tracked files of the checkout."""
    command = ["git", "-C", paths.CHECKOUT, "ls-files", *patterns]
    listed = subprocess.run(command, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("no git checkout")
    return listed.stdout.split()


def check(*command: str) -> None:
    done = subprocess.run(command, cwd=paths.CHECKOUT, capture_output=True, text=True)
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]


def test_python_types_are_complete_and_consistent():
    check(str(TOOLS / "mypy"))


def test_c_sources_are_laid_out_as_clang_format_has_it():
    files = sources("*.c", "*.h")
    assert len(files) > 150
    check(str(TOOLS / "clang-format"), "--dry-run", "--Werror", *files)


def test_the_package_is_marked_as_typed():
    assert (paths.CHECKOUT / "host_tools/saddlewalk/py.typed").exists()
