/** Base of support, margins, exit, polygon, energy surface and gravity: hand-made cases and brute
 *  force in double. */
#include "core_test.h"

#include "balance/saddle_space.h"

#define HALF_DEPTH_M 0.1f

/* Metres of margin: coordinates up to 2.5 m are rounded to 2.4e-7, a few times over. */
static const double MARGIN_TOLERANCE = 1e-6;

void setUp(void) {}

void tearDown(void) {}

/* Feet side by side, 2 r apart around the origin. */
static saddle_bos_t side_by_side(float radius)
{
    const saddle_vec2_t cop[2] = {{0.0f, radius}, {0.0f, -radius}};
    return saddle_bos(cop, HALF_DEPTH_M, 1.0f);
}

static void assert_margin(const saddle_bos_t *bos, double expected, double x, double y)
{
    for (int quadrant = 0; quadrant < 4; quadrant++) {
        const saddle_vec2_t point = {(float)((quadrant & 1) != 0 ? -x : x),
                                     (float)((quadrant & 2) != 0 ? -y : y)};
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, expected, saddle_bos_margin_m(bos, point));
    }
}

/* r = 0.3, d_h = 0.1: the corner lies at (0.1, sqrt 0.08). */
static void test_margins_of_each_region_by_hand(void)
{
    const saddle_bos_t bos = side_by_side(0.3f);
    const double corner = sqrt(0.08);
    assert_margin(&bos, 0.1, 0.0, 0.0);
    assert_margin(&bos, 0.01, 0.09, 0.0);                     /* edge, inside */
    assert_margin(&bos, 0.05, 0.0, 0.25);                     /* arc, inside */
    assert_margin(&bos, -0.1, 0.2, 0.0);                      /* edge, outside */
    assert_margin(&bos, -0.1, 0.2, 0.28);                     /* edge, just before the corner */
    assert_margin(&bos, -0.1, 0.0, 0.4);                      /* arc, outside */
    assert_margin(&bos, 0.3 - hypot(0.09, 0.31), 0.09, 0.31); /* arc, just before the corner */
    assert_margin(&bos, -0.05, 0.1 + 0.03, corner + 0.04);    /* corner: 3, 4, 5 */
    assert_margin(&bos, 0.0, 0.1, corner);
    assert_margin(&bos, 0.0, 0.1, 0.1);
    assert_margin(&bos, 0.0, 0.0, 0.3);
}

static void test_close_feet_make_the_plain_disc(void)
{
    const saddle_bos_t disc = side_by_side(0.05f);
    assert_margin(&disc, 0.05, 0.0, 0.0);
    assert_margin(&disc, 0.01, 0.04, 0.0);
    assert_margin(&disc, 0.05 - hypot(0.09, 0.02), 0.09, 0.02);
    const saddle_bos_t touching = side_by_side(0.1f);
    assert_margin(&touching, 0.1, 0.0, 0.0);
    assert_margin(&touching, -0.1, 0.2, 0.0);
    assert_margin(&touching, -0.1, 0.12, 0.16);
}

static void test_frame_follows_the_feet(void)
{
    /* Left foot 0.4 m ahead: y_S points forward and to the left, x_S forward and to the right. */
    const saddle_vec2_t cop[2] = {{1.4f, 0.2f}, {1.0f, -0.1f}};
    const saddle_bos_t bos = saddle_bos(cop, HALF_DEPTH_M, 1.0f);
    TEST_ASSERT_TRUE(bos.defined);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.2, bos.centre_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.05, bos.centre_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.25, bos.radius_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.6, bos.axis_x.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.8, bos.axis_x.y);
    ASSERT_SAME_FLOAT(HALF_DEPTH_M, bos.half_depth_m);
}

/* The border once more, in double: two arcs of many chords each, joined by the straight edges. */
#define ARC_POINTS 2000

typedef struct {
    double centre[2], x_axis[2], y_axis[2], radius, depth;
    double border[2 * ARC_POINTS][2];
} twin_t;

