/** Where a foot can be put to catch the XCoM, against a search over all places, and what moving the
 *  CoP can correct until then. */
#include "balance_twin.h"

#include "balance/expected_step.h"
#include "balance/recovery_step.h"
#include "math/vec2.h"

#define STEP_TIME_S 0.55f

/* Metres: places up to 2 m, a growth of up to 6. */
static const double PLACE_TOLERANCE = 2e-6;

static saddle_config_t config;
static saddle_body_t body;

void setUp(void)
{
    config = paper_config();
    config.bos_factor = 1.0f;
    config.prediction_horizon_s = 0.5f;
    config.recovery_width_min_m = 0.05f;
    config.recovery_width_max_m = 0.45f;
    config.recovery_margin_m = 0.0f;
    config.recovery_follow = 0.0f;
    body = model_of(&config)->body;
}

void tearDown(void) {}

static saddle_recovery_t recovery_from(const saddle_recovery_target_t *target)
{
    saddle_recovery_t recovery;
    memset(&recovery, 0xFF, sizeof recovery);
    saddle_recovery_step(model_of(&config), target, &recovery);
    return recovery;
}

/* ---- what the model page says of a landing ------------------------------------------------- */

typedef struct {
    double min_x, max_x, min_y, max_y; /* y outward from the stance foot */
} places_t;

static double reach(void)
{
    return 3.0 / FREQUENCY;
}

/* The XCoM ahead of the new CoP that steps of full reach sustain. */
static double sustained(double step_time_s)
{
    return reach() / (exp(FREQUENCY * step_time_s) - 1.0);
}

/* How far behind the new CoP the XCoM may be: as planned, or d_h. */
static double heel(const saddle_recovery_target_t *target)
{
    return fmax((double)config.cop_range_m, (double)target->landing_m.x - (double)target->xcom_m.x);
}

static double outward_of(saddle_side_t stance)
{
    return stance == SADDLE_LEFT ? -1.0 : 1.0;
}

static places_t places(const saddle_recovery_target_t *target)
{
    const double step_s = (double)target->step_time_s;
    const double quick_s = fmin(step_s, (double)config.prediction_horizon_s);
    const double x = (double)target->xcom_m.x + (double)target->departure_m.x;
    const double y =
        outward_of(target->stance) * ((double)target->xcom_m.y + (double)target->departure_m.y);
    return (places_t){
        .min_x = fmax(-reach(), x - sustained(step_s)),
        .max_x = fmin(reach(), x + heel(target)),
        .min_y = fmax((double)config.recovery_width_min_m, y + (double)config.recovery_margin_m),
        .max_y = fmin((double)config.recovery_width_max_m,
                      y + (double)config.recovery_width_max_m / exp(FREQUENCY * quick_s)),
    };
}

/* The planned walk on a left stance foot at a speed: landing, XCoM then, step time. */
static saddle_recovery_target_t planned_walk(double v)
{
    const double half = 0.1802 * v + 0.1351;
    const double width = v < 0.6 ? 0.22 : v > 1.1 ? 0.10 : -0.2128 * v + 0.3456;
    const double amplitude = fmin(width / (2.0 * PI * v), width / PI);
    const double vy = amplitude * 0.5 * PI / half * v;
    return (saddle_recovery_target_t){
        .stance = SADDLE_LEFT,
        .landing_m = {(float)(2.0 * half), (float)-width},
        .xcom_m = {(float)(half + v / FREQUENCY), (float)(-0.5 * width - vy / FREQUENCY)},
        .step_time_s = (float)(2.0 * half / v),
    };
}

static saddle_recovery_target_t mirrored(saddle_recovery_target_t target)
{
    target.stance = saddle_other_side(target.stance);
    target.landing_m.y = -target.landing_m.y;
    target.xcom_m.y = -target.xcom_m.y;
    target.departure_m.y = -target.departure_m.y;
    return target;
}

