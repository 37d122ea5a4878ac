/* cmd_turntable.c - the verb turntable: a movie around a volume.  The camera
 * turns once about the up axis to its right, from the requested azimuth.  With
 * --fit volume frame i of N equals `render --azimuth A+360i/N` bit for bit.
 * Frame N would equal frame 0, so the movie plays in a loop. */
#include "commands/commands.h"
#include "movie/movie_render.h"
#include "run/log.h"
#include "run/start.h"

#include <stdlib.h>
#include <string.h>

static int make_shots(const options *opts, shot_list *out) {
    out->count = opts->frames;
    out->shots = calloc((size_t)out->count, sizeof *out->shots);
    if (!out->shots)
        return fail_memory("out of memory for a list of %lld frames; make "
                           "fewer",
                           (long long)out->count);
    for (int64_t i = 0; i < out->count; i++)
        out->shots[i] = (movie_shot){
            .path = opts->operands[0],
            .time = opts->time,
            .azimuth = opts->azimuth + 360 * (double)i / (double)opts->frames,
            .step = -1};
    return CONTINUE;
}

/* An earlier input from a pipe cannot be compared with a new one. */
static int check_turntable(const options *opts) {
    if (opts->resume && strcmp(opts->operands[0], "-") == 0)
        return fail_usage("--resume: standard input cannot be compared with "
                          "the earlier run's; name a file");
    int done = render_state_check(opts);
    return done == CONTINUE ? movie_check(opts) : done;
}

/* The rank that writes checks the outputs. */
static int prepare_turntable(const options *opts, shot_list *list,
                             shot_renderer *shots, movie **s) {
    int done = check_turntable(opts);
    if (done == CONTINUE)
        done = make_shots(opts, list);
    if (done == CONTINUE && process_talks())
        done = check_input(opts);
    if (done == CONTINUE && process_talks())
        done = movie_open(opts, list, s);
    done = process_agree(done);
    if (done == CONTINUE)
        done = shots_open(opts, shots);
    if (done != CONTINUE)
        return done;
    shots->count = list->count;
    shots->state.turns = true;
    /* here, where an interruption still ends at once */
    return shots_volume(shots, &list->shots[0]);
}

int cmd_turntable(const options *opts) {
    double begin = seconds_now();
    shot_list list = {.shots = NULL};
    movie *s = NULL;
    shot_renderer shots = {.count = 0};
    int done = prepare_turntable(opts, &list, &shots, &s);
    if (done == CONTINUE)
        done = movie_run(s, opts, &list, &shots, begin);
    movie_close(s);
    shots_close(&shots);
    free(list.shots);
    return done;
}
