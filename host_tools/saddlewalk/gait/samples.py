"""Freely available recorded walks: two trials in the PyPI package gaitkit.

They hold hips, heels and toes as 3D points, in millimetres and in the axes of each laboratory. The
CoM is taken midway between the hips, which is the whole model: it moves like the CoM in the
transverse plane but lies about 0.1 m below it. Only gaitkit's data are read; none of its code runs.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.gait.motion_capture import load_walk, read_markers
from saddlewalk.gait.recording import Recording
from saddlewalk.paths import in_checkout, install_command


def recorded_walks(
    files: Sequence[str], sample: str | None, markers: str | None
) -> list[Recording]:
    """What RECORDING... or --sample names; markers: the file of --markers."""
    if sample:
        return [load_sample(sample)]
    mapping = read_markers(markers)
    return [load_walk(file, mapping) for file in files]


@dataclass(frozen=True)
class Sample:
    file: str
    to_task: tuple[tuple[int, int, int], ...]  # rows: our x, y, z in the laboratory's axes


SAMPLES = {
    # x forward, y up, z to the right
    "healthy": Sample("example_healthy.json", ((1, 0, 0), (0, 0, -1), (0, 1, 0))),
    # walks towards -x with z up
    "stroke": Sample("example_stroke.json", ((-1, 0, 0), (0, -1, 0), (0, 0, 1))),
}


def load_sample(name: str) -> Recording:
    """The recorded person `name` of SAMPLES. Raises UserError if gaitkit is not installed."""
    sample = SAMPLES[name]
    try:
        package = distribution("gaitkit")
        path = Path(str(package.locate_file(f"gaitkit/data/{sample.file}")))
        text = path.read_text(encoding="utf-8")
    except (PackageNotFoundError, FileNotFoundError) as error:
        how = "run `make samples`" if in_checkout() else install_command("samples")
        raise UserError(f"--sample {name} needs gaitkit 1.5.0: {how}") from error
    trial = json.loads(text)
    frames = trial["angle_frames"]
    point = {key: _points_m(frames, key, sample) for key in frames[0]["landmark_positions"]}
    return Recording(
        source=(
            f"{trial['description']} ({trial['source']}), from gaitkit {package.version}; "
            "CoM taken midway between the hips"
        ),
        time_s=np.array([frame["frame_index"] for frame in frames]) / trial["fps"],
        com_m=(point["left_hip"] + point["right_hip"]) / 2,
        heel_m=np.stack([point["left_heel"], point["right_heel"]]),
        toe_m=np.stack([point["left_toe"], point["right_toe"]]),
    )


def _points_m(frames: list[dict[str, Any]], key: str, sample: Sample) -> np.ndarray:
    """(n, 3) of one landmark in the task frame. gaitkit writes one that was not seen as zeros."""
    points_mm = np.array([frame["landmark_positions"][key] for frame in frames], dtype=float)
    points_mm[~points_mm.any(axis=1)] = np.nan
    return points_mm @ np.array(sample.to_task).T / 1000
