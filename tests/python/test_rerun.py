"""`saddlewalk rerun`: a log gives the same bits again, and a difference is named."""

import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import can
import lcm
import pytest

from host_node import own_lcm
from saddlewalk import __version__, paths
from saddlewalk.cli import main
from saddlewalk.transport import wire
from saddlewalk.transport.bus import private_udp
from saddlewalk.transport.lcm_log import LcmLog

TICKS = 163  # of 13 s
OUTPUTS = TICKS * 7
FRAMES = TICKS * 28


def rerun(log: Path, capsys, *options: str) -> tuple[int, str, str]:
    capsys.readouterr()
    status = main(["rerun", str(log), *options])
    shown = capsys.readouterr()
    return status, shown.out, shown.err


def write_events(path: Path, events) -> Path:
    log = lcm.EventLog(str(path), "w", overwrite=True)
    for event in events:
        log.write_event(event.logged_us, event.channel, event.data)
    log.close()
    return path


class Changed:
    """An event of a log, with other bytes."""

    def __init__(self, event, data: bytes) -> None:
        self.logged_us, self.channel, self.data = event.logged_us, event.channel, data


def events_of(walk: Path) -> list:
    return list(LcmLog(walk / "walk.lcmlog"))


def test_a_log_is_recomputed_bit_for_bit(walk, capsys):
    status, shown, _ = rerun(walk / "walk.lcmlog", capsys)
    assert status == 0
    assert f"lockstep: 1 run, {TICKS} ticks recomputed" in shown
    assert f"all {OUTPUTS} recorded outputs are equal" in shown


def test_a_run_in_real_time_is_recomputed_bit_for_bit(tmp_path, capsys):
    """With the ages that its measurements had; of which a CAN log does not know."""
    options = ["--can", private_udp(), "--lcm", own_lcm(), "--out", str(tmp_path)]
    body = ["--height", "1.6", "--mass", "48.123"]
    assert main(["demo", "--clock", "realtime", "--duration", "2", *options, *body]) == 0
    status, shown, _ = rerun(tmp_path / "walk.lcmlog", capsys)
    assert status == 0 and "real time: 1 run" in shown
    status, _, shown = rerun(tmp_path / "walk.candump.log", capsys, *body)
    assert (status, shown.count("\n")) == (2, 1)
    assert "rerun its LCM log, which has the ages" in shown


@pytest.mark.parametrize(
    ("channel", "byte", "named"),
    [
        ("PLAN", -1, "SADDLEWALK_PLAN load[1]: recorded"),
        ("PLAN", 17, "SADDLEWALK_PLAN mode: recorded 0, recomputed 1"),
        ("SCORES", -1, "SADDLEWALK_SCORES xcom_m[1]: recorded"),
        ("VERDICT", 16, "SADDLEWALK_VERDICT level: recorded"),
        ("BALANCE", 16, "SADDLEWALK_BALANCE driver: recorded"),
        ("BALANCE", -1, "SADDLEWALK_BALANCE walk_step_margin: recorded"),
        ("BOS", -1, "SADDLEWALK_BOS y_m[15]: recorded"),
        ("HEALTH", 20, "SADDLEWALK_HEALTH status: recorded 1, recomputed 0"),
        ("PLAN", 0, "SADDLEWALK_PLAN: recorded 200 bytes of no such type"),
    ],
)
def test_one_flipped_bit_of_an_output_is_named(walk, tmp_path, capsys, channel, byte, named):
    events = events_of(walk)
    index = [i for i, e in enumerate(events) if e.channel == f"SADDLEWALK_{channel}"][5]
    data = bytearray(events[index].data)
    data[byte] ^= 1
    events[index] = Changed(events[index], bytes(data))
    status, shown, _ = rerun(write_events(tmp_path / "log", events), capsys)
    assert status == 1
    assert shown.splitlines()[1].startswith(f"tick 5 (0.40 s), {named}")
    assert f"1 of {TICKS} ticks differ" in shown


def test_a_flipped_bit_of_an_input_shows_in_the_outputs(walk, tmp_path, capsys):
    events = events_of(walk)
    index = [i for i, e in enumerate(events) if e.channel == "SADDLEWALK_INPUT"][40]
    data = bytearray(events[index].data)
    data[8 + 8 + 4 + 1 + 4 + 4 + 8 + 4 + 3] ^= 1  # the CoM's velocity along x, its last bit
    events[index] = Changed(events[index], bytes(data))
    status, shown, _ = rerun(write_events(tmp_path / "log", events), capsys)
    assert status == 1
    assert "tick 40 (3.20 s), SADDLEWALK_" in shown and "(0x" in shown


