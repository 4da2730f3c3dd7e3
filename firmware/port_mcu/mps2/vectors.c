#include "mps2.h"

extern char __stack[]; /* the linker's */
void _start(void);     /* the C library's */

static void hang(void)
{
    for (;;) { /* nothing can be trusted any more: the watchdog resets the controller */
    }
}

/** The watchdog's warning, which interrupts whatever hangs. A product brings its machine into the
 *  safe state here. There is no way back: the line stays up until the warning is cleared, which on
 *  this watchdog means feeding it, and only a good tick may do that. */
static void on_warning(void)
{
    hang();
}

static void on_timer(void)
{
    mps2_wake();
    mps2_timer_came_round();
}

static void on_uart_received(void)
{
    mps2_wake();
    mps2_uart_received();
}

typedef void (*handler_t)(void);

/** What the processor reads at address 0. */
typedef struct {
    const void *stack;
    handler_t reset;
    handler_t warning; /* NMI */
    handler_t faults[13];
    handler_t interrupts[MPS2_INTERRUPTS];
} vectors_t;

extern const vectors_t __interrupt_vector; /* so the C library calls it */
const vectors_t __interrupt_vector __attribute__((section(".data.init.enter"), used)) = {
    .stack = __stack,
    .reset = _start,
    .warning = on_warning,
    .faults = {hang, hang, hang, hang, hang, hang, hang, hang, hang, hang, hang, hang, hang},
    .interrupts = {[MPS2_UART_RECEIVED] = on_uart_received,
                   [MPS2_UART_SENT] = mps2_uart_sent,
                   [MPS2_TIMER] = on_timer},
};
