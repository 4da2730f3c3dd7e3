"""Walks of the core as a laboratory would have recorded them, and the files that it would write."""

import functools
import itertools

import ezc3d
import numpy as np

from saddlewalk.config import ANKLES, configuration
from saddlewalk.core import Core
from saddlewalk.gait.recording import Recording
from saddlewalk.planning.schedule import SpeedChange
from saddlewalk.planning.schedule import walk as scheduled
from saddlewalk.planning.steady import walk as planned

PERSON = {
    "body_height_m": 1.62,
    "body_mass_kg": 55.0,
    "cop_range_m": 0.085,
    "step_width_slow_m": 0.162,
    "step_width_fast_m": 0.114,
    "step_width_slow_speed_m_s": 0.7,
    "step_width_fast_speed_m_s": 1.3,
    "step_width_slope_s": -0.08,
    "step_width_intercept_m": 0.218,
    "half_step_slope_s": 0.15,
    "half_step_intercept_m": 0.13,
    "vertical_slope_s": 0.03,
    "vertical_intercept_m": 0.004,
    "lateral_factor": 0.8,
    "step_length_factor_left": 1.04,
    "step_length_factor_right": 0.96,
}
RATE_HZ = 200

# Laboratory axes as rows of forward, left and up: x sideways and z up, or y up.
LABORATORIES = {
    "z up, walking along -y": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "y up, walking along x": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
}


def walk_of(fields: dict[str, float], speed_m_s: float, duration_s: float = 9.0) -> Recording:
    """The core's walk as if it had been recorded: heel and toe d_h behind and ahead of the CoP."""
    return recorded(tuple(fields.items()), speed_m_s, duration_s)


@functools.cache
def recorded(fields: tuple, speed_m_s: float, duration_s: float) -> Recording:
    config = configuration({**dict(fields), "ankle": ANKLES["cycloid"]})
    steady = planned(Core(config), speed_m_s, 10, 1 / RATE_HZ)
    return recording_of(config, itertools.islice(steady, round(duration_s * RATE_HZ)))


def walk_on_a_treadmill(duration_s: float) -> tuple[Recording, np.ndarray]:
    """A walk from standing to standing over the ground, and how far the belt ran under it."""
    config = configuration({"ankle": ANKLES["cycloid"]})
    changes = [SpeedChange(0, 0.0, 0.0), SpeedChange(0, 4.0, 1.0), SpeedChange(0, 15.0, 0.0)]
    belt_m_s = []

    def outputs():
        for instant in itertools.islice(
            scheduled(Core(config), changes, 0.0, 1 / RATE_HZ), round(duration_s * RATE_HZ)
        ):
            belt_m_s.append(instant.output.plan.speed_m_s)
            yield instant.t_s, instant.output

    recording = recording_of(config, outputs())
    return recording, np.cumsum(belt_m_s) / RATE_HZ


def recording_of(config, outputs) -> Recording:
    com_m, foot_m = [], ([], [])
    for time_s, output in outputs:
        plan, origin_m = output.plan, output.plan.origin_x_nm * 1e-9
        com_m.append((time_s, origin_m + plan.com_m.x, plan.com_m.y, plan.com_m.z))
        for side, foot in enumerate(plan.foot_m):
            foot_m[side].append((origin_m + foot.x, foot.y, foot.z))
    half_foot_m = np.array([config.cop_range_m, 0, 0])
    return Recording(
        source="a plan",
        time_s=np.array(com_m)[:, 0],
        com_m=np.array(com_m)[:, 1:],
        heel_m=np.array(foot_m) - half_foot_m,
        toe_m=np.array(foot_m) + half_foot_m,
    )


def laboratory(
    recording: Recording, rows: tuple, belt_m: float | np.ndarray = 0.0
) -> dict[str, np.ndarray]:
    """Plug-in Gait markers, (n, 3) in mm and the laboratory's axes; belt_m: its way so far."""
    back_m = np.outer(belt_m * np.ones_like(recording.time_s), (1, 0, 0))
    aside_m, ahead_m = np.array([0, 0.12, 0]), np.array([0.09, 0, 0])
    points_m = {
        "Ann:LASI": recording.com_m + ahead_m + aside_m,
        "Ann:RASI": recording.com_m + ahead_m - aside_m,
        "Ann:LPSI": recording.com_m - ahead_m + aside_m / 2,
        "Ann:RPSI": recording.com_m - ahead_m - aside_m / 2,
        "Ann:LHEE": recording.heel_m[0],
        "Ann:RHEE": recording.heel_m[1],
        "Ann:LTOE": recording.toe_m[0],
        "Ann:RTOE": recording.toe_m[1],
    }
    return {name: 1e3 * (xyz_m - back_m) @ np.array(rows) for name, xyz_m in points_m.items()}


def c3d_file(path, markers: dict[str, np.ndarray], unit: str = "mm") -> str:
    trial = ezc3d.c3d()
    point = trial["parameters"]["POINT"]
    point["RATE"]["value"] = [float(RATE_HZ)]
    point["UNITS"]["value"] = [unit]
    point["LABELS"]["value"] = list(markers)
    points = np.stack(list(markers.values()), axis=0).transpose(2, 0, 1)
    trial["data"]["points"] = np.concatenate([points, np.ones((1, *points.shape[1:]))])
    trial.write(str(path))
    return str(path)


def trc_file(path, markers: dict[str, np.ndarray]) -> str:
    table = np.concatenate(list(markers.values()), axis=1)
    frames = [
        "\t".join([str(i + 1), f"{i / RATE_HZ:.4f}", *("" if x != x else f"{x:.5f}" for x in row)])
        for i, row in enumerate(table)
    ]
    head = [
        f"PathFileType\t4\t(X/Y/Z)\t{path.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate",
        f"{RATE_HZ}\t{RATE_HZ}\t{len(table)}\t{len(markers)}\tmm\t{RATE_HZ}",
        "Frame#\tTime\t" + "\t\t\t".join(markers),
        "\t\t" + "\t".join(f"{axis}{i + 1}" for i in range(len(markers)) for axis in "XYZ"),
        "",
    ]
    path.write_text("\n".join([*head, *frames, ""]))
    return str(path)


WRITERS = {"c3d": c3d_file, "trc": trc_file}
