/** [E23] The gait cycle: quarter after quarter, driven by the distance that the CoM goes, so that any change of
 *  speed or of the feet meets it without a jump. */
#ifndef SADDLEWALK_GAIT_CYCLE_H
#define SADDLEWALK_GAIT_CYCLE_H

#include "motion/ankle_strategy.h"
#include "motion/foot_swing.h"

#include <saddlewalk/private/context.h>

/** What a cycle says at one instant, from the stance CoP; y from there too. */
typedef struct {
    float progress; /**< of the quarter, [0, 1] */
    saddle_vec3_t com_m, com_velocity_m_s;
    saddle_swing_state_t swing;
    saddle_ankle_state_t ankle;
    float stance_pitch_rad, swing_pitch_rad; /**< sole to ground, positive heel up */
    bool ankle_limited;
} saddle_pose_t;

/** Where a walk begins. */
typedef struct {
    uint8_t phase; /**< 0 or 2: CoM beside the stance foot; 1 or 3: midway to it */
    float stance_y_m;
    saddle_vec2_t other_m;  /**< the other foot, from the stance CoP */
    float com_y_m, com_z_m; /**< from the stance CoP; z from the ground */
    saddle_fixed_t speed;
    float heel_strike_rad; /**< of the first landing */
    bool under_way;        /**< the other foot is in mid-swing: a steady walk is joined */
} saddle_cycle_start_t;

/** Stand, no step under way, with the stance foot at stance_y_m from the walking line. */
void saddle_cycle_stand(saddle_cycle_t *cycle, saddle_side_t stance, float stance_y_m);

/** Begin to walk. Counts and distance go on; the pace is as it was. */
void saddle_cycle_begin(saddle_cycle_t *cycle, const saddle_model_t *model,
                        const saddle_cycle_start_t *start);

/** From now on towards a speed at a rate. */
void saddle_cycle_set_pace(saddle_cycle_t *cycle, float speed_m_s, float rate_m_s2);

/** Whether the swing under way, or before a landing the next one, ends beside the stance foot. */
void saddle_cycle_set_last_swing(saddle_cycle_t *cycle, bool last_swing);

/** Walk on for dt_us. Returns the microseconds left when a last swing ended with zero speed beside
 *  the stance foot; 0 while it walks on. At most eight via points are passed. */
uint32_t saddle_cycle_advance(saddle_cycle_t *cycle, const saddle_model_t *model,
                              float heel_strike_rad, uint32_t dt_us, bool *arrived);

/** Take over a landing: the step that the stance foot really made. False, and nothing changes, if
 *  it is too late in the step or the foot lies where no plan can go on from. */
bool saddle_cycle_land(saddle_cycle_t *cycle, const saddle_model_t *model, saddle_vec2_t step_m);

/** Go on by another model, whose shape differs: what it changes at the CoM and the swing foot fades out.
 *  False, and nothing changes, but in the part of a step in which saddle_cycle_land() is possible. */
bool saddle_cycle_reshape(saddle_cycle_t *cycle, const saddle_model_t *model,
                          const saddle_model_t *reshaped);

/** [E43] The swing foot is on the ground: it carries from now on, where the plan has it, and the CoM goes
 *  on from where it is. Before a landing only. False, and nothing changes, if no plan can go on so. */
bool saddle_cycle_touch_down(saddle_cycle_t *cycle, const saddle_model_t *model,
                             float heel_strike_rad);

/** [E45] Let the swing foot land after step_m from the stance CoP, as far as the legs reach and the foot
 *  comes until then: the way there fades in without a jump. Nothing changes after a landing until the
 *  foot via point, nor in the last 60 ms before the next one. */
void saddle_cycle_place(saddle_cycle_t *cycle, const saddle_model_t *model, saddle_vec2_t step_m);

/** Whether the running quarter leads to a saddle via point, where the swing foot lands. */
bool saddle_cycle_before_landing(const saddle_cycle_t *cycle);

/** Phase angle where the CoM is, com_path.h. */
saddle_sin_cos_t saddle_cycle_phase(const saddle_cycle_t *cycle);

/** Way to the end of the running quarter. */
float saddle_cycle_distance_to_via_point_m(const saddle_cycle_t *cycle);

/** [E49] How far the CoM leans to the left, and its change with the CoM's x. */
saddle_sample_t saddle_cycle_lean(const saddle_cycle_t *cycle);

/** The pose's com_m.y alone. */
float saddle_cycle_com_y_m(const saddle_cycle_t *cycle, const saddle_model_t *model);

/** [E12] [E38] Way of the CoM from the next heel strike to the saddle via point, where the step is
 *  twice half_step_m long. */
float saddle_cycle_strike_lead_m(const saddle_cycle_t *cycle, const saddle_model_t *model,
                                 float half_step_m);

void saddle_cycle_pose(const saddle_cycle_t *cycle, const saddle_model_t *model,
                       saddle_pose_t *pose);

#endif