static void twin_build(twin_t *twin, const saddle_vec2_t cop[2], double factor)
{
    const double dx = (double)cop[0].x - (double)cop[1].x;
    const double dy = (double)cop[0].y - (double)cop[1].y;
    const double distance = hypot(dx, dy);
    twin->centre[0] = 0.5 * ((double)cop[0].x + (double)cop[1].x);
    twin->centre[1] = 0.5 * ((double)cop[0].y + (double)cop[1].y);
    twin->y_axis[0] = dx / distance;
    twin->y_axis[1] = dy / distance;
    twin->x_axis[0] = twin->y_axis[1];
    twin->x_axis[1] = -twin->y_axis[0];
    twin->radius = factor * 0.5 * distance;
    twin->depth = factor * (double)HALF_DEPTH_M;
    const double half = asin(fmin(1.0, twin->depth / twin->radius));
    for (int i = 0; i < ARC_POINTS; i++) {
        const double angle = half * (1.0 - 2.0 * i / (ARC_POINTS - 1));
        twin->border[i][0] = twin->radius * sin(angle);
        twin->border[i][1] = twin->radius * cos(angle);
        twin->border[i + ARC_POINTS][0] = -twin->border[i][0];
        twin->border[i + ARC_POINTS][1] = -twin->border[i][1];
    }
}

static double segment_distance(const double a[2], const double b[2], double x, double y)
{
    const double ux = b[0] - a[0];
    const double uy = b[1] - a[1];
    const double square = ux * ux + uy * uy;
    double share = square > 0.0 ? ((x - a[0]) * ux + (y - a[1]) * uy) / square : 0.0;
    share = fmin(1.0, fmax(0.0, share));
    return hypot(a[0] + share * ux - x, a[1] + share * uy - y);
}

static double twin_margin(const twin_t *twin, saddle_vec2_t point)
{
    const double dx = (double)point.x - twin->centre[0];
    const double dy = (double)point.y - twin->centre[1];
    const double x = dx * twin->x_axis[0] + dy * twin->x_axis[1];
    const double y = dx * twin->y_axis[0] + dy * twin->y_axis[1];
    const bool inside = hypot(x, y) <= twin->radius && fabs(x) <= twin->depth;
    double nearest = 1e9;
    for (int i = 0; i < 2 * ARC_POINTS; i++) {
        const int next = (i + 1) % (2 * ARC_POINTS);
        nearest = fmin(nearest, segment_distance(twin->border[i], twin->border[next], x, y));
    }
    return inside ? nearest : -nearest;
}

static saddle_vec2_t random_point(uint32_t *state, float reach)
{
    const saddle_vec2_t point = {random_in(state, -reach, reach), random_in(state, -reach, reach)};
    return point;
}

