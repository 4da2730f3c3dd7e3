#include "motion/reference.h"

#include "math/bytes.h"
#include "math/elementary.h"
#include "math/vec2.h"
#include "motion/way.h"

#include <math.h>

/* Slower steps are shaped as if this fast, and shorter swings as if this long. */
#define SPEED_MIN_M_S 0.01f
#define SWING_MIN_S 0.05f

/* How far inward from a foot's middle one stands on it, of the foot's half width: what is left is to
 * balance by, and to come to rest there, [E42]. */
#define STANDING_INWARD 0.85f

/* And how far behind it, of half the length, if the other foot stands behind. */
#define STANDING_BEHIND 0.67f

/* Speed at a landing that is nearer than this is the present one. */
#define LANDING_NOW_S 1.0e-3f

/* A step, from the landing on its stance CoP to the next landing. */
typedef struct {
    saddle_side_t stance;
    float x_m, y_m;       /* its stance CoP, in the plan's frame */
    saddle_vec2_t made_m; /* the step that led to it, forward and outward */
    saddle_vec2_t next_m; /* the step that follows, forward and inward */
    float speed_m_s, acceleration_m_s2;
    float progress; /* [0, 1] */
} step_t;

/* What exponentials have decayed to, per natural frequency times duration: kappa. */
typedef struct {
    float kappa;
    float crossing, rolling, step; /* while the CoP crosses to the new foot, on it, and in all */
} decay_t;

/* [E39] Where a step is. Those before it count as like it, those after it as like the next one. */
typedef struct {
    decay_t now, next;
    float share;     /* of a step in which the CoP crosses */
    float since_end; /* progress since the end of crossing or rolling, <= 0 */
    float growth;    /* until then: exp(kappa since_end) */
    bool crosses;
} phase_t;

/* One axis of a step: the CoP at the landing, on the new foot and before the next landing. The steps
 * to follow move it on by next from one foot to the other and repeat so or mirrored: sign. */
typedef struct {
    float start, enter, leave;
    float next, sign;
} axis_t;

/* Along one axis: x = (advancing + receding) / 2. */
typedef struct {
    float cop;
    float advancing;  /* XCoM */
    float receding;   /* the point x - v / w, which converges */
    float speed_rate; /* of the XCoM, per relative change of speed */
} state_t;

static decay_t decay_in(float kappa, float share)
{
    decay_t decay_of;
    decay_of.kappa = kappa;
    decay_of.crossing = saddle_decay(kappa * share);
    decay_of.rolling = saddle_decay(kappa * (1.0f - share));
    decay_of.step = decay_of.crossing * decay_of.rolling;
    return decay_of;
}

/* [E39] */
static void phase_of(const saddle_model_t *model, const step_t *step, phase_t *phase)
{
    const float share = model->config.double_support_share;
    const float per_m =
        model->body.natural_frequency_rad_s / saddle_larger(step->speed_m_s, SPEED_MIN_M_S);
    const float length_m = 0.5f * (step->made_m.x + step->next_m.x);
    phase->share = share;
    phase->now = decay_in(per_m * length_m, share);
    phase->next = length_m == step->next_m.x ? phase->now : decay_in(per_m * step->next_m.x, share);
    phase->crosses = step->progress < share;
    phase->since_end = step->progress - (phase->crosses ? share : 1.0f);
    phase->growth = saddle_decay(-phase->now.kappa * phase->since_end);
}

