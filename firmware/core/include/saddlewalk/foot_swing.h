/** The swing foot: its CoP stays on the line through the stance CoP and the CoM. */
#ifndef SADDLEWALK_FOOT_SWING_H
#define SADDLEWALK_FOOT_SWING_H

#include <saddlewalk/blend.h>
#include <saddlewalk/saddle_types.h>

/** One swing, relative to the stance CoP. Progress runs from 0 at one saddle via point over 1/2
 *  beside the stance foot to 1 at the next; a first or last half swing is in the air for half. */
typedef struct {
    float lift_progress, land_progress; /**< in the air between them */
    float line_y_m;                     /**< where it lands, from the stance CoP */
    saddle_vec2_t offset_m;             /**< from the line to where it lifted off: fades out */
    float clearance_m;
    float path_width_m;                 /**< of the quarter whose lateral path is followed */
} saddle_swing_t;

typedef struct {
    saddle_vec3_t position_m;   /**< CoP, from the stance CoP; z from the ground */
    saddle_vec3_t velocity_m_s;
} saddle_swing_state_t;

/** [E9] x of the point where the line from the stance CoP through the reference CoM meets the line
 *  of the path's other foot, path_width_m away, and dx/d(CoM x). x_m is the CoM's, lateral its
 *  reference. */
saddle_sample_t saddle_swing_line(const saddle_swing_t *swing, float x_m, saddle_sample_t lateral);

/** [E9] [E10] The foot at a progress; x_m, lateral as above; speed_m_s that of the CoM and
 *  rate_hz that of the progress. */
void saddle_foot_swing(const saddle_swing_t *swing, float progress, float x_m,
                       saddle_sample_t lateral, float speed_m_s, float rate_hz,
                       saddle_swing_state_t *foot);

#endif
