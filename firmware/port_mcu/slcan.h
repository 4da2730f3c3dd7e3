/** CAN frames as text on a serial line: SLCAN, which python-can, Linux's slcand and many adapters
 *  speak. A data frame is `tIIILDD..` and a carriage return, all digits hexadecimal. */
#ifndef SADDLEWALK_MCU_SLCAN_H
#define SADDLEWALK_MCU_SLCAN_H

#include "can_queue.h"

/** Characters of the longest frame, its carriage return included. */
#define SADDLE_SLCAN_LINE 22u

typedef enum {
    SADDLE_SLCAN_NOTHING, /**< the line is incomplete, or has no meaning here */
    SADDLE_SLCAN_FRAME,
    SADDLE_SLCAN_CLOSE,    /**< `C`: the other side closes the channel */
    SADDLE_SLCAN_MALFORMED /**< not a classic data frame with an 11-bit identifier */
} saddle_slcan_event_t;

/** The line so far. Initialise with zeros. */
typedef struct {
    char line[SADDLE_SLCAN_LINE];
    size_t length; /**< characters kept; SADDLE_SLCAN_LINE, too long for a frame, if
                        more came */
} saddle_slcan_reader_t;

/** Process a character. SADDLE_SLCAN_FRAME: frame was written, except received_us; else it was not. */
saddle_slcan_event_t saddle_slcan_read(saddle_slcan_reader_t *reader, char character,
                                       saddle_can_frame_t *frame);

/** Write the text of a frame, without a final '\0'; returns the number of characters. */
size_t saddle_slcan_write(const saddle_can_frame_t *frame, char line[SADDLE_SLCAN_LINE]);

#endif