/* [E39] */
static void state_in(const axis_t *axis, const phase_t *phase, state_t *state)
{
    const decay_t *now = &phase->now;
    const decay_t *next = &phase->next;
    const float crossing = (axis->enter - axis->start) / phase->share;
    const float rolling = (axis->leave - axis->enter) / (1.0f - phase->share);
    const float per_kappa = 1.0f / now->kappa;
    const float jump = (crossing - rolling) * per_kappa;
    const float next_per_kappa = 1.0f / next->kappa;
    const float next_jump = (axis->next / phase->share - rolling) * next_per_kappa;
    const float periodic = axis->sign / (1.0f - axis->sign * next->step);
    const float end = next_jump * (1.0f - next->crossing) * periodic;
    const float begin = jump * (1.0f - axis->sign * now->rolling) / (1.0f - axis->sign * now->step);
    const float end_rate =
        end * (1.0f + next->kappa * (next->step * periodic -
                                     phase->share * next->crossing / (1.0f - next->crossing)));
    const float slope = (phase->crosses ? crossing : rolling) * per_kappa;
    float offset = end;
    float offset_rate = end_rate;
    float recedes = (begin * now->crossing - jump) * now->rolling;
    float from = axis->leave;
    if (phase->crosses) {
        offset = end * now->rolling - jump;
        offset_rate = (end_rate + (1.0f - phase->share) * now->kappa * end) * now->rolling - jump;
        recedes = begin * now->crossing;
        from = axis->enter;
    }
    state->cop = from + slope * now->kappa * phase->since_end;
    state->advancing = state->cop + slope + offset * phase->growth;
    state->receding = state->cop - slope + recedes / phase->growth;
    state->speed_rate =
        slope + (offset_rate - now->kappa * phase->since_end * offset) * phase->growth;
}

/* [E40] Where the CoP leaves the foot: a walk that brakes needs some of the toes for it. */
static float leave_m(const saddle_model_t *model, float acceleration_m_s2)
{
    const float w = model->body.natural_frequency_rad_s;
    const float range_m = model->config.cop_range_m;
    const float braking_m = saddle_larger(-acceleration_m_s2, 0.0f) / (w * w);
    return saddle_clamp(range_m - braking_m, -range_m, model->config.cop_leave * range_m);
}

/* The step as the axes have it: x from the stance CoP, y outward from it. */
typedef struct {
    state_t x, y;
    float carried; /* share of the load that the stance foot carries */
} motion_t;

static void motion_in(const saddle_model_t *model, const step_t *step, motion_t *motion)
{
    const float leave = leave_m(model, step->acceleration_m_s2);
    const float enter = model->config.cop_enter * model->config.cop_range_m;
    const axis_t along = {leave - step->made_m.x, enter, leave, step->next_m.x + enter - leave,
                          1.0f};
    const axis_t across = {-step->made_m.y, 0.0f, 0.0f, step->next_m.y, -1.0f};
    phase_t phase;
    phase_of(model, step, &phase);
    state_in(&along, &phase, &motion->x);
    state_in(&across, &phase, &motion->y);
    motion->carried = phase.crosses ? step->progress / phase.share : 1.0f;
}

static void place(const step_t *step, float x_m, float y_m, saddle_vec2_t *point)
{
    point->x = step->x_m + x_m;
    point->y = step->y_m + saddle_outward(step->stance) * y_m;
}

static void write(const step_t *step, const motion_t *motion, saddle_reference_t *reference)
{
    place(step, 0.5f * (motion->x.advancing + motion->x.receding),
          0.5f * (motion->y.advancing + motion->y.receding), &reference->com_m);
    place(step, motion->x.advancing, motion->y.advancing, &reference->xcom_m);
    place(step, motion->x.cop, motion->y.cop, &reference->cop_m);
    reference->load[step->stance] = motion->carried;
    reference->load[saddle_other_side(step->stance)] = 1.0f - motion->carried;
}

/* The CoP moved by shift, but no further than range from the middle of the soles. */
static float shifted(float cop, float shift, float middle, float range)
{
    return saddle_clamp(cop + shift, middle - range, middle + range);
}

