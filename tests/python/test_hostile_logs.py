"""Logs that are damaged, forged or long: no crash, no escape to the terminal, bounded memory."""

import itertools
import os
import random
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import can
import numpy as np
import pytest

from long_log import HEADER, encoded, write_log, write_long_log
from saddlewalk.cli import main
from saddlewalk.logs.can_log import LINE_MAX
from saddlewalk.logs.messages import NAMES_MAX, decode
from saddlewalk.printable import printable
from saddlewalk.session import page as session_page
from saddlewalk.session import pictures
from saddlewalk.session.runs import load_session
from saddlewalk.transport import lcm_log
from saddlewalk.transport.lcm_log import SYNC, Event, LcmLog
from sanitizer import SANITIZED

SOME = [Event(1000 * n, f"CHANNEL_{n}", bytes([n]) * n) for n in range(1, 8)]
pytestmark = pytest.mark.filterwarnings("error")

EVIL = "\x1b[31mred\x1b]0;title\x07\x9b2J\x85a\nb\u202ec\u2028d\x00"
SHOWN = r"\x1b[31mred\x1b]0;title\x07\x9b2J\x85a\nb\u202ec\u2028d\x00"
EXPORTS = [["export", "--format", form] for form in ("csv", "parquet", "mcap")]
COMMANDS = [["report"], ["rerun"], *EXPORTS]
SHORT_TICKS = 40
BLF_OBJECT = struct.Struct("<4sHHLL")


@pytest.fixture(scope="module")
def short(walk, tmp_path_factory) -> Path:
    """The log of the first ticks of a walk."""
    path = tmp_path_factory.mktemp("short") / "short.lcmlog"
    inputs = 0
    with path.open("wb") as file:
        for event in LcmLog(walk / "walk.lcmlog"):
            inputs += event.channel == "SADDLEWALK_INPUT"
            if inputs > SHORT_TICKS:
                break
            file.write(encoded(event))
    return path


@pytest.fixture
def unseen(monkeypatch) -> None:
    """Pages without the pictures, which take a second to draw."""
    blank = dict.fromkeys(("level", "scores"), pictures.Picture("", b""))
    monkeypatch.setattr(session_page, "draw", lambda *_: blank)


def run(command: list[str], log: Path, capsys) -> tuple[int, str, str]:
    """Written next to the log; each printed line is safe to show on a terminal."""
    capsys.readouterr()
    status = main([command[0], str(log), *command[1:]])
    printed = capsys.readouterr()
    for line in (printed.out + printed.err).split("\n"):
        assert line.isprintable(), line
    assert status in (0, 1, 2)
    if status == 2:
        assert (printed.out, printed.err.count("\n")) == ("", 1)
    return status, printed.out, printed.err


# The reader


@pytest.mark.parametrize("length_at", [20, 24], ids=["channel", "data"])
@pytest.mark.parametrize("length", [0x7FFFFFFF, 0xFFFFFFFF, 0x80000000, 100_000])
@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_a_length_beyond_the_file_costs_one_event(
    short, tmp_path, capsys, unseen, command, length, length_at
):
    log, events = tmp_path / "log", list(LcmLog(short))
    data = bytearray(short.read_bytes())
    place = sum(len(encoded(event)) for event in events[:100])
    struct.pack_into(">I", data, place + length_at, length)
    log.write_bytes(data)
    broken = LcmLog(log)
    assert list(broken) == events[:99] + events[101:] or list(broken) == events[:100] + events[101:]
    status, out, err = run(command, log, capsys)
    assert status == 1 and "bytes of the log are not an event" in out + err


def test_a_log_is_what_was_written(walk, short):
    import lcm

    log = lcm.EventLog(str(walk / "walk.lcmlog"))
    theirs = [(event.timestamp, event.channel, event.data) for event in log]
    ours = LcmLog(walk / "walk.lcmlog")
    assert list(map(tuple, ours)) == theirs
    assert (ours.events, ours.broken) == (len(theirs), "")
    assert len(list(ours)) == len(theirs), "a second time"


