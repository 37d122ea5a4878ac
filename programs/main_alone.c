/* main_alone.c - the tool as one process.
 *
 * All is closed when it ends.  What libraries would do then can only fail:
 * libhdf5 prints lines or crashes where a file was damaged or memory ran out.
 */
#include "run/start.h"

#include <stdio.h>
#include <unistd.h>

int main(int argc, char **argv) {
    const process_start alone = {.comm = NULL};
    int done = tool_run(argc, argv, &alone);
#if !defined SNOW_SANITIZED && !defined SNOW_COVERAGE
    fflush(NULL);
    _exit(done);
#endif
    return done;
}
