"""From recorded states of a walker to the supervisor's scores, row by row."""

import cmath
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from saddlewalk.core import Command, Core, Measurement, ffi, library
from saddlewalk.errors import UserError
from saddlewalk.table import Cell
from saddlewalk.verdict import level_name

STATE_COLUMNS = (
    "t_s com_x_m com_y_m com_z_m com_vx_m_s com_vy_m_s left_x_m left_y_m right_x_m right_y_m "
    "left_contact right_contact"
).split()
PELVIS_YAW = "pelvis_yaw_rad"  # a column of walks that turn
SCORE_COLUMNS = (
    "t_s v_comp_m_s s_pend s_jump s_sw mos_com_m mos_xcom_m ebos_com_m ebos_xcom_m "
    "excess_stop_j excess_track_j can_stop on_track level flags recovery_margin_m margin"
).split()


_PLANE = [  # vectors, as pairs of columns
    (name, name.replace("x_m", "y_m")) for name in STATE_COLUMNS if "x_m" in name
]


def recording_core(config: Any) -> Core:
    """A core that never stops the walk for lost inputs. config: saddle_config_t, not changed."""
    patient = ffi().new("saddle_config_t *", config[0])
    patient.lost_inputs_stop = 0.0
    return Core(patient)


def scored_rows(
    core: Core, command: Command, measurements: Iterable[tuple[float, Measurement]]
) -> Iterator[list[Cell]]:
    """A row of SCORE_COLUMNS for each time in seconds and what was measured then."""
    start_s = None
    for t_s, measurement in measurements:
        start_s = t_s if start_s is None else start_s
        yield score_row(t_s, core.tick(round((t_s - start_s) * 1e6), command, measurement))


def measurement_of(where: str, state: Mapping[str, float]) -> Measurement:
    """The measurement in STATE_COLUMNS and, of a walk that turns, PELVIS_YAW; a number that is not
    finite was not measured.

    Raises UserError, beginning with `where`, for a contact that is neither 0 nor 1.
    """
    state = facing_forward(state)
    left_contact = _contact(where, state, "left_contact")
    right_contact = _contact(where, state, "right_contact")
    return Measurement(
        com_height_m=state["com_z_m"] if math.isfinite(state["com_z_m"]) else None,
        com_velocity_m_s=_known(state["com_vx_m_s"], state["com_vy_m_s"]),
        left_cop_m=_relative(state, "left") if left_contact is not None else None,
        right_cop_m=_relative(state, "right") if right_contact is not None else None,
        left_contact=bool(left_contact),
        right_contact=bool(right_contact),
    )


def facing_forward(state: Mapping[str, float]) -> Mapping[str, float]:
    """A state in axes of the pelvis's heading, about the same origin."""
    yaw_rad = state.get(PELVIS_YAW, 0.0)
    if yaw_rad == 0:
        return state
    to_pelvis = cmath.rect(1.0, -yaw_rad) if math.isfinite(yaw_rad) else complex(math.nan, math.nan)
    turned = dict(state)
    for x, y in _PLANE:
        vector = complex(state[x], state[y]) * to_pelvis
        turned[x], turned[y] = vector.real, vector.imag
    return turned


def _known(x: float, y: float) -> tuple[float, float] | None:
    return (x, y) if math.isfinite(x) and math.isfinite(y) else None


def _relative(state: Mapping[str, float], foot: str) -> tuple[float, float] | None:
    return _known(state[f"{foot}_x_m"] - state["com_x_m"], state[f"{foot}_y_m"] - state["com_y_m"])


def _contact(where: str, state: Mapping[str, float], column: str) -> bool | None:
    value = state[column]
    if not math.isfinite(value):
        return None
    if value not in (0.0, 1.0):
        raise UserError(f"{where}, {column}: {value:g} must be 0 or 1")
    return bool(value)


def score_row(t_s: float, output: Any) -> list[Cell]:
    """Cells of SCORE_COLUMNS from a saddle_output_t; None: a result that is not there."""
    core, scores, verdict = library(), output.scores, output.verdict

    def scored(value: float, bit: int, faults_with_zero: int = 0) -> float | None:
        known = scores.valid & bit or output.faults & faults_with_zero
        return value if known else None

    def compared(value: float, bit: int = 0) -> float | None:
        return value if verdict.compared and scores.valid & bit == bit else None

    infeasible = core.SADDLE_FAULT_SPEED_INFEASIBLE
    return [
        t_s,
        scored(scores.v_comp_m_s, core.SADDLE_VALID_V_COMP),
        scored(scores.s_pend, core.SADDLE_VALID_STEP, infeasible),
        scored(scores.s_jump, core.SADDLE_VALID_STEP, infeasible),
        scored(scores.s_sw, core.SADDLE_VALID_S_SW),
        scored(scores.mos_com_m, core.SADDLE_VALID_MOS_COM),
        scored(scores.mos_xcom_m, core.SADDLE_VALID_MOS_XCOM),
        compared(verdict.ebos_com_m),
        compared(verdict.ebos_xcom_m),
        scored(scores.excess_stop_j, core.SADDLE_VALID_STOP),
        compared(verdict.excess_track_j, core.SADDLE_VALID_STOP),
        scored(int(scores.can_stop), core.SADDLE_VALID_STOP),
        compared(int(verdict.on_track), core.SADDLE_VALID_STOP),
        level_name(verdict.level),
        _flags(output),
        compared(verdict.recovery.margin_m),
        verdict.margin if verdict.margin_known else None,
    ]


def _flags(output: Any) -> str:
    """Hex: bits 0-15 saddle_fault_t, 16-23 saddle_limit_t, 24-31 the saddle_reason_t."""
    return f"0x{output.faults | output.limits << 16 | output.verdict.reason << 24:08x}"
