/** What the watchdog resets: the image of firmware/port_mcu with a saddle_tick() that misbehaves
 *  after a while, in another way after each reset. Exit status 0 once each has been reset. */
#include <board.h>
#include <settings.h>
#include <timing.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define GOOD_TICKS 12u /* for some times as long as the watchdog waits; the one midway is late */
#define BAD_TICKS 4u   /* more are not to be survived */

/** What is wrong, by the resets before. */
enum { STALLED, REFUSED, LATE, WARNED, ALL_RESET };

/** Kept over a reset; QEMU's memory begins with zeros. */
static uint32_t resets __attribute__((section(".preserve")));
static uint32_t ticks __attribute__((section(".preserve")));

saddle_status_t __real_saddle_tick(saddle_context_t *context, const saddle_input_t *input,
                                   saddle_output_t *output);
saddle_status_t __wrap_saddle_tick(saddle_context_t *context, const saddle_input_t *input,
                                   saddle_output_t *output);

bool __wrap_saddle_settings_read(const uint32_t *page, saddle_settings_t *settings);

bool __wrap_saddle_settings_read(const uint32_t *page, saddle_settings_t *settings)
{
    (void)page;
    settings->config = saddle_config_default(1.79f, 63.3f);
    settings->joints = saddle_joint_loop_default(&settings->config);
    settings->lockstep = false;
    return true;
}

void __wrap_mps2_sleep(void);

/** QEMU 7.2 counts twice what is slept under `-icount sleep=off`, and the watchdog's time with it. */
void __wrap_mps2_sleep(void) {}

static void finish(const char *words, int status)
{
    printf("%s: %" PRIu32 " resets, %" PRIu32 " ticks since\n", words, resets, ticks);
    exit(status);
}

/** The first tick since a reset. */
static void begin(void)
{
    if (ticks != 0u && ticks <= GOOD_TICKS) {
        finish("reset though all was well", 1);
    }
    resets += ticks != 0u;
    ticks = 0;
    if (resets == ALL_RESET) {
        finish("all were reset", 0);
    }
}

static void wait_us(uint32_t us)
{
    const uint64_t end_us = saddle_clock_now_us() + us;
    while (saddle_clock_now_us() < end_us) {
    }
}

saddle_status_t __wrap_saddle_tick(saddle_context_t *context, const saddle_input_t *input,
                                   saddle_output_t *output)
{
    static bool begun;
    if (!begun) {
        begun = true;
        begin();
    }
    ++ticks;
    if (ticks > GOOD_TICKS + BAD_TICKS) {
        finish("not reset", 1);
    }
    const bool bad = ticks > GOOD_TICKS;
    while (bad && resets == STALLED) {
    }
    if ((bad && resets == LATE) || ticks == GOOD_TICKS / 2u) {
        wait_us(SADDLE_TICK_US + 1000u);
    }
    if (resets == WARNED && ticks == GOOD_TICKS + 1u) { /* all would be well after it */
        wait_us(SADDLE_TICK_US * 15u / 8u);
    }
    return __real_saddle_tick(context, bad && resets == REFUSED ? NULL : input, output);
}
