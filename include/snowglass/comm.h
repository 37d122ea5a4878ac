/* snowglass/comm.h - processors that work on one picture together.
 *
 * A communicator is a fixed group of processors, numbered from 0 (its ranks),
 * that send each other messages.  Three makers: a group of one
 * (snow_comm_new_self), threads of this process (snow_comm_run_threads), and
 * MPI (snowglass/mpi.h, in a library of its own); anybody may add a transport
 * by filling in snow_comm_ops.  Rank 0 is the paper's display processor.
 *
 * Collective calls, marked so, are made by all ranks of a communicator in the
 * same order.  What fails on one rank fails on all: they agree on the status,
 * and every rank's context has the message, which names the rank. */
#ifndef SNOWGLASS_COMM_H
#define SNOWGLASS_COMM_H

#include <snowglass/context.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct snow_comm snow_comm;

/* A message under way.  `handle` belongs to the transport: NULL once the
 * message is done; `bytes` of a received one is then its length. */
typedef struct snow_message {
    void *handle;
    size_t bytes;
} snow_message;

/* Work that has nothing to do with messages, done piece by piece: does one, or
 * returns false where none is left. */
typedef bool snow_idle_fn(void *user);

/* What a transport does.  Its functions are called by the thread that the
 * communicator belongs to.  Those that return a status leave their reason with
 * snow_context_fail, or none, and after a failure none is called but `end`: the
 * communicator is broken (snow_comm_broken). */
typedef struct snow_comm_ops {
    size_t size;
    /* Starts a message of 0 or more bytes, which stay as they are until a wait
     * says that it is done: at once, or when its receiver has asked for it.
     * Two ranks that send to each other start both messages, then wait.
     * Messages of one tag (0 to 32767) between two ranks arrive in order.  A
     * rank may send to itself. */
    snow_status (*send)(void *self, const void *bytes, size_t count, int to,
                        int tag, snow_message *message);
    /* Gets ready for one of at most `room` bytes; a longer one is a failure. */
    snow_status (*receive)(void *self, void *bytes, size_t room, int from,
                           int tag, snow_message *message);
    /* Waits until one of the messages that are still under way is done, and
     * tells which; -1 when none is under way. */
    snow_status (*wait_any)(void *self, snow_message *messages, int count,
                            int *which);
    /* Waits for all. */
    snow_status (*wait_all)(void *self, snow_message *messages, int count);
    /* Wall time in seconds, of whatever clock messages take time on. */
    double (*seconds)(void *self);
    /* Lets so much simulated time pass; NULL where time is real. */
    void (*work)(void *self, double seconds);
    /* From now on waits do pieces of `work` as long as there is one and none of
     * their messages is done; NULL: no more.  A transport without this function
     * waits idly. */
    void (*occupy)(void *self, snow_idle_fn *work, void *user);
    /* Lets messages under way move on, without waiting for any: called now and
     * then by who works while some are.  NULL where they move by themselves. */
    void (*progress)(void *self);
    /* The longest that a wait may last in which nobody who is waited for
     * answers, after which it fails; 0: for ever.  NULL where ranks cannot
     * stop alone. */
    void (*timeout)(void *self, double seconds);
    /* Frees self. */
    void (*end)(void *self);
} snow_comm_ops;
SNOW_RECORD(snow_comm_ops);

/* A communicator over a transport.  `ops` is copied; `self` is handed to its
 * functions, and ended with the communicator.  Errors, where self is not ended:
 * SNOW_STATUS_BAD_USAGE (a record of another size, a rank that is none of
 * `ranks`), SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_comm_new(snow_context *context,
                                   const snow_comm_ops *ops, void *self,
                                   int rank, int ranks, snow_comm **out);

/* A group of one.  Errors: SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_comm_new_self(snow_context *context, snow_comm **out);

/* Runs `body` on `ranks` threads, each with a communicator and a context of its
 * own, and returns when all have ended: with SNOW_STATUS_OK, or the status and
 * (in `context`) the message of the lowest rank that failed of itself.  The
 * ranks' memory comes from `context`, which counts it; its listener hears rank
 * 0. Communicators and contexts end with the call: a body frees what it made
 * with them, but not them.  A body that returns releases all who wait for it,
 * and where all ranks wait for one another all are released: their calls fail.
 * Errors also: SNOW_STATUS_BAD_USAGE (ranks below 1), SNOW_STATUS_NO_MEMORY
 * (threads too). */
typedef snow_status snow_comm_body_fn(snow_comm *comm, void *user);
SNOW_API snow_status snow_comm_run_threads(snow_context *context, int ranks,
                                           snow_comm_body_fn *body, void *user);

/* Frees it, after the objects made with it (collective for transports that need
 * it); NULL is accepted. */
SNOW_API void snow_comm_free(snow_comm *comm);

SNOW_API int snow_comm_rank(const snow_comm *comm); /* from 0 */
SNOW_API int snow_comm_size(const snow_comm *comm); /* how many */
SNOW_API snow_context *snow_comm_context(const snow_comm *comm);

/* Collective.  What became of all ranks: SNOW_STATUS_OK only where all are OK.
 * Otherwise the status of the lowest rank that failed, and its message in every
 * context, with "rank N: " before it where there are several.  On a broken
 * communicator it fails at once. */
SNOW_API snow_status snow_comm_agree_status(snow_comm *comm,
                                            snow_status status);

/* Collective.  `count` bytes of rank `root` to all; of every rank to all, `all`
 * having room for ranks * count bytes, in order of rank.  Errors: those of the
 * transport. */
SNOW_API snow_status snow_comm_broadcast(snow_comm *comm, void *bytes,
                                         size_t count, int root);
SNOW_API snow_status snow_comm_allgather(snow_comm *comm, const void *mine,
                                         size_t count, void *all);

/* Whether the transport itself has failed on this rank (a peer is gone, say).
 * All further calls on the communicator fail with the same status, and the
 * other ranks may not know: a program of several processes ends them all, and
 * frees nothing before that a late message may come into (frames, movies). */
SNOW_API bool snow_comm_broken(const snow_comm *comm);

/* Alike on all ranks: the longest that a rank is waited for that neither sends
 * nor waits itself, in seconds; 0, as it is at first: for ever.  Beyond it the
 * wait fails and names that rank, and the communicator is broken.  A rank at
 * work for longer is taken for one that hangs, so be generous: all that one
 * rank may do while others wait, reading and writing of files too, must be
 * shorter.  Between threads nothing is watched: they stop together. */
SNOW_API void snow_comm_set_timeout(snow_comm *comm, double seconds);

/* The time that messages of this communicator take time on, in seconds from
 * any beginning: wall time, but where time is modelled. */
SNOW_API double snow_comm_seconds(snow_comm *comm);

/* Messages and bytes that this rank has sent so far. */
SNOW_API void snow_comm_sent(const snow_comm *comm, uint64_t *messages,
                             uint64_t *bytes);

#ifdef __cplusplus
}
#endif
#endif
