"""Reading trials, and the gait found in them: synthetic walks, recorded people, bad files."""

import csv
import dataclasses
import importlib.util
import re

import numpy as np
import pytest

from saddlewalk import paths
from saddlewalk.cli import main
from saddlewalk.errors import UserError
from saddlewalk.gait.events import FootEvents, analyse, mean_speed
from saddlewalk.gait.recording import COLUMNS, Recording, load_recording
from saddlewalk.gait.samples import SAMPLES, load_sample
from synthetic_walk import Walk, csv_text

SIDES = (0, 1)
WALKS = [
    Walk(),
    Walk(speed_m_s=0.4, step_length_m=0.4, step_width_m=0.2, stance=0.7, duration_s=20),
    Walk(speed_m_s=1.8, step_length_m=0.8, phase=0.7),
    Walk(speed_m_s=1.0, step_length_m=0.4, step_width_m=-0.03, rate_hz=150),
]

TRIALS = paths.CHECKOUT.parent / "shared/data/gait"


@pytest.fixture
def trial(tmp_path):
    """A trial file with one text replaced by another; its path."""

    def write(old: str = "", new: str = "", text: str | None = None) -> str:
        whole = csv_text(Walk(duration_s=0.05).recording()) if text is None else text
        assert old in whole
        path = tmp_path / "trial.csv"
        path.write_text(whole.replace(old, new, 1))
        return str(path)

    return write


def strikes(recording: Recording, side: int) -> np.ndarray:
    return recording.time_s[analyse(recording).events[side].heel_strikes]


@pytest.mark.parametrize("walk", WALKS, ids=str)
@pytest.mark.parametrize("noise_m", [0.0, 0.002])
def test_events_are_found_within_a_sample(walk, noise_m):
    recording = walk.recording(noise_m)
    gait = analyse(recording)
    for side in SIDES:
        for found, true_s in (
            (gait.events[side].heel_strikes, walk.heel_strikes_s(side)),
            (gait.events[side].toe_offs, walk.toe_offs_s(side)),
        ):
            inside = true_s[(true_s > 0.1) & (true_s < walk.duration_s - 0.3)]
            found_s = recording.time_s[found]
            nearest = np.abs(found_s[:, None] - inside).min(axis=0)
            assert np.all(nearest <= 1 / walk.rate_hz + 1e-9)
            assert len(inside) <= len(found_s) <= len(true_s)


@pytest.mark.parametrize("walk", WALKS, ids=str)
def test_speed_and_steps_are_those_that_were_walked(walk):
    gait = analyse(walk.recording(0.002))
    assert gait.speed_m_s == pytest.approx(walk.speed_m_s, rel=0.005)
    assert gait.step_lengths_m == pytest.approx(walk.step_length_m, abs=0.002)
    assert gait.step_widths_m == pytest.approx(walk.step_width_m, abs=0.002)


@pytest.mark.parametrize("phase", np.arange(0, 2, 0.1).round(1))
def test_contact_is_known_wherever_the_trial_begins(phase):
    walk = Walk(phase=phase)
    wrong = analyse(walk.recording()).contact != walk.contact()
    # An event too close to an end to separate from it shifts the contact at the end, nothing else.
    assert wrong.sum() <= 0.25 * walk.rate_hz
    middle = slice(int(0.2 * walk.rate_hz), -int(0.3 * walk.rate_hz))
    starts = np.abs(np.diff(walk.contact().astype(int), axis=1))[:, middle].sum()
    assert wrong[:, middle].sum() <= starts


def test_a_trial_may_begin_just_before_a_heel_strike():
    walk = Walk(phase=0.05)
    assert strikes(walk.recording(), 0)[0] == pytest.approx(walk.heel_strikes_s(0)[0], abs=0.01)


def test_speed_is_that_between_the_first_heel_strike_and_the_last():
    time_s = np.arange(50) / 10
    com_m = np.stack([time_s**2, 0 * time_s, 0 * time_s], axis=1)
    recording = Recording("", time_s, com_m, np.zeros((2, 50, 3)), np.zeros((2, 50, 3)))
    none = np.array([], dtype=int)
    left, right = FootEvents(np.array([20, 40]), none), FootEvents(np.array([10, 30]), none)
    assert mean_speed(recording, (left, right)) == pytest.approx((16 - 1) / (4 - 1))


