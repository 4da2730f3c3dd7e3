/** A mismatch that fades out: what keeps a path without jumps when its reference changes. */
#ifndef SADDLEWALK_BLEND_H
#define SADDLEWALK_BLEND_H

#include <saddlewalk/private/context.h>

/** The mismatch that takes a path from `actual` to `reference` over length_m from start_m. */
saddle_blend_t saddle_blend(saddle_sample_t actual, saddle_sample_t reference, float start_m,
                            float length_m);

/** [E22] Minimum jerk for the value, a cubic for the slope; both gone at the end with zero slope. */
saddle_sample_t saddle_blend_at(const saddle_blend_t *blend, float place_m);

#endif
