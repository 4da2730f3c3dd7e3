"""Walks as a motion-capture laboratory exports them, C3D or TRC, as recordings in the task frame.

CoM and CoP are the paper's: the CoM midway between the centres of the front and the rear iliac
markers, a foot's CoP midway between the heel and the middle of the metatarsus.
"""

import importlib.util
import math
import multiprocessing
import re
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.gait.recording import ABSURD_M, Recording, load_recording
from saddlewalk.paths import install_command
from saddlewalk.toml_file import read_toml

POINTS = ("front", "rear", "left_heel", "left_toe", "right_heel", "right_toe")
MAY_BE_MISSING = ("left_toe", "right_toe")
METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}

# Plug-in Gait first, then the usual names of the same places. "l" and "r" are the sides.
ILIAC = {"front": ("asi", "asis", "ias"), "rear": ("psi", "psis", "ips")}
SACRUM = ("sacr", "sacrum", "vsac", "vsacral")
HEEL = ("hee", "heel", "fcc", "cal", "calc")
METATARSUS = (("toe",), ("mt1", "mt5"), ("fm1", "fm5"), ("mt2", "mt5"), ("toelat", "toemed"))

WALKED_M = 1.0  # who went less far walked on a treadmill, or not at all
BELT_WINDOW_S = 0.1
SLOWEST_BELT_M_S = 0.1

Markers = Mapping[str, Sequence[str]]  # point of POINTS -> markers whose mean it is


@dataclass(frozen=True)
class Capture:
    """Markers in the axes of the laboratory, metres; NaN: not seen."""

    time_s: np.ndarray  # (n,)
    marker_m: dict[str, np.ndarray]  # name -> (n, 3)


def load_walk(source: str, markers: Markers | None = None) -> Recording:
    """A trial from .c3d, .trc or, any other name, CSV. `markers` goes before the built-in names.

    Raises UserError naming the file and what is wrong in it.
    """
    read = {".c3d": _read_c3d, ".trc": _read_trc}.get(Path(source).suffix.lower())
    if read is None:
        return load_recording(source)
    capture = read(Path(source))
    if len(capture.time_s) < 2:
        raise UserError(f"{source}: {len(capture.time_s)} frames; a trial needs at least 2")
    return _in_task_frame(source, capture.time_s, _points(source, capture, markers or {}))


def read_markers(path: Path) -> Markers:
    """The mapping file: TOML with a list of marker names for any of POINTS."""
    mapping = read_toml(path, "--markers")
    for point, names in mapping.items():
        if point not in POINTS:
            raise UserError(f"{path}: {point} is not one of {', '.join(POINTS)}")
        if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
            raise UserError(f"{path}: {point} = {names!r} must be a list of marker names")
    return mapping


def _points(source: str, capture: Capture, markers: Markers) -> dict[str, np.ndarray]:
    """(n, 3) of each point of POINTS; NaN for one that may be missing and is."""
    by_name = {_plain(name): xyz_m for name, xyz_m in capture.marker_m.items()}
    points = {}
    for point in POINTS:
        asked = [tuple(markers[point])] if point in markers else list(_usual_names(point))
        found = next((names for names in asked if all(_plain(n) in by_name for n in names)), None)
        if found is not None:
            points[point] = np.mean([by_name[_plain(name)] for name in found], axis=0)
        elif point in markers or point not in MAY_BE_MISSING:
            wanted = " or ".join(" and ".join(names) for names in asked)
            raise UserError(f"{source}: no markers for {point}: {wanted} (see --markers)")
        else:
            points[point] = np.full((len(capture.time_s), 3), np.nan)
    return points


def _usual_names(point: str) -> Iterator[tuple[str, ...]]:
    if point in ILIAC:
        yield from ((f"l{name}", f"r{name}") for name in ILIAC[point])
        if point == "rear":
            yield from ((name,) for name in SACRUM)
        return
    side, place = point[0], point.partition("_")[2]
    groups = [(name,) for name in HEEL] if place == "heel" else METATARSUS
    yield from (tuple(side + name for name in group) for group in groups)


