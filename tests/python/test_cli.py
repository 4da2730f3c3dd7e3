"""The command's standard streams and output files: full, closed, devices, links."""

import subprocess
import sys
from pathlib import Path

import pytest

from saddlewalk import paths
from saddlewalk.cli import main
from saddlewalk.errors import UserError

SADDLEWALK = Path(sys.executable).with_name("saddlewalk")
PLAN = ["plan", "--speed", "1.2", "--strides", "300"]


def shell(line: str) -> subprocess.CompletedProcess:
    words = ["bash", "-c", line, str(SADDLEWALK), *PLAN]
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)


def test_a_closed_pipe_is_not_reported_as_an_error():
    done = shell('"$0" "$@" | head -1')
    assert (done.stdout.count("\n"), done.stderr) == (1, "")


@pytest.mark.parametrize(
    ("redirection", "named"),
    [
        (">/dev/full", "No space left"),
        ("--out /dev/full", "No space left"),
        (">&-", "standard output is closed"),
    ],
)
def test_output_that_cannot_be_written_is_a_one_line_error(redirection, named):
    done = shell(f'"$0" "$@" {redirection}')
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert named in done.stderr


def test_closed_standard_input_is_a_one_line_error():
    done = shell('"$0" supervise --in - <&-')
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "standard input is closed" in done.stderr


def test_a_pipe_given_as_output_is_written_to_and_stays(tmp_path):
    done = shell(f'mkfifo {tmp_path}/pipe; "$0" "$@" --out {tmp_path}/pipe & cat {tmp_path}/pipe')
    assert (done.stdout[:4], done.stderr) == ("t_s,", "")
    assert (tmp_path / "pipe").is_fifo()


def test_a_link_given_as_output_stays_a_link(tmp_path):
    link, target = tmp_path / "link.csv", tmp_path / "target.csv"
    link.symlink_to(target)
    assert main([*PLAN, "--out", str(link)]) == 0
    assert link.is_symlink() and target.read_text().startswith("t_s,")
    assert sorted(tmp_path.iterdir()) == [link, target]


def test_a_copy_without_its_checkout_reports_how_to_install(monkeypatch, tmp_path):
    monkeypatch.setattr(paths, "CHECKOUT", tmp_path)
    with pytest.raises(UserError, match="install the package by pip"):
        paths.built("lib/libsaddlewalk.so")
