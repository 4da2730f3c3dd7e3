/** [E33] to [E35] The one number that the level is decided by: how much further a posture may depart
 *  from the wearer's own walk. */
#ifndef SADDLEWALK_MARGIN_H
#define SADDLEWALK_MARGIN_H

#include <saddlewalk/private/context.h>

/** Departure of a measured posture from the learned walk. Lengths and velocities are shares of the
 *  CoM's usual height h and of sqrt(g h), as everything below. */
typedef struct {
    saddle_vec2_t offset; /**< of the CoM, predicted, from midway between the feet; across it is
                               weighted */
    float step;           /**< what the distance of the feet tolerates */
    float sinking;        /**< how fast the CoM sinks, now and at the height before, at least 0: a
                               height that jumps once is no collapse */
    float sink;           /**< the part of a departure that sinking is */
} saddle_departure_t;

/** [E33] CoM and both feet are known and learning has watched the CoM. */
saddle_departure_t saddle_departure(const saddle_model_t *model, const saddle_learning_t *learning,
                                    const saddle_measurement_t *measurement);

/** [E34] Tolerance of the learned walk less the departure. */
float saddle_own_margin(const saddle_model_t *model, const saddle_learning_t *learning,
                        const saddle_departure_t *departure);

/** [E35] What the plan adds to the margin of a wearer whom it leads: how well the step to come
 *  catches the CoM. verdict: compared with the plan. */
float saddle_plan_margin(const saddle_model_t *model, const saddle_learning_t *learning,
                         const saddle_verdict_t *verdict);

/** [E37] What a sinking CoM leaves of any margin, whatever the feet or a plan can do. */
float saddle_sinking_margin(const saddle_departure_t *departure);

/** The largest part of a departure. plan: what saddle_plan_margin() said, 0 for nobody led. */
saddle_reason_t saddle_driver(const saddle_departure_t *departure, float plan);

/** At and below this margin is caution: half of what the wearer's steady steps keep, caution_margin
 *  before one is known, and half of what the plan adds, [E31]. */
float saddle_caution_below(const saddle_model_t *model, const saddle_learning_t *learning,
                           float plan);

#endif
