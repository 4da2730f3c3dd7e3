/* Random schedules of commands, watched at 1 kHz: what must hold of every plan.
 *
 * A schedule is a random body, ankle model, asymmetry and shape of the CoM's path, and 30 s of
 * commands at irregular ticks; then a stand. Between the ticks the plan is asked for every millisecond, and at the next tick it
 * must be the tick's own. Positions: each channel moves by what its reported velocities say (mean
 * value: between the smaller and the larger one, times the time), within its speed bound, to
 * JUMP_M. The bounds are derived where they are computed, from these facts of the plan:
 *
 *   v the speed of the CoM, L the half step, W the step width, A = W / (2 pi max(v, 0.5)),
 *   a the acceleration, r = v / L the quarters per second; a minimum-jerk profile has a slope
 *   of at most 1.875 and a curvature of at most 5.774; erf a slope of at most 2 / sqrt(pi).
 *
 * Excepted, as in the paper: z of the CoM jumps at landings under `erf`, and under `rigid` too if the
 * shape of its path has it nearer to one foot there (every other check of it
 * holds), and what the erf's tails leave at the foot via points: pitch and z may jump there by
 * what erfc says. */
#include "walks.h"

#include <string.h>

#define SCHEDULE_US 30000000u
#define QUERY_US 1000u
#define JUMP_M 1e-5
#define JUMP_M_S 1e-5   /* rounding of a velocity, some steps in a row */
#define LANDING_M 2e-7  /* rounding of a position, and of the way to the nanometre */
#define DISTANCE_M 2e-5 /* what a trapezium a millisecond misses at the kinks of the speed */
#define EVENT_S 5e-5    /* rounding of times: with EVENT_SHARE, EVENT_WAY_M at the speed */
#define EVENT_SHARE 3e-6
#define EVENT_WAY_M 3e-7
#define AT_REST_M_S 1e-5 /* slower, a position's last digit is milliseconds */
#define MIN_JERK_SLOPE 1.875
#define MIN_JERK_CURVATURE 5.774
#define ERF_SLOPE 1.1284
#define SLOWEST_SHAPED_M_S 0.01
#define FAILURES_SHOWN 10

enum { COM_X, COM_Y, COM_Z, LEFT_X, LEFT_Y, LEFT_Z, RIGHT_X, RIGHT_Y, RIGHT_Z, MOVES };

/* The quarter of the stride that a plan is in, as its outputs tell it. */
typedef struct {
    double half, width, amplitude, vertical;
    double off_y, off_slope, off_z, off_climb; /* what fades out: mismatches where it began */
} quarter_t;

typedef struct {
    double toe_off_us, via_us, heel_us; /* when they are predicted to be */
} events_t;

typedef struct {
    uint64_t seed, random;
    saddle_config_t config;
    saddle_context_t context;
    saddle_input_t input;
    saddle_plan_t plan; /* the last one, at plan_us */
    uint64_t plan_us;
    quarter_t quarter;
    events_t events;
    double widest, narrowest, fastest, longest_half, steepest_way;
    double first_way_m, way_m; /* way by position and by speed */
    bool same_command;
    int failures;
} walk_t;

/* Largest shares of the bounds that were used. */
static struct {
    double move[MOVES], pitch, vx, vy, vz, distance_m, landing_m, event_s;
} used;

static void expect(walk_t *walk, bool holds, const char *what, double value, double bound)
{
    if (!holds && walk->failures++ == 0) {
        printf("FAIL seed %llu at %.6f s: %s: %.9g, bound %.9g\n", (unsigned long long)walk->seed,
               1.0e-6 * (double)walk->plan_us, what, value, bound);
    }
}

static void within(walk_t *walk, double value, double bound, double *largest_share,
                   const char *what)
{
    expect(walk, fabs(value) <= bound, what, value, bound);
    keep_larger(largest_share, value / bound);
}

static bool steps(const saddle_plan_t *plan)
{
    return plan->step_length_m > 0.0f;
}

static bool to_landing(const saddle_plan_t *plan)
{
    return plan->phase % 2u == 0u;
}

static bool same_quarter(const saddle_plan_t *a, const saddle_plan_t *b)
{
    return steps(a) == steps(b) && a->phase == b->phase && a->step_count == b->step_count;
}

static double pendulum_m(const walk_t *walk)
{
    return (double)walk->context.model.body.pendulum_m;
}

/* The legs have lengths of their own: where the CoM is nearer to the one foot, z jumps. */
static bool shaped_legs(const walk_t *walk)
{
    return walk->config.ankle != SADDLE_ANKLE_CYCLOID &&
           ((double)walk->config.lateral_offset_m != 0.0 ||
            (double)walk->config.lateral_delay_rad != 0.0);
}

static bool is_erf(const walk_t *walk)
{
    return walk->config.ankle == SADDLE_ANKLE_ERF;
}

/* ---- bounds -------------------------------------------------------------------------------- */

/* The shape of the CoM's path, c + A cos(angle - lag): the paper's in a last swing. */
typedef struct {
    double y, y_lag, z, z_lag; /* z_lag in gait phase */
} shape_t;

