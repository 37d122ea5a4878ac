/* tests/serve/test_draft.c - how small drafts are. */
#include "support/support.h"

#include "draw/draft.h"

/* Seconds of a draft at full size -> those at a shrink: at least a quarter for
 * a quarter of the pixels. */
static double seconds_at(double full, double fixed, int shrink) {
    return fixed + (full - fixed) / (double)(1 << (2 * shrink));
}

static void a_slow_draft_gets_half_the_side(void **state) {
    (void)state;
    assert_int_equal(draft_shrink(0, 0, 0.041, false), 1);
    assert_int_equal(draft_shrink(1, 0, 0.041, false), 2);
    assert_int_equal(draft_shrink(2, 0, 9, false), 3);
    assert_int_equal(draft_shrink(3, 0, 9, false), 3);
}

static void a_quick_one_gets_it_back(void **state) {
    (void)state;
    assert_int_equal(draft_shrink(3, 0, 0.008, false), 2);
    assert_int_equal(draft_shrink(1, 0, 0.001, false), 0);
    assert_int_equal(draft_shrink(0, 0, 0.001, false), 0);
    for (int shrink = 0; shrink <= 3; shrink++) {
        assert_int_equal(draft_shrink(shrink, 0, 0.010, false), shrink);
        assert_int_equal(draft_shrink(shrink, 0, 0.039, false), shrink);
    }
}

static void one_that_encodes_does_not_count(void **state) {
    (void)state;
    assert_int_equal(draft_shrink(1, 0, 9, true), 1);
    assert_int_equal(draft_shrink(1, 0, 0.001, true), 1);
}

static void pictures_at_rest_count_where_they_are_quick(void **state) {
    (void)state;
    assert_int_equal(draft_shrink(3, 1, 0.039, false), 0);
    assert_int_equal(draft_shrink(3, 1, 0.039, true), 0);
    assert_int_equal(draft_shrink(2, 1, 0.041, false), 2);
    assert_int_equal(draft_shrink(2, 2, 9, false), 2);
    assert_int_equal(draft_shrink(2, 2, 0.001, false), 2);
}

/* Whatever a volume takes, the size comes to rest. */
static void sizes_do_not_alternate(void **state) {
    (void)state;
    for (double full = 0.001; full < 10; full *= 1.1)
        for (double part = 0; part < 1; part += 0.1) {
            int shrink = 0, changes = 0;
            for (int i = 0; i < 20; i++) {
                double took = seconds_at(full, part * full, shrink);
                int next = draft_shrink(shrink, 0, took, false);
                changes += next != shrink;
                shrink = next;
            }
            assert_in_range(changes, 0, DRAFT_SHRINK_MOST);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slow_draft_gets_half_the_side),
        cmocka_unit_test(a_quick_one_gets_it_back),
        cmocka_unit_test(one_that_encodes_does_not_count),
        cmocka_unit_test(pictures_at_rest_count_where_they_are_quick),
        cmocka_unit_test(sizes_do_not_alternate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
