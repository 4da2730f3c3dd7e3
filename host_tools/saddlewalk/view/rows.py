"""What the page shows of each tick: a row of numbers from the tick's LCM messages.

A number that is not known is NaN. Positions are of one world: x forward from the start, y to the
left, metres. The world is found from the measured feet alone and the planned heading of the pelvis,
in whose axes they are, so it is the same for an emulated wearer, a recording and a machine.
"""

import cmath
import math
from array import array
from collections.abc import Iterable, Sequence
from typing import Any

from saddlewalk.config import ANKLES, configuration
from saddlewalk.contract import LEFT, RIGHT, STANDING, STARTING
from saddlewalk.core import bos_polygon, defined, field_ranges
from saddlewalk.logs.messages import kinds
from saddlewalk.planning.ground import on_arc
from saddlewalk.status_text import DROPPED, REJECTED

VERTICES = int(defined("SADDLE_BOS_VERTICES"))
FIRMWARE = tuple("config input plan scores verdict balance bos way status health".split())
LAST = "health"  # of a tick's messages

_TAKEN: dict[str, tuple[str, ...]] = {  # as they are
    "verdict": (
        *("level", "reason", "compared", "can_stop", "excess_stop_j"),
        *("ebos_com_m", "ebos_xcom_m", "recovery_found", "recovery_foot", "recovery_margin_m"),
    ),
    "balance": ("margin", "caution_below", "driver"),
    "scores": ("s_pend", "s_jump", "s_sw", "mos_com_m", "mos_xcom_m", "v_comp_m_s"),
    "plan": ("valid", "mode", "support", "step_count", "speed_m_s", "time_to_heel_strike_s"),
    "health": ("status", "limits", "faults", "latency_us", "late_ticks"),
    "status": (
        *("command_source", "can_link", "lcm_link", "can_transport", "missed_ticks"),
        *("latency_max_us", "period_us"),
    ),
}
_AGES = tuple(f"{name}_age_us" for name in ("command", "com", "left", "right"))
_POINTS = ("com", "left", "right")
_REFERENCE = ("com", "xcom", "cop")
_JOINTS = ("hip", "knee", "ankle", "heel", "toe")


def _polygon_names(name: str) -> list[str]:
    return [f"{name}_{axis}_m.{index}" for axis in "xy" for index in range(VERTICES)]


NAMES: tuple[str, ...] = (
    *("tick", "t_s"),
    *(f"{kind}.{name}" for kind, names in _TAKEN.items() for name in names),
    *(f"input.{name}" for name in ("speed_m_s", *_AGES)),
    *("status.rejected", "status.dropped"),
    *("truth.fallen", "truth.push_x_n_s", "truth.push_y_n_s"),
    *("com_x_m", "com_y_m", "com_z_m", "com_vx_m_s", "com_vy_m_s", "xcom_x_m", "xcom_y_m"),
    *(f"{side}_{part}" for side in ("left", "right") for part in ("x_m", "y_m", "contact")),
    *(f"plan_{point}_{axis}_m" for point in _POINTS for axis in "xyz"),
    *("plan_left_pitch_rad", "plan_right_pitch_rad", "landing_x_m", "landing_y_m"),
    *("heading_rad", "left_yaw_rad", "right_yaw_rad", "landing_yaw_rad", "walked_m"),
    *("recovery_x_m", "recovery_y_m"),
    *(f"reference_{point}_{axis}_m" for point in _REFERENCE for axis in "xy"),
    *(
        f"{side}_{joint}_{axis}_m"
        for joint in _JOINTS
        for side in ("left", "right")
        for axis in "xz"
    ),
    *("trunk_up_x", "trunk_up_z"),
    *_polygon_names("bos"),
    *_polygon_names("ebos"),
)
_UNKNOWN = math.nan
_NOWHERE = complex(_UNKNOWN, _UNKNOWN)
_NO_POLYGON = (_UNKNOWN,) * (2 * VERTICES)