static shape_t shape_of(const walk_t *walk, const saddle_plan_t *now)
{
    const saddle_config_t *config = &walk->config;
    if (!to_landing(now) && !(now->landing_m.x > 0.0f)) {
        return (shape_t){0.0, 0.0, 0.0, 0.0};
    }
    return (shape_t){(double)config->lateral_offset_m, (double)config->lateral_delay_rad,
                     (double)config->vertical_offset_m, 0.5 * (double)config->vertical_delay_rad};
}

/* How much the slopes of a wave of amplitude A per half step may differ from those of the quarter
 * before, where it lags: at the foot via point it has a slope of A sin(lag) then. */
static double off_slope(double now, double old, double lag, bool beside)
{
    return 0.5 * PI * (beside ? (now + old) * fabs(sin(lag)) : fabs(now - old));
}

/* The quarter that `now` has just entered. At a foot via point without a lag the slope is continuous
 * and the shapes differ in y; at a landing they meet in y and differ in slope by their
 * amplitudes. A lag mixes the two. */
static quarter_t enter_quarter(const walk_t *walk, const saddle_plan_t *now)
{
    const double speed = (double)now->speed_m_s;
    const double slack_m = 2e-4; /* the sample is up to a query after the via point */
    const quarter_t *old = &walk->quarter;
    quarter_t quarter = {.half = 0.5 * (double)now->step_length_m,
                         .width = (double)now->step_width_m};
    quarter.amplitude = 1.01 * quarter.width / (2.0 * PI * fmax(speed, 0.5));
    quarter.vertical = 1.01 * ((double)walk->config.vertical_slope_s * speed +
                               (double)walk->config.vertical_intercept_m);
    const bool beside = to_landing(now);
    const double angle = beside ? 0.0 : -0.5 * PI;
    const double old_half = old->half > 0.0 ? old->half : quarter.half;
    const shape_t shape = shape_of(walk, now);
    const double outward = now->support == (uint8_t)SADDLE_LEFT ? 1.0 : -1.0;
    const double gap = 0.5 * quarter.width - quarter.amplitude;
    const double beside_z = sqrt(pendulum_m(walk) * pendulum_m(walk) - gap * gap);
    const double y = (double)now->com_m.y - (double)now->foot_m[now->support].y;
    const double reference_y =
        outward * (quarter.amplitude * cos(angle - shape.y_lag) - 0.5 * quarter.width) + shape.y;
    const double reference_z =
        beside_z + shape.z - quarter.vertical * pow(sin(angle - shape.z_lag), 2.0);
    const double lag = (double)walk->config.lateral_delay_rad;
    quarter.off_y = fabs(y - reference_y) + slack_m;
    quarter.off_z = fabs((double)now->com_m.z - reference_z) + slack_m;
    quarter.off_slope =
        1e-3 + off_slope(quarter.amplitude / quarter.half, old->amplitude / old_half, lag, beside);
    quarter.off_climb = PI * fabs(sin((double)walk->config.vertical_delay_rad)) *
                        (quarter.vertical / quarter.half + old->vertical / old_half);
    if (!beside && !(now->landing_m.x > 0.0f)) { /* the lag ends */
        quarter.off_slope += 0.5 * PI * (1.0 - cos(lag)) * old->amplitude / old_half;
    }
    return quarter;
}

typedef struct {
    double move[MOVES]; /* m/s */
    double pitch;       /* rad/s */
    double vx, vy, vz;  /* m/s^2 */
    double tail;        /* rad: what erf leaves at a foot via point */
} bounds_t;

/* Both feet stand and the CoM shifts by at most half the widest step in shift_time_s. */
static bounds_t standing_bounds(const walk_t *walk)
{
    const double shift_s = (double)walk->config.shift_time_s;
    const double way = 0.5 * walk->widest;
    const double vy = MIN_JERK_SLOPE * way / shift_s;
    const double ay = MIN_JERK_CURVATURE * way / (shift_s * shift_s);
    const double z = 0.9 * pendulum_m(walk);
    bounds_t bounds = {.vx = (double)walk->config.acceleration_m_s2, .vy = ay};
    bounds.move[COM_Y] = vy;
    bounds.move[COM_Z] = way * vy / z;
    bounds.vz = 1.1 * (vy * vy + way * ay) / z;
    return bounds;
}

/* Farthest that the CoM is from its stance foot across: W / 2 where it lands, and the shape's part. */
static double aside_bound(const walk_t *walk)
{
    return (0.5 + fabs(sin((double)walk->config.lateral_delay_rad)) / PI) * walk->widest +
           fabs((double)walk->config.lateral_offset_m);
}

/* Largest toe-off angle [E13]: the leg from the CoM, no higher than l_p or the shape's offset above
 * it, to a foot at L, W / 2. */
static double toe_off_bound(const walk_t *walk, double half)
{
    const double high = pendulum_m(walk) + fabs((double)walk->config.vertical_offset_m);
    const double leg = hypot(hypot(high, half), aside_bound(walk));
    const double sine = (leg - pendulum_m(walk)) / (2.0 * (double)walk->config.cop_range_m);
    return 2.0 * asin(fmin(sine, 1.0));
}

