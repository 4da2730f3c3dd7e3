"""Recorded walks of people who did not fall, scored by the core: every alarm is false."""

import csv
import math
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from saddlewalk.core import Command, Core, Measurement, ffi, library
from saddlewalk.errors import UserError
from saddlewalk.evaluation.scoring import Levels, levels_in
from saddlewalk.gait.events import Gait, analyse
from saddlewalk.gait.playback import measurements, states_at_ticks
from saddlewalk.gait.recording import Recording, load_recording
from saddlewalk.ticks import Messages
from saddlewalk.verdict import level_name, reason_name, ticks_in

FIRST_S = 1.0  # beginning of a recording, in which the level may be unknown
MANIFEST = "manifest.csv"  # in the folder of the trials: file, and height_m, mass_kg if known


@dataclass(frozen=True)
class GaitTrial:
    """Announced levels of a recording."""

    name: str
    height_m: float
    speed_m_s: float
    levels: dict[str, int]  # ticks between the first heel strike and the last
    reasons: dict[str, int]  # reasons of the ticks that are not stable
    settled: Levels  # levels of all ticks after the first FIRST_S
    level_after_s: float  # from the beginning to the first known level; inf: never


def score_folder(folder: Path, config: Any) -> list[GaitTrial]:
    """Score every CSV file of a folder, with the body in its manifest or else that of config.

    Raises UserError if there is none, or one cannot be read.
    """
    bodies = _bodies(folder / MANIFEST)
    paths = sorted(path for path in folder.glob("*.csv") if path.name != MANIFEST)
    if not paths:
        raise UserError(f"--gait {folder}: no trials: give a folder with CSV files")
    return [score_trial(path, _with_body(config, bodies.get(path.name, {}))) for path in paths]


def score_trial(path: Path, config: Any) -> GaitTrial:
    recording = load_recording(str(path))
    gait = analyse(recording)
    core, ticks = Core(config), []
    for time_s, messages in measurements(states_at_ticks(recording, gait.contact)):
        verdict = core.tick(round(time_s * 1e6), Command(), _measurement(messages)).verdict
        ticks.append((time_s, verdict.level, verdict.reason))
    from_s, to_s = _walking(recording, gait)
    walking = [announced for time_s, *announced in ticks if from_s <= time_s <= to_s]
    settled = [announced for time_s, *announced in ticks if time_s > FIRST_S]
    stable, unknown = library().SADDLE_LEVEL_STABLE, library().SADDLE_LEVEL_UNKNOWN
    return GaitTrial(
        name=path.stem,
        height_m=config.body_height_m,
        speed_m_s=gait.speed_m_s,
        levels=ticks_in(level_name(level) for level, _ in walking),
        reasons=dict(Counter(reason_name(why) for level, why in walking if level != stable)),
        settled=levels_in(settled),
        level_after_s=next((time_s for time_s, level, _ in ticks if level != unknown), math.inf),
    )


def _walking(recording: Recording, gait: Gait) -> tuple[float, float]:
    """First and last heel strike, s from the start; without any, the whole trial."""
    strikes = np.concatenate([foot.heel_strikes for foot in gait.events])
    if len(strikes) == 0:
        return 0.0, math.inf
    since_start_s = recording.time_s - recording.time_s[0]
    return float(since_start_s[strikes.min()]), float(since_start_s[strikes.max()])


def _measurement(messages: Messages) -> Measurement:
    com, left, right = (messages[f"MEASURED_{name}"] for name in ("COM", "LEFT", "RIGHT"))

    def known(x: float, y: float) -> tuple[float, float] | None:
        return (x, y) if math.isfinite(x) and math.isfinite(y) else None

    return Measurement(
        com_height_m=com["HEIGHT"] if math.isfinite(com["HEIGHT"]) else None,
        com_velocity_m_s=known(com["VX"], com["VY"]),
        left_cop_m=known(left["X"], left["Y"]),
        right_cop_m=known(right["X"], right["Y"]),
        left_contact=bool(left["CONTACT"]),
        right_contact=bool(right["CONTACT"]),
    )


def _bodies(manifest: Path) -> dict[str, dict[str, float]]:
    """Fields of saddle_config_t by file name; empty without a manifest."""
    if not manifest.exists():
        return {}
    fields = {"height_m": "body_height_m", "mass_kg": "body_mass_kg"}
    with manifest.open(newline="") as file:
        return {
            row["file"]: {
                field: float(row[column]) for column, field in fields.items() if row.get(column)
            }
            for row in csv.DictReader(file)
        }


def _with_body(config: Any, body: dict[str, float]) -> Any:
    fitted = ffi().new("saddle_config_t *", config[0])
    for field, value in body.items():
        setattr(fitted, field, value)
    return fitted
