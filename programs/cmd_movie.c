/* cmd_movie.c - stub */
#include "commands.h"
#include "report.h"
int cmd_movie(const options *asked) {
    (void)asked;
    return fail_usage("movie is not built yet");
}
