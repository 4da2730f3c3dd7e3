/** Which foot stands and which swings: by the plan, and by the loads that the feet carry. */
#ifndef SADDLEWALK_FOOTING_H
#define SADDLEWALK_FOOTING_H

#include <saddlewalk/joint_walk.h>

/** What one call works with; all points are from the estimate's anchor. */
typedef struct {
    const saddle_plan_t *plan;      /**< NULL: none to follow */
    unsigned stance;                /**< side of the foot that the plan stands on */
    saddle_vec2_t planned_stance_m; /**< where the plan has that foot, in its own frame */
    const saddle_verdict_t *verdict;
    const saddle_estimate_t *estimate;
    float dt_s;
    float frequency_rad_s;  /**< of the pendulum as high as the CoM */
    saddle_vec2_t origin_m; /**< of the plan's frame */
    saddle_vec2_t xcom_m;   /**< measured */
    saddle_vec2_t planned_xcom_m, planned_cop_m;
} saddle_moment_t;

/** Where the walk is at this time, before any foot moves. */
saddle_moment_t saddle_moment(saddle_joint_walk_t *walk, const saddle_joint_walk_input_t *input,
                              const saddle_estimate_t *estimate, float dt_s);

/** [J21] Feet lift, swing and land. */
void saddle_footing_update(saddle_joint_walk_t *walk, saddle_moment_t *moment);

/** Whether a plan has both feet on the ground all the time. */
bool saddle_both_stand(const saddle_plan_t *plan);

/** [J21] The most of the load that the trailing foot may keep. */
float saddle_trailing_share(const saddle_joint_walk_t *walk, const saddle_moment_t *moment);

/** saddle_leg_role_t of a leg. */
uint8_t saddle_leg_role(const saddle_joint_walk_t *walk, const saddle_moment_t *moment,
                        unsigned side);

#endif
