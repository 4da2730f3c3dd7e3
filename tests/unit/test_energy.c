/** The energy that stopping or returning to the plan has to absorb, against the formulas. */
#include "balance_twin.h"

#include "balance/energy.h"
#include "balance/saddle_space.h"

/* Joules: m g z is 630 J, rounded to 6e-5 J, a few times over. */
static const double ENERGY_TOLERANCE = 5e-4;

static saddle_config_t config;
static saddle_body_t body;

void setUp(void)
{
    config = paper_config();
    config.ankle_work_factor = 1.0f;
    config.bos_factor = 1.0f;
    body = model_of(&config)->body;
}

void tearDown(void) {}

typedef struct {
    saddle_vec2_t cop_m[2];
    saddle_com_state_t state, planned;
} posture_t;

static saddle_support_t support_of(const saddle_vec2_t cop_m[2], const saddle_bos_t *bos,
                                   saddle_vec2_t com_m)
{
    const float pendulum_m = model_of(&config)->body.pendulum_m;
    return (saddle_support_t){cop_m, bos, saddle_surface(cop_m, com_m, pendulum_m)};
}

static float excess_stop(const posture_t *posture)
{
    const saddle_bos_t bos = saddle_bos(posture->cop_m, config.cop_range_m, config.bos_factor);
    float excess_j;
    const saddle_support_t support = support_of(posture->cop_m, &bos, posture->state.com_m);
    TEST_ASSERT_TRUE(saddle_excess_stop_j(model_of(&config), &support, &posture->state, &excess_j));
    return excess_j;
}

static float excess_track(const posture_t *posture)
{
    const saddle_bos_t bos = saddle_bos(posture->cop_m, config.cop_range_m, config.bos_factor);
    float excess_j;
    const saddle_support_t support = support_of(posture->cop_m, &bos, posture->state.com_m);
    TEST_ASSERT_TRUE(saddle_excess_track_j(model_of(&config), &support, &posture->state,
                                           &posture->planned, &excess_j));
    return excess_j;
}

/* Where the CoM of a state leaves the base has this much potential energy. */
static double potential_at_exit(const posture_t *posture, const saddle_com_state_t *state)
{
    const point_t left = point_of(posture->cop_m[SADDLE_LEFT]);
    const point_t right = point_of(posture->cop_m[SADDLE_RIGHT]);
    const twin_base_t base =
        twin_base(left, right, (double)config.cop_range_m, (double)config.bos_factor);
    const point_t exit = twin_exit(&base, point_of(state->com_m), point_of(state->velocity_m_s));
    return twin_potential(left, right, exit);
}

static double potential(const posture_t *posture)
{
    return twin_potential(point_of(posture->cop_m[SADDLE_LEFT]),
                          point_of(posture->cop_m[SADDLE_RIGHT]), point_of(posture->state.com_m));
}

static double kinetic(const saddle_com_state_t *state)
{
    return twin_kinetic(point_of(state->velocity_m_s));
}

static saddle_com_state_t random_state(uint32_t *state)
{
    const bool rests = random_bits(state) % 8u == 0u;
    return (saddle_com_state_t){
        .com_m = {random_in(state, -0.35f, 0.35f), random_in(state, -0.25f, 0.25f)},
        .velocity_m_s = {rests ? 0.0f : random_in(state, -0.5f, 2.0f),
                         rests ? 0.0f : random_in(state, -0.5f, 0.5f)},
    };
}

static posture_t random_posture(uint32_t *state)
{
    return (posture_t){
        .cop_m = {{random_in(state, -0.35f, 0.35f), random_in(state, 0.02f, 0.2f)},
                  {random_in(state, -0.35f, 0.35f), random_in(state, -0.2f, -0.02f)}},
        .state = random_state(state),
        .planned = random_state(state),
    };
}

/* Standing, feet 0.6 m apart, CoM midway, forward at 0.3 m/s: the ray leaves at 0.1 m ahead. */
static void test_excess_to_stop_by_hand(void)
{
    const posture_t posture = {.cop_m = {{0.0f, 0.3f}, {0.0f, -0.3f}},
                               .state = {.velocity_m_s = {0.3f, 0.0f}}};
    const double weight = 63.3 * 9.80665;
    const double expected =
        0.5 * 63.3 * 0.09 + weight * (sqrt(1.0203 * 1.0203 - 0.09) - sqrt(1.0203 * 1.0203 - 0.10));
    TEST_ASSERT_DOUBLE_WITHIN(ENERGY_TOLERANCE, expected, excess_stop(&posture));
}

static void test_excess_equals_the_formulas_for_random_postures(void)
{
    uint32_t state = 41;
    for (int i = 0; i < 5000; i++) {
        const posture_t posture = random_posture(&state);
        const double stop = kinetic(&posture.state) + potential(&posture) -
                            potential_at_exit(&posture, &posture.state);
        const double track = kinetic(&posture.state) - kinetic(&posture.planned) +
                             potential(&posture) - potential_at_exit(&posture, &posture.planned);
        TEST_ASSERT_DOUBLE_WITHIN(ENERGY_TOLERANCE, stop, excess_stop(&posture));
        TEST_ASSERT_DOUBLE_WITHIN(ENERGY_TOLERANCE, track, excess_track(&posture));
    }
}

static void test_used_share_of_the_base_moves_the_exit(void)
{
    uint32_t state = 43;
    for (int i = 0; i < 1000; i++) {
        config.bos_factor = random_in(&state, 0.2f, 1.0f);
        const posture_t posture = random_posture(&state);
        const double stop = kinetic(&posture.state) + potential(&posture) -
                            potential_at_exit(&posture, &posture.state);
        TEST_ASSERT_DOUBLE_WITHIN(ENERGY_TOLERANCE, stop, excess_stop(&posture));
    }
}

