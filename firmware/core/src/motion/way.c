#include "motion/way.h"

#include "math/blend.h"
#include "math/bytes.h"
#include "math/elementary.h"
#include "math/fixed.h"
#include "math/vec2.h"
#include "model/gait_model.h"

#include <math.h>

#define SHIFT_MAX_M 2.0f
#define SPEED_MIN_M_S 0.01f /* the turning rate changes in a slower step as if it were this fast */

/* Halves a float's digits. */
#define SPLITTER 4097.0f

enum { BEHIND = 0, AHEAD = 1 };

static bool is_zero(float x)
{
    return x >= 0.0f && x <= 0.0f;
}

static bool is_bent(const saddle_arc_t *arc)
{
    return !is_zero(arc->curvature_1_m) || !is_zero(arc->before_1_m);
}

static const saddle_arc_t *arc_at(const saddle_arc_t arcs[2], float along_m)
{
    return &arcs[along_m < 0.0f ? BEHIND : AHEAD];
}

void saddle_way_begin(saddle_way_t *way)
{
    saddle_clear(way->arcs, sizeof way->arcs);
    way->curvature = 0;
    way->turn_rate_rad_s = 0.0f;
    way->bent = false;
}

/* What rounding took from a product. [Dekker 1971] */
static float rounded_off(float a, float b, float product)
{
    const float upper_a = SPLITTER * a - (SPLITTER * a - a);
    const float upper_b = SPLITTER * b - (SPLITTER * b - b);
    const float lower_a = a - upper_a;
    const float lower_b = b - upper_b;
    return ((upper_a * upper_b - product) + upper_a * lower_b + lower_a * upper_b) +
           lower_a * lower_b;
}

/* [E48] The arc ahead has a turning rate at a speed > 0: the quotient in twice a float's digits, so that
 * no heading drifts. */
static void turn_ahead(saddle_way_t *way, float turn_rate_rad_s, float speed_m_s)
{
    const float curvature_1_m = turn_rate_rad_s / speed_m_s;
    const float product = curvature_1_m * speed_m_s;
    const float rest_rad_s =
        turn_rate_rad_s - product - rounded_off(curvature_1_m, speed_m_s, product);
    way->turn_rate_rad_s = turn_rate_rad_s;
    way->arcs[AHEAD].curvature_1_m = curvature_1_m;
    way->curvature =
        saddle_speed_from_m_s(curvature_1_m) + saddle_speed_from_m_s(rest_rad_s / speed_m_s);
}

void saddle_way_join(saddle_way_t *way, float speed_m_s)
{
    saddle_way_begin(way);
    turn_ahead(way, way->wanted_rad_s, speed_m_s);
    way->arcs[BEHIND] = way->arcs[AHEAD];
    way->bent = is_bent(&way->arcs[AHEAD]);
}

/* The point on an arc through the stance foot, in its heading. */
static saddle_vec2_t chord_m(float curvature_1_m, float along_m, saddle_sin_cos_t half)
{
    const float length_m = is_zero(curvature_1_m) ? along_m : 2.0f * half.sin / curvature_1_m;
    return (saddle_vec2_t){length_m * half.cos, length_m * half.sin};
}

static int64_t to_nm(float length_m)
{
    return (int32_t)(1.0e9f * saddle_clamp(length_m, -SHIFT_MAX_M, SHIFT_MAX_M));
}

/* The stance foot's place goes along an arc. way_nm: the same as along_m; turn: its angle. */
static void move_on(saddle_way_t *way, const saddle_arc_t *arc, float along_m, int64_t way_nm,
                    saddle_fixed_t turn)
{
    way->walked_nm += (uint32_t)way_nm;
    int64_t along_nm = way_nm;
    int64_t across_nm = 0;
    if (!is_zero(arc->curvature_1_m)) {
        const saddle_sin_cos_t half = saddle_sin_cos(0.5f * arc->curvature_1_m * along_m);
        const saddle_vec2_t chord = chord_m(arc->curvature_1_m, along_m, half);
        along_nm = to_nm(chord.x);
        across_nm = to_nm(chord.y);
    }
    if (way->heading == 0) {
        way->origin_x_nm += along_nm;
        way->origin_y_nm += across_nm;
    } else {
        const saddle_sin_cos_t heading = saddle_sin_cos(saddle_speed_to_m_s(way->heading));
        const int64_t x_nm =
            saddle_share_nm(along_nm, heading.cos) - saddle_share_nm(across_nm, heading.sin);
        const int64_t y_nm =
            saddle_share_nm(along_nm, heading.sin) + saddle_share_nm(across_nm, heading.cos);
        way->origin_x_nm += x_nm;
        way->origin_y_nm += y_nm;
    }
    way->heading = saddle_angle_sum(way->heading, turn);
}

