/* tests/stages/test_order.c - the order of boxes from front to back against
 * that of all pairs: grids, slabs, k-d trees in the order of their leaves and
 * in any other, bricks that no plane divides, with holes and without, from all
 * sides and from within. */
#include "support/support.h"

#include "decompose/order.h"

#include <snowglass/extend.h>
#include <stdlib.h>
#include <string.h>

#define MOST 512
#define SIDE 60

typedef struct parts {
    snow_box boxes[MOST];
    int count;
} parts;

/* --- all pairs ------------------------------------------------------------ */

/* Of two boxes that an axis separates: 1, rays that meet both meet `low` first,
 * -1, `high` first, 0, no ray meets both. */
static int first_along(const snow_viewer *viewer, int axis, double low_end,
                       double high_first) {
    if (!viewer->perspective)
        return (viewer->along[axis] > 0) - (viewer->along[axis] < 0);
    if (viewer->eye[axis] <= low_end)
        return 1;
    return viewer->eye[axis] >= high_first ? -1 : 0;
}

/* Whether a box must come before another one: a ray may meet both, and all
 * axes that separate them say so. */
static bool must_precede(const snow_box *a, const snow_box *b,
                         const snow_viewer *viewer) {
    bool found = false;
    if (!snow_box_voxels(a) || !snow_box_voxels(b))
        return false;
    for (int axis = 0; axis < 3; axis++) {
        const double a_first = (double)a->first[axis] - 0.5;
        const double b_first = (double)b->first[axis] - 0.5;
        const double a_end = a_first + (double)a->count[axis];
        const double b_end = b_first + (double)b->count[axis];
        if (a_end > b_first && b_end > a_first)
            continue;
        if (a_end <= b_first && first_along(viewer, axis, a_end, b_first) != 1)
            return false;
        if (b_end <= a_first && first_along(viewer, axis, b_end, a_first) != -1)
            return false;
        found = true;
    }
    return found;
}

static void check_order(const parts *p, const snow_viewer *viewer,
                        const int *order) {
    bool seen[MOST] = {false};
    for (int n = 0; n < p->count; n++) {
        assert_in_range(order[n], 0, p->count - 1);
        assert_false(seen[order[n]]);
        seen[order[n]] = true;
    }
    for (int n = 1; n < p->count; n++)
        assert_true(snow_box_voxels(&p->boxes[order[n - 1]]) ||
                    !snow_box_voxels(&p->boxes[order[n]]));
    for (int n = 0; n < p->count; n++)
        for (int later = n + 1; later < p->count; later++)
            assert_false(must_precede(&p->boxes[order[later]],
                                      &p->boxes[order[n]], viewer));
}

/* Whether there is an order at all, by taking boxes that nothing precedes. */
static bool have_order(const parts *p, const snow_viewer *viewer) {
    bool taken[MOST] = {false};
    for (int left = p->count, before = left + 1; left && left < before;) {
        before = left;
        for (int n = 0; n < p->count; n++) {
            bool free = !taken[n];
            for (int other = 0; other < p->count && free; other++)
                free = taken[other] || other == n ||
                       !must_precede(&p->boxes[other], &p->boxes[n], viewer);
            taken[n] = taken[n] || free;
            left -= free;
        }
        if (!left)
            return true;
    }
    return !p->count;
}

/* --- viewers -------------------------------------------------------------- */

#define VIEWS 40

/* Along each axis, obliquely, and from eyes outside, between and within the
 * boxes, on their borders too. */
static snow_viewer viewer_of(int view, uint64_t *seed) {
    snow_viewer viewer = {.perspective = view % 2};
    for (int axis = 0; axis < 3; axis++) {
        const double at = support_uniform(seed);
        viewer.along[axis] = view % 3 && view % 5 == axis ? 0 : at * 2 - 1;
        viewer.eye[axis] = view % 4 == 1 ? at * 300 - 120 : at * SIDE;
        if (view % 7 == 0)
            viewer.eye[axis] = (double)(int)viewer.eye[axis];
    }
    if (view < 12)
        for (int axis = 0; axis < 3; axis++)
            viewer.along[axis] = axis == view / 4 ? (view % 4 < 2 ? 1 : -1) : 0;
    return viewer;
}

