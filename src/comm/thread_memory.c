/* comm/thread_memory.c - blocks of ranks that are threads, in a table under the
 * lock of their mailboxes. */
#include "comm/thread_memory.h"

/* All ranks are on one node. */
int snow_thread_memory_node(void *self, int rank) {
    (void)self;
    (void)rank;
    return 0;
}

static void set_block(const snow_thread_memory *own, void *block) {
    pthread_mutex_lock(own->lock);
    void *old = own->blocks[own->rank];
    own->blocks[own->rank] = block;
    pthread_mutex_unlock(own->lock);
    snow_release(own->owner, old);
}

/* The rank's own context counts what is used of it (shared.c). */
snow_status snow_thread_memory_share(void *self, size_t bytes, void **out) {
    const snow_thread_memory *own = self;
    set_block(own, NULL);
    *out = snow_allocate(own->owner, bytes);
    set_block(own, *out);
    return *out ? SNOW_STATUS_OK
                : snow_fail(own->context, SNOW_STATUS_NO_MEMORY,
                            "out of memory: %zu bytes more are needed for "
                            "messages; use fewer ranks or a smaller picture",
                            bytes);
}

const void *snow_thread_memory_shared(void *self, int rank) {
    const snow_thread_memory *own = self;
    pthread_mutex_lock(own->lock);
    const void *there = own->blocks[rank];
    pthread_mutex_unlock(own->lock);
    return there;
}

void snow_thread_memory_unshare(void *self) {
    (void)self;
}

void snow_thread_memory_end(void *self) {
    set_block(self, NULL);
}
