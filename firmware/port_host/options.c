#include "options.h"

#include "config_file.h"
#include "lcm_commands.h"
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_LCM "udpm://239.255.76.67:7667?ttl=0"
#define DEFAULT_HEIGHT_M 1.79f
#define DEFAULT_MASS_KG 63.3f
#define FIFO_PRIORITY_MAX 99

static bool complain(const char *option, const char *value, const char *right)
{
    fprintf(stderr, SADDLE_PROGRAM ": --%s %s: give %s\n", option, value, right);
    return false;
}

/** saddle_config_field(), or another list. */
typedef const saddle_config_field_t *fields_t(size_t index);

static float value_of(const void *object, const saddle_config_field_t *field)
{
    float value;
    memcpy(&value, (const char *)object + field->offset, sizeof value);
    return value;
}

/** The field whose name is the first `length` characters of a text; NULL: there is none. */
static const saddle_config_field_t *find_field(fields_t *fields, const char *name, size_t length)
{
    const saddle_config_field_t *field;
    for (size_t i = 0; (field = fields(i)) != NULL; ++i) {
        if (strlen(field->name) == length && memcmp(field->name, name, length) == 0) {
            return field;
        }
    }
    return NULL;
}

/** NAME=VALUE, of an object with these fields. */
static bool set_field(const char *option, const char *text, fields_t *fields, void *object)
{
    const size_t length = strcspn(text, "=");
    const saddle_config_field_t *field = find_field(fields, text, length);
    if (field == NULL || text[length] != '=') {
        return complain(option, text, "NAME=VALUE with a NAME that --help lists");
    }
    char *end;
    const char *number = text + length + 1;
    const float value = strtof(number, &end);
    if (end == number || *end != '\0' || !(value >= field->min && value <= field->max)) {
        char right[80];
        snprintf(right, sizeof right, "a number from %g to %g", (double)field->min,
                 (double)field->max);
        return complain(option, text, right);
    }
    memcpy((char *)object + field->offset, &value, sizeof value);
    return true;
}

/** Passes in a second, as passes in a tick. */
static bool set_joints(saddle_options_t *options, const char *text)
{
    char *end;
    const long rate_hz = strtol(text, &end, 10);
    const long passes = rate_hz * (long)SADDLE_TICK_US / 1000000;
    if (end == text || *end != '\0' || passes < (long)SADDLE_PASSES_MIN ||
        passes > (long)SADDLE_PASSES_MAX || rate_hz * (long)SADDLE_TICK_US % 1000000 != 0 ||
        SADDLE_TICK_US % (uint32_t)passes != 0u) {
        return complain(
            "joints", text,
            "a rate that makes whole passes in a tick: 100, 125, 200, 250, 400, 500, 625, 800 or "
            "1000 Hz");
    }
    options->joints.passes = (uint32_t)passes;
    return true;
}

/** PART.NAME=VALUE. */
static bool set_joint(saddle_options_t *options, const char *text)
{
    const size_t length = strcspn(text, ".=");
    for (size_t i = 0; text[length] == '.' && i < SADDLE_JOINT_PARTS; ++i) {
        const saddle_joint_part_t part = saddle_joint_part(i);
        if (strlen(part.name) == length && memcmp(part.name, text, length) == 0) {
            char *values = (char *)&options->joints + part.offset;
            return set_field("joint", text + length + 1, part.field, values);
        }
    }
    return complain("joint", text, "PART.NAME=VALUE, PART being legs, estimator, walk or drive");
}

static bool set_clock(saddle_options_t *options, const char *text)
{
    options->lockstep = strcmp(text, "lockstep") == 0;
    return options->lockstep || strcmp(text, "realtime") == 0 ||
           complain("clock", text, "realtime or lockstep");
}

static bool set_ankle(saddle_options_t *options, const char *text)
{
    for (int i = 0; i < SADDLE_ANKLE_COUNT; ++i) {
        if (strcmp(saddle_ankle_names[i], text) == 0) {
            options->config.ankle = (saddle_ankle_t)i;
            return true;
        }
    }
    return complain("ankle", text, "erf, rigid or cycloid");
}

static bool set_command_from(saddle_options_t *options, const char *text)
{
    static const char *const names[] = {
        [SADDLE_SOURCE_NONE] = "first", [SADDLE_SOURCE_CAN] = "can", [SADDLE_SOURCE_LCM] = "lcm"};
    for (int i = 0; i < 3; ++i) {
        if (strcmp(names[i], text) == 0) {
            options->command_from = (saddle_source_t)i;
            return true;
        }
    }
    return complain("command-from", text, "can, lcm or first");
}

