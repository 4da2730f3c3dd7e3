/* A day's walk at random speeds and turning rates beside a twin in double precision. The twin is the
 * description of the plan, integrated exactly from event to event; it shares nothing with the core but
 * the configuration's and the commands' floats. Both feet, the CoM and the heading are compared at every
 * tick, relative to the core's stance foot, so that a via point passed a rounding earlier or later is no
 * difference: the walk is continuous there. */
#include "walks.h"

#define HOURS 24u
#define TICKS_AN_HOUR 45000u
#define SLOWEST_M_S 0.25
#define FASTEST_M_S 1.93

#define PHASE_TOLERANCE_RAD 1e-4
#define HEADING_TOLERANCE_RAD 1e-4
#define POSITION_TOLERANCE_M 1e-5
#define DAY_AT_LEAST_M 90000.0

typedef struct {
    double x, y;
} point_t;

/* A piece of the way from the foot at begin on; what is left of the last one's curvature fades. */
typedef struct {
    double curvature, begin, before, fade;
} arc_t;

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
    double heading;                /* of the stance foot, from the first step on */
    double turn_rate, wanted_turn; /* rad/s, of the arc ahead and commanded */
    arc_t behind, ahead;
    double lean, lean_off; /* to the left in the running quarter's end, and at its start off that */
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

static double swing_line_x(const twin_t *twin)
{
    double slope;
    return -stance_side(twin) * twin->width * twin->x / shape_y(twin, &slope);
}

static double natural_frequency(const saddle_config_t *config)
{
    return sqrt((double)SADDLE_GRAVITY_M_S2 /
                ((double)config->pendulum_ratio * (double)config->body_height_m));
}

/* The largest turning rate: hips, reach, and a CoM that leans over the inner foot at most. */
static double turn_max(const twin_t *twin, double speed)
{
    const saddle_config_t *config = twin->config;
    const double w = natural_frequency(config);
    const double width = width_at(config, speed);
    const double half = half_step_at(twin, speed);
    const double reach = (double)config->peak_speed_m_s / (2.0 * w) - half;
    const double step = fmin((double)config->turn_step_max_rad, fmax(4.0 * reach / width, 0.0));
    const double curvature = fmin(step / (2.0 * half), 1.0 / width);
    const double gap = width * (0.5 - 1.0 / (2.0 * PI * fmax(speed, 0.5)));
    return fmin(curvature * speed, gap * w * w / speed);
}

/* After a further way. */
static double speed_after(const twin_t *twin, double way)
{
    const double rate = (double)twin->config->acceleration_m_s2;
    const double rise = twin->wanted > twin->speed ? 2.0 * rate * way : -2.0 * rate * way;
    const double speed = sqrt(fmax(twin->speed * twin->speed + rise, 0.0));
    return rise > 0.0 ? fmin(speed, twin->wanted) : fmax(speed, twin->wanted);
}

/* The stance foot's place on the way goes on by a step, and the arc that begins there is chosen. */
static void turn(twin_t *twin)
{
    const double step = 2.0 * twin->half;
    const double speed = speed_after(twin, step);
    const double change = (double)twin->config->turn_acceleration_rad_s2 * step / speed;
    const double most = turn_max(twin, speed);
    const double bears = turn_max(twin, twin->wanted);
    const double wanted = fmin(fmax(twin->wanted_turn, -bears), bears);
    const double near = fmin(fmax(wanted, twin->turn_rate - change), twin->turn_rate + change);
    twin->heading += twin->ahead.curvature * step;
    twin->turn_rate = fmin(fmax(near, -most), most);
    twin->behind = twin->ahead;
    twin->behind.begin = -step;
    twin->ahead.curvature = twin->turn_rate / speed;
    twin->ahead.before = twin->behind.curvature - twin->ahead.curvature;
    twin->ahead.fade = 2.0 * (double)twin->config->half_step_intercept_m;
}

/* A place of the way in the stance foot's axes, and the yaw there: by the sine and the cosine of all
 * that it has turned. */
static point_t on_ground(const twin_t *twin, point_t place, double *yaw)
{
    const arc_t *arc = place.x < 0.0 ? &twin->behind : &twin->ahead;
    const double k = arc->curvature;
    const double turned = k * place.x;
    const double faded =
        arc->fade > 0.0 ? fmin(fmax((place.x - arc->begin) / arc->fade, 0.0), 1.0) : 1.0;
    const point_t line = {fabs(k) > 1e-9 ? sin(turned) / k : place.x,
                          fabs(k) > 1e-9 ? (1.0 - cos(turned)) / k : 0.5 * k * place.x * place.x};
    *yaw = turned + arc->before * arc->fade * faded * (1.0 - faded) * (1.0 - faded);
    return (point_t){line.x - place.y * sin(*yaw), line.y + place.y * cos(*yaw)};
}

/* Inward in a turn, by v^2 / (w^2 R), from now on. */
static void lean_into(twin_t *twin, const arc_t *arc)
{
    const double w = natural_frequency(twin->config);
    const double was = twin->lean;
    twin->lean = arc->curvature * twin->speed * twin->speed / (w * w);
    twin->lean_off = was - twin->lean;
}

