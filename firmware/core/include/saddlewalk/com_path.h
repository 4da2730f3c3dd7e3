/** The CoM in the transverse plane at constant speed, relative to the stance foot. */
#ifndef SADDLEWALK_COM_PATH_H
#define SADDLEWALK_COM_PATH_H

#include <saddlewalk/gait_model.h>
#include <saddlewalk/saddle_types.h>

/** x from the stance CoP, y from the walking line. */
typedef struct {
    saddle_vec2_t position_m;
    saddle_vec2_t velocity_m_s;
} saddle_com_path_t;

/** [E7] step_phase_rad in [-pi/2, pi/2]: 0 beside the stance foot (foot via point), +-pi/2 at the
 *  saddle via points. One sine, one cosine. */
saddle_com_path_t saddle_com_path(const saddle_gait_t *gait, saddle_side_t stance,
                                  float step_phase_rad);

#endif
