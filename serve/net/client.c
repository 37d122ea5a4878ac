/* client.c - implements client.h. */
#include "net/client.h"

#include <stdlib.h>
#include <string.h>

/* Qualities of pictures that move.  One is left for the next lower one when a
 * trip takes more than `slow` seconds, and for the next higher one when it
 * takes less than `quick`; between the two it stays. */
static const struct {
    int quality;
    double quick, slow;
} steps[] = {{50, 0.12, 1e9},
             {62, 0.12, 0.25},
             {75, 0.05, 0.25},
             {85, 0.05, 0.1},
             {90, 0, 0.1}};
#define STEP_FIRST 2 /* what all begin with */

/* A step is kept for so many trips, until they are its own. */
#define TRIPS_LEAST 8

/* Only pictures of fewer bytes have more than the first step; each step adds up
 * to a third. */
#define PICTURE_BYTES 60000

void client_free(client *c, outbox *box) {
    for (int i = 0; i < c->count; i++)
        outgoing_release(box, c->queue[i]);
    if (c->sending)
        outgoing_release(box, c->sending);
    free(c->text);
    c->count = 0;
    c->sending = NULL;
    c->text = NULL;
    c->id = 0;
}

static bool is_picture(const outgoing *p) {
    return p->topic == MESSAGE_PICTURE || p->topic == MESSAGE_THIN_PICTURE;
}

/* Of all pictures that wait, for whichever link, only the newest is sent. */
static void forget_pictures(client *c, outbox *box) {
    int left = 0;
    for (int i = 0; i < c->count; i++)
        if (is_picture(c->queue[i]))
            outgoing_release(box, c->queue[i]);
        else
            c->queue[left++] = c->queue[i];
    c->count = left;
}

static bool is_final(const outgoing *p) {
    return p->topic == MESSAGE_PICTURE && p->bytes[8] == 2;
}

/* The rest of a picture that goes in parts, as another one follows. */
static void drop_parts(client *c, outbox *box) {
    if (!c->sending || !c->in_parts)
        return;
    outgoing_release(box, c->sending);
    c->sending = NULL;
    c->under_way--; /* the newest, which the page never paints */
}

uint64_t client_shape(const client *c) {
    return (uint64_t)c->size.width | (uint64_t)c->size.height << 32;
}

/* The state and the look of another volume go behind the message that names it,
 * which the page forgets those before by. */
static bool is_behind_info(const client *c, int place) {
    for (int i = place + 1; i < c->count; i++)
        if (c->queue[i]->topic == MESSAGE_INFO)
            return true;
    return false;
}

static void take_out(client *c, int place) {
    memmove(c->queue + place, c->queue + place + 1,
            (size_t)(c->count - place - 1) * sizeof *c->queue);
    c->count--;
}

void client_queue(client *c, outbox *box, outgoing *p) {
    /* The picture at rest, whose head says so, is one for all links. */
    bool final = is_final(p);
    if (is_picture(p) && !final &&
        c->thin != (p->topic == MESSAGE_THIN_PICTURE))
        return;
    if (final && c->served && p->shape && p->shape != client_shape(c))
        return; /* that of its own size comes too */
    if (is_picture(p)) {
        forget_pictures(c, box);
        drop_parts(c, box);
    }
    for (int i = 0; i < c->count && p->topic != MESSAGE_PLAIN; i++) {
        if (c->queue[i]->topic != p->topic)
            continue;
        outgoing_release(box, c->queue[i]);
        if (is_behind_info(c, i)) {
            take_out(c, i);
            break;
        }
        c->queue[i] = outgoing_share(box, p);
        return;
    }
    if (c->count == CLIENT_QUEUE_MOST)
        c->too_slow = true;
    else
        c->queue[c->count++] = outgoing_share(box, p);
}

int client_quality(const client *c) {
    return steps[STEP_FIRST + c->step].quality;
}

/* The step that follows from the trips, and from the length of a picture. */
static int step_after(const client *c, size_t length) {
    int now = STEP_FIRST + c->step;
    bool long_one = c->step > 0 && length > PICTURE_BYTES;
    bool short_one = c->step < 0 || length < PICTURE_BYTES * 2 / 3;
    if (c->trip > steps[now].slow || long_one)
        return c->step - 1;
    return c->trip < steps[now].quick && short_one ? c->step + 1 : c->step;
}

static void note_trip(client *c, const sent_picture *sent, double took) {
    double seconds = 1e-6 * (double)(lws_now_usecs() - sent->at);
    double share = c->trip > 0 ? 0.2 : 1;
    c->trip += share * (seconds - c->trip);
    c->painted += share * (took - c->painted);
    if (++c->trips < TRIPS_LEAST)
        return;
    int step = step_after(c, sent->length);
    if (step != c->step)
        c->trips = 0;
    c->step = step;
}

/* A picture at rest does not count for those that move, nor does one that waits
 * behind it. */
static void note_sent(client *c, const outgoing *p) {
    bool at_rest = p->bytes[8] > 0;
    bool waits = c->under_way > 0 && c->sent_pictures[0].at_rest;
    c->sent_pictures[c->under_way++] =
        (sent_picture){.at = lws_now_usecs(),
                       .length = p->length,
                       .at_rest = at_rest,
                       .counts = !at_rest && !waits};
}

