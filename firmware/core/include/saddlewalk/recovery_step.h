/** [E30] Where to put the foot so that walking can go on, or that no place within reach will do. */
#ifndef SADDLEWALK_RECOVERY_STEP_H
#define SADDLEWALK_RECOVERY_STEP_H

#include <saddlewalk/expected_step.h>
#include <saddlewalk/gait_model.h>
#include <saddlewalk/model.h>
#include <saddlewalk/saddle_types.h>
#include <stdbool.h>
#include <stdint.h>

/** Points are measured from the stance CoP, the foot that does not step. */
typedef struct {
    bool found;     /**< false: no place within reach helps, and landing_m is 0 */
    bool stops;     /**< the XCoM will lie in the BoS of that posture: the step ends the walk */
    uint8_t foot;   /**< saddle_side_t: the foot that steps */
    saddle_vec2_t landing_m; /**< the place nearest to the wanted one */
    float margin_m; /**< reach that is left on the scarcer axis; negative: what is lacking */
} saddle_recovery_t;

/** What a recovery step starts from. */
typedef struct {
    saddle_side_t stance;
    saddle_vec2_t landing_m; /**< planned */
    saddle_vec2_t xcom_m;    /**< planned, when the foot lands */
    saddle_vec2_t departure_m; /**< of the expected XCoM from there */
    float step_time_s;       /**< of the steps after it */
} saddle_recovery_target_t;

void saddle_recovery_step(const saddle_model_t *model,
                          const saddle_recovery_target_t *target, saddle_recovery_t *recovery);

/** How far the wearer can move the CoP from where it is planned, along one axis. */
typedef struct {
    float foot_m;     /**< either way, within the stance foot, all the time */
    float trailing_m; /**< signed: to the trailing foot, while that carries */
} saddle_cop_shift_t;

/** [E30] The least that a deviation of the XCoM along one axis can have grown to. */
float saddle_least_deviation_m(float deviation_m, saddle_cop_shift_t shift,
                               const saddle_growth_t *growth);

#endif