def _plain(name: str) -> str:
    """A marker's name without the subject before it, case or punctuation: Ann:L.ASIS -> lasis."""
    return re.sub(r"[^a-z0-9]", "", name.rpartition(":")[2].lower())


def _in_task_frame(source: str, time_s: np.ndarray, points: dict[str, np.ndarray]) -> Recording:
    com_m = (points["front"] + points["rear"]) / 2
    heel_m = np.stack([points["left_heel"], points["right_heel"]])
    toe_m = np.stack([points["left_toe"], points["right_toe"]])
    for name, xyz_m in (("pelvis", com_m), ("left heel", heel_m[0]), ("right heel", heel_m[1])):
        if np.isfinite(xyz_m).all(axis=1).sum() < 2:
            raise UserError(f"{source}: the {name}'s markers are hardly ever seen")
    to_task = _axes(source, com_m, heel_m, toe_m)
    com_m, heel_m, toe_m = (xyz_m @ to_task.T for xyz_m in (com_m, heel_m, toe_m))
    origin_m = com_m[np.isfinite(com_m).all(axis=1)][0] * (1, 1, 0)
    belt_m_s = _belt_speed(time_s, heel_m[..., 0])
    way_m = np.stack([belt_m_s * (time_s - time_s[0]), 0 * time_s, 0 * time_s], axis=1) - origin_m
    treadmill = f", treadmill at {belt_m_s:.3g} m/s" if belt_m_s else ""
    return Recording(
        source=Path(source).name + treadmill,
        time_s=time_s,
        com_m=com_m + way_m,
        heel_m=heel_m + way_m,
        toe_m=toe_m + way_m,
    )


def _axes(source: str, com_m: np.ndarray, heel_m: np.ndarray, toe_m: np.ndarray) -> np.ndarray:
    """(3, 3), rows forward, left, up in the laboratory's axes.

    Up is the axis along which the pelvis is above the heels. Forward is the way that the pelvis
    goes or, on a treadmill, that the feet point.
    """
    above_m = (com_m - heel_m)[np.isfinite(com_m - heel_m).all(axis=2)]
    if not len(above_m):
        raise UserError(f"{source}: pelvis and heels are never seen together")
    above_m = np.median(above_m, axis=0)
    up = np.zeros(3)
    up[np.abs(above_m).argmax()] = np.sign(above_m[np.abs(above_m).argmax()])
    seen = np.flatnonzero(np.isfinite(com_m).all(axis=1))
    forward = _horizontal(com_m[seen[-1]] - com_m[seen[0]], up)
    if np.linalg.norm(forward) < WALKED_M:
        feet_m = (toe_m - heel_m)[np.isfinite(toe_m - heel_m).all(axis=2)]
        forward = _horizontal(feet_m.mean(axis=0), up) if len(feet_m) else np.zeros(3)
    if not np.linalg.norm(forward) > 0:
        raise UserError(f"{source}: no way to tell forward: the pelvis stays and no toe is seen")
    forward /= np.linalg.norm(forward)
    return np.stack([forward, np.cross(up, forward), up])


def _horizontal(vector: np.ndarray, up: np.ndarray) -> np.ndarray:
    return vector - vector @ up * up


def _belt_speed(time_s: np.ndarray, heel_x_m: np.ndarray) -> float:
    """What the foot that goes back fastest does most of the time; 0 over ground."""
    step = max(1, math.floor(BELT_WINDOW_S / float(np.median(np.diff(time_s)))))
    back_m_s = -(heel_x_m[:, step:] - heel_x_m[:, :-step]) / (time_s[step:] - time_s[:-step])
    both = back_m_s[:, np.isfinite(back_m_s).all(axis=0)]
    speed_m_s = float(np.median(both.max(axis=0))) if both.size else 0.0
    return speed_m_s if speed_m_s > SLOWEST_BELT_M_S else 0.0


