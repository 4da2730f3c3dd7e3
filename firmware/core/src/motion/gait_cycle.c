#include "motion/gait_cycle.h"

#include "math/blend.h"
#include "math/elementary.h"
#include "math/fixed.h"
#include "math/vec2.h"
#include "model/gait_model.h"
#include "motion/com_path.h"
#include "motion/speed_profile.h"
#include "motion/way.h"

#include <math.h>

/* A quarter lasts at least 36 ms, [E6] at its extremes, and a tick at most 250 ms. */
#define VIA_POINTS_A_TICK 8
#define SPEED_MIN_M_S 0.01f /* slower transitions are shaped as if this fast */

/* A landing is taken over in the first half of the quarter after it and the first quarter of the
 * swing, and only if it leaves the CoM this far behind the foot and the feet this far apart. */
#define LANDING_AHEAD_MIN_M 0.02f
#define LANDING_WIDTH_MIN_M 0.02f
#define LANDING_AIR_MAX 0.25f

/* A distance to the foot via point that is more times the planned one is no misplaced landing: at
 * the planned path's slope the CoM would leave the feet sideways. */
#define LANDING_STRETCH_MAX 2.0f

/* A swing foot comes down on a slope from no higher. */
#define APPROACH_MAX_M 0.03f

/* A foot is waited for until the CoM is further ahead by no more than this share of its way to that foot
 * when it was to land. */
#define LATE_SHARE_MAX 0.5f

/* A landing is moved no later than this before it, and the foot no faster in the mean: 3 m/s at most
 * with E22's profile. [E45] */
#define PLACEMENT_FROZEN_S 0.06f
#define PLACEMENT_SPEED_M_S 1.6f

/* The CoM stays within this share of the pendulum's length from the stance foot, squared. */
#define REACH_SHARE 0.8f

bool saddle_cycle_before_landing(const saddle_cycle_t *cycle)
{
    return cycle->phase % 2u == 0u;
}

/* set_phase() follows, at the latest when the cycle has advanced. */
static void move_to(saddle_cycle_t *cycle, saddle_fixed_t position)
{
    cycle->position = position;
    cycle->x_m = saddle_position_to_m(position);
}

static void set_phase(saddle_cycle_t *cycle, saddle_sin_cos_t phase)
{
    cycle->sin_phase = phase.sin;
    cycle->cos_phase = phase.cos;
}

saddle_sin_cos_t saddle_cycle_phase(const saddle_cycle_t *cycle)
{
    return (saddle_sin_cos_t){cycle->sin_phase, cycle->cos_phase};
}

/* The end of a last swing. */
static void rest_beside_foot(saddle_cycle_t *cycle)
{
    move_to(cycle, 0);
    set_phase(cycle, SADDLE_PHASE_FOOT);
    saddle_profile_set_speed(&cycle->profile, 0);
}

static saddle_side_t stance_of_phase(uint8_t phase)
{
    return phase == 0u || phase == 3u ? SADDLE_LEFT : SADDLE_RIGHT;
}

static saddle_sample_t sum(saddle_sample_t a, saddle_sample_t b)
{
    const saddle_sample_t total = {a.value + b.value, a.slope + b.slope};
    return total;
}

/* Where the running quarter has the CoM at a phase: y, */
static saddle_sample_t lateral_at(const saddle_cycle_t *cycle, const saddle_model_t *model,
                                  saddle_sin_cos_t phase)
{
    const bool last = cycle->last_swing && !saddle_cycle_before_landing(cycle);
    return saddle_shaped_lateral(&cycle->quarter, saddle_shape(model, last), phase);
}

/* and z for the cycloid; the other ankles have no height of their own. */
static saddle_sample_t vertical_at(const saddle_cycle_t *cycle, const saddle_model_t *model,
                                   saddle_sin_cos_t phase)
{
    const bool last = cycle->last_swing && !saddle_cycle_before_landing(cycle);
    if (model->config.ankle != SADDLE_ANKLE_CYCLOID) {
        return (saddle_sample_t){0.0f, 0.0f};
    }
    return saddle_shaped_height(&cycle->quarter, saddle_shape(model, last), model->body.pendulum_m,
                                phase);
}

/* The CoM at a place. */
typedef struct {
    saddle_sample_t lateral, vertical;
} place_t;

static place_t reference_at(const saddle_cycle_t *cycle, const saddle_model_t *model,
                            saddle_sin_cos_t phase)
{
    return (place_t){lateral_at(cycle, model, phase), vertical_at(cycle, model, phase)};
}

/* Where the CoM is x_m from the stance CoP: the reference, and what of a mismatch is left. */
static place_t place_at(const saddle_cycle_t *cycle, const place_t *reference, float x_m)
{
    return (place_t){
        .lateral = sum(reference->lateral, saddle_blend_at(&cycle->lateral, x_m)),
        .vertical = sum(reference->vertical, saddle_blend_at(&cycle->vertical, x_m)),
    };
}