static saddle_recovery_target_t random_catch(uint32_t *state)
{
    const saddle_recovery_target_t left = {
        .stance = SADDLE_LEFT,
        .landing_m = {random_in(state, 0.0f, 0.9f), random_in(state, -0.3f, -0.05f)},
        .xcom_m = {random_in(state, 0.2f, 0.9f), random_in(state, -0.2f, 0.0f)},
        .departure_m = {random_in(state, -1.6f, 0.8f), random_in(state, -0.5f, 0.3f)},
        .step_time_s = random_in(state, 0.3f, 1.2f),
    };
    return random_bits(state) % 2u == 0u ? left : mirrored(left);
}

/* ---- the planned walk ---------------------------------------------------------------------- */

/* Below 0.245 m/s the XCoM lags the planned landing by more than d_h: that is no departure. */
static void test_planned_walk_lands_where_it_is_planned_at_every_speed(void)
{
    config.prediction_horizon_s = 0.4f;
    config.recovery_width_max_m = 0.5f;
    for (double v = 0.05; v < 1.93; v += 0.01) {
        const saddle_recovery_target_t left = planned_walk(v);
        const saddle_recovery_target_t sides[] = {left, mirrored(left)};
        for (size_t i = 0; i < COUNT_OF(sides); i++) {
            const saddle_recovery_t recovery = recovery_from(&sides[i]);
            TEST_ASSERT_TRUE(recovery.found);
            TEST_ASSERT_TRUE(recovery.margin_m > 0.0f);
            TEST_ASSERT_EQUAL_UINT8(saddle_other_side(sides[i].stance), recovery.foot);
            TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, sides[i].landing_m.x, recovery.landing_m.x);
            ASSERT_SAME_FLOAT(sides[i].landing_m.y, recovery.landing_m.y);
        }
    }
}

/* The model page: at 1.9 m/s the planned walk needs 0.83 m of the 0.97 m reach. */
static void test_fast_walk_has_the_documented_remaining_reach(void)
{
    saddle_recovery_target_t target = planned_walk(1.9);
    const places_t free = places(&target);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.83, free.min_x);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.97, reach());
    target.landing_m.x = 0.0f;
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, free.min_x, recovery_from(&target).landing_m.x);
}

/* ---- one direction at a time --------------------------------------------------------------- */

/* The foot follows an XCoM that departs ever further as little as it must, until it gives up. */
static void test_xcom_that_runs_ahead_pulls_the_landing_to_the_end_of_the_reach(void)
{
    saddle_recovery_target_t target = {.stance = SADDLE_LEFT,
                                       .landing_m = {0.6f, -0.12f},
                                       .xcom_m = {0.6f, -0.06f},
                                       .step_time_s = STEP_TIME_S};
    const double ahead = sustained((double)STEP_TIME_S);
    for (int mm = 0; mm < 1000; mm++) {
        target.departure_m.x = 1e-3f * (float)mm;
        const double xcom = 0.6 + 1e-3 * mm;
        const saddle_recovery_t recovery = recovery_from(&target);
        TEST_ASSERT_EQUAL(xcom - ahead <= reach(), recovery.found);
        if (recovery.found) {
            TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, fmax(0.6, xcom - ahead),
                                      recovery.landing_m.x);
            ASSERT_SAME_FLOAT(-0.12f, recovery.landing_m.y);
        }
    }
}

static void test_xcom_that_falls_behind_pulls_the_landing_back_to_the_end_of_the_reach(void)
{
    saddle_recovery_target_t target = {.stance = SADDLE_RIGHT,
                                       .landing_m = {0.6f, 0.12f},
                                       .xcom_m = {0.6f, 0.06f},
                                       .step_time_s = STEP_TIME_S};
    for (int mm = 0; mm < 2000; mm++) {
        target.departure_m.x = -1e-3f * (float)mm;
        const double heel = 0.6 - 1e-3 * mm + 0.1; /* the XCoM over the heel of the new foot */
        const saddle_recovery_t recovery = recovery_from(&target);
        TEST_ASSERT_EQUAL(heel >= -reach(), recovery.found);
        if (recovery.found) {
            TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, fmin(0.6, heel), recovery.landing_m.x);
        }
    }
}

/* Outward the step must go beyond the XCoM, up to the widest; over the stance foot it would have to
 * cross. */