def test_one_marker_a_foot_is_enough():
    walk = Walk()
    recording = walk.recording()
    gait = analyse(dataclasses.replace(recording, toe_m=recording.heel_m))
    assert gait.step_length_m == pytest.approx(walk.step_length_m, abs=0.002)
    assert gait.speed_m_s == pytest.approx(walk.speed_m_s, rel=0.005)


def test_missing_samples_stay_missing_and_hide_no_other_event():
    whole = strikes(Walk().recording(), 1)
    recording = Walk().recording()
    recording.heel_m[0, 100:130] = np.nan
    recording.heel_m[1, 105:107] = np.nan
    recording.toe_m[0, 140:144, 1] = np.nan
    recording.com_m[200, 0] = np.nan
    gait = analyse(recording)
    assert recording.time_s[gait.events[1].heel_strikes] == pytest.approx(whole)
    assert np.isnan(recording.cop_m[0, 100:130]).all()
    assert np.isnan(recording.com_velocity_m_s[[198, 199, 201, 202], 0]).tolist() == [0, 1, 1, 0]
    assert gait.step_length_m == pytest.approx(0.65, abs=0.002)
    assert gait.step_width_m == pytest.approx(0.12, abs=0.002)


def test_someone_who_stands_takes_no_step():
    still = np.tile([1.0, 0.0, 0.9], (200, 1))
    feet = still + np.array([[[0, 0.1, -0.9]], [[0, -0.1, -0.9]]])
    gait = analyse(Recording("nobody", np.arange(200) / 100, still, feet, feet))
    assert gait.contact.all()
    assert len(gait.step_lengths_m) == 0
    assert np.isnan([gait.speed_m_s, gait.step_length_m, gait.step_width_m]).all()


def test_a_walker_who_stops_stands_on_both_feet():
    walk = Walk(duration_s=3)
    recording = walk.recording()
    stop = int(np.ceil(walk.heel_strikes_s(1)[1] * walk.rate_hz))
    held = np.minimum(np.arange(len(recording.time_s)), stop)
    stopped = dataclasses.replace(
        recording,
        com_m=recording.com_m[held],
        heel_m=recording.heel_m[:, held],
        toe_m=recording.toe_m[:, held],
    )
    assert analyse(stopped).contact[:, stop + 20 :].all()


def test_velocity_is_the_central_difference():
    time_s = np.array([0.0, 0.1, 0.2, 0.3])
    com_m = np.stack([time_s**2, 2 * time_s, 0 * time_s], axis=1)
    feet = np.zeros((2, 4, 3))
    velocity = Recording("", time_s, com_m, feet, feet).com_velocity_m_s
    assert velocity[1:3, 0] == pytest.approx([0.2, 0.4])
    assert velocity[:, 1] == pytest.approx(2.0)


def test_a_trial_reads_back(trial):
    recording = Walk(duration_s=0.05).recording()
    read = load_recording(trial())
    assert read.source == "trial.csv"
    assert read.time_s == pytest.approx(recording.time_s, abs=1e-4)
    for name in ("com_m", "heel_m", "toe_m"):
        assert getattr(read, name) == pytest.approx(getattr(recording, name), abs=1e-4)


@pytest.mark.parametrize("cell", ["", "nan", "inf", "-inf", "1.7e308", "-1e6"])
def test_a_cell_that_is_empty_not_finite_or_absurd_is_missing(trial, cell):
    read = load_recording(trial("0.0500,0.0600,", f"0.0500,{cell},"))
    assert np.isnan(read.com_m[5, 0])
    assert np.isfinite(read.com_m[:5]).all()


BAD = [
    ("com_y", "com_why", "com_y"),
    ("0.0100,0.0120", "0.0100,twelve", "line 3.*com_x.*'twelve'"),
    ("\n0.0200,", "\n0.0100,", "line 4, t: 0.01 must be later than 0.01 s"),
    ("\n0.0200,", "\n,", "line 4.*t.*nan"),
    ("\n0.0200,", "\n0.0100001,", "line 4, t: .* must be later than 0.01 s"),
    ("\n0.0200,", "\n1e9,", "line 4, t: .* must be within 86400 s of the first, 0 s"),
]


