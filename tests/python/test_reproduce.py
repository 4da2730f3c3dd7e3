"""`saddlewalk reproduce`: its numbers compared with the twin, its page, people, and failures."""

import base64
import csv
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from saddlewalk import html_page, paths
from saddlewalk.cli import main
from saddlewalk.errors import UserError
from saddlewalk.paper import figures, numbers, readings, simulations
from saddlewalk.paper.people import load_trials
from saddlewalk.paper.simulations import FIGURE_HEEL_STRIKE_DEG, SPEEDS_M_S
from synthetic_walk import Walk, csv_text
from twin import Twin

TRIALS = paths.CHECKOUT.parent / "shared/data/gait"
FIGURES = "steps lateral-stability vertical-amplitude vertical-motion from-above toe-off".split()
JUST_S = 1e-9


@pytest.fixture(scope="module")
def simulated():
    return numbers.simulate_all()


@pytest.fixture(scope="module")
def reproduced(tmp_path_factory):
    """The output folder of the command, with recorded people of all kinds."""
    folder = tmp_path_factory.mktemp("paper")
    gait = folder / "gait"
    gait.mkdir()
    (gait / "walks.csv").write_text(csv_text(Walk().recording()))
    (gait / "runs.csv").write_text(csv_text(Walk(speed_m_s=2.5, step_length_m=1.0).recording()))
    (gait / "creeps.csv").write_text(csv_text(Walk(speed_m_s=1e-3).recording()))
    unseen = Walk(speed_m_s=1.2).recording()
    unseen.heel_m[:, ::7] = np.nan
    unseen.com_m[::5] = np.nan
    (gait / "unseen.csv").write_text(csv_text(unseen))
    child = Walk(speed_m_s=1.0).recording()
    (gait / "child.csv").write_text(csv_text(child))
    (gait / "manifest.csv").write_text("file,dataset,group\nchild.csv,Ours,child\n")
    assert main(["reproduce", "--out", str(folder / "out"), "--gait", str(gait)]) == 0
    return folder / "out"


def twin(speed_m_s: float, ankle: str = "erf") -> Twin:
    return Twin(speed_m_s, math.radians(FIGURE_HEEL_STRIKE_DEG), ankle)


def peak_to_peak_mm(walker: Twin) -> float:
    saddle_s = walker.step_time / 2
    times_s = [0.0, saddle_s - JUST_S, saddle_s, *np.linspace(0, walker.step_time, 2001)]
    return 1e3 * float(np.ptp([walker.com_z(t) for t in times_s]))


def jump_mm(walker: Twin) -> float:
    saddle_s = walker.step_time / 2
    return 1e3 * (walker.com_z(saddle_s) - walker.com_z(saddle_s - JUST_S))


@pytest.mark.parametrize("index", range(len(SPEEDS_M_S)))
def test_numbers_as_read_are_those_of_the_double_precision_twin(index):
    walker = twin(SPEEDS_M_S[index])
    for printed, value in (
        (numbers.HALF_STEP_MM, 500 * walker.step),
        (numbers.HALF_STEP_MIN_MM, 500 * walker.speed / walker.frequency),
        (numbers.WIDTH_MM, 1e3 * walker.width),
        (numbers.HUMAN_VERTICAL_MM, 26.56 * walker.speed + 2.575),
        (numbers.S_SW_MIN, walker.s_sw(0.0)),
        (numbers.TOE_OFF_DEG, math.degrees(walker.toe_off_angle())),
        (numbers.PLANNER_VERTICAL_MM, peak_to_peak_mm(walker)),
        (numbers.RIGID_VERTICAL_MM, peak_to_peak_mm(twin(walker.speed, "rigid"))),
        (numbers.JUMP_MM, jump_mm(walker)),
    ):
        assert value == pytest.approx(float(printed[index]), abs=numbers.half_digit(printed[index]))


