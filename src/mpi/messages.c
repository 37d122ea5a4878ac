/* mpi/messages.c - sends, receives and waits, and a communicator's record of
 * these functions.
 *
 * MPI counts in int. A message of more bytes than SNOW_MPI_CHUNK is one element
 * of a datatype made for it, of whole chunks and a rest; its signature is still
 * that number of bytes, so that the receiver's type, made for its buffer,
 * matches it.
 *
 * Requests are stored in a table; a message's handle is its index there, from
 * 1. */
#include "mpi/messages.h"

#include <stdint.h>
#include <string.h>

#ifndef SNOW_MPI_CHUNK
#define SNOW_MPI_CHUNK ((size_t)1 << 30)
#endif

snow_status snow_mpi_fail(snow_context *context, int error, const char *what,
                          int peer) {
    char text[MPI_MAX_ERROR_STRING + 1] = "";
    int length = 0, kind = MPI_ERR_OTHER;
    MPI_Error_class(error, &kind);
    MPI_Error_string(error, text, &length);
    for (char *at = text; *at; at++)
        if (*at == '\n')
            *at = ' ';
    if (kind == MPI_ERR_TRUNCATE)
        return snow_context_fail(context, SNOW_STATUS_FAILED,
                                 "a message from rank %d exceeds its buffer: "
                                 "all ranks must make the same calls",
                                 peer);
    if (peer < 0)
        return snow_context_fail(context, SNOW_STATUS_FAILED,
                                 "MPI cannot %s: %s", what, text);
    return snow_context_fail(
        context, SNOW_STATUS_FAILED,
        "MPI cannot %s rank %d: %s; check whether all processes are running",
        what, peer, text);
}

static snow_status fail_side(mpi_side *side, int error, const char *what,
                             int peer) {
    side->failed = true;
    return snow_mpi_fail(side->context, error, what, peer);
}

/* --- memory --------------------------------------------------------------- */

static snow_status spare_slot(mpi_side *side, int *out) {
    for (int i = 0; i < side->slot_count; i++)
        if (side->slots[i].request == MPI_REQUEST_NULL) {
            *out = i;
            return SNOW_STATUS_OK;
        }
    int count = side->slot_count * 2 + 8;
    snow_status status = snow_context_reserve(
        side->context, &side->slots, (uint64_t)side->slot_count,
        (uint64_t)count, sizeof *side->slots);
    if (status != SNOW_STATUS_OK)
        return status;
    for (int i = side->slot_count; i < count; i++)
        side->slots[i].request = MPI_REQUEST_NULL;
    *out = side->slot_count;
    side->slot_count = count;
    return SNOW_STATUS_OK;
}

/* Reserves memory for the requests of a wait. */
static snow_status make_room(mpi_side *side, int count) {
    const uint64_t some = (uint64_t)count;
    snow_status status = snow_context_reserve(side->context, &side->requests, 0,
                                              some, sizeof *side->requests);
    if (status == SNOW_STATUS_OK)
        status = snow_context_reserve(side->context, &side->places, 0, some,
                                      sizeof *side->places);
    if (status == SNOW_STATUS_OK)
        status = snow_context_reserve(side->context, &side->peers, 0, some,
                                      sizeof *side->peers);
    return status;
}

/* --- messages ------------------------------------------------------------- */

/* A type of `bytes` bytes, more than a chunk; the caller frees it. */
static int large_type(size_t bytes, MPI_Datatype *out) {
    MPI_Datatype chunk, parts[2];
    size_t chunks = bytes / SNOW_MPI_CHUNK, rest = bytes % SNOW_MPI_CHUNK;
    int lengths[2] = {(int)chunks, (int)rest};
    MPI_Aint places[2] = {0, (MPI_Aint)(bytes - rest)};
    int error = MPI_Type_contiguous((int)SNOW_MPI_CHUNK, MPI_BYTE, &chunk);
    if (error != MPI_SUCCESS)
        return error;
    parts[0] = chunk;
    parts[1] = MPI_BYTE;
    error = MPI_Type_create_struct(rest ? 2 : 1, lengths, places, parts, out);
    MPI_Type_free(&chunk);
    if (error == MPI_SUCCESS)
        error = MPI_Type_commit(out);
    return error;
}

