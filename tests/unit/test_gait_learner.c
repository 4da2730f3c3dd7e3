/** What is learned of a wearer, who is another core that walks in a shape of its own. */
#include "core_test.h"

#include <gait_learner.h>

#define SPEED_M_S 1.1f
#define TICK_US 80000u
#define TICKS_A_MINUTE 750

static saddle_context_t plan_context, wearer_context;
static saddle_config_t config, wearer;
static saddle_learning_config_t learning;
static saddle_gait_learner_t learner;
static saddle_output_t output;
static uint64_t time_us;
static uint32_t random_state;
static float noise_m;
static bool heel_first; /* false: a foot is on the ground when it carries */
static float largest_jump_m;
static uint32_t taken_over;

/* A person whom `calibrate` measured: a height of its own, a heel strike and a swing of a share. */
void setUp(void)
{
    config = paper_config();
    config.ankle = SADDLE_ANKLE_CYCLOID;
    config.strike_share = 0.36f;
    config.swing_begin = -0.32f;
    config.swing_end = 1.04f;
    config.swing_skew = 1.47f;
    wearer = config;
    learning = saddle_learning_default();
    learning.share = 0.1f;
    time_us = 0;
    random_state = 1;
    noise_m = largest_jump_m = 0.0f;
    taken_over = 0;
    heel_first = true;
}

void tearDown(void) {}

static float random_m(void)
{
    return random_in(&random_state, -noise_m, noise_m);
}

/* Another person in every field that is learned. */
static void change_wearer(void)
{
    wearer.lateral_factor = 1.3f;
    wearer.lateral_offset_m = -0.012f;
    wearer.lateral_delay_rad = 0.3f;
    wearer.vertical_offset_m = 0.008f;
    wearer.vertical_delay_rad = -0.25f;
    wearer.strike_share = 0.42f;
    wearer.swing_begin = -0.27f;
    wearer.swing_end = 1.09f;
}

static void begin(void)
{
    const saddle_command_t walk = {SADDLE_COMMAND_WALK, SPEED_M_S, 0.17f, 0.0f};
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_init(&plan_context, &config));
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_init(&wearer_context, &wearer));
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_join(&plan_context, &walk));
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_join(&wearer_context, &walk));
    saddle_gait_learner_init(&learner, &config, &learning);
}

/* What is measured of the wearer: the heel is on the ground from its strike on. */
static saddle_measurement_t measured(const saddle_plan_t *body)
{
    saddle_measurement_t seen = saddle_no_measurement();
    seen.com.height_m = body->com_m.z + random_m();
    seen.com.velocity_m_s = (saddle_vec2_t){body->com_velocity_m_s.x, body->com_velocity_m_s.y};
    seen.com.age_us = 0;
    for (int foot = 0; foot < 2; foot++) {
        seen.foot[foot].cop_m.x = body->foot_m[foot].x - body->com_m.x + random_m();
        seen.foot[foot].cop_m.y = body->foot_m[foot].y - body->com_m.y + random_m();
        seen.foot[foot].contact =
            foot == body->support || (heel_first && body->time_to_heel_strike_s <= 0.0f);
        seen.foot[foot].age_us = 0;
    }
    return seen;
}

static float distance_m(saddle_vec3_t a, saddle_vec3_t b)
{
    return sqrtf((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/* What the plan has now, and has when the learner has had its say. */
static void watch(const saddle_input_t *input)
{
    saddle_plan_t after;
    taken_over += saddle_gait_learner_tick(&learner, &plan_context, input, &output) ? 1u : 0u;
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_plan_at(&plan_context, input->time_us, &after));
    const float jumps_m[] = {distance_m(after.com_m, output.plan.com_m),
                             distance_m(after.foot_m[0], output.plan.foot_m[0]),
                             distance_m(after.foot_m[1], output.plan.foot_m[1])};
    for (size_t i = 0; i < COUNT_OF(jumps_m); i++) {
        TEST_ASSERT_TRUE(jumps_m[i] >= 0.0f);
        largest_jump_m = fmaxf(largest_jump_m, jumps_m[i]);
    }
}

static void tick(void)
{
    saddle_output_t body;
    saddle_input_t input = {
        .time_us = time_us,
        .command = {SADDLE_COMMAND_WALK, SPEED_M_S, 0.17f, 0.0f},
        .measurement = saddle_no_measurement(),
    };
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_tick(&wearer_context, &input, &body));
    input.measurement = measured(&body.plan);
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_tick(&plan_context, &input, &output));
    watch(&input);
    time_us += TICK_US;
}

