/** How step length, width and amplitudes follow from walking speed, and which speeds are feasible. */
#ifndef SADDLEWALK_GAIT_MODEL_H
#define SADDLEWALK_GAIT_MODEL_H

#include <saddlewalk/model.h>
#include <saddlewalk/saddle_fixed.h>
#include <saddlewalk/saddle_types.h>
#include <stdbool.h>

/** One quarter of the stride: from beside the stance foot (foot via point) to midway between the
 *  feet (saddle via point), or back. */
typedef struct {
    saddle_side_t stance;
    float length_m;    /**< along x; half a step in steady walking */
    float width_m;     /**< between the lines of the two feet, > 0 */
    float amplitude_m; /**< A_y, at most width_m / pi, [E7] */
    float vertical_m;  /**< delta Z, peak to peak, [E5] */
} saddle_quarter_t;

/** Half step lengths that bound the step scores at one speed, [E6]. */
typedef struct {
    float min_m;       /**< XCoM limit */
    float reference_m; /**< the regression */
    float max_m;       /**< reach limit */
    bool feasible;     /**< speed > 0 and min < reference < max */
} saddle_step_bounds_t;

/** [E3], defined at every speed. */
float saddle_step_width_m(const saddle_model_t *model, float speed_m_s);

/** Any finite speed; for speed <= 0 not feasible. */
saddle_step_bounds_t saddle_step_bounds(const saddle_model_t *model,
                                        float speed_m_s);

/** [E4] Half the step that a foot makes, exact in the speed; speed >= 0. */
saddle_fixed_t saddle_half_step(const saddle_model_t *model, saddle_side_t foot,
                                saddle_fixed_t speed);

/** [E3] Where a foot lands beside the walking line: y, positive for the left foot. */
float saddle_landing_y_m(const saddle_model_t *model, saddle_side_t foot, float speed_m_s);

/** Amplitudes at a speed for a quarter of the given shape; width_m below 2 cm counts as 2 cm. */
saddle_quarter_t saddle_quarter(const saddle_model_t *model, saddle_side_t stance, float length_m,
                                float width_m, float speed_m_s);

#endif
