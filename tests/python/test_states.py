"""supervise and replay read what calibrate reads, and supervise what the other commands write."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from laboratory import LABORATORIES, PERSON, RATE_HZ, c3d_file, laboratory, trc_file, walk_of
from saddlewalk.cli import main
from saddlewalk.gait.events import analyse
from saddlewalk.gait.motion_capture import load_walk
from saddlewalk.recorded_states import STATE_COLUMNS
from synthetic_walk import Walk, csv_text

pytestmark = pytest.mark.firmware

NUMBERS = "v_comp_m_s s_sw mos_com_m mos_xcom_m ebos_com_m ebos_xcom_m excess_stop_j".split()


@pytest.fixture
def recorded(tmp_path) -> dict[str, str]:
    """One walk in each format."""
    walk = walk_of(PERSON, 1.0, 5.0)
    markers = laboratory(walk, LABORATORIES["z up, walking along -y"])
    (tmp_path / "walk.csv").write_text(csv_text(walk))
    return {
        "c3d": c3d_file(tmp_path / "walk.c3d", markers),
        "trc": trc_file(tmp_path / "walk.trc", markers),
        "csv": str(tmp_path / "walk.csv"),
    }


def supervised(capsys, path: str, *options: str) -> list[dict[str, str]]:
    assert main(["supervise", "--in", path, *options]) == 0
    return list(csv.DictReader(io.StringIO(capsys.readouterr().out)))


def column(rows: list[dict[str, str]], name: str) -> np.ndarray:
    return np.array([float(row[name] or "nan") for row in rows])


def states_csv(path: Path, recording) -> str:
    """The states as a user would write them, from the recording's own quantities."""
    contact = analyse(recording).contact
    table = np.column_stack(
        [
            recording.time_s,
            recording.com_m,
            recording.com_velocity_m_s[:, :2],
            recording.cop_m[0],
            recording.cop_m[1],
            contact.T,
        ]
    )
    rows = [",".join(map(repr, map(float, row))) for row in table]
    path.write_text("\n".join([",".join(STATE_COLUMNS), *rows, ""]))
    return str(path)


@pytest.mark.parametrize("kind", ["c3d", "trc", "csv"])
def test_a_recording_is_scored_as_the_states_in_it(kind, recorded, tmp_path, capsys):
    recording = load_walk(recorded[kind])
    rows = supervised(capsys, recorded[kind])
    assert rows == supervised(capsys, states_csv(tmp_path / "states.csv", recording))
    assert column(rows, "t_s") == pytest.approx(np.arange(5 * RATE_HZ) / RATE_HZ, abs=1e-4)
    walking = column(rows, "v_comp_m_s")[3 * RATE_HZ :]
    assert walking == pytest.approx(1.0, abs=0.02)
    assert {row["level"] for row in rows[3 * RATE_HZ :]} == {"stable"}


def test_a_recording_may_come_from_standard_input(recorded, monkeypatch, capsys):
    from_file = supervised(capsys, recorded["csv"])
    with Path(recorded["csv"]).open() as file:
        monkeypatch.setattr("sys.stdin", file)
        assert supervised(capsys, "-") == from_file


def test_assumptions_and_implausible_values_are_reported(recorded, tmp_path, capsys):
    data = Path(recorded["c3d"]).read_bytes()
    Path(recorded["c3d"]).write_bytes(data.replace(b"UNITS", b"UNITX", 1))
    assert main(["supervise", "--in", recorded["c3d"]]) == 0
    assert "walk.c3d, no unit in the file, mm assumed" in capsys.readouterr().err
    (tmp_path / "millimetres.csv").write_text(csv_text(Walk(1200.0, 650.0).recording()))
    assert main(["supervise", "--in", str(tmp_path / "millimetres.csv")]) == 0
    assert "millimetres.csv: step length 650 m is not a person's" in capsys.readouterr().err


