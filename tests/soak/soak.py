"""One host process through hours of walks, as fast as it answers: does it grow or stop?

usage: soak.py HOURS [SEED]

HOURS are of the firmware's time. Every walk has random speeds, stops, pushes and a new wearer, who
may fall; between its frames come others that no sender of measurements made: of any identifier and
length, and damaged copies. Fails if memory or open files of the host process grow, if no frame is
rejected, or if the process stops answering or does not end cleanly.
"""

import math
import sys
import time
from pathlib import Path

import can
import numpy as np

from saddlewalk.config import configuration, host_arguments
from saddlewalk.contract import TICK_S
from saddlewalk.emulation.exoskeleton import Exoskeleton, Observer, Tick
from saddlewalk.emulation.host import running_host
from saddlewalk.emulation.wearer import Body, Noise, Push, Wearer
from saddlewalk.planning.schedule import Schedule, schedule_of
from saddlewalk.transport.bus import open_bus, private_udp

WALK_S = 120.0
WARM_UP_WALKS = 3  # by then all that is allocated once is there
GROWTH_MAX_KIB = 256
FOREIGN_SHARE = 0.2  # of frames, beside the wearer's
HEEL_STRIKE_RAD = 0.17


class NoisyBus:
    """A bus on which others send too."""

    def __init__(self, bus: can.BusABC, random: np.random.Generator) -> None:
        self._bus, self._random = bus, random
        self.channel_info = bus.channel_info

    def send(self, frame: can.Message) -> None:
        if self._random.random() < FOREIGN_SHARE:
            self._bus.send(self._damaged(frame) if self._random.random() < 0.5 else self._any())
        self._bus.send(frame)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        return self._bus.recv(timeout)

    def _damaged(self, frame: can.Message) -> can.Message:
        data = bytearray(frame.data)
        data[self._random.integers(len(data))] ^= 1 << self._random.integers(8)
        return can.Message(arbitration_id=frame.arbitration_id, data=data, is_extended_id=False)

    def _any(self) -> can.Message:
        data = self._random.bytes(self._random.integers(9))
        identifier = int(self._random.integers(0x800))
        return can.Message(arbitration_id=identifier, data=data, is_extended_id=False)


class Soak(Observer):
    """Counts of all walks."""

    def __init__(self) -> None:
        self.ticks = self.falls = 0

    def tick(self, tick: Tick, wearer: Wearer) -> None:
        self.ticks += 1
        self.finished = wearer.fallen  # who lies there cannot be asked to walk


def speeds(random: np.random.Generator) -> Schedule:
    """Standing, then a new speed every few seconds, one in five a stop."""
    rows, time_s = [(0.0, 0.0)], 1.0
    while time_s < WALK_S:
        rows.append((time_s, 0.0 if random.random() < 0.2 else float(random.uniform(0.2, 1.8))))
        time_s += float(random.uniform(2.0, 20.0))
    return schedule_of(rows, HEEL_STRIKE_RAD)


def pushes(random: np.random.Generator) -> tuple[Push, ...]:
    times_s = np.sort(random.uniform(5.0, WALK_S, 6))
    return tuple(
        Push(float(random.uniform(0.0, 20.0)), float(t), float(random.uniform(0.0, 360.0)))
        for t in times_s
    )


def used(pid: int) -> tuple[int, int]:
    """Resident memory, KiB, and open files of a process."""
    status = Path(f"/proc/{pid}/status").read_text()
    resident = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    return int(resident.split()[1]), len(list(Path(f"/proc/{pid}/fd").iterdir()))


def main() -> None:
    hours = float(sys.argv[1])
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    walks = max(WARM_UP_WALKS + 1, math.ceil(hours * 3600 / WALK_S))
    config, address, soak = configuration({}), private_udp(), Soak()
    before = last = (0, 0)
    options = [f"--can={address}", "--lcm=none", "--clock=lockstep", *host_arguments(config)]
    begin_s = time.monotonic()
    with open_bus(address) as bus, running_host(*options) as process:
        for walk in range(walks):
            random = np.random.default_rng([seed, walk])
            wearer = Wearer(Body.of(config), Noise(), pushes(random), seed=walk)
            noisy = NoisyBus(bus, random)
            device = Exoskeleton(
                noisy, wearer, config, speeds(random), observers=[soak], fresh=walk == 0
            )
            device.run("lockstep", WALK_S)
            soak.falls, soak.finished = soak.falls + wearer.fallen, False
            rejected = device.health["REJECTED_FRAMES"]
            last = used(process.pid)
            before = last if walk < WARM_UP_WALKS else before
    grown = last[0] - before[0]
    passed_s = time.monotonic() - begin_s
    print(
        f"soak: {soak.ticks} ticks, {soak.ticks * TICK_S / 3600:.2f} h at "
        f"{soak.ticks * TICK_S / passed_s:.0f} times real time (seed {seed}); {walks} wearers, "
        f"{soak.falls} fell; memory {last[0]} KiB, {grown:+d} since walk {WARM_UP_WALKS}; "
        f"{last[1]} open files, {last[1] - before[1]:+d}; {rejected:.0f} frames rejected"
    )
    if grown > GROWTH_MAX_KIB or last[1] != before[1] or not rejected:
        sys.exit("soak: FAILED: the process grew, or rejected nothing")


if __name__ == "__main__":
    main()
