/* bench/main.c - the program snowglass-bench, which `snowglass bench` starts.
 */
#include "bench.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/start.h"

int tool_run(int argc, char **argv, const process_start *how) {
    process_begin(how);
    interrupt_install();
    int done = process_meet(CONTINUE, VERB_BENCH, 0);
    /* What is no business of all ranks is that of the first. */
    if (done == CONTINUE && !bench_for_all(argc, argv) && !process_talks())
        done = SNOW_STATUS_OK;
    else if (done == CONTINUE)
        done = bench_main(argc, argv);
    if (done == SNOW_STATUS_OK)
        done = finish_stdout();
    done = process_agree(done);
    if (process_ranks() >
        1) /* whose launcher ends all with the first to fail */
        interrupt_mute();
    return done;
}
