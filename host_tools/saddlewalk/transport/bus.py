"""CAN for the host tools: SocketCAN where the kernel has it, else UDP multicast on loopback.

The datagrams are those of python-can's `udp_multicast`, so its tools understand them; unlike it,
this bus stays on the loopback interface, with hop limit 0, and so needs no route and no root;
`@INTERFACE` after the port makes it leave this machine. A node does not receive its own frames.
Invalid datagrams are counted, not raised. python-can's own programs find it as `can_logger -i
saddlewalk_udp`.
"""

import errno
import fcntl
import ipaddress
import select
import socket
import struct
import time
from typing import Any

import can
from can.interfaces.socketcan import SocketcanBus
from can.interfaces.udp_multicast.utils import pack_message, unpack_message

from saddlewalk.errors import UserError

DEFAULT_GROUP = "239.74.163.2"
DEFAULT_PORT = 43113
SOCKETCAN_CHANNEL = "vcan0"

_LOOPBACK = "lo"
_DATAGRAM_MAX = 65535
_RECEIVE_BUFFER = 1 << 20
_SIOCGIFFLAGS, _SIOCGIFADDR, _IFF_UP = 0x8913, 0x8915, 0x1
_IP_MULTICAST_ALL = 49  # which Python's socket does not name


class LoopbackUdpBus(can.BusABC):
    """CAN frames as UDP multicast datagrams on the loopback interface.

    channel is "GROUP:PORT" or "GROUP:PORT@INTERFACE". `malformed` counts datagrams that are not a
    frame.
    """

    def __init__(self, channel: str = f"{DEFAULT_GROUP}:{DEFAULT_PORT}", **kwargs: Any) -> None:
        group, _, interface = str(channel).partition("@")
        interface = interface or _LOOPBACK
        self._address = _address(group)
        self.malformed = 0
        reach = "on loopback" if interface == _LOOPBACK else f"on {interface}: leaves this machine"
        self.channel_info = f"UDP {group} {reach}"
        try:
            place = _interface(interface)
            self._receiving = _receiving_socket(self._address, place)
            self._sending = _sending_socket(place, hops=int(interface != _LOOPBACK))
        except OSError as error:
            raise UserError(
                f"CAN: UDP {group} on {interface} cannot be opened ({error.strerror}): "
                f"{_remedy(error, interface)}"
            ) from error
        self._own_address = self._sending.getsockname()
        super().__init__(channel, **kwargs)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Never blocks. Raises can.CanOperationError if the socket has no room."""
        try:
            self._sending.sendto(pack_message(msg), self._address)
        except OSError as error:
            raise can.CanOperationError(f"{self.channel_info}: {error.strerror}") from error

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            left = None if deadline is None else max(0.0, deadline - time.monotonic())
            if not select.select([self._receiving], [], [], left)[0]:
                return None, False
            message = self._frame()
            if message is not None:
                return message, False

    def _frame(self) -> can.Message | None:
        datagram, source = self._receiving.recvfrom(_DATAGRAM_MAX)
        if source == self._own_address:
            return None
        try:
            return unpack_message(datagram, replace={"timestamp": time.time()}, check=True)
        except Exception:  # msgpack and python-can raise exceptions of many types
            self.malformed += 1
            return None

    def fileno(self) -> int:
        return self._receiving.fileno()

    def shutdown(self) -> None:
        super().shutdown()
        self._receiving.close()
        self._sending.close()


def _address(channel: str) -> tuple[str, int]:
    group, _, port = channel.partition(":")
    try:
        valid = ipaddress.IPv4Address(group).is_multicast
        number = int(port)
    except ValueError:
        valid, number = False, 0
    if not valid or not 0 < number < 65536:
        raise UserError(
            f"CAN over UDP: {channel} is not GROUP:PORT, such as {DEFAULT_GROUP}:{DEFAULT_PORT}"
        )
    return group, number


def _remedy(error: OSError, interface: str) -> str:
    if error.errno in (errno.EADDRINUSE, errno.EACCES):
        return "give another --can udp:GROUP:PORT"
    what = "loopback" if interface == _LOOPBACK else "the interface"
    return f"{what} must be up, `sudo ip link set {interface} up`"


def _interface(name: str) -> tuple[str, int]:
    """Its address and its index. Raises OSError if it has none."""
    request = struct.pack("16sH22x", name.encode()[:15], socket.AF_INET)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        answer = fcntl.ioctl(probe, _SIOCGIFADDR, request)
    return socket.inet_ntoa(answer[20:24]), socket.if_nametoindex(name)


def _membership(group: str, interface: tuple[str, int]) -> bytes:
    """The kernel's `struct ip_mreqn`."""
    address, index = interface
    return struct.pack("4s4si", socket.inet_aton(group), socket.inet_aton(address), index)


