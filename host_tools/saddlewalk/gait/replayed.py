"""The firmware's scores of a replayed walk, as table rows and as lines."""

import math

import numpy as np

from saddlewalk import verdict
from saddlewalk.gait.events import Gait
from saddlewalk.gait.recording import Recording
from saddlewalk.table import Cell

NUMBER_COLUMNS = "t_s v_comp_m_s s_pend s_jump s_sw mos_com_m mos_xcom_m".split()
SCORE_COLUMNS = [*NUMBER_COLUMNS, *verdict.COLUMNS, "recovery_margin_m", "faults"]


def score_row(time_s: float, scores: dict[str, float]) -> list[Cell]:
    """One line of --out, in the order of SCORE_COLUMNS."""
    names = ("V_COMP", "S_PEND", "S_JUMP", "S_SW", "MOS_COM", "MOS_XCOM")
    return [
        round(time_s, 6),
        *(scores[name] for name in names),
        *verdict.cells(scores),
        scores["MARGIN"],
        f"0x{scores['FAULTS']:04x}",
    ]


def report(recording: Recording, gait: Gait, rows: list[list[Cell]]) -> list[str]:
    """Lines `name value unit`: the walk from the markers, the rest from the firmware's scores."""
    numbers = np.array([row[: len(NUMBER_COLUMNS)] for row in rows])
    columns = dict(zip(NUMBER_COLUMNS, numbers.T, strict=True))
    scored = np.isfinite(columns["mos_com_m"])
    levels = verdict.ticks_in(str(row[SCORE_COLUMNS.index("level")]) for row in rows)
    return [
        f"source {recording.source}",
        _line("duration", recording.duration_s, "s"),
        _line("speed", gait.speed_m_s, "m/s"),
        _line("step_length", gait.step_length_m, "m"),
        _line("step_width", gait.step_width_m, "m"),
        _line("min_s_sw", _least(columns["s_sw"])),
        _line("com_in_bos", _share_positive(columns["mos_com_m"]), "%"),
        _line("xcom_in_bos", _share_positive(columns["mos_xcom_m"]), "%"),
        *(_line(name, 100.0 * ticks / len(rows), "%") for name, ticks in levels.items()),
        f"ticks_scored {scored.sum()}",
        f"ticks {len(rows)}",
    ]


def _line(name: str, value: float, unit: str = "") -> str:
    text = "n/a" if math.isnan(value) else f"{value:.4g}"
    return f"{name} {text} {unit}".rstrip()


def _least(values: np.ndarray) -> float:
    return min((value for value in values if math.isfinite(value)), default=math.nan)


def _share_positive(values: np.ndarray) -> float:
    """Percentage of the known values that are positive; NaN without any."""
    there = values[values == values]
    return 100.0 * float((there > 0).mean()) if len(there) else math.nan
