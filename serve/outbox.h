/* outbox.h - what the threads that work have for the pages, until the thread
 * that serves sockets fetches it.
 *
 * A parcel is bytes with a count of owners: a picture is packed once for all
 * pages.  A parcel with a topic replaces the one before it, wherever that still
 * waits, and the newest is kept for pages that come later. */
#ifndef OUTBOX_H
#define OUTBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum parcel_topic {
    PARCEL_PLAIN = 0, /* each one counts */
    PARCEL_INFO,
    PARCEL_LOOK,
    PARCEL_STATE,
    PARCEL_FIGURES,
    PARCEL_PROGRESS,
    PARCEL_COUNTS, /* of the values of a simulation */
    PARCEL_PICTURE,
    PARCEL_THIN_PICTURE, /* the same for pages on thin links */
    PARCEL_TOPICS
} parcel_topic;

typedef struct parcel {
    int owners; /* changed under the outbox's lock alone */
    parcel_topic topic;
    bool is_text;
    uint32_t revision; /* of the state, of pictures and states */
    uint64_t client;   /* for one page, or 0: for all but `except` */
    uint64_t except;
    struct parcel *next;
    size_t length;
    unsigned char bytes[];
} parcel;

typedef struct outbox outbox;

/* `wake` lets the serving thread know that something waits; any thread calls
 * it. */
outbox *outbox_new(void (*wake)(void *user), void *user);
void outbox_free(outbox *box);

/* A parcel with undefined bytes and one owner; NULL: no memory. */
parcel *parcel_new(size_t length);
void parcel_release(outbox *box, parcel *p);
parcel *parcel_share(outbox *box, parcel *p);

/* Takes over a parcel; NULL is accepted. */
void outbox_put(outbox *box, parcel *p);

/* A text for a page, or for all (0), with a topic. */
void outbox_put_text(outbox *box, uint64_t client, parcel_topic topic,
                     const char *text);

/* How many pages are on fast and on thin links: for whom pictures are packed;
 * and in what quality those for fast links, while they move. */
void outbox_set_audience(outbox *box, int fast, int thin, int quality);
bool outbox_has_audience(outbox *box, parcel_topic about);
int outbox_quality(outbox *box);

/* All that waits, in order, which the caller then owns; NULL: nothing. */
parcel *outbox_take(outbox *box);

/* The newest parcel of a topic, shared; NULL: none yet. */
parcel *outbox_newest(outbox *box, parcel_topic topic);

#endif
