/** [E31] [E36] The level at the bounds themselves, to the bit. */
#include "core_test.h"

#include "balance/level.h"

static saddle_config_t config;
static saddle_level_state_t state;
static saddle_scores_t scores;
static saddle_verdict_t verdict;

/* On the plan, with scores and a recovery step: nothing to announce. */
void setUp(void)
{
    config = paper_config();
    config.level_hold_ticks = 1.0f;
    memset(&state, 0, sizeof state);
    scores = (saddle_scores_t){.valid = (uint32_t)SADDLE_VALID_ALL,
                               .s_pend = 1.0f,
                               .s_jump = 1.0f,
                               .s_sw = 1.0f,
                               .mos_xcom_m = 1.0f,
                               .can_stop = true};
    verdict = (saddle_verdict_t){.margin_known = true,
                                 .margin = 1.0f,
                                 .caution_below = 0.25f,
                                 .driver = SADDLE_REASON_LEFT,
                                 .compared = true,
                                 .on_track = true,
                                 .recovery.found = true};
}

void tearDown(void) {}

static void assert_level(saddle_level_t level, saddle_reason_t reason)
{
    memset(&state, 0, sizeof state);
    saddle_level_update(&state, model_of(&config), 0, &scores, &verdict);
    TEST_ASSERT_EQUAL_UINT8(level, verdict.level);
    TEST_ASSERT_EQUAL_UINT8(reason, verdict.reason);
}

static void test_margin_at_a_bound_is_on_its_worse_side(void)
{
    verdict.margin = nextafterf(0.25f, 1.0f);
    assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    verdict.margin = 0.25f;
    assert_level(SADDLE_LEVEL_CAUTION, SADDLE_REASON_LEFT);
    verdict.margin = nextafterf(0.0f, 1.0f);
    assert_level(SADDLE_LEVEL_CAUTION, SADDLE_REASON_LEFT);
    verdict.margin = 0.0f;
    assert_level(SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_LEFT);
    verdict.margin_known = false;
    assert_level(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_INPUT);
}

/* [E36] */
static void test_previous_level_takes_a_score_at_its_bound_as_enough(void)
{
    float *const scored[] = {&scores.s_pend, &scores.s_jump, &scores.s_sw};
    const saddle_reason_t reasons[] = {SADDLE_REASON_S_PEND, SADDLE_REASON_S_JUMP,
                                       SADDLE_REASON_S_SW};
    for (size_t i = 0; i < COUNT_OF(scored); i++) {
        setUp();
        config.previous_level = 1.0f;
        *scored[i] = config.caution_score;
        assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
        *scored[i] = nextafterf(config.caution_score, -1.0f);
        assert_level(SADDLE_LEVEL_CAUTION, reasons[i]);
    }
}

static void test_previous_level_takes_a_deviation_at_its_bound_as_little(void)
{
    float *const deviations[] = {&verdict.xcom_deviation_m.x, &verdict.xcom_deviation_m.y};
    const saddle_reason_t reasons[] = {SADDLE_REASON_XCOM_AP, SADDLE_REASON_XCOM_ML};
    for (size_t i = 0; i < COUNT_OF(deviations); i++) {
        setUp();
        config.previous_level = 1.0f;
        const float most = i == 0 ? config.caution_xcom_ap_m : config.caution_xcom_ml_m;
        *deviations[i] = -most;
        assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
        *deviations[i] = nextafterf(most, 10.0f);
        assert_level(SADDLE_LEVEL_CAUTION, reasons[i]);
    }
}

/* Who cannot stop needs a step, who can needs none. */
static void test_previous_level_is_unstable_where_no_step_helps(void)
{
    config.previous_level = 1.0f;
    scores.mos_xcom_m = config.stop_margin_m;
    verdict.recovery.found = false;
    assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    scores.mos_xcom_m = nextafterf(config.stop_margin_m, -1.0f);
    assert_level(SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_NO_STEP);
    scores.mos_xcom_m = config.stop_margin_m;
    scores.can_stop = false;
    assert_level(SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_NO_STEP);
    verdict.compared = false;
    assert_level(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_NO_WALK);
}

static void test_previous_level_is_cautious_off_the_track(void)
{
    config.previous_level = 1.0f;
    verdict.on_track = false;
    assert_level(SADDLE_LEVEL_CAUTION, SADDLE_REASON_OFF_TRACK);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_margin_at_a_bound_is_on_its_worse_side);
    RUN_TEST(test_previous_level_takes_a_score_at_its_bound_as_enough);
    RUN_TEST(test_previous_level_takes_a_deviation_at_its_bound_as_little);
    RUN_TEST(test_previous_level_is_unstable_where_no_step_helps);
    RUN_TEST(test_previous_level_is_cautious_off_the_track);
    return UNITY_END();
}
