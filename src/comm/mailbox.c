/* comm/mailbox.c - mailboxes of ranks in one process, under one lock.
 *
 * A message goes to the oldest receive that asks for its sender and tag, or
 * else into the receiver's mailbox, where a later receive finds the oldest
 * match. So messages of one tag arrive in order, in whatever order they are
 * waited for.
 *
 *   send --> asked for? --yes--> slot->queued_message   slot: a message in
 *                 |no                                   flight on either side
 *                 +--> box->queued_messages --(receive)--> slot->queued_message
 *
 * No rank waits for ever. A rank that has left, or whose transport has failed,
 * fails those that wait for it; and when every remaining rank waits, no rank
 * can send. */
#include "comm/mailbox.h"
#include "comm/thread_memory.h"

#include <string.h>

typedef struct mailbox_message {
    struct mailbox_message *next;
    struct mailbox_slot *sender; /* notified when it is asked for */
    int from, tag;
    size_t bytes; /* follow this record */
} mailbox_message;

/* For a receive, or for a send (`sends`), which uses only some fields. */
typedef struct mailbox_slot {
    struct mailbox_slot *next; /* in its queue, or among the spare ones */
    struct mailbox_slot *made; /* the slot made before it */
    bool sends, taken;         /* a send; it was asked for */
    void *bytes;
    size_t capacity;
    int peer, tag;
    mailbox_message *queued_message;
} mailbox_slot;

typedef struct mailbox_queue {
    pthread_cond_t wake;
    mailbox_message *queued_messages; /* not yet asked for, oldest first */
    mailbox_slot *slots;              /* without a message yet, oldest first */
    bool gone;                        /* its rank sends nothing more */
    int before; /* number of ranks that had left before it */
    bool waits; /* its rank sleeps, and has nothing new */
} mailbox_queue;

struct snow_mailbox {
    snow_context *context;
    pthread_mutex_t lock; /* of all mailboxes */
    int ranks, waiting, gone;
    bool stuck;    /* every rank waited for another */
    void **shared; /* of each rank, behind the boxes: memory for others */
    mailbox_queue boxes[];
};

/* The data of a rank, which it alone accesses. */
typedef struct mailbox_rank {
    snow_thread_memory memory; /* first */
    snow_mailbox *mailbox;
    snow_context *context;
    int rank;
    bool owns;               /* the mailbox is freed with this record */
    mailbox_slot *made;      /* all slots */
    mailbox_slot *spare;     /* those not in use */
    snow_idle_fn *meanwhile; /* other work done in waits, or NULL */
    void *meanwhile_user;
} mailbox_rank;

/* --- queues (under the lock) ---------------------------------------------- */

static void wake_rank(snow_mailbox *mailbox, mailbox_queue *box) {
    if (box->waits) {
        box->waits = false;
        mailbox->waiting--;
        pthread_cond_signal(&box->wake);
    }
}

static void wake_all(snow_mailbox *mailbox) {
    for (int rank = 0; rank < mailbox->ranks; rank++)
        wake_rank(mailbox, &mailbox->boxes[rank]);
}

static void sleep_at(snow_mailbox *mailbox, mailbox_queue *box) {
    box->waits = true;
    mailbox->waiting++;
    if (mailbox->waiting + mailbox->gone == mailbox->ranks) {
        mailbox->stuck = true;
        wake_all(mailbox);
    }
    while (box->waits)
        pthread_cond_wait(&box->wake, &mailbox->lock);
}

/* Removes the oldest slot that asks for a message from the queue, or returns
 * NULL. */
static mailbox_slot *find_slot(mailbox_queue *box,
                               const mailbox_message *queued_message) {
    for (mailbox_slot **at = &box->slots; *at; at = &(*at)->next)
        if ((*at)->peer == queued_message->from &&
            (*at)->tag == queued_message->tag) {
            mailbox_slot *found = *at;
            *at = found->next;
            return found;
        }
    return NULL;
}

/* Removes the oldest message that a slot asks for from the queue, or returns
 * NULL. */
