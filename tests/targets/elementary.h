/** The core's functions of one float. */
#ifndef SADDLEWALK_TARGETS_ELEMENTARY_H
#define SADDLEWALK_TARGETS_ELEMENTARY_H

#define ELEMENTARY_COUNT 7

extern float (*const ELEMENTARY[ELEMENTARY_COUNT])(float);

#endif
