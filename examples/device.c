/* The loop of a small device without a bus: sensors in, plan to the drives, verdict to the brake.
 * What a board has is in the functions at the top; here they play a person who stands, whose left
 * foot's sensor dies after two seconds. docs/porting.md; with a bus: firmware/port_mcu. */
#include <saddlewalk/saddlewalk.h>
#include <stdio.h>

#define TICK_US 80000u
#define RUN_US 4000000u

/* ---- the board ---- */

static uint64_t now_us;

static uint64_t board_clock_us(void)
{
    return now_us; /* a timer that never goes back */
}

static void board_sleep_until(uint64_t time_us)
{
    now_us = time_us; /* wait for an interrupt */
}

static bool board_com(saddle_measurement_t *person)
{
    const float sway_m_s = (now_us / TICK_US) % 2 ? 0.01f : -0.01f;
    person->com.height_m = 1.0f;
    person->com.velocity_m_s = (saddle_vec2_t){sway_m_s, 0.0f};
    return true; /* a new sample has come since the last call */
}

static bool board_foot(int side, saddle_measurement_t *person)
{
    const float sway_m = (now_us / TICK_US) % 2 ? 0.001f : 0.0f;
    person->foot[side].cop_m = (saddle_vec2_t){sway_m, side == SADDLE_LEFT ? 0.11f : -0.11f};
    person->foot[side].contact = true;
    return side == SADDLE_RIGHT || now_us < 2000000u;
}

static void board_drives(const saddle_plan_t *plan)
{
    (void)plan; /* the targets of the joints' controllers, as docs/joints.md has them */
}

static void board_brake(bool hold)
{
    (void)hold; /* true: support the person, whatever the plan says */
}

static void board_feed_watchdog(void)
{
    /* not fed for two ticks, it removes power from the drives */
}

/* ---- the loop ---- */

static uint32_t age_us(uint64_t sampled_us)
{
    const uint64_t age = now_us - sampled_us;
    return age < SADDLE_AGE_NEVER_US ? (uint32_t)age : SADDLE_AGE_NEVER_US;
}

int main(void)
{
    static saddle_context_t walker;
    static const char *const levels[] = {"unknown", "stable", "caution", "unstable"};
    saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    config.level_hold_ticks = 2; /* any field: saddle_config_check() names one out of range */

    const saddle_status_t status = saddle_init(&walker, &config);
    if (status != SADDLE_OK) {
        const char *field = saddle_config_check(&config);
        printf("not started: status %d, field %s\n", (int)status, field ? field : "none");
        return 1; /* the drives were never powered */
    }

    saddle_input_t input = {.command = {SADDLE_COMMAND_STAND, 0.0f, 0.0f, 0.0f}};
    uint64_t com_us = 0, foot_us[2] = {0, 0};
    uint8_t shown = UINT8_MAX;
    input.measurement = saddle_no_measurement();
    while (board_clock_us() < RUN_US) {
        /* A sample is as old as it is: one that did not come is kept, and ages. The core uses
         * none that is older than the configuration allows. */
        if (board_com(&input.measurement)) {
            com_us = board_clock_us();
        }
        for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
            if (board_foot(side, &input.measurement)) {
                foot_us[side] = board_clock_us();
            }
            input.measurement.foot[side].age_us = age_us(foot_us[side]);
        }
        input.measurement.com.age_us = age_us(com_us);
        input.time_us = board_clock_us();
        input.command_age_us = 0; /* since the person or the therapist last confirmed it */

        saddle_output_t output;
        const bool works = saddle_tick(&walker, &input, &output) == SADDLE_OK && output.plan.valid;
        if (works) {
            board_drives(&output.plan);
            board_feed_watchdog();
        }
        board_brake(!works || output.verdict.level == SADDLE_LEVEL_UNSTABLE ||
                    (output.limits & SADDLE_LIMIT_SAFE_STOP) != 0);
        if (output.verdict.level != shown) {
            shown = output.verdict.level;
            printf("%4.2f s  %s, faults 0x%04x\n", (double)input.time_us * 1e-6, levels[shown],
                   (unsigned)output.faults);
        }
        board_sleep_until(input.time_us + TICK_US);
    }
    return 0;
}
