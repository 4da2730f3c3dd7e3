"""Who can command the host process: this machine, and by LCM others only with an option."""

import socket
import struct
import time
from pathlib import Path

import pytest

from host_node import COMMAND_HOLDS, SILENCE_S, Host, LcmNode
from private_test_network import HERE, THERE, in_private_network, neighbour

pytestmark = pytest.mark.firmware

COMMANDS = 20
URL = "udpm://239.255.76.67:7667?ttl=0"
FOREIGN_URL = "udpm://239.255.76.67:7667?ttl=1"
SEND = f"""
import time
from host_node import LcmNode
node = LcmNode("{FOREIGN_URL}")
for _ in range({COMMANDS}):
    node.command(1, 1.2)
    time.sleep(0.01)
"""
REJECTED = f"command by LCM from {THERE} rejected: "


def status_after(node: LcmNode, commands: int):
    """The status once so many commands have come, whatever became of them."""
    for _ in range(40):
        status = node.take()["SADDLEWALK_STATUS"]
        counts = status.commands_obeyed, status.commands_foreign, status.commands_ignored
        if sum(counts) >= commands:
            return status
    raise AssertionError(f"{counts} of {commands} commands have come")


@in_private_network
def test_another_machine_cannot_command_by_lcm():
    with neighbour() as other, Host("--lcm", URL, COMMAND_HOLDS) as host:
        assert (
            "; commands: any program on this machine (CAN over UDP, LCM); --command-key FILE to "
            "authenticate\n" in host.first_line
        )
        node = LcmNode(URL)
        other.python(SEND)
        status = status_after(node, COMMANDS)
        assert (status.commands_obeyed, status.commands_foreign) == (0, COMMANDS)
        heard = node.take()
        assert heard["SADDLEWALK_HEALTH"].commands_rejected == COMMANDS
        on_can = (host.tick()["HEALTH"]["REJECTED_FRAMES"] for _ in range(100))
        assert COMMANDS in on_can
        assert heard["SADDLEWALK_INPUT"].command_age_us == -1
        assert heard["SADDLEWALK_PLAN"].mode == 0
        node.command(1, 0.8)  # nor does it keep this machine from commanding
        assert status_after(node, COMMANDS + 1).commands_obeyed == 1
        assert f" {COMMANDS} from other machines;" in host.stop(announced=(REJECTED,))


@in_private_network
def test_another_machine_commands_by_lcm_if_an_option_allows_it():
    with neighbour() as other, Host("--lcm", URL, "--lcm-from-network", COMMAND_HOLDS) as host:
        assert "this machine (CAN over UDP), anyone on the network (LCM)" in host.first_line
        node = LcmNode(URL)
        other.python(SEND)
        status = status_after(node, COMMANDS)
        assert (status.commands_obeyed, status.commands_foreign) == (COMMANDS, 0)
        host.stop()


def udp_datagram(source: str, payload: bytes) -> bytes:
    """An IPv4 packet to the group; the kernel fills in length and checksum of its header."""
    udp = struct.pack(">HHHH", 7667, 7667, 8 + len(payload), 0) + payload
    addresses = socket.inet_aton(source) + socket.inet_aton("239.255.76.67")
    return struct.pack(">BBHHHBBH", 0x45, 0, 0, 0, 0, 1, 17, 0) + addresses + udp


def forge(source: str) -> None:
    """Commands with a source address that the sender chooses."""
    from saddlewalk.transport.lcm_types import command_t

    message = command_t()
    message.mode, message.speed_m_s = 1, 1.2
    payload = b"LC02" + bytes(4) + b"SADDLEWALK_COMMAND\0" + message.encode()
    with socket.socket(socket.AF_INET, socket.SOCK_RAW, socket.IPPROTO_RAW) as raw:
        for _ in range(COMMANDS):
            raw.sendto(udp_datagram(source, payload), ("239.255.76.67", 7667))
            time.sleep(0.01)


@in_private_network
@pytest.mark.parametrize("source", [HERE, "127.0.0.1"])
def test_a_forged_source_address_does_not_help(source):
    """Even where the kernel is set to accept packets with this machine's own source address."""
    with neighbour() as other, Host("--lcm", URL, COMMAND_HOLDS) as host:
        for conf in ("all", "here"):
            for name, value in (("accept_local", 1), ("rp_filter", 0), ("route_localnet", 1)):
                Path(f"/proc/sys/net/ipv4/conf/{conf}/{name}").write_text(str(value))
        node = LcmNode(URL)
        other.python(f"from test_who_commands import forge; forge({source!r})")
        status = status_after(node, COMMANDS)
        assert (status.commands_obeyed, status.commands_foreign) == (0, COMMANDS)
        host.stop(announced=(f"command by LCM from {source} rejected: ",))


@in_private_network
def test_this_machine_commands_whatever_the_multicast_route():
    """By the default route or by loopback, and when that changes while the process runs."""
    from private_test_network import route

    with neighbour(), Host("--lcm", URL, COMMAND_HOLDS) as host:
        node = LcmNode(URL)
        node.command(0, 0.0)
        assert status_after(node, 1).commands_obeyed == 1
        route()
        node = LcmNode(URL)
        node.command(0, 0.0)
        assert status_after(node, 2).commands_obeyed == 2
        assert node.take(SILENCE_S) is not None
        host.stop()
