"""Checks the sizes stated in a C3D file before a reader allocates memory for them.

The header and the parameter section hold counts and lengths that may be wrong by orders of
magnitude in a damaged file. Each is compared with the file's size. Lengths and offsets are in the
byte order of the processor that the file names; blocks are 512 bytes, counted from 1.
"""

import math
import struct
from collections.abc import Iterator, Mapping
from pathlib import Path

from saddlewalk.errors import UserError

BLOCK = 512  # bytes
KEY = 0x50
BYTE_ORDERS = {84: "<", 85: "<", 86: ">"}  # Intel, DEC, SGI/MIPS
SCALE_SIGN_BYTE = {84: 15, 85: 13, 86: 12}  # of the header: its top bit: data are floats
ELEMENT_BYTES = {-1: 1, 1: 1, 2: 2, 4: 4}  # by type: characters, bytes, integers, floats
MOST_DIMENSIONS = 7
MOST_EMPTY = 0xFFFF  # elements of no length, such as 40 empty descriptions
OVERFLOWED = 0xFFFF  # a last frame or a count of frames: the true one is in another parameter

Counts = Mapping[tuple[str, str], tuple[int, ...]]  # integers by (group, parameter)


class _LayoutError(Exception):
    """The text of an error, without the file's name."""


def check_layout(path: Path) -> None:
    """Raises UserError naming the size that exceeds the file."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    try:
        _check(data)
    except _LayoutError as error:
        raise UserError(f"{path}: not a C3D file: {error}") from None


def _check(data: bytes) -> None:
    if len(data) < 2 * BLOCK:
        raise _LayoutError(f"{len(data)} bytes; header and parameters take {2 * BLOCK} or more")
    if data[1] != KEY:
        raise _LayoutError(f"byte 2 is 0x{data[1]:02x}, must be 0x{KEY:02x}")
    section = BLOCK * (data[0] - 1)
    if not BLOCK <= section <= len(data) - BLOCK:
        raise _LayoutError(f"the parameters begin in block {data[0]} of {len(data) // BLOCK}")
    processor = data[section + 3]
    if processor not in BYTE_ORDERS:
        raise _LayoutError(f"processor type {processor} must be one of 84, 85, 86")
    _check_frames(data, processor, _integers(data, section, BYTE_ORDERS[processor]))


def _integers(data: bytes, section: int, order: str) -> Counts:
    """Integers of the parameter section. Raises _LayoutError if a record exceeds the file."""
    groups, found = {}, []
    for at, name, number, end in _records(data, section, order):
        if number < 0:
            groups[-number] = name
        else:
            found.append((number, name, _parameter(data, at, end, order, name)))
    return {(groups.get(group, ""), name): words for group, name, words in found if words}


def _records(data: bytes, section: int, order: str) -> Iterator[tuple[int, str, int, int]]:
    """(first byte after the length, name, number, end) of each group, below 0, and parameter."""
    at = section + 4
    while at < len(data) and data[at] != 0:
        length, number = struct.unpack_from("bb", data, at)
        name_end = at + 2 + abs(length)
        if name_end + 3 > len(data):
            raise _LayoutError(f"the parameter record at byte {at} ends beyond the file")
        name = data[at + 2 : name_end].decode("latin-1")
        if number == 0:
            raise _LayoutError(f"{name!r} at byte {at} belongs to group 0; groups count from 1")
        (offset,) = struct.unpack_from(order + "H", data, name_end)
        end = name_end + offset if offset else len(data)
        if not name_end + 3 <= end <= len(data):
            raise _LayoutError(
                f"{name!r} at byte {at} is {offset} bytes long; 3 to {len(data) - name_end} fit"
            )
        yield name_end + 2, name, number, end
        if not offset:
            return
        at = end


def _parameter(data: bytes, at: int, end: int, order: str, name: str) -> tuple[int, ...]:
    """Its value as unsigned 16-bit integers, if that is its type. Its dimensions must fit its
    record.
    """
    kind, dimensions = struct.unpack_from("bB", data, at) if at + 2 <= end else (0, 0)
    if kind not in ELEMENT_BYTES or dimensions > MOST_DIMENSIONS:
        raise _LayoutError(
            f"{name!r} has type {kind} and {dimensions} dimensions; types are -1, 1, 2, 4, "
            f"dimensions 0 to {MOST_DIMENSIONS}"
        )
    first = at + 2 + dimensions
    shape = data[at + 2 : first]
    elements, room = math.prod(shape), end - first
    if elements * ELEMENT_BYTES[kind] > room or math.prod(filter(None, shape)) > MOST_EMPTY:
        raise _LayoutError(
            f"{name!r} is {' x '.join(map(str, shape))} elements of {ELEMENT_BYTES[kind]} bytes; "
            f"its record has room for {max(0, room)} bytes"
        )
    return struct.unpack_from(f"{order}{elements}H", data, first) if kind == 2 else ()


def _check_frames(data: bytes, processor: int, counts: Counts) -> None:
    """Check points and frames against the data section, by the smallest counts that the file
    states.
    """
    points, analogs, first, last = struct.unpack_from(BYTE_ORDERS[processor] + "4H", data, 2)
    (start,) = struct.unpack_from(BYTE_ORDERS[processor] + "H", data, 16)
    if not 2 * BLOCK <= BLOCK * (start - 1) < len(data):
        raise _LayoutError(f"the data begin in block {start} of {len(data) // BLOCK}")
    points = counts.get(("POINT", "USED"), (points,))[0]  # as in ezc3d
    if points == 0:
        raise _LayoutError("POINT:USED is 0: there are no markers")
    frames = _frames(first, last, counts)
    if frames < 1:
        raise _LayoutError(f"frames {first} to {last}: there must be at least one")
    is_float = data[SCALE_SIGN_BYTE[processor]] & 0x80
    frame_bytes = (4 * points + analogs) * (4 if is_float else 2)
    room = len(data) - BLOCK * (start - 1)
    if frames * frame_bytes > room:
        raise _LayoutError(
            f"{frames} frames of {points} points and {analogs} analog values take "
            f"{frames * frame_bytes} bytes; the file has {room} bytes of data"
        )


def _frames(first: int, last: int, counts: Counts) -> int:
    """The smallest of header, POINT:FRAMES and TRIAL; a 16-bit count may have overflowed."""
    stated = [] if last == OVERFLOWED else [last - first + 1]
    frames = counts.get(("POINT", "FRAMES"))
    if frames and frames[0] not in (0, OVERFLOWED):
        stated.append(frames[0])
    ends = [counts.get(("TRIAL", f"ACTUAL_{edge}_FIELD"), ()) for edge in ("START", "END")]
    if all(len(words) == 2 for words in ends):
        start, end = (low + (high << 16) for low, high in ends)
        stated.append(end - start + 1)
    return min(stated, default=1)