def test_a_log_cut_anywhere_keeps_its_whole_events(tmp_path):
    data, log = b"".join(map(encoded, SOME)), tmp_path / "log"
    ends = list(itertools.accumulate(len(encoded(event)) for event in SOME))
    for size in range(ends[0], len(data)):
        log.write_bytes(data[:size])
        cut = LcmLog(log)
        whole = sum(end <= size for end in ends)
        assert list(cut) == SOME[:whole]
        assert cut.lost == size - ends[whole - 1]
        assert bool(cut.broken) == (cut.lost > 0)


@pytest.mark.parametrize("block", [lcm_log.BLOCK, 128])
def test_reading_goes_on_after_damage(tmp_path, monkeypatch, block):
    """Any bytes between events, at any position relative to the reader's blocks."""
    monkeypatch.setattr(lcm_log, "BLOCK", block)
    log, rng = tmp_path / "log", random.Random(1)
    for size in range(1, 300, 7):
        junk = rng.randbytes(size).replace(SYNC[:1], b"x")
        log.write_bytes(encoded(SOME[1]) + encoded(SOME[2]) + junk + encoded(SOME[3]))
        damaged = LcmLog(log)
        assert list(damaged) == [SOME[1], SOME[3]], "the length of the second may be wrong"
        assert damaged.lost == len(encoded(SOME[2])) + size
        assert f"the first is byte {len(encoded(SOME[1]))}" in damaged.broken


def test_damage_at_the_start_costs_the_first_event(tmp_path):
    log = tmp_path / "log"
    log.write_bytes(b"x" + b"".join(map(encoded, SOME))[1:])
    assert list(LcmLog(log)) == SOME[1:]


def test_a_sync_word_within_data_is_data(tmp_path):
    events = [Event(1, "A", SYNC * 9), Event(2, "B", encoded(SOME[0])), Event(3, "C", b"")]
    log = LcmLog(write_log(tmp_path / "log", events))
    assert (list(log), log.broken) == (events, "")


def test_only_the_start_of_a_huge_event_is_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(lcm_log, "DATA_MAX", 1000)
    events = [SOME[0], Event(1, "CAMERA", bytes(5000)), SOME[1]]
    log = LcmLog(write_log(tmp_path / "log", events))
    read = list(log)
    assert [read[0], read[2], log.broken] == [SOME[0], SOME[1], ""]
    assert read[1].data == bytes(1000)


def test_a_channel_name_that_is_not_text_is_escaped(tmp_path):
    data = HEADER.pack(SYNC, 0, 0, 2, 0) + b"\xff\x80"
    (tmp_path / "log").write_bytes(data)
    assert [event.channel for event in LcmLog(tmp_path / "log")] == [r"\xff\x80"]


def test_a_log_must_be_an_ordinary_file(tmp_path, capsys):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", Path(os.devnull)):
        assert "not an ordinary file" in run(["rerun"], path, capsys)[2]


def test_monitor_rejects_a_damaged_log(short, tmp_path, capsys):
    """lcm's own player reads it, and crashes."""
    data = bytearray(short.read_bytes())
    struct.pack_into(">I", data, 24, 0x7FFFFFFF)
    (tmp_path / "log").write_bytes(data)
    assert main(["monitor", "--once", "--lcm", f"file://{tmp_path / 'log'}"]) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and "bytes of the log are not an event" in printed


# Text from outside


def test_terminal_control_sequences_are_escaped():
    assert printable(EVIL) == SHOWN
    assert printable("m/s µ ü 步 ok") == "m/s µ ü 步 ok"
    assert printable(os.fsdecode(b"\xff.log")) == r"\udcff.log"
    for number in (*range(0x20), *range(0x7F, 0xA1)):
        assert printable(chr(number)) == ascii(chr(number))[1:-1] != chr(number)


def with_version(events: list[Event], version: str) -> list[Event]:
    changed = []
    for event in events:
        if event.channel in ("SADDLEWALK_CONFIG", "SADDLEWALK_STATUS"):
            message = decode(event)
            message.library_version = version
            event = Event(event.logged_us, event.channel, message.encode())
        changed.append(event)
    return changed


