#!/usr/bin/env python3
"""The C constants of the CAN messages: identifiers, signals, and the table of the CRC.

usage: tools/wire_signals.py DBC HEADER

firmware/wire/src/wire.c packs and unpacks by them. Exit status 1 if the DBC has a layout that it
does not know.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import cantools
from cantools.database.can import Message, Signal

CRC_POLYNOMIAL = 0x1D
FRAME_LENGTH = 8
NUMBER_BITS = (8, 16)

HEAD = """\
/* Written by tools/wire_signals.py from saddlewalk.dbc. */
#ifndef SADDLE_WIRE_SIGNALS_H
#define SADDLE_WIRE_SIGNALS_H

#include <stdint.h>

/** Where a signal lies in the 64 bits of a frame, and what one step of it means. */
typedef struct {
    uint8_t start, length;
    float scale;
} signal_t;
"""


def complaint(signal: Signal) -> str | None:
    """What wire.c cannot pack: it knows scaled numbers of 16 and 8 bits, and counts and codes."""
    if signal.byte_order != "little_endian" or signal.is_float or signal.is_multiplexer:
        return "must be a little-endian integer"
    if signal.offset != 0:
        return f"has offset {signal.offset}: must be 0"
    if signal.length > 32:
        return f"has {signal.length} bits: 32 at most"
    if not signal.is_signed:
        return None if signal.scale == 1 else f"is unsigned with scale {signal.scale}: must be 1"
    if signal.length not in NUMBER_BITS:
        return f"is signed with {signal.length} bits: must be 16 or 8"
    not_available = -(1 << (signal.length - 1))
    if not_available not in (signal.choices or {}):
        return f"is signed without a word for {not_available}, not available"
    return None


def complaints(message: Message) -> Iterator[str]:
    if message.length != FRAME_LENGTH or message.is_extended_frame or message.is_fd:
        yield f"{message.name} must be a classic frame of {FRAME_LENGTH} bytes, identifier 11 bits"
    places = {signal.name: (signal.start, signal.length) for signal in message.signals}
    if places.get("CRC") != (0, 8) or places.get("COUNTER") != (8, 4):
        yield f"{message.name} must begin with CRC, 0|8, and COUNTER, 8|4"
    for signal in message.signals:
        if problem := complaint(signal):
            yield f"{message.name}.{signal.name} {problem}"


def layout(message: Message) -> list[tuple[str, int, int, float]]:
    return [(s.name, s.start, s.length, float(s.scale)) for s in message.signals]


def differences(messages: list[Message]) -> Iterator[str]:
    """Of frames that C packs alike: of the left and the right, and of all joints."""
    found = {message.name: message for message in messages}
    twins = [(name, name.replace("RIGHT", "LEFT")) for name in found]
    for kind in ("JOINT_", "GAINS_"):
        names = [name for name in found if name.startswith(kind)]
        twins += [(name, names[0]) for name in names]
        identifiers = [found[name].frame_id for name in names]
        if identifiers != list(range(identifiers[0], identifiers[0] + len(names))):
            yield f"the identifiers of {kind}xxx must be one after the other"
    for one, other in twins:
        if layout(found[one]) != layout(found[other]):
            yield f"the signals of {one} must lie as those of {other}"


def crc_of(byte: int) -> int:
    for _ in range(8):
        byte = (byte << 1) ^ (0x100 | CRC_POLYNOMIAL if byte & 0x80 else 0)
    return byte


def crc_table() -> Iterator[str]:
    yield "/** What the CRC's polynomial makes of each byte. */"
    yield "static const uint8_t CRC_OF_BYTE[256] = {"
    for row in range(0, 256, 16):
        yield "    " + ", ".join(f"0x{crc_of(byte):02X}" for byte in range(row, row + 16)) + ","
    yield "};"


def enum(rows: list[str]) -> str:
    return "enum {\n" + "".join(f"    {row},\n" for row in rows) + "};"


def header(messages: list[Message]) -> Iterator[str]:
    signals = {f"{m.name}_{s.name}": s for m in messages for s in m.signals}
    if len(signals) < sum(len(message.signals) for message in messages):
        sys.exit("two signals have one name, as MESSAGE_SIGNAL")
    yield HEAD
    yield enum([f"MESSAGE_{message.name} = {message.frame_id}" for message in messages])
    yield ""
    yield enum([f"SIGNAL_{name}" for name in signals])
    yield "\nstatic const signal_t SIGNALS[] = {"
    for name, signal in signals.items():
        yield (
            f"    [SIGNAL_{name}] = {{{signal.start}, {signal.length}, {float(signal.scale)!r}f}},"
        )
    yield "};\n"
    yield from crc_table()
    yield "\n#endif"


def main() -> None:
    dbc, out = map(Path, sys.argv[1:])
    messages = cantools.database.load_file(dbc).messages
    wrong = [text for message in messages for text in complaints(message)]
    if wrong := wrong or list(differences(messages)):
        sys.exit("\n".join(f"{dbc}: {text}" for text in wrong))
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text("\n".join(header(messages)) + "\n")


if __name__ == "__main__":
    main()
