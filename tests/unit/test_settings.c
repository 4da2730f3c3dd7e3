/** What is fitted to the wearer, from a page of flash. */
#include "core_test.h"

#include <settings.h>

static uint32_t page[256];

void setUp(void)
{
    memset(page, 0xFF, sizeof page); /* as flash that was erased */
}

void tearDown(void) {}

static float field_at(const saddle_config_t *config, size_t index)
{
    float value;
    memcpy(&value, (const char *)config + saddle_config_field(index)->offset, sizeof value);
    return value;
}

static void test_without_a_page_nothing_is_changed(void)
{
    const saddle_config_t before = saddle_config_default(1.6f, 50.0f);
    saddle_config_t config = before;
    bool lockstep = true;
    saddle_settings_read(page, &config, &lockstep);
    TEST_ASSERT_EQUAL_MEMORY(&before, &config, sizeof config);
    TEST_ASSERT_TRUE(lockstep);
}

static void test_every_field_comes_from_the_page(void)
{
    saddle_config_t config = saddle_config_default(1.6f, 50.0f);
    bool lockstep = false;
    size_t fields = 0;
    page[0] = SADDLE_SETTINGS_MAGIC;
    page[SADDLE_SETTINGS_LOCKSTEP] = 1;
    page[SADDLE_SETTINGS_ANKLE] = SADDLE_ANKLE_RIGID;
    for (; saddle_config_field(fields) != NULL; ++fields) {
        const float value = (float)fields + 0.5f;
        memcpy(&page[SADDLE_SETTINGS_FIELDS + fields], &value, sizeof value);
    }
    saddle_settings_read(page, &config, &lockstep);
    TEST_ASSERT_TRUE(lockstep);
    TEST_ASSERT_EQUAL_INT(SADDLE_ANKLE_RIGID, config.ankle);
    for (size_t i = 0; i < fields; ++i) {
        ASSERT_SAME_FLOAT((float)i + 0.5f, field_at(&config, i));
    }
    page[SADDLE_SETTINGS_LOCKSTEP] = 0;
    saddle_settings_read(page, &config, &lockstep);
    TEST_ASSERT_FALSE(lockstep);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_a_page_nothing_is_changed);
    RUN_TEST(test_every_field_comes_from_the_page);
    return UNITY_END();
}