def test_text_of_a_log_is_escaped_on_the_terminal(short, tmp_path, capsys, unseen):
    events = with_version(list(LcmLog(short)), EVIL)
    name = EVIL.replace("\x00", "")
    log = write_log(tmp_path / "log", [*events, Event(1, name, b"data")])
    assert SHOWN in run(["rerun"], log, capsys)[1]
    for command in EXPORTS:
        assert f"1 messages on {printable(name)}" in run(command, log, capsys)[2]
    run(["report"], log, capsys)
    page = (tmp_path / "log.html").read_text()
    assert not any(control in page for control in "\x1b\x07\x9b\x85\u202e\u2028\x00")
    for data in (b"data", b""):
        others = write_log(tmp_path / "others", [Event(1, name, data)])
        for command in (["report"], EXPORTS[0]):
            assert run(command, others, capsys)[0] == 2


def test_file_names_are_escaped_on_the_terminal(short, tmp_path, capsys, unseen):
    log = tmp_path / EVIL.replace("\x00", "").replace("/", "")
    for command in COMMANDS:
        assert "No such file" in run(command, log, capsys)[2]
    log.write_bytes(short.read_bytes())
    for command in COMMANDS:
        run(command, log, capsys)
    page = next(path for path in tmp_path.iterdir() if path.suffix == ".html").read_text()
    assert "\x1b" not in page and "<title>Session report: \\x1b[31mred" in page


def test_wrong_options_are_escaped_on_the_terminal(capsys):
    with pytest.raises(SystemExit):
        main(["report", "log", f"--{EVIL}"])
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1 and printed[:-1].isprintable()


# Invalid messages


def test_fields_of_a_forged_configuration(short, tmp_path, capsys, unseen):
    """Names of other columns, of none, twice, and each time others."""

    def forged(number: int) -> Event:
        config = decode(next(e for e in LcmLog(short) if e.channel == "SADDLEWALK_CONFIG"))
        config.name = ["logged_s", "utime_us", "", "", *(f"{number} {n}" for n in range(40))]
        config.value = [float("nan"), float("inf"), *map(float, range(42))]
        config.fields = len(config.name)
        return Event(1, "SADDLEWALK_CONFIG", config.encode())

    events = list(LcmLog(short))
    log = write_log(tmp_path / "log", [*map(forged, range(100)), *events])
    for command in COMMANDS:
        status, _, printed = run(command, log, capsys)
        assert (status, "messages on SADDLEWALK_CONFIG" in printed) == (0, command in EXPORTS)
    header = (tmp_path / "log-csv" / "config.csv").read_text().splitlines()[0]
    assert 40 < header.count(",") < 1001 and header.startswith("logged_s,utime_us,")


def test_of_many_channels_a_few_are_named(short, tmp_path, capsys, unseen):
    events = [Event(1, f"C{n}", b"") for n in range(5000)]
    log = write_log(tmp_path / "log", [*LcmLog(short), *events])
    printed = run(EXPORTS[0], log, capsys)[2]
    assert printed.count("\n") == NAMES_MAX + 1
    assert f"{5000 - NAMES_MAX} messages on further channels" in printed


def test_a_channel_by_another_name_is_another(short, tmp_path, capsys):
    """Else two would be one file."""
    events = list(LcmLog(short))
    other = [Event(e.logged_us, "SADDLEWALK_plan", e.data) for e in events if "PLAN" in e.channel]
    log = write_log(tmp_path / "log", [*other, *events])
    assert f"{SHORT_TICKS} messages on SADDLEWALK_plan" in run(EXPORTS[0], log, capsys)[2]
    assert len((tmp_path / "log-csv" / "plan.csv").read_text().splitlines()) == SHORT_TICKS + 1


def test_gaps_of_a_rerun_are_counted_and_the_first_reported(short, tmp_path, capsys):
    inputs = [e for e in LcmLog(short) if e.channel in ("SADDLEWALK_INPUT", "SADDLEWALK_CONFIG")]
    log = write_log(tmp_path / "log", [*inputs, *inputs[3:], *inputs[3:]] * 30)
    printed = run(["rerun"], log, capsys)[1]
    assert printed.count("not compared: tick") <= 20 and " further gaps" in printed


