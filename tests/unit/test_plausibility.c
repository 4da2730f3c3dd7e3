/** Which measurement is refused and why: its age, its range, frozen, contradictory. */
#include "core_test.h"

#include "sense/plausibility.h"

static const float DT_S = 0.08f;

/* Ages at the limits below. */
#define COM_MAX_AGE_US 240000u
#define FOOT_MAX_AGE_US 160000u

static saddle_config_t config;
static saddle_plausibility_t plausibility;
static float planned_m_s;
static saddle_measurement_t measured;

/* Mid-step, both feet down, CoM a little behind the middle. */
static saddle_measurement_t good_measurement(void)
{
    return (saddle_measurement_t){
        .com = {.height_m = 1.0f, .velocity_m_s = {1.1f, 0.05f}},
        .foot = {{.cop_m = {0.35f, 0.06f}, .contact = true},
                 {.cop_m = {-0.25f, -0.05f}, .contact = true}},
    };
}

void setUp(void)
{
    config = paper_config();
    config.com_max_age_s = 0.24f;
    config.foot_max_age_s = 0.16f;
    config.flight_max_s = 0.5f;
    config.crossing_max_m = 0.15f;
    memset(&plausibility, 0, sizeof plausibility);
    measured = good_measurement();
    planned_m_s = 0.0f;
}

void tearDown(void) {}

static uint32_t check_measurement(void)
{
    return saddle_measurement_check(&plausibility, model_of(&config), &measured, planned_m_s, DT_S);
}

/* Of this measurement alone. */
static uint32_t check_again(void)
{
    memset(&plausibility, 0, sizeof plausibility);
    return check_measurement();
}

/* The body moves on over feet that stand: the feet fall behind the CoM. */
static void move(float vx_m_s, float vy_m_s)
{
    for (int side = 0; side < 2; side++) {
        measured.foot[side].cop_m.x -= vx_m_s * DT_S;
        measured.foot[side].cop_m.y -= vy_m_s * DT_S;
    }
}

/* ---- age and range ------------------------------------------------------------------------- */

static void test_no_measurement_never_came(void)
{
    const saddle_measurement_t none = saddle_no_measurement();
    ASSERT_SAME_FLOAT(0.0f, none.com.height_m);
    ASSERT_SAME_FLOAT(0.0f, none.com.velocity_m_s.x);
    ASSERT_SAME_FLOAT(0.0f, none.com.velocity_m_s.y);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, none.com.age_us);
    for (int side = 0; side < 2; side++) {
        ASSERT_SAME_FLOAT(0.0f, none.foot[side].cop_m.x);
        ASSERT_SAME_FLOAT(0.0f, none.foot[side].cop_m.y);
        ASSERT_SAME_FLOAT(0.0f, none.foot[side].ground_m_s);
        TEST_ASSERT_FALSE(none.foot[side].contact);
        TEST_ASSERT_EQUAL_UINT32(0, none.foot[side].since_us);
        TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, none.foot[side].age_us);
    }
}

static void test_good_measurement_has_no_fault(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
}

static void test_age_at_the_limit_is_fresh_and_above_it_stale(void)
{
    const struct {
        uint32_t *age_us, limit_us, fault;
    } ages[] = {
        {&measured.com.age_us, COM_MAX_AGE_US, SADDLE_FAULT_COM_STALE},
        {&measured.foot[SADDLE_LEFT].age_us, FOOT_MAX_AGE_US, SADDLE_FAULT_LEFT_STALE},
        {&measured.foot[SADDLE_RIGHT].age_us, FOOT_MAX_AGE_US, SADDLE_FAULT_RIGHT_STALE},
    };
    for (size_t i = 0; i < COUNT_OF(ages); i++) {
        measured = good_measurement();
        *ages[i].age_us = ages[i].limit_us;
        TEST_ASSERT_EQUAL_HEX32(0, check_again());
        *ages[i].age_us = ages[i].limit_us + 1u;
        TEST_ASSERT_EQUAL_HEX32(ages[i].fault, check_again());
        *ages[i].age_us = SADDLE_AGE_NEVER_US;
        TEST_ASSERT_EQUAL_HEX32(ages[i].fault, check_again());
    }
}