static double pitch_bound(const walk_t *walk, const quarter_t *quarter, double speed,
                          const double *move)
{
    const double r = speed / quarter->half;
    const double toe_off = toe_off_bound(walk, walk->longest_half);
    if (walk->config.ankle == SADDLE_ANKLE_RIGID) {
        return 0.0;
    }
    if (!is_erf(walk)) { /* leg = hypot(x, y, z); angle = 2 asin(elongation / 2 d_h) */
        const double leg =
            (quarter->half * speed + aside_bound(walk) * move[COM_Y]) / (0.9 * pendulum_m(walk)) +
            move[COM_Z];
        const double cosine = fmax(cos(0.5 * toe_off), 0.2);
        return leg / ((double)walk->config.cop_range_m * cosine) + MIN_JERK_SLOPE * toe_off * r;
    }
    /* theta(u), u = (lead - way to the saddle via point) / (v tau): a slowing or rising v adds
     * u a / v to du/dt, and |u| exp(-u^2) is at most 0.429. */
    const double tau = (double)walk->config.ankle_time_constant_s;
    const double shaped = fmax(speed, SLOWEST_SHAPED_M_S);
    const double heel = (double)walk->config.heel_strike_max_rad;
    const double change = (double)walk->config.acceleration_m_s2 / shaped;
    const double erf_rate = ERF_SLOPE * (1.0 / tau + 0.429 * change);
    const double swing = MIN_JERK_SLOPE * r * (2.0 * toe_off + heel) + 0.484 * heel * change;
    return (toe_off + heel) * erf_rate + swing;
}

static void com_bounds(const walk_t *walk, const quarter_t *q, double speed, bounds_t *bounds)
{
    const double a = (double)walk->config.acceleration_m_s2;
    const double r = speed / q->half;
    const double wave = 0.5 * PI;
    /* y = A cos(wave x / L) + mismatch of value off_y and slope off_slope */
    const double dy = wave * q->amplitude + MIN_JERK_SLOPE * q->off_y + q->off_slope * q->half;
    const double ddy =
        wave * wave * q->amplitude + MIN_JERK_CURVATURE * q->off_y + 4.0 * q->off_slope * q->half;
    /* z = const - dZ sin^2(wave x / L) + mismatch */
    const double dz = wave * q->vertical + MIN_JERK_SLOPE * q->off_z + q->off_climb * q->half;
    const double ddz = 2.0 * wave * wave * q->vertical + MIN_JERK_CURVATURE * q->off_z +
                       4.0 * q->off_climb * q->half;
    bounds->move[COM_X] = speed;
    bounds->move[COM_Y] = dy * r;
    bounds->move[COM_Z] = dz * r;
    bounds->vx = a;
    bounds->vy = ddy * r * r + dy * a / q->half;
    bounds->vz = ddz * r * r + dz * a / q->half;
}

/* Steepest change of a person's way with the CoM's: x = 2 L (2 J(s^skew) / J_end - 1), p = x_com / 2 L;
 * s^(skew - 1) is steepest at the end, or for a skew below 1 before J comes into play. */
static double way_bound(const walk_t *walk)
{
    const saddle_config_t *config = &walk->config;
    const double length = (double)config->swing_end - (double)config->swing_begin;
    const double skew = (double)config->swing_skew;
    const double end = fmin((1.0 - (double)config->swing_begin) / length, 1.0);
    double steepest = 0.0;
    for (int k = 1; k <= 1000 && skew > 0.0; k++) {
        const double s = 0.001 * k;
        const double u = pow(s, skew);
        steepest = fmax(steepest, 30.0 * u * u * (1.0 - u) * (1.0 - u) * skew * u / s);
    }
    return 2.02 * steepest / length / min_jerk(pow(end, skew));
}

/* x = line x_com / y_com, steepest beside the stance foot: 1 / (1/2 - 1/pi) line / W; the lift-off
 * offset, at most 2 L times what the widths differ by, fades over half a swing or a quarter of one;
 * so do y, across the widest step, and z, over the clearance. */
static void foot_bounds(const walk_t *walk, const quarter_t *q, double speed, bounds_t *bounds)
{
    const double r = speed / q->half;
    const double widths = walk->widest / walk->narrowest;
    const double fade = 2.0 * MIN_JERK_SLOPE * r;
    const double line = 5.51 * widths * speed + fade * 2.0 * q->half * fmax(1.0, widths - 1.0);
    const double x = fmax(line, walk->steepest_way * speed + fade * 4.0 * walk->longest_half);
    const double y = fade * walk->widest;
    const double z = fade * (double)walk->config.swing_clearance_m;
    for (int foot = LEFT_X; foot <= RIGHT_X; foot += RIGHT_X - LEFT_X) {
        bounds->move[foot] = x;
        bounds->move[foot + 1] = y;
        bounds->move[foot + 2] = z;
    }
}

static bounds_t walking_bounds(const walk_t *walk, const quarter_t *quarter, double speed)
{
    bounds_t bounds = {.tail = 0.0};
    com_bounds(walk, quarter, speed, &bounds);
    foot_bounds(walk, quarter, speed, &bounds);
    bounds.pitch = pitch_bound(walk, quarter, speed, bounds.move);
    if (walk->config.ankle == SADDLE_ANKLE_CYCLOID) {
        return bounds;
    }
    /* z^2 = h^2 - x^2 - y^2, with the leg's rate of at most d_h times the ankle's */
    const double low = 0.5 * pendulum_m(walk);
    const double range = (double)walk->config.cop_range_m;
    const double leg = pendulum_m(walk) + 2.0 * range;
    bounds.move[COM_Z] = (leg * range * bounds.pitch + quarter->half * speed +
                          aside_bound(walk) * bounds.move[COM_Y]) /
                         low;
    const double tau = (double)walk->config.ankle_time_constant_s;
    const double heel = (double)walk->config.heel_strike_max_rad;
    const double way = quarter->half - range * (1.0 - cos(heel));
    if (is_erf(walk)) {
        bounds.tail = (2.0 * toe_off_bound(walk, walk->longest_half) + heel) *
                      erfc(way / (tau * fmax(speed, SLOWEST_SHAPED_M_S)));
    }
    return bounds;
}

