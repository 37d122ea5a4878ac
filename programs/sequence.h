/* sequence.h - many pictures as one movie: what turntable and movie share.
 *
 * A sequence is a list of shots.  They are rendered one after another, or, of
 * many ranks, the next while one is combined; meanwhile the frames before are
 * compressed and written by other threads (frames.h).
 * Every frame becomes a file, whole or absent:
 *
 *   -o f_%04d.png    f_0000.png, f_0001.png, ...      the result itself
 *   -o spin.mp4      spin.mp4.frames/000000.png, ...  until the movie is whole;
 *                    ffmpeg gets the same bytes meanwhile
 *
 * A record beside the frames says what they were made with, and which are done
 * (sequence_record.h), so that --resume goes on after whatever end.
 *
 * Who renders is a record of functions: one process, or many ranks of which
 * only the first writes. */
#ifndef SEQUENCE_H
#define SEQUENCE_H

#include "marks.h"
#include "options.h"

/* One frame to be. */
typedef struct movie_shot {
    const char *path; /* of the volume */
    int64_t time;     /* the step in that file */
    double azimuth;   /* of the camera, in degrees */
    int64_t step;     /* the number that people know it by, -1: none */
} movie_shot;

typedef struct shot_list {
    movie_shot *shots;
    int64_t count; /* at least 1 */
    bool together; /* each frame depends on all shots, by the look: another
                      list of them is another movie */
} shot_list;

/* Figures of one or more frames, and of the renderer. */
typedef struct render_report render_report;

/* Who renders.  Calls are made by all ranks in the same order, with the same
 * shots; what one of them answers, all do. */
typedef struct sequence_renderer {
    void *self;

    /* Begins to render a shot, and finishes the one begun first; *image is the
     * caller's, and NULL on ranks that do not write.  They answer GO_ON, or an
     * exit code after the fault was told. */
    int (*begin)(void *self, const movie_shot *shot);
    int (*finish)(void *self, snow_image **image);
    int ahead; /* shots to be begun before the one that is finished: 0 or 1 */

    /* Depths of the last picture; NULL where none were asked for.  Called on
     * the rank that writes. */
    const snow_image *(*depth)(void *self);

    /* Figures of the last picture; their `image` is filled in by the caller.
     * Called on the rank that writes. */
    void (*report)(void *self, render_report *out);

    /* What is drawn over the pictures, after the first one.  Called on the rank
     * that writes. */
    void (*marks)(void *self, picture_marks *out);

    /* Every rank gets the word of the one that writes.  NULL: there is one. */
    int (*share)(void *self, int word);

    bool writes; /* this rank writes and talks */
    int ranks;
} sequence_renderer;

typedef struct sequence sequence;

/* Refuses options that contradict each other.  Answers GO_ON or an exit code.
 */
int sequence_check(const options *asked);

/* Looks at the output: whether it can be written, and what lies there of an
 * earlier run.  Writes nothing yet, but holds a lock on what is to be resumed.
 * `list` and `asked` must outlive the sequence.  Only for the rank that writes.
 * Answers GO_ON or an exit code. */
int sequence_open(const options *asked, const shot_list *list, sequence **out);

/* Makes all frames that are missing, and of them the movie; then the figures of
 * --stats.  Ranks that do not write pass NULL for `s`.  Answers an exit code.
 */
int sequence_run(sequence *s, const options *asked, const shot_list *list,
                 const sequence_renderer *renderer, double begin);

/* Accepts NULL. */
void sequence_close(sequence *s);

#endif
