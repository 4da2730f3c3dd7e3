/** The tick's contract: a complete output on every path, time, contexts, and whatever bytes come in. */
#include "core_test.h"

#include "output_fields.h"

#include "math/vec2.h"
#include "motion/plan_output.h"

static saddle_config_t config;
static saddle_context_t context;
static saddle_input_t input;
static saddle_output_t output;

static void prefill(void)
{
    memset(&output, 0xA5, sizeof output);
}

static saddle_measurement_t good_measurement(void)
{
    return (saddle_measurement_t){
        .com = {.height_m = 1.0f, .velocity_m_s = {1.1f, 0.05f}},
        .foot = {{.cop_m = {0.35f, 0.06f}, .contact = true},
                 {.cop_m = {-0.25f, -0.05f}, .contact = true}},
    };
}

static saddle_input_t walking_input(uint64_t time_us)
{
    return (saddle_input_t){.time_us = time_us,
                            .command = {SADDLE_COMMAND_WALK, 1.2f, 0.17453293f, 0.0f},
                            .measurement = good_measurement()};
}

void setUp(void)
{
    config = paper_config();
    config.command_max_age_s = 0.24f;
    config.com_max_age_s = 0.24f;
    config.foot_max_age_s = 0.24f;
    config.resume_time_s = 1.0f;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    input = walking_input(0);
    prefill();
}

void tearDown(void) {}

static saddle_status_t tick_at(uint64_t time_us)
{
    input.time_us = time_us;
    prefill();
    return saddle_tick(&context, &input, &output);
}

/* A steady walk from here on, at the command of the input. */
static void join(void)
{
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_join(&context, &input.command));
}

static bool same_output(const saddle_output_t *a, const saddle_output_t *b)
{
    for (size_t i = 0; i < COUNT_OF(FIELDS); i++) {
        if (memcmp((const char *)a + FIELDS[i].offset, (const char *)b + FIELDS[i].offset,
                   FIELDS[i].size) != 0) {
            return false;
        }
    }
    return true;
}

static bool finite_output(const saddle_output_t *o)
{
    for (size_t i = 0; i < COUNT_OF(FIELDS); i++) {
        for (size_t k = 0; FIELDS[i].kind == FLOATS && k < FIELDS[i].size; k += sizeof(float)) {
            float value;
            memcpy(&value, (const char *)o + FIELDS[i].offset + k, sizeof value);
            if (!isfinite(value)) {
                return false;
            }
        }
    }
    return true;
}

/* Between two neighbours there is room for padding only: nothing is left out above. */
static void test_field_list_is_complete(void)
{
    size_t end = 0;
    for (size_t i = 0; i < COUNT_OF(FIELDS); i++) {
        const size_t alignment = FIELDS[i].offset % 8u == 0u ? 8u : 4u;
        TEST_ASSERT_TRUE(FIELDS[i].offset >= end);
        TEST_ASSERT_TRUE(FIELDS[i].offset - end < alignment);
        end = FIELDS[i].offset + FIELDS[i].size;
    }
    TEST_ASSERT_TRUE(sizeof(saddle_output_t) - end < 8u);
}

static void assert_hold(saddle_status_t status)
{
    const saddle_output_t hold = {.status = status};
    TEST_ASSERT_EQUAL_INT(status, output.status);
    TEST_ASSERT_TRUE(same_output(&hold, &output));
}

static void test_null_arguments_are_rejected_with_a_complete_output(void)
{
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_tick(NULL, &input, &output));
    assert_hold(SADDLE_ERROR_NULL);
    prefill();
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_tick(&context, NULL, &output));
    assert_hold(SADDLE_ERROR_NULL);
    prefill();
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_tick(NULL, NULL, &output));
    assert_hold(SADDLE_ERROR_NULL);
}

static void test_tick_without_an_output_changes_nothing(void)
{
    input.time_us = 5000000;
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_tick(&context, &input, NULL));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_tick(NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(0)); /* still the first */
}

static void test_context_without_init_is_rejected_with_a_complete_output(void)
{
    const uint8_t fills[] = {0x00, 0xA5, 0xFF};
    for (size_t i = 0; i < COUNT_OF(fills); i++) {
        memset(&context, fills[i], sizeof context);
        TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED, tick_at(0));
        assert_hold(SADDLE_ERROR_UNINITIALISED);
    }
}

static void test_failed_init_leaves_the_context_uninitialised(void)
{
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(0));
    config.body_height_m = NAN;
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_CONFIG, saddle_init(&context, &config));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED, tick_at(80000));
    assert_hold(SADDLE_ERROR_UNINITIALISED);

    config = paper_config();
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_init(&context, NULL));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED, tick_at(160000));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_init(NULL, &config));
}

static void test_good_tick_writes_every_field(void)
{
    saddle_output_t other;
    saddle_context_t twin;
    saddle_init(&twin, &config);
    join();
    saddle_join(&twin, &input.command);
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(0));
    memset(&other, 0x5A, sizeof other);
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_tick(&twin, &input, &other));
    TEST_ASSERT_TRUE(same_output(&output, &other)); /* whatever lay there before */
    TEST_ASSERT_TRUE(output.plan.valid);
    saddle_scores_t scores;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_score_plan(&context, &output.plan, &scores));
    TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_ALL, scores.valid);
    TEST_ASSERT_EQUAL_HEX32(0, output.faults);
    TEST_ASSERT_EQUAL_HEX32(0, output.limits);
}

static void test_time_backwards_is_rejected_and_ignored(void)
{
    saddle_context_t twin;
    saddle_output_t undisturbed;
    saddle_init(&twin, &config);
    tick_at(1000000);
    saddle_tick(&twin, &input, &undisturbed);

    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME, tick_at(999999));
    assert_hold(SADDLE_ERROR_TIME);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME, tick_at(0));
    assert_hold(SADDLE_ERROR_TIME);

    TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(1080000));
    saddle_tick(&twin, &input, &undisturbed);
    TEST_ASSERT_TRUE(same_output(&undisturbed, &output));
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(1080000)); /* the same instant again is no error */
}

static void test_plan_advances_by_the_time_that_passed_from_any_origin(void)
{
    const uint64_t origins[] = {0, 1, 0xFFFFFFFFu, 0x100000000u, UINT64_MAX - 80000u};
    for (size_t i = 0; i < COUNT_OF(origins); i++) {
        saddle_init(&context, &config);
        join();
        tick_at(origins[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, output.plan.com_m.x);
        tick_at(origins[i] + 80000u);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.2 * 0.08, output.plan.com_m.x);
        TEST_ASSERT_EQUAL_HEX32(0, output.limits);
    }
}

static void test_late_tick_advances_by_tick_max_and_reports_it(void)
{
    const uint64_t gaps[] = {200001,    1000000, 0xFFFFFFFFu, 0x100000000u, 0x100000000u + 80000u,
                             UINT64_MAX};
    input.measurement = saddle_no_measurement();
    for (size_t i = 0; i < COUNT_OF(gaps); i++) {
        saddle_init(&context, &config);
        join();
        tick_at(0);
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(gaps[i]));
        TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_TICK_GAP, output.limits);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.2 * 0.2, output.plan.com_m.x);
    }
    saddle_init(&context, &config);
    tick_at(0);
    tick_at(200000); /* tick_max_s itself is not late */
    TEST_ASSERT_EQUAL_HEX32(0, output.limits);
    tick_at(400001);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_TICK_GAP, output.limits);
    tick_at(480001);
    TEST_ASSERT_EQUAL_HEX32(0, output.limits); /* only the late tick is flagged */
}

static void test_unusable_command_leaves_the_last_good_one(void)
{
    input.command.speed_m_s = NAN;
    tick_at(0);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COMMAND, output.faults);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, output.plan.mode); /* none yet */

    input = walking_input(0);
    join();
    tick_at(80000);
    input.command = (saddle_command_t){.mode = 200, .speed_m_s = 0.5f};
    tick_at(160000);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COMMAND, output.faults);
    TEST_ASSERT_EQUAL_HEX32(0, output.limits);
    ASSERT_SAME_FLOAT(1.2f, output.plan.speed_m_s);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.2 * 0.16, output.plan.com_m.x);
}

