/** The CoM in the transverse plane over one quarter of the stride, relative to the stance foot. */
#ifndef SADDLEWALK_COM_PATH_H
#define SADDLEWALK_COM_PATH_H

#include <saddlewalk/private/context.h>

/** Phase angle in [-pi/2, pi/2] of the place x_m from the stance CoP: 0 at the foot via point,
 *  +-pi/2 at the saddle via points. |x_m| <= length_m. */
float saddle_quarter_angle_rad(const saddle_quarter_t *quarter, float x_m);

/** [E7] CoM y from the stance CoP, and dy/dx. */
saddle_sample_t saddle_com_lateral(const saddle_quarter_t *quarter, float angle_rad);

#endif