static void keep_wider(bounds_t *bounds, const bounds_t *other)
{
    for (int i = 0; i < MOVES; i++) {
        bounds->move[i] = fmax(bounds->move[i], other->move[i]);
    }
    bounds->pitch = fmax(bounds->pitch, other->pitch);
    bounds->vx = fmax(bounds->vx, other->vx);
    bounds->vy = fmax(bounds->vy, other->vy);
    bounds->vz = fmax(bounds->vz, other->vz);
    bounds->tail = fmax(bounds->tail, other->tail);
}

/* Over one query: of the quarter where it began and, past a via point, of where it ended. */
static bounds_t bounds_of_query(walk_t *walk, const saddle_plan_t *now)
{
    const double speed = (double)fmaxf(walk->plan.speed_m_s, now->speed_m_s);
    bounds_t bounds =
        steps(&walk->plan) ? walking_bounds(walk, &walk->quarter, speed) : standing_bounds(walk);
    if (!same_quarter(&walk->plan, now)) {
        if (steps(now)) {
            walk->quarter = enter_quarter(walk, now);
        }
        const bounds_t next =
            steps(now) ? walking_bounds(walk, &walk->quarter, speed) : standing_bounds(walk);
        keep_wider(&bounds, &next);
    }
    return bounds;
}

/* ---- what holds of two plans in a row ------------------------------------------------------ */

static void positions(const saddle_plan_t *plan, double *p)
{
    const saddle_vec3_t *points[3] = {&plan->com_m, &plan->foot_m[SADDLE_LEFT],
                                      &plan->foot_m[SADDLE_RIGHT]};
    for (int i = 0; i < 3; i++) {
        p[3 * i] = (double)points[i]->x + 1e-9 * (double)plan->origin_x_nm;
        p[3 * i + 1] = (double)points[i]->y;
        p[3 * i + 2] = (double)points[i]->z;
    }
}

static void velocities(const saddle_plan_t *plan, double *v)
{
    const saddle_vec3_t none = {0.0f, 0.0f, 0.0f};
    const bool left = plan->support == (uint8_t)SADDLE_LEFT;
    const saddle_vec3_t *points[3] = {&plan->com_velocity_m_s,
                                      left ? &none : &plan->swing_velocity_m_s,
                                      left ? &plan->swing_velocity_m_s : &none};
    for (int i = 0; i < 3; i++) {
        v[3 * i] = (double)points[i]->x;
        v[3 * i + 1] = (double)points[i]->y;
        v[3 * i + 2] = (double)points[i]->z;
    }
}

static void check_moves(walk_t *walk, const saddle_plan_t *now, double dt_s, const bounds_t *bounds)
{
    static const char *const NAMES[MOVES] = {
        "CoM x jumps",        "CoM y jumps",        "CoM z jumps",
        "left foot x jumps",  "left foot y jumps",  "left foot z jumps",
        "right foot x jumps", "right foot y jumps", "right foot z jumps"};
    double p0[MOVES], p1[MOVES], v0[MOVES], v1[MOVES];
    const bool via = !same_quarter(&walk->plan, now);
    const bool landed = now->step_count != walk->plan.step_count;
    positions(&walk->plan, p0);
    positions(now, p1);
    velocities(&walk->plan, v0);
    velocities(now, v1);
    for (int i = 0; i < MOVES; i++) {
        const bool erf_z = i == COM_Z && is_erf(walk) && steps(now);
        if (landed && (erf_z || (i == COM_Z && shaped_legs(walk)))) {
            continue;
        }
        const double tail_m =
            erf_z && via ? 2.0 * (double)walk->config.cop_range_m * bounds->tail : 0.0;
        const double move = p1[i] - p0[i];
        within(walk, move, bounds->move[i] * dt_s + JUMP_M + tail_m, &used.move[i], NAMES[i]);
        /* A foot may land while it gets faster: then its velocities on both sides say too little. */
        const bool landing_foot = landed && i == (now->support == SADDLE_LEFT ? LEFT_X : RIGHT_X);
        if (!erf_z && !landing_foot) {
            const double mean = 0.5 * (v0[i] + v1[i]) * dt_s;
            const double spread = 0.5 * fabs(v1[i] - v0[i]) * dt_s;
            expect(walk, fabs(move - mean) <= spread + JUMP_M, NAMES[i], move, mean);
        }
    }
    for (int foot = 0; foot < 2; foot++) {
        const double turn =
            (double)now->foot_pitch_rad[foot] - (double)walk->plan.foot_pitch_rad[foot];
        within(walk, turn, bounds->pitch * dt_s + JUMP_M + (via ? bounds->tail : 0.0), &used.pitch,
               "foot pitch jumps");
    }
}

