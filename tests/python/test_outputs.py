"""Outputs of every command: never an input, checked to be writable, never partly written."""

import argparse
import importlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from host_node import own_lcm
from saddlewalk import atomic_write
from saddlewalk.cli import main, parser
from saddlewalk.transport.bus import private_udp
from synthetic_falls import write_folder
from synthetic_walk import Walk, csv_text

CHECKOUT = Path(__file__).parents[2]
SADDLEWALK = Path(sys.executable).with_name("saddlewalk")
OLD = b"what was there before\n"
NOBODY = 65534


@dataclass(frozen=True)
class Writer:
    """A command that writes. In `words`, {name} is the path of an input of that name."""

    words: str
    option: str
    out: str  # a name that its option takes
    holds: tuple[str, ...] = ()  # of a folder: files that the command writes there

    @property
    def command(self) -> str:
        return self.words.split()[0]

    def __str__(self) -> str:
        return f"{self.words}, {self.option}"


RUN = ("walk.csv", "walk.lcmlog", "walk.candump.log", "walk.png")
WRITERS = [
    Writer("plan --speed 1.2 --config {toml}", "--out", "plan.csv"),
    Writer("plan --schedule {schedule} --config {toml}", "--out", "plan.csv"),
    Writer("plan --schedule {schedule} --config {toml}", "--picture", "plan.svg"),
    Writer("supervise --in {states} --config {toml}", "--out", "scores.csv"),
    Writer("replay {walk}", "--out", "scores.csv"),
    Writer("replay {walk}", "--log", "walk.lcmlog"),
    Writer("follow {walk} {other} --config {toml}", "--out", "follow.csv"),
    Writer("follow {walk} {other} --config {toml}", "--json", "follow.json"),
    Writer("follow {walk} {other} --config {toml}", "--picture", "follow.png"),
    Writer("calibrate {walk} {other}", "--out", "person.toml"),
    Writer("calibrate {walk} {other}", "--header", "person.h"),
    Writer("bench --rounds 1", "--json", "bench.json"),
    Writer("evaluate --walks 1 --jobs 2 --gait {gait}", "--out", "found", ("evaluation.json",)),
    Writer(
        "endure --plant pendulum --speeds 1 --distance 1 --repeats 1 --jobs 1 --config {toml}",
        "--out",
        "found",
        ("endurance.json",),
    ),
    Writer("evaluate --falls {falls} --config {toml}", "--out", "found", ("scores.json",)),
    Writer("evaluate --falls {falls} --config {toml}", "--json", "scores.json"),
    Writer("reproduce --gait {gait}", "--out", "paper", ("paper.html", "steps.png")),
    Writer("report {log}", "--out", "page.html"),
    Writer("export {log} --format mcap", "--out", "log.mcap"),
    Writer("export {log} --format csv", "--out", "tables", ("plan.csv",)),
    Writer("export {log} --format parquet", "--out", "tables", ("plan.parquet",)),
    Writer("demo --clock lockstep --duration 1 --schedule {schedule}", "--out", "run", RUN),
]
FILES = [writer for writer in WRITERS if not writer.holds]
FOLDERS = [writer for writer in WRITERS if writer.holds]


