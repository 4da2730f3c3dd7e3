#include <saddlewalk/com_path.h>
#include <saddlewalk/foot_swing.h>
#include <saddlewalk/planner.h>
#include <saddlewalk/saddle_math.h>

/* Fixed-point phase: its upper 32 bits count 2^-32 strides. A step is half a stride. */
#define Q32 4294967296.0f
#define STEP_Q32 2147483648.0f
#define QUARTER_Q32 0x40000000u
#define STEP_MASK_Q32 0x7FFFFFFFu

/* The largest float below 2 pi: the last 2^-25 of a stride would round up to a whole turn. */
#define THETA_MAX_RAD 6.28318500f

/* Where the phase lies in its step. */
typedef struct {
    float progress;    /* [0, 1] from one saddle via point to the next */
    float angle_rad;   /* [-pi/2, pi/2], 0 at the foot via point */
    float to_saddle_s; /* until the step ends */
} step_phase_t;

bool saddle_command_usable(const saddle_command_t *command)
{
    const float finite_max = 1.0e6f;
    if (command->mode == (uint8_t)SADDLE_COMMAND_STAND) {
        return true;
    }
    return command->mode == (uint8_t)SADDLE_COMMAND_WALK &&
           saddle_in_range(command->speed_m_s, -finite_max, finite_max) &&
           saddle_in_range(command->heel_strike_rad, -finite_max, finite_max);
}

static float limited(float value, float min, float max, saddle_limit_t limit, uint32_t *limits)
{
    const float inside = saddle_clamp(value, min, max);
    if (inside != value) {
        *limits |= (uint32_t)limit;
    }
    return inside;
}

static void begin_walk(saddle_planner_t *planner, const saddle_config_t *config,
                       const saddle_body_t *body, const saddle_command_t *command)
{
    uint32_t limits = 0;
    float speed_m_s = command->speed_m_s;
    if (speed_m_s >= body->speed_ceiling_m_s) {
        speed_m_s = SADDLE_CEILING_MARGIN * body->speed_ceiling_m_s;
        limits |= (uint32_t)SADDLE_LIMIT_SPEED;
    }
    speed_m_s = limited(speed_m_s, SADDLE_SPEED_FLOOR_M_S, body->speed_ceiling_m_s,
                        SADDLE_LIMIT_SPEED, &limits);
    const float heel_strike_rad =
        limited(command->heel_strike_rad, 0.0f, config->heel_strike_max_rad,
                SADDLE_LIMIT_HEEL_STRIKE, &limits);

    planner->phase_q64 = 0;
    planner->stride_count = 0;
    planner->origin_x_nm = 0;
    planner->gait = saddle_gait(config, speed_m_s);
    planner->transition = saddle_transition(config, body, &planner->gait, heel_strike_rad);
    if (planner->transition.toe_off_limited) {
        limits |= (uint32_t)SADDLE_LIMIT_TOE_OFF;
    }
    planner->commanded_speed_m_s = command->speed_m_s;
    planner->commanded_heel_strike_rad = command->heel_strike_rad;
    planner->start_limits = limits;
    planner->walking = true;
}

static uint32_t phase_q32(const saddle_planner_t *planner)
{
    return (uint32_t)(planner->phase_q64 >> 32);
}

/* Heel strikes are at a quarter and at three quarters of the stride. */
static uint32_t step_count(const saddle_planner_t *planner)
{
    const uint32_t quarter = phase_q32(planner) >> 30;
    return 2u * planner->stride_count + (quarter + 1u) / 2u;
}

/* A share of a stride in [0, 1) with 64 fractional bits, without rounding. */
static uint64_t to_q64(float strides)
{
    const float scaled = strides * Q32;
    const uint32_t upper = (uint32_t)scaled;
    const uint32_t lower = (uint32_t)((scaled - (float)upper) * Q32);
    return ((uint64_t)upper << 32) | lower;
}

static void advance(saddle_planner_t *planner, float dt_s)
{
    const float strides = saddle_clamp(0.5f * planner->gait.cadence_hz * dt_s, 0.0f, 0.5f);
    const uint32_t steps_before = step_count(planner);
    const uint64_t increment = to_q64(strides);
    planner->phase_q64 += increment;
    if (planner->phase_q64 < increment) {
        planner->stride_count++;
    }
    if (step_count(planner) != steps_before) {
        const int32_t half_step_nm = (int32_t)(0.5e9f * planner->gait.step_length_m);
        planner->origin_x_nm += 2 * (int64_t)half_step_nm;
    }
}

