"""The ripple of a recorded walker's CoM velocity, as the core learns it, [E32]."""

import math

from saddlewalk.config import configuration
from saddlewalk.contract import TICK_S
from saddlewalk.core import Command
from saddlewalk.gait.events import analyse
from saddlewalk.gait.recording import Recording
from saddlewalk.gait.states import state_at
from saddlewalk.recorded_states import measurement_of, recording_core

SHORTEST_S = 1.0  # shortest usable recording: about two steps


def learned_ripple(recording: Recording) -> float:
    """saddle_learned_walk_t.ripple at the end of the recording; NaN if that is too short."""
    since_s = recording.time_s - recording.time_s[0]
    if since_s[-1] < SHORTEST_S:
        return math.nan
    gait, core = analyse(recording), recording_core(configuration({}))
    ripple, next_s = math.nan, 0.0
    for index, time_s in enumerate(map(float, since_s)):
        if time_s >= next_s:
            state = state_at(recording, gait.contact, index, time_s)
            measured = measurement_of(recording.source, state)
            ripple = core.tick(round(time_s * 1e6), Command(), measured).walk.ripple
            next_s += TICK_S
    return ripple
