"""Walks as a motion-capture laboratory exports them, C3D or TRC, as recordings in the task frame.

CoM and CoP are the paper's: the CoM midway between the centres of the front and the rear iliac
markers, a foot's CoP midway between the heel and the middle of the metatarsus.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import median_filter

from saddlewalk.errors import UserError
from saddlewalk.gait.c3d_file import read_c3d
from saddlewalk.gait.capture import METRES, Capture
from saddlewalk.gait.gaps import fill_gaps
from saddlewalk.gait.recording import ABSURD_M, Recording, load_recording
from saddlewalk.gait.trc_file import read_trc
from saddlewalk.printable import printable
from saddlewalk.toml_file import read_toml

POINTS = ("front", "rear", "left_heel", "left_toe", "right_heel", "right_toe")
MAY_BE_MISSING = ("left_toe", "right_toe")
READERS = {".c3d": read_c3d, ".trc": read_trc}

# Names of Plug-in Gait, then other usual ones. "l" and "r" are the sides.
ILIAC = {
    "front": ("asi", "asis", "ias", "sias", "fwt"),
    "rear": ("psi", "psis", "ips", "sips", "bwt"),
}
SACRUM = ("sacr", "sacrum", "vsac", "vsacral", "sacral")
HEEL = (
    *((name,) for name in ("hee", "heel", "fcc", "cal", "calc", "calcaneus")),
    *((f"{name}med", f"{name}lat") for name in ("heel", "hee", "calc", "cal")),
)
METATARSUS = (
    ("toe",),
    *((f"{bone}{inner}", f"{bone}5") for bone in ("mt", "fm", "mth", "met") for inner in "12"),
    *((f"{inner}{bone}", f"5{bone}") for bone in ("mt", "mth", "met", "meta") for inner in "12"),
    ("d1mt", "d5mt"),
    ("toelat", "toemed"),
    *((f"{bone}2",) for bone in ("mt", "fm", "mth", "met")),
)

SIDE_FIRST = re.compile(r"(?P<side>left|right)(?P<place>.+)")
SIDE_LAST = re.compile(r"(?![lr][._ -])(?P<place>.+)[._ -](?P<side>l|r|left|right)")

WALKED_M = 1.0  # a shorter path means a treadmill, or no walk
BELT_WINDOW_S, BELT_MEDIAN_S = 0.1, 1.0
SHORTEST_BELT_S = 3.0  # a foot drawn back for less is no treadmill
SAME_SPEED = 0.1  # a belt's speed that varies by less is one number
SLOWEST_BELT_M_S = 0.1
PELVIS_M = (0.25, 1.5)  # pelvis above the heels, from a child of two to the tallest adult

Markers = Mapping[str, Sequence[str]]  # point of POINTS -> markers whose mean it is


def load_walk(source: str, markers: Markers | None = None) -> Recording:
    """A trial from a .c3d or .trc file, else CSV. `markers` takes precedence over the built-in
    names.

    Raises UserError naming the file and what is wrong in it.
    """
    read = READERS.get(Path(source).suffix.lower())
    if read is None:
        return load_recording(source)
    capture = read(Path(source))
    if len(capture.time_s) < 2:
        raise UserError(f"{source}: {len(capture.time_s)} frames; a trial needs at least 2")
    points, filled = _points(source, capture, markers or {})
    unit = capture.unit or _likely_unit(source, points)
    notes = [
        f"no unit in the file, {unit} assumed" if not capture.unit else "",
        f"{filled} short gaps filled" if filled else "",
    ]
    points_m = {name: _sane(xyz * METRES[unit]) for name, xyz in points.items()}
    return _in_task_frame(source, capture.time_s, points_m, notes)


def read_markers(file: str | None) -> Markers:
    """The mapping file, if given: TOML with a list of marker names for any of POINTS."""
    if file is None:
        return {}
    path = Path(file)
    mapping = read_toml(path, "--markers")
    for point, names in mapping.items():
        if point not in POINTS:
            raise UserError(f"{path}: {point} is not one of {', '.join(POINTS)}")
        if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
            raise UserError(f"{path}: {point} = {names!r} must be a list of marker names")
    return mapping


def _points(source: str, capture: Capture, markers: Markers) -> tuple[dict[str, np.ndarray], int]:
    """Each of POINTS as (n, 3) with gaps filled; all NaN for an optional point without markers."""
    by_name: dict[str, list[str]] = {}
    for name in capture.markers:
        for key in {_plain(name), _full(name)}:
            by_name.setdefault(key, []).append(name)
    points: dict[str, np.ndarray] = {}
    filled: dict[str, tuple[np.ndarray, int]] = {}
    for point in POINTS:
        names = _choose(source, point, capture, markers, by_name)
        for name in names:
            filled.setdefault(name, fill_gaps(capture.time_s, capture.markers[name]))
        points[point] = (
            np.mean([filled[name][0] for name in names], axis=0)
            if names
            else np.full((len(capture.time_s), 3), np.nan)
        )
    return points, sum(count for _, count in filled.values())


def _choose(
    source: str, point: str, capture: Capture, markers: Markers, by_name: Mapping[str, list[str]]
) -> list[str]:
    """The file's markers whose mean is the point; empty for a missing optional point."""
    given = point in markers
    asked = [tuple(markers[point])] if given else list(_usual_names(point))
    there = [
        [by_name[_full(name) if given else name] for name in names]
        for names in asked
        if all((_full(name) if given else name) in by_name for name in names)
    ]
    if not there:
        if point in MAY_BE_MISSING and not given:
            return []
        wanted = " or ".join(" and ".join(names) for names in asked)
        raise UserError(f"{source}: no markers for {point}: {wanted} (see --markers)")
    seen = [
        found
        for found in there
        if all(np.isfinite(capture.markers[names[0]]).any() for names in found)
    ]
    chosen = (seen or there)[0]
    for names in chosen:
        if len(names) > 1:
            raise UserError(
                f"{source}: {' and '.join(names)} could each be {point}: name one in --markers"
            )
    return [names[0] for names in chosen]


