/* client.c - implements client.h. */
#include "net/client.h"

#include <stdlib.h>
#include <string.h>

/* Bytes of a piece: what a socket takes at once. */
#define PIECE_BYTES 65536

void client_free(client *c, outbox *box) {
    for (int i = 0; i < c->count; i++)
        parcel_release(box, c->queue[i]);
    if (c->sending)
        parcel_release(box, c->sending);
    free(c->text);
    c->count = 0;
    c->sending = NULL;
    c->text = NULL;
    c->id = 0;
}

static bool is_picture(const parcel *p) {
    return p->topic == PARCEL_PICTURE || p->topic == PARCEL_THIN_PICTURE;
}

/* The picture at rest, whose head says so, is one for all links. */
static bool is_for_link(const client *c, const parcel *p) {
    bool final = p->topic == PARCEL_PICTURE && p->bytes[8] == 2;
    return !is_picture(p) || final ||
           c->thin == (p->topic == PARCEL_THIN_PICTURE);
}

/* Of all pictures that wait, for whichever link, only the newest is sent. */
static void forget_pictures(client *c, outbox *box) {
    int left = 0;
    for (int i = 0; i < c->count; i++)
        if (is_picture(c->queue[i]))
            parcel_release(box, c->queue[i]);
        else
            c->queue[left++] = c->queue[i];
    c->count = left;
}

void client_queue(client *c, outbox *box, parcel *p) {
    if (!is_for_link(c, p))
        return;
    if (is_picture(p))
        forget_pictures(c, box);
    for (int i = 0; i < c->count && p->topic != PARCEL_PLAIN; i++) {
        if (c->queue[i]->topic != p->topic)
            continue;
        parcel_release(box, c->queue[i]);
        c->queue[i] = parcel_share(box, p);
        return;
    }
    if (c->count == CLIENT_QUEUE_MOST)
        c->too_slow = true;
    else
        c->queue[c->count++] = parcel_share(box, p);
}

static bool has_picture(const client *c) {
    for (int i = 0; i < c->count; i++)
        if (is_picture(c->queue[i]))
            return true;
    return false;
}

/* A link is thin where most pictures wait until another has arrived, and no
 * more when hardly any does. */
bool client_acknowledge(client *c) {
    bool before = c->thin;
    if (c->under_way > 0)
        c->under_way--;
    c->blocked += 0.2 * ((has_picture(c) ? 1 : 0) - c->blocked);
    c->thin = c->webp && c->blocked > (c->thin ? 0.02 : 0.6);
    return c->thin != before;
}

/* The index of the next parcel that may be sent, or -1. */
static int next_of(const client *c) {
    for (int i = 0; i < c->count; i++)
        if (!is_picture(c->queue[i]) || c->under_way < CLIENT_UNDER_WAY)
            return i;
    return -1;
}

bool client_has_more(const client *c) {
    return c->sending || next_of(c) >= 0;
}

static void begin(client *c) {
    int index = next_of(c);
    if (index < 0)
        return;
    c->sending = c->queue[index];
    c->sent = 0;
    memmove(c->queue + index, c->queue + index + 1,
            (size_t)(c->count - index - 1) * sizeof *c->queue);
    c->count--;
    c->under_way += is_picture(c->sending);
}

/* lws writes into the bytes before a piece, and others read the parcel: so it
 * is copied. */
static bool send_piece(client *c) {
    static unsigned char room[LWS_PRE + PIECE_BYTES];
    const parcel *p = c->sending;
    size_t length = p->length - c->sent;
    bool first = c->sent == 0, last = length <= PIECE_BYTES;
    if (!last)
        length = PIECE_BYTES;
    memcpy(room + LWS_PRE, p->bytes + c->sent, length);
    if (first && is_picture(p))
        frame_head_set_n(room + LWS_PRE, set_log_n(&c->sets, p->revision));
    if (first && p->topic == PARCEL_STATE)
        state_text_set_n(room + LWS_PRE, set_log_n(&c->sets, p->revision));
    int how = !first       ? LWS_WRITE_CONTINUATION
              : p->is_text ? LWS_WRITE_TEXT
                           : LWS_WRITE_BINARY;
    if (!last)
        how |= LWS_WRITE_NO_FIN;
    c->sent += length;
    return lws_write(c->wsi, room + LWS_PRE, length,
                     (enum lws_write_protocol)how) >= 0;
}

bool client_send(client *c, outbox *box) {
    if (!c->sending)
        begin(c);
    if (!c->sending)
        return true;
    bool good = send_piece(c);
    if (c->sent == c->sending->length) {
        parcel_release(box, c->sending);
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
