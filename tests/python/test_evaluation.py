"""`saddlewalk evaluate`: its walks, its statistics, its baselines and its region of attraction."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.config import configuration
from saddlewalk.core import ffi, library
from saddlewalk.emulation.wearer import Body
from saddlewalk.evaluation.baselines import half_foot_m, hof_margin_m, hull_margin_m
from saddlewalk.evaluation.detection import detection_of, evidence, push_limits, recovery_benefit
from saddlewalk.evaluation.region import POSTURES, Posture, bring_to_rest, explore, grid
from saddlewalk.evaluation.scoring import roc
from saddlewalk.evaluation.walks import (
    CELLS,
    KINDS,
    MARGINS,
    SOON_S,
    SPEEDS_M_S,
    WARNING_MIN_S,
    WINDOWS,
    Setting,
    Trial,
    Walk,
    course_of,
    draw,
    evaluate,
    evaluated_walk,
    run,
)
from saddlewalk.workers import Workers
from synthetic_walk import Walk as RecordedWalk
from synthetic_walk import csv_text

MASS_KG = 63.3


def default_config():
    config = ffi().new("saddle_config_t *")
    config[0] = library().saddle_config_default(1.79, MASS_KG)
    return config


def walk_of(index: int, fell_at_s=math.nan, alarm_at_s=math.nan, **changes) -> Walk:
    """A made-up walk with a push at 6 s; margin: every margin's minimum."""
    margin = changes.pop("margin", math.nan)
    trial = Trial("planned", index, -1, 1.0, 0.0, 6.0, 10.0, 0)
    least = {window: dict.fromkeys(MARGINS, margin) for window in WINDOWS}
    walk = Walk(trial, fell_at_s, alarm_at_s, least, {1: 10}, {0: 10}, {1: 12}, {})
    return replace(walk, trial=replace(trial, **changes))


@pytest.mark.parametrize("index", [-20, -24])
@pytest.mark.parametrize("kind", KINDS)
def test_nobody_falls_while_stopping(kind, index):
    """One once crawled through a step too slow to stand on a leg; one's last swing never began."""
    trial = draw(1, index, kind, MASS_KG)
    assert 0.67 < trial.speed_m_s < 0.71
    course = run(trial, default_config())
    assert math.isnan(course.fell_at_s)
    assert course.ticks["mode"][-1] == library().SADDLE_MODE_STANDING


def test_one_rectangle_margin_is_the_distance_to_its_border():
    height_m = 2.0
    half = half_foot_m(height_m)
    foot = np.broadcast_to([0.3, -0.1], (4, 2, 2))
    points = np.array([[0.3, -0.1], [0.3 + half[0] + 0.2, -0.1], [0.3, -0.1 + half[1] - 0.01],
                       [0.3 - half[0] - 0.03, -0.1 - half[1] - 0.04]])  # fmt: skip
    expected = [half[1], -0.2, 0.01, -0.05]
    assert hull_margin_m(points, foot, half) == pytest.approx(expected, abs=1e-12)


def test_hull_margin_of_two_feet_agrees_with_a_fine_border():
    random = np.random.default_rng(7)
    height_m, count = 1.79, 300
    feet = random.uniform(-0.6, 0.6, (count, 2, 2))
    points = random.uniform(-0.5, 0.5, (count, 2))
    half = half_foot_m(height_m)
    angles = np.linspace(0, 2 * np.pi, 20_001)
    normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    # A convex set's signed margin is the least of its supporting lines' distances, seen from
    # inside; from outside, the greatest violation. Normals 314 microradians apart, 1.2 m at most.
    for foot, point, margin in zip(feet, points, hull_margin_m(points, feet, half), strict=True):
        support = (normals @ foot.T).max(axis=1) + np.abs(normals) @ half
        assert margin == pytest.approx((support - normals @ point).min(), abs=4e-4)


def test_hof_margin_counts_only_feet_on_the_ground():
    feet = np.array([[[0.0, 0.1], [0.5, -0.1]]] * 3)
    contact = np.array([[True, True], [True, False], [False, False]])
    xcom = np.array([[0.5, -0.1]] * 3)
    both, left, none = hof_margin_m(xcom, feet, contact, half_foot_m(1.79))
    assert both > 0 > left and math.isnan(none)


def test_a_state_comes_to_rest_exactly_if_its_xcom_is_in_the_soles():
    body, random = Body(), np.random.default_rng(3)
    states = random.uniform(-1, 1, (2000, 4)) * [0.3, 0.3, 0.9, 0.9]
    posture = Posture("apart", ((0.1, 0.12), (-0.1, -0.12)))
    stops, _ = bring_to_rest(posture, states, body)
    # The soles' hull is where their middles' line comes within half a sole of the XCoM.
    xcom = states[:, :2] + states[:, 2:] / body.natural_frequency_rad_s
    shares = np.linspace(0, 1, 1001)[:, None, None]
    left, right = (np.array(cop) for cop in posture.cop_m)
    off = np.abs(xcom - (left + shares * (right - left)))
    depth_m = np.minimum(
        body.foot_half_length_m - off[..., 0], body.foot_half_width_m - off[..., 1]
    ).max(axis=0)
    sure = np.abs(depth_m) > 2e-3
    assert 50 < (depth_m > 0).sum() < 1000
    assert (stops == (depth_m > 0))[sure].all()


