"""A recorded walker as states, one per row, from any supported recording."""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np

from saddlewalk.core import Measurement
from saddlewalk.gait.events import analyse
from saddlewalk.gait.measures import implausible
from saddlewalk.gait.motion_capture import READERS, Markers, load_walk
from saddlewalk.gait.recording import COLUMNS, Recording, recording_of
from saddlewalk.printable import printable
from saddlewalk.recorded_states import PELVIS_YAW, STATE_COLUMNS, measurement_of
from saddlewalk.table import read_any_series

State = Mapping[str, float]  # by STATE_COLUMNS; NaN: not measured

LONGEST_S = 1e9
GROUNDED_M = 1e-6  # a planned foot rests at 0 and flies above
PLAN_COLUMNS = (*STATE_COLUMNS[:-2], "left_z_m", "right_z_m")  # of saddlewalk plan
DEMO_COLUMNS = tuple(  # in a demo's walk.csv: the wearer's true state
    name if name == "t_s" or name.endswith("contact") else f"true_{name}" for name in STATE_COLUMNS
)
LAYOUTS = (
    (*STATE_COLUMNS, PELVIS_YAW),
    STATE_COLUMNS,
    (*PLAN_COLUMNS, PELVIS_YAW),
    PLAN_COLUMNS,
    (*DEMO_COLUMNS, f"true_{PELVIS_YAW}"),
    DEMO_COLUMNS,
    COLUMNS,
)


def read_measurements(
    source: str, markers: Markers, note: Callable[[str], None]
) -> Iterator[tuple[float, Measurement]]:
    """(time, what was measured) of each row or frame of a recording, or of a table of LAYOUTS.

    `note` is called with assumptions and warnings. Raises UserError naming the file and what is
    wrong in it.
    """
    if Path(source).suffix.lower() in READERS:
        recording = load_walk(source, markers)
        if recording.source != printable(Path(source).name):
            note(recording.source)
        yield from _recorded(recording, note)
        return
    rows = read_any_series(source, LAYOUTS, LONGEST_S)
    first = next(rows, None)
    if first is None:
        return
    rows = itertools.chain([first], rows)
    if set(COLUMNS) == first[1].keys():
        yield from _recorded(recording_of(source, (list(row.values()) for _, row in rows)), note)
    else:
        for line, row in rows:
            yield row["t_s"], measurement_of(f"{source}: line {line}", _state(row))


def _recorded(
    recording: Recording, note: Callable[[str], None]
) -> Iterator[tuple[float, Measurement]]:
    """(time, measurement) of each sample."""
    gait = analyse(recording)
    for line in implausible(recording, gait):
        note(line)
    for index, time_s in enumerate(map(float, recording.time_s)):
        state = state_at(recording, gait.contact, index, time_s)
        yield time_s, measurement_of(recording.source, state)


def state_at(recording: Recording, contact: np.ndarray, index: int, time_s: float) -> State:
    """A sample of the recording, as the state at time_s."""
    com_m, velocity_m_s = recording.com_m[index], recording.com_velocity_m_s[index]
    left_m, right_m = recording.cop_m[:, index]
    numbers = (time_s, *com_m, *velocity_m_s[:2], *left_m, *right_m, *contact[:, index])
    return dict(zip(STATE_COLUMNS, map(float, numbers), strict=True))


def nothing_at(time_s: float) -> State:
    return dict.fromkeys(STATE_COLUMNS, math.nan) | {"t_s": time_s}


def _state(row: Mapping[str, float]) -> State:
    """The state in a row of LAYOUTS but the last."""
    if "left_z_m" in row:
        on_ground = {
            f"{side}_contact": math.nan
            if math.isnan(row[f"{side}_z_m"])
            else float(row[f"{side}_z_m"] <= GROUNDED_M)
            for side in ("left", "right")
        }
        return {**row, **on_ground}
    return {name.removeprefix("true_"): value for name, value in row.items()}
