/* An hour at constant speed against the paper's functions of time, in double precision: nothing
 * grows from the first stride on. */
#include "walks.h"

#define SPEEDS 20
#define SLOWEST_M_S 0.05
#define FASTEST_M_S 1.9
#define TICKS_AN_HOUR 45000u
#define TOLERANCE_M 2e-5
#define TOLERANCE_RAD 1e-4

/* A place this close to a via point may count to either side. */
#define VIA_POINT_WIDTH_M 1e-6

/* The paper's walk at one speed. */
typedef struct {
    const saddle_config_t *config;
    double speed, half, width, amplitude, vertical, pendulum, heel_strike, lead, toe_off;
} steady_t;

static double width_at(const saddle_config_t *config, double speed)
{
    const double slow = (double)config->step_width_slow_speed_m_s;
    const double fast = (double)config->step_width_fast_speed_m_s;
    const double sloped =
        (double)config->step_width_slope_s * speed + (double)config->step_width_intercept_m;
    return speed < slow   ? (double)config->step_width_slow_m
           : speed > fast ? (double)config->step_width_fast_m
                          : sloped;
}

static steady_t steady_walk(const saddle_config_t *config, const saddle_command_t *command)
{
    const double speed = (double)command->speed_m_s;
    const double range = (double)config->cop_range_m;
    steady_t walk = {.config = config, .speed = speed};
    walk.half = (double)config->half_step_slope_s * speed + (double)config->half_step_intercept_m;
    walk.width = width_at(config, speed);
    walk.amplitude = fmin(walk.width / (2.0 * PI * speed), walk.width / PI);
    walk.vertical = (double)config->vertical_slope_s * speed + (double)config->vertical_intercept_m;
    walk.pendulum = (double)config->pendulum_ratio * (double)config->body_height_m;
    walk.heel_strike = (double)command->heel_strike_rad;
    walk.lead = range * (1.0 - cos(walk.heel_strike));
    const double x = walk.half - walk.lead;
    const double y = walk.amplitude * cos(0.5 * PI * x / walk.half) - 0.5 * walk.width;
    const double leg = hypot(hypot(walk.pendulum - walk.vertical, x), y);
    const double sine = (leg - walk.pendulum) / (2.0 * range);
    walk.toe_off = 2.0 * asin(fmin(fmax(sine, 0.0), 1.0));
    return walk;
}

/* CoM height at a place relative to the stance foot. */
static double height(const steady_t *walk, double x, double y, bool towards_saddle)
{
    if (walk->config->ankle == SADDLE_ANKLE_CYCLOID) {
        const double beside = 0.5 * walk->width - walk->amplitude;
        const double sine = sin(0.5 * PI * x / walk->half);
        return sqrt(walk->pendulum * walk->pendulum - beside * beside) -
               walk->vertical * sine * sine;
    }
    const double since_saddle = towards_saddle ? x - walk->half : x + walk->half;
    const double tau = (double)walk->config->ankle_time_constant_s;
    const double rise = erf((since_saddle + walk->lead) / (walk->speed * tau));
    const double angle =
        towards_saddle ? walk->toe_off * (1.0 + rise) : walk->heel_strike * (1.0 - rise);
    const double leg = walk->pendulum + 2.0 * (double)walk->config->cop_range_m * sin(0.5 * angle);
    return sqrt(leg * leg - x * x - y * y);
}