def test_ticks_without_some_channels_stay_in_order(short):
    """In each column, against the messages themselves."""
    events = [e for n, e in enumerate(LcmLog(short)) if n % 7 and n % 11]
    (run,) = load_session(write_log(short.with_name("lacking"), events)).runs
    for name, member in (("plan", "speed_m_s"), ("verdict", "level"), ("input", "left_age_us")):
        logged = [decode(e) for e in events if e.channel == f"SADDLEWALK_{name.upper()}"]
        values = {message.utime_us: getattr(message, member) for message in logged}
        first_us = run.utime_us[0]
        expected = [values.get(first_us + round(1e6 * at_s), np.nan) for at_s in run.time_s]
        assert len(values) < run.ticks
        np.testing.assert_allclose(run.column(name, member), expected, rtol=1e-6)


# Many mutations


def mutated(data: bytes, rng: random.Random) -> bytes:
    """A few bytes flipped, cut, doubled or grown."""
    changed = bytearray(data)
    for _ in range(rng.choice((1, 3, 30))):
        at = rng.randrange(len(changed))
        kind = rng.randrange(6)
        if kind < 2:
            changed[at] ^= 1 << rng.randrange(8)
        elif kind == 2:
            changed[at : at + 4] = rng.choice((b"\x7f\xff\xff\xff", b"\xff" * 4, bytes(4), SYNC))
        elif kind == 3:
            del changed[at : at + rng.randrange(1, 200)]
        elif kind == 4:
            changed[at:at] = changed[at : at + rng.randrange(1, 200)]
        elif len(changed) > 2000:
            del changed[rng.randrange(len(changed) // 2, len(changed)) :]
    return bytes(changed)


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_a_mutated_log_is_reported_or_rejected(short, tmp_path, capsys, unseen, command):
    rng, data, log = random.Random(7), short.read_bytes(), tmp_path / "log"
    statuses = set()
    for _ in range(60):
        log.write_bytes(mutated(data, rng))
        statuses.add(run(command, log, capsys)[0])
    assert 1 in statuses


def test_messages_of_random_bits_are_drawn(short, tmp_path, capsys):
    """Whole events, so that each number counts: infinities, times of centuries, levels of 99."""
    rng, log = random.Random(8), tmp_path / "log"
    events = list(LcmLog(short))
    for index in rng.sample(range(len(events)), 90):
        event = events[index]
        data = bytearray(event.data)
        for at in rng.sample(range(8, len(data)), 6):
            data[at] = rng.choice((0, 0x7F, 0x80, 0xFF))
        events[index] = Event(event.logged_us, event.channel, bytes(data))
    write_log(log, events)
    for command in COMMANDS:
        run(command, log, capsys)


@pytest.mark.parametrize("suffix", [".log", ".blf", ".asc", ".trc", ".csv"])
def test_a_mutated_can_log_is_rerun_or_rejected(walk, tmp_path, capsys, suffix):
    log, rng = tmp_path / f"walk{suffix}", random.Random(9)
    with can.LogReader(walk / "walk.candump.log") as frames, can.Logger(log) as writer:
        for frame in itertools.islice(frames, 1000):
            writer.on_message_received(frame)
    data = log.read_bytes()
    statuses = set()
    for _ in range(60):
        log.write_bytes(mutated(data, rng))
        statuses.add(run(["rerun"], log, capsys)[0])
    assert statuses & {1, 2}


# CAN logs that no program writes


def blf(*containers: bytes, method: int = 2) -> bytes:
    header = b"LOGG" + struct.pack("<L", 144) + bytes(136)
    parts = []
    for data in containers:
        body = struct.pack("<H14x", method) + (zlib.compress(data) if method == 2 else data)
        size = BLF_OBJECT.size + len(body)
        parts.append(BLF_OBJECT.pack(b"LOBJ", 16, 1, size, 10) + body + bytes(size % 4))
    return header + b"".join(parts)


def blf_object(size: int, kind: int = 1) -> bytes:
    frame = struct.pack("<LHHQ", 1, 0, 0, 0) + struct.pack("<HBBL8s", 1, 0, 8, 0x7FF, bytes(8))
    return BLF_OBJECT.pack(b"LOBJ", 32, 1, size, kind) + frame


@pytest.mark.timeout(20)
@pytest.mark.parametrize("kind", [1, 99], ids=["frames", "others"])
def test_a_blf_log_without_end_ends(tmp_path, capsys, kind):
    """An object of no size is followed by itself."""
    log = tmp_path / "log.blf"
    log.write_bytes(blf(blf_object(48) + blf_object(0, kind)))
    assert "an object has 0 bytes" in run(["rerun"], log, capsys)[2]


def test_a_blf_log_that_unpacks_to_gigabytes_is_rejected(tmp_path, capsys):
    log = tmp_path / "log.blf"
    log.write_bytes(blf(bytes(20 << 20)))
    assert "a container has more than" in run(["rerun"], log, capsys)[2]


@pytest.mark.parametrize(
    ("name", "text", "named"),
    [
        ("a.log", f"(1.0) can0 123#00\n(1.0) can0 {'1' * 10000}#00\n", f"than {LINE_MAX} char"),
        ("a.csv", "t,i,e,r,e,d,d\n1,0x123,0,0,0,0,\n1,-1,0,0,0,0,\n", "identifier -0x1"),
        ("a.csv", f"t\n1,0x123,0,0,0,0,\n1,0x{'f' * 40},0,0,0,0,\n", "has identifier 0xfff"),
        ("a.log", f"(1.0) can0 123#00\n(1.0) can0 123##0{'00' * 90}\n", "90 bytes of data"),
        ("a.trc", f"{EVIL}\n", "entries cannot be read"),
        ("a.db", "", "is empty"),
        ("a.db", "SQLite format 3", "neither an LCM log nor a CAN log"),
    ],
)
def test_frames_that_are_none_are_reported(tmp_path, capsys, name, text, named):
    log = tmp_path / name
    log.write_text(text)
    status, out, err = run(["rerun"], log, capsys)
    assert status == 2 and (named in out + err or "none of the frames" in err), err


# Memory

MEASURED = """
import pathlib, re, sys
from saddlewalk.cli import main
status = main(sys.argv[1:])
process = pathlib.Path("/proc/self/status").read_text()  # getrusage() has the parent's peak in it
print(int(re.search(r"VmHWM: *(\\d+) kB", process.replace("\\t", " "))[1]) // 1024, file=sys.stderr)
raise SystemExit(status)
"""


def peak_mb(*arguments: str) -> int:
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode in (0, 1), done.stderr
    return int(done.stderr.splitlines()[-1])


@pytest.fixture(scope="module")
def long(walk, tmp_path_factory) -> tuple[Path, int]:
    path = tmp_path_factory.mktemp("long") / "long.lcmlog"
    return path, write_long_log(path, walk / "walk.lcmlog", 32_000_000)


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_memory_does_not_grow_with_the_log(short, long, tmp_path, command):
    """Beyond what a short log takes: less than a third of what the log's messages are as objects.

    Export and report hold some 100,000 messages at a time, of a log of any length; report keeps
    120 bytes a tick.
    """
    path, ticks = long
    name, *options = command
    out = [] if name == "rerun" else ["--out", str(tmp_path / "out")]
    usual_mb = peak_mb(name, str(short), *options, *out)
    grown_mb = peak_mb(name, str(path), *options, *out) - usual_mb
    print(f"{' '.join(command)}: {grown_mb} MB more for {path.stat().st_size / 1e6:.0f} MB")
    if not SANITIZED:
        assert grown_mb < {"report": 80, "rerun": 20, "export": 130}[name]
    if name == "report":
        assert f"{ticks}, numbers 0 to {ticks - 1}" in (tmp_path / "out").read_text()