static mailbox_message *find_message(mailbox_queue *box,
                                     const mailbox_slot *slot) {
    for (mailbox_message **at = &box->queued_messages; *at; at = &(*at)->next)
        if ((*at)->from == slot->peer && (*at)->tag == slot->tag) {
            mailbox_message *found = *at;
            *at = found->next;
            return found;
        }
    return NULL;
}

/* Gives a message to the slot that asked for it: both sides are done. */
static void join(snow_mailbox *mailbox, mailbox_slot *slot,
                 mailbox_message *queued_message) {
    slot->queued_message = queued_message;
    queued_message->sender->taken = true;
    wake_rank(mailbox, &mailbox->boxes[queued_message->from]);
}

static void put_message(snow_mailbox *mailbox, int to,
                        mailbox_message *queued_message) {
    mailbox_queue *box = &mailbox->boxes[to];
    mailbox_slot *slot = find_slot(box, queued_message);
    wake_rank(mailbox, box);
    if (slot) {
        join(mailbox, slot, queued_message);
        return;
    }
    mailbox_message **end = &box->queued_messages;
    while (*end)
        end = &(*end)->next;
    *end = queued_message;
}

static void put_slot(snow_mailbox *mailbox, int at, mailbox_slot *slot) {
    mailbox_queue *box = &mailbox->boxes[at];
    mailbox_message *queued_message = find_message(box, slot);
    if (queued_message) {
        join(mailbox, slot, queued_message);
        return;
    }
    mailbox_slot **end = &box->slots;
    while (*end)
        end = &(*end)->next;
    *end = slot;
}

/* --- a rank --------------------------------------------------------------- */

static mailbox_slot *new_slot(mailbox_rank *own) {
    mailbox_slot *slot = own->spare;
    if (slot) {
        own->spare = slot->next;
        slot->next = NULL;
        return slot;
    }
    slot = snow_allocate(own->context, sizeof *slot);
    if (slot) {
        *slot = (mailbox_slot){.made = own->made};
        own->made = slot;
    }
    return slot;
}

/* A copy of a message; NULL, with an error message, without memory. */
static mailbox_message *new_message(mailbox_rank *own, const void *bytes,
                                    size_t count, int to, int tag) {
    mailbox_message *queued_message = NULL;
    if (count <= SIZE_MAX - sizeof *queued_message)
        queued_message = snow_allocate(own->mailbox->context,
                                       sizeof *queued_message + count);
    if (!queued_message) {
        snow_fail(own->context, SNOW_STATUS_NO_MEMORY,
                  "out of memory for a message of %zu bytes to rank %d; use "
                  "fewer ranks or a smaller picture",
                  count, to);
        return NULL;
    }
    *queued_message =
        (mailbox_message){.from = own->rank, .tag = tag, .bytes = count};
    if (count)
        memcpy(queued_message + 1, bytes, count);
    return queued_message;
}

static snow_status send(void *self, const void *bytes, size_t count, int to,
                        int tag, snow_message *message) {
    mailbox_rank *own = self;
    snow_mailbox *mailbox = own->mailbox;
    mailbox_message *queued_message = new_message(own, bytes, count, to, tag);
    mailbox_slot *slot = queued_message ? new_slot(own) : NULL;
    if (!slot) {
        snow_release(mailbox->context, queued_message);
        snow_mailbox_leave(mailbox, own->rank);
        return SNOW_STATUS_NO_MEMORY;
    }
    slot->sends = true;
    slot->peer = to;
    queued_message->sender = slot;
    pthread_mutex_lock(&mailbox->lock);
    put_message(mailbox, to, queued_message);
    pthread_mutex_unlock(&mailbox->lock);
    *message = (snow_message){.handle = slot, .bytes = count};
    return SNOW_STATUS_OK;
}

