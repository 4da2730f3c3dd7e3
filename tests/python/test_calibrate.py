"""calibrate and follow: the core's own walks come back as the configuration they were made with;
laboratories' files, missing markers, invalid files; the TOML file and the C header."""

import argparse
import dataclasses
import json
import math
import os
import shutil
import subprocess
import tomllib

import numpy as np
import pytest

from laboratory import (
    LABORATORIES,
    PERSON,
    WRITERS,
    c3d_file,
    laboratory,
    trc_file,
    walk_of,
    walk_on_a_treadmill,
)
from saddlewalk.cli import main, parser
from saddlewalk.config import configuration, host_arguments, load_config
from saddlewalk.core import field_ranges
from saddlewalk.errors import UserError
from saddlewalk.gait.measures import measure
from saddlewalk.gait.motion_capture import load_walk
from saddlewalk.gait.recording import Recording
from saddlewalk.paths import CHECKOUT, built
from saddlewalk.table import read_table
from synthetic_walk import Walk, csv_text

SPEEDS_M_S = (0.7, 1.0, 1.3)

TRIALS = CHECKOUT.parent / "shared/data/gait"

# What is left: one step more of the longer side in a walk; an uneven walk sways by no pure cosine.
TOLERANCE = {
    "half_step_slope_s": 2e-3,
    "half_step_intercept_m": 2e-3,
    "lateral_factor": 4e-3,
    "lateral_offset_m": 3e-4,
    "lateral_delay_rad": 0.01,
    "vertical_offset_m": 3e-4,
    "vertical_delay_rad": 0.02,
}

SHAPE = {
    "lateral_offset_m": 0.008,
    "lateral_delay_rad": 0.25,
    "vertical_offset_m": -0.003,
    "vertical_delay_rad": 0.3,
    "strike_share": 0.4,
}


@pytest.fixture
def write(tmp_path):
    """Write a recording as CSV; its path."""

    def to_csv(recording: Recording, name: str = "walk.csv") -> str:
        path = tmp_path / name
        path.write_text(csv_text(recording))
        return str(path)

    return to_csv


def calibrated(tmp_path, *arguments: str) -> dict[str, float]:
    out = tmp_path / "person.toml"
    assert main(["calibrate", *arguments, "--out", str(out)]) == 0
    return tomllib.loads(out.read_text())


def error_of(capsys, *arguments: str) -> str:
    assert main(list(arguments)) == 2
    printed = capsys.readouterr()
    assert printed.err.count("\n") == 1
    return printed.err


def test_a_recording_that_is_given_twice_is_rejected(write, capsys, tmp_path):
    walk = write(walk_of(PERSON, 1.0))
    printed = error_of(capsys, "calibrate", walk, walk, "--out", str(tmp_path / "person.toml"))
    assert walk in printed and "twice" in printed


def test_names_of_recordings_are_shown_with_their_control_characters_escaped(write, capsys):
    path = write(walk_of(PERSON, 1.2), "\x1b[31m\n\x9bred.csv")
    assert main(["calibrate", path, "--out", "-"]) == 0
    assert main(["follow", path]) == 0
    printed = capsys.readouterr()
    assert all(line.isprintable() for line in (printed.out + printed.err).split("\n"))
    assert r"\x1b[31m\n\x9bred.csv" in (printed.out + printed.err)


def test_calibrating_to_planned_walks_recovers_the_configuration(write, tmp_path):
    walks = [write(walk_of(PERSON, v), f"{v}.csv") for v in SPEEDS_M_S]
    found = calibrated(tmp_path, *walks, "--mass", "55")
    assert set(found) == {*PERSON, *SHAPE, "learn_ripple_start", "ankle"}
    for name, value in PERSON.items():
        assert found[name] == pytest.approx(value, abs=TOLERANCE.get(name, 1e-4)), name
    for name in SHAPE.keys() - {"strike_share"}:
        assert found[name] == pytest.approx(0, abs=TOLERANCE[name]), name
    assert found["ankle"] == "cycloid"
    text = (tmp_path / "person.toml").read_text()
    assert "step length: 47 steps, R2 0.91" in text
    assert "sway: 43 steps, R2 1.00\n" in text


@pytest.mark.parametrize("speeds_m_s", [SPEEDS_M_S, (1.0,)])
def test_shape_of_a_walk_is_found(speeds_m_s, write, tmp_path):
    walks = [write(walk_of(PERSON | SHAPE, v), f"{v}.csv") for v in speeds_m_s]
    found = calibrated(tmp_path, *walks)
    for name in ("lateral_offset_m", "lateral_delay_rad", "vertical_delay_rad"):
        assert found[name] == pytest.approx(SHAPE[name], abs=TOLERANCE[name]), name
    for walk in walks:
        error = followed(tmp_path, walk, "--config", str(tmp_path / "person.toml"))["calibrated"]
        assert error["com_y_m"] < 1e-3 and error["com_z_m"] < 1e-3, walk