def _usual_names(point: str) -> Iterator[tuple[str, ...]]:
    if point in ILIAC:
        yield from ((f"l{name}", f"r{name}") for name in ILIAC[point])
        if point == "rear":
            yield from ((name,) for name in SACRUM)
        return
    side, place = point[0], point.partition("_")[2]
    groups = HEEL if place == "heel" else METATARSUS
    yield from (tuple(side + name for name in group) for group in groups)


def _full(name: str) -> str:
    """A marker's name without case or punctuation: Ann:L.ASIS -> annlasis."""
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _plain(name: str) -> str:
    """A marker's name without the subject, with its side in front: Ann:Heel_Left -> lheel."""
    words = name.rpartition(":")[2].lower().removesuffix("_study")  # of OpenCap
    for pattern in (SIDE_FIRST, SIDE_LAST):
        if match := pattern.fullmatch(words):
            return match["side"][0] + _full(match["place"])
    return _full(words)


def _likely_unit(source: str, points: dict[str, np.ndarray]) -> str:
    """The unit that gives a person's height of the pelvis above the heels."""
    pelvis = (points["front"] + points["rear"]) / 2
    above = np.concatenate([pelvis - points[f"{side}_heel"] for side in ("left", "right")])
    above = above[np.isfinite(above).all(axis=1)]
    height = float(np.abs(np.median(above, axis=0)).max()) if len(above) else math.nan
    low_m, high_m = PELVIS_M
    for unit, metres in METRES.items():
        if low_m <= height * metres <= high_m:
            return unit
    raise UserError(
        f"{source}: no unit in the file, and none fits: the pelvis is {height:.4g} above the "
        f"heels; {low_m:g} to {high_m:g} m in one of {', '.join(METRES)}"
    )


def _in_task_frame(
    source: str, time_s: np.ndarray, points: dict[str, np.ndarray], notes: Sequence[str]
) -> Recording:
    com_m = (points["front"] + points["rear"]) / 2
    heel_m = np.stack([points["left_heel"], points["right_heel"]])
    toe_m = np.stack([points["left_toe"], points["right_toe"]])
    for name, xyz_m in (("pelvis", com_m), ("left heel", heel_m[0]), ("right heel", heel_m[1])):
        if np.isfinite(xyz_m).all(axis=1).sum() < 2:
            raise UserError(f"{source}: the {name}'s markers are hardly ever visible")
    to_task = _axes(source, com_m, heel_m, toe_m)
    com_m, heel_m, toe_m = (xyz_m @ to_task.T for xyz_m in (com_m, heel_m, toe_m))
    origin_m = com_m[np.isfinite(com_m).all(axis=1)][0] * (1, 1, 0)
    belt_m_s = _belt_speed(time_s, heel_m[..., 0])
    walked_m = cumulative_trapezoid(belt_m_s, time_s, initial=0.0)
    way_m = np.stack([walked_m, 0 * time_s, 0 * time_s], axis=1) - origin_m
    notes = [Path(source).name, _treadmill(belt_m_s), *notes]
    return Recording(
        source=printable(", ".join(filter(None, notes))),
        time_s=time_s,
        com_m=com_m + way_m,
        heel_m=heel_m + way_m,
        toe_m=toe_m + way_m,
    )