/* Every measured number, the values that it may have, and the fault of any other. */
typedef struct {
    float *number;
    float min, max;
    uint32_t fault;
} field_t;

#define FIELD_COUNT 7

static void list_fields(field_t fields[FIELD_COUNT])
{
    const field_t list[FIELD_COUNT] = {
        {&measured.com.height_m, 0.05f, 1.79f, SADDLE_FAULT_COM_RANGE},
        {&measured.com.velocity_m_s.x, -6.0f, 6.0f, SADDLE_FAULT_COM_RANGE},
        {&measured.com.velocity_m_s.y, -6.0f, 6.0f, SADDLE_FAULT_COM_RANGE},
        {&measured.foot[SADDLE_LEFT].cop_m.x, -2.5f, 2.5f, SADDLE_FAULT_LEFT_RANGE},
        {&measured.foot[SADDLE_LEFT].cop_m.y, -2.5f, 2.5f, SADDLE_FAULT_LEFT_RANGE},
        {&measured.foot[SADDLE_RIGHT].cop_m.x, -2.5f, 2.5f, SADDLE_FAULT_RIGHT_RANGE},
        {&measured.foot[SADDLE_RIGHT].cop_m.y, -2.5f, 2.5f, SADDLE_FAULT_RIGHT_RANGE},
    };
    memcpy(fields, list, sizeof list);
}

static void test_absurd_number_in_any_field_is_a_range_fault(void)
{
    field_t fields[FIELD_COUNT];
    list_fields(fields);
    for (size_t i = 0; i < FIELD_COUNT; i++) {
        const float bad[] = {NAN,
                             -NAN,
                             INFINITY,
                             -INFINITY,
                             1e30f,
                             -1e30f,
                             3.4e38f,
                             nextafterf(fields[i].min, -INFINITY),
                             nextafterf(fields[i].max, INFINITY)};
        for (size_t k = 0; k < COUNT_OF(bad); k++) {
            measured = good_measurement();
            *fields[i].number = bad[k];
            TEST_ASSERT_EQUAL_HEX32(fields[i].fault, check_again());
        }
        const float ends[] = {fields[i].min, fields[i].max};
        for (size_t k = 0; k < COUNT_OF(ends); k++) {
            measured = good_measurement();
            *fields[i].number = ends[k];
            /* the left foot may well be right of the right one */
            const uint32_t crossed = (uint32_t)SADDLE_FAULT_FEET_CROSSED;
            const uint32_t low = (uint32_t)SADDLE_FAULT_COM_LOW;
            TEST_ASSERT_EQUAL_HEX32(0, check_again() & ~(crossed | low));
        }
    }
}

/* A person of 1.2 m: her knees are lower, and so is the top of her head. */
static void test_com_between_knees_and_head_goes_with_the_body(void)
{
    config = saddle_config_default(1.2f, 25.0f);
    const struct {
        float height_m;
        uint32_t fault;
    } table[] = {{0.0f, SADDLE_FAULT_COM_RANGE},
                 {0.1f, SADDLE_FAULT_COM_LOW},
                 {0.34f, SADDLE_FAULT_COM_LOW},
                 {0.35f, 0},
                 {0.68f, 0},
                 {1.19f, 0},
                 {1.21f, SADDLE_FAULT_COM_RANGE}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        measured.com.height_m = table[i].height_m;
        TEST_ASSERT_EQUAL_HEX32(table[i].fault, check_again());
    }
}

static void test_stale_measurement_is_not_also_out_of_range(void)
{
    measured.com.height_m = NAN;
    measured.com.age_us = SADDLE_AGE_NEVER_US;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COM_STALE, check_measurement());
}

