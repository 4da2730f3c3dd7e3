/** How step length, width and amplitudes follow from walking speed, and which speeds are feasible. */
#ifndef SADDLEWALK_GAIT_MODEL_H
#define SADDLEWALK_GAIT_MODEL_H

#include <saddlewalk/private/context.h>

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
saddle_step_bounds_t saddle_step_bounds(const saddle_model_t *model, float speed_m_s);

/** [E4] Half the step that a foot makes, exact in the speed; speed >= 0. */
saddle_fixed_t saddle_half_step(const saddle_model_t *model, saddle_side_t foot,
                                saddle_fixed_t speed);

/** [E3] Where a foot lands beside the walking line: y, positive for the left foot. */
float saddle_landing_y_m(const saddle_model_t *model, saddle_side_t foot, float speed_m_s);

/** [E48] The largest turning rate of a walk at a speed: as far as the legs reach, as the hips turn in a
 *  step, and as the CoM leans without passing over the inner foot; 0 for speed <= 0. */
float saddle_turn_max_rad_s(const saddle_model_t *model, float speed_m_s);

/** Amplitudes at a speed for a quarter of the given shape; width_m below 2 cm counts as 2 cm. */
saddle_quarter_t saddle_quarter(const saddle_model_t *model, saddle_side_t stance, float length_m,
                                float width_m, float speed_m_s);

#endif
