/** Whether the measurements of the wearer are plausible. */
#ifndef SADDLEWALK_PLAUSIBILITY_H
#define SADDLEWALK_PLAUSIBILITY_H

#include <saddlewalk/private/context.h>

/** Check a measurement: age, range, frozen numbers, contradictions. dt_s: since the last call;
 *  planned_m_s: speed of the walk that was planned then, 0 for none. Out of range: a CoM below the
 *  knees (0.285 of the body's height) or above the body's height, faster than 6 m/s along x or y; a
 *  CoP beyond 2.5 m along x or y. Returns saddle_fault_t bits. */
uint32_t saddle_measurement_check(saddle_plausibility_t *plausibility, const saddle_model_t *model,
                                  const saddle_measurement_t *measurement, float planned_m_s,
                                  float dt_s);

#endif
