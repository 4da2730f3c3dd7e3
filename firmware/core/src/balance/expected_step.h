/** The step under way as it is planned, and what a deviation from it will have grown to when the
 *  foot lands. Every point is measured from the stance CoP. */
#ifndef SADDLEWALK_EXPECTED_STEP_H
#define SADDLEWALK_EXPECTED_STEP_H

#include "balance/energy.h"
#include "math/elementary.h"

#include <saddlewalk/private/context.h>

/** A step of a steady walk. */
typedef struct {
    saddle_side_t stance;
    float speed_m_s;         /**< > 0 */
    float half_behind_m;     /**< from the foot via point back to the last landing, > 0 */
    float width_behind_m;    /**< between the lines of the feet then */
    saddle_vec2_t landing_m; /**< of the swing CoP */
} saddle_step_t;

/** [E28] What the step expects. */
typedef struct {
    saddle_com_state_t now;     /**< at the measured phase */
    saddle_com_state_t landing; /**< when the foot lands */
    saddle_vec2_t landing_m;    /**< there */
    float time_s;               /**< until then, at most prediction_horizon_s */
    float step_time_s;          /**< of a whole step */
} saddle_expectation_t;

/** Where in a step the CoM is. */
typedef struct {
    float x_m;              /**< from the stance CoP */
    saddle_sin_cos_t phase; /**< of the running quarter there, com_path.h */
} saddle_step_place_t;

/** Where a CoM is that is x_m from the stance CoP, or at the nearest end of the step. */
saddle_step_place_t saddle_step_place(const saddle_step_t *step, float x_m);

/** [E28] The step at the phase of a CoM. */
void saddle_expect(const saddle_model_t *model, const saddle_step_t *step,
                   const saddle_step_place_t *place, saddle_expectation_t *expected);

/** How a deviation of the XCoM grows in a time, [E29] [E30]. */
typedef struct {
    float factor;   /**< exp(w_n t) */
    float trailing; /**< what a CoP held at the trailing foot, as long as that carries, takes off:
                         its distance times this; 0 once the foot has lifted off */
} saddle_growth_t;

/** [E29] trailing: the other foot still carries, for about 0.1 s more. */
saddle_growth_t saddle_growth(const saddle_model_t *model, float time_s, bool trailing);

/** [E29] What a deviation of the CoM along one axis, with that of the XCoM, has grown to after free
 *  fall about the CoP; the XCoM's own grows by growth->factor. */
float saddle_grown_m(float com_m, float xcom_m, const saddle_growth_t *growth);

#endif