/* [E39] [E40] */
static void walk(const saddle_model_t *model, const step_t *step, saddle_reference_t *reference)
{
    const float relative =
        step->acceleration_m_s2 /
        (saddle_larger(step->speed_m_s, SPEED_MIN_M_S) * model->body.natural_frequency_rad_s);
    motion_t motion;
    motion_in(model, step, &motion);
    const float behind = 1.0f - motion.carried;
    motion.x.cop = shifted(motion.x.cop, -relative * motion.x.speed_rate, -behind * step->made_m.x,
                           model->config.cop_range_m);
    motion.y.cop = shifted(motion.y.cop, -relative * motion.y.speed_rate, -behind * step->made_m.y,
                           model->config.cop_shift_ml_m);
    write(step, &motion, reference);
}

/* Forward, and outward for a foot. */
static saddle_vec2_t forward_and_outward(saddle_vec2_t step_m, saddle_side_t foot)
{
    const saddle_vec2_t turned_m = {step_m.x, saddle_outward(foot) * step_m.y};
    return turned_m;
}

saddle_vec2_t saddle_unmoved_landing_m(const saddle_plan_t *plan)
{
    const saddle_side_t stance = (saddle_side_t)plan->support;
    if (plan->phase % 2u != 0u || plan->step_length_m == 0.0f) {
        return plan->landing_m;
    }
    const float across_m = saddle_outward(saddle_other_side(stance)) * plan->step_width_m;
    return (saddle_vec2_t){plan->step_length_m, plan->foot_m[stance].y + across_m};
}

/* The step under way; where in it is left to the caller. From the foot via point on its landing may be
 * moved, [E45], but not in the reference. */
static step_t running_step(const saddle_plan_t *plan, float speed_m_s)
{
    const saddle_side_t stance = (saddle_side_t)plan->support;
    const saddle_side_t other = saddle_other_side(stance);
    const saddle_vec2_t landing_m = saddle_unmoved_landing_m(plan);
    const saddle_vec2_t next_m = {landing_m.x, landing_m.y - plan->foot_m[stance].y};
    step_t step;
    step.stance = stance;
    step.x_m = 0.0f;
    step.y_m = plan->foot_m[stance].y;
    step.made_m = forward_and_outward(plan->last_step_m, stance);
    step.next_m = forward_and_outward(next_m, other);
    step.speed_m_s = speed_m_s;
    step.acceleration_m_s2 = plan->acceleration_m_s2;
    step.progress = 0.0f;
    return step;
}

/* The step after it, at its begin: as long and wide as the one that leads to it. */
static step_t step_after(const step_t *running, float speed_m_s)
{
    step_t step = *running;
    step.stance = saddle_other_side(running->stance);
    step.x_m = running->x_m + running->next_m.x;
    step.y_m = running->y_m - saddle_outward(running->stance) * running->next_m.y;
    step.made_m = running->next_m;
    step.speed_m_s = speed_m_s;
    step.progress = 0.0f;
    return step;
}

/* The step that a walk is in after_s after a plan. */
static step_t step_at(const saddle_plan_t *plan, float after_s)
{
    const float gained_m_s = plan->acceleration_m_s2 * after_s;
    const float speed_m_s = saddle_larger(plan->speed_m_s + gained_m_s, 0.0f);
    const float x_m = plan->com_m.x + (plan->speed_m_s + 0.5f * gained_m_s) * after_s;
    step_t step = running_step(plan, speed_m_s);
    float since_m = x_m + 0.5f * step.made_m.x;
    if (x_m >= 0.5f * step.next_m.x) {
        since_m = x_m - 0.5f * step.next_m.x;
        step = step_after(&step, speed_m_s);
    }
    step.progress = saddle_clamp(2.0f * since_m / (step.made_m.x + step.next_m.x), 0.0f, 1.0f);
    return step;
}

/* Where a wearer stands on one foot alone before a walk and after it, from that foot, forward and
 * outward: where the plan has its CoM, but over the foot. made_m: to it from the other foot. */