/* [E48] The turning rate of the next arc. */
static float next_rate_rad_s(const saddle_way_t *way, const saddle_model_t *model, float speed_m_s,
                             float step_m)
{
    const float change_rad_s =
        model->config.turn_acceleration_rad_s2 * step_m / saddle_larger(speed_m_s, SPEED_MIN_M_S);
    const float max_rad_s = saddle_turn_max_rad_s(model, speed_m_s);
    const float near_rad_s = saddle_clamp(way->wanted_rad_s, way->turn_rate_rad_s - change_rad_s,
                                          way->turn_rate_rad_s + change_rad_s);
    return saddle_clamp(near_rad_s, -max_rad_s, max_rad_s);
}

/* No planned step is shorter: what fades on it has gone when the foot lands. */
static float shortest_step_m(const saddle_model_t *model)
{
    const saddle_config_t *config = &model->config;
    return 2.0f * config->half_step_intercept_m *
           saddle_smaller(config->step_length_factor_left, config->step_length_factor_right);
}

bool saddle_way_turns(const saddle_way_t *way)
{
    return way->bent || !is_zero(way->wanted_rad_s);
}

void saddle_way_land(saddle_way_t *way, const saddle_model_t *model, float speed_m_s,
                     int64_t way_nm)
{
    saddle_arc_t *behind = &way->arcs[BEHIND];
    saddle_arc_t *ahead = &way->arcs[AHEAD];
    const float step_m = 1.0e-9f * (float)(int32_t)way_nm;
    const saddle_fixed_t turn = way->curvature == 0 ? 0 : saddle_angle(way->curvature, way_nm);
    move_on(way, ahead, step_m, way_nm, turn);
    if (!saddle_way_turns(way)) {
        return;
    }
    const float rate_rad_s = next_rate_rad_s(way, model, speed_m_s, step_m);
    *behind = *ahead;
    behind->begin_m = -step_m;
    if (is_zero(rate_rad_s)) {
        saddle_clear(ahead, sizeof *ahead);
        way->curvature = 0;
        way->turn_rate_rad_s = 0.0f;
    } else {
        turn_ahead(way, rate_rad_s, speed_m_s);
    }
    ahead->before_1_m = behind->curvature_1_m - ahead->curvature_1_m;
    ahead->fade_m = shortest_step_m(model);
    way->bent = is_bent(behind) || is_bent(ahead);
}

void saddle_way_shift(saddle_way_t *way, float way_m)
{
    saddle_arc_t *behind = &way->arcs[BEHIND];
    const float turn_rad = behind->curvature_1_m * way_m;
    move_on(way, behind, way_m, to_nm(way_m), saddle_speed_from_m_s(turn_rad));
    behind->begin_m -= way_m;
}

void saddle_way_of(const saddle_plan_t *plan, saddle_arc_t arcs[2])
{
    saddle_clear(arcs, 2u * sizeof *arcs);
    arcs[BEHIND].curvature_1_m = plan->curvature_1_m[BEHIND];
    arcs[AHEAD].curvature_1_m = plan->curvature_1_m[AHEAD];
}

/* The direction across, which turns without a jump of its rate where the arcs meet: what it is off the
 * arc's own, and that per way. */
static saddle_sample_t lag_at(const saddle_arc_t *arc, float along_m)
{
    const saddle_blend_t fade = {{0.0f, arc->before_1_m}, arc->begin_m, arc->fade_m};
    if (along_m < arc->begin_m) {
        return (saddle_sample_t){0.0f, 0.0f};
    }
    return saddle_blend_at(&fade, along_m);
}

