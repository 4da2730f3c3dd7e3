/** The forces under both feet that move the body as it should. */
#ifndef SADDLEWALK_GROUND_FORCE_H
#define SADDLEWALK_GROUND_FORCE_H

#include <saddlewalk/joint_command.h>

/** Of one foot: force and where it acts. */
typedef struct {
    saddle_vec3_t force_n, cop_m;
    float share;
} saddle_ground_force_t;

/** [J16] [J17] Both feet's; the result is the CoP of both together. */
saddle_vec2_t saddle_ground_forces(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                                   const saddle_estimate_t *estimate, const saddle_intent_t *intent,
                                   saddle_ground_force_t ground[2]);

#endif
