/* bench/simulated_network.c - ranks of this process on a simulated cluster.
 *
 * Each rank has its own clock. It runs with the processor time of the rank's
 * thread; a message takes the network's time:
 *
 *   sender's port    |--- bytes / bandwidth ---|
 *                    ^ start                    \ latency
 *   receiver's port          |--- bytes / bandwidth ---| done
 *
 * A port carries one message after another, in each direction. `start` travels
 * with the message, so the receiver knows when it could arrive; several that it
 * waits for together enter its port in order of their starts. It is the model
 * by which Hockney (1994) and LogGP (Alexandrov et al. 1995) predict programs,
 * with ports that can be busy.
 *
 * A wait with other work first waits for the real message, since its arrival
 * time is not known before, and then works until the clock reaches that time.
 * Other work sends nothing, so no rank can observe the difference. */
#include "simulated_network.h"

#include "comm/comm.h"

#include <math.h>
#include <pthread.h>
#include <string.h>
#include <time.h>

typedef struct cluster {
    snow_network network;
    snow_comm_body_fn *body;
    void *user;
    pthread_mutex_t baton; /* held by the rank that computes */
} cluster;

typedef struct node {
    cluster *cluster;
    snow_comm *inner;
    double clock, computed;   /* simulated; processor time when last read */
    double out_free, in_free; /* times when the ports become free */
    snow_idle_fn *meanwhile;  /* other work done in waits, or NULL */
    void *meanwhile_user;
} node;

/* Sent before a message's bytes. */
typedef struct stamp {
    double start; /* when its first byte enters the network */
} stamp;

/* A message in flight. */
typedef struct queued_message {
    snow_message inner;
    double sent;    /* when the last byte was sent */
    void *buffer;   /* buffer of a receive; NULL: a send */
    bool to_myself; /* takes no time */
} queued_message;

static stamp *stamp_of(const queued_message *l) {
    return (stamp *)((uintptr_t)l + sizeof *l);
}

