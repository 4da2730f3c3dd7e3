"""Checks for unsafe output, whatever faults were injected."""

import math
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from saddlewalk.contract import STANDING, STARTING, STOPPING, TICK_S, WALKING
from saddlewalk.faults.scenario import CLOCK, INPUTS, MEASURED, Arrival
from saddlewalk.firmware import library
from saddlewalk.ticks import PLAN_MESSAGES, Messages
from saddlewalk.transport import wire

KNEE_HEIGHT = 0.285  # of the body's height
COM_SPEED_M_S = 6.0
LONGEST_STEP = 2.1  # of half_step_max_m
ROUNDING = 1e-3  # maximum on the wire
STOP_WITHIN_S = 6.0  # from any speed, at the default deceleration

# The most cautious state reported after a fault began, the most cautious first.
STATES = ("safe stop", "no plan", "unknown", "unstable", "caution", "walked on")

# Violations: what the firmware must never do.
BAD_PLAN = "plan out of bounds"
OLD_SCORE = "score of old data"
SILENT_STOP = "silent stop"
NO_STOP = "no stop"

_SCORES_OF_FEET = {
    "SCORES_STEP": ("S_SW",),
    "SCORES_MARGIN": ("MOS_COM", "MOS_XCOM"),
    "SCORES_FORCE": ("GRAVITY_X", "GRAVITY_Y"),
    "SCORES_ENERGY": ("EXCESS_STOP", "EXCESS_TRACK"),
    "SCORES_EXPECTED": ("EBOS_COM", "EBOS_XCOM"),
}
_SCORES_OF_COM = {
    "SCORES_MARGIN": ("MOS_XCOM",),
    "SCORES_ENERGY": ("EXCESS_STOP", "EXCESS_TRACK"),
    "SCORES_EXPECTED": ("EBOS_COM", "EBOS_XCOM"),
}


@dataclass
class MessageRecord:
    """The checker's own record of a message."""

    came_s: float = -math.inf  # when it was last accepted, by the firmware's clock
    usable_s: float = -math.inf  # when it was last accepted and usable
    born_s: float = math.inf  # when the last accepted values were measured


@dataclass
class Checker:
    """Checks a walk tick by tick. begin_s: when the fault begins."""

    config: Any
    body: Any  # saddle_body_t
    begin_s: float
    records: dict[str, MessageRecord] = field(
        default_factory=lambda: {name: MessageRecord() for name in INPUTS}
    )
    violations: Counter[str] = field(default_factory=Counter)
    detected: int | None = None
    walk_commanded: bool = False  # whether the valid commands ask for a walk
    blind: int = 0
    forged: int = 0
    states: set[str] = field(default_factory=set)
    _before: tuple[int, ...] = ()
    _mode: int = STANDING
    _stopping_s: float = 0.0
    _armed: bool = False
    _ticks_since: int = 0

    def arrived(self, arrival: Arrival, time_s: float) -> None:
        """Record a frame that was accepted at time_s of the firmware's clock."""
        name = wire.known_name(arrival.frame.arbitration_id)
        self.forged += arrival.forged
        if name in CLOCK:
            return
        signals = wire.signals(arrival.frame)
        record = self.records[name]
        if name != "COMMAND" or self._commands(signals):
            record.came_s = time_s
            record.born_s = arrival.born_s
        if name == "COMMAND" and not arrival.forged and self._commands(signals):
            self.walk_commanded = signals["MODE"] == 1 and signals["SPEED"] > 0
        if all(map(math.isfinite, signals.values())):
            record.usable_s = time_s

    @staticmethod
    def _commands(signals: dict[str, float]) -> bool:
        walks = signals["MODE"] == 1 and all(map(math.isfinite, signals.values()))
        return walks or signals["MODE"] == 0

    def tick(self, messages: Messages, walk_s: float, clock_s: float) -> None:
        """Check a tick at walk_s of the walk and clock_s of the firmware's clock."""
        health, verdict = messages["HEALTH"], messages["VERDICT"]
        stopping = bool(health["LIMITS"] & library().SADDLE_LIMIT_SAFE_STOP)
        self._detect(messages, walk_s)
        if health["STATUS"] != library().SADDLE_OK:
            if messages["PLAN_STEP"]["VALID"] or verdict["LEVEL"]:
                self.violations[BAD_PLAN] += 1
            self._stopping_s = 0.0
            self._mode = STANDING
            return
        ages_s = {name: clock_s - record.came_s for name, record in self.records.items()}
        self._check_plan(messages)
        self._check_scores(messages, ages_s)
        self._check_stop(messages, stopping, ages_s, clock_s)
        self._armed = self._armed or all(ages_s[name] <= self._limit_s(name) for name in MEASURED)
        if verdict["LEVEL"] and any(
            walk_s - self.records[name].born_s > self._limit_s(name) for name in MEASURED
        ):
            self.blind += 1

    def _limit_s(self, name: str) -> float:
        limits = {
            "COMMAND": self.config.command_max_age_s,
            "MEASURED_COM": self.config.com_max_age_s,
        }
        return limits.get(name, self.config.foot_max_age_s) + 1e-6

    def _detect(self, messages: Messages, walk_s: float) -> None:
        """Detect new reports of the firmware since the fault began."""
        lib, health = library(), messages["HEALTH"]
        reported = lib.SADDLE_LIMIT_SAFE_STOP | lib.SADDLE_LIMIT_TICK_GAP
        faults = int(messages["SCORES_FORCE"]["FAULTS"])
        limits = int(health["LIMITS"]) & reported
        level = int(messages["VERDICT"]["LEVEL"])
        now = (int(health["STATUS"]), int(health["REJECTED_FRAMES"]), faults, limits)
        if walk_s < self.begin_s:
            self._before = now
            return
        status, rejected, faults_before, limits_before = self._before or (0, 0, 0, 0)
        amiss = (
            now[0] != status
            or now[1] != rejected
            or faults & ~faults_before
            or limits & ~limits_before
        )
        if self.detected is None and amiss:
            self.detected = self._ticks_since
        self._ticks_since += 1
        if limits & lib.SADDLE_LIMIT_SAFE_STOP:
            self.states.add("safe stop")
        if health["STATUS"] != lib.SADDLE_OK:
            self.states.add("no plan")
        names = {0: "unknown", 2: "caution", 3: "unstable"}
        if level in names:
            self.states.add(names[level])

    @property
    def state(self) -> str:
        return next((state for state in STATES if state in self.states), "walked on")

    def _check_plan(self, messages: Messages) -> None:
        values = {
            f"{part} {name}": value
            for part in PLAN_MESSAGES
            for name, value in messages[part].items()
        }
        sound = values["PLAN_STEP VALID"] == 1 and all(map(math.isfinite, values.values()))
        bounds = plan_bounds(self.config, self.body).items()
        within = all(low <= values[name] <= high for name, (low, high) in bounds)
        if not (sound and within and _legs_reach(values, self.body)):
            self.violations[BAD_PLAN] += 1

    def _check_scores(self, messages: Messages, ages_s: dict[str, float]) -> None:
        old = {name for name in MEASURED if ages_s[name] > self._limit_s(name)}
        scores = {}
        if old & {"MEASURED_LEFT", "MEASURED_RIGHT"}:
            scores = _SCORES_OF_FEET
        elif old:
            scores = _SCORES_OF_COM
        scored = any(
            math.isfinite(messages[part][name]) for part, names in scores.items() for name in names
        )
        if old and (scored or messages["VERDICT"]["LEVEL"]):
            self.violations[OLD_SCORE] += 1

    def _check_stop(
        self, messages: Messages, stopping: bool, ages_s: dict[str, float], clock_s: float
    ) -> None:
        """Lost inputs must stop the walk, and every other stop must be reported."""
        mode = int(messages["PLAN_EVENTS"]["MODE"])
        ended = mode in (STOPPING, STANDING) and self._mode in (STARTING, WALKING)
        if ended and self.walk_commanded and not stopping:
            self.violations[SILENT_STOP] += 1
        self._mode = mode
        needed = INPUTS if self._armed else INPUTS[:1]
        lost = any(ages_s[name] > self._limit_s(name) for name in needed)
        unusable = any(
            clock_s - self.records[name].usable_s > self._limit_s(name) + TICK_S for name in needed
        )
        self._stopping_s = self._stopping_s + TICK_S if stopping else 0.0
        still_walks = self._stopping_s > STOP_WITHIN_S and mode != STANDING
        if still_walks or ((lost or unusable) and not stopping):
            self.violations[NO_STOP] += 1


