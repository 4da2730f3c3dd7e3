#include "mps2.h"

#include "slcan.h"

typedef struct {
    volatile uint32_t data, state, control, interrupt, divider;
} uart_t;

#define UART ((uart_t *)0x40004000u)
#define UART_BAUD 921600u
#define UART_SEND 1u
#define UART_RECEIVE 2u
#define UART_SENT_INTERRUPT 4u
#define UART_RECEIVED_INTERRUPT 8u
#define UART_SENT 1u
#define UART_RECEIVED 2u

static saddle_can_queue_t received, to_send;
static volatile uint32_t malformed;
static volatile bool closed;

/** The frame that is being sent, and how far. */
static char line[SADDLE_SLCAN_LINE];
static size_t line_length, line_sent;
static bool sending; /* a character whose interrupt is still to come */

void mps2_uart_received(void)
{
    static saddle_slcan_reader_t reader;
    saddle_can_frame_t frame;
    UART->interrupt = UART_RECEIVED;
    switch (saddle_slcan_read(&reader, (char)UART->data, &frame)) {
    case SADDLE_SLCAN_FRAME:
        frame.received_us = saddle_clock_now_us();
        (void)saddle_can_queue_put(&received, &frame); /* counts what is lost */
        break;
    case SADDLE_SLCAN_MALFORMED: malformed = malformed + 1u; break;
    case SADDLE_SLCAN_CLOSE: closed = true; break;
    default: break;
    }
}

/** The next character, if there is one. */
static void send_next(void)
{
    saddle_can_frame_t frame;
    if (line_sent == line_length && saddle_can_queue_take(&to_send, &frame)) {
        line_length = saddle_slcan_write(&frame, line);
        line_sent = 0;
    }
    sending = line_sent < line_length;
    if (sending) {
        UART->data = (uint32_t)line[line_sent];
        ++line_sent;
    }
}

void mps2_uart_sent(void)
{
    UART->interrupt = UART_SENT;
    send_next();
}

void mps2_can_start(void)
{
    UART->divider = MPS2_CLOCK_HZ / UART_BAUD;
    UART->control = UART_SEND | UART_RECEIVE | UART_SENT_INTERRUPT | UART_RECEIVED_INTERRUPT;
    mps2_interrupt_enable(MPS2_UART_RECEIVED);
    mps2_interrupt_enable(MPS2_UART_SENT);
}

bool mps2_can_closed(void)
{
    return closed;
}

bool saddle_can_receive(saddle_can_frame_t *frame)
{
    return saddle_can_queue_take(&received, frame);
}

uint32_t saddle_can_lost(void)
{
    return received.lost + malformed;
}

/** An idle line needs a push; on a busy one each character's interrupt sends the next. */
bool saddle_can_send(const saddle_can_frame_t *frame)
{
    const bool room = saddle_can_queue_put(&to_send, frame);
    const uint32_t held = mps2_interrupts_hold();
    if (!sending) {
        send_next();
    }
    mps2_interrupts_restore(held);
    return room;
}