@pytest.mark.parametrize(("old", "new", "words"), BAD, ids=[words for *_, words in BAD])
def test_a_bad_trial_is_a_one_line_error_with_its_place(trial, capsys, old, new, words):
    assert main(["replay", trial(old, new)]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert "trial.csv" in printed.err
    assert re.search(words, printed.err)


@pytest.mark.parametrize("text", ["", ",".join(COLUMNS), ",".join(COLUMNS) + "\n0" + ",0" * 15])
def test_a_trial_without_samples_is_rejected(trial, text):
    with pytest.raises(UserError, match=r"trial\.csv"):
        load_recording(trial(text=text))


def test_a_file_that_is_not_there_or_not_text_is_rejected(tmp_path):
    with pytest.raises(UserError, match=r"absent\.csv"):
        load_recording(str(tmp_path / "absent.csv"))
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(UserError, match=r"bytes\.csv"):
        load_recording(str(tmp_path / "bytes.csv"))


needs_gaitkit = pytest.mark.skipif(
    importlib.util.find_spec("gaitkit") is None, reason="gaitkit is missing: run `make samples`"
)


@needs_gaitkit
@pytest.mark.parametrize("name", SAMPLES)
def test_samples_are_in_the_task_frame(name):
    recording = load_sample(name)
    assert "CC-BY 4.0" in recording.source
    assert "CoM taken midway between the hips" in recording.source
    assert np.ptp(recording.com_m[:, 0]) > 2
    assert recording.com_m[-1, 0] > recording.com_m[0, 0]
    assert np.all((recording.com_m[:, 2] > 0.8) & (recording.com_m[:, 2] < 1.0))
    assert np.all(recording.heel_m[..., 2] < 0.4)
    assert np.all(recording.toe_m[0, :, 1] > recording.toe_m[1, :, 1])
    stance = analyse(recording).contact
    ahead = (recording.toe_m - recording.heel_m)[..., 0]
    assert np.all(ahead[stance] > 0)


@needs_gaitkit
def test_the_samples_are_a_healthy_and_a_slower_walk():
    healthy, stroke = (analyse(load_sample(name)) for name in ("healthy", "stroke"))
    assert (len(healthy.step_lengths_m), len(stroke.step_lengths_m)) == (4, 6)
    assert healthy.speed_m_s == pytest.approx(1.26, abs=0.01)
    assert stroke.speed_m_s == pytest.approx(0.87, abs=0.01)
    assert healthy.step_length_m > stroke.step_length_m


def test_a_landmark_of_zeros_is_missing(monkeypatch, tmp_path):
    import json

    from saddlewalk.gait import samples

    points = ("hip", "heel", "toe")
    landmarks = {
        f"{side}_{p}": [1000.0, 2000.0, 3000.0] for side in ("left", "right") for p in points
    }
    frames = [{"frame_index": i, "landmark_positions": dict(landmarks)} for i in range(2)]
    frames[1]["landmark_positions"]["left_heel"] = [0.0, 0.0, 0.0]
    trial = {"description": "d", "source": "s", "fps": 50.0, "angle_frames": frames}
    (tmp_path / "gaitkit/data").mkdir(parents=True)
    (tmp_path / "gaitkit/data/example_stroke.json").write_text(json.dumps(trial))

    class Package:
        version = "0"

        @staticmethod
        def locate_file(name):
            return tmp_path / name

    monkeypatch.setattr(samples, "distribution", lambda name: Package)
    recording = load_sample("stroke")
    assert recording.time_s.tolist() == [0.0, 0.02]
    assert recording.com_m[0].tolist() == [-1.0, -2.0, 3.0]
    assert np.isnan(recording.heel_m[0, 1]).all()
    assert np.isfinite(recording.heel_m[1]).all()


def test_without_gaitkit_the_remedy_is_named(tmp_path, monkeypatch, capsys):
    from importlib.metadata import PackageNotFoundError

    from saddlewalk.gait import samples

    def absent(name):
        raise PackageNotFoundError(name)

    monkeypatch.setattr(samples, "distribution", absent)
    for installed, remedy in (
        (False, "run `make samples`"),
        (True, "run `pip install 'saddlewalk[samples]'`"),
    ):
        monkeypatch.setattr(paths, "SHIPPED", tmp_path if installed else tmp_path / "none")
        assert main(["replay", "--sample", "healthy"]) == 2
        printed = capsys.readouterr().err
        assert printed.count("\n") == 1
        assert remedy in printed


if TRIALS.is_dir():

    @pytest.mark.parametrize(
        "row", list(csv.DictReader((TRIALS / "manifest.csv").open())), ids=lambda row: row["file"]
    )
    def test_recorded_trials_match_their_manifest(row):
        gait = analyse(load_recording(str(TRIALS / row["file"])))
        assert gait.speed_m_s == pytest.approx(float(row["speed_m_s"]), rel=0.03)
        assert gait.step_length_m == pytest.approx(float(row["step_length_m"]), rel=0.05)
