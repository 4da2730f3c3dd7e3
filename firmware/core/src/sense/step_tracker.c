#include "sense/step_tracker.h"

#include "math/elementary.h"

/* A disturbed step changes the walking speed by no more. */
#define DISTURBED_CHANGE_M_S 0.1f

/* Contact that is lost for less did not end a stance: nobody swings a leg so fast. */
#define SWING_MIN_S 0.12f

/* Slower, with both feet on the ground, is standing. */
#define STANDING_SPEED_M_S 0.2f

/* A foot that swung and is on the ground now. */
static bool heel_strike(saddle_step_tracker_t *tracker, const saddle_measurement_t *measurement,
                        saddle_side_t side, float dt_s)
{
    if (!measurement->foot[side].contact) {
        tracker->airborne_s[side] += dt_s;
        return false;
    }
    const bool swung = tracker->airborne_s[side] >= SWING_MIN_S;
    tracker->airborne_s[side] = 0.0f;
    return swung;
}

/* v_CoMp: the velocity integrated by the trapezoidal rule over a step. */
static void follow_speed(saddle_step_tracker_t *tracker, bool velocity_known, float velocity_m_s,
                         float time_s)
{
    tracker->step_open = tracker->step_open && velocity_known;
    if (tracker->step_open) {
        tracker->step_distance_m += 0.5f * time_s * (tracker->last_velocity_m_s + velocity_m_s);
        tracker->step_duration_s += time_s;
    }
    if (velocity_known) {
        tracker->last_velocity_m_s = velocity_m_s;
    }
}

/* A heel strike ends a step and begins the next. */
static void end_step(saddle_step_tracker_t *tracker, bool velocity_known)
{
    const float known_m_s = tracker->v_comp_m_s;
    const bool bounded = tracker->disturbed && tracker->v_comp_known;
    tracker->v_comp_known = false;
    tracker->disturbed = false;
    if (tracker->step_open && tracker->step_duration_s > 0.0f) {
        const float mean_m_s = tracker->step_distance_m / tracker->step_duration_s;
        tracker->v_comp_m_s = bounded ? saddle_clamp(mean_m_s, known_m_s - DISTURBED_CHANGE_M_S,
                                                     known_m_s + DISTURBED_CHANGE_M_S)
                                      : mean_m_s;
        tracker->step_time_s = tracker->step_duration_s;
        tracker->v_comp_known = true;
        tracker->stands = false;
    }
    tracker->step_open = velocity_known;
    tracker->step_distance_m = 0.0f;
    tracker->step_duration_s = 0.0f;
}

/* A heel strike, since_s ago: the velocity changed evenly within the tick. */
static void follow_strike(saddle_step_tracker_t *tracker, bool velocity_known, float velocity_m_s,
                          float dt_s, float since_s)
{
    const bool measured_before = tracker->step_open && dt_s > 0.0f;
    const float share = measured_before ? since_s / dt_s : 0.0f;
    const float at_strike_m_s = velocity_m_s + share * (tracker->last_velocity_m_s - velocity_m_s);
    follow_speed(tracker, velocity_known, at_strike_m_s, dt_s - since_s);
    end_step(tracker, velocity_known);
    follow_speed(tracker, velocity_known, velocity_m_s, since_s);
}

static void follow_step(saddle_step_tracker_t *tracker, const saddle_measurement_t *measurement,
                        saddle_side_t landed)
{
    const saddle_vec2_t left_m = measurement->foot[SADDLE_LEFT].cop_m;
    const saddle_vec2_t right_m = measurement->foot[SADDLE_RIGHT].cop_m;
    const float left_ahead_m = left_m.x - right_m.x;
    tracker->half_step_m = 0.5f * (landed == SADDLE_LEFT ? left_ahead_m : -left_ahead_m);
    tracker->step_width_m = left_m.y - right_m.y;
    tracker->half_step_known = true;
}

static void follow_stance(saddle_step_tracker_t *tracker, const saddle_measurement_t *measurement)
{
    const bool left = measurement->foot[SADDLE_LEFT].contact;
    if (left != measurement->foot[SADDLE_RIGHT].contact) {
        tracker->stance = (uint8_t)(left ? SADDLE_LEFT : SADDLE_RIGHT);
    }
}

/* Both feet carry a CoM that hardly moves. */
static bool stands_still(const saddle_measurement_t *measurement)
{
    const saddle_vec2_t v = measurement->com.velocity_m_s;
    return measurement->foot[SADDLE_LEFT].contact && measurement->foot[SADDLE_RIGHT].contact &&
           v.x * v.x + v.y * v.y < STANDING_SPEED_M_S * STANDING_SPEED_M_S;
}

/* Who has not stepped for so long does not walk any more. */
static void age_step(saddle_step_tracker_t *tracker, const saddle_model_t *model, float dt_s)
{
    tracker->since_strike_s += dt_s;
    if (tracker->since_strike_s > model->config.step_time_max_s) {
        tracker->since_strike_s = model->config.step_time_max_s;
        tracker->step_open = false;
        tracker->v_comp_known = false;
        tracker->half_step_known = false;
    }
}

void saddle_track_steps(saddle_step_tracker_t *tracker, const saddle_model_t *model,
                        const saddle_measurement_t *measurement, uint32_t faults, float dt_s)
{
    age_step(tracker, model, dt_s);
    const bool com_known = (faults & SADDLE_FAULTS_COM) == 0u;
    const bool left_known = (faults & SADDLE_FAULTS_LEFT) == 0u;
    const bool right_known = (faults & SADDLE_FAULTS_RIGHT) == 0u;
    const bool left = left_known && heel_strike(tracker, measurement, SADDLE_LEFT, dt_s);
    const bool right = right_known && heel_strike(tracker, measurement, SADDLE_RIGHT, dt_s);
    const bool strike = left || right;
    const float velocity_m_s = measurement->com.velocity_m_s.x;
    tracker->struck = strike;
    if (strike) {
        const saddle_side_t side = left ? SADDLE_LEFT : SADDLE_RIGHT;
        const float since_s =
            saddle_smaller((float)measurement->foot[side].since_us * 1.0e-6f, dt_s);
        follow_strike(tracker, com_known, velocity_m_s, dt_s, since_s);
        tracker->stance = (uint8_t)side;
        tracker->since_strike_s = since_s;
    } else {
        follow_speed(tracker, com_known, velocity_m_s, dt_s);
    }
    tracker->half_step_known = tracker->half_step_known && !strike;
    if (left_known && right_known) {
        if (strike) {
            follow_step(tracker, measurement, (saddle_side_t)tracker->stance);
        }
        follow_stance(tracker, measurement);
    }
    if (com_known && left_known && right_known && !tracker->v_comp_known) {
        tracker->stands = tracker->stands || stands_still(measurement);
    }
}

void saddle_track_gap(saddle_step_tracker_t *tracker, float gap_s)
{
    tracker->step_open = false;
    tracker->stands = false;
    tracker->disturbed = false;
    tracker->since_strike_s += gap_s;
}
