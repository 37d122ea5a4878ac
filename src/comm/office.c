/* comm/office.c - boxes of letters, under one lock.
 *
 * A letter goes to the oldest receive that asks for its sender and tag, or else
 * into the box, where a later receive finds the oldest that it asks for: so
 * letters of one tag arrive in order, in whatever order they are waited for.
 *
 *   send --> asked for? --yes--> slot->letter     slot: a message under way
 *                 |no                               on either side
 *                 +--> box->letters --(receive)--> slot->letter
 *
 * Nobody waits for ever.  A rank that has left, or whose transport has failed,
 * fails those that wait for it; and when every rank that is there waits, nobody
 * is left to send. */
#include "comm/office.h"

#include <string.h>

typedef struct mail_letter {
    struct mail_letter *next;
    struct mail_slot *sender; /* to be told when it is asked for */
    int from, tag;
    size_t bytes; /* which follow this record */
} mail_letter;

/* Of a receive, or of a send (`sends`), which uses only some of it. */
typedef struct mail_slot {
    struct mail_slot *next; /* in the box, while no letter has come; or spare */
    struct mail_slot *made; /* the one that was made before it */
    bool sends, taken;      /* a send; it was asked for */
    void *bytes;
    size_t room;
    int peer, tag;
    mail_letter *letter;
} mail_slot;

typedef struct mail_box {
    pthread_cond_t wake;
    mail_letter *letters; /* that nobody has asked for yet, oldest first */
    mail_slot *slots;     /* that no letter has come for, oldest first */
    bool gone;            /* its rank will send nothing more */
    int before;           /* ranks that had gone when it went */
    bool waits;           /* its rank sleeps, and nothing new is there for it */
} mail_box;

struct snow_office {
    snow_context *context;
    pthread_mutex_t lock; /* of all boxes */
    int ranks, waiting, gone;
    bool stuck; /* everybody waited for somebody */
    mail_box boxes[];
};

/* A rank's side of the office; what it alone touches. */
typedef struct mail_desk {
    snow_office *office;
    snow_context *context;
    int rank;
    bool owns;                    /* the office ends with the desk */
    mail_slot *made;              /* all slots */
    mail_slot *spare;             /* those not in use */
    snow_meanwhile_fn *meanwhile; /* what is done in waits, or NULL */
    void *meanwhile_user;
} mail_desk;

/* --- boxes (under the lock) ----------------------------------------------- */

static void wake(snow_office *office, mail_box *box) {
    if (box->waits) {
        box->waits = false;
        office->waiting--;
        pthread_cond_signal(&box->wake);
    }
}

static void wake_all(snow_office *office) {
    for (int rank = 0; rank < office->ranks; rank++)
        wake(office, &office->boxes[rank]);
}

static void sleep_at(snow_office *office, mail_box *box) {
    box->waits = true;
    office->waiting++;
    if (office->waiting + office->gone == office->ranks) {
        office->stuck = true;
        wake_all(office);
    }
    while (box->waits)
        pthread_cond_wait(&box->wake, &office->lock);
}

/* Takes the oldest slot that asks for a letter out of the box, or NULL. */
static mail_slot *find_slot(mail_box *box, const mail_letter *letter) {
    for (mail_slot **at = &box->slots; *at; at = &(*at)->next)
        if ((*at)->peer == letter->from && (*at)->tag == letter->tag) {
            mail_slot *found = *at;
            *at = found->next;
            return found;
        }
    return NULL;
}

/* Takes the oldest letter that a slot asks for out of the box, or NULL. */
static mail_letter *find_letter(mail_box *box, const mail_slot *slot) {
    for (mail_letter **at = &box->letters; *at; at = &(*at)->next)
        if ((*at)->from == slot->peer && (*at)->tag == slot->tag) {
            mail_letter *found = *at;
            *at = found->next;
            return found;
        }
    return NULL;
}

/* A letter and who asks for it have met: both sides are done. */
static void join(snow_office *office, mail_slot *slot, mail_letter *letter) {
    slot->letter = letter;
    letter->sender->taken = true;
    wake(office, &office->boxes[letter->from]);
}

static void put_letter(snow_office *office, int to, mail_letter *letter) {
    mail_box *box = &office->boxes[to];
    mail_slot *slot = find_slot(box, letter);
    wake(office, box);
    if (slot) {
        join(office, slot, letter);
        return;
    }
    mail_letter **end = &box->letters;
    while (*end)
        end = &(*end)->next;
    *end = letter;
}

static void put_slot(snow_office *office, int at, mail_slot *slot) {
    mail_box *box = &office->boxes[at];
    mail_letter *letter = find_letter(box, slot);
    if (letter) {
        join(office, slot, letter);
        return;
    }
    mail_slot **end = &box->slots;
    while (*end)
        end = &(*end)->next;
    *end = slot;
}

