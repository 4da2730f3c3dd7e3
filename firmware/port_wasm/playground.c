/* What the playground's JavaScript calls. Numbers go in and out in arrays of floats whose names, in
 * their order, are a text beside them. */
#include "balance/saddle_space.h"

#include <saddlewalk/saddlewalk.h>

#define EXPORT(name) __attribute__((export_name(name)))
#define ROWS_MAX 512u
#define TICK_US 80000u
#define LEARNING_STRIDES 10u /* after which the supervisor knows the wearer */
#define TICKS_MAX 2000u
#define RAD_A_DEGREE 0.0174532925f

#define INPUT_NAMES                                                                         \
    "body_height_m body_mass_kg speed_m_s heel_strike_deg ankle ticks shift_x_m shift_y_m " \
    "velocity_x_m_s velocity_y_m_s"
#define ROW_NAMES                                                                                \
    "phase theta_rad support com_x_m com_y_m com_z_m com_vx_m_s com_vy_m_s com_vz_m_s left_x_m " \
    "left_y_m left_z_m right_x_m right_y_m right_z_m leg_length_m theta_to_rad theta_hs_rad "    \
    "s_pend s_jump s_sw mos_com_m mos_xcom_m gravity_x_n gravity_y_n left_pitch_rad "            \
    "right_pitch_rad"
#define ROW_LENGTH 27u
#define PROBE_NAMES                                                                              \
    "level reason driver margin_known margin caution_below valid v_comp_m_s s_pend s_jump s_sw " \
    "mos_com_m mos_xcom_m excess_stop_j can_stop paper_stable compared excess_track_j on_track " \
    "ebos_com_m ebos_xcom_m recovery_found recovery_foot recovery_x_m recovery_y_m "             \
    "recovery_margin_m support com_x_m com_y_m com_vx_m_s com_vy_m_s xcom_x_m xcom_y_m "         \
    "left_x_m left_y_m right_x_m right_y_m left_contact right_contact landing_x_m landing_y_m "  \
    "com_z_m left_z_m right_z_m left_pitch_rad right_pitch_rad plan_com_x_m plan_com_y_m"
#define PROBE_LENGTH 48u

enum {
    BODY_HEIGHT,
    BODY_MASS,
    SPEED,
    HEEL_STRIKE,
    ANKLE,
    TICKS, /* from the left foot via point to the moment that is probed */
    SHIFT_X,
    SHIFT_Y,
    VELOCITY_X, /* beside the planned one, as VELOCITY_Y */
    VELOCITY_Y,
    INPUTS
};

static float inputs[INPUTS];
static float rows[ROWS_MAX * ROW_LENGTH];
static float probe[PROBE_LENGTH + 4u * SADDLE_BOS_VERTICES];
static saddle_context_t context;
static saddle_input_t input;
static saddle_output_t output;

EXPORT("input_names") const char *playground_input_names(void);
EXPORT("row_names") const char *playground_row_names(void);
EXPORT("probe_names") const char *playground_probe_names(void);
EXPORT("inputs") float *playground_inputs(void);
EXPORT("rows") float *playground_rows(void);
EXPORT("probed") float *playground_probed(void);
EXPORT("bad_field") const char *playground_bad_field(void);
EXPORT("plan") uint32_t playground_plan(uint32_t count, uint32_t period_us);
EXPORT("probe") uint32_t playground_probe(void);

const char *playground_input_names(void)
{
    return INPUT_NAMES;
}

const char *playground_row_names(void)
{
    return ROW_NAMES;
}

/* After these come the polygons of the base of support and of the expected one: x, then y. */
const char *playground_probe_names(void)
{
    return PROBE_NAMES;
}

float *playground_inputs(void)
{
    return inputs;
}

float *playground_rows(void)
{
    return rows;
}

float *playground_probed(void)
{
    return probe;
}

static saddle_config_t config_of_inputs(void)
{
    saddle_config_t config = saddle_config_default(inputs[BODY_HEIGHT], inputs[BODY_MASS]);
    config.ankle = (saddle_ankle_t)inputs[ANKLE];
    return config;
}

/* NULL: the inputs are a body that can be planned for. */
const char *playground_bad_field(void)
{
    const saddle_config_t config = config_of_inputs();
    return saddle_config_check(&config);
}

