"""`saddlewalk supervise`: scores of recorded states, from the C core."""

import argparse
import math
import sys
from collections.abc import Iterator
from typing import Any

from saddlewalk.config import add_body_options, load_config
from saddlewalk.errors import UserError
from saddlewalk.options import speed
from saddlewalk.table import Cell, read_series, write_table
from saddlewalk.verdict import level_name

STATE_COLUMNS = (
    "t_s com_x_m com_y_m com_z_m com_vx_m_s com_vy_m_s left_x_m left_y_m right_x_m right_y_m "
    "left_contact right_contact"
).split()
LONGEST_S = 1e9
SCORE_COLUMNS = (
    "t_s v_comp_m_s s_pend s_jump s_sw mos_com_m mos_xcom_m ebos_com_m ebos_xcom_m "
    "excess_stop_j excess_track_j can_stop on_track level flags"
).split()


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "supervise",
        help="score recorded states as CSV",
        description="Score recorded states as CSV. An empty cell is a result that is not there. "
        "flags: bits 0-15 saddle_fault_t, 16-23 saddle_limit_t, 24-31 the saddle_reason_t that "
        "decided the level.",
    )
    parser.add_argument(
        "--in", dest="source", required=True, metavar="FILE", help="states as CSV; - reads stdin"
    )
    parser.add_argument("--out", metavar="FILE", help="default: standard output")
    parser.add_argument(
        "--speed",
        type=speed,
        metavar="M/S",
        help="compare with the steady walk that is planned at this speed, its left foot under the "
        "CoM in the first row; default: with the recorded walk's own last step",
    )
    add_body_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from saddlewalk.core import Command, Core, library

    config = load_config(args)
    config.lost_inputs_stop = 0.0  # a recording goes on whatever it lacks
    core = Core(config)
    command = Command(args.speed)
    if args.speed is not None:
        core.join(command)
        ceiling_m_s = library().saddle_body(config).speed_ceiling_m_s
        if args.speed >= ceiling_m_s:
            note = f"is not feasible for this body: limited below {ceiling_m_s:.4g} m/s"
            print(f"saddlewalk supervise: --speed {args.speed:g} {note}", file=sys.stderr)
    write_table(args.out, SCORE_COLUMNS, _scores(core, command, args.source))
    return 0


def _scores(core: Any, command: Any, source: str) -> Iterator[list[Cell]]:
    start_s = None
    for line, state in read_series(source, STATE_COLUMNS, LONGEST_S):
        t_s = state["t_s"]
        start_s = t_s if start_s is None else start_s
        measurement = _measurement(source, line, state)
        yield _row(t_s, core.tick(round((t_s - start_s) * 1e6), command, measurement))


def _measurement(source: str, line: int, state: dict[str, float]) -> Any:
    from saddlewalk.core import Measurement

    left_contact = _contact(source, line, state, "left_contact")
    right_contact = _contact(source, line, state, "right_contact")
    velocity = _known(state["com_vx_m_s"], state["com_vy_m_s"])
    return Measurement(
        com_height_m=state["com_z_m"] if math.isfinite(state["com_z_m"]) else None,
        com_velocity_m_s=velocity,
        left_cop_m=_relative(state, "left") if left_contact is not None else None,
        right_cop_m=_relative(state, "right") if right_contact is not None else None,
        left_contact=bool(left_contact),
        right_contact=bool(right_contact),
    )


def _known(x: float, y: float) -> tuple[float, float] | None:
    return (x, y) if math.isfinite(x) and math.isfinite(y) else None


def _relative(state: dict[str, float], foot: str) -> tuple[float, float] | None:
    return _known(state[f"{foot}_x_m"] - state["com_x_m"], state[f"{foot}_y_m"] - state["com_y_m"])


def _contact(source: str, line: int, state: dict[str, float], column: str) -> bool | None:
    value = state[column]
    if not math.isfinite(value):
        return None
    if value not in (0.0, 1.0):
        raise UserError(f"{source}: line {line}, {column}: {value:g} must be 0 or 1")
    return bool(value)


def _row(t_s: float, output: Any) -> list[Cell]:
    from saddlewalk.core import library

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
        flags(output),
    ]


def flags(output: Any) -> str:
    """Hex: bits 0-15 saddle_fault_t, 16-23 saddle_limit_t, 24-31 the saddle_reason_t."""
    return f"0x{output.faults | output.limits << 16 | output.verdict.reason << 24:08x}"
