"""`saddlewalk export`: an LCM log as CSV, Parquet and MCAP, with nothing lost or invented."""

import csv
import json
import math
import sys
from pathlib import Path

import lcm
import pytest

from saddlewalk import __version__
from saddlewalk.cli import main
from saddlewalk.logs.messages import decode
from saddlewalk.logs.tables import columns_of, element_names
from saddlewalk.transport.lcm_log import LcmLog

CHANNELS = set("balance bos config health input plan scores status truth verdict".split())


def export(walk: Path, form: str, out: Path) -> int:
    return main(["export", str(walk / "walk.lcmlog"), "--format", form, "--out", str(out)])


def messages(walk: Path, name: str) -> list[tuple[int, object]]:
    """(when it was logged, message) of a channel."""
    events = LcmLog(walk / "walk.lcmlog")
    channel = f"SADDLEWALK_{name.upper()}"
    return [(event.logged_us, decode(event)) for event in events if event.channel == channel]


@pytest.mark.parametrize(
    ("name", "count", "elements"),
    [
        ("com_m", 3, ["com_x_m", "com_y_m", "com_z_m"]),
        ("com_velocity_m_s", 2, ["com_velocity_x_m_s", "com_velocity_y_m_s"]),
        ("push_n_s", 2, ["push_x_n_s", "push_y_n_s"]),
        ("foot_pitch_rad", 2, ["foot_pitch_left_rad", "foot_pitch_right_rad"]),
        ("x_m", 16, [f"x_{i}_m" for i in range(16)]),
        ("share", 4, ["share_0", "share_1", "share_2", "share_3"]),
    ],
)
def test_elements_are_named_before_the_unit(name, count, elements):
    assert element_names(name, count) == elements


def test_csv_has_each_number_of_each_message(walk, tmp_path):
    assert export(walk, "csv", tmp_path / "new" / "folder") == 0
    files = {path.stem: path for path in (tmp_path / "new" / "folder").iterdir()}
    assert files.keys() >= CHANNELS and {path.suffix for path in files.values()} == {".csv"}
    for name in ("plan", "scores"):
        rows = list(csv.DictReader(files[name].open(newline="")))
        logged = messages(walk, name)
        assert len(rows) == len(logged) > 100
        for row, (logged_us, message) in zip(rows, logged, strict=True):
            assert round(float(row.pop("logged_s")) * 1e6) == logged_us
            expected = {column: value for column, (_, value) in columns_of(message).items()}
            assert list(row) == list(expected)
            for column, value in expected.items():
                read = float(row[column]) if row[column] else math.nan
                assert read == value or (math.isnan(read) and math.isnan(value))
    assert "com_x_m" in next(csv.reader(files["plan"].open()))


def test_the_configuration_has_a_column_for_each_field(walk, tmp_path):
    assert export(walk, "csv", tmp_path) == 0
    row = next(csv.DictReader((tmp_path / "config.csv").open()))
    assert float(row["body_height_m"]) == pytest.approx(1.79)
    assert (row["library_version"], row["lockstep"]) == (__version__, "1")
    assert "name" not in row and "value" not in row and "name_x" not in row


def test_parquet_keeps_types_and_bits(walk, tmp_path):
    import pyarrow.parquet

    assert export(walk, "parquet", tmp_path) == 0
    table = pyarrow.parquet.read_table(tmp_path / "plan.parquet")
    kinds = {name: str(table.schema.field(name).type) for name in table.column_names}
    assert [kinds[name] for name in ("logged_s", "utime_us", "valid", "com_x_m", "origin_x_m")] == [
        "double",
        "int64",
        "int8",
        "float",
        "double",
    ]
    planned = [message.com_m[0] for _, message in messages(walk, "plan")]
    assert table["com_x_m"].to_pylist() == planned and len(set(planned)) > 50
    scores = pyarrow.parquet.read_table(tmp_path / "scores.parquet")["v_comp_m_s"].to_pylist()
    logged = [message.v_comp_m_s for _, message in messages(walk, "scores")]
    assert list(map(repr, scores)) == list(map(repr, logged)) and "nan" in map(repr, scores)