static bool set_fifo(saddle_options_t *options, const char *text)
{
    char *end;
    const long priority = strtol(text, &end, 10);
    if (end == text || *end != '\0' || priority < 1 || priority > FIFO_PRIORITY_MAX) {
        return complain("fifo", text, "a priority from 1 to 99");
    }
    options->fifo_priority = (int)priority;
    return true;
}

static void print_fields(fields_t *fields, const void *object)
{
    const saddle_config_field_t *field;
    for (size_t i = 0; (field = fields(i)) != NULL; ++i) {
        printf("  %-24s %8g %8g %8g\n", field->name, (double)value_of(object, field),
               (double)field->min, (double)field->max);
    }
}

static void print_help(const saddle_options_t *defaults)
{
    puts("usage: " SADDLE_PROGRAM " [OPTION]...\n"
         "Walking planner and stability supervisor between CAN and LCM, one tick every 80 ms.\n\n"
         "  --can SPEC         auto (default), socketcan:INTERFACE, udp, udp:GROUP:PORT;\n"
         "                     udp:GROUP:PORT@INTERFACE leaves this machine\n"
         "  --lcm URL          default " DEFAULT_LCM "; none: without LCM\n"
         "  --command-from X   accept commands from can; lcm; first (default): the first that\n"
         "                     commands, until it is silent and the walk has ended\n"
         "  --command-key FILE accept only commands by CAN that are authenticated with this key\n"
         "  --lcm-from-network accept commands by LCM from other machines too\n"
         "  --fifo PRIORITY    schedule by SCHED_FIFO, 1 to 99, and lock all memory\n"
         "  --clock CLOCK      realtime (default); lockstep: one tick per set of measurements\n"
         "  --ankle ANKLE      ankle strategy: erf (default), rigid, cycloid\n"
         "  --set NAME=VALUE   a parameter of the person or the device; repeatable\n"
         "  --learn NAME=VALUE let the plan follow the wearer; repeatable: share=0.05 of each\n"
         "                     stride's departure, the others say how far each field may go\n"
         "  --learned FILE     write the configuration as learned to FILE, in the format of\n"
         "                     saddlewalk --config, when this process ends\n"
         "  --joints HZ        measure by sensors and command the joints at this rate, of which\n"
         "                     a tick is a whole number of passes: 100 to 1000, such as 500\n"
         "  --joint PART.NAME=VALUE\n"
         "                     a parameter of the legs, estimator, walk or drive; repeatable\n"
         "  --help             this text\n\n"
         "parameter                   default     from       to");
    print_fields(saddle_config_field, &defaults->config);
    puts("\nof --learn");
    print_fields(saddle_learning_field, &defaults->learning);
    const saddle_joint_loop_config_t joints = saddle_joint_loop_default(&defaults->config);
    for (size_t i = 0; i < SADDLE_JOINT_PARTS; ++i) {
        const saddle_joint_part_t part = saddle_joint_part(i);
        printf("\nof --joint %s.\n", part.name);
        print_fields(part.field, (const char *)&joints + part.offset);
    }
}

static bool take_option(saddle_options_t *options, int letter, char *argv[])
{
    switch (letter) {
    case 'c': options->can = optarg; return true;
    case 'l': options->lcm = strcmp(optarg, "none") == 0 ? NULL : optarg; return true;
    case 'k': return set_clock(options, optarg);
    case 'a': return set_ankle(options, optarg);
    case 's': return set_field("set", optarg, saddle_config_field, &options->config);
    case 'e': return set_field("learn", optarg, saddle_learning_field, &options->learning);
    case 'd': options->learned = optarg; return true;
    case 'm': return set_command_from(options, optarg);
    case 'y': options->command_key = optarg; return true;
    case 'f': return set_fifo(options, optarg);
    case 'n': options->lcm_from_network = true; return true;
    case 'j': return set_joints(options, optarg);
    case 'J': return true; /* once the body is known, take_joints() */
    case ':':
        fprintf(stderr, SADDLE_PROGRAM ": %s: give a value (see --help)\n", argv[optind - 1]);
        return false;
    default:
        fprintf(stderr, SADDLE_PROGRAM ": %s: give an option that --help lists\n",
                argv[optind - 1]);
        return false;
    }
}

