"""A walk on disk: the LCM event log, every CAN frame, and a CSV row a tick.

Each file is written during the walk and closed on any error, so what was recorded before it is
kept.
"""

import csv
import time
from pathlib import Path
from typing import Self

import can
import lcm

from saddlewalk import verdict
from saddlewalk.contract import MODES
from saddlewalk.emulation.exoskeleton import Observer, Tick
from saddlewalk.emulation.wearer import Plan, Wearer
from saddlewalk.errors import UserError
from saddlewalk.logs.run_files import CAN_LOG, LCM_LOG, TABLE
from saddlewalk.table import Cell, format_cell
from saddlewalk.ticks import Signals, scores_of
from saddlewalk.transport.lcmbus import listen, receive

LCM_CHANNELS = "SADDLEWALK_.*"
LCM_QUEUE = 2000
LAST_WORDS_S = 0.2  # for messages that are still in transit at the end
_PARTS = "CONFIG INPUT TURN FEET PLAN SCORES VERDICT BALANCE BOS WAY HEALTH STATUS TRUTH"
CHANNELS = tuple(f"SADDLEWALK_{part}" for part in _PARTS.split())

_POINTS = "com_x_m com_y_m com_z_m left_x_m left_y_m left_z_m right_x_m right_y_m right_z_m".split()
COLUMNS = (
    "t_s mode step_count phase theta_rad support".split()
    + [f"plan_{name}" for name in _POINTS]
    + "plan_speed_m_s s_pend s_jump s_sw mos_com_m mos_xcom_m v_comp_m_s".split()
    + "gravity_x_n gravity_y_n".split()
    + verdict.COLUMNS
    + "paper_stable xcom_deviation_x_m xcom_deviation_y_m".split()
    + "recovery_foot recovery_x_m recovery_y_m recovery_margin_m recovery_stops".split()
    + "faults limits".split()
    + [f"true_{name}" for name in _POINTS]
    + "true_com_vx_m_s true_com_vy_m_s true_cop_x_m true_cop_y_m left_contact right_contact".split()
    + "pushed_x_n_s pushed_y_n_s fallen".split()
    + "plan_left_yaw_rad plan_right_yaw_rad".split()
    + "true_left_yaw_rad true_right_yaw_rad true_pelvis_yaw_rad".split()
)

_SCORES = "S_PEND S_JUMP S_SW MOS_COM MOS_XCOM V_COMP GRAVITY_X GRAVITY_Y".split()


class Recorder(Observer):
    """Writes the LCM log, the CAN log and the table of a walk into a folder while it is open."""

    def __init__(self, folder: Path, bus: lcm.LCM) -> None:
        self.lcm_path = folder / LCM_LOG
        self.can_path = folder / CAN_LOG
        self.csv_path = folder / TABLE
        self.frames = self.rows = self.lcm_messages = 0
        self.levels: list[str] = []  # announced level of each tick until a fall
        try:
            self._csv_file = self.csv_path.open("w", newline="")
            self._can_log = can.CanutilsLogWriter(self.can_path, channel="saddlewalk")
            self._lcm_log = lcm.EventLog(str(self.lcm_path), "w", overwrite=True)
        except OSError as error:
            raise UserError(f"--out {folder}: {error.strerror}") from error
        self._csv = csv.writer(self._csv_file, lineterminator="\n")
        self._csv.writerow(COLUMNS)
        self._bus = bus
        self._subscription = bus.subscribe(LCM_CHANNELS, self._lcm_message)
        self._subscription.set_queue_capacity(LCM_QUEUE)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        listen(self._bus, LAST_WORDS_S)
        self._bus.unsubscribe(self._subscription)
        self._lcm_log.close()
        self._can_log.stop()
        self._csv_file.close()

    def frame(self, frame: can.Message) -> None:
        self._can_log.on_message_received(frame)
        self.frames += 1

    def tick(self, tick: Tick, wearer: Wearer) -> None:
        self._csv.writerow(format_cell(cell) for cell in row(tick, wearer))
        self.rows += 1
        if not wearer.fallen:
            self.levels.append(verdict.level_name(int(tick.messages["VERDICT"]["LEVEL"])))

    def poll(self) -> None:
        for _ in range(LCM_QUEUE):
            if not receive(self._bus):
                return

    def _lcm_message(self, channel: str, data: bytes) -> None:
        self._lcm_log.write_event(time.time_ns() // 1000, channel, data)
        self.lcm_messages += 1


def row(tick: Tick, wearer: Wearer) -> list[Cell]:
    """One line of walk.csv in the order of COLUMNS, in the world frame; cells are empty without a
    plan.
    """
    scores = scores_of(tick.messages)
    left, right = wearer.feet
    return [
        tick.time_s,
        *_planned(tick, wearer),
        *(scores[name] for name in _SCORES),
        *verdict.cells(scores),
        int(scores["PAPER_STABLE"]),
        *(scores[name] for name in ("XCOM_DEVIATION_X", "XCOM_DEVIATION_Y")),
        *_recovery(scores),
        f"0x{int(scores['FAULTS']):04x}",
        f"0x{int(tick.messages['HEALTH']['LIMITS']):02x}",
        *(wearer.com_m.real, wearer.com_m.imag, wearer.height_m),
        *(left.position_m.real, left.position_m.imag, left.height_m),
        *(right.position_m.real, right.position_m.imag, right.height_m),
        *(wearer.velocity_m_s.real, wearer.velocity_m_s.imag),
        *(wearer.cop_m.real, wearer.cop_m.imag),
        *(int(left.contact), int(right.contact)),
        *(wearer.pushed_n_s.real, wearer.pushed_n_s.imag),
        int(wearer.fallen),
        *(_yaws(tick.plan) if tick.plan else (None, None)),
        *(left.yaw_rad, right.yaw_rad, wearer.heading_rad),
    ]


def _yaws(plan: Plan) -> list[Cell]:
    return [plan.heading_rad + yaw_rad for yaw_rad in plan.yaw_rad]


def _recovery(scores: Signals) -> list[Cell]:
    """Cells: foot, position from the stance foot, remaining reach, whether it ends the walk."""
    foot = "right" if scores["FOOT"] else "left"
    return [
        foot if scores["COMPARED"] else None,
        *(scores[name] for name in ("X", "Y", "MARGIN")),
        verdict.known_bit(scores["STOPS"], scores["X"]),
    ]


def _planned(tick: Tick, wearer: Wearer) -> list[Cell]:
    if tick.plan is None:
        return [None] * (COLUMNS.index("plan_speed_m_s"))
    step = tick.messages["PLAN_STEP"]
    points = [tick.messages[name] for name in ("PLAN_COM", "PLAN_LEFT", "PLAN_RIGHT")]
    places = [wearer.in_world(complex(point["X"], point["Y"])) for point in points]
    return [
        MODES[tick.plan.mode],
        int(step["STEP_COUNT"]),
        int(step["PHASE"]),
        step["THETA"],
        "right" if step["SUPPORT"] else "left",
        *(
            value
            for place, point in zip(places, points, strict=True)
            for value in (place.real, place.imag, point["Z"])
        ),
        tick.plan.speed_m_s,
    ]
