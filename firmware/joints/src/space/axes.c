#include "space/axes.h"

/* cos a + sin b, and cos b - sin a: two axes turned about the third. */
static saddle_vec3_t towards(saddle_vec3_t a, saddle_vec3_t b, saddle_sin_cos_t turn)
{
    return saddle_vec3_along(saddle_vec3_scale(turn.cos, a), turn.sin, b);
}

static saddle_vec3_t away(saddle_vec3_t b, saddle_vec3_t a, saddle_sin_cos_t turn)
{
    return saddle_vec3_along(saddle_vec3_scale(turn.cos, b), -turn.sin, a);
}

saddle_axes_t saddle_axes_about_x(const saddle_axes_t *axes, saddle_sin_cos_t turn)
{
    return (saddle_axes_t){axes->x, towards(axes->y, axes->z, turn), away(axes->z, axes->y, turn)};
}

saddle_axes_t saddle_axes_about_y(const saddle_axes_t *axes, saddle_sin_cos_t turn)
{
    return (saddle_axes_t){away(axes->x, axes->z, turn), axes->y, towards(axes->z, axes->x, turn)};
}

saddle_axes_t saddle_axes_about_z(const saddle_axes_t *axes, saddle_sin_cos_t turn)
{
    return (saddle_axes_t){towards(axes->x, axes->y, turn), away(axes->y, axes->x, turn), axes->z};
}
