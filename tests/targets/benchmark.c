/* What there is to be measured, in one image: initialisations, ticks of every kind, then a device's
 * joints.
 *
 * Prints the sizes, then one line for each tick in turn, `tick MODE LEVEL FAULTS STATUS TURNS`, by
 * which the counted instructions are separated. */
#include "device.h"
#include "sequences.h"

#include <stdio.h>

#define TICKS 4000u
#define UPDATES 4000u

static void print_sizes(void)
{
    printf("size context %u\n", (unsigned)sizeof(saddle_context_t));
    printf("size config %u\n", (unsigned)sizeof(saddle_config_t));
    printf("size input %u\n", (unsigned)sizeof(saddle_input_t));
    printf("size output %u\n", (unsigned)sizeof(saddle_output_t));
    printf("size receiver %u\n", (unsigned)sizeof(saddle_wire_receiver_t));
    printf("size estimator %u\n", (unsigned)sizeof(saddle_estimator_t));
    printf("size joint_walk %u\n", (unsigned)sizeof(saddle_joint_walk_t));
}

static bool turns(const saddle_plan_t *plan)
{
    return plan->curvature_1_m[0] != 0.0f || plan->curvature_1_m[1] != 0.0f;
}

static void move_joints(bool absurd)
{
    static device_t device;
    device_begin(&device, absurd);
    while (device.updates < UPDATES) {
        device_update(&device);
    }
}

int main(void)
{
    static sequence_t sequence;
    print_sizes();
    for (int kind = 0; kind < (int)SEQUENCE_COUNT; kind++) {
        sequence_begin(&sequence, (sequence_kind_t)kind);
        while (sequence.ticks < TICKS) {
            sequence_tick(&sequence);
            printf("tick %u %u %lx %u %d\n", (unsigned)sequence.output.plan.mode,
                   (unsigned)sequence.output.verdict.level, (unsigned long)sequence.output.faults,
                   (unsigned)sequence.output.status, turns(&sequence.output.plan) ? 1 : 0);
        }
    }
    move_joints(false);
    move_joints(true);
    return 0;
}
