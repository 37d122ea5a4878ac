/* parallel/clock.c - the clock of a frame on many ranks: it stands while bands
 * of the next picture are drawn where the present one waits for messages, so
 * that the time of each picture is its own. */
#include "parallel/internal.h"

double snow_ranks_clock(const snow_ranks *r) {
    return snow_comm_seconds(r->comm) - r->overlapped;
}

static double processor_time(const snow_in_flight *f) {
    return f->picture.job.settings.threads == 1 ? snow_thread_seconds()
                                                : snow_cpu_seconds();
}

double snow_in_flight_cpu(const snow_in_flight *f) {
    return processor_time(f) - f->ranks->overlapped_cpu;
}

/* Bands that follow one another are timed together: to look at a clock takes
 * time too. */
static void stop_clock(snow_ranks *r) {
    if (r->standing)
        return;
    r->standing = true;
    r->since = snow_comm_seconds(r->comm);
    r->since_cpu = processor_time(r->drawn);
}

double snow_ranks_pause(snow_ranks *r) {
    if (!r->standing)
        return 0;
    double took = snow_comm_seconds(r->comm) - r->since;
    double cpu = processor_time(r->drawn) - r->since_cpu;
    r->standing = false;
    r->overlapped += took;
    r->overlapped_cpu += cpu;
    r->drawn->overlapped += took;
    r->drawn->picture.ranks_stats.cpu_splat += cpu;
    return took;
}

bool snow_ranks_draw(snow_ranks *r) {
    stop_clock(r);
    return snow_line_batch_step(r->drawn->picture.drawing);
}

void snow_ranks_drain(snow_ranks *r) {
    if (!r->drawn)
        return;
    snow_comm_occupy(r->comm, NULL, NULL);
    stop_clock(r);
    snow_line_batch_end(r->drawn->picture.drawing);
    snow_ranks_pause(r);
    r->drawn->picture.drawing = NULL;
    r->drawn = NULL;
}