/* [E47] */
saddle_on_ground_t saddle_way_to_ground(const saddle_arc_t arcs[2], const saddle_course_t *course)
{
    const saddle_arc_t *arc = arc_at(arcs, course->place_m.x);
    const float along_m = course->place_m.x;
    const float turn_rad = arc->curvature_1_m * along_m;
    const saddle_sample_t lag = lag_at(arc, along_m);
    const saddle_sin_cos_t half = saddle_sin_cos(0.5f * turn_rad);
    const saddle_sin_cos_t yaw = saddle_sin_cos(turn_rad + lag.value);
    const saddle_vec2_t forward = {half.cos * half.cos - half.sin * half.sin,
                                   2.0f * half.sin * half.cos};
    const saddle_vec2_t across = {-yaw.sin, yaw.cos};
    const float sweep_m_s =
        (arc->curvature_1_m + lag.slope) * course->rate_m_s.x * course->place_m.y;
    saddle_on_ground_t ground;
    ground.position_m = saddle_vec2_add(chord_m(arc->curvature_1_m, along_m, half),
                                        saddle_vec2_scale(course->place_m.y, across));
    ground.velocity_m_s.x =
        course->rate_m_s.x * forward.x + course->rate_m_s.y * across.x - sweep_m_s * yaw.cos;
    ground.velocity_m_s.y =
        course->rate_m_s.x * forward.y + course->rate_m_s.y * across.y - sweep_m_s * yaw.sin;
    ground.yaw_rad = turn_rad + lag.value;
    return ground;
}

saddle_vec2_t saddle_way_point_to_ground(const saddle_arc_t arcs[2], saddle_vec2_t place_m)
{
    const saddle_course_t rests = {place_m, {0.0f, 0.0f}};
    return saddle_way_to_ground(arcs, &rests).position_m;
}

/* [E47] Of an arc through the stance foot: the angle and the distance as seen from its centre. */
static saddle_vec2_t along_arc(float curvature_1_m, saddle_vec2_t position_m)
{
    if (is_zero(curvature_1_m)) {
        return position_m;
    }
    const float side = curvature_1_m * position_m.x;
    const float front = 1.0f - curvature_1_m * position_m.y;
    const float distance = sqrtf(side * side + front * front);
    const float inward =
        2.0f * position_m.y - curvature_1_m * saddle_vec2_dot(position_m, position_m);
    return (saddle_vec2_t){saddle_asin(side / distance) / curvature_1_m,
                           inward / (1.0f + distance)};
}

saddle_vec2_t saddle_way_from_ground(const saddle_arc_t arcs[2], saddle_vec2_t position_m)
{
    return along_arc(arc_at(arcs, position_m.x)->curvature_1_m, position_m);
}

/* [E49] */
float saddle_lean_m(const saddle_model_t *model, float curvature_1_m, float speed_m_s)
{
    const float w = model->body.natural_frequency_rad_s;
    return curvature_1_m * speed_m_s * speed_m_s / (w * w);
}

/* A small angle's turn. */
static saddle_vec2_t turned(saddle_vec2_t v, float angle_rad)
{
    return (saddle_vec2_t){v.x - angle_rad * v.y, v.y + angle_rad * v.x};
}

/* As seen from where the CoM is, on the arc that it is on. */
void saddle_way_measured(const saddle_arc_t arcs[2], saddle_vec2_t com_m,
                         saddle_measurement_t *measured)
{
    const saddle_arc_t *arc = arc_at(arcs, com_m.x);
    const saddle_sample_t lag = lag_at(arc, com_m.x);
    const saddle_vec2_t aside_m = {0.0f, com_m.y};
    for (int side = 0; side < 2; side++) {
        saddle_vec2_t *cop_m = &measured->foot[side].cop_m;
        const saddle_vec2_t from_line_m = turned(saddle_vec2_add(aside_m, *cop_m), lag.value);
        *cop_m = saddle_vec2_sub(along_arc(arc->curvature_1_m, from_line_m), aside_m);
    }
    saddle_vec2_t *velocity_m_s = &measured->com.velocity_m_s;
    velocity_m_s->x /= 1.0f - (arc->curvature_1_m + lag.slope) * com_m.y;
    velocity_m_s->y += lag.value * velocity_m_s->x;
}
