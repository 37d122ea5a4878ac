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

/* Of 3840 x 2160 pixels packing takes twice as long as drawing, which alone
 * would have kept them. */
static void packing_counts(void **state) {
    (void)state;
    const double drawn = 0.02, packed = 0.04;
    draft_times times = {.count = 0};
    int shrink = 0;
    for (int i = 0; i < 40; i++)
        shrink = draft_follow(&times, shrink, 0,
                              seconds_at(drawn, drawn / 4, shrink) +
                                  seconds_at(packed, 0, shrink),
                              false);
    assert_int_equal(shrink, 1);
    assert_int_equal(draft_shrink(0, 0, drawn, false), 0);
}

/* Of a machine that does other work beside, by which every third draft or so
 * takes several times as long as it would alone. */
static void sizes_do_not_pulse_on_a_busy_machine(void **state) {
    (void)state;
    static const double factors[] = {1, 1, 6, 1, 4, 1, 1};
    draft_times times = {.count = 0};
    int shrink = 0, changes = 0, before = 0, pulses = 0;
    for (int i = 0; i < 37; i++) {
        const double busy = factors[i % 7];
        int next = draft_follow(&times, shrink, 0,
                                busy * seconds_at(0.014, 0.003, shrink), false);
        changes += next != shrink;
        shrink = next;
        next = draft_shrink(before, 0, busy * seconds_at(0.014, 0.003, before),
                            false);
        pulses += next != before;
        before = next;
    }
    assert_true(pulses > 8);
    assert_in_range(changes, 0, 2);
    /* One that takes very long is enough. */
    assert_int_equal(draft_follow(&times, 0, 0, 0.5, false), 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slow_draft_gets_half_the_side),
        cmocka_unit_test(a_quick_one_gets_it_back),
        cmocka_unit_test(one_that_encodes_does_not_count),
        cmocka_unit_test(pictures_at_rest_count_where_they_are_quick),
        cmocka_unit_test(sizes_do_not_alternate),
        cmocka_unit_test(packing_counts),
        cmocka_unit_test(sizes_do_not_pulse_on_a_busy_machine),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