/* Starts a send or a receive. */
static snow_status begin_message(mpi_side *side, bool receives, void *bytes,
                                 size_t count, int peer, int tag,
                                 snow_message *message) {
    int place, error;
    snow_status status = spare_slot(side, &place);
    if (status != SNOW_STATUS_OK)
        return status;
    mpi_slot *slot = &side->slots[place];
    slot->receives = receives;
    slot->peer = peer;
    slot->large = count > SNOW_MPI_CHUNK;
    if (!receives)
        snow_mpi_node_sync(side->node);
    MPI_Datatype type = MPI_BYTE;
    const int items = slot->large ? 1 : (int)count;
    error = slot->large ? large_type(count, &type) : MPI_SUCCESS;
    if (error == MPI_SUCCESS) {
        error = receives ? MPI_Irecv(bytes, items, type, peer, tag, side->group,
                                     &slot->request)
                         : MPI_Isend(bytes, items, type, peer, tag, side->group,
                                     &slot->request);
        if (slot->large)
            MPI_Type_free(&type); /* waits until it is not needed */
    }
    if (error != MPI_SUCCESS) {
        slot->request = MPI_REQUEST_NULL;
        return fail_side(side, error, receives ? "receive from" : "send to",
                         peer);
    }
    message->handle = (void *)(uintptr_t)(place + 1);
    message->bytes = receives ? 0 : count;
    return SNOW_STATUS_OK;
}

static snow_status send_bytes(void *self, const void *bytes, size_t count,
                              int to, int tag, snow_message *message) {
    void *unchanged; /* old MPI headers have no const here */
    memcpy(&unchanged, &bytes, sizeof unchanged);
    return begin_message(self, false, unchanged, count, to, tag, message);
}

static snow_status receive_bytes(void *self, void *bytes, size_t capacity,
                                 int from, int tag, snow_message *message) {
    return begin_message(self, true, bytes, capacity, from, tag, message);
}

static mpi_slot *slot_of(const mpi_side *side, const snow_message *message) {
    return &side->slots[(uintptr_t)message->handle - 1];
}

/* Collects the requests of the messages in flight; returns their number. */
static int collect_requests(mpi_side *side, const snow_message *messages,
                            int count) {
    int asked = 0;
    for (int i = 0; i < count; i++)
        if (messages[i].handle) {
            const mpi_slot *slot = slot_of(side, &messages[i]);
            side->requests[asked] = slot->request;
            side->peers[asked] = slot->peer;
            side->places[asked++] = i;
        }
    return asked;
}

/* Completes a message: its slot is spare, its length known. */
static void complete_message(mpi_side *side, snow_message *message,
                             const MPI_Status *status) {
    mpi_slot *slot = slot_of(side, message);
    MPI_Count bytes = 0; /* which may exceed an int */
    if (slot->receives) {
        MPI_Get_elements_x(status, MPI_BYTE, &bytes);
        message->bytes = (size_t)bytes;
    }
    slot->request = MPI_REQUEST_NULL;
    message->handle = NULL;
    snow_mpi_node_sync(side->node);
}

/* Waits for one of the first `asked` requests, and sets *found if MPI reports
 * it; *error is its error. Errors: of the watchdog. */
static snow_status await(mpi_side *side, int asked, int *found,
                         MPI_Status *done, int *error) {
    *found = -1;
    bool busy = side->meanwhile != NULL; /* while there is work */
    int ended = 0;
    MPI_Finalized(&ended);
    if (ended)
        return snow_context_fail(side->context, SNOW_STATUS_FAILED,
                                 "MPI has ended: free frames before");
    snow_status status = snow_watchdog_begin(side->watchdog);
    while (status == SNOW_STATUS_OK) {
        int there = 0;
        *error = MPI_Testany(asked, side->requests, found, &there, done);
        if (*error != MPI_SUCCESS || there)
            return SNOW_STATUS_OK;
        busy = busy && side->meanwhile(side->meanwhile_user);
        status = snow_watchdog_turn(side->watchdog, side->peers, asked);
    }
    side->failed = true;
    return status;
}