static double processor_seconds(void) {
    struct timespec now = {0};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Advances the clock to now, on entry to one of the functions below. What they
 * do themselves is no part of the model, so leaving only reads the time. */
static void enter(node *n) {
    const double worked = processor_seconds() - n->computed;
    n->clock += worked * n->cluster->network.slowness;
}

static snow_status leave(node *n, snow_status status) {
    n->computed = processor_seconds();
    return status;
}

static queued_message *new_message(node *n, size_t bytes) {
    return snow_allocate(n->inner->context,
                         sizeof(queued_message) + sizeof(stamp) + bytes);
}

static snow_status post(node *n, const void *bytes, size_t count, int to,
                        int tag, snow_message *message) {
    const snow_network *net = &n->cluster->network;
    queued_message *l = new_message(n, count);
    if (!l)
        return SNOW_STATUS_NO_MEMORY;
    bool to_myself = to == snow_comm_rank(n->inner);
    n->clock += net->overhead;
    double start = fmax(n->clock, n->out_free);
    *l = (queued_message){.to_myself = to_myself, .sent = n->clock};
    if (!to_myself)
        l->sent = n->out_free = start + (double)count / net->bandwidth;
    stamp_of(l)->start = start;
    if (count)
        memcpy(stamp_of(l) + 1, bytes, count);
    snow_status status = snow_comm_send(
        n->inner, stamp_of(l), sizeof(stamp) + count, to, tag, &l->inner);
    if (status == SNOW_STATUS_OK)
        *message = (snow_message){l, count};
    else
        snow_release(n->inner->context, l);
    return status;
}

static snow_status send(void *self, const void *bytes, size_t count, int to,
                        int tag, snow_message *message) {
    enter(self);
    return leave(self, post(self, bytes, count, to, tag, message));
}

static snow_status get_ready(node *n, void *bytes, size_t capacity, int from,
                             int tag, snow_message *message) {
    queued_message *l = new_message(n, capacity);
    if (!l)
        return SNOW_STATUS_NO_MEMORY;
    /* Any pointer that is not NULL marks a receive of no bytes. */
    *l = (queued_message){.buffer = bytes ? bytes : l,
                          .to_myself = from == snow_comm_rank(n->inner)};
    snow_status status = snow_comm_receive(
        n->inner, stamp_of(l), sizeof(stamp) + capacity, from, tag, &l->inner);
    if (status == SNOW_STATUS_OK)
        *message = (snow_message){l, 0};
    else
        snow_release(n->inner->context, l);
    return status;
}

static snow_status receive(void *self, void *bytes, size_t capacity, int from,
                           int tag, snow_message *message) {
    enter(self);
    return leave(self, get_ready(self, bytes, capacity, from, tag, message));
}

/* The time when a message is completely received. */
static double arrival(node *n, const queued_message *l, size_t bytes) {
    const snow_network *net = &n->cluster->network;
    if (l->to_myself)
        return stamp_of(l)->start;
    n->in_free = fmax(stamp_of(l)->start + net->latency, n->in_free) +
                 (double)bytes / net->bandwidth;
    return n->in_free;
}

/* Advances the clock to `then`, with other work while there is some; the last
 * piece may end later. */
static void wait_until(node *n, double then) {
    bool busy = n->meanwhile != NULL;
    while (busy && n->clock < then) {
        leave(n, SNOW_STATUS_OK);
        busy = n->meanwhile(n->meanwhile_user);
        enter(n);
    }
    n->clock = fmax(n->clock, then);
}

/* Completes a message, in simulated time. */
static void complete_message(node *n, snow_message *message) {
    queued_message *l = message->handle;
    if (l->buffer) {
        message->bytes = l->inner.bytes - sizeof(stamp);
        if (message->bytes)
            memcpy(l->buffer, stamp_of(l) + 1, message->bytes);
        wait_until(n, arrival(n, l, message->bytes));
        n->clock += n->cluster->network.overhead;
    } else {
        wait_until(n, l->sent);
    }
    snow_release(n->inner->context, l);
    message->handle = NULL;
}

/* After a failure no rank waits for messages in flight. */
static snow_status give_up(node *n, snow_message *messages, int count,
                           snow_status status) {
    for (int i = 0; i < count; i++) {
        snow_release(n->inner->context, messages[i].handle);
        messages[i].handle = NULL;
    }
    return status;
}

/* The message that entered the network first; NULL when none is left. */
static snow_message *earliest(snow_message *messages, int count) {
    snow_message *first = NULL;
    for (int i = 0; i < count; i++) {
        queued_message *l = messages[i].handle;
        if (l &&
            (!first || stamp_of(l)->start <
                           stamp_of((queued_message *)first->handle)->start))
            first = &messages[i];
    }
    return first;
}

static snow_status wait_all(void *self, snow_message *messages, int count) {
    node *n = self;
    snow_message *next;
    enter(n);
    snow_status status = SNOW_STATUS_OK;
    /* The ranks take turns: others may compute while this one waits. */
    for (int i = 0; i < count && status == SNOW_STATUS_OK; i++) {
        queued_message *l = messages[i].handle;
        if (!l)
            continue;
        pthread_mutex_unlock(&n->cluster->baton);
        status = snow_comm_wait_all(n->inner, &l->inner, 1);
        pthread_mutex_lock(&n->cluster->baton);
    }
    if (status != SNOW_STATUS_OK)
        return give_up(n, messages, count, status);
    while ((next = earliest(messages, count)) != NULL)
        complete_message(n, next);
    return leave(n, SNOW_STATUS_OK);
}

/* The first message that is done already: a send. */
static int find_done(const snow_message *messages, int count) {
    for (int i = 0; i < count; i++) {
        const queued_message *l = messages[i].handle;
        if (l && !l->inner.handle)
            return i;
    }
    return -1;
}

static snow_status wait_any_inner(node *n, snow_message *messages, int count,
                                  int *which) {
    snow_context *context = n->inner->context;
    snow_message *inner =
        snow_allocate_clear(context, ((size_t)count + 1) * sizeof *inner);
    if (!inner)
        return SNOW_STATUS_NO_MEMORY;
    for (int i = 0; i < count; i++)
        if (messages[i].handle)
            inner[i] = ((queued_message *)messages[i].handle)->inner;
    pthread_mutex_unlock(&n->cluster->baton);
    snow_status status = snow_comm_wait_any(n->inner, inner, count, which);
    pthread_mutex_lock(&n->cluster->baton);
    if (status == SNOW_STATUS_OK && *which >= 0)
        ((queued_message *)messages[*which].handle)->inner = inner[*which];
    snow_release(context, inner);
    return status;
}

/* Returns the message that the ranks' simulated clocks bring first; the clock
 * is advanced to it. */
static snow_status wait_any(void *self, snow_message *messages, int count,
                            int *which) {
    node *n = self;
    snow_status status = SNOW_STATUS_OK;
    enter(n);
    int found = find_done(messages, count);
    if (found < 0)
        status = wait_any_inner(n, messages, count, &found);
    if (status != SNOW_STATUS_OK)
        return give_up(n, messages, count, status);
    if (found >= 0)
        complete_message(n, &messages[found]);
    *which = found;
    return leave(n, SNOW_STATUS_OK);
}

static double seconds(void *self) {
    node *n = self;
    enter(n);
    leave(n, SNOW_STATUS_OK);
    return n->clock;
}

static void work(void *self, double seconds) {
    node *n = self;
    enter(n);
    n->clock += seconds;
    leave(n, SNOW_STATUS_OK);
}

static void occupy(void *self, snow_idle_fn *meanwhile, void *user) {
    node *n = self;
    n->meanwhile = meanwhile;
    n->meanwhile_user = user;
}

static void end(void *self) {
    node *n = self;
    snow_release(n->inner->context, n);
}

static const snow_comm_ops node_ops = {.size = sizeof node_ops,
                                       .send = send,
                                       .receive = receive,
                                       .wait_any = wait_any,
                                       .wait_all = wait_all,
                                       .seconds = seconds,
                                       .work = work,
                                       .occupy = occupy,
                                       .end = end};

/* The life of a rank: a node around its communicator, then the user's function.
 */
static snow_status run_rank(snow_comm *inner, void *user) {
    cluster *c = user;
    snow_context *context = snow_comm_context(inner);
    snow_comm *comm;
    node *n = snow_allocate(context, sizeof *n);
    if (!n)
        return SNOW_STATUS_NO_MEMORY;
    *n = (node){.cluster = c, .inner = inner};
    snow_status status =
        snow_comm_new(context, &node_ops, n, snow_comm_rank(inner),
                      snow_comm_size(inner), &comm);
    if (status != SNOW_STATUS_OK) {
        snow_release(context, n);
        return status;
    }
    pthread_mutex_lock(&c->baton);
    leave(n, SNOW_STATUS_OK);
    status = c->body(comm, c->user);
    pthread_mutex_unlock(&c->baton);
    snow_comm_free(comm);
    return status;
}

snow_status snow_comm_run_simulated(snow_context *context, int ranks,
                                    const snow_network *network,
                                    snow_comm_body_fn *body, void *user) {
    if (!(network->bandwidth > 0) || !(network->slowness > 0) ||
        !(network->latency >= 0) || !(network->overhead >= 0))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "invalid network: bandwidth %g, latency %g, overhead %g, slowness "
            "%g; bandwidth and slowness must be above 0, times not negative",
            network->bandwidth, network->latency, network->overhead,
            network->slowness);
    cluster c = {.network = *network, .body = body, .user = user};
    if (pthread_mutex_init(&c.baton, NULL))
        return snow_fail(context, SNOW_STATUS_NO_MEMORY,
                         "cannot create a lock: out of memory");
    snow_status status = snow_comm_run_threads(context, ranks, run_rank, &c);
    pthread_mutex_destroy(&c.baton);
    return status;
}
