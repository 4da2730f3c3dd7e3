/** XCoM and the paper's stability scores. */
#ifndef SADDLEWALK_STABILITY_SCORES_H
#define SADDLEWALK_STABILITY_SCORES_H

#include <saddlewalk/types.h>

/** [E19] Extrapolated centre of mass. */
saddle_vec2_t saddle_xcom_m(saddle_vec2_t com_m, saddle_vec2_t com_velocity_m_s,
                            float natural_frequency_rad_s);

/** [E20] S_pend with the XCoM limit as bound, S_jump with the reach limit: 1 on the reference half
 *  step, 0 on the bound. reference_m must differ from bound_m. */
float saddle_step_score(float half_step_m, float reference_m, float bound_m);

/** [E21] S_SW: 1 midway between the feet, 0 above a foot. step_width_m > 0. */
float saddle_width_score(float offset_from_midline_m, float step_width_m);

#endif
