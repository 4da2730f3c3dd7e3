"""Atomic writing: existing files are replaced only when the new ones are complete.

Output goes to a new file or folder in the same place, which is renamed at the end. A command that
fails or is killed never damages existing files.
"""

import contextlib
import fcntl
import os
import shutil
import signal
import stat
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from saddlewalk.errors import UserError
from saddlewalk.printable import printable

STDIN, STDOUT, STDERR = range(3)
UNFINISHED = "unfinished"
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def own_descriptor(path: str | Path) -> int | None:
    """The descriptor of a path such as /dev/stdout or /dev/fd/3, which is open already."""
    standard = {"/dev/stdin": STDIN, "/dev/stdout": STDOUT, "/dev/stderr": STDERR}
    if str(path) in standard:
        return standard[str(path)]
    folder, name = os.path.split(path)
    if not name.isdigit() or os.path.realpath(folder) != f"/proc/{os.getpid()}/fd":
        return None
    return int(name)


@contextlib.contextmanager
def atomic_file(option: str, path: str | Path, mode: str = "w") -> Iterator[IO[Any]]:
    """A file that appears at `path` when it is complete; "-": standard output.

    Special files, and those that are open already, are written to and not replaced. Raises
    UserError, naming the option, if it cannot be written.
    """
    if str(path) == "-":
        if "b" not in mode:
            yield sys.stdout
            return
        with os.fdopen(os.dup(STDOUT), mode) as file:  # the library may close the file
            yield file
        return
    try:
        with _open(Path(path), mode) as file:
            yield file
    except OSError as error:
        raise UserError(f"{option} {path}: {error.strerror}") from error


def write_text(option: str, path: str | Path, text: str) -> None:
    """Write to an atomic_file()."""
    with atomic_file(option, path) as file:
        file.write(text)


@contextlib.contextmanager
def atomic_folder(option: str, folder: Path, names: Sequence[str]) -> Iterator[Path]:
    """A new folder whose files are moved to `folder` when all are complete.

    Files of `names` in `folder` that are not written again are of an earlier run and are removed.
    No other file is touched. Raises UserError, naming the option, if it cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder, prefix=".new.") as new:
            yield Path(new)
            _replace(folder, Path(new), names)
    except OSError as error:
        raise UserError(f"{option} {folder}: {error.strerror}") from error


class RunFolder:
    """An atomic_folder() for recordings, which cannot be repeated.

    Files are written in FOLDER/unfinished. An interrupted run stays there if FOLDER has an earlier
    run, and is moved to FOLDER otherwise.
    """

    def __init__(self, option: str, folder: Path, names: Sequence[str]) -> None:
        self.folder = folder
        self._option, self._names = option, names
        self._new = folder / UNFINISHED
        self._lock: int | None = None

    @property
    def earlier(self) -> list[str]:
        """The files of an earlier run."""
        return [name for name in self._names if _is_there(self.folder / name)]

    def start(self) -> Path:
        """The folder to write to, empty. Raises UserError if another run is recorded there."""
        try:
            self._new.mkdir(parents=True, exist_ok=True)
            lock = os.open(self._new, os.O_RDONLY)
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            for name in self._names:
                (self._new / name).unlink(missing_ok=True)
            self._lock = lock
        except BlockingIOError as error:
            raise UserError(
                f"{self._option} {self.folder}: another run is being recorded there: give another"
            ) from error
        except OSError as error:
            raise UserError(f"{self._option} {self.folder}: {error.strerror}") from error
        return self._new

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, _: BaseException | None, __: TracebackType | None
    ) -> None:
        if self._lock is None:
            return
        os.close(self._lock)
        if kind and self.earlier:
            print(
                f"{printable(self.folder)} still holds the previous run; what was recorded of this "
                f"one is in {printable(self._new)}",
                flush=True,
            )
            return
        try:
            _replace(self.folder, self._new, self._names)
        except OSError as error:
            words = f"{error.strerror}: the run is in {self._new}"
            raise UserError(f"{self._option} {self.folder}: {words}") from error
        with contextlib.suppress(OSError):  # it has a file that is not ours
            self._new.rmdir()


@contextlib.contextmanager
def _open(path: Path, mode: str) -> Iterator[IO[Any]]:
    newline = None if "b" in mode else ""
    descriptor = own_descriptor(path)
    if descriptor is not None:
        with os.fdopen(os.dup(descriptor), mode, newline=newline) as file:
            yield file
        return
    if path.exists() and not path.is_file():
        with path.open(mode, newline=newline) as file:
            yield file
        return
    path = path.resolve()  # a symbolic link stays one
    descriptor, partial = tempfile.mkstemp(dir=path.parent, prefix=".new.")
    try:
        with os.fdopen(descriptor, mode, newline=newline) as file:
            yield file
            file.flush()
            os.fsync(descriptor)
        Path(partial).chmod(_permissions(path))
        Path(partial).replace(path)
    finally:
        Path(partial).unlink(missing_ok=True)


def _permissions(path: Path) -> int:
    """Permissions of the existing file, else of a new one."""
    if path.exists():
        return stat.S_IMODE(path.stat().st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _is_there(path: Path) -> bool:
    return path.is_symlink() or path.is_file()


def _replace(folder: Path, new: Path, names: Sequence[str]) -> None:
    """Move the files of `names` in `new` to `folder`, replacing all those there, or none."""
    with _uninterrupted():
        old = Path(tempfile.mkdtemp(dir=folder, prefix=".old."))
        moves = [(folder / name, old / name) for name in names if _is_there(folder / name)]
        moves += [(new / name, folder / name) for name in names if _is_there(new / name)]
        _move_all(moves)
        shutil.rmtree(old)
        for part in {(folder / name).parent for name in names} - {folder}:
            with contextlib.suppress(OSError):  # it is missing, or holds another file
                part.rmdir()


def _move_all(moves: Sequence[tuple[Path, Path]]) -> None:
    """All or, with an OSError, none."""
    done = []
    try:
        for source, target in moves:
            target.parent.mkdir(parents=True, exist_ok=True)
            source.rename(target)
            done.append((source, target))
    except OSError:
        for source, target in reversed(done):
            target.rename(source)
        raise


@contextlib.contextmanager
def _uninterrupted() -> Iterator[None]:
    """Delay Ctrl-C, SIGTERM and SIGHUP until the end."""
    came: list[int] = []
    before = {number: signal.getsignal(number) for number in ENDING}
    for number, handler in before.items():
        if handler != signal.SIG_IGN:
            signal.signal(number, lambda signum, _: came.append(signum))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    if came:
        signal.raise_signal(came[0])
