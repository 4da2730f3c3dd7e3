"""Campaigns by a dask scheduler with two worker processes: the same results, and clear errors."""

import contextlib
import functools
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from saddlewalk import core, workers
from saddlewalk.cli import main
from saddlewalk.errors import UserError
from saddlewalk.evaluation.walks import evaluate
from saddlewalk.faults.campaign import campaign
from saddlewalk.faults.scenario import read_scenario
from saddlewalk.paths import CHECKOUT
from saddlewalk.workers import Workers, run_tasks

DASK = Path(sys.executable).with_name("dask")
CONFIG = core.ffi().new("saddle_config_t *", core.library().saddle_config_default(1.79, 63.3))
SCENARIO = read_scenario(CHECKOUT / "examples/faults.toml")
START_TIMEOUT_S = 60


class Cluster:
    """A scheduler and its workers on this machine, each a process of its own."""

    def __init__(self, folder: Path, worker_count: int, **environment: str) -> None:
        self._environment = {**os.environ, **environment}
        self._log = (folder / "dask.log").open("w")
        file = folder / "scheduler.json"
        self.scheduler = self._start(
            *("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"),
            *("--scheduler-file", file),
        )
        self.address = self._address(file)
        worker = ("worker", self.address, "--host", "127.0.0.1", "--nthreads", "1", "--no-nanny")
        self.workers = [self._start(*worker, "--no-dashboard") for _ in range(worker_count)]

    def _start(self, *command: str | Path) -> subprocess.Popen:
        return subprocess.Popen(
            [DASK, *command], stdout=self._log, stderr=self._log, env=self._environment
        )

    def _address(self, file: Path) -> str:
        deadline_s = time.monotonic() + START_TIMEOUT_S
        while time.monotonic() < deadline_s:
            with contextlib.suppress(OSError, json.JSONDecodeError):
                return json.loads(file.read_text())["address"]
            time.sleep(0.05)
        raise AssertionError("the scheduler does not start")

    def wait_for_workers(self) -> None:
        from distributed import Client

        if not self.workers:
            return
        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(len(self.workers), timeout=START_TIMEOUT_S)

    def end(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()
        self._log.close()


@contextlib.contextmanager
def running_cluster(folder: Path, worker_count: int, **environment: str) -> Iterator[Cluster]:
    cluster = Cluster(folder, worker_count, **environment)
    try:
        cluster.wait_for_workers()
        yield cluster
    finally:
        cluster.end()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    with running_cluster(tmp_path_factory.mktemp("cluster"), 2) as running:
        yield running


def nothing(_: int) -> None:
    """Progress that nobody looks at."""


def faults_of(where: Workers, progress=nothing) -> list:
    scenario = replace(SCENARIO, duration_s=4.0, faults=SCENARIO.faults[:12])
    return campaign(scenario, 2, 7, CONFIG, where, progress)


@functools.cache
def local_faults() -> list:
    return faults_of(Workers(1))


def test_the_same_walks_on_a_cluster(cluster):
    on_cluster = evaluate(3, 3, CONFIG, Workers(1, cluster.address), nothing)
    assert repr(on_cluster) == repr(evaluate(3, 3, CONFIG, Workers(1), nothing))


def test_the_same_faults_on_a_cluster(cluster):
    seen = []
    assert faults_of(Workers(1, cluster.address), seen.append) == local_faults()
    assert seen == list(range(2, 26, 2))


def test_a_lost_worker_costs_only_time(tmp_path):
    with running_cluster(tmp_path, 2) as cluster:
        left = []

        def progress(done: int) -> None:
            if not left:
                cluster.workers[0].kill()
            left.append(24 - done)

        assert faults_of(Workers(1, cluster.address), progress) == local_faults()
        assert left[0] > 0 and left[-1] == 0
        assert cluster.workers[0].wait() < 0 and cluster.workers[1].poll() is None


def test_a_lost_scheduler_is_an_error(tmp_path):
    with (
        running_cluster(tmp_path, 1) as cluster,
        pytest.raises(UserError, match=f"{cluster.address}: the connection was lost"),
    ):
        faults_of(Workers(1, cluster.address), lambda _: cluster.scheduler.kill())


def test_a_task_that_kills_its_worker_is_an_error(tmp_path):
    with (
        running_cluster(tmp_path, 2, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0") as cluster,
        pytest.raises(UserError, match=f"{cluster.address}: workers die on a task"),
    ):
        run_tasks(os._exit, [(1,)], Workers(1, cluster.address), nothing)


def test_a_process_that_is_killed_is_an_error():
    with pytest.raises(UserError, match="a worker process was killed"):
        run_tasks(os._exit, [(1,)], Workers(1), nothing)


def test_a_worker_with_another_saddlewalk_is_rejected(cluster, monkeypatch):
    here = workers.identity()
    monkeypatch.setattr(workers, "identity", lambda: "0.0.9 (sources 01234567)")
    with pytest.raises(UserError) as raised:
        faults_of(Workers(1, cluster.address))
    assert f"has saddlewalk {here}, this is 0.0.9 (sources 01234567)" in str(raised.value)
    assert "check out the same commit" in str(raised.value)


def test_an_error_of_the_work_names_the_worker(cluster):
    with pytest.raises(UserError, match=r"worker tcp://127\.0\.0\.1:\d+: .*no/such/file"):
        run_tasks(read_scenario, [(Path("no/such/file"),)], Workers(1, cluster.address), nothing)


@pytest.fixture
def no_saddlewalk(tmp_path):
    """A folder that hides the package from a Python with it in its path."""
    hidden = tmp_path / "hidden/saddlewalk"
    hidden.mkdir(parents=True)
    (hidden / "__init__.py").write_text("raise ImportError('hidden')\n")
    return str(hidden.parent)


def test_a_cluster_without_saddlewalk_is_rejected(no_saddlewalk, tmp_path):
    with (
        running_cluster(tmp_path, 1, PYTHONPATH=no_saddlewalk) as cluster,
        pytest.raises(UserError, match=r"worker tcp:.*\d has no saddlewalk: it needs \d+\.\d+"),
    ):
        faults_of(Workers(1, cluster.address))


def error_of(capsys, address: str) -> str:
    assert main(["faults", "--runs", "1", "--scheduler", address]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1
    return captured.err


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense", "udp://127.0.0.1:8786"])
def test_an_unreachable_scheduler_is_one_line(address, monkeypatch, capsys):
    monkeypatch.setattr(workers, "CONNECT_TIMEOUT_S", 1)
    assert f"--scheduler {address}: no dask scheduler answers there" in error_of(capsys, address)


def test_a_scheduler_without_workers_is_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(workers, "CONNECT_TIMEOUT_S", 1)
    with running_cluster(tmp_path, 0) as cluster:
        assert f"start some with `dask worker {cluster.address}`" in error_of(
            capsys, cluster.address
        )


def test_the_missing_extra_is_one_line(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert ".venv/bin/pip install -e '.[cluster]'" in error_of(capsys, "tcp://127.0.0.1:9")
