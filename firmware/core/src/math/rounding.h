/** Whether the compiler kept the arithmetic that every equation here relies on. */
#ifndef SADDLEWALK_ROUNDING_H
#define SADDLEWALK_ROUNDING_H

#include <stdbool.h>

/** Each operation is rounded by itself, to the nearest float, in the order written: no fused
 *  multiply-add, no excess precision, no reassociation, no division by way of a reciprocal.
 *  Speaks for all that was compiled with the flags of rounding.c. */
bool saddle_rounds_as_written(void);

#endif
