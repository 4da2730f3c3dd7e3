"""Marker positions from a C3D file, by ezc3d.

In a process of its own, with bounded memory and time: ezc3d may crash its process on a damaged
file. Bounds follow from the file's size; a sound file takes 13 bytes of memory and 30 ns for each
of its bytes (float data, ezc3d 1.7.2, 2026).
"""

import importlib.util
import math
import multiprocessing
import re
import resource
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from saddlewalk.errors import UserError
from saddlewalk.gait.c3d_layout import check_layout
from saddlewalk.gait.capture import Capture, unit_of
from saddlewalk.paths import install_command

LEAST_MEMORY, MEMORY_A_BYTE = 256 << 20, 60  # bytes
LEAST_CPU_S, CPU_A_BYTE_S = 10.0, 2e-6


@dataclass(frozen=True)
class _Limits:
    memory: int  # bytes, in addition to what the process has mapped
    cpu_s: float


def read_c3d(path: Path) -> Capture:
    """Raises UserError naming the file and what is wrong in it."""
    if importlib.util.find_spec("ezc3d") is None:
        raise UserError(f"{path}: C3D needs ezc3d: {install_command('c3d')}")
    if not path.is_file():
        raise UserError(f"{path}: no such file")
    check_layout(path)
    limits = _limits(path)
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as reader:
        try:
            return reader.submit(_parse, path, limits).result()
        except BrokenProcessPool as error:
            raise UserError(
                f"{path}: not a C3D file: ezc3d crashed on it or took more than "
                f"{limits.cpu_s:.0f} s or {limits.memory / 1e6:.0f} MB"
            ) from error


def _limits(path: Path) -> _Limits:
    size = path.stat().st_size
    return _Limits(LEAST_MEMORY + MEMORY_A_BYTE * size, LEAST_CPU_S + CPU_A_BYTE_S * size)


def _parse(path: Path, limits: _Limits) -> Capture:
    import ezc3d

    _limit_this_process(limits)
    try:
        trial = ezc3d.c3d(str(path))
        point = trial["parameters"]["POINT"]
        names = [name for key in _label_keys(point) for name in point[key]["value"]]
        rate_hz = float(point["RATE"]["value"][0])
        points = trial["data"]["points"][:3]
        unseen = trial["data"]["meta_points"]["residuals"][0] < 0
    except (OSError, RuntimeError, ValueError, KeyError, IndexError, MemoryError) as error:
        raise UserError(f"{path}: not a C3D file with markers: {error}") from error
    if not 1 <= rate_hz < math.inf:
        raise UserError(f"{path}: POINT:RATE {rate_hz:g} must be a rate in Hz, 1 or more")
    points = np.where(unseen | ~points.any(axis=0), np.nan, points)
    return Capture(
        time_s=np.arange(points.shape[2]) / rate_hz,
        markers={name: points[:, i].T for i, name in enumerate(names[: points.shape[1]])},
        unit=_unit(path, point),
    )


def _limit_this_process(limits: _Limits) -> None:
    """The memory mapped now plus the bound: the interpreter maps more than it uses."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    used_s = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    for kind, most in (
        (resource.RLIMIT_AS, pages * resource.getpagesize() + limits.memory),
        (resource.RLIMIT_CPU, used_s + limits.cpu_s),
    ):
        hard = resource.getrlimit(kind)[1]
        soft = int(most) if hard == resource.RLIM_INFINITY else min(int(most), hard)
        resource.setrlimit(kind, (soft, hard))


def _unit(path: Path, point: Mapping[str, Any]) -> str:
    """The unit of the points; empty if POINT:UNITS is missing or empty."""
    texts = point["UNITS"]["value"] if "UNITS" in point else []
    text = str(texts[0]) if len(texts) else ""
    return unit_of(path, text) if text.strip().strip("\0") else ""


def _label_keys(point: Mapping[str, Any]) -> list[str]:
    """LABELS holds 255 names, LABELS2 and so on further ones."""
    return sorted(
        (key for key in point if re.fullmatch(r"LABELS\d*", key)), key=lambda k: (len(k), k)
    )
