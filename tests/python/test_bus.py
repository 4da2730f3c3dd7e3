"""CAN on every transport, for Python's nodes and the firmware, and LCM as the tools open it."""

import random
import socket
import subprocess
import sys
import time
from pathlib import Path

import can
import pytest

from host_node import MESSAGES_PER_TICK, STANDING, WALK, lockstep
from saddlewalk.errors import UserError
from saddlewalk.paths import built
from saddlewalk.transport.bus import DEFAULT_GROUP, LoopbackUdpBus, describe, open_bus, private_udp
from saddlewalk.transport.lcmbus import open_lcm
from saddlewalk.transport.wire import Receiver, Sender

pytestmark = pytest.mark.firmware

WAIT_S = 5.0  # for what must come
SILENCE_S = 0.05  # for what must not


@pytest.fixture
def nodes(spec):
    with open_bus(spec) as one, open_bus(spec) as other:
        yield one, other


def frame(identifier=0x123, data=b"\x01\x02\x03", **kind):
    return can.Message(arbitration_id=identifier, data=data, **{"is_extended_id": False, **kind})


def same(received: can.Message, sent: can.Message) -> bool:
    return received.equals(sent, timestamp_delta=None, check_channel=False, check_direction=False)


class TestBus:
    """Tests that every transport passes."""

    def test_a_frame_reaches_the_others_but_not_its_sender(self, nodes, spec):
        one, other = nodes
        with open_bus(spec) as third:
            before = time.time()
            one.send(frame())
            for node in (other, third):
                received = node.recv(WAIT_S)
                assert same(received, frame())
                assert before <= received.timestamp <= time.time()
            assert one.recv(SILENCE_S) is None

    def test_frames_keep_their_order(self, nodes):
        one, other = nodes
        for burst in range(20):
            identifiers = range(50 * burst, 50 * (burst + 1))
            for identifier in identifiers:
                one.send(frame(identifier))
            assert [other.recv(WAIT_S).arbitration_id for _ in identifiers] == list(identifiers)

    def test_frames_wait_for_a_node_that_is_busy(self, nodes):
        one, other = nodes
        identifiers = range(400)  # a second of a walk
        for identifier in identifiers:
            one.send(frame(identifier))
        assert [other.recv(WAIT_S).arbitration_id for _ in identifiers] == list(identifiers)

    @pytest.mark.parametrize(
        "sent",
        [
            frame(0),
            frame(0x7FF, bytes(range(8))),
            frame(data=b""),
            frame(0x1FFFFFFF, is_extended_id=True),
            frame(data=None, dlc=5, is_remote_frame=True),
        ],
        ids=["lowest", "highest", "empty", "extended", "remote"],
    )
    def test_each_kind_of_frame_is_received_as_sent(self, nodes, sent):
        one, other = nodes
        one.send(sent)
        assert same(other.recv(WAIT_S), sent)

    def test_a_node_receives_nothing_sent_before_it_opened(self, nodes, spec):
        one, _ = nodes
        one.send(frame())
        with open_bus(spec) as late:
            assert late.recv(SILENCE_S) is None

    def test_recv_times_out(self, nodes):
        start = time.monotonic()
        assert nodes[0].recv(SILENCE_S) is None
        assert nodes[0].recv(0) is None
        assert SILENCE_S <= time.monotonic() - start < WAIT_S

    def test_a_bus_describes_itself(self, nodes, spec):
        assert spec.partition(":")[2] in describe(nodes[0])

    def test_the_firmware_answers_each_set_of_measurements(self, spec):
        with lockstep(spec=spec) as host:
            assert spec.partition(":")[2] in host.first_line
            host.send("COMMAND", **WALK)
            for number in range(50):
                host.measure()
                tick = host.tick()
                assert len(tick) == MESSAGES_PER_TICK
                assert {message["COUNTER"] for message in tick.values()} == {number % 16}
            assert host.tick_frames(SILENCE_S) == []
            assert "50 ticks, 0 late, 0 missed; frames: 201 accepted, rejected 0 " in host.stop()

    def test_the_firmware_counts_foreign_frames(self, spec):
        with lockstep(spec=spec) as host:
            com, *feet = (host.sender.frame(name, **STANDING[name]) for name in STANDING)
            identifier, data = com.arbitration_id, com.data
            strangers = [
                frame(0x7FF, data),
                frame(identifier, data[:7]),
                frame(identifier, b""),
                frame(identifier, data, is_extended_id=True),
                frame(identifier, None, dlc=8, is_remote_frame=True),
            ]
            if takes_fd(spec):
                strangers += [
                    frame(identifier, data, is_fd=True),
                    frame(identifier, data, is_fd=True, bitrate_switch=True),
                    frame(identifier, bytes(data) * 8, is_fd=True),
                ]
            for message in (*feet, *strangers):
                host.bus.send(message)
            assert host.tick_frames(SILENCE_S) == []
            host.bus.send(com)
            assert host.tick()["HEALTH"]["REJECTED_FRAMES"] == len(strangers)
            assert f" 0 bad version, 0 bad code, {len(strangers)} malformed;" in host.stop()

    def test_the_tools_count_foreign_frames(self, nodes, spec):
        one, other = nodes
        receiver = Receiver()
        com = Sender().frame("MEASURED_COM", **STANDING["MEASURED_COM"])
        strangers = [frame(com.arbitration_id, com.data, is_extended_id=True)]
        if takes_fd(spec):
            strangers.append(frame(com.arbitration_id, com.data, is_fd=True))
        for message in (*strangers, com):
            one.send(message)
        assert [receiver.accept(other.recv(WAIT_S)) for _ in strangers] == [None] * len(strangers)
        assert receiver.accept(other.recv(WAIT_S))[0] == "MEASURED_COM"
        assert receiver.malformed == len(strangers)

    def test_the_firmware_gives_the_same_bits_as_on_another_bus(self, spec):
        assert lockstep_bytes(spec) == lockstep_bytes(private_udp())