/* The running quarter, at a phase, has a new shape; what it changes at the CoM fades out until its end. */
static void follow_shape(saddle_cycle_t *cycle, const saddle_model_t *model, saddle_sin_cos_t phase,
                         const place_t *actual)
{
    const float x_m = cycle->x_m;
    const bool before = saddle_cycle_before_landing(cycle);
    const float rest_m = before ? cycle->quarter.length_m - x_m : -x_m;
    cycle->swing.path_width_m = cycle->quarter.width_m;
    const place_t reference = reference_at(cycle, model, phase);
    cycle->lateral = saddle_blend(actual->lateral, reference.lateral, x_m, rest_m);
    if (model->config.ankle == SADDLE_ANKLE_CYCLOID) {
        cycle->vertical = saddle_blend(actual->vertical, reference.vertical, x_m, rest_m);
    } else {
        cycle->transition = saddle_transition(
            model, &cycle->quarter, before ? cycle->next_strike : cycle->transition.strike);
    }
}

/* How far the CoM leans to the left. */
static saddle_sample_t lean_at(const saddle_cycle_t *cycle, float x_m)
{
    const saddle_sample_t lean = {cycle->lean_m, 0.0f};
    return sum(lean, saddle_blend_at(&cycle->leaning, x_m));
}

/* [E49] From now on towards another lean, until the quarter's end; upright, nothing fades. */
static void lean_towards(saddle_cycle_t *cycle, saddle_sample_t actual, float lean_m)
{
    const bool before = saddle_cycle_before_landing(cycle);
    const float rest_m = before ? cycle->quarter.length_m - cycle->x_m : -cycle->x_m;
    const float leans =
        saddle_magnitude(actual.value) + saddle_magnitude(actual.slope) + saddle_magnitude(lean_m);
    const saddle_sample_t lean = {lean_m, 0.0f};
    cycle->lean_m = lean_m;
    cycle->leaning = saddle_blend(actual, lean, cycle->x_m, leans > 0.0f ? rest_m : 0.0f);
}

/* As the running quarter's arc and the speed need it; a last swing ends upright. */
static void lean_into_turn(saddle_cycle_t *cycle, const saddle_model_t *model,
                           saddle_sample_t actual, float speed_m_s)
{
    if (!cycle->way.bent) {
        return; /* upright: a lean has gone before the way is straight again */
    }
    const bool before = saddle_cycle_before_landing(cycle);
    const float curvature_1_m = cycle->way.arcs[before ? 1 : 0].curvature_1_m;
    const float needed_m = saddle_lean_m(model, curvature_1_m, speed_m_s);
    lean_towards(cycle, actual, cycle->last_swing ? 0.0f : needed_m);
}

/* The swing foot's way along x at a phase, [E9] or [E44], and its change with the CoM's. The last swing
 * ends beside the stance foot, where only the line leads. */
static saddle_sample_t swing_way(const saddle_cycle_t *cycle, const saddle_model_t *model,
                                 float x_m, saddle_sin_cos_t phase)
{
    const bool last = cycle->last_swing && !saddle_cycle_before_landing(cycle);
    if (last || model->config.swing_skew <= 0.0f) {
        return saddle_swing_line(&cycle->swing, x_m, saddle_com_lateral(&cycle->quarter, phase));
    }
    const float half_m = cycle->quarter.length_m;
    const saddle_jerk_t share = saddle_swing_share(&model->body.swing, 0.5f + 0.5f * x_m / half_m);
    return (saddle_sample_t){2.0f * half_m * (2.0f * share.value - 1.0f), 2.0f * share.slope};
}

/* The foot via point: the next step's length follows from the speed now. Every mismatch has gone. */
static SADDLE_NOINLINE void pass_foot(saddle_cycle_t *cycle, const saddle_model_t *model,
                                      saddle_fixed_t speed)
{
    const saddle_side_t stance = cycle->quarter.stance;
    const float speed_m_s = saddle_speed_to_m_s(speed);
    const place_t actual = reference_at(cycle, model, SADDLE_PHASE_FOOT);
    const float old_half_m = cycle->quarter.length_m;
    cycle->phase = (uint8_t)((cycle->phase + 1u) % 4u);
    cycle->stride_count += cycle->phase == 0u ? 1u : 0u;
    cycle->quarter_length = saddle_half_step(model, saddle_other_side(stance), speed);
    cycle->quarter = saddle_quarter(model, stance, saddle_position_to_m(cycle->quarter_length),
                                    saddle_magnitude(cycle->swing.line_y_m), speed_m_s);
    follow_shape(cycle, model, SADDLE_PHASE_FOOT, &actual);
    lean_into_turn(cycle, model, lean_at(cycle, 0.0f), speed_m_s);
    if (model->config.swing_skew > 0.0f) {
        const float share = 2.0f * saddle_swing_share(&model->body.swing, 0.5f).value - 1.0f;
        cycle->swing.stretch_m = 2.0f * (old_half_m - cycle->quarter.length_m) * share;
    }
}

/* The line on which the next swing foot travels, from the new stance CoP: at its place beside the
 * walking line, but between half and twice a step width from the stance foot. A last swing lands as
 * wide as one stands, so that the CoM stays nearer to the leg that carries it. */
static float swing_line_y_m(const saddle_cycle_t *cycle, const saddle_model_t *model,
                            saddle_side_t foot, float speed_m_s)
{
    const float then_m_s = cycle->last_swing ? 0.0f : speed_m_s;
    const float line_y_m = saddle_landing_y_m(model, foot, then_m_s) - cycle->stance_y_m;
    const float width_m = saddle_step_width_m(model, then_m_s);
    const float outward = saddle_outward(foot);
    return outward * saddle_clamp(outward * line_y_m, 0.5f * width_m, 2.0f * width_m);
}

