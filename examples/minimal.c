#include <saddlewalk/saddlewalk.h>
#include <stdio.h>

/* Your sensors; here of a wearer who does as planned. */
static void measure(const saddle_plan_t *plan, saddle_measurement_t *measured)
{
    measured->com.height_m = plan->com_m.z;
    measured->com.velocity_m_s.x = plan->com_velocity_m_s.x;
    measured->com.velocity_m_s.y = plan->com_velocity_m_s.y;
    measured->com.age_us = 0;
    for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
        const saddle_vec3_t foot_m = plan->foot_m[side];
        measured->foot[side].cop_m.x = foot_m.x - plan->com_m.x;
        measured->foot[side].cop_m.y = foot_m.y - plan->com_m.y;
        measured->foot[side].contact = foot_m.z == 0.0f;
        measured->foot[side].age_us = 0;
    }
}

int main(void)
{
    static saddle_context_t walker;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f); /* height m, mass kg */
    saddle_input_t input = {.command = {SADDLE_COMMAND_WALK, 1.2f, 0.17f}}; /* m/s, rad */
    saddle_output_t output;
    input.measurement = saddle_no_measurement();
    saddle_init(&walker, &config);
    for (input.time_us = 0; input.time_us < 4000000; input.time_us += 80000) {
        saddle_tick(&walker, &input, &output);
        measure(&output.plan, &input.measurement);
        printf("CoM %6.3f %6.3f %6.3f m   XCoM in base %.3f m   level %d\n", output.plan.com_m.x,
               output.plan.com_m.y, output.plan.com_m.z, output.scores.mos_xcom_m, output.verdict.level);
    }
    return 0;
}
