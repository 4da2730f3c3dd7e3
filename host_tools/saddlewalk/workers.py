"""Campaigns: a function of many tasks, in processes of this machine or of a dask cluster.

Its results follow from the tasks alone, so they are the same wherever it runs, and a task whose
worker is lost is run again on another.
"""

import contextlib
import functools
import hashlib
import multiprocessing
import pickle
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any, TypeVar

from saddlewalk import __version__
from saddlewalk.errors import UserError
from saddlewalk.paths import CHECKOUT, PACKAGE, in_checkout, install_command

CONNECT_TIMEOUT_S = 10
SOURCES = ("firmware/**/*.[ch]", "firmware/**/*.dbc", "host_tools/saddlewalk/**/*.py")
SHIPPED_SOURCES = ("shipped/build/lib/*.so", "shipped/firmware/**/*.dbc", "**/*.py")

Result = TypeVar("Result")
Completed = Generator[tuple[int, list[Result]], None, None]  # a task's index and its results


@dataclass(frozen=True)
class Workers:
    """Where a campaign runs: in `jobs` processes of this machine, or by a dask scheduler."""

    jobs: int
    scheduler: str | None = None  # address, such as tcp://10.0.0.5:8786

    def __str__(self) -> str:
        return f"{self.jobs} jobs" if self.scheduler is None else f"scheduler {self.scheduler}"


def run_tasks(
    work: Callable[..., list[Result]],
    tasks: Sequence[tuple[Any, ...]],
    workers: Workers,
    progress: Callable[[int], None],
) -> list[Result]:
    """The results of work(*task) for each task, in their order; progress(results so far).

    work is a function of a module, without side effects; tasks and results can be pickled. Raises
    UserError if the workers cannot be used, or if work raises it.
    """
    run = _in_processes if workers.scheduler is None else _on_cluster
    results: dict[int, list[Result]] = {}
    with contextlib.closing(run(work, tasks, workers)) as completed:
        for index, found in completed:
            results[index] = found
            progress(sum(map(len, results.values())))
    return [each for index in sorted(results) for each in results[index]]


def _in_processes(
    work: Callable[..., list[Result]], tasks: Sequence[tuple[Any, ...]], workers: Workers
) -> Completed[Result]:
    # Not forked: a fork of a process with threads may inherit a lock that nobody releases.
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers.jobs, mp_context=spawn) as pool:
        futures = {pool.submit(work, *task): index for index, task in enumerate(tasks)}
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        except BrokenProcessPool as error:
            raise UserError(
                "a worker process was killed, perhaps for lack of memory: try fewer --jobs"
            ) from error
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _on_cluster(
    work: Callable[..., list[Result]], tasks: Sequence[tuple[Any, ...]], workers: Workers
) -> Completed[Result]:
    address = str(workers.scheduler)
    with _connected(address) as client:
        from distributed import KilledWorker
        from distributed import as_completed as completed_on_cluster

        run = functools.partial(_runner(), identity())
        futures = client.map(run, [pickle.dumps((work, task)) for task in tasks], pure=False)
        indices = {future.key: index for index, future in enumerate(futures)}
        try:
            for future in completed_on_cluster(futures, loop=client.loop):
                yield indices[future.key], _results(future.result())
        except KilledWorker as error:
            raise UserError(f"--scheduler {address}: workers die on a task: {error}") from error
        except CancelledError as error:
            raise UserError(f"--scheduler {address}: the connection was lost") from error


@contextlib.contextmanager
def _connected(address: str) -> Iterator[Any]:
    """A client of the scheduler, with at least one worker; at the end it drops its tasks."""
    try:
        from distributed import Client
    except ImportError as error:
        raise UserError(f"--scheduler needs dask: {install_command('cluster')}") from error
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UserError(f"--scheduler {address}: no dask scheduler answers there") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECT_TIMEOUT_S)
        except TimeoutError as error:
            raise UserError(
                f"--scheduler {address}: it has no workers: start some with `dask worker {address}`"
            ) from error
        yield client


def _runner() -> Callable[[str, bytes], bytes | str]:
    """What dask runs. A nested function is sent as code and a job as bytes: both arrive even where
    saddlewalk is missing or another one.
    """

    def run(client_identity: str, job: bytes) -> bytes | str:
        from distributed import get_worker

        worker = f"worker {get_worker().address}"
        try:
            from saddlewalk.workers import run_job
        except ImportError:
            return f"{worker} has no saddlewalk: it needs {client_identity}"
        return run_job(worker, client_identity, job)

    return run


def run_job(worker: str, client_identity: str, job: bytes) -> bytes | str:
    """On a worker: the pickled results of a pickled (work, task), or an error in words."""
    if identity() != client_identity:
        return (
            f"{worker} has saddlewalk {identity()}, this is {client_identity}: "
            "check out the same commit for both"
        )
    work, task = pickle.loads(job)
    try:
        return pickle.dumps(work(*task))
    except UserError as error:
        return f"{worker}: {error}"


def _results(found: bytes | str) -> Any:
    if isinstance(found, str):
        raise UserError(found)
    return pickle.loads(found)


@functools.cache
def identity() -> str:
    """Version and a hash of the sources that decide results."""
    digest = hashlib.sha256()
    root, patterns = (CHECKOUT, SOURCES) if in_checkout() else (PACKAGE, SHIPPED_SOURCES)
    for path in sorted(path for pattern in patterns for path in root.glob(pattern)):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return f"{__version__} (sources {digest.hexdigest()[:8]})"