class Rows:
    """Makes rows of messages as they come."""

    def __init__(self) -> None:
        self.config: Any = None  # saddle_config_t, once the firmware has published it
        self.body_height_m: float | None = None
        self._messages: dict[str, Any] = {}
        self._utime_us: int | None = None
        self._start_us: int | None = None
        self._world = World()
        self._push_n_s = 0j
        self._fallen = 0
        self._skeleton: Any = None  # the newest

    def feed(self, channel: str, data: bytes) -> "array[float] | None":
        """The row of the tick that this message completes, in the order of NAMES.

        What is not a message of ours changes nothing. A tick whose last message was lost is
        completed by the next tick's first.
        """
        kind = kinds().get(channel)
        message = kind.decode(data) if kind else None
        if kind is None or message is None:
            return None
        if kind.name == "truth":
            self._push_n_s += complex(*message.push_n_s)
            self._fallen = message.fallen
        if kind.name == "skeleton":
            self._skeleton = message
        if kind.name not in FIRMWARE:
            return None
        row = None
        if message.utime_us != self._utime_us:
            row = self._row() if self._messages else None
            self._utime_us = message.utime_us
        self._messages[kind.name] = message
        if kind.name == "config":
            self._configure(message)
        return self._row() if kind.name == LAST else row

    def end(self) -> "array[float] | None":
        """The row of messages that nothing followed."""
        return self._row() if self._messages else None

    def _configure(self, message: Any) -> None:
        """Fields of other versions of the firmware are passed over."""
        known = field_ranges()
        fields = {
            name: value
            for name, value in zip(message.name, message.value, strict=True)
            if name in known
        }
        if message.ankle in ANKLES.values():
            fields["ankle"] = message.ankle
        self.config = configuration(fields)
        self.body_height_m = self.config.body_height_m

    def _row(self) -> "array[float]":
        messages, self._messages = self._messages, {}
        assert self._utime_us is not None
        if self._start_us is None or self._utime_us < self._start_us:
            self._start_us = self._utime_us
        time_s = (self._utime_us - self._start_us) / 1e6
        inputs, plan = messages.get("input"), messages.get("plan")
        scores, verdict = messages.get("scores"), messages.get("verdict")
        status = messages.get("status")
        world = self._world
        world.turn(messages.get("way"))
        world.measure(inputs, time_s)
        world.plan(plan)
        push_n_s, self._push_n_s = self._push_n_s, 0j
        numbers = [
            *(_member(messages.get("health"), "tick"), time_s),
            *(
                _member(messages.get(kind), name)
                for kind, names in _TAKEN.items()
                for name in names
            ),
            *(_commanded(inputs), *(_age(inputs, name) for name in _AGES)),
            *(_total(status, REJECTED.values()), _total(status, DROPPED.values())),
            *(self._fallen, push_n_s.real, push_n_s.imag),
            *(world.com_m.real, world.com_m.imag, *_measured_com(inputs)),
            *_parts(world.com_m + _complex(scores, "xcom_m") * world.forward),
            *_foot(world, inputs, LEFT),
            *_foot(world, inputs, RIGHT),
            *(value for point in _POINTS for value in world.planned(plan, f"{point}_m")),
            *(plan.foot_pitch_rad if plan else (_UNKNOWN, _UNKNOWN)),
            *_parts(world.landing(plan)),
            *(world.heading_rad, *world.yaws_rad, world.landing_yaw_rad(plan), world.walked_m),
            *_parts(_recovery(world, verdict, plan)),
            *(part for point in _REFERENCE for part in _parts(world.reference(plan, point))),
            *_skeleton(world, self._skeleton),
            *_bos(world, messages.get("bos")),
            *self._expected_bos(plan),
        ]
        return array("f", numbers)

    def _expected_bos(self, plan: Any) -> Sequence[float]:
        """The base of support when the swing foot lands, from the core."""
        landing, stance = self._world.landing(plan), self._world.stance(plan)
        if self.config is None or not _finite(landing) or not _finite(stance):
            return _NO_POLYGON
        forward = self._world.forward
        step = (landing - stance) / forward
        vertices = bos_polygon(self.config, [(0.0, 0.0), (step.real, step.imag)])
        return _outline(stance + complex(*vertex) * forward for vertex in vertices)


