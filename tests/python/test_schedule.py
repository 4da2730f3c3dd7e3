"""`saddlewalk plan --schedule`: rejected files, and the walk of a valid one."""

import csv
import io
import math
import struct
from pathlib import Path

import numpy as np
import pytest

from saddlewalk.cli import main

pytestmark = pytest.mark.firmware

EXAMPLE = Path(__file__).parents[2] / "examples/schedule.csv"
START_CHANGE_STOP = "0,0\n0.5,0.6\n5,1.2\n9,0\n"
# 80 ms ticks are exact; what is off is float positions of some metres.
WAY_TOLERANCE_M = 1e-5
# Predicted times are floats that are off by some 1e-7 s, and the core counts microseconds.
EVENT_TOLERANCE_S = 5e-6


@pytest.fixture
def schedule(tmp_path):
    def write(rows: str, header: str = "t_s,speed_m_s") -> str:
        path = tmp_path / "schedule.csv"
        path.write_text(f"{header}\n{rows}")
        return str(path)

    return write


def run(*options: str) -> int:
    try:
        return main(["plan", *options])
    except SystemExit as exit_:
        return exit_.code


def plan(capsys, path: str, *options: str) -> list[dict[str, str]]:
    assert run("--schedule", path, *options) == 0
    return list(csv.DictReader(io.StringIO(capsys.readouterr().out)))


def column(rows: list[dict[str, str]], name: str) -> np.ndarray:
    return np.array([float(row[name]) for row in rows])


def events_of(rows: list[dict[str, str]]) -> list[tuple[str, float]]:
    return [
        (name, float(t_s))
        for row in rows
        for name, t_s in zip(row["event"].split(), row["event_t_s"].split(), strict=True)
    ]


def test_modes_come_in_order_and_the_walk_ends_standing(schedule, capsys):
    rows = plan(capsys, schedule(START_CHANGE_STOP))
    modes = [row["mode"] for row in rows]
    changes = [mode for mode, before in zip(modes, [None, *modes], strict=False) if mode != before]
    assert changes == ["standing", "starting", "walking", "stopping", "standing"]
    assert modes.index("starting") == 7  # the first tick from 0.5 s on
    first_stop = modes.index("stopping")
    assert float(rows[first_stop]["t_s"]) == pytest.approx(9.04)
    assert modes.count("standing") == 7 + 1  # it ends as soon as it stands
    last = rows[-1]
    assert [float(last[f"com_v{axis}_m_s"]) for axis in "xyz"] == [0, 0, 0]
    assert float(last["left_x_m"]) == pytest.approx(float(last["right_x_m"]), abs=1e-6)
    middle_m = (float(last["left_y_m"]) + float(last["right_y_m"])) / 2
    assert float(last["com_y_m"]) == pytest.approx(middle_m, abs=1e-6)


@pytest.mark.parametrize("ankle", ["erf", "rigid", "cycloid"])
def test_distance_is_the_integral_of_speed(schedule, ankle, capsys):
    path = schedule(START_CHANGE_STOP)
    rows = plan(capsys, path, "--ankle", ankle, "--dt", "0.001")
    speed, x = column(rows, "com_vx_m_s"), column(rows, "com_x_m")
    # Between two rows the speed is a straight line, but for three rows a step at most.
    way_m = np.concatenate([[0], np.cumsum((speed[1:] + speed[:-1]) / 2)]) * 1e-3
    assert np.abs(x - x[0] - way_m).max() < WAY_TOLERANCE_M
    assert x[-1] > 7


def test_commanded_speeds_are_reached_at_the_configured_rate(schedule, capsys, tmp_path):
    config = tmp_path / "person.toml"
    config.write_text("acceleration_m_s2 = 0.25\n")
    rows = plan(capsys, schedule("0,1.2\n8,0.6\n"), "--config", str(config), "--duration", "12")
    speed = column(rows, "com_vx_m_s")
    assert np.abs(np.diff(speed)).max() == pytest.approx(0.25 * 0.08, rel=1e-4)
    assert speed.max() == pytest.approx(1.2, abs=1e-6) and speed[-1] == pytest.approx(0.6, abs=1e-6)


def test_a_row_holds_from_its_time_on(schedule, capsys):
    rows = plan(capsys, schedule("0,0.5\n8,1.0\n"))
    speed, t = column(rows, "com_vx_m_s"), column(rows, "t_s")
    assert t[-1] == pytest.approx(12.96)  # the last multiple of 80 ms up to 8 s + 5 s
    assert speed[t <= 8.001].max() == pytest.approx(0.5, abs=1e-6)
    assert speed[np.searchsorted(t, 8.08 - 1e-6)] == pytest.approx(0.54, abs=1e-6)


def test_a_schedule_that_only_stands_is_one_row(schedule, capsys):
    (row,) = plan(capsys, schedule("0,0\n"))
    assert row["mode"] == "standing" and row["event"] == row["time_to_toe_off_s"] == ""
    assert row["s_pend"] == row["s_jump"] == ""


