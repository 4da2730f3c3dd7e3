/** Health of the host process, for LCM and as text; for CAN see health.h. */
#ifndef SADDLEWALK_HOST_REPORT_H
#define SADDLEWALK_HOST_REPORT_H

#include "bus.h"
#include "health.h"
#include "lcm_port.h"
#include "realtime.h"

/** Everything that is reported; it is only read. */
typedef struct {
    const saddle_timing_t *timing;
    const saddle_inbox_t *inbox;
    const saddle_bus_t *bus;
    const saddle_lcm_port_t *lcm;
    const saddle_realtime_t *realtime;
} saddle_report_t;

saddlewalk_health_t saddle_report_health(const saddle_report_t *report,
                                         const saddle_output_t *output);

saddlewalk_status_t saddle_report_status(const saddle_report_t *report);

/** The last line of the process on standard output. */
void saddle_report_print(const saddle_report_t *report);

#endif