static void check_velocities(walk_t *walk, const saddle_plan_t *now, double dt_s,
                             const bounds_t *bounds)
{
    const saddle_vec3_t *v0 = &walk->plan.com_velocity_m_s;
    const saddle_vec3_t *v1 = &now->com_velocity_m_s;
    within(walk, (double)(v1->x - v0->x), bounds->vx * dt_s + JUMP_M_S, &used.vx,
           "CoM velocity x jumps");
    within(walk, (double)(v1->y - v0->y), bounds->vy * dt_s + JUMP_M_S, &used.vy,
           "CoM velocity y jumps");
    if (walk->config.ankle == SADDLE_ANKLE_CYCLOID) {
        within(walk, (double)(v1->z - v0->z), bounds->vz * dt_s + JUMP_M_S, &used.vz,
               "CoM velocity z jumps");
    }
}

/* Where the foot that is now in support, or has come down beside it, was said to land. */
static void check_landing(walk_t *walk, const saddle_plan_t *now)
{
    const saddle_plan_t *last = &walk->plan;
    const bool landed = steps(last) && now->step_count != last->step_count;
    const bool came_beside = steps(last) && !steps(now);
    if (landed || came_beside) {
        const int foot = landed ? now->support : 1 - now->support;
        const double said_x = (double)last->landing_m.x + 1e-9 * (double)last->origin_x_nm;
        const double x = (double)now->foot_m[foot].x + 1e-9 * (double)now->origin_x_nm;
        const double y = (double)now->foot_m[foot].y;
        within(walk, x - said_x, LANDING_M, &used.landing_m, "lands elsewhere along x");
        within(walk, y - (double)last->landing_m.y, LANDING_M, &used.landing_m,
               "lands elsewhere along y");
    } else if (steps(last) && to_landing(last) && same_quarter(last, now)) {
        expect(walk, memcmp(&last->landing_m, &now->landing_m, sizeof now->landing_m) == 0,
               "the planned landing moves", (double)now->landing_m.x, (double)last->landing_m.x);
    }
}

static void check_stance(walk_t *walk, const saddle_plan_t *now)
{
    const saddle_plan_t *last = &walk->plan;
    for (int foot = 0; foot < 2; foot++) {
        const bool stands =
            (foot == now->support && foot == last->support) || (!steps(now) && !steps(last));
        const bool moved =
            memcmp(&now->foot_m[foot], &last->foot_m[foot], sizeof now->foot_m[foot]) != 0 ||
            now->origin_x_nm != last->origin_x_nm;
        expect(walk, !stands || !moved, "a stance foot moves", (double)now->foot_m[foot].x,
               (double)last->foot_m[foot].x);
    }
}

static void check_mode(walk_t *walk, const saddle_plan_t *now)
{
    static const uint8_t NEXT[] = {
        [SADDLE_MODE_STANDING] = 1u << SADDLE_MODE_STARTING,
        [SADDLE_MODE_STARTING] = 1u << SADDLE_MODE_WALKING | 1u << SADDLE_MODE_STOPPING,
        [SADDLE_MODE_WALKING] = 1u << SADDLE_MODE_STOPPING,
        [SADDLE_MODE_STOPPING] =
            1u << SADDLE_MODE_STANDING | 1u << SADDLE_MODE_STARTING | 1u << SADDLE_MODE_WALKING,
    };
    const unsigned from = walk->plan.mode;
    expect(walk, now->mode == from || (NEXT[from] >> now->mode & 1u) != 0u, "mode does not follow",
           (double)now->mode, (double)from);
}

static void check_finite(walk_t *walk, const saddle_plan_t *plan)
{
    const float values[] = {plan->theta_rad,
                            plan->speed_m_s,
                            plan->step_length_m,
                            plan->step_width_m,
                            plan->com_m.x,
                            plan->com_m.y,
                            plan->com_m.z,
                            plan->com_velocity_m_s.x,
                            plan->com_velocity_m_s.y,
                            plan->com_velocity_m_s.z,
                            plan->foot_m[0].x,
                            plan->foot_m[0].y,
                            plan->foot_m[0].z,
                            plan->foot_m[1].x,
                            plan->foot_m[1].y,
                            plan->foot_m[1].z,
                            plan->foot_pitch_rad[0],
                            plan->foot_pitch_rad[1],
                            plan->swing_velocity_m_s.x,
                            plan->swing_velocity_m_s.y,
                            plan->swing_velocity_m_s.z,
                            plan->leg_length_m,
                            plan->knee_flexion_m,
                            plan->toe_off_rad,
                            plan->heel_strike_rad,
                            plan->time_to_via_point_s,
                            plan->time_to_heel_strike_s,
                            plan->time_to_toe_off_s,
                            plan->landing_m.x,
                            plan->landing_m.y};
    float sum = 0.0f;
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        sum += values[i] - values[i]; /* 0, or NaN from then on */
    }
    expect(walk, plan->valid && sum == 0.0f, "an output is not finite", (double)sum, 0.0);
}

/* ---- events -------------------------------------------------------------------------------- */

