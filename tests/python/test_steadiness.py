"""Only one steady straight walk is calibrated to: jumps, turns and stumbles are rejected."""

import csv
import dataclasses

import numpy as np
import pytest

from laboratory import LABORATORIES, PERSON, c3d_file, laboratory, walk_of
from saddlewalk import paths
from saddlewalk.cli import main
from saddlewalk.errors import UserError
from saddlewalk.gait.measures import measure
from saddlewalk.gait.motion_capture import load_walk
from saddlewalk.gait.recording import Recording, load_recording
from synthetic_walk import Walk, csv_text

pytestmark = pytest.mark.firmware

TRIALS = paths.CHECKOUT.parent / "shared/data/gait"


def each_point(recording: Recording, change) -> Recording:
    """`change` is applied to the (n, 3) of the CoM and of each heel and toe."""
    return dataclasses.replace(
        recording,
        com_m=change(recording.com_m),
        heel_m=np.stack([change(foot) for foot in recording.heel_m]),
        toe_m=np.stack([change(foot) for foot in recording.toe_m]),
    )


def bent(walk: Recording, turn_deg: float, from_m: float = 3.0, over_m: float = 1.0) -> Recording:
    """Along a path that goes straight, then on an arc, then straight on."""

    def onto_path(xyz: np.ndarray) -> np.ndarray:
        turn_rad = np.radians(turn_deg)
        way = np.linspace(-2.0, walk.com_m[-1, 0] + 2.0, 5000)
        heading = turn_rad * np.clip((way - from_m) / over_m, 0, 1)
        step = np.gradient(way)
        x, y = (np.cumsum(f(heading) * step) for f in (np.cos, np.sin))
        here = np.interp(xyz[:, 0], way, heading)
        return np.stack(
            [
                np.interp(xyz[:, 0], way, x) - np.sin(here) * xyz[:, 1],
                np.interp(xyz[:, 0], way, y) + np.cos(here) * xyz[:, 1],
                xyz[:, 2],
            ],
            axis=1,
        )

    return each_point(walk, onto_path)


def lifted(walk: Recording, height_m: float, from_s: float = 3.0) -> Recording:
    """All of it rises and falls freely once."""
    flight_s = 2 * np.sqrt(2 * height_m / 9.81)
    share = np.clip((walk.time_s - walk.time_s[0] - from_s) / flight_s, 0, 1)
    up_m = 4 * height_m * share * (1 - share)
    return each_point(walk, lambda xyz: xyz + np.outer(up_m, (0, 0, 1)))


def from_a_box(walk: Recording, height_m: float = 0.3) -> Recording:
    """The first second is walked so much higher."""
    up_m = height_m * (walk.time_s - walk.time_s[0] < 1.0)
    return each_point(walk, lambda xyz: xyz + np.outer(up_m, (0, 0, 1)))


def stumbled(deviation_m: tuple[float, float]) -> Recording:
    """Feet that land elsewhere each time, by so much in x and y."""
    walk = Walk(duration_s=9.0)
    recording, rng = walk.recording(), np.random.default_rng(5)
    off_m = np.zeros((2, len(recording.time_s), 3))
    for side in (0, 1):
        landing = np.floor(walk.strides(side)).astype(int)
        elsewhere_m = rng.normal(0, 1, (landing.max() - landing.min() + 1, 2)) * deviation_m
        off_m[side, :, :2] = elsewhere_m[landing - landing.min()]
    return dataclasses.replace(
        recording, heel_m=recording.heel_m + off_m, toe_m=recording.toe_m + off_m
    )


def hurried(walk: Recording) -> Recording:
    """Half of it at 0.6 times the speed, the other half at 1.6 times."""
    since_s = walk.time_s - walk.time_s[0]
    half_s = since_s[-1] / 2
    slow_s = np.minimum(since_s, half_s) / 0.6
    return dataclasses.replace(walk, time_s=slow_s + np.maximum(since_s - half_s, 0) / 1.6)


def backwards(walk: Recording) -> Recording:
    turned = each_point(walk, lambda xyz: xyz[::-1] * (-1, -1, 1))
    return dataclasses.replace(turned, heel_m=turned.heel_m, toe_m=turned.toe_m, time_s=walk.time_s)