static void test_faults_add_up(void)
{
    measured.com.age_us = SADDLE_AGE_NEVER_US;
    measured.foot[SADDLE_LEFT].age_us = SADDLE_AGE_NEVER_US;
    measured.foot[SADDLE_RIGHT].cop_m.x = NAN;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COM_STALE | SADDLE_FAULT_LEFT_STALE |
                                SADDLE_FAULT_RIGHT_RANGE,
                            check_measurement());
}

static void test_recovery_is_at_once(void)
{
    check_measurement();
    measured.com.velocity_m_s.x = NAN;
    measured.foot[SADDLE_LEFT].cop_m.y = INFINITY;
    measured.foot[SADDLE_RIGHT].age_us = SADDLE_AGE_NEVER_US;
    TEST_ASSERT_NOT_EQUAL_UINT32(0, check_measurement());
    measured = good_measurement();
    TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
}

/* ---- frozen -------------------------------------------------------------------------------- */

/* The wearer moves at 0.5 m/s over feet that stand; the CoM's sensor still says 1.1 m/s. 0.6 m/s
 * amiss make more than 2 cm in one tick, but the bits may stay for com_max_age_s. */
static void test_constant_velocity_that_contradicts_the_feet_is_frozen(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    for (int tick = 1; tick <= 8; tick++) {
        move(0.5f, 0.0f);
        const uint32_t expected = tick > 3 ? (uint32_t)SADDLE_FAULT_COM_FROZEN : 0u;
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected, check_measurement(), "240 ms are three ticks");
    }
}

/* From 2 cm on, either way along either axis: 0.055 m/s amiss make 17.6 mm in four ticks. */
static void test_frozen_com_is_seen_along_either_axis_from_two_centimetres_on(void)
{
    const struct {
        float vx, vy;
    } true_velocity[] = {{1.1f - 0.055f, 0.05f},
                         {1.1f + 0.055f, 0.05f},
                         {1.1f, 0.05f - 0.055f},
                         {1.1f, 0.05f + 0.055f}};
    for (size_t i = 0; i < COUNT_OF(true_velocity); i++) {
        setUp();
        check_measurement();
        for (int tick = 1; tick <= 8; tick++) {
            move(true_velocity[i].vx, true_velocity[i].vy);
            TEST_ASSERT_EQUAL_HEX32(tick >= 5 ? (uint32_t)SADDLE_FAULT_COM_FROZEN : 0u,
                                    check_measurement());
        }
    }
}

