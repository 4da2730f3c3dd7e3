# %% [markdown]
# # Saddlewalk from Python
#
# The C core in this process, by its own structs: what `saddle_tick()` gives a controller. Run it
# as a script, or cell by cell in an editor that knows `# %%`. Lengths in m, x forward, y left.

# %% Plan a walk
# `saddle_join()` begins in a steady walk; each tick, 80 ms later, gives the plan.
import sys
from collections import Counter
from pathlib import Path

import numpy as np

from saddlewalk.config import configuration
from saddlewalk.contract import LEVELS, TICK_S
from saddlewalk.core import Command, Core, Measurement
from saddlewalk.logs.messages import decode
from saddlewalk.transport.lcm_log import LcmLog

config = configuration({"body_height_m": 1.68, "body_mass_kg": 55.0})  # the rest: defaults
walk = Command(speed_m_s=1.1, heel_strike_rad=0.17)
core = Core(config)
core.join(walk)
for tick in range(4):
    plan = core.tick(round(tick * TICK_S * 1e6), walk, Measurement()).plan
    com, left = plan.com_m, plan.foot_m[0]
    print(f"{tick * TICK_S:.2f} s  CoM {com.x:6.3f} {com.y:6.3f} {com.z:6.3f}  left {left.x:6.3f}")

# %% Between two ticks
# A joint controller that is faster asks for any time since the last tick.
plan = core.plan_at(round(3.5 * TICK_S * 1e6))
print(f"0.28 s  CoM {plan.com_m.x:6.3f}  CoP to balance by {plan.reference.cop_m.x:6.3f}")

# %% Score a state
# A person stands and sways to the left: from which speed on do the ankles alone not stop it?
for speed_m_s in (0.0, 0.2, 0.4, 0.6):
    state = Measurement(
        com_height_m=0.95,
        com_velocity_m_s=(0.0, speed_m_s),
        left_cop_m=(0.0, 0.1),  # from the CoM
        right_cop_m=(0.0, -0.1),
        left_contact=True,
        right_contact=True,
    )
    output = Core(config).tick(0, Command(speed_m_s=None), state)
    margin_m, stops = output.scores.mos_xcom_m, output.scores.can_stop
    print(f"{speed_m_s:.1f} m/s to the left: XCoM in base {margin_m:6.3f} m, can stop: {stops}")

# %% Read a log
# Each message of an LCM log, here of `saddlewalk demo`, has the members of its type in lcm_types/.
log = Path(sys.argv[1] if len(sys.argv) > 1 else "out/demo/walk.lcmlog")
messages = [(event.channel, decode(event)) for event in LcmLog(log)]
speed_m_s = np.array([m.speed_m_s for channel, m in messages if channel == "SADDLEWALK_PLAN"])
margin = np.array([m.margin for channel, m in messages if channel == "SADDLEWALK_BALANCE"])
levels = Counter(LEVELS[m.level] for channel, m in messages if channel == "SADDLEWALK_VERDICT")
print(f"{len(speed_m_s)} plans, at most {speed_m_s.max():.2f} m/s")
print(f"least margin {np.nanmin(margin):.2f}; ticks by level: {dict(levels)}")

# %% [markdown]
# For pandas: `saddlewalk export LOG --format parquet --out FOLDER` writes a table for each channel,
# which `pandas.read_parquet()` reads.
