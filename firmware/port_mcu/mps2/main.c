/** A controller on the MPS2 board. Started by QEMU with a serial line to an emulated wearer; when
 *  the wearer leaves, it prints its statistics through semihosting. Exit status 1: it could not run. */
#include "controller.h"
#include "mps2.h"
#include "settings.h"
#include "stack_paint.h"

#include <inttypes.h>
#include <stdio.h>

#define SETTINGS ((const uint32_t *)0x003FF000u) /* the last page of the flash */

extern uint32_t __stack[];  /* the linker's: the stack's top */
extern char __stack_size[]; /* this one's address is the number of its bytes */

static saddle_controller_t controller;

/** This board has no source of random bits: it cannot require codes. */
bool saddle_random(uint32_t *bits)
{
    (void)bits;
    return false;
}

static uint32_t *stack_lowest(void)
{
    return __stack - (uintptr_t)__stack_size / sizeof __stack[0];
}

static void run(void)
{
    mps2_can_start();
    mps2_clock_start(saddle_joint_loop_period_us(&controller.joints.config));
    if (!controller.lockstep) { /* the time of the next tick is unknown there */
        mps2_watchdog_start();
    }
    while (!mps2_can_closed()) {
        saddle_controller_step(&controller);
        mps2_sleep();
    }
}

static void report(void)
{
    const uint32_t used = saddle_stack_used(stack_lowest(), __stack);
    printf("%" PRIu32 " ticks, %" PRIu32 " late, %" PRIu32 " missed; frames: %" PRIu32
           " lost, %" PRIu32 " not sent; stack: %" PRIu32 " of %" PRIu32 " bytes\n",
           controller.timing.ticks, controller.timing.late_ticks, controller.timing.missed_ticks,
           saddle_can_lost(), controller.not_sent, used, (uint32_t)(uintptr_t)__stack_size);
}

/** False: what is wrong with the settings was printed. */
static bool start(const saddle_settings_t *settings)
{
    const char *bad_field = saddle_config_check(&settings->config);
    bad_field = bad_field != NULL ? bad_field : saddle_joint_loop_check(&settings->joints);
    saddle_status_t status =
        saddle_controller_init(&controller, &settings->config, settings->lockstep);
    if (status == SADDLE_OK) {
        status = saddle_controller_drive_joints(&controller, &settings->joints);
    }
    if (status != SADDLE_OK || bad_field != NULL) {
        printf("saddle_init: status %d, %s\n", (int)status,
               bad_field != NULL ? bad_field : "see saddle_status_t");
        return false;
    }
    return true;
}

int main(void)
{
    static saddle_settings_t settings;
    saddle_stack_paint(stack_lowest());
    if (!saddle_settings_read(SETTINGS, &settings)) {
        printf("settings: the page is damaged, was never written, or holds other fields\n");
        return 1;
    }
    if (!start(&settings)) {
        return 1;
    }
    run();
    report();
    return 0;
}