/* Let the other foot, at lifted_m, begin a swing at a phase: what it is off its line fades out. */
static void lift_off(saddle_cycle_t *cycle, const saddle_model_t *model, saddle_vec2_t lifted_m,
                     float speed_m_s, saddle_sin_cos_t phase)
{
    const saddle_side_t foot = saddle_other_side(cycle->quarter.stance);
    saddle_swing_t *swing = &cycle->swing;
    swing->lift_progress = saddle_cycle_before_landing(cycle) ? 0.5f : 0.0f;
    swing->land_progress = cycle->last_swing ? 0.5f : 1.0f;
    swing->clearance_m = model->config.swing_clearance_m;
    swing->approach = model->config.swing_approach;
    swing->approach_max_m = saddle_smaller(APPROACH_MAX_M, swing->clearance_m);
    swing->line_y_m = swing_line_y_m(cycle, model, foot, speed_m_s);
    swing->offset_m.x = lifted_m.x - swing_way(cycle, model, cycle->x_m, phase).value;
    swing->offset_m.y = lifted_m.y - swing->line_y_m;
    swing->stretch_m = 0.0f;
    swing->moved_m.x = 0.0f;
    swing->moved_m.y = 0.0f;
    swing->moving_x.length_m = 0.0f;
    swing->moving_y.length_m = 0.0f;
}

static float shaping_speed_m_s(const saddle_cycle_t *cycle)
{
    return saddle_larger(cycle->profile.speed_m_s, SPEED_MIN_M_S);
}

static float length_m(float x_m, float y_m, float z_m)
{
    return sqrtf(x_m * x_m + y_m * y_m + z_m * z_m);
}

/* The ankles of the erf and rigid models at the saddle via point. */
static saddle_ankle_angles_t angles_at_saddle(const saddle_cycle_t *cycle,
                                              const saddle_model_t *model)
{
    const float lead_s = cycle->transition.strike.lead_m / shaping_speed_m_s(cycle);
    return saddle_ankle_angles(model, &cycle->transition, lead_s);
}

/* The angle at which the stance foot leaves the ground, at the saddle via point. */
static float toe_off_angle_rad(const saddle_cycle_t *cycle, const saddle_model_t *model,
                               const place_t *place)
{
    if (model->config.ankle != SADDLE_ANKLE_CYCLOID) {
        return angles_at_saddle(cycle, model).toe_off_rad;
    }
    saddle_ankle_state_t ankle;
    const float leg_m =
        length_m(cycle->quarter.length_m, place->lateral.value, place->vertical.value);
    (void)saddle_ankle_for_leg(model, leg_m, true, &ankle);
    return ankle.toe_off_rad;
}

/* The next heel strike. */
static void plan_heel_strike(saddle_cycle_t *cycle, const saddle_model_t *model,
                             float heel_strike_rad)
{
    if (heel_strike_rad != cycle->next_strike.angle_rad) {
        cycle->next_strike = saddle_heel_strike(model, heel_strike_rad);
    }
}

/* A landing: the step from the old stance foot to the new one, and how far behind it the CoM is. */
typedef struct {
    saddle_vec2_t step_m;
    int64_t step_nm; /* along x */
    saddle_fixed_t behind;
    float behind_m;
    float onward_m_s; /* speed of the CoM midway to the landing after it; of use in turns */
} landing_t;

/* The swing foot has landed, with the CoM at a place from the old stance foot, hereafter from the new
 * one: it carries from now on. */
static void begin_step(saddle_cycle_t *cycle, const saddle_model_t *model, const landing_t *landing,
                       place_t *place, float speed_m_s)
{
    const saddle_vec2_t lifted_m = {-landing->step_m.x, -landing->step_m.y};
    cycle->lift_pitch_rad = toe_off_angle_rad(cycle, model, place);
    place->lateral.value -= landing->step_m.y;
    cycle->last_step_m = landing->step_m;
    const saddle_sample_t lean = lean_at(cycle, cycle->x_m);

    cycle->phase++;
    cycle->step_count++;
    cycle->quarter_length = landing->behind;
    move_to(cycle, -landing->behind);
    saddle_way_land(&cycle->way, model, landing->onward_m_s, landing->step_nm);
    cycle->stance_y_m += landing->step_m.y;
    cycle->quarter =
        saddle_quarter(model, saddle_other_side(cycle->quarter.stance), landing->behind_m,
                       saddle_magnitude(landing->step_m.y), speed_m_s);
    follow_shape(cycle, model, SADDLE_PHASE_LANDED, place);
    lean_into_turn(cycle, model, lean, speed_m_s);
    lift_off(cycle, model, lifted_m, speed_m_s, SADDLE_PHASE_LANDED);
}