def test_every_number_and_finding_is_reproduced_by_the_core(simulated):
    compared = numbers.numbers(simulated)
    assert len(compared) == 16 + 9 * len(SPEEDS_M_S)
    assert [number for number in compared if not number.sound] == []
    assert [found for found in numbers.findings(simulated) if not found.holds] == []


@pytest.mark.parametrize(
    ("field", "change", "off"),
    [
        ("half_step_slope_s", 1.001, {"half step length, slope", "half step length"}),
        ("step_width_fast_m", 1.01, {"step width, fast", "step width"}),
        ("step_width_slow_m", 1.01, {"step width, slow"}),
        ("step_width_slope_s", 1.01, {"step width, slope", "step width"}),
        ("vertical_intercept_m", 1.01, {"vertical amplitude, intercept", "vertical, people"}),
        ("ankle_time_constant_s", 1.01, {"time constant of the ankle"}),
        ("cop_range_m", 1.05, {"CoP to the foot's pivots", "toe-off angle"}),
        ("peak_speed_m_s", 1.01, {"XCoM and reach limits meet", "reach of half a step"}),
        ("pendulum_ratio", 1.01, {"pendulum by body height", "natural frequency", "XCoM limit"}),
    ],
)
def test_another_model_fails_the_comparison(field, change, off, monkeypatch):
    paper_body = simulations.mean_body

    def other_body(ankle: str = "erf"):
        config = paper_body(ankle)
        setattr(config, field, change * getattr(config, field))
        return config

    monkeypatch.setattr(simulations, "mean_body", other_body)
    monkeypatch.setattr(numbers, "mean_body", other_body)
    found = {number.what for number in numbers.numbers(numbers.simulate_all()) if not number.sound}
    assert found >= off


def test_a_rigid_leg_does_not_reproduce_the_ankles_results(simulated):
    rigid = replace(simulated, walks={key: simulated.rigid[key[0]] for key in simulated.walks})
    fallen = [found.claim for found in numbers.findings(rigid) if not found.holds]
    assert [claim.split(" (")[0] for claim in fallen] == [
        "The vertical error is significantly lower than the rigid pendulum's",
        "The vertical trajectory is not as smooth as a person's",
    ]


def test_a_com_beside_the_saddle_is_found(simulated):
    aside = {
        key: replace(walk, columns=walk.columns | {"com_y_m": walk["com_y_m"] + 1e-5})
        for key, walk in simulated.walks.items()
    }
    fallen = [f.claim for f in numbers.findings(replace(simulated, walks=aside)) if not f.holds]
    assert fallen == ["The CoM stays on y_Saddle, also during the swing (eq. 2)"]


@pytest.mark.parametrize(("speed", "share"), [(0.7, 0.41), (1.0, 0.0)])
def test_time_in_the_base_is_a_share_of_the_stride(speed, share, simulated):
    assert simulated.at(speed).share_inside("mos_xcom_m") == pytest.approx(share, abs=0.01)


@pytest.mark.parametrize("speed", SPEEDS_M_S)
def test_the_jump_at_the_saddle_does_not_depend_on_the_rows(speed, simulated):
    coarse = simulations.simulate(speed, samples=simulations.COARSE_SAMPLES)
    assert coarse.jump_m == pytest.approx(simulated.at(speed).jump_m, abs=2e-4)


@pytest.mark.parametrize("speed", [0.7, 1.5, 1.6, 1.9])
def test_the_toe_off_angle_does_not_depend_on_the_rows(speed):
    fine = simulations.simulate(speed, samples=8000)
    coarse = simulations.simulate(speed, samples=simulations.COARSE_SAMPLES)
    assert coarse.toe_off_rad == pytest.approx(fine.toe_off_rad, abs=math.radians(0.05))


def test_a_missing_number_fails_the_comparison():
    lost = numbers.Number("x", "", "0.10", math.nan, "m", 0.005, "eq:03", stated=True)
    assert not lost.sound
    assert replace(lost, ours=0.1049).sound
    assert not replace(lost, ours=0.1051).sound