@pytest.fixture(scope="session")
def inputs(walk, tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("inputs")
    (folder / "gait").mkdir()
    recordings = {"walk.csv": 1.2, "other.csv": 1.0, "gait/somebody.csv": 1.2}
    for name, speed_m_s in recordings.items():
        (folder / name).write_text(csv_text(Walk(speed_m_s=speed_m_s, duration_s=10).recording()))
    (folder / "person.toml").write_text("body_height_m = 1.7\n")
    shutil.copy(CHECKOUT / "examples/schedule.csv", folder)
    states = folder / "states.csv"
    assert main(["plan", "--speed", "1.2", "--out", str(states)]) == 0
    head, *rows = states.read_text().splitlines()
    lines = [f"{head},left_contact,right_contact", *(f"{row},1,1" for row in rows)]
    states.write_text("\n".join(lines))
    shutil.copy(walk / "walk.lcmlog", folder)
    return {
        "walk": folder / "walk.csv",
        "other": folder / "other.csv",
        "gait": folder / "gait",
        "falls": write_folder(folder / "falls"),
        "toml": folder / "person.toml",
        "schedule": folder / "schedule.csv",
        "states": states,
        "log": folder / "walk.lcmlog",
    }


@pytest.fixture
def mine(inputs, tmp_path) -> dict[str, Path]:
    """Copies of the inputs, for a test that may harm them."""
    shutil.copytree(inputs["gait"].parent, tmp_path / "inputs")
    return {name: tmp_path / "inputs" / path.name for name, path in inputs.items()}


def run(writer: Writer, inputs: dict[str, Path], out: Path | str) -> int:
    words = [word.format(**inputs) for word in writer.words.split()]
    ports = ["--can", private_udp(), "--lcm", own_lcm()] if writer.command == "demo" else []
    return main([*words, *ports, writer.option, str(out)])


def contents(folder: Path) -> dict[str, bytes]:
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.fixture
def rejected(monkeypatch, capsys):
    """Checks that a command rejects its output in one line before it computes."""

    def check(writer: Writer, inputs: dict[str, Path], out: Path | str) -> str:
        module = importlib.import_module(f"saddlewalk.commands.{writer.command}")
        monkeypatch.setattr(module, "run", lambda args: pytest.fail("it ran"))
        assert run(writer, inputs, out) == 2
        printed = capsys.readouterr()
        assert (printed.out, printed.err.count("\n")) == ("", 1)
        assert f"{writer.option} {out}" in printed.err
        return printed.err

    return check


def commands() -> dict[str, argparse.ArgumentParser]:
    return parser()._subparsers._group_actions[0].choices


FILE_WORDS = {"FILE", "FOLDER", "LOG", "OUT", "TRIAL.csv", "RECORDING", "report.html"}


def test_every_file_option_declares_its_role():
    """Else check_files() would not know it."""
    for name, command in commands().items():
        for action in command._actions:
            names_a_file = action.metavar in FILE_WORDS or action.type is Path
            assert hasattr(action, "role") == names_a_file, f"{name} {action.dest}"


def test_the_table_has_every_output_of_every_command():
    outputs = {
        (name, action.option_strings[0])
        for name, command in commands().items()
        for action in command._actions
        if hasattr(action, "role") and action.role.output
    }
    assert outputs == {(writer.command, writer.option) for writer in WRITERS}


def inputs_of(writer: Writer) -> list[str]:
    return re.findall(r"{(\w+)}", writer.words)


def file_of(path: Path) -> Path:
    """An input, or one of the files in a folder that is an input."""
    return min(each for each in path.iterdir() if each.is_file()) if path.is_dir() else path


def other_names(target: Path, folder: Path, suffix: str) -> list[Path]:
    """Paths and links to a file; only links if the suffix would be rejected."""
    symbolic, hard = folder / f"symbolic{suffix}", folder / f"hard{suffix}"
    symbolic.symlink_to(target)
    hard.hardlink_to(target)
    links = [symbolic, hard]
    if suffix == ".svg":
        return links
    return [target, target.parent / ".." / target.parent.name / target.name, *links]


@pytest.mark.parametrize("writer", FILES, ids=str)
def test_an_output_that_is_an_input_is_rejected(writer, mine, tmp_path, rejected):
    before = contents(tmp_path / "inputs")
    for name in inputs_of(writer):
        folder = tmp_path / name
        folder.mkdir()
        for out in other_names(file_of(mine[name]), folder, Path(writer.out).suffix):
            assert "is the same file as" in rejected(writer, mine, out)
    assert contents(tmp_path / "inputs") == before


@pytest.mark.parametrize("writer", FOLDERS, ids=str)
def test_a_folder_that_would_lose_an_input_is_rejected(writer, mine, tmp_path, rejected):
    """The input is what the command would write there; or the folder is that of the input."""
    for name in inputs_of(writer):
        folder = tmp_path / name
        folder.mkdir()
        (folder / writer.holds[0]).hardlink_to(file_of(mine[name]))
        assert "is the same file as" in rejected(writer, mine, folder)
    if "{gait}" in writer.words:
        assert "is the same file as --gait" in rejected(writer, mine, mine["gait"])


@pytest.mark.parametrize("writer", WRITERS, ids=str)
def test_an_output_that_cannot_be_written_is_rejected(writer, inputs, tmp_path, rejected):
    name = writer.out
    (tmp_path / "file").write_bytes(OLD)
    rejected(writer, inputs, tmp_path / "file" / name)
    rejected(writer, inputs, f"/proc/{name}")
    rejected(writer, inputs, tmp_path / ("x" * 300 + name))
    if writer.holds:
        rejected(writer, inputs, tmp_path / "file")
        (tmp_path / "run" / writer.holds[0]).mkdir(parents=True)
        assert "is a folder" in rejected(writer, inputs, tmp_path / "run")
    else:
        folder = tmp_path / name
        folder.mkdir()
        assert "is a folder" in rejected(writer, inputs, folder)
        assert "no folder" in rejected(writer, inputs, tmp_path / "nowhere" / name)
    assert (tmp_path / "file").read_bytes() == OLD


@pytest.fixture
def nobody(inputs) -> Iterator[Path]:
    """A folder of this process, which runs as another user: root may write anywhere."""
    parser()  # imports every command
    was = os.geteuid()
    with tempfile.TemporaryDirectory() as folder:  # pytest's own is in one of its user alone
        Path(folder).chmod(0o777)
        if was == 0:
            os.seteuid(NOBODY)
        yield Path(folder)
        os.seteuid(was)


@pytest.mark.parametrize("writer", WRITERS, ids=str)
def test_an_output_that_is_write_protected_is_rejected(writer, inputs, nobody, rejected):
    out = nobody / "folder" / writer.out
    file = out / writer.holds[0] if writer.holds else out
    file.parent.mkdir(parents=True)
    file.write_bytes(OLD)
    file.chmod(0o444)
    assert "write-protected" in rejected(writer, inputs, out)
    file.chmod(0o644)
    file.parent.chmod(0o555)
    assert "Permission denied" in rejected(writer, inputs, out)
    file.parent.chmod(0o755)
    assert file.read_bytes() == OLD


@pytest.mark.parametrize("writer", WRITERS, ids=str)
def test_an_output_stays_as_it_was_until_all_is_written(writer, inputs, tmp_path, monkeypatch):
    """Ctrl-C at the last moment."""

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    out = tmp_path / "out" / writer.out
    for file in [out / name for name in writer.holds] or [out]:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(OLD)
    before = contents(tmp_path)
    monkeypatch.setattr(atomic_write, "_move_all", interrupted)
    monkeypatch.setattr(Path, "replace", interrupted)
    assert run(writer, inputs, out) == 130
    after = contents(tmp_path)
    kept = {name: after.pop(name) for name in list(after) if "/unfinished/" in name}
    assert after == before
    assert bool(kept) == (writer.command == "demo")


@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_an_output_stays_when_the_command_is_ended(tmp_path, by):
    out = tmp_path / "plan.csv"
    out.write_bytes(OLD)
    plan = [SADDLEWALK, "plan", "--speed", "1.2", "--strides", "1000000", "--out", str(out)]
    with subprocess.Popen(plan) as process:
        while not any(path.stat().st_size for path in tmp_path.glob(".new.*")):
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(by)
    assert process.returncode == (-by if by == signal.SIGKILL else 130)
    assert out.read_bytes() == OLD
    assert (list(tmp_path.iterdir()) == [out]) == (by != signal.SIGKILL)


def test_two_outputs_of_a_command_are_two_files(inputs, tmp_path, capsys):
    one = str(tmp_path / "one")
    for first, second in ((one, f"{tmp_path}/../{tmp_path.name}/one"), ("-", "-"), (one, one)):
        words = ["calibrate", str(inputs["walk"]), "--out", first, "--header", second]
        assert main(words) == 2
        printed = capsys.readouterr()
        assert (printed.out, printed.err.count("\n")) == ("", 1)
        assert "is the same file as --out" in printed.err
    assert not Path(one).exists()


def shell(line: str, folder: Path) -> subprocess.CompletedProcess:
    words = ["bash", "-c", line, str(SADDLEWALK)]
    return subprocess.run(
        words, cwd=folder, capture_output=True, text=True, check=False, timeout=60
    )


@pytest.mark.parametrize(
    "line",
    [
        '"$0" supervise --in - --out states.csv <states.csv',
        '"$0" supervise --in states.csv >>states.csv',
        '"$0" supervise --in states.csv --out /dev/fd/7 7>>states.csv',
    ],
)
def test_a_stream_from_or_to_a_file_is_that_file(line, mine, tmp_path):
    before = contents(tmp_path)
    done = shell(line, tmp_path / "inputs")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "is the same file as --in" in done.stderr
    assert contents(tmp_path) == before


@pytest.mark.parametrize(
    ("line", "start"),
    [
        ('"$0" plan --speed 1.2 --out /dev/stdout >>file', "old\nt_s,"),
        ('"$0" plan --speed 1.2 --out /dev/fd/7 7>>file', "old\nt_s,"),
        ('"$0" plan --speed 1.2 --out >(cat >>file); wait $!', "old\nt_s,"),
        ('"$0" plan --speed 1.2 --out /dev/null', "old\n"),
        ('"$0" supervise --in <(cat inputs/states.csv) >>file', "old\nt_s,"),
        ('"$0" report inputs/walk.lcmlog --out - >>file', "old\n<!doctype html>"),
        ('"$0" export inputs/walk.lcmlog --format mcap --out - >file', "\x89MCAP"),
    ],
)
def test_open_files_are_written_to_and_not_replaced(line, start, mine, tmp_path):
    file = tmp_path / "file"
    file.write_text("old\n")
    number = file.stat().st_ino
    done = shell(line, tmp_path)
    assert done.returncode == 0, done.stderr
    assert file.read_bytes().decode("latin-1").startswith(start)
    assert file.stat().st_ino == number


def test_a_file_that_is_replaced_keeps_its_permissions(tmp_path):
    out = tmp_path / "plan.csv"
    out.write_bytes(OLD)
    out.chmod(0o640)
    assert main(["plan", "--speed", "1.2", "--out", str(out)]) == 0
    assert out.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("suffix", ["docx", "", "csv"])
def test_an_unknown_picture_format_is_rejected_before_planning(inputs, capsys, suffix):
    words = ["plan", "--schedule", str(inputs["schedule"]), "--picture", f"x.{suffix}"]
    assert main(words) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and ".png or .svg or .pdf" in printed.err