static snow_status receive(void *self, void *bytes, size_t capacity, int from,
                           int tag, snow_message *message) {
    mailbox_rank *own = self;
    snow_mailbox *mailbox = own->mailbox;
    mailbox_slot *slot = new_slot(own);
    if (!slot) {
        snow_mailbox_leave(mailbox, own->rank);
        return SNOW_STATUS_NO_MEMORY;
    }
    slot->bytes = bytes;
    slot->capacity = capacity;
    slot->peer = from;
    slot->tag = tag;
    pthread_mutex_lock(&mailbox->lock);
    put_slot(mailbox, own->rank, slot);
    pthread_mutex_unlock(&mailbox->lock);
    *message = (snow_message){.handle = slot};
    return SNOW_STATUS_OK;
}

/* The result of a look at the messages of a wait. */
typedef enum mailbox_event { NOTHING, DONE, NONE_ASKED, LOST } mailbox_event;

/* Checks the messages in flight: *which is done; or *which is with a rank that
 * has left. */
static mailbox_event find_done(const snow_mailbox *mailbox,
                               const snow_message *messages, int count,
                               int *which) {
    mailbox_event news = NONE_ASKED;
    for (int i = 0; i < count; i++) {
        const mailbox_slot *slot = messages[i].handle;
        if (slot && (slot->queued_message || slot->taken)) {
            *which = i;
            return DONE;
        }
        if (slot && mailbox->boxes[slot->peer].gone) {
            *which = i;
            news = LOST;
        } else if (slot && news == NONE_ASKED) {
            news = NOTHING;
        }
    }
    return news;
}

/* Delivers the message of a receive; the slot becomes spare. */
static snow_status deliver_message(mailbox_rank *own, snow_message *message) {
    mailbox_slot *slot = message->handle;
    mailbox_message *queued_message = slot->queued_message;
    if (queued_message && queued_message->bytes > slot->capacity) {
        snow_mailbox_leave(own->mailbox, own->rank);
        return snow_fail(
            own->context, SNOW_STATUS_FAILED,
            "a message of %zu bytes from rank %d exceeds its buffer of %zu "
            "bytes: all ranks must make the same calls",
            queued_message->bytes, queued_message->from, slot->capacity);
    }
    message->handle = NULL;
    if (queued_message) {
        message->bytes = queued_message->bytes;
        if (queued_message->bytes)
            memcpy(slot->bytes, queued_message + 1, queued_message->bytes);
        snow_release(own->mailbox->context, queued_message);
    }
    *slot = (mailbox_slot){.made = slot->made, .next = own->spare};
    own->spare = slot;
    return SNOW_STATUS_OK;
}

static snow_status wait_any(void *self, snow_message *messages, int count,
                            int *which) {
    mailbox_rank *own = self;
    snow_mailbox *mailbox = own->mailbox;
    int found = -1;
    pthread_mutex_lock(&mailbox->lock);
    mailbox_event news = find_done(mailbox, messages, count, &found);
    bool busy = own->meanwhile != NULL; /* while there is other work */
    while (news == NOTHING && !mailbox->stuck) {
        if (busy) {
            /* Messages may arrive while the lock is released. */
            pthread_mutex_unlock(&mailbox->lock);
            busy = own->meanwhile(own->meanwhile_user);
            pthread_mutex_lock(&mailbox->lock);
        } else
            sleep_at(mailbox, &mailbox->boxes[own->rank]);
        news = find_done(mailbox, messages, count, &found);
    }
    pthread_mutex_unlock(&mailbox->lock);
    if (news == NONE_ASKED) {
        *which = -1;
        return SNOW_STATUS_OK;
    }
    if (news == DONE) {
        SNOW_TRY(deliver_message(own, &messages[found]));
        *which = found;
        return SNOW_STATUS_OK;
    }
    snow_mailbox_leave(mailbox, own->rank);
    if (news == LOST)
        return snow_fail(own->context, SNOW_STATUS_FAILED, "rank %d has ended",
                         ((const mailbox_slot *)messages[found].handle)->peer);
    return snow_fail(
        own->context, SNOW_STATUS_FAILED,
        "every rank waits for another: all ranks must make the same calls");
}

static snow_status wait_all(void *self, snow_message *messages, int count) {
    int which = 0;
    while (which >= 0)
        SNOW_TRY(wait_any(self, messages, count, &which));
    return SNOW_STATUS_OK;
}

