/* cmd_turntable.c - a movie around a volume: the camera goes once about the up
 * axis to its right, from the azimuth that is asked for.  Frame i of N is what
 * `render --azimuth A+360i/N` makes, bit for bit; frame N would be frame 0, so
 * that the movie can be played in a loop. */
#include "commands.h"
#include "launch.h"
#include "report.h"
#include "sequence_render.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int make_shots(const options *asked, shot_list *out) {
    out->count = asked->frames;
    out->shots = calloc((size_t)out->count, sizeof *out->shots);
    if (!out->shots) {
        say("no memory for a list of %lld frames; make fewer",
            (long long)out->count);
        return SNOW_NO_MEMORY;
    }
    for (int64_t i = 0; i < out->count; i++)
        out->shots[i] = (movie_shot){
            .path = asked->operands[0],
            .time = asked->time,
            .azimuth = asked->azimuth + 360 * (double)i / (double)asked->frames,
            .step = -1};
    return GO_ON;
}

/* What comes from a pipe cannot be known again. */
static int check(const options *asked) {
    if (asked->resume && strcmp(asked->operands[0], "-") == 0)
        return fail_usage("--resume: standard input cannot be compared with "
                          "that of an earlier run; name a file");
    int done = scene_check(asked);
    return done == GO_ON ? sequence_check(asked) : done;
}

/* Outputs are looked at by the rank that writes them. */
static int prepare(const options *asked, shot_list *list, shot_renderer *shots,
                   sequence **s) {
    int done = check(asked);
    if (done == GO_ON)
        done = make_shots(asked, list);
    if (done == GO_ON && launch_talks())
        done = sequence_open(asked, list, s);
    done = launch_agree(done);
    if (done == GO_ON)
        done = shots_open(asked, shots);
    if (done != GO_ON)
        return done;
    shots->count = list->count;
    shots->scene.turns = true;
    /* here, where an interruption ends it at once */
    return shots_volume(shots, &list->shots[0]);
}

int cmd_turntable(const options *asked) {
    double begin = seconds_now();
    shot_list list = {.shots = NULL};
    sequence *s = NULL;
    shot_renderer shots = {.count = 0};
    int done = prepare(asked, &list, &shots, &s);
    if (done == GO_ON) {
        sequence_renderer renderer = shots_renderer(&shots);
        done = sequence_run(s, asked, &list, &renderer, begin);
    }
    sequence_close(s);
    shots_close(&shots);
    free(list.shots);
    return done;
}