/* The saddle via point: the swing foot lands as planned. */
static SADDLE_NOINLINE void pass_saddle(saddle_cycle_t *cycle, const saddle_model_t *model,
                                        saddle_fixed_t speed, saddle_fixed_t onward)
{
    place_t place = reference_at(cycle, model, SADDLE_PHASE_LANDING); /* no mismatch is left */
    const saddle_vec2_t moved_m = cycle->swing.moved_m;
    const saddle_fixed_t moved = saddle_position_from_m(moved_m.x);
    const landing_t landing = {
        .step_m = {2.0f * cycle->quarter.length_m + moved_m.x, cycle->swing.line_y_m + moved_m.y},
        .step_nm = 2 * saddle_position_to_nm(cycle->quarter_length) + saddle_position_to_nm(moved),
        .behind = cycle->quarter_length + moved,
        .behind_m = cycle->quarter.length_m + moved_m.x,
        .onward_m_s = saddle_speed_to_m_s(onward),
    };
    begin_step(cycle, model, &landing, &place, saddle_speed_to_m_s(speed));
}

void saddle_cycle_begin(saddle_cycle_t *cycle, const saddle_model_t *model,
                        const saddle_cycle_start_t *start)
{
    const saddle_side_t stance = stance_of_phase(start->phase);
    const place_t actual = {{start->com_y_m, 0.0f}, {start->com_z_m, 0.0f}};
    const bool beside = start->phase % 2u == 0u;
    const saddle_sin_cos_t phase = beside ? SADDLE_PHASE_FOOT : SADDLE_PHASE_LANDED;
    const saddle_heel_strike_t none = {0.0f, 0.0f};
    saddle_profile_set_speed(&cycle->profile, start->speed);
    const float speed_m_s = cycle->profile.speed_m_s;
    cycle->transition.strike = none;
    plan_heel_strike(cycle, model, start->heel_strike_rad);
    cycle->phase = start->phase;
    cycle->stance_y_m = start->stance_y_m;
    saddle_way_begin(&cycle->way);
    cycle->last_swing = false;
    cycle->lift_pitch_rad = 0.0f;
    cycle->last_step_m.x = -start->other_m.x;
    cycle->last_step_m.y = -start->other_m.y;
    cycle->quarter_length = beside
                                ? saddle_half_step(model, saddle_other_side(stance), start->speed)
                                : saddle_position_from_m(-0.5f * start->other_m.x);
    move_to(cycle, beside ? 0 : -cycle->quarter_length);
    set_phase(cycle, phase);
    cycle->quarter = saddle_quarter(model, stance, saddle_position_to_m(cycle->quarter_length),
                                    saddle_magnitude(start->other_m.y), speed_m_s);
    cycle->swing.path_width_m = cycle->quarter.width_m;
    lift_off(cycle, model, start->other_m, speed_m_s, phase);
    if (beside) {
        cycle->quarter = saddle_quarter(model, stance, cycle->quarter.length_m,
                                        saddle_magnitude(cycle->swing.line_y_m), speed_m_s);
    }
    follow_shape(cycle, model, phase, &actual);
    const saddle_sample_t upright = {0.0f, 0.0f};
    lean_towards(cycle, upright, 0.0f);
    if (start->under_way) {
        saddle_way_join(&cycle->way, speed_m_s);
        cycle->lean_m = saddle_lean_m(model, cycle->way.arcs[1].curvature_1_m, speed_m_s);
        cycle->swing.lift_progress = 0.0f;
        cycle->lateral.length_m = 0.0f;
        cycle->vertical.length_m = 0.0f;
    }
}

void saddle_cycle_stand(saddle_cycle_t *cycle, saddle_side_t stance, float stance_y_m)
{
    saddle_way_begin(&cycle->way);
    cycle->quarter.stance = stance;
    cycle->stance_y_m = stance_y_m;
}

void saddle_cycle_set_pace(saddle_cycle_t *cycle, float speed_m_s, float rate_m_s2)
{
    saddle_profile_aim(&cycle->profile, speed_m_s, rate_m_s2);
}

void saddle_cycle_set_last_swing(saddle_cycle_t *cycle, bool last_swing)
{
    cycle->last_swing = last_swing;
}

float saddle_cycle_distance_to_via_point_m(const saddle_cycle_t *cycle)
{
    const saddle_fixed_t end = saddle_cycle_before_landing(cycle) ? cycle->quarter_length : 0;
    return saddle_position_to_m(end - cycle->position);
}

/* Time after which a last swing has come to rest beside the stance foot. */
static bool comes_to_rest(const saddle_cycle_t *cycle, uint32_t dt_us, uint32_t *rest_us)
{
    if (!cycle->last_swing || saddle_cycle_before_landing(cycle) || cycle->profile.target != 0) {
        return false;
    }
    const float speed_m_s = cycle->profile.speed_m_s;
    const float distance_m = saddle_cycle_distance_to_via_point_m(cycle);
    const float time_us = speed_m_s > 0.0f ? 2.0e6f * distance_m / speed_m_s : 0.0f;
    if (time_us < 0.0f || time_us > (float)dt_us) {
        return false;
    }
    *rest_us = dt_us - (uint32_t)time_us;
    return true;
}

/* Progress of the running quarter, [0, 1]. */
static float quarter_progress(const saddle_cycle_t *cycle, float x_m)
{
    const float quarter_m = cycle->quarter.length_m;
    const float since_via_m = saddle_cycle_before_landing(cycle) ? x_m : quarter_m + x_m;
    return saddle_clamp(since_via_m / quarter_m, 0.0f, 1.0f);
}