def test_a_walk_that_turns_is_scored_in_the_heading_of_its_pelvis(recorded, tmp_path, capsys):
    """Turned more and more, about the CoM: in the axes of its pelvis nothing has changed."""
    path = states_csv(tmp_path / "states.csv", load_walk(recorded["csv"]))
    straight = supervised(capsys, path)
    states = list(csv.DictReader(io.StringIO(Path(path).read_text())))
    names = [*STATE_COLUMNS, "pelvis_yaw_rad"]
    lines = [",".join(names)]
    for state in states:
        row = {name: float(text) for name, text in state.items()}
        yaw_rad = row["pelvis_yaw_rad"] = 0.6 * row["t_s"] - 1.0
        com_m = complex(row["com_x_m"], row["com_y_m"])
        turn = np.exp(1j * yaw_rad)
        for x, y, about_m in (
            ("com_vx_m_s", "com_vy_m_s", 0j),
            ("left_x_m", "left_y_m", com_m),
            ("right_x_m", "right_y_m", com_m),
        ):
            vector = about_m + (complex(row[x], row[y]) - about_m) * turn
            row[x], row[y] = float(vector.real), float(vector.imag)
        lines.append(",".join(repr(row[name]) for name in names))
    (tmp_path / "turned.csv").write_text("\n".join([*lines, ""]))
    turned = supervised(capsys, str(tmp_path / "turned.csv"))
    assert [row["level"] for row in turned] == [row["level"] for row in straight]
    for name in NUMBERS:
        assert np.allclose(column(turned, name), column(straight, name), atol=2e-4, equal_nan=True)


def test_what_plan_writes_of_a_turn_is_supervised_in_its_heading(tmp_path, capsys):
    schedule = tmp_path / "schedule.csv"
    schedule.write_text("t_s,speed_m_s,turn_rad_s\n0,0.8,0\n2,0.8,0.3\n8,0.8,0\n14,0,0\n")
    out = tmp_path / "plan.csv"
    assert main(["plan", "--schedule", str(schedule), "--out", str(out)]) == 0
    rows = supervised(capsys, str(out), "--speed", "0.8")
    time_s, s_sw = column(rows, "t_s"), column(rows, "s_sw")
    assert {row["level"] for row in rows} <= {"stable", "unknown"}
    after = (time_s > 11) & (time_s < 14)  # straight on, at an angle of 1.8 rad
    assert np.nanmin(column(rows, "mos_com_m")[after]) > -0.02
    assert np.isfinite(s_sw[after]).all()


def test_markers_are_named_for_every_command_that_reads_a_recording(recorded, tmp_path, capsys):
    Path(recorded["trc"]).write_text(Path(recorded["trc"]).read_text().replace("LHEE", "rear foot"))
    (tmp_path / "markers.toml").write_text('left_heel = ["rear foot"]\n')
    named = ["--markers", str(tmp_path / "markers.toml")]
    for command in (["supervise", "--in"], ["replay"]):
        assert main([*command, recorded["trc"]]) == 2
        assert "no markers for left_heel" in capsys.readouterr().err
        assert main([*command, recorded["trc"], *named]) == 0


def test_replay_reads_a_laboratory_s_files(recorded, tmp_path, capsys):
    shown = []
    for kind in ("c3d", "trc", "csv"):
        assert main(["replay", recorded[kind]]) == 0
        lines = dict(line.split()[:2] for line in capsys.readouterr().out.splitlines())
        names = ("speed", "step_length", "step_width", "ticks")
        shown.append([float(lines[name]) for name in names])
    assert shown[0] == pytest.approx(shown[2], rel=5e-3)
    assert shown[1] == pytest.approx(shown[2], rel=5e-3)