def test_heel_strikes_at_the_recorded_share_of_the_step(write, tmp_path):
    """The feet of a synthetic walk strike at whole steps, when the CoM is half a step behind."""
    walk = Walk(speed_m_s=1.2, step_length_m=0.65).recording()
    late_s = 0.3 * 0.65 / 1.2  # until it passes the stance foot
    ahead = dataclasses.replace(walk, com_m=walk.com_m - np.array([1.2 * late_s, 0, 0]))
    found = calibrated(tmp_path, write(ahead))
    assert found["strike_share"] == pytest.approx(0.2, abs=0.01)


def test_heel_that_strikes_after_the_plan_s_foot_carries(write, tmp_path):
    walk = Walk(speed_m_s=1.0, step_length_m=0.6).recording()
    early_s = 0.08 * 0.6  # beyond half a step after the CoM passed the stance foot
    behind = dataclasses.replace(walk, com_m=walk.com_m + np.array([early_s, 0, 0]))
    rows = followed(tmp_path, write(behind))
    assert calibrated(tmp_path, write(behind))["strike_share"] == pytest.approx(0.58, abs=0.01)
    assert rows["calibrated"]["heel_strike_s"] < 0.005 < rows["default"]["heel_strike_s"]


def test_one_step_is_enough(write, tmp_path):
    """Its path is held to people's by 1 in 40, lengths are its own."""
    person = {"lateral_factor": 0.8, "lateral_delay_rad": 0.18, "half_step_intercept_m": 0.1}
    walk = walk_of(person, 1.0, 3.0)
    cut = {name: getattr(walk, name)[..., 40:240, :] for name in ("com_m", "heel_m", "toe_m")}
    short = dataclasses.replace(walk, time_s=walk.time_s[40:240], **cut)
    found = calibrated(tmp_path, write(short))
    assert "step length: 1 step" in (text := (tmp_path / "person.toml").read_text())
    assert "sway: 1 step, R2 1.00" in text
    assert found["lateral_factor"] == pytest.approx(0.8, rel=0.05)
    assert found["lateral_offset_m"] == pytest.approx(0, abs=1e-3)
    assert found["lateral_delay_rad"] == pytest.approx(0.18, abs=0.03)
    assert found["half_step_intercept_m"] == pytest.approx(0.1, abs=0.004)
    assert found["step_width_intercept_m"] == pytest.approx(0.3456, abs=2e-3)


def test_path_is_measured_from_the_line_on_which_the_feet_go_on(write, tmp_path):
    """A walk that drifts aside by 5 cm a metre; x and y of a foot that lies flat stay."""
    walk = walk_of({"lateral_offset_m": 0.01}, 1.0)
    across = np.array([0, 1.0, 0])

    def aside_m(x_m: np.ndarray) -> np.ndarray:
        return 0.05 * np.expand_dims(x_m, -1) * across

    feet_m = aside_m((walk.heel_m[..., 0] + walk.toe_m[..., 0]) / 2)
    source = write(moved(walk, com_m=aside_m(walk.com_m[:, 0]), heel_m=feet_m, toe_m=feet_m))
    assert calibrated(tmp_path, source)["lateral_offset_m"] == pytest.approx(0.01, abs=1e-3)
    assert followed(tmp_path, source)["calibrated"]["com_y_m"] < 1e-3


def test_first_step_that_is_unlike_the_others_does_not_move_their_landing(write, tmp_path):
    walk = walk_of({}, 1.0, 2.4)
    shift_m = np.where(walk.time_s < 0.25, 0.25, 0.0)[:, None] * np.array([1.0, 0, 0])
    rows = followed(tmp_path, write(moved(walk, heel_m=shift_m, toe_m=shift_m)))
    assert rows["calibrated"]["landing_m"] <= rows["default"]["landing_m"] + 1e-4


def test_no_quantity_is_farther_from_the_walk_than_by_default(write, tmp_path):
    """The paper's own walk, with feet that scatter: nothing is to be gained."""
    rng = np.random.default_rng(4)
    walk = walk_of({}, 1.2)
    scatter_m = np.interp(walk.time_s, np.arange(0, 10, 0.4), rng.normal(0, 0.01, 25))
    swaying = moved(walk, com_m=scatter_m[:, None] * np.array([0, 1.0, 0.3]))
    rows = followed(tmp_path, write(swaying))
    for name in ("com_y_m", "com_z_m", "heel_strike_s"):  # the swing's line is the sway's
        assert rows["calibrated"][name] <= rows["default"][name] + 1e-6, name


