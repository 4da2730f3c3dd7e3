#include "lcm_port.h"

#include <fcntl.h>
#include <math.h>
#include <saddlewalk_bos_t.h>
#include <saddlewalk_command_t.h>
#include <saddlewalk_plan_t.h>
#include <saddlewalk_scores_t.h>
#include <saddlewalk_verdict_t.h>
#include <unistd.h>

#define NM_PER_M 1e9

/** LCM explains at length on standard error why it cannot start; the caller does so in one line. */
static lcm_t *create_silently(const char *url)
{
    const int standard_error = dup(STDERR_FILENO);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDERR_FILENO);
    lcm_t *lcm = lcm_create(url);
    dup2(standard_error, STDERR_FILENO);
    close(nowhere);
    close(standard_error);
    return lcm;
}

bool saddle_lcm_open(saddle_lcm_port_t *port, const char *url)
{
    *port = (saddle_lcm_port_t){.lcm = create_silently(url)};
    return port->lcm != NULL;
}

/** The generated handler drops what it cannot decode unseen; this one lets it be counted. */
static void take_command(const lcm_recv_buf_t *received, const char *channel, void *user)
{
    const saddle_lcm_port_t *port = user;
    const int size = (int)received->data_size;
    saddlewalk_command_t message;
    (void)channel;
    if (saddlewalk_command_t_decode(received->data, 0, size, &message) != size) {
        port->on_command(port->user, NULL);
        return;
    }
    const saddle_command_t command = {.mode = (uint8_t)message.mode,
                                      .speed_m_s = message.speed_m_s,
                                      .heel_strike_rad = message.heel_strike_rad};
    port->on_command(port->user, &command);
}

void saddle_lcm_subscribe(saddle_lcm_port_t *port, saddle_lcm_command_fn *on_command, void *user)
{
    if (port->lcm != NULL) {
        port->on_command = on_command;
        port->user = user;
        lcm_subscribe(port->lcm, "SADDLEWALK_COMMAND", take_command, port);
    }
}

int saddle_lcm_fd(const saddle_lcm_port_t *port)
{
    return port->on_command != NULL ? lcm_get_fileno(port->lcm) : -1;
}

void saddle_lcm_receive(saddle_lcm_port_t *port, int limit)
{
    while (port->on_command != NULL && limit-- > 0 && lcm_handle_timeout(port->lcm, 0) > 0) {
    }
}

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
    };
    set3(message.com_m, plan->com_m);
    set3(message.com_velocity_m_s, plan->com_velocity_m_s);
    set3(message.left_m, plan->foot_m[SADDLE_LEFT]);
    set3(message.right_m, plan->foot_m[SADDLE_RIGHT]);
    set3(message.swing_velocity_m_s, plan->swing_velocity_m_s);
    set2(message.landing_m, plan->landing_m);
    return message;
}

/** A result, or NaN if its bit says that there is none. */
static float result(const saddle_scores_t *scores, saddle_valid_t bit, float value)
{
    return (scores->valid & (uint32_t)bit) != 0u ? value : NAN;
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

void saddle_lcm_publish(saddle_lcm_port_t *port, const saddle_output_t *output,
                        const saddlewalk_health_t *health)
{
    if (port->lcm == NULL) {
        return;
    }
    const saddlewalk_plan_t plan = plan_message(&output->plan, health->utime_us);
    const saddlewalk_scores_t scores = scores_message(&output->scores, health->utime_us);
    const saddlewalk_verdict_t verdict =
        verdict_message(&output->scores, &output->verdict, health->utime_us);
    const saddlewalk_bos_t bos = bos_message(&output->scores.bos, health->utime_us);
    port->not_sent += saddlewalk_plan_t_publish(port->lcm, "SADDLEWALK_PLAN", &plan) != 0;
    port->not_sent += saddlewalk_scores_t_publish(port->lcm, "SADDLEWALK_SCORES", &scores) != 0;
    port->not_sent +=
        saddlewalk_verdict_t_publish(port->lcm, "SADDLEWALK_VERDICT", &verdict) != 0;
    port->not_sent += saddlewalk_bos_t_publish(port->lcm, "SADDLEWALK_BOS", &bos) != 0;
    port->not_sent += saddlewalk_health_t_publish(port->lcm, "SADDLEWALK_HEALTH", health) != 0;
}

void saddle_lcm_close(saddle_lcm_port_t *port)
{
    if (port->lcm != NULL) {
        lcm_destroy(port->lcm);
    }
}