/* --- a desk --------------------------------------------------------------- */

static mail_slot *new_slot(mail_desk *desk) {
    mail_slot *slot = desk->spare;
    if (slot) {
        desk->spare = slot->next;
        slot->next = NULL;
        return slot;
    }
    slot = snow_allocate(desk->context, sizeof *slot);
    if (slot) {
        *slot = (mail_slot){.made = desk->made};
        desk->made = slot;
    }
    return slot;
}

static void free_slot(mail_desk *desk, mail_slot *slot) {
    *slot = (mail_slot){.made = slot->made, .next = desk->spare};
    desk->spare = slot;
}

/* A copy of a message, or NULL and a message. */
static mail_letter *new_letter(mail_desk *desk, const void *bytes, size_t count,
                               int to, int tag) {
    mail_letter *letter = NULL;
    if (count <= SIZE_MAX - sizeof *letter)
        letter = snow_allocate(desk->office->context, sizeof *letter + count);
    if (!letter) {
        snow_fail(desk->context, SNOW_NO_MEMORY,
                  "no memory for a message of %zu bytes to rank %d; take fewer "
                  "ranks or a smaller picture",
                  count, to);
        return NULL;
    }
    *letter = (mail_letter){.from = desk->rank, .tag = tag, .bytes = count};
    if (count)
        memcpy(letter + 1, bytes, count);
    return letter;
}

static snow_status send(void *self, const void *bytes, size_t count, int to,
                        int tag, snow_message *message) {
    mail_desk *desk = self;
    snow_office *office = desk->office;
    mail_letter *letter = new_letter(desk, bytes, count, to, tag);
    mail_slot *slot = letter ? new_slot(desk) : NULL;
    if (!slot) {
        snow_release(office->context, letter);
        snow_office_leave(office, desk->rank);
        return SNOW_NO_MEMORY;
    }
    slot->sends = true;
    slot->peer = to;
    letter->sender = slot;
    pthread_mutex_lock(&office->lock);
    put_letter(office, to, letter);
    pthread_mutex_unlock(&office->lock);
    *message = (snow_message){.handle = slot, .bytes = count};
    return SNOW_OK;
}

static snow_status receive(void *self, void *bytes, size_t room, int from,
                           int tag, snow_message *message) {
    mail_desk *desk = self;
    snow_office *office = desk->office;
    mail_slot *slot = new_slot(desk);
    if (!slot) {
        snow_office_leave(office, desk->rank);
        return SNOW_NO_MEMORY;
    }
    slot->bytes = bytes;
    slot->room = room;
    slot->peer = from;
    slot->tag = tag;
    pthread_mutex_lock(&office->lock);
    put_slot(office, desk->rank, slot);
    pthread_mutex_unlock(&office->lock);
    *message = (snow_message){.handle = slot};
    return SNOW_OK;
}

/* What there is for those who wait. */
typedef enum mail_news { NOTHING, DONE, NONE_ASKED, LOST } mail_news;

/* Looks through the messages under way: *which is done; or *which is with a
 * rank that has gone. */
static mail_news look(const snow_office *office, const snow_message *messages,
                      int count, int *which) {
    mail_news news = NONE_ASKED;
    for (int i = 0; i < count; i++) {
        const mail_slot *slot = messages[i].handle;
        if (slot && (slot->letter || slot->taken)) {
            *which = i;
            return DONE;
        }
        if (slot && office->boxes[slot->peer].gone) {
            *which = i;
            news = LOST;
        } else if (slot && news == NONE_ASKED) {
            news = NOTHING;
        }
    }
    return news;
}

/* Hands over the letter of a receive; the slot is spare again. */
static snow_status finish(mail_desk *desk, snow_message *message) {
    mail_slot *slot = message->handle;
    mail_letter *letter = slot->letter;
    if (letter && letter->bytes > slot->room) {
        snow_office_leave(desk->office, desk->rank);
        return snow_fail(desk->context, SNOW_FAILED,
                         "a message of %zu bytes from rank %d where there is "
                         "room for %zu; the ranks do different things",
                         letter->bytes, letter->from, slot->room);
    }
    message->handle = NULL;
    if (letter) {
        message->bytes = letter->bytes;
        if (letter->bytes)
            memcpy(slot->bytes, letter + 1, letter->bytes);
        snow_release(desk->office->context, letter);
    }
    free_slot(desk, slot);
    return SNOW_OK;
}

/* Does a piece of other work, the lock open, so that letters may have come;
 * false where there is none. */
static bool work_meanwhile(mail_desk *desk) {
    bool worked;
    if (!desk->meanwhile)
        return false;
    pthread_mutex_unlock(&desk->office->lock);
    worked = desk->meanwhile(desk->meanwhile_user);
    pthread_mutex_lock(&desk->office->lock);
    return worked;
}

