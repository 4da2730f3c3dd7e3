/** Any accepted configuration, any row of calls, plausible inputs and raw ones: every number finite,
 *  a stale CoM unknown, lost inputs a stop, no speed above the ceiling, plan_at the next tick's. */
#include "fuzz.h"
#include "output_fields.h"

#include <math.h>

static saddle_context_t context;
static saddle_input_t input;
static saddle_output_t output;

static saddle_config_t some_config(fuzz_bytes_t *bytes)
{
    saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    size_t count = 0;
    while (saddle_config_field(count) != NULL) {
        ++count;
    }
    config.ankle = (saddle_ankle_t)(fuzz_byte(bytes) % SADDLE_ANKLE_COUNT);
    for (uint8_t fields = fuzz_byte(bytes) % 16u; fields > 0u; --fields) {
        const saddle_config_field_t *field = saddle_config_field(fuzz_byte(bytes) % count);
        const float value = fuzz_between(bytes, field->min, field->max);
        memcpy((char *)&config + field->offset, &value, sizeof value);
    }
    return config;
}

static void require_numbers(const saddle_output_t *checked)
{
    for (size_t i = 0; i < sizeof FIELDS / sizeof FIELDS[0]; ++i) {
        for (size_t at = 0; FIELDS[i].kind == FLOATS && at < FIELDS[i].size; at += sizeof(float)) {
            float value;
            memcpy(&value, (const char *)checked + FIELDS[i].offset + at, sizeof value);
            REQUIRE(isfinite(value));
        }
    }
}

static void require_safe(void)
{
    const saddle_config_t *config = &context.model.config;
    const bool stale = (float)input.measurement.com.age_us > config->com_max_age_s * 1.0e6f;
    require_numbers(&output);
    REQUIRE(output.plan.valid);
    REQUIRE(output.plan.speed_m_s >= 0.0f);
    REQUIRE(output.plan.speed_m_s <= context.model.body.speed_ceiling_m_s);
    REQUIRE(!stale || (output.faults & SADDLE_FAULT_COM_STALE) != 0u);
    const bool unmeasured =
        (output.faults & (SADDLE_FAULT_COM_STALE | SADDLE_FAULT_COM_RANGE)) != 0u;
    REQUIRE(!unmeasured || (output.scores.valid & SADDLE_VALID_MOS_XCOM) == 0u);
    REQUIRE(!unmeasured || output.verdict.level == SADDLE_LEVEL_UNKNOWN);
    REQUIRE(output.verdict.level <= SADDLE_LEVEL_UNSTABLE);
    REQUIRE(output.plan.mode <= SADDLE_MODE_STOPPING && output.plan.support <= SADDLE_RIGHT);
    REQUIRE((output.limits & SADDLE_LIMIT_SAFE_STOP) == 0u || context.planner.speed_m_s == 0.0f);
}

static void require_numbers_after(const saddle_plan_t *plan, float after_s)
{
    saddle_reference_t reference;
    const saddle_status_t status = saddle_reference_after(&context, plan, after_s, &reference);
    REQUIRE(status == SADDLE_OK || status == SADDLE_ERROR_TIME);
    REQUIRE(isfinite(reference.xcom_m.x) && isfinite(reference.xcom_m.y));
    REQUIRE(isfinite(reference.cop_m.x) && isfinite(reference.cop_m.y));
}

static void tick(uint32_t after_us)
{
    static saddle_output_t at;
    saddle_plan_t now;
    input.time_us += after_us;
    REQUIRE(saddle_tick(&context, &input, &output) == SADDLE_OK);
    require_safe();
    REQUIRE(saddle_plan_at(&context, input.time_us, &now) == SADDLE_OK);
    REQUIRE(now.com_m.x == output.plan.com_m.x && now.com_m.z == output.plan.com_m.z);
    at = output;
    if (saddle_plan_at(&context, input.time_us + after_us, &at.plan) == SADDLE_OK) {
        require_numbers(&at);
        require_numbers_after(&at.plan, (float)after_us * 1.0e-6f);
    }
    REQUIRE(saddle_score_plan(&context, &at.plan, &at.scores) == SADDLE_OK);
    require_numbers(&at);
}

