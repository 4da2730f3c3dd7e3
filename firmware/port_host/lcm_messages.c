#include "lcm_messages.h"

#include <math.h>
#include <saddlewalk_balance_t.h>
#include <saddlewalk_bos_t.h>
#include <saddlewalk_config_t.h>
#include <saddlewalk_feet_t.h>
#include <saddlewalk_input_t.h>
#include <saddlewalk_joints_t.h>
#include <saddlewalk_plan_t.h>
#include <saddlewalk_scores_t.h>
#include <saddlewalk_sensors_t.h>
#include <saddlewalk_turn_t.h>
#include <saddlewalk_verdict_t.h>
#include <saddlewalk_way_t.h>
#include <string.h>

#define NM_PER_M 1e9
#define CONFIG_FIELDS (offsetof(saddle_config_t, ankle) / sizeof(float))

static void set3(float to[3], saddle_vec3_t from)
{
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

static void set2(float to[2], saddle_vec2_t from)
{
    to[0] = from.x;
    to[1] = from.y;
}

static saddlewalk_plan_t plan_message(const saddle_plan_t *plan, int64_t utime_us)
{
    saddlewalk_plan_t message = {
        .utime_us = utime_us,
        .valid = plan->valid,
        .mode = (int8_t)plan->mode,
        .phase = (int8_t)plan->phase,
        .support = (int8_t)plan->support,
        .step_count = (int32_t)plan->step_count,
        .stride_count = (int32_t)plan->stride_count,
        .theta_rad = plan->theta_rad,
        .origin_x_m = (double)plan->origin_x_nm / NM_PER_M,
        .speed_m_s = plan->speed_m_s,
        .step_length_m = plan->step_length_m,
        .step_width_m = plan->step_width_m,
        .foot_pitch_rad = {plan->foot_pitch_rad[SADDLE_LEFT], plan->foot_pitch_rad[SADDLE_RIGHT]},
        .leg_length_m = plan->leg_length_m,
        .knee_flexion_m = plan->knee_flexion_m,
        .toe_off_rad = plan->toe_off_rad,
        .heel_strike_rad = plan->heel_strike_rad,
        .time_to_via_point_s = plan->time_to_via_point_s,
        .time_to_heel_strike_s = plan->time_to_heel_strike_s,
        .time_to_toe_off_s = plan->time_to_toe_off_s,
        .acceleration_m_s2 = plan->acceleration_m_s2,
        .load = {plan->reference.load[SADDLE_LEFT], plan->reference.load[SADDLE_RIGHT]},
    };
    set3(message.com_m, plan->com_m);
    set3(message.com_velocity_m_s, plan->com_velocity_m_s);
    set3(message.left_m, plan->foot_m[SADDLE_LEFT]);
    set3(message.right_m, plan->foot_m[SADDLE_RIGHT]);
    set3(message.swing_velocity_m_s, plan->swing_velocity_m_s);
    set2(message.landing_m, plan->landing_m);
    set2(message.last_step_m, plan->last_step_m);
    set2(message.reference_com_m, plan->reference.com_m);
    set2(message.reference_xcom_m, plan->reference.xcom_m);
    set2(message.reference_cop_m, plan->reference.cop_m);
    return message;
}

static saddlewalk_way_t way_message(const saddle_plan_t *plan, int64_t utime_us)
{
    return (saddlewalk_way_t){
        .utime_us = utime_us,
        .origin_y_m = (double)plan->origin_y_nm / NM_PER_M,
        .heading_rad = plan->heading_rad,
        .curvature_1_m = {plan->curvature_1_m[0], plan->curvature_1_m[1]},
        .foot_yaw_rad = {plan->foot_yaw_rad[SADDLE_LEFT], plan->foot_yaw_rad[SADDLE_RIGHT]},
        .pelvis_yaw_rad = plan->pelvis_yaw_rad,
    };
}

/** The number if it is known, else NaN. */
static float known(bool is_known, float value)
{
    return is_known ? value : NAN;
}

static float result(const saddle_scores_t *scores, saddle_valid_t bit, float value)
{
    return known((scores->valid & (uint32_t)bit) != 0u, value);
}

static saddlewalk_scores_t scores_message(const saddle_scores_t *scores, int64_t utime_us)
{
    return (saddlewalk_scores_t){
        .utime_us = utime_us,
        .valid = (int32_t)(scores->valid & ~(uint32_t)SADDLE_VALID_STOP), /* in verdict_t */
        .v_comp_m_s = result(scores, SADDLE_VALID_V_COMP, scores->v_comp_m_s),
        .s_pend = result(scores, SADDLE_VALID_STEP, scores->s_pend),
        .s_jump = result(scores, SADDLE_VALID_STEP, scores->s_jump),
        .s_sw = result(scores, SADDLE_VALID_S_SW, scores->s_sw),
        .mos_com_m = result(scores, SADDLE_VALID_MOS_COM, scores->mos_com_m),
        .mos_xcom_m = result(scores, SADDLE_VALID_MOS_XCOM, scores->mos_xcom_m),
        .gravity_n = {result(scores, SADDLE_VALID_GRAVITY, scores->gravity_n.x),
                      result(scores, SADDLE_VALID_GRAVITY, scores->gravity_n.y)},
        .xcom_m = {result(scores, SADDLE_VALID_MOS_XCOM, scores->xcom_m.x),
                   result(scores, SADDLE_VALID_MOS_XCOM, scores->xcom_m.y)},
    };
}

static saddlewalk_verdict_t verdict_message(const saddle_scores_t *scores,
                                            const saddle_verdict_t *verdict, int64_t utime_us)
{
    const saddle_recovery_t *recovery = &verdict->recovery;
    saddlewalk_verdict_t message = {
        .utime_us = utime_us,
        .level = (int8_t)verdict->level,
        .reason = (int8_t)verdict->reason,
        .paper_stable = scores->paper_stable,
        .compared = verdict->compared,
        .can_stop = scores->can_stop,
        .on_track = verdict->on_track,
        .excess_stop_j = result(scores, SADDLE_VALID_STOP, scores->excess_stop_j),
        .excess_track_j = NAN,
        .ebos_com_m = NAN,
        .ebos_xcom_m = NAN,
        .xcom_deviation_m = {NAN, NAN},
        .recovery_found = recovery->found,
        .recovery_stops = recovery->stops,
        .recovery_foot = (int8_t)recovery->foot,
        .recovery_landing_m = {NAN, NAN},
        .recovery_margin_m = NAN,
    };
    if (verdict->compared) {
        message.excess_track_j = result(scores, SADDLE_VALID_STOP, verdict->excess_track_j);
        message.ebos_com_m = verdict->ebos_com_m;
        message.ebos_xcom_m = verdict->ebos_xcom_m;
        set2(message.xcom_deviation_m, verdict->xcom_deviation_m);
        message.recovery_margin_m = recovery->margin_m;
    }
    if (verdict->compared && recovery->found) {
        set2(message.recovery_landing_m, recovery->landing_m);
    }
    return message;
}

static saddlewalk_balance_t balance_message(const saddle_verdict_t *verdict,
                                            const saddle_learned_walk_t *walk, int64_t utime_us)
{
    const bool measured = walk->height_m > 0.0f;
    const bool stepped = walk->step_time_s > 0.0f;
    return (saddlewalk_balance_t){
        .utime_us = utime_us,
        .driver = (int8_t)verdict->driver,
        .margin = known(verdict->margin_known, verdict->margin),
        .caution_below = known(verdict->margin_known, verdict->caution_below),
        .recovery_margin_m = known(verdict->compared, verdict->recovery.margin_m),
        .walk_velocity_m_s = {known(measured, walk->velocity_m_s.x),
                              known(measured, walk->velocity_m_s.y)},
        .walk_height_m = known(measured, walk->height_m),
        .walk_ripple = known(walk->ripple > 0.0f, walk->ripple),
        .walk_step_time_s = known(stepped, walk->step_time_s),
        .walk_step_length_m = known(stepped, walk->step_length_m),
        .walk_step_width_m = known(stepped, walk->step_width_m),
        .walk_step_margin = known(stepped, walk->step_margin),
    };
}

static saddlewalk_bos_t bos_message(const saddle_bos_t *bos, int64_t utime_us)
{
    saddlewalk_bos_t message = {.utime_us = utime_us, .defined = bos->defined};
    saddle_vec2_t vertices_m[SADDLE_BOS_VERTICES];
    saddle_bos_polygon(bos, vertices_m);
    for (size_t i = 0; i < SADDLE_BOS_VERTICES; ++i) {
        message.x_m[i] = vertices_m[i].x;
        message.y_m[i] = vertices_m[i].y;
    }
    return message;
}

const char *saddle_lcm_channel(saddle_lcm_output_t part)
{
    static const char *const names[SADDLE_LCM_OUTPUTS] = {
        [SADDLE_LCM_PLAN] = "SADDLEWALK_PLAN",       [SADDLE_LCM_SCORES] = "SADDLEWALK_SCORES",
        [SADDLE_LCM_VERDICT] = "SADDLEWALK_VERDICT", [SADDLE_LCM_BALANCE] = "SADDLEWALK_BALANCE",
        [SADDLE_LCM_BOS] = "SADDLEWALK_BOS",         [SADDLE_LCM_WAY] = "SADDLEWALK_WAY",
    };
    return names[part];
}

int saddle_lcm_encode_output(saddle_lcm_output_t part, const saddle_output_t *output,
                             int64_t utime_us, uint8_t bytes[SADDLE_LCM_MESSAGE_MAX])
{
    const int room = SADDLE_LCM_MESSAGE_MAX;
    if (part == SADDLE_LCM_PLAN) {
        const saddlewalk_plan_t plan = plan_message(&output->plan, utime_us);
        return saddlewalk_plan_t_encode(bytes, 0, room, &plan);
    }
    if (part == SADDLE_LCM_SCORES) {
        const saddlewalk_scores_t scores = scores_message(&output->scores, utime_us);
        return saddlewalk_scores_t_encode(bytes, 0, room, &scores);
    }
    if (part == SADDLE_LCM_VERDICT) {
        const saddlewalk_verdict_t verdict =
            verdict_message(&output->scores, &output->verdict, utime_us);
        return saddlewalk_verdict_t_encode(bytes, 0, room, &verdict);
    }
    if (part == SADDLE_LCM_BALANCE) {
        const saddlewalk_balance_t balance =
            balance_message(&output->verdict, &output->walk, utime_us);
        return saddlewalk_balance_t_encode(bytes, 0, room, &balance);
    }
    if (part == SADDLE_LCM_WAY) {
        const saddlewalk_way_t way = way_message(&output->plan, utime_us);
        return saddlewalk_way_t_encode(bytes, 0, room, &way);
    }
    const saddlewalk_bos_t bos = bos_message(&output->scores.bos, utime_us);
    return saddlewalk_bos_t_encode(bytes, 0, room, &bos);
}

static int64_t age_message(uint32_t age_us)
{
    return age_us != SADDLE_AGE_NEVER_US ? (int64_t)age_us : SADDLEWALK_INPUT_T_NEVER;
}

int saddle_lcm_encode_input(const saddle_input_t *input, int32_t tick,
                            uint8_t bytes[SADDLE_LCM_MESSAGE_MAX])
{
    const saddle_measurement_t *measured = &input->measurement;
    saddlewalk_input_t message = {
        .utime_us = (int64_t)input->time_us,
        .tick = tick,
        .mode = (int8_t)input->command.mode,
        .speed_m_s = input->command.speed_m_s,
        .heel_strike_rad = input->command.heel_strike_rad,
        .command_age_us = age_message(input->command_age_us),
        .com_height_m = measured->com.height_m,
        .com_age_us = age_message(measured->com.age_us),
        .left_contact = measured->foot[SADDLE_LEFT].contact,
        .left_age_us = age_message(measured->foot[SADDLE_LEFT].age_us),
        .right_contact = measured->foot[SADDLE_RIGHT].contact,
        .right_age_us = age_message(measured->foot[SADDLE_RIGHT].age_us),
    };
    set2(message.com_velocity_m_s, measured->com.velocity_m_s);
    set2(message.left_m, measured->foot[SADDLE_LEFT].cop_m);
    set2(message.right_m, measured->foot[SADDLE_RIGHT].cop_m);
    return saddlewalk_input_t_encode(bytes, 0, SADDLE_LCM_MESSAGE_MAX, &message);
}

int saddle_lcm_encode_turn(const saddle_input_t *input, uint8_t bytes[SADDLE_LCM_MESSAGE_MAX])
{
    const saddlewalk_turn_t message = {.utime_us = (int64_t)input->time_us,
                                       .turn_rate_rad_s = input->command.turn_rate_rad_s};
    return saddlewalk_turn_t_encode(bytes, 0, SADDLE_LCM_MESSAGE_MAX, &message);
}

bool saddle_lcm_decode_turn(const uint8_t *bytes, int size, saddle_input_t *input)
{
    saddlewalk_turn_t message;
    if (saddlewalk_turn_t_decode(bytes, 0, size, &message) != size) {
        return false;
    }
    input->command.turn_rate_rad_s = message.turn_rate_rad_s;
    return true;
}

int saddle_lcm_encode_feet(const saddle_input_t *input, uint8_t bytes[SADDLE_LCM_MESSAGE_MAX])
{
    const saddle_measured_foot_t *foot = input->measurement.foot;
    const saddlewalk_feet_t message = {.utime_us = (int64_t)input->time_us,
                                       .left_ground_m_s = foot[SADDLE_LEFT].ground_m_s,
                                       .left_since_us = foot[SADDLE_LEFT].since_us,
                                       .right_ground_m_s = foot[SADDLE_RIGHT].ground_m_s,
                                       .right_since_us = foot[SADDLE_RIGHT].since_us};
    return saddlewalk_feet_t_encode(bytes, 0, SADDLE_LCM_MESSAGE_MAX, &message);
}

bool saddle_lcm_decode_feet(const uint8_t *bytes, int size, saddle_input_t *input)
{
    saddle_measured_foot_t *foot = input->measurement.foot;
    saddlewalk_feet_t message;
    if (saddlewalk_feet_t_decode(bytes, 0, size, &message) != size) {
        return false;
    }
    foot[SADDLE_LEFT].ground_m_s = message.left_ground_m_s;
    foot[SADDLE_LEFT].since_us = (uint32_t)message.left_since_us;
    foot[SADDLE_RIGHT].ground_m_s = message.right_ground_m_s;
    foot[SADDLE_RIGHT].since_us = (uint32_t)message.right_since_us;
    return true;
}

static saddle_vec2_t vec2(const float from[2])
{
    return (saddle_vec2_t){from[0], from[1]};
}

bool saddle_lcm_decode_input(const uint8_t *bytes, int size, saddle_input_t *input, int32_t *tick)
{
    saddlewalk_input_t message;
    if (saddlewalk_input_t_decode(bytes, 0, size, &message) != size) {
        return false;
    }
    *tick = message.tick;
    *input = (saddle_input_t){
        .time_us = (uint64_t)message.utime_us,
        .command = {.mode = (uint8_t)message.mode,
                    .speed_m_s = message.speed_m_s,
                    .heel_strike_rad = message.heel_strike_rad},
        .command_age_us = (uint32_t)message.command_age_us,
        .measurement = {.com = {.height_m = message.com_height_m,
                                .velocity_m_s = vec2(message.com_velocity_m_s),
                                .age_us = (uint32_t)message.com_age_us},
                        .foot = {[SADDLE_LEFT] = {.cop_m = vec2(message.left_m),
                                                  .contact = message.left_contact != 0,
                                                  .age_us = (uint32_t)message.left_age_us},
                                 [SADDLE_RIGHT] = {.cop_m = vec2(message.right_m),
                                                   .contact = message.right_contact != 0,
                                                   .age_us = (uint32_t)message.right_age_us}}},
    };
    return true;
}

int saddle_lcm_encode_sensors(const saddle_sensors_t *sensors, const saddle_estimate_t *estimate,
                              uint8_t bytes[SADDLE_LCM_MESSAGE_MAX])
{
    saddlewalk_sensors_t message = {
        .utime_us = (int64_t)sensors->time_us,
        .load_n = {sensors->load_n[SADDLE_LEFT], sensors->load_n[SADDLE_RIGHT]},
        .imu_age_us = age_message(sensors->imu_age_us),
        .joints_age_us = {age_message(sensors->joints_age_us[SADDLE_LEFT]),
                          age_message(sensors->joints_age_us[SADDLE_RIGHT])},
        .load_age_us = {age_message(sensors->load_age_us[SADDLE_LEFT]),
                        age_message(sensors->load_age_us[SADDLE_RIGHT])},
        .faults = (int32_t)estimate->faults,
        .lost_joints = (int32_t)estimate->lost_joints,
    };
    set3(message.gyro_rad_s, sensors->gyro_rad_s);
    set3(message.accelerometer_m_s2, sensors->accelerometer_m_s2);
    memcpy(message.angle_rad, sensors->angle_rad, sizeof message.angle_rad);
    return saddlewalk_sensors_t_encode(bytes, 0, SADDLE_LCM_MESSAGE_MAX, &message);
}

int saddle_lcm_encode_joints(const saddle_joint_commands_t *commands, int64_t utime_us,
                             uint8_t bytes[SADDLE_LCM_MESSAGE_MAX])
{
    saddlewalk_joints_t message = {
        .utime_us = utime_us,
        .fallback = commands->fallback,
        .load_share = {commands->load_share[SADDLE_LEFT], commands->load_share[SADDLE_RIGHT]},
    };
    for (size_t i = 0; i < (size_t)2u * SADDLE_LEG_JOINTS; ++i) {
        const saddle_joint_command_t *command =
            &commands->joint[i / SADDLE_LEG_JOINTS][i % SADDLE_LEG_JOINTS];
        message.angle_rad[i] = command->angle_rad;
        message.rate_rad_s[i] = command->rate_rad_s;
        message.torque_nm[i] = command->torque_nm;
        message.stiffness[i] = command->stiffness;
        message.damping[i] = command->damping;
        message.torque_min_nm[i] = command->torque_min_nm;
        message.torque_max_nm[i] = command->torque_max_nm;
    }
    return saddlewalk_joints_t_encode(bytes, 0, SADDLE_LCM_MESSAGE_MAX, &message);
}

int saddle_lcm_encode_config(const saddle_config_t *config, uint64_t time_us, bool lockstep,
                             uint8_t bytes[SADDLE_LCM_MESSAGE_MAX])
{
    char *names[CONFIG_FIELDS];
    float values[CONFIG_FIELDS];
    for (size_t i = 0; i < CONFIG_FIELDS; ++i) {
        const saddle_config_field_t *field = saddle_config_field(i);
        names[i] = (char *)field->name; /* not written to: the generated type has no const */
        memcpy(&values[i], (const char *)config + field->offset, sizeof values[i]);
    }
    const saddlewalk_config_t message = {
        .utime_us = (int64_t)time_us,
        .library_version = SADDLE_VERSION,
        .wire_version = SADDLE_WIRE_VERSION,
        .lockstep = lockstep,
        .ankle = (int8_t)config->ankle,
        .fields = (int16_t)CONFIG_FIELDS,
        .name = names,
        .value = values,
    };
    return saddlewalk_config_t_encode(bytes, 0, SADDLE_LCM_MESSAGE_MAX, &message);
}
