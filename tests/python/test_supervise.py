"""`saddlewalk supervise`: scores of recorded states against independent formulas, and bad input."""

import csv
import io
import itertools
import math
import re
from pathlib import Path

import numpy as np
import pytest

from saddlewalk.cli import main
from saddlewalk.recorded_states import SCORE_COLUMNS, STATE_COLUMNS
from twin import GRAVITY, Twin, bos_margin

pytestmark = pytest.mark.firmware

TOLERANCE = 2e-5
FAULTS_AND_LIMITS = 0xFFFFFF  # of the flags; above is the reason
INPUT, NO_STEP = 1, 3
DT_S = 0.08


def steady_walk(twin: Twin, steps: int) -> list[dict[str, float]]:
    """The planned walk as if measured; a foot is on the ground while it is the stance foot."""
    rows = []
    for k in range(int(steps * twin.step_time / DT_S)):
        t = k * DT_S
        com, velocity, feet = twin.com_xy(t), twin.com_xy_velocity(t), twin.feet(t)
        numbers = [t, *com, twin.com_z(t), *velocity, *feet["left"], *feet["right"]]
        contacts = [twin.support(t) == "left", twin.support(t) == "right"]
        rows.append(
            dict(zip(STATE_COLUMNS, [*map(float, numbers), *map(int, contacts)], strict=True))
        )
    return rows


def write(path, rows) -> str:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, STATE_COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    return str(path)


def supervise(capsys, *options: str) -> list[dict[str, str]]:
    assert main(["supervise", *options]) == 0
    return list(csv.DictReader(io.StringIO(capsys.readouterr().out)))


def prompt(tmp_path: Path) -> list[str]:
    """Options with which a level is announced in the tick in which it is seen."""
    (tmp_path / "prompt.toml").write_text("level_hold_ticks = 1\n")
    return ["--config", str(tmp_path / "prompt.toml")]


def heel_strikes(rows) -> list[int]:
    return [
        k
        for k in range(1, len(rows))
        for side in ("left_contact", "right_contact")
        if rows[k][side] > rows[k - 1][side]
    ]


@pytest.mark.parametrize("speed", [0.5, 0.9, 1.2, 1.6])
def test_scores_equal_their_formulas(speed, capsys, tmp_path):
    twin = Twin(speed, math.radians(10))
    states = steady_walk(twin, 6)
    path = write(tmp_path / "states.csv", states)
    scores = supervise(capsys, "--in", path, *prompt(tmp_path))
    strikes = heel_strikes(states)
    d_min, d = speed / (2 * twin.frequency), twin.step / 2
    d_max = 3.0 / (2 * twin.frequency)
    assert list(scores[0]) == SCORE_COLUMNS
    for k in range(strikes[1], len(states)):
        state, row = states[k], {name: value for name, value in scores[k].items()}
        last = max(strike for strike in strikes if strike <= k)
        half = abs(states[last]["left_x_m"] - states[last]["right_x_m"]) / 2
        com, xcom = twin.com_xy(state["t_s"]), twin.xcom(state["t_s"])
        feet = twin.feet(state["t_s"])
        expected = {
            "t_s": state["t_s"],
            "v_comp_m_s": speed,
            "s_pend": (half - d_min) / (d - d_min),
            "s_jump": (half - d_max) / (d - d_max),
            "s_sw": twin.s_sw(state["t_s"]),
            "mos_com_m": bos_margin(feet["left"], feet["right"], 0.1, com),
            "mos_xcom_m": bos_margin(feet["left"], feet["right"], 0.1, xcom),
        }
        for column, value in expected.items():
            # s_pend divides by a few centimetres: the same rounding weighs more.
            tolerance = 1e-4 if column.startswith("s_") else TOLERANCE
            assert float(row[column]) == pytest.approx(value, abs=tolerance), (column, k)
        assert int(row["flags"], 16) & FAULTS_AND_LIMITS == 0
        assert row["level"] != "unknown"


