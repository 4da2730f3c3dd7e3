/* Random schedules of speeds, turning rates and stands, watched on the ground at 1 kHz: what must hold
 * of every plan, wherever its axes are.
 *
 * A foot that stands neither moves nor turns, and one that lands is where it swung to. CoM and feet move
 * as their velocities say. The CoM's velocity does not jump: it changes by COM_M_S2 at most, a third more
 * than in the most asymmetric of these bodies at its fastest, which the check prints. That velocities are
 * continuous where arcs meet is exact in test_way.c. */
#include "walks.h"

#define SCHEDULE_US 12000000u
#define QUERY_US 1000u
#define ORIGIN_M 3e-7 /* rounding of a position and of the way to the nanometre */
#define YAW_RAD 1e-6
#define MOVE_M 1e-5
#define COM_M_S2 80.0
#define SIDE_REACH 1.02 /* of a landing: the legs' reach along the way, as a chord */
#define FAILURES_SHOWN 10

typedef struct {
    double x, y;
} point_t;

/* A plan on the ground, from where the way began. */
typedef struct {
    point_t com, com_velocity, foot[2], swing_velocity;
    double yaw[2];
    saddle_plan_t plan;
    uint64_t us;
} posture_t;

typedef struct {
    uint64_t seed, random;
    saddle_context_t context;
    saddle_config_t config;
    saddle_input_t input;
    posture_t last;
    int failures;
} walk_t;

/* The largest, of all walks. */
static struct {
    double stance_m, stance_rad, com_m, foot_m, com_m_s2, heading_rad;
    long turned_steps;
} seen;

static void expect(walk_t *walk, bool holds, const char *what, double value, double bound)
{
    if (!holds && walk->failures++ == 0) {
        printf("FAIL seed %llu at %.6f s: %s: %.9g, bound %.9g\n", (unsigned long long)walk->seed,
               1.0e-6 * (double)walk->last.us, what, value, bound);
    }
}

static point_t turned(double heading, double x, double y)
{
    return (point_t){x * cos(heading) - y * sin(heading), x * sin(heading) + y * cos(heading)};
}

static point_t placed(const saddle_plan_t *plan, const saddle_vec3_t *at)
{
    const point_t from = turned((double)plan->heading_rad, (double)at->x, (double)at->y);
    return (point_t){1e-9 * (double)plan->origin_x_nm + from.x,
                     1e-9 * (double)plan->origin_y_nm + from.y};
}

static double distance(point_t a, point_t b)
{
    return hypot(a.x - b.x, a.y - b.y);
}

static posture_t posture_of(const saddle_plan_t *plan, uint64_t us)
{
    const double heading = (double)plan->heading_rad;
    posture_t posture = {.plan = *plan, .us = us, .com = placed(plan, &plan->com_m)};
    posture.com_velocity =
        turned(heading, (double)plan->com_velocity_m_s.x, (double)plan->com_velocity_m_s.y);
    posture.swing_velocity =
        turned(heading, (double)plan->swing_velocity_m_s.x, (double)plan->swing_velocity_m_s.y);
    for (int side = 0; side < 2; side++) {
        posture.foot[side] = placed(plan, &plan->foot_m[side]);
        posture.yaw[side] = heading + (double)plan->foot_yaw_rad[side];
    }
    return posture;
}

/* A foot that stands through both. */
static void check_stance(walk_t *walk, const posture_t *now)
{
    const posture_t *last = &walk->last;
    const bool both = !(last->plan.step_length_m > 0.0f) && !(now->plan.step_length_m > 0.0f);
    for (int side = 0; side < 2; side++) {
        const bool stands =
            both || (last->plan.support == (uint8_t)side && now->plan.support == (uint8_t)side);
        const double moved = distance(last->foot[side], now->foot[side]);
        const double turn = fabs(turn_between(now->yaw[side], last->yaw[side]));
        if (stands) {
            expect(walk, moved <= ORIGIN_M, "a stance foot moves", moved, ORIGIN_M);
            expect(walk, turn <= YAW_RAD, "a stance foot turns", turn, YAW_RAD);
            keep_larger(&seen.stance_m, moved);
            keep_larger(&seen.stance_rad, turn);
        }
    }
}

