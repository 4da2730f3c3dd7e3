/** The way of a foot through the air. */
#ifndef SADDLEWALK_SWING_H
#define SADDLEWALK_SWING_H

#include <saddlewalk/joint_walk.h>

/** The plan at one time; path_m is measured from the other foot's sole on the ground. */
typedef struct {
    saddle_vec3_t path_m, rate_m_s;
    float landing_in_s, pitch_rad;
} saddle_planned_swing_t;

/** A foot that leaves the ground there, with the sole at that pitch. */
void saddle_swing_path_begin(saddle_swing_path_t *swing, saddle_vec3_t sole_m, float pitch_rad);

/** [J22] [J23] The next position and velocity, towards the landing that swing->shift_m moves. */
void saddle_swing_path_step(saddle_swing_path_t *swing, const saddle_joint_walk_config_t *config,
                            const saddle_planned_swing_t *planned, float dt_s);

#endif