@pytest.mark.parametrize("speed", [0.9, 1.2, 1.6])
def test_a_planned_walk_is_stable_and_as_expected(speed, capsys, tmp_path):
    twin = Twin(speed, math.radians(10))
    path = write(tmp_path / "states.csv", steady_walk(twin, 6))
    for row in supervise(capsys, "--in", path, "--speed", str(speed), *prompt(tmp_path)):
        steps = twin.steps_taken(float(row["t_s"]))
        sides = (1, -1) if steps % 2 == 0 else (-1, 1)
        stance, landing = (
            np.array([(steps + k) * twin.step, 0.5 * side * twin.width])
            for k, side in enumerate(sides)
        )
        landing_s = (steps + 0.5) * twin.step_time
        left, right = (stance, landing) if steps % 2 == 0 else (landing, stance)
        for column, point in (
            ("ebos_com_m", twin.com_xy(landing_s)),
            ("ebos_xcom_m", twin.xcom(landing_s)),
        ):
            margin = bos_margin(left, right, twin.d_h, point)
            assert float(row[column]) == pytest.approx(margin, abs=TOLERANCE)
        assert row["can_stop"] == str(int(float(row["excess_stop_j"]) <= ankle_work_j(twin)))
        assert row["on_track"] == str(int(float(row["excess_track_j"]) <= ankle_work_j(twin)))
        assert (row["level"], row["flags"]) == ("stable", "0x00000000")


def ankle_work_j(twin: Twin) -> float:
    return twin.mass * GRAVITY * twin.d_h**2 / twin.pendulum


def test_a_state_beyond_any_recovery_step_is_unstable(capsys, tmp_path):
    states = steady_walk(Twin(1.2, 0.0), 5)
    for state in states[-4:]:
        state["com_vy_m_s"] += 2.0
    path = write(tmp_path / "states.csv", states)
    scores = supervise(capsys, "--in", path, "--speed", "1.2", *prompt(tmp_path))
    assert [row["level"] for row in scores[:-4]] == ["stable"] * (len(states) - 4)
    assert (scores[-1]["level"], scores[-1]["flags"]) == ("unstable", f"0x{NO_STEP:02x}000000")
    assert scores[-1]["can_stop"] == scores[-1]["on_track"] == "0"


def test_v_comp_is_the_mean_speed_of_the_last_step(capsys, tmp_path):
    states = steady_walk(Twin(1.0, 0.0), 6)
    for state in states:
        state["com_vx_m_s"] = 1.0 + 0.3 * math.sin(7.0 * state["t_s"])
    strikes = heel_strikes(states)
    scores = supervise(capsys, "--in", write(tmp_path / "states.csv", states))
    for first, last in itertools.pairwise(strikes):
        speeds = [state["com_vx_m_s"] for state in states[first : last + 1]]
        mean = np.trapezoid(speeds) / (last - first)
        assert float(scores[last]["v_comp_m_s"]) == pytest.approx(mean, abs=1e-6)
        before = scores[last - 1]["v_comp_m_s"]
        assert before == "" or float(before) != pytest.approx(mean, abs=1e-6)


def test_the_measured_speed_is_used_until_a_step_is_complete(capsys, tmp_path):
    path = write(tmp_path / "states.csv", steady_walk(Twin(1.2, 0.0), 4))
    without = supervise(capsys, "--in", path)
    assert without[0]["v_comp_m_s"] == "" and without[0]["s_sw"] == ""
    assert without[0]["ebos_com_m"] == without[0]["on_track"] == ""
    assert without[0]["recovery_margin_m"] == "" and without[0]["level"] == "stable"
    assert without[0]["excess_stop_j"] != "" and without[0]["can_stop"] == "0"
    assert float(supervise(capsys, "--in", path, "--speed", "1.1")[0]["v_comp_m_s"]) == (
        pytest.approx(1.1)
    )


def test_infeasible_speed_gives_zero_and_a_flag(capsys, tmp_path):
    states = steady_walk(Twin(1.2, 0.0), 4)
    for state in states:
        state["com_vx_m_s"] = 2.4
    last = supervise(capsys, "--in", write(tmp_path / "states.csv", states))[-1]
    assert float(last["v_comp_m_s"]) == pytest.approx(2.4)
    assert (last["s_pend"], last["s_jump"]) == ("0.0", "0.0")
    assert int(last["flags"], 16) & 0x100