def test_every_field_of_an_input_is_logged_to_the_bit():
    """Random bytes in each, NaNs of any kind among them, and back."""
    from saddlewalk.firmware import ffi, library

    rng = random.Random(3)
    given, back = (ffi().new("saddle_input_t *") for _ in range(2))
    tick, room = ffi().new("int32_t *"), ffi().new("uint8_t[4096]")
    for number in range(200):
        ffi().memmove(given, rng.randbytes(ffi().sizeof(given[0])), ffi().sizeof(given[0]))
        given.time_us &= 2**63 - 1
        for foot in given.measurement.foot:
            ffi().memmove(ffi().addressof(foot, "contact"), bytes([rng.randrange(2)]), 1)
        size = library().saddle_lcm_encode_input(given, number, room)
        assert library().saddle_lcm_decode_input(room, size, back, tick)
        turn_size = library().saddle_lcm_encode_turn(given, room)
        assert library().saddle_lcm_decode_turn(room, turn_size, back)
        feet_size = library().saddle_lcm_encode_feet(given, room)
        assert library().saddle_lcm_decode_feet(room, feet_size, back)
        assert leaves(back[0]) == leaves(given[0]) and tick[0] == number
    assert len(leaves(given[0])) >= 14
    assert not library().saddle_lcm_decode_turn(room, turn_size - 1, back)
    size = library().saddle_lcm_encode_input(given, number, room)
    assert not library().saddle_lcm_decode_input(room, size - 1, back, tick)


def leaves(struct) -> dict[str, bytes]:
    """The bytes of each member of a struct that is none itself, by its path."""
    from saddlewalk.firmware import ffi

    kind, found = ffi().typeof(struct), {}
    if kind.kind == "array":
        members = [(f"[{i}]", ffi().addressof(struct, i)[0]) for i in range(kind.length)]
    else:
        members = [(name, None) for name, _ in kind.fields]
    for name, element in members:
        member = element if element is not None else getattr(struct, name)
        if isinstance(member, ffi().CData):
            found |= {f"{name}.{path}": data for path, data in leaves(member).items()}
        else:
            found[name] = bytes(ffi().buffer(ffi().addressof(struct, name)))
    return found


def test_every_field_of_the_configuration_is_logged_and_counts(walk, tmp_path, capsys):
    from saddlewalk.firmware import ffi
    from saddlewalk.transport.lcm_types import config_t

    events = events_of(walk)
    config = config_t.decode(events[0].data)
    assert events[0].channel == "SADDLEWALK_CONFIG"
    fields = [name for name, _ in ffi().typeof("saddle_config_t").fields]
    assert [*config.name, "ankle"] == fields
    assert (config.library_version, config.wire_version) == (__version__, wire.WIRE_VERSION)
    config.value = list(config.value)
    config.value[config.name.index("body_mass_kg")] += 1
    events[0] = Changed(events[0], config.encode())
    status, shown, _ = rerun(write_events(tmp_path / "log", events), capsys)
    assert status == 1
    assert "gravity_n" in shown and "the configuration changes at tick 12" in shown


def test_a_configuration_of_another_version_is_rejected(walk, tmp_path, capsys):
    from saddlewalk.transport.lcm_types import config_t

    events = events_of(walk)
    config = config_t.decode(events[0].data)
    config.library_version = "9.9.9"
    config.name = ["stride_magic", *config.name[1:]]
    events[0] = Changed(events[0], config.encode())
    status, _, shown = rerun(write_events(tmp_path / "log", events), capsys)
    assert (status, shown.count("\n")) == (2, 1)
    assert "saddlewalk 9.9.9, and stride_magic is not a field" in shown


def test_a_log_from_mid_run_says_so(walk, tmp_path, capsys):
    events = events_of(walk)
    status, _, shown = rerun(write_events(tmp_path / "log", events[500:]), capsys)
    assert (status, shown.count("\n")) == (2, 1)
    assert "the log begins in mid-run" in shown and f"to {TICKS - 1} cannot be computed" in shown


def test_successive_runs_are_each_recomputed(walk, tmp_path, capsys):
    events = events_of(walk)
    log = write_events(tmp_path / "log", [*events, *events])
    status, shown, _ = rerun(log, capsys)
    assert status == 0 and f"2 runs, {2 * TICKS} ticks" in shown
    log = write_events(tmp_path / "log", [*events[500:], *events])
    status, shown, _ = rerun(log, capsys)
    assert status == 1
    assert f"1 run, {TICKS} ticks" in shown and "not compared: the log begins in mid-run" in shown


