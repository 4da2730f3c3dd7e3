/* A device with Zephyr: the core's tick every 80 ms in the main thread. What a board has is in the
 * functions at the top; here they play a person who stands, whose left foot's sensor dies after two
 * seconds. */
#include <saddlewalk/saddlewalk.h>
#include <zephyr/kernel.h>

#define TICK_MS 80
#define RUN_MS 4000
#define LEFT_DIES_US 2000000u

/* ---- the board ---- */

static uint64_t board_clock_us(void)
{
    return k_ticks_to_us_floor64((uint64_t)k_uptime_ticks());
}

static void board_com(saddle_measured_com_t *com)
{
    const float sway_m_s = board_clock_us() / 80000u % 2u ? 0.01f : -0.01f;
    com->height_m = 1.0f;
    com->velocity_m_s = (saddle_vec2_t){sway_m_s, 0.0f};
}

static bool board_foot(int side, saddle_measured_foot_t *foot)
{
    const float sway_m = board_clock_us() / 80000u % 2u ? 0.001f : 0.0f;
    foot->cop_m = (saddle_vec2_t){sway_m, side == SADDLE_LEFT ? 0.11f : -0.11f};
    foot->contact = true;
    return side == SADDLE_RIGHT || board_clock_us() < LEFT_DIES_US;
}

static void board_drives(const saddle_plan_t *plan)
{
    ARG_UNUSED(plan); /* the targets of the joints' controllers */
}

static void board_brake(bool hold)
{
    ARG_UNUSED(hold); /* true: support the person, whatever the plan says */
}

/* ---- the loop ---- */

static void measure(saddle_measurement_t *measurement, uint64_t now_us)
{
    static uint64_t foot_us[2]; /* when each foot was sampled; 0: never */
    board_com(&measurement->com);
    measurement->com.age_us = 0; /* sampled in this call */
    for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
        if (board_foot(side, &measurement->foot[side])) {
            foot_us[side] = now_us;
        }
        if (foot_us[side] != 0) {
            measurement->foot[side].age_us = (uint32_t)(now_us - foot_us[side]);
        }
    }
}

static void judge(const saddle_input_t *input, const saddle_output_t *output)
{
    static const char *const levels[] = {"unknown", "stable", "caution", "unstable"};
    static uint8_t shown = UINT8_MAX;
    const bool works = output->status == SADDLE_OK && output->plan.valid;
    if (works) {
        board_drives(&output->plan); /* and feed the watchdog, wdt_feed() */
    }
    board_brake(!works || output->verdict.level == SADDLE_LEVEL_UNSTABLE ||
                (output->limits & SADDLE_LIMIT_SAFE_STOP) != 0);
    if (output->verdict.level != shown) {
        shown = output->verdict.level;
        printk("%u ms  %s, faults 0x%04x\n", (unsigned)(input->time_us / 1000u), levels[shown],
               (unsigned)output->faults);
    }
}

int main(void)
{
    static saddle_context_t walker;
    static saddle_input_t input = {.command = {SADDLE_COMMAND_STAND, 0.0f, 0.0f}};
    static saddle_output_t output;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    if (saddle_init(&walker, &config) != SADDLE_OK) {
        const char *field = saddle_config_check(&config);
        printk("not started: %s\n", field ? field : "the compiler's flags");
        return 1; /* the drives were never powered */
    }
    input.measurement = saddle_no_measurement();
    for (int64_t due_ms = TICK_MS; due_ms <= RUN_MS; due_ms += TICK_MS) {
        k_sleep(K_TIMEOUT_ABS_MS(due_ms));
        input.time_us = board_clock_us();
        measure(&input.measurement, input.time_us);
        (void)saddle_tick(&walker, &input, &output);
        judge(&input, &output);
    }
    return 0;
}
