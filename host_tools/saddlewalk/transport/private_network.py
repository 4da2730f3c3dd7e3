"""LCM needs a multicast route. Where the machine has none, a network of its own can be given one.

`python -m saddlewalk.transport.private_network PROGRAM...`, run inside a new network namespace,
brings up the loopback interface there, routes multicast to it and becomes PROGRAM. It speaks to the
kernel itself, for minimal systems have no `ip`.
"""

import fcntl
import os
import socket
import struct
import subprocess
import sys

_NAMESPACE = ("unshare", "--user", "--map-root-user", "--net")
_INSIDE = "SADDLEWALK_PRIVATE_NETWORK"
_SIOCADDRT, SIOCDELRT, _SIOCGIFFLAGS, _SIOCSIFFLAGS = 0x890B, 0x890C, 0x8913, 0x8914
_IFF_UP, _RTF_UP = 0x1, 0x1
_MULTICAST, _MASK = "224.0.0.0", "240.0.0.0"


def possible() -> bool:
    """Whether this process may have a network of its own, and isn't in one already."""
    if inside():
        return False
    try:
        trial = subprocess.run([*_NAMESPACE, "true"], capture_output=True, check=False)
    except OSError:
        return False
    return trial.returncode == 0


def inside() -> bool:
    """Whether this process is in such a network."""
    return _INSIDE in os.environ


def enter() -> None:
    """Restart this program in a private network. Does not return."""
    os.environ[_INSIDE] = "1"
    again = [sys.executable, "-m", __name__, sys.executable, *sys.argv]
    os.execvp(_NAMESPACE[0], [*_NAMESPACE, *again])


def bring_up(control: socket.socket, interface: bytes = b"lo", up: bool = True) -> None:
    """Bring an interface up, or take it down with all its routes."""
    request = struct.pack("16sh22x", interface, 0)
    flags = struct.unpack("16sh22x", fcntl.ioctl(control, _SIOCGIFFLAGS, request))[1]
    flags = flags | _IFF_UP if up else flags & ~_IFF_UP
    fcntl.ioctl(control, _SIOCSIFFLAGS, struct.pack("16sh22x", interface, flags))


def route_multicast(control: socket.socket, request: int = _SIOCADDRT) -> None:
    """Add the route to loopback, or remove it with SIOCDELRT.

    The kernel's `struct rtentry`: destination, gateway, netmask, flags, device by name.
    """
    import ctypes

    def address(text: str) -> bytes:
        return struct.pack("=HH4s8x", socket.AF_INET, 0, socket.inet_aton(text))

    device = ctypes.create_string_buffer(b"lo")
    entry = struct.pack(
        "@L16s16s16sHhLPhPLLH",
        *(0, address(_MULTICAST), address("0.0.0.0"), address(_MASK)),
        *(_RTF_UP, 0, 0, 0, 0, ctypes.addressof(device), 0, 0, 0),
    )
    fcntl.ioctl(control, request, entry)


if __name__ == "__main__":
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as network:
        bring_up(network)
        route_multicast(network)
    os.execv(sys.argv[1], sys.argv[1:])
