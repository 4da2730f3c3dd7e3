/** [E26] [E27] The energy that stopping, or returning to the plan, has to absorb. */
#ifndef SADDLEWALK_ENERGY_H
#define SADDLEWALK_ENERGY_H

#include "balance/saddle_space.h"

#include <saddlewalk/private/context.h>

/** The CoM in the transverse plane. */
typedef struct {
    saddle_vec2_t com_m, velocity_m_s;
} saddle_com_state_t;

/** What carries the CoM. */
typedef struct {
    const saddle_vec2_t *cop_m; /**< of both feet, in the frame of the CoM's state */
    const saddle_bos_t *bos;    /**< of them */
    saddle_surface_t at_com;
} saddle_support_t;

/** [E26] Energy beyond what leaves the CoM at rest on the border of the BoS. False, and 0, where no
 *  leg reaches. */
bool saddle_excess_stop_j(const saddle_model_t *model, const saddle_support_t *support,
                          const saddle_com_state_t *state, float *excess_j);

/** [E26] Energy beyond what the planned state has on the border of the BoS. */
bool saddle_excess_track_j(const saddle_model_t *model, const saddle_support_t *support,
                           const saddle_com_state_t *state, const saddle_com_state_t *planned,
                           float *excess_j);

#endif