/* As the velocities at both ends say: between them, to the rounding. */
static void check_move(walk_t *walk, const point_t place[2], const point_t rate[2], double dt_s,
                       double *largest, const char *what)
{
    const double spread = 0.5 * distance(rate[0], rate[1]) * dt_s;
    const point_t said = {place[0].x + 0.5 * (rate[0].x + rate[1].x) * dt_s,
                          place[0].y + 0.5 * (rate[0].y + rate[1].y) * dt_s};
    const double off = distance(said, place[1]) - spread;
    expect(walk, off <= MOVE_M, what, off, MOVE_M);
    keep_larger(largest, fmax(off, 0.0));
}

static void check_moves(walk_t *walk, const posture_t *now)
{
    const posture_t *last = &walk->last;
    const double dt_s = 1e-6 * (double)(now->us - last->us);
    const point_t com[2] = {last->com, now->com};
    const point_t com_rate[2] = {last->com_velocity, now->com_velocity};
    const double jump = distance(com_rate[0], com_rate[1]);
    check_move(walk, com, com_rate, dt_s, &seen.com_m, "the CoM does not move as it says");
    expect(walk, jump <= COM_M_S2 * dt_s + MOVE_M, "the CoM's velocity jumps", jump,
           COM_M_S2 * dt_s);
    keep_larger(&seen.com_m_s2, (jump - MOVE_M) / dt_s);
    const int swing = 1 - (int)now->plan.support;
    if (last->plan.support == now->plan.support) {
        const point_t foot[2] = {last->foot[swing], now->foot[swing]};
        const point_t rate[2] = {last->swing_velocity, now->swing_velocity};
        check_move(walk, foot, rate, dt_s, &seen.foot_m, "a foot does not move as it says");
    }
}

/* The foot that carries now is where it was about to land, in the heading of its place. */
static void check_landing(walk_t *walk, const posture_t *now)
{
    const posture_t *last = &walk->last;
    const double reach_m =
        SIDE_REACH * hypot(2.0 * (double)walk->context.model.body.half_step_max_m,
                           2.0 * (double)walk->config.step_width_slow_m);
    if (now->plan.step_count == last->plan.step_count) {
        return;
    }
    const int landed = now->plan.support;
    const saddle_vec3_t due = {last->plan.landing_m.x, last->plan.landing_m.y, 0.0f};
    const double off = distance(placed(&last->plan, &due), now->foot[landed]);
    const double step = distance(now->foot[0], now->foot[1]);
    expect(walk, off <= 1e-4, "a foot lands elsewhere than it was to", off, 1e-4);
    expect(walk, step <= reach_m, "a step beyond the reach", step, reach_m);
    keep_larger(&seen.heading_rad, (double)now->plan.heading_rad);
    seen.turned_steps += now->plan.curvature_1_m[0] != 0.0f;
    expect(walk, fabs(turn_between(now->yaw[landed], (double)now->plan.heading_rad)) <= YAW_RAD,
           "a landed foot is not in the heading of its place", now->yaw[landed],
           (double)now->plan.heading_rad);
}

static void watch(walk_t *walk, const saddle_plan_t *plan, uint64_t us)
{
    const posture_t now = posture_of(plan, us);
    check_stance(walk, &now);
    check_moves(walk, &now);
    check_landing(walk, &now);
    walk->last = now;
}

static void query_until(walk_t *walk, uint64_t end_us)
{
    saddle_plan_t plan;
    while (walk->last.us < end_us && walk->failures == 0) {
        const uint64_t us = walk->last.us + QUERY_US < end_us ? walk->last.us + QUERY_US : end_us;
        if (saddle_plan_at(&walk->context, us, &plan) != SADDLE_OK) {
            expect(walk, false, "no plan until the next tick", 1e-6 * (double)us, 0.0);
            return;
        }
        watch(walk, &plan, us);
    }
}

/* The turning rate is limited if and only if it is more than the speed bears. */
static void check_limit(walk_t *walk, const saddle_output_t *output)
{
    const saddle_command_t *command = &walk->input.command;
    const bool told = (output->limits & (uint32_t)SADDLE_LIMIT_TURN) != 0u;
    const double lean_m = fabs((double)command->turn_rate_rad_s) * (double)command->speed_m_s /
                          pow((double)walk->context.model.body.natural_frequency_rad_s, 2.0);
    const bool walks = command->mode == (uint8_t)SADDLE_COMMAND_WALK;
    expect(walk, told || !walks || lean_m <= 0.5 * (double)walk->config.step_width_slow_m,
           "the CoM is to lean beyond the inner foot", lean_m, 0.0);
    expect(walk, !told || (walks && command->turn_rate_rad_s != 0.0f), "a limit of no turn",
           (double)command->turn_rate_rad_s, 0.0);
}

