"""Where the built firmware is: SADDLEWALK_BUILD, a folder in the checkout or an absolute path, else
`build`.
"""

import os
from pathlib import Path

from saddlewalk.errors import UserError

CHECKOUT = Path(__file__).resolve().parents[2]


def build_dir() -> Path:
    """The CMake build folder; it need not exist yet."""
    return CHECKOUT / (os.environ.get("SADDLEWALK_BUILD") or "build")


def need_checkout() -> None:
    """Raise UserError if this package is a copy without its checkout, as from `pip install .`.

    Its firmware, DBC and LCM types are those of the checkout.
    """
    if not (CHECKOUT / "CMakeLists.txt").is_file():
        raise UserError(
            "this is a copy of the package without its checkout: "
            "run `.venv/bin/pip install -e .` in the checkout, with -e"
        )


def install_command(extra: str) -> str:
    """The command that installs the optional dependencies `extra`, editable."""
    return f"run `.venv/bin/pip install -e '.[{extra}]'` in the checkout"


def built(relative: str) -> Path:
    """The absolute path of a build product, such as `bin/saddlewalk-host`.

    Raises UserError, naming the product and the command that makes it, if it isn't there.
    """
    need_checkout()
    path = build_dir().absolute() / relative
    if not path.exists():
        raise UserError(f"{path} is missing: run `make build` in {CHECKOUT}")
    return path