def test_swing_of_a_person_is_found(write, tmp_path):
    swing = {"swing_begin": -0.3, "swing_end": 1.05, "swing_skew": 1.5}
    walk = write(walk_of(PERSON | swing, 1.1))
    found = calibrated(tmp_path, walk)
    assert found["swing_end"] == pytest.approx(1.05, abs=0.05)
    assert found["swing_skew"] == pytest.approx(1.5, abs=0.3)
    rows = followed(tmp_path, walk)
    assert rows["calibrated"]["swing_x_m"] < 0.012 < 3 * rows["default"]["swing_x_m"]


def test_steps_of_several_cadences_are_pooled(write, tmp_path):
    """Longer steps at the lower speed leave the paper's slope."""
    slow, fast = ({"half_step_slope_s": 0.1, "half_step_intercept_m": m} for m in (0.23, 0.19))
    walks = [write(walk_of(slow, 1.0), "a.csv"), write(walk_of(fast, 1.25), "b.csv")]
    found = calibrated(tmp_path, *walks)
    mean_m = found["half_step_slope_s"] * 1.125 + found["half_step_intercept_m"]
    assert found["half_step_slope_s"] == pytest.approx(0.1802)
    assert mean_m == pytest.approx(0.3225, abs=6e-3)  # the faster one has more steps
    assert "the slope would be -0.06" in (tmp_path / "person.toml").read_text()


def test_ripple_is_the_one_that_the_supervisor_learned(write, tmp_path):
    """A walk of even speed, and the same that sways fore and aft by 0.3 m/s."""
    walk = walk_of(PERSON, 1.0)
    com_m = walk.com_m.copy()
    com_m[:, 0] += 0.3 / 7 * np.sin(7 * walk.time_s)
    swaying = dataclasses.replace(walk, com_m=com_m)
    even = calibrated(tmp_path, write(walk, "even.csv"))["learn_ripple_start"]
    uneven = calibrated(tmp_path, write(swaying, "uneven.csv"))["learn_ripple_start"]
    assert even == pytest.approx(0.134 / math.sqrt(9.81 * 0.91), abs=0.005)  # of its height alone
    assert uneven > 1.5 * even


def test_one_speed_fits_offsets_and_keeps_the_papers_slopes(write, tmp_path):
    found = calibrated(tmp_path, write(walk_of(PERSON, 1.0)))
    paper = configuration({})
    for name in ("half_step_slope_s", "vertical_slope_s", "step_width_slope_s"):
        assert found[name] == pytest.approx(getattr(paper, name))
    assert found["half_step_slope_s"] + found["half_step_intercept_m"] == pytest.approx(
        0.28, abs=2e-3
    )
    assert found["vertical_slope_s"] + found["vertical_intercept_m"] == pytest.approx(
        0.034, abs=5e-4
    )
    assert found["step_width_slope_s"] + found["step_width_intercept_m"] == pytest.approx(
        0.138, abs=5e-4
    )
    shift_m = found["step_width_slow_m"] - paper.step_width_slow_m
    assert shift_m == pytest.approx(found["step_width_fast_m"] - paper.step_width_fast_m, abs=1e-6)


def test_fitted_width_is_never_narrower_than_the_core_allows(write, tmp_path):
    fields = {"step_width_slow_m": 0.05, "step_width_slow_speed_m_s": 0.9}
    narrow = {**fields, "step_width_fast_speed_m_s": 0.95}
    found = calibrated(tmp_path, write(walk_of(narrow, 0.6)))
    assert found["step_width_slope_s"] * 0.6 + found["step_width_intercept_m"] == pytest.approx(
        0.05, abs=1e-3
    )
    assert found["step_width_fast_m"] == 0.02
    end_m = (
        found["step_width_slope_s"] * found["step_width_fast_speed_m_s"]
        + found["step_width_intercept_m"]
    )
    assert end_m == pytest.approx(0.02, abs=1e-6)


def test_a_negative_intercept_becomes_zero_and_the_slope_follows(write, tmp_path):
    flat = {"vertical_slope_s": 0.01, "vertical_intercept_m": 0.0}
    found = calibrated(tmp_path, write(walk_of(flat, 1.2)))
    assert found["vertical_intercept_m"] == 0
    assert found["vertical_slope_s"] == pytest.approx(0.01, abs=5e-4)


def test_sway_is_limited_to_tangency(write, tmp_path):
    walk = walk_of({}, 1.2)
    wide = dataclasses.replace(walk, com_m=walk.com_m * (1, 5, 1))
    found = calibrated(tmp_path, write(wide))
    assert found["lateral_factor"] == pytest.approx(2 * 1.2, rel=0.01)
    assert "beyond tangency" in (tmp_path / "person.toml").read_text()