static void test_stop_is_applied_whatever_its_numbers(void)
{
    join();
    tick_at(0);
    input.command = (saddle_command_t){SADDLE_COMMAND_STAND, NAN, INFINITY, 0.0f};
    tick_at(80000);
    TEST_ASSERT_EQUAL_HEX32(0, output.faults);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STOPPING, output.plan.mode);
}

static void test_standing_is_a_plan_of_both_feet_on_the_ground(void)
{
    input.command = (saddle_command_t){.mode = SADDLE_COMMAND_STAND};
    input.measurement.com.velocity_m_s = (saddle_vec2_t){0.0f, 0.0f};
    for (uint64_t t = 0; t < 1000000u; t += 80000u) {
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(t));
        TEST_ASSERT_TRUE(output.plan.valid);
        TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, output.plan.mode);
        ASSERT_SAME_FLOAT(0.11f, output.plan.foot_m[SADDLE_LEFT].y);
        ASSERT_SAME_FLOAT(-0.11f, output.plan.foot_m[SADDLE_RIGHT].y);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, output.plan.com_m.y);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, output.plan.com_velocity_m_s.z);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_MOS_COM | SADDLE_VALID_MOS_XCOM |
                                    SADDLE_VALID_GRAVITY | SADDLE_VALID_STOP,
                                output.scores.valid);
    }
}

static void test_init_again_starts_over_and_keeps_no_pointer(void)
{
    tick_at(0);
    const saddle_output_t first = output;
    for (uint64_t k = 1; k < 50; k++) {
        tick_at(80000 * k);
    }
    TEST_ASSERT_FALSE(same_output(&first, &output));
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    memset(&config, 0, sizeof config); /* the context has its own copy */
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(0));
    TEST_ASSERT_TRUE(same_output(&first, &output));
}

static void test_contexts_are_independent_and_deterministic(void)
{
    saddle_context_t one;
    saddle_context_t two;
    saddle_context_t alone;
    saddle_output_t from_one;
    saddle_output_t from_two;
    saddle_output_t from_alone;
    saddle_config_t child = saddle_config_default(1.2f, 25.0f);
    saddle_init(&one, &config);
    saddle_init(&two, &child);
    saddle_init(&alone, &config);
    for (uint64_t k = 0; k < 200; k++) {
        const saddle_input_t adult_input = walking_input(80000 * k);
        saddle_input_t child_input = walking_input(70000 * k);
        child_input.command.speed_m_s = 0.6f;
        saddle_tick(&one, &adult_input, &from_one);
        saddle_tick(&two, &child_input, &from_two);
        TEST_ASSERT_FALSE(same_output(&from_one, &from_two));
    }
    for (uint64_t k = 0; k < 200; k++) {
        const saddle_input_t adult_input = walking_input(80000 * k);
        saddle_tick(&alone, &adult_input, &from_alone);
    }
    TEST_ASSERT_TRUE(same_output(&from_one, &from_alone));
}

/* The model page's figures of the plan: min S_SW, and the share of time with the XCoM inside. */
static void test_planned_walk_has_the_papers_stability(void)
{
    static const struct {
        float speed;
        double s_sw, xcom_inside;
    } table[] = {{0.3f, 0.363, 0.76}, {0.5f, 0.363, 0.55}, {0.7f, 0.545, 0.41},
                 {1.0f, 0.682, 0.0},  {1.2f, 0.735, 0.0},  {1.6f, 0.801, 0.0}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        double lowest = 1.0;
        int inside = 0;
        int count = 0;
        saddle_init(&context, &config);
        input.command.speed_m_s = table[i].speed;
        input.measurement = saddle_no_measurement();
        join();
        prefill();
        output.plan.stride_count = 0;
        for (uint64_t t = 0; output.plan.stride_count < 1u || t < 100000u; t += 1000u) {
            tick_at(t);
            saddle_scores_t scores;
            saddle_score_plan(&context, &output.plan, &scores);
            lowest = fmin(lowest, (double)scores.s_sw);
            inside += scores.mos_xcom_m > 0.0f ? 1 : 0;
            count++;
            TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.0, scores.s_pend);
            TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.0, scores.s_jump);
        }
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, table[i].s_sw, lowest);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, table[i].xcom_inside, (double)inside / count);
    }
}

/* Any configuration that the check accepts. */
static saddle_config_t random_config(uint32_t *state)
{
    for (;;) {
        saddle_config_t random = paper_config();
        for (size_t i = 0; saddle_config_field(i) != NULL; i++) {
            const saddle_config_field_t *field = saddle_config_field(i);
            const uint32_t choice = random_bits(state) % 8u;
            if (choice < 4u) {
                *config_field(&random, i) = random_in(state, field->min, field->max);
            } else if (choice < 6u) {
                *config_field(&random, i) = choice == 4u ? field->min : field->max;
            }
        }
        random.ankle = (saddle_ankle_t)(random_bits(state) % (uint32_t)SADDLE_ANKLE_COUNT);
        if (saddle_config_check(&random) == NULL) {
            return random;
        }
    }
}

/* Any bits at all, or something plausible. */
static float random_float(uint32_t *state, float max)
{
    const bool plausible = random_bits(state) % 4u != 0u;
    const float any = float_of_bits(random_bits(state));
    return plausible ? random_in(state, -max, max) : any;
}

static uint32_t random_age(uint32_t *state)
{
    const bool fresh = random_bits(state) % 4u != 0u;
    return fresh ? random_bits(state) % 20000u : random_bits(state);
}

/* Feet of any bytes, or near those of the plan, so that landings are taken over. */
static void random_feet(uint32_t *state, const saddle_plan_t *plan, void *feet)
{
    saddle_measurement_t any;
    const bool near_plan = random_bits(state) % 4u != 0u;
    const float spread = random_bits(state) % 2u == 0u ? 0.02f : 0.5f;
    for (int side = 0; side < 2; side++) {
        any.foot[side].cop_m.x = random_float(state, 1.0f);
        any.foot[side].cop_m.y = random_float(state, 0.3f);
        any.foot[side].ground_m_s =
            random_bits(state) % 4u == 0u ? random_float(state, 2.0f) : 0.0f;
        any.foot[side].since_us = random_age(state);
        any.foot[side].contact = near_plan || random_bits(state) % 2u != 0u;
        any.foot[side].age_us = near_plan ? 0u : random_age(state);
        if (near_plan) {
            any.foot[side].cop_m.x =
                plan->foot_m[side].x - plan->com_m.x + random_in(state, -spread, spread);
            any.foot[side].cop_m.y =
                plan->foot_m[side].y - plan->com_m.y + random_in(state, -spread, spread);
        }
    }
    memcpy(feet, any.foot, sizeof any.foot);
}

/* Now and then nothing comes anew: numbers that keep their bits. */
static void random_measurement(uint32_t *state, saddle_measurement_t *any)
{
    if (random_bits(state) % 4u != 0u) {
        any->com.height_m = random_float(state, 2.5f);
        any->com.velocity_m_s.x = random_float(state, 6.0f);
        any->com.velocity_m_s.y = random_float(state, 2.0f);
        any->com.age_us = random_age(state);
    }
    if (random_bits(state) % 4u != 0u) {
        random_feet(state, &output.plan, any->foot);
    }
}

/* Near the plan's posture in number and time, so that all is compared and every level is met. */
static void plausible_measurement(uint32_t *state, saddle_measurement_t *any)
{
    const saddle_plan_t *plan = &output.plan;
    const float spread = random_bits(state) % 4u == 0u ? 1.0f : 0.1f;
    any->com.height_m = config.pendulum_ratio * config.body_height_m;
    any->com.velocity_m_s.x = plan->com_velocity_m_s.x + random_in(state, -spread, spread);
    any->com.velocity_m_s.y = plan->com_velocity_m_s.y + random_in(state, -spread, spread);
    any->com.age_us = 0;
    for (int side = 0; side < 2; side++) {
        any->foot[side].cop_m.x = plan->foot_m[side].x - plan->com_m.x;
        any->foot[side].cop_m.y = plan->foot_m[side].y - plan->com_m.y;
        any->foot[side].ground_m_s = 0.0f;
        any->foot[side].since_us = 0;
        any->foot[side].contact = side == (int)plan->support || !(plan->speed_m_s > 0.0f);
        any->foot[side].age_us = 0;
    }
}

