/** Last check of what goes out: whether every number of it is finite. */
#ifndef SADDLEWALK_FINITE_H
#define SADDLEWALK_FINITE_H

#include <saddlewalk/types.h>

bool saddle_plan_finite(const saddle_plan_t *plan);
bool saddle_output_finite(const saddle_output_t *output);

#endif
