"""Names and constants are those of the firmware's headers, in Python, in the DBC and on LCM."""

import os
import re
import subprocess
import sys

import cantools
import pytest

from saddlewalk import contract, firmware, paths, status_text, ticks, verdict
from saddlewalk.session.quality import FAULT_WORDS, LIMIT_WORDS
from saddlewalk.transport.lcm_types import plan_t, verdict_t

FIRMWARE = paths.CHECKOUT / "firmware"
DATABASE = cantools.database.load_file(FIRMWARE / "wire/saddlewalk.dbc")


def headers() -> str:
    rooms = (FIRMWARE / room / "include/saddlewalk" for room in ("core", "joints"))
    return "".join(header.read_text() for room in rooms for header in room.rglob("*.h"))


@pytest.mark.parametrize(
    ("numbered", "names"),
    [
        (r"SADDLE_(OK|ERROR_\w+) = \d", contract.STATUSES),
        (r"SADDLE_(LEFT|RIGHT) = \d", contract.SIDES),
        (r"SADDLE_COMMAND_(\w+) = \d", contract.COMMAND_MODES),
        (r"SADDLE_MODE_(\w+) = \d", contract.MODES),
        (r"SADDLE_LEVEL_(\w+) = \d", contract.LEVELS),
        (r"SADDLE_REASON_(\w+) = \d", contract.REASONS),
        (r"SADDLE_LIMIT_(\w+) = 1u << \d", contract.LIMITS),
        (r"SADDLE_FAULT_(\w+) = 1u << \d", contract.FAULTS),
        (r"SADDLE_SENSOR_(\w+) = 1u << \d", contract.SENSOR_FAULTS),
    ],
)
def test_names_are_those_of_the_headers(numbered, names):
    assert re.findall(numbered, headers()) == [name.upper() for name in names]


def test_constants_are_those_of_the_headers():
    assert contract.GRAVITY_M_S2 == 9.80665
    assert contract.TIME_MAX_S == 1000.0
    assert (contract.TICK_US, contract.TICK_S) == (80_000, 0.08)
    assert len(ticks.MESSAGES) == contract.OUTPUT_FRAMES


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (verdict.REASON_WORDS, contract.REASONS),
        (FAULT_WORDS, contract.FAULTS),
        (LIMIT_WORDS, contract.LIMITS),
    ],
)
def test_every_name_has_words(words, names):
    assert list(words) == list(names)


@pytest.mark.parametrize(
    "again",
    ["9[.]80665", '"standing", "st', '"unknown", "st', '"left", "right"', '"COMMAND", "COM_'],
)
def test_names_are_not_duplicated_in_python(again):
    package = paths.CHECKOUT / "host_tools/saddlewalk"
    written = {
        path.name
        for path in package.rglob("*.py")
        for line in path.read_text().splitlines()
        if re.search(rf"^[A-Z_, ]+ = [(\[]?{again}", line)
    }
    assert written == set()


def test_lcm_has_the_same_names():
    for kind, names in (("LEVEL", contract.LEVELS), ("REASON", contract.REASONS)):
        for number, name in enumerate(names):
            assert getattr(verdict_t, f"{kind}_{name.upper()}") == number
    for number, name in enumerate(contract.MODES):
        assert getattr(plan_t, f"MODE_{name.upper()}") == number


def numbered(names: tuple[str, ...]) -> dict[int, str]:
    return {number: name.upper() for number, name in enumerate(names)}


def flags(names: tuple[str, ...]) -> dict[int, str]:
    """A DBC's table has whole values: the bits one by one."""
    return {0: "NONE"} | {1 << bit: name for bit, name in enumerate(names)}


SOURCES = {
    number: name.removeprefix("SADDLE_SOURCE_")
    for number, name in sorted(firmware.ffi().typeof("saddle_source_t").elements.items())
}
TABLES = {
    ("COMMAND", "MODE"): numbered(contract.COMMAND_MODES),
    ("PLAN_STEP", "SUPPORT"): numbered(contract.SIDES),
    ("PLAN_EVENTS", "MODE"): numbered(contract.MODES),
    ("SCORES_FORCE", "FAULTS"): flags(contract.FAULTS),
    ("VERDICT", "LEVEL"): numbered(contract.LEVELS),
    ("VERDICT", "REASON"): numbered(contract.REASONS),
    ("RECOVERY", "FOOT"): numbered(contract.SIDES),
    ("BALANCE", "DRIVER"): numbered(contract.REASONS),
    ("INPUTS", "COMMAND_SOURCE"): SOURCES,
    ("INPUTS", "MEASURED_BY"): {0: "COM", 1: "SENSORS"},
    ("JOINTS_STATE", "FAULTS"): flags(contract.SENSOR_FAULTS),
    ("HEALTH", "STATUS"): numbered(contract.STATUSES),
    ("HEALTH", "LIMITS"): flags(contract.LIMITS),
}


def line_of(message: str, signal: str, table: dict[int, str]) -> str:
    """As it must stand in the DBC."""
    words = " ".join(f'{number} "{name}"' for number, name in sorted(table.items()))
    return f"VAL_ {DATABASE.get_message_by_name(message).frame_id} {signal} {words} ;"


@pytest.mark.parametrize(("message", "signal"), TABLES)
def test_the_dbc_has_the_words_of_the_headers(message, signal):
    text = (FIRMWARE / "wire/saddlewalk.dbc").read_text()
    assert line_of(message, signal, TABLES[message, signal]) in text.splitlines()


def test_the_dbc_reports_what_is_not_available():
    for message in DATABASE.messages:
        for signal in message.signals:
            choices = {number: str(word) for number, word in (signal.choices or {}).items()}
            if signal.is_signed:
                lowest = -(1 << (signal.length - 1))
                assert choices == {lowest: "NOT_AVAILABLE"}, signal.name
            else:
                assert choices == TABLES.get((message.name, signal.name), {}), signal.name


def test_every_code_fits_its_signal():
    for (message, signal), table in TABLES.items():
        length = DATABASE.get_message_by_name(message).get_signal_by_name(signal).length
        assert max(table) < 1 << length


def test_command_sources_match_the_status_type():
    assert list(SOURCES.values()) == [name.upper() for name in status_text.SOURCES]


def test_help_needs_no_build():
    """Names are read when a command runs, not when the commands are listed."""
    done = subprocess.run(
        [sys.executable, "-c", "from saddlewalk.cli import main; main()", "--help"],
        env=os.environ | {"SADDLEWALK_BUILD": "/nowhere"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "") and "monitor" in done.stdout
