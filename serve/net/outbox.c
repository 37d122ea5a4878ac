/* outbox.c - implements outbox.h: a list under one lock. */
#include "net/outbox.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct outbox {
    pthread_mutex_t lock;
    void (*wake)(void *user);
    void *user;
    outgoing *first, **end;
    outgoing *newest[MESSAGE_TOPICS];
    int fast, thin, quality;
};

outbox *outbox_new(void (*wake)(void *user), void *user) {
    outbox *box = calloc(1, sizeof *box);
    if (!box)
        return NULL;
    pthread_mutex_init(&box->lock, NULL);
    box->wake = wake;
    box->user = user;
    box->end = &box->first;
    return box;
}

/* Under the lock. */
static void drop(outgoing *p) {
    if (p && --p->owners == 0)
        free(p);
}

void outbox_free(outbox *box) {
    if (!box)
        return;
    for (outgoing *p = box->first, *next; p; p = next) {
        next = p->next;
        drop(p);
    }
    for (int i = 0; i < MESSAGE_TOPICS; i++)
        drop(box->newest[i]);
    pthread_mutex_destroy(&box->lock);
    free(box);
}

outgoing *outgoing_new(size_t length) {
    outgoing *p = malloc(sizeof *p + length);
    if (p)
        *p = (outgoing){.owners = 1, .length = length};
    return p;
}

void outgoing_release(outbox *box, outgoing *p) {
    pthread_mutex_lock(&box->lock);
    drop(p);
    pthread_mutex_unlock(&box->lock);
}

outgoing *outgoing_share(outbox *box, outgoing *p) {
    pthread_mutex_lock(&box->lock);
    p->owners++;
    pthread_mutex_unlock(&box->lock);
    return p;
}

/* Under the lock: takes what a message replaces out of the list.  Pictures at
 * rest of one state, for pages of different sizes, stand beside one another.
 * Two states that each leave out another page become one for all, as neither
 * has the other's. */
static void replace(outbox *box, outgoing *by) {
    for (outgoing **at = &box->first; *at;) {
        outgoing *p = *at;
        if (p->topic != by->topic || p->client != by->client ||
            (p->shape != by->shape && p->revision == by->revision)) {
            at = &p->next;
            continue;
        }
        if (p->except != by->except)
            by->except = 0;
        *at = p->next;
        if (box->end == &p->next)
            box->end = at;
        drop(p);
    }
}

void outbox_put(outbox *box, outgoing *p) {
    if (!p)
        return;
    pthread_mutex_lock(&box->lock);
    if (p->topic != MESSAGE_PLAIN && p->client == 0) {
        replace(box, p);
        drop(box->newest[p->topic]);
        box->newest[p->topic] = p;
        p->owners++;
    }
    p->next = NULL;
    *box->end = p;
    box->end = &p->next;
    pthread_mutex_unlock(&box->lock);
    box->wake(box->user);
}

void outbox_put_text(outbox *box, uint64_t client, message_topic topic,
                     const char *text) {
    outgoing *p = text ? outgoing_new(strlen(text)) : NULL;
    if (!p)
        return;
    memcpy(p->bytes, text, p->length);
    p->is_text = true;
    p->client = client;
    p->topic = topic;
    outbox_put(box, p);
}

void outbox_set_audience(outbox *box, int fast, int thin, int quality) {
    pthread_mutex_lock(&box->lock);
    box->fast = fast;
    box->thin = thin;
    if (fast)
        box->quality = quality;
    pthread_mutex_unlock(&box->lock);
}

bool outbox_has_audience(outbox *box, message_topic about) {
    pthread_mutex_lock(&box->lock);
    bool has = about == MESSAGE_THIN_PICTURE ? box->thin > 0 : box->fast > 0;
    pthread_mutex_unlock(&box->lock);
    return has;
}

int outbox_quality(outbox *box) {
    pthread_mutex_lock(&box->lock);
    int quality = box->quality;
    pthread_mutex_unlock(&box->lock);
    return quality;
}

outgoing *outbox_take(outbox *box) {
    pthread_mutex_lock(&box->lock);
    outgoing *first = box->first;
    box->first = NULL;
    box->end = &box->first;
    pthread_mutex_unlock(&box->lock);
    return first;
}

outgoing *outbox_newest(outbox *box, message_topic topic) {
    pthread_mutex_lock(&box->lock);
    outgoing *p = box->newest[topic];
    if (p)
        p->owners++;
    pthread_mutex_unlock(&box->lock);
    return p;
}
