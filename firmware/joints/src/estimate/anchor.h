/** The point of a sole that rests on the ground. */
#ifndef SADDLEWALK_ANCHOR_H
#define SADDLEWALK_ANCHOR_H

#include <saddlewalk/estimator.h>

/** Where the anchor is on a foot. */
saddle_vec3_t saddle_anchor_m(const saddle_estimator_t *estimator,
                              const saddle_foot_pose_t foot[2]);

/** Choose the anchor: the foot that carries, or the one whose joints are sound; its middle, or where
 *  it rolls heel or toe. The IMU's track goes on from the new one. */
void saddle_anchor_choose(saddle_estimator_t *estimator, const saddle_foot_pose_t foot[2],
                          uint32_t lost_joints);

/** [J14] Whether the anchor slips, from the velocity that it has beyond what the IMU expects. While it
 *  does, the velocity is the IMU's alone. */
bool saddle_anchor_slips(saddle_estimator_t *estimator, saddle_vec3_t beyond_m_s, float dt_s);

#endif
