/** Lines of the gait regressions, for those who have a configuration and no model yet. */
#ifndef SADDLEWALK_CONFIG_H
#define SADDLEWALK_CONFIG_H

#include <saddlewalk/types.h>

/** Of the symmetric step, the longer one of the two feet; at least 1. */
float saddle_longer_step_factor(const saddle_config_t *config);

/** [E4] Half a symmetric step. */
float saddle_regressed_half_step_m(const saddle_config_t *config, float speed_m_s);

/** [E3] Step width between the two speeds. */
float saddle_regressed_width_m(const saddle_config_t *config, float speed_m_s);

#endif
