/** The measured posture against the planned step, the person's own walk, or standing. */
#ifndef SADDLEWALK_COMPARISON_H
#define SADDLEWALK_COMPARISON_H

#include "balance/energy.h"
#include "balance/expected_step.h"
#include "balance/saddle_space.h"
#include "balance/scores.h"

#include <saddlewalk/private/context.h>

/** What the supervisor takes from the planner: where the wearer is to be. */
typedef struct {
    bool leads;                /**< a walk is planned, or has been walked since the start */
    bool walking;              /**< else both feet stand */
    saddle_side_t stance_then; /**< planned when the wearer was measured, [E46] */
    saddle_step_t step;        /**< the planned one, while walking, */
    saddle_step_place_t place; /**< and where in it the plan is */
    saddle_com_state_t com;    /**< planned, from midway between the feet, while both stand */
    bool may_place;            /**< while walking: the landing may be moved, [E45], */
    saddle_vec2_t
        reference_xcom_m; /**< by the XCoM's departure from this one, from the stance CoP */
} saddle_intent_t;

/** What is known of the wearer at one instant. */
typedef struct {
    const saddle_step_tracker_t *steps;
    const saddle_measurement_t *measurement;
    const saddle_posture_t *posture; /**< of that measurement */
    const saddle_scores_t *scores;   /**< of that posture */
    const saddle_support_t *support; /**< of that posture */
} saddle_wearer_t;

/** Clear what a comparison writes. */
void saddle_compare_nothing(saddle_verdict_t *verdict);

/** Compare with what is planned; without a command, with the walk of the last step or standing. Feet
 *  and CoM are known and the BoS is defined. Sets verdict->compared and writes all that goes with it,
 *  or nothing if there is no walk to compare with. Returns whether the wearer is seen to do as planned,
 *  making the planned step on its stance foot, or is to stand; sets *placement for one whose landing may
 *  be moved. */
bool saddle_compare(const saddle_model_t *model, const saddle_wearer_t *wearer,
                    const saddle_intent_t *intent, saddle_verdict_t *verdict,
                    saddle_placement_t *placement);

#endif
