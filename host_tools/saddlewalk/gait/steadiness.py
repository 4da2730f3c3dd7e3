"""Checks that a recording is one steady straight walk, as the gait model's fit needs.

Limits leave room for children, patients and short trials. Sixteen recorded walks of adults and
children, over ground and on treadmills, one ending in a turn on the spot, have (2026): step lengths
that scatter by up to 26 % of their mean, widths by 0.11 m, speeds of strides by 5 %, a path that
turns by 15 degrees, feet that point 23 degrees off it in the median, and never both feet more than
0.024 m above the ground.
"""

from collections.abc import Iterator

import numpy as np

from saddlewalk.gait.events import FootEvents, Placement, step_pairs, steps
from saddlewalk.gait.recording import Recording

LENGTH_SCATTER = 0.5  # standard deviation of the step lengths, of their mean
WIDTH_SCATTER_M = 0.16
SPEED_SCATTER = 0.35  # of the strides, of their mean
CHORD_M = 1.0  # the path's direction is measured on chords longer than the sway of a stride
TURN_DEG = 30.0
AIRBORNE_M = 0.06  # both feet this much above their standing height
AIRBORNE_S = 0.05
ASKEW_DEG = 60.0  # median angle of flat feet to the direction of walking
SAMPLES_TO_STAND = 5.0  # percentile of a foot's height that counts as its standing height
FEWEST = 2


def unsteady(
    recording: Recording, events: tuple[FootEvents, FootEvents], placed: list[Placement]
) -> list[str]:
    """Reasons why it is not a steady walk, with numbers and limits; empty if it is."""
    return [
        *_airborne(recording),
        *_turning(recording),
        *_askew(recording, placed),
        *_scattered_steps(placed),
        *_changing_speed(recording, events),
    ]


def _airborne(recording: Recording) -> Iterator[str]:
    """Time with both feet in the air. Needs toes: a rising heel alone would look like a foot in the
    air.
    """
    lowest_m = np.minimum(recording.heel_m[..., 2], recording.toe_m[..., 2])
    known = np.isfinite(lowest_m).all(axis=0)
    if not known.any():
        return
    stand_m = np.percentile(lowest_m[:, known], SAMPLES_TO_STAND, axis=1)[:, None]
    both_m = np.where(known, (lowest_m - stand_m).min(axis=0), 0.0)
    time_s = np.gradient(recording.time_s)[both_m > AIRBORNE_M].sum()
    if time_s > AIRBORNE_S:
        yield (
            f"both feet are in the air for {time_s:.2f} s, up to {both_m.max():.2f} m above where "
            f"they stand (over {AIRBORNE_M:g} m for at most {AIRBORNE_S:g} s)"
        )


def _turning(recording: Recording) -> Iterator[str]:
    """Turn of the CoM's path, measured on chords of CHORD_M; a shorter path has no direction."""
    path_m = recording.com_m[np.isfinite(recording.com_m[:, :2]).all(axis=1), :2]
    headings_rad, end = [], 0
    for start in range(len(path_m)):
        while end < len(path_m) and np.linalg.norm(path_m[end] - path_m[start]) < CHORD_M:
            end += 1
        if end == len(path_m):
            break
        headings_rad.append(np.arctan2(*(path_m[end] - path_m[start])[::-1]))
    if not headings_rad:
        return
    turn_deg = float(np.degrees(np.ptp(np.unwrap(headings_rad))))
    if turn_deg > TURN_DEG:
        yield f"the path turns by {turn_deg:.0f} degrees (at most {TURN_DEG:g})"


def _askew(recording: Recording, placed: list[Placement]) -> Iterator[str]:
    """Angle of the feet to x, the direction of walking. A foot with one point has no direction."""
    feet_m = np.array(
        [
            np.median((recording.toe_m - recording.heel_m)[p.side, p.first : p.end, :2], axis=0)
            for p in placed
        ]
    ).reshape(-1, 2)
    angles_deg = np.degrees(np.abs(np.arctan2(feet_m[:, 1], feet_m[:, 0])))
    if len(angles_deg) and np.median(angles_deg) > ASKEW_DEG:
        yield (
            f"the feet point {np.median(angles_deg):.0f} degrees off x, the forward direction "
            f"(at most {ASKEW_DEG:g})"
        )


def _scattered_steps(placed: list[Placement]) -> Iterator[str]:
    if len(step_pairs(placed)) < FEWEST:
        return
    lengths_m, widths_m = steps(placed)
    mean_m, scatter_m = float(lengths_m.mean()), float(lengths_m.std())
    if scatter_m > LENGTH_SCATTER * abs(mean_m):
        yield (
            f"step lengths scatter by {1e3 * scatter_m:.0f} mm about {1e3 * mean_m:.0f} mm "
            f"(at most {100 * LENGTH_SCATTER:.0f} %)"
        )
    if widths_m.std() > WIDTH_SCATTER_M:
        yield (
            f"step widths scatter by {1e3 * widths_m.std():.0f} mm about "
            f"{1e3 * widths_m.mean():.0f} mm (at most {1e3 * WIDTH_SCATTER_M:.0f} mm)"
        )


def _changing_speed(recording: Recording, events: tuple[FootEvents, FootEvents]) -> Iterator[str]:
    speeds_m_s = np.concatenate(
        [
            np.diff(recording.com_m[foot.heel_strikes, 0])
            / np.diff(recording.time_s[foot.heel_strikes])
            for foot in events
        ]
    )
    if len(speeds_m_s) < FEWEST:
        return
    mean_m_s, scatter_m_s = float(speeds_m_s.mean()), float(speeds_m_s.std())
    if scatter_m_s > SPEED_SCATTER * abs(mean_m_s):
        yield (
            f"speeds of the strides scatter by {scatter_m_s:.2f} m/s about {mean_m_s:.2f} m/s "
            f"(at most {100 * SPEED_SCATTER:.0f} %)"
        )
