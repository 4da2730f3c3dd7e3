#include "math/bytes.h"
#include "math/elementary.h"
#include "math/rounding.h"
#include "walk/footing.h"
#include "walk/reference.h"

#include <saddlewalk/joint_walk.h>

/* Longer steps in time start it anew. */
#define STEP_MAX_US 50000u

/* No side: saddle_joint_commands() answers with the fallback. */
#define NOBODY 2u

saddle_status_t saddle_joint_walk_init(saddle_joint_walk_t *walk, const saddle_legs_t *legs,
                                       const saddle_joint_walk_config_t *config)
{
    saddle_clear(walk, sizeof *walk);
    if (!saddle_rounds_as_written()) {
        return SADDLE_ERROR_BUILD;
    }
    if (saddle_legs_check(legs) != NULL || saddle_joint_walk_check(config) != NULL) {
        return SADDLE_ERROR_CONFIG;
    }
    saddle_copy(&walk->legs, legs, sizeof *legs);
    saddle_copy(&walk->config, config, sizeof *config);
    walk->initialised = true;
    return SADDLE_OK;
}

/* Both feet on the ground, as high as the CoM is. */
static void stand_at_first(saddle_joint_walk_t *walk, const saddle_estimate_t *estimate)
{
    for (unsigned side = 0; side < 2; side++) {
        walk->stands[side] = true;
        walk->swings[side] = false;
        walk->light_s[side] = 0.0f;
        saddle_clear(&walk->leg[side], sizeof walk->leg[side]);
    }
    walk->leading = SADDLE_LEFT;
    walk->first_swing = true;
    walk->since_landing_s = 0.0f;
    walk->recovery_shift_m = (saddle_vec2_t){0.0f, 0.0f};
    walk->in_need = false;
    walk->height_m = estimate->body.com.position_m.z;
    walk->height_rate_m_s = 0.0f;
    saddle_copy(&walk->joints, &estimate->joints, sizeof walk->joints);
    walk->started = true;
}

/* The time since the last update; 0 where that is no time to go on from. */
static float since_last_s(saddle_joint_walk_t *walk, uint64_t time_us)
{
    const uint64_t last_us = walk->time_us;
    const bool goes_on = walk->started && time_us > last_us && time_us - last_us <= STEP_MAX_US;
    walk->time_us = time_us;
    walk->started = goes_on;
    return goes_on ? 1.0e-6f * (float)(uint32_t)(time_us - last_us) : 0.0f;
}

saddle_status_t saddle_joint_walk_update(saddle_joint_walk_t *walk,
                                         const saddle_joint_walk_input_t *input,
                                         const saddle_estimate_t *estimate, saddle_intent_t *intent)
{
    saddle_clear(intent, sizeof *intent);
    intent->leading = NOBODY;
    if (!walk->initialised) {
        return SADDLE_ERROR_UNINITIALISED;
    }
    const float dt_s = since_last_s(walk, input->time_us);
    if (!walk->started) {
        stand_at_first(walk, estimate);
    }
    saddle_moment_t moment = saddle_moment(walk, input, estimate, dt_s);
    saddle_footing_update(walk, &moment);
    if (!saddle_reference_update(walk, &moment, intent)) {
        walk->started = false;
        return SADDLE_OK;
    }
    intent->leading = walk->leading;
    intent->trailing_share_max = intent->role[1u - walk->leading] == SADDLE_LEG_TRAILS
                                     ? saddle_trailing_share(walk, &moment)
                                     : 1.0f;
    intent->xcom_m = moment.planned_xcom_m;
    intent->cop_m = moment.planned_cop_m;
    return SADDLE_OK;
}