static saddle_vec2_t standing_place_m(const saddle_model_t *model, saddle_vec2_t made_m)
{
    const saddle_config_t *config = &model->config;
    const float planned_m = (0.5f - 1.0f / SADDLE_PI) * made_m.y;
    const bool apart = made_m.x > config->half_step_intercept_m;
    saddle_vec2_t place_m;
    place_m.x = apart ? -STANDING_BEHIND * config->cop_range_m : 0.0f;
    place_m.y = -saddle_smaller(planned_m, STANDING_INWARD * config->cop_shift_ml_m);
    return place_m;
}

/* Where a first swing began, at rest, and when. */
typedef struct {
    saddle_vec2_t begin_m;
    float elapsed_s, left_s;
} first_swing_t;

/* What decays in the time since then, in the time that is left, and in both. */
typedef struct {
    float elapsed, left, whole;
} swing_decay_t;

/* The plan begins beside the stance foot, or where the feet were apart midway between them. */
static first_swing_t first_swing_of(const saddle_model_t *model, const saddle_plan_t *plan,
                                    const step_t *step)
{
    const bool apart = step->made_m.x > model->config.half_step_intercept_m;
    const float begin_m = apart ? -0.5f * step->made_m.x : 0.0f;
    const float run_up_m =
        plan->speed_m_s * plan->speed_m_s / (2.0f * model->config.acceleration_m_s2);
    first_swing_t first;
    first.begin_m = standing_place_m(model, step->made_m);
    first.elapsed_s = plan->speed_m_s / model->config.acceleration_m_s2 +
                      saddle_larger(plan->com_m.x - begin_m - run_up_m, 0.0f) /
                          saddle_larger(plan->speed_m_s, SPEED_MIN_M_S);
    first.left_s = plan->time_to_toe_off_s;
    return first;
}

/* [E41] Along one axis, from rest at begin to an XCoM at the landing, about a CoP that stays. */
static void fall(float begin, float landing, float range, const swing_decay_t *decay,
                 state_t *state)
{
    const float wanted = begin - (landing - begin) * decay->whole / (1.0f - decay->whole);
    state->cop = saddle_clamp(wanted, -range, range);
    state->advancing = state->cop + (landing - state->cop) * decay->left;
    state->receding = state->cop + (begin - state->cop) * decay->elapsed;
}

/* Speed at the landing of a first swing: it has changed evenly until then. */
static float landing_speed_m_s(const saddle_plan_t *plan)
{
    if (plan->time_to_toe_off_s < LANDING_NOW_S) {
        return plan->speed_m_s;
    }
    const float way_m = 0.5f * saddle_unmoved_landing_m(plan).x - plan->com_m.x;
    return saddle_larger(2.0f * way_m / plan->time_to_toe_off_s - plan->speed_m_s, SPEED_MIN_M_S);
}

/* [E41] */
static void begin_walk(const saddle_model_t *model, const saddle_plan_t *plan, float after_s,
                       saddle_reference_t *reference)
{
    const float w = model->body.natural_frequency_rad_s;
    const float landing_m_s = landing_speed_m_s(plan);
    const step_t step = running_step(plan, plan->speed_m_s);
    step_t next = step_after(&step, landing_m_s);
    first_swing_t first = first_swing_of(model, plan, &step);
    if (after_s >= first.left_s) {
        const float since_m = (after_s - first.left_s) * landing_m_s;
        next.progress = saddle_clamp(since_m / next.next_m.x, 0.0f, 1.0f);
        walk(model, &next, reference);
        return;
    }
    first.left_s -= after_s;
    first.elapsed_s += after_s;
    const swing_decay_t decay = {
        saddle_decay(w * first.elapsed_s),
        saddle_decay(w * first.left_s),
        saddle_decay(w * (first.elapsed_s + first.left_s)),
    };
    motion_t landed, motion;
    motion_in(model, &next, &landed);
    fall(first.begin_m.x, step.next_m.x + landed.x.advancing, model->config.cop_range_m, &decay,
         &motion.x);
    fall(first.begin_m.y, -step.next_m.y - landed.y.advancing, model->config.cop_shift_ml_m, &decay,
         &motion.y);
    motion.carried = 1.0f;
    write(&step, &motion, reference);
}