/* A chord of the twin's arcs lies at most r (pi/2000)^2 / 8 = 3e-7 r inside the arc. */
static void test_margin_equals_brute_force_for_random_postures(void)
{
    static twin_t twin;
    uint32_t state = 11;
    double worst = 0.0;
    for (int i = 0; i < MANY(1500); i++) {
        const float reach = (i & 1) != 0 ? 0.7f : 0.12f;
        const saddle_vec2_t cop[2] = {random_point(&state, reach), random_point(&state, reach)};
        const saddle_bos_t bos = saddle_bos(cop, HALF_DEPTH_M, 1.0f);
        if (!bos.defined) {
            continue;
        }
        twin_build(&twin, cop, 1.0);
        const saddle_vec2_t offset = random_point(&state, 1.5f * bos.radius_m + 0.05f);
        const saddle_vec2_t point = {bos.centre_m.x + offset.x, bos.centre_m.y + offset.y};
        const double core = (double)saddle_bos_margin_m(&bos, point);
        worst = fmax(worst, fabs(core - twin_margin(&twin, point)));
        TEST_ASSERT_TRUE(core == core);
        if (fabs(core) > MARGIN_TOLERANCE) { /* nearer to the border both are rounded */
            TEST_ASSERT_EQUAL(core > 0.0, saddle_bos_contains(&bos, point));
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(MARGIN_TOLERANCE, 0.0, worst);
}

/* Signed distance: continuous with slope at most 1, across every region's border. */
static void test_margin_is_continuous(void)
{
    uint32_t state = 5;
    const double step = 1e-3;
    for (int i = 0; i < MANY(200); i++) {
        const saddle_vec2_t cop[2] = {random_point(&state, 0.5f), random_point(&state, 0.5f)};
        const saddle_bos_t bos = saddle_bos(cop, HALF_DEPTH_M, 1.0f);
        if (!bos.defined) {
            continue;
        }
        const float y = random_in(&state, -1.0f, 1.0f);
        double before = (double)saddle_bos_margin_m(&bos, (saddle_vec2_t){-1.0f, y});
        for (int k = 1; k <= 2000; k++) {
            const saddle_vec2_t point = {(float)(-1.0 + step * k), y};
            const double margin = (double)saddle_bos_margin_m(&bos, point);
            TEST_ASSERT_DOUBLE_WITHIN(step + MARGIN_TOLERANCE, before, margin);
            before = margin;
        }
    }
}

static double cross(saddle_vec2_t a, saddle_vec2_t b, saddle_vec2_t c)
{
    return ((double)b.x - (double)a.x) * ((double)c.y - (double)b.y) -
           ((double)b.y - (double)a.y) * ((double)c.x - (double)b.x);
}

static void test_polygon_is_convex_counter_clockwise_and_on_the_border(void)
{
    static twin_t twin;
    uint32_t state = 17;
    TEST_ASSERT_EQUAL_INT(16, SADDLE_BOS_VERTICES);
    for (int i = 0; i < MANY(100); i++) {
        const float reach = (i & 1) != 0 ? 1.0f : 0.1f;
        const saddle_vec2_t cop[2] = {random_point(&state, reach), random_point(&state, reach)};
        const saddle_bos_t bos = saddle_bos(cop, HALF_DEPTH_M, 1.0f);
        saddle_vec2_t vertices[SADDLE_BOS_VERTICES];
        saddle_bos_polygon(&bos, vertices);
        twin_build(&twin, cop, 1.0);
        for (int k = 0; k < SADDLE_BOS_VERTICES; k++) {
            const saddle_vec2_t next = vertices[(k + 1) % SADDLE_BOS_VERTICES];
            const saddle_vec2_t after = vertices[(k + 2) % SADDLE_BOS_VERTICES];
            TEST_ASSERT_TRUE(cross(vertices[k], next, after) > 0.0);
            TEST_ASSERT_DOUBLE_WITHIN(MARGIN_TOLERANCE, 0.0, twin_margin(&twin, vertices[k]));
        }
    }
}

/* An inscribed polygon of 16 vertices fills a disc to 97.5 %, a cut disc to more. */
static void test_polygon_fills_the_base(void)
{
    const float radii[] = {0.05f, 0.1f, 0.15f, 0.4f};
    for (size_t i = 0; i < COUNT_OF(radii); i++) {
        const saddle_bos_t bos = side_by_side(radii[i]);
        saddle_vec2_t vertices[SADDLE_BOS_VERTICES];
        saddle_bos_polygon(&bos, vertices);
        double area = 0.0;
        for (int k = 0; k < SADDLE_BOS_VERTICES; k++) {
            const saddle_vec2_t a = vertices[k];
            const saddle_vec2_t b = vertices[(k + 1) % SADDLE_BOS_VERTICES];
            area += 0.5 * ((double)a.x * (double)b.y - (double)b.x * (double)a.y);
        }
        const double r = (double)radii[i];
        const double half = asin(fmin(1.0, 0.1 / r));
        const double true_area = 2.0 * r * r * (half + 0.5 * sin(2.0 * half));
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * true_area, true_area, area);
        TEST_ASSERT_TRUE(area < true_area);
    }
}

static void test_polygon_has_the_corners(void)
{
    const saddle_bos_t bos = side_by_side(0.3f);
    saddle_vec2_t vertices[SADDLE_BOS_VERTICES];
    saddle_bos_polygon(&bos, vertices);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.1, vertices[0].x); /* front left */
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, sqrt(0.08), vertices[0].y);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.1, vertices[15].x); /* front right */
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -sqrt(0.08), vertices[15].y);
}

