/** What is fitted to the wearer, from a page of flash. */
#include "core_test.h"

#include <settings.h>

static uint32_t page[256];
static size_t fields;
static saddle_settings_t before, settings;

static size_t words(void)
{
    return SADDLE_SETTINGS_FIELDS + fields;
}

/** The field at an index of the page: of the configuration, then of the joints' parts; NULL: none. */
static float *field_at(size_t index)
{
    const saddle_config_field_t *field;
    for (size_t i = 0; (field = saddle_config_field(i)) != NULL; ++i) {
        if (index-- == 0u) {
            return (float *)(void *)((char *)&settings.config + field->offset);
        }
    }
    for (size_t part = 0; part < SADDLE_JOINT_PARTS; ++part) {
        const saddle_joint_part_t fields_of = saddle_joint_part(part);
        for (size_t i = 0; (field = fields_of.field(i)) != NULL; ++i) {
            if (index-- == 0u) {
                char *values = (char *)&settings.joints + fields_of.offset;
                return (float *)(void *)(values + field->offset);
            }
        }
    }
    return NULL;
}

/** In lockstep, with a rigid ankle, 40 passes, and each field half above its place in the list. */
void setUp(void)
{
    memset(page, 0xFF, sizeof page); /* as flash that was erased */
    page[SADDLE_SETTINGS_LOCKSTEP] = 1;
    page[SADDLE_SETTINGS_ANKLE] = SADDLE_ANKLE_RIGID;
    page[SADDLE_SETTINGS_PASSES] = 40;
    for (fields = 0; field_at(fields) != NULL; ++fields) {
        const float value = (float)fields + 0.5f;
        memcpy(&page[SADDLE_SETTINGS_FIELDS + fields], &value, sizeof value);
    }
    page[SADDLE_SETTINGS_CRC] = saddle_settings_crc(page);
    memset(&before, 0, sizeof before);
    before.config = saddle_config_default(1.6f, 50.0f);
    before.joints = saddle_joint_loop_default(&before.config);
    settings = before;
}

void tearDown(void) {}

static void expect_refused(void)
{
    TEST_ASSERT_FALSE(saddle_settings_read(page, &settings));
    TEST_ASSERT_EQUAL_MEMORY(&before, &settings, sizeof settings);
}

static void test_every_field_is_read_from_the_page(void)
{
    TEST_ASSERT_TRUE(saddle_settings_read(page, &settings));
    TEST_ASSERT_TRUE(settings.lockstep);
    TEST_ASSERT_EQUAL_INT(SADDLE_ANKLE_RIGID, settings.config.ankle);
    TEST_ASSERT_EQUAL_UINT32(40, settings.joints.passes);
    TEST_ASSERT_GREATER_THAN_UINT32(150, fields);
    for (size_t i = 0; i < fields; ++i) {
        ASSERT_SAME_FLOAT((float)i + 0.5f, *field_at(i));
    }
    page[SADDLE_SETTINGS_LOCKSTEP] = 0;
    page[SADDLE_SETTINGS_CRC] = saddle_settings_crc(page);
    TEST_ASSERT_TRUE(saddle_settings_read(page, &settings));
    TEST_ASSERT_FALSE(settings.lockstep);
}

static void test_a_page_is_read_as_it_was_written(void)
{
    uint32_t written[256];
    memset(written, 0xFF, sizeof written);
    TEST_ASSERT_TRUE(saddle_settings_read(page, &settings));
    saddle_settings_write(written, &settings);
    TEST_ASSERT_EQUAL_MEMORY(page, written, sizeof written);
    saddle_settings_write(written, &before);
    TEST_ASSERT_TRUE(saddle_settings_read(written, &settings));
    TEST_ASSERT_EQUAL_MEMORY(&before, &settings, sizeof settings);
}

static void test_a_page_that_was_never_written_is_rejected(void)
{
    memset(page, 0xFF, sizeof page);
    expect_refused();
    memset(page, 0, sizeof page);
    expect_refused();
}

static void test_every_flipped_bit_is_rejected(void)
{
    for (size_t bit = 0; bit < 32u * words(); ++bit) {
        page[bit / 32u] ^= 1u << bit % 32u;
        expect_refused();
        page[bit / 32u] ^= 1u << bit % 32u;
    }
    TEST_ASSERT_TRUE(saddle_settings_read(page, &settings));
}

/** The CRC of the words alone, as the page of a list with other names would have it. */
static void test_the_names_of_the_fields_count(void)
{
    uint32_t crc = UINT32_MAX;
    for (size_t bit = 32; bit < 32u * words(); ++bit) {
        const uint8_t byte = ((const uint8_t *)page)[bit / 8u];
        const uint32_t differs = (crc ^ byte >> bit % 8u) & 1u;
        crc = crc >> 1 ^ differs * 0xEDB88320u;
    }
    page[SADDLE_SETTINGS_CRC] = ~crc;
    expect_refused();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_field_is_read_from_the_page);
    RUN_TEST(test_a_page_is_read_as_it_was_written);
    RUN_TEST(test_a_page_that_was_never_written_is_rejected);
    RUN_TEST(test_every_flipped_bit_is_rejected);
    RUN_TEST(test_the_names_of_the_fields_count);
    return UNITY_END();
}