/* A steady walk at the left foot via point, in which nothing was measured yet. */
static bool begin(void)
{
    const saddle_config_t config = config_of_inputs();
    input = (saddle_input_t){
        .command = {SADDLE_COMMAND_WALK, inputs[SPEED], inputs[HEEL_STRIKE] * RAD_A_DEGREE, 0.0f},
        .measurement = saddle_no_measurement(),
    };
    return saddle_init(&context, &config) == SADDLE_OK &&
           saddle_join(&context, &input.command) == SADDLE_OK;
}

/* ---- the plan ------------------------------------------------------------------------------ */

static float *put3(float *place, float origin_m, saddle_vec3_t point)
{
    *place++ = origin_m + point.x;
    *place++ = point.y;
    *place++ = point.z;
    return place;
}

static void write_row(float *place, const saddle_plan_t *plan, const saddle_scores_t *scores)
{
    const float origin_m = (float)plan->origin_x_nm * 1.0e-9f;
    *place++ = (float)plan->phase;
    *place++ = plan->theta_rad;
    *place++ = (float)plan->support;
    place = put3(place, origin_m, plan->com_m);
    place = put3(place, 0.0f, plan->com_velocity_m_s);
    place = put3(place, origin_m, plan->foot_m[SADDLE_LEFT]);
    place = put3(place, origin_m, plan->foot_m[SADDLE_RIGHT]);
    *place++ = plan->leg_length_m;
    *place++ = plan->toe_off_rad;
    *place++ = plan->heel_strike_rad;
    *place++ = scores->s_pend;
    *place++ = scores->s_jump;
    *place++ = scores->s_sw;
    *place++ = scores->mos_com_m;
    *place++ = scores->mos_xcom_m;
    *place++ = scores->gravity_n.x;
    *place++ = scores->gravity_n.y;
    *place++ = plan->foot_pitch_rad[SADDLE_LEFT];
    *place = plan->foot_pitch_rad[SADDLE_RIGHT];
}

/* Rows of a steady walk, period_us apart; how many there are: 0 for a body that cannot be planned
 * for. */
uint32_t playground_plan(uint32_t count, uint32_t period_us)
{
    if (!begin() || count > ROWS_MAX) {
        return 0;
    }
    for (uint32_t i = 0; i < count; i++, input.time_us += period_us) {
        saddle_scores_t scores;
        (void)saddle_tick(&context, &input, &output);
        (void)saddle_score_plan(&context, &output.plan, &scores);
        write_row(rows + (size_t)i * ROW_LENGTH, &output.plan, &scores);
    }
    return count;
}

/* ---- a posture ----------------------------------------------------------------------------- */

/* A wearer who is where the plan is, but for a shift of the CoM and of its velocity. */
static void measure(const saddle_plan_t *plan, saddle_vec2_t shift_m, saddle_vec2_t velocity_m_s)
{
    saddle_measurement_t *measured = &input.measurement;
    measured->com.height_m = plan->com_m.z;
    measured->com.velocity_m_s.x = plan->com_velocity_m_s.x + velocity_m_s.x;
    measured->com.velocity_m_s.y = plan->com_velocity_m_s.y + velocity_m_s.y;
    measured->com.age_us = 0;
    for (int side = 0; side < 2; side++) {
        const saddle_vec3_t foot_m = plan->foot_m[side];
        measured->foot[side].cop_m.x = foot_m.x - plan->com_m.x - shift_m.x;
        measured->foot[side].cop_m.y = foot_m.y - plan->com_m.y - shift_m.y;
        measured->foot[side].contact = !(foot_m.z > 0.0f);
        measured->foot[side].age_us = 0;
    }
}

static void tick(saddle_vec2_t shift_m, saddle_vec2_t velocity_m_s)
{
    saddle_plan_t ahead;
    input.time_us += TICK_US;
    (void)saddle_plan_at(&context, input.time_us, &ahead);
    measure(&ahead, shift_m, velocity_m_s);
    (void)saddle_tick(&context, &input, &output);
}

/* As planned to `more` ticks after that many strides. */
static void follow_to(uint32_t strides, uint32_t more)
{
    const saddle_vec2_t nothing = {0.0f, 0.0f};
    for (uint32_t i = 0; i < TICKS_MAX && output.plan.stride_count < strides; i++) {
        tick(nothing, nothing);
    }
    for (uint32_t i = 1; i < more; i++) {
        tick(nothing, nothing);
    }
}

