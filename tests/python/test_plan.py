"""`saddlewalk plan` against the golden runs, the twin, the paper's figures and bad options."""

import argparse
import csv
import io
import math
from pathlib import Path

import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.config import load_config
from twin import Twin

pytestmark = pytest.mark.firmware

GOLDEN = Path(__file__).parents[1] / "golden"
SPEEDS = (0.7, 1.0, 1.2, 1.6)
ANGLES_DEG = (5, 10, 15)

# The paper's figures as peak-to-peak z over a stride at 10 degrees: speed, planner, rigid pendulum.
PEAK_TO_PEAK_M = (
    (0.7, 0.0198, 0.0375),
    (1.0, 0.0331, 0.0512),
    (1.2, 0.0447, 0.0630),
    (1.6, 0.0736, 0.0926),
)

# Float arithmetic on metres and radians of order 1 to 10: the golden runs' stated tolerance.
TOLERANCE = 2e-5
# N and N/m s^-2: the same relative precision on forces of up to 400 N.
FORCE_TOLERANCE_N = 400 * TOLERANCE


def plan(capsys, *options: str) -> list[dict[str, str]]:
    assert main(["plan", *options]) == 0
    return list(csv.DictReader(io.StringIO(capsys.readouterr().out)))


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("angle", ANGLES_DEG)
def test_golden_run_is_reproduced_to_the_bit(speed, angle, capsys):
    golden = (GOLDEN / f"plan_speed{speed}_hs{angle:02}.csv").read_text()
    assert main(["plan", "--speed", str(speed), "--hs-angle", str(angle)]) == 0
    assert capsys.readouterr().out == golden


def expected_row(twin: Twin, t: float) -> dict[str, float]:
    com, velocity, feet = twin.com_xy(t), twin.com_xy_velocity(t), twin.feet(t)
    swing = "right" if twin.support(t) == "left" else "left"
    height = {twin.support(t): 0.0, swing: twin.swing_height(t)}
    toe_off, heel_strike = twin.ankle_angles(t)
    return {
        "phase": math.floor(2 * t / twin.step_time) % 4,
        "theta_rad": math.pi * t / twin.step_time,
        "com_x_m": com[0],
        "com_y_m": com[1],
        "com_z_m": twin.com_z(t),
        "com_vx_m_s": velocity[0],
        "com_vy_m_s": velocity[1],
        "com_vz_m_s": twin.com_vz(t),
        "left_x_m": feet["left"][0],
        "left_y_m": feet["left"][1],
        "left_z_m": height["left"],
        "right_x_m": feet["right"][0],
        "right_y_m": feet["right"][1],
        "right_z_m": height["right"],
        "leg_length_m": twin.leg(t),
        "theta_to_rad": toe_off,
        "theta_hs_rad": heel_strike,
        "s_pend": 1.0,
        "s_jump": 1.0,
        "s_sw": twin.s_sw(t),
        "mos_com_m": twin.margin(t, com),
        "mos_xcom_m": twin.margin(t, twin.xcom(t)),
    }


@pytest.mark.parametrize("speed", (*SPEEDS, 0.2, 0.45, 1.9))
@pytest.mark.parametrize("angle", ANGLES_DEG)
def test_plan_equals_the_double_precision_twin(speed, angle, capsys):
    twin = Twin(speed, math.radians(angle))
    rows = plan(capsys, "--speed", str(speed), "--hs-angle", str(angle))
    assert len(rows) == math.floor(2 * twin.step_time / 0.08 + 1e-9) + 1
    for k, row in enumerate(rows):
        t = k * 0.08
        assert float(row["t_s"]) == pytest.approx(t, abs=1e-12)
        assert row["support"] == twin.support(t)
        for column, value in expected_row(twin, t).items():
            assert float(row[column]) == pytest.approx(value, abs=TOLERANCE), (column, t)
        force = twin.gravity(t)
        assert float(row["gravity_x_n"]) == pytest.approx(force[0], abs=FORCE_TOLERANCE_N)
        assert float(row["gravity_y_n"]) == pytest.approx(force[1], abs=FORCE_TOLERANCE_N)


@pytest.mark.parametrize(("speed", "planner_m", "rigid_m"), PEAK_TO_PEAK_M)
def test_vertical_excursion_is_the_papers(speed, planner_m, rigid_m, capsys):
    step_time = Twin(speed, 0).step_time
    for ankle, expected_m in (("erf", planner_m), ("rigid", rigid_m)):
        twin = Twin(speed, math.radians(10), ankle)
        z = [twin.com_z(step_time * k / 2000) for k in range(4001)]
        assert round(np.ptp(z), 4) == expected_m
        rows = plan(capsys, "--speed", str(speed), "--ankle", ankle, "--dt", repr(step_time / 2000))
        core_z = [float(row["com_z_m"]) for row in rows]
        # A sample may fall on either side of the jump at the saddle: vz / sampling rate = 0.2 mm.
        assert np.ptp(core_z) == pytest.approx(expected_m, abs=2e-4)


@pytest.mark.parametrize(
    ("speed", "minimum"), [(0.7, 0.545), (1.0, 0.682), (1.2, 0.735), (1.6, 0.801)]
)
def test_lateral_stability_minimum_is_the_papers(speed, minimum, capsys):
    rows = plan(capsys, "--speed", str(speed), "--dt", "0.002")
    assert min(float(row["s_sw"]) for row in rows) == pytest.approx(minimum, abs=5e-4)


