/** CAN frames as text on a serial line: SLCAN, which python-can, Linux's slcand and many adapters
 *  speak. A data frame is `tIIILDD..` and a carriage return, all digits hexadecimal. */
#ifndef SADDLEWALK_MCU_SLCAN_H
#define SADDLEWALK_MCU_SLCAN_H

#include "can_queue.h"

/** Characters of the longest frame, its carriage return included. */
#define SADDLE_SLCAN_LINE 22u

typedef enum {
    SADDLE_SLCAN_NOTHING, /**< the line goes on, or says nothing that matters here */
    SADDLE_SLCAN_FRAME,
    SADDLE_SLCAN_CLOSE,    /**< `C`: the other side leaves */
    SADDLE_SLCAN_MALFORMED /**< no frame, or one that is not classic data with 11 bits */
} saddle_slcan_event_t;

/** The line so far. Start from all zeros. */
typedef struct {
    char line[SADDLE_SLCAN_LINE];
    size_t length; /**< characters kept; SADDLE_SLCAN_LINE, too long for a frame, if
                        more came */
} saddle_slcan_reader_t;

/** Take a character. SADDLE_SLCAN_FRAME: frame has been written, but for came_us; else it has not. */
saddle_slcan_event_t saddle_slcan_read(saddle_slcan_reader_t *reader, char character,
                                       saddle_can_frame_t *frame);

/** The text of a frame, and how many characters that are; there is no '\0' at the end. */
size_t saddle_slcan_write(const saddle_can_frame_t *frame, char line[SADDLE_SLCAN_LINE]);

#endif
