/** One person and device: the configuration and what follows from it, derived once by saddle_init()
 *  and never changed after. */
#ifndef SADDLEWALK_MODEL_H
#define SADDLEWALK_MODEL_H

#include <saddlewalk/config.h>
#include <saddlewalk/saddle_fixed.h>
#include <saddlewalk/saddle_types.h>
#include <stdint.h>

/** A feasible speed stays this factor under the ceiling when it is limited. */
#define SADDLE_CEILING_MARGIN 0.99f

/** Coefficients. */
typedef struct {
    float pendulum_m;              /**< l_p, [E1] */
    float natural_frequency_rad_s; /**< w_n, [E2] */
    float half_step_max_m;         /**< reach, [E6] */
    float speed_ceiling_m_s;       /**< no speed at or above it is planned, [E6] */
    float half_step_slope_s[2];    /**< of the step that each foot makes, [E4] */
    saddle_fixed_t half_step_intercept[2];
    float ankle_work_j;            /**< W_max, [E27] */
    float foresight_growth;        /**< of a deviation within foresight_s, [E29] */
    float com_height_min_m;        /**< a lower CoM is below the knees */
    float crawl_m_s;               /**< a stop goes on at no less until it brakes, */
    float braked_in_a_step_m_s;    /**< and at no more: every step is long enough to brake from it */
    float braked_in_a_tick_m_s;    /**< what the longest tick can brake */
    float command_max_age_us, com_max_age_us, foot_max_age_us; /**< to compare ages with */
    uint32_t tick_max_us;
    uint32_t shift_us;             /**< of a shift of weight */
} saddle_body_t;

typedef struct {
    saddle_config_t config;
    saddle_body_t body;
} saddle_model_t;

/** Copy a configuration that has passed saddle_config_check() and derive the coefficients. */
void saddle_model_init(saddle_model_t *model, const saddle_config_t *config);

#endif