static void random_input(uint32_t *state, bool plausible, saddle_input_t *any)
{
    const uint32_t choice = random_bits(state) % 256u;
    if (choice == 0u) {
        any->time_us = ((uint64_t)random_bits(state) << 32) | random_bits(state);
    } else if (choice < 10u) {
        any->time_us -= random_bits(state) % 200000u;
    } else {
        any->time_us += random_bits(state) % (choice < 128u ? 250000u : 20000u);
    }
    if (choice % 32u == 1u) { /* a command stays for a while, so that walks go on */
        any->command.mode = (uint8_t)(choice < 128u ? 1u : random_bits(state));
        any->command.speed_m_s = random_float(state, 3.0f);
        any->command.heel_strike_rad = random_float(state, 0.6f);
        any->command.turn_rate_rad_s = random_float(state, 1.0f);
    }
    any->command_age_us = random_bits(state) % 64u == 0u ? random_bits(state) : 0u;
    if (plausible) {
        plausible_measurement(state, &any->measurement);
    } else {
        random_measurement(state, &any->measurement);
    }
}

static void assert_sound_plan(const saddle_output_t *o)
{
    const saddle_plan_t *plan = &o->plan;
    TEST_ASSERT_TRUE_MESSAGE(finite_output(o), "not finite");
    TEST_ASSERT_TRUE(o->status == SADDLE_OK || o->status == SADDLE_ERROR_TIME);
    TEST_ASSERT_EQUAL(o->status == SADDLE_OK, plan->valid);
    TEST_ASSERT_TRUE(o->limits < 1u << 7);
    TEST_ASSERT_TRUE(plan->phase <= 3u && plan->support <= 1u && plan->mode <= 3u);
    TEST_ASSERT_TRUE(plan->theta_rad >= 0.0f && (double)plan->theta_rad < 2.0 * PI);
    TEST_ASSERT_TRUE(plan->speed_m_s >= 0.0f);
    TEST_ASSERT_TRUE(plan->time_to_via_point_s >= 0.0f);
    TEST_ASSERT_TRUE(plan->time_to_heel_strike_s >= 0.0f);
    TEST_ASSERT_TRUE(plan->time_to_toe_off_s >= 0.0f);
    if (plan->valid) {
        TEST_ASSERT_TRUE(plan->com_m.z > 0.0f);
        TEST_ASSERT_TRUE(plan->leg_length_m > 0.0f);
    }
}

/* A score that is not valid is 0. */
static void assert_sound_scores(const saddle_scores_t *scores)
{
    const struct {
        uint32_t valid;
        float number;
    } numbers[] = {
        {SADDLE_VALID_V_COMP, scores->v_comp_m_s},
        {SADDLE_VALID_STEP, scores->s_pend},
        {SADDLE_VALID_STEP, scores->s_jump},
        {SADDLE_VALID_S_SW, scores->s_sw},
        {SADDLE_VALID_MOS_COM, scores->mos_com_m},
        {SADDLE_VALID_MOS_XCOM, scores->mos_xcom_m},
        {SADDLE_VALID_GRAVITY, scores->gravity_n.x},
        {SADDLE_VALID_GRAVITY, scores->gravity_n.y},
        {SADDLE_VALID_STOP, scores->excess_stop_j},
        {SADDLE_VALID_STOP, scores->can_stop ? 1.0f : 0.0f},
    };
    TEST_ASSERT_TRUE(scores->valid <= (uint32_t)SADDLE_VALID_ALL);
    for (size_t i = 0; i < COUNT_OF(numbers); i++) {
        TEST_ASSERT_TRUE((scores->valid & numbers[i].valid) != 0u || numbers[i].number == 0.0f);
    }
    TEST_ASSERT_TRUE(scores->bos.defined || scores->bos.radius_m == 0.0f);
}

static const uint32_t COM_MISSING = SADDLE_FAULTS_COM & ~(uint32_t)SADDLE_FAULT_COM_LOW;
static const uint32_t FEET_MISSING = SADDLE_FAULTS_LEFT | SADDLE_FAULTS_RIGHT;

static void assert_unusable_input_is_not_scored(const saddle_output_t *o)
{
    const uint32_t of_com = SADDLE_VALID_MOS_XCOM | SADDLE_VALID_STOP;
    const uint32_t of_feet =
        of_com | SADDLE_VALID_S_SW | SADDLE_VALID_MOS_COM | SADDLE_VALID_GRAVITY;
    if ((o->faults & COM_MISSING) != 0u) {
        TEST_ASSERT_EQUAL_HEX32(0, o->scores.valid & of_com);
        TEST_ASSERT_TRUE(o->scores.xcom_m.x == 0.0f && o->scores.xcom_m.y == 0.0f);
    }
    if ((o->faults & FEET_MISSING) != 0u) {
        TEST_ASSERT_EQUAL_HEX32(0, o->scores.valid & of_feet);
        TEST_ASSERT_FALSE(o->scores.bos.defined);
    }
    if ((o->faults & (COM_MISSING | FEET_MISSING)) != 0u) {
        TEST_ASSERT_EQUAL_UINT8(SADDLE_LEVEL_UNKNOWN, o->verdict.level);
        TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_INPUT, o->verdict.reason);
        TEST_ASSERT_FALSE(o->verdict.compared);
    }
}

/* Each reason belongs to its levels: 1 << saddle_level_t. */
static unsigned levels_of(uint8_t reason)
{
    switch (reason) {
    case SADDLE_REASON_NONE: return 1u << SADDLE_LEVEL_STABLE;
    case SADDLE_REASON_INPUT:
    case SADDLE_REASON_NO_WALK:
    case SADDLE_REASON_SETTLING: return 1u << SADDLE_LEVEL_UNKNOWN;
    case SADDLE_REASON_NO_STEP:
    case SADDLE_REASON_FORWARD:
    case SADDLE_REASON_BACKWARD:
    case SADDLE_REASON_LEFT:
    case SADDLE_REASON_RIGHT:
    case SADDLE_REASON_SINKING: return 1u << SADDLE_LEVEL_CAUTION | 1u << SADDLE_LEVEL_UNSTABLE;
    default: return 1u << SADDLE_LEVEL_CAUTION;
    }
}

static void assert_sound_margin(const saddle_output_t *o)
{
    const saddle_verdict_t *verdict = &o->verdict;
    TEST_ASSERT_TRUE(verdict->driver <= (uint8_t)SADDLE_REASON_SINKING);
    TEST_ASSERT_TRUE(verdict->caution_below >= 0.0f);
    TEST_ASSERT_EQUAL(verdict->margin_known, verdict->driver != (uint8_t)SADDLE_REASON_NONE);
    if (!verdict->margin_known) {
        TEST_ASSERT_TRUE(verdict->margin == 0.0f && verdict->caution_below == 0.0f);
    }
}

static void assert_sound_verdict(const saddle_output_t *o)
{
    const saddle_verdict_t *verdict = &o->verdict;
    const saddle_recovery_t *recovery = &verdict->recovery;
    TEST_ASSERT_TRUE((levels_of(verdict->reason) >> verdict->level & 1u) != 0u);
    assert_sound_margin(o);
    if (!verdict->compared) {
        const saddle_output_t whole = {.verdict = *verdict};
        const saddle_output_t nothing = {.verdict = {.level = verdict->level,
                                                     .reason = verdict->reason,
                                                     .driver = verdict->driver,
                                                     .margin_known = verdict->margin_known,
                                                     .margin = verdict->margin,
                                                     .caution_below = verdict->caution_below}};
        TEST_ASSERT_TRUE(same_output(&nothing, &whole)); /* every other number 0 */
        return;
    }
    TEST_ASSERT_TRUE(recovery->foot <= 1u);
    TEST_ASSERT_EQUAL(recovery->margin_m >= 0.0f, recovery->found);
    TEST_ASSERT_TRUE(recovery->found || (!recovery->stops && recovery->landing_m.x == 0.0f &&
                                         recovery->landing_m.y == 0.0f));
}

