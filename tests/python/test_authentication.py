"""Authenticated commands: C and Python make the same codes, and the host takes no others."""

import random
from pathlib import Path

import can
import pytest
from cffi import FFI

from host_node import STANDING, Host
from saddlewalk import paths
from saddlewalk.errors import UserError
from saddlewalk.transport import wire
from saddlewalk.transport.authentication import (
    Authenticator,
    code_of,
    read_key,
    write_new_key,
)

pytestmark = pytest.mark.firmware

SEED = 20261122
KEY = bytes.fromhex("2b7e151628aed2a6abf7158809cf4f3c")
WALK = {"MODE": 1, "SPEED": 1.2, "HEEL_STRIKE": 0.1745}

ffi = FFI()


@pytest.fixture(scope="module")
def codec():
    ffi.cdef(paths.built("saddlewalk_wire_cdef.h").read_text())
    return ffi.dlopen(str(paths.built("lib/libsaddlewalk_wire_shared.so")))


class Guarded:
    """The C receiver in a session that requires authentication."""

    def __init__(self, codec, session: int = 0x01020304, key: bytes = KEY) -> None:
        self._codec = codec
        self._sessions_told = 0
        self.receiver = ffi.new("saddle_wire_receiver_t *")
        codec.saddle_wire_require_auth(self.receiver, key)
        codec.saddle_wire_open_session(self.receiver, session)

    def accepts(self, *frames: can.Message) -> bool:
        """Whether the last of the frames is accepted."""
        accepted = [
            self._codec.saddle_wire_accept(self.receiver, f.arbitration_id, bytes(f.data), 8)
            for f in frames
        ]
        return accepted[-1] == self._codec.SADDLE_WIRE_COMMAND

    def session(self) -> can.Message:
        frame = ffi.new("saddle_frame_t *")
        self._sessions_told += 1
        self._codec.saddle_wire_encode_session(self.receiver, self._sessions_told, frame)
        data = bytes(frame.data)
        return can.Message(arbitration_id=frame.id, is_extended_id=False, data=data)


def speaking(guarded: Guarded) -> Authenticator:
    authenticator = Authenticator(KEY)
    authenticator.hear(guarded.session())
    return authenticator


def test_c_and_python_make_the_same_codes(codec):
    rng = random.Random(SEED)
    command, made = ffi.new("saddle_frame_t *"), ffi.new("saddle_frame_t *")
    prepared = ffi.new("saddle_cmac_key_t *")
    for _ in range(300):
        key, session = rng.randbytes(16), rng.randrange(2**32)
        freshness = rng.randrange(1, 65536)
        codec.saddle_cmac_prepare(prepared, key)
        command.id, command.data = 0x100, rng.randbytes(8)
        frame = can.Message(arbitration_id=0x100, data=bytes(command.data))
        codec.saddle_wire_encode_code(prepared, session, freshness, command, made)
        data = bytes(made.data)
        code = can.Message(arbitration_id=made.id, is_extended_id=False, data=data)
        _, values = wire.Receiver().accept(code)
        assert values["CODE"] == code_of(key, session, freshness, frame)
        assert (values["FRESHNESS"], values["COUNTER"]) == (freshness, command.data[1] & 15)


def test_only_authenticated_commands_are_accepted(codec):
    guarded, sender = Guarded(codec), wire.Sender()
    authenticator = speaking(guarded)
    for number in range(40):
        assert guarded.accepts(*authenticator.frames(sender, **WALK)), number
    assert not guarded.accepts(sender.frame("COMMAND", **WALK))
    assert (guarded.receiver.bad_code, guarded.receiver.accepted) == (1, 80)


def test_a_replay_is_rejected_in_its_session_and_in_the_next(codec):
    guarded, sender = Guarded(codec), wire.Sender()
    authenticator = speaking(guarded)
    recorded = [authenticator.frames(sender, **WALK) for _ in range(22)]
    for number in (2, 6, 10, 14):
        assert guarded.accepts(*recorded[number])
    assert not guarded.accepts(*recorded[2])  # 16 before the next, so its alive counter is in step
    assert guarded.receiver.bad_code == 1
    # A replay costs two commands, for its alive counter, and no more.
    assert [guarded.accepts(*recorded[number]) for number in (18, 19, 20)] == [False, False, True]
    codec.saddle_wire_open_session(guarded.receiver, 5)
    assert not guarded.accepts(*recorded[21])
    authenticator.hear(guarded.session())
    assert guarded.accepts(*authenticator.frames(sender, **WALK))


