"""Tests that take a network away or need another machine: in a child process with a network of
its own.
"""

import contextlib
import ctypes
import fcntl
import functools
import os
import socket
import struct
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from saddlewalk.transport import private_network

_CLONE_NEWUSER, _CLONE_NEWNET = 0x10000000, 0x40000000
_SIOCSIFNAME = 0x8923
_NOT_POSSIBLE, _FAILED = 77, 1


def in_private_network(test: Callable[..., None]) -> Callable[..., None]:
    """The test runs where loopback is up and has the multicast route, and nothing else is."""

    @functools.wraps(test)
    def forked(**arguments: object) -> None:
        child = os.fork()
        if child == 0:
            os._exit(_run(functools.partial(test, **arguments)))
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if status == _NOT_POSSIBLE:
            pytest.skip("no network namespaces here, or no iproute2 to link two of them")
        assert status == 0, "see the traceback of the child process"

    return forked


def _run(test: Callable[[], None]) -> int:
    if not _unshare():
        return _NOT_POSSIBLE
    try:
        bring_up()
        test()
    except NotPossibleError:
        return _NOT_POSSIBLE
    except BaseException:
        traceback.print_exc()
        return _FAILED
    return 0


class NotPossibleError(Exception):
    """This machine does not have what a test needs."""


def _unshare() -> bool:
    """A network of its own, as its root."""
    uid, gid = os.geteuid(), os.getegid()
    namespaces = _CLONE_NEWNET if uid == 0 else _CLONE_NEWNET | _CLONE_NEWUSER
    if ctypes.CDLL(None).unshare(namespaces) != 0:
        return False
    if uid != 0:
        Path("/proc/self/setgroups").write_text("deny")
        Path("/proc/self/uid_map").write_text(f"0 {uid} 1")
        Path("/proc/self/gid_map").write_text(f"0 {gid} 1")
    return True


HERE, THERE = "10.91.7.1", "10.91.7.2"  # this machine's address and the neighbour's


class Neighbour:
    """Another machine on a network to which both route by default, as an ordinary host does."""

    def __init__(self, pid: int) -> None:
        self._enter = ["nsenter", f"--net=/proc/{pid}/ns/net"]
        self.ip("addr", "add", f"{THERE}/24", "dev", "there")
        self.ip("link", "set", "there", "up")
        self.ip("route", "add", "default", "dev", "there")
        while "state UP" not in self.ip("-oneline", "link", "show", "there"):
            time.sleep(0.01)  # the kernel drops what is sent before

    def ip(self, *words: str) -> str:
        command = [*self._enter, "ip", *words]
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout

    def python(self, script: str) -> None:
        """Run a script there, which may import these tests' modules."""
        tests = Path(__file__).parent
        subprocess.run([*self._enter, sys.executable, "-c", script], check=True, cwd=tests)


@contextlib.contextmanager
def neighbour() -> Iterator[Neighbour]:
    """In a test that is in_private_network: link it with another network."""
    other = _start(["unshare", "--net", "sleep", "600"])
    theirs = Path(f"/proc/{other.pid}/ns/net")
    try:
        while theirs.readlink() == Path("/proc/self/ns/net").readlink():
            time.sleep(0.01)
        _link(other.pid)
        yield Neighbour(other.pid)
    finally:
        other.kill()
        other.wait()


def _start(program: list[str]) -> subprocess.Popen:
    try:
        return subprocess.Popen(program, stderr=subprocess.PIPE)
    except OSError as error:
        raise NotPossibleError from error


def _link(pid: int) -> None:
    for words in (
        f"link add here type veth peer name there netns {pid}",
        f"addr add {HERE}/24 dev here",
        "link set here up",
        "route add default dev here",
    ):
        ip = _start(["ip", *words.split()])
        if ip.wait() != 0:
            raise NotPossibleError(ip.stderr.read().decode())
    unroute()


def bring_up(loopback: str = "lo") -> None:
    """Loopback, and the multicast route to it unless it has another name."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        private_network.bring_up(control, loopback.encode())
        if loopback == "lo":
            private_network.route_multicast(control)


def take_down() -> None:
    """Loopback, and with it every route."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        private_network.bring_up(control, up=False)


def rename_loopback(name: str) -> None:
    """Rename loopback, which must be down."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        fcntl.ioctl(control, _SIOCSIFNAME, struct.pack("16s16s8x", b"lo", name.encode()))


def unroute() -> None:
    """Take the multicast route away."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        private_network.route_multicast(control, private_network.SIOCDELRT)


def route() -> None:
    """Restore the multicast route."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        private_network.route_multicast(control)