/* A last swing: what decays until the crossing ends, then until the swing does, and where it is. */
typedef struct {
    float crossing_s; /* from its begin, at the landing, until the new foot carries */
    float crossing, standing, growth, recedes;
    float share; /* of the crossing; 1 after it */
    float w;
} last_swing_t;

static last_swing_t last_swing_of(const saddle_model_t *model, float elapsed_s, float left_s)
{
    const float w = model->body.natural_frequency_rad_s;
    last_swing_t last;
    last.w = w;
    last.crossing_s = model->config.double_support_share * (elapsed_s + left_s);
    last.share = saddle_smaller(elapsed_s / last.crossing_s, 1.0f);
    last.crossing = saddle_decay(w * last.crossing_s);
    last.standing = saddle_decay(w * (elapsed_s + left_s - last.crossing_s));
    if (last.share < 1.0f) {
        last.growth = saddle_decay(w * (last.crossing_s - elapsed_s));
        last.recedes = last.crossing / last.growth;
    } else {
        last.growth = saddle_decay(w * left_s);
        last.recedes = last.standing / last.growth;
    }
    return last;
}

/* [E41] Along one axis, from what the landing begins with to rest at end, about a CoP that crosses to
 * the new foot and stays there. */
static state_t come_to_rest(const state_t *landed, float end, float range, const last_swing_t *last)
{
    const float mean = (1.0f - last->crossing) / (last->w * last->crossing_s);
    const float over = last->standing * last->crossing;
    const float wanted =
        (landed->advancing - landed->cop * (1.0f - mean) - end * over) / (mean - over);
    const float cop = saddle_clamp(wanted, -range, range);
    const float ahead = (cop - landed->cop) / (last->w * last->crossing_s);
    const float begun = landed->receding - landed->cop + ahead;
    state_t state;
    if (last->share < 1.0f) {
        state.cop = landed->cop + last->share * (cop - landed->cop);
        state.advancing = state.cop + ahead + ((end - cop) * last->standing - ahead) * last->growth;
        state.receding = state.cop - ahead + begun * last->recedes;
    } else {
        state.cop = cop;
        state.advancing = cop + (end - cop) * last->growth;
        state.receding = cop + (begun * last->crossing - ahead) * last->recedes;
    }
    state.speed_rate = 0.0f;
    return state;
}

/* [E41] It brakes evenly: of the way that is left follows how long it has lasted. */
static void end_walk(const saddle_model_t *model, const saddle_plan_t *plan, float after_s,
                     saddle_reference_t *reference)
{
    step_t step = running_step(plan, plan->speed_m_s);
    const float way_share = saddle_clamp(-2.0f * plan->com_m.x / step.made_m.x, 0.0f, 1.0f);
    const float root = sqrtf(way_share);
    const float total_s =
        saddle_larger(root > 0.0f ? plan->time_to_via_point_s / root : 0.0f, SWING_MIN_S);
    const float left_s = saddle_clamp(plan->time_to_via_point_s - after_s, 0.0f, total_s);
    const last_swing_t last = last_swing_of(model, total_s - left_s, left_s);
    const saddle_vec2_t beside_m = {0.0f, step.next_m.y};
    const float rest_m = standing_place_m(model, beside_m).y;
    step.next_m = step.made_m;
    step.speed_m_s = step.made_m.x / total_s;
    motion_t landed;
    motion_in(model, &step, &landed);
    motion_t motion;
    motion.x = come_to_rest(&landed.x, 0.0f, model->config.cop_range_m, &last);
    motion.y = come_to_rest(&landed.y, rest_m, model->config.cop_shift_ml_m, &last);
    motion.carried = last.share;
    write(&step, &motion, reference);
}

