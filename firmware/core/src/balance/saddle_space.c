#include "balance/saddle_space.h"

#include "math/elementary.h"
#include "math/vec2.h"

#include <math.h>
#include <saddlewalk/saddlewalk.h>

#define HALF_VERTICES (SADDLE_BOS_VERTICES / 2)

/* Slower counts as at rest. */
#define REST_M_S 1.0e-4f

saddle_bos_t saddle_bos_undefined(void)
{
    const saddle_vec2_t zero = {0.0f, 0.0f};
    saddle_bos_t bos;
    bos.centre_m = zero;
    bos.axis_x = zero;
    bos.radius_m = 0.0f;
    bos.half_depth_m = 0.0f;
    bos.defined = false;
    return bos;
}

/* [E15] [E16] */
saddle_bos_t saddle_bos(const saddle_vec2_t cop_m[2], float half_depth_m, float factor)
{
    const saddle_vec2_t left = cop_m[SADDLE_LEFT];
    const saddle_vec2_t right = cop_m[SADDLE_RIGHT];
    const saddle_vec2_t apart_m = saddle_vec2_sub(left, right);
    const float distance_m = saddle_vec2_length(apart_m);
    if (distance_m < SADDLE_FEET_DISTANCE_MIN_M) {
        return saddle_bos_undefined();
    }
    saddle_bos_t bos;
    bos.centre_m = saddle_vec2_scale(0.5f, saddle_vec2_add(left, right));
    bos.axis_x.x = apart_m.y / distance_m;
    bos.axis_x.y = -apart_m.x / distance_m;
    bos.radius_m = factor * 0.5f * distance_m;
    bos.half_depth_m = factor * half_depth_m;
    bos.defined = true;
    return bos;
}

/* Task space to saddle space, directions and places alike once the centre is taken off. */
static saddle_vec2_t to_saddle(const saddle_bos_t *bos, saddle_vec2_t v)
{
    return (saddle_vec2_t){saddle_vec2_dot(v, bos->axis_x),
                           v.y * bos->axis_x.x - v.x * bos->axis_x.y};
}

static saddle_vec2_t to_task_m(const saddle_bos_t *bos, saddle_vec2_t saddle_m)
{
    const saddle_vec2_t task_m = {
        bos->centre_m.x + saddle_m.x * bos->axis_x.x - saddle_m.y * bos->axis_x.y,
        bos->centre_m.y + saddle_m.x * bos->axis_x.y + saddle_m.y * bos->axis_x.x};
    return task_m;
}

/* Half the length of the straight edges; 0 for the plain disc. */
static float edge_half_length_m(const saddle_bos_t *bos)
{
    const float square = bos->radius_m * bos->radius_m - bos->half_depth_m * bos->half_depth_m;
    return square > 0.0f ? sqrtf(square) : 0.0f;
}

/* [E17] */
float saddle_bos_margin_m(const saddle_bos_t *bos, saddle_vec2_t point_m)
{
    const saddle_vec2_t place_m = to_saddle(bos, saddle_vec2_sub(point_m, bos->centre_m));
    const float x_m = saddle_magnitude(place_m.x);
    const float y_m = saddle_magnitude(place_m.y);
    const float centre_distance_m = saddle_vec2_length(place_m);
    const float to_arc_m = bos->radius_m - centre_distance_m;
    const float to_edge_m = bos->half_depth_m - x_m;

    if (to_edge_m >= 0.0f && to_arc_m >= 0.0f) {
        return saddle_smaller(to_arc_m, to_edge_m);
    }
    if (x_m * bos->radius_m <= bos->half_depth_m * centre_distance_m) {
        return to_arc_m;
    }
    const float corner_y_m = edge_half_length_m(bos);
    if (y_m <= corner_y_m) {
        return to_edge_m;
    }
    return -saddle_vec2_length((saddle_vec2_t){to_edge_m, y_m - corner_y_m});
}

static bool is_inside(const saddle_bos_t *bos, saddle_vec2_t place_m)
{
    return saddle_magnitude(place_m.x) <= bos->half_depth_m &&
           saddle_vec2_dot(place_m, place_m) <= bos->radius_m * bos->radius_m;
}

bool saddle_bos_contains(const saddle_bos_t *bos, saddle_vec2_t point_m)
{
    return bos->defined && is_inside(bos, to_saddle(bos, saddle_vec2_sub(point_m, bos->centre_m)));
}