static events_t predicted_events(const saddle_plan_t *plan, uint64_t us)
{
    const events_t events = {(double)us + 1e6 * (double)plan->time_to_toe_off_s,
                             (double)us + 1e6 * (double)plan->time_to_via_point_s,
                             (double)us + 1e6 * (double)plan->time_to_heel_strike_s};
    return events;
}

/* An event is predicted for the same instant as before. */
static void same_event(walk_t *walk, double was_us, double is_us, double left_s, double speed,
                       const char *what)
{
    const double slack_s = EVENT_S + EVENT_SHARE * left_s + EVENT_WAY_M / fmax(speed, 1e-4);
    expect(walk, fabs(is_us - was_us) <= 1e6 * slack_s, what, 1e-6 * is_us, 1e-6 * was_us);
    keep_larger(&used.event_s, 1e-6 * (is_us - was_us) / slack_s);
}

/* What was predicted still is, or has come to pass in its time. */
static void check_events(walk_t *walk, const saddle_plan_t *now, uint64_t us)
{
    const events_t is = predicted_events(now, us);
    const events_t *was = &walk->events;
    const double speed = (double)fminf(now->speed_m_s, walk->plan.speed_m_s);
    if (now->mode == (uint8_t)SADDLE_MODE_STANDING) {
        return; /* until a command nothing comes */
    }
    const bool same_step =
        steps(now) && steps(&walk->plan) && now->step_count == walk->plan.step_count;
    if (!same_quarter(&walk->plan, now)) {
        same_event(walk, was->via_us, fmin(fmax(was->via_us, (double)walk->plan_us), (double)us),
                   0.0, speed, "a via point out of its time");
    } else if (now->mode == walk->plan.mode && (speed > AT_REST_M_S || !steps(now))) {
        same_event(walk, was->via_us, is.via_us, (double)now->time_to_via_point_s,
                   steps(now) ? speed : 1.0, "the next via point is predicted anew");
    }
    if (same_step && now->mode == walk->plan.mode) {
        same_event(walk, was->toe_off_us, is.toe_off_us, (double)now->time_to_toe_off_s, speed,
                   "the next toe-off is predicted anew");
    } else if (now->step_count != walk->plan.step_count) {
        same_event(walk, was->toe_off_us,
                   fmin(fmax(was->toe_off_us, (double)walk->plan_us), (double)us), 0.0, speed,
                   "a toe-off out of its time");
    }
    if (same_step && now->mode == walk->plan.mode && now->time_to_heel_strike_s > 0.0f &&
        walk->plan.time_to_heel_strike_s > 0.0f) {
        same_event(walk, was->heel_us, is.heel_us, (double)now->time_to_heel_strike_s, speed,
                   "the next heel strike is predicted anew");
    }
    expect(walk, (double)(now->time_to_heel_strike_s - now->time_to_toe_off_s) <= EVENT_S,
           "the heel strikes after the CoP arrives", (double)now->time_to_heel_strike_s,
           (double)now->time_to_toe_off_s);
}

/* ---- the walk ------------------------------------------------------------------------------ */

static void check_distance(walk_t *walk, const saddle_plan_t *now, double dt_s)
{
    walk->way_m +=
        0.5 * dt_s * ((double)walk->plan.com_velocity_m_s.x + (double)now->com_velocity_m_s.x);
    const double way_m = 1e-9 * (double)now->origin_x_nm + (double)now->com_m.x - walk->first_way_m;
    within(walk, way_m - walk->way_m, DISTANCE_M, &used.distance_m,
           "the way is not the integral of the speed");
}

/* The plan a query later, under one command. */
static void watch(walk_t *walk, const saddle_plan_t *now, uint64_t us)
{
    const double dt_s = 1e-6 * (double)(us - walk->plan_us);
    check_finite(walk, now);
    check_mode(walk, now);
    check_landing(walk, now);
    check_stance(walk, now);
    check_events(walk, now, us);
    const bounds_t bounds = bounds_of_query(walk, now);
    check_moves(walk, now, dt_s, &bounds);
    check_velocities(walk, now, dt_s, &bounds);
    check_distance(walk, now, dt_s);
    walk->plan = *now;
    walk->plan_us = us;
    walk->events = predicted_events(now, us);
}

static bool same_float(float a, float b)
{
    return a >= b && a <= b;
}

static bool same_point(const saddle_vec3_t *a, const saddle_vec3_t *b)
{
    return same_float(a->x, b->x) && same_float(a->y, b->y) && same_float(a->z, b->z);
}

/* The tick has the plan that was predicted for its time; its command may change what follows. */
static void check_tick(walk_t *walk, const saddle_plan_t *now)
{
    const saddle_plan_t *was = &walk->plan;
    const bool same = same_point(&was->com_m, &now->com_m) &&
                      same_point(&was->com_velocity_m_s, &now->com_velocity_m_s) &&
                      same_point(&was->foot_m[0], &now->foot_m[0]) &&
                      same_point(&was->foot_m[1], &now->foot_m[1]) &&
                      same_float(was->foot_pitch_rad[0], now->foot_pitch_rad[0]) &&
                      same_float(was->foot_pitch_rad[1], now->foot_pitch_rad[1]) &&
                      was->origin_x_nm == now->origin_x_nm && was->step_count == now->step_count;
    expect(walk, same, "a tick's plan is not what was predicted", (double)now->com_m.x,
           (double)was->com_m.x);
    check_finite(walk, now);
    check_mode(walk, now);
    if (walk->same_command && was->mode == (uint8_t)SADDLE_MODE_WALKING && now->mode == was->mode) {
        check_events(walk, now, walk->plan_us);
    }
    walk->plan = *now;
    walk->events = predicted_events(now, walk->plan_us);
}

