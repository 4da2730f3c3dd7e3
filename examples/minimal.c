#include <saddlewalk/saddlewalk.h>
#include <stdio.h>

int main(void)
{
    static saddle_context_t walker;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f); /* height m, mass kg */
    saddle_input_t input = {.command = {SADDLE_COMMAND_WALK, 1.2f, 0.17f}}; /* m/s, rad */
    input.measurement.com.height_m = 1.0f; /* your sensors; here somebody who stands */
    input.measurement.foot[SADDLE_LEFT].cop_m.y = 0.1f;
    input.measurement.foot[SADDLE_RIGHT].cop_m.y = -0.1f;
    input.measurement.foot[SADDLE_LEFT].contact = input.measurement.foot[SADDLE_RIGHT].contact = true;
    saddle_init(&walker, &config);
    for (input.time_us = 0; input.time_us < 4000000; input.time_us += 80000) {
        saddle_output_t output;
        saddle_tick(&walker, &input, &output);
        printf("CoM %6.3f %6.3f %6.3f m   XCoM in base %.3f m   level %d\n", output.plan.com_m.x,
               output.plan.com_m.y, output.plan.com_m.z, output.scores.mos_xcom_m, output.verdict.level);
    }
    return 0;
}
