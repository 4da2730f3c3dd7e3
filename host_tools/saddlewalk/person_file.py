"""A fitted gait model as a TOML file for --config and as a C header for firmware."""

import re
from collections.abc import Sequence
from pathlib import Path

from saddlewalk import __version__
from saddlewalk.calibration import Fit, fields_of
from saddlewalk.config import DEFAULT_HEIGHT_M, DEFAULT_MASS_KG


def toml_text(fits: Sequence[Fit], sources: Sequence[str]) -> str:
    lines = [f"# {line}" for line in _origin(sources)]
    for fit in fits:
        lines += ["", f"# {_how_known(fit)}"]
        lines += [f"{name} = {_number(value)}" for name, value in fit.fields.items()]
    return "\n".join([*lines, ""])


def header_text(fits: Sequence[Fit], sources: Sequence[str], path: str) -> str:
    """A header that defines `saddle_config_STEM()`, STEM the file's name as a C identifier."""
    stem = re.sub(r"\W", "_", Path(path).stem, flags=re.ASCII).lower()
    fields = fields_of(fits)
    height, mass = (
        f"{_number(fields.pop(name, default))}f"
        for name, default in (
            ("body_height_m", DEFAULT_HEIGHT_M),
            ("body_mass_kg", DEFAULT_MASS_KG),
        )
    )
    return "\n".join(
        [
            *(f"/* {line.replace('*/', '')} */" for line in _origin(sources)),
            f"#ifndef SADDLE_CONFIG_{stem.upper()}_H",
            f"#define SADDLE_CONFIG_{stem.upper()}_H",
            "",
            "#include <saddlewalk/config.h>",
            "",
            f"static inline saddle_config_t saddle_config_{stem}(void)",
            "{",
            f"    saddle_config_t config = saddle_config_default({height}, {mass});",
            *(f"    config.{name} = {_number(value)}f;" for name, value in fields.items()),
            "    return config;",
            "}",
            "",
            "#endif",
            "",
        ]
    )


def _origin(sources: Sequence[str]) -> list[str]:
    """Where it comes from, in lines without anything that could end a comment."""
    plain = [re.sub(r"[^ -~]", "?", source) for source in sources]
    return [f"Fitted by saddlewalk calibrate {__version__} to:", *plain]


def _how_known(fit: Fit) -> str:
    known = [f"{fit.steps} steps"] if fit.steps else ["not fitted"]
    if fit.r2 == fit.r2:
        known.append(f"R2 {fit.r2:.2f}")
    return f"{fit.quantity}: {', '.join([*known, fit.note]) if fit.note else ', '.join(known)}"


def _number(value: float) -> str:
    """Six digits, always with a point."""
    text = f"{value:.6g}"
    return text if re.search(r"[.e]", text) else f"{text}.0"