@pytest.mark.parametrize(("speed", "share"), [(0.3, 0.76), (0.5, 0.55), (0.7, 0.41), (1.0, 0.0)])
def test_xcom_leaves_the_base_as_the_model_predicts(speed, share, capsys):
    rows = plan(capsys, "--speed", str(speed), "--dt", "0.002")
    inside = [float(row["mos_xcom_m"]) > 0 for row in rows]
    assert np.mean(inside) == pytest.approx(share, abs=0.01)


def test_rows_do_not_depend_on_the_ticks_in_between(capsys):
    coarse = plan(capsys, "--speed", "1.2", "--strides", "3", "--dt", "0.4")
    fine = plan(capsys, "--speed", "1.2", "--strides", "3", "--dt", "0.02")
    for k, row in enumerate(coarse):
        for column in ("com_x_m", "com_y_m", "com_z_m", "right_x_m", "theta_rad"):
            assert float(row[column]) == pytest.approx(float(fine[20 * k][column]), abs=TOLERANCE)


def test_columns_are_as_documented_and_numbers_are_lossless(capsys):
    rows = plan(capsys, "--speed", "1.2")
    assert ",".join(rows[0]) == (
        "t_s,phase,theta_rad,support,com_x_m,com_y_m,com_z_m,com_vx_m_s,com_vy_m_s,com_vz_m_s,"
        "left_x_m,left_y_m,left_z_m,right_x_m,right_y_m,right_z_m,leg_length_m,theta_to_rad,"
        "theta_hs_rad,s_pend,s_jump,s_sw,mos_com_m,mos_xcom_m,gravity_x_n,gravity_y_n"
    )
    assert all(float(np.float32(row["com_z_m"])) == float(row["com_z_m"]) for row in rows)


def test_speed_above_the_ceiling_is_limited_and_reported(capsys):
    assert main(["plan", "--speed", "2.5"]) == 0
    captured = capsys.readouterr()
    assert "--speed 2.5" in captured.err and "limited to 1.916 m/s" in captured.err
    row = next(csv.DictReader(io.StringIO(captured.out)))
    assert float(row["com_vx_m_s"]) == pytest.approx(1.9352 * 0.99, abs=1e-3)


def test_body_options_shape_the_plan(capsys, tmp_path):
    config = tmp_path / "person.toml"
    config.write_text("body_height_m = 1.6\nstep_width_fast_m = 0.15\nankle = 'rigid'\n")
    from_file = plan(capsys, "--speed", "1.2", "--config", str(config))
    assert float(from_file[0]["left_y_m"]) == pytest.approx(0.075)
    assert float(from_file[0]["leg_length_m"]) == pytest.approx(0.57 * 1.6)
    overridden = plan(capsys, "--speed", "1.2", "--config", str(config), "--height", "1.7")
    assert float(overridden[0]["leg_length_m"]) == pytest.approx(0.57 * 1.7)


def test_old_name_of_a_field_is_read_with_a_warning(tmp_path, capsys):
    old, new = tmp_path / "old.toml", tmp_path / "new.toml"
    old.write_text("foresight_s = 0.55\n")
    new.write_text("prediction_horizon_s = 0.55\n")
    configs = [
        load_config(argparse.Namespace(config=path, height=None, mass=None)) for path in (old, new)
    ]
    assert [config.prediction_horizon_s for config in configs] == [np.float32(0.55)] * 2
    warning = capsys.readouterr().err
    assert f"{old}: foresight_s is called prediction_horizon_s now" in warning
    assert str(new) not in warning


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--speed", "fast"], "--speed"),
        (["--speed", "nan"], "--speed"),
        (["--speed", "-1"], "--speed"),
        (["--speed", "0"], "--speed"),
        (["--speed", "1.2", "--dt", "0"], "--dt"),
        (["--speed", "1.2", "--strides", "1.5"], "--strides"),
        (["--speed", "1.2", "--hs-angle", "50"], "--hs-angle"),
        (["--speed", "1.2", "--height", "17.9"], "--height"),
        (["--speed", "1.2", "--mass", "nan"], "--mass"),
        (["--speed", "1.2", "--ankle", "wooden"], "--ankle"),
        (["--speed", "1.2", "--config", "no-such.toml"], "no-such.toml"),
        (["--speed", "1.2", "--out", "no/such/folder/plan.csv"], "no/such/folder/plan.csv"),
        ([], "--speed"),
    ],
)
def test_a_bad_option_is_a_one_line_error(options, named, capsys):
    try:
        status = main(["plan", *options])
    except SystemExit as exit_:
        status = exit_.code
    captured = capsys.readouterr()
    assert status == 2
    assert captured.out == ""
    assert captured.err.count("\n") == 1 and named in captured.err


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("step_widht_fast_m = 0.1", "step_width_fast_m"),
        ("body_height_m = 'tall'", "body_height_m"),
        ("body_height_m = 9.0", "body_height_m"),
        ("ankle = 'wooden'", "ankle"),
        ("ankle = ['erf']", "ankle"),
        (f"body_mass_kg = 1{400 * '0'}", "body_mass_kg = inf"),
        (f"body_mass_kg = -1{400 * '0'}", "body_mass_kg = -inf"),
        ("step_width_slow_speed_m_s = 2.0", "step_width_slow_speed_m_s"),
        ("body_height_m = ", "not TOML"),
    ],
)
def test_bad_config_file_is_one_line_that_names_the_field(text, named, capsys, tmp_path):
    config = tmp_path / "person.toml"
    config.write_text(text)
    out = tmp_path / "plan.csv"
    assert main(["plan", "--speed", "1", "--config", str(config), "--out", str(out)]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and named in message and str(config) in message
    assert sorted(tmp_path.iterdir()) == [config]
