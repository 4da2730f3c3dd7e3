"""Where the built firmware is, and the sources that the tools read: in the checkout that this
package lies in or, if it was installed from a wheel, in its own folder `shipped`.

In a checkout SADDLEWALK_BUILD names the build folder, in it or absolute; else it is `build`.
"""

import os
from pathlib import Path

from saddlewalk.errors import UserError

PACKAGE = Path(__file__).resolve().parent
CHECKOUT = PACKAGE.parents[1]
SHIPPED = PACKAGE / "shipped"  # as hatch_build.py lays it


def in_checkout() -> bool:
    return not SHIPPED.is_dir()


def build_dir() -> Path:
    """The CMake build folder; it need not exist yet."""
    if not in_checkout():
        return SHIPPED / "build"
    return CHECKOUT / (os.environ.get("SADDLEWALK_BUILD") or "build")


def source(relative: str) -> Path:
    """A file or folder of the checkout that comes with the wheel too."""
    return (CHECKOUT if in_checkout() else SHIPPED) / relative


def install_command(extra: str) -> str:
    """The command that installs the optional dependencies `extra`."""
    if in_checkout():
        return f"run `.venv/bin/pip install -e '.[{extra}]'` in the checkout"
    return f"run `pip install 'saddlewalk[{extra}]'`"


def built(relative: str) -> Path:
    """The absolute path of a build product, such as `bin/saddlewalk-host`.

    Raises UserError, naming the product and the command that makes it, if it isn't there.
    """
    path = build_dir().absolute() / relative
    if path.exists():
        return path
    if not in_checkout():
        raise UserError(f"{relative} does not come with the wheel: use a checkout of the project")
    if not (CHECKOUT / "CMakeLists.txt").is_file():
        raise UserError(f"{PACKAGE} is a copy of the sources: install the package by pip")
    raise UserError(f"{path} is missing: run `make build` in {CHECKOUT}")
