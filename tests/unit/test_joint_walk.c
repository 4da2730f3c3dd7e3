/** The walking layer on a puppet: a body that is where the plan has it, with its loads. What the joints
 *  should do is checked by forward kinematics. */
#include "core_test.h"

#include <fenv.h>
#include <saddlewalk/joint_walk.h>

#define STEP_US 1000u
#define TICK_STEPS 80u
#define STANDS_US 1000000u /* before the command to walk */
#define PLACE_M 2e-4       /* of a sole, through inverse and forward kinematics in floats */

static saddle_context_t core;
static saddle_input_t input;
static saddle_output_t output;
static saddle_plan_t plan;
static saddle_legs_t legs;
static saddle_joint_walk_config_t config;
static saddle_joint_walk_t walk;
static saddle_estimate_t estimate;
static saddle_intent_t intent;
static saddle_vec2_t xcom_error_m;      /* of the puppet */
static float light;                     /* share of a load that the puppet shows */
static uint64_t stops_us;               /* from then on the command is to stand */
static const saddle_verdict_t *verdict; /* that the walk hears of */

static const saddle_axes_t WORLD = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};

static void begin(void)
{
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_joint_walk_init(&walk, &legs, &config));
}

void setUp(void)
{
    saddle_config_t body = paper_config();
    body.ankle = SADDLE_ANKLE_CYCLOID;
    body.pendulum_ratio = 0.545f;
    body.step_width_fast_m = 0.16f;
    body.lost_inputs_stop = 0.0f; /* the core plans for nobody */
    saddle_init(&core, &body);
    memset(&input, 0, sizeof input);
    input.measurement.com.age_us = SADDLE_AGE_NEVER_US;
    input.measurement.foot[0].age_us = input.measurement.foot[1].age_us = SADDLE_AGE_NEVER_US;
    legs = saddle_legs_default(1.79f, 63.3f);
    config = saddle_joint_walk_default();
    xcom_error_m = (saddle_vec2_t){0.0f, 0.0f};
    light = 1.0f;
    stops_us = UINT64_MAX;
    verdict = &output.verdict;
    memset(&plan, 0, sizeof plan);
    begin();
}

void tearDown(void) {}

/* The body of the plan: its feet, and its XCoM but for the error. At rest before the first plan. */
static void pose(void)
{
    const saddle_vec2_t com = plan.reference.com_m;
    saddle_foot_t foot[2];
    memset(foot, 0, sizeof foot);
    memset(&estimate, 0, sizeof estimate);
    for (unsigned side = 0; side < 2; side++) {
        foot[side].position_m = plan.foot_m[side];
        estimate.load_n[side] = light * 620.0f * plan.reference.load[side];
    }
    const float time_s = sqrtf(plan.com_m.z / SADDLE_GRAVITY_M_S2);
    saddle_com_t wanted = {{com.x, com.y, plan.com_m.z}, {0.0f, 0.0f, 0.0f}};
    if (time_s > 0.0f) {
        wanted.velocity_m_s.x = (plan.reference.xcom_m.x + xcom_error_m.x - com.x) / time_s;
        wanted.velocity_m_s.y = (plan.reference.xcom_m.y + xcom_error_m.y - com.y) / time_s;
    }
    estimate.trunk.hips_m = (saddle_vec3_t){com.x, com.y, plan.com_m.z - 0.1f};
    estimate.trunk.axes = WORLD;
    (void)saddle_inverse_of_com(&legs, &wanted, foot, &estimate.trunk, &estimate.joints);
    saddle_forward(&legs, &estimate.trunk, &estimate.joints, &estimate.body);
    for (unsigned side = 0; side < 2; side++) { /* where the leg is too short as well */
        estimate.body.foot[side].sole_m = plan.foot_m[side];
    }
    estimate.body.com = wanted;
}

static void update(void)
{
    const saddle_joint_walk_input_t at = {input.time_us, &plan, verdict};
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_joint_walk_update(&walk, &at, &estimate, &intent));
}

/* One millisecond of the plan of a walk at 0.8 m/s, and the puppet in it. */
static void move_puppet(void)
{
    const uint64_t now_us = input.time_us + STEP_US;
    const bool walks = now_us >= STANDS_US && now_us < stops_us;
    input.time_us = now_us;
    input.command.mode = walks ? SADDLE_COMMAND_WALK : SADDLE_COMMAND_STAND;
    input.command.speed_m_s = 0.8f;
    if ((now_us / STEP_US) % TICK_STEPS == 1u) {
        TEST_ASSERT_EQUAL(SADDLE_OK, saddle_tick(&core, &input, &output));
    }
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_plan_at(&core, now_us, &plan));
    pose();
}

