#include "gait_learner.h"

#define PI 3.14159265f

#define NO_STANCE 2u

/* Limits by which the plan is not the steady walk that its speed says. */
#define NOT_AS_COMMANDED ((uint32_t)SADDLE_LIMIT_TICK_GAP | (uint32_t)SADDLE_LIMIT_SAFE_STOP)

/* A departure that is larger is no matter of shape. */
#define DEPARTURE_MAX_M 0.1f

/* Fewer ticks show no wave. */
#define SAMPLES_MIN 6.0f

/* Directions shorter than this, in m or m/s, are noise. */
#define DIRECTION_MIN 1.0e-3f

#define FIELD(name, min, max) {#name, (uint16_t)offsetof(saddle_learning_config_t, name), min, max}

static const saddle_config_field_t FIELDS[] = {
    FIELD(share, 0.0f, 0.3f),
    FIELD(lateral_factor, 0.0f, 5.0f),
    FIELD(lateral_offset_m, 0.0f, 0.1f),
    FIELD(lateral_delay_rad, 0.0f, 1.5f),
    FIELD(vertical_offset_m, 0.0f, 0.1f),
    FIELD(vertical_delay_rad, 0.0f, 1.5f),
    FIELD(strike_share, 0.0f, 0.75f),
    FIELD(swing_delay, 0.0f, 0.5f),
};

#define FIELD_COUNT (sizeof FIELDS / sizeof FIELDS[0])

saddle_learning_config_t saddle_learning_default(void)
{
    return (saddle_learning_config_t){
        .share = 0.0f,
        .lateral_factor = 0.5f,
        .lateral_offset_m = 0.02f,
        .lateral_delay_rad = 0.5f,
        .vertical_offset_m = 0.02f,
        .vertical_delay_rad = 0.5f,
        .strike_share = 0.12f,
        .swing_delay = 0.15f,
    };
}

const saddle_config_field_t *saddle_learning_field(size_t index)
{
    return index < FIELD_COUNT ? &FIELDS[index] : NULL;
}

const char *saddle_learning_check(const saddle_learning_config_t *learning)
{
    for (size_t i = 0; i < FIELD_COUNT; i++) {
        const void *place = (const char *)learning + FIELDS[i].offset;
        const float value = *(const float *)place;
        if (!(value >= FIELDS[i].min && value <= FIELDS[i].max)) {
            return FIELDS[i].name;
        }
    }
    return NULL;
}

static float clamped(float value, float low, float high)
{
    return value < low ? low : value > high ? high : value;
}

/* ---- what a tick shows ------------------------------------------------------------------------ */

static void begin_stride(saddle_gait_learner_t *learner, bool whole)
{
    static const saddle_projection_t none = {0.0f, 0.0f};
    learner->whole = whole;
    learner->stance = whole ? learner->stance : NO_STANCE;
    learner->samples = learner->across_m = learner->height_m = 0.0f;
    learner->size = learner->delay = learner->climb = learner->swing = learner->strike = none;
}

static void project(saddle_projection_t *onto, float departure, float direction)
{
    onto->along += departure * direction;
    onto->square += direction * direction;
}

/* The walk is steady and what is measured can be compared with it. */
static bool is_steady(const saddle_output_t *output)
{
    const saddle_plan_t *plan = &output->plan;
    return output->status == SADDLE_OK && output->faults == 0u &&
           (output->limits & NOT_AS_COMMANDED) == 0u &&
           plan->mode == (uint8_t)SADDLE_MODE_WALKING && plan->speed_m_s > 0.0f &&
           plan->acceleration_m_s2 >= 0.0f && plan->acceleration_m_s2 <= 0.0f &&
           output->verdict.level != (uint8_t)SADDLE_LEVEL_UNSTABLE;
}

/* An index, whatever comes. */
static uint8_t stance_of(const saddle_plan_t *plan)
{
    return plan->support == (uint8_t)SADDLE_LEFT ? SADDLE_LEFT : SADDLE_RIGHT;
}

/* Since it was measured, with what its age does not say. */
static float since_s(const saddle_gait_learner_t *learner, uint32_t age_us)
{
    return (float)age_us * 1.0e-6f + learner->config.sensor_latency_s;
}

/* y of the CoM from the line midway between the feet: by the foot that carries, so that the way of the
 * swing foot does not count. */