def test_with_a_given_height_the_pendulum_ratio_is_fitted(write, tmp_path):
    found = calibrated(tmp_path, write(walk_of(PERSON, 1.0)), "--height", "1.7")
    assert found["body_height_m"] == 1.7
    assert found["pendulum_ratio"] == pytest.approx(0.57 * 1.62 / 1.7, abs=1e-3)


def test_sway_is_fitted_despite_drift_and_offset():
    walk = walk_of({}, 1.0)
    drift_m = 0.3 + 0.02 * walk.time_s
    moved = dataclasses.replace(walk, com_m=walk.com_m + np.outer(drift_m, (0, 1, 0)))
    assert measure(moved).lateral_m == pytest.approx(0.1328 / (2 * math.pi), abs=2e-4)


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("rows", LABORATORIES.values(), ids=LABORATORIES)
@pytest.mark.parametrize("belt_m_s", [0.0, 1.0])
def test_laboratory_file_is_the_walk_in_the_task_frame(kind, rows, belt_m_s, tmp_path):
    walk = walk_of(PERSON, 1.0)
    source = WRITERS[kind](
        tmp_path / f"walk.{kind}", laboratory(walk, rows, belt_m_s * walk.time_s)
    )
    loaded = load_walk(source)
    origin_m = walk.com_m[0] * (1, 1, 0)
    along = walk.com_m[-1, :2] - walk.com_m[0, :2]
    turned = (
        math.atan2(along[1], along[0]) if not belt_m_s else 0.0
    )  # forward is the direction of walking
    assert abs(turned) < 0.01
    # The belt's speed is known to a few mm/s from feet that roll on it.
    tolerance_m = 0.002 + abs(turned) * 10 + (0.005 * walk.time_s[-1] if belt_m_s else 0)
    for found, true in ((loaded.com_m, walk.com_m), *zip(loaded.heel_m, walk.heel_m, strict=True)):
        assert found == pytest.approx(true - origin_m, abs=tolerance_m)
    assert loaded.time_s == pytest.approx(walk.time_s - walk.time_s[0], abs=1e-4)
    assert ("treadmill at 1 m/s" in loaded.source) == bool(belt_m_s)


def test_treadmill_that_starts_and_stops_is_a_walk_over_ground(tmp_path, capsys):
    walk, belt_m = walk_on_a_treadmill(20.0)
    rows = LABORATORIES["y up, walking along x"]
    source = c3d_file(tmp_path / "walk.c3d", laboratory(walk, rows, belt_m))
    loaded = load_walk(source)
    assert "treadmill, up to 1 m/s" in loaded.source
    # Over the ground as it is: a belt that changes its speed is known to 0.1 m/s for a second each.
    walked_m = walk.com_m[-1, 0] - walk.com_m[0, 0]
    assert loaded.com_m[-1, 0] == pytest.approx(walked_m, abs=0.2)
    assert main(["replay", source]) == 0
    lines = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert lines["unstable"] == lines["caution"] == "0 %"


@pytest.mark.parametrize("kind", WRITERS)
def test_laboratory_file_calibrates_as_the_csv_does(kind, write, tmp_path):
    walk = walk_of(PERSON, 1.0)
    markers = laboratory(walk, LABORATORIES["z up, walking along -y"])
    source = WRITERS[kind](tmp_path / f"walk.{kind}", markers)
    expected = calibrated(tmp_path, write(walk))
    assert calibrated(tmp_path, source) == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize(
    ("kind", "written"), [(kind, gap) for kind in WRITERS for gap in (np.nan, 0.0)]
)
def test_an_invisible_marker_is_missing(kind, written, tmp_path):
    markers = laboratory(walk_of(PERSON, 1.0), LABORATORIES["z up, walking along -y"])
    markers["Ann:LHEE"][100:120] = written
    loaded = load_walk(WRITERS[kind](tmp_path / f"walk.{kind}", markers))
    assert np.isnan(loaded.heel_m[0, 100:120]).all()
    assert np.isfinite(loaded.heel_m[0, 120:]).all()
    assert np.isfinite(loaded.heel_m[1]).all()


