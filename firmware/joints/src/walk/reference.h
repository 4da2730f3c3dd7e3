/** The reference of every joint: trunk and feet as they should be, through the inverse kinematics. */
#ifndef SADDLEWALK_REFERENCE_H
#define SADDLEWALK_REFERENCE_H

#include "walk/footing.h"

#include <saddlewalk/joint_walk.h>

/** [J24] [J25] Writes roles, height, joints and accelerations of the intent; false if the estimate is
 *  absurd. */
bool saddle_reference_update(saddle_joint_walk_t *walk, const saddle_moment_t *moment,
                             saddle_intent_t *intent);

#endif