static snow_status wait_any(void *self, snow_message *messages, int count,
                            int *which) {
    mail_desk *desk = self;
    snow_office *office = desk->office;
    int found = -1;
    pthread_mutex_lock(&office->lock);
    mail_news news = look(office, messages, count, &found);
    bool busy = true;
    while (news == NOTHING && !office->stuck) {
        if (busy)
            busy = work_meanwhile(desk);
        else
            sleep_at(office, &office->boxes[desk->rank]);
        news = look(office, messages, count, &found);
    }
    pthread_mutex_unlock(&office->lock);
    if (news == NONE_ASKED) {
        *which = -1;
        return SNOW_OK;
    }
    if (news == DONE) {
        SNOW_TRY(finish(desk, &messages[found]));
        *which = found;
        return SNOW_OK;
    }
    snow_office_leave(office, desk->rank);
    if (news == LOST)
        return snow_fail(desk->context, SNOW_FAILED, "rank %d has ended",
                         ((const mail_slot *)messages[found].handle)->peer);
    return snow_fail(desk->context, SNOW_FAILED,
                     "every rank waits for another; the ranks do different "
                     "things");
}

static snow_status wait_all(void *self, snow_message *messages, int count) {
    int which = 0;
    while (which >= 0)
        SNOW_TRY(wait_any(self, messages, count, &which));
    return SNOW_OK;
}

static double seconds(void *self) {
    (void)self;
    return snow_seconds();
}

static void occupy(void *self, snow_meanwhile_fn *meanwhile, void *user) {
    mail_desk *desk = self;
    desk->meanwhile = meanwhile;
    desk->meanwhile_user = user;
}

static void end(void *self) {
    mail_desk *desk = self;
    snow_office_leave(desk->office, desk->rank);
    while (desk->made) {
        mail_slot *slot = desk->made;
        desk->made = slot->made;
        /* Only a slot in use has one. */
        snow_release(desk->office->context, slot->letter);
        snow_release(desk->context, slot);
    }
    if (desk->owns)
        snow_office_free(desk->office);
    snow_release(desk->context, desk);
}

/* --- the office ----------------------------------------------------------- */

snow_status snow_office_comm(snow_office *office, snow_context *context,
                             int rank, bool owns, snow_comm **out) {
    static const snow_comm_ops ops = {.size = sizeof ops,
                                      .send = send,
                                      .receive = receive,
                                      .wait_any = wait_any,
                                      .wait_all = wait_all,
                                      .seconds = seconds,
                                      .occupy = occupy,
                                      .end = end};
    mail_desk *desk = snow_allocate(context, sizeof *desk);
    if (!desk)
        return SNOW_NO_MEMORY;
    *desk = (struct mail_desk){
        .office = office, .context = context, .rank = rank, .owns = owns};
    snow_status status =
        snow_comm_new(context, &ops, desk, rank, office->ranks, out);
    if (status != SNOW_OK)
        snow_release(context, desk);
    return status;
}

void snow_office_leave(snow_office *office, int rank) {
    mail_box *box = &office->boxes[rank];
    pthread_mutex_lock(&office->lock);
    if (!box->gone) {
        box->gone = true;
        box->before = office->gone++;
        wake_all(office);
    }
    pthread_mutex_unlock(&office->lock);
}

int snow_office_left_before(const snow_office *office, int rank) {
    return office->boxes[rank].before;
}

snow_status snow_office_new(snow_context *context, int ranks,
                            snow_office **out) {
    size_t bytes = sizeof(snow_office) + (size_t)ranks * sizeof(mail_box);
    snow_office *office = snow_allocate_clear(context, bytes);
    if (!office)
        return SNOW_NO_MEMORY;
    office->context = context;
    if (pthread_mutex_init(&office->lock, NULL)) {
        snow_release(context, office);
        return snow_fail(context, SNOW_NO_MEMORY, "no memory for a lock");
    }
    for (; office->ranks < ranks; office->ranks++)
        if (pthread_cond_init(&office->boxes[office->ranks].wake, NULL)) {
            snow_office_free(office);
            return snow_fail(context, SNOW_NO_MEMORY, "no memory for a lock");
        }
    *out = office;
    return SNOW_OK;
}

void snow_office_free(snow_office *office) {
    if (!office)
        return;
    for (int rank = 0; rank < office->ranks; rank++) {
        mail_box *box = &office->boxes[rank];
        while (box->letters) {
            mail_letter *letter = box->letters;
            box->letters = letter->next;
            snow_release(office->context, letter);
        }
        pthread_cond_destroy(&box->wake);
    }
    pthread_mutex_destroy(&office->lock);
    snow_release(office->context, office);
}