static void assert_sound(const saddle_output_t *o)
{
    TEST_ASSERT_TRUE(o->faults < 1u << 16);
    assert_sound_plan(o);
    assert_sound_scores(&o->scores);
    if (o->status == SADDLE_OK) {
        assert_unusable_input_is_not_scored(o);
        assert_sound_verdict(o);
    }
}

/* The plan between two ticks, wherever it is predicted. */
static void query(uint32_t *state, uint64_t last_us)
{
    saddle_output_t at = {.status = SADDLE_OK};
    at.status = saddle_plan_at(&context, last_us + random_bits(state) % 6000000u, &at.plan);
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_score_plan(&context, &at.plan, &at.scores));
    assert_sound_plan(&at);
    assert_sound_scores(&at.scores);
}

/* Of this seed's configurations some bring the CoM to where no leg reaches it. */
static void test_any_bytes_in_any_configuration_give_a_sound_output(void)
{
    uint32_t state = 13;
    int walking = 0;
    int stopping = 0;
    int valid_scores = 0;
    int refused = 0;
    uint32_t faults = 0;
    uint32_t limits = 0;
    int levels[SADDLE_LEVEL_UNSTABLE + 1] = {0};
    int reasons[SADDLE_REASON_SINKING + 1] = {0};
    for (int k = 0; k < MANY(300000); k++) {
        if (k % 200 == 0) {
            config = random_config(&state);
            TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
            input = walking_input(random_bits(&state));
        }
        random_input(&state, k / 200 % 4 == 0, &input);
        prefill();
        const saddle_status_t status = saddle_tick(&context, &input, &output);
        TEST_ASSERT_EQUAL_INT(status, output.status);
        assert_sound(&output);
        if (status == SADDLE_OK) {
            query(&state, input.time_us);
        }
        walking += output.plan.mode == (uint8_t)SADDLE_MODE_WALKING ? 1 : 0;
        stopping += output.plan.mode == (uint8_t)SADDLE_MODE_STOPPING ? 1 : 0;
        valid_scores += (output.scores.valid & SADDLE_VALID_MOS_XCOM) != 0u ? 1 : 0;
        refused += output.status != SADDLE_OK ? 1 : 0;
        faults |= output.faults;
        limits |= output.limits;
        levels[output.verdict.level]++;
        reasons[output.verdict.reason]++;
    }
    if (MANY(300000) < 300000) {
        return;
    }
    /* The bytes are hostile, but not so hostile that nothing is computed. */
    TEST_ASSERT_GREATER_THAN_INT(10000, walking);
    TEST_ASSERT_GREATER_THAN_INT(5000, stopping);
    TEST_ASSERT_GREATER_THAN_INT(5000, valid_scores);
    TEST_ASSERT_GREATER_THAN_INT(1000, refused);
    TEST_ASSERT_EQUAL_HEX32((1u << 16) - 1u, faults); /* each was met */
    TEST_ASSERT_EQUAL_HEX32((1u << 7) - 1u, limits);
    for (size_t i = 0; i < COUNT_OF(levels); i++) {
        TEST_ASSERT_GREATER_THAN_INT(5000, levels[i]);
    }
    for (size_t i = 0; i < COUNT_OF(reasons); i++) {
        TEST_ASSERT_GREATER_THAN_INT(10, reasons[i]); /* some need a rare configuration */
    }
}

static saddle_plan_t plan_at(uint64_t time_us)
{
    saddle_output_t at;
    memset(&at, 0xA5, sizeof at);
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_plan_at(&context, time_us, &at.plan));
    return at.plan;
}

static bool same_plan(const saddle_plan_t *a, const saddle_plan_t *b)
{
    saddle_output_t one = {.plan = *a};
    saddle_output_t two = {.plan = *b};
    return same_output(&one, &two);
}

/* Through start, changes, stop and restart: with any tick, and without a trace in the context. */
static void test_plan_at_is_the_next_ticks_plan_bit_for_bit(void)
{
    uint32_t state = 47;
    uint64_t t = 1000000;
    input.measurement = saddle_no_measurement();
    for (int i = 0; i < MANY(20000); i++) {
        if (i % 50 == 0) {
            config.ankle = (saddle_ankle_t)(random_bits(&state) % (uint32_t)SADDLE_ANKLE_COUNT);
            input.command.speed_m_s =
                random_bits(&state) % 3u == 0u ? 0.0f : random_in(&state, 0.0f, 2.0f);
        }
        if (i % 1000 == 0) {
            saddle_init(&context, &config);
        }
        tick_at(t);
        const saddle_context_t before = context;
        t += random_bits(&state) % 200001u;
        const saddle_plan_t predicted = plan_at(t);
        TEST_ASSERT_EQUAL_MEMORY(&before, &context, sizeof context);
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(t));
        ASSERT_SAME_FLOAT(predicted.com_m.x, output.plan.com_m.x);
        ASSERT_SAME_FLOAT(predicted.com_m.y, output.plan.com_m.y);
        ASSERT_SAME_FLOAT(predicted.com_m.z, output.plan.com_m.z);
        for (int side = 0; side < 2; side++) {
            ASSERT_SAME_FLOAT(predicted.foot_m[side].x, output.plan.foot_m[side].x);
            ASSERT_SAME_FLOAT(predicted.foot_m[side].y, output.plan.foot_m[side].y);
            ASSERT_SAME_FLOAT(predicted.foot_m[side].z, output.plan.foot_m[side].z);
        }
    }
}

static void test_plan_at_of_a_steady_walk_is_the_next_ticks_in_every_field(void)
{
    input.measurement = saddle_no_measurement();
    join();
    tick_at(0);
    for (uint64_t t = 80000; t < 8000000u; t += 80000u) {
        const saddle_plan_t predicted = plan_at(t);
        tick_at(t);
        TEST_ASSERT_TRUE(same_plan(&predicted, &output.plan));
    }
}

/* ---- saddle_reference_after() --------------------------------------------------------------- */

static saddle_reference_t reference_after(float after_s)
{
    saddle_reference_t reference;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK,
                          saddle_reference_after(&context, &output.plan, after_s, &reference));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.0,
                              (double)reference.load[0] + (double)reference.load[1]);
    return reference;
}

static void test_reference_at_once_is_the_plan_s(void)
{
    join();
    for (uint64_t t = 0; t < 2000000u; t += 80000u) {
        tick_at(t);
        const saddle_reference_t now = reference_after(0.0f);
        ASSERT_SAME_FLOAT(output.plan.reference.xcom_m.x, now.xcom_m.x);
        ASSERT_SAME_FLOAT(output.plan.reference.cop_m.y, now.cop_m.y);
        ASSERT_SAME_FLOAT(output.plan.reference.load[SADDLE_LEFT], now.load[SADDLE_LEFT]);
    }
}

/* Also over the end of a first swing: a step of 5 ms, and no further than at 6 m/s. */
static void test_reference_goes_on_without_a_jump_from_standing_on(void)
{
    for (uint64_t t = 0; t < 4000000u; t += 80000u) {
        input.command = (saddle_command_t){SADDLE_COMMAND_WALK, 1.2f, 0.17f, 0.0f};
        tick_at(t);
        saddle_reference_t before = reference_after(0.0f);
        for (int k = 1; k <= 100; k++) {
            const saddle_reference_t after = reference_after(0.005f * (float)k);
            TEST_ASSERT_DOUBLE_WITHIN(0.03, (double)before.xcom_m.x, (double)after.xcom_m.x);
            TEST_ASSERT_DOUBLE_WITHIN(0.03, (double)before.xcom_m.y, (double)after.xcom_m.y);
            before = after;
        }
    }
}

static void test_reference_of_another_time_or_no_plan_is_rejected(void)
{
    saddle_reference_t reference;
    join();
    tick_at(0);
    const float times_s[] = {-0.001f, 0.501f, NAN};
    for (size_t i = 0; i < COUNT_OF(times_s); i++) {
        memset(&reference, 0xA5, sizeof reference);
        TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME, saddle_reference_after(&context, &output.plan,
                                                                        times_s[i], &reference));
        ASSERT_SAME_FLOAT(0.0f, reference.xcom_m.x);
    }
    saddle_plan_t plan = output.plan;
    plan.support = 2; /* no foot */
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME,
                          saddle_reference_after(&context, &plan, 0.1f, &reference));
    plan.valid = false;
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME,
                          saddle_reference_after(&context, &plan, 0.1f, &reference));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_reference_after(NULL, &plan, 0.1f, &reference));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL,
                          saddle_reference_after(&context, NULL, 0.1f, &reference));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_reference_after(&context, &plan, 0.1f, NULL));
    memset(&context, 0, sizeof context);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED,
                          saddle_reference_after(&context, &plan, 0.1f, &reference));
}

