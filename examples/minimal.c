#include <saddlewalk/saddlewalk.h>
#include <stdio.h>

int main(void)
{
    static saddle_context_t walker;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f); /* height m, mass kg */
    saddle_input_t input = {.command = {SADDLE_COMMAND_WALK, 1.2f, 0.17f}}; /* m/s, rad */
    if (saddle_init(&walker, &config) != SADDLE_OK) {
        return 1;
    }
    for (input.time_us = 0; input.time_us < 4000000; input.time_us += 80000) {
        saddle_output_t output; /* input.measurement: your sensors; here somebody who stands */
        input.measurement.com.height_m = 1.0f;
        for (int side = 0; side < 2; side++) {
            input.measurement.foot[side].cop_m.y = side == SADDLE_LEFT ? 0.1f : -0.1f;
            input.measurement.foot[side].contact = true;
        }
        saddle_tick(&walker, &input, &output);
        printf("CoM %6.3f %6.3f %6.3f m   margin of stability %.3f m   level %u\n",
               output.plan.com_m.x, output.plan.com_m.y, output.plan.com_m.z,
               output.scores.mos_com_m, (unsigned)output.verdict.level);
    }
    return 0;
}
