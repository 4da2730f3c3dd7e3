"""The build backend: hatchling's, and for a wheel also what compiles the firmware.

An editable install takes the firmware from the checkout's build folder, so it needs none of that.
"""

from typing import Any

import hatchling.build
from hatchling.build import (
    build_editable,
    build_sdist,
    build_wheel,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
)

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
]

COMPILES = ["cantools==45.1.0", "cmake==4.4.4", "lcm==1.5.3", "ninja==1.13.2", "pip"]


def get_requires_for_build_wheel(config_settings: dict[str, Any] | None = None) -> list[str]:
    return [*hatchling.build.get_requires_for_build_wheel(config_settings), *COMPILES]
