#include "math/blend.h"

#include "math/elementary.h"

#define LENGTH_MIN_M 1.0e-4f

saddle_blend_t saddle_blend(saddle_sample_t actual, saddle_sample_t reference, float start_m,
                            float length_m)
{
    saddle_blend_t blend;
    blend.start.value = actual.value - reference.value;
    blend.start.slope = actual.slope - reference.slope;
    blend.start_m = start_m;
    blend.length_m = length_m;
    return blend;
}

/* [E22] */
saddle_sample_t saddle_blend_at(const saddle_blend_t *blend, float place_m)
{
    saddle_sample_t mismatch = {0.0f, 0.0f};
    if (blend->length_m < LENGTH_MIN_M) {
        return mismatch;
    }
    const float s = saddle_clamp((place_m - blend->start_m) / blend->length_m, 0.0f, 1.0f);
    const float rest = 1.0f - s;
    const saddle_jerk_t fade = saddle_min_jerk_both(s);
    mismatch.value = blend->start.value * (1.0f - fade.value) +
                     blend->start.slope * blend->length_m * s * rest * rest;
    mismatch.slope = blend->start.slope * rest * (1.0f - 3.0f * s) -
                     blend->start.value * fade.slope / blend->length_m;
    return mismatch;
}
