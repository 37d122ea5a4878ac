/* comm/threads.c - ranks that are threads of this process.
 *
 * Each has a context whose memory is that of the caller's context, which so
 * counts the memory of all, and a mailbox. No thread starts before all exist:
 * if the system provides too few threads, none has begun. */
#include "comm/mailbox.h"

typedef enum start_gate { CLOSED, OPEN, SENT_HOME } start_gate;

typedef struct rank_threads {
    snow_context *context; /* the caller's */
    snow_mailbox *mailbox;
    snow_comm_body_fn *body;
    void *user;
    pthread_mutex_t lock;
    pthread_cond_t turn; /* the gate has changed */
    start_gate gate;
} rank_threads;

typedef struct thread_rank {
    rank_threads *threads;
    snow_context *context;
    snow_comm *comm;
    pthread_t thread;
    snow_status status;
} thread_rank;

static void *allocate_shared(void *context, size_t bytes) {
    return snow_allocate(context, bytes);
}

static void release_shared(void *context, void *block) {
    snow_release(context, block);
}

static start_gate wait_at_gate(rank_threads *threads) {
    pthread_mutex_lock(&threads->lock);
    while (threads->gate == CLOSED)
        pthread_cond_wait(&threads->turn, &threads->lock);
    start_gate gate = threads->gate;
    pthread_mutex_unlock(&threads->lock);
    return gate;
}

static void *run_rank(void *argument) {
    thread_rank *member = argument;
    rank_threads *threads = member->threads;
    if (wait_at_gate(threads) == OPEN) {
        member->status = threads->body(member->comm, threads->user);
        snow_mailbox_leave(threads->mailbox, snow_comm_rank(member->comm));
    }
    return NULL;
}

static snow_status prepare_rank(rank_threads *threads, thread_rank *member,
                                int rank) {
    const snow_allocator shared = {allocate_shared, release_shared,
                                   threads->context};
    member->threads = threads;
    SNOW_TRY(snow_context_new(&shared, &member->context));
    if (rank == 0)
        snow_context_set_warning(member->context, threads->context->warning,
                                 threads->context->warning_user);
    snow_status status = snow_mailbox_comm(threads->mailbox, member->context,
                                           rank, false, &member->comm);
    return status == SNOW_STATUS_OK ? status
                                    : snow_fail(threads->context, status, "%s",
                                                member->context->message);
}

/* Makes the threads, lets them work, and waits for their end. */
static snow_status run_ranks(rank_threads *threads, thread_rank *members,
                             int ranks) {
    int made = 0;
    while (made < ranks && !pthread_create(&members[made].thread, NULL,
                                           run_rank, &members[made]))
        made++;
    pthread_mutex_lock(&threads->lock);
    threads->gate = made == ranks ? OPEN : SENT_HOME;
    pthread_cond_broadcast(&threads->turn);
    pthread_mutex_unlock(&threads->lock);
    for (int rank = 0; rank < made; rank++)
        pthread_join(members[rank].thread, NULL);
    if (made == ranks)
        return SNOW_STATUS_OK;
    return snow_fail(
        threads->context, SNOW_STATUS_NO_MEMORY,
        "the system provides %d of the %d threads needed; use fewer ranks",
        made, ranks);
}

/* Returns whether the failure of `a` is reported rather than that of `b`: a
 * rank that failed by itself before those that could not go on without it;
 * among the former the lowest rank, among the latter the first in time. */
static bool comes_before(const thread_rank *a, const thread_rank *b) {
    const snow_mailbox *mailbox = a->threads->mailbox;
    if (!a->comm->broken != !b->comm->broken)
        return !a->comm->broken;
    if (!a->comm->broken)
        return a->comm->rank < b->comm->rank;
    return snow_mailbox_left_before(mailbox, a->comm->rank) <
           snow_mailbox_left_before(mailbox, b->comm->rank);
}

static snow_status sum_up(rank_threads *threads, const thread_rank *members,
                          int ranks) {
    const thread_rank *given = NULL;
    for (int rank = 0; rank < ranks; rank++)
        if (members[rank].status != SNOW_STATUS_OK &&
            (!given || comes_before(&members[rank], given)))
            given = &members[rank];
    if (!given)
        return SNOW_STATUS_OK;
    if (given->comm->agreed || ranks == 1)
        return snow_fail(threads->context, given->status, "%s",
                         given->context->message);
    return snow_fail(threads->context, given->status, "rank %d: %s",
                     given->comm->rank, given->context->message);
}

static snow_status run(rank_threads *threads, thread_rank *members, int ranks) {
    snow_status status = SNOW_STATUS_OK;
    for (int rank = 0; rank < ranks && status == SNOW_STATUS_OK; rank++)
        status = prepare_rank(threads, &members[rank], rank);
    if (status == SNOW_STATUS_OK)
        status = run_ranks(threads, members, ranks);
    if (status == SNOW_STATUS_OK)
        status = sum_up(threads, members, ranks);
    for (int rank = 0; rank < ranks; rank++) {
        snow_comm_free(members[rank].comm);
        snow_context_free(members[rank].context);
    }
    return status;
}

snow_status snow_comm_run_threads(snow_context *context, int ranks,
                                  snow_comm_body_fn *body, void *user) {
    if (ranks < 1)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid number of ranks %d: must be at least 1",
                         ranks);
    rank_threads threads = {.context = context,
                            .body = body,
                            .user = user,
                            .lock = PTHREAD_MUTEX_INITIALIZER,
                            .turn = PTHREAD_COND_INITIALIZER};
    SNOW_TRY(snow_mailbox_new(context, ranks, &threads.mailbox));
    snow_status status = SNOW_STATUS_NO_MEMORY;
    size_t bytes = (size_t)ranks * sizeof(thread_rank);
    thread_rank *members = snow_allocate_clear(context, bytes);
    if (members)
        status = run(&threads, members, ranks);
    pthread_cond_destroy(&threads.turn);
    pthread_mutex_destroy(&threads.lock);
    snow_release(context, members);
    snow_mailbox_free(threads.mailbox);
    return status;
}

/* A mailbox with a single rank, so that code for many ranks needs no special
 * case for one. */
snow_status snow_comm_new_self(snow_context *context, snow_comm **out) {
    snow_mailbox *mailbox;
    SNOW_TRY(snow_mailbox_new(context, 1, &mailbox));
    snow_status status = snow_mailbox_comm(mailbox, context, 0, true, out);
    if (status != SNOW_STATUS_OK)
        snow_mailbox_free(mailbox);
    return status;
}
