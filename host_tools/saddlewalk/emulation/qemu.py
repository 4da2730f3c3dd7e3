"""The firmware on a controller that QEMU emulates, `firmware/port_mcu`, for the length of a `with`
block."""

import contextlib
import os
import shutil
import socket
import struct
import subprocess
import tempfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from saddlewalk.errors import UserError
from saddlewalk.paths import CHECKOUT, in_checkout
from saddlewalk.transport.slcan import SlcanBus

MACHINE = "mps2-an386"
DESCRIPTION = f"serial line of {MACHINE} in QEMU"
IMAGE = CHECKOUT / "build-cortex-m4f/bin/saddlewalk-controller"
STOP_TIMEOUT_S = 5.0
_EMULATOR = "qemu-system-arm"
_COMPILER = "arm-none-eabi-gcc"
# As firmware/port_mcu/mps2/main.c has it.
_SETTINGS_ADDRESS = 0x003FF000


class Controller:
    """A running controller: its bus, and once the block has ended, its last line of output."""

    def __init__(self, bus: SlcanBus) -> None:
        self.bus = bus
        self.words = ""


@contextlib.contextmanager
def running_controller(
    config: Any,
    clock: str = "lockstep",
    joints_hz: int = 0,
    measured_legs: Mapping[str, float] | None = None,
) -> Iterator[Controller]:
    """Starts it with a configuration; when the block ends, its bus is closed, which ends it.

    joints_hz: as of saddlewalk-host --joints; 0: it is measured by CoM and feet. measured_legs:
    fields of saddle_legs_t.

    Raises UserError if something is missing, or with its last line if it failed, whatever
    exception that caused in the block.
    """
    if problem := missing():
        raise UserError(problem)
    ours, theirs = socket.socketpair()
    with tempfile.TemporaryDirectory() as folder, theirs:
        page = Path(folder) / "settings"
        page.write_bytes(settings_page(config, clock, joints_hz, measured_legs))
        process = subprocess.Popen(
            _command(page, theirs.fileno()),
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        theirs.close()
        controller = Controller(SlcanBus(ours, DESCRIPTION))
        try:
            yield controller
        finally:
            controller.bus.shutdown()
            controller.words = _last_words(process)
            if process.returncode != 0:
                words = controller.words or f"status {process.returncode}"
                raise UserError(f"{DESCRIPTION}: {words}")


def settings_page(
    config: Any,
    clock: str,
    joints_hz: int = 0,
    measured_legs: Mapping[str, float] | None = None,
) -> bytes:
    """The page of flash with a saddle_config_t, as firmware/port_mcu/settings.h lays it down."""
    from saddlewalk.contract import TICK_S
    from saddlewalk.core import field_ranges
    from saddlewalk.joints import loop_settings

    fields = [(name, getattr(config, name)) for name in field_ranges()]
    fields += [(name, value) for _, name, value in loop_settings(config, measured_legs)]
    names = b"".join(name.encode() + b"\0" for name, _ in fields)
    head = (clock == "lockstep", config.ankle, round(joints_hz * TICK_S))
    values = struct.pack(f"<3I{len(fields)}f", *head, *(value for _, value in fields))
    return struct.pack("<I", zlib.crc32(names + values)) + values


def missing() -> str:
    """What is missing to run a controller, with the remedy; empty if nothing is."""
    if not in_checkout():
        return "its image is built in a checkout of the project, by `make controller`"
    if shutil.which(_EMULATOR) is None:
        return f"{_EMULATOR} is missing: as root, apt-get install -y qemu-system-arm"
    if IMAGE.exists():
        return ""
    if shutil.which(_COMPILER) is None:
        packages = "gcc-arm-none-eabi picolibc-arm-none-eabi"
        return f"{_COMPILER} is missing: as root, apt-get install -y {packages}"
    return f"{IMAGE} is missing: run `make controller` in {CHECKOUT}"


def _command(page: Path, line: int) -> list[str]:
    return [
        *(_EMULATOR, "-M", MACHINE, "-display", "none", "-monitor", "none"),
        *("-chardev", f"socket,id=can,fd={line}", "-serial", "chardev:can"),
        *("-semihosting-config", "enable=on,target=native"),
        *("-device", f"loader,file={page},addr={_SETTINGS_ADDRESS:#x},force-raw=on"),
        *("-kernel", os.fspath(IMAGE)),
    ]


def _last_words(process: subprocess.Popen[str]) -> str:
    """Wait for its end; returns its last line. It is killed if it does not end, as its status then
    shows.
    """
    try:
        words = process.communicate(timeout=STOP_TIMEOUT_S)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        words = process.communicate()[0]
    return "".join(words.strip().splitlines()[-1:])
