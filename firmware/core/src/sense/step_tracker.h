/** Heel strikes of the wearer, and what the last step was like. */
#ifndef SADDLEWALK_STEP_TRACKER_H
#define SADDLEWALK_STEP_TRACKER_H

#include <saddlewalk/private/context.h>

/** Take one measurement and its faults. A foot that was in the air for less than 0.12 s did not
 *  step. A step older than step_time_max_s is forgotten, and so is one before a step that could not be
 *  measured. Standing is detected when both feet carry and the CoM is slower than 0.2 m/s. */
void saddle_track_steps(saddle_step_tracker_t *tracker, const saddle_model_t *model,
                        const saddle_measurement_t *measurement, uint32_t faults, float dt_s);

/** What happened in the last gap_s is not known: the running step gives no speed. */
void saddle_track_gap(saddle_step_tracker_t *tracker, float gap_s);

#endif