static void test_feet_within_a_millimetre_are_undefined(void)
{
    const saddle_vec2_t together[2] = {{0.3f, 0.2009f}, {0.3f, 0.2f}};
    const saddle_bos_t bos = saddle_bos(together, HALF_DEPTH_M, 1.0f);
    saddle_vec2_t vertices[SADDLE_BOS_VERTICES];
    memset(vertices, 0xA5, sizeof vertices);
    saddle_bos_polygon(&bos, vertices);
    TEST_ASSERT_FALSE(bos.defined);
    ASSERT_SAME_FLOAT(0.0f, bos.radius_m);
    ASSERT_SAME_FLOAT(0.0f, saddle_bos_margin_m(&bos, together[0]));
    TEST_ASSERT_FALSE(saddle_bos_contains(&bos, together[0]));
    for (int k = 0; k < SADDLE_BOS_VERTICES; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, vertices[k].x);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, vertices[k].y);
    }
    const saddle_vec2_t apart[2] = {{0.3f, 0.2011f}, {0.3f, 0.2f}};
    TEST_ASSERT_TRUE(saddle_bos(apart, HALF_DEPTH_M, 1.0f).defined);
    const saddle_vec2_t same[2] = {{0.3f, 0.2f}, {0.3f, 0.2f}};
    TEST_ASSERT_FALSE(saddle_bos(same, HALF_DEPTH_M, 1.0f).defined);
}

/* ---- share of the base that is used -------------------------------------------------------- */

/* Half the base: the disc and the cut shrink towards the same centre. */
static void test_factor_shrinks_the_base_around_its_centre(void)
{
    const saddle_vec2_t cop[2] = {{1.4f, 0.2f}, {1.0f, -0.1f}};
    const saddle_bos_t whole = saddle_bos(cop, HALF_DEPTH_M, 1.0f);
    const saddle_bos_t half = saddle_bos(cop, HALF_DEPTH_M, 0.5f);
    TEST_ASSERT_TRUE(half.defined);
    ASSERT_SAME_FLOAT(whole.centre_m.x, half.centre_m.x);
    ASSERT_SAME_FLOAT(whole.centre_m.y, half.centre_m.y);
    ASSERT_SAME_FLOAT(whole.axis_x.x, half.axis_x.x);
    ASSERT_SAME_FLOAT(whole.axis_x.y, half.axis_x.y);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.125, half.radius_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.05, half.half_depth_m);
}

/* Similar figures: the margin of a point twice as far from the centre is twice as large. */
static void test_margin_in_the_used_share_is_similar(void)
{
    uint32_t state = 31;
    for (int i = 0; i < MANY(2000); i++) {
        const float factor = random_in(&state, 0.1f, 1.0f);
        const saddle_vec2_t cop[2] = {random_point(&state, 0.5f), random_point(&state, 0.5f)};
        const saddle_bos_t whole = saddle_bos(cop, HALF_DEPTH_M, 1.0f);
        const saddle_bos_t used = saddle_bos(cop, HALF_DEPTH_M, factor);
        const saddle_vec2_t offset = random_point(&state, 0.5f);
        const saddle_vec2_t far_m = {whole.centre_m.x + offset.x, whole.centre_m.y + offset.y};
        const saddle_vec2_t near_m = {whole.centre_m.x + factor * offset.x,
                                      whole.centre_m.y + factor * offset.y};
        TEST_ASSERT_DOUBLE_WITHIN(MARGIN_TOLERANCE,
                                  (double)factor * (double)saddle_bos_margin_m(&whole, far_m),
                                  saddle_bos_margin_m(&used, near_m));
    }
}

/* ---- exit ---------------------------------------------------------------------------------- */