/* Progress of the swing under way: a quarter is half of it. */
static float swing_progress(const saddle_cycle_t *cycle, float progress)
{
    return 0.5f * progress + (saddle_cycle_before_landing(cycle) ? 0.5f : 0.0f);
}

/* [E45] By as much as its landing is moved, on the way there. */
static void move_foot(const saddle_swing_t *swing, float x_m, float speed_m_s,
                      saddle_swing_state_t *foot)
{
    const saddle_sample_t x = saddle_blend_at(&swing->moving_x, x_m);
    const saddle_sample_t y = saddle_blend_at(&swing->moving_y, x_m);
    foot->position_m.x += swing->moved_m.x + x.value;
    foot->position_m.y += swing->moved_m.y + y.value;
    foot->velocity_m_s.x += x.slope * speed_m_s;
    foot->velocity_m_s.y += y.slope * speed_m_s;
}

static void swing_foot(const saddle_cycle_t *cycle, const saddle_model_t *model, float x_m,
                       saddle_sin_cos_t phase, saddle_swing_state_t *foot)
{
    const bool arrived = x_m > cycle->quarter.length_m; /* and late to land */
    const float speed_m_s = arrived ? 0.0f : cycle->profile.speed_m_s;
    const saddle_swing_place_t place = {
        .progress = swing_progress(cycle, quarter_progress(cycle, x_m)),
        .rate_hz = 0.5f * speed_m_s / cycle->quarter.length_m,
        .speed_m_s = speed_m_s,
        .way = swing_way(cycle, model, saddle_smaller(x_m, cycle->quarter.length_m), phase),
        .landing_x_m = saddle_cycle_before_landing(cycle) ? 2.0f * cycle->quarter.length_m : 0.0f,
    };
    saddle_foot_swing(&cycle->swing, &place, foot);
    if (cycle->swing.moving_x.length_m > 0.0f) {
        move_foot(&cycle->swing, x_m, speed_m_s, foot);
    }
}

/* The step that the swing foot makes if it lands where it is, and the CoM there. */
static SADDLE_NOINLINE saddle_vec2_t step_here(const saddle_cycle_t *cycle,
                                               const saddle_model_t *model, place_t *place)
{
    const float x_m = cycle->x_m;
    const saddle_sin_cos_t phase = saddle_quarter_phase(cycle->quarter.length_m, x_m);
    const place_t reference = reference_at(cycle, model, phase);
    saddle_swing_state_t foot;
    *place = place_at(cycle, &reference, x_m);
    swing_foot(cycle, model, x_m, phase, &foot);
    return (saddle_vec2_t){foot.position_m.x, foot.position_m.y};
}

/* Before or after the saddle via point. */
static SADDLE_NOINLINE void land_here(saddle_cycle_t *cycle, const saddle_model_t *model,
                                      float heel_strike_rad)
{
    place_t place;
    const saddle_vec2_t step_m = step_here(cycle, model, &place);
    const saddle_fixed_t step = saddle_position_from_m(step_m.x);
    const landing_t landing = {
        .step_m = step_m,
        .step_nm = saddle_position_to_nm(step),
        .behind = step - cycle->position,
        .behind_m = saddle_position_to_m(step - cycle->position),
        .onward_m_s = saddle_speed_to_m_s(saddle_profile_speed_after(&cycle->profile, step_m.x)),
    };
    begin_step(cycle, model, &landing, &place, cycle->profile.speed_m_s);
    plan_heel_strike(cycle, model, heel_strike_rad);
}

/* How far the CoM may go on over the stance foot beyond the planned landing: within reach. */
static float late_max_m(const saddle_cycle_t *cycle, const saddle_model_t *model)
{
    const float behind_m = cycle->quarter.length_m + cycle->swing.moved_m.x; /* the landing foot */
    const float within_m = saddle_smaller(LATE_SHARE_MAX * behind_m,
                                          model->body.half_step_max_m - cycle->quarter.length_m);
    return saddle_smaller(model->config.landing_late_s * cycle->profile.speed_m_s, within_m);
}

/* The swing foot, which was to land, is seen in the air, and the CoM not too far ahead of that yet. */
static bool waits_for_foot(const saddle_cycle_t *cycle, const saddle_model_t *model,
                           saddle_fixed_t beyond)
{
    return cycle->foot_is_late && saddle_cycle_before_landing(cycle) &&
           saddle_position_to_m(beyond) <= late_max_m(cycle, model);
}

