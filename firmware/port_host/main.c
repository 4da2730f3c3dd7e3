/** saddlewalk-host: the core on Linux, between CAN and LCM. Exit status 0: ended by SIGINT or
 *  SIGTERM; 2: an option is wrong, or CAN or LCM cannot be opened. */
#include "bus.h"
#include "commanders.h"
#include "config_file.h"
#include "lcm_commands.h"
#include "lcm_port.h"
#include "options.h"
#include "runner.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define EXIT_BAD_INPUT 2

/** A signal writes a byte to a pipe, which the loop waits for with its other inputs. */
static int stop_pipe[2];

static void on_signal(int signal_number)
{
    const int saved_errno = errno;
    (void)signal_number;
    /* Full: a byte is waiting already. */
    while (write(stop_pipe[1], "", 1) < 0 && errno == EINTR) {
    }
    errno = saved_errno;
}

static bool catch_signals(void)
{
    const struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    const struct sigaction ignore = {.sa_handler = SIG_IGN}; /* the reader of our output is gone */
    return pipe(stop_pipe) == 0 && fcntl(stop_pipe[1], F_SETFL, O_NONBLOCK) == 0 &&
           sigaction(SIGPIPE, &ignore, NULL) == 0 && sigaction(SIGINT, &action, NULL) == 0 &&
           sigaction(SIGTERM, &action, NULL) == 0;
}

/** Only multicast may need something that the user can set up. */
static void complain_about_lcm(const char *url)
{
    const char *right = strncmp(url, "udpm:", 5) == 0
                            ? "for a multicast route, run `sudo ip route add 224.0.0.0/4 dev lo`"
                            : "give an LCM URL such as udpm://239.255.76.67:7667?ttl=0";
    fprintf(stderr, SADDLE_PROGRAM ": --lcm %s cannot be opened: %s, or give --lcm none\n", url,
            right);
}

/** Everything that is open during a run. */
typedef struct {
    saddle_bus_t bus;
    saddle_lcm_port_t lcm;
    int lcm_commands_fd;
} ports_t;

static bool open_lcm(const saddle_options_t *options, ports_t *ports)
{
    ports->lcm = (saddle_lcm_port_t){0};
    ports->lcm_commands_fd = -1;
    if (options->lcm == NULL) {
        return true;
    }
    bool opened = saddle_lcm_open(&ports->lcm, options->lcm);
    if (opened && saddle_options_lcm_commands(options)) {
        ports->lcm_commands_fd = saddle_lcm_commands_open(options->lcm, options->lcm_from_network);
        opened = ports->lcm_commands_fd >= 0;
    }
    if (!opened) {
        complain_about_lcm(options->lcm);
    }
    return opened;
}

static bool open_ports(const saddle_options_t *options, ports_t *ports)
{
    if (!saddle_bus_open(&ports->bus, options->can)) {
        fprintf(stderr, SADDLE_PROGRAM ": --can %s: %s\n", options->can, ports->bus.description);
        return false;
    }
    return open_lcm(options, ports);
}

static void close_ports(ports_t *ports)
{
    saddle_lcm_close(&ports->lcm);
    if (ports->lcm_commands_fd >= 0) {
        close(ports->lcm_commands_fd);
    }
    saddle_bus_close(&ports->bus);
}

static void print_start(const saddle_options_t *options, const saddle_runner_t *runner)
{
    const saddle_realtime_t *realtime = &runner->realtime;
    printf(SADDLE_PROGRAM " " SADDLE_VERSION ": CAN %s; LCM %s; clock %s; ",
           runner->bus->description, options->lcm != NULL ? runner->lcm->description : "none",
           options->lockstep ? "lockstep" : "realtime");
    if (options->joints.passes != 0u) {
        printf("measured by sensors, joints at %u Hz; ",
               1000000u / saddle_joint_loop_period_us(&options->joints));
    } else {
        printf("measured by CoM and feet; ");
    }
    saddle_print_commanders(options, runner->bus);
    if (realtime->fifo_priority != 0) {
        printf("; SCHED_FIFO %d", realtime->fifo_priority);
    }
    printf("%s\nready\n", realtime->memory_locked ? "; memory locked" : "");
    fflush(stdout);
}

/** 32 hexadecimal digits, in a file that only its owner may read. */
static bool read_key(const char *path, uint8_t key[SADDLE_CMAC_LENGTH])
{
    struct stat about;
    FILE *file = fopen(path, "r");
    bool good = file != NULL && fstat(fileno(file), &about) == 0 &&
                (about.st_mode & (S_IRWXG | S_IRWXO)) == 0;
    for (size_t i = 0; good && i < SADDLE_CMAC_LENGTH; ++i) {
        /* Two digits do not overflow. */
        /* NOLINTNEXTLINE(bugprone-unchecked-string-to-number-conversion,cert-err34-c) */
        good = fscanf(file, "%2hhx", &key[i]) == 1;
    }
    if (file != NULL) {
        fclose(file);
    }
    return good;
}

static bool require_auth(saddle_runner_t *runner, const char *path)
{
    uint8_t key[SADDLE_CMAC_LENGTH];
    if (path == NULL) {
        return true;
    }
    if (!read_key(path, key)) {
        fprintf(stderr,
                SADDLE_PROGRAM ": --command-key %s: give a file with 32 hexadecimal digits that "
                               "only its owner may read (chmod 600)\n",
                path);
        return false;
    }
    saddle_runner_require_auth(runner, key);
    return true;
}

/** Before the first tick too, so that a file that cannot be written is no surprise at the end. */
static bool write_learned(const char *path, const saddle_config_t *config)
{
    if (path == NULL || saddle_config_file_write(path, config)) {
        return true;
    }
    fprintf(stderr, SADDLE_PROGRAM ": --learned %s: %s\n", path, strerror(errno));
    return false;
}

static int run(const saddle_options_t *options, ports_t *ports)
{
    saddle_runner_t runner;
    saddle_runner_init(&runner, &options->config, options->lockstep, options->command_from,
                       &ports->bus, &ports->lcm, stop_pipe[0]);
    runner.lcm_commands_fd = ports->lcm_commands_fd;
    saddle_gait_learner_init(&runner.learner, &options->config, &options->learning);
    saddle_runner_drive_joints(&runner, &options->joints);
    if (!require_auth(&runner, options->command_key) ||
        !write_learned(options->learned, &runner.learner.config)) {
        return EXIT_BAD_INPUT;
    }
    /* After LCM has started its threads, which do not need this priority. */
    runner.realtime = saddle_realtime_enter(options->fifo_priority);
    print_start(options, &runner);
    saddle_runner_run(&runner);
    const saddle_report_t report = saddle_runner_report(&runner);
    saddle_report_print(&report);
    return write_learned(options->learned, &runner.learner.config) ? 0 : 1;
}

int main(int argc, char *argv[])
{
    saddle_options_t options;
    const saddle_parsed_t parsed = saddle_options_parse(&options, argc, argv);
    if (parsed != SADDLE_OPTIONS_RUN) {
        return parsed == SADDLE_OPTIONS_HELP ? 0 : EXIT_BAD_INPUT;
    }
    ports_t ports;
    if (!catch_signals()) {
        perror(SADDLE_PROGRAM ": signals");
        return 1;
    }
    if (!open_ports(&options, &ports)) {
        return EXIT_BAD_INPUT;
    }
    const int status = run(&options, &ports);
    close_ports(&ports);
    return status;
}