class World:
    """Where the measured body is. A foot that stays in contact stays where it is."""

    def __init__(self) -> None:
        self.com_m = _NOWHERE
        self.walked_m = _UNKNOWN  # by the CoM, in its heading
        self.heading_rad = 0.0  # of the pelvis
        self.forward = 1 + 0j
        self.yaws_rad = [0.0, 0.0]  # planned, of the feet
        self._origin_m = 0j  # of the plan's axes, from where the way began, and their direction
        self._ahead = 1 + 0j
        self._curvature_1_m = (0.0, 0.0)
        self.feet_m = [_NOWHERE, _NOWHERE]
        self._contact = [False, False]
        self._time_s = _UNKNOWN
        self._plan_m = _NOWHERE  # origin of the plan's frame

    def turn(self, way: Any) -> None:
        """To the headings of a tick; firmware without a way goes straight on."""
        if way is None or not all(map(math.isfinite, _numbers(way))):
            return
        self.heading_rad = math.remainder(way.heading_rad + way.pelvis_yaw_rad, math.tau)
        self.forward = cmath.rect(1.0, self.heading_rad)
        self.yaws_rad = [way.heading_rad + yaw_rad for yaw_rad in way.foot_yaw_rad]
        self._origin_m = 1j * way.origin_y_m
        self._ahead = cmath.rect(1.0, way.heading_rad)
        self._curvature_1_m = way.curvature_1_m

    def measure(self, inputs: Any, time_s: float) -> None:
        """Move to what was measured at a tick."""
        before_m = self.com_m
        relative = [_complex(inputs, f"{side}_m") * self.forward for side in ("left", "right")]
        contact = [
            bool(_member(inputs, f"{side}_contact") == 1) and _finite(foot)
            for side, foot in zip(("left", "right"), relative, strict=True)
        ]
        stays = [
            now and before and _finite(foot)
            for now, before, foot in zip(contact, self._contact, self.feet_m, strict=True)
        ]
        held = [self.feet_m[side] - relative[side] for side in (LEFT, RIGHT) if stays[side]]
        if held:
            self.com_m = sum(held) / len(held)
        elif _finite(self.com_m):
            self.com_m += _moved(inputs, time_s - self._time_s) * self.forward
        elif all(map(_finite, relative)):
            self.com_m = -(relative[LEFT] + relative[RIGHT]) / 2
        self.feet_m = [
            self.feet_m[side] if stays[side] else self.com_m + relative[side]
            for side in (LEFT, RIGHT)
        ]
        self._contact, self._time_s = contact, time_s
        if _finite(before_m):
            self.walked_m += ((self.com_m - before_m) / self.forward).real
        else:
            self.walked_m = self.com_m.real

    def plan(self, plan: Any) -> None:
        """Attach the plan's frame to the measured stance foot."""
        if plan and plan.valid and self._contact[_support(plan)]:
            self._plan_m = self.feet_m[_support(plan)] - self._walked(plan, _planned_stance(plan))

    def _walked(self, plan: Any, point_m: complex) -> complex:
        """A point of the plan's axes, whose origin moves on with the stance foot."""
        return self._origin_m + plan.origin_x_m + point_m * self._ahead

    def stance(self, plan: Any) -> complex:
        """The stance foot, as measured."""
        return self.feet_m[_support(plan)] if plan and plan.valid else _NOWHERE

    def planned(self, plan: Any, name: str) -> tuple[float, float, float]:
        """A point of a plan of steps."""
        if not plan or not plan.valid or plan.mode == STANDING:
            return (_UNKNOWN, _UNKNOWN, _UNKNOWN)
        x_m, y_m, z_m = getattr(plan, name)
        point = self._plan_m + self._walked(plan, complex(x_m, y_m))
        return (point.real, point.imag, z_m)

    def reference(self, plan: Any, point: str) -> complex:
        """CoM, XCoM or CoP of the pendulum to balance by."""
        if not plan or not plan.valid:
            return _NOWHERE
        return self._plan_m + self._walked(plan, _complex(plan, f"reference_{point}_m"))

    def landing(self, plan: Any) -> complex:
        """Where the swing foot is planned to land."""
        if not plan or not plan.valid or plan.mode == STANDING:
            return _NOWHERE
        if plan.mode == STARTING and plan.speed_m_s == 0:  # the weight is being shifted
            return _NOWHERE
        return self._plan_m + self._walked(plan, complex(*plan.landing_m))

    def landing_yaw_rad(self, plan: Any) -> float:
        """Of the foot that lands there."""
        if not _finite(self.landing(plan)):
            return _UNKNOWN
        return cmath.phase(self._ahead) + self._curvature_1_m[1] * plan.landing_m[0]

    def from_stance(self, plan: Any, place_m: complex) -> complex:
        """A place along and across the way, from the stance foot, as a vector of the world."""
        if not plan or not plan.valid:
            return place_m * self._ahead
        stance_m = _planned_stance(plan)
        if not _finite(place_m + stance_m):
            return _NOWHERE
        curvature_1_m = self._curvature_1_m[place_m.real >= 0]
        return (on_arc(curvature_1_m, place_m + stance_m) - stance_m) * self._ahead