static void step(void)
{
    move_puppet();
    update();
}

/* The puppet stays while a millisecond passes. */
static void stay(void)
{
    input.time_us += STEP_US;
    update();
}

static void step_until_us(uint64_t time_us)
{
    while (input.time_us < time_us) {
        step();
    }
}

static unsigned swing_side(void)
{
    return 1u - plan.support;
}

/* To the next moment at which a foot has been in the air for so long. */
static void step_into_a_swing(unsigned steps)
{
    while (intent.role[swing_side()] == SADDLE_LEG_SWINGS) {
        step();
    }
    while (intent.role[swing_side()] != SADDLE_LEG_SWINGS) {
        step();
    }
    for (unsigned n = 0; n < steps; n++) {
        step();
    }
    TEST_ASSERT_EQUAL(SADDLE_LEG_SWINGS, intent.role[swing_side()]);
}

/* Where the reference has a sole. */
static saddle_vec3_t reference_m(unsigned side)
{
    saddle_whole_body_t body;
    saddle_forward(&legs, &estimate.trunk, &intent.joints, &body);
    return body.foot[side].sole_m;
}

/* ---- roles ---------------------------------------------------------------------------------- */

static void test_who_stands_stands_on_both_feet(void)
{
    step_until_us(900000u);
    for (unsigned side = 0; side < 2; side++) {
        TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[side]);
        for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) { /* and stays as it is */
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)estimate.joints.angle_rad[side][joint],
                                      (double)intent.joints.angle_rad[side][joint]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, (double)intent.joints.rate_rad_s[side][joint]);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 1.0, (double)intent.trailing_share_max);
}

static void test_without_a_plan_the_cop_goes_between_the_feet(void)
{
    step_until_us(900000u);
    const saddle_plan_t good = plan;
    for (unsigned kind = 0; kind < 3u; kind++) {
        plan = good;
        plan.valid = kind != 0u;
        plan.support = kind == 1u ? SADDLE_RIGHT + 1u : plan.support;
        const saddle_joint_walk_input_t at = {input.time_us, kind == 2u ? NULL : &plan, NULL};
        TEST_ASSERT_EQUAL(SADDLE_OK, saddle_joint_walk_update(&walk, &at, &estimate, &intent));
        const saddle_vec3_t left = estimate.body.foot[0].sole_m;
        const saddle_vec3_t right = estimate.body.foot[1].sole_m;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 * (double)(left.x + right.x), (double)intent.cop_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 * (double)(left.y + right.y), (double)intent.xcom_m.y);
        TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[0]);
        TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[1]);
        input.time_us += STEP_US;
    }
}

static void test_legs_do_what_the_plan_has_them_for(void)
{
    unsigned seen[3] = {0u, 0u, 0u};
    step_until_us(3000000u);
    while (input.time_us < 6000000u) {
        step();
        TEST_ASSERT_TRUE(intent.role[plan.support] != SADDLE_LEG_SWINGS ||
                         estimate.load_n[plan.support] <= config.landed_n);
        if (intent.role[swing_side()] == SADDLE_LEG_TRAILS) { /* it hands over what it has */
            TEST_ASSERT_TRUE(intent.trailing_share_max > 0.0f && intent.trailing_share_max <= 1.0f);
        }
        seen[intent.role[swing_side()]]++;
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)plan.reference.cop_m.x, (double)intent.cop_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)plan.reference.xcom_m.y, (double)intent.xcom_m.y);
    }
    TEST_ASSERT_TRUE(seen[SADDLE_LEG_STANDS] <
                     50u); /* until the leading foot has found the ground */
    TEST_ASSERT_TRUE(seen[SADDLE_LEG_SWINGS] > 2000u && seen[SADDLE_LEG_TRAILS] > 200u);
}

static void test_a_foot_that_carries_nothing_lifts_before_its_time(void)
{
    step_until_us(3000000u);
    config.lifted_s = 0.005f;
    begin();
    step_into_a_swing(0u);
    while (intent.role[swing_side()] != SADDLE_LEG_TRAILS) {
        step();
    }
    unsigned trailed = 0;
    for (; intent.role[swing_side()] == SADDLE_LEG_TRAILS; trailed++) {
        move_puppet();
        estimate.load_n[swing_side()] = 5.0f;
        estimate.load_n[plan.support] = 600.0f;
        update();
    }
    TEST_ASSERT_UINT_WITHIN(2u, 6u, trailed);
}

