"""What a wheel has beside the Python package: the firmware, compiled, and sources that tools read.

saddlewalk/shipped/build is laid out like the CMake build folder, and saddlewalk/shipped like the
checkout; saddlewalk/paths.py finds them there.
"""

import os
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

TARGETS = (
    *("saddlewalk-host", "saddlewalk", "saddlewalk_firmware", "saddlewalk_bench"),
    *("saddlewalk-bench-calls", "saddlewalk-bench-updates", "lcm_types_python", "saddle_web"),
)
BUILT = (
    *("bin/saddlewalk-host", "bin/saddlewalk-bench-calls", "bin/saddlewalk-bench-updates"),
    *("lib/libsaddlewalk.so", "lib/libsaddlewalk_firmware.so", "lib/libsaddlewalk_bench.so"),
    *("saddlewalk_cdef.h", "saddlewalk_firmware_cdef.h", "saddlewalk_bench_cdef.h"),
    *("lcm/python", "web"),
)
SOURCES = (
    *("firmware/core/include", "firmware/wire/include", "firmware/wire/saddlewalk.dbc"),
    *("firmware/port_common/timing.h", "lcm_types", "examples", "docs/equations.md"),
)
LCM = "$ORIGIN/../../../../lib"  # where the lcm package lays its library, beside this package


class CompiledFirmware(BuildHookInterface):
    """Compiles the firmware for a wheel; an editable install uses the checkout's."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "editable":
            return
        self._folder = tempfile.TemporaryDirectory(prefix="saddlewalk-")
        build = Path(self._folder.name)
        self._compile(build)
        shipped = {build / name: f"build/{name}" for name in BUILT}
        shipped |= {Path(self.root) / name: name for name in SOURCES}
        for path, name in shipped.items():
            build_data["force_include"][str(path)] = f"saddlewalk/shipped/{name}"
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        if version != "editable":
            self._folder.cleanup()

    def _compile(self, build: Path) -> None:
        options = {
            "CMAKE_BUILD_TYPE": "Release",
            "CMAKE_C_FLAGS_RELEASE": "-O2",
            "CMAKE_BUILD_WITH_INSTALL_RPATH": "ON",
            "CMAKE_INSTALL_RPATH": LCM,
            "Python3_EXECUTABLE": sys.executable,
        }
        defined = [f"-D{name}={value}" for name, value in options.items()]
        configure = ["cmake", "-S", self.root, "-B", build, "-G", "Ninja", *defined]
        quiet = ["--log-level=WARNING"]
        for command in ([*configure, *quiet], ["cmake", "--build", build, "-t", *TARGETS]):
            subprocess.run(command, check=True, env={**os.environ, "DESTDIR": ""})
