/** Orientations: the axes of a body, seen from the world. */
#ifndef SADDLEWALK_AXES_H
#define SADDLEWALK_AXES_H

#include "math/elementary.h"
#include "space/vec3.h"

#include <saddlewalk/joints.h>

/** The body turned about its own x, y or z axis; `turn` holds the angle's sine and cosine. */
saddle_axes_t saddle_axes_about_x(const saddle_axes_t *axes, saddle_sin_cos_t turn);
saddle_axes_t saddle_axes_about_y(const saddle_axes_t *axes, saddle_sin_cos_t turn);
saddle_axes_t saddle_axes_about_z(const saddle_axes_t *axes, saddle_sin_cos_t turn);

/** A vector of the body, seen from the world. */
static inline saddle_vec3_t saddle_to_world(const saddle_axes_t *axes, saddle_vec3_t v)
{
    return (saddle_vec3_t){axes->x.x * v.x + axes->y.x * v.y + axes->z.x * v.z,
                           axes->x.y * v.x + axes->y.y * v.y + axes->z.y * v.z,
                           axes->x.z * v.x + axes->y.z * v.y + axes->z.z * v.z};
}

/** A vector of the world, seen from the body. */
static inline saddle_vec3_t saddle_to_body(const saddle_axes_t *axes, saddle_vec3_t v)
{
    return (saddle_vec3_t){saddle_vec3_dot(axes->x, v), saddle_vec3_dot(axes->y, v),
                           saddle_vec3_dot(axes->z, v)};
}

#endif
