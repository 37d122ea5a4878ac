/* parallel/shares.c - see shares.h. */
#include "parallel/shares.h"

#include "decompose/slab.h"
#include <stddef.h>
#include <string.h>

static int slabs_of(const int64_t dims[3], int ranks) {
    return ranks < dims[2] ? ranks : (int)dims[2];
}

/* Of each slab. */
static int parts_of(const int64_t dims[3], int ranks) {
    const int parts = ranks / slabs_of(dims, ranks);
    return parts < dims[1] ? parts : (int)dims[1];
}

int snow_share_readers(const int64_t dims[3], int ranks) {
    return slabs_of(dims, ranks) * parts_of(dims, ranks);
}

snow_box snow_share_of(const int64_t dims[3], int rank, int ranks) {
    snow_box box = {{0, 0, 0}, {dims[0], 0, 0}};
    const int slabs = slabs_of(dims, ranks);
    const int parts = parts_of(dims, ranks);
    snow_slab z = {0, 0}, y = {0, 0};
    if (rank < slabs * parts) {
        z = snow_slab_equal(dims[2], slabs, rank / parts);
        y = snow_slab_equal(dims[1], parts, rank % parts);
    }
    box.first[1] = y.first;
    box.count[1] = y.count;
    box.first[2] = z.first;
    box.count[2] = z.count;
    return box;
}

snow_status snow_share_agree(snow_comm *comm, bool here, bool *all) {
    int64_t word = here;
    SNOW_TRY(snow_comm_reduce_ints(comm, &word, 1, SNOW_REDUCE_MIN));
    *all = word != 0;
    return SNOW_STATUS_OK;
}

/* --- one after another ---------------------------------------------------- */

/* What is handed on is the beginning of a relay. */
#define HANDED_BYTES offsetof(snow_relay, seen)

/* From the rank before. */
static snow_status take_relay(snow_comm *comm, snow_relay *relay) {
    const int rank = snow_comm_rank(comm);
    snow_message message = {0};
    if (rank == 0)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_comm_receive(comm, relay, HANDED_BYTES, rank - 1,
                               SNOW_TAG_VOXELS, &message));
    return snow_comm_wait_all(comm, &message, 1);
}

static snow_status hand_on(snow_comm *comm, const snow_relay *relay,
                           int readers) {
    const int rank = snow_comm_rank(comm);
    snow_message message = {0};
    if (rank + 1 >= readers)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_comm_send(comm, relay, HANDED_BYTES, rank + 1,
                            SNOW_TAG_VOXELS, &message));
    return snow_comm_wait_all(comm, &message, 1);
}

/* With the relay; the last one looks at what lies behind the data. */
static snow_status read_with(snow_comm *comm, snow_relay *relay, int readers,
                             snow_share_fn *read, void *user) {
    relay->last = snow_comm_rank(comm) == readers - 1;
    return relay->failed ? SNOW_STATUS_OK : read(user, relay);
}

/* Where the file was not entered by those before, nobody waits for the other.
 */
static snow_status read_share(snow_comm *comm, snow_relay *relay, int readers,
                              snow_share_fn *read, void *user) {
    const int rank = snow_comm_rank(comm);
    if (rank >= readers)
        return read(user, NULL);
    SNOW_TRY(take_relay(comm, relay));
    const bool waits = rank == 0 || relay->skips;
    if (!waits)
        SNOW_TRY(hand_on(comm, relay, readers));
    const snow_status status = read_with(comm, relay, readers, read, user);
    if (!waits)
        return status;
    relay->skips = relay->skips && relay->from.unpacked;
    relay->failed = relay->failed || status != SNOW_STATUS_OK;
    SNOW_TRY(hand_on(comm, relay, readers));
    return status;
}

/* Collective.  The first rank says what the last one has noticed. */
static snow_status remark(snow_comm *comm, const snow_relay *relay,
                          const char *path) {
    int64_t words[2] = {relay->foreign, (int64_t)relay->left};
    SNOW_TRY(snow_comm_reduce_ints(comm, words, 2, SNOW_REDUCE_MAX));
    if (snow_comm_rank(comm) == 0)
        snow_relay_remark(snow_comm_context(comm), path, words[0] != 0,
                          (uint64_t)words[1]);
    return SNOW_STATUS_OK;
}

snow_status snow_shares_in_turn(snow_comm *comm, int readers, const char *path,
                                snow_share_fn *read, void *user) {
    snow_context *context = snow_comm_context(comm);
    snow_relay *relay = snow_allocate_clear(context, sizeof *relay);
    snow_status status = snow_comm_agree_status(
        comm, relay ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY);
    if (status == SNOW_STATUS_OK) {
        status = read_share(comm, relay, readers, read, user);
        if (comm->broken == SNOW_STATUS_OK)
            (void)remark(comm, relay, path);
    }
    snow_release(context, relay);
    return status;
}

snow_status snow_share_is_packed(snow_context *context, snow_share_fn *read,
                                 void *user, bool *packed) {
    snow_relay *relay = snow_allocate_clear(context, sizeof *relay);
    if (!relay)
        return SNOW_STATUS_NO_MEMORY;
    const snow_status status = read(user, relay);
    *packed = relay->source != 0;
    snow_release(context, relay);
    return status;
}