/* How far the border is from an inner place along a unit direction, both in saddle space. */
static float distance_out_m(const saddle_bos_t *bos, saddle_vec2_t place_m, saddle_vec2_t direction)
{
    const float along_m = saddle_vec2_dot(place_m, direction);
    const float inside_m2 = bos->radius_m * bos->radius_m - place_m.x * place_m.x -
                            place_m.y * place_m.y + along_m * along_m;
    const float to_arc_m = (inside_m2 > 0.0f ? sqrtf(inside_m2) : 0.0f) - along_m;
    const float depth_m = bos->half_depth_m - (direction.x > 0.0f ? place_m.x : -place_m.x);
    const float slope = saddle_magnitude(direction.x);
    const bool edge_first = depth_m < to_arc_m * slope;
    return edge_first ? depth_m / slope : to_arc_m;
}

/* The nearest point of the border, in saddle space. */
static saddle_vec2_t nearest_border_m(const saddle_bos_t *bos, saddle_vec2_t place_m)
{
    const float corner_y_m = edge_half_length_m(bos);
    const float distance_m = saddle_vec2_length(place_m);
    const float x_m = saddle_magnitude(place_m.x);
    const float y_m = saddle_magnitude(place_m.y);
    const bool arc_nearer = bos->radius_m - distance_m < bos->half_depth_m - x_m;
    const bool faces_arc = x_m * bos->radius_m <= bos->half_depth_m * distance_m;
    saddle_vec2_t border_m = {bos->half_depth_m, saddle_smaller(y_m, corner_y_m)};
    if (is_inside(bos, place_m) ? arc_nearer : faces_arc) {
        const float stretch = distance_m > 0.0f ? bos->radius_m / distance_m : 0.0f;
        border_m.x = distance_m > 0.0f ? stretch * x_m : bos->radius_m;
        border_m.y = stretch * y_m;
    }
    border_m.x = place_m.x < 0.0f ? -border_m.x : border_m.x;
    border_m.y = place_m.y < 0.0f ? -border_m.y : border_m.y;
    return border_m;
}

/* [E26] */
saddle_vec2_t saddle_bos_exit_m(const saddle_bos_t *bos, saddle_vec2_t point_m,
                                saddle_vec2_t direction_m_s)
{
    if (!bos->defined) {
        return point_m;
    }
    const saddle_vec2_t place_m = to_saddle(bos, saddle_vec2_sub(point_m, bos->centre_m));
    const float speed_m_s = saddle_vec2_length(direction_m_s);
    if (speed_m_s < REST_M_S || !is_inside(bos, place_m)) {
        return to_task_m(bos, nearest_border_m(bos, place_m));
    }
    const saddle_vec2_t direction =
        to_saddle(bos, (saddle_vec2_t){direction_m_s.x / speed_m_s, direction_m_s.y / speed_m_s});
    const float out_m = distance_out_m(bos, place_m, direction);
    return to_task_m(bos, saddle_vec2_add(place_m, saddle_vec2_scale(out_m, direction)));
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

/* From the CoP that carries, the nearer one, to the CoM. */
static saddle_vec2_t lever_m(const saddle_vec2_t cop_m[2], saddle_vec2_t com_m)
{
    const saddle_vec2_t left = saddle_vec2_sub(com_m, cop_m[SADDLE_LEFT]);
    const saddle_vec2_t right = saddle_vec2_sub(com_m, cop_m[SADDLE_RIGHT]);
    return saddle_vec2_dot(right, right) < saddle_vec2_dot(left, left) ? right : left;
}

/* [E18] */
saddle_surface_t saddle_surface(const saddle_vec2_t cop_m[2], saddle_vec2_t place_m,
                                float pendulum_m)
{
    const saddle_vec2_t lever = lever_m(cop_m, place_m);
    const float height_m2 = pendulum_m * pendulum_m - lever.x * lever.x - lever.y * lever.y;
    const float lowest_m = SADDLE_LOWEST_PENDULUM * pendulum_m;
    const bool reached = height_m2 > lowest_m * lowest_m;
    return (saddle_surface_t){lever, reached ? sqrtf(height_m2) : 0.0f, reached};
}

/* [E18] */
saddle_vec2_t saddle_gravity_n(const saddle_surface_t *surface, float mass_kg)
{
    const float stiffness_n_m =
        surface->reached ? mass_kg * SADDLE_GRAVITY_M_S2 / surface->height_m : 0.0f;
    return saddle_vec2_scale(stiffness_n_m, surface->lever_m);
}