/* A bit of the memory that flips, or code that writes where it should not. */
static void test_a_damaged_context_gives_no_number_that_is_not_finite(void)
{
    float *const damaged[] = {&context.planner.cycle.last_step_m.x,
                              &context.supervisor.learning.walk.step_time_s};
    const saddle_context_t sound = context;
    for (size_t i = 0; i < COUNT_OF(damaged); i++) {
        context = sound;
        *damaged[i] = NAN;
        TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NUMBER, tick_at(80000));
        assert_hold(SADDLE_ERROR_NUMBER);
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(0));
    }
}

static void test_a_damaged_context_gives_no_such_plan(void)
{
    saddle_plan_t plan;
    tick_at(0);
    context.planner.cycle.last_step_m.x = INFINITY;
    memset(&plan, 0xA5, sizeof plan);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NUMBER, saddle_plan_at(&context, 0, &plan));
    TEST_ASSERT_FALSE(plan.valid);
    ASSERT_SAME_FLOAT(0.0f, plan.last_step_m.x);
}

/* A person who differs in every field of the shape, and in others, which are not taken over. */
static saddle_config_t another_shape(void)
{
    saddle_config_t shape = config;
    shape.lateral_factor = 1.3f;
    shape.lateral_offset_m = -0.02f;
    shape.lateral_delay_rad = 0.3f;
    shape.vertical_offset_m = 0.01f;
    shape.vertical_delay_rad = -0.25f;
    shape.strike_share = 0.4f;
    shape.swing_begin = -0.32f;
    shape.swing_end = 1.04f;
    shape.swing_skew = 1.47f;
    return shape;
}

static void walk_steadily(saddle_ankle_t ankle)
{
    config.ankle = ankle;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    input.measurement = saddle_no_measurement();
    join();
    tick_at(0);
}

static void same_place(saddle_vec3_t expected, saddle_vec3_t actual)
{
    const double tolerance = 3e-7; /* a rounding or two of a metre */
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)expected.x, (double)actual.x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)expected.y, (double)actual.y);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)expected.z, (double)actual.z);
}

static void no_position_jumps(const saddle_plan_t *before, uint64_t time_us)
{
    saddle_plan_t after;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_plan_at(&context, time_us, &after));
    same_place(before->com_m, after.com_m);
    same_place(before->foot_m[SADDLE_LEFT], after.foot_m[SADDLE_LEFT]);
    same_place(before->foot_m[SADDLE_RIGHT], after.foot_m[SADDLE_RIGHT]);
}

/* Tried at every 10 ms of three steps. */
static void test_a_shape_is_taken_over_in_the_first_quarter_of_a_step_without_a_jump(void)
{
    for (int ankle = 0; ankle < SADDLE_ANKLE_COUNT; ankle++) {
        const saddle_config_t shape = another_shape();
        uint32_t taken = 0;
        for (uint64_t start_us = 0; start_us < 1500000u; start_us += 10000u) {
            walk_steadily((saddle_ankle_t)ankle);
            for (uint64_t time_us = 0; time_us <= start_us; time_us += 10000u) {
                tick_at(time_us);
            }
            const saddle_context_t untouched = context;
            const saddle_plan_t before = output.plan;
            const bool first_quarter =
                before.phase % 2u == 1u && -2.0f * before.com_m.x >= 0.5f * before.step_length_m;
            const saddle_status_t status = saddle_adapt(&context, &shape);
            TEST_ASSERT_EQUAL_INT(first_quarter ? SADDLE_OK : SADDLE_ERROR_TIME, status);
            if (status != SADDLE_OK) {
                TEST_ASSERT_EQUAL_MEMORY(&untouched, &context, sizeof context);
                continue;
            }
            taken++;
            no_position_jumps(&before, start_us);
        }
        TEST_ASSERT_GREATER_THAN_UINT32(10, taken);
    }
}

static void test_a_walk_goes_on_in_the_shape_that_it_took_over(void)
{
    walk_steadily(SADDLE_ANKLE_CYCLOID);
    saddle_config_t shape = another_shape();
    shape.half_step_intercept_m = 0.2f; /* not of the shape */
    uint64_t time_us = 0;
    while (saddle_adapt(&context, &shape) != SADDLE_OK) {
        time_us += 20000u;
        tick_at(time_us);
    }
    saddle_context_t shaped;
    shape.half_step_intercept_m = config.half_step_intercept_m;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&shaped, &shape));
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_join(&shaped, &input.command));
    saddle_output_t expected;
    saddle_input_t at = input;
    for (at.time_us = 0; at.time_us < 4000000u; at.time_us += 20000u) {
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_tick(&shaped, &at, &expected));
        if (at.time_us > time_us) {
            tick_at(at.time_us);
        }
    }
    same_place(expected.plan.com_m, output.plan.com_m);
    same_place(expected.plan.foot_m[SADDLE_LEFT], output.plan.foot_m[SADDLE_LEFT]);
    same_place(expected.plan.foot_m[SADDLE_RIGHT], output.plan.foot_m[SADDLE_RIGHT]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)expected.plan.time_to_heel_strike_s,
                              (double)output.plan.time_to_heel_strike_s);
}

static void test_a_shape_is_taken_over_while_standing(void)
{
    const saddle_config_t shape = another_shape();
    input.command.mode = SADDLE_COMMAND_STAND;
    tick_at(0);
    const saddle_plan_t before = output.plan;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_adapt(&context, &shape));
    no_position_jumps(&before, 0);
    ASSERT_SAME_FLOAT(shape.swing_skew, context.model.config.swing_skew);
}

static void test_a_shape_that_cannot_be_used_is_rejected(void)
{
    saddle_config_t shape = another_shape();
    saddle_context_t empty;
    memset(&empty, 0, sizeof empty);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_adapt(NULL, &shape));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_adapt(&context, NULL));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED, saddle_adapt(&empty, &shape));
    shape.lateral_offset_m = NAN;
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_CONFIG, saddle_adapt(&context, &shape));
    ASSERT_SAME_FLOAT(config.lateral_factor, context.model.config.lateral_factor);
}

static void test_plan_at_beyond_its_span_is_rejected(void)
{
    saddle_plan_t plan;
    memset(&plan, 0xA5, sizeof plan);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME, saddle_plan_at(&context, 0, &plan)); /* no tick yet */
    TEST_ASSERT_FALSE(plan.valid);
    join();
    tick_at(1000000);
    const uint64_t end = 1000000u + saddle_plan_horizon_us(&context.planner);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME, saddle_plan_at(&context, 999999, &plan));
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_plan_at(&context, 1000000, &plan));
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_plan_at(&context, end, &plan));
    TEST_ASSERT_EQUAL_UINT32(2, plan.step_count + (plan.phase % 2u == 0u ? 1u : 0u));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME, saddle_plan_at(&context, end + 1u, &plan));
    TEST_ASSERT_FALSE(plan.valid);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_TIME, saddle_plan_at(&context, UINT64_MAX, &plan));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_plan_at(NULL, end, &plan));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_plan_at(&context, end, NULL));
    memset(&context, 0, sizeof context);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED, saddle_plan_at(&context, 0, &plan));
}

static void test_join_needs_a_walk(void)
{
    const saddle_command_t bad[] = {
        {SADDLE_COMMAND_STAND, 1.0f, 0.1f, 0.0f},    {SADDLE_COMMAND_WALK, 0.0f, 0.1f, 0.0f},
        {SADDLE_COMMAND_WALK, -1.0f, 0.1f, 0.0f},    {SADDLE_COMMAND_WALK, NAN, 0.1f, 0.0f},
        {SADDLE_COMMAND_WALK, 1.0f, INFINITY, 0.0f}, {7, 1.0f, 0.1f, 0.0f}};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_COMMAND, saddle_join(&context, &bad[i]));
    }
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_join(NULL, &input.command));
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_join(&context, NULL));
    input.command.mode = SADDLE_COMMAND_STAND;
    tick_at(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, output.plan.mode);
    memset(&context, 0, sizeof context);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED, saddle_join(&context, &bad[0]));
}