static void check_limits(walk_t *walk, const saddle_output_t *output)
{
    const saddle_command_t *command = &walk->input.command;
    const float ceiling_m_s = walk->context.model.body.speed_ceiling_m_s;
    const bool moves = command->mode == (uint8_t)SADDLE_COMMAND_WALK &&
                       !(command->speed_m_s >= 0.0f && command->speed_m_s <= 0.0f);
    const bool limited =
        moves && (command->speed_m_s < SADDLE_SPEED_FLOOR_M_S || command->speed_m_s >= ceiling_m_s);
    expect(walk, limited == ((output->limits & (uint32_t)SADDLE_LIMIT_SPEED) != 0u),
           "a limited speed is not reported, or another one is", (double)command->speed_m_s,
           (double)ceiling_m_s);
    expect(walk, output->faults == 0u || !moves || (output->faults & SADDLE_FAULT_COMMAND) == 0u,
           "a fault of the command", (double)output->faults, 0.0);
}

static void tick(walk_t *walk, uint64_t us, bool first)
{
    saddle_output_t output;
    walk->input.time_us = us;
    if (saddle_tick(&walk->context, &walk->input, &output) != SADDLE_OK) {
        expect(walk, false, "a tick fails", (double)output.status, 0.0);
        return;
    }
    check_limits(walk, &output);
    if (first) {
        walk->plan = output.plan;
        walk->plan_us = us;
        walk->first_way_m = (double)output.plan.com_m.x;
        walk->events = predicted_events(&output.plan, us);
        return;
    }
    check_tick(walk, &output.plan);
}

static void query_until(walk_t *walk, uint64_t end_us)
{
    saddle_plan_t plan;
    while (walk->plan_us < end_us && walk->failures == 0) {
        const uint64_t us = walk->plan_us + QUERY_US < end_us ? walk->plan_us + QUERY_US : end_us;
        if (saddle_plan_at(&walk->context, us, &plan) != SADDLE_OK) {
            expect(walk, false, "no plan until the next tick", 1e-6 * (double)us,
                   1e-6 * (double)walk->input.time_us);
            return;
        }
        watch(walk, &plan, us);
    }
}

static uint64_t random_period_us(walk_t *walk)
{
    const double kind = random_in(&walk->random, 0.0, 1.0);
    const double longest_us = 1e6 * (double)walk->config.tick_max_s - 1.0;
    return kind < 0.6    ? TICK_US
           : kind < 0.9  ? (uint64_t)random_in(&walk->random, 70e3, 95e3)
           : kind < 0.97 ? (uint64_t)random_in(&walk->random, 95e3, longest_us)
                         : (uint64_t)random_in(&walk->random, 500.0, 20e3);
}

static saddle_command_t random_command(walk_t *walk)
{
    const double ceiling = (double)walk->context.model.body.speed_ceiling_m_s;
    saddle_command_t command = {.mode = SADDLE_COMMAND_WALK};
    command.heel_strike_rad = (float)random_in(&walk->random, -0.05, 0.6);
    switch (random_bits(&walk->random) >> 60) {
    case 0:
    case 1:
    case 2: break; /* speed 0 */
    case 3:
        command.mode = SADDLE_COMMAND_STAND;
        command.speed_m_s = NAN;
        break;
    case 4: command.speed_m_s = SADDLE_SPEED_FLOOR_M_S; break;
    case 5: command.speed_m_s = (float)random_in(&walk->random, 1.0, 3.0) * (float)ceiling; break;
    case 6: command.speed_m_s = (float)random_in(&walk->random, -1.0, -0.001); break;
    case 7: command.speed_m_s = (float)random_in(&walk->random, 0.001, 0.1); break;
    default: command.speed_m_s = (float)random_in(&walk->random, 0.05, ceiling);
    }
    return command;
}

static uint64_t random_duration_us(walk_t *walk)
{
    return random_bits(&walk->random) >> 62 == 0u ? (uint64_t)random_in(&walk->random, 0.0, 0.5e6)
                                                  : (uint64_t)random_in(&walk->random, 0.3e6, 8e6);
}

static float random_factor(uint64_t *random, double min, double max)
{
    return (float)random_in(random, min, max);
}