static double seconds(void *self) {
    (void)self;
    return snow_seconds();
}

static void occupy(void *self, snow_idle_fn *meanwhile, void *user) {
    mailbox_rank *own = self;
    own->meanwhile = meanwhile;
    own->meanwhile_user = user;
}

static void end(void *self) {
    mailbox_rank *own = self;
    snow_mailbox_leave(own->mailbox, own->rank);
    snow_thread_memory_end(self);
    while (own->made) {
        mailbox_slot *slot = own->made;
        own->made = slot->made;
        /* Only a slot in use has one. */
        snow_release(own->mailbox->context, slot->queued_message);
        snow_release(own->context, slot);
    }
    if (own->owns)
        snow_mailbox_free(own->mailbox);
    snow_release(own->context, own);
}

/* --- the mailbox ---------------------------------------------------------- */

snow_status snow_mailbox_comm(snow_mailbox *mailbox, snow_context *context,
                              int rank, bool owns, snow_comm **out) {
    static const snow_comm_ops ops = {.size = sizeof ops,
                                      .send = send,
                                      .receive = receive,
                                      .wait_any = wait_any,
                                      .wait_all = wait_all,
                                      .seconds = seconds,
                                      .occupy = occupy,
                                      .end = end,
                                      .node_of = snow_thread_memory_node,
                                      .share = snow_thread_memory_share,
                                      .shared = snow_thread_memory_shared,
                                      .unshare = snow_thread_memory_unshare};
    mailbox_rank *own = snow_allocate(context, sizeof *own);
    if (!own)
        return SNOW_STATUS_NO_MEMORY;
    *own =
        (struct mailbox_rank){.memory = {mailbox->context, context,
                                         &mailbox->lock, mailbox->shared, rank},
                              .mailbox = mailbox,
                              .context = context,
                              .rank = rank,
                              .owns = owns};
    snow_status status =
        snow_comm_new(context, &ops, own, rank, mailbox->ranks, out);
    if (status != SNOW_STATUS_OK)
        snow_release(context, own);
    return status;
}

void snow_mailbox_leave(snow_mailbox *mailbox, int rank) {
    mailbox_queue *box = &mailbox->boxes[rank];
    pthread_mutex_lock(&mailbox->lock);
    if (!box->gone) {
        box->gone = true;
        box->before = mailbox->gone++;
        wake_all(mailbox);
    }
    pthread_mutex_unlock(&mailbox->lock);
}

int snow_mailbox_left_before(const snow_mailbox *mailbox, int rank) {
    return mailbox->boxes[rank].before;
}

snow_status snow_mailbox_new(snow_context *context, int ranks,
                             snow_mailbox **out) {
    size_t bytes = sizeof(snow_mailbox) +
                   (size_t)ranks * (sizeof(mailbox_queue) + sizeof(void *));
    snow_mailbox *mailbox = snow_allocate_clear(context, bytes);
    if (!mailbox)
        return SNOW_STATUS_NO_MEMORY;
    mailbox->context = context;
    mailbox->ranks = ranks;
    mailbox->shared = (void **)(void *)(mailbox->boxes + ranks);
    mailbox->lock = (pthread_mutex_t)PTHREAD_MUTEX_INITIALIZER;
    for (int rank = 0; rank < ranks; rank++)
        mailbox->boxes[rank].wake = (pthread_cond_t)PTHREAD_COND_INITIALIZER;
    *out = mailbox;
    return SNOW_STATUS_OK;
}

void snow_mailbox_free(snow_mailbox *mailbox) {
    if (!mailbox)
        return;
    for (int rank = 0; rank < mailbox->ranks; rank++) {
        mailbox_queue *box = &mailbox->boxes[rank];
        while (box->queued_messages) {
            mailbox_message *queued_message = box->queued_messages;
            box->queued_messages = queued_message->next;
            snow_release(mailbox->context, queued_message);
        }
        pthread_cond_destroy(&box->wake);
    }
    pthread_mutex_destroy(&mailbox->lock);
    snow_release(mailbox->context, mailbox);
}