SADDLE_NOINLINE uint32_t saddle_cycle_advance(saddle_cycle_t *cycle, const saddle_model_t *model,
                                              float heel_strike_rad, uint32_t dt_us, bool *arrived)
{
    uint32_t rest_us = 0;
    *arrived = comes_to_rest(cycle, dt_us, &rest_us);
    if (*arrived) {
        rest_beside_foot(cycle);
        return rest_us;
    }
    const saddle_speed_profile_t before = cycle->profile;
    float distance_m = 0.0f;
    saddle_fixed_t distance = saddle_profile_advance(&cycle->profile, dt_us);
    for (int i = 0; i < VIA_POINTS_A_TICK; i++) {
        const saddle_fixed_t end = saddle_cycle_before_landing(cycle) ? cycle->quarter_length : 0;
        const saddle_fixed_t to_end = end - cycle->position;
        if (distance < to_end || (cycle->last_swing && !saddle_cycle_before_landing(cycle)) ||
            waits_for_foot(cycle, model, distance - to_end)) {
            break;
        }
        if (to_end < 0) { /* it has waited */
            land_here(cycle, model, heel_strike_rad);
            continue;
        }
        distance -= to_end;
        distance_m += saddle_position_to_m(to_end);
        move_to(cycle, end);
        const saddle_fixed_t speed = saddle_profile_speed_after(&before, distance_m);
        if (saddle_cycle_before_landing(cycle)) {
            const float onward_m = distance_m + 2.0f * cycle->quarter.length_m;
            pass_saddle(cycle, model, speed,
                        saddle_way_turns(&cycle->way)
                            ? saddle_profile_speed_after(&before, onward_m)
                            : speed);
            plan_heel_strike(cycle, model, heel_strike_rad);
        } else {
            pass_foot(cycle, model, speed);
        }
    }
    move_to(cycle, cycle->position + distance);
    set_phase(cycle, saddle_quarter_phase(cycle->quarter.length_m, cycle->x_m));
    if (!saddle_cycle_before_landing(cycle) && cycle->position > 0) {
        rest_beside_foot(cycle);
    }
    return 0;
}

/* Progress of the running swing through the air, in the quarter after a landing. */
static float air_after_landing(const saddle_cycle_t *cycle, float x_m)
{
    return 0.5f * (1.0f + x_m / cycle->quarter.length_m) / cycle->swing.land_progress;
}

/* Can the walk go on from a landing of a foot after step_m, with the CoM at com_m from it? */
static bool landing_usable(const saddle_model_t *model, saddle_side_t foot, saddle_vec2_t step_m,
                           saddle_vec2_t com_m)
{
    const float outward = saddle_outward(foot);
    const float reach_m2 = REACH_SHARE * model->body.pendulum_m * model->body.pendulum_m;
    return saddle_in_range(-com_m.x, LANDING_AHEAD_MIN_M, model->body.half_step_max_m) &&
           saddle_in_range(outward * step_m.y, LANDING_WIDTH_MIN_M,
                           2.0f * model->config.step_width_slow_m) &&
           saddle_vec2_dot(com_m, com_m) < reach_m2;
}

/* The measured landing changed the line: what the swing foot is off it from this phase on fades
 * out. */
static void redirect_swing(saddle_cycle_t *cycle, const saddle_model_t *model, saddle_vec2_t foot_m,
                           float speed_m_s, saddle_sin_cos_t phase)
{
    const float x_m = cycle->x_m;
    const float fade = 1.0f - saddle_min_jerk(2.0f * air_after_landing(cycle, x_m));
    saddle_swing_t *swing = &cycle->swing;
    swing->line_y_m =
        swing_line_y_m(cycle, model, saddle_other_side(cycle->quarter.stance), speed_m_s);
    swing->offset_m.x = (foot_m.x - swing_way(cycle, model, x_m, phase).value) / fade;
    swing->offset_m.y = (foot_m.y - swing->line_y_m) / fade;
}

/* A last swing that ends after distance_m comes to rest no harder than allowed. */
static bool can_end(const saddle_cycle_t *cycle, const saddle_model_t *model, float distance_m)
{
    return !cycle->last_swing ||
           saddle_can_brake(cycle->profile.speed_m_s, model->config.acceleration_m_s2, distance_m);
}

/* In the first half of the quarter after a landing. */
static bool just_landed(const saddle_cycle_t *cycle)
{
    return !saddle_cycle_before_landing(cycle) && -2.0f * cycle->x_m >= cycle->quarter.length_m &&
           air_after_landing(cycle, cycle->x_m) <= LANDING_AIR_MAX;
}

SADDLE_NOINLINE bool saddle_cycle_land(saddle_cycle_t *cycle, const saddle_model_t *model,
                                       saddle_vec2_t step_m)
{
    const saddle_side_t stance = cycle->quarter.stance;
    const float dx_m = step_m.x - cycle->last_step_m.x;
    const float dy_m = step_m.y - cycle->last_step_m.y;
    const float old_x_m = cycle->x_m;
    if (!just_landed(cycle)) {
        return false;
    }
    const float x_m = old_x_m - dx_m;
    const float length_m = cycle->quarter.length_m * x_m / old_x_m;
    const saddle_sin_cos_t old_phase = saddle_cycle_phase(cycle);
    const place_t old_reference = reference_at(cycle, model, old_phase);
    place_t place = place_at(cycle, &old_reference, old_x_m);
    place.lateral.value -= dy_m;
    if (x_m < LANDING_STRETCH_MAX * old_x_m ||
        length_m > saddle_larger(model->body.half_step_max_m, cycle->quarter.length_m) ||
        !landing_usable(model, stance, step_m, (saddle_vec2_t){x_m, place.lateral.value}) ||
        (x_m > old_x_m && !can_end(cycle, model, -x_m))) {
        return false;
    }
    const saddle_sample_t lean = lean_at(cycle, old_x_m);
    saddle_swing_state_t foot;
    swing_foot(cycle, model, old_x_m, old_phase, &foot);
    const saddle_vec2_t swing_m = {foot.position_m.x - dx_m, foot.position_m.y - dy_m};
    move_to(cycle, saddle_position_from_m(x_m));
    cycle->quarter_length = saddle_position_from_m(length_m);
    saddle_way_shift(&cycle->way, dx_m);
    cycle->stance_y_m += dy_m;
    cycle->last_step_m = step_m;
    const float speed_m_s = cycle->profile.speed_m_s;
    cycle->quarter = saddle_quarter(model, stance, length_m, saddle_magnitude(step_m.y), speed_m_s);
    const saddle_sin_cos_t phase = saddle_quarter_phase(length_m, cycle->x_m);
    set_phase(cycle, phase);
    follow_shape(cycle, model, phase, &place);
    lean_towards(cycle, lean, cycle->lean_m);
    redirect_swing(cycle, model, swing_m, speed_m_s, phase);
    return true;
}

