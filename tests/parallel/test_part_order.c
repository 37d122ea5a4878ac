/* test_part_order - the order of parts is kept from picture to picture while
 * view and parts stay, and found anew when one of them changes. */
#include "support/support.h"

#include "parallel/internal.h"

#define PARTS 3
#define MARK (-7)

/* Slabs along z, seen from the front of the first. */
typedef struct scene {
    snow_context *context;
    snow_box boxes[PARTS];
    int order[PARTS];
    snow_ranks ranks;
    snow_placement placement;
} scene;

static void put_in_order(scene *s) {
    assert_int_equal(snow_ranks_put_in_order(&s->ranks, &s->placement),
                     SNOW_STATUS_OK);
}

static int begin(void **state) {
    static scene s;
    s = (scene){.context = support_context(),
                .placement = {.u_axis = 0,
                              .v_axis = 1,
                              .slice_axis = 2,
                              .nearest_first = true}};
    for (int n = 0; n < PARTS; n++)
        s.boxes[n] = (snow_box){.first = {0, 0, 4 * n}, .count = {9, 9, 4}};
    s.ranks = (snow_ranks){.context = s.context,
                           .ranks = PARTS,
                           .boxes = s.boxes,
                           .order = s.order,
                           .generation = 1};
    *state = &s;
    return 0;
}

static int end(void **state) {
    snow_context_free(((scene *)*state)->context);
    return 0;
}

static void assert_order(const scene *s, bool last_first) {
    for (int n = 0; n < PARTS; n++)
        assert_int_equal(s->order[n], last_first ? PARTS - 1 - n : n);
}

static void it_is_kept_while_view_and_parts_stay(void **state) {
    scene *s = *state;
    put_in_order(s);
    assert_order(s, false);
    s->order[1] = MARK;
    put_in_order(s);
    assert_int_equal(s->order[1], MARK);
}

static void another_view_finds_it_anew(void **state) {
    scene *s = *state;
    put_in_order(s);
    s->placement.nearest_first = false;
    put_in_order(s);
    assert_order(s, true);
    s->order[1] = MARK;
    s->placement.perspective = true;
    s->placement.eye.at[2] = -20;
    put_in_order(s);
    assert_order(s, false);
    s->placement.eye.at[2] = 40;
    put_in_order(s);
    assert_order(s, true);
}

static void other_parts_find_it_anew(void **state) {
    scene *s = *state;
    put_in_order(s);
    for (int n = 0; n < PARTS; n++)
        s->boxes[n].first[2] = 4 * (PARTS - 1 - n);
    s->ranks.generation++;
    put_in_order(s);
    assert_order(s, true);
}

static void a_failure_keeps_none(void **state) {
    scene *s = *state;
    put_in_order(s);
    s->boxes[1] = s->boxes[0];
    s->ranks.generation++;
    for (int n = 0; n < 2; n++)
        assert_int_equal(snow_ranks_put_in_order(&s->ranks, &s->placement),
                         SNOW_STATUS_BAD_USAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(it_is_kept_while_view_and_parts_stay,
                                        begin, end),
        cmocka_unit_test_setup_teardown(another_view_finds_it_anew, begin, end),
        cmocka_unit_test_setup_teardown(other_parts_find_it_anew, begin, end),
        cmocka_unit_test_setup_teardown(a_failure_keeps_none, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
