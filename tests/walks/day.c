/* A day's walk at random speeds beside a twin in double precision. The twin is the description of
 * the plan, integrated exactly from event to event; it shares nothing with the core but the
 * configuration's and the commands' floats. Both feet and the CoM are compared at every tick,
 * relative to the core's stance foot, so that a via point passed a rounding earlier or later is no
 * difference: the walk is continuous there. */
#include "walks.h"

#define HOURS 24u
#define TICKS_AN_HOUR 45000u
#define SLOWEST_M_S 0.25
#define FASTEST_M_S 1.93

#define PHASE_TOLERANCE_RAD 1e-4
#define POSITION_TOLERANCE_M 1e-5
#define DAY_AT_LEAST_M 90000.0

typedef struct {
    double x, y;
} point_t;

typedef struct {
    const saddle_config_t *config;
    double speed, wanted; /* m/s */
    long quarters;        /* passed since the left foot via point; an even one ends in a landing */
    double walked;        /* way to the stance foot */
    double x;             /* CoM from the stance foot */
    double half, width, amplitude; /* shape of the running quarter */
    double off_value, off_slope;   /* CoM y at the quarter's start less the shape's */
    double stance_y, swing_y;      /* lines of the feet, from the walking line */
    point_t swing_off;             /* where the swing foot lifted off less its line */
} twin_t;

static double slope_s(const twin_t *twin)
{
    return (double)twin->config->half_step_slope_s;
}

static bool lands_next(const twin_t *twin)
{
    return twin->quarters % 2 == 0;
}

/* +1 while the left foot carries, -1 while the right one does. */
static double stance_side(const twin_t *twin)
{
    return (twin->quarters + 1) % 4 < 2 ? 1.0 : -1.0;
}

static double width_at(const saddle_config_t *config, double speed)
{
    if (speed < (double)config->step_width_slow_speed_m_s) {
        return (double)config->step_width_slow_m;
    }
    if (speed > (double)config->step_width_fast_speed_m_s) {
        return (double)config->step_width_fast_m;
    }
    return (double)config->step_width_slope_s * speed + (double)config->step_width_intercept_m;
}

static double half_step_at(const twin_t *twin, double speed)
{
    return slope_s(twin) * speed + (double)twin->config->half_step_intercept_m;
}

/* CoM y from the stance foot as the running quarter's shape has it, and dy/dx. */
static double shape_y(const twin_t *twin, double *slope)
{
    const double wave = PI / (2.0 * twin->half);
    const double side = stance_side(twin);
    *slope = -side * twin->amplitude * wave * sin(wave * twin->x);
    return side * (twin->amplitude * cos(wave * twin->x) - 0.5 * twin->width);
}

/* With what is left of the mismatch. */
static double com_y(const twin_t *twin, double *slope)
{
    const double s = lands_next(twin) ? twin->x / twin->half : 1.0 + twin->x / twin->half;
    const double left = 1.0 - s;
    const double y = shape_y(twin, slope);
    *slope += twin->off_slope * left * (1.0 - 3.0 * s) -
              twin->off_value / twin->half * 30.0 * s * s * left * left;
    return y + twin->off_value * (1.0 - min_jerk(s)) +
           twin->off_slope * twin->half * s * left * left;
}

static void take_shape(twin_t *twin, double width, double y, double slope)
{
    double new_slope;
    twin->width = width;
    twin->amplitude = width / (2.0 * PI * fmax(twin->speed, 0.5));
    twin->off_value = y - shape_y(twin, &new_slope);
    twin->off_slope = slope - new_slope;
}

static void pass_beside_the_stance_foot(twin_t *twin)
{
    double slope;
    const double y = com_y(twin, &slope);
    twin->quarters++;
    twin->half = half_step_at(twin, twin->speed);
    take_shape(twin, fabs(twin->swing_y - twin->stance_y), y, slope);
}

static double swing_line_x(const twin_t *twin)
{
    double slope;
    return -stance_side(twin) * twin->width * twin->x / shape_y(twin, &slope);
}

static void land(twin_t *twin)
{
    double slope;
    const double lifted_y = twin->stance_y;
    const double y = twin->stance_y + com_y(twin, &slope) - twin->swing_y;
    twin->quarters++;
    twin->walked += 2.0 * twin->half;
    twin->x = -twin->half;
    twin->stance_y = twin->swing_y;
    take_shape(twin, fabs(twin->stance_y - lifted_y), y, slope);
    const double width = width_at(twin->config, twin->speed);
    const double outward = -stance_side(twin);
    const double across = outward * (outward * 0.5 * width - twin->stance_y);
    twin->swing_y = twin->stance_y + outward * fmin(fmax(across, 0.5 * width), 2.0 * width);
    twin->swing_off.x = -2.0 * twin->half - swing_line_x(twin);
    twin->swing_off.y = lifted_y - twin->swing_y;
}

static point_t swing_foot(const twin_t *twin)
{
    const double fade = lands_next(twin) ? 0.0 : 1.0 - min_jerk(1.0 + twin->x / twin->half);
    const point_t foot = {swing_line_x(twin) + twin->swing_off.x * fade,
                          twin->swing_y + twin->swing_off.y * fade};
    return foot;
}

/* Time until the quarter's end at an acceleration; longer than any tick if never. */
static double time_to_end(const twin_t *twin, double acceleration)
{
    const double way = (lands_next(twin) ? twin->half : 0.0) - twin->x;
    const double square = twin->speed * twin->speed + 2.0 * acceleration * way;
    return square > 0.0 ? 2.0 * way / (twin->speed + sqrt(square)) : HUGE_VAL;
}

