"""The C core in this process: the library that firmware links, called through its own headers."""

import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cffi

from saddlewalk.errors import UserError
from saddlewalk.paths import built, source

AGE_NEVER_US = 0xFFFFFFFF  # SADDLE_AGE_NEVER_US


@functools.cache
def ffi() -> cffi.FFI:
    """Declarations of the core's public headers, preprocessed by the build."""
    declarations = cffi.FFI()
    declarations.cdef(built("saddlewalk_cdef.h").read_text())
    return declarations


@functools.cache
def library() -> Any:
    return ffi().dlopen(str(built("lib/libsaddlewalk.so")))


def defined(name: str, header: str = "core/include/saddlewalk/types.h") -> float:
    """The value of a macro in a header, which cffi does not read."""
    text = source(f"firmware/{header}").read_text()
    (number,) = re.findall(rf"^#define {name} ([0-9.]+)[fu]?$", text, re.MULTILINE)
    return float(number)


@dataclass(frozen=True)
class Measurement:
    """A wearer at one instant. CoPs are relative to the CoM, in metres; None: not measured."""

    com_height_m: float | None = None
    com_velocity_m_s: tuple[float, float] | None = None
    left_cop_m: tuple[float, float] | None = None
    right_cop_m: tuple[float, float] | None = None
    left_contact: bool = False
    right_contact: bool = False
    left_ground_m_s: float = 0.0  # of a treadmill's belt, negative as it runs backward
    right_ground_m_s: float = 0.0
    age_us: int = 0


@dataclass(frozen=True)
class Command:
    """speed_m_s None: stand."""

    speed_m_s: float | None = None
    heel_strike_rad: float = 0.0
    turn_rate_rad_s: float = 0.0  # of the way, to the left


class Core:
    """One context of the core. `config` is a saddle_config_t (see saddlewalk.config)."""

    def __init__(self, config: Any) -> None:
        self._context = ffi().new("saddle_context_t *")
        self._input = ffi().new("saddle_input_t *")
        self._plan = ffi().new("saddle_plan_t *")
        bad_field = library().saddle_config_check(config)
        if bad_field != ffi().NULL:
            raise UserError(describe_bad_field(ffi().string(bad_field).decode(), config))
        library().saddle_init(self._context, config)

    def join(self, command: Command) -> None:
        """saddle_join(): begin in a steady walk, at the left foot via point."""
        self._command(self._input.command, command)
        status = library().saddle_join(self._context, ffi().addressof(self._input, "command"))
        if status != library().SADDLE_OK:
            raise ValueError(f"saddle_join at {command.speed_m_s} m/s: status {status}")

    def tick(self, time_us: int, command: Command, measurement: Measurement) -> Any:
        """One saddle_tick(): returns a new saddle_output_t. Raises ValueError if it is rejected."""
        output = ffi().new("saddle_output_t *")
        self._input.time_us = time_us
        self._command(self._input.command, command)
        _fill(self._input.measurement, measurement)
        status = library().saddle_tick(self._context, self._input, output)
        if status != library().SADDLE_OK:
            raise ValueError(f"saddle_tick at {time_us} us: status {status}")
        return output

    def plan_at(self, time_us: int) -> Any:
        """saddle_plan_at(): a saddle_plan_t, not valid outside the span that the core can give."""
        library().saddle_plan_at(self._context, time_us, self._plan)
        return self._plan

    def score_plan(self, plan: Any) -> Any:
        """saddle_score_plan(): the saddle_scores_t of a planned posture."""
        scores = ffi().new("saddle_scores_t *")
        library().saddle_score_plan(self._context, ffi().addressof(plan), scores)
        return scores

    def reference_after(self, plan: Any, after_s: float) -> Any:
        """saddle_reference_after(): the saddle_reference_t that long after a saddle_plan_t *."""
        reference = ffi().new("saddle_reference_t *")
        status = library().saddle_reference_after(self._context, plan, after_s, reference)
        if status != library().SADDLE_OK:
            raise ValueError(f"saddle_reference_after {after_s} s: status {status}")
        return reference

    @staticmethod
    def _command(target: Any, command: Command) -> None:
        walk = command.speed_m_s is not None
        target.mode = library().SADDLE_COMMAND_WALK if walk else library().SADDLE_COMMAND_STAND
        target.speed_m_s = command.speed_m_s if walk else 0.0
        target.heel_strike_rad = command.heel_strike_rad
        target.turn_rate_rad_s = command.turn_rate_rad_s


def _fill(target: Any, measurement: Measurement) -> None:
    com = target.com
    com.age_us = AGE_NEVER_US
    if measurement.com_height_m is not None and measurement.com_velocity_m_s is not None:
        com.age_us = measurement.age_us
        com.height_m = measurement.com_height_m
        com.velocity_m_s.x, com.velocity_m_s.y = measurement.com_velocity_m_s
    feet = (
        (measurement.left_cop_m, measurement.left_contact, measurement.left_ground_m_s),
        (measurement.right_cop_m, measurement.right_contact, measurement.right_ground_m_s),
    )
    for foot, (cop_m, contact, ground_m_s) in zip(target.foot, feet, strict=True):
        foot.age_us = measurement.age_us if cop_m is not None else AGE_NEVER_US
        foot.contact = contact
        foot.ground_m_s = ground_m_s
        if cop_m is not None:
            foot.cop_m.x, foot.cop_m.y = cop_m


def config_bytes(config: Any) -> bytes:
    """A saddle_config_t for another process, for config_from()."""
    return bytes(ffi().buffer(config))


def config_from(image: bytes) -> Any:
    """The saddle_config_t of config_bytes()."""
    config = ffi().new("saddle_config_t *")
    ffi().memmove(config, image, len(image))
    return config


def model_of(config: Any) -> Any:
    """The saddle_model_t of a configuration: with what saddle_init() derives from it."""
    model = ffi().new("saddle_model_t *")
    library().saddle_model_init(model, config)
    return model


def body_of(config: Any) -> Any:
    """The saddle_body_t of a configuration. A copy: a field of a struct does not keep it alive."""
    model = model_of(config)
    return ffi().new("saddle_body_t *", model.body)[0]


def bos_polygon(config: Any, cops_m: Sequence[Sequence[float]]) -> list[tuple[float, float]]:
    """The base of support of a left and a right CoP, as a polygon in their frame."""
    cops = ffi().new("saddle_vec2_t[2]", [(float(x), float(y)) for x, y in cops_m])
    bos = ffi().new(
        "saddle_bos_t *", library().saddle_bos(cops, config.cop_range_m, config.bos_factor)
    )
    vertices = ffi().new("saddle_vec2_t[]", int(defined("SADDLE_BOS_VERTICES")))
    library().saddle_bos_polygon(bos, vertices)
    return [(vertex.x, vertex.y) for vertex in vertices]


def field_ranges() -> dict[str, tuple[float, float]]:
    """Accepted range of every float field of saddle_config_t."""
    ranges = {}
    index = 0
    while (field := library().saddle_config_field(index)) != ffi().NULL:
        ranges[ffi().string(field.name).decode()] = (field.min, field.max)
        index += 1
    return ranges


def describe_bad_field(name: str, config: Any) -> str:
    """One line for a field that saddle_config_check() named."""
    value = getattr(config, name)
    ranges = field_ranges()
    if name not in ranges:
        return f"{name} = {value} is not one of the core's models"
    low, high = ranges[name]
    if low <= value <= high:
        return f"{name} = {value:g} does not fit the other fields of the configuration"
    return f"{name} = {value:g} must be in {low:g} to {high:g}"
