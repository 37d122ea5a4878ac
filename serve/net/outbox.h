/* outbox.h - what the threads that work have for the pages, until the thread
 * that serves sockets fetches it.
 *
 * A message is bytes with a count of owners: a picture is packed once for all
 * pages.  A message with a topic replaces the one before it, wherever that
 * still waits, and the newest is kept for pages that come later. */
#ifndef OUTBOX_H
#define OUTBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum message_topic {
    MESSAGE_PLAIN = 0, /* each one counts */
    MESSAGE_INFO,
    MESSAGE_LOOK,
    MESSAGE_STATE,
    MESSAGE_FIGURES,
    MESSAGE_PROGRESS,
    MESSAGE_MOVIE,  /* that is written */
    MESSAGE_COUNTS, /* of the values of a simulation */
    MESSAGE_FOLDER, /* how far the list of a folder is */
    MESSAGE_PICTURE,
    MESSAGE_THIN_PICTURE, /* the same for pages on thin links */
    MESSAGE_TOPICS
} message_topic;

typedef struct outgoing {
    int owners; /* changed under the outbox's lock alone */
    message_topic topic;
    bool is_text;
    uint32_t revision; /* of the state, of pictures and states */
    uint64_t shape;    /* width and height of a picture at rest; else 0 */
    uint64_t client;   /* for one page, or 0: for all but `except` */
    uint64_t except;
    struct outgoing *next;
    size_t length;
    unsigned char bytes[];
} outgoing;

typedef struct outbox outbox;

/* `wake` lets the serving thread know that something waits; any thread calls
 * it. */
outbox *outbox_new(void (*wake)(void *user), void *user);
void outbox_free(outbox *box);

/* A message with undefined bytes and one owner; NULL: no memory. */
outgoing *outgoing_new(size_t length);
void outgoing_release(outbox *box, outgoing *p);
outgoing *outgoing_share(outbox *box, outgoing *p);

/* Takes over a message; NULL is accepted. */
void outbox_put(outbox *box, outgoing *p);

/* A text for a page, or for all (0), with a topic. */
void outbox_put_text(outbox *box, uint64_t client, message_topic topic,
                     const char *text);

/* How many pages are on fast and on thin links: for whom pictures are packed;
 * and in what quality those for fast links, while they move. */
void outbox_set_audience(outbox *box, int fast, int thin, int quality);
bool outbox_has_audience(outbox *box, message_topic about);
int outbox_quality(outbox *box);

/* All that waits, in order, which the caller then owns; NULL: nothing. */
outgoing *outbox_take(outbox *box);

/* The newest message of a topic, shared; NULL: none yet. */
outgoing *outbox_newest(outbox *box, message_topic topic);

#endif
