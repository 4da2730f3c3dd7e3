"""Heel strikes, toe-offs, contacts and steps of a recorded walk.

Heel strikes are where a heel is farthest ahead of the CoM and toe-offs where a toe is farthest
behind it (Zeni, Richards & Higginson 2008, Gait & Posture 27:710). Steps are measured between foot
placements, where a foot lies flat: at heel strike and toe-off itself the midpoint of heel and toe
is up to a tenth of a step away from where the foot stands.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from saddlewalk.gait.recording import Recording

REVERSAL_M = 0.1  # a heel or toe that moves back by less does not begin or end a step
FIRST_RISE_M = 0.01  # a smaller rise before the first maximum may be the start of the trial
FLAT_SPEED_M_S = 0.25  # the CoP of a flat foot moves slower than this, over FLAT_WINDOW_S
FLAT_WINDOW_S = 0.1
FLAT_DURATION_S = 0.1  # and for at least this long


@dataclass(frozen=True)
class FootEvents:
    """Events of a foot as ascending sample indices."""

    heel_strikes: np.ndarray
    toe_offs: np.ndarray


@dataclass(frozen=True)
class Placement:
    """A foot that lay flat from sample `first` to before `end`, and its CoP."""

    side: int
    first: int
    end: int
    cop_m: np.ndarray  # (2,)


@dataclass(frozen=True)
class Gait:
    """Measures of a recorded walk. NaN: the trial has too few steps."""

    events: tuple[FootEvents, FootEvents]
    contact: np.ndarray  # (2, n) bool
    speed_m_s: float  # of the CoM from the first heel strike to the last
    step_lengths_m: np.ndarray  # one per step: AP distance between successive placements
    step_widths_m: np.ndarray  # left minus right; below 0 the feet cross

    @property
    def step_length_m(self) -> float:
        return _mean(self.step_lengths_m)

    @property
    def step_width_m(self) -> float:
        return _mean(self.step_widths_m)


def analyse(recording: Recording) -> Gait:
    """Events, contacts and steps of a trial in which the walker moves forward along x."""
    events = (foot_events(recording, 0), foot_events(recording, 1))
    placed = placements(recording)
    lengths_m, widths_m = steps(placed)
    return Gait(
        events=events,
        contact=contact(len(recording.time_s), events, placed),
        speed_m_s=mean_speed(recording, events),
        step_lengths_m=lengths_m,
        step_widths_m=widths_m,
    )


def foot_events(recording: Recording, side: int) -> FootEvents:
    com_x_m = recording.com_m[:, 0]
    heel_m = recording.heel_m[side, :, 0] - com_x_m
    toe_m = recording.toe_m[side, :, 0] - com_x_m
    return FootEvents(heel_strikes=_peaks(heel_m), toe_offs=_peaks(-toe_m))


def contact(
    samples: int, events: tuple[FootEvents, FootEvents], placed: list[Placement]
) -> np.ndarray:
    """(2, samples): a foot is on the ground from heel strike to toe-off, and while it lies flat.

    The second clause is for a walker who stops: the last heel does not fall back from the CoM.
    """
    on_ground = np.stack([_between_events(samples, foot) for foot in events])
    for placement in placed:
        on_ground[placement.side, placement.first : placement.end] = True
    return on_ground


def mean_speed(recording: Recording, events: tuple[FootEvents, FootEvents]) -> float:
    """AP speed of the CoM from the first heel strike of either foot to the last."""
    strikes = np.concatenate([foot.heel_strikes for foot in events])
    if len(strikes) < 2:
        return np.nan
    ends = [strikes.min(), strikes.max()]
    return float(np.diff(recording.com_m[ends, 0])[0] / np.diff(recording.time_s[ends])[0])


def placements(recording: Recording) -> list[Placement]:
    """All placements of the feet, in order of time."""
    found = []
    for side, cop_m in enumerate(recording.cop_m):
        for first, end in _runs(_flat(recording.time_s, cop_m)):
            if recording.time_s[end - 1] - recording.time_s[first] >= FLAT_DURATION_S:
                found.append(Placement(side, first, end, np.median(cop_m[first:end], axis=0)))
    return sorted(found, key=lambda placement: placement.first + placement.end)


def step_pairs(placed: list[Placement]) -> list[tuple[Placement, Placement]]:
    """Each step as two successive placements of opposite feet.

    A foot on the ground when the trial begins did not make a recorded step.
    """
    return [(a, b) for a, b in itertools.pairwise(placed) if a.side != b.side and b.first > 0]


def steps(placed: list[Placement]) -> tuple[np.ndarray, np.ndarray]:
    """Length and width of each step of step_pairs()."""
    pairs = step_pairs(placed)
    lengths_m = [b.cop_m[0] - a.cop_m[0] for a, b in pairs]
    widths_m = [(a.cop_m[1] - b.cop_m[1]) * (1 if a.side == 0 else -1) for a, b in pairs]
    return np.array(lengths_m), np.array(widths_m)


def passing(recording: Recording, foot: Placement) -> tuple[int, float] | None:
    """When the CoM passes a foot: the first sample past it, and the interpolated time.

    None if the trial begins later or ends before.
    """
    past = np.flatnonzero(recording.com_m[:, 0] >= foot.cop_m[0])
    if not len(past) or past[0] == 0:
        return None
    pair = slice(past[0] - 1, past[0] + 1)
    time_s = np.interp(foot.cop_m[0], recording.com_m[pair, 0], recording.time_s[pair])
    return int(past[0]), float(time_s)


def _between_events(samples: int, foot: FootEvents) -> np.ndarray:
    order = sorted(
        [(index, True) for index in foot.heel_strikes] + [(index, False) for index in foot.toe_offs]
    )
    on_ground = np.full(samples, not order[0][1] if order else True)
    for index, lands in order:
        on_ground[index:] = lands
    return on_ground


def _peaks(signal_m: np.ndarray) -> np.ndarray:
    """Maxima with a rise before and a fall after of at least REVERSAL_M.

    A trial may begin late in a swing, so FIRST_RISE_M is enough for the first. Missing samples are
    skipped.
    """
    peaks, best, trough_m, rise_m = [], None, np.inf, FIRST_RISE_M
    for index in np.flatnonzero(np.isfinite(signal_m)):
        value_m = signal_m[index]
        if best is None:
            trough_m = min(trough_m, value_m)
            if value_m - trough_m >= rise_m:
                best = index
        elif value_m > signal_m[best]:
            best = index
        elif signal_m[best] - value_m >= REVERSAL_M:
            peaks.append(best)
            best, trough_m, rise_m = None, value_m, REVERSAL_M
    return np.array(peaks, dtype=int)


def _flat(time_s: np.ndarray, cop_m: np.ndarray) -> np.ndarray:
    """Whether a foot's CoP is measured and hardly moves over FLAT_WINDOW_S, or two samples if
    longer.
    """
    index = np.arange(len(time_s))
    half_s = FLAT_WINDOW_S / 2 + 1e-9
    first = np.minimum(np.searchsorted(time_s, time_s - half_s), np.maximum(index - 1, 0))
    last = np.maximum(np.searchsorted(time_s, time_s + half_s) - 1, index + 1)
    last = np.minimum(last, len(time_s) - 1)
    speed_m_s = (cop_m[last, 0] - cop_m[first, 0]) / (time_s[last] - time_s[first])
    return np.isfinite(cop_m).all(axis=1) & (np.abs(speed_m_s) < FLAT_SPEED_M_S)


def _runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """First index and end (one past the last) of each run of True."""
    edges = np.flatnonzero(np.diff(flags, prepend=False, append=False))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if len(values) else np.nan
