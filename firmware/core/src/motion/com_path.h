/** The CoM in the transverse plane over one quarter of the stride, relative to the stance foot. */
#ifndef SADDLEWALK_COM_PATH_H
#define SADDLEWALK_COM_PATH_H

#include "math/elementary.h"

#include <saddlewalk/private/context.h>

/** Sine and cosine of the phase angle where the CoM is beside the stance foot, the foot via point; and
 *  where it is midway between the feet, a saddle via point, before a landing and after one. These are
 *  the bits of saddle_sin_cos() at 0 and +-pi/2. */
#define SADDLE_PHASE_FOOT ((saddle_sin_cos_t){0.0f, 1.0f})
#define SADDLE_PHASE_LANDING ((saddle_sin_cos_t){1.0f, -4.37113954e-8f})
#define SADDLE_PHASE_LANDED ((saddle_sin_cos_t){-1.0f, -4.37113954e-8f})

/** The same at the place x_m from the stance CoP in a quarter of that length, |x_m| <= quarter_m: of an angle in [-pi/2, pi/2] that
 *  grows with the distance. */
saddle_sin_cos_t saddle_quarter_phase(float quarter_m, float x_m);

/** The person's shape; at the end of a walk, once its last swing has begun, the paper's: there the CoM
 *  comes to where it is beside the stance foot in standing. */
const saddle_shape_t *saddle_shape(const saddle_model_t *model, bool last_swing);

/** [E7] CoM y from the stance CoP, and dy/dx, at a phase: of the paper's path. The swing foot's line
 *  goes through it. */
saddle_sample_t saddle_com_lateral(const saddle_quarter_t *quarter, saddle_sin_cos_t phase);

/** [E7] The same of a person's path, by which the CoM goes. */
saddle_sample_t saddle_shaped_lateral(const saddle_quarter_t *quarter, const saddle_shape_t *shape,
                                      saddle_sin_cos_t phase);

/** [E24] CoM height of the cycloid model at a phase, and dz/dx; pendulum_m: l_p. */
saddle_sample_t saddle_shaped_height(const saddle_quarter_t *quarter, const saddle_shape_t *shape,
                                     float pendulum_m, saddle_sin_cos_t phase);

#endif