def test_a_lost_input_ends_the_comparison_there(walk, tmp_path, capsys):
    events = events_of(walk)
    lost = [i for i, e in enumerate(events) if e.channel == "SADDLEWALK_INPUT"][60]
    status, shown, _ = rerun(
        write_events(tmp_path / "log", events[:lost] + events[lost + 1 :]), capsys
    )
    assert status == 1
    assert "60 ticks recomputed" in shown and "differ" not in shown
    assert f"tick 59 is followed by tick 61: ticks 61 to {TICKS - 1} cannot be computed" in shown


def test_lost_outputs_are_reported_and_the_others_compared(walk, tmp_path, capsys):
    events = [e for e in events_of(walk) if e.channel != "SADDLEWALK_BOS"]
    status, shown, _ = rerun(write_events(tmp_path / "log", events), capsys)
    assert status == 1 and f"{TICKS} ticks recomputed" in shown
    assert f"SADDLEWALK_BOS of {TICKS} ticks is not in the log, the first time of tick 0" in shown


def test_a_log_of_older_firmware_is_complete(walk, tmp_path, capsys):
    """Without any message of the channel. If there are some, the others were lost."""
    events = events_of(walk)
    there = [i for i, event in enumerate(events) if event.channel == "SADDLEWALK_BALANCE"]
    added = ("SADDLEWALK_BALANCE", "SADDLEWALK_WAY", "SADDLEWALK_TURN", "SADDLEWALK_FEET")
    older = [event for event in events if event.channel not in added]
    status, shown, _ = rerun(write_events(tmp_path / "older", older), capsys)
    assert status == 0 and f"all {TICKS * 5} recorded outputs are equal" in shown
    for channel in added[:2]:
        assert f"{channel} is not in the log and was not compared" in shown
    del events[there[3]]
    status, shown, _ = rerun(write_events(tmp_path / "lost", events), capsys)
    assert status == 1
    assert "SADDLEWALK_BALANCE of 1 ticks is not in the log, the first time of tick 3" in shown


def test_a_log_without_inputs_says_so(walk, tmp_path, capsys):
    events = [e for e in events_of(walk) if e.channel != "SADDLEWALK_INPUT"]
    status, _, shown = rerun(write_events(tmp_path / "log", events), capsys)
    assert (status, shown.count("\n")) == (2, 1) and "no SADDLEWALK_INPUT" in shown


def test_a_truncated_log_says_so(walk, tmp_path, capsys):
    cut = tmp_path / "cut.lcmlog"
    cut.write_bytes((walk / "walk.lcmlog").read_bytes()[:-150])
    status, shown, _ = rerun(cut, capsys)
    assert status == 1
    assert "bytes of the log are not an event" in shown and "differ" not in shown


@pytest.mark.parametrize(
    ("content", "named"),
    [
        (b"", "is empty"),
        (b"\x89PNG" + bytes(100), "neither an LCM log nor a CAN log"),
        (bytes.fromhex("eda1da01"), "none of its events"),
        (bytes.fromhex("eda1da01") + bytes(range(256)), "none of its events"),
    ],
)
def test_a_file_that_is_not_a_log_is_a_one_line_error(tmp_path, capfd, content, named):
    """LCM's own reader prints messages, which are hidden."""
    file = tmp_path / "file"
    file.write_bytes(content)
    status, out, shown = rerun(file, capfd)
    assert (status, out, shown.count("\n")) == (2, "", 1)
    assert str(file) in shown and named in shown


def test_a_missing_file_and_options_for_an_lcm_log_are_one_line_errors(walk, tmp_path, capsys):
    status, _, shown = rerun(tmp_path / "none.lcmlog", capsys)
    assert (status, shown.count("\n")) == (2, 1) and "No such file" in shown
    status, _, shown = rerun(walk / "walk.lcmlog", capsys, "--mass", "70")
    assert (status, shown.count("\n")) == (
        2,
        1,
    ) and "--mass 70.0: an LCM log has its own" in shown


def can_log(path: Path, frames) -> Path:
    with can.Logger(path) as log:
        for frame in frames:
            log.on_message_received(frame)
    return path


def frames_of(walk: Path) -> list[can.Message]:
    with can.LogReader(walk / "walk.candump.log") as log:
        return list(log)


@pytest.mark.parametrize("suffix", [".log", ".blf", ".asc"])
def test_a_can_log_is_recomputed_bit_for_bit(walk, tmp_path, capsys, suffix):
    status, shown, _ = rerun(can_log(tmp_path / f"walk{suffix}", frames_of(walk)), capsys)
    assert status == 0
    assert f"{TICKS} ticks" in shown and f"all {FRAMES} recorded outputs are equal" in shown


