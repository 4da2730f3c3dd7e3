/** Ankle strategies: the stance leg lengthens around toe-off and heel strike. */
#ifndef SADDLEWALK_ANKLE_STRATEGY_H
#define SADDLEWALK_ANKLE_STRATEGY_H

#include <saddlewalk/gait_model.h>
#include <saddlewalk/saddle_types.h>

/** One step-to-step transition. */
typedef struct {
    float heel_strike_rad;  /**< commanded angle of the foot at heel strike */
    float toe_off_rad;      /**< toe-off angle when the heel strikes, [E13] */
    float heel_strike_lead_s; /**< heel strike to saddle via point, [E12] */
    bool toe_off_limited;   /**< the geometry asks for an angle outside [0, pi] */
} saddle_transition_t;

typedef struct {
    float toe_off_rad, heel_strike_rad; /**< sole to ground */
    float leg_length_m;                 /**< stance leg, [E11] */
    float leg_rate_m_s;                 /**< its time derivative */
} saddle_ankle_state_t;

/** The transition of a steady gait. heel_strike_rad in [0, pi/2]. */
saddle_transition_t saddle_transition(const saddle_config_t *config, const saddle_body_t *body,
                                      const saddle_gait_t *gait, float heel_strike_rad);

/** The ankles time_s after the nearest saddle via point (negative: before it).
 *  The stance leg is in its toe-off part before the saddle and in its heel-strike part after. */
saddle_ankle_state_t saddle_ankle(const saddle_config_t *config, const saddle_body_t *body,
                                  const saddle_transition_t *transition, float time_s);

/** [E14] CoM height and its rate over a stance CoP at `offset_m` horizontally from it. */
void saddle_com_height(const saddle_ankle_state_t *ankle, saddle_vec2_t offset_m,
                       saddle_vec2_t velocity_m_s, float *height_m, float *height_rate_m_s);

#endif
