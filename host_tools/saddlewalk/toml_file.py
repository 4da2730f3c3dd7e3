"""TOML files that a user gives."""

import tomllib
from pathlib import Path
from typing import Any

from saddlewalk.errors import UserError


def read_toml(path: Path, option: str = "") -> dict[str, Any]:
    """Its tables. Raises UserError naming the file, and `option` if it cannot be read."""
    try:
        return tomllib.loads(path.read_text())
    except OSError as error:
        raise UserError(f"{option} {path}: {error.strerror}".strip()) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UserError(f"{path}: not TOML: {error}") from error
