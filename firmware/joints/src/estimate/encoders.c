#include "estimate/encoders.h"

#include "kinematics/legs.h"
#include "math/elementary.h"
#include "space/vec3.h"

/* What the check of one sample needs. */
typedef struct {
    const saddle_estimator_config_t *config;
    saddle_joint_range_t range;
    saddle_vec3_t foot_m;
    bool always_turns; /* a joint that a travelling foot cannot leave alone */
    float dt_s;
} frame_t;

static bool in_range(const frame_t *frame, float rad)
{
    const float margin_rad = frame->config->angle_margin_rad;
    return saddle_in_range(rad, frame->range.min_rad - margin_rad,
                           frame->range.max_rad + margin_rad);
}

static bool leaps(const frame_t *frame, const saddle_encoder_t *encoder, float rad)
{
    const float most_rad =
        frame->range.rate_max_rad_s * frame->dt_s + frame->config->angle_margin_rad;
    return !(saddle_magnitude(rad - encoder->raw_rad) <= most_rad);
}

/* The same bits while the foot travels. */
static bool is_frozen(const frame_t *frame, saddle_encoder_t *encoder, float rad)
{
    if (rad != encoder->raw_rad || !frame->always_turns) {
        encoder->same_s = 0.0f;
        return false;
    }
    if (encoder->same_s == 0.0f) {
        encoder->foot_m = frame->foot_m;
    }
    encoder->same_s = saddle_smaller(encoder->same_s + frame->dt_s, 1.0f);
    const float travel_m = saddle_vec3_length(saddle_vec3_sub(frame->foot_m, encoder->foot_m));
    return encoder->same_s >= frame->config->frozen_time_s &&
           travel_m >= frame->config->frozen_travel_m;
}

/* [J15] Whether it is lost. */
static bool check_encoder(const frame_t *frame, saddle_encoder_t *encoder, float rad, bool stale)
{
    const bool usable = !stale && in_range(frame, rad);
    const bool bad = !usable || leaps(frame, encoder, rad) || is_frozen(frame, encoder, rad);
    if (usable) {
        encoder->raw_rad = rad;
    }
    encoder->unsound_s = bad ? frame->config->frozen_time_s : encoder->unsound_s - frame->dt_s;
    if (encoder->unsound_s > 0.0f) {
        return true;
    }
    encoder->unsound_s = 0.0f;
    encoder->sound_rad = rad;
    return false;
}

void saddle_encoders_start(saddle_estimator_t *estimator, const saddle_sensors_t *sensors)
{
    for (unsigned i = 0; i < 2u * SADDLE_LEG_JOINTS; i++) {
        const unsigned side = i / SADDLE_LEG_JOINTS;
        const unsigned joint = i % SADDLE_LEG_JOINTS;
        const saddle_joint_range_t range =
            saddle_joint_range(&estimator->legs, (saddle_side_t)side, joint);
        const float rad =
            saddle_clamp(sensors->angle_rad[side][joint], range.min_rad, range.max_rad);
        estimator->encoder[side][joint] =
            (saddle_encoder_t){rad, rad, 0.0f, 0.0f, {0.0f, 0.0f, 0.0f}};
    }
}

uint32_t saddle_encoders_update(saddle_estimator_t *estimator, const saddle_sensors_t *sensors,
                                float dt_s)
{
    const uint32_t max_age_us = (uint32_t)(1.0e6f * estimator->config.max_age_s);
    uint32_t lost = 0;
    for (unsigned i = 0; i < 2u * SADDLE_LEG_JOINTS; i++) {
        const unsigned side = i / SADDLE_LEG_JOINTS;
        const unsigned joint = i % SADDLE_LEG_JOINTS;
        const frame_t frame = {&estimator->config,
                               saddle_joint_range(&estimator->legs, (saddle_side_t)side, joint),
                               estimator->sole_m[side],
                               joint >= SADDLE_HIP_PITCH && joint <= SADDLE_ANKLE_PITCH, dt_s};
        const bool stale = sensors->joints_age_us[side] > max_age_us;
        if (check_encoder(&frame, &estimator->encoder[side][joint], sensors->angle_rad[side][joint],
                          stale)) {
            lost |= SADDLE_JOINT_BIT(side, joint);
        }
    }
    return lost;
}
