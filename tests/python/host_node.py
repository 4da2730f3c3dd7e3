"""The host process on a CAN bus, seen from a node of ours on the same bus."""

import itertools
import os
import signal
import subprocess
import time

import can
import pytest

from saddlewalk import paths
from saddlewalk.errors import UserError
from saddlewalk.transport.bus import open_bus, private_udp
from saddlewalk.transport.lcmbus import open_lcm
from saddlewalk.transport.wire import TIMES, Receiver, Sender

WAIT_S = 5.0  # for what must come
SILENCE_S = 0.1  # for what must not
TICK_S = 0.08
MESSAGES_PER_TICK = 31
# For tests that command once and are about something else.
COMMAND_HOLDS = "--set=command_max_age_s=3600"
# A walk that comes to its speed within half a second.
QUICK = ("--set=shift_time_s=0.1", "--set=acceleration_m_s2=5")

WALK = {"MODE": 1, "SPEED": 1.2, "HEEL_STRIKE": 0.1745}
STANDING = {
    "MEASURED_COM": {"HEIGHT": 1.0, "VX": 0.0, "VY": 0.0},
    "MEASURED_LEFT": {"CONTACT": 1, "X": 0.0, "Y": 0.11},
    "MEASURED_RIGHT": {"CONTACT": 1, "X": 0.0, "Y": -0.11},
}


class Host:
    """A running host process and a node of ours, on a bus of their own unless one is given."""

    def __init__(
        self, *options: str, spec: str | None = None, stderr: int = subprocess.PIPE
    ) -> None:
        self.spec = spec or private_udp()
        command = [paths.built("bin/saddlewalk-host"), "--can", self.spec, *options]
        leaks = os.environ | {"ASAN_OPTIONS": "detect_leaks=1"}  # for a sanitized build
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=stderr, text=True, env=leaks
        )
        self.first_line = self.process.stdout.readline()
        assert self.process.stdout.readline() == "ready\n"
        self.bus = open_bus(self.spec)
        self.sender, self.receiver = Sender(), Receiver()
        self.flicker_m = 0.0

    def __enter__(self) -> "Host":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()
        self.bus.shutdown()

    def send(self, name: str, **values: float) -> can.Message:
        frame = self.sender.frame(name, **values)
        self.bus.send(frame)
        return frame

    def measure(self, measurement=STANDING) -> None:
        """The CoM's height flickers by 1 mm: sensors that never change are frozen."""
        self.flicker_m = 0.001 - self.flicker_m
        self.send("MEASURED_TIME", TIME=time.monotonic_ns() // 1000 % TIMES, CODE=0)
        for name, values in measurement.items():
            if "HEIGHT" in values:
                values = values | {"HEIGHT": values["HEIGHT"] + self.flicker_m}
            self.send(name, **values)

    def tick_frames(self, timeout_s: float = WAIT_S) -> list[can.Message]:
        """The frames up to the next HEALTH; fewer if it does not come in time."""
        frames = []
        deadline_s = time.monotonic() + timeout_s
        while (frame := self.bus.recv(max(0.0, deadline_s - time.monotonic()))) is not None:
            frames.append(frame)
            if frame.arbitration_id == 0x140:
                break
        return frames

    def tick(self) -> dict[str, dict[str, float]]:
        """The messages of the next tick by name."""
        return dict(self.receiver.accept(frame) for frame in self.tick_frames())

    def stop(self, by: signal.Signals = signal.SIGTERM, announced: tuple[str, ...] = ()) -> str:
        """End the process cleanly; returns its summary line.

        announced: how each announced line begins, in any order.
        """
        self.process.send_signal(by)
        output, errors = self.process.communicate(timeout=WAIT_S)
        assert self.process.returncode == 0, errors
        lines = sorted(errors.splitlines())
        for line, begin in itertools.zip_longest(lines, sorted(announced)):
            assert line and begin and line.startswith(f"saddlewalk-host: {begin}"), errors
        assert output.count("\n") == 1
        return output


def lockstep(*options: str, spec: str | None = None) -> Host:
    """Options with which a command holds until the next one."""
    return Host("--lcm=none", "--clock=lockstep", COMMAND_HOLDS, *options, spec=spec)


class LcmNode:
    """A second LCM process: received messages by channel."""

    def __init__(self, url: str) -> None:
        self.lcm = open_lcm(url)
        self.latest = {}
        channels = "SADDLEWALK_(INPUT|TURN|PLAN|SCORES|VERDICT|BALANCE|BOS|WAY|STATUS|HEALTH)"
        self.lcm.subscribe(channels, self._take).set_queue_capacity(1000)

    def _take(self, channel: str, data: bytes) -> None:
        from saddlewalk.transport import lcm_types

        self.latest[channel] = getattr(lcm_types, f"{channel[11:].lower()}_t").decode(data)

    def take(self, timeout_s: float = WAIT_S) -> dict:
        """What came by the next SADDLEWALK_HEALTH, which is the last of a tick."""
        self.latest = {}
        deadline_s = time.monotonic() + timeout_s
        while "SADDLEWALK_HEALTH" not in self.latest and time.monotonic() < deadline_s:
            self.lcm.handle_timeout(50)
        return self.latest

    def command(self, mode: int, speed_m_s: float) -> None:
        from saddlewalk.transport.lcm_types import command_t

        message = command_t()
        message.mode, message.speed_m_s = mode, speed_m_s
        self.lcm.publish("SADDLEWALK_COMMAND", message.encode())

    def turn(self, speed_m_s: float, turn_rate_rad_s: float) -> None:
        from saddlewalk.transport.lcm_types import command_turn_t

        message = command_turn_t()
        message.mode, message.speed_m_s = message.MODE_WALK, speed_m_s
        message.turn_rate_rad_s = turn_rate_rad_s
        self.lcm.publish("SADDLEWALK_COMMAND_TURN", message.encode())


def own_lcm() -> str:
    """An LCM URL that no other test uses. Skips where LCM cannot run."""
    url = f"udpm://239.255.76.67:{private_udp().rpartition(':')[2]}?ttl=0"
    try:
        open_lcm(url)
    except UserError as error:
        pytest.skip(str(error))
    return url