static void test_scores_of_a_plan_need_a_context_and_a_plan(void)
{
    saddle_scores_t given;
    join();
    tick_at(0);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_score_plan(NULL, &output.plan, &given));
    TEST_ASSERT_EQUAL_HEX32(0, given.valid);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_score_plan(&context, NULL, &given));
    TEST_ASSERT_EQUAL_HEX32(0, given.valid);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_NULL, saddle_score_plan(&context, &output.plan, NULL));
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_score_plan(&context, &output.plan, &given));
    TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_ALL, given.valid);
    const saddle_plan_t refused = {.valid = false};
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_score_plan(&context, &refused, &given));
    TEST_ASSERT_EQUAL_HEX32(0, given.valid);
    memset(&context, 0, sizeof context);
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED,
                          saddle_score_plan(&context, &output.plan, &given));
}

static void test_joined_walk_goes_on_without_a_usable_command(void)
{
    input.measurement = saddle_no_measurement();
    input.command.speed_m_s = 0.05f;
    join();
    input.command.speed_m_s = NAN;
    tick_at(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_WALKING, output.plan.mode);
    ASSERT_SAME_FLOAT(0.05f, output.plan.speed_m_s);
}

/* ---- safe stop ----------------------------------------------------------------------------- */

/* A wearer who is where the plan is. */
static void measure_plan(const saddle_plan_t *plan, saddle_measurement_t *measured)
{
    measured->com.height_m = plan->com_m.z;
    measured->com.velocity_m_s.x = plan->com_velocity_m_s.x;
    measured->com.velocity_m_s.y = plan->com_velocity_m_s.y;
    for (int side = 0; side < 2; side++) {
        measured->foot[side].cop_m.x = plan->foot_m[side].x - plan->com_m.x;
        measured->foot[side].cop_m.y = plan->foot_m[side].y - plan->com_m.y;
        measured->foot[side].contact = side == (int)plan->support || !(plan->step_length_m > 0.0f);
    }
}

static void follow_until(uint64_t *time_us, uint64_t end_us)
{
    while (*time_us < end_us) {
        *time_us += 80000u;
        const saddle_plan_t plan = plan_at(*time_us);
        measure_plan(&plan, &input.measurement);
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(*time_us));
    }
}

/* Three seconds of a joined walk at 1.2 m/s. Returns the time. */
static uint64_t walk_for_a_while(void)
{
    uint64_t time_us = 0;
    setUp();
    input.measurement = saddle_no_measurement();
    join();
    tick_at(0);
    input.measurement = good_measurement();
    follow_until(&time_us, 3000000u);
    TEST_ASSERT_EQUAL_HEX32(0, output.faults);
    TEST_ASSERT_EQUAL_HEX32(0, output.limits);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_WALKING, output.plan.mode);
    return time_us;
}

static void test_gap_between_the_ticks_ends_the_level_and_the_walk(void)
{
    uint64_t t = walk_for_a_while();
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEVEL_STABLE, output.verdict.level);
    context.model.config.level_hold_ticks = 2.0f;
    t += 10000000u;
    tick_at(t);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEVEL_UNKNOWN, output.verdict.level);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_SETTLING, output.verdict.reason);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_TICK_GAP | SADDLE_LIMIT_SAFE_STOP, output.limits);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STOPPING, output.plan.mode);
}

/* The CoM is lost in a walk: its scores end with it, at once. */
static void test_step_scores_end_with_the_com(void)
{
    uint64_t t = walk_for_a_while();
    TEST_ASSERT_BITS_HIGH(SADDLE_VALID_STEP, output.scores.valid);
    input.measurement.com.age_us = SADDLE_AGE_NEVER_US;
    follow_until(&t, t + 1u);
    TEST_ASSERT_BITS_LOW(SADDLE_VALID_STEP, output.scores.valid);
    TEST_ASSERT_FALSE(output.scores.paper_stable);
}

/* ---- the plan as the wearer's reference ---------------------------------------------------- */

static void assert_on_the_plan(double tolerance_y)
{
    TEST_ASSERT_TRUE(output.verdict.compared);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, output.verdict.xcom_deviation_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance_y, 0.0, output.verdict.xcom_deviation_m.y);
    TEST_ASSERT_TRUE(output.verdict.recovery.found);
}

static void assert_lands_as_planned(void)
{
    const saddle_plan_t *plan = &output.plan;
    const saddle_vec3_t *stance = &plan->foot_m[plan->support];
    TEST_ASSERT_EQUAL_UINT8(saddle_other_side((saddle_side_t)plan->support),
                            output.verdict.recovery.foot);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, (double)plan->landing_m.x - (double)stance->x,
                              output.verdict.recovery.landing_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, (double)plan->landing_m.y - (double)stance->y,
                              output.verdict.recovery.landing_m.y);
}

/* From standing to standing: the shift to the first stance leg, the walk, and the stop with the
 * feet wherever they came to stand are all where the wearer is to be. */
static void test_wearer_who_follows_the_plan_never_departs_from_it(void)
{
    uint64_t t = 0;
    tick_at(t);
    for (int k = 0; k < 150; k++) {
        input.command.speed_m_s = k < 100 ? 0.9f : 0.0f;
        follow_until(&t, t + 1u);
        const bool steady = k > 60 && k < 100;
        const bool stands = !(output.plan.speed_m_s > 0.0f);
        assert_on_the_plan(steady || stands ? 1e-5 : 0.07);
        if (steady) {
            assert_lands_as_planned();
        }
        TEST_ASSERT_TRUE(output.verdict.level != (uint8_t)SADDLE_LEVEL_UNSTABLE);
    }
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, output.plan.mode);
    TEST_ASSERT_TRUE(output.plan.step_count > 5u);
}

/* ---- a treadmill ---- */

/* The same wearer on two belts; sensors in the room do not see what the belt under the foot that
 * stands does. */
static void put_on_belts(saddle_measurement_t *measured, float left_m_s, float right_m_s)
{
    const bool left = measured->foot[SADDLE_LEFT].contact;
    const bool right = measured->foot[SADDLE_RIGHT].contact;
    measured->foot[SADDLE_LEFT].ground_m_s = left_m_s;
    measured->foot[SADDLE_RIGHT].ground_m_s = right_m_s;
    measured->com.velocity_m_s.x += left == right ? 0.5f * (left_m_s + right_m_s)
                                    : left        ? left_m_s
                                                  : right_m_s;
}

/* 1e-5 m: the velocity is rounded once more. */
static void assert_judged_as(const saddle_output_t *floor)
{
    TEST_ASSERT_EQUAL_HEX32(floor->faults, output.faults);
    TEST_ASSERT_EQUAL_UINT8(floor->verdict.level, output.verdict.level);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, floor->scores.xcom_m.x, output.scores.xcom_m.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, floor->verdict.xcom_deviation_m.x,
                             output.verdict.xcom_deviation_m.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, floor->scores.v_comp_m_s, output.scores.v_comp_m_s);
}

/* Belts that start, run at two speeds and stop, under a walk from standing to standing. */
static void test_wearer_on_belts_is_judged_as_on_a_floor(void)
{
    uint64_t t = 0;
    tick_at(t);
    saddle_context_t on_belts = context;
    for (int k = 0; k < 150; k++) {
        input.command.speed_m_s = k < 100 ? 0.9f : 0.0f;
        follow_until(&t, t + 1u);
        const saddle_context_t on_floor = context;
        const saddle_output_t floor = output;
        const float belt_m_s = k < 20 ? -0.05f * (float)k : k < 110 ? -1.0f : 0.0f;
        put_on_belts(&input.measurement, belt_m_s, 0.7f * belt_m_s);
        context = on_belts;
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(t));
        assert_judged_as(&floor);
        on_belts = context;
        context = on_floor;
        input.measurement.foot[0].ground_m_s = input.measurement.foot[1].ground_m_s = 0.0f;
    }
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, output.plan.mode);
}