static void assert_exit(const saddle_bos_t *bos, double exit_x, double exit_y, double x, double y,
                        double vx, double vy)
{
    for (int quadrant = 0; quadrant < 4; quadrant++) {
        const double sx = (quadrant & 1) != 0 ? -1.0 : 1.0;
        const double sy = (quadrant & 2) != 0 ? -1.0 : 1.0;
        const saddle_vec2_t exit =
            saddle_bos_exit_m(bos, (saddle_vec2_t){(float)(sx * x), (float)(sy * y)},
                              (saddle_vec2_t){(float)(sx * vx), (float)(sy * vy)});
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, sx * exit_x, exit.x);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, sy * exit_y, exit.y);
    }
}

/* r = 0.3, d_h = 0.1: the corner lies at (0.1, sqrt 0.08). The speed does not matter. */
static void test_exit_of_a_moving_point_by_hand(void)
{
    const saddle_bos_t bos = side_by_side(0.3f);
    const double corner = sqrt(0.08);
    const double speeds[] = {2e-4, 1.0, 6.0};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        const double v = speeds[i];
        assert_exit(&bos, 0.1, 0.0, 0.0, 0.0, v, 0.0);                   /* edge, ahead */
        assert_exit(&bos, 0.1, 0.07, -0.05, 0.07, v, 0.0);               /* from behind */
        assert_exit(&bos, 0.1, 0.2, 0.0, 0.1, v, v);                     /* edge, aslant */
        assert_exit(&bos, 0.0, 0.3, 0.0, 0.1, 0.0, v);                   /* arc, sideways */
        assert_exit(&bos, 0.0, 0.3, 0.0, -0.25, 0.0, v);                 /* all through */
        assert_exit(&bos, 0.06, sqrt(0.09 - 0.0036), 0.06, 0.1, 0.0, v); /* arc, beside y_S */
        assert_exit(&bos, 0.1, corner, 0.05, 0.5 * corner, v / 3.0, corner * v / 0.3);
        assert_exit(&bos, 0.1, 0.1, 0.1, 0.1, v, 0.0); /* on the border */
    }
    const saddle_bos_t disc = side_by_side(0.05f);
    assert_exit(&disc, 0.05, 0.0, 0.01, 0.0, 1.0, 0.0);
    assert_exit(&disc, 0.03, 0.04, 0.0, 0.0, 0.6, 0.8);
}

static void test_exit_of_a_point_at_rest_is_the_nearest_border_point(void)
{
    const saddle_bos_t bos = side_by_side(0.3f);
    const double y = sqrt(0.09 - 0.018 * 0.018);
    const double rest[] = {0.0, 5e-5};
    for (size_t i = 0; i < COUNT_OF(rest); i++) {
        assert_exit(&bos, 0.1, 0.02, 0.03, 0.02, rest[i], rest[i]);        /* edge */
        assert_exit(&bos, 0.0, 0.3, 0.0, 0.25, rest[i], -rest[i]);         /* arc */
        assert_exit(&bos, 0.018, y, 0.96 * 0.018, 0.96 * y, 0.0, rest[i]); /* arc, aslant */
    }
}

/* Whichever way a point outside moves: the nearest point of the border. */
static void test_exit_of_a_point_outside_is_the_nearest_border_point(void)
{
    const saddle_bos_t bos = side_by_side(0.3f);
    const double corner = sqrt(0.08);
    const double velocities[][2] = {{0.0, 0.0}, {1.0, 0.0}, {-1.0, -0.3}, {0.0, 2.0}};
    for (size_t i = 0; i < COUNT_OF(velocities); i++) {
        const double vx = velocities[i][0];
        const double vy = velocities[i][1];
        assert_exit(&bos, 0.1, 0.05, 0.2, 0.05, vx, vy);             /* edge */
        assert_exit(&bos, 0.0, 0.3, 0.0, 0.4, vx, vy);               /* arc */
        assert_exit(&bos, 0.1, corner, 0.13, corner + 0.04, vx, vy); /* corner */
        assert_exit(&bos, 0.1, corner, 0.5, 0.4, vx, vy);
    }
    const saddle_bos_t disc = side_by_side(0.05f);
    assert_exit(&disc, 0.03, 0.04, 0.6, 0.8, 1.0, 1.0);
}

