"""Files of motion-capture laboratories: damaged ones, units, names of markers, gaps."""

import json
import struct
import subprocess
import sys
import time

import numpy as np
import pytest

from laboratory import LABORATORIES, PERSON, RATE_HZ, c3d_file, laboratory, trc_file, walk_of
from saddlewalk.errors import UserError
from saddlewalk.gait.c3d_layout import check_layout
from saddlewalk.gait.measures import measure
from saddlewalk.gait.motion_capture import load_walk
from sanitizer import WITHOUT

AXES = LABORATORIES["z up, walking along -y"]
BLOCK = 512


def markers(duration_s: float = 3.0) -> dict[str, np.ndarray]:
    return laboratory(walk_of(PERSON, 1.0, duration_s), AXES)


def renamed(names: dict[str, str]) -> dict[str, np.ndarray]:
    return {names.get(name, name): xyz for name, xyz in markers().items()}


@pytest.fixture(scope="module")
def c3d(tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("c3d") / "walk.c3d"
    c3d_file(path, markers(0.2))
    return path.read_bytes()


def place(data: bytes, name: str, group: str = "POINT") -> int:
    """Where the type of a parameter is, its dimensions and value behind it."""
    at = data.index(group.encode(), BLOCK)
    return data.index(name.encode(), at) + len(name) + 2


def patched(data: bytes, at: int, new: bytes) -> bytes:
    return data[:at] + new + data[at + len(new) :]


DAMAGED = {
    "header's key": (lambda d: patched(d, 1, b"\x51"), "byte 2 is 0x51, must be 0x50"),
    "parameters beyond the end": (lambda d: patched(d, 0, b"\xff"), "begin in block 255 of"),
    "processor": (lambda d: patched(d, BLOCK + 3, b"\x00"), "type 0 must be one of 84, 85, 86"),
    "record beyond the end": (
        lambda d: patched(d, place(d, "LABELS") - 2, b"\xff\xff"),
        "'LABELS' at byte .* is 65535 bytes long; 3 to .* fit",
    ),
    "dimensions": (
        lambda d: patched(d, place(d, "LABELS") + 1, b"\x07" + b"\xff" * 7),
        "'LABELS' is 255 x 255 x .* elements of 1 bytes; its record has room for",
    ),
    "too many dimensions": (
        lambda d: patched(d, place(d, "LABELS") + 1, b"\x80"),
        "'LABELS' has type -1 and 128 dimensions",
    ),
    "empty texts without number": (
        lambda d: patched(d, place(d, "LABELS") + 1, b"\x07\x00" + b"\xff" * 6),
        "'LABELS' is 0 x 255 x 255",
    ),
    "type": (lambda d: patched(d, place(d, "RATE"), b"\x03"), "'RATE' has type 3"),
    "data beyond the end": (
        lambda d: patched(d, 16, struct.pack("<H", 9999)),
        "data begin in block 9999 of",
    ),
    "points": (
        lambda d: patched(d, place(d, "USED") + 2, b"\xff\xff"),
        "40 frames of 65535 points and 0 analog values take 41942400 bytes; the file has",
    ),
    "no points": (
        lambda d: patched(d, place(d, "USED") + 2, bytes(2)),
        "POINT:USED is 0: there are no markers",
    ),
    "cut": (lambda d: d[: -2 * BLOCK], r"40 frames of 8 points and 0 analog values take 5120"),
    "empty": (lambda d: b"", "0 bytes; header and parameters take 1024 or more"),
}


@pytest.mark.parametrize(("damage", "words"), DAMAGED.values(), ids=DAMAGED)
def test_a_damaged_c3d_file_names_what_does_not_fit(damage, words, c3d, tmp_path):
    path = tmp_path / "walk.c3d"
    path.write_bytes(damage(c3d))
    with pytest.raises(UserError, match=words) as refused:
        load_walk(str(path))
    assert str(path) in str(refused.value) and "\n" not in str(refused.value)


# Parses each file that is named in a process of its own; prints the worst of them.
PARSE_EACH = """
import json, os, sys, pathlib
import ezc3d
from saddlewalk.errors import UserError
from saddlewalk.gait import c3d_file
worst = {"seconds": 0.0, "megabytes": 0.0, "parsed": 0, "refused": 0, "crashed": 0}
for path in map(pathlib.Path, sys.stdin.read().split()):
    child = os.fork()
    if child == 0:
        try:
            c3d_file._parse(path, c3d_file._limits(path))
        except UserError:
            os._exit(1)
        os._exit(0)
    _, status, used = os.wait4(child, 0)
    worst["seconds"] = max(worst["seconds"], used.ru_utime + used.ru_stime)
    worst["megabytes"] = max(worst["megabytes"], used.ru_maxrss / 1024)
    worst[{0: "parsed", 256: "refused"}.get(status, "crashed")] += 1
print(json.dumps(worst))
"""


def test_no_altered_byte_makes_the_c3d_reader_exceed_its_limits(c3d, tmp_path):
    # 0x80 and 0xff make counts and lengths as large as they can be. Every third byte of header and
    # parameters, where 12 GB and 50 s were taken.
    data_start = BLOCK * (struct.unpack_from("<H", c3d, 16)[0] - 1)
    kept, refused = [], 0
    started_s = time.process_time()
    for value in (0x80, 0xFF):
        for at in range(value % 3, data_start, 3):
            path = tmp_path / f"{at}-{value}.c3d"
            path.write_bytes(patched(c3d, at, bytes([value])))
            try:
                check_layout(path)
                kept.append(str(path))
            except UserError:
                refused += 1
                path.unlink()
    assert time.process_time() - started_s < 10
    assert refused > 100
    kept = kept[::4]
    done = subprocess.run(
        [sys.executable, "-c", PARSE_EACH],
        input="\n".join(kept),
        text=True,
        check=True,
        capture_output=True,
        env=WITHOUT,
    )
    worst = json.loads(done.stdout)
    assert worst["parsed"] > 100
    assert worst["seconds"] < 2
    assert worst["megabytes"] < 200


def test_a_reader_that_exceeds_its_limits_is_stopped(tmp_path, monkeypatch):
    (tmp_path / "ezc3d.py").write_text("def c3d(path):\n    bytearray(1 << 30)\n")
    monkeypatch.syspath_prepend(tmp_path)
    path = c3d_file(tmp_path / "walk.c3d", markers())
    with pytest.raises(UserError, match=r"walk\.c3d: not a C3D file"):
        load_walk(path)
    (tmp_path / "ezc3d.py").write_text("def c3d(path):\n    while True:\n        pass\n")
    monkeypatch.setattr("saddlewalk.gait.c3d_file.LEAST_CPU_S", 1.0)
    with pytest.raises(UserError, match=r"walk\.c3d: .* took more than"):
        load_walk(path)


METRE_TEXTS = {"m": 1, "mete": 1, "metres": 1, "mm": 1e3, "mill": 1e3, "cent": 1e2, " MM ": 1e3}


@pytest.mark.parametrize("unit", METRE_TEXTS)
def test_unit_may_be_a_word_or_the_beginning_of_one(unit, tmp_path):
    scaled = {name: xyz * METRE_TEXTS[unit] / 1e3 for name, xyz in markers().items()}
    loaded = load_walk(c3d_file(tmp_path / "walk.c3d", scaled, unit))
    assert loaded.com_m[:, 2] == pytest.approx(walk_of(PERSON, 1.0, 3.0).com_m[:, 2], abs=1e-4)
    assert "assumed" not in loaded.source


def test_an_unknown_unit_is_named(tmp_path):
    with pytest.raises(UserError, match=r"unit 'inch' must be one of m, cm, mm"):
        load_walk(c3d_file(tmp_path / "walk.c3d", markers(), "inch"))


def without_units(path) -> str:
    data = path.read_bytes()
    path.write_bytes(patched(data, data.index(b"UNITS"), b"UNITX"))
    return str(path)


@pytest.mark.parametrize("unit", ["m", "cm", "mm"])
def test_a_missing_unit_is_inferred_from_the_walkers_size(unit, tmp_path):
    path = tmp_path / "walk.c3d"
    c3d_file(
        path, {name: xyz * METRE_TEXTS.get(unit, 1e2) / 1e3 for name, xyz in markers().items()}
    )
    loaded = load_walk(without_units(path))
    assert loaded.com_m[:, 2] == pytest.approx(walk_of(PERSON, 1.0, 3.0).com_m[:, 2], abs=1e-4)
    assert loaded.source == f"walk.c3d, no unit in the file, {unit} assumed"


def test_a_missing_unit_that_cannot_be_inferred_is_rejected(tmp_path):
    path = tmp_path / "walk.c3d"
    c3d_file(path, {name: xyz * 7 for name, xyz in markers().items()})
    with pytest.raises(UserError, match="no unit in the file, and none fits: the pelvis is 6"):
        load_walk(without_units(path))


SIDES = (("L", "R"), ("R", "L"))
PAIRS = {
    "heels, inner and outer": {"HEE": ("{}.Heel.Med", "{}.Heel.Lat")},
    "second and fifth metatarsal": {"TOE": ("{}FM2", "{}FM5")},
    "first and fifth metatarsal": {"TOE": ("{}_1MT", "{}_5MT")},
}
SINGLE = {
    "Cortex": {"ASI": "{}.ASIS", "PSI": "{}.PSIS", "HEE": "{}.Heel", "TOE": "{}.Toe"},
    "side in words": {
        "ASI": "{word}_ASIS",
        "PSI": "{word}_PSIS",
        "HEE": "{word}Heel",
        "TOE": "{word}Toe",
    },
    "side last": {"ASI": "ASIS_{}", "PSI": "PSIS_{}", "HEE": "Heel_{word}", "TOE": "Toe.{}"},
    "OpenCap": {
        "ASI": "{}.ASIS_study",
        "PSI": "{}.PSIS_study",
        "HEE": "{}_calc_study",
        "TOE": "{}_toe_study",
    },
    "waist": {"ASI": "{}FWT", "PSI": "{}BWT"},
}


def named(scheme: dict[str, str]) -> dict[str, str]:
    words = {"L": "Left", "R": "Right"}
    return {
        f"Ann:{side}{place}": name.format(side, word=words[side])
        for place, name in scheme.items()
        for side in words
    }


@pytest.mark.parametrize("scheme", SINGLE.values(), ids=SINGLE)
def test_usual_names_of_markers_are_known(scheme, tmp_path):
    known = load_walk(trc_file(tmp_path / "walk.trc", markers()))
    loaded = load_walk(trc_file(tmp_path / "walk.trc", renamed(named(scheme))))
    for points in ("com_m", "heel_m", "toe_m"):
        assert getattr(loaded, points) == pytest.approx(getattr(known, points))


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_a_pair_of_markers_is_the_point_between_them(pair, tmp_path):
    known = load_walk(trc_file(tmp_path / "walk.trc", markers()))
    ((place, names),) = pair.items()
    aside = np.array([30.0, 20.0, 0.0])
    paired = {}
    for name, xyz in markers().items():
        if name.endswith(place):
            paired[names[0].format(name[4])] = xyz - aside
            paired[names[1].format(name[4])] = xyz + aside
        else:
            paired[name] = xyz
    loaded = load_walk(trc_file(tmp_path / "walk.trc", paired))
    for points in ("heel_m", "toe_m"):
        assert getattr(loaded, points) == pytest.approx(getattr(known, points), abs=1e-6)


def test_two_people_in_one_file_need_a_marker_mapping(tmp_path):
    both = markers() | {name.replace("Ann", "Bob"): xyz + 1e3 for name, xyz in markers().items()}
    path = trc_file(tmp_path / "walk.trc", both)
    with pytest.raises(UserError, match="Ann:LASI and Bob:LASI could each be front"):
        load_walk(path)
    places = {"front": "ASI", "rear": "PSI", "heel": "HEE", "toe": "TOE"}
    mapping = {
        f"{side}_{point}" if point in ("heel", "toe") else point: [
            f"Bob:{letter}{places[point]}"
            for letter in ("LR" if point in ("front", "rear") else side[0].upper())
        ]
        for point in places
        for side in ("left", "right")
    }
    alone = load_walk(trc_file(tmp_path / "ann.trc", markers()))
    assert load_walk(path, mapping).com_m[:, 2] == pytest.approx(alone.com_m[:, 2] + 1.0)


def test_a_marker_that_is_never_visible_is_replaced_by_another_name(tmp_path):
    found = markers()
    found["Ann:SACR"] = (found["Ann:LPSI"] + found["Ann:RPSI"]) / 2
    known = load_walk(trc_file(tmp_path / "walk.trc", found))
    found["Ann:LPSI"] = np.full_like(found["Ann:LPSI"], np.nan)
    loaded = load_walk(trc_file(tmp_path / "walk.trc", found))
    assert loaded.com_m == pytest.approx(known.com_m)


@pytest.mark.parametrize("kind", [c3d_file, trc_file])
def test_a_short_gap_is_filled_and_a_long_one_is_not(kind, tmp_path):
    path = tmp_path / f"walk.{kind.__name__[:3]}"
    whole = load_walk(kind(path, markers()))
    holed = markers()
    short, long = round(0.1 * RATE_HZ) - 1, round(0.1 * RATE_HZ)  # samples: 0.1 s, and one more
    for start in range(60, 400, 45):  # of every part of a stride
        holed["Ann:LHEE"][start : start + short] = np.nan
    holed["Ann:RHEE"][200 : 200 + long] = np.nan
    holed["Ann:RTOE"][:3] = np.nan
    loaded = load_walk(kind(path, holed))
    assert loaded.source == f"{path.name}, 8 short gaps filled"
    assert np.isfinite(loaded.heel_m[0]).all()
    # Without the speeds at its ends it would be off by 22 mm.
    assert loaded.heel_m[0] == pytest.approx(whole.heel_m[0], abs=0.008)
    assert np.flatnonzero(np.isnan(loaded.heel_m[1, :, 0])).tolist() == [*range(200, 200 + long)]
    assert np.flatnonzero(np.isnan(loaded.toe_m[1, :, 0])).tolist() == [0, 1, 2]


def test_steps_in_a_long_gap_are_left_out_of_the_fit(tmp_path):
    whole = measure(load_walk(c3d_file(tmp_path / "walk.c3d", markers(9.0))))
    holed = markers(9.0)
    holed["Ann:LASI"][500:600] = np.nan  # half a second at 200 Hz
    holed["Ann:RHEE"][1000:1100] = np.nan
    walk = measure(load_walk(c3d_file(tmp_path / "walk.c3d", holed)))
    assert walk.speed_m_s == pytest.approx(whole.speed_m_s, abs=2e-3)
    assert len(walk.vertical_m) < len(whole.vertical_m)
    for quantity in ("length_m", "width_m", "vertical_m", "lateral_m", "com_top_m"):
        found, known = getattr(walk, quantity), getattr(whole, quantity)
        assert len(known) - 4 <= len(found) <= len(known), quantity
        assert found.mean() == pytest.approx(known.mean(), abs=2e-3), quantity