bool saddle_options_lcm_commands(const saddle_options_t *options)
{
    return options->lcm != NULL && !options->lockstep && saddle_lcm_commands_possible(options->lcm);
}

static bool are_commands_consistent(const saddle_options_t *options)
{
    const bool by_lcm = options->command_from == SADDLE_SOURCE_LCM;
    if (by_lcm && !saddle_options_lcm_commands(options)) {
        return complain("command-from", "lcm",
                        "can or first: commands by LCM need --clock realtime and --lcm udpm://...");
    }
    if (by_lcm && options->command_key != NULL) {
        return complain("command-key", options->command_key,
                        "--command-from can: a command by LCM cannot be authenticated");
    }
    if (options->lcm_from_network &&
        (options->command_key != NULL || options->command_from == SADDLE_SOURCE_CAN ||
         !saddle_options_lcm_commands(options))) {
        fprintf(stderr, SADDLE_PROGRAM ": --lcm-from-network: leave it out, the other options "
                                       "allow no commands by LCM\n");
        return false;
    }
    return true;
}

static bool is_consistent(const saddle_options_t *options)
{
    const saddle_config_t *config = &options->config;
    const char *name = saddle_config_check(config);
    if (!are_commands_consistent(options)) {
        return false;
    }
    if (name != NULL) {
        fprintf(stderr, SADDLE_PROGRAM ": --set %s=%.9g: give a value that suits the others\n",
                name,
                (double)value_of(config, find_field(saddle_config_field, name, strlen(name))));
    }
    return name == NULL;
}

static const struct option KNOWN[] = {{"can", required_argument, NULL, 'c'},
                                      {"lcm", required_argument, NULL, 'l'},
                                      {"clock", required_argument, NULL, 'k'},
                                      {"ankle", required_argument, NULL, 'a'},
                                      {"set", required_argument, NULL, 's'},
                                      {"learn", required_argument, NULL, 'e'},
                                      {"learned", required_argument, NULL, 'd'},
                                      {"command-from", required_argument, NULL, 'm'},
                                      {"fifo", required_argument, NULL, 'f'},
                                      {"command-key", required_argument, NULL, 'y'},
                                      {"lcm-from-network", no_argument, NULL, 'n'},
                                      {"joints", required_argument, NULL, 'j'},
                                      {"joint", required_argument, NULL, 'J'},
                                      {"help", no_argument, NULL, 'h'},
                                      {NULL, 0, NULL, 0}};

static int next_letter(int argc, char *argv[])
{
    return getopt_long(argc, argv, ":", KNOWN, NULL);
}

/** The joints of the body that all other options describe. */
static bool take_joints(saddle_options_t *options, int argc, char *argv[])
{
    const uint32_t passes = options->joints.passes;
    options->joints = saddle_joint_loop_default(&options->config);
    options->joints.passes = passes;
    int letter;
    optind = 1;
    while ((letter = next_letter(argc, argv)) != -1) {
        if (letter == 'J' && !set_joint(options, optarg)) {
            return false;
        }
    }
    const char *name = saddle_joint_loop_check(&options->joints);
    if (name != NULL) {
        fprintf(stderr,
                SADDLE_PROGRAM ": --joint %s: give a value that suits the others, and the body of "
                               "--set\n",
                name);
    }
    return name == NULL;
}

saddle_parsed_t saddle_options_parse(saddle_options_t *options, int argc, char *argv[])
{
    *options = (saddle_options_t){
        .can = "auto",
        .lcm = DEFAULT_LCM,
        .config = saddle_config_default(DEFAULT_HEIGHT_M, DEFAULT_MASS_KG),
        .learning = saddle_learning_default(),
    };
    int letter;
    opterr = 0;
    while ((letter = next_letter(argc, argv)) != -1) {
        if (letter == 'h') {
            print_help(options);
            return SADDLE_OPTIONS_HELP;
        }
        if (!take_option(options, letter, argv)) {
            return SADDLE_OPTIONS_WRONG;
        }
    }
    if (optind < argc) {
        fprintf(stderr, SADDLE_PROGRAM ": %s: give options only (see --help)\n", argv[optind]);
        return SADDLE_OPTIONS_WRONG;
    }
    return is_consistent(options) && take_joints(options, argc, argv) ? SADDLE_OPTIONS_RUN
                                                                      : SADDLE_OPTIONS_WRONG;
}