/* The centre of a plain disc has no nearest border point: any of them. */
static void test_exit_of_the_middle_of_a_disc_at_rest_is_on_the_border(void)
{
    const saddle_bos_t disc = side_by_side(0.05f);
    const saddle_vec2_t exit =
        saddle_bos_exit_m(&disc, (saddle_vec2_t){0.0f, 0.0f}, (saddle_vec2_t){0.0f, 0.0f});
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.05, hypot((double)exit.x, (double)exit.y));
}

static void test_exit_of_an_undefined_base_is_the_point(void)
{
    const saddle_vec2_t together[2] = {{0.3f, 0.2f}, {0.3f, 0.2f}};
    const saddle_bos_t bos = saddle_bos(together, HALF_DEPTH_M, 1.0f);
    const saddle_vec2_t exit =
        saddle_bos_exit_m(&bos, (saddle_vec2_t){0.7f, -0.4f}, (saddle_vec2_t){1.0f, 0.0f});
    ASSERT_SAME_FLOAT(0.7f, exit.x);
    ASSERT_SAME_FLOAT(-0.4f, exit.y);
}

/* Inside and moving: on the border, straight ahead, and nothing of the border before it. */
static void assert_first_crossing(const twin_t *twin, saddle_vec2_t from, saddle_vec2_t direction,
                                  saddle_vec2_t exit)
{
    const double speed = hypot((double)direction.x, (double)direction.y);
    const double ux = (double)direction.x / speed;
    const double uy = (double)direction.y / speed;
    const double dx = (double)exit.x - (double)from.x;
    const double dy = (double)exit.y - (double)from.y;
    const double way = dx * ux + dy * uy;
    TEST_ASSERT_TRUE(way >= -MARGIN_TOLERANCE);
    TEST_ASSERT_DOUBLE_WITHIN(MARGIN_TOLERANCE, 0.0, dx * uy - dy * ux);
    TEST_ASSERT_DOUBLE_WITHIN(MARGIN_TOLERANCE, 0.0, twin_margin(twin, exit));
    for (int k = 1; k < 8; k++) { /* the base is convex: all the way to it lies inside */
        const saddle_vec2_t between = {(float)((double)from.x + way * ux * k / 8.0),
                                       (float)((double)from.y + way * uy * k / 8.0)};
        TEST_ASSERT_TRUE(twin_margin(twin, between) >= -MARGIN_TOLERANCE);
    }
}

