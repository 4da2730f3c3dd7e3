import os
import signal
from pathlib import Path

import pytest

from saddlewalk.transport.bus import private_udp

# A job in the background of a script ignores Ctrl-C, and so would each process that a test starts.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_runtest_setup(item):
    """tools/vcan/up sets SADDLEWALK_VCAN: vcan0 and vcan1 exist for the tests only."""
    if item.get_closest_marker("socketcan") and "SADDLEWALK_VCAN" not in os.environ:
        pytest.skip("SocketCAN on vcan0 and vcan1: make test-socketcan")
    if item.get_closest_marker("flood") and "flood" not in item.config.option.markexpr:
        pytest.skip("a flood of a minute: make test-flood")
    if item.get_closest_marker("memory") and "memory" not in item.config.option.markexpr:
        pytest.skip("ten minutes of a page: make test-memory")
    if item.get_closest_marker("targets") and "targets" not in item.config.option.markexpr:
        pytest.skip("a controller in QEMU: make test-targets")


SOCKETCAN = [
    pytest.param(f"socketcan:{name}", marks=pytest.mark.socketcan, id=name)
    for name in ("vcan0", "vcan1")
]


@pytest.fixture(params=["udp", *SOCKETCAN])
def spec(request) -> str:
    """A bus that no other test uses now, of each transport: vcan0 is classic, vcan1 CAN FD."""
    return private_udp() if request.param == "udp" else request.param


@pytest.fixture(scope="session")
def walk(tmp_path_factory) -> Path:
    """The folder of a demo in lockstep, with its logs. Not to be changed."""
    from host_node import own_lcm
    from saddlewalk.cli import main

    folder = tmp_path_factory.mktemp("walk")
    options = ["--can", private_udp(), "--lcm", own_lcm(), "--clock", "lockstep"]
    options += ["--out", str(folder), "--speed", "1.2", "--duration", "13", "--push", "8@12:90"]
    assert main(["demo", *options]) == 0
    return folder
