"""`saddlewalk spy`: our types in Java, and lcm-spy with them where there is a display to open."""

import os
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest

from host_node import own_lcm
from saddlewalk import paths
from saddlewalk.cli import main

TYPES = {path.stem for path in (paths.CHECKOUT / "lcm_types").glob("*.lcm")}
SPY = [str(Path(sys.executable).with_name("saddlewalk")), "spy"]
WAIT_S = 30.0


@pytest.fixture(scope="module")
def build(tmp_path_factory) -> Path:
    """A build folder of its own with all our types as a jar."""
    if not shutil.which("javac"):
        pytest.skip("no Java development kit: apt-get install default-jdk")
    folder = tmp_path_factory.mktemp("build")
    command = [*SPY, "--jar"]
    environment = os.environ | {"SADDLEWALK_BUILD": str(folder)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{folder}/lcm/java/saddlewalk.jar\n"
    return folder


def test_every_type_is_in_the_jar(build):
    with zipfile.ZipFile(build / "lcm/java/saddlewalk.jar") as jar:
        names = {Path(name) for name in jar.namelist()}
    assert {name.stem for name in names if name.suffix == ".class"} == TYPES
    assert {name.parent.name for name in names if name.suffix == ".class"} == {"saddlewalk"}
    assert [path.name for path in (build / "lcm/java").iterdir()] == ["saddlewalk.jar"]


def test_the_jar_is_made_again_only_when_a_type_is_newer(build, monkeypatch, capsys):
    jar = build / "lcm/java/saddlewalk.jar"
    monkeypatch.setenv("SADDLEWALK_BUILD", str(build))
    monkeypatch.setenv("PATH", "")  # nothing to make it with
    assert main(["spy", "--jar"]) == 0
    os.utime(jar, (1, 1))
    assert main(["spy", "--jar"]) == 2
    assert "needs Java" in capsys.readouterr().err
    os.utime(jar)


def test_missing_java_is_a_one_line_error(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("SADDLEWALK_BUILD", str(tmp_path))
    monkeypatch.setenv("PATH", "")
    assert main(["spy"]) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1
    assert "needs Java, and java is missing: as root, apt-get install -y default-jdk" in printed
    assert not list(tmp_path.iterdir())


def test_a_missing_display_is_a_one_line_error(build, monkeypatch, capsys):
    monkeypatch.setenv("SADDLEWALK_BUILD", str(build))
    monkeypatch.delenv("DISPLAY", raising=False)
    assert main(["spy"]) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and "saddlewalk monitor" in printed


def test_lcm_spy_finds_every_type(build, tmp_path):
    if not shutil.which("xvfb-run"):
        pytest.skip("no xvfb-run: apt-get install xvfb xauth")
    output = tmp_path / "output"
    environment = os.environ | {"SADDLEWALK_BUILD": str(build)}
    command = ["xvfb-run", "--auto-servernum", *SPY, "--lcm", own_lcm()]
    with output.open("w") as file:
        process = subprocess.Popen(
            command, env=environment, stdout=file, stderr=file, start_new_session=True
        )
    try:
        deadline_s = time.monotonic() + WAIT_S
        while "LCM types" not in output.read_text() and time.monotonic() < deadline_s:
            time.sleep(0.1)
        assert f"Found {len(TYPES)} LCM types" in output.read_text()
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        process.wait(WAIT_S)