static void test_a_walk_that_stops_ends_side_by_side(void)
{
    step_until_us(3000000u);
    stops_us = input.time_us;
    while (plan.speed_m_s > 0.0f) {
        step();
        if (plan.landing_m.x <= 0.0f && plan.time_to_via_point_s < 0.005f) {
            const saddle_vec3_t at = reference_m(swing_side());
            TEST_ASSERT_DOUBLE_WITHIN(0.01, (double)plan.foot_m[plan.support].x, (double)at.x);
            TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, (double)at.z);
        }
    }
    step_until_us(input.time_us + 1000000u); /* the load comes back to the swing foot */
    TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[0]);
    TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 1.0, (double)intent.trailing_share_max);
}

/* The first moment of a stop that begins on `stance` at which the last swing would. */
static void stop_until_the_last_swing(unsigned stance)
{
    setUp();
    step_until_us(3000000u);
    while (plan.support != stance) {
        step();
    }
    stops_us = input.time_us;
    while (!(plan.landing_m.x <= 0.0f) || intent.role[swing_side()] != SADDLE_LEG_TRAILS) {
        step();
    }
}

static void test_the_last_swing_waits_while_the_xcom_would_fall_out_or_past_it(void)
{
    const float errors_m[] = {0.0f, 0.12f, -0.12f};
    for (unsigned stance = 0; stance < 2u; stance++) {
        for (size_t i = 0; i < COUNT_OF(errors_m); i++) {
            stop_until_the_last_swing(stance);
            xcom_error_m.y = errors_m[i];
            for (unsigned n = 0; n < 20u; n++) {
                pose();
                estimate.load_n[swing_side()] = 0.0f; /* which the last swing does not lift by */
                stay();
            }
            const bool waits = intent.role[swing_side()] == SADDLE_LEG_STANDS;
            TEST_ASSERT_EQUAL(i != 0u, waits);
            TEST_ASSERT_TRUE(!waits || intent.trailing_share_max == 1.0f);
        }
    }
}

/* ---- swings --------------------------------------------------------------------------------- */

static void test_a_swing_ends_where_the_plan_has_it(void)
{
    step_until_us(3000000u);
    for (unsigned n = 0; n < 4; n++) {
        step_into_a_swing(0u);
        const unsigned side = swing_side();
        while (plan.time_to_toe_off_s > 0.005f) {
            step();
            TEST_ASSERT_EQUAL(SADDLE_LEG_SWINGS, intent.role[side]);
        }
        const saddle_vec3_t at = reference_m(side);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, (double)plan.landing_m.x, (double)at.x); /* 5 ms to go */
        TEST_ASSERT_DOUBLE_WITHIN(0.002, (double)plan.landing_m.y, (double)at.y);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, (double)at.z);
    }
}

static void test_rates_are_those_of_the_angles(void)
{
    step_until_us(3000000u);
    step_into_a_swing(20u);
    const unsigned side = swing_side();
    for (unsigned n = 0; n < 200; n++) {
        const saddle_intent_t before = intent;
        step();
        for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
            const double moved = (double)intent.joints.angle_rad[side][joint] -
                                 (double)before.joints.angle_rad[side][joint];
            const double mean = 0.5 * ((double)intent.joints.rate_rad_s[side][joint] +
                                       (double)before.joints.rate_rad_s[side][joint]);
            /* the puppet's hips turn with the reference, but their velocity is left out */
            TEST_ASSERT_DOUBLE_WITHIN(0.004, moved, 1e-3 * mean);
        }
    }
}

static void test_the_landing_follows_an_error_of_the_xcom_until_shortly_before_it(void)
{
    saddle_vec3_t straight[2];
    for (unsigned n = 0; n < 2; n++) {
        setUp();
        step_until_us(3000000u);
        step_into_a_swing(0u);
        while (plan.time_to_toe_off_s > 0.005f) {
            const bool early = plan.time_to_toe_off_s > 0.061f;
            xcom_error_m.y = n == 1 ? (early ? 0.02f : -0.05f) : 0.0f; /* later is too late */
            step();
        }
        straight[n] = reference_m(swing_side());
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.004, 1.5 * 0.02, (double)(straight[1].y - straight[0].y));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, (double)(straight[1].x - straight[0].x));
}