static bool learn_across(saddle_gait_learner_t *learner, const saddle_measurement_t *measured,
                         const saddle_plan_t *plan)
{
    const uint8_t stance = stance_of(plan);
    const float age_s = since_s(learner, measured->foot[stance].age_us);
    const float half = stance == (uint8_t)SADDLE_LEFT ? 0.5f : -0.5f;
    const float rate_m_s = plan->com_velocity_m_s.y;
    const float planned_m =
        plan->com_m.y - plan->foot_m[stance].y + half * plan->step_width_m - rate_m_s * age_s;
    const float departure_m = half * learner->width_m - measured->foot[stance].cop_m.y - planned_m;
    project(&learner->size, departure_m, planned_m - learner->config.lateral_offset_m);
    project(&learner->delay, departure_m, rate_m_s);
    learner->across_m += departure_m;
    return departure_m > -DEPARTURE_MAX_M && departure_m < DEPARTURE_MAX_M;
}

static bool learn_height(saddle_gait_learner_t *learner, const saddle_measurement_t *measured,
                         const saddle_plan_t *plan)
{
    const float rate_m_s = plan->com_velocity_m_s.z;
    const float planned_m = plan->com_m.z - rate_m_s * since_s(learner, measured->com.age_us);
    const float departure_m = measured->com.height_m - planned_m;
    project(&learner->climb, departure_m, rate_m_s);
    learner->height_m += departure_m;
    return departure_m > -DEPARTURE_MAX_M && departure_m < DEPARTURE_MAX_M;
}

static void learn_swing(saddle_gait_learner_t *learner, const saddle_measurement_t *measured,
                        const saddle_plan_t *plan)
{
    const uint8_t stance = stance_of(plan);
    const uint8_t swing = 1u - stance;
    const float rate_m_s = plan->swing_velocity_m_s.x;
    const float planned_m = plan->foot_m[swing].x - plan->foot_m[stance].x -
                            rate_m_s * since_s(learner, measured->foot[swing].age_us);
    const float x_m = measured->foot[swing].cop_m.x - measured->foot[stance].cop_m.x;
    if (!measured->foot[swing].contact) {
        project(&learner->swing, x_m - planned_m, rate_m_s);
    }
}

/* A foot that has come to the ground did so half a tick ago, in the mean. */
static void learn_strike(saddle_gait_learner_t *learner, const saddle_measurement_t *measured,
                         const saddle_plan_t *plan, float dt_s)
{
    for (uint8_t foot = 0; foot < 2u; foot++) {
        const bool airborne = !measured->foot[foot].contact;
        float *until_s = &learner->until_strike_s[foot];
        *until_s -= dt_s;
        if (foot != stance_of(plan) && plan->time_to_heel_strike_s > 0.0f) {
            *until_s = plan->time_to_heel_strike_s;
        }
        if (learner->airborne[foot] && !airborne) {
            const float late_s =
                -*until_s - 0.5f * dt_s - since_s(learner, measured->foot[foot].age_us);
            project(&learner->strike, late_s, 1.0f);
        }
        learner->airborne[foot] = airborne;
    }
}

/* The width of the step that the stance foot made, seen when it takes over. */
static void see_step(saddle_gait_learner_t *learner, const saddle_measurement_t *measured,
                     const saddle_plan_t *plan)
{
    if (stance_of(plan) != learner->stance) {
        learner->stance = stance_of(plan);
        learner->width_m =
            measured->foot[SADDLE_LEFT].cop_m.y - measured->foot[SADDLE_RIGHT].cop_m.y;
    }
}

/* False: it is not of a steady walk. */
static bool learn(saddle_gait_learner_t *learner, const saddle_input_t *input,
                  const saddle_output_t *output, float dt_s)
{
    const saddle_measurement_t *measured = &input->measurement;
    const saddle_plan_t *plan = &output->plan;
    if (!is_steady(output)) {
        return false;
    }
    see_step(learner, measured, plan);
    learn_strike(learner, measured, plan, dt_s);
    if (!measured->foot[stance_of(plan)].contact) {
        return true; /* between two stance feet */
    }
    learner->samples += 1.0f;
    learn_swing(learner, measured, plan);
    return learn_across(learner, measured, plan) && learn_height(learner, measured, plan);
}

/* ---- what a stride shows ---------------------------------------------------------------------- */