static float *put_polygon(float *place, const saddle_bos_t *bos, saddle_vec2_t origin_m)
{
    saddle_vec2_t vertices[SADDLE_BOS_VERTICES];
    saddle_bos_polygon(bos, vertices);
    for (int i = 0; i < SADDLE_BOS_VERTICES; i++) {
        place[i] = origin_m.x + vertices[i].x;
        place[SADDLE_BOS_VERTICES + i] = origin_m.y + vertices[i].y;
    }
    return place + (size_t)2 * SADDLE_BOS_VERTICES;
}

static float *put_verdict(float *place)
{
    const saddle_verdict_t *verdict = &output.verdict;
    const saddle_scores_t *scores = &output.scores;
    const float numbers[] = {
        (float)verdict->level,
        (float)verdict->reason,
        (float)verdict->driver,
        (float)verdict->margin_known,
        verdict->margin,
        verdict->caution_below,
        (float)scores->valid,
        scores->v_comp_m_s,
        scores->s_pend,
        scores->s_jump,
        scores->s_sw,
        scores->mos_com_m,
        scores->mos_xcom_m,
        scores->excess_stop_j,
        (float)scores->can_stop,
        (float)scores->paper_stable,
        (float)verdict->compared,
        verdict->excess_track_j,
        (float)verdict->on_track,
        verdict->ebos_com_m,
        verdict->ebos_xcom_m,
        (float)verdict->recovery.found,
        (float)verdict->recovery.foot,
        verdict->recovery.landing_m.x,
        verdict->recovery.landing_m.y,
        verdict->recovery.margin_m,
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        *place++ = numbers[i];
    }
    return place;
}

/* As measured, in the frame of the plan: x from the stance CoP, y from the walking line. */
static float *put_posture(float *place, saddle_vec2_t com_m)
{
    const saddle_plan_t *plan = &output.plan;
    const saddle_vec2_t velocity_m_s = input.measurement.com.velocity_m_s;
    const saddle_vec2_t left_m = input.measurement.foot[SADDLE_LEFT].cop_m;
    const saddle_vec2_t right_m = input.measurement.foot[SADDLE_RIGHT].cop_m;
    const float numbers[] = {
        (float)plan->support,
        com_m.x,
        com_m.y,
        velocity_m_s.x,
        velocity_m_s.y,
        com_m.x + output.scores.xcom_m.x,
        com_m.y + output.scores.xcom_m.y,
        com_m.x + left_m.x,
        com_m.y + left_m.y,
        com_m.x + right_m.x,
        com_m.y + right_m.y,
        (float)input.measurement.foot[SADDLE_LEFT].contact,
        (float)input.measurement.foot[SADDLE_RIGHT].contact,
        plan->landing_m.x,
        plan->landing_m.y,
        input.measurement.com.height_m,
        plan->foot_m[SADDLE_LEFT].z,
        plan->foot_m[SADDLE_RIGHT].z,
        plan->foot_pitch_rad[SADDLE_LEFT],
        plan->foot_pitch_rad[SADDLE_RIGHT],
        plan->com_m.x,
        plan->com_m.y,
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        *place++ = numbers[i];
    }
    return place;
}

/* The verdict on a posture: some seconds of the planned walk, then the moment that is probed, with
 * the CoM and its velocity shifted. 0 for a body that cannot be planned for. */
uint32_t playground_probe(void)
{
    const saddle_vec2_t shift_m = {inputs[SHIFT_X], inputs[SHIFT_Y]};
    const saddle_vec2_t velocity_m_s = {inputs[VELOCITY_X], inputs[VELOCITY_Y]};
    if (!begin()) {
        return 0;
    }
    (void)saddle_tick(&context, &input, &output);
    follow_to(LEARNING_STRIDES, (uint32_t)inputs[TICKS]);
    tick(shift_m, velocity_m_s);
    const saddle_plan_t *plan = &output.plan;
    const saddle_vec3_t stance_m = plan->foot_m[plan->support];
    const saddle_vec2_t from_com_m = input.measurement.foot[plan->support].cop_m;
    const saddle_vec2_t com_m = {stance_m.x - from_com_m.x, stance_m.y - from_com_m.y};
    const saddle_vec2_t step_m[2] = {{stance_m.x, stance_m.y}, plan->landing_m};
    const saddle_config_t config = config_of_inputs();
    const saddle_bos_t expected = saddle_bos(step_m, config.cop_range_m, config.bos_factor);
    float *place = put_posture(put_verdict(probe), com_m);
    place = put_polygon(place, &output.scores.bos, com_m);
    (void)put_polygon(place, &expected, (saddle_vec2_t){0.0f, 0.0f});
    return 1;
}
