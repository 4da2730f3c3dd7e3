/** How step length, width and amplitudes follow from walking speed, and which speeds are feasible. */
#ifndef SADDLEWALK_GAIT_MODEL_H
#define SADDLEWALK_GAIT_MODEL_H

#include <saddlewalk/config.h>
#include <stdbool.h>

/** A feasible speed stays this factor under the ceiling when it is limited. */
#define SADDLE_CEILING_MARGIN 0.99f

/** Constants of one body, derived once from the configuration. */
typedef struct {
    float pendulum_m;            /**< l_p, [E1] */
    float natural_frequency_rad_s; /**< w_n, [E2] */
    float half_step_max_m;       /**< reach, [E6] */
    float speed_ceiling_m_s;     /**< no speed at or above it is feasible, [E6] */
} saddle_body_t;

/** The regressions at one speed. */
typedef struct {
    float speed_m_s;
    float step_length_m;        /**< [E4] */
    float step_width_m;         /**< [E3] */
    float lateral_amplitude_m;  /**< A_y, [E7] */
    float vertical_amplitude_m; /**< delta Z, peak to peak, [E5] */
    float cadence_hz;           /**< w_0, steps per second */
} saddle_gait_t;

/** Half step lengths that bound the step scores at one speed, [E6]. */
typedef struct {
    float min_m;       /**< XCoM limit */
    float reference_m; /**< the regression */
    float max_m;       /**< reach limit */
    bool feasible;     /**< speed > 0 and min < reference < max */
} saddle_step_bounds_t;

/** config has passed saddle_config_check(). */
saddle_body_t saddle_body(const saddle_config_t *config);

/** speed_m_s finite and > 0. */
saddle_gait_t saddle_gait(const saddle_config_t *config, float speed_m_s);

/** [E3], defined at every speed. */
float saddle_step_width_m(const saddle_config_t *config, float speed_m_s);

/** Any finite speed; for speed <= 0 not feasible. */
saddle_step_bounds_t saddle_step_bounds(const saddle_config_t *config, const saddle_body_t *body,
                                        float speed_m_s);

#endif