/* The point of the feet that is nearest to the CoP, and what each foot carries then. [E42] */
static void support(const saddle_model_t *model, const saddle_plan_t *plan,
                    saddle_reference_t *reference)
{
    const saddle_side_t stance = (saddle_side_t)plan->support;
    const saddle_side_t other = saddle_other_side(stance);
    const saddle_vec2_t stance_m = {plan->foot_m[stance].x, plan->foot_m[stance].y};
    const saddle_vec2_t apart_m = {plan->foot_m[other].x - stance_m.x,
                                   plan->foot_m[other].y - stance_m.y};
    const saddle_vec2_t cop_m = saddle_vec2_sub(reference->cop_m, stance_m);
    const float share = saddle_clamp(
        saddle_vec2_dot(cop_m, apart_m) / saddle_vec2_dot(apart_m, apart_m), 0.0f, 1.0f);
    const saddle_vec2_t middle_m = saddle_vec2_scale(share, apart_m);
    const float range_m = model->config.cop_range_m;
    const float half_width_m = model->config.cop_shift_ml_m;
    reference->cop_m.x =
        stance_m.x + middle_m.x + saddle_clamp(cop_m.x - middle_m.x, -range_m, range_m);
    reference->cop_m.y =
        stance_m.y + middle_m.y + saddle_clamp(cop_m.y - middle_m.y, -half_width_m, half_width_m);
    reference->load[other] = share;
    reference->load[stance] = 1.0f - share;
}

/* [E42] Half of the time faster, half of it slower: so the CoP needs to leave the feet least. */
static void shift(const saddle_model_t *model, float share, saddle_vec2_t way_m,
                  saddle_reference_t *reference)
{
    const float w = model->body.natural_frequency_rad_s;
    const float per_s = 1.0f / (w * model->config.shift_time_s);
    const bool later = share > 0.5f;
    const float rest = later ? 1.0f - share : share;
    const float way = later ? 1.0f - 2.0f * rest * rest : 2.0f * rest * rest;
    const float fall = (later ? -4.0f : 4.0f) * per_s * per_s;
    reference->com_m = saddle_vec2_add(reference->com_m, saddle_vec2_scale(way, way_m));
    reference->xcom_m =
        saddle_vec2_add(reference->com_m, saddle_vec2_scale(4.0f * rest * per_s, way_m));
    reference->cop_m = saddle_vec2_sub(reference->com_m, saddle_vec2_scale(fall, way_m));
}

/* [E42] */
static void stand(const saddle_model_t *model, const saddle_plan_t *plan, float after_s,
                  saddle_reference_t *reference)
{
    const saddle_side_t stance = (saddle_side_t)plan->support;
    const saddle_vec3_t *stance_m = &plan->foot_m[stance];
    const saddle_vec3_t *other_m = &plan->foot_m[saddle_other_side(stance)];
    const saddle_vec2_t apart_m = {stance_m->x - other_m->x, stance_m->y - other_m->y};
    const saddle_vec2_t middle_m = {0.5f * (stance_m->x + other_m->x),
                                    0.5f * (stance_m->y + other_m->y)};
    const saddle_vec2_t on_foot_m =
        forward_and_outward(standing_place_m(model, forward_and_outward(apart_m, stance)), stance);
    const saddle_vec2_t way_m = saddle_vec2_add(saddle_vec2_scale(0.5f, apart_m), on_foot_m);
    const float left_s = saddle_larger(plan->time_to_via_point_s - after_s, 0.0f);
    const float left = saddle_smaller(left_s / model->config.shift_time_s, 1.0f);
    reference->com_m = middle_m;
    reference->xcom_m = middle_m;
    reference->cop_m = middle_m;
    if (plan->mode == (uint8_t)SADDLE_MODE_STARTING) {
        shift(model, 1.0f - left, way_m, reference);
    } else if (left > 0.0f) {
        reference->com_m = saddle_vec2_add(middle_m, way_m);
        shift(model, 1.0f - left, saddle_vec2_scale(-1.0f, way_m), reference);
    }
    support(model, plan, reference);
}

