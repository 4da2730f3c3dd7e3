"""A fitted gait model as a TOML file for --config and as a C header for firmware."""

import math
import re
from collections.abc import Sequence
from pathlib import Path

from saddlewalk import __version__
from saddlewalk.config import ANKLES, DEFAULT_HEIGHT_M, DEFAULT_MASS_KG
from saddlewalk.gait.fit import Fit, fields_of


def toml_text(fits: Sequence[Fit], sources: Sequence[str]) -> str:
    lines = [f"# {line}" for line in _origin(sources)]
    for fit in fits:
        lines += ["", f"# {_how_known(fit)}"]
        lines += [f"{name} = {_toml_value(name, value)}" for name, value in fit.fields.items()]
    return "\n".join([*lines, ""])


def header_text(fits: Sequence[Fit], sources: Sequence[str], path: str) -> str:
    """A header that defines `saddle_config_STEM()`, STEM the file's name as a C identifier."""
    stem = re.sub(r"\W", "_", Path(path).stem, flags=re.ASCII).lower()
    body = f"{DEFAULT_HEIGHT_M}f, {DEFAULT_MASS_KG}f"
    return "\n".join(
        [
            *(f"/* {line} */" for line in _origin(sources)),
            f"#ifndef SADDLE_CONFIG_{stem.upper()}_H",
            f"#define SADDLE_CONFIG_{stem.upper()}_H",
            "",
            "#include <saddlewalk/saddlewalk.h>",
            "",
            f"static inline saddle_config_t saddle_config_{stem}(void)",
            "{",
            f"    saddle_config_t config = saddle_config_default({body});",
            *(f"    config.{name} = {_c_value(name, v)};" for name, v in fields_of(fits).items()),
            "    return config;",
            "}",
            "",
            "#endif",
            "",
        ]
    )


def _origin(sources: Sequence[str]) -> list[str]:
    """The sources, as comment lines; file names without slashes cannot end a comment."""
    plain = [re.sub(r"[^ -~]", "?", source) for source in sources]
    return [f"Fitted by saddlewalk calibrate {__version__} to:", *plain]


def _how_known(fit: Fit) -> str:
    known = [
        f"{fit.steps} step{'s' * (fit.steps != 1)}" if fit.steps else "not fitted",
        "" if math.isnan(fit.r2) else f"R2 {fit.r2:.2f}",
        fit.note,
    ]
    return f"{fit.quantity}: {', '.join(text for text in known if text)}"


def _toml_value(name: str, value: float) -> str:
    return f'"{_ankle(value)}"' if name == "ankle" else _number(value)


def _c_value(name: str, value: float) -> str:
    return f"SADDLE_ANKLE_{_ankle(value).upper()}" if name == "ankle" else f"{_number(value)}f"


def _ankle(number: float) -> str:
    return next(name for name, value in ANKLES.items() if value == number)


def _number(value: float) -> str:
    """Six digits, always with a point."""
    text = f"{value:.6g}"
    return text if re.search(r"[.e]", text) else f"{text}.0"