static void test_exit_of_random_points_is_where_the_ray_or_the_nearest_border_is(void)
{
    static twin_t twin;
    uint32_t state = 29;
    int inside = 0;
    int outside = 0;
    for (int i = 0; i < MANY(1500); i++) {
        const float reach = (i & 1) != 0 ? 0.6f : 0.12f;
        const float factor = random_in(&state, 0.3f, 1.0f);
        const saddle_vec2_t cop[2] = {random_point(&state, reach), random_point(&state, reach)};
        const saddle_bos_t bos = saddle_bos(cop, HALF_DEPTH_M, factor);
        if (!bos.defined) {
            continue;
        }
        const saddle_vec2_t offset = random_point(&state, 0.8f * bos.radius_m + 0.02f);
        const saddle_vec2_t from = {bos.centre_m.x + offset.x, bos.centre_m.y + offset.y};
        const bool moves = i % 3 != 0;
        const saddle_vec2_t velocity = random_point(&state, moves ? 3.0f : 0.0f);
        twin_build(&twin, cop, (double)factor);
        const saddle_vec2_t exit = saddle_bos_exit_m(&bos, from, velocity);
        const double margin = twin_margin(&twin, from);
        if (moves && margin > 0.0) {
            assert_first_crossing(&twin, from, velocity, exit);
            inside++;
        } else {
            const double way =
                hypot((double)exit.x - (double)from.x, (double)exit.y - (double)from.y);
            TEST_ASSERT_DOUBLE_WITHIN(MARGIN_TOLERANCE, 0.0, twin_margin(&twin, exit));
            TEST_ASSERT_DOUBLE_WITHIN(MARGIN_TOLERANCE, fabs(margin), way);
            outside++;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(MANY(300), inside);
    TEST_ASSERT_GREATER_THAN_INT(MANY(300), outside);
}

/* ---- energy surface ------------------------------------------------------------------------ */

static bool surface_height_m(const saddle_vec2_t cop[2], saddle_vec2_t com, float pendulum_m,
                             float *height)
{
    const saddle_surface_t surface = saddle_surface(cop, com, pendulum_m);
    *height = surface.height_m;
    return surface.reached;
}

static bool gravity_n(const saddle_vec2_t cop[2], saddle_vec2_t com, float pendulum_m,
                      saddle_vec2_t *force)
{
    const saddle_surface_t surface = saddle_surface(cop, com, pendulum_m);
    *force = saddle_gravity_n(&surface, 63.3f);
    return surface.reached;
}

static double surface_height(const saddle_vec2_t cop[2], double x, double y)
{
    double highest = 0.0;
    for (int side = 0; side < 2; side++) {
        const double dx = x - (double)cop[side].x;
        const double dy = y - (double)cop[side].y;
        highest = fmax(highest, sqrt(1.02 * 1.02 - dx * dx - dy * dy));
    }
    return highest;
}

static void test_surface_height_is_over_the_nearer_foot(void)
{
    const saddle_vec2_t cop[2] = {{0.3f, 0.05f}, {-0.3f, -0.05f}};
    float height;
    TEST_ASSERT_TRUE(surface_height_m(cop, cop[SADDLE_LEFT], 1.02f, &height));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.02, height); /* the maximum over a foot */
    TEST_ASSERT_TRUE(surface_height_m(cop, cop[SADDLE_RIGHT], 1.02f, &height));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.02, height);
    TEST_ASSERT_TRUE(surface_height_m(cop, (saddle_vec2_t){0.0f, 0.0f}, 1.02f, &height));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, sqrt(1.02 * 1.02 - 0.0925), height); /* the saddle */
    uint32_t state = 37;
    for (int i = 0; i < MANY(5000); i++) {
        const saddle_vec2_t com = random_point(&state, 0.5f);
        TEST_ASSERT_TRUE(surface_height_m(cop, com, 1.02f, &height));
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE,
                                  surface_height(cop, (double)com.x, (double)com.y), height);
    }
}

static void test_surface_ends_where_the_pendulum_lies_down(void)
{
    const saddle_vec2_t cop[2] = {{0.0f, 0.05f}, {0.0f, -0.05f}};
    const float lowest = sqrtf(1.0f - SADDLE_LOWEST_PENDULUM * SADDLE_LOWEST_PENDULUM);
    float height = 1.0f;
    TEST_ASSERT_FALSE(
        surface_height_m(cop, (saddle_vec2_t){0.8f * lowest + 1e-4f, 0.05f}, 0.8f, &height));
    ASSERT_SAME_FLOAT(0.0f, height);
    TEST_ASSERT_TRUE(
        surface_height_m(cop, (saddle_vec2_t){0.8f * lowest - 1e-4f, 0.05f}, 0.8f, &height));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.08, height);
}