def _read_c3d(path: Path) -> Capture:
    """In a process of its own: ezc3d may crash on a damaged file, and takes its process along."""
    if importlib.util.find_spec("ezc3d") is None:
        raise UserError(f"{path}: C3D needs ezc3d: {install_command('c3d')}")
    if not path.is_file():
        raise UserError(f"{path}: no such file")
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as reader:
        try:
            return reader.submit(_parse_c3d, path).result()
        except BrokenProcessPool as error:
            raise UserError(f"{path}: not a C3D file: ezc3d crashed on it") from error


def _parse_c3d(path: Path) -> Capture:
    import ezc3d

    try:
        trial = ezc3d.c3d(str(path))
        point = trial["parameters"]["POINT"]
        names = [name for key in _label_keys(point) for name in point[key]["value"]]
        rate_hz = float(point["RATE"]["value"][0])
        unit = point["UNITS"]["value"][0]
        points = trial["data"]["points"][:3]
        unseen = trial["data"]["meta_points"]["residuals"][0] < 0
    except (OSError, RuntimeError, ValueError, KeyError, IndexError, MemoryError) as error:
        raise UserError(f"{path}: not a C3D file with markers: {error}") from error
    if not 1 <= rate_hz < math.inf:
        raise UserError(f"{path}: POINT:RATE {rate_hz:g} must be a rate in Hz")
    points_m = np.where(unseen | ~points.any(axis=0), np.nan, points) * _metres(path, unit)
    return Capture(
        time_s=np.arange(points.shape[2]) / rate_hz,
        marker_m={name: _sane(points_m[:, i].T) for i, name in enumerate(names[: points.shape[1]])},
    )


def _label_keys(point: Mapping) -> list[str]:
    """LABELS holds 255 names, LABELS2 and so on further ones."""
    return sorted(
        (key for key in point if re.fullmatch(r"LABELS\d*", key)), key=lambda k: (len(k), k)
    )


def _read_trc(path: Path) -> Capture:
    """Tab-separated text: three header lines, one of marker names, one of axes, then frames."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: not TRC: {error}") from error
    if len(lines) < 6 or not lines[0].startswith("PathFileType"):
        raise UserError(f"{path}: not TRC: the first line must begin with PathFileType")
    header = dict(zip(lines[1].split(), lines[2].split(), strict=False))
    if "Units" not in header:
        raise UserError(f"{path}: not TRC: no Units in line 2")
    names = [name for name in lines[3].rstrip().split("\t")[2:] if name.strip()]
    rows = np.array(
        [_trc_row(path, i, line, len(names)) for i, line in enumerate(lines[5:], 6) if line.strip()]
    ).reshape(-1, 1 + 3 * len(names))
    backwards = np.flatnonzero(~(np.diff(rows[:, 0]) > 0))
    if len(backwards):
        raise UserError(f"{path}: frame {backwards[0] + 2}: the time must be later than before")
    xyz_m = rows[:, 1:].reshape(len(rows), len(names), 3) * _metres(path, header["Units"])
    return Capture(rows[:, 0], {name: _sane(xyz_m[:, i]) for i, name in enumerate(names)})


def _trc_row(path: Path, line: int, text: str, markers: int) -> list[float]:
    """Time and coordinates; an empty cell is a marker that was not seen."""
    cells = text.split("\t")[1:]
    cells += [""] * (1 + 3 * markers - len(cells))
    try:
        row = [float(cell) if cell.strip() else math.nan for cell in cells[: 1 + 3 * markers]]
    except ValueError as error:
        raise UserError(f"{path}: line {line}: {error}") from None
    if not math.isfinite(row[0]):
        raise UserError(f"{path}: line {line}: the time must be a number of seconds")
    return row


def _metres(path: Path, unit: str) -> float:
    if unit.strip().lower() not in METRES:
        raise UserError(f"{path}: unit {unit!r} must be one of {', '.join(METRES)}")
    return METRES[unit.strip().lower()]


def _sane(xyz_m: np.ndarray) -> np.ndarray:
    return np.where((np.abs(xyz_m) < ABSURD_M).all(axis=1)[:, None], xyz_m, np.nan)
