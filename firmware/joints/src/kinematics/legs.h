/** What the segments and ranges of a body come to on one side. */
#ifndef SADDLEWALK_LEGS_H
#define SADDLEWALK_LEGS_H

#include <saddlewalk/joints.h>

/** Total mass. */
float saddle_legs_mass_kg(const saddle_legs_t *legs);

/** The range of a joint on that side: mirrored on the right for yaw and roll. */
saddle_joint_range_t saddle_joint_range(const saddle_legs_t *legs, saddle_side_t side,
                                        unsigned joint);

/** From the middle of the sole forward to that point of it; 0 for a point that there is not. */
float saddle_sole_point_m(const saddle_legs_t *legs, uint8_t point);

#endif
