"""The gait of recorded people, trial by trial, for comparison with the plan."""

import csv
import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.gait.events import Gait, Placement, analyse, placements, step_pairs
from saddlewalk.gait.recording import Recording, load_recording

MANIFEST = "manifest.csv"


@dataclass(frozen=True)
class Trial:
    """Measurements of one recording. NaN: not measured."""

    name: str
    about: dict[str, str]  # its row in the manifest, if there is one
    recording: Recording
    placed: list[Placement]
    speed_m_s: float
    steps: int
    step_length_m: float
    step_width_m: float
    vertical_m: float  # peak to peak of the CoM's height in a stride, mean
    s_sw_min: float  # least S_SW of a step with the person's own width, mean

    @property
    def child(self) -> bool:
        return "child" in self.about.get("group", "")


def load_trials(folder: Path) -> list[Trial]:
    """Measure every trial (*.csv) of a folder, in order of speed.

    manifest.csv, if there, has a row for each `file` with the columns dataset, licence,
    group and note; an empty step_width_m there: its width means nothing. Raises
    UserError naming the folder, or the file that is not a trial.
    """
    if not folder.is_dir():
        raise UserError(f"--gait {folder}: no such folder")
    paths = [path for path in sorted(folder.glob("*.csv")) if path.name != MANIFEST]
    if not paths:
        raise UserError(f"--gait {folder}: no trials (*.csv) in it")
    manifest = _read_manifest(folder / MANIFEST)
    trials = [_measure(path, manifest.get(path.name, {})) for path in paths]
    return sorted(trials, key=lambda trial: trial.speed_m_s)


def _read_manifest(path: Path) -> dict[str, dict[str, str]]:
    """Its rows by file name; empty if there is no manifest."""
    if not path.exists():
        return {}
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file, restval="")
            if "file" not in (reader.fieldnames or ()):
                raise UserError(f"{path}: no column file")
            return {row["file"]: row for row in reader}
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    except (csv.Error, UnicodeDecodeError) as error:
        raise UserError(f"{path}: not CSV: {error}") from error


def _measure(path: Path, about: dict[str, str]) -> Trial:
    recording = load_recording(str(path))
    gait, placed = analyse(recording), placements(recording)
    comparable = about.get("step_width_m") != ""
    return Trial(
        name=path.stem,
        about=about,
        recording=recording,
        placed=placed,
        speed_m_s=gait.speed_m_s,
        steps=len(gait.step_lengths_m),
        step_length_m=gait.step_length_m,
        step_width_m=gait.step_width_m if comparable else np.nan,
        vertical_m=vertical_amplitude_m(recording, gait),
        s_sw_min=least_lateral_stability(recording, placed) if comparable else np.nan,
    )


def vertical_amplitude_m(recording: Recording, gait: Gait) -> float:
    """Mean peak-to-peak height of the CoM in a stride; in a step if no whole stride was seen."""
    by_foot = [foot.heel_strikes for foot in gait.events]
    strides = [pair for strikes in by_foot for pair in itertools.pairwise(strikes)]
    steps = itertools.pairwise(np.sort(np.concatenate(by_foot)))
    height_m = recording.com_m[:, 2]
    return _mean([np.ptp(height_m[first : end + 1]) for first, end in strides or steps])


def least_lateral_stability(recording: Recording, placed: list[Placement]) -> float:
    """Mean over the steps of the least S_SW, eq:11, with the width of the step itself."""
    return _mean([_least_s_sw(recording, a, b) for a, b in step_pairs(placed)])


def step_samples(a: Placement, b: Placement) -> slice:
    """From mid-stance on one foot to mid-stance on the next."""
    return slice((a.first + a.end) // 2, (b.first + b.end) // 2)


def _least_s_sw(recording: Recording, a: Placement, b: Placement) -> float:
    width_m = abs(a.cop_m[1] - b.cop_m[1])
    middle_m = (a.cop_m[1] + b.cop_m[1]) / 2
    aside_m = np.abs(recording.com_m[step_samples(a, b), 1] - middle_m)
    return 1 - 2 * aside_m.max(initial=0.0) / width_m if width_m > 0 else np.nan


def _mean(values: list[float]) -> float:
    """Mean of the values that are not NaN."""
    known = [value for value in values if np.isfinite(value)]
    return float(np.mean(known)) if known else np.nan