/* The largest difference of a position from the closed form after walking way_m. */
static double difference_m(const steady_t *walk, const saddle_plan_t *plan, double way_m)
{
    const bool left = plan->support == (uint8_t)SADDLE_LEFT;
    const double side = left ? 1.0 : -1.0;
    const double x = way_m - 2.0 * walk->half * (double)plan->step_count;
    const double com_y = walk->amplitude * cos(0.5 * PI * way_m / walk->half);
    const double y = com_y - side * 0.5 * walk->width;
    const saddle_vec3_t *stance = &plan->foot_m[left ? SADDLE_LEFT : SADDLE_RIGHT];
    const saddle_vec3_t *swing = &plan->foot_m[left ? SADDLE_RIGHT : SADDLE_LEFT];
    const bool towards_saddle = plan->phase % 2u == 0u;
    const double end = towards_saddle ? walk->half : 0.0;
    double largest = 0.0;
    if (!(x > end - walk->half - VIA_POINT_WIDTH_M && x < end + VIA_POINT_WIDTH_M)) {
        return HUGE_VAL;
    }
    keep_larger(&largest, (double)plan->com_m.x - x);
    keep_larger(&largest, (double)plan->com_m.y - com_y);
    keep_larger(&largest, (double)plan->com_m.z - height(walk, x, y, towards_saddle));
    keep_larger(&largest, (double)stance->x);
    keep_larger(&largest, (double)stance->y - side * 0.5 * walk->width);
    keep_larger(&largest, (double)swing->x + side * walk->width * x / y);
    keep_larger(&largest, (double)swing->y + side * 0.5 * walk->width);
    return largest;
}

typedef struct {
    double first_m, hour_m, phase_rad;
} differences_t;

static int walk_an_hour(const saddle_config_t *config, double speed, differences_t *worst)
{
    static saddle_context_t context;
    saddle_input_t input = {.command = {.mode = SADDLE_COMMAND_WALK,
                                        .speed_m_s = (float)speed,
                                        .heel_strike_rad = 0.1745f},
                            .measurement = saddle_no_measurement()};
    saddle_output_t output;
    const steady_t walk = steady_walk(config, &input.command);
    differences_t largest = {0.0, 0.0, 0.0};
    int failures = saddle_init(&context, config) != SADDLE_OK ||
                   saddle_join(&context, &input.command) != SADDLE_OK;
    for (uint32_t tick = 0; tick <= TICKS_AN_HOUR; tick++, input.time_us += TICK_US) {
        const double way_m = walk.speed * (1.0e-6 * TICK_US * tick);
        failures += saddle_tick(&context, &input, &output) != SADDLE_OK;
        const double error_m = difference_m(&walk, &output.plan, way_m);
        keep_larger(way_m < 4.0 * walk.half ? &largest.first_m : &largest.hour_m, error_m);
        keep_larger(&largest.phase_rad,
                    turn_between(0.5 * PI * way_m / walk.half, (double)output.plan.theta_rad));
    }
    const bool holds = failures == 0 && largest.first_m < TOLERANCE_M &&
                       largest.hour_m < TOLERANCE_M && largest.phase_rad < TOLERANCE_RAD;
    if (!holds) {
        printf("FAIL ankle %d, %.3f m/s: first stride %.1e m, the hour %.1e m, phase %.1e rad\n",
               (int)config->ankle, speed, largest.first_m, largest.hour_m, largest.phase_rad);
    }
    keep_larger(&worst->first_m, largest.first_m);
    keep_larger(&worst->hour_m, largest.hour_m);
    keep_larger(&worst->phase_rad, largest.phase_rad);
    return holds ? 0 : 1;
}

int check_constant(void)
{
    int failures = 0;
    for (int ankle = 0; ankle < (int)SADDLE_ANKLE_COUNT; ankle += (int)SADDLE_ANKLE_CYCLOID) {
        saddle_config_t config = saddle_config_default(1.79f, 63.3f);
        differences_t worst = {0.0, 0.0, 0.0};
        config.ankle = (saddle_ankle_t)ankle;
        for (int i = 0; i < SPEEDS; i++) {
            const double share = (double)i / (SPEEDS - 1);
            failures +=
                walk_an_hour(&config, SLOWEST_M_S + (FASTEST_M_S - SLOWEST_M_S) * share, &worst);
        }
        printf("ankle %d: first stride %.1e m, the hour %.1e m, phase %.1e rad\n", ankle,
               worst.first_m, worst.hour_m, worst.phase_rad);
    }
    printf("constant: %d failures\n", failures);
    return failures;
}
