/* support_comm.h - what ranks do in tests of communicators: bodies that hold
 * with any transport and any number of ranks up to 33. */
#ifndef SUPPORT_COMM_H
#define SUPPORT_COMM_H

#include "support/support.h"

#include "comm/comm.h"

/* A body's assertion: it fails the rank, and with it the test. */
#define CHECK(condition)                                                  \
    do {                                                                  \
        if (!(condition))                                                 \
            return snow_fail(snow_comm_context(comm), SNOW_STATUS_FAILED, \
                             "line %d: %s", __LINE__, #condition);        \
    } while (0)

/* One number to or from a rank, waited for. */
snow_status send_number(snow_comm *comm, int64_t number, int to, int tag);
snow_status receive_number(snow_comm *comm, int64_t *number, int from, int tag);

/* Sleeps. */
void rest(long microseconds);

/* Bodies that succeed with any transport and any number of ranks; `user` is not
 * used.  The last has none. */
typedef struct comm_body {
    const char *name;
    snow_comm_body_fn *body;
} comm_body;
extern const comm_body comm_bodies[];

/* Two of them: every rank sends to every rank, itself included, before anybody
 * receives; and the last of many tags is received first, and of one tag in
 * order, also when the second receive is waited for before the first. */
snow_status send_all_to_all(snow_comm *comm, void *user);
snow_status mix_tags(snow_comm *comm, void *user);
snow_status wait_for_none(snow_comm *comm, void *user);

/* What was sent and asked for, and never met. */
snow_status leave_much_undone(snow_comm *comm, void *user);

/* A sum whose rounding depends on its order: all ranks have the same bits, and
 * each run has those of the last one. */
typedef struct rank_sums {
    double sums[33];
} rank_sums;

snow_status reduce_doubles(snow_comm *comm, void *user);

/* Ranks 2 and 3 fail; all hear of rank 2, and may go on together. */
snow_status agree_on_failure(snow_comm *comm, void *user);

#endif