static double lean(const twin_t *twin)
{
    const double s = lands_next(twin) ? twin->x / twin->half : 1.0 + twin->x / twin->half;
    return twin->lean + twin->lean_off * (1.0 - min_jerk(s));
}

static void pass_beside_the_stance_foot(twin_t *twin)
{
    double slope;
    const double y = com_y(twin, &slope);
    twin->quarters++;
    twin->half = half_step_at(twin, twin->speed);
    take_shape(twin, fabs(twin->swing_y - twin->stance_y), y, slope);
    lean_into(twin, &twin->ahead);
}

static void land(twin_t *twin)
{
    double slope;
    turn(twin);
    lean_into(twin, &twin->behind);
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
    double phase_rad, com_m, swing_m, heading_rad;
} differences_t;

/* From a base in its own axes. */
static point_t seen_from(point_t base, double yaw, point_t point)
{
    const double x = point.x - base.x;
    const double y = point.y - base.y;
    return (point_t){x * cos(yaw) + y * sin(yaw), y * cos(yaw) - x * sin(yaw)};
}

static point_t point_of(const saddle_vec3_t *point)
{
    return (point_t){(double)point->x, (double)point->y};
}

static void keep_apart(double *largest, point_t a, point_t b)
{
    keep_larger(largest, a.x - b.x);
    keep_larger(largest, a.y - b.y);
}

static void compare(const twin_t *twin, const saddle_plan_t *plan, differences_t *largest)
{
    const double progress = lands_next(twin) ? twin->x / twin->half : 1.0 + twin->x / twin->half;
    const double phase = 0.5 * PI * ((double)(twin->quarters % 4) + progress);
    const bool same = (stance_side(twin) > 0.0) == (plan->support == (uint8_t)SADDLE_LEFT);
    double slope, com_yaw, swing_yaw;
    const point_t place = {twin->x, twin->stance_y + com_y(twin, &slope) + lean(twin)};
    const point_t com = on_ground(twin, place, &com_yaw);
    const point_t stance = {0.0, twin->stance_y};
    const point_t swing = on_ground(twin, swing_foot(twin), &swing_yaw);
    const point_t base = same ? stance : swing;
    const double yaw = same ? 0.0 : swing_yaw;
    const point_t plan_base = point_of(&plan->foot_m[plan->support]);
    const point_t plan_com = point_of(&plan->com_m);
    const point_t plan_other = point_of(&plan->foot_m[1 - plan->support]);
    keep_larger(&largest->phase_rad, turn_between(phase, (double)plan->theta_rad));
    keep_larger(&largest->heading_rad,
                turn_between(twin->heading + yaw, (double)plan->heading_rad));
    keep_apart(&largest->com_m, seen_from(plan_base, 0.0, plan_com), seen_from(base, yaw, com));
    keep_apart(&largest->swing_m, seen_from(plan_base, 0.0, plan_other),
               seen_from(base, yaw, same ? swing : stance));
}

static bool within(const differences_t *largest)
{
    return largest->phase_rad < PHASE_TOLERANCE_RAD &&
           largest->heading_rad < HEADING_TOLERANCE_RAD && largest->com_m < POSITION_TOLERANCE_M &&
           largest->swing_m < POSITION_TOLERANCE_M;
}

/* A speed, and straight on or a turning rate that it bears: the rounding of a limit would add up. */
static void change_command(saddle_command_t *command, const twin_t *twin, uint64_t *random)
{
    const bool straight = random_bits(random) >> 62 == 0u;
    command->speed_m_s = (float)random_in(random, SLOWEST_M_S, FASTEST_M_S);
    const double most = straight ? 0.0 : 0.95 * turn_max(twin, (double)command->speed_m_s);
    command->turn_rate_rad_s = (float)random_in(random, -most, most);
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
        differences_t largest = {0.0, 0.0, 0.0, 0.0};
        for (uint32_t tick = 0; tick < TICKS_AN_HOUR; tick++, input.time_us += TICK_US) {
            if (input.time_us >= next_us) {
                next_us = input.time_us + (uint64_t)random_in(&random, 5.0e6, 60.0e6);
                change_command(&input.command, &twin, &random);
            }
            failures += saddle_tick(&context, &input, &output) != SADDLE_OK || output.limits != 0;
            compare(&twin, &output.plan, &largest);
            twin.wanted = (double)input.command.speed_m_s;
            twin.wanted_turn = (double)input.command.turn_rate_rad_s;
            walk(&twin, 1.0e-6 * TICK_US);
        }
        failures += !within(&largest);
        printf("%s hour %2u: %6.2f km, phase %.1e rad, heading %.1e rad, CoM %.1e m, swing foot "
               "%.1e m\n",
               within(&largest) ? "    " : "FAIL", hour, 1.0e-3 * twin.walked, largest.phase_rad,
               largest.heading_rad, largest.com_m, largest.swing_m);
    }
    failures += !(twin.walked > DAY_AT_LEAST_M);
    printf("day: %d failures; %.0f steps\n", failures, (double)(twin.quarters / 2));
    return failures;
}
