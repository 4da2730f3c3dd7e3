/** The joints of one leg from where trunk and foot should be. */
#ifndef SADDLEWALK_INVERSE_H
#define SADDLEWALK_INVERSE_H

#include <saddlewalk/joints.h>

/** [J2] to [J6] As saddle_inverse(), for one side; the other side's joints stay. Not valid: the joints
 *  stay as they were. */
saddle_reach_t saddle_inverse_leg(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                                  const saddle_foot_t *foot, saddle_side_t side,
                                  saddle_joints_t *joints);

#endif