def test_markers_are_named_by_a_mapping_file(tmp_path, capsys):
    rename = {"Ann:LASI": "hip a", "Ann:RASI": "hip b", "Ann:LTOE": "C7"}
    markers = laboratory(walk_of(PERSON, 1.0), LABORATORIES["z up, walking along -y"])
    source = trc_file(
        tmp_path / "walk.trc", {rename.get(name, name): xyz for name, xyz in markers.items()}
    )
    assert "no markers for front" in error_of(capsys, "calibrate", source)
    mapping = tmp_path / "markers.toml"
    mapping.write_text('front = ["hip a", "Hip B"]\nleft_toe = ["C7"]\n')
    found = calibrated(tmp_path, source, "--markers", str(mapping))
    assert found["half_step_slope_s"] + found["half_step_intercept_m"] == pytest.approx(
        0.28, abs=2e-3
    )


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("front = [", "not TOML"),
        ('nose = ["A"]', "nose is not one of front, rear"),
        ('front = "LASI"', "front = 'LASI' must be a list"),
        ("front = []", "must be a list"),
        ('front = ["NOSE"]', "no markers for front: NOSE"),
    ],
)
def test_bad_mapping_is_named(text, named, tmp_path, capsys):
    markers = laboratory(walk_of(PERSON, 1.0, 3.0), LABORATORIES["z up, walking along -y"])
    source = trc_file(tmp_path / "walk.trc", markers)
    mapping = tmp_path / "markers.toml"
    mapping.write_text(text)
    assert named in error_of(capsys, "calibrate", source, "--markers", str(mapping))


def test_without_toes_the_steps_are_not_reported_and_the_rest_is(tmp_path, capsys):
    markers = laboratory(walk_of(PERSON, 1.0), LABORATORIES["z up, walking along -y"])
    del markers["Ann:LTOE"], markers["Ann:RTOE"]
    found = calibrated(tmp_path, trc_file(tmp_path / "walk.trc", markers))
    population = {
        "lateral_delay_rad": 0.18,
        "vertical_delay_rad": 0.19,
        "strike_share": 0.362,
        "ankle": "cycloid",
    }
    population |= {"swing_begin": -0.32, "swing_end": 1.04, "swing_skew": 1.47}
    fitted = {"body_height_m", "vertical_slope_s", "vertical_intercept_m"}
    assert set(found) == {*fitted, *population}
    assert {name: found[name] for name in population} == population
    printed = capsys.readouterr().out
    assert "walk.trc: no step length: one or both toes were never visible" in printed
    assert "walk.trc: no half foot length: one or both toes were never visible" in printed


def moved(walk: Recording, **offset_m: np.ndarray) -> Recording:
    return dataclasses.replace(
        walk, **{name: getattr(walk, name) + by_m for name, by_m in offset_m.items()}
    )


def test_quantities_that_cannot_be_measured_are_reported_with_the_reason(write, tmp_path, capsys):
    walk = walk_of(PERSON, 1.0)
    up = np.array([0, 0, 1.0])
    calibrated(tmp_path, write(moved(walk, com_m=up, heel_m=up, toe_m=up)))
    assert "CoM height: the heels do not stand at z = 0" in capsys.readouterr().out
    calibrated(tmp_path, write(dataclasses.replace(walk, toe_m=walk.heel_m)))
    assert "half foot length: heel and toe are one point" in capsys.readouterr().out
    calibrated(tmp_path, write(dataclasses.replace(walk, com_m=walk.com_m * (1, -1, 1))))
    assert "lateral amplitude: the CoM is not nearest to the foot" in capsys.readouterr().out
    short = walk_of(PERSON, 1.0, 1.4)
    assert "lateral_factor" in calibrated(tmp_path, write(short))
    printed = " ".join(capsys.readouterr().out.split())
    assert "lateral amplitude: no stride from passing a foot" in printed
    assert "3 each are needed" in printed


def test_without_com_height_the_transverse_plane_is_still_fitted(write, tmp_path, capsys):
    unseen = np.array([0, 0, np.nan])
    found = calibrated(tmp_path, write(moved(walk_of(PERSON, 1.0), com_m=unseen)))
    assert "vertical_slope_s" not in found and "half_step_slope_s" in found
    assert "vertical amplitude: no step from heel strike" in capsys.readouterr().out


def scaled(walk: Recording, factor: np.ndarray) -> Recording:
    return dataclasses.replace(
        walk, com_m=walk.com_m * factor, heel_m=walk.heel_m * factor, toe_m=walk.toe_m * factor
    )


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda walk: scaled(walk, np.array([1000, 1000, 1000])), "walking speed 1000 m/s"),
        (lambda walk: scaled(walk, np.array([-1, -1, 1])), "no walk|walking speed -"),
        (lambda walk: scaled(walk, np.array([1, 8, 1])), "step width 1.1"),
        (lambda walk: scaled(walk, np.array([1, -1, 1])), "step width -0.138"),
        (lambda walk: scaled(walk, np.array([1, 1, 2])), "CoM height 1.8"),
        (lambda walk: scaled(walk, np.array([0, 0, 1])), "no walk"),
        (
            lambda walk: dataclasses.replace(walk, time_s=walk.time_s / 4),
            "walking speed 4 m/s is not a person's: 0.1 to 3",
        ),
    ],
)
def test_values_outside_human_range_are_rejected_by_name(change, named, write, capsys):
    error = error_of(capsys, "calibrate", write(change(walk_of(PERSON, 1.0))))
    assert any(text in error for text in named.split("|")), error
    assert "walk.csv" in error