static void test_frozen_com_is_used_again_as_soon_as_it_changes(void)
{
    check_measurement();
    for (int tick = 0; tick < 10; tick++) {
        move(0.5f, 0.0f);
        check_measurement();
    }
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COM_FROZEN, check_measurement());
    move(0.5f, 0.0f);
    measured.com.velocity_m_s.x = 0.5f;
    TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    for (int tick = 0; tick < 10; tick++) { /* and now it is right */
        move(0.5f, 0.05f);
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

static void test_com_whose_height_changes_is_alive(void)
{
    check_measurement();
    for (int tick = 0; tick < 10; tick++) {
        move(0.5f, 0.0f);
        measured.com.height_m += 1e-3f;
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

/* A walk at a constant speed without noise: the bits stay, and the feet agree. */
static void test_constant_speed_that_agrees_with_the_feet_is_not_frozen(void)
{
    check_measurement();
    for (int tick = 0; tick < 20; tick++) {
        move(1.1f, 0.05f);
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

static void test_standing_still_without_noise_is_not_frozen(void)
{
    measured.com.velocity_m_s = (saddle_vec2_t){0.0f, 0.0f};
    for (int tick = 0; tick < 200; tick++) {
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

/* Swinging feet move over the ground: they say nothing about the CoM. */
/* Sensors that froze before the walk began contradict nothing but the plan: 2 cm of it. */
static void test_com_that_stands_still_under_a_planned_walk_is_frozen(void)
{
    static const float speeds_m_s[] = {0.06f, 0.3f, 1.2f};
    for (size_t i = 0; i < COUNT_OF(speeds_m_s); i++) {
        setUp();
        config.com_max_age_s = 0.2f;
        measured.com.velocity_m_s = (saddle_vec2_t){0.0f, 0.0f};
        planned_m_s = speeds_m_s[i];
        for (int tick = 0; tick < 12; tick++) { /* 0.24 s after the first, and 2 cm */
            const bool frozen = tick >= 3 && (float)tick * DT_S * planned_m_s > 0.02f;
            TEST_ASSERT_EQUAL_HEX32(frozen ? SADDLE_FAULT_COM_FROZEN : 0u, check_measurement());
        }
        measured.com.velocity_m_s.x = 0.01f;
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

static void test_feet_in_the_air_do_not_make_the_com_frozen(void)
{
    measured.foot[SADDLE_RIGHT].contact = false;
    check_measurement();
    for (int tick = 0; tick < 6; tick++) {
        measured.foot[SADDLE_LEFT].cop_m.x -= 1.1f * DT_S;
        measured.foot[SADDLE_LEFT].cop_m.y -= 0.05f * DT_S;
        measured.foot[SADDLE_RIGHT].cop_m.x += 1.5f * DT_S;
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

/* A walk over the ground: steps of six ticks. The swing foot moves until it lands, during the first
 * tick of the next step, where both feet are down. vx_m_s is the true speed along x. */
typedef struct {
    float com_x_m, foot_x_m[2];
    int tick, stance;
} walker_t;

static void walk_on(walker_t *walker, float vx_m_s)
{
    const bool both = walker->tick % 6 == 0;
    walker->com_x_m += vx_m_s * DT_S;
    walker->foot_x_m[1 - walker->stance] += 2.0f * vx_m_s * DT_S;
    walker->stance = both ? 1 - walker->stance : walker->stance;
    walker->tick++;
    for (int side = 0; side < 2; side++) {
        measured.foot[side].cop_m.x = walker->foot_x_m[side] - walker->com_x_m;
        measured.foot[side].contact = both || side == walker->stance;
    }
}

/* The same bits for ten seconds, and they are true. */
static void test_walk_at_a_constant_speed_is_not_frozen(void)
{
    walker_t walker = {.foot_x_m = {0.1f, -0.1f}};
    measured.com.velocity_m_s = (saddle_vec2_t){0.8f, 0.0f};
    for (int tick = 0; tick < 125; tick++) {
        walk_on(&walker, 0.8f);
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

/* Whenever in the step the velocity freezes 0.4 m/s off the truth: the next stance at the latest
 * contradicts it, and then it stays frozen whichever feet swing, until it changes. */
static void test_com_that_freezes_in_a_walk_stays_frozen_until_it_changes(void)
{
    for (int start = 24; start < 30; start++) {
        walker_t walker = {.foot_x_m = {0.1f, -0.1f}};
        memset(&plausibility, 0, sizeof plausibility);
        measured.com.velocity_m_s = (saddle_vec2_t){0.8f, 0.0f};
        int first = 0;
        for (int tick = 0; tick < start + 60; tick++) {
            walk_on(&walker, 0.8f);
            measured.com.velocity_m_s.x = tick < start ? 0.8f + 1e-3f * (float)(tick % 3) : 1.2f;
            const uint32_t faults = check_measurement();
            if (faults != 0u && first == 0) {
                first = tick;
            }
            const uint32_t expected = first != 0 ? (uint32_t)SADDLE_FAULT_COM_FROZEN : 0u;
            TEST_ASSERT_EQUAL_HEX32(expected, faults);
        }
        TEST_ASSERT_TRUE(first > start + 3 && first <= start + 9);
        walk_on(&walker, 0.8f);
        measured.com.velocity_m_s.x = 0.8f;
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

/* The CoM moves at 1.1 m/s, and one foot's place relative to it keeps its bits. */
static void test_foot_that_keeps_its_bits_while_the_com_moves_is_frozen(void)
{
    const uint32_t faults[] = {SADDLE_FAULT_LEFT_FROZEN, SADDLE_FAULT_RIGHT_FROZEN};
    for (int side = 0; side < 2; side++) {
        setUp();
        check_measurement();
        for (int tick = 1; tick <= 8; tick++) {
            const saddle_vec2_t frozen_m = measured.foot[side].cop_m;
            measured.com.velocity_m_s.x = 1.1f + 0.01f * (float)(tick % 2);
            move(1.1f, 0.05f);
            measured.foot[side].cop_m = frozen_m;
            const uint32_t expected = tick > 2 ? faults[side] : 0u;
            TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected, check_measurement(), "160 ms are two ticks");
        }
        measured.foot[side].cop_m.x -= 0.5f;
        measured.com.velocity_m_s.x = 1.0f;
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement()); /* alive again at once */
    }
}

/* Either axis of a CoP is enough to be alive, and 2 cm of way not yet a contradiction. */
static void test_foot_is_alive_if_one_number_changes_or_the_com_hardly_moves(void)
{
    measured.com.velocity_m_s = (saddle_vec2_t){0.04f, -0.04f};
    check_measurement();
    for (int tick = 1; tick <= 6; tick++) { /* 3.2 mm each: 19.2 mm */
        measured.com.velocity_m_s.x += 1e-4f * (float)(tick % 2 == 0 ? 1 : -1);
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
    measured.com.velocity_m_s.x = 1.1f;
    for (int tick = 0; tick < 10; tick++) {
        measured.com.velocity_m_s.x += 0.01f;
        measured.foot[SADDLE_LEFT].cop_m.y += 1e-6f;
        measured.foot[SADDLE_RIGHT].cop_m.x += 1e-6f;
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
    }
}

/* The same packet again and again, with an age of 0: nothing moves but what the velocity says. */
static void test_stream_that_repeats_itself_is_frozen_in_every_number(void)
{
    check_measurement();
    for (int tick = 1; tick <= 6; tick++) {
        const uint32_t feet = SADDLE_FAULT_LEFT_FROZEN | SADDLE_FAULT_RIGHT_FROZEN;
        const uint32_t expected =
            (tick > 2 ? feet : 0u) | (tick > 3 ? (uint32_t)SADDLE_FAULT_COM_FROZEN : 0u);
        TEST_ASSERT_EQUAL_HEX32(expected, check_measurement());
    }
}

/* Below 2 cm/s a person rests: for hours the feet may keep their bits. */
static void test_foot_under_a_resting_com_is_not_frozen(void)
{
    const struct {
        float speed;
        bool frozen;
    } table[] = {{0.0195f, false}, {-0.0195f, false}, {0.0205f, true}, {-0.0205f, true}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        for (int axis = 0; axis < 2; axis++) {
            uint32_t faults = 0;
            setUp();
            measured.com.velocity_m_s = (saddle_vec2_t){axis == 0 ? table[i].speed : 0.0f,
                                                        axis == 1 ? table[i].speed : 0.0f};
            for (int tick = 0; tick < 100; tick++) {
                measured.com.height_m = tick % 2 == 0 ? 1.0f : 1.001f;
                faults = check_measurement();
            }
            const uint32_t feet = SADDLE_FAULT_LEFT_FROZEN | SADDLE_FAULT_RIGHT_FROZEN;
            TEST_ASSERT_EQUAL_HEX32(table[i].frozen ? feet : 0u, faults);
        }
    }
}

/* The velocity is frozen, and a foot's place: after an outage both have to be seen anew. */
static void test_outage_ends_a_frozen_state(void)
{
    check_measurement();
    for (int tick = 0; tick < 8; tick++) {
        move(0.5f, 0.0f);
        measured.foot[SADDLE_LEFT].cop_m = good_measurement().foot[SADDLE_LEFT].cop_m;
        check_measurement();
    }
    const uint32_t frozen = SADDLE_FAULT_COM_FROZEN | SADDLE_FAULT_LEFT_FROZEN;
    TEST_ASSERT_EQUAL_HEX32(frozen, check_measurement() & frozen);
    measured.foot[SADDLE_RIGHT].age_us = SADDLE_AGE_NEVER_US;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_RIGHT_STALE, check_measurement());
    measured.foot[SADDLE_RIGHT].age_us = 0;
    for (int tick = 1; tick <= 6; tick++) {
        move(0.5f, 0.0f);
        measured.foot[SADDLE_LEFT].cop_m = good_measurement().foot[SADDLE_LEFT].cop_m;
        const uint32_t expected = (tick > 2 ? (uint32_t)SADDLE_FAULT_LEFT_FROZEN : 0u) |
                                  (tick > 3 ? (uint32_t)SADDLE_FAULT_COM_FROZEN : 0u);
        TEST_ASSERT_EQUAL_HEX32(expected, check_measurement());
    }
}

/* What was not measured is no contradiction: the true walk goes on while a foot is not measured. */
static void test_outage_does_not_make_anything_frozen(void)
{
    for (int length = 1; length <= 12; length++) {
        walker_t walker = {.foot_x_m = {0.1f, -0.1f}};
        setUp();
        measured.com.velocity_m_s = (saddle_vec2_t){0.8f, 0.0f};
        for (int tick = 0; tick < 40; tick++) {
            const bool out = tick >= 10 && tick < 10 + length;
            walk_on(&walker, 0.8f);
            measured.foot[SADDLE_LEFT].age_us = out ? SADDLE_AGE_NEVER_US : 0u;
            TEST_ASSERT_EQUAL_HEX32(out ? (uint32_t)SADDLE_FAULT_LEFT_STALE : 0u,
                                    check_measurement());
        }
    }
}

/* Pushed between two ticks: the place follows from the next tick on. */
static void test_push_of_a_standing_person_is_not_frozen(void)
{
    measured.com.velocity_m_s = (saddle_vec2_t){0.0f, 0.0f};
    for (int tick = 0; tick < 10; tick++) {
        check_measurement();
    }
    measured.com.velocity_m_s.x = 1.0f;
    for (int tick = 0; tick < 10; tick++) {
        TEST_ASSERT_EQUAL_HEX32(0, check_measurement());
        move(1.0f, 0.0f);
    }
}

/* ---- contradictory ------------------------------------------------------------------------- */

static void test_both_feet_in_the_air_for_long_is_airborne(void)
{
    measured.com.velocity_m_s.x = 0.5f;
    measured.foot[SADDLE_LEFT].contact = false;
    measured.foot[SADDLE_RIGHT].contact = false;
    for (int tick = 1; tick <= 20; tick++) { /* 6 ticks are 0.48 s, 7 are 0.56 s */
        move(0.5f, 0.05f);
        const uint32_t expected = tick > 6 ? (uint32_t)SADDLE_FAULT_AIRBORNE : 0u;
        TEST_ASSERT_EQUAL_HEX32(expected, check_measurement());
    }
    TEST_ASSERT_TRUE(((uint32_t)SADDLE_FAULT_AIRBORNE & SADDLE_FAULTS_FEET) != 0u);
    measured.foot[SADDLE_RIGHT].contact = true;
    move(0.5f, 0.05f);
    TEST_ASSERT_EQUAL_HEX32(0, check_measurement()); /* one foot is enough, at once */
    measured.foot[SADDLE_RIGHT].contact = false;
    for (int tick = 1; tick <= 7; tick++) { /* and the time begins anew */
        move(0.5f, 0.05f);
        TEST_ASSERT_EQUAL_HEX32(tick > 6 ? (uint32_t)SADDLE_FAULT_AIRBORNE : 0u,
                                check_measurement());
    }
    measured.foot[SADDLE_LEFT].cop_m.y = measured.foot[SADDLE_RIGHT].cop_m.y - 0.16f;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_AIRBORNE | SADDLE_FAULT_FEET_CROSSED, check_measurement());
}

static void test_feet_that_cross_by_too_much_are_contradictory(void)
{
    const struct {
        float left_y, right_y;
        uint32_t fault;
    } table[] = {{0.06f, -0.05f, 0},
                 {-0.07f, 0.07f, 0},
                 {-0.08f, 0.08f, SADDLE_FAULT_FEET_CROSSED},
                 {0.40f, 0.54f, 0},
                 {0.40f, 0.56f, SADDLE_FAULT_FEET_CROSSED}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        measured.foot[SADDLE_LEFT].cop_m.y = table[i].left_y;
        measured.foot[SADDLE_RIGHT].cop_m.y = table[i].right_y;
        TEST_ASSERT_EQUAL_HEX32(table[i].fault, check_again());
    }
    measured.foot[SADDLE_LEFT].cop_m.y = 0.0f;
    measured.foot[SADDLE_RIGHT].cop_m.y = config.crossing_max_m;
    TEST_ASSERT_EQUAL_HEX32(0, check_again());
    TEST_ASSERT_TRUE(((uint32_t)SADDLE_FAULT_FEET_CROSSED & SADDLE_FAULTS_FEET) != 0u);
}

static void test_feet_that_are_not_measured_are_neither_airborne_nor_crossed(void)
{
    measured.foot[SADDLE_LEFT].contact = false;
    measured.foot[SADDLE_RIGHT].contact = false;
    measured.foot[SADDLE_LEFT].cop_m.y = -1.0f;
    measured.foot[SADDLE_RIGHT].age_us = SADDLE_AGE_NEVER_US;
    for (int tick = 0; tick < 20; tick++) {
        TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_RIGHT_STALE, check_measurement());
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_measurement_never_came);
    RUN_TEST(test_good_measurement_has_no_fault);
    RUN_TEST(test_age_at_the_limit_is_fresh_and_above_it_stale);
    RUN_TEST(test_absurd_number_in_any_field_is_a_range_fault);
    RUN_TEST(test_com_between_knees_and_head_goes_with_the_body);
    RUN_TEST(test_stale_measurement_is_not_also_out_of_range);
    RUN_TEST(test_faults_add_up);
    RUN_TEST(test_recovery_is_at_once);
    RUN_TEST(test_constant_velocity_that_contradicts_the_feet_is_frozen);
    RUN_TEST(test_frozen_com_is_seen_along_either_axis_from_two_centimetres_on);
    RUN_TEST(test_frozen_com_is_used_again_as_soon_as_it_changes);
    RUN_TEST(test_com_whose_height_changes_is_alive);
    RUN_TEST(test_constant_speed_that_agrees_with_the_feet_is_not_frozen);
    RUN_TEST(test_standing_still_without_noise_is_not_frozen);
    RUN_TEST(test_com_that_stands_still_under_a_planned_walk_is_frozen);
    RUN_TEST(test_feet_in_the_air_do_not_make_the_com_frozen);
    RUN_TEST(test_walk_at_a_constant_speed_is_not_frozen);
    RUN_TEST(test_com_that_freezes_in_a_walk_stays_frozen_until_it_changes);
    RUN_TEST(test_foot_that_keeps_its_bits_while_the_com_moves_is_frozen);
    RUN_TEST(test_foot_is_alive_if_one_number_changes_or_the_com_hardly_moves);
    RUN_TEST(test_stream_that_repeats_itself_is_frozen_in_every_number);
    RUN_TEST(test_foot_under_a_resting_com_is_not_frozen);
    RUN_TEST(test_outage_ends_a_frozen_state);
    RUN_TEST(test_outage_does_not_make_anything_frozen);
    RUN_TEST(test_push_of_a_standing_person_is_not_frozen);
    RUN_TEST(test_both_feet_in_the_air_for_long_is_airborne);
    RUN_TEST(test_feet_that_cross_by_too_much_are_contradictory);
    RUN_TEST(test_feet_that_are_not_measured_are_neither_airborne_nor_crossed);
    return UNITY_END();
}