static void test_in_need_the_foot_goes_to_the_recovery_step(void)
{
    step_until_us(3000000u);
    step_into_a_swing(0u);
    const saddle_vec3_t stance = plan.foot_m[plan.support];
    while (plan.time_to_toe_off_s > 0.005f) {
        step();
        output.verdict.recovery = (saddle_recovery_t){
            true, false, (uint8_t)swing_side(), {0.4f, plan.landing_m.y - stance.y + 0.2f}, 0.1f};
        output.verdict.xcom_deviation_m = (saddle_vec2_t){0.0f, 0.08f};
    }
    const saddle_vec3_t at = reference_m(swing_side());
    TEST_ASSERT_DOUBLE_WITHIN(0.01, (double)stance.x + 0.4, (double)at.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, (double)plan.landing_m.y + 0.2, (double)at.y);
}

/* Where a swing lands under a verdict that is changed by `change`. */
static saddle_vec3_t landing_under(void (*change)(saddle_verdict_t *changed, unsigned swing))
{
    setUp();
    step_until_us(3000000u);
    step_into_a_swing(0u);
    while (plan.time_to_toe_off_s > 0.005f) {
        move_puppet();
        output.verdict.recovery.found = false;
        change(&output.verdict, swing_side());
        update();
    }
    return reference_m(swing_side());
}

static void no_recovery(saddle_verdict_t *changed, unsigned swing)
{
    (void)changed;
    (void)swing;
}

static void no_verdict(saddle_verdict_t *changed, unsigned swing)
{
    (void)changed;
    (void)swing;
    verdict = NULL;
}

static void recovery_at(saddle_verdict_t *changed, unsigned foot, float along_m, float across_m)
{
    const saddle_vec3_t stance = plan.foot_m[plan.support];
    const saddle_vec2_t landing_m = {plan.landing_m.x - stance.x + along_m,
                                     plan.landing_m.y - stance.y + across_m};
    changed->recovery = (saddle_recovery_t){true, false, (uint8_t)foot, landing_m, 0.1f};
    changed->xcom_deviation_m = (saddle_vec2_t){0.14f, 0.0f};
}

static void of_the_other_foot(saddle_verdict_t *changed, unsigned swing)
{
    recovery_at(changed, 1u - swing, 0.0f, 0.2f);
}

static void nearby(saddle_verdict_t *changed, unsigned swing)
{
    recovery_at(changed, swing, 0.5f * config.nearby_along_m, 0.5f * config.nearby_across_m);
}

static void without_need(saddle_verdict_t *changed, unsigned swing)
{
    recovery_at(changed, swing, 0.0f, 0.2f);
    changed->xcom_deviation_m = (saddle_vec2_t){0.0f, 0.0f};
}

static void ahead(saddle_verdict_t *changed, unsigned swing)
{
    recovery_at(changed, swing, 0.1f, 0.0f);
}

static void test_the_recovery_step_is_taken_in_need_only(void)
{
    void (*const ignored[])(saddle_verdict_t *, unsigned) = {no_verdict, of_the_other_foot, nearby,
                                                             without_need};
    const saddle_vec3_t planned = landing_under(no_recovery);
    for (size_t i = 0; i < COUNT_OF(ignored); i++) {
        const saddle_vec3_t at = landing_under(ignored[i]);
        TEST_ASSERT_EQUAL_MEMORY(&planned, &at, sizeof at);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1, (double)(landing_under(ahead).x - planned.x));
}

static void test_a_foot_that_has_not_landed_reaches_down(void)
{
    step_until_us(3000000u);
    step_into_a_swing(300u);
    const unsigned side = swing_side();
    while (swing_side() == side) {
        step();
    }
    light = 0.0f; /* the ground is lower there */
    float lowest_m = 1.0f;
    for (unsigned n = 0; n < 200; n++) {
        step();
        TEST_ASSERT_EQUAL(SADDLE_LEG_SWINGS, intent.role[side]);
        TEST_ASSERT_TRUE(intent.role[1u - side] != SADDLE_LEG_SWINGS); /* which waits */
        const float height_m = walk.swing[side].position_m.z;
        lowest_m = height_m < lowest_m ? height_m : lowest_m;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -0.04, (double)lowest_m);
    light = 1.0f;
    step();
    TEST_ASSERT_TRUE(intent.role[side] != SADDLE_LEG_SWINGS);
}