# Fault bits of saddle_fault_t and the columns that must stay empty.
NEED_ALL = "ebos_com_m ebos_xcom_m excess_stop_j excess_track_j can_stop on_track".split()
MISSING = [
    ("com_vx_m_s", "", 0x02, ["mos_xcom_m"]),
    ("com_vy_m_s", "nan", 0x02, ["mos_xcom_m"]),
    ("com_z_m", "inf", 0x02, ["mos_xcom_m"]),
    ("left_x_m", "", 0x08, ["s_sw", "mos_com_m", "mos_xcom_m"]),
    ("left_contact", "", 0x08, ["s_sw", "mos_com_m", "mos_xcom_m"]),
    ("right_y_m", "-inf", 0x20, ["s_sw", "mos_com_m", "mos_xcom_m"]),
    ("com_x_m", "", 0x28, ["s_sw", "mos_com_m", "mos_xcom_m"]),
]
ABSURD = [
    ("com_z_m", 0.0, 0x04, ["mos_xcom_m"]),
    ("com_vx_m_s", 1e30, 0x04, ["mos_xcom_m"]),
    ("left_y_m", 4e3, 0x10, ["s_sw", "mos_com_m", "mos_xcom_m"]),
    ("right_x_m", -1e38, 0x40, ["s_sw", "mos_com_m", "mos_xcom_m"]),
    ("com_y_m", 1e308, 0x50, ["s_sw", "mos_com_m", "mos_xcom_m"]),
]


@pytest.mark.parametrize(("column", "value", "fault", "empty"), MISSING + ABSURD)
def test_missing_or_absurd_measurement_is_flagged_and_gives_no_number(
    column, value, fault, empty, capsys, tmp_path
):
    states = steady_walk(Twin(1.2, 0.0), 5)
    states[-2][column] = value
    path = write(tmp_path / "states.csv", states)
    scores = supervise(capsys, "--in", path, *prompt(tmp_path))
    assert len(scores) == len(states)
    assert int(scores[-2]["flags"], 16) & 0xFFFF == fault
    assert int(scores[-2]["flags"], 16) >> 24 == INPUT and scores[-2]["level"] == "unknown"
    assert all(scores[-2][name] == "" for name in [*empty, *NEED_ALL])
    after = dict(scores[-1])
    assert (after.pop("level"), after.pop("flags")) == ("stable", "0x00000000")
    assert all(math.isfinite(float(value)) for value in after.values())


def test_feet_at_the_same_place_are_flagged(capsys, tmp_path):
    states = steady_walk(Twin(1.2, 0.0), 5)
    states[-1]["right_x_m"], states[-1]["right_y_m"] = (
        states[-1]["left_x_m"] + 5e-4,
        states[-1]["left_y_m"],
    )
    last = supervise(capsys, "--in", write(tmp_path / "states.csv", states))[-1]
    assert int(last["flags"], 16) & 0xFFFF == 0x80
    assert last["mos_com_m"] == "" and last["s_sw"] != ""


def test_standard_input_and_output(capsys, monkeypatch, tmp_path):
    path = write(tmp_path / "states.csv", steady_walk(Twin(1.2, 0.0), 5))
    from_file = supervise(capsys, "--in", path)
    with Path(path).open() as file:
        monkeypatch.setattr("sys.stdin", file)
        assert supervise(capsys, "--in", "-", "--out", "-") == from_file


def bad_files():
    rows = [",".join(STATE_COLUMNS), "0,0,0,1,1,0,0,0.1,0,-0.1,1,0"]
    yield [rows[0].replace("com_vx_m_s", "speed"), rows[1]], "com_vx_m_s"
    yield [rows[0], rows[1].replace("0.1", "wide")], "line 2, left_y_m: 'wide'"
    yield [rows[0], rows[1][:-1] + "2"], "line 2, right_contact: 2"
    yield [*rows, rows[1]], "line 3, t_s"
    yield [*rows, "," + rows[1][2:]], "line 3, t_s"
    yield [rows[0], "inf" + rows[1][1:]], "line 2, t_s"
    yield [rows[0], rows[1] + ",0"], "line 2: not as many cells"
    yield [rows[0], rows[1][:-2]], "line 2: not as many cells"
    yield [*rows, "1e15" + rows[1][1:]], "line 3, t_s: 1e+15 must be within"
    yield [rows[0] + ",t_s", rows[1] + ",3"], "2 columns t_s"
    yield [""], "no column t_s"