static snow_status wait_any(void *self, snow_message *messages, int count,
                            int *which) {
    mpi_side *side = self;
    snow_status status = make_room(side, count);
    if (status != SNOW_STATUS_OK)
        return status;
    int asked = collect_requests(side, messages, count), found, error;
    if (!asked) {
        *which = -1;
        return SNOW_STATUS_OK;
    }
    MPI_Status done;
    status = await(side, asked, &found, &done, &error);
    if (status != SNOW_STATUS_OK)
        return status;
    if (error != MPI_SUCCESS) {
        bool known = found >= 0 && found < asked;
        return fail_side(
            side, error, known ? "exchange messages with" : "exchange messages",
            known ? slot_of(side, &messages[side->places[found]])->peer : -1);
    }
    *which = side->places[found];
    complete_message(side, &messages[*which], &done);
    return SNOW_STATUS_OK;
}

/* One after another: all must complete anyway, and MPI then reports which
 * failed. */
static snow_status wait_all(void *self, snow_message *messages, int count) {
    mpi_side *side = self;
    snow_status status = make_room(side, 1);
    for (int i = 0; i < count && status == SNOW_STATUS_OK; i++) {
        if (!messages[i].handle)
            continue;
        MPI_Status done;
        int found, error;
        collect_requests(side, &messages[i], 1);
        status = await(side, 1, &found, &done, &error);
        if (status != SNOW_STATUS_OK)
            return status;
        if (error != MPI_SUCCESS)
            return fail_side(side, error, "exchange messages with",
                             side->peers[0]);
        complete_message(side, &messages[i], &done);
    }
    return status;
}

static double seconds(void *self) {
    (void)self;
    return MPI_Wtime();
}

static void occupy(void *self, snow_idle_fn *meanwhile, void *user) {
    mpi_side *side = self;
    side->meanwhile = meanwhile;
    side->meanwhile_user = user;
}

/* Any test of a message lets all messages progress. */
static void progress(void *self) {
    mpi_side *side = self;
    int there = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, side->group, &there,
               MPI_STATUS_IGNORE);
}

static void limit_waits(void *self, double length) {
    mpi_side *side = self;
    snow_watchdog_limit(side->watchdog, length);
}

/* Cancels messages that were not waited for: nothing may arrive in a buffer
 * that the caller is about to free. */
static void give_up(mpi_slot *slot) {
    if (slot->request == MPI_REQUEST_NULL)
        return;
    if (!slot->receives) {
        MPI_Request_free(&slot->request);
        return;
    }
    MPI_Cancel(&slot->request);
    MPI_Wait(&slot->request, MPI_STATUS_IGNORE);
}

/* A group that has failed is left alone: freeing it is collective, peers may
 * have ended, and the state of its requests is unknown. */
static void end(void *self) {
    mpi_side *side = self;
    int finalized = 0;
    MPI_Finalized(&finalized);
    if (!finalized && !side->failed) {
        for (int i = 0; i < side->slot_count; i++)
            give_up(&side->slots[i]);
        snow_mpi_node_free(side->node, true);
        side->node = NULL;
        MPI_Comm_free(&side->group);
    }
    snow_mpi_node_free(side->node, false);
    snow_watchdog_free(side->watchdog, !finalized && !side->failed);
    snow_context_release(side->context, side->slots);
    snow_context_release(side->context, side->requests);
    snow_context_release(side->context, side->places);
    snow_context_release(side->context, side->peers);
    snow_context_release(side->context, side);
}

const snow_comm_ops snow_mpi_ops = {.size = sizeof(snow_comm_ops),
                                    .send = send_bytes,
                                    .receive = receive_bytes,
                                    .wait_any = wait_any,
                                    .wait_all = wait_all,
                                    .seconds = seconds,
                                    .timeout = limit_waits,
                                    .occupy = occupy,
                                    .progress = progress,
                                    .node_of = snow_mpi_node_of,
                                    .share = snow_mpi_share,
                                    .shared = snow_mpi_shared,
                                    .unshare = snow_mpi_unshare,
                                    .end = end};