def plan_bounds(config: Any, body: Any) -> dict[str, tuple[float, float]]:
    """Bounds by message and signal: from the model, else from the core's range check of
    measurements.
    """
    fastest_m_s, upright, turned = body.speed_ceiling_m_s, math.pi / 2, 2 * math.pi
    step_m = LONGEST_STEP * body.half_step_max_m
    leg_m = (KNEE_HEIGHT * config.body_height_m, config.body_height_m)
    bounds = {
        "PLAN_COM Z": leg_m,
        "PLAN_LANDING X": (-step_m, step_m),
        "PLAN_LANDING LEG_LENGTH": leg_m,
        "PLAN_ANKLE TOE_OFF": (0.0, upright),
        "PLAN_ANKLE HEEL_STRIKE": (0.0, 2 * config.heel_strike_max_rad),  # [E12]
        "PLAN_ANKLE SPEED": (0.0, fastest_m_s),
        "PLAN_STEP THETA": (0.0, turned),
        "PLAN_STEP STEP_LENGTH": (0.0, step_m),
        "PLAN_EVENTS TIME_TO_VIA_POINT": (0.0, math.inf),
        "PLAN_EVENTS TIME_TO_HEEL_STRIKE": (0.0, math.inf),
        "PLAN_EVENTS TIME_TO_TOE_OFF": (0.0, math.inf),
        "PLAN_PITCH LEFT": (-upright, upright),
        "PLAN_PITCH RIGHT": (-upright, upright),
        "PLAN_PITCH KNEE_FLEXION": (0.0, body.pendulum_m),
    }
    for axis in ("VX", "VY", "VZ"):
        bounds[f"PLAN_COM_VELOCITY {axis}"] = (-COM_SPEED_M_S, COM_SPEED_M_S)
    for side in ("LEFT", "RIGHT"):
        bounds[f"PLAN_{side} Z"] = (0.0, body.pendulum_m)
    return {name: (low - ROUNDING, high + ROUNDING) for name, (low, high) in bounds.items()}


def _legs_reach(values: dict[str, float], body: Any) -> bool:
    """No planned foot is further from below the CoM than the leg's length."""
    com_m = complex(values["PLAN_COM X"], values["PLAN_COM Y"])
    feet_m = (
        complex(values[f"PLAN_{side} X"], values[f"PLAN_{side} Y"]) for side in ("LEFT", "RIGHT")
    )
    return all(abs(foot_m - com_m) <= body.pendulum_m for foot_m in feet_m)