def test_work_of_a_stop_on_one_foot_is_the_absorbed_energy():
    body = Body()
    posture = Posture("right foot", ((0.0, 0.1), (0.0, 0.0)), (False, True))
    slow, fast = np.array([[0.0, 0.0, 0.1, 0.0]]), np.array([[0.0, 0.0, 0.25, 0.0]])
    (stops_slow,), (work_slow,) = bring_to_rest(posture, slow, body)
    (stops_fast,), (work_fast,) = bring_to_rest(posture, fast, body)
    assert stops_slow and stops_fast
    # From the equilibrium the kinetic energy must go, and what the pendulum adds on the way.
    assert work_slow >= 0.5 * body.mass_kg * 0.1**2
    assert work_fast == pytest.approx(work_slow * 6.25, rel=0.2)


def test_claims_are_those_of_the_core_and_confusion_counts_every_state():
    config, states = default_config(), grid()
    region = explore(POSTURES[0], states, config)
    at_rest = np.flatnonzero((states == 0).all(axis=1))
    assert region.stops_within_work[at_rest] and region.claims["stays"][at_rest]
    assert (region.claims["stays"] <= region.claims["can_stop"]).all()
    for claim in region.claims:
        counts = region.confusion(claim)
        assert sum(counts.values()) - counts["false_safe_by_work"] == len(states)


def test_rates_and_lead_times_of_synthetic_walks():
    walks = [
        walk_of(0, fell_at_s=8.0, alarm_at_s=7.0),
        walk_of(2, fell_at_s=8.0, alarm_at_s=7.9),
        walk_of(4, fell_at_s=8.0),
        walk_of(6, alarm_at_s=7.0),
        walk_of(8),
        walk_of(-1, impulse_n_s=0.0),
    ]
    found = detection_of(walks)
    assert (found.pushed, found.fallen, found.calm_falls) == (5, 3, 0)
    assert found.sensitivity == pytest.approx(2 / 3) and found.timely == pytest.approx(1 / 3)
    assert found.false_alarms == 0.5
    assert found.lead_median_s == pytest.approx(0.55)
    assert found.lead_tenth_s == pytest.approx(0.19)
    assert found.walking_levels == {"stable": 60} and found.alarm_share == 0


def test_area_under_the_roc_counts_pairs_and_halves_ties():
    walks = [
        walk_of(0, fell_at_s=8.0, margin=-2.0),
        walk_of(2, fell_at_s=8.0, margin=0.0),
        walk_of(4, margin=0.0),
        walk_of(6, margin=1.0),
        walk_of(8, margin=math.nan),
    ]
    areas = detection_of(walks).areas
    assert areas[WINDOWS[0]]["S_SW"] == (3 + 0.5) / 4
    false, true = roc(*evidence(walks, WINDOWS[0], "S_SW"))
    assert np.trapezoid(true, false) == (3 + 0.5) / 4
    assert math.isnan(detection_of(walks[:2]).areas[WINDOWS[0]]["S_SW"])


def test_recovery_benefit_and_push_limits():
    walks = [
        walk_of(0, fell_at_s=8.0), walk_of(0, kind="recovery"),
        walk_of(2), walk_of(2, kind="recovery"),
        walk_of(1, cell=3, impulse_n_s=20.0), walk_of(41, cell=3, impulse_n_s=40.0, fell_at_s=9.0),
        walk_of(81, cell=3, impulse_n_s=10.0),
    ]  # fmt: skip
    benefit = recovery_benefit(walks)
    assert (benefit["pushes"], benefit["recovery_alone_survives"], benefit["both_survive"]) == (
        2,
        0.5,
        0.5,
    )
    assert push_limits(walks)["planned"] == {3: pytest.approx(20.0)}


def test_trials_are_equal_for_both_kinds_and_cover_the_stated_ranges():
    trials = [draw(5, index, "planned", MASS_KG) for index in range(400)]
    other = [draw(5, index, "recovery", MASS_KG) for index in range(400)]
    assert [replace(trial, kind="planned") for trial in other] == trials
    speeds = np.array([trial.speed_m_s for trial in trials])
    assert SPEEDS_M_S[0] <= speeds.min() < 0.55 and 1.55 < speeds.max() <= SPEEDS_M_S[1]
    near = [trial for trial in trials if trial.cell >= 0]
    assert len(near) == 200 and {trial.cell for trial in near} == set(range(CELLS))
    assert {trial.direction_deg > 0 for trial in near} == {True, False}
    assert draw(6, 0, "planned", MASS_KG) != trials[0]


