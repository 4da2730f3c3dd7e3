/** The frames of one tick, as cansend takes them. */
#include <saddlewalk/wire.h>
#include <stdio.h>

int main(void)
{
    static saddle_context_t walker;
    static saddle_output_t output;
    static saddle_input_t input;
    static saddle_wire_health_t health;
    static saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    if (saddle_init(&walker, &config) != SADDLE_OK ||
        saddle_tick(&walker, &input, &output) != SADDLE_OK) {
        return 1;
    }
    saddle_wire_encode_output(&output, &health, 0, frames);
    for (size_t i = 0; i < SADDLE_WIRE_OUTPUT_FRAMES; i++) {
        printf("%03X#", (unsigned)frames[i].id);
        for (size_t k = 0; k < SADDLE_WIRE_LENGTH; k++) {
            printf("%02X", (unsigned)frames[i].data[k]);
        }
        printf("\n");
    }
    return 0;
}
