/** The core knows whether arithmetic is what it was written for. The compiler's flags:
 *  tests/python/test_packaging.py. */
#include "core_test.h"

#include "math/rounding.h"

#include <fenv.h>

/* Not every target's library can change the mode, and WebAssembly has one alone. */
#if !defined SADDLE_EMULATED && defined FE_UPWARD
#define MODES_CHANGE
#endif

void setUp(void) {}

void tearDown(void)
{
#ifdef MODES_CHANGE
    fesetround(FE_TONEAREST);
#endif
}

static void test_this_build_rounds_as_written(void)
{
    TEST_ASSERT_TRUE(saddle_rounds_as_written());
}

#ifdef MODES_CHANGE
static void test_other_rounding_modes_are_detected_by_init(void)
{
    static const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    const saddle_config_t config = paper_config();
    static saddle_context_t context;
    static saddle_output_t output;
    const saddle_input_t input = {.command = {SADDLE_COMMAND_STAND, 0.0f, 0.0f, 0.0f}};
    for (size_t i = 0; i < COUNT_OF(modes); i++) {
        TEST_ASSERT_EQUAL_INT(0, fesetround(modes[i]));
        const saddle_status_t status = saddle_init(&context, &config);
        fesetround(FE_TONEAREST);
        TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_BUILD, status);
        TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_UNINITIALISED, saddle_tick(&context, &input, &output));
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    }
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_this_build_rounds_as_written);
#ifdef MODES_CHANGE
    RUN_TEST(test_other_rounding_modes_are_detected_by_init);
#endif
    return UNITY_END();
}
