/* bench/metered_comm.h - a communicator that knows what its transport took. */
#ifndef BENCH_METERED_COMM_H
#define BENCH_METERED_COMM_H

#include <snowglass/extend.h>
#include <time.h>

typedef struct bench_meter {
    snow_comm *inner;
    clockid_t clock; /* processor time of this rank */
    double inside;   /* seconds of it in the transport so far, waits included,
                        but not the work that is done in them */
    snow_idle_fn *idle; /* that work, or NULL */
    void *user;
} bench_meter;

/* The same ranks as those of meter->inner, which outlives it, as the meter
 * does. Errors: SNOW_STATUS_NO_MEMORY; the caller must inform the other ranks.
 */
snow_status bench_meter_new(bench_meter *meter, snow_comm **out);

#endif
