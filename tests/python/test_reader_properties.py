"""Readers of recordings on any bytes: what was written is read, the rest is refused."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from laboratory import LABORATORIES, PERSON, c3d_file, laboratory, walk_of
from long_log import encoded
from saddlewalk.errors import UserError
from saddlewalk.gait.c3d_layout import BLOCK, check_layout
from saddlewalk.transport.lcm_log import CHANNEL_MAX, SYNC, Event, LcmLog

ANY = settings(
    max_examples=300,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
NO_SYNC = st.binary(max_size=80).filter(lambda data: SYNC[0] not in data)
EVENTS = st.builds(
    Event,
    st.integers(0, 1 << 62),
    st.text("ABCDEFGHIJ_", min_size=1, max_size=CHANNEL_MAX),
    NO_SYNC,
)
PATCHES = st.lists(
    st.tuples(st.integers(0, 1 << 16), st.binary(min_size=1, max_size=6)), max_size=8
)


@ANY
@given(events=st.lists(st.tuples(EVENTS, NO_SYNC), min_size=1, max_size=8))
def test_events_are_read_whatever_is_between_them(events, tmp_path):
    log = tmp_path / "log"
    # What follows an event must be another, so each that is followed by other bytes is not whole.
    log.write_bytes(b"".join(between + encoded(event) for event, between in events))
    after = [*(between for _, between in events[1:]), b""]
    whole = [event for (event, _), follows in zip(events, after, strict=True) if not follows]
    read = LcmLog(log)
    assert list(read) == whole
    assert bool(read.broken) == (len(whole) < len(events) or bool(events[0][1]))


@ANY
@given(data=st.binary(max_size=400), patches=PATCHES, events=st.lists(EVENTS, max_size=4))
def test_any_log_is_read_or_refused(data, patches, events, tmp_path):
    log = tmp_path / "log"
    log.write_bytes(patched(data + b"".join(map(encoded, events)), patches))
    try:
        read = LcmLog(log)
    except UserError as refused:
        assert "\n" not in str(refused)
        return
    assert sum(len(encoded(event)) for event in read) + read.lost <= log.stat().st_size + (1 << 16)
    assert read.events > 0


def patched(data: bytes, patches: list[tuple[int, bytes]]) -> bytes:
    changed = bytearray(data)
    for place, new in patches:
        at = place % max(1, len(changed))
        changed[at : at + len(new)] = new[: len(changed) - at]
    return bytes(changed)


@pytest.fixture(scope="module")
def c3d(tmp_path_factory) -> bytes:
    path: Path = tmp_path_factory.mktemp("c3d") / "walk.c3d"
    axes = LABORATORIES["z up, walking along -y"]
    c3d_file(path, laboratory(walk_of(PERSON, 1.0, 0.2), axes))
    return path.read_bytes()


@ANY
@given(patches=PATCHES, length=st.integers(0, 1 << 16))
def test_any_c3d_layout_is_accepted_or_refused(patches, length, c3d, tmp_path):
    """Header and parameters are the first blocks: there most changes matter."""
    path = tmp_path / "walk.c3d"
    aimed = [(at % (4 * BLOCK), new) for at, new in patches]
    path.write_bytes(patched(c3d, aimed)[: length if length < len(c3d) else None])
    try:
        check_layout(path)
    except UserError as refused:
        assert str(path) in str(refused) and "\n" not in str(refused)
