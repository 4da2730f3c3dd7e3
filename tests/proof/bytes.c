/** Clearing and copying of what the core clears and copies; in core.c they are libc's, which Eva
 *  knows. Read by Eva (`make prove`). */
#include "math/bytes.h"

#include <saddlewalk/saddlewalk.h>

static volatile saddle_planner_t any_planner;

int main(void)
{
    static saddle_context_t context;
    saddle_planner_t copy, planner = any_planner;
    saddle_output_t output;
    saddle_plan_t plan;
    saddle_scores_t scores;
    saddle_clear(&context, sizeof context);
    saddle_clear(&planner.cycle, sizeof planner.cycle);
    saddle_clear(&output, sizeof output);
    saddle_clear(&plan, sizeof plan);
    saddle_clear(&scores, sizeof scores);
    saddle_copy(&copy, &planner, sizeof copy);
    return copy.mode + output.limits + plan.mode + scores.valid == 0u;
}
