/* A device with FreeRTOS: a task for the sensors, one for the core, one for the drives, which want the
 * plan more often than it is made. What a board has is in the functions at the top; here they play a
 * person who stands, whose left foot's sensor dies after two seconds. */
#include <FreeRTOS.h>
#include <queue.h>
#include <saddlewalk/saddlewalk.h>
#include <stdio.h>
#include <stdlib.h>
#include <task.h>

#define SENSOR_MS 10u
#define TICK_MS 80u
#define DRIVE_MS 4u
#define RUN_US 4000000u
#define LEFT_DIES_US 2000000u

/* ---- the board ---- */

static uint64_t board_clock_us(void)
{
    return 1000ull * xTaskGetTickCount(); /* use a timer of 64 bits: this wraps after 49 days */
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
    (void)plan; /* the targets of the joints' controllers, as docs/joints.md has them */
}

static void board_brake(bool hold)
{
    (void)hold; /* true: support the person, whatever the plan says */
}

static void board_feed_watchdog(void)
{
    /* not fed for two ticks, it removes power from the drives */
}

/* ---- what the tasks hand over: the newest of each, by value ---- */

typedef struct {
    saddle_measurement_t measured; /* its ages are filled in by who uses it */
    uint64_t com_us, foot_us[2];   /* when each was sampled; 0: never */
} samples_t;

static StaticQueue_t samples_box, walker_box;
static uint8_t samples_room[sizeof(samples_t)], walker_room[sizeof(saddle_context_t)];
static QueueHandle_t samples_queue, walker_queue;

static uint32_t age_us(uint64_t sampled_us, uint64_t now_us)
{
    const uint64_t age = now_us - sampled_us;
    return sampled_us != 0 && age < SADDLE_AGE_NEVER_US ? (uint32_t)age : SADDLE_AGE_NEVER_US;
}

/* ---- the tasks ---- */

static void sensor_task(void *unused)
{
    static samples_t samples;
    TickType_t woken = xTaskGetTickCount();
    (void)unused;
    for (;;) {
        xTaskDelayUntil(&woken, pdMS_TO_TICKS(SENSOR_MS));
        board_com(&samples.measured.com);
        samples.com_us = board_clock_us();
        for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
            if (board_foot(side, &samples.measured.foot[side])) {
                samples.foot_us[side] = board_clock_us();
            }
        }
        xQueueOverwrite(samples_queue, &samples);
    }
}

/* No context is used by two tasks: the drives get a copy of it after each tick. */
static void drive_task(void *unused)
{
    static saddle_context_t walker;
    TickType_t woken = xTaskGetTickCount();
    (void)unused;
    for (;;) {
        saddle_plan_t plan;
        xTaskDelayUntil(&woken, pdMS_TO_TICKS(DRIVE_MS));
        if (xQueuePeek(walker_queue, &walker, 0) == pdTRUE &&
            saddle_plan_at(&walker, board_clock_us(), &plan) == SADDLE_OK) {
            board_drives(&plan);
        }
    }
}

static void judge(const saddle_input_t *input, const saddle_output_t *output)
{
    static const char *const levels[] = {"unknown", "stable", "caution", "unstable"};
    static uint8_t shown = UINT8_MAX;
    const bool works = output->status == SADDLE_OK && output->plan.valid;
    if (works) {
        board_feed_watchdog();
    }
    board_brake(!works || output->verdict.level == SADDLE_LEVEL_UNSTABLE ||
                (output->limits & SADDLE_LIMIT_SAFE_STOP) != 0);
    if (output->verdict.level != shown) {
        shown = output->verdict.level;
        printf("%lu ms  %s, faults 0x%04lx\n", (unsigned long)(input->time_us / 1000u),
               levels[shown], (unsigned long)output->faults);
    }
}

static void walk_task(void *context)
{
    static saddle_input_t input = {.command = {SADDLE_COMMAND_STAND, 0.0f, 0.0f}};
    static saddle_output_t output;
    static samples_t samples;
    TickType_t woken = xTaskGetTickCount();
    while (board_clock_us() < RUN_US) {
        xTaskDelayUntil(&woken, pdMS_TO_TICKS(TICK_MS));
        (void)xQueuePeek(samples_queue, &samples, 0);
        input.time_us = board_clock_us();
        input.measurement = samples.measured;
        input.measurement.com.age_us = age_us(samples.com_us, input.time_us);
        for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
            input.measurement.foot[side].age_us = age_us(samples.foot_us[side], input.time_us);
        }
        (void)saddle_tick(context, &input, &output);
        xQueueOverwrite(walker_queue, context);
        judge(&input, &output);
    }
    printf("%lu words of stack left\n", (unsigned long)uxTaskGetStackHighWaterMark(NULL));
    exit(0); /* of the emulator; a device goes on */
}

void vApplicationStackOverflowHook(TaskHandle_t task, char *name);

void vApplicationStackOverflowHook(TaskHandle_t task, char *name)
{
    (void)task;
    (void)name;
    abort(); /* the watchdog is not fed any more */
}

int main(void)
{
    static saddle_context_t walker;
    static StaticTask_t sensor, walk, drive;
    static StackType_t sensor_stack[256], walk_stack[1024], drive_stack[512];
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    if (saddle_init(&walker, &config) != SADDLE_OK) {
        const char *field = saddle_config_check(&config);
        printf("not started: %s\n", field ? field : "the compiler's flags");
        return 1; /* the drives were never powered */
    }
    samples_queue = xQueueCreateStatic(1, sizeof(samples_t), samples_room, &samples_box);
    walker_queue = xQueueCreateStatic(1, sizeof(saddle_context_t), walker_room, &walker_box);
    (void)xTaskCreateStatic(walk_task, "walk", 1024, &walker, 1, walk_stack, &walk);
    (void)xTaskCreateStatic(sensor_task, "sensor", 256, NULL, 2, sensor_stack, &sensor);
    (void)xTaskCreateStatic(drive_task, "drive", 512, NULL, 3, drive_stack, &drive);
    vTaskStartScheduler();
    return 1;
}