SADDLE_NOINLINE void saddle_reference(const saddle_model_t *model, const saddle_plan_t *plan,
                                      float after_s, saddle_reference_t *reference)
{
    if (plan->step_length_m == 0.0f) { /* no step is under way */
        stand(model, plan, after_s, reference);
    } else if (plan->mode == (uint8_t)SADDLE_MODE_STARTING) {
        begin_walk(model, plan, after_s, reference);
    } else if (!(plan->landing_m.x > 0.0f)) {
        end_walk(model, plan, after_s, reference);
    } else {
        const step_t step = step_at(plan, after_s);
        walk(model, &step, reference);
    }
}

/* [E49] From the CoP that moves the pendulum so, to its CoM. lever_m: where the way is straight, along and
 * across it; rate_m: of the CoM, per natural frequency; n: its distance from the line, of the radius. */
static saddle_vec2_t bent_lever_m(saddle_vec2_t lever_m, saddle_vec2_t rate_m, float curvature_1_m,
                                  float n)
{
    return (saddle_vec2_t){
        (1.0f - n) * lever_m.x - 2.0f * curvature_1_m * rate_m.x * rate_m.y,
        lever_m.y + (1.0f - n) * curvature_1_m * rate_m.x * rate_m.x,
    };
}

void saddle_reference_bend(const saddle_model_t *model, const saddle_plan_t *plan,
                           saddle_reference_t *reference)
{
    const float w = model->body.natural_frequency_rad_s;
    const saddle_vec2_t rate_m = saddle_vec2_sub(reference->xcom_m, reference->com_m);
    const saddle_vec2_t lever_m = saddle_vec2_sub(reference->com_m, reference->cop_m);
    const float curvature_1_m = plan->curvature_1_m[reference->com_m.x < 0.0f ? 0 : 1];
    saddle_course_t com = {reference->com_m, saddle_vec2_scale(w, rate_m)};
    saddle_arc_t arcs[2];
    saddle_way_of(plan, arcs);
    com.place_m.y += saddle_lean_m(model, curvature_1_m, plan->speed_m_s);
    const saddle_on_ground_t ground = saddle_way_to_ground(arcs, &com);
    const saddle_vec2_t bent_m =
        bent_lever_m(lever_m, rate_m, curvature_1_m, curvature_1_m * com.place_m.y);
    const saddle_sin_cos_t yaw = saddle_sin_cos(ground.yaw_rad);
    reference->com_m = ground.position_m;
    reference->xcom_m =
        saddle_vec2_add(ground.position_m, saddle_vec2_scale(1.0f / w, ground.velocity_m_s));
    reference->cop_m.x = ground.position_m.x - (yaw.cos * bent_m.x - yaw.sin * bent_m.y);
    reference->cop_m.y = ground.position_m.y - (yaw.sin * bent_m.x + yaw.cos * bent_m.y);
}

void saddle_reference_after_plan(const saddle_model_t *model, const saddle_plan_t *plan,
                                 float after_s, saddle_reference_t *reference)
{
    if (plan->curvature_1_m[0] == 0.0f && plan->curvature_1_m[1] == 0.0f) {
        saddle_reference(model, plan, after_s, reference);
        return;
    }
    const saddle_vec2_t com_m = {plan->com_m.x, plan->com_m.y};
    const saddle_vec2_t stance_m = {plan->foot_m[plan->support].x, plan->foot_m[plan->support].y};
    saddle_arc_t arcs[2];
    saddle_plan_t along;
    saddle_copy(&along, plan, sizeof along);
    saddle_way_of(plan, arcs);
    along.com_m.x = saddle_way_from_ground(arcs, com_m).x;
    along.landing_m = saddle_way_from_ground(arcs, plan->landing_m);
    along.last_step_m = saddle_vec2_sub(
        stance_m, saddle_way_from_ground(arcs, saddle_vec2_sub(stance_m, plan->last_step_m)));
    saddle_reference(model, &along, after_s, reference);
    saddle_reference_bend(model, plan, reference);
}