def test_walks_without_a_valid_model_name_the_field(write, tmp_path, capsys):
    out = tmp_path / "person.toml"
    slow, fast = ({"vertical_slope_s": 0.001, "vertical_intercept_m": m} for m in (0.09, 0.05))
    walks = [write(walk_of(slow, 1.0), "a.csv"), write(walk_of(fast, 1.25), "b.csv")]
    error = error_of(capsys, "calibrate", *walks, "--out", str(out))
    assert "vertical_slope_s = -0.1" in error
    assert not out.exists()


def test_height_that_is_not_the_walker_s_is_rejected(write, capsys):
    source = write(walk_of(PERSON, 1.0))
    assert "0.44 of it; human: 0.45 to 0.65" in error_of(
        capsys, "calibrate", source, "--height", "2.1"
    )


@pytest.mark.parametrize(
    ("name", "text", "named"),
    [
        ("walk.trc", "", "the first line must begin with PathFileType"),
        ("walk.trc", "PathFileType\n\n\n\n\n\n", "no Units"),
        ("walk.c3d", "hello" * 200, "not a C3D file"),
        ("walk.c3d", "", "not a C3D file"),
    ],
)
def test_a_file_of_another_format_is_rejected(name, text, named, tmp_path, capsys):
    path = tmp_path / name
    path.write_text(text)
    assert named in error_of(capsys, "calibrate", str(path))


@pytest.mark.parametrize("name", ["walk.trc", "walk.c3d", "walk.csv"])
def test_a_missing_recording_is_named(name, tmp_path, capsys):
    assert name in error_of(capsys, "calibrate", str(tmp_path / name))


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("\tmm\t", "\tfurlong\t", "unit 'furlong' must be one of m, cm, mm"),
        ("3\t0.0100\t", "3\tsoon\t", "line 9: could not convert"),
        ("3\t0.0100\t", "3\t\t", "line 9: the time must be a number"),
        ("3\t0.0100\t", "3\t0.0050\t", "frame 3: the time must be later"),
    ],
)
def test_bad_trc_is_named(old, new, named, tmp_path, capsys):
    markers = laboratory(walk_of(PERSON, 1.0, 2.0), LABORATORIES["z up, walking along -y"])
    path = tmp_path / "walk.trc"
    trc_file(path, markers)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    assert named in error_of(capsys, "calibrate", str(path))


