/** One person and device: the configuration and what follows from it, derived once by saddle_init()
 *  and never changed after. */
#ifndef SADDLEWALK_MODEL_H
#define SADDLEWALK_MODEL_H

#include <saddlewalk/private/context.h>

/** A feasible speed stays this factor under the ceiling when it is limited. */
#define SADDLE_CEILING_MARGIN 0.99f

/** Both feet carry for about this long after a heel strike: a sixth of a step. */
#define SADDLE_TRAILING_S 0.1f

/** Copy a configuration that has passed saddle_config_check() and derive the coefficients. */
void saddle_model_init(saddle_model_t *model, const saddle_config_t *config);

#endif
