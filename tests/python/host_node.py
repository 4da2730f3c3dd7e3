"""The host process on a CAN bus, seen from a node of ours on the same bus."""

import os
import signal
import subprocess
import time

import can

from saddlewalk import paths
from saddlewalk.bus import open_bus, private_udp
from saddlewalk.wire import Receiver, Sender

WAIT_S = 2.0  # for what must come
SILENCE_S = 0.1  # for what must not
TICK_S = 0.08
MESSAGES_PER_TICK = 18

WALK = {"MODE": 1, "SPEED": 1.2, "HEEL_STRIKE": 0.1745}
STANDING = {
    "MEASURED_COM": {"HEIGHT": 1.0, "VX": 0.0, "VY": 0.0},
    "MEASURED_LEFT": {"CONTACT": 1, "X": 0.0, "Y": 0.11},
    "MEASURED_RIGHT": {"CONTACT": 1, "X": 0.0, "Y": -0.11},
}


class Host:
    """A running host process and a node of ours, on a bus of their own unless one is given."""

    def __init__(self, *options: str, spec: str | None = None) -> None:
        self.spec = spec or private_udp()
        command = [paths.built("bin/saddlewalk-host"), "--can", self.spec, *options]
        pipe = subprocess.PIPE
        leaks = os.environ | {"ASAN_OPTIONS": "detect_leaks=1"}  # for a sanitized build
        self.process = subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=leaks)
        self.first_line = self.process.stdout.readline()
        assert self.process.stdout.readline() == "ready\n"
        self.bus = open_bus(self.spec)
        self.sender, self.receiver = Sender(), Receiver()

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
        for name, values in measurement.items():
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

    def stop(self, by: signal.Signals = signal.SIGTERM) -> str:
        """End the process cleanly; returns its summary line."""
        self.process.send_signal(by)
        output, errors = self.process.communicate(timeout=WAIT_S)
        assert (self.process.returncode, errors) == (0, "")
        assert output.count("\n") == 1
        return output


def lockstep(*options: str, spec: str | None = None) -> Host:
    return Host("--lcm", "none", "--clock", "lockstep", *options, spec=spec)
