/* bench/frame/frame_turn.c - pictures of a turning volume by many ranks, as a
 * turntable makes them: one after another, and each splatted while the one
 * before it is combined.  Both in turn, so that what disturbs one disturbs the
 * other; of each the fastest counts. */
#include "frame.h"

#include <string.h>

/* Degrees from picture to picture: the slice axis seldom changes. */
#define STEP 1.0

/* One way of making all pictures. */
typedef struct turning {
    double seconds, hidden; /* a picture; hidden on this rank */
    uint64_t sum;           /* of all pictures' bits, on rank 0 */
} turning;

/* Mixes in the bits of a picture (Fowler, Noll and Vo's hash). */
static void add_picture(turning *t, snow_image *image) {
    const float *pixels = snow_image_pixels(image);
    size_t count = (size_t)snow_image_width(image) *
                   (size_t)snow_image_height(image) *
                   (size_t)snow_image_channels(image);
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &pixels[i], sizeof bits);
        t->sum = (t->sum ^ bits) * UINT64_C(1099511628211);
    }
}

static snow_status begin(frame_rank *s, int number) {
    snow_view view = s->view;
    view.azimuth += STEP * number;
    snow_status status = snow_ranks_repartition(
        s->comm, s->transfer, &view, &s->settings, &s->how, &s->volume);
    if (status != SNOW_STATUS_OK)
        return status;
    return snow_ranks_begin(s->frame, s->comm, s->volume, s->transfer, &view,
                            &s->settings, &s->how);
}

static snow_status finish(frame_rank *s, turning *t, bool looks) {
    snow_image *image = NULL;
    snow_status status = snow_ranks_finish(s->frame, &image);
    if (status != SNOW_STATUS_OK)
        return status;
    t->hidden +=
        snow_frame_ranks_stats(s->frame)->seconds_hidden / s->options->turn;
    if (image && looks)
        add_picture(t, image);
    snow_image_free(image);
    return SNOW_STATUS_OK;
}

/* Collective: all pictures, `ahead` of them begun before the first is finished.
 * Whether bits are looked at: that takes time. */
static snow_status turn(frame_rank *s, int ahead, bool looks, turning *out) {
    const int count = s->options->turn;
    *out = (turning){.sum = UINT64_C(14695981039346656037)};
    snow_status status =
        snow_comm_agree_status(s->comm, SNOW_STATUS_OK); /* a barrier */
    const double start = snow_comm_seconds(s->comm);
    for (int i = 0; i < count + ahead && status == SNOW_STATUS_OK; i++) {
        if (i < count)
            status = begin(s, i);
        if (status == SNOW_STATUS_OK && i >= ahead)
            status = finish(s, out, looks);
    }
    if (status == SNOW_STATUS_OK)
        status = snow_comm_agree_status(s->comm, SNOW_STATUS_OK);
    out->seconds = (snow_comm_seconds(s->comm) - start) / count;
    return status;
}

/* Collective: the mean over ranks. */
static snow_status share_hidden(frame_rank *s, double *mean) {
    const int ranks = snow_comm_size(s->comm);
    s->mine.hidden = *mean;
    snow_status status =
        snow_comm_allgather(s->comm, &s->mine, sizeof s->mine, s->all);
    *mean = 0;
    for (int i = 0; i < ranks && status == SNOW_STATUS_OK; i++)
        *mean += s->all[i].hidden / ranks;
    return status;
}

snow_status frame_turn(frame_rank *s, frame_result *out) {
    turning apart, overlapped = {0};
    snow_status status = turn(s, 0, true, &apart);
    if (status == SNOW_STATUS_OK)
        status = turn(s, 1, true, &overlapped);
    out->same = apart.sum == overlapped.sum;
    for (int i = 0; i < s->options->runs && status == SNOW_STATUS_OK; i++) {
        status = turn(s, 0, false, &apart);
        if (status == SNOW_STATUS_OK)
            status = turn(s, 1, false, &overlapped);
        if (i == 0 || apart.seconds < out->apart)
            out->apart = apart.seconds;
        if (i == 0 || overlapped.seconds < out->overlapped) {
            out->overlapped = overlapped.seconds;
            out->hidden = overlapped.hidden;
        }
    }
    return status == SNOW_STATUS_OK ? share_hidden(s, &out->hidden) : status;
}
