/** The swing foot: its CoP stays on the line through the stance CoP and the CoM, or goes a person's way. */
#ifndef SADDLEWALK_FOOT_SWING_H
#define SADDLEWALK_FOOT_SWING_H

#include "math/elementary.h"

#include <saddlewalk/private/context.h>

typedef struct {
    saddle_vec3_t position_m; /**< CoP, from the stance CoP; z from the ground */
    saddle_vec3_t velocity_m_s;
} saddle_swing_state_t;

/** [E9] x of the point where the line from the stance CoP through the reference CoM meets the line
 *  of the path's other foot, path_width_m away, and dx/d(CoM x). x_m is the CoM's, lateral its
 *  reference. */
saddle_sample_t saddle_swing_line(const saddle_swing_t *swing, float x_m, saddle_sample_t lateral);

/** [E44] A person's share of the way from behind the stance foot to ahead of it, and its change with
 *  the swing's progress: 1 at its end. */
saddle_jerk_t saddle_swing_share(const saddle_swing_profile_t *profile, float progress);

/** Where a swing is. */
typedef struct {
    float progress, rate_hz; /**< its rate of change */
    float speed_m_s;         /**< of the CoM */
    saddle_sample_t way;     /**< along x, and its change with the CoM's */
    float landing_x_m;       /**< where the foot lands, in the second half of its swing */
} saddle_swing_place_t;

/** [E9] [E10] The foot. */
void saddle_foot_swing(const saddle_swing_t *swing, const saddle_swing_place_t *place,
                       saddle_swing_state_t *foot);

#endif