def _axes(source: str, com_m: np.ndarray, heel_m: np.ndarray, toe_m: np.ndarray) -> np.ndarray:
    """(3, 3), rows forward, left, up in the laboratory's axes.

    Up is the axis along which the pelvis is above the heels. Forward is the direction in which the
    pelvis moves or, on a treadmill, in which the feet point.
    """
    above_m = (com_m - heel_m)[np.isfinite(com_m - heel_m).all(axis=2)]
    if not len(above_m):
        raise UserError(f"{source}: pelvis and heels are never visible together")
    above_m = np.median(above_m, axis=0)
    up = np.zeros(3)
    up[np.abs(above_m).argmax()] = np.sign(above_m[np.abs(above_m).argmax()])
    seen = np.flatnonzero(np.isfinite(com_m).all(axis=1))
    forward = _horizontal(com_m[seen[-1]] - com_m[seen[0]], up)
    if np.linalg.norm(forward) < WALKED_M:
        feet_m = (toe_m - heel_m)[np.isfinite(toe_m - heel_m).all(axis=2)]
        forward = _horizontal(feet_m.mean(axis=0), up) if len(feet_m) else np.zeros(3)
    if not np.linalg.norm(forward) > 0:
        raise UserError(
            f"{source}: forward is unknown: the pelvis does not move and no toe is visible"
        )
    forward /= np.linalg.norm(forward)
    return np.stack([forward, np.cross(up, forward), up])


def _horizontal(vector: np.ndarray, up: np.ndarray) -> np.ndarray:
    return vector - vector @ up * up


def _belt_speed(time_s: np.ndarray, heel_x_m: np.ndarray) -> np.ndarray:
    """(n,) the belt's speed: that of the foot that moves back fastest, in the median of a second;
    0 over ground.
    """
    still_m_s = np.zeros_like(time_s)
    sample_s = float(np.median(np.diff(time_s)))
    step = max(1, math.floor(BELT_WINDOW_S / sample_s))
    back_m_s = -(heel_x_m[:, step:] - heel_x_m[:, :-step]) / (time_s[step:] - time_s[:-step])
    seen = np.flatnonzero(np.isfinite(back_m_s).all(axis=0))
    if not len(seen):
        return still_m_s
    between_s = (time_s[step:] + time_s[:-step]) / 2
    second = max(1, round(BELT_MEDIAN_S / sample_s))
    speed_m_s = median_filter(back_m_s[:, seen].max(axis=0), second, mode="reflect")
    moves = speed_m_s > SLOWEST_BELT_M_S
    if moves.sum() * sample_s < min(SHORTEST_BELT_S, len(seen) * sample_s / 2):
        return still_m_s
    usual_m_s = np.median(speed_m_s[moves])
    if np.abs(np.percentile(speed_m_s, (5, 95)) / usual_m_s - 1).max() < SAME_SPEED:
        return still_m_s + usual_m_s
    speed_m_s = np.interp(time_s, between_s[seen], speed_m_s)
    return np.where(speed_m_s > SLOWEST_BELT_M_S, speed_m_s, 0.0)


def _treadmill(belt_m_s: np.ndarray) -> str:
    """What a reader of the recording is told of it."""
    least, most = belt_m_s.min(), belt_m_s.max()
    if not most:
        return ""
    return f"treadmill at {most:.3g} m/s" if least == most else f"treadmill, up to {most:.3g} m/s"


def _sane(xyz_m: np.ndarray) -> np.ndarray:
    return np.where((np.abs(xyz_m) < ABSURD_M).all(axis=1)[:, None], xyz_m, np.nan)