def test_every_changed_bit_is_rejected(codec):
    """Every bit of the command (except its version) and of the code, with a valid CRC."""
    for which, bits in ((0, range(12, 64)), (1, [*range(12, 48), *range(56, 64)])):
        for bit in bits:
            guarded, sender = Guarded(codec), wire.Sender()
            frames = speaking(guarded).frames(sender, **WALK)
            frames[which].data[bit // 8] ^= 1 << bit % 8
            frames[which].data[0] = wire.frame_crc(frames[which].arbitration_id, frames[which].data)
            spare = which == 0 and bit < 16
            assert guarded.accepts(*frames) == spare, (which, bit)


def test_a_code_is_valid_once(codec):
    guarded, sender = Guarded(codec), wire.Sender()
    code, command = speaking(guarded).frames(sender, **WALK)
    other = wire.Sender().frame("COMMAND", **(WALK | {"SPEED": 0.5}))
    assert not guarded.accepts(code, other)
    assert not guarded.accepts(command)
    assert guarded.receiver.bad_code == 2


def test_only_authenticated_times_are_accepted_and_only_once(codec):
    guarded, sender = Guarded(codec), wire.Sender()
    authenticator = speaking(guarded)
    times = [authenticator.time_frames(sender, 80_000 * number)[0] for number in range(3)]
    for frame in times:
        guarded.accepts(frame)
    assert (guarded.receiver.accepted, guarded.receiver.bad_code) == (3, 0)
    guarded.accepts(times[2])
    guarded.accepts(wire.changed(*authenticator.time_frames(sender, 240_000), TIME=250_000))
    assert (guarded.receiver.accepted, guarded.receiver.bad_code) == (3, 2)
    assert Authenticator(KEY).time_frames(sender, 320_000) == []  # heard of no session


def test_another_key_is_rejected(codec):
    guarded = Guarded(codec, key=bytes(16))
    assert not guarded.accepts(*speaking(guarded).frames(wire.Sender(), **WALK))


@pytest.fixture
def key_file(tmp_path):
    path = tmp_path / "key"
    path.write_text(KEY.hex() + "\n")
    path.chmod(0o600)
    return path


def test_the_host_applies_commands_with_the_key_and_counts_others(key_file):
    with Host("--lcm=none", "--clock=lockstep", "--command-key", str(key_file)) as host:
        assert f"; commands: by CAN, authenticated with the key in {key_file}\n" in host.first_line
        authenticator = Authenticator(KEY)
        host.measure(STANDING)
        for frame in host.tick_frames():
            authenticator.hear(frame)
        for frame in authenticator.frames(host.sender, **WALK):
            host.bus.send(frame)
        host.measure(STANDING)
        assert host.tick()["INPUTS"]["COMMAND_AGE"] == 80 * 0
        host.send("COMMAND", **WALK)
        host.measure(STANDING)
        assert host.tick()["INPUTS"]["COMMAND_AGE"] == 80
        # And the time of each set, of which none had a code.
        assert "4 bad code" in host.stop()


def test_a_silence_opens_a_new_session(key_file):
    with Host("--lcm=none", "--clock=lockstep", "--command-key", str(key_file)) as host:
        sessions, ages = [], []
        heard = None
        for number in range(16):
            if number % 8 == 1:
                newcomer = Authenticator(KEY)  # counts from 1
                newcomer.hear(heard)
                for frame in newcomer.frames(host.sender, **WALK):
                    host.bus.send(frame)
            host.measure(STANDING)
            frames = host.tick_frames()
            heard = next(frame for frame in frames if frame.arbitration_id == 0x13C)
            sessions.append(bytes(heard.data[2:6]))
            ages += [
                wire.Receiver().accept(frame)[1]["COMMAND_AGE"]
                for frame in frames
                if frame.arbitration_id == 0x13F
            ]
        assert len(set(sessions)) == 3
        assert ages[1] == ages[9] == 0 and ages[8] == 7 * 80


@pytest.mark.parametrize(
    ("text", "mode"), [(KEY.hex(), 0o644), (KEY.hex()[:-2], 0o600), ("key" * 11, 0o600)]
)
def test_an_unsafe_or_invalid_key_file_is_a_one_line_error(tmp_path, text, mode):
    path = tmp_path / "key"
    path.write_text(text)
    path.chmod(mode)
    with pytest.raises(AssertionError), Host("--lcm=none", "--command-key", str(path)) as host:
        host.stop()


def test_both_sides_reject_the_same_key_files(tmp_path, key_file):
    assert read_key(key_file) == KEY
    for text, mode in ((KEY.hex(), 0o640), (KEY.hex()[:-1], 0o600), ("key" * 11, 0o600)):
        path = tmp_path / "other"
        path.write_text(text)
        path.chmod(mode)
        with pytest.raises(UserError, match=f"--command-key {path}: give a file with 32 hexa"):
            read_key(path)
    with pytest.raises(UserError, match="--command-key /no/key: give a file"):
        read_key(Path("/no/key"))


def test_a_new_key_is_random_and_readable_by_its_owner_only(tmp_path):
    for name in ("one", "two"):
        write_new_key(tmp_path / name)
        assert (tmp_path / name).stat().st_mode & 0o777 == 0o600
    assert read_key(tmp_path / "one") != read_key(tmp_path / "two")
    with pytest.raises(FileExistsError):
        write_new_key(tmp_path / "one")


def test_a_key_of_another_length_is_rejected():
    with pytest.raises(UserError, match="has 15 bytes: give 16"):
        Authenticator(bytes(15))