def test_a_plan_is_supervised_as_a_steady_walk(tmp_path, capsys):
    plan = tmp_path / "plan.csv"
    for dt in ("0.08", "0.02"):
        assert (
            main(["plan", "--speed", "1.2", "--strides", "4", "--dt", dt, "--out", str(plan)]) == 0
        )
        rows = supervised(capsys, str(plan))
        with plan.open() as file:
            planned = list(csv.DictReader(file))
        assert len(rows) == len(planned)
        late = slice(len(rows) // 2, None)
        assert column(rows, "v_comp_m_s")[late] == pytest.approx(1.2, abs=0.03)
        for name in ("mos_com_m", "mos_xcom_m"):
            assert column(rows, name)[late] == pytest.approx(column(planned, name)[late], abs=2e-5)
        assert {row["level"] for row in rows[late]} == {"stable"}


def test_a_scheduled_plan_stands_on_both_feet_until_it_walks(tmp_path, capsys):
    (tmp_path / "schedule.csv").write_text("t_s,speed_m_s\n0,0\n1,1.0\n")
    plan = ["plan", "--schedule", str(tmp_path / "schedule.csv"), "--out", str(tmp_path / "p.csv")]
    assert main(plan) == 0
    rows = supervised(capsys, str(tmp_path / "p.csv"))
    assert rows[-1]["level"] == "stable"
    assert all(row["mos_com_m"] for row in rows)


def test_what_replay_writes_is_scored_as_the_firmware_scored_it(tmp_path, capsys):
    recording = Walk(duration_s=6).recording(0.001)
    recording.toe_m[0, 96] = np.nan  # tick 12
    (tmp_path / "walk.csv").write_text(csv_text(recording))
    out = tmp_path / "scores.csv"
    assert main(["replay", str(tmp_path / "walk.csv"), "--out", str(out)]) == 0
    capsys.readouterr()
    with out.open() as file:
        replayed = list(csv.DictReader(file))
    rows = supervised(capsys, str(out))
    assert [row["t_s"] for row in rows] == [row["t_s"] for row in replayed]
    assert [row["level"] for row in rows] == [row["level"] for row in replayed]
    assert rows[12]["level"] == "unknown" and rows[12]["mos_com_m"] == ""
    for name in NUMBERS:  # as near as the frames on the bus are fine
        mine, firmware = column(rows, name), column(replayed, name)
        assert np.array_equal(np.isnan(mine), np.isnan(firmware)), name
        tolerance = 0.5 if name.endswith("_j") else 2e-3
        assert mine == pytest.approx(firmware, abs=tolerance, nan_ok=True), name


def test_what_a_demo_writes_is_scored(walk, capsys):
    rows = supervised(capsys, str(walk / "walk.csv"))
    with (walk / "walk.csv").open() as file:
        demo = list(csv.DictReader(file))
    assert [row["t_s"] for row in rows] == [row["t_s"] for row in demo]
    for name in ("mos_com_m", "mos_xcom_m"):
        assert column(rows, name) == pytest.approx(column(demo, name), abs=0.02, nan_ok=True), name


@pytest.mark.parametrize(
    ("header", "named"),
    [
        ("t_s,com_x_m,com_y_m", "no column com_z_m; needed: t_s, com_x_m"),
        ("t,com_x,com_y,com_z,lheel_x", "no column lheel_y; needed: t, com_x"),
        ("t_s,mode,true_com_x_m,true_com_y_m,true_com_z_m", "no column true_com_vx_m_s"),
    ],
)
def test_an_unknown_table_is_compared_with_the_closest_layout(header, named, tmp_path, capsys):
    path = tmp_path / "table.csv"
    path.write_text(header + "\n")
    assert main(["supervise", "--in", str(path)]) == 2
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1 and named in shown and str(path) in shown


@pytest.mark.parametrize("command", [["supervise", "--in"], ["replay"]])
def test_a_file_that_is_not_a_recording_is_a_one_line_error(command, tmp_path, capsys):
    path = tmp_path / "walk.c3d"
    path.write_bytes(b"t_s,com_x_m\n")
    assert main([*command, str(path)]) == 2
    shown = capsys.readouterr()
    assert (
        shown.out == "" and shown.err.count("\n") == 1 and "walk.c3d: not a C3D file" in shown.err
    )
