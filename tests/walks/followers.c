/* Wearers who are where the plan is, through random schedules of speeds, starts and stops, every other
 * one of them turning: the supervisor believes them, always knows a step for them and never calls them unstable. */
#include "walks.h"

#include "model/model.h"

#define FOLLOWERS 5000
#define SCHEDULE_US 30000000u
#define SETTLED_US 1000000u

/* What an exact follower departs from the steady walk by, where the plan's speed changes. */
#define DEVIATION_ML_M 0.07
#define DEVIATION_AP_M 1e-5

/* And in a turn: arcs of measured feet are of one curvature. */
#define TURNING_M 2e-3

typedef struct {
    uint64_t random;
    saddle_config_t config;
    saddle_context_t context;
    saddle_input_t input;
    uint64_t change_us; /* of the command */
    bool turns;
} follower_t;

static struct {
    uint64_t ticks, cautions;
    double ap_m, ml_m;
} seen;

static void random_body(follower_t *follower)
{
    saddle_config_t *config = &follower->config;
    do {
        *config = saddle_config_default((float)random_in(&follower->random, 1.1, 2.1), 70.0f);
        config->ankle = (saddle_ankle_t)(random_bits(&follower->random) % SADDLE_ANKLE_COUNT);
        config->acceleration_m_s2 = (float)random_in(&follower->random, 0.2, 1.0);
        config->shift_time_s = (float)random_in(&follower->random, 0.3, 1.5);
        if (random_bits(&follower->random) % 2u == 0u) {
            config->lateral_offset_m = (float)random_in(&follower->random, -0.02, 0.02);
            config->lateral_delay_rad = (float)random_in(&follower->random, -0.3, 0.5);
            config->vertical_offset_m = (float)random_in(&follower->random, -0.02, 0.02);
            config->vertical_delay_rad = (float)random_in(&follower->random, -0.5, 0.7);
            config->strike_share = (float)random_in(&follower->random, 0.2, 0.45);
        }
    } while (saddle_config_check(config) != NULL);
}

/* One in four stands. */
static void random_command(follower_t *follower)
{
    const double fastest =
        SADDLE_CEILING_MARGIN * (double)follower->context.model.body.speed_ceiling_m_s;
    const bool stands = random_bits(&follower->random) >> 62 == 0u;
    follower->input.command.mode = SADDLE_COMMAND_WALK;
    follower->input.command.speed_m_s =
        stands ? 0.0f : (float)random_in(&follower->random, 0.05, fastest);
    if (follower->turns) {
        follower->input.command.turn_rate_rad_s = (float)random_in(&follower->random, -0.6, 0.6);
    }
    follower->change_us += (uint64_t)random_in(&follower->random, 0.3e6, 8e6);
}

/* In the axes of the pelvis. */
static saddle_vec2_t faced(const saddle_plan_t *plan, float x, float y)
{
    const double yaw = (double)plan->pelvis_yaw_rad;
    return (saddle_vec2_t){(float)((double)x * cos(yaw) + (double)y * sin(yaw)),
                           (float)((double)y * cos(yaw) - (double)x * sin(yaw))};
}

static void measure(const saddle_plan_t *plan, saddle_measurement_t *measurement)
{
    measurement->com.height_m = plan->com_m.z;
    measurement->com.velocity_m_s = faced(plan, plan->com_velocity_m_s.x, plan->com_velocity_m_s.y);
    for (int side = 0; side < 2; side++) {
        measurement->foot[side].cop_m =
            faced(plan, plan->foot_m[side].x - plan->com_m.x, plan->foot_m[side].y - plan->com_m.y);
        measurement->foot[side].contact =
            side == (int)plan->support || !(plan->step_length_m > 0.0f);
    }
}

/* The first broken promise of a tick, or NULL. */
static const char *broken(const saddle_output_t *output, uint64_t time_us, bool turns)
{
    const double turning_m = turns ? TURNING_M : 0.0;
    const saddle_verdict_t *verdict = &output->verdict;
    const uint32_t faults = output->faults & ~(uint32_t)SADDLE_FAULT_SPEED_INFEASIBLE;
    const saddle_vec2_t off_m = verdict->xcom_deviation_m;
    keep_larger(&seen.ap_m, (double)off_m.x);
    keep_larger(&seen.ml_m, (double)off_m.y);
    seen.ticks++;
    seen.cautions += verdict->level == (uint8_t)SADDLE_LEVEL_CAUTION ? 1u : 0u;
    if (faults != 0u || (output->limits & (uint32_t)SADDLE_LIMIT_SAFE_STOP) != 0u) {
        return "is not believed";
    }
    if (verdict->level == (uint8_t)SADDLE_LEVEL_UNSTABLE) {
        return "is unstable";
    }
    if (verdict->level == (uint8_t)SADDLE_LEVEL_UNKNOWN && time_us > SETTLED_US) {
        return "is unknown";
    }
    if (verdict->compared && !verdict->recovery.found) {
        return "has no step";
    }
    if (!(fabs((double)off_m.x) < DEVIATION_AP_M + turning_m &&
          fabs((double)off_m.y) < DEVIATION_ML_M + turning_m)) {
        return "departs";
    }
    return NULL;
}

static int follow(uint64_t seed)
{
    static follower_t follower;
    saddle_output_t output;
    saddle_plan_t plan;
    follower = (follower_t){.random = seed * 0x9E3779B97F4A7C15u};
    random_bits(&follower.random);
    random_body(&follower);
    follower.turns = seed % 2u == 1u;
    int failures = saddle_init(&follower.context, &follower.config) != SADDLE_OK;
    saddle_tick(&follower.context, &follower.input, &output);
    while (follower.input.time_us < SCHEDULE_US && failures == 0) {
        follower.input.time_us += TICK_US;
        failures += saddle_plan_at(&follower.context, follower.input.time_us, &plan) != SADDLE_OK;
        measure(&plan, &follower.input.measurement);
        if (follower.input.time_us >= follower.change_us) {
            random_command(&follower);
        }
        failures += saddle_tick(&follower.context, &follower.input, &output) != SADDLE_OK;
        const char *what = broken(&output, follower.input.time_us, follower.turns);
        if (what != NULL) {
            printf("FAIL follower %llu at %.2f s, %.3f m/s: %s: reason %u, faults %x, %g %g m\n",
                   (unsigned long long)seed, 1e-6 * (double)follower.input.time_us,
                   (double)output.plan.speed_m_s, what, output.verdict.reason,
                   (unsigned)output.faults, (double)output.verdict.xcom_deviation_m.x,
                   (double)output.verdict.xcom_deviation_m.y);
            failures++;
        }
    }
    return failures > 0;
}

int check_followers(void)
{
    int failures = 0;
    for (uint64_t seed = 1; seed <= FOLLOWERS && failures < 10; seed++) {
        failures += follow(seed);
    }
    printf("%llu ticks, %.2f %% of them a caution; XCoM off by %.1e m AP, %.3f m ML at most\n",
           (unsigned long long)seen.ticks, 100.0 * (double)seen.cautions / (double)seen.ticks,
           seen.ap_m, seen.ml_m);
    printf("followers: %d failures\n", failures);
    return failures;
}