/* What the input is for: the CoM of who walks on a belt rests in the room. */
static void test_belt_that_is_not_measured_puts_the_xcom_behind_the_plan(void)
{
    const uint64_t t = walk_for_a_while() + 80000u;
    const saddle_plan_t plan = plan_at(t);
    measure_plan(&plan, &input.measurement);
    put_on_belts(&input.measurement, -1.2f, -1.2f);
    const saddle_context_t before = context;
    tick_at(t);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.0f, output.verdict.xcom_deviation_m.x);
    context = before;
    input.measurement.foot[0].ground_m_s = input.measurement.foot[1].ground_m_s = 0.0f;
    tick_at(t);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -1.2f / context.model.body.natural_frequency_rad_s,
                             output.verdict.xcom_deviation_m.x);
}

static void test_absurd_ground_is_a_fault_of_its_foot_and_of_the_com_that_it_carries(void)
{
    const float absurd[] = {NAN, INFINITY, -INFINITY, -15.0f, 1e30f};
    for (size_t i = 0; i < COUNT_OF(absurd); i++) {
        const uint64_t t = walk_for_a_while();
        const saddle_plan_t plan = plan_at(t + 80000u);
        measure_plan(&plan, &input.measurement);
        input.measurement.foot[SADDLE_LEFT].contact = false;
        input.measurement.foot[SADDLE_RIGHT].contact = true;
        input.measurement.foot[SADDLE_LEFT].ground_m_s = absurd[i];
        saddle_context_t before = context;
        tick_at(t + 80000u);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_LEFT_RANGE, output.faults);
        context = before;
        input.measurement.foot[SADDLE_LEFT].contact = true;
        tick_at(t + 80000u);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_LEFT_RANGE | SADDLE_FAULT_COM_RANGE, output.faults);
    }
}

/* The numbers of a foot that never was measured mean nothing. */
static void test_ground_under_a_foot_that_never_came_is_not_used(void)
{
    const uint64_t t = walk_for_a_while();
    for (int side = 0; side < 2; side++) {
        input.measurement.foot[side] = (saddle_measured_foot_t){
            .contact = false, .ground_m_s = NAN, .age_us = SADDLE_AGE_NEVER_US};
    }
    tick_at(t + 80000u);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_LEFT_STALE | SADDLE_FAULT_RIGHT_STALE, output.faults);
}

/* ---- [E45] the landing moves with the wearer ---- */

/* A tick beyond the foot via point, of a wearer who keeps to the reference but goes faster by dv. */
static void tick_off_by(saddle_vec2_t dv_m_s, float gain)
{
    uint64_t t = walk_for_a_while();
    while (output.plan.phase != 0u) {
        follow_until(&t, t + 1u);
    }
    context.model.config.placement_gain = gain;
    const float w = context.model.body.natural_frequency_rad_s;
    saddle_plan_t plan = plan_at(t + 1000u);
    plan.com_velocity_m_s.x = w * (plan.reference.xcom_m.x - plan.com_m.x) + dv_m_s.x;
    plan.com_velocity_m_s.y = w * (plan.reference.xcom_m.y - plan.com_m.y) + dv_m_s.y;
    measure_plan(&plan, &input.measurement);
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, tick_at(t + 1000u));
    TEST_ASSERT_EQUAL_UINT8(0, output.plan.phase);
}

static void test_landing_follows_what_the_ankles_can_mend_by_the_gain(void)
{
    const double w = (double)model_of(&config)->body.natural_frequency_rad_s;
    tick_off_by((saddle_vec2_t){0.0f, 0.0f}, 0.5f);
    const saddle_plan_t on_reference = output.plan;
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, on_reference.step_length_m, on_reference.landing_m.x);
    tick_off_by((saddle_vec2_t){0.03f, -0.02f}, 0.5f);
    const double grown = exp(w * (double)output.plan.time_to_toe_off_s) / w;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 * 0.03 * grown,
                              output.plan.landing_m.x - on_reference.landing_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -0.5 * 0.02 * grown,
                              output.plan.landing_m.y - on_reference.landing_m.y);
}

/* The same posture without a moved landing: neither the verdict nor the reference differs. */
static void test_wearer_is_judged_by_the_plan_that_was_not_moved(void)
{
    const saddle_vec2_t dv_m_s = {0.25f, -0.1f};
    tick_off_by(dv_m_s, 0.0f);
    const saddle_output_t unmoved = output;
    tick_off_by(dv_m_s, 0.5f);
    TEST_ASSERT_TRUE(output.plan.landing_m.x > unmoved.plan.landing_m.x + 0.05f);
    TEST_ASSERT_EQUAL_MEMORY(&unmoved.plan.reference, &output.plan.reference,
                             sizeof unmoved.plan.reference);
    ASSERT_SAME_FLOAT(unmoved.verdict.margin, output.verdict.margin);
    ASSERT_SAME_FLOAT(unmoved.verdict.xcom_deviation_m.x, output.verdict.xcom_deviation_m.x);
    ASSERT_SAME_FLOAT(unmoved.verdict.recovery.landing_m.x, output.verdict.recovery.landing_m.x);
    ASSERT_SAME_FLOAT(unmoved.verdict.ebos_com_m, output.verdict.ebos_com_m);
}

static void test_plan_at_takes_the_recovery_step(void)
{
    tick_off_by((saddle_vec2_t){0.5f, -0.2f}, 0.5f);
    const saddle_plan_t placed = output.plan;
    const saddle_plan_t landed =
        plan_at(81000u + context.last_time_us + (uint64_t)(1e6f * placed.time_to_toe_off_s));
    const double stance_y = (double)placed.foot_m[placed.support].y;
    TEST_ASSERT_TRUE(placed.landing_m.x > placed.step_length_m + 0.1f);
    TEST_ASSERT_EQUAL_UINT32(placed.step_count + 1u, landed.step_count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, placed.landing_m.x, landed.last_step_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)placed.landing_m.y - stance_y, landed.last_step_m.y);
}

/* Nothing was commanded and nobody stands: whoever walks there is no follower of the plan. */
static void test_standing_plan_is_no_reference(void)
{
    config.previous_level = 1.0f;
    saddle_init(&context, &config);
    input.command.mode = SADDLE_COMMAND_STAND;
    for (uint64_t t = 0; t < 800000u; t += 80000u) {
        input.measurement.com.velocity_m_s.x += 0.001f;
        input.measurement.foot[SADDLE_LEFT].cop_m.x -= 0.08f;
        input.measurement.foot[SADDLE_RIGHT].cop_m.x -= 0.08f;
        tick_at(t);
        TEST_ASSERT_FALSE(output.verdict.compared);
        TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_NO_WALK, output.verdict.reason);
    }
}

static void assert_stops_now(uint64_t time_us, uint32_t fault)
{
    const saddle_plan_t plan = plan_at(time_us);
    measure_plan(&plan, &input.measurement);
    tick_at(time_us);
    TEST_ASSERT_EQUAL_HEX32(fault, output.faults);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_SAFE_STOP, output.limits);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STOPPING, output.plan.mode);
}

static void test_lost_input_stops_the_walk_in_the_same_tick(void)
{
    const struct {
        uint32_t *age_us, limit_us, fault;
    } inputs[] = {
        {&input.command_age_us, 240000u, SADDLE_FAULT_COMMAND_STALE},
        {&input.measurement.com.age_us, 240000u, SADDLE_FAULT_COM_STALE},
        {&input.measurement.foot[SADDLE_LEFT].age_us, 240000u, SADDLE_FAULT_LEFT_STALE},
        {&input.measurement.foot[SADDLE_RIGHT].age_us, 240000u, SADDLE_FAULT_RIGHT_STALE},
    };
    for (size_t i = 0; i < COUNT_OF(inputs); i++) {
        uint64_t t = walk_for_a_while();
        *inputs[i].age_us = inputs[i].limit_us; /* still good */
        follow_until(&t, t + 1u);
        TEST_ASSERT_EQUAL_HEX32(0, output.limits);
        *inputs[i].age_us = inputs[i].limit_us + 1u;
        assert_stops_now(t + 80000u, inputs[i].fault);
        t += 80000u;
        follow_until(&t, t + 8000000u); /* lost for good: it comes to stand and stays */
        TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, output.plan.mode);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_SAFE_STOP, output.limits);
    }
}