static void test_xcom_that_goes_aside_widens_the_step_or_narrows_it(void)
{
    const double stance_side = 0.45 / exp(FREQUENCY * 0.5);
    for (int side = 0; side < 2; side++) {
        saddle_recovery_target_t target = {.stance = SADDLE_LEFT,
                                           .landing_m = {0.6f, -0.25f},
                                           .xcom_m = {0.7f, -0.06f},
                                           .step_time_s = STEP_TIME_S};
        target = side == 0 ? target : mirrored(target);
        const double outward = outward_of(target.stance);
        for (int mm = -600; mm < 600; mm++) {
            target.departure_m.y = (float)(1e-3 * outward * mm);
            const double xcom = 0.06 + 1e-3 * mm;
            const saddle_recovery_t recovery = recovery_from(&target);
            const bool reached = xcom <= 0.45 && xcom + stance_side >= 0.05;
            if (fabs(xcom - 0.45) > 1e-6 && fabs(xcom + stance_side - 0.05) > 1e-6) {
                TEST_ASSERT_EQUAL(reached, recovery.found);
            }
            if (recovery.found) {
                const double widest = fmin(0.45, xcom + stance_side);
                const double landing = fmin(fmax(0.25, xcom), widest);
                TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, outward * landing, recovery.landing_m.y);
            }
        }
    }
}

/* ---- against a search ---------------------------------------------------------------------- */

/* The model page's conditions on a place, without intervals. */
static bool catches(const saddle_recovery_target_t *target, double x, double outward_y)
{
    const double step_s = (double)target->step_time_s;
    const double quick_s = fmin(step_s, (double)config.prediction_horizon_s);
    const double ahead = (double)target->xcom_m.x + (double)target->departure_m.x - x;
    const double aside = outward_y - outward_of(target->stance) *
                                         ((double)target->xcom_m.y + (double)target->departure_m.y);
    return fabs(x) <= reach() && ahead <= sustained(step_s) && ahead >= -heel(target) &&
           outward_y >= (double)config.recovery_width_min_m &&
           outward_y <= (double)config.recovery_width_max_m &&
           aside >= (double)config.recovery_margin_m &&
           aside * exp(FREQUENCY * quick_s) <= (double)config.recovery_width_max_m;
}

typedef struct {
    bool found;
    double x, y; /* nearest to the wanted place on either axis */
} search_t;

/* Over a grid, where the conditions on x and y do not depend on each other. */
#define GRID_M 2e-3

static search_t search(const saddle_recovery_target_t *target, double wanted_x,
                       double wanted_outward_y)
{
    search_t best = {.found = false, .x = HUGE_VAL, .y = HUGE_VAL};
    const places_t free = places(target);
    const double some_x = 0.5 * (free.min_x + free.max_x);
    const double some_y = 0.5 * (free.min_y + free.max_y);
    bool found_x = false;
    bool found_y = false;
    for (int i = -500; i <= 500; i++) {
        const double at = GRID_M * i;
        if (catches(target, at, some_y) && fabs(at - wanted_x) < fabs(best.x - wanted_x)) {
            best.x = at;
            found_x = true;
        }
        if (catches(target, some_x, at) &&
            fabs(at - wanted_outward_y) < fabs(best.y - wanted_outward_y)) {
            best.y = at;
            found_y = true;
        }
    }
    best.found = found_x && found_y;
    return best;
}

