/* movie_webp.h - joins frames that are WebP pictures into one animated WebP. */
#ifndef MOVIE_WEBP_H
#define MOVIE_WEBP_H

#include "movie/movie_place.h"

typedef struct webp_job {
    int64_t count;     /* number of frames */
    int width, height; /* of each frame */
    double rate;       /* frames per second */
    bool alpha;        /* frames have alpha */
} webp_job;

/* Writes the movie; one frame at a time is in memory.  Returns 0 or an error
 * number; EFBIG beyond the 4 GB limit of the format. */
int webp_join(const webp_job *job, const movie_place *place);

#endif