def test_mcap_is_what_foxglove_and_plotjuggler_read(walk, tmp_path):
    """JSON messages with JSON schemas, an index, no NaN."""
    from mcap.reader import make_reader

    out = tmp_path / "walk.mcap"
    assert export(walk, "mcap", out) == 0
    with out.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        read = list(reader.iter_messages(topics=["SADDLEWALK_SCORES"]))
    encodings = {
        (c.message_encoding, c.schema_id in summary.schemas) for c in summary.channels.values()
    }
    assert encodings == {("json", True)}
    assert {schema.encoding for schema in summary.schemas.values()} == {"jsonschema"}
    logged = messages(walk, "scores")
    assert len(read) == len(logged)
    for (schema, _, record), (logged_us, message) in zip(read, logged, strict=True):
        cells = json.loads(record.data, parse_constant=pytest.fail)
        assert record.log_time == record.publish_time == logged_us * 1000
        known = {
            column: value
            for column, (_, value) in columns_of(message).items()
            if math.isfinite(value)
        }
        assert {name: value for name, value in cells.items() if name != "logged_s"} == known
        described = json.loads(schema.data)["properties"]
        assert described["s_pend"] == {"type": "number"} and described.keys() >= cells.keys()
        assert described["valid"] == {"type": "integer"}


def test_the_default_output_is_in_the_logs_folder(walk, tmp_path, capsys):
    log = tmp_path / "a.lcmlog"
    log.write_bytes((walk / "walk.lcmlog").read_bytes())
    for form in ("csv", "parquet", "mcap"):
        assert main(["export", str(log), "--format", form]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {
        "a.lcmlog",
        "a-csv",
        "a-parquet",
        "a.mcap",
    }
    assert str(tmp_path / "a-csv" / "plan.csv") in capsys.readouterr().out


def refused(arguments: list[str], capsys) -> str:
    assert main(["export", *arguments]) == 2
    printed = capsys.readouterr()
    assert (printed.out, printed.err.count("\n")) == ("", 1)
    return printed.err


@pytest.mark.parametrize(
    ("content", "named"),
    [
        (b"", "is empty"),
        (b"t_s,x\n1,2\n", "is not an LCM log"),
        (b"\xed\xa1\xda\x01ab", "none of its events"),
    ],
)
@pytest.mark.parametrize("command", [["export", "--format", "mcap"], ["report"]])
def test_a_file_that_is_not_a_log_is_a_one_line_error_without_output(
    tmp_path, capsys, command, content, named
):
    (tmp_path / "log").write_bytes(content)
    assert main([*command, str(tmp_path / "log")]) == 2
    printed = capsys.readouterr()
    assert (printed.out, printed.err.count("\n")) == ("", 1) and named in printed.err
    assert [path.name for path in tmp_path.iterdir()] == ["log"]


def test_unknown_logs_are_rejected_and_unknown_messages_reported(walk, tmp_path, capsys):
    path = tmp_path / "others.lcmlog"
    log = lcm.EventLog(str(path), "w")
    log.write_event(1, "CAMERA", b"picture")
    log.close()
    assert "on CAMERA, is of a saddlewalk type" in refused([str(path), "--format", "csv"], capsys)
    with path.open("ab") as file:
        file.write((walk / "walk.lcmlog").read_bytes())
    assert main(["export", str(path), "--format", "csv"]) == 0
    printed = capsys.readouterr()
    assert "skipped: 1 messages on CAMERA" in printed.err and "camera" not in printed.out


def test_a_truncated_log_is_exported_as_far_as_possible(walk, tmp_path, capsys):
    cut = tmp_path / "cut.lcmlog"
    cut.write_bytes((walk / "walk.lcmlog").read_bytes()[:100000])
    assert main(["export", str(cut), "--format", "csv"]) == 1
    printed = capsys.readouterr()
    assert "incomplete: " in printed.err and "not an event" in printed.err
    assert (tmp_path / "cut-csv" / "plan.csv").stat().st_size > 1000


@pytest.mark.parametrize(("form", "package"), [("parquet", "pyarrow"), ("mcap", "mcap")])
def test_a_missing_package_is_named_with_what_installs_it(
    walk, tmp_path, capsys, monkeypatch, form, package
):
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    arguments = [str(walk / "walk.lcmlog"), "--format", form, "--out", str(tmp_path / "out")]
    printed = refused(arguments, capsys)
    assert f"--format {form} needs {package}: run `.venv/bin/pip install -e '.[export]'`" in printed
    assert not list(tmp_path.iterdir())


def test_an_unwritable_output_is_a_one_line_error(walk, tmp_path, capsys):
    log = str(walk / "walk.lcmlog")
    (tmp_path / "file").write_text("")
    file, deep = str(tmp_path / "file"), str(tmp_path / "no" / "where.mcap")
    assert f"--out {file}" in refused([log, "--format", "csv", "--out", file], capsys)
    assert f"--out {deep}" in refused([log, "--format", "mcap", "--out", deep], capsys)
    printed = refused([log, "--format", "mcap", "--out", log], capsys)
    assert f"is the same file as LOG {log}" in printed
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
