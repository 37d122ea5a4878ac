/* tests/base/test_pool_signals.c - threads of the library take no signals that
 * are sent to the process, but those of their own faults. */
#define _GNU_SOURCE /* usleep */
#include "support/support.h"

#include "base/thread_pool.h"

#include <signal.h>
#include <unistd.h>

typedef struct meeting {
    atomic_int present;
    sigset_t blocked[2]; /* of each worker */
} meeting;

/* Each of two items waits for the other: both workers have one. */
static void meet(void *job, int64_t item, int worker) {
    meeting *m = job;
    (void)item;
    pthread_sigmask(SIG_BLOCK, NULL, &m->blocked[worker]);
    atomic_fetch_add(&m->present, 1);
    for (int n = 0; n < 10000 && atomic_load(&m->present) < 2; n++)
        usleep(1000);
}

static void signals_are_for_the_program_s_own_threads(void **state) {
    (void)state;
    static const int sent[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGUSR1},
                     own[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    snow_context *context = support_context();
    meeting m = {0};
    assert_int_equal(snow_parallel(context, 2, 2, meet, &m), SNOW_STATUS_OK);
    assert_int_equal(atomic_load(&m.present), 2);
    for (size_t i = 0; i < sizeof sent / sizeof *sent; i++) {
        assert_int_equal(sigismember(&m.blocked[1], sent[i]), 1);
        assert_int_equal(sigismember(&m.blocked[0], sent[i]), 0);
    }
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        assert_int_equal(sigismember(&m.blocked[1], own[i]), 0);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signals_are_for_the_program_s_own_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
