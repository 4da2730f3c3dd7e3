"""Which options name files, and the check of the outputs before a command reads or computes.

Every option that names a file or a folder is added by add_input() or add_output().
"""

import argparse
import os
import stat
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from saddlewalk.atomic_write import STDIN, STDOUT, own_descriptor
from saddlewalk.errors import UserError


@dataclass(frozen=True)
class OutputFile:
    """One file. suffixes: of the formats that can be written, such as .png; empty: any."""

    suffixes: tuple[str, ...] = ()


@dataclass(frozen=True)
class OutputFolder:
    """Files that belong together. names: all that a command may write or replace there."""

    names: tuple[str, ...]


Output = OutputFile | OutputFolder


@dataclass(frozen=True)
class _Role:
    """The role of an option's value. output: None for an input."""

    output: Callable[[argparse.Namespace], Output] | None = None
    default: Callable[[argparse.Namespace], Path] | None = None


@dataclass(frozen=True)
class _Named:
    """A file, and the option that names it."""

    option: str
    path: str

    def __str__(self) -> str:
        return f"{self.option} {self.path}".removesuffix(" -")


def add_input(container: Any, *names: str, **keywords: Any) -> None:
    """container.add_argument() for a file, or a folder of files, that the command reads."""
    container.add_argument(*names, **keywords).role = _Role()


def add_output(
    container: Any,
    *names: str,
    output: Output | Callable[[argparse.Namespace], Output] = OutputFile(),
    default_path: Callable[[argparse.Namespace], Path] | None = None,
    **keywords: Any,
) -> None:
    """container.add_argument() for what the command writes.

    output and default_path may depend on the other options.
    """
    of = output if callable(output) else lambda _: output
    container.add_argument(*names, **keywords).role = _Role(of, default_path)


def check_files(parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
    """Raise UserError if an output cannot be written, is an input or is another output.

    By any path or link. Fills in the defaults that depend on other options.
    """
    inputs: list[_Named] = []
    outputs: list[_Named] = []
    for action in parser._actions:
        role = getattr(action, "role", None)
        if role is None:
            continue
        option = action.option_strings[0] if action.option_strings else str(action.metavar)
        if role.output is None:
            inputs += _inputs(option, getattr(args, action.dest))
        else:
            outputs += _outputs(option, _output_path(action.dest, role, args), role.output(args))
    _reject_duplicates(inputs, outputs)


def _inputs(option: str, value: Any) -> Iterator[_Named]:
    """The files of an input option, and those in a folder."""
    paths = value if isinstance(value, list) else [value]
    for path in (str(path) for path in paths if path is not None):
        yield _Named(option, path)
        if os.path.isdir(path):  # noqa: PTH112 - Path.is_dir() raises for a name that is too long
            yield from (_Named(option, entry.path) for entry in os.scandir(path))


def _output_path(dest: str, role: _Role, args: argparse.Namespace) -> str | None:
    """The option's value in `args`; "-" for standard output by any name."""
    value = getattr(args, dest)
    if value is None and role.default:
        value = role.default(args)
    if value is not None and own_descriptor(value) == STDOUT:
        value = type(value)("-")
    setattr(args, dest, value)
    return None if value is None else str(value)


def _outputs(option: str, path: str | None, output: Output) -> list[_Named]:
    """The files that an output option names, each of which can be written."""
    if path is None:
        return []
    named = _Named(option, path)
    try:
        if isinstance(output, OutputFolder):
            return _checked_folder(named, output)
        _check_file(named, output)
    except OSError as error:
        raise UserError(f"{named}: {error.strerror}") from error
    return [named]


def _check_file(named: _Named, output: OutputFile) -> None:
    path = Path(named.path)
    device = path.exists() and not (path.is_file() or path.is_dir())
    if output.suffixes and not device and path.suffix.lower() not in output.suffixes:
        raise UserError(f"{named} must end in {' or '.join(output.suffixes)}")
    if named.path == "-":
        return
    if path.is_dir():
        raise UserError(f"{named} is a folder: give a file")
    if path.exists() and not os.access(path, os.W_OK, effective_ids=True):
        raise UserError(f"{named} is write-protected")
    if not device and own_descriptor(path) is None:
        _try(named, path.resolve().parent)


def _checked_folder(named: _Named, output: OutputFolder) -> list[_Named]:
    folder = Path(named.path)
    there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise UserError(f"{named}: {there} is a file: give a folder")
    _try(named, there)
    files = [_Named(named.option, str(folder / name)) for name in output.names]
    for file in files:
        if Path(file.path).exists():
            _check_file(file, OutputFile())
    return [named, *files]


def _try(named: _Named, folder: Path) -> None:
    """Create a file in the folder: permissions alone do not show that it is possible."""
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except FileNotFoundError as error:
        raise UserError(f"{named}: {error.strerror}: there is no folder {folder}") from error


def _reject_duplicates(inputs: list[_Named], outputs: list[_Named]) -> None:
    taken = {_identity(file, STDIN): file for file in inputs}
    taken.pop(None, None)
    if all(file.path != "-" for file in outputs):
        outputs = [_Named("standard output", "-"), *outputs]
    for file in outputs:
        identity = _identity(file, STDOUT)
        if identity is None:
            continue
        if identity in taken:
            raise UserError(f"{file} is the same file as {taken[identity]}: give another")
        taken[identity] = file


def _identity(file: _Named, stream: int) -> Any:
    """Equal for two paths to one file. None: a device or a pipe, or an input that is not there."""
    try:
        status = os.fstat(stream) if file.path == "-" else os.stat(file.path)  # noqa: PTH116
    except OSError:
        return None if file.path == "-" else os.path.realpath(file.path)
    if stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode):
        return status.st_dev, status.st_ino
    return "-" if (file.path, stream) == ("-", STDOUT) else None