static void test_landing_is_the_nearest_sufficient_place(void)
{
    uint32_t state = 67;
    int found = 0;
    int none = 0;
    for (int i = 0; i < MANY(2000); i++) {
        config.recovery_follow = (float)(i % 3) * 0.5f;
        config.recovery_margin_m = random_in(&state, -0.05f, 0.05f);
        const saddle_recovery_target_t target = random_catch(&state);
        const saddle_recovery_t recovery = recovery_from(&target);
        const double outward = outward_of(target.stance);
        const double follow = (double)config.recovery_follow;
        const double wanted_x = (double)target.landing_m.x + follow * (double)target.departure_m.x;
        const double wanted_y =
            outward * ((double)target.landing_m.y + follow * (double)target.departure_m.y);
        const search_t best = search(&target, wanted_x, wanted_y);
        if (recovery.found && best.found) {
            found++;
            TEST_ASSERT_DOUBLE_WITHIN(GRID_M, best.x, recovery.landing_m.x);
            TEST_ASSERT_DOUBLE_WITHIN(GRID_M, best.y, outward * (double)recovery.landing_m.y);
        } else if ((double)fabsf(recovery.margin_m) > GRID_M) {
            TEST_ASSERT_FALSE(recovery.found || best.found);
            none++;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(MANY(300), found);
    TEST_ASSERT_GREATER_THAN_INT(MANY(300), none);
}

/* ---- margin -------------------------------------------------------------------------------- */

static void test_margin_is_the_room_left_on_the_scarcer_axis(void)
{
    uint32_t state = 71;
    for (int i = 0; i < MANY(5000); i++) {
        const saddle_recovery_target_t target = random_catch(&state);
        const places_t free = places(&target);
        const saddle_recovery_t recovery = recovery_from(&target);
        const double room = fmin(free.max_x - free.min_x, free.max_y - free.min_y);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, room, recovery.margin_m);
        TEST_ASSERT_EQUAL(recovery.margin_m >= 0.0f, recovery.found);
        if (!recovery.found) {
            TEST_ASSERT_FALSE(recovery.stops);
            TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, recovery.landing_m.x);
            TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, recovery.landing_m.y);
        }
    }
}

/* In no time nothing grows, and no place is too near to sustain the XCoM: the reach alone counts. */
static void test_step_without_time_has_the_whole_reach_behind_the_xcom(void)
{
    saddle_recovery_target_t target = planned_walk(1.2);
    target.step_time_s = 0.0f;
    target.departure_m.x = -0.5f;
    const saddle_recovery_t recovery = recovery_from(&target);
    const double xcom_m = (double)target.xcom_m.x - 0.5;
    TEST_ASSERT_TRUE(recovery.found);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, xcom_m + heel(&target), recovery.landing_m.x);
    config.recovery_width_max_m = 3.0f; /* so that the scarcer axis is the sagittal one */
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, reach() + xcom_m + heel(&target),
                              recovery_from(&target).margin_m);
}

/* No jump on any way through the departures: a millimetre of them is at most one of margin. */
static void test_margin_is_continuous(void)
{
    uint32_t state = 73;
    int changes = 0;
    for (int i = 0; i < MANY(300); i++) {
        saddle_recovery_target_t target = random_catch(&state);
        const double angle = (double)random_in(&state, 0.0f, 6.28f);
        bool was_found = false;
        double before = 0.0;
        for (int mm = 0; mm < 1500; mm++) {
            target.departure_m.x = (float)(1e-3 * mm * cos(angle));
            target.departure_m.y = (float)(1e-3 * mm * sin(angle));
            const saddle_recovery_t recovery = recovery_from(&target);
            const double margin = (double)recovery.margin_m;
            if (mm > 0) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-3 + PLACE_TOLERANCE, before, margin);
                if (was_found != recovery.found) {
                    TEST_ASSERT_DOUBLE_WITHIN(1e-3 + PLACE_TOLERANCE, 0.0, margin);
                    changes++;
                }
            }
            before = margin;
            was_found = recovery.found;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(MANY(100), changes);
}

/* ---- settings ------------------------------------------------------------------------------ */

/* 0: the nearest place to the planned one; 1: as far off it as the XCoM is off its own. */
static void test_landing_follows_the_departure_by_its_share(void)
{
    saddle_recovery_target_t target = {.stance = SADDLE_LEFT,
                                       .landing_m = {0.5f, -0.2f},
                                       .xcom_m = {0.6f, -0.15f},
                                       .departure_m = {0.08f, -0.03f},
                                       .step_time_s = STEP_TIME_S};
    const float shares[] = {0.0f, 0.25f, 1.0f};
    for (size_t i = 0; i < COUNT_OF(shares); i++) {
        config.recovery_follow = shares[i];
        const saddle_recovery_t recovery = recovery_from(&target);
        TEST_ASSERT_TRUE(recovery.found);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.5 + 0.08 * (double)shares[i],
                                  recovery.landing_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, -0.2 - 0.03 * (double)shares[i],
                                  recovery.landing_m.y);
    }
    target.departure_m.x = 0.55f; /* no further than it reaches */
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, reach(), recovery_from(&target).landing_m.x);
}