@pytest.mark.parametrize(
    ("speed", "planned"), [(math.nan, 0), (0.0, 0), (0.005, 0), (0.02, 1), (1.93, 1), (1.94, 0)]
)
def test_speeds_that_would_be_limited_are_known(speed, planned):
    assert simulations.gait(speed).planned == bool(planned)


@pytest.mark.parametrize(("printed", "half"), [("0.10", 0.005), ("-29", 0.5), ("1.935", 0.0005)])
def test_half_a_unit_of_the_last_digit(printed, half):
    assert numbers.half_digit(printed) == pytest.approx(half)


def test_exit_status_1_if_a_number_is_outside_its_tolerance(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(figures, "draw_all", lambda simulations, trials: [])
    monkeypatch.setattr(numbers, "TOE_OFF_DEG", ("9.6", "12.3", "15.5", "25.2"))
    assert main(["reproduce", "--out", str(tmp_path)]) == 1
    printed = capsys.readouterr().out
    assert "51 of 52 numbers (28 stated in the paper, 24 as read)" in printed
    assert "off: toe-off angle 1.6 m/s" in printed
    assert "**off**" not in (page := (tmp_path / "paper.html").read_text())
    assert page.count("<strong>off</strong>") == 1


def test_exit_status_1_if_a_finding_does_not_hold(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(figures, "draw_all", lambda simulations, trials: [])
    monkeypatch.setattr(numbers, "VARIABILITY_SD", 1.0)
    assert main(["reproduce", "--out", str(tmp_path)]) == 1
    assert "7 of 8 findings hold; off: The vertical trajectory is acc" in capsys.readouterr().out


def test_the_page_is_self_contained_with_every_figure(reproduced):
    page = (reproduced / "paper.html").read_text()
    embedded = re.findall(r'<img src="data:image/png;base64,([^"]+)"', page)
    drawn = [(reproduced / f"{name}.png").read_bytes() for name in FIGURES]
    assert [base64.b64decode(image) for image in embedded] == drawn
    assert all(image.startswith(b"\x89PNG") for image in drawn)
    assert not re.search(r'(src|href)="(?!data:)', page)
    assert sorted(path.name for path in reproduced.iterdir()) == sorted(
        ["paper.html", *(f"{name}.png" for name in FIGURES)]
    )


def test_page_reports_every_number_and_every_reading(reproduced, simulated):
    page = (reproduced / "paper.html").read_text()
    rows = re.findall(r"<tr>(.*?)</tr>", page, re.DOTALL)
    cells = [re.findall(r"<td>(.*?)</td>", row, re.DOTALL) for row in rows]
    compared = [(row[0], row[1], row[7]) for row in cells if len(row) == 8]
    assert [(number.what, number.case) for number in numbers.numbers(simulated)] == [
        row[:2] for row in compared
    ]
    assert {row[2] for row in compared} == {"same"}
    tags = [row[0] for row in cells if len(row) == 4 and re.fullmatch(r"E\d+", row[0])]
    assert tags == [reading.tag for reading in readings.readings()]


def test_readings_are_the_rows_of_the_equations_page(monkeypatch, tmp_path):
    tags = {reading.tag for reading in readings.readings()}
    page = (paths.CHECKOUT / "docs/equations.md").read_text()
    marked = [line for line in page.splitlines() if "*reading*" in line and line.startswith("| [E")]
    assert tags == {re.match(r"\| \[(E\d+)\]", line).group(1) for line in marked}
    assert {"E6", "E7", "E13"} <= tags
    monkeypatch.setattr(readings, "PAGE", tmp_path / "none.md")
    with pytest.raises(UserError, match=r"none\.md: No such file"):
        readings.readings()
    (tmp_path / "none.md").write_text("| [E1] | x | eq:01 | as printed |\n")
    with pytest.raises(UserError, match="no row of a table with"):
        readings.readings()


def test_without_trials_only_orendurff_is_drawn_with_a_note(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(figures, "draw_all", lambda simulations, trials: [])
    assert main(["reproduce", "--out", str(tmp_path)]) == 0
    assert "only by the points of Orendurff 2004" in capsys.readouterr().out
    assert "only by the points of Orendurff 2004" in (tmp_path / "paper.html").read_text()


def test_people_are_measured_as_they_walked(tmp_path):
    fast = Walk(speed_m_s=1.5, step_width_m=0.2)
    slow = Walk(speed_m_s=0.8)
    (tmp_path / "a.csv").write_text(csv_text(fast.recording()))
    (tmp_path / "b.csv").write_text(csv_text(slow.recording()))
    (tmp_path / "manifest.csv").write_text("file,group,step_width_m\nb.csv,a child,\n")
    first, second = load_trials(tmp_path)
    assert (first.name, first.child, second.name, second.child) == ("b", True, "a", False)
    assert second.speed_m_s == pytest.approx(1.5, rel=0.005)
    assert second.step_length_m == pytest.approx(0.65, abs=0.002)
    assert second.step_width_m == pytest.approx(0.2, abs=0.001)
    assert np.isnan([first.step_width_m, first.s_sw_min]).all()
    # The CoM sways by 0.02 m to each side, between feet 0.2 m apart.
    assert second.s_sw_min == pytest.approx(1 - 2 * 0.02 / 0.2, abs=0.02)
    # Its height has a period of 1 s; a stride of the slow walk takes longer.
    assert first.vertical_m == pytest.approx(0.02, abs=0.0002)


def test_a_person_who_stands_is_reported_as_unknown(tmp_path):
    still = Walk(speed_m_s=1e-3).recording()
    (tmp_path / "still.csv").write_text(csv_text(still))
    (trial,) = load_trials(tmp_path)
    assert np.isnan([trial.step_length_m, trial.vertical_m, trial.s_sw_min]).all()


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (None, "--gait {0}: no such folder"),
        ({}, "--gait {0}: no trials (*.csv) in it"),
        ({"manifest.csv": "file\n"}, "--gait {0}: no trials (*.csv) in it"),
        ({"a.csv": "t,com_x\n0,1\n"}, "{0}/a.csv: no column com_y"),
        ({"a.csv": "t\n", "manifest.csv": "name\na\n"}, "{0}/manifest.csv: no column file"),
        ({"a.csv": "t\n", "manifest.csv": "file\n\xff"}, "{0}/manifest.csv: not CSV"),
    ],
)
def test_bad_trials_are_named_and_nothing_is_written(files, message, tmp_path, capsys):
    folder = tmp_path / "gait"
    if files is not None:
        folder.mkdir()
        for name, text in files.items():
            (folder / name).write_text(text, encoding="latin-1")
    out = tmp_path / "out"
    assert main(["reproduce", "--out", str(out), "--gait", str(folder)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert message.format(folder) in error
    assert not out.exists()


def test_a_folder_that_cannot_be_written_is_named(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(figures, "draw_all", lambda simulations, trials: [])
    (tmp_path / "file").write_text("")
    assert main(["reproduce", "--out", str(tmp_path / "file")]) == 2
    assert f"--out {tmp_path}/file" in capsys.readouterr().err


def test_table_cells_are_escaped():
    page = html_page.page("<t>", html_page.table(("a", "b"), [["|y|", "**off** < 1"]]), {})
    assert "<td>|y|</td>" in page.replace("&#124;", "|")
    assert "<td><strong>off</strong> &lt; 1</td>" in page
    assert "<title>&lt;t&gt;</title>" in page


if TRIALS.is_dir():

    def test_recorded_people_match_their_manifest():
        lines = (TRIALS / "manifest.csv").read_text().splitlines()
        manifest = {row["file"]: row for row in csv.DictReader(lines)}
        trials = load_trials(TRIALS)
        assert len(trials) == len(manifest)
        for trial in trials:
            row = manifest[f"{trial.name}.csv"]
            assert trial.vertical_m == pytest.approx(float(row["dz_m"]), abs=5e-4)
            if row["step_width_m"]:
                assert trial.step_width_m == pytest.approx(float(row["step_width_m"]), abs=2e-3)
