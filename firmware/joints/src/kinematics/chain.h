/** One leg from the trunk down: where its joints and segments are, and how they move. */
#ifndef SADDLEWALK_CHAIN_H
#define SADDLEWALK_CHAIN_H

#include <saddlewalk/joints.h>

/** Segments of a leg. */
enum { SADDLE_THIGH = 0, SADDLE_SHANK = 1, SADDLE_FOOT = 2, SADDLE_LEG_SEGMENTS = 3 };

typedef struct {
    saddle_vec3_t hip_m, knee_m, ankle_m;
    saddle_vec3_t axis[SADDLE_LEG_JOINTS]; /**< of each joint, along the world's axes */
    saddle_com_t segment[SADDLE_LEG_SEGMENTS];
    saddle_foot_pose_t foot;
} saddle_chain_t;

/** [J7] Angles beyond [-2 pi, 2 pi] count as 0, and rates are taken as they are. */
void saddle_chain(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                  const saddle_joints_t *joints, saddle_side_t side, saddle_chain_t *chain);

/** The hip of that side, and its velocity. */
saddle_com_t saddle_hip(const saddle_legs_t *legs, const saddle_trunk_t *trunk, saddle_side_t side);

/** CoM of trunk and two legs, [J7]. */
saddle_com_t saddle_com_of(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                           const saddle_chain_t chain[2]);

#endif
