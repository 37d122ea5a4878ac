/* tests/test_apart.c - helpers keep off the processor of whom they help, and
 * off no other; where there is one processor only, they have it. */
#define _GNU_SOURCE /* pthread_setaffinity_np */
#include "support.h"

#include "base/apart.h"
#include "base/parallel.h"

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

/* --- a sleeper ------------------------------------------------------------ */

static pthread_mutex_t until = PTHREAD_MUTEX_INITIALIZER;

static void *sleep_until(void *argument) {
    pthread_mutex_lock(&until);
    pthread_mutex_unlock(&until);
    return argument;
}

static pthread_t asleep(void) {
    pthread_t sleeper;
    pthread_mutex_lock(&until);
    assert_int_equal(pthread_create(&sleeper, NULL, sleep_until, NULL), 0);
    return sleeper;
}

static void end(pthread_t sleeper) {
    pthread_mutex_unlock(&until);
    pthread_join(sleeper, NULL);
    go_to(all);
}

static void a_helper_keeps_off_the_processor_where_its_caller_is(void **state) {
    (void)state;
    want_two();
    int avoided = SNOW_APART_NONE;
    pthread_t sleeper = asleep();
    go_to(only(here));
    for (int n = 0; n < 2; n++) {
        snow_apart(sleeper, 1, &avoided);
        assert_int_equal(avoided, here);
        assert_on(sleeper, all_but(here));
    }
    go_to(only(there));
    snow_apart(sleeper, 1, &avoided);
    assert_int_equal(avoided, there);
    assert_on(sleeper, all_but(there));
    end(sleeper);
}

static void helpers_that_are_too_many_are_left_alone(void **state) {
    (void)state;
    want_two();
    int avoided = SNOW_APART_NONE;
    pthread_t sleeper = asleep();
    snow_apart(sleeper, CPU_COUNT(&all), &avoided);
    assert_int_equal(avoided, SNOW_APART_NONE);
    assert_on(sleeper, all);
    end(sleeper);
}

static void the_only_processor_is_shared(void **state) {
    (void)state;
    want_two();
    int avoided = SNOW_APART_NONE;
    go_to(only(here));
    pthread_t sleeper = asleep();
    snow_apart(sleeper, 1, &avoided);
    assert_int_equal(avoided, SNOW_APART_NONE);
    assert_on(sleeper, only(here));
    end(sleeper);
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

static void threads_of_a_pool_are_woken_apart(void **state) {
    (void)state;
    want_two();
    snow_context *context = support_context();
    for (int n = 0; n < 4; n++) {
        meeting m = {0};
        int mine = n % 2 ? there : here;
        go_to(only(mine));
        /* The pool's thread has the processors of whom makes it. */
        if (n == 0)
            go_to(all);
        snow_parallel(context, 2, 2, meet, &m);
        cpu_set_t expected = all_but(mine);
        assert_int_equal(atomic_load(&m.present), 2);
        assert_int_equal(CPU_COUNT(&m.helper), CPU_COUNT(&all) - 1);
        if (n > 0)
            assert_true(CPU_EQUAL(&m.helper, &expected));
    }
    go_to(all);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_helper_keeps_off_the_processor_where_its_caller_is),
        cmocka_unit_test(helpers_that_are_too_many_are_left_alone),
        cmocka_unit_test(the_only_processor_is_shared),
        cmocka_unit_test(threads_of_a_pool_are_woken_apart),
    };
    return cmocka_run_group_tests(tests, look_around, NULL);
}