static float slope_of(const saddle_projection_t *onto, float samples)
{
    const float least = DIRECTION_MIN * DIRECTION_MIN * samples;
    return onto->square > least ? onto->along / onto->square : 0.0f;
}

/* Follow by a share, within the bounds. Not a number: not at all. */
static void follow(const saddle_gait_learner_t *learner, float *field, float start, float by,
                   float bound)
{
    const float share = learner->learning.share;
    const float wanted = *field + share * clamped(by, -bound, bound);
    if (wanted >= start - bound && wanted <= start + bound) {
        *field = wanted;
    } else if (by > 0.0f) {
        *field = start + bound;
    } else if (by < 0.0f) {
        *field = start - bound;
    }
}

static void follow_path(const saddle_gait_learner_t *learner, saddle_config_t *config,
                        float phase_rate_rad_s)
{
    const saddle_learning_config_t *bound = &learner->learning;
    const saddle_config_t *start = &learner->start;
    const float n = learner->samples;
    follow(learner, &config->lateral_factor, start->lateral_factor,
           config->lateral_factor * slope_of(&learner->size, n), bound->lateral_factor);
    follow(learner, &config->lateral_offset_m, start->lateral_offset_m, learner->across_m / n,
           bound->lateral_offset_m);
    follow(learner, &config->lateral_delay_rad, start->lateral_delay_rad,
           -slope_of(&learner->delay, n) * phase_rate_rad_s, bound->lateral_delay_rad);
    if (config->ankle == SADDLE_ANKLE_CYCLOID) {
        follow(learner, &config->vertical_offset_m, start->vertical_offset_m, learner->height_m / n,
               bound->vertical_offset_m);
        follow(learner, &config->vertical_delay_rad, start->vertical_delay_rad,
               -2.0f * slope_of(&learner->climb, n) * phase_rate_rad_s, bound->vertical_delay_rad);
    }
}

static void follow_foot(const saddle_gait_learner_t *learner, saddle_config_t *config,
                        float step_time_s)
{
    const saddle_learning_config_t *bound = &learner->learning;
    const saddle_config_t *start = &learner->start;
    if (config->strike_share > 0.0f) {
        follow(learner, &config->strike_share, start->strike_share,
               slope_of(&learner->strike, 1.0f) / step_time_s, bound->strike_share);
    }
    if (config->swing_skew > 0.0f) {
        follow(learner, &config->swing_begin, start->swing_begin,
               -slope_of(&learner->swing, learner->samples) / step_time_s, bound->swing_delay);
        config->swing_end = config->swing_begin + (start->swing_end - start->swing_begin);
    }
}

static void end_stride(saddle_gait_learner_t *learner, const saddle_plan_t *plan)
{
    if (!learner->whole || learner->samples < SAMPLES_MIN) {
        return;
    }
    const float step_time_s = plan->step_length_m / plan->speed_m_s;
    saddle_config_t config = learner->config;
    follow_path(learner, &config, PI / step_time_s);
    follow_foot(learner, &config, step_time_s);
    if (saddle_config_check(&config) == NULL) {
        learner->config = config;
        learner->changed = true;
    }
}

void saddle_gait_learner_init(saddle_gait_learner_t *learner, const saddle_config_t *config,
                              const saddle_learning_config_t *learning)
{
    *learner = (saddle_gait_learner_t){.config = *config, .start = *config, .learning = *learning};
}

bool saddle_gait_learner_tick(saddle_gait_learner_t *learner, saddle_context_t *context,
                              const saddle_input_t *input, const saddle_output_t *output)
{
    if (!(learner->learning.share > 0.0f)) {
        return false;
    }
    const float dt_s = (float)(input->time_us - learner->last_us) * 1.0e-6f;
    const bool learned = learner->ticked && learn(learner, input, output, dt_s);
    const bool passed = output->plan.stride_count != learner->stride_count;
    learner->last_us = input->time_us;
    learner->stride_count = output->plan.stride_count;
    learner->ticked = true;
    if (learned && passed) {
        end_stride(learner, &output->plan);
    }
    if (!learned || passed) {
        begin_stride(learner, learned);
    }
    const bool taken_over =
        learner->changed && saddle_adapt(context, &learner->config) == SADDLE_OK;
    learner->changed = learner->changed && !taken_over;
    return taken_over;
}
