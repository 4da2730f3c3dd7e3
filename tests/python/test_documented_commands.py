"""Every command line of the README and of docs/ runs as printed, or is listed as an exception.

Commands stand in blocks of `sh`; a block of `text` right after one is what it prints last. Each
block runs in a folder like a checkout after `make build`, and in a network of its own.
"""

import argparse
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from laboratory import LABORATORIES, PERSON, c3d_file, laboratory, walk_of
from private_test_network import in_private_network
from saddlewalk import paths
from saddlewalk.cli import parser
from saddlewalk.core import field_ranges
from synthetic_walk import csv_text

CHECKOUT = paths.CHECKOUT
PAGES = [CHECKOUT / "README.md", *sorted((CHECKOUT / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```sh\n(.*?)^```$(?:\n\n```text\n(.*?)^```$)?", re.MULTILINE | re.DOTALL)
TIMEOUT_S = 60
# As at a terminal, which knows its jobs; but it stops at the first line that fails.
SHELL = "set -em; trap 'for job in $(jobs -p); do kill -- -$job 2>&- || true; done' EXIT"

# Lines that start with these are not run, but every option that they name must be there.
NOT_RUN = {
    "make demo": "half a minute in real time; .ci/run runs it",
    "make test": "this test is a part of it",
    "sudo apt-get": "root, and the network",
    "sudo modprobe": "root, and a kernel with CAN",
    "build/bin/saddlewalk-host --set command_max_age_s=60": "the kernel's CAN: test_socketcan.py",
    "cansend vcan0": "the kernel's CAN: test_socketcan.py",
    "candump vcan0": "the kernel's CAN: test_cantools.py",
    ".venv/bin/cantools monitor": "runs until it is ended, on a terminal: test_cantools.py",
    "build/bin/saddlewalk-host --command-key": "20 s in real time: test_authentication.py",
    ".venv/bin/saddlewalk emulate --command-key": "20 s in real time: test_authentication.py",
    "make build bench-baselines": "packages from the network",
    ".venv/bin/saddlewalk bench": "minutes, and packages from the network: test_bench.py",
    ".venv/bin/saddlewalk evaluate": "minutes: test_evaluation.py",
    ".venv/bin/saddlewalk faults": "minutes: test_faults.py",
    ".venv/bin/pip install -c requirements.lock": "packages from the network",
    ".venv/bin/dask": "other machines: test_workers.py",
    "make physics": "packages from the network",
    ".venv/bin/saddlewalk demo --plant mujoco": "half a minute, and MuJoCo: test_physics.py",
    ".venv/bin/saddlewalk endure": "minutes: test_physics.py",
    ".venv/bin/saddlewalk chain": "half a minute to minutes, and MuJoCo: test_chain.py",
    "make controller": "a cross-compiler and QEMU: test_controller.py",
}

WITH_SUBCOMMANDS = ("cantools", "dask", "pip")


@dataclass(frozen=True)
class Block:
    page: Path
    lines: tuple[str, ...]  # each a whole command
    printed: str

    def __str__(self) -> str:
        return f"{self.page.name}: {self.lines[0]}"

    @property
    def to_run(self) -> list[str]:
        return [line for line in self.lines if not reason(line)]


def reason(line: str) -> str | None:
    """Why a line is not run."""
    return next((why for start, why in NOT_RUN.items() if line.startswith(start)), None)


def blocks_of(page: Path) -> list[Block]:
    return [
        Block(page, tuple(block.replace("\\\n", " ").splitlines()), printed)
        for block, printed in BLOCK.findall(page.read_text())
    ]


BLOCKS = [block for page in PAGES for block in blocks_of(page)]
LINES = [line for block in BLOCKS for line in block.lines]


@pytest.fixture(scope="module")
def checkout(tmp_path_factory) -> Path:
    """A copy of the checkout, with the files that the documented commands read."""
    folder = tmp_path_factory.mktemp("checkout")
    for path in CHECKOUT.iterdir():
        if path.name not in ("docs", "build", "out", ".git"):
            (folder / path.name).symlink_to(path)
    (folder / "build").symlink_to(paths.build_dir().absolute())
    shutil.copytree(CHECKOUT / "docs", folder / "docs")
    for name, speed_m_s in (("slow", 0.8), ("normal", 1.0), ("fast", 1.2)):
        markers = laboratory(walk_of(PERSON, speed_m_s), LABORATORIES["z up, walking along -y"])
        c3d_file(folder / f"{name}.c3d", markers)
    (folder / "JANE").mkdir()
    for name in ("slow", "fast"):
        (folder / f"JANE/{name}.c3d").symlink_to(folder / f"{name}.c3d")
    (folder / "FOLDER").mkdir()
    (folder / "FOLDER/a__walk.csv").write_text(csv_text(walk_of(PERSON, 1.0)))
    return folder


@pytest.mark.parametrize("block", [block for block in BLOCKS if block.to_run], ids=str)
@in_private_network
def test_a_block_runs_as_printed(block, checkout):
    script = "\n".join([SHELL, *block.to_run])
    done = subprocess.run(
        ["timeout", str(TIMEOUT_S), "bash", "-c", script],
        cwd=checkout,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith(block.printed)
    if "cantools decode" in script:
        assert " :: PLAN_COM(" in done.stdout


def words_of(line: str) -> list[list[str]]:
    """Its commands, each in words."""
    commands: list[list[str]] = [[]]
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    for word in lexer:
        if set(word) <= set("();|&<>"):
            commands.append([])
        else:
            commands[-1].append(word)
    return [words for words in commands if words]


def options_of(words: list[str]) -> set[str]:
    return {word.partition("=")[0] for word in words if re.match(r"--?[a-zA-Z]", word)}


def commands() -> dict[str, argparse.ArgumentParser]:
    return parser()._subparsers._group_actions[0].choices


def known_options(words: list[str]) -> set[str] | None:
    """The options of one of our programs, from its --help; None for any other program."""
    program, *rest = words
    if program == ".venv/bin/saddlewalk":
        return set(commands()[rest[0]]._option_string_actions)
    if program.startswith(("build/bin/", ".venv/bin/")):
        own = Path(sys.executable).parent / Path(program).name
        path = own if program.startswith(".venv") else paths.built(program.removeprefix("build/"))
        asked = [path, *([rest[0]] if own.name in WITH_SUBCOMMANDS else []), "--help"]
        help_text = subprocess.run(asked, capture_output=True, text=True, check=False)
        return set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", help_text.stdout + help_text.stderr))
    return None


@pytest.mark.parametrize("line", [line for line in LINES if reason(line)])
def test_a_line_that_is_not_run_names_what_is_there(line):
    for words in words_of(line):
        if words[0] == "make":
            makefile = (CHECKOUT / "Makefile").read_text()
            assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in words[1:])
        known = known_options(words)
        if known is not None:
            assert options_of(words) <= known, words
        if words[0] == "build/bin/saddlewalk-host" and "--set" in words:
            field = words[words.index("--set") + 1].partition("=")[0]
            assert field in field_ranges()


def test_every_exclusion_matches_a_line():
    for start in NOT_RUN:
        assert any(line.startswith(start) for line in LINES), start


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_are_written_in_one_form(page):
    """In blocks of `sh`, and `.venv/bin/saddlewalk` wherever a command of it is named."""
    text = page.read_text()
    names = "|".join(commands())
    assert not re.findall(rf"(?<!\.venv/bin/)saddlewalk (?:{names})\b", text)
    programs = r"\.venv/bin/|build/bin/|make |sudo |saddlewalk |cc |candump |cansend "
    assert not re.findall(rf"^ {{4,}}(?:{programs}).*", BLOCK.sub("", text), re.MULTILINE)


def inline_commands(page: Path) -> list[str]:
    """Commands in the text, and those of the table of commands, whose head has the program."""
    text = page.read_text()
    typed = re.findall(r"`(\.venv/bin/saddlewalk [a-z][^`]*)`", text)
    rows = text.partition("| `.venv/bin/saddlewalk` |")[2].partition("\n\n")[0]
    typed += [f".venv/bin/saddlewalk {row}" for row in re.findall(r"^\| `([^`]*)` \|", rows, re.M)]
    return typed


def test_commands_in_the_text_have_the_options_that_they_name():
    typed = [line for page in PAGES for line in inline_commands(page)]
    assert len(typed) > 25
    for line in typed:
        words = line.split()
        known = known_options(words)
        assert options_of(words) <= known, line


def test_the_table_has_every_command():
    rows = inline_commands(CHECKOUT / "docs/commands.md")
    assert {line.split()[1] for line in rows} == set(commands())
