/** The golden runs, bit for bit, without files or a heap: the same program serves a target. */
#include "core_test.h"

/* One row of `saddlewalk plan`, named as its columns. Absolute x and theta are sums in double. */
typedef struct {
    uint64_t time_us;
    uint8_t phase, support;
    double theta_rad, com_x_m, left_x_m, right_x_m;
    float com_y_m, com_z_m, com_vx_m_s, com_vy_m_s, com_vz_m_s;
    float left_y_m, left_z_m, right_y_m, right_z_m;
    float leg_length_m, theta_to_rad, theta_hs_rad;
    float s_pend, s_jump, s_sw, mos_com_m, mos_xcom_m, gravity_x_n, gravity_y_n;
} golden_row_t;

typedef struct {
    const char *name;
    float speed_m_s, heel_strike_rad;
    const golden_row_t *rows;
    size_t row_count;
} golden_run_t;

#include <golden_runs.h>

void setUp(void) {}

void tearDown(void) {}

#define ASSERT_FLOAT(column, value) \
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(float_bits(row->column), float_bits(value), name)

#define ASSERT_DOUBLE(column, value) \
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.0, row->column, value, name)

static void assert_plan(const char *name, const golden_row_t *row, const saddle_plan_t *plan)
{
    const double origin_m = (double)plan->origin_x_nm * 1e-9;
    const saddle_vec3_t *left = &plan->foot_m[SADDLE_LEFT];
    const saddle_vec3_t *right = &plan->foot_m[SADDLE_RIGHT];
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(row->phase, plan->phase, name);
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(row->support, plan->support, name);
    ASSERT_DOUBLE(theta_rad, 2.0 * PI * plan->stride_count + (double)plan->theta_rad);
    ASSERT_DOUBLE(com_x_m, origin_m + (double)plan->com_m.x);
    ASSERT_FLOAT(com_y_m, plan->com_m.y);
    ASSERT_FLOAT(com_z_m, plan->com_m.z);
    ASSERT_FLOAT(com_vx_m_s, plan->com_velocity_m_s.x);
    ASSERT_FLOAT(com_vy_m_s, plan->com_velocity_m_s.y);
    ASSERT_FLOAT(com_vz_m_s, plan->com_velocity_m_s.z);
    ASSERT_DOUBLE(left_x_m, origin_m + (double)left->x);
    ASSERT_FLOAT(left_y_m, left->y);
    ASSERT_FLOAT(left_z_m, left->z);
    ASSERT_DOUBLE(right_x_m, origin_m + (double)right->x);
    ASSERT_FLOAT(right_y_m, right->y);
    ASSERT_FLOAT(right_z_m, right->z);
    ASSERT_FLOAT(leg_length_m, plan->leg_length_m);
    ASSERT_FLOAT(theta_to_rad, plan->toe_off_rad);
    ASSERT_FLOAT(theta_hs_rad, plan->heel_strike_rad);
}

static void assert_scores(const char *name, const golden_row_t *row, const saddle_scores_t *scores)
{
    ASSERT_FLOAT(s_pend, scores->s_pend);
    ASSERT_FLOAT(s_jump, scores->s_jump);
    ASSERT_FLOAT(s_sw, scores->s_sw);
    ASSERT_FLOAT(mos_com_m, scores->mos_com_m);
    ASSERT_FLOAT(mos_xcom_m, scores->mos_xcom_m);
    ASSERT_FLOAT(gravity_x_n, scores->gravity_n.x);
    ASSERT_FLOAT(gravity_y_n, scores->gravity_n.y);
}

static void replay(const golden_run_t *run)
{
    static saddle_context_t context;
    static saddle_output_t output;
    const saddle_config_t config = paper_config();
    const saddle_command_t command = {SADDLE_COMMAND_WALK, run->speed_m_s, run->heel_strike_rad,
                                      0.0f};
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_join(&context, &command));
    for (size_t i = 0; i < run->row_count; i++) {
        const golden_row_t *row = &run->rows[i];
        const saddle_input_t input = {
            .time_us = row->time_us,
            .command = command,
            .measurement = saddle_no_measurement(),
        };
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_tick(&context, &input, &output));
        assert_plan(run->name, row, &output.plan);
        saddle_scores_t scores;
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_score_plan(&context, &output.plan, &scores));
        assert_scores(run->name, row, &scores);
    }
}

static void test_every_run_is_reproduced_bit_for_bit(void)
{
    TEST_ASSERT_EQUAL_size_t(12, COUNT_OF(GOLDEN_RUNS)); /* 4 speeds x 3 heel-strike angles */
    for (size_t i = 0; i < COUNT_OF(GOLDEN_RUNS); i++) {
        TEST_ASSERT_GREATER_THAN_size_t(10, GOLDEN_RUNS[i].row_count);
        replay(&GOLDEN_RUNS[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_run_is_reproduced_bit_for_bit);
    return UNITY_END();
}
