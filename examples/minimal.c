#include <saddlewalk/saddlewalk.h>
#include <stdio.h>

int main(void)
{
    static saddle_context_t walker;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f); /* height m, mass kg */
    saddle_input_t input = {
        .command = {SADDLE_COMMAND_WALK, 1.2f, 0.17f, 0.0f}}; /* m/s, rad, rad/s */
    input.measurement = saddle_no_measurement(); /* your sensors; output.verdict needs them */
    if (saddle_init(&walker, &config) != SADDLE_OK) {
        return 1; /* the configuration, or a compiler flag that breaks the arithmetic */
    }
    for (input.time_us = 0; input.time_us < 4000000; input.time_us += 80000) {
        saddle_output_t output;
        saddle_scores_t planned;
        saddle_tick(&walker, &input, &output);
        saddle_score_plan(&walker, &output.plan, &planned);
        printf("CoM %6.3f %6.3f %6.3f m   XCoM in base %6.3f m\n", output.plan.com_m.x,
               output.plan.com_m.y, output.plan.com_m.z, planned.mos_xcom_m);
    }
    return 0;
}
