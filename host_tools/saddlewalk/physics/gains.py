"""Every number that was tuned to make a body walk."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Gains:
    """Found by trial on the body of body.winter() at 0.3 to 1.8 m/s, November 2026, and then used
    for every body. Stiffnesses in 1/s2, dampings in 1/s, weights of the least squares of
    accelerations.
    """

    com_weight: float = 200.0
    height_weight: float = 12.0
    height_stiffness: float = 80.0
    height_damping: float = 18.0
    height_filter_rad_s: float = 12.0  # of the planned height, which may jump
    upright_weight: float = 1.0
    upright_stiffness: float = 150.0
    upright_damping: float = 25.0

    swing_weight: float = 10.0
    swing_stiffness: float = 400.0
    swing_damping: float = 40.0
    sole_weight: float = 2.0  # orientation of a foot in the air
    sole_stiffness: float = 300.0
    sole_damping: float = 30.0
    stance_weight: float = 100.0
    stance_damping: float = 40.0
    stance_height_stiffness: float = 200.0
    heel_off_weight: float = 0.3  # pitch of a foot on its toes

    knee_bend_min_rad: float = 0.10  # the knee turns back before it is straight
    knee_stiffness: float = 400.0
    knee_damping: float = 40.0
    friction: float = 0.6  # asked of the floor, which has more
    acceleration_weight: float = 1e-3  # makes the optimum unique, here and below
    force_weight: float = 1e-6

    step_gain: float = 1.5  # by which the landing follows an error of the XCoM
    landing_frozen_s: float = 0.06  # before it, the landing stays
    detour_filter_rad_s: float = 20.0  # of a landing that moves
    lift_off_share: float = 0.6  # of a swing, in which the place of the lift-off fades
    pitch_time_s: float = 0.04  # of a foot's pitch in the air
    sole_rise_max_m: float = 0.006  # by which a pitched foot swings higher, to land on time
    feed_forward: float = 0.6  # filter of the swing's acceleration, of a step of the control
    swing_acceleration_max_m_s2: float = 60.0
    reach_down_m_s: float = 0.3  # of a foot that should have landed and has not
    reach_down_m: float = 0.01

    landed_n: float = 20.0  # load of a foot that has landed when planned
    early_max_s: float = 0.12
    lifted_n: float = 10.0  # load of a foot that may leave the ground
    lifted_s: float = 0.015  # once it was so light for so long
    carrying_n: float = 200.0  # and the other foot carries so much
    trailing_reserve: float = 1.2  # the trailing foot's load may exceed its share by this factor
    trailing_share_min: float = 0.02
