#include "space/quaternion.h"

#include "space/vec3.h"

#include <math.h>

/* Shorter is no direction. */
#define LENGTH_MIN 1.0e-6f

static const saddle_quaternion_t UPRIGHT = {1.0f, 0.0f, 0.0f, 0.0f};

static saddle_quaternion_t of_length_one(saddle_quaternion_t q)
{
    const float length = sqrtf(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    if (!(length > LENGTH_MIN)) {
        return UPRIGHT;
    }
    return (saddle_quaternion_t){q.w / length, q.x / length, q.y / length, q.z / length};
}

/* Half-way between the direction and the vertical lies half of the turn. */
saddle_quaternion_t saddle_quaternion_of_up(saddle_vec3_t up)
{
    const float length = saddle_vec3_length(up);
    return of_length_one((saddle_quaternion_t){length + up.z, up.y, -up.x, 0.0f});
}

saddle_quaternion_t saddle_quaternion_turned(saddle_quaternion_t q, saddle_vec3_t rate_rad_s,
                                             float dt_s)
{
    const saddle_vec3_t r = saddle_vec3_scale(0.5f * dt_s, rate_rad_s);
    return of_length_one((saddle_quaternion_t){
        q.w - q.x * r.x - q.y * r.y - q.z * r.z, q.x + q.w * r.x + q.y * r.z - q.z * r.y,
        q.y + q.w * r.y + q.z * r.x - q.x * r.z, q.z + q.w * r.z + q.x * r.y - q.y * r.x});
}

saddle_axes_t saddle_quaternion_axes(saddle_quaternion_t q)
{
    const float x2 = 2.0f * q.x;
    const float y2 = 2.0f * q.y;
    const float z2 = 2.0f * q.z;
    return (saddle_axes_t){{1.0f - y2 * q.y - z2 * q.z, x2 * q.y + z2 * q.w, x2 * q.z - y2 * q.w},
                           {x2 * q.y - z2 * q.w, 1.0f - x2 * q.x - z2 * q.z, y2 * q.z + x2 * q.w},
                           {x2 * q.z + y2 * q.w, y2 * q.z - x2 * q.w, 1.0f - x2 * q.x - y2 * q.y}};
}
