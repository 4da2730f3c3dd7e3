"""Where the built firmware is: the environment's SADDLEWALK_BUILD, else `build` in the checkout."""

import os
from pathlib import Path

from saddlewalk.errors import UserError

CHECKOUT = Path(__file__).resolve().parents[2]


def build_dir() -> Path:
    """The CMake build folder; it need not exist yet."""
    return Path(os.environ.get("SADDLEWALK_BUILD") or CHECKOUT / "build")


def built(relative: str) -> Path:
    """The absolute path of a build product, such as `bin/saddlewalk-host`.

    Raises UserError, naming the product and the command that makes it, if it isn't there.
    """
    path = build_dir().absolute() / relative
    if not path.exists():
        raise UserError(f"{path} is missing: run `make build` in {CHECKOUT}")
    return path