static step_phase_t step_phase(const saddle_planner_t *planner)
{
    const uint32_t in_step = (phase_q32(planner) + QUARTER_Q32) & STEP_MASK_Q32;
    const int32_t from_via_point = (int32_t)in_step - (int32_t)QUARTER_Q32;
    step_phase_t step;
    step.progress = (float)in_step / STEP_Q32;
    step.angle_rad = (float)from_via_point * (SADDLE_PI / STEP_Q32);
    step.to_saddle_s =
        (float)(STEP_MASK_Q32 + 1u - in_step) / (STEP_Q32 * planner->gait.cadence_hz);
    return step;
}

static void plan_feet(const saddle_planner_t *planner, const saddle_config_t *config,
                      const step_phase_t *step, const saddle_com_path_t *com, saddle_plan_t *plan)
{
    const float half_width_m = 0.5f * planner->gait.step_width_m;
    const float stance_y_m = plan->support == SADDLE_LEFT ? half_width_m : -half_width_m;
    const saddle_vec2_t stance_m = {0.0f, stance_y_m};
    const saddle_swing_t swing =
        saddle_foot_swing(stance_m, com->position_m, com->velocity_m_s, -stance_y_m,
                          step->progress, planner->gait.cadence_hz, config->swing_clearance_m);
    const saddle_vec3_t stance_foot_m = {stance_m.x, stance_m.y, 0.0f};
    plan->foot_m[plan->support] = stance_foot_m;
    plan->foot_m[1 - plan->support] = swing.position_m;
    plan->swing_velocity_m_s = swing.velocity_m_s;
    plan->landing_m.x = planner->gait.step_length_m;
    plan->landing_m.y = -stance_y_m;
    plan->time_to_heel_strike_s = step->to_saddle_s;
}

static void plan_com(const saddle_planner_t *planner, const saddle_config_t *config,
                     const saddle_body_t *body, const step_phase_t *step,
                     const saddle_com_path_t *com, saddle_plan_t *plan)
{
    const float since_saddle_s = step->progress / planner->gait.cadence_hz;
    const float from_saddle_s = step->angle_rad < 0.0f ? since_saddle_s : -step->to_saddle_s;
    const saddle_ankle_state_t ankle =
        saddle_ankle(config, body, &planner->transition, from_saddle_s);
    const saddle_vec3_t *stance_m = &plan->foot_m[plan->support];
    const saddle_vec2_t offset_m = {com->position_m.x - stance_m->x,
                                    com->position_m.y - stance_m->y};
    plan->com_m.x = com->position_m.x;
    plan->com_m.y = com->position_m.y;
    plan->com_velocity_m_s.x = com->velocity_m_s.x;
    plan->com_velocity_m_s.y = com->velocity_m_s.y;
    saddle_com_height(&ankle, offset_m, com->velocity_m_s, &plan->com_m.z,
                      &plan->com_velocity_m_s.z);
    plan->leg_length_m = ankle.leg_length_m;
    plan->toe_off_rad = ankle.toe_off_rad;
    plan->heel_strike_rad = ankle.heel_strike_rad;
}

static void write_plan(const saddle_planner_t *planner, const saddle_config_t *config,
                       const saddle_body_t *body, saddle_plan_t *plan)
{
    const step_phase_t step = step_phase(planner);
    plan->valid = true;
    plan->phase = (uint8_t)(phase_q32(planner) >> 30);
    plan->step_count = step_count(planner);
    plan->support = (uint8_t)(plan->step_count % 2u == 0u ? SADDLE_LEFT : SADDLE_RIGHT);
    plan->stride_count = planner->stride_count;
    plan->theta_rad =
        saddle_clamp((float)phase_q32(planner) * (SADDLE_TWO_PI / Q32), 0.0f, THETA_MAX_RAD);
    plan->origin_x_nm = planner->origin_x_nm;
    plan->speed_m_s = planner->gait.speed_m_s;
    plan->step_length_m = planner->gait.step_length_m;
    plan->step_width_m = planner->gait.step_width_m;

    const saddle_com_path_t com =
        saddle_com_path(&planner->gait, (saddle_side_t)plan->support, step.angle_rad);
    plan_feet(planner, config, &step, &com, plan);
    plan_com(planner, config, body, &step, &com, plan);
}

uint32_t saddle_planner_update(saddle_planner_t *planner, const saddle_config_t *config,
                               const saddle_body_t *body, const saddle_command_t *command,
                               float dt_s, saddle_plan_t *plan)
{
    if (command->mode == (uint8_t)SADDLE_COMMAND_STAND) {
        planner->walking = false;
        *plan = (saddle_plan_t){.valid = false};
        return 0;
    }
    if (planner->walking) {
        advance(planner, dt_s);
    } else {
        begin_walk(planner, config, body, command);
    }
    write_plan(planner, config, body, plan);
    const bool held = command->speed_m_s != planner->commanded_speed_m_s ||
                      command->heel_strike_rad != planner->commanded_heel_strike_rad;
    return planner->start_limits | (held ? (uint32_t)SADDLE_LIMIT_COMMAND_HELD : 0u);
}