SADDLE_NOINLINE bool saddle_cycle_reshape(saddle_cycle_t *cycle, const saddle_model_t *model,
                                          const saddle_model_t *reshaped)
{
    if (!just_landed(cycle)) {
        return false;
    }
    const float x_m = cycle->x_m;
    const float speed_m_s = cycle->profile.speed_m_s;
    const saddle_sin_cos_t phase = saddle_cycle_phase(cycle);
    const place_t reference = reference_at(cycle, model, phase);
    const place_t place = place_at(cycle, &reference, x_m);
    saddle_swing_state_t foot;
    swing_foot(cycle, model, x_m, phase, &foot);
    const saddle_vec2_t swing_m = {foot.position_m.x, foot.position_m.y};
    cycle->quarter = saddle_quarter(reshaped, cycle->quarter.stance, cycle->quarter.length_m,
                                    cycle->quarter.width_m, speed_m_s);
    follow_shape(cycle, reshaped, phase, &place);
    redirect_swing(cycle, reshaped, swing_m, speed_m_s, phase);
    return true;
}

/* By how much the swing foot is moved along an axis, and its change with the CoM's x. */
static saddle_sample_t moved_at(float moved_m, const saddle_blend_t *moving, float x_m)
{
    const saddle_sample_t landing = {moved_m, 0.0f};
    return sum(landing, saddle_blend_at(moving, x_m));
}

/* [E45] */
SADDLE_NOINLINE void saddle_cycle_place(saddle_cycle_t *cycle, const saddle_model_t *model,
                                        saddle_vec2_t step_m)
{
    saddle_swing_t *swing = &cycle->swing;
    const float x_m = cycle->x_m;
    const float half_m = cycle->quarter.length_m;
    const float left_m = half_m - x_m;
    const float left_s = left_m / shaping_speed_m_s(cycle);
    if (!saddle_cycle_before_landing(cycle) || left_s < PLACEMENT_FROZEN_S) {
        return;
    }
    const saddle_sample_t x = moved_at(swing->moved_m.x, &swing->moving_x, x_m);
    const saddle_sample_t y = moved_at(swing->moved_m.y, &swing->moving_y, x_m);
    const float way_m = left_s * PLACEMENT_SPEED_M_S;
    const float moved_x_m =
        saddle_clamp(step_m.x - 2.0f * half_m, x.value - way_m, x.value + way_m);
    const float moved_y_m =
        saddle_clamp(step_m.y - swing->line_y_m, y.value - way_m, y.value + way_m);
    const float ahead_min_m = cycle->last_swing ? half_m : LANDING_AHEAD_MIN_M; /* to brake on */
    const float outward = saddle_outward(saddle_other_side(cycle->quarter.stance));
    const float line_m = saddle_magnitude(swing->line_y_m);
    swing->moved_m.x =
        saddle_clamp(moved_x_m, ahead_min_m - half_m, model->body.half_step_max_m - half_m);
    swing->moved_m.y = outward * saddle_clamp(outward * moved_y_m, LANDING_WIDTH_MIN_M - line_m,
                                              2.0f * model->config.step_width_slow_m - line_m);
    swing->moving_x = saddle_blend(x, (saddle_sample_t){swing->moved_m.x, 0.0f}, x_m, left_m);
    swing->moving_y = saddle_blend(y, (saddle_sample_t){swing->moved_m.y, 0.0f}, x_m, left_m);
}

/* [E43] */
bool saddle_cycle_touch_down(saddle_cycle_t *cycle, const saddle_model_t *model,
                             float heel_strike_rad)
{
    place_t place;
    const saddle_vec2_t step_m = step_here(cycle, model, &place);
    const saddle_vec2_t com_m = {cycle->x_m - step_m.x, place.lateral.value - step_m.y};
    if (!landing_usable(model, saddle_other_side(cycle->quarter.stance), step_m, com_m)) {
        return false;
    }
    land_here(cycle, model, heel_strike_rad);
    set_phase(cycle, SADDLE_PHASE_LANDED);
    return true;
}

