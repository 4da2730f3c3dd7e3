/** Any command line of the host process: what is to run has a configuration that can be used, and its
 *  texts are the command line's. */
#include "fuzz.h"

#include <getopt.h>
#include <options.h>

#define WORDS_MAX 24
#define TEXT_MAX 512u

static const char *const NAMES[] = {
    "--can",    "--lcm",         "--clock",
    "--ankle",  "--set",         "--command-from",
    "--fifo",   "--command-key", "--lcm-from-network",
    "realtime", "lockstep",      "erf",
};

/** A word of ours, the name of a field with what follows, or any text; NULL: there is no room. */
static char *word(fuzz_bytes_t *bytes, char *text, size_t room)
{
    const uint8_t how = fuzz_byte(bytes);
    size_t length = 0;
    if (how < 128u) {
        length = (size_t)snprintf(text, room, "%s", NAMES[how % (sizeof NAMES / sizeof NAMES[0])]);
    } else if (how < 192u) {
        const saddle_config_field_t *field = saddle_config_field(how % 64u);
        length = (size_t)snprintf(text, room, "%s=", field != NULL ? field->name : "ankle");
    }
    for (char c; length + 1u < room && (c = (char)fuzz_byte(bytes)) != '\0';) {
        text[length++] = c;
    }
    if (length + 1u >= room) {
        return NULL;
    }
    text[length] = '\0';
    return text;
}

/** What it prints is not looked at. */
static saddle_parsed_t parse(saddle_options_t *options, int argc, char *argv[])
{
    static FILE *nowhere;
    FILE *const out = stdout, *const err = stderr;
    nowhere = nowhere != NULL ? nowhere : fopen("/dev/null", "w");
    REQUIRE(nowhere != NULL);
    stdout = stderr = nowhere;
    optind = 0; /* getopt begins anew */
    const saddle_parsed_t parsed = saddle_options_parse(options, argc, argv);
    stdout = out;
    stderr = err;
    return parsed;
}

static void require_of(const char *text, int argc, char *const argv[])
{
    bool found = text == NULL;
    for (int i = 1; i < argc; ++i) {
        found = found || (text >= argv[i] && text <= argv[i] + strlen(argv[i]));
    }
    REQUIRE(found);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char text[TEXT_MAX];
    fuzz_bytes_t bytes = {data, size};
    char *argv[WORDS_MAX + 1] = {"saddlewalk-host"};
    saddle_options_t options;
    size_t used = 0;
    int argc = 1;
    while (bytes.left > 0u && argc < WORDS_MAX) {
        argv[argc] = word(&bytes, text + used, sizeof text - used);
        if (argv[argc] == NULL) {
            break;
        }
        used += strlen(argv[argc]) + 1u;
        ++argc;
    }
    argv[argc] = NULL;
    if (parse(&options, argc, argv) == SADDLE_OPTIONS_RUN) {
        REQUIRE(saddle_config_check(&options.config) == NULL);
        require_of(options.command_key, argc, argv);
        REQUIRE(options.can != NULL && options.fifo_priority >= 0 && options.fifo_priority <= 99);
    }
    return 0;
}
