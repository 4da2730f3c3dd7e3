"""Which push a body survives half of the time, walked by joint commands on CAN.

Each direction is a staircase (Dixon and Mood 1948): the next push is harder if the body stayed up,
and weaker if it fell, so that the pushes gather where half are survived. The firmware runs in this
process.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from saddlewalk import core
from saddlewalk.emulation.wearer import Push
from saddlewalk.faults.joint_campaign import RATE_HZ, FaultyFirmware
from saddlewalk.physics.joint_chain import START_S, STARTS_AND_STOPS_S, Course, walk
from saddlewalk.workers import Workers, run_tasks

DIRECTIONS = {"forward": 0.0, "left": 90.0, "back": 180.0, "right": -90.0}
FIRST_N_S, STEP_N_S = 24.0, 4.0
SETTLING = 4  # walks of a staircase that only find the place
PUSHED_S = (START_S + 2.5, START_S + 3.5)  # somewhere in a stride
AFTER_S = 3.0  # from the latest push to the end


def staircase(direction: str, walks: int, speed_m_s: float, seed: int, image: bytes) -> list[float]:
    """The impulse in N s that half survive: the mean of the staircase, but for its first walks."""
    config = core.config_from(image)
    impulse_n_s, tried = FIRST_N_S, []
    for number in range(walks):
        random = np.random.default_rng([seed, number])
        push = Push(impulse_n_s, float(random.uniform(*PUSHED_S)), DIRECTIONS[direction])
        course = Course(
            speed_m_s,
            (PUSHED_S[1] + AFTER_S - START_S - STARTS_AND_STOPS_S) * speed_m_s,
            RATE_HZ,
            int(random.integers(2**32)),
            stopping_s=0.0,
            push=push,
        )
        fell = walk(FaultyFirmware(config, [], random), config, course).fell
        tried.append(impulse_n_s)
        impulse_n_s = max(impulse_n_s + (-STEP_N_S if fell else STEP_N_S), STEP_N_S)
    return [float(np.mean([*tried[SETTLING:], impulse_n_s]))]


def survived(
    walks: int,
    speed_m_s: float,
    seed: int,
    config: Any,
    workers: Workers,
    progress: Callable[[int], None],
) -> dict[str, float]:
    """By direction, the impulse that half survive, of `walks` walks each; progress(directions)."""
    image = core.config_bytes(config)
    tasks = [(direction, walks, speed_m_s, seed, image) for direction in DIRECTIONS]
    return dict(zip(DIRECTIONS, run_tasks(staircase, tasks, workers, progress), strict=True))
