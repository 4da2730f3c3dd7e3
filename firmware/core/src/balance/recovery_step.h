/** [E30] Where to put the foot so that walking can go on, or that no place within reach will do. */
#ifndef SADDLEWALK_RECOVERY_STEP_H
#define SADDLEWALK_RECOVERY_STEP_H

#include "balance/expected_step.h"

#include <saddlewalk/private/context.h>

/** What a recovery step starts from. */
typedef struct {
    saddle_side_t stance;
    saddle_vec2_t landing_m;   /**< planned */
    saddle_vec2_t xcom_m;      /**< planned, when the foot lands */
    saddle_vec2_t departure_m; /**< of the expected XCoM from there */
    saddle_vec2_t placement_m; /**< the landing's, beyond what follows the departure, [E45] */
    float step_time_s;         /**< of the steps after it */
} saddle_recovery_target_t;

void saddle_recovery_step(const saddle_model_t *model, const saddle_recovery_target_t *target,
                          saddle_recovery_t *recovery);

/** How far the wearer can move the CoP from where it is planned, along one axis. */
typedef struct {
    float foot_m;     /**< either way, within the stance foot, all the time */
    float trailing_m; /**< signed: to the trailing foot, while that carries */
} saddle_cop_shift_t;

/** [E30] The least that a deviation of the XCoM along one axis can have grown to. */
float saddle_least_deviation_m(float deviation_m, saddle_cop_shift_t shift,
                               const saddle_growth_t *growth);

#endif
