"""The sources' layout, types and static checks, with the tools that requirements.lock pins."""

import subprocess
import sys
from pathlib import Path

from saddlewalk import paths

TOOLS = Path(sys.executable).parent


def check(*command: str) -> None:
    done = subprocess.run(command, cwd=paths.CHECKOUT, capture_output=True, text=True)
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]


def test_python_types_are_complete_and_consistent():
    check(str(TOOLS / "mypy"))


def test_the_package_is_marked_as_typed():
    assert (paths.CHECKOUT / "host_tools/saddlewalk/py.typed").exists()