def test_one_flipped_bit_of_a_frame_is_named(walk, tmp_path, capsys):
    frames = frames_of(walk)
    scores = [frame for frame in frames if frame.arbitration_id == 0x131][7]
    scores.data[2] ^= 1
    status, shown, _ = rerun(can_log(tmp_path / "walk.log", frames), capsys)
    assert status == 1
    assert "tick 7 (0.56 s), SCORES_MARGIN MOS_COM: recorded " in shown
    assert f"1 of {TICKS} ticks differ" in shown


def test_a_can_log_with_another_body_differs(walk, capsys):
    status, shown, _ = rerun(walk / "walk.candump.log", capsys, "--mass", "80")
    assert status == 1 and "SCORES_FORCE GRAVITY" in shown


def test_a_can_log_from_mid_run_or_with_losses_says_so(walk, tmp_path, capsys):
    frames = frames_of(walk)
    log = can_log(tmp_path / "mid.log", frames[36 * 5 :])
    status, _, shown = rerun(log, capsys)
    assert (status, shown.count("\n")) == (2, 1) and "the log begins in mid-run" in shown
    answered = [i for i, frame in enumerate(frames) if frame.arbitration_id == 0x140]
    status, shown, _ = rerun(
        can_log(tmp_path / "lost.log", frames[: answered[9] - 30] + frames[answered[9] + 1 :]),
        capsys,
    )
    assert status == 1 and "9 ticks recomputed" in shown and "2 sets of measurements came" in shown
    log = can_log(tmp_path / "frame.log", frames[: answered[9] - 8] + frames[answered[9] - 7 :])
    status, shown, _ = rerun(log, capsys)
    assert (
        status == 1 and "RECOVERY of 1 ticks is not in the log, the first time of tick 9" in shown
    )


def test_frames_that_the_host_rejected_are_rejected_again(walk, tmp_path, capsys):
    """Bad CRC, a repeat, foreign identifiers, other kinds of frame."""
    frames = frames_of(walk)
    com = next(frame for frame in frames if frame.arbitration_id == 0x110)
    bad = can.Message(
        arbitration_id=0x110, is_extended_id=False, data=bytes(com.data[:7]) + b"\xaa"
    )
    junk = [
        com,
        bad,
        can.Message(arbitration_id=0x7FF, is_extended_id=False, data=b"x"),
        can.Message(arbitration_id=0x140, is_extended_id=True, data=bytes(8)),
        can.Message(arbitration_id=0x140, is_extended_id=False, is_remote_frame=True),
        can.Message(arbitration_id=0x140, is_extended_id=False, data=b"abc"),
    ]
    status, shown, _ = rerun(
        can_log(tmp_path / "junk.log", frames[:44] + junk + frames[44:]), capsys
    )
    assert status == 0, shown


def test_an_unusable_command_is_not_used_in_the_rerun(walk, tmp_path, capsys):
    frames = frames_of(walk)
    command = [frame for frame in frames if frame.arbitration_id == 0x100][90]
    command.data[2:4] = b"\x00\x80"  # the speed: not available
    command.data[0] = wire.frame_crc(0x100, command.data)
    status, shown, _ = rerun(can_log(tmp_path / "walk.log", frames), capsys)
    assert status == 0, shown


def test_a_damaged_can_log_says_where(walk, tmp_path, capsys):
    lines = (walk / "walk.candump.log").read_text().splitlines()
    broken = tmp_path / "broken.log"
    broken.write_text("\n".join([*lines[:1000], "(17953285 saddlewalk"]))
    status, shown, _ = rerun(broken, capsys)
    assert status == 1 and "cannot be read beyond 1000 records" in shown
    broken.write_text("no frame\n")
    status, _, shown = rerun(broken, capsys)
    assert (status, shown.count("\n")) == (2, 1) and "holds no CAN frame" in shown
    other = can_log(
        tmp_path / "other.log", [can.Message(arbitration_id=0x7FF, is_extended_id=False)]
    )
    status, _, shown = rerun(other, capsys)
    assert (status, shown.count("\n")) == (2, 1) and "none of the frames COMMAND" in shown


def test_reruns_do_not_depend_on_this_machine(walk, tmp_path):
    """The log alone, elsewhere, without LCM's network or a home folder."""
    log = shutil.copy(walk / "walk.lcmlog", tmp_path / "from-afar")
    script = Path(sys.executable).with_name("saddlewalk")
    done = subprocess.run(
        ["unshare", "--user", "--net", str(script), "rerun", log],
        cwd=tmp_path,
        env=os.environ | {"SADDLEWALK_BUILD": str(paths.build_dir().absolute())},
        capture_output=True,
        text=True,
        check=False,
    )
    if "unshare" in done.stderr:
        pytest.skip("no user namespaces here")
    assert done.returncode == 0, done.stderr
