/* tests/base/test_affinity.c - helpers that wake after a rest are kept off the
 * processor of whom they help until they are awake, and off no other; where
 * there are no more processors than helpers, they have all. */
#define _GNU_SOURCE /* pthread_setaffinity_np, RTLD_NEXT */
#include "support/support.h"

#include "base/affinity.h"
#include "base/thread_pool.h"

#include <dlfcn.h>
#include <sched.h>
#include <unistd.h>

/* The processors of this process, and two of them. */
static cpu_set_t all;
static int here = -1, there = -1;

static int look_around(void **state) {
    (void)state;
    if (sched_getaffinity(0, sizeof all, &all))
        return 0;
    for (int n = 0; n < CPU_SETSIZE; n++)
        if (CPU_ISSET((size_t)n, &all)) {
            here = there;
            there = n;
        }
    return 0;
}

static void want_two(void) {
    if (here < 0)
        skip();
}

static cpu_set_t only(int processor) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET((size_t)processor, &set);
    return set;
}

static cpu_set_t all_but(int processor) {
    cpu_set_t set = all;
    CPU_CLR((size_t)processor, &set);
    return set;
}

static void go_to(cpu_set_t set) {
    assert_int_equal(pthread_setaffinity_np(pthread_self(), sizeof set, &set),
                     0);
}

static void assert_on(pthread_t thread, cpu_set_t expected) {
    cpu_set_t set;
    assert_int_equal(pthread_getaffinity_np(thread, sizeof set, &set), 0);
    assert_true(CPU_EQUAL(&set, &expected));
}

/* What others are told, in place of the system's function. */
static atomic_int given;

int pthread_setaffinity_np(pthread_t thread, size_t bytes,
                           const cpu_set_t *set) {
    int (*real)(pthread_t, size_t, const cpu_set_t *);
    void *found = dlsym(RTLD_NEXT, "pthread_setaffinity_np");
    memcpy(&real, &found, sizeof real);
    if (!pthread_equal(thread, pthread_self()))
        atomic_fetch_add(&given, 1);
    return real(thread, bytes, set);
}

/* --- a sleeper ------------------------------------------------------------ */

static pthread_mutex_t until = PTHREAD_MUTEX_INITIALIZER;
static pthread_t sleeper;
static bool is_asleep;

static void *sleep_until(void *argument) {
    pthread_mutex_lock(&until);
    pthread_mutex_unlock(&until);
    return argument;
}

static void fall_asleep(void) {
    pthread_mutex_lock(&until);
    is_asleep = true;
    assert_int_equal(pthread_create(&sleeper, NULL, sleep_until, NULL), 0);
}

/* After each test, also one that failed. */
static int clean_up(void **state) {
    (void)state;
    if (is_asleep) {
        pthread_mutex_unlock(&until);
        pthread_join(sleeper, NULL);
    }
    is_asleep = false;
    return pthread_setaffinity_np(pthread_self(), sizeof all, &all);
}

static void a_helper_is_kept_off_the_processor_of_its_caller(void **state) {
    (void)state;
    want_two();
    fall_asleep();
    snow_affinity apart = {0};
    assert_true(snow_affinity_begin(&apart));
    go_to(only(here));
    assert_true(snow_affinity_keep(&apart, sleeper, 1));
    assert_on(sleeper, all_but(here));
    /* It sleeps on while its caller has gone elsewhere. */
    go_to(only(there));
    assert_true(snow_affinity_keep(&apart, sleeper, 1));
    assert_on(sleeper, all_but(there));
}

static void a_helper_that_is_awake_runs_where_its_caller_may(void **state) {
    (void)state;
    want_two();
    snow_affinity apart = {0};
    assert_true(snow_affinity_begin(&apart));
    go_to(only(here));
    assert_true(snow_affinity_release(&apart));
    assert_on(pthread_self(), all);
}

static void helpers_that_are_too_many_are_left_alone(void **state) {
    (void)state;
    want_two();
    fall_asleep();
    snow_affinity apart = {0};
    assert_true(snow_affinity_begin(&apart));
    assert_false(snow_affinity_keep(&apart, sleeper, CPU_COUNT(&all)));
    assert_on(sleeper, all);
}

static void the_only_processor_is_shared(void **state) {
    (void)state;
    want_two();
    go_to(only(here));
    fall_asleep();
    snow_affinity apart = {0};
    assert_true(snow_affinity_begin(&apart));
    assert_false(snow_affinity_keep(&apart, sleeper, 1));
    assert_on(sleeper, only(here));
}

/* --- when ----------------------------------------------------------------- */

/* Times are far apart, for this machine may be busy. */
static void a_rest_is_a_time_without_work(void **state) {
    (void)state;
    const double now = snow_seconds(), cpu = snow_cpu_seconds();
    snow_affinity never = {0}, rested = {.ended = now - 100, .ended_cpu = cpu};
    snow_affinity worked = {.ended = now - 100, .ended_cpu = cpu - 100};
    snow_affinity called = {.ended = now + 100, .ended_cpu = cpu};
    assert_true(snow_affinity_begin(&never));
    assert_true(snow_affinity_begin(&rested));
    assert_false(snow_affinity_begin(&worked));
    assert_false(snow_affinity_begin(&called));
    /* The pauses between the parts of a picture come soon after a rest. */
    called.until = now + 100;
    assert_true(snow_affinity_begin(&called));
    snow_affinity_end(&called);
    assert_true(called.ended >= now && called.ended < now + 100);
    assert_true(called.ended_cpu >= cpu);
}

/* --- the pool ------------------------------------------------------------- */

typedef struct meeting {
    atomic_int present;
    cpu_set_t helper;
} meeting;

/* Each of two items waits for the other: both workers have one. */
static void meet(void *job, int64_t item, int worker) {
    meeting *m = job;
    (void)item;
    if (worker == 1)
        sched_getaffinity(0, sizeof m->helper, &m->helper);
    atomic_fetch_add(&m->present, 1);
    for (int n = 0; n < 10000 && atomic_load(&m->present) < 2; n++)
        usleep(1000);
}

static void threads_of_a_pool_are_kept_apart_and_work_anywhere(void **state) {
    (void)state;
    want_two();
    snow_context *context = support_context();
    for (int n = 0; n < 6; n++) {
        meeting m = {0};
        atomic_store(&given, 0);
        assert_int_equal(snow_parallel(context, 2, 2, meet, &m),
                         SNOW_STATUS_OK);
        assert_int_equal(atomic_load(&m.present), 2);
        assert_true(CPU_EQUAL(&m.helper, &all));
        if (n > 0) /* the first time it may not have slept yet */
            assert_int_equal(atomic_load(&given), 1);
        usleep(100000); /* for the helper to fall asleep: a rest */
    }
    snow_context_free(context);
}

#define TEST(function) cmocka_unit_test_teardown(function, clean_up)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(a_helper_is_kept_off_the_processor_of_its_caller),
        TEST(a_helper_that_is_awake_runs_where_its_caller_may),
        TEST(helpers_that_are_too_many_are_left_alone),
        TEST(the_only_processor_is_shared),
        TEST(a_rest_is_a_time_without_work),
        TEST(threads_of_a_pool_are_kept_apart_and_work_anywhere),
    };
    return cmocka_run_group_tests(tests, look_around, NULL);
}