/** Any bits, but for the contacts, which are 0 or 1. */
static void patch(fuzz_bytes_t *bytes)
{
    float *const numbers[] = {&input.command.speed_m_s,
                              &input.command.heel_strike_rad,
                              &input.command.turn_rate_rad_s,
                              &input.measurement.com.height_m,
                              &input.measurement.com.velocity_m_s.x,
                              &input.measurement.com.velocity_m_s.y,
                              &input.measurement.foot[SADDLE_LEFT].cop_m.x,
                              &input.measurement.foot[SADDLE_LEFT].cop_m.y,
                              &input.measurement.foot[SADDLE_LEFT].ground_m_s,
                              &input.measurement.foot[SADDLE_RIGHT].cop_m.x,
                              &input.measurement.foot[SADDLE_RIGHT].cop_m.y,
                              &input.measurement.foot[SADDLE_RIGHT].ground_m_s};
    float *number = numbers[fuzz_byte(bytes) % (sizeof numbers / sizeof numbers[0])];
    fuzz_take(bytes, number, sizeof *number);
}

static void set_ages(fuzz_bytes_t *bytes)
{
    input.command_age_us = fuzz_word(bytes) >> fuzz_byte(bytes) % 32u;
    input.measurement.com.age_us = fuzz_word(bytes) >> fuzz_byte(bytes) % 32u;
    for (int side = 0; side < 2; ++side) {
        input.measurement.foot[side].age_us = fuzz_word(bytes) >> fuzz_byte(bytes) % 32u;
        input.measurement.foot[side].since_us = fuzz_word(bytes) >> fuzz_byte(bytes) % 32u;
    }
}

static void measure(fuzz_bytes_t *bytes)
{
    input.measurement.com.height_m = fuzz_between(bytes, 0.3f, 1.4f);
    input.measurement.com.velocity_m_s.x = fuzz_between(bytes, -2.0f, 2.5f);
    input.measurement.com.velocity_m_s.y = fuzz_between(bytes, -1.0f, 1.0f);
}

static void put_foot(fuzz_bytes_t *bytes)
{
    const uint8_t which = fuzz_byte(bytes);
    const int side = which & 1;
    input.measurement.foot[side].contact = (which & 2) != 0;
    input.measurement.foot[side].cop_m.x = fuzz_between(bytes, -0.8f, 0.8f);
    input.measurement.foot[side].cop_m.y = fuzz_between(bytes, -0.4f, 0.4f);
}

static void adapt(fuzz_bytes_t *bytes)
{
    const saddle_config_t shape = some_config(bytes);
    (void)saddle_adapt(&context, &shape);
}

static void act(fuzz_bytes_t *bytes)
{
    switch (fuzz_byte(bytes) % 11u) {
    case 0: tick(fuzz_word(bytes) >> fuzz_byte(bytes) % 32u); break;
    case 1:
        for (uint8_t ticks = fuzz_byte(bytes) % 32u; ticks > 0u; --ticks) {
            tick(80000);
        }
        break;
    case 2:
        input.command.mode = fuzz_byte(bytes) % 3u;
        input.command.speed_m_s = fuzz_between(bytes, -0.5f, 3.0f);
        input.command.heel_strike_rad = fuzz_between(bytes, -0.1f, 0.6f);
        break;
    case 3: measure(bytes); break;
    case 4:
    case 5: put_foot(bytes); break;
    case 6: set_ages(bytes); break;
    case 7: patch(bytes); break;
    case 8: (void)saddle_join(&context, &input.command); break;
    case 9: adapt(bytes); break;
    default: tick(80000); break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_bytes_t bytes = {data, size};
    const saddle_config_t config = some_config(&bytes);
    memset(&input, 0, sizeof input);
    input.measurement.com.height_m = 1.0f;
    input.measurement.foot[SADDLE_LEFT].cop_m.y = 0.1f;
    input.measurement.foot[SADDLE_RIGHT].cop_m.y = -0.1f;
    if (saddle_init(&context, &config) != SADDLE_OK) {
        REQUIRE(saddle_config_check(&config) != NULL);
        return 0;
    }
    while (bytes.left > 0u) {
        act(&bytes);
    }
    return 0;
}