def _receiving_socket(address: tuple[str, int], interface: tuple[str, int]) -> socket.socket:
    """Bound to the group: a socket bound to any address also receives the port's other groups.

    And received on that interface only: by default a group that any process joined on another
    interface is received from there too.
    """
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    udp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER)
    udp.bind(address)
    udp.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)
    membership = _membership(address[0], interface)
    udp.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
    return udp


def _sending_socket(interface: tuple[str, int], hops: int) -> socket.socket:
    """Its own port identifies this node's frames."""
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.setblocking(False)
    udp.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, hops)
    leaving = _membership("0.0.0.0", interface)
    udp.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, leaving)
    udp.bind((interface[0], 0))
    return udp


def _socketcan_is_up(channel: str) -> bool:
    """Asks the kernel: /sys may show the interfaces of another network namespace."""
    request = struct.pack("16sh22x", channel.encode(), 0)
    try:
        with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as probe:
            answer = fcntl.ioctl(probe, _SIOCGIFFLAGS, request)
    except (AttributeError, OSError):
        return False
    return bool(struct.unpack("16sh22x", answer)[1] & _IFF_UP)


def _open_socketcan(channel: str) -> can.BusABC:
    """Takes CAN FD frames too, so that they can be counted."""
    if not _socketcan_is_up(channel):
        raise UserError(
            f"CAN interface {channel} is not there or not up, or this kernel has no CAN:"
            " give another, or --can udp"
        )
    try:
        bus = can.Bus(interface="socketcan", channel=channel, fd=True)
    except (OSError, can.CanError) as error:
        raise UserError(f"CAN interface {channel} cannot be opened ({error}): try udp") from error
    assert isinstance(bus, SocketcanBus)
    bus.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER)
    return bus


def open_bus(spec: str = "auto") -> can.BusABC:
    """A bus that does not hear its own frames. spec is one of

    `auto`: SocketCAN vcan0 if it is up, else `udp`; `socketcan:INTERFACE`; `udp`;
    `udp:GROUP:PORT`; `udp:GROUP:PORT@INTERFACE`, which leaves this machine. Raises UserError for
    another spec or an interface that cannot be opened.
    """
    kind, _, rest = spec.partition(":")
    if spec == "auto" and _socketcan_is_up(SOCKETCAN_CHANNEL):
        return _open_socketcan(SOCKETCAN_CHANNEL)
    if spec in ("auto", "udp"):
        return LoopbackUdpBus()
    if kind == "socketcan" and rest:
        return _open_socketcan(rest)
    if kind == "udp" and rest:
        return LoopbackUdpBus(rest)
    raise UserError(f"CAN {spec} is not auto, socketcan:INTERFACE, udp or udp:GROUP:PORT")


def private_udp() -> str:
    """The spec of a UDP bus on an unused port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        return f"udp:{DEFAULT_GROUP}:{probe.getsockname()[1]}"


def describe(bus: can.BusABC) -> str:
    """Kind and channel of a bus, as text."""
    return str(bus.channel_info)