static void test_a_foot_that_carries_early_has_landed(void)
{
    step_until_us(3000000u);
    step_into_a_swing(0u);
    const unsigned side = swing_side();
    while (plan.time_to_toe_off_s > 0.1f) {
        step();
    }
    TEST_ASSERT_EQUAL(SADDLE_LEG_SWINGS, intent.role[side]);
    estimate.load_n[side] = 61.0f;
    stay();
    TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[side]);
    TEST_ASSERT_EQUAL(side, intent.leading);
    for (unsigned n = 0; n < 300u; n++) { /* the plan is late, and the foot no trailing one */
        estimate.load_n[side] = 0.0f;
        stay();
        TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[side]);
    }
}

static void test_a_foot_that_is_due_lands_even_if_the_plan_has_not_gone_on(void)
{
    step_until_us(3000000u);
    step_into_a_swing(300u);
    const unsigned side = swing_side();
    plan.time_to_toe_off_s = 0.0f;
    stay();
    TEST_ASSERT_EQUAL(side, intent.leading);
    stay(); /* and stands though it is due */
    TEST_ASSERT_EQUAL(side, intent.leading);
}

static void test_the_first_swing_touches_the_ground_without_landing(void)
{
    step_until_us(STANDS_US);
    while (intent.role[swing_side()] != SADDLE_LEG_SWINGS) {
        step();
    }
    const unsigned side = swing_side();
    while (plan.time_to_toe_off_s > 0.1f) {
        step();
    }
    estimate.load_n[side] = 61.0f;
    stay();
    TEST_ASSERT_EQUAL(SADDLE_LEG_SWINGS, intent.role[side]);
    TEST_ASSERT_EQUAL(1u - side, intent.leading);
}

static void test_a_foot_on_its_toe_is_put_down_by_the_plan_not_at_once(void)
{
    step_until_us(3000000u);
    while (intent.role[swing_side()] != SADDLE_LEG_TRAILS ||
           plan.foot_pitch_rad[swing_side()] < 0.1f) {
        step();
    }
    const unsigned side = swing_side();
    estimate.body.foot[side].axes.x = (saddle_vec3_t){0.995f, 0.0f, -0.1f};
    estimate.body.foot[side].axes.z = (saddle_vec3_t){0.1f, 0.0f, 0.995f};
    plan.speed_m_s = 0.0f; /* both feet stand now */
    stay();
    TEST_ASSERT_EQUAL(SADDLE_LEG_TRAILS, intent.role[side]);
    plan.valid = false; /* nor does anybody know how it is to be tilted */
    stay();
    TEST_ASSERT_EQUAL(SADDLE_LEG_TRAILS, intent.role[side]);
    estimate.body.foot[side].axes = WORLD; /* its heel is down */
    stay();
    TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[side]);
}

static void test_a_change_of_role_is_no_jump(void)
{
    step_until_us(3000000u);
    while (input.time_us < 6000000u) {
        const saddle_intent_t before = intent;
        step();
        for (unsigned i = 0; i < 12u; i++) {
            const double moved = (double)intent.joints.angle_rad[i / 6u][i % 6u] -
                                 (double)before.joints.angle_rad[i / 6u][i % 6u];
            TEST_ASSERT_DOUBLE_WITHIN(0.015, 0.0, moved); /* 15 rad/s, what a joint may turn */
        }
    }
}

/* ---- nothing to go by ----------------------------------------------------------------------- */

static bool falls_back(void)
{
    const saddle_drive_config_t drive = saddle_drive_default();
    saddle_joint_commands_t commands;
    saddle_joint_commands(&legs, &drive, &estimate, &intent, &commands);
    return commands.fallback;
}

static void test_an_absurd_estimate_falls_back_and_leaves_nothing_behind(void)
{
    step_until_us(3300000u);
    const float absurd[] = {NAN, INFINITY, 1e30f};
    for (size_t n = 0; n < COUNT_OF(absurd); n++) {
        TEST_ASSERT_FALSE(falls_back());
        estimate.body.com.position_m.z = absurd[n];
        estimate.body.com.velocity_m_s.y = absurd[n];
        estimate.body.foot[0].sole_m.x = estimate.body.foot[1].sole_m.x = absurd[n];
        input.time_us += STEP_US;
        update();
        pose();
        TEST_ASSERT_TRUE(falls_back());
        step(); /* starts anew */
        step();
    }
    step_until_us(3600000u);
    TEST_ASSERT_FALSE(falls_back());
}

