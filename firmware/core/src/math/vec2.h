/** Vectors in the transverse plane, and the two sides of the body. */
#ifndef SADDLEWALK_VEC2_H
#define SADDLEWALK_VEC2_H

#include <saddlewalk/types.h>

#ifndef SADDLE_DECLARATIONS_ONLY /* for those who read the headers and are no compiler */

#include <math.h>

static inline saddle_vec2_t saddle_vec2_add(saddle_vec2_t a, saddle_vec2_t b)
{
    return (saddle_vec2_t){a.x + b.x, a.y + b.y};
}

static inline saddle_vec2_t saddle_vec2_sub(saddle_vec2_t a, saddle_vec2_t b)
{
    return (saddle_vec2_t){a.x - b.x, a.y - b.y};
}

static inline saddle_vec2_t saddle_vec2_scale(float factor, saddle_vec2_t v)
{
    return (saddle_vec2_t){factor * v.x, factor * v.y};
}

static inline float saddle_vec2_dot(saddle_vec2_t a, saddle_vec2_t b)
{
    return a.x * b.x + a.y * b.y;
}

static inline float saddle_vec2_length(saddle_vec2_t v)
{
    return sqrtf(saddle_vec2_dot(v, v));
}

/** The other foot. */
static inline saddle_side_t saddle_other_side(saddle_side_t side)
{
    return side == SADDLE_LEFT ? SADDLE_RIGHT : SADDLE_LEFT;
}

/** Sign of y on that side of the body: 1 on the left, -1 on the right. */
static inline float saddle_outward(saddle_side_t side)
{
    return side == SADDLE_LEFT ? 1.0f : -1.0f;
}

#endif

#endif