def takes_fd(spec: str) -> bool:
    return spec != "socketcan:vcan0"


def lockstep_bytes(spec: str) -> list[tuple[int, bytes]]:
    """All that the firmware sends in a walk of 50 ticks."""
    sent = []
    with lockstep(spec=spec) as host:
        host.send("COMMAND", **WALK)
        for _ in range(50):
            host.measure()
            sent += [
                (message.arbitration_id, bytes(message.data)) for message in host.tick_frames()
            ]
    return sent


class TestUdp:
    """Tests of the loopback bus only."""

    @pytest.fixture
    def spec(self):
        return private_udp()

    def test_buses_on_other_ports_receive_nothing(self, nodes):
        one, _ = nodes
        with open_bus(private_udp()) as apart:
            one.send(frame())
            assert apart.recv(SILENCE_S) is None

    def test_junk_datagrams_are_counted_and_skipped(self, nodes, spec):
        one, other = nodes
        rng = random.Random(1)
        junk = [b"", b"\x81", b"\xdf\xff\xff\xff\xff", *(rng.randbytes(40) for _ in range(50))]
        for datagram in junk:
            send_datagram(spec, datagram)
        one.send(frame())
        assert other.recv(WAIT_S).arbitration_id == 0x123
        assert other.malformed == len(junk)

    def test_datagrams_never_leave_the_machine(self, nodes):
        sending = nodes[0]._sending
        assert sending.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL) == 0
        interface = sending.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, 4)
        assert interface == socket.inet_aton("127.0.0.1")

    def test_python_can_finds_the_bus_by_name(self, spec):
        with can.Bus(interface="saddlewalk_udp", channel=spec.removeprefix("udp:")) as bus:
            assert isinstance(bus, LoopbackUdpBus)
            assert describe(bus) == f"UDP {spec.removeprefix('udp:')} on loopback"

    def test_a_port_in_use_is_a_one_line_error(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as selfish:
            selfish.bind(("", 0))
            spec = f"udp:{DEFAULT_GROUP}:{selfish.getsockname()[1]}"
            taken = r"Address already in use.*give another --can"
            with pytest.raises(UserError, match=taken) as error:
                open_bus(spec)
        assert spec.removeprefix("udp:") in str(error.value)

    def test_loopback_that_is_down_is_a_one_line_error(self):
        unshare = ["unshare", "--user", "--map-root-user", "--net"]
        if subprocess.run([*unshare, "true"], capture_output=True, check=False).returncode != 0:
            pytest.skip("no user namespaces here")
        emulate = [Path(sys.executable).with_name("saddlewalk"), "emulate", "--lcm", "memq://"]
        host = [built("bin/saddlewalk-host"), "--lcm=none"]
        for command in (emulate, host):
            done = subprocess.run(
                [*unshare, *command],
                capture_output=True,
                text=True,
                check=False,
                timeout=WAIT_S * 5,
            )
            assert (done.returncode, done.stderr.count("\n")) == (2, 1)
            assert "sudo ip link set lo up" in done.stderr


def send_datagram(spec, datagram):
    """Send a datagram to the group, as any other program could."""
    _, group, port = spec.split(":")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        loopback = socket.inet_aton("127.0.0.1")
        stranger.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, loopback)
        stranger.sendto(datagram, (group, int(port)))


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


def test_lcm_that_cannot_be_opened_is_a_one_line_error(capfd):
    with pytest.raises(UserError, match="nowhere:"):
        open_lcm("nowhere:")
    assert capfd.readouterr().err == ""