@pytest.mark.parametrize(("lines", "named"), list(bad_files()))
def test_a_bad_file_is_a_one_line_error_without_output(lines, named, capsys, tmp_path):
    source, out = tmp_path / "states.csv", tmp_path / "scores.csv"
    source.write_text("\n".join(lines) + "\n")
    assert main(["supervise", "--in", str(source), "--out", str(out)]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and named in message and str(source) in message
    assert list(tmp_path.iterdir()) == [source]


def test_bad_input_from_the_start_writes_no_header(capsys, tmp_path):
    assert main(["supervise", "--in", str(tmp_path / "none.csv")]) == 2
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("content", [b"\xff\xfe\x00\x00", b"\x00" * 64])
def test_binary_file_is_rejected_in_one_line(content, capsys, tmp_path):
    source = tmp_path / "states.csv"
    source.write_bytes(content)
    assert main(["supervise", "--in", str(source)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_missing_file_is_named(capsys, tmp_path):
    assert main(["supervise", "--in", str(tmp_path / "none.csv")]) == 2
    assert "none.csv" in capsys.readouterr().err


def test_speed_beyond_the_ceiling_is_reported(capsys, tmp_path):
    source = tmp_path / "states.csv"
    source.write_text(",".join(STATE_COLUMNS) + "\n0" + "," * (len(STATE_COLUMNS) - 1) + "\n")
    assert main(["supervise", "--in", str(source), "--speed", "9"]) == 0
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and "--speed 9" in printed and "1.935 m/s" in printed
    assert main(["supervise", "--in", str(source), "--speed", "1.2"]) == 0
    assert capsys.readouterr().err == ""


def test_level_is_decided_by_the_margin(capsys, tmp_path):
    """A push of a walk of one's own that ends in a fall: each level is met on the way."""
    states = steady_walk(Twin(1.2, 0.0), 10)
    for k, state in enumerate(states[60:]):
        state["com_vx_m_s"] += 0.05 * k
        state["com_x_m"] += 0.002 * k * k
        state["com_z_m"] -= 0.0005 * k * k
    rows = supervise(capsys, "--in", write(tmp_path / "states.csv", states))
    levels = {row["level"] for row in rows}
    assert levels == {"stable", "caution", "unstable"}
    for row in rows:
        margin = float(row["margin"])
        assert (margin <= 0) == (row["level"] == "unstable")
        assert margin <= 0.25 or row["level"] == "stable"
        assert margin > 0.05 or row["level"] != "stable"
    assert float(rows[50]["margin"]) > 0.2 and rows[50]["recovery_margin_m"] != ""


def test_margin_of_a_missing_measurement_is_empty(capsys, tmp_path):
    states = steady_walk(Twin(1.2, 0.0), 4)
    states[10]["com_z_m"] = math.nan
    rows = supervise(capsys, "--in", write(tmp_path / "states.csv", states))
    assert rows[10]["margin"] == "" and rows[10]["level"] == "unknown"
    assert all(row["margin"] for k, row in enumerate(rows) if k != 10)


def test_the_help_explains_each_column(capsys):
    with pytest.raises(SystemExit):
        main(["supervise", "--help"])
    _, states, result = re.split(r"\ncolumns of .*\n", capsys.readouterr().out)
    assert {*STATE_COLUMNS} <= {*states.split()}
    assert {*SCORE_COLUMNS} <= {*result.split()}


def test_the_example_is_stable_then_a_caution_then_unstable(capsys):
    """A push to the left at 12 s, of which the emulated wearer falls."""
    example = Path(__file__).parents[2] / "examples/states.csv"
    assert main(["supervise", "--in", str(example)]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    levels = [(float(row["t_s"]), row["level"]) for row in rows]
    assert {level for t_s, level in levels if t_s < 12} <= {"unknown", "stable"}
    first = [next(t_s for t_s, each in levels if each == name) for name in ("caution", "unstable")]
    assert 12 < first[0] < first[1] < levels[-1][0]