saddle_config_t random_config(uint64_t *random)
{
    saddle_config_t config;
    do {
        config = saddle_config_default(random_factor(random, 1.1, 2.1), 70.0f);
        config.ankle = (saddle_ankle_t)(random_bits(random) % SADDLE_ANKLE_COUNT);
        config.acceleration_m_s2 = random_factor(random, 0.2, 3.0);
        config.shift_time_s = random_factor(random, 0.3, 1.5);
        config.swing_clearance_m = random_factor(random, 0.0, 0.1);
        if (random_bits(random) % 3u == 0u) {
            config.step_length_factor_left = random_factor(random, 0.7, 1.3);
            config.step_length_factor_right = random_factor(random, 0.7, 1.3);
            config.step_width_factor_left = random_factor(random, 0.6, 1.9);
            config.step_width_factor_right = random_factor(random, 0.6, 1.9);
        }
        if (random_bits(random) % 2u == 0u) {
            config.lateral_offset_m = random_factor(random, -0.04, 0.04);
            config.lateral_delay_rad = random_factor(random, -1.0, 1.0);
            config.vertical_offset_m = random_factor(random, -0.03, 0.03);
            config.vertical_delay_rad = random_factor(random, -1.5, 1.5);
            config.strike_share = random_factor(random, 0.1, 0.5);
        }
        if (random_bits(random) % 2u == 0u) {
            config.swing_begin = random_factor(random, -0.6, 0.3);
            config.swing_end = random_factor(random, 0.8, 1.4);
            config.swing_skew = random_factor(random, 0.8, 2.5);
        }
    } while (saddle_config_check(&config) != NULL);
    return config;
}

/* What no step of this walker exceeds: a foot is at its factor times half the width from the
 * walking line, and never nearer to the other than half the width. */
static void find_extremes(walk_t *walk)
{
    const saddle_config_t *config = &walk->config;
    const saddle_body_t *body = &walk->context.model.body;
    const double sides =
        0.5 * (double)(config->step_width_factor_left + config->step_width_factor_right);
    const double longer =
        fmax((double)config->step_length_factor_left, (double)config->step_length_factor_right);
    const double crawl = sqrt((double)(config->acceleration_m_s2 * config->half_step_intercept_m));
    walk->fastest = fmax((double)body->speed_ceiling_m_s, crawl);
    walk->longest_half = longer * ((double)config->half_step_slope_s * walk->fastest +
                                   (double)config->half_step_intercept_m);
    walk->widest = fmax(sides, 0.5) * (double)config->step_width_slow_m;
    walk->narrowest = 0.5 * (double)config->step_width_fast_m;
    walk->widest = fmax(walk->widest, (double)config->step_width_slow_m);
    walk->steepest_way = way_bound(walk);
}

/* In the end the walker stands: slowed to a crawl, some steps at it, a stop, two shifts. */
static void check_end(walk_t *walk)
{
    const double a = (double)walk->config.acceleration_m_s2;
    const double crawl = sqrt(a * (double)walk->config.half_step_intercept_m);
    const double time_s = walk->fastest / a + 8.0 * walk->longest_half / crawl +
                          3.0 * (double)walk->config.shift_time_s;
    const uint64_t end_us = walk->plan_us + (uint64_t)(1e6 * time_s);
    walk->input.command = (saddle_command_t){.mode = SADDLE_COMMAND_STAND};
    walk->same_command = false;
    while (walk->plan_us < end_us && walk->failures == 0 &&
           (walk->plan.mode != (uint8_t)SADDLE_MODE_STANDING || !walk->same_command)) {
        const uint64_t next_us = walk->plan_us + random_period_us(walk);
        query_until(walk, next_us);
        tick(walk, next_us, false);
        walk->same_command = true;
    }
    expect(walk, walk->plan.mode == (uint8_t)SADDLE_MODE_STANDING, "it does not come to stand",
           time_s, 0.0);
}

static int run_schedule(uint64_t seed)
{
    static walk_t walk;
    walk = (walk_t){.seed = seed, .random = seed * 0x9E3779B97F4A7C15u};
    walk.input.measurement = saddle_no_measurement();
    random_bits(&walk.random);
    walk.config = random_config(&walk.random);
    if (saddle_init(&walk.context, &walk.config) != SADDLE_OK) {
        expect(&walk, false, "no beginning", 0.0, 0.0);
        return 1;
    }
    find_extremes(&walk);
    uint64_t change_us = 0;
    tick(&walk, 0, true);
    while (walk.plan_us < SCHEDULE_US && walk.failures == 0) {
        const uint64_t next_us = walk.plan_us + random_period_us(&walk);
        query_until(&walk, next_us);
        walk.same_command = next_us < change_us;
        if (!walk.same_command) {
            walk.input.command = random_command(&walk);
            change_us = next_us + random_duration_us(&walk);
        }
        if (walk.failures == 0) {
            tick(&walk, next_us, false);
        }
    }
    check_end(&walk);
    return walk.failures > 0;
}

int check_schedules(uint64_t first_seed, uint64_t count)
{
    int failures = 0;
    for (uint64_t i = 0; i < count && failures < FAILURES_SHOWN; i++) {
        failures += run_schedule(first_seed + i);
    }
    printf("shares of the bounds used: CoM %.2f %.2f %.2f, feet %.2f %.2f %.2f, pitch %.2f,\n"
           "  velocity %.2f %.2f %.2f, landing %.2f, way %.2f, events %.2f\n",
           used.move[COM_X], used.move[COM_Y], used.move[COM_Z],
           fmax(used.move[LEFT_X], used.move[RIGHT_X]), fmax(used.move[LEFT_Y], used.move[RIGHT_Y]),
           fmax(used.move[LEFT_Z], used.move[RIGHT_Z]), used.pitch, used.vx, used.vy, used.vz,
           used.landing_m, used.distance_m, used.event_s);
    printf("schedules: seeds %llu to %llu, %d failures\n", (unsigned long long)first_seed,
           (unsigned long long)(first_seed + count - 1u), failures);
    return failures;
}
