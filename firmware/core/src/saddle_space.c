#include <math.h>
#include <saddlewalk/saddle_math.h>
#include <saddlewalk/saddle_space.h>

#define HALF_VERTICES (SADDLE_BOS_VERTICES / 2)

static float length_m(float x_m, float y_m)
{
    return sqrtf(x_m * x_m + y_m * y_m);
}

saddle_bos_t saddle_bos(const saddle_vec2_t cop_m[2], float half_depth_m)
{
    const saddle_vec2_t left = cop_m[SADDLE_LEFT];
    const saddle_vec2_t right = cop_m[SADDLE_RIGHT];
    const float dx_m = left.x - right.x;
    const float dy_m = left.y - right.y;
    const float distance_m = length_m(dx_m, dy_m);
    saddle_bos_t bos = {{0.0f, 0.0f}, {0.0f, 0.0f}, 0.0f, 0.0f, false};
    if (distance_m < SADDLE_FEET_DISTANCE_MIN_M) {
        return bos;
    }
    bos.centre_m.x = 0.5f * (left.x + right.x);
    bos.centre_m.y = 0.5f * (left.y + right.y);
    bos.axis_x.x = dy_m / distance_m;
    bos.axis_x.y = -dx_m / distance_m;
    bos.radius_m = 0.5f * distance_m;
    bos.half_depth_m = half_depth_m;
    bos.defined = true;
    return bos;
}

/* Half the length of the straight edges; 0 for the plain disc. */
static float edge_half_length_m(const saddle_bos_t *bos)
{
    const float square = bos->radius_m * bos->radius_m - bos->half_depth_m * bos->half_depth_m;
    return square > 0.0f ? sqrtf(square) : 0.0f;
}

float saddle_bos_margin_m(const saddle_bos_t *bos, saddle_vec2_t point_m)
{
    const float dx_m = point_m.x - bos->centre_m.x;
    const float dy_m = point_m.y - bos->centre_m.y;
    const float x_m = saddle_magnitude(dx_m * bos->axis_x.x + dy_m * bos->axis_x.y);
    const float y_m = saddle_magnitude(dy_m * bos->axis_x.x - dx_m * bos->axis_x.y);
    const float centre_distance_m = length_m(x_m, y_m);
    const float to_arc_m = bos->radius_m - centre_distance_m;
    const float to_edge_m = bos->half_depth_m - x_m;
    const float corner_y_m = edge_half_length_m(bos);

    if (to_edge_m >= 0.0f && to_arc_m >= 0.0f) {
        return to_arc_m < to_edge_m ? to_arc_m : to_edge_m;
    }
    if (x_m * bos->radius_m <= bos->half_depth_m * centre_distance_m) {
        return to_arc_m;
    }
    if (y_m <= corner_y_m) {
        return to_edge_m;
    }
    return -length_m(to_edge_m, y_m - corner_y_m);
}

/* The arc around +y_S spans +-half_angle from y_S; a plain disc is a regular polygon. */
static float arc_half_angle_rad(const saddle_bos_t *bos)
{
    const float regular = 0.5f * SADDLE_PI * (float)(HALF_VERTICES - 1) / (float)HALF_VERTICES;
    const float corner = saddle_asin(saddle_clamp(bos->half_depth_m / bos->radius_m, 0.0f, 1.0f));
    return corner < regular ? corner : regular;
}

void saddle_bos_polygon(const saddle_bos_t *bos, saddle_vec2_t vertices_m[SADDLE_BOS_VERTICES])
{
    const float half_angle = bos->defined ? arc_half_angle_rad(bos) : 0.0f;
    for (int i = 0; i < HALF_VERTICES; i++) {
        const float angle = half_angle * (1.0f - 2.0f * (float)i / (float)(HALF_VERTICES - 1));
        const float x_m = bos->radius_m * saddle_sin(angle);
        const float y_m = bos->radius_m * saddle_cos(angle);
        const float turned_x_m = x_m * bos->axis_x.x - y_m * bos->axis_x.y;
        const float turned_y_m = x_m * bos->axis_x.y + y_m * bos->axis_x.x;
        vertices_m[i].x = bos->centre_m.x + turned_x_m;
        vertices_m[i].y = bos->centre_m.y + turned_y_m;
        vertices_m[i + HALF_VERTICES].x = bos->centre_m.x - turned_x_m;
        vertices_m[i + HALF_VERTICES].y = bos->centre_m.y - turned_y_m;
    }
}

bool saddle_gravity_force(const saddle_vec2_t cop_m[2], saddle_vec2_t com_m, float pendulum_m,
                          float mass_kg, saddle_vec2_t *force_n)
{
    float x_m = com_m.x - cop_m[SADDLE_LEFT].x;
    float y_m = com_m.y - cop_m[SADDLE_LEFT].y;
    const float right_x_m = com_m.x - cop_m[SADDLE_RIGHT].x;
    const float right_y_m = com_m.y - cop_m[SADDLE_RIGHT].y;
    if (right_x_m * right_x_m + right_y_m * right_y_m < x_m * x_m + y_m * y_m) {
        x_m = right_x_m;
        y_m = right_y_m;
    }
    const float height_m2 = pendulum_m * pendulum_m - x_m * x_m - y_m * y_m;
    const float lowest_m = SADDLE_LOWEST_PENDULUM * pendulum_m;
    const bool reached = height_m2 > lowest_m * lowest_m;
    const float stiffness_n_m =
        reached ? mass_kg * SADDLE_GRAVITY_M_S2 / sqrtf(height_m2) : 0.0f;
    force_n->x = stiffness_n_m * x_m;
    force_n->y = stiffness_n_m * y_m;
    return reached;
}