static void shuffle(parts *p, uint64_t *seed) {
    for (int n = p->count - 1; n > 0; n--) {
        const int other = (int)(support_uniform(seed) * (n + 1));
        const snow_box box = p->boxes[n];
        p->boxes[n] = p->boxes[other];
        p->boxes[other] = box;
    }
}

/* All views of boxes: an order that is one, or an error where there is none;
 * returns in how many there is none. */
static int check_views(const parts *p) {
    snow_context *context = support_context();
    uint64_t seed = 5;
    int refused = 0, order[MOST];
    for (int view = 0; view < VIEWS; view++) {
        const snow_viewer viewer = viewer_of(view, &seed);
        const snow_status status =
            snow_order_boxes(context, p->boxes, p->count, &viewer, order);
        assert_int_equal(status == SNOW_STATUS_OK, have_order(p, &viewer));
        if (status == SNOW_STATUS_OK)
            check_order(p, &viewer, order);
        else
            assert_non_null(strstr(snow_context_message(context), "cycle"));
        refused += status != SNOW_STATUS_OK;
    }
    snow_context_free(context);
    return refused;
}

/* As they are, mixed, and with holes; then again mixed. */
static void check_all(parts *p, uint64_t *seed) {
    assert_int_equal(check_views(p), 0);
    shuffle(p, seed);
    assert_int_equal(check_views(p), 0);
    for (int n = 0; n < p->count; n += 3)
        p->boxes[n].count[n % 3] = 0;
    assert_int_equal(check_views(p), 0);
}

/* --- boxes ---------------------------------------------------------------- */

static void add_grid(parts *p, const int cells[3]) {
    p->count = 0;
    for (int n = 0; n < cells[0] * cells[1] * cells[2]; n++) {
        const int at[3] = {n % cells[0], n / cells[0] % cells[1],
                           n / cells[0] / cells[1]};
        snow_box *box = &p->boxes[p->count++];
        for (int axis = 0; axis < 3; axis++) {
            box->first[axis] = SIDE * at[axis] / cells[axis];
            box->count[axis] =
                SIDE * (at[axis] + 1) / cells[axis] - box->first[axis];
        }
    }
}

/* A random k-d tree, the lower side first. */
static void add_tree(parts *p, snow_box box, int leaves, uint64_t *seed) {
    const int axis = (int)(support_uniform(seed) * 3);
    if (leaves == 1 || box.count[axis] < 2) {
        p->boxes[p->count++] = box;
        return;
    }
    const int below = 1 + (int)(support_uniform(seed) * (leaves - 1));
    snow_box low = box, high = box;
    low.count[axis] =
        1 + (int64_t)(support_uniform(seed) * (double)(box.count[axis] - 1));
    high.first[axis] += low.count[axis];
    high.count[axis] -= low.count[axis];
    add_tree(p, low, below, seed);
    add_tree(p, high, leaves - below, seed);
}

/* Five bricks around a middle one, which no plane divides, and each again. */
static void add_wheel(parts *p, snow_box box, int levels) {
    const int64_t w = box.count[0], h = box.count[1], a = (w + 2) / 3,
                  b = (h + 2) / 3;
    const int64_t bricks[5][4] = {{0, 0, w - a, b},
                                  {w - a, 0, a, h - b},
                                  {a, h - b, w - a, b},
                                  {0, b, a, h - b},
                                  {a, b, w - 2 * a, h - 2 * b}};
    if (!levels || w < 3 || h < 3) {
        p->boxes[p->count++] = box;
        return;
    }
    for (int n = 0; n < 5; n++) {
        snow_box brick = box;
        for (int axis = 0; axis < 2; axis++) {
            brick.first[axis] += bricks[n][axis];
            brick.count[axis] = bricks[n][2 + axis];
        }
        if (snow_box_voxels(&brick))
            add_wheel(p, brick, levels - 1);
    }
}

/* --- tests ---------------------------------------------------------------- */

static const snow_box whole = {{0, 0, 0}, {SIDE, SIDE, SIDE}};

