/** Included before every file that Eva reads. */
#include <math.h>

#define __builtin_fabsf fabsf

#include "models.h"

#define saddle_larger model_larger
#define saddle_smaller model_smaller
#define saddle_clamp model_clamp
#define saddle_in_range MODEL_IN_RANGE