/* On the plan K = K_des: what is left is the way down to the border. */
static void test_plan_without_deviation_has_only_the_distance_to_the_border(void)
{
    uint32_t state = 47;
    for (int i = 0; i < 1000; i++) {
        posture_t posture = random_posture(&state);
        posture.planned = posture.state;
        const double expected = potential(&posture) - potential_at_exit(&posture, &posture.state);
        TEST_ASSERT_DOUBLE_WITHIN(ENERGY_TOLERANCE, expected, excess_track(&posture));
        TEST_ASSERT_DOUBLE_WITHIN(ENERGY_TOLERANCE,
                                  (double)excess_stop(&posture) - kinetic(&posture.state),
                                  excess_track(&posture));
    }
}

static void test_ankles_of_the_papers_body_absorb_six_joules(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 6.084, model_of(&config)->body.ankle_work_j);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, 63.3 * GRAVITY * 0.01 / PENDULUM,
                              model_of(&config)->body.ankle_work_j);
    config.ankle_work_factor = 2.5f;
    TEST_ASSERT_DOUBLE_WITHIN(5e-6, 2.5 * 63.3 * GRAVITY * 0.01 / PENDULUM,
                              model_of(&config)->body.ankle_work_j);
    config = saddle_config_default(1.2f, 25.0f);
    config.cop_range_m = 0.06f;
    body = model_of(&config)->body;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 25.0 * GRAVITY * 0.0036 / (0.57 * 1.2),
                              model_of(&config)->body.ankle_work_j);
}

/* Just inside a foot, moving at w d_h to the border d_h ahead: the pendulum's kinetic energy and
 * its fall are half of W_max each, to second order: what is left falls with d_h^2. */
static void test_com_over_a_foot_at_w_d_h_has_as_much_as_the_ankles_absorb(void)
{
    const float ranges[] = {0.1f, 0.05f, 0.025f};
    for (size_t i = 0; i < COUNT_OF(ranges); i++) {
        const double d = (double)ranges[i];
        config.cop_range_m = ranges[i];
        const posture_t posture = {
            .cop_m = {{0.0f, 1.0f}, {0.0f, -1.0f}},
            .state = {.com_m = {0.0f, (float)(1.0 - 0.6 * d * d)},
                      .velocity_m_s = {(float)(FREQUENCY * d), 0.0f}},
        };
        const double work = (double)model_of(&config)->body.ankle_work_j;
        const double of_second_order = 0.25 * d * d / (PENDULUM * PENDULUM);
        TEST_ASSERT_DOUBLE_WITHIN(work * of_second_order + ENERGY_TOLERANCE, work,
                                  excess_stop(&posture));
    }
}

/* Twice the mass, twice the energy, and the same decision. */
static void test_energies_grow_with_the_mass(void)
{
    const posture_t posture = {.cop_m = {{0.3f, 0.05f}, {-0.3f, -0.05f}},
                               .state = {{0.05f, 0.02f}, {1.1f, 0.1f}},
                               .planned = {{0.04f, 0.0f}, {1.2f, 0.0f}}};
    const float stop = excess_stop(&posture);
    const float track = excess_track(&posture);
    const float work = model_of(&config)->body.ankle_work_j;
    config.body_mass_kg *= 2.0f;
    ASSERT_SAME_FLOAT(2.0f * stop, excess_stop(&posture));
    ASSERT_SAME_FLOAT(2.0f * track, excess_track(&posture));
    ASSERT_SAME_FLOAT(2.0f * work, model_of(&config)->body.ankle_work_j);
}

/* No leg reaches the CoM, or the place on the border: feet 5 m apart, the exit midway. */
static void test_no_energy_is_given_beyond_the_legs_reach(void)
{
    const struct {
        saddle_vec2_t cop_m[2];
        saddle_com_state_t state;
    } table[] = {
        {{{1.5f, 0.1f}, {1.3f, -0.1f}}, {{0.0f, 0.0f}, {1.0f, 0.0f}}},
        {{{0.0f, 2.5f}, {0.0f, -2.5f}}, {{-0.09f, 2.0f}, {0.19f, -2.0f}}},
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        const saddle_bos_t bos = saddle_bos(table[i].cop_m, config.cop_range_m, 1.0f);
        const saddle_com_state_t *state = &table[i].state;
        const saddle_support_t support = support_of(table[i].cop_m, &bos, state->com_m);
        float stop_j = NAN;
        float track_j = NAN;
        TEST_ASSERT_FALSE(saddle_excess_stop_j(model_of(&config), &support, state, &stop_j));
        TEST_ASSERT_FALSE(
            saddle_excess_track_j(model_of(&config), &support, state, state, &track_j));
        ASSERT_SAME_FLOAT(0.0f, stop_j);
        ASSERT_SAME_FLOAT(0.0f, track_j);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_excess_to_stop_by_hand);
    RUN_TEST(test_excess_equals_the_formulas_for_random_postures);
    RUN_TEST(test_used_share_of_the_base_moves_the_exit);
    RUN_TEST(test_plan_without_deviation_has_only_the_distance_to_the_border);
    RUN_TEST(test_ankles_of_the_papers_body_absorb_six_joules);
    RUN_TEST(test_com_over_a_foot_at_w_d_h_has_as_much_as_the_ankles_absorb);
    RUN_TEST(test_energies_grow_with_the_mass);
    RUN_TEST(test_no_energy_is_given_beyond_the_legs_reach);
    return UNITY_END();
}
