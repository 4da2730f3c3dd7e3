/** Vectors in space. */
#ifndef SADDLEWALK_VEC3_H
#define SADDLEWALK_VEC3_H

#include <math.h>
#include <saddlewalk/types.h>

static inline saddle_vec3_t saddle_vec3_add(saddle_vec3_t a, saddle_vec3_t b)
{
    return (saddle_vec3_t){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline saddle_vec3_t saddle_vec3_sub(saddle_vec3_t a, saddle_vec3_t b)
{
    return (saddle_vec3_t){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline saddle_vec3_t saddle_vec3_scale(float factor, saddle_vec3_t v)
{
    return (saddle_vec3_t){factor * v.x, factor * v.y, factor * v.z};
}

/** a + factor v. */
static inline saddle_vec3_t saddle_vec3_along(saddle_vec3_t a, float factor, saddle_vec3_t v)
{
    return (saddle_vec3_t){a.x + factor * v.x, a.y + factor * v.y, a.z + factor * v.z};
}

static inline float saddle_vec3_dot(saddle_vec3_t a, saddle_vec3_t b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline saddle_vec3_t saddle_vec3_cross(saddle_vec3_t a, saddle_vec3_t b)
{
    return (saddle_vec3_t){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline float saddle_vec3_length(saddle_vec3_t v)
{
    return sqrtf(saddle_vec3_dot(v, v));
}

#endif