static void walk(int ticks)
{
    for (int i = 0; i < ticks; i++) {
        tick();
    }
}

#define WITHIN(tolerance, name)                                         \
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE((tolerance), (double)wearer.name, \
                                      (double)learner.config.name, #name)

static void test_it_becomes_the_wearer(void)
{
    change_wearer();
    begin();
    walk(3 * TICKS_A_MINUTE);
    WITHIN(1e-3, lateral_factor);
    WITHIN(1e-5, lateral_offset_m);
    WITHIN(1e-3, lateral_delay_rad);
    WITHIN(1e-5, vertical_offset_m);
    WITHIN(1e-3, vertical_delay_rad);
    WITHIN(0.02, strike_share); /* seen at the ticks alone, 0.14 of a step apart */
    WITHIN(1e-3, swing_begin);
    WITHIN(1e-3, swing_end);
    TEST_ASSERT_EQUAL_FLOAT(config.swing_skew, learner.config.swing_skew);
    const saddle_config_t *used = &plan_context.model.config;
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)wearer.lateral_factor, (double)used->lateral_factor);
}

/* The first strides change the plan by millimetres, and it goes on from where it is. */
static void test_no_position_of_the_plan_jumps(void)
{
    change_wearer();
    learning.share = 0.3f;
    begin();
    walk(TICKS_A_MINUTE);
    TEST_ASSERT_GREATER_THAN_UINT32(30, taken_over);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.0, (double)largest_jump_m);
}

static void test_it_stays_within_its_bounds(void)
{
    change_wearer();
    learning.lateral_factor = 0.1f;
    learning.lateral_offset_m = 0.005f;
    learning.lateral_delay_rad = 0.1f;
    learning.vertical_offset_m = 0.002f;
    learning.vertical_delay_rad = 0.05f;
    learning.strike_share = 0.01f;
    learning.swing_delay = 0.02f;
    begin();
    walk(2 * TICKS_A_MINUTE);
    ASSERT_SAME_FLOAT(1.0f + 0.1f, learner.config.lateral_factor);
    ASSERT_SAME_FLOAT(-0.005f, learner.config.lateral_offset_m);
    ASSERT_SAME_FLOAT(0.1f, learner.config.lateral_delay_rad);
    ASSERT_SAME_FLOAT(0.002f, learner.config.vertical_offset_m);
    ASSERT_SAME_FLOAT(-0.05f, learner.config.vertical_delay_rad);
    ASSERT_SAME_FLOAT(config.strike_share + 0.01f, learner.config.strike_share);
    ASSERT_SAME_FLOAT(config.swing_begin + 0.02f, learner.config.swing_begin);
}

/* 2 cm on every position: it still finds the wearer, as nearly as the noise allows. */
static void test_noise_moves_it_little(void)
{
    change_wearer();
    learning.share = 0.03f;
    noise_m = 0.02f;
    begin();
    walk(5 * TICKS_A_MINUTE);
    WITHIN(0.15, lateral_factor);
    WITHIN(0.002, lateral_offset_m);
    WITHIN(0.1, lateral_delay_rad);
    WITHIN(0.001, vertical_offset_m);
    WITHIN(0.1, vertical_delay_rad);
    WITHIN(0.02, swing_begin);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.0, (double)largest_jump_m);
}

static void same_config(const saddle_config_t *expected)
{
    const saddle_config_field_t *field;
    for (size_t i = 0; (field = saddle_config_field(i)) != NULL; i++) {
        float a, b;
        memcpy(&a, (const char *)expected + field->offset, sizeof a);
        memcpy(&b, (const char *)&learner.config + field->offset, sizeof b);
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(float_bits(a), float_bits(b), field->name);
    }
}

static void test_off_it_learns_nothing(void)
{
    change_wearer();
    learning = saddle_learning_default();
    begin();
    walk(TICKS_A_MINUTE);
    same_config(&config);
    TEST_ASSERT_EQUAL_UINT32(0, taken_over);
}

typedef void spoil_t(saddle_input_t *, saddle_output_t *);

/* A tick in so many is spoiled. */
static void walk_spoiled(spoil_t *spoil, int every)
{
    begin();
    for (int i = 0; i < TICKS_A_MINUTE; i++) {
        saddle_output_t body;
        saddle_input_t input = {
            .time_us = time_us,
            .command = {SADDLE_COMMAND_WALK, SPEED_M_S, 0.17f, 0.0f},
            .measurement = saddle_no_measurement(),
        };
        saddle_tick(&wearer_context, &input, &body);
        input.measurement = measured(&body.plan);
        saddle_tick(&plan_context, &input, &output);
        if (i % every == 0) {
            spoil(&input, &output);
        }
        (void)saddle_gait_learner_tick(&learner, &plan_context, &input, &output);
        time_us += TICK_US;
    }
}