/* The last good command holds for command_max_age_s: three ticks. */
static void test_command_that_stays_unusable_stops_the_walk(void)
{
    uint64_t t = walk_for_a_while();
    input.command.speed_m_s = NAN;
    for (int tick = 1; tick <= 3; tick++) {
        follow_until(&t, t + 1u);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COMMAND, output.faults);
        TEST_ASSERT_EQUAL_HEX32(0, output.limits);
        TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_WALKING, output.plan.mode);
    }
    assert_stops_now(t + 80000u, SADDLE_FAULT_COMMAND | SADDLE_FAULT_COMMAND_STALE);
}

/* A good command that comes late brings its own age along. */
static void test_age_of_the_last_usable_command_counts(void)
{
    uint64_t t = walk_for_a_while();
    input.command_age_us = 160000u;
    follow_until(&t, t + 1u);
    input.command.speed_m_s = NAN;
    input.command_age_us = 0; /* of a command that is not taken */
    follow_until(&t, t + 1u);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COMMAND, output.faults);
    assert_stops_now(t + 80000u, SADDLE_FAULT_COMMAND | SADDLE_FAULT_COMMAND_STALE);
}

/* resume_time_s is 1 s: 13 ticks. It has come to stand by then and starts anew. */
static void test_walk_resumes_only_after_valid_inputs_for_resume_time(void)
{
    uint64_t t = walk_for_a_while();
    input.measurement.com.age_us = SADDLE_AGE_NEVER_US;
    assert_stops_now(t + 80000u, SADDLE_FAULT_COM_STALE);
    t += 80000u;
    follow_until(&t, t + 8000000u);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, output.plan.mode);
    input.measurement.com.age_us = 0;
    for (int tick = 1; tick <= 12; tick++) {
        follow_until(&t, t + 1u);
        TEST_ASSERT_EQUAL_HEX32(0, output.faults);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_SAFE_STOP, output.limits);
        TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, output.plan.mode);
    }
    follow_until(&t, t + 1u);
    TEST_ASSERT_EQUAL_HEX32(0, output.limits);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STARTING, output.plan.mode);
}

static void test_plan_that_was_never_given_measurements_walks_on(void)
{
    input.measurement = saddle_no_measurement();
    join();
    for (uint64_t t = 0; t < 60000000u; t += 80000u) {
        tick_at(t);
        TEST_ASSERT_EQUAL_HEX32(0, output.limits);
        TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_WALKING, output.plan.mode);
    }
}

/* Measurements of so many ticks ago, in a walk that departs from the plan. */
static void walk_late(uint32_t age_us, saddle_output_t *last)
{
    saddle_measurement_t past[2] = {good_measurement(), good_measurement()};
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    input = walking_input(0);
    join();
    for (uint64_t t = 0; t < 4000000u; t += 80000u) {
        input.measurement = past[0];
        input.measurement.com.age_us = age_us;
        input.measurement.foot[SADDLE_LEFT].age_us = age_us;
        input.measurement.foot[SADDLE_RIGHT].age_us = age_us;
        tick_at(t);
        past[0] = past[1];
        measure_plan(&output.plan, &past[1]);
        past[1].com.velocity_m_s.y += 0.1f;
    }
    *last = output;
}

/* [E46] The same bits, whether a latency is in the ages or in the configuration. */
static void test_known_latency_counts_as_age(void)
{
    saddle_output_t by_age, by_latency, too_young;
    walk_late(160000u, &by_age);
    config.sensor_latency_s = 0.1f;
    walk_late(60000u, &by_latency);
    walk_late(59999u, &too_young);
    TEST_ASSERT_TRUE(same_output(&by_age, &by_latency));
    TEST_ASSERT_FALSE(same_output(&by_age, &too_young));
}

static void test_known_latency_counts_for_the_age_limits(void)
{
    config.sensor_latency_s = 0.1f;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    input.measurement.com.age_us = 140000u;
    tick_at(0);
    TEST_ASSERT_EQUAL_HEX32(0, output.faults);
    input.measurement.com.age_us = 140001u;
    tick_at(80000u);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COM_STALE, output.faults);
    input.measurement.com.age_us = SADDLE_AGE_NEVER_US; /* no sum is older */
    tick_at(160000u);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COM_STALE, output.faults);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_field_list_is_complete);
    RUN_TEST(test_null_arguments_are_rejected_with_a_complete_output);
    RUN_TEST(test_tick_without_an_output_changes_nothing);
    RUN_TEST(test_context_without_init_is_rejected_with_a_complete_output);
    RUN_TEST(test_failed_init_leaves_the_context_uninitialised);
    RUN_TEST(test_good_tick_writes_every_field);
    RUN_TEST(test_time_backwards_is_rejected_and_ignored);
    RUN_TEST(test_plan_advances_by_the_time_that_passed_from_any_origin);
    RUN_TEST(test_late_tick_advances_by_tick_max_and_reports_it);
    RUN_TEST(test_unusable_command_leaves_the_last_good_one);
    RUN_TEST(test_stop_is_applied_whatever_its_numbers);
    RUN_TEST(test_standing_is_a_plan_of_both_feet_on_the_ground);
    RUN_TEST(test_init_again_starts_over_and_keeps_no_pointer);
    RUN_TEST(test_contexts_are_independent_and_deterministic);
    RUN_TEST(test_planned_walk_has_the_papers_stability);
    RUN_TEST(test_any_bytes_in_any_configuration_give_a_sound_output);
    RUN_TEST(test_plan_at_is_the_next_ticks_plan_bit_for_bit);
    RUN_TEST(test_plan_at_of_a_steady_walk_is_the_next_ticks_in_every_field);
    RUN_TEST(test_a_damaged_context_gives_no_number_that_is_not_finite);
    RUN_TEST(test_a_damaged_context_gives_no_such_plan);
    RUN_TEST(test_a_shape_is_taken_over_in_the_first_quarter_of_a_step_without_a_jump);
    RUN_TEST(test_a_walk_goes_on_in_the_shape_that_it_took_over);
    RUN_TEST(test_a_shape_is_taken_over_while_standing);
    RUN_TEST(test_a_shape_that_cannot_be_used_is_rejected);
    RUN_TEST(test_plan_at_beyond_its_span_is_rejected);
    RUN_TEST(test_reference_at_once_is_the_plan_s);
    RUN_TEST(test_reference_goes_on_without_a_jump_from_standing_on);
    RUN_TEST(test_reference_of_another_time_or_no_plan_is_rejected);
    RUN_TEST(test_join_needs_a_walk);
    RUN_TEST(test_wearer_who_follows_the_plan_never_departs_from_it);
    RUN_TEST(test_standing_plan_is_no_reference);
    RUN_TEST(test_scores_of_a_plan_need_a_context_and_a_plan);
    RUN_TEST(test_joined_walk_goes_on_without_a_usable_command);
    RUN_TEST(test_lost_input_stops_the_walk_in_the_same_tick);
    RUN_TEST(test_command_that_stays_unusable_stops_the_walk);
    RUN_TEST(test_age_of_the_last_usable_command_counts);
    RUN_TEST(test_walk_resumes_only_after_valid_inputs_for_resume_time);
    RUN_TEST(test_gap_between_the_ticks_ends_the_level_and_the_walk);
    RUN_TEST(test_step_scores_end_with_the_com);
    RUN_TEST(test_wearer_on_belts_is_judged_as_on_a_floor);
    RUN_TEST(test_belt_that_is_not_measured_puts_the_xcom_behind_the_plan);
    RUN_TEST(test_absurd_ground_is_a_fault_of_its_foot_and_of_the_com_that_it_carries);
    RUN_TEST(test_ground_under_a_foot_that_never_came_is_not_used);
    RUN_TEST(test_landing_follows_what_the_ankles_can_mend_by_the_gain);
    RUN_TEST(test_wearer_is_judged_by_the_plan_that_was_not_moved);
    RUN_TEST(test_plan_at_takes_the_recovery_step);
    RUN_TEST(test_plan_that_was_never_given_measurements_walks_on);
    RUN_TEST(test_known_latency_counts_as_age);
    RUN_TEST(test_known_latency_counts_for_the_age_limits);
    return UNITY_END();
}