/* One stretch of constant acceleration that ends at a via point, at the wanted speed or after
 * time_s; returns its duration. */
static double walk_a_stretch(twin_t *twin, double time_s)
{
    const double rate = (double)twin->config->acceleration_m_s2;
    const double change = twin->wanted - twin->speed;
    const double acceleration = change > 0.0 ? rate : change < 0.0 ? -rate : 0.0;
    const double change_s = change < 0.0 || change > 0.0 ? fabs(change) / rate : HUGE_VAL;
    const double end_s = time_to_end(twin, acceleration);
    const double stretch_s = fmin(time_s, fmin(change_s, end_s));
    twin->x += stretch_s * (twin->speed + 0.5 * acceleration * stretch_s);
    twin->speed = change_s <= stretch_s ? twin->wanted : twin->speed + acceleration * stretch_s;
    if (end_s <= stretch_s && lands_next(twin)) {
        twin->x = twin->half;
        land(twin);
    } else if (end_s <= stretch_s) {
        twin->x = 0.0;
        pass_beside_the_stance_foot(twin);
    }
    return stretch_s;
}

static void walk(twin_t *twin, double time_s)
{
    while (time_s > 0.0) {
        time_s -= walk_a_stretch(twin, time_s);
    }
}

static twin_t joined_twin(const saddle_config_t *config, double speed)
{
    twin_t twin = {.config = config, .speed = speed, .wanted = speed};
    const double width = width_at(config, speed);
    twin.half = half_step_at(&twin, speed);
    twin.stance_y = 0.5 * width;
    twin.swing_y = -0.5 * width;
    twin.width = width;
    twin.amplitude = width / (2.0 * PI * fmax(speed, 0.5));
    return twin;
}

typedef struct {
    double phase_rad, com_m, swing_m;
} differences_t;

static void compare(const twin_t *twin, const saddle_plan_t *plan, differences_t *largest)
{
    const double progress = lands_next(twin) ? twin->x / twin->half : 1.0 + twin->x / twin->half;
    const double phase = 0.5 * PI * ((double)(twin->quarters % 4) + progress);
    const bool twin_left = stance_side(twin) > 0.0;
    const bool plan_left = plan->support == (uint8_t)SADDLE_LEFT;
    const point_t stance = {0.0, twin->stance_y};
    const point_t swing = swing_foot(twin);
    const point_t base = twin_left == plan_left ? stance : swing;
    const point_t other = twin_left == plan_left ? swing : stance;
    const saddle_vec3_t *foot = plan->foot_m;
    const saddle_vec3_t *plan_base = &foot[plan_left ? SADDLE_LEFT : SADDLE_RIGHT];
    const saddle_vec3_t *plan_other = &foot[plan_left ? SADDLE_RIGHT : SADDLE_LEFT];
    double slope;
    keep_larger(&largest->phase_rad, turn_between(phase, (double)plan->theta_rad));
    keep_larger(&largest->com_m, (double)(plan->com_m.x - plan_base->x) - (twin->x - base.x));
    keep_larger(&largest->com_m, (double)(plan->com_m.y - plan_base->y) -
                                     (twin->stance_y + com_y(twin, &slope) - base.y));
    keep_larger(&largest->swing_m, (double)(plan_other->x - plan_base->x) - (other.x - base.x));
    keep_larger(&largest->swing_m, (double)(plan_other->y - plan_base->y) - (other.y - base.y));
}

static bool within(const differences_t *largest)
{
    return largest->phase_rad < PHASE_TOLERANCE_RAD && largest->com_m < POSITION_TOLERANCE_M &&
           largest->swing_m < POSITION_TOLERANCE_M;
}

int check_day(void)
{
    static saddle_context_t context;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    uint64_t random = 20261122u;
    saddle_input_t input = {
        .command = {.mode = SADDLE_COMMAND_WALK, .speed_m_s = 1.2f, .heel_strike_rad = 0.1745f},
        .measurement = saddle_no_measurement()};
    saddle_output_t output;
    twin_t twin = joined_twin(&config, (double)input.command.speed_m_s);
    uint64_t next_us = 0;
    int failures = 0;
    if (saddle_init(&context, &config) != SADDLE_OK ||
        saddle_join(&context, &input.command) != SADDLE_OK) {
        printf("FAIL: the core does not begin\n");
        return 1;
    }
    for (uint32_t hour = 1; hour <= HOURS; hour++) {
        differences_t largest = {0.0, 0.0, 0.0};
        for (uint32_t tick = 0; tick < TICKS_AN_HOUR; tick++, input.time_us += TICK_US) {
            if (input.time_us >= next_us) {
                next_us = input.time_us + (uint64_t)random_in(&random, 5.0e6, 60.0e6);
                input.command.speed_m_s = (float)random_in(&random, SLOWEST_M_S, FASTEST_M_S);
            }
            failures += saddle_tick(&context, &input, &output) != SADDLE_OK || output.limits != 0;
            compare(&twin, &output.plan, &largest);
            twin.wanted = (double)input.command.speed_m_s;
            walk(&twin, 1.0e-6 * TICK_US);
        }
        failures += !within(&largest);
        printf("%s hour %2u: %6.2f km, phase %.1e rad, CoM %.1e m, swing foot %.1e m\n",
               within(&largest) ? "    " : "FAIL", hour, 1.0e-3 * twin.walked, largest.phase_rad,
               largest.com_m, largest.swing_m);
    }
    failures += !(twin.walked > DAY_AT_LEAST_M);
    printf("day: %d failures; %.0f steps\n", failures, (double)(twin.quarters / 2));
    return failures;
}
