/** Heel strikes of the wearer, and what the last step was like. */
#ifndef SADDLEWALK_STEP_TRACKER_H
#define SADDLEWALK_STEP_TRACKER_H

#include <saddlewalk/measurement.h>
#include <saddlewalk/model.h>

/** State, part of the context. */
typedef struct {
    float step_distance_m, step_duration_s; /**< since the last heel strike */
    float last_velocity_m_s;
    float v_comp_m_s;      /**< mean AP speed over the last completed step */
    float half_step_m;     /**< half of what the landed foot was ahead at the last heel strike */
    float step_width_m;    /**< of the feet then, left minus right */
    float since_strike_s;
    float airborne_s[2];   /**< since the foot left the ground; 0 on it */
    bool step_open;        /**< a heel strike was seen and the velocity was known ever since */
    bool v_comp_known, half_step_known; /**< step_width_m goes with half_step_m */
    bool stands;           /**< was seen to stand, and no step was completed since */
    uint8_t stance;        /**< saddle_side_t: the only foot on the ground, else the one that landed last */
} saddle_step_tracker_t;

/** Follow one measurement judged by saddle_judge(). A foot that was in the air for less than 0.12 s
 *  did not step. What is older than step_time_max_s is forgotten, or older than a step that could not
 *  be measured. Standing is seen when both feet
 *  carry and the CoM is slower than 0.2 m/s. */
void saddle_track_steps(saddle_step_tracker_t *tracker, const saddle_model_t *model,
                        const saddle_measurement_t *measurement, uint32_t faults, float dt_s);

/** What happened in the last gap_s is not known: the running step gives no speed. */
void saddle_track_gap(saddle_step_tracker_t *tracker, float gap_s);

#endif