static void note_painted(client *c, double took) {
    if (c->under_way == 0)
        return;
    sent_picture oldest = c->sent_pictures[0];
    c->under_way--;
    memmove(c->sent_pictures, c->sent_pictures + 1,
            (size_t)c->under_way * sizeof *c->sent_pictures);
    if (oldest.counts)
        note_trip(c, &oldest, took);
}

/* A link is thin where most pictures wait until another has arrived, and no
 * more when hardly any does.  A page that is itself slow, as on a busy machine,
 * has no thin link: WebP would keep it and the viewer busier still. */
bool client_acknowledge(client *c, double took) {
    bool thin = c->thin;
    int quality = client_quality(c);
    note_painted(c, took);
    int waits = 0; /* 1: a picture does, for the link */
    for (int i = 0; i < c->count && c->trip >= 2 * c->painted; i++)
        waits |= is_picture(c->queue[i]);
    c->blocked += 0.2 * (waits - c->blocked);
    c->thin = c->webp && c->blocked > (c->thin ? 0.02 : 0.6);
    return c->thin != thin || client_quality(c) != quality;
}

/* A page that is slow itself, not its link, gets a picture when it has painted
 * the one before: another would only grow old there. */
static int most_under_way(const client *c) {
    return c->trip < 1.5 * c->painted ? 1 : CLIENT_UNDER_WAY;
}

/* The index of the next message that may be sent, or -1. */
static int next_of(const client *c) {
    const int most = most_under_way(c);
    for (int i = 0; i < c->count; i++)
        if (!is_picture(c->queue[i]) || c->under_way < most)
            return i;
    return -1;
}

bool client_has_more(const client *c) {
    if (c->sending)
        return !c->in_parts || c->parts < CLIENT_PARTS_MOST;
    return next_of(c) >= 0;
}

static void begin(client *c) {
    int index = next_of(c);
    if (index < 0)
        return;
    c->sending = c->queue[index];
    c->sent = 0;
    take_out(c, index);
    c->in_parts = c->thin && is_final(c->sending) &&
                  c->sending->length > 2 * CLIENT_PART_BYTES;
    if (c->in_parts)
        c->sent = FRAME_HEAD_BYTES;
    if (is_picture(c->sending))
        note_sent(c, c->sending);
}

void client_note_part(client *c) {
    if (c->parts > 0)
        c->parts--;
}

/* A message with the head and some bytes of the picture. */
static bool send_part(client *c) {
    static unsigned char
        scratch[LWS_PRE + FRAME_HEAD_BYTES + CLIENT_PART_BYTES];
    unsigned char *head = scratch + LWS_PRE;
    const outgoing *p = c->sending;
    const bool first = c->sent == FRAME_HEAD_BYTES;
    size_t length = p->length - c->sent;
    if (length > CLIENT_PART_BYTES)
        length = CLIENT_PART_BYTES;
    memcpy(head, p->bytes, FRAME_HEAD_BYTES);
    frame_head_set_n(head, set_log_n(&c->sets, p->revision));
    frame_head_set_part(head, first ? FRAME_FIRST : FRAME_NEXT,
                        (uint32_t)(p->length - FRAME_HEAD_BYTES));
    memcpy(head + FRAME_HEAD_BYTES, p->bytes + c->sent, length);
    c->sent += length;
    c->parts++;
    return lws_write(c->wsi, head, FRAME_HEAD_BYTES + length,
                     LWS_WRITE_BINARY) >= 0;
}

/* lws writes into the bytes before a piece, and others read the message: so it
 * is copied. */
static bool send_piece(client *c) {
    static unsigned char scratch[LWS_PRE + CLIENT_PIECE_BYTES];
    const outgoing *p = c->sending;
    size_t length = p->length - c->sent;
    bool first = c->sent == 0, last = length <= CLIENT_PIECE_BYTES;
    if (!last)
        length = CLIENT_PIECE_BYTES;
    memcpy(scratch + LWS_PRE, p->bytes + c->sent, length);
    if (first && is_picture(p))
        frame_head_set_n(scratch + LWS_PRE, set_log_n(&c->sets, p->revision));
    if (first && p->topic == MESSAGE_STATE)
        state_text_set_step(scratch + LWS_PRE,
                            set_log_n(&c->sets, p->revision));
    int how = !first       ? LWS_WRITE_CONTINUATION
              : p->is_text ? LWS_WRITE_TEXT
                           : LWS_WRITE_BINARY;
    if (!last)
        how |= LWS_WRITE_NO_FIN;
    c->sent += length;
    return lws_write(c->wsi, scratch + LWS_PRE, length,
                     (enum lws_write_protocol)how) >= 0;
}

bool client_send(client *c, outbox *box) {
    if (!c->sending)
        begin(c);
    if (!c->sending || (c->in_parts && c->parts >= CLIENT_PARTS_MOST))
        return true;
    bool good = c->in_parts ? send_part(c) : send_piece(c);
    if (c->sent == c->sending->length) {
        outgoing_release(box, c->sending);
        c->sending = NULL;
    }
    return good;
}

int client_collect(client *c, const void *bytes, size_t length, bool last) {
    if (!c->text)
        c->text = malloc(MESSAGE_BYTES);
    if (!c->text || c->used + length > MESSAGE_BYTES)
        return -1;
    memcpy(c->text + c->used, bytes, length);
    c->used += length;
    return last ? 1 : 0;
}
