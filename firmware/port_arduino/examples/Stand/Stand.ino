// Every 80 ms the plan and the verdict for somebody who stands; put your sensors in their place.
#include <Saddlewalk.h>

const uint32_t PERIOD_US = 80000;

static saddle_context_t walker;
static saddle_input_t input;
static saddle_output_t output;

void setup() {
  Serial.begin(115200);
  const saddle_config_t config = saddle_config_default(1.79f, 63.3f);  // height m, mass kg
  const saddle_status_t status = saddle_init(&walker, &config);
  if (status == SADDLE_ERROR_BUILD) {
    Serial.println("compile with -ffp-contract=off: docs/porting.md");
  }
  input.command.mode = SADDLE_COMMAND_STAND;
  input.measurement.com.height_m = 1.0f;
  input.measurement.foot[SADDLE_LEFT].cop_m.y = 0.1f;
  input.measurement.foot[SADDLE_RIGHT].cop_m.y = -0.1f;
  input.measurement.foot[SADDLE_LEFT].contact = true;
  input.measurement.foot[SADDLE_RIGHT].contact = true;
}

void loop() {
  // micros() wraps after 71 minutes, time_us never.
  const uint32_t since_us = micros() - static_cast<uint32_t>(input.time_us);
  if (since_us < PERIOD_US) {
    return;
  }
  input.time_us += since_us;
  if (saddle_tick(&walker, &input, &output) == SADDLE_OK) {
    Serial.print(output.plan.com_m.z, 3);
    Serial.print(" m, level ");
    Serial.println(output.verdict.level);
  }
}
