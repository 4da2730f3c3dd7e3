"""The loopback CAN bus and LCM as the host tools open them."""

import random
import socket
import subprocess
import sys
import time
from pathlib import Path

import can
import pytest

from saddlewalk.bus import DEFAULT_GROUP, LoopbackUdpBus, describe, open_bus, private_udp
from saddlewalk.errors import UserError
from saddlewalk.lcmbus import open_lcm
from saddlewalk.paths import built

WAIT_S = 2.0  # for what must come
SILENCE_S = 0.05  # for what must not


@pytest.fixture
def spec():
    return private_udp()


@pytest.fixture
def nodes(spec):
    with open_bus(spec) as one, open_bus(spec) as other:
        yield one, other


def frame(identifier=0x123, data=b"\x01\x02\x03"):
    return can.Message(arbitration_id=identifier, is_extended_id=False, data=data)


def send_datagram(spec, datagram):
    """As a stranger on the same group would."""
    _, group, port = spec.split(":")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        loopback = socket.inet_aton("127.0.0.1")
        stranger.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, loopback)
        stranger.sendto(datagram, (group, int(port)))


def test_a_frame_reaches_the_others_but_not_its_sender(nodes):
    one, other = nodes
    before = time.time()
    one.send(frame())
    received = other.recv(WAIT_S)
    assert received.equals(frame(), timestamp_delta=None, check_channel=False)
    assert before <= received.timestamp <= time.time()
    assert one.recv(SILENCE_S) is None


def test_frames_keep_their_order(nodes):
    one, other = nodes
    for identifier in range(1000):
        one.send(frame(identifier))
    assert [other.recv(WAIT_S).arbitration_id for _ in range(1000)] == list(range(1000))


def test_buses_on_other_ports_do_not_hear(nodes):
    one, _ = nodes
    with open_bus(private_udp()) as apart:
        one.send(frame())
        assert apart.recv(SILENCE_S) is None


def test_junk_is_counted_and_does_not_hide_what_follows(nodes, spec):
    one, other = nodes
    rng = random.Random(1)
    junk = [b"", b"\x81", b"\xdf\xff\xff\xff\xff", *(rng.randbytes(40) for _ in range(50))]
    for datagram in junk:
        send_datagram(spec, datagram)
    one.send(frame())
    assert other.recv(WAIT_S).arbitration_id == 0x123
    assert other.malformed == len(junk)


def test_nothing_comes_in_time(nodes):
    start = time.monotonic()
    assert nodes[0].recv(SILENCE_S) is None
    assert nodes[0].recv(0) is None
    assert SILENCE_S <= time.monotonic() - start < WAIT_S


def test_datagrams_never_leave_the_machine(nodes):
    sending = nodes[0]._sending
    assert sending.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL) == 0
    interface = sending.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, 4)
    assert interface == socket.inet_aton("127.0.0.1")


def test_python_can_finds_the_bus_by_name(spec):
    with can.Bus(interface="saddlewalk_udp", channel=spec.removeprefix("udp:")) as bus:
        assert isinstance(bus, LoopbackUdpBus)
        assert describe(bus) == f"UDP {spec.removeprefix('udp:')} on loopback"


@pytest.mark.parametrize(
    "spec",
    [
        "",
        "vcan0",
        "udp:",
        "socketcan:",
        f"udp:{DEFAULT_GROUP}",
        f"udp:{DEFAULT_GROUP}:0",
        f"udp:{DEFAULT_GROUP}:65536",
        "udp:127.0.0.1:5000",
        "udp:nowhere:5000",
        "socketcan:no_such_can",
    ],
)
def test_a_wrong_spec_is_named(spec):
    with pytest.raises(UserError) as error:
        open_bus(spec)
    assert spec.partition(":")[2] in str(error.value)
    assert "\n" not in str(error.value)


def test_a_port_that_is_taken_is_one_line():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as selfish:
        selfish.bind(("", 0))
        spec = f"udp:{DEFAULT_GROUP}:{selfish.getsockname()[1]}"
        with pytest.raises(UserError, match=r"Address already in use.*give another --can") as error:
            open_bus(spec)
    assert spec.removeprefix("udp:") in str(error.value)


def test_loopback_that_is_down_is_one_line():
    unshare = ["unshare", "--user", "--map-root-user", "--net"]
    if subprocess.run([*unshare, "true"], capture_output=True, check=False).returncode != 0:
        pytest.skip("no user namespaces here")
    emulate = [Path(sys.executable).with_name("saddlewalk"), "emulate", "--lcm", "memq://"]
    host = [built("bin/saddlewalk-host"), "--lcm=none"]
    for command in (emulate, host):
        done = subprocess.run(
            [*unshare, *command], capture_output=True, text=True, check=False, timeout=WAIT_S * 5
        )
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert "sudo ip link set lo up" in done.stderr


def test_lcm_that_cannot_be_opened_is_one_line(capfd):
    with pytest.raises(UserError, match="nowhere:"):
        open_lcm("nowhere:")
    assert capfd.readouterr().err == ""