static void test_gravity_is_the_slope_of_the_energy(void)
{
    uint32_t state = 23;
    const double h = 1e-6;
    const double weight = 63.3 * GRAVITY;
    for (int i = 0; i < MANY(5000); i++) {
        const saddle_vec2_t cop[2] = {
            {random_in(&state, -0.3f, 0.3f), random_in(&state, 0.05f, 0.2f)},
            {random_in(&state, -0.3f, 0.3f), random_in(&state, -0.2f, 0.0f)}};
        const saddle_vec2_t com = {random_in(&state, -0.3f, 0.3f), random_in(&state, -0.3f, 0.3f)};
        const double x = (double)com.x;
        const double y = (double)com.y;
        const double left = hypot(x - (double)cop[0].x, y - (double)cop[0].y);
        const double right = hypot(x - (double)cop[1].x, y - (double)cop[1].y);
        if (fabs(left - right) < 1e-4) {
            continue; /* on the ridge between the feet the slope has two values */
        }
        saddle_vec2_t force;
        TEST_ASSERT_TRUE(gravity_n(cop, com, 1.02f, &force));
        const double slope_x =
            (surface_height(cop, x + h, y) - surface_height(cop, x - h, y)) / (2 * h);
        const double slope_y =
            (surface_height(cop, x, y + h) - surface_height(cop, x, y - h)) / (2 * h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, -weight * slope_x, force.x); /* of up to 600 N */
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, -weight * slope_y, force.y);
    }
}

static void test_gravity_ends_where_the_pendulum_lies_down(void)
{
    const saddle_vec2_t cop[2] = {{0.0f, 0.05f}, {0.0f, -0.05f}};
    const float lowest = sqrtf(1.0f - SADDLE_LOWEST_PENDULUM * SADDLE_LOWEST_PENDULUM);
    saddle_vec2_t force = {1.0f, 1.0f};
    const saddle_vec2_t beyond = {lowest + 1e-4f, 0.05f};
    TEST_ASSERT_FALSE(gravity_n(cop, beyond, 1.0f, &force));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, force.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, force.y);
    const saddle_vec2_t within = {lowest - 1e-4f, 0.05f};
    TEST_ASSERT_TRUE(gravity_n(cop, within, 1.0f, &force));
    const double x = (double)within.x;
    const double expected = 63.3 * GRAVITY * x / sqrt(1.0 - x * x);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, expected, force.x); /* 6 kN; 1 - x^2 keeps 5 digits */
}

/* On the arc, and moving along it: no way is left. */
static void test_exit_from_the_arc(void)
{
    const saddle_bos_t bos = side_by_side(0.25f);
    const saddle_vec2_t point = {0.0f, 0.25f};
    const saddle_vec2_t exit = saddle_bos_exit_m(&bos, point, (saddle_vec2_t){1.0f, 0.0f});
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.0, exit.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.25, exit.y);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_exit_from_the_arc);
    RUN_TEST(test_margins_of_each_region_by_hand);
    RUN_TEST(test_close_feet_make_the_plain_disc);
    RUN_TEST(test_frame_follows_the_feet);
    RUN_TEST(test_margin_equals_brute_force_for_random_postures);
    RUN_TEST(test_margin_is_continuous);
    RUN_TEST(test_polygon_is_convex_counter_clockwise_and_on_the_border);
    RUN_TEST(test_polygon_fills_the_base);
    RUN_TEST(test_polygon_has_the_corners);
    RUN_TEST(test_feet_within_a_millimetre_are_undefined);
    RUN_TEST(test_factor_shrinks_the_base_around_its_centre);
    RUN_TEST(test_margin_in_the_used_share_is_similar);
    RUN_TEST(test_exit_of_a_moving_point_by_hand);
    RUN_TEST(test_exit_of_a_point_at_rest_is_the_nearest_border_point);
    RUN_TEST(test_exit_of_a_point_outside_is_the_nearest_border_point);
    RUN_TEST(test_exit_of_the_middle_of_a_disc_at_rest_is_on_the_border);
    RUN_TEST(test_exit_of_an_undefined_base_is_the_point);
    RUN_TEST(test_exit_of_random_points_is_where_the_ray_or_the_nearest_border_is);
    RUN_TEST(test_surface_height_is_over_the_nearer_foot);
    RUN_TEST(test_surface_ends_where_the_pendulum_lies_down);
    RUN_TEST(test_gravity_is_the_slope_of_the_energy);
    RUN_TEST(test_gravity_ends_where_the_pendulum_lies_down);
    return UNITY_END();
}