NOT_STEADY = {
    "jump": (lambda: lifted(walk_of(PERSON, 1.0), 0.25), "both feet are in the air for 0.4"),
    "box": (lambda: from_a_box(walk_of(PERSON, 1.0)), r"up to 0.3. m above where they stand"),
    "corner": (lambda: bent(walk_of(PERSON, 1.0), 90), "the path turns by 9. degrees"),
    "about turn": (lambda: bent(walk_of(PERSON, 1.0), -170), "the path turns by 1.. degrees"),
    "half a corner": (lambda: bent(walk_of(PERSON, 1.0), 45), "the path turns by 4. degrees"),
    "lengths": (
        lambda: stumbled((0.45, 0.0)),
        "step lengths scatter by .*at most 50 %",
    ),
    "widths": (lambda: stumbled((0.0, 0.3)), "step widths scatter by .*at most 160 mm"),
    "speed": (lambda: hurried(walk_of(PERSON, 1.0)), "speeds of the strides scatter by"),
    "backwards": (lambda: backwards(walk_of(PERSON, 1.0)), "the feet point 180 degrees off"),
}


@pytest.mark.parametrize(("movement", "words"), NOT_STEADY.values(), ids=NOT_STEADY)
def test_another_movement_is_rejected_with_number_and_limit(movement, words):
    with pytest.raises(UserError, match=f"not one steady straight walk: .*{words}") as rejected:
        measure(movement())
    assert "at most" in str(rejected.value)


@pytest.mark.parametrize("command", ["calibrate", "follow"])
def test_a_turn_in_a_laboratory_file_is_a_one_line_error(command, tmp_path, capsys):
    walk = bent(walk_of(PERSON, 1.0, 6.0), 90)
    path = c3d_file(tmp_path / "turn.c3d", laboratory(walk, LABORATORIES["y up, walking along x"]))
    assert main([command, path]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.count("\n") == 1
    assert (
        "turn.c3d" in shown.err and "not one steady straight walk: the path turns by 9" in shown.err
    )


LIMPING = {**PERSON, "step_length_factor_left": 1.2, "step_length_factor_right": 0.8}
STEADY = {
    "a limp": lambda: walk_of(LIMPING, 0.6),
    "a child": lambda: each_point(walk_of(PERSON, 1.3), lambda xyz: 0.6 * xyz),
    "a short trial": lambda: walk_of(PERSON, 1.0, 1.6),
    "uneven landings": lambda: stumbled((0.06, 0.04)),
    "a slight curve": lambda: bent(walk_of(PERSON, 1.0), 15, over_m=4.0),
    "a bumpy floor": lambda: lifted(walk_of(PERSON, 1.0), 0.03),
}


@pytest.mark.parametrize("movement", STEADY.values(), ids=STEADY)
def test_a_steady_walk_that_is_not_perfect_is_measured(movement):
    assert measure(movement()).speed_m_s > 0.5


def test_exchanged_left_and_right_are_reported(tmp_path, capsys):
    walk = walk_of(PERSON, 1.0)
    swapped = dataclasses.replace(walk, heel_m=walk.heel_m[::-1], toe_m=walk.toe_m[::-1])
    path = tmp_path / "walk.csv"
    path.write_text(csv_text(swapped))
    assert main(["calibrate", str(path)]) == 2
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1
    assert "walk.csv: step width -0.138 m: left and right seem swapped" in shown


def test_a_swap_in_a_laboratory_s_file_is_reported_too(tmp_path):
    markers = laboratory(walk_of(PERSON, 1.0), LABORATORIES["z up, walking along -y"])
    exchanged = {f"Ann:{'RL'['LR'.index(name[4])]}{name[5:]}": xyz for name, xyz in markers.items()}
    with pytest.raises(UserError, match="left and right seem swapped"):
        measure(load_walk(c3d_file(tmp_path / "walk.c3d", exchanged)))


if TRIALS.is_dir():

    @pytest.mark.parametrize(
        "file", [row["file"] for row in csv.DictReader((TRIALS / "manifest.csv").open())]
    )
    def test_recorded_people_walk_steadily(file):
        measure(load_recording(str(TRIALS / file)))