/* [E45] */
static void test_placement_moves_the_landing_within_the_same_bounds(void)
{
    saddle_recovery_target_t target = {.stance = SADDLE_LEFT,
                                       .landing_m = {0.5f, -0.2f},
                                       .xcom_m = {0.6f, -0.15f},
                                       .departure_m = {0.08f, -0.03f},
                                       .step_time_s = STEP_TIME_S};
    const saddle_recovery_t followed = recovery_from(&target);
    target.placement_m = (saddle_vec2_t){0.04f, -0.02f};
    const saddle_recovery_t placed = recovery_from(&target);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, (double)followed.landing_m.x + 0.04,
                              placed.landing_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, (double)followed.landing_m.y - 0.02,
                              placed.landing_m.y);
    ASSERT_SAME_FLOAT(followed.margin_m, placed.margin_m);
    target.placement_m.x = 1.0f; /* the heel no further ahead of the XCoM */
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.6 + 0.08 + heel(&target),
                              recovery_from(&target).landing_m.x);
}

static void test_share_that_is_followed_changes_neither_margin_nor_decision(void)
{
    uint32_t state = 79;
    for (int i = 0; i < MANY(1000); i++) {
        const saddle_recovery_target_t target = random_catch(&state);
        config.recovery_follow = 0.0f;
        const saddle_recovery_t nearest = recovery_from(&target);
        config.recovery_follow = 1.0f;
        const saddle_recovery_t followed = recovery_from(&target);
        TEST_ASSERT_EQUAL(nearest.found, followed.found);
        ASSERT_SAME_FLOAT(nearest.margin_m, followed.margin_m);
    }
}

static void test_margin_of_the_configuration_keeps_the_xcom_inside_the_foot(void)
{
    const saddle_recovery_target_t target = {.stance = SADDLE_RIGHT,
                                             .landing_m = {0.6f, 0.1f},
                                             .xcom_m = {0.7f, 0.15f},
                                             .step_time_s = STEP_TIME_S};
    const float margins[] = {-0.03f, 0.0f, 0.04f};
    for (size_t i = 0; i < COUNT_OF(margins); i++) {
        config.recovery_margin_m = margins[i];
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.15 + (double)margins[i],
                                  recovery_from(&target).landing_m.y);
    }
}

/* ---- stops --------------------------------------------------------------------------------- */

static void test_step_stops_where_the_xcom_lies_in_the_base_of_its_posture(void)
{
    uint32_t state = 83;
    int stops = 0;
    int found = 0;
    for (int i = 0; i < MANY(5000); i++) {
        config.bos_factor = i % 2 == 0 ? 1.0f : 0.6f;
        const saddle_recovery_target_t target = random_catch(&state);
        const saddle_recovery_t recovery = recovery_from(&target);
        if (!recovery.found) {
            continue;
        }
        const point_t stance = {0.0, 0.0};
        const point_t landing = point_of(recovery.landing_m);
        const bool left = recovery.foot == (uint8_t)SADDLE_LEFT;
        const twin_base_t base = twin_base(left ? landing : stance, left ? stance : landing, 0.1,
                                           (double)config.bos_factor);
        const double margin =
            twin_margin(&base, (point_t){(double)target.xcom_m.x + (double)target.departure_m.x,
                                         (double)target.xcom_m.y + (double)target.departure_m.y});
        if (fabs(margin) > PLACE_TOLERANCE) {
            TEST_ASSERT_EQUAL(margin > 0.0, recovery.stops);
        }
        found++;
        stops += recovery.stops ? 1 : 0;
    }
    TEST_ASSERT_TRUE(stops > MANY(100) && stops < found - MANY(100));
}

/* ---- what moving the CoP corrects ---------------------------------------------------------- */

/* xi' = w (xi - u): the CoP as far towards the deviation as it can be, in small steps. */
static double corrected_by_simulation(double xi, double foot, double trailing, double time_s)
{
    const int steps = 20000;
    const double h = time_s / steps;
    const double side = xi < 0.0 ? -1.0 : 1.0;
    const double beside = xi * trailing > 0.0 ? fabs(trailing) : 0.0;
    for (int i = 0; i < steps; i++) {
        const double u = side * (foot + ((i + 0.5) * h < 0.1 ? beside : 0.0));
        xi = (xi - u) * exp(FREQUENCY * h) + u;
    }
    return side * xi < 0.0 ? 0.0 : xi; /* whoever can do more than needed does what is needed */
}

