"""How hard a push does an emulated wearer survive at 1 m/s, from each side?

usage: push_limit.py [FIELD=VALUE ...]

FIELD: of saddle_config_t, such as body_height_m=1.6. One seed, one time of the push: for figures
take many, as `saddlewalk evaluate` does.
"""

import sys

from saddlewalk.config import configuration
from saddlewalk.emulation.closed_loop import walk
from saddlewalk.emulation.wearer import Body, Push, Wearer
from saddlewalk.planning.schedule import schedule_of

PUSHED_S, OVER_S = 5.0, 8.0
FROM = {"behind": 0.0, "the right": 90.0, "the front": 180.0, "the left": -90.0}

config = configuration({name: float(value) for name, value in (a.split("=") for a in sys.argv[1:])})


def survives(impulse_n_s: float, direction_deg: float) -> bool:
    push = Push(impulse_n_s, PUSHED_S, direction_deg)
    wearer = Wearer(Body.of(config), pushes=(push,))
    for tick in walk(config, wearer, schedule_of([(0.0, 1.0)], heel_strike_rad=0.17)):
        if wearer.fallen or tick.time_s > OVER_S:
            break
    return not wearer.fallen


for side, direction_deg in FROM.items():
    survived_n_s, fatal_n_s = 0.0, 64.0
    while fatal_n_s - survived_n_s > 2.0:
        middle_n_s = (survived_n_s + fatal_n_s) / 2
        if survives(middle_n_s, direction_deg):
            survived_n_s = middle_n_s
        else:
            fatal_n_s = middle_n_s
    print(f"from {side:9}  {survived_n_s:4.0f} N s")