def test_events_alternate_and_each_foot_lands_once_a_swing(schedule, capsys):
    events = events_of(plan(capsys, schedule(START_CHANGE_STOP)))
    times_s = [t_s for _, t_s in events]
    assert times_s == sorted(times_s)
    names = [name for name, _ in events]
    assert names[0] == "toe_off_right"
    swings = list(zip(names[::2], names[1::2], strict=True))
    sides = [("right", "left")[index % 2] for index in range(len(swings))]
    expected = [(f"toe_off_{side}", f"heel_strike_{side}") for side in sides]
    assert swings == expected and len(swings) >= 12


@pytest.mark.parametrize("hs_angle", ["0", "10", "25"])
def test_event_times_do_not_depend_on_the_rows(schedule, hs_angle, capsys):
    """One speed from the start, walked with ticks of 80 ms and of 10 ms."""
    path = schedule("0,0.8\n")
    walks = [
        events_of(plan(capsys, path, "--hs-angle", hs_angle, "--duration", "8", "--dt", dt))
        for dt in ("0.08", "0.01")
    ]
    assert [name for name, _ in walks[0]] == [name for name, _ in walks[1]]
    coarse_s, fine_s = ([t_s for _, t_s in events] for events in walks)
    assert len(coarse_s) > 15
    assert np.abs(np.subtract(coarse_s, fine_s)).max() < EVENT_TOLERANCE_S


def test_the_last_foot_lands_when_the_body_comes_to_rest(schedule, capsys):
    rows = plan(capsys, schedule("0,0.6\n4,0\n"))
    ((name, landed_s),) = events_of(rows)[-1:]
    moving = [row for row in rows if float(row["com_vx_m_s"]) > 0][-1]
    way_m = float(rows[-1]["com_x_m"]) - float(moving["com_x_m"])
    rest_s = float(moving["t_s"]) + 2 * way_m / float(moving["com_vx_m_s"])
    assert name.startswith("heel_strike")
    # A way of some 0.1 mm at the end of 2 m: floats hold it to a thousandth.
    assert landed_s == pytest.approx(rest_s, abs=1e-3)


def test_a_walk_commanded_during_the_last_swing_goes_on(schedule, capsys):
    rows = plan(capsys, schedule("0,0.6\n4,0\n5.6,0.6\n"))
    modes = [row["mode"] for row in rows]
    restart = modes.index("starting", modes.index("stopping"))
    assert rows[restart]["event"] == "heel_strike_left toe_off_left"
    landed_s, lifted_s = rows[restart]["event_t_s"].split()
    assert landed_s == lifted_s
    assert "standing" not in modes[restart:]


def test_long_rows_keep_every_event(schedule, capsys):
    path = schedule(START_CHANGE_STOP)
    fine = events_of(plan(capsys, path, "--duration", "15", "--dt", "0.08"))
    coarse = events_of(plan(capsys, path, "--duration", "15.2", "--dt", "0.8"))
    assert [name for name, _ in coarse] == [name for name, _ in fine]


def test_the_foot_does_not_move_from_heel_strike_to_toe_off(schedule, capsys):
    rows = plan(capsys, schedule(START_CHANGE_STOP), "--dt", "0.01")
    t = column(rows, "t_s")
    events = events_of(rows)
    for side in ("left", "right"):
        x = column(rows, f"{side}_x_m")
        lands = [t_s for name, t_s in events if name == f"heel_strike_{side}"]
        lifts = [t_s for name, t_s in events if name == f"toe_off_{side}"]
        lifts = [t_s for t_s in lifts if t_s > lands[0]] + [math.inf]
        for land_s, lift_s in zip(lands, lifts, strict=True):
            # The heel strikes some ms before the CoP arrives.
            stance = x[(t > land_s + 0.02) & (t < lift_s)]
            assert np.ptp(stance) < 1e-5


def test_a_speed_that_is_not_feasible_is_limited_and_reported(schedule, capsys):
    path = schedule("0,0\n1,2.5\n6,1\n")
    assert run("--schedule", path, "--duration", "9") == 0
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and f"{path}: line 3, speed_m_s: 2.5 is not feasible" in printed