static void not_finite_across(saddle_input_t *input, saddle_output_t *tick_output)
{
    input->measurement.foot[tick_output->plan.support].cop_m.y = NAN;
}

static void not_finite_height(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)tick_output;
    input->measurement.com.height_m = INFINITY;
}

static void fault(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)input;
    tick_output->faults = (uint32_t)SADDLE_FAULT_COM_FROZEN;
}

static void limit(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)input;
    tick_output->limits = (uint32_t)SADDLE_LIMIT_TICK_GAP;
}

static void failed(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)input;
    tick_output->status = SADDLE_ERROR_TIME;
}

static void unstable(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)input;
    tick_output->verdict.level = (uint8_t)SADDLE_LEVEL_UNSTABLE;
}

static void speeds_up(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)input;
    tick_output->plan.acceleration_m_s2 = 0.1f;
}

static void slows_down(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)input;
    tick_output->plan.acceleration_m_s2 = -0.1f;
}

static void stops(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)input;
    tick_output->plan.mode = (uint8_t)SADDLE_MODE_STOPPING;
}

static void stands_still(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)input;
    tick_output->plan.speed_m_s = 0.0f;
}

static void far_left(saddle_input_t *input, saddle_output_t *tick_output)
{
    input->measurement.foot[tick_output->plan.support].cop_m.y -= 0.3f;
}

static void far_right(saddle_input_t *input, saddle_output_t *tick_output)
{
    input->measurement.foot[tick_output->plan.support].cop_m.y += 0.3f;
}

static void far_up(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)tick_output;
    input->measurement.com.height_m += 0.2f;
}

static void far_down(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)tick_output;
    input->measurement.com.height_m -= 0.2f;
}

static void test_a_stride_in_which_anything_is_amiss_teaches_nothing(void)
{
    spoil_t *const spoils[] = {
        not_finite_across, not_finite_height, fault,      limit,   failed,
        unstable,          speeds_up,         slows_down, stops,   stands_still,
        far_left,          far_right,         far_up,     far_down};
    for (size_t i = 0; i < COUNT_OF(spoils); i++) {
        setUp();
        change_wearer();
        walk_spoiled(spoils[i], 8); /* a stride has 14 ticks */
        same_config(&config);
    }
}

static void swing_not_finite(saddle_input_t *input, saddle_output_t *tick_output)
{
    input->measurement.foot[1 - tick_output->plan.support].cop_m.x = NAN;
}

static void both_feet_on_the_ground(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)tick_output;
    input->measurement.foot[0].contact = input->measurement.foot[1].contact = true;
}

static void test_a_foot_that_shows_nothing_teaches_nothing(void)
{
    spoil_t *const spoils[] = {swing_not_finite, both_feet_on_the_ground};
    for (size_t i = 0; i < COUNT_OF(spoils); i++) {
        setUp();
        change_wearer();
        walk_spoiled(spoils[i], 1);
        WITHIN(0.01, lateral_delay_rad);
        ASSERT_SAME_FLOAT(config.swing_begin, learner.config.swing_begin);
    }
    ASSERT_SAME_FLOAT(config.strike_share, learner.config.strike_share);
}

static void left_by_5_cm(saddle_input_t *input, saddle_output_t *tick_output)
{
    (void)tick_output;
    input->measurement.foot[0].cop_m.y -= 0.05f;
    input->measurement.foot[1].cop_m.y -= 0.05f;
}

/* A bound that reaches beyond what the core accepts. */
static void test_it_stays_a_configuration_that_can_be_used(void)
{
    config.lateral_offset_m = wearer.lateral_offset_m = 0.08f;
    learning.lateral_offset_m = 0.1f;
    walk_spoiled(left_by_5_cm, 1);
    TEST_ASSERT_NULL(saddle_config_check(&learner.config));
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.095, (double)learner.config.lateral_offset_m);
    ASSERT_SAME_FLOAT(learner.config.lateral_offset_m, plan_context.model.config.lateral_offset_m);
}

/* Five ticks a stride show no wave. */
static void test_too_few_ticks_teach_nothing(void)
{
    change_wearer();
    config.tick_max_s = wearer.tick_max_s = 0.25f;
    begin();
    for (int i = 0; i < 100; i++) {
        tick();
        TEST_ASSERT_EQUAL_HEX32(0, output.limits & SADDLE_LIMIT_TICK_GAP);
        time_us += 245000u - TICK_US;
    }
    same_config(&config);
}