static float least_after(float deviation_m, saddle_cop_shift_t shift, float time_s)
{
    const saddle_growth_t growth =
        saddle_growth(model_of(&config), time_s, shift.trailing_m != 0.0f);
    return saddle_least_deviation_m(deviation_m, shift, &growth);
}

static void test_least_deviation_is_that_with_the_best_cop(void)
{
    uint32_t state = 89;
    int corrected = 0;
    for (int i = 0; i < MANY(300); i++) {
        const float deviation = random_in(&state, -0.3f, 0.3f);
        const float time_s = random_in(&state, 0.0f, 0.6f);
        const saddle_cop_shift_t shift = {.foot_m = random_in(&state, 0.0f, 0.1f),
                                          .trailing_m =
                                              i % 3 == 0 ? 0.0f : random_in(&state, -0.5f, 0.5f)};
        const double expected = corrected_by_simulation((double)deviation, (double)shift.foot_m,
                                                        (double)shift.trailing_m, (double)time_s);
        const double least = (double)least_after(deviation, shift, time_s);
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, expected, least); /* of up to 1.9 m; in steps of 30 us */
        corrected += expected == 0.0 ? 1 : 0;
    }
    TEST_ASSERT_TRUE(corrected > MANY(50) && corrected < MANY(200));
}

static void test_without_a_shift_a_deviation_grows_freely(void)
{
    const saddle_cop_shift_t none = {.foot_m = 0.0f, .trailing_m = 0.0f};
    for (int i = 0; i <= 10; i++) {
        const float time_s = 0.06f * (float)i;
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, -0.2 * exp(FREQUENCY * (double)time_s),
                                  least_after(-0.2f, none, time_s));
    }
}

static void test_trailing_foot_corrects_only_deviations_towards_it(void)
{
    const saddle_cop_shift_t towards = {.foot_m = 0.02f, .trailing_m = 0.5f};
    const saddle_cop_shift_t away = {.foot_m = 0.02f, .trailing_m = -0.5f};
    const saddle_cop_shift_t lifted = {.foot_m = 0.02f, .trailing_m = 0.0f};
    TEST_ASSERT_TRUE(least_after(0.2f, towards, 0.4f) < least_after(0.2f, lifted, 0.4f));
    ASSERT_SAME_FLOAT(least_after(0.2f, lifted, 0.4f), least_after(0.2f, away, 0.4f));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_planned_walk_lands_where_it_is_planned_at_every_speed);
    RUN_TEST(test_fast_walk_has_the_documented_remaining_reach);
    RUN_TEST(test_xcom_that_runs_ahead_pulls_the_landing_to_the_end_of_the_reach);
    RUN_TEST(test_xcom_that_falls_behind_pulls_the_landing_back_to_the_end_of_the_reach);
    RUN_TEST(test_xcom_that_goes_aside_widens_the_step_or_narrows_it);
    RUN_TEST(test_landing_is_the_nearest_sufficient_place);
    RUN_TEST(test_margin_is_the_room_left_on_the_scarcer_axis);
    RUN_TEST(test_step_without_time_has_the_whole_reach_behind_the_xcom);
    RUN_TEST(test_margin_is_continuous);
    RUN_TEST(test_landing_follows_the_departure_by_its_share);
    RUN_TEST(test_placement_moves_the_landing_within_the_same_bounds);
    RUN_TEST(test_share_that_is_followed_changes_neither_margin_nor_decision);
    RUN_TEST(test_margin_of_the_configuration_keeps_the_xcom_inside_the_foot);
    RUN_TEST(test_step_stops_where_the_xcom_lies_in_the_base_of_its_posture);
    RUN_TEST(test_least_deviation_is_that_with_the_best_cop);
    RUN_TEST(test_without_a_shift_a_deviation_grows_freely);
    RUN_TEST(test_trailing_foot_corrects_only_deviations_towards_it);
    return UNITY_END();
}
