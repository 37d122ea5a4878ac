/* bench/metered_comm.c - a communicator over another one that counts the
 * processor time of its transport.
 *
 * A rank of MPI that waits asks again and again, which takes processor time
 * though nothing is done.  What a rank works is the rest. */
#include "metered_comm.h"

#include "comm/comm.h"

static double now(const bench_meter *meter) {
    struct timespec time;
    clock_gettime(meter->clock, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static snow_status count(bench_meter *meter, double start, snow_status status) {
    meter->inside += now(meter) - start;
    return status;
}

static snow_status send(void *self, const void *bytes, size_t size, int to,
                        int tag, snow_message *message) {
    bench_meter *m = self;
    const double start = now(m);
    return count(m, start,
                 snow_comm_send(m->inner, bytes, size, to, tag, message));
}

static snow_status receive(void *self, void *bytes, size_t room, int from,
                           int tag, snow_message *message) {
    bench_meter *m = self;
    const double start = now(m);
    return count(m, start,
                 snow_comm_receive(m->inner, bytes, room, from, tag, message));
}

static snow_status wait_any(void *self, snow_message *messages, int many,
                            int *which) {
    bench_meter *m = self;
    const double start = now(m);
    return count(m, start, snow_comm_wait_any(m->inner, messages, many, which));
}

static snow_status wait_all(void *self, snow_message *messages, int many) {
    bench_meter *m = self;
    const double start = now(m);
    return count(m, start, snow_comm_wait_all(m->inner, messages, many));
}

static double seconds(void *self) {
    return snow_comm_seconds(((bench_meter *)self)->inner);
}

static void work(void *self, double seconds) {
    snow_comm_work(((bench_meter *)self)->inner, seconds);
}

/* A piece of other work in a wait. */
static bool do_idle(void *self) {
    bench_meter *m = self;
    const double start = now(m);
    bool more = m->idle(m->user);
    m->inside -= now(m) - start;
    return more;
}

static void occupy(void *self, snow_idle_fn *idle, void *user) {
    bench_meter *m = self;
    m->idle = idle;
    m->user = user;
    snow_comm_occupy(m->inner, idle ? do_idle : NULL, m);
}

static void progress(void *self) {
    bench_meter *m = self;
    const double start = now(m);
    snow_comm_progress(m->inner);
    count(m, start, SNOW_STATUS_OK);
}

static void timeout(void *self, double seconds) {
    snow_comm_set_timeout(((bench_meter *)self)->inner, seconds);
}

static int node_of(void *self, int rank) {
    const snow_comm *inner = ((bench_meter *)self)->inner;
    return inner->ops.node_of ? inner->ops.node_of(inner->self, rank) : rank;
}

static snow_status share(void *self, size_t bytes, void **own) {
    bench_meter *m = self;
    const snow_comm *inner = m->inner;
    *own = NULL;
    if (!inner->ops.share)
        return SNOW_STATUS_OK;
    const double start = now(m);
    return count(m, start, inner->ops.share(inner->self, bytes, own));
}

static const void *shared(void *self, int rank) {
    const snow_comm *inner = ((bench_meter *)self)->inner;
    return inner->ops.shared(inner->self, rank);
}

static void rest_shared(void *self) {
    const snow_comm *inner = ((bench_meter *)self)->inner;
    if (inner->ops.unshare)
        inner->ops.unshare(inner->self);
}

static void end(void *self) {
    (void)self;
}

snow_status bench_meter_new(bench_meter *meter, snow_comm **out) {
    static const snow_comm_ops ops = {.size = sizeof ops,
                                      .send = send,
                                      .receive = receive,
                                      .wait_any = wait_any,
                                      .wait_all = wait_all,
                                      .seconds = seconds,
                                      .work = work,
                                      .occupy = occupy,
                                      .progress = progress,
                                      .timeout = timeout,
                                      .end = end,
                                      .node_of = node_of,
                                      .share = share,
                                      .shared = shared,
                                      .unshare = rest_shared};
    return snow_comm_new(snow_comm_context(meter->inner), &ops, meter,
                         snow_comm_rank(meter->inner),
                         snow_comm_size(meter->inner), out);
}