/* The paper's plan has no height, heel strike or swing of a person. */
static void test_what_the_plan_does_not_have_is_not_learned(void)
{
    config = paper_config();
    change_wearer();
    wearer.ankle = SADDLE_ANKLE_CYCLOID;
    begin();
    walk(2 * TICKS_A_MINUTE);
    WITHIN(1e-3, lateral_factor);
    TEST_ASSERT_EQUAL_FLOAT(0, learner.config.vertical_offset_m);
    TEST_ASSERT_EQUAL_FLOAT(0, learner.config.strike_share);
    TEST_ASSERT_EQUAL_FLOAT(config.swing_begin, learner.config.swing_begin);
}

/* Ticks and delays of 20 ms; heels that strike when the foot carries, half a step after the other. */
static void test_old_measurements_are_compared_with_the_plan_of_their_time(void)
{
    change_wearer();
    heel_first = false;
    config.sensor_latency_s = 0.008f;
    begin();
    saddle_measurement_t last = saddle_no_measurement();
    for (int i = 0; i < 6 * TICKS_A_MINUTE; i++) {
        saddle_output_t body;
        saddle_input_t input = {
            .time_us = time_us,
            .command = {SADDLE_COMMAND_WALK, SPEED_M_S, 0.17f, 0.0f},
            .measurement = saddle_no_measurement(),
        };
        saddle_tick(&wearer_context, &input, &body);
        input.measurement = last;
        last = measured(&body.plan);
        last.com.age_us = last.foot[0].age_us = last.foot[1].age_us = 12000; /* of 20 ms */
        saddle_tick(&plan_context, &input, &output);
        (void)saddle_gait_learner_tick(&learner, &plan_context, &input, &output);
        time_us += 20000;
    }
    WITHIN(0.01, lateral_delay_rad);
    WITHIN(0.02, vertical_delay_rad);
    WITHIN(0.005, swing_begin);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, config.strike_share + learning.strike_share,
                              learner.config.strike_share);
}

static void test_bounds_are_checked_by_name(void)
{
    const saddle_config_field_t *field;
    TEST_ASSERT_NULL(saddle_learning_check(&learning));
    for (size_t i = 0; (field = saddle_learning_field(i)) != NULL; i++) {
        const float wrong[] = {-0.01f, field->max * 1.01f, NAN};
        for (size_t k = 0; k < COUNT_OF(wrong); k++) {
            saddle_learning_config_t bad = learning;
            memcpy((char *)&bad + field->offset, &wrong[k], sizeof wrong[k]);
            TEST_ASSERT_EQUAL_STRING(field->name, saddle_learning_check(&bad));
        }
    }
    TEST_ASSERT_EQUAL_size_t(sizeof learning / sizeof(float), 8);
}

/* The same bits on every processor. */
static void test_what_is_learned_has_the_same_bits_everywhere(void)
{
    change_wearer();
    noise_m = 0.005f;
    begin();
    walk(200);
    const saddle_config_t *found = &learner.config;
    const float learned[] = {found->lateral_factor,     found->lateral_offset_m,
                             found->lateral_delay_rad,  found->vertical_offset_m,
                             found->vertical_delay_rad, found->strike_share,
                             found->swing_begin,        found->swing_end};
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < COUNT_OF(learned); i++) {
        hash = (hash ^ float_bits(learned[i])) * 16777619u;
    }
    TEST_ASSERT_EQUAL_HEX32(0x0CCBD6B8, hash);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_it_becomes_the_wearer);
    RUN_TEST(test_no_position_of_the_plan_jumps);
    RUN_TEST(test_it_stays_within_its_bounds);
    RUN_TEST(test_noise_moves_it_little);
    RUN_TEST(test_off_it_learns_nothing);
    RUN_TEST(test_a_stride_in_which_anything_is_amiss_teaches_nothing);
    RUN_TEST(test_a_foot_that_shows_nothing_teaches_nothing);
    RUN_TEST(test_it_stays_a_configuration_that_can_be_used);
    RUN_TEST(test_too_few_ticks_teach_nothing);
    RUN_TEST(test_what_the_plan_does_not_have_is_not_learned);
    RUN_TEST(test_old_measurements_are_compared_with_the_plan_of_their_time);
    RUN_TEST(test_bounds_are_checked_by_name);
    RUN_TEST(test_what_is_learned_has_the_same_bits_everywhere);
    return UNITY_END();
}
