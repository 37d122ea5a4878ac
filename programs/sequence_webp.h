/* sequence_webp.h - frames that are WebP pictures, put together as one animated
 * WebP. */
#ifndef SEQUENCE_WEBP_H
#define SEQUENCE_WEBP_H

#include "sequence_place.h"

typedef struct webp_job {
    int64_t count;     /* of frames */
    int width, height; /* of each */
    double rate;       /* frames a second */
    bool alpha;        /* they have any */
} webp_job;

/* Writes the movie of a place.  A frame at a time is in memory.  Answers 0 or
 * an error number; EFBIG where the format's 4 GB do not suffice. */
int webp_join(const webp_job *job, const sequence_place *place);

#endif
