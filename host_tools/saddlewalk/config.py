"""From command-line options and a TOML file to the core's configuration."""

import argparse
import difflib
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from saddlewalk.errors import UserError
from saddlewalk.outputs import add_input
from saddlewalk.toml_file import read_toml

DEFAULT_HEIGHT_M = 1.79
DEFAULT_MASS_KG = 63.3
ANKLES = {"erf": 0, "rigid": 1, "cycloid": 2}

LEGS = "legs"  # table of a file

# Old names of fields, accepted with a warning for one version.
RENAMED = {"foresight_s": "prediction_horizon_s"}


def add_body_options(parser: argparse.ArgumentParser) -> None:
    """--height, --mass, --config: what every command that runs the core takes."""
    parser.add_argument("--height", type=float, metavar="M", help="body height, m (default 1.79)")
    parser.add_argument("--mass", type=float, metavar="KG", help="body mass, kg (default 63.3)")
    add_input(
        parser,
        "--config",
        type=Path,
        metavar="FILE",
        help="TOML file with fields of saddle_config_t, and of saddle_legs_t in a table [legs]",
    )


def load_config(
    args: argparse.Namespace,
    ankle: str | None = None,
    body: Mapping[str, float] = MappingProxyType({}),
) -> Any:
    """A saddle_config_t: the paper's defaults, then the body, the file and the options.

    Raises UserError naming the option, file, field and value that is wrong.
    """
    from saddlewalk.core import describe_bad_field, ffi, library

    fields = {**body, **given_fields(args)}
    if ankle is not None:
        fields["ankle"] = ANKLES[ankle]
    config = configuration(fields)
    bad_field = library().saddle_config_check(config)
    if bad_field != ffi().NULL:
        name = ffi().string(bad_field).decode()
        raise UserError(f"{_origin(name, args)}{describe_bad_field(name, config)}")
    return config


def given_fields(args: argparse.Namespace) -> dict[str, float | int]:
    """Fields of saddle_config_t as the file and the options of add_body_options() give them."""
    fields = _read_file(args.config) if args.config else {}
    if args.height is not None:
        fields["body_height_m"] = args.height
    if args.mass is not None:
        fields["body_mass_kg"] = args.mass
    return fields


def given_legs(args: argparse.Namespace) -> dict[str, float]:
    """Fields of saddle_legs_t in the file's table [legs]: what was measured of the legs.

    Raises UserError naming the file and the field that is wrong.
    """
    table = read_toml(args.config, "--config").get(LEGS, {}) if args.config else {}
    if not isinstance(table, dict):
        raise UserError(f"{args.config}: {LEGS} = {table!r} must be a table")
    return {name: _leg_field(args.config, name, value) for name, value in table.items()}


def configuration(fields: Mapping[str, float | int]) -> Any:
    """A saddle_config_t with these fields, and the paper's defaults for the others. Not checked."""
    from saddlewalk.core import ffi, library

    config = ffi().new("saddle_config_t *")
    config[0] = library().saddle_config_default(DEFAULT_HEIGHT_M, DEFAULT_MASS_KG)
    for name, value in fields.items():
        setattr(config, name, value)
    return config


def host_arguments(config: Any) -> list[str]:
    """Options that give saddlewalk-host the same configuration, to the bit."""
    from saddlewalk.core import field_ranges

    arguments = [f"--set={name}={getattr(config, name):.9g}" for name in field_ranges()]
    ankle = next(name for name, number in ANKLES.items() if number == config.ankle)
    return [*arguments, f"--ankle={ankle}"]


def _origin(field: str, args: argparse.Namespace) -> str:
    option = {"body_height_m": "height", "body_mass_kg": "mass"}.get(field)
    if option is not None and getattr(args, option) is not None:
        return f"--{option}: "
    return f"{args.config}: " if args.config else ""


def _read_file(path: Path) -> dict[str, float | int]:
    fields = {
        _present_name(path, name): value
        for name, value in read_toml(path, "--config").items()
        if name != LEGS
    }
    return {name: _field_value(path, name, value) for name, value in fields.items()}


def _present_name(path: Path, name: str) -> str:
    if name in RENAMED:
        print(
            f"saddlewalk: {path}: {name} is called {RENAMED[name]} now; "
            "the old name will be an error in the next version",
            file=sys.stderr,
        )
    return RENAMED.get(name, name)


def _leg_field(path: Path, name: str, value: Any) -> float:
    from saddlewalk.joints import fields

    known = fields()
    if name not in known:
        raise UserError(f"{path}: [{LEGS}]: {name} is not a field of saddle_legs_t")
    low, high = known[name].min, known[name].max
    number = not isinstance(value, bool) and isinstance(value, int | float)
    if not number or not low <= value <= high:
        raise UserError(f"{path}: [{LEGS}]: {name} = {value!r} must be in {low:g} to {high:g}")
    return float(value)


def _field_value(path: Path, name: str, value: Any) -> float | int:
    from saddlewalk.core import field_ranges

    if name == "ankle":
        if not isinstance(value, str) or value not in ANKLES:
            raise UserError(f"{path}: ankle = {value!r} must be one of {', '.join(ANKLES)}")
        return ANKLES[value]
    known = field_ranges()
    if name not in known:
        near = difflib.get_close_matches(name, [*known, "ankle"], n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise UserError(f"{path}: {name} is not a field of saddle_config_t{hint}")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UserError(f"{path}: {name} = {value!r} must be a number")
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
