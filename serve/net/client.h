/* client.h - a page: what waits for it, what was sent, what it has painted.
 *
 * A page on a slow link has at most two pictures under way, one that is slow
 * itself has one, and of those that wait only the newest; other pages do not
 * notice.  All functions are of the
 * thread that serves sockets. */
#ifndef CLIENT_H
#define CLIENT_H

#include "message.h"
#include "net/outbox.h"
#include "state.h"

#include <libwebsockets.h>

#define CLIENT_QUEUE_MOST 96
#define CLIENT_UNDER_WAY 2

/* Bytes of a piece: what a socket takes at once. */
#define CLIENT_PIECE_BYTES 65536

/* On a thin link the picture at rest goes in messages of so many bytes, of
 * which few are under way: what has not gone can be dropped when another
 * follows. */
#define CLIENT_PART_BYTES 16384
#define CLIENT_PARTS_MOST 3

/* A picture that is under way. */
typedef struct sent_picture {
    lws_usec_t at;
    size_t length;
    bool at_rest; /* it was made when nothing moved */
    bool counts;  /* for the time of trips */
} sent_picture;

/* lws allocates it, zeroed, for each WebSocket. */
typedef struct client {
    struct lws *wsi;
    uint64_t id; /* from 1; 0: closed, or not greeted */
    struct client *next;
    bool webp;
    bool moving;   /* something is dragged there */
    bool too_slow; /* so much waits that it is closed */
    char *text;    /* a message that comes in pieces */
    size_t used;
    outgoing *queue[CLIENT_QUEUE_MOST]; /* the oldest first */
    int count;
    outgoing *sending; /* and of it: */
    size_t sent;
    bool in_parts;
    int parts;      /* that the page has not acknowledged */
    bool thin;      /* the link, since pictures wait for it: */
    double blocked; /* the share of them, of late */
    int under_way;  /* pictures that were sent and not acknowledged: */
    sent_picture sent_pictures[CLIENT_UNDER_WAY]; /* the oldest first */
    double trip; /* seconds from a picture to its acknowledgement, of late: */
    double painted; /* and of these the page's own, once it had the picture */
    int step;       /* of quality, from that which all begin with */
    int trips;      /* that were measured since it changed */
    page_size size; /* of the page's picture; 0: not said */
    bool served;    /* it gets pictures at rest of that size */
    uint32_t n;     /* the newest that the page counted */
    set_log sets;   /* of its own */
} client;

void client_free(client *c, outbox *box);

/* Queues a message, which it shares. */
void client_queue(client *c, outbox *box, outgoing *p);

/* A picture was painted, `took` seconds after it had come.  Whether pictures
 * are to be packed in another way for this page from now on. */
bool client_acknowledge(client *c, double took);

/* A part has come. */
void client_note_part(client *c);

/* The shape of the pictures at rest of its size (message.h). */
uint64_t client_shape(const client *c);

/* The quality of pictures that move, from 50 to 90. */
int client_quality(const client *c);

/* Sends a piece of the next message; called when the socket can take one. False
 * for an error. */
bool client_send(client *c, outbox *box);

/* Whether client_send has something to do. */
bool client_has_more(const client *c);

/* Collects a piece of a message.  Returns 1 when it is whole: `text` and `used`
 * hold it; 0 when more comes; -1 where it is too long. */
int client_collect(client *c, const void *bytes, size_t length, bool last);

#endif