static void test_after_a_gap_it_starts_anew(void)
{
    step_until_us(3000000u);
    step_into_a_swing(50u);
    input.time_us += 60000u;
    update();
    TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[0]);
    TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[1]);
    step_into_a_swing(50u);
    update(); /* nor is there a time in which a rate could change */
    TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[0]);
    TEST_ASSERT_EQUAL(SADDLE_LEG_STANDS, intent.role[1]);
}

static void test_before_its_start_it_has_no_intent(void)
{
    const saddle_joint_walk_input_t at = {0u, NULL, NULL};
    memset(&walk, 0, sizeof walk);
    pose();
    TEST_ASSERT_EQUAL(SADDLE_ERROR_UNINITIALISED,
                      saddle_joint_walk_update(&walk, &at, &estimate, &intent));
    TEST_ASSERT_TRUE(falls_back());
    config.fade_s = 0.0f;
    TEST_ASSERT_EQUAL(SADDLE_ERROR_CONFIG, saddle_joint_walk_init(&walk, &legs, &config));
    TEST_ASSERT_EQUAL(SADDLE_ERROR_UNINITIALISED,
                      saddle_joint_walk_update(&walk, &at, &estimate, &intent));
    config = saddle_joint_walk_default();
    legs.thigh_m = -1.0f;
    TEST_ASSERT_EQUAL(SADDLE_ERROR_CONFIG, saddle_joint_walk_init(&walk, &legs, &config));
}

#if !defined SADDLE_EMULATED && defined FE_UPWARD
static void test_another_rounding_mode_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(0, fesetround(FE_UPWARD));
    const saddle_status_t status = saddle_joint_walk_init(&walk, &legs, &config);
    fesetround(FE_TONEAREST);
    TEST_ASSERT_EQUAL(SADDLE_ERROR_BUILD, status);
}
#endif

static void test_each_gain_out_of_its_range_is_named(void)
{
    const saddle_config_field_t *field;
    size_t count = 0;
    TEST_ASSERT_NULL(saddle_joint_walk_check(&config));
    for (; (field = saddle_joint_walk_field(count)) != NULL; count++) {
        const float bad[] = {field->min - 0.1f, field->max * 1.01f, NAN};
        for (size_t i = 0; i < COUNT_OF(bad); i++) {
            saddle_joint_walk_config_t wrong = config;
            memcpy((char *)&wrong + field->offset, &bad[i], sizeof(float));
            TEST_ASSERT_EQUAL_STRING(field->name, saddle_joint_walk_check(&wrong));
        }
        TEST_ASSERT_EQUAL_size_t(count * sizeof(float), field->offset);
    }
    TEST_ASSERT_EQUAL_size_t(sizeof config, count * sizeof(float));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_who_stands_stands_on_both_feet);
    RUN_TEST(test_without_a_plan_the_cop_goes_between_the_feet);
    RUN_TEST(test_legs_do_what_the_plan_has_them_for);
    RUN_TEST(test_a_foot_that_carries_nothing_lifts_before_its_time);
    RUN_TEST(test_a_walk_that_stops_ends_side_by_side);
    RUN_TEST(test_the_last_swing_waits_while_the_xcom_would_fall_out_or_past_it);
    RUN_TEST(test_a_swing_ends_where_the_plan_has_it);
    RUN_TEST(test_rates_are_those_of_the_angles);
    RUN_TEST(test_the_landing_follows_an_error_of_the_xcom_until_shortly_before_it);
    RUN_TEST(test_in_need_the_foot_goes_to_the_recovery_step);
    RUN_TEST(test_the_recovery_step_is_taken_in_need_only);
    RUN_TEST(test_a_foot_that_has_not_landed_reaches_down);
    RUN_TEST(test_a_foot_that_carries_early_has_landed);
    RUN_TEST(test_a_foot_that_is_due_lands_even_if_the_plan_has_not_gone_on);
    RUN_TEST(test_the_first_swing_touches_the_ground_without_landing);
    RUN_TEST(test_a_foot_on_its_toe_is_put_down_by_the_plan_not_at_once);
    RUN_TEST(test_a_change_of_role_is_no_jump);
    RUN_TEST(test_an_absurd_estimate_falls_back_and_leaves_nothing_behind);
    RUN_TEST(test_after_a_gap_it_starts_anew);
    RUN_TEST(test_before_its_start_it_has_no_intent);
#if !defined SADDLE_EMULATED && defined FE_UPWARD
    RUN_TEST(test_another_rounding_mode_is_refused);
#endif
    RUN_TEST(test_each_gain_out_of_its_range_is_named);
    return UNITY_END();
}
