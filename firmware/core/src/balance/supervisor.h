/** The stability supervisor: scores the measured posture, compares it with the walk that is
 *  planned, and says how far the wearer is from falling. */
#ifndef SADDLEWALK_SUPERVISOR_H
#define SADDLEWALK_SUPERVISOR_H

#include "balance/comparison.h"

#include <saddlewalk/private/context.h>

/** Nothing seen and nothing learned yet; the state is cleared. */
void saddle_supervisor_init(saddle_supervisor_t *supervisor, const saddle_model_t *model);

/** What happened in the last gap_s is not known: no level holds over it. */
void saddle_supervisor_gap(saddle_supervisor_t *supervisor, float gap_s);

/** A measurement after saddle_measurement_check(). */
typedef struct {
    const saddle_measurement_t *measurement; /**< brought forward to now, [E46] */
    const saddle_measurement_t *sampled;     /**< as it was made */
    uint32_t faults;                         /**< saddle_fault_t bits */
    float dt_s;                              /**< since the one before */
} saddle_sensed_t;

/** Follow the steps, score the posture in the frame of the CoM and give the verdict: writes scores and
 *  verdict of *output, and reads none of it. While a plan has both feet stand there is no walk to
 *  score: v_comp_m_s, the step scores and s_sw are not valid. Returns the faults, those of the scores
 *  among them. */
uint32_t saddle_supervisor_update(saddle_supervisor_t *supervisor, const saddle_model_t *model,
                                  const saddle_sensed_t *sensed, const saddle_intent_t *intent,
                                  saddle_output_t *output);

#endif
