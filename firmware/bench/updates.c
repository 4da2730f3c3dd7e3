/* saddlewalk-bench-updates: each update of each walk, and then its floor, whose calls are read from
 * standard input as saddlewalk-bench-calls prints them. Prints a line for each: walk, update,
 * status, mode, level, faults. Callgrind counts saddle_init(), saddle_bench_update() or
 * saddle_bench_floor(). */
#include "floor.h"
#include "walks.h"

#include <stdio.h>

/* Far more calls than any update makes. */
#define CALLS_MOST 256u

typedef struct {
    int walk;
    unsigned update;
    int function;
    float argument;
} call_t;

static bool read_call(call_t *call)
{
    /* The numbers are those that saddlewalk-bench-calls printed. */
    /* NOLINTNEXTLINE(bugprone-unchecked-string-to-number-conversion,cert-err34-c) */
    return scanf("%d %u %d %f", &call->walk, &call->update, &call->function, &call->argument) == 4;
}

/* The calls of one update from standard input; *next is the first one after them. */
static uint32_t read_calls(int walk, uint32_t update, call_t *calls, call_t *next, bool *more)
{
    uint32_t count = 0;
    while (*more && next->walk == walk && next->update == update && count < CALLS_MOST) {
        calls[count++] = *next;
        *more = read_call(next);
    }
    return count;
}

static void sort_calls(const call_t *calls, uint32_t count, saddle_bench_calls_t *sorted,
                       float *arguments)
{
    uint32_t next = 0;
    *sorted = (saddle_bench_calls_t){{0}};
    for (int function = 0; function < SADDLE_BENCH_FUNCTIONS; function++) {
        for (uint32_t i = 0; i < count; i++) {
            if (calls[i].function == function) {
                arguments[next++] = calls[i].argument;
                sorted->count[function]++;
            }
        }
    }
}

int main(void)
{
    static saddle_bench_walk_t walk;
    static saddle_output_t output;
    static saddle_scores_t scores;
    static call_t calls[CALLS_MOST], next;
    static float arguments[CALLS_MOST];
    static volatile float sum;
    bool more = read_call(&next);
    for (int number = 0; number < SADDLE_BENCH_WALKS; number++) {
        saddle_bench_walk(&walk, number);
        for (uint32_t update = 0; update < SADDLE_BENCH_UPDATES; update++) {
            saddle_bench_calls_t sorted;
            uint32_t used;
            sort_calls(calls, read_calls(number, update, calls, &next, &more), &sorted, arguments);
            saddle_bench_update(&walk, update, &output, &scores);
            sum = sum + saddle_bench_floor(&sorted, arguments, &used);
            printf("%d %u %d %u %u %u\n", number, (unsigned)update, (int)output.status,
                   (unsigned)output.plan.mode, (unsigned)output.verdict.level,
                   (unsigned)output.faults);
        }
    }
    return more ? 1 : 0;
}
