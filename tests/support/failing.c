/* tests/support/failing.c - the allocator of support_failing.h. */
#include "support/failing.h"

static bool fails(const support_failing *f, long number, size_t bytes) {
    if (f->largest && bytes > f->largest)
        return true;
    if (f->failing < 0 || number < f->failing)
        return false;
    return f->for_good || number == f->failing;
}

static void *allocate_or_fail(void *user, size_t bytes) {
    support_failing *f = user;
    if (fails(f, f->allocations++, bytes))
        return NULL;
    if (++f->held > f->most_held)
        f->most_held = f->held;
    return malloc(bytes);
}

static void release_counted(void *user, void *block) {
    ((support_failing *)user)->held--;
    free(block);
}

snow_allocator support_failing_allocator(support_failing *failing) {
    return (snow_allocator){allocate_or_fail, release_counted, failing};
}
