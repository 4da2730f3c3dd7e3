"""The core with the wire and the LCM messages, in this process, as saddlewalk-host links them."""

import functools
from typing import Any

import cffi

from saddlewalk.contract import OUTPUT_FRAMES
from saddlewalk.core import describe_bad_field
from saddlewalk.errors import UserError
from saddlewalk.paths import built
from saddlewalk.transport.wire import identifier

_OF_PROCESS = {identifier(name) for name in ("TIMING", "RECEIVED", "INPUTS")}


@functools.cache
def ffi() -> cffi.FFI:
    """Declarations of the firmware's public headers, preprocessed by the build."""
    declarations = cffi.FFI()
    declarations.cdef(built("saddlewalk_firmware_cdef.h").read_text())
    return declarations


@functools.cache
def library() -> Any:
    return ffi().dlopen(str(built("lib/libsaddlewalk_firmware.so")))


def default_config() -> Any:
    """A saddle_config_t of this library, to fill."""
    config = ffi().new("saddle_config_t *")
    config[0] = library().saddle_config_default(1.0, 1.0)
    return config


def config_of(core_config: Any) -> Any:
    """A saddle_config_t of saddlewalk.config as one of this library."""
    from saddlewalk import core

    config = ffi().new("saddle_config_t *")
    ffi().memmove(config, core.ffi().buffer(core_config), ffi().sizeof("saddle_config_t"))
    return config


class Firmware:
    """One context of the core, ticked with whole inputs; its outputs as messages and frames."""

    def __init__(self, config: Any) -> None:
        """config: a saddle_config_t of this library. Raises UserError naming a bad field."""
        bad_field = library().saddle_config_check(config)
        if bad_field != ffi().NULL:
            raise UserError(describe_bad_field(ffi().string(bad_field).decode(), config))
        self._context = ffi().new("saddle_context_t *")
        self._bytes = ffi().new("uint8_t[]", library().SADDLE_LCM_MESSAGE_MAX)
        self._plan = ffi().new("saddle_plan_t *")
        self.output = ffi().new("saddle_output_t *")
        library().saddle_init(self._context, config)

    def tick(self, inputs: Any) -> Any:
        """One saddle_tick() with a saddle_input_t; returns the saddle_output_t, which is reused."""
        library().saddle_tick(self._context, inputs, self.output)
        return self.output

    def adapt(self, config: Any) -> bool:
        """saddle_adapt() to a saddle_config_t; whether it is the configuration now."""
        status = library().saddle_adapt(self._context, config)
        used = ffi().buffer(ffi().addressof(self._context.model, "config"))
        return bool(status == library().SADDLE_OK and used[:] == ffi().buffer(config)[:])

    def plan_at(self, time_us: int) -> Any:
        """saddle_plan_at(): a saddle_plan_t, which is reused; not valid outside the core's span."""
        library().saddle_plan_at(self._context, time_us, self._plan)
        return self._plan

    def messages(self, utime_us: int) -> dict[str, bytes]:
        """The last output as the host publishes it: channel -> encoded message."""
        lib = library()
        encoded = {}
        for part in range(lib.SADDLE_LCM_OUTPUTS):
            size = lib.saddle_lcm_encode_output(part, self.output, utime_us, self._bytes)
            channel = ffi().string(lib.saddle_lcm_channel(part)).decode()
            encoded[channel] = bytes(ffi().buffer(self._bytes, size))
        return encoded

    def frames(self, counter: int, late_ticks: int, rejected_frames: int) -> dict[int, bytes]:
        """The last output as the host sends it on CAN: identifier -> data.

        Without messages about the host process itself, which do not follow from the inputs.
        """
        frames = ffi().new("saddle_frame_t[]", OUTPUT_FRAMES)
        health = ffi().new("saddle_wire_health_t *")
        health.late_ticks, health.rejected_frames = late_ticks, rejected_frames
        library().saddle_wire_encode_output(self.output, health, counter, frames)
        return {frame.id: bytes(frame.data) for frame in frames if frame.id not in _OF_PROCESS}