def test_a_fall_is_announced_and_its_record_is_consistent():
    config = default_config()
    trial = replace(draw(1, 0, "planned", MASS_KG), impulse_n_s=60.0, direction_deg=90.0)
    course = run(trial, config)
    walk, ticks, fell_at_s = evaluated_walk(trial, course, course), course.ticks, course.fell_at_s
    assert walk.fell and trial.push_time_s < walk.alarm_at_s < fell_at_s
    assert ticks["time_s"][-1] < fell_at_s
    since_push_s = ticks["time_s"] - trial.push_time_s
    after = (since_push_s >= 0) & (since_push_s < SOON_S)
    after &= ticks["time_s"] < fell_at_s - WARNING_MIN_S
    soon = walk.least["first 0.4 s"]
    assert soon["S_SW"] == np.nanmin(ticks["s_sw"][after])
    assert soon["recovery margin"] == np.nanmin(ticks["recovery_margin_m"][after])
    assert walk.least["to the fall"]["S_SW"] <= soon["S_SW"]
    assert sum(walk.walking_levels.values()) > 30


def test_the_same_walks_whatever_the_number_of_jobs():
    config, progress = default_config(), []
    alone = evaluate(3, 3, config, Workers(1), progress.append)
    shared = evaluate(3, 3, config, Workers(2), lambda done: None)
    assert [repr(walk) for walk in alone] == [repr(walk) for walk in shared]
    assert progress[-1] == len(alone) == len(KINDS) * (3 + 1)
    trial, course = course_of(3, 1, "recovery", config)
    again = next(walk for walk in alone if walk.trial == trial)
    assert repr(again.fell_at_s) == repr(course.fell_at_s)


def test_a_staircase_pushes_harder_until_the_wearer_falls():
    config = default_config()
    impulses = [
        course_of(2, index, "planned", config)[0].impulse_n_s for index in (1, 1 + 2 * CELLS)
    ]
    fell = math.isfinite(course_of(2, 1, "planned", config)[1].fell_at_s)
    assert (impulses[1] < impulses[0]) == fell


def test_the_command_reports_and_writes(tmp_path, capsys):
    gait, out = tmp_path / "gait", tmp_path / "out"
    gait.mkdir()
    (gait / "somebody.csv").write_text(csv_text(RecordedWalk().recording()))
    (gait / "manifest.csv").write_text("file,height_m,mass_kg\nsomebody.csv,1.7,60\n")
    assert main(["evaluate", "--walks", "4", "--gait", str(gait), "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    for words in ("seed 1", "sensitivity", "recovery margin", "Hof", "sideways", "somebody"):
        assert words in printed
    result = json.loads((out / "evaluation.json").read_text())
    assert result["detection"]["planned"]["pushed"] == 4
    assert result["gait"][0]["height_m"] == pytest.approx(1.7)
    with (out / "walks.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(KINDS) * (4 + 1)
    assert all(SPEEDS_M_S[0] <= float(row["speed_m_s"]) <= SPEEDS_M_S[1] for row in rows)
    for picture in ("roc.png", "region.png"):
        assert (out / picture).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--walks", "0"], "'0'"),
        (["--jobs", "many"], "'many'"),
        (["--seed", "-1"], "'-1'"),
        (["--gait", "nowhere"], "nowhere"),
        (["--height", "17"], "17"),
    ],
)
def test_a_bad_option_is_a_one_line_error(options, named, capsys):
    try:
        status = main(["evaluate", *options])
    except SystemExit as end:
        status = end.code
    printed = capsys.readouterr().err
    assert status == 2
    assert printed.count("\n") == 1 and named in printed and options[0].strip("-") in printed


def test_a_walk_that_turns_is_stable_until_it_is_pushed_over():
    config, turning = configuration({}), Setting(turn_rad_s=0.3)
    calm = Trial("recovery", -1, -1, 0.8, 0.0, 7.0, 0.0, 5)
    pushed = replace(calm, index=0, kind="planned", direction_deg=90.0, impulse_n_s=60.0)
    straight, bent = (run(calm, config, setting=each) for each in (Setting(), turning))
    for course in (straight, bent):
        assert math.isnan(course.fell_at_s)
        assert set(course.ticks["level"]) == {library().SADDLE_LEVEL_STABLE}
    sideways_m = [np.ptp(course.ticks["true_com_y_m"]) for course in (straight, bent)]
    assert sideways_m[0] < 0.3 and sideways_m[1] > 3.0  # circles of 2.7 m
    fall = evaluated_walk(pushed, run(pushed, config, setting=turning), None)
    assert 7.0 < fall.alarm_at_s < fall.fell_at_s
