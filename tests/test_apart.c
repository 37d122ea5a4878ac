/* tests/test_apart.c - helpers that wake after a rest keep off the processor of
 * whom they help until they are awake, and off no other; where there is one
 * processor only, they have it. */
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
    pthread_t sleeper = asleep();
    go_to(only(here));
    int avoided = snow_apart_keep(sleeper, 1, SNOW_APART_NONE);
    assert_int_equal(avoided, here);
    assert_on(sleeper, all_but(here));
    /* It sleeps on while its caller has gone elsewhere. */
    go_to(only(there));
    assert_int_equal(snow_apart_keep(sleeper, 1, avoided), here);
    assert_on(sleeper, all_but(here));
    end(sleeper);
}

static void a_helper_that_is_awake_may_be_anywhere(void **state) {
    (void)state;
    want_two();
    go_to(all_but(here));
    snow_apart_release(SNOW_APART_NONE);
    assert_on(pthread_self(), all_but(here));
    snow_apart_release(here);
    assert_on(pthread_self(), all);
    go_to(all);
}

static void helpers_that_are_too_many_are_left_alone(void **state) {
    (void)state;
    want_two();
    pthread_t sleeper = asleep();
    assert_int_equal(snow_apart_keep(sleeper, CPU_COUNT(&all), SNOW_APART_NONE),
                     SNOW_APART_NONE);
    assert_on(sleeper, all);
    end(sleeper);
}

static void the_only_processor_is_shared(void **state) {
    (void)state;
    want_two();
    go_to(only(here));
    pthread_t sleeper = asleep();
    assert_int_equal(snow_apart_keep(sleeper, 1, SNOW_APART_NONE),
                     SNOW_APART_NONE);
    assert_on(sleeper, only(here));
    end(sleeper);
}

/* --- when ----------------------------------------------------------------- */

static void a_rest_is_a_time_without_work(void **state) {
    (void)state;
    double now = snow_seconds(), cpu = snow_cpu_seconds();
    snow_apart never = {0}, rested = {now - 1, cpu, 0};
    snow_apart worked = {now - 1, cpu - 1, 0}, called = {now + 1, cpu, 0};
    assert_true(snow_apart_begin(&never));
    assert_true(snow_apart_begin(&rested));
    assert_false(snow_apart_begin(&worked));
    assert_false(snow_apart_begin(&called));
    /* The pauses between the parts of a picture come soon after a rest. */
    rested.until = now + 100;
    snow_apart_end(&rested);
    assert_true(snow_apart_begin(&rested));
    rested.until = now;
    assert_false(snow_apart_begin(&rested));
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

static void threads_of_a_pool_work_anywhere_after_a_rest(void **state) {
    (void)state;
    want_two();
    snow_context *context = support_context();
    for (int n = 0; n < 6; n++) {
        meeting m = {0};
        snow_parallel(context, 2, 2, meet, &m);
        assert_int_equal(atomic_load(&m.present), 2);
        assert_true(CPU_EQUAL(&m.helper, &all));
        usleep(n % 2 ? 5000 : 0);
    }
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_helper_keeps_off_the_processor_where_its_caller_is),
        cmocka_unit_test(a_helper_that_is_awake_may_be_anywhere),
        cmocka_unit_test(helpers_that_are_too_many_are_left_alone),
        cmocka_unit_test(the_only_processor_is_shared),
        cmocka_unit_test(a_rest_is_a_time_without_work),
        cmocka_unit_test(threads_of_a_pool_work_anywhere_after_a_rest),
    };
    return cmocka_run_group_tests(tests, look_around, NULL);
}