def size_of(picture) -> tuple[int, int]:
    header = picture.read_bytes()[:24]
    assert header[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", header[16:])


def test_picture_is_drawn(capsys, tmp_path):
    picture = tmp_path / "walk.png"
    assert plan(capsys, str(EXAMPLE), "--ankle", "cycloid", "--picture", str(picture))
    assert size_of(picture) == (1200, 800)


def test_picture_of_a_turn_is_to_scale(capsys, tmp_path):
    picture = tmp_path / "walk.png"
    eight = EXAMPLE.with_name("figure-of-eight.csv")
    assert plan(capsys, str(eight), "--picture", str(picture))
    width, height = size_of(picture)
    assert width == 1200 and height > 1500  # the eight is taller than wide


@pytest.mark.parametrize(
    ("rows", "named"),
    [
        ("", "no rows"),
        ("1,0\n", "line 2, t_s: 1 must be 0"),
        ("0,0\n0,1\n", "line 3, t_s: 0 must be later than 0 s"),
        ("0,0\n2,1\n1,1\n", "line 4, t_s: 1 must be later than 2 s"),
        ("0,0\n,1\n", "line 3, t_s: nan must be a finite time"),
        ("0,0\ninf,1\n", "line 3, t_s: inf must be a finite time"),
        ("0,0\nsoon,1\n", "line 3, t_s: 'soon' is not a number"),
        ("0,-0.1\n", "line 2, speed_m_s: -0.1 must be 0 or more"),
        ("0,\n", "line 2, speed_m_s: nan must be 0 or more"),
        ("0,inf\n", "line 2, speed_m_s: inf must be 0 or more"),
        ("0,fast\n", "line 2, speed_m_s: 'fast' is not a number"),
        ("0\n", "line 2: not as many cells"),
    ],
)
def test_a_bad_file_is_a_one_line_error_with_its_place(rows, named, schedule, capsys, tmp_path):
    path, out = schedule(rows), tmp_path / "plan.csv"
    assert run("--schedule", path, "--out", str(out)) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and not out.exists()
    assert captured.err.count("\n") == 1 and f"{path}: {named}" in captured.err


def test_a_missing_column_is_named(schedule, capsys):
    assert run("--schedule", schedule("0,0\n", header="t_s,speed")) == 2
    assert "no column speed_m_s" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--speed", "1", "--schedule", str(EXAMPLE)], "--schedule"),
        (["--schedule", str(EXAMPLE), "--strides", "2"], "--strides"),
        (["--speed", "1", "--duration", "2"], "--duration"),
        (["--speed", "1", "--picture", "walk.png"], "--picture"),
        (["--schedule", str(EXAMPLE), "--duration", "-1"], "--duration"),
        (["--schedule", "no/such.csv"], "no/such.csv"),
        (["--schedule", str(EXAMPLE), "--picture", "no/such/walk.png"], "--picture no/such"),
        (["--schedule", str(EXAMPLE), "--picture", "walk.wood"], "--picture walk.wood"),
    ],
)
def test_a_bad_option_is_a_one_line_error(options, named, capsys, tmp_path):
    assert run(*options, "--out", str(tmp_path / "plan.csv")) == 2
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1 and named in captured.err


def test_a_turn_ends_in_the_heading_that_its_rate_makes(schedule, capsys):
    """0.4 rad/s at 0.6 m/s is a circle of 1.5 m, and feet stay where they landed."""
    path = schedule("0,0.6,0\n4,0.6,0.4\n14,0.6,0\n20,0,0\n", "t_s,speed_m_s,turn_rad_s")
    rows = plan(capsys, path, "--dt", "0.02")
    t, heading = column(rows, "t_s"), column(rows, "heading_rad")
    steady = (t > 8) & (t < 14)
    turned = np.unwrap(heading)
    rate = (turned[steady][-1] - turned[steady][0]) / 6
    assert rate == pytest.approx(0.4, abs=0.2 / 6)  # the heading is that of the feet, step by step
    # Commanded for 10 s, and followed from landing to landing, each 0.81 s.
    assert turned[-1] == pytest.approx(4.0, abs=0.4 * 0.81)
    x, y = column(rows, "com_x_m")[steady], column(rows, "com_y_m")[steady]
    design = np.column_stack([2 * x, 2 * y, np.ones_like(x)])
    centre_x, centre_y, _ = np.linalg.lstsq(design, x**2 + y**2, rcond=None)[0]
    radius = np.hypot(x - centre_x, y - centre_y)
    lean = 0.6 * 0.4 / (9.80665 / 1.0203)
    assert radius.mean() == pytest.approx(1.5 - lean, abs=5e-3)
    for side in ("left", "right"):
        stands = column(rows, f"{side}_z_m") == 0
        held = stands[1:] & stands[:-1]
        for name in (f"{side}_x_m", f"{side}_y_m", f"{side}_yaw_rad"):
            assert np.abs(np.diff(np.unwrap(column(rows, name)))[held]).max() < 1e-6


def test_a_turn_that_the_speed_does_not_bear_is_limited_and_named(schedule, capsys):
    path = schedule("0,1.2,0.9\n3,1.2,0.2\n", "t_s,speed_m_s,turn_rad_s")
    assert run("--schedule", path) == 0
    notes = capsys.readouterr().err
    assert "line 2, turn_rad_s: 0.9 is not feasible at this speed: limited" in notes
    assert notes.count("turn_rad_s") == 1


def test_a_schedule_without_turns_says_so_in_every_row(schedule, capsys):
    rows = plan(capsys, schedule("0,0.6\n4,0\n"))
    assert {row["heading_rad"] for row in rows} == {"0.0"}


@pytest.mark.parametrize("cell", ["nan", "11", "left"])
def test_a_turning_rate_that_is_none_is_rejected(schedule, cell, capsys):
    path = schedule(f"0,0.6,{cell}\n", "t_s,speed_m_s,turn_rad_s")
    assert run("--schedule", path) == 2
    assert "line 2, turn_rad_s" in capsys.readouterr().err