static void tick(walk_t *walk, uint64_t us)
{
    saddle_output_t output;
    walk->input.time_us = us;
    if (saddle_tick(&walk->context, &walk->input, &output) != SADDLE_OK) {
        expect(walk, false, "a tick fails", (double)output.status, 0.0);
        return;
    }
    check_limit(walk, &output);
    walk->last = posture_of(&output.plan, us);
}

static saddle_command_t random_command(walk_t *walk)
{
    const double ceiling = (double)walk->context.model.body.speed_ceiling_m_s;
    saddle_command_t command = {.mode = SADDLE_COMMAND_WALK, .heel_strike_rad = 0.17f};
    const uint64_t kind = random_bits(&walk->random) >> 61;
    command.mode = (uint8_t)(kind == 0u ? SADDLE_COMMAND_STAND : SADDLE_COMMAND_WALK);
    command.speed_m_s = (float)random_in(&walk->random, 0.05, 0.99 * ceiling);
    command.turn_rate_rad_s =
        kind < 3u ? 0.0f : (float)random_in(&walk->random, kind == 7u ? -5.0 : -0.6, 0.6);
    return command;
}

static void stand_at_last(walk_t *walk)
{
    walk->input.command = (saddle_command_t){.mode = SADDLE_COMMAND_STAND};
    for (int ticks = 0; ticks < 1500 && walk->failures == 0; ticks++) {
        query_until(walk, walk->last.us + TICK_US);
        tick(walk, walk->last.us);
    }
    const double apart = fabs(turn_between(walk->last.yaw[0], walk->last.yaw[1]));
    expect(walk, walk->last.plan.mode == (uint8_t)SADDLE_MODE_STANDING, "it does not stand", 0.0,
           0.0);
    expect(walk, apart <= YAW_RAD, "the feet do not stand parallel", apart, YAW_RAD);
}

static int run_schedule(uint64_t seed)
{
    static walk_t walk;
    walk = (walk_t){.seed = seed, .random = seed * 0x9E3779B97F4A7C15u};
    walk.input.measurement = saddle_no_measurement();
    random_bits(&walk.random);
    walk.config = random_config(&walk.random);
    walk.config.turn_acceleration_rad_s2 = (float)random_in(&walk.random, 0.2, 3.0);
    walk.config.turn_step_max_rad = (float)random_in(&walk.random, 0.1, 0.7);
    if (saddle_init(&walk.context, &walk.config) != SADDLE_OK) {
        expect(&walk, false, "no beginning", 0.0, 0.0);
        return 1;
    }
    uint64_t change_us = 0;
    tick(&walk, 0);
    while (walk.last.us < SCHEDULE_US && walk.failures == 0) {
        if (walk.last.us >= change_us) {
            walk.input.command = random_command(&walk);
            change_us = walk.last.us + (uint64_t)random_in(&walk.random, 0.3e6, 8e6);
        }
        query_until(&walk, walk.last.us + TICK_US);
        tick(&walk, walk.last.us);
    }
    stand_at_last(&walk);
    return walk.failures > 0;
}

int check_turns(uint64_t first_seed, uint64_t count)
{
    int failures = 0;
    for (uint64_t i = 0; i < count && failures < FAILURES_SHOWN; i++) {
        failures += run_schedule(first_seed + i);
    }
    printf(
        "largest: stance foot %.1e m %.1e rad, CoM %.1e m %.1f m/s^2, swing foot %.1e m, heading "
        "%.2f rad, %ld turned steps\n",
        seen.stance_m, seen.stance_rad, seen.com_m, seen.com_m_s2, seen.foot_m, seen.heading_rad,
        seen.turned_steps);
    printf("turns: seeds %llu to %llu, %d failures\n", (unsigned long long)first_seed,
           (unsigned long long)(first_seed + count - 1u), failures);
    return failures;
}
