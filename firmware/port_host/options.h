/** The command line of saddlewalk-host. */
#ifndef SADDLEWALK_HOST_OPTIONS_H
#define SADDLEWALK_HOST_OPTIONS_H

#include "announce.h"
#include "gait_learner.h"
#include "inbox.h"
#include "joint_loop.h"

typedef struct {
    const char *can;       /**< for saddle_bus_open() */
    const char *lcm;       /**< an LCM URL; NULL: no LCM */
    bool lcm_from_network; /**< accept commands by LCM from other machines */
    bool lockstep;
    saddle_source_t command_from; /**< NONE: the first that commands */
    const char
        *command_key;  /**< file with the key for authenticated commands; NULL: not required */
    int fifo_priority; /**< 0: the ordinary scheduler */
    saddle_config_t config;
    saddle_learning_config_t learning;
    saddle_joint_loop_config_t joints;
    const char *learned; /**< file for what was learned; NULL: none */
} saddle_options_t;

typedef enum { SADDLE_OPTIONS_RUN, SADDLE_OPTIONS_HELP, SADDLE_OPTIONS_WRONG } saddle_parsed_t;

/**
 * Read the options. SADDLE_OPTIONS_HELP: the help was printed. SADDLE_OPTIONS_WRONG: one line on
 * standard error names the option, its value and what would be right. Otherwise the configuration
 * has passed saddle_config_check(), and that of the joints its check. The strings are argv's.
 */
saddle_parsed_t saddle_options_parse(saddle_options_t *options, int argc, char *argv[]);

/** Whether commands can come by LCM: not in lockstep, and not by a URL other than `udpm://`. */
bool saddle_options_lcm_commands(const saddle_options_t *options);

#endif
