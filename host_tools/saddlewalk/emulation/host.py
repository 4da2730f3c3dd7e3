"""The firmware process `saddlewalk-host`, run as a child for the length of a `with` block."""

import contextlib
import subprocess
import threading
from collections.abc import Iterator

from saddlewalk.errors import UserError
from saddlewalk.paths import built

START_TIMEOUT_S = 10.0
STOP_TIMEOUT_S = 5.0


@contextlib.contextmanager
def running_host(*options: str) -> Iterator[subprocess.Popen[str]]:
    """Starts it, waits until it is ready, and ends it by SIGTERM when the block ends.

    Raises UserError with its last line if it does not become ready or does not end with status 0.
    """
    program = [str(built("bin/saddlewalk-host")), *options]
    process = subprocess.Popen(
        program, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, bufsize=1
    )
    try:
        _await_ready(process)
        yield process
    finally:
        words = _stop(process)
    if process.returncode != 0:
        raise _failed(process, words)


def _await_ready(process: subprocess.Popen[str]) -> None:
    watchdog = threading.Timer(START_TIMEOUT_S, process.kill)
    watchdog.start()
    words = ""
    try:
        for line in process.stdout or ():
            if line.strip() == "ready":
                return
            words += line
    finally:
        watchdog.cancel()
    process.wait()
    raise _failed(process, words)


def _stop(process: subprocess.Popen[str]) -> str:
    """End it; returns its last line. A process that ignores SIGTERM is killed, as its status then
    shows.
    """
    process.terminate()
    try:
        return process.communicate(timeout=STOP_TIMEOUT_S)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        return process.communicate()[0]


def _failed(process: subprocess.Popen[str], words: str) -> UserError:
    last = words.strip().splitlines()[-1:] or [
        f"saddlewalk-host ended, status {process.returncode}"
    ]
    return UserError(last[0])
