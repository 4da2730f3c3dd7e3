/** The swing foot: its CoP stays on the line through the stance CoP and the CoM. */
#ifndef SADDLEWALK_FOOT_SWING_H
#define SADDLEWALK_FOOT_SWING_H

#include <saddlewalk/saddle_types.h>

typedef struct {
    saddle_vec3_t position_m; /**< CoP; x and y in the frame of the arguments */
    saddle_vec3_t velocity_m_s;
} saddle_swing_t;

/** Transverse motion and height, [E9] [E10].
 *  stance_m and com in one frame; swing_y_m is the line on which the swing foot travels;
 *  com.y must differ from stance_m.y. progress in [0, 1] from toe-off to heel strike, and its
 *  rate progress_rate_hz. */
saddle_swing_t saddle_foot_swing(saddle_vec2_t stance_m, saddle_vec2_t com_m,
                                 saddle_vec2_t com_velocity_m_s, float swing_y_m, float progress,
                                 float progress_rate_hz, float clearance_m);

#endif
