/** Base of support and energy once more, in double precision and from the equations: what the tests
 *  of the supervisor expect. */
#ifndef SADDLEWALK_BALANCE_TWIN_H
#define SADDLEWALK_BALANCE_TWIN_H

#include "core_test.h"

#define BODY_MASS 63.3
#define PENDULUM (0.57 * 1.79)
#define FREQUENCY sqrt(GRAVITY / PENDULUM)

typedef struct {
    double x, y;
} point_t;

/** The disc around the middle of the feet, cut at +-depth along x_S. */
typedef struct {
    point_t centre, axis_x;
    double radius, depth;
} twin_base_t;

static inline point_t point_of(saddle_vec2_t v)
{
    return (point_t){(double)v.x, (double)v.y};
}

static inline twin_base_t twin_base(point_t left, point_t right, double depth, double factor)
{
    const double distance = hypot(left.x - right.x, left.y - right.y);
    return (twin_base_t){
        .centre = {0.5 * (left.x + right.x), 0.5 * (left.y + right.y)},
        .axis_x = {(left.y - right.y) / distance, (right.x - left.x) / distance},
        .radius = factor * 0.5 * distance,
        .depth = factor * depth,
    };
}

static inline point_t twin_to_saddle(const twin_base_t *base, point_t p)
{
    const double dx = p.x - base->centre.x;
    const double dy = p.y - base->centre.y;
    return (point_t){dx * base->axis_x.x + dy * base->axis_x.y,
                     dy * base->axis_x.x - dx * base->axis_x.y};
}

static inline point_t twin_to_task(const twin_base_t *base, point_t s)
{
    return (point_t){base->centre.x + s.x * base->axis_x.x - s.y * base->axis_x.y,
                     base->centre.y + s.x * base->axis_x.y + s.y * base->axis_x.x};
}

static inline bool twin_inside(const twin_base_t *base, point_t s, double slack)
{
    return hypot(s.x, s.y) <= base->radius + slack && fabs(s.x) <= base->depth + slack;
}

/** The nearest border point among all candidates: on the arc, on either edge, the four corners. */
static inline point_t twin_nearest_border(const twin_base_t *base, point_t p)
{
    const point_t s = twin_to_saddle(base, p);
    const double distance = hypot(s.x, s.y);
    const double square = base->radius * base->radius - base->depth * base->depth;
    const double edge = square > 0.0 ? sqrt(square) : 0.0;
    const point_t candidates[] = {
        {distance > 0.0 ? base->radius * s.x / distance : base->radius,
         distance > 0.0 ? base->radius * s.y / distance : 0.0},
        {base->depth, s.y},
        {-base->depth, s.y},
        {base->depth, edge},
        {base->depth, -edge},
        {-base->depth, edge},
        {-base->depth, -edge},
    };
    point_t best = s;
    double least = HUGE_VAL;
    for (size_t i = 0; i < COUNT_OF(candidates); i++) {
        const double way = hypot(candidates[i].x - s.x, candidates[i].y - s.y);
        if (twin_inside(base, candidates[i], 1e-12) && way < least) {
            least = way;
            best = candidates[i];
        }
    }
    return twin_to_task(base, best);
}

static inline double twin_margin(const twin_base_t *base, point_t p)
{
    const point_t border = twin_nearest_border(base, p);
    const double way = hypot(border.x - p.x, border.y - p.y);
    return twin_inside(base, twin_to_saddle(base, p), 0.0) ? way : -way;
}

/** Where the ray leaves the base, by bisection; at rest or outside the nearest border point. */
static inline point_t twin_exit(const twin_base_t *base, point_t p, point_t velocity)
{
    const double speed = hypot(velocity.x, velocity.y);
    if (speed < 1e-4 || !twin_inside(base, twin_to_saddle(base, p), 0.0)) {
        return twin_nearest_border(base, p);
    }
    double in = 0.0;
    double out = 3.0 * base->radius;
    point_t exit = p;
    for (int i = 0; i < 60; i++) {
        const double way = 0.5 * (in + out);
        exit = (point_t){p.x + way * velocity.x / speed, p.y + way * velocity.y / speed};
        if (twin_inside(base, twin_to_saddle(base, exit), 0.0)) {
            in = way;
        } else {
            out = way;
        }
    }
    return exit;
}

/** m g z_s of the paper's mean body: the highest of the pendulums over the feet. */
static inline double twin_potential(point_t left, point_t right, point_t p)
{
    const double from_left = hypot(p.x - left.x, p.y - left.y);
    const double from_right = hypot(p.x - right.x, p.y - right.y);
    const double lever = fmin(from_left, from_right);
    return BODY_MASS * GRAVITY * sqrt(PENDULUM * PENDULUM - lever * lever);
}

static inline double twin_kinetic(point_t velocity)
{
    return 0.5 * BODY_MASS * (velocity.x * velocity.x + velocity.y * velocity.y);
}

#endif