/* The ankles of the erf and rigid models, and the height they give. */
static void erf_height(const saddle_cycle_t *cycle, const saddle_model_t *model, float to_saddle_m,
                       float speed_m_s, saddle_pose_t *pose)
{
    const float shaped_m_s = shaping_speed_m_s(cycle);
    const bool before = saddle_cycle_before_landing(cycle);
    const float time_s = (before ? -to_saddle_m : to_saddle_m) / shaped_m_s;
    const saddle_vec2_t offset_m = {pose->com_m.x, pose->com_m.y};
    const saddle_vec2_t velocity_m_s = {pose->com_velocity_m_s.x, pose->com_velocity_m_s.y};
    saddle_ankle(model, &cycle->transition, time_s + cycle->transition.strike.lead_m / shaped_m_s,
                 before, &pose->ankle);
    pose->ankle_limited = cycle->transition.toe_off_limited || pose->ankle.limited;
    pose->ankle.leg_rate_m_s *= speed_m_s / shaped_m_s;
    saddle_com_height(&pose->ankle, offset_m, velocity_m_s, &pose->com_m.z,
                      &pose->com_velocity_m_s.z);
}

/* The cycloid's height, and the ankles that give it. */
static void cycloid_height(const saddle_cycle_t *cycle, const saddle_model_t *model,
                           saddle_pose_t *pose)
{
    const saddle_sample_t vertical = sum(vertical_at(cycle, model, saddle_cycle_phase(cycle)),
                                         saddle_blend_at(&cycle->vertical, pose->com_m.x));
    const saddle_vec3_t *com = &pose->com_m;
    pose->com_m.z = vertical.value;
    pose->com_velocity_m_s.z = vertical.slope * pose->com_velocity_m_s.x;
    pose->ankle_limited = !saddle_ankle_for_leg(model, length_m(com->x, com->y, com->z),
                                                saddle_cycle_before_landing(cycle), &pose->ankle);
}

/* The foot angle with which the swing foot will land, heel first. */
static float landing_angle_rad(const saddle_cycle_t *cycle, const saddle_model_t *model)
{
    if (model->config.ankle != SADDLE_ANKLE_CYCLOID) {
        return angles_at_saddle(cycle, model).heel_strike_rad;
    }
    const saddle_quarter_t *quarter = &cycle->quarter;
    const place_t landing = reference_at(cycle, model, SADDLE_PHASE_LANDING);
    const float y_m = landing.lateral.value + saddle_outward(quarter->stance) * quarter->width_m;
    saddle_ankle_state_t ankle;
    (void)saddle_ankle_for_leg(model, length_m(quarter->length_m, y_m, landing.vertical.value),
                               false, &ankle);
    return ankle.heel_strike_rad;
}

/* The sole turns flat until mid-swing and to the landing angle after it. */
static float swing_pitch_rad(const saddle_cycle_t *cycle, const saddle_model_t *model,
                             float progress)
{
    if (!saddle_cycle_before_landing(cycle)) {
        return cycle->lift_pitch_rad * (1.0f - saddle_min_jerk(2.0f * progress));
    }
    return -landing_angle_rad(cycle, model) * saddle_min_jerk(2.0f * progress - 1.0f);
}

saddle_sample_t saddle_cycle_lean(const saddle_cycle_t *cycle)
{
    return lean_at(cycle, cycle->x_m);
}

float saddle_cycle_com_y_m(const saddle_cycle_t *cycle, const saddle_model_t *model)
{
    return lateral_at(cycle, model, saddle_cycle_phase(cycle)).value +
           saddle_blend_at(&cycle->lateral, cycle->x_m).value + lean_at(cycle, cycle->x_m).value;
}

float saddle_cycle_strike_lead_m(const saddle_cycle_t *cycle, const saddle_model_t *model,
                                 float half_step_m)
{
    return model->config.strike_share > 0.0f ? model->body.strike_lead * half_step_m
                                             : cycle->next_strike.lead_m;
}

void saddle_cycle_pose(const saddle_cycle_t *cycle, const saddle_model_t *model,
                       saddle_pose_t *pose)
{
    const float speed_m_s = cycle->profile.speed_m_s;
    const float x_m = cycle->x_m;
    const float quarter_m = cycle->quarter.length_m;
    const bool before = saddle_cycle_before_landing(cycle);
    const saddle_sin_cos_t phase = saddle_cycle_phase(cycle);
    const saddle_sample_t lateral =
        sum(sum(lateral_at(cycle, model, phase), saddle_blend_at(&cycle->lateral, x_m)),
            lean_at(cycle, x_m));
    const float to_saddle_m = before ? quarter_m - x_m : quarter_m + x_m;
    pose->progress = quarter_progress(cycle, x_m);
    pose->com_m.x = x_m;
    pose->com_m.y = lateral.value;
    pose->com_velocity_m_s.x = speed_m_s;
    pose->com_velocity_m_s.y = lateral.slope * speed_m_s;
    if (model->config.ankle == SADDLE_ANKLE_CYCLOID) {
        cycloid_height(cycle, model, pose);
    } else {
        erf_height(cycle, model, to_saddle_m, speed_m_s, pose);
    }
    const float progress = swing_progress(cycle, pose->progress);
    swing_foot(cycle, model, x_m, phase, &pose->swing);
    pose->stance_pitch_rad = before ? pose->ankle.toe_off_rad : -pose->ankle.heel_strike_rad;
    pose->swing_pitch_rad = swing_pitch_rad(cycle, model, progress);
}