static void slabs_and_grids_have_an_order(void **state) {
    (void)state;
    static const int cells[][3] = {{1, 1, 1},  {37, 1, 1}, {1, 60, 1},
                                   {1, 1, 7},  {5, 1, 9},  {3, 4, 5},
                                   {1, 11, 3}, {6, 6, 6}};
    uint64_t seed = 3;
    parts p;
    for (size_t n = 0; n < sizeof cells / sizeof *cells; n++) {
        add_grid(&p, cells[n]);
        check_all(&p, &seed);
    }
}

static void trees_have_an_order(void **state) {
    (void)state;
    uint64_t seed = 4;
    parts p;
    for (int leaves = 1; leaves < 200; leaves += 1 + leaves / 2) {
        p.count = 0;
        add_tree(&p, whole, leaves, &seed);
        check_all(&p, &seed);
    }
}

static void bricks_that_no_plane_divides_have_an_order(void **state) {
    (void)state;
    uint64_t seed = 6;
    parts p = {.count = 0};
    for (int layer = 0; layer < 4; layer++) {
        snow_box box = whole;
        box.first[2] = 15 * layer;
        box.count[2] = 15;
        add_wheel(&p, box, 2);
    }
    check_all(&p, &seed);
    /* along another axis, each of its own length: from few sides there may be
     * a cycle */
    p.count = 0;
    add_wheel(&p, whole, 3);
    for (int n = 0; n < p.count; n++) {
        snow_box *box = &p.boxes[n];
        const int64_t first = box->first[0], count = box->count[0];
        box->first[0] = box->first[2] + n % 7;
        box->count[0] = 9 + n % 5;
        box->first[2] = first;
        box->count[2] = count;
    }
    assert_in_range(check_views(&p), 0, VIEWS / 8);
}

/* Three bars around each corner of a lattice occlude each other in a cycle,
 * from some sides; one fewer, and they do not. */
static void cycles_are_found(void **state) {
    (void)state;
    static const snow_box ring[] = {
        {{0, 0, 2}, {4, 2, 2}}, {{2, 0, 0}, {2, 4, 2}}, {{0, 2, 0}, {2, 2, 4}}};
    parts p;
    int refused = 0;
    for (int bars = 3; bars <= 3 * 27; bars += 39) {
        for (p.count = 0; p.count < bars; p.count++) {
            const int corner = p.count / 3;
            p.boxes[p.count] = ring[p.count % 3];
            p.boxes[p.count].first[0] += 20 * (corner % 3);
            p.boxes[p.count].first[1] += 20 * (corner / 3 % 3);
            p.boxes[p.count].first[2] += 20 * (corner / 9);
        }
        refused += check_views(&p);
    }
    assert_in_range(refused, 6, 3 * VIEWS - 6);
    p.count = 2;
    assert_int_equal(check_views(&p), 0);
}

static void boxes_that_overlap_are_refused(void **state) {
    (void)state;
    snow_context *context = support_context();
    uint64_t seed = 8;
    parts p;
    int order[MOST];
    for (int view = 0; view < VIEWS; view++) {
        const snow_viewer viewer = viewer_of(view, &seed);
        const int cells[3] = {4, 5, 3};
        add_grid(&p, cells);
        p.boxes[view].count[view % 3]++;
        p.boxes[view].first[view % 3] -= view % 2;
        const snow_box box = p.boxes[view];
        bool overlaps = false;
        for (int n = 0; n < p.count; n++) {
            snow_box shared;
            overlaps =
                overlaps ||
                (n != view && snow_box_intersect(&p.boxes[n], &box, &shared));
        }
        assert_int_equal(
            snow_order_boxes(context, p.boxes, p.count, &viewer, order),
            overlaps ? SNOW_STATUS_BAD_USAGE : SNOW_STATUS_OK);
        if (overlaps)
            assert_non_null(strstr(snow_context_message(context), "overlap"));
    }
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slabs_and_grids_have_an_order),
        cmocka_unit_test(trees_have_an_order),
        cmocka_unit_test(bricks_that_no_plane_divides_have_an_order),
        cmocka_unit_test(cycles_are_found),
        cmocka_unit_test(boxes_that_overlap_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
