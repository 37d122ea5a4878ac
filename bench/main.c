/* bench/main.c - the program snowglass-bench, which `snowglass bench` starts.
 */
#include "bench.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/start.h"

/* What is no business of all ranks is that of the first. */
static int run(int argc, char **argv) {
    if (!bench_for_all(argc, argv) && !process_talks())
        return SNOW_STATUS_OK;
    int done = bench_main(argc, argv);
    return done == SNOW_STATUS_OK ? finish_stdout() : done;
}

int tool_run(int argc, char **argv, const process_start *how) {
    process_begin(how);
    interrupt_install();
    int done = process_meet(CONTINUE, VERB_BENCH, 0);
    done = process_agree(done == CONTINUE ? run(argc, argv) : done);
    if (process_ranks() >
        1) /* whose launcher ends all with the first to fail */
        interrupt_mute();
    return done;
}
