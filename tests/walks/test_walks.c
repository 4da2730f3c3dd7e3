/**
 * Walks of many kinds and of great length: `test_walks CHECK [ARGUMENTS]`.
 *
 *   schedules [SEED [COUNT]]  random commands, watched at 1 kHz; alone, the campaign of
 *                             the tests; with a seed, that schedule (or COUNT from it on)
 *   turns [SEED [COUNT]]      the same of random speeds and turning rates, on the ground
 *   day                       24 hours at random speeds and turning rates against a twin in double
 *                             precision
 *   constant                  an hour at each of 20 speeds against the closed form
 *   followers                 wearers who are where the plan is: the supervisor believes them
 *
 * Exit status 0 if all held, 1 if something failed, 2 for a wrong argument.
 */
#include "walks.h"

#include <stdlib.h>
#include <string.h>

#define SCHEDULES_OF_A_TEST 2000u

static int usage(void)
{
    fprintf(stderr, "test_walks: expected schedules [SEED [COUNT]], turns [SEED [COUNT]], day, "
                    "constant or followers\n");
    return 2;
}

/* False for anything but a whole number above 0. */
static bool whole_number(const char *text, uint64_t *number)
{
    char *end;
    *number = strtoull(text, &end, 10);
    return *end == '\0' && *number > 0;
}

static int run_schedules(int argc, char **argv, int (*check)(uint64_t first_seed, uint64_t count))
{
    uint64_t seed = 1;
    uint64_t count = argc == 3 ? 1 : SCHEDULES_OF_A_TEST;
    if ((argc > 2 && !whole_number(argv[2], &seed)) ||
        (argc > 3 && !whole_number(argv[3], &count)) || argc > 4) {
        return usage();
    }
    return check(seed, count) == 0 ? 0 : 1;
}

int main(int argc, char **argv)
{
    if (argc >= 2 && strcmp(argv[1], "schedules") == 0) {
        return run_schedules(argc, argv, check_schedules);
    }
    if (argc >= 2 && strcmp(argv[1], "turns") == 0) {
        return run_schedules(argc, argv, check_turns);
    }
    if (argc == 2 && strcmp(argv[1], "day") == 0) {
        return check_day() == 0 ? 0 : 1;
    }
    if (argc == 2 && strcmp(argv[1], "constant") == 0) {
        return check_constant() == 0 ? 0 : 1;
    }
    if (argc == 2 && strcmp(argv[1], "followers") == 0) {
        return check_followers() == 0 ? 0 : 1;
    }
    return usage();
}