def _numbers(way: Any) -> tuple[float, ...]:
    single = way.origin_y_m, way.heading_rad, way.pelvis_yaw_rad
    return *single, *way.foot_yaw_rad, *way.curvature_1_m


def _support(plan: Any) -> int:
    return RIGHT if plan.support == plan.RIGHT else LEFT


def _planned_stance(plan: Any) -> complex:
    x_m, y_m, _ = (plan.left_m, plan.right_m)[_support(plan)]
    return complex(x_m, y_m)


def _moved(inputs: Any, time_s: float) -> complex:
    """By the measured velocity; not at all where that is not known."""
    moved = _complex(inputs, "com_velocity_m_s") * time_s
    return moved if _finite(moved) else 0j


def _recovery(world: World, verdict: Any, plan: Any) -> complex:
    if not verdict or not verdict.recovery_found:
        return _NOWHERE
    other = LEFT if verdict.recovery_foot == verdict.RIGHT else RIGHT
    landing_m = world.from_stance(plan, complex(*verdict.recovery_landing_m))
    return world.feet_m[other] + landing_m


def _skeleton(world: World, skeleton: Any) -> list[float]:
    """Joints along the walked way and up, and the trunk's direction."""
    if not skeleton:
        return [_UNKNOWN] * (4 * len(_JOINTS) + 2)

    def ahead(point: Sequence[float]) -> float:
        return float((complex(*point[:2]) / world.forward).real)

    joints = [getattr(skeleton, f"{joint}_m")[side] for joint in _JOINTS for side in (LEFT, RIGHT)]
    places = [part for point in joints for part in (world.walked_m + ahead(point), point[2])]
    return [*places, ahead(skeleton.trunk_up), skeleton.trunk_up[2]]


def _bos(world: World, bos: Any) -> Sequence[float]:
    if not bos or not bos.defined:
        return _NO_POLYGON
    vertices = map(complex, bos.x_m, bos.y_m)
    return _outline(world.com_m + vertex * world.forward for vertex in vertices)


def _outline(points_m: Iterable[complex]) -> list[float]:
    """In the order of _polygon_names()."""
    points = list(points_m)
    return [*(point.real for point in points), *(point.imag for point in points)]


def _foot(world: World, inputs: Any, side: int) -> tuple[float, float, float]:
    foot, name = world.feet_m[side], ("left", "right")[side]
    return foot.real, foot.imag, _member(inputs, f"{name}_contact")


def _measured_com(inputs: Any) -> tuple[float, float, float]:
    """Height and velocity."""
    if not inputs or inputs.com_age_us == inputs.NEVER:
        return (_UNKNOWN, _UNKNOWN, _UNKNOWN)
    return (inputs.com_height_m, *inputs.com_velocity_m_s)


def _commanded(inputs: Any) -> float:
    """The speed that is commanded; standing is 0."""
    if not inputs or inputs.command_age_us == inputs.NEVER:
        return _UNKNOWN
    return float(inputs.speed_m_s) if inputs.mode == inputs.MODE_WALK else 0.0


def _age(inputs: Any, name: str) -> float:
    age_us = getattr(inputs, name, None)
    return _UNKNOWN if age_us is None or age_us == inputs.NEVER else age_us


def _member(message: Any, name: str) -> float:
    return _UNKNOWN if message is None else getattr(message, name, _UNKNOWN)


def _total(message: Any, names: Iterable[str]) -> float:
    return sum(_member(message, name) for name in names)


def _complex(message: Any, name: str) -> complex:
    return _NOWHERE if message is None else complex(*getattr(message, name))


def _parts(point: complex) -> tuple[float, float]:
    return point.real, point.imag


def _finite(point: complex) -> bool:
    return math.isfinite(point.real) and math.isfinite(point.imag)
