"""Tests that take a network away: in a child process with a network of its own."""

import ctypes
import fcntl
import functools
import os
import socket
import struct
import traceback
from collections.abc import Callable

import pytest

from saddlewalk.transport import private_network

_CLONE_NEWUSER, _CLONE_NEWNET = 0x10000000, 0x40000000
_SIOCSIFNAME = 0x8923
_NOT_POSSIBLE, _FAILED = 77, 1


def in_private_network(test: Callable[[], None]) -> Callable[[], None]:
    """The test runs where loopback is up and has the multicast route, and nothing else is."""

    @functools.wraps(test)
    def forked() -> None:
        child = os.fork()
        if child == 0:
            os._exit(_run(test))
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if status == _NOT_POSSIBLE:
            pytest.skip("no network namespaces here")
        assert status == 0, "see the traceback of the child process"

    return forked


def _run(test: Callable[[], None]) -> int:
    namespaces = _CLONE_NEWNET if os.geteuid() == 0 else _CLONE_NEWNET | _CLONE_NEWUSER
    if ctypes.CDLL(None).unshare(namespaces) != 0:
        return _NOT_POSSIBLE
    try:
        bring_up()
        test()
    except BaseException:
        traceback.print_exc()
        return _FAILED
    return 0


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
    """While it is down."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        fcntl.ioctl(control, _SIOCSIFNAME, struct.pack("16s16s8x", b"lo", name.encode()))


def unroute() -> None:
    """Take the multicast route away."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        private_network.route_multicast(control, private_network.SIOCDELRT)


def route() -> None:
    """And give it back."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        private_network.route_multicast(control)
