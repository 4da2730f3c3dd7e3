"""The paper's plan in GNU Octave, which reads Matlab's language: plan_walk.m, timed by Octave."""

import shutil
import subprocess
import weakref
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from saddlewalk.benchmark.baselines import MissingError

SCRIPT = Path(__file__).with_name("plan_walk.m")
ROWS = (
    "com_x_m com_y_m com_z_m com_vx_m_s com_vy_m_s left_x_m left_y_m left_z_m right_x_m right_y_m "
    "right_z_m leg_length_m theta_to_rad theta_hs_rad s_pend s_jump s_sw mos_com_m mos_xcom_m "
    "gravity_x_n gravity_y_n"
).split()


def _end(process: subprocess.Popen[str]) -> None:
    """Close its input, so that Octave exits by itself; if killed, it would leave a file behind."""
    assert process.stdin and process.stdout
    process.stdin.close()
    process.wait()
    process.stdout.close()


class Octave:
    """An Octave process that ends with this object."""

    def __init__(self) -> None:
        program = shutil.which("octave-cli")
        if program is None:
            raise MissingError("GNU Octave is not installed: apt install octave")
        self._process = subprocess.Popen(
            [program, "--norc", "--quiet", "--no-history"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        weakref.finalize(self, _end, self._process)
        self._ask(f"source('{SCRIPT}'); puts('ready')")

    def plan(
        self, speed_m_s: float, heel_strike_rad: float, t_s: Sequence[float]
    ) -> dict[str, list[float]]:
        """The plan at t_s, under the names of `saddlewalk plan`'s columns."""
        self._set_walk(speed_m_s, heel_strike_rad, t_s)
        text = self._ask("rows = plan_walk(speed, heel_strike, t); printf('%.17g ', rows')")
        return dict(zip(ROWS, np.array(text.split(), float).reshape(len(ROWS), -1), strict=True))

    def seconds(
        self, speed_m_s: float, heel_strike_rad: float, t_s: Sequence[float], at_once: bool
    ) -> float:
        """Time of one plan, by Octave's clock."""
        self._set_walk(speed_m_s, heel_strike_rad, t_s)
        call = "rows = plan_walk(speed, heel_strike, t);"
        if not at_once:
            call = "for k = 1:numel(t), row = plan_walk(speed, heel_strike, t(k)); end"
        return float(self._ask(f"began = tic; {call}; printf('%.9g', toc(began))"))

    def _set_walk(self, speed_m_s: float, heel_strike_rad: float, t_s: Sequence[float]) -> None:
        times = " ".join(f"{t:.17g}" for t in t_s)
        self._send(f"speed = {speed_m_s}; heel_strike = {heel_strike_rad}; t = [{times}];")

    def _send(self, statement: str) -> None:
        assert self._process.stdin
        self._process.stdin.write(f"{statement}\n")

    def _ask(self, statement: str) -> str:
        """Run a statement and return the line that it prints."""
        self._send(f"{statement}; printf('\\n'); fflush(stdout);")
        assert self._process.stdin and self._process.stdout
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line.strip():
            raise MissingError(f"GNU Octave cannot run {SCRIPT.name}")
        return line
