/** Ankle strategies: the stance leg lengthens around toe-off and heel strike. */
#ifndef SADDLEWALK_ANKLE_STRATEGY_H
#define SADDLEWALK_ANKLE_STRATEGY_H

#include "math/elementary.h"

#include <saddlewalk/private/context.h>

typedef struct {
    float toe_off_rad, heel_strike_rad; /**< sole to ground */
    float leg_length_m;                 /**< stance leg, [E11] */
    float knee_flexion_m; /**< by which the stance leg is shorter than straight, [E25] */
    float leg_rate_m_s;   /**< its time derivative */
    bool limited;         /**< an angle is beyond what an ankle does */
} saddle_ankle_state_t;

/** [E12] A heel strike at an angle in [0, pi/2]. */
saddle_heel_strike_t saddle_heel_strike(const saddle_model_t *model, float angle_rad);

/** The transition at the saddle via point of a quarter. */
saddle_transition_t saddle_transition(const saddle_model_t *model, const saddle_quarter_t *quarter,
                                      saddle_heel_strike_t strike);

/** Ankle angles, sole to ground. */
typedef struct {
    float toe_off_rad; /**< at most pi/2, the sole upright */
    float heel_strike_rad;
    bool limited; /**< toe_off_rad would be more */
} saddle_ankle_angles_t;

/** [E12] The angles since_strike_s after the nearest heel strike (negative: before it). */
saddle_ankle_angles_t saddle_ankle_angles(const saddle_model_t *model,
                                          const saddle_transition_t *transition,
                                          float since_strike_s);

/** The ankles since_strike_s after the nearest heel strike (negative: before it). Before the saddle
 *  via point the stance leg is in its toe-off part, after it in its heel-strike part:
 *  toe_off_acts. */
void saddle_ankle(const saddle_model_t *model, const saddle_transition_t *transition,
                  float since_strike_s, bool toe_off_acts, saddle_ankle_state_t *ankle);

/** [E14] CoM height and its rate over a stance CoP at `offset_m` horizontally from it. */
void saddle_com_height(const saddle_ankle_state_t *ankle, saddle_vec2_t offset_m,
                       saddle_vec2_t velocity_m_s, float *height_m, float *height_rate_m_s);

/** [E25] The ankle angle that gives the stance leg its length: of toe-off or of heel strike, at
 *  most pi/2, the sole upright. False if it would be more. */
bool saddle_ankle_for_leg(const saddle_model_t *model, float leg_length_m, bool toe_off_acts,
                          saddle_ankle_state_t *ankle);

#endif