def test_c3d_without_ezc3d_reports_what_to_install(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert "pip install -e '.[c3d]'" in error_of(capsys, "calibrate", str(tmp_path / "a.c3d"))


def test_a_crash_of_the_c3d_reader_is_an_error_of_the_file(monkeypatch, tmp_path, capsys):
    (tmp_path / "ezc3d.py").write_text("import os\nos.abort()\n")
    monkeypatch.syspath_prepend(tmp_path)
    markers = laboratory(walk_of(PERSON, 1.0, 2.0), LABORATORIES["z up, walking along -y"])
    path = c3d_file(tmp_path / "walk.c3d", markers)
    assert "walk.c3d: not a C3D file: ezc3d crashed" in error_of(capsys, "calibrate", path)


@pytest.fixture
def person(write, tmp_path):
    """A calibrated person's TOML file and C header."""
    walks = [write(walk_of(PERSON, v), f"{v}.csv") for v in SPEEDS_M_S]
    toml, header = tmp_path / "person.toml", tmp_path / "jane_doe-2.h"
    assert main(["calibrate", *walks, "--out", str(toml), "--header", str(header)]) == 0
    return toml, header


def test_the_toml_file_loads_as_a_configuration(person, tmp_path, capsys):
    toml = str(person[0])
    capsys.readouterr()
    assert main(["plan", "--speed", "1.0", "--config", toml]) == 0
    plan_csv = capsys.readouterr().out
    assert main(["plan", "--speed", "1.0"]) == 0
    assert plan_csv != capsys.readouterr().out
    states = tmp_path / "states.csv"
    states.write_text(
        "t_s,com_x_m,com_y_m,com_z_m,com_vx_m_s,com_vy_m_s,left_x_m,left_y_m,right_x_m,right_y_m,"
        "left_contact,right_contact\n0,0,0,0.9,1,0,0.3,0.1,-0.3,-0.1,1,1\n"
    )
    assert main(["supervise", "--in", str(states), "--config", toml]) == 0
    options = parser().parse_args(["demo", "--config", toml])
    assert "--set=lateral_factor=" in " ".join(host_arguments(load_config(options)))


def test_header_compiles_with_the_core_and_is_the_same_configuration(person, tmp_path):
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    toml, header = person
    names = list(field_ranges())
    program = tmp_path / "print.c"
    program.write_text(
        "#include <stdio.h>\n"
        f'#include "{header.name}"\n'
        "int main(void)\n{\n"
        "    const saddle_config_t config = saddle_config_jane_doe_2();\n"
        "    if (saddle_config_check(&config) != NULL) {\n        return 1;\n    }\n"
        + "".join(f'    printf("%.9g\\n", (double)config.{name});\n' for name in names)
        + "    return 0;\n}\n"
    )
    flags = "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Werror"
    library = built("lib/libsaddlewalk.so")
    include = f"-I{CHECKOUT / 'firmware/core/include'}"
    binary = tmp_path / "print"
    subprocess.run([compiler, *flags.split(), include, program, library, "-o", binary], check=True)
    lines = subprocess.run(
        [binary],
        env=os.environ | {"LD_LIBRARY_PATH": str(library.parent)},
        check=True,
        capture_output=True,
    ).stdout.split()
    config = load_config(argparse.Namespace(config=toml, height=None, mass=None))
    assert [np.float32(line) for line in lines] == [
        np.float32(getattr(config, name)) for name in names
    ]


def test_no_partial_file_is_left(write, tmp_path, capsys):
    out = tmp_path / "nowhere/person.toml"
    error = error_of(capsys, "calibrate", write(walk_of(PERSON, 1.0)), "--out", str(out))
    assert "--out" in error and "No such file or directory" in error


def followed(tmp_path, *arguments: str) -> dict[str, dict[str, float]]:
    """Rows of follow's CSV by configuration, numbers only."""
    out = tmp_path / "follow.csv"
    assert main(["follow", *arguments, "--ankle", "cycloid", "--out", str(out)]) == 0
    columns = "com_y_m com_z_m com_z_shape_m swing_x_m landing_m heel_strike_s steps".split()
    rows = [row for _, row in read_table(str(out), columns)]
    return dict(zip(("default", "calibrated"), rows, strict=True))


@pytest.mark.parametrize("known", ["this walk", "others"])
def test_calibrated_plan_tracks_a_planned_walk(known, write, person, tmp_path, capsys):
    before = [] if known == "this walk" else ["--config", str(person[0])]
    rows = followed(tmp_path, write(walk_of(PERSON, 1.1)), *before)
    assert rows["calibrated"]["steps"] == rows["default"]["steps"] >= 12
    within = {"com_y_m": 1e-3, "com_z_m": 2e-3, "swing_x_m": 5e-3, "landing_m": 5e-3}
    for name, tolerance in within.items():
        assert rows["calibrated"][name] < tolerance < rows["default"][name], name
    struck_s = (
        0.015  # this plan's heel strikes by its angle, a calibrated one's at a share of a step
    )
    assert rows["calibrated"]["heel_strike_s"] < struck_s < rows["default"]["heel_strike_s"]
    assert "walk.csv" in capsys.readouterr().out


def test_follow_leaves_each_recording_out_and_summarises(write, tmp_path, capsys):
    walks = [write(walk_of(PERSON | SHAPE, v), f"{v}.csv") for v in SPEEDS_M_S]
    out = tmp_path / "follow.json"
    assert main(["follow", *walks, "--leave-out", "--json", str(out)]) == 0
    assert "left out" in capsys.readouterr().out
    found = json.loads(out.read_text())
    assert [one["recording"] for one in found["recordings"]] == ["0.7.csv", "1.0.csv", "1.3.csv"]
    for one in found["recordings"]:
        assert one["after"] == one["left_out"] and one["before"] == one["default"]
        assert one["calibrated"]["y_mm"] < 1 < one["before"]["y_mm"]
    middle = found["recordings"][1]  # between the speeds that the others know
    assert middle["left_out"]["y_mm"] < 1.5 and middle["left_out"]["z_mm"] < 1.5
    assert found["medians"]["after"]["y_mm"] == pytest.approx(
        np.median([one["after"]["y_mm"] for one in found["recordings"]]), abs=1e-3
    )
    assert found["within"]["calibrated"]["y_mm"] == 1


def test_halves_of_a_recording_are_followed_by_each_other(write, tmp_path, capsys):
    """The second half sways farther to the left."""
    walk = walk_of(PERSON | SHAPE, 1.0)
    aside_m = np.where(walk.com_m[:, 0] > walk.com_m[-1, 0] / 2, 0.01, 0.0)
    walks = [write(moved(walk, com_m=aside_m[:, None] * np.array([0, 1.0, 0])))]
    walks.append(write(walk_of(PERSON, 1.0, 1.4), "short.csv"))
    out = tmp_path / "follow.json"
    assert main(["follow", *walks, "--halves", "--json", str(out)]) == 0
    assert "short.csv: left out: it has no two steps" in capsys.readouterr().err
    first, second = json.loads(out.read_text())["recordings"]
    assert [one["recording"] for one in (first, second)] == [
        "walk.csv, first half",
        "walk.csv, second half",
    ]
    for one in (first, second):
        assert one["calibrated"]["y_mm"] < 2.5
        assert one["left_out"]["y_mm"] == pytest.approx(10, abs=1.5)
        assert one["left_out"]["z_mm"] < 1.5
    assert "two steps or more" in error_of(capsys, "follow", walks[1], "--halves")


def test_film_strip_is_drawn_of_a_stride(write, tmp_path):
    picture = tmp_path / "strip.svg"
    assert main(["follow", write(walk_of(PERSON, 1.0)), "--picture", str(picture)]) == 0
    words = picture.read_text()
    assert words.startswith("<?xml") and "svg" in words


def test_film_strip_needs_a_step_that_was_seen(write, tmp_path, capsys):
    walk = walk_of(PERSON, 1.0)
    unseen = dataclasses.replace(walk, com_m=walk.com_m * np.array([1, 1, np.nan]))
    arguments = ("follow", write(unseen), "--picture", str(tmp_path / "strip.png"))
    assert "--picture: no step of walk.csv" in error_of(capsys, *arguments)


def test_what_cannot_be_left_out_is_rejected(write, tmp_path, capsys):
    walk = write(walk_of(PERSON, 1.0))
    assert "two recordings" in error_of(capsys, "follow", walk, "--leave-out")
    assert "twice" in error_of(capsys, "follow", walk, walk, "--leave-out")
    config = tmp_path / "person.toml"
    config.write_text("body_height_m = 1.7\n")
    other = write(walk_of(PERSON, 1.3), "other.csv")
    for option in ("--leave-out", "--halves"):
        arguments = (option, "--config", str(config))
        assert f"{option} calibrates" in error_of(capsys, "follow", walk, other, *arguments)
    assert "only one" in error_of(capsys, "follow", walk, other, "--leave-out", "--halves")


def test_follow_reports_a_long_name_on_one_line_where_there_is_no_terminal(tmp_path, capsys):
    path = tmp_path / f"{'long_' * 12}.csv"
    path.write_text(csv_text(walk_of({}, 1.0)))
    assert main(["follow", str(path)]) == 0
    assert f" {path.name} " in capsys.readouterr().out


def test_follow_measures_the_offset_that_it_is_given(write, tmp_path):
    higher = moved(walk_of({}, 1.0), com_m=np.array([0, 0, 0.05]))
    aside = moved(walk_of({}, 1.0), com_m=np.array([0, 0.03, 0]))
    by_height = followed(tmp_path, write(higher))["default"]
    assert by_height["com_z_m"] == pytest.approx(0.05, abs=0.01)
    assert by_height["com_z_shape_m"] < 0.01
    assert followed(tmp_path, write(aside))["default"]["com_y_m"] == pytest.approx(0.03, abs=1e-3)


def test_follow_compares_the_foot_that_swings(write, tmp_path):
    walk = walk_of({}, 1.0)
    ahead_m = 0.1 * (walk.heel_m[..., 2:] > 0) * np.array([1.0, 0, 0])
    rows = followed(tmp_path, write(moved(walk, heel_m=ahead_m, toe_m=ahead_m)))
    assert rows["default"]["swing_x_m"] == pytest.approx(0.1, abs=0.01)
    assert rows["default"]["landing_m"] < 0.002


def test_follow_reports_that_a_speed_is_out_of_reach(write, tmp_path, capsys):
    small = {"half_step_slope_s": 0.05}
    config = tmp_path / "small.toml"
    config.write_text("".join(f"{name} = {value}\n" for name, value in small.items()))
    assert main(["follow", write(walk_of({}, 1.7)), "--config", str(config)]) == 0
    assert "(calibrated)" in " ".join(capsys.readouterr().out.split())


def test_walk_with_no_steps_is_rejected():
    still = Walk(speed_m_s=1e-3, step_length_m=1e-3).recording()
    with pytest.raises(UserError, match="no walk"):
        measure(still)


if TRIALS.is_dir():

    def test_calibration_reduces_the_landing_error_of_recorded_people(tmp_path):
        trials = sorted(str(path) for path in TRIALS.glob("*__*.csv"))
        out = tmp_path / "follow.csv"
        assert main(["follow", *trials, "--out", str(out)]) == 0
        landings_m = np.array([row["landing_m"] for _, row in read_table(str(out), ["landing_m"])])
        default_m, calibrated_m = landings_m.reshape(-1, 2).T
        assert np.all(calibrated_m <= default_m)
        assert np.median(calibrated_m) < 0.3 * np.median(default_m)
