/* bench/combine/order.c - `snowglass bench order`: what a rank takes to put the
 * parts of all in order, before every picture from another side. */
#include "bench.h"

#include "decompose/order.h"

#include <stdio.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const int part_counts[] = {128, 1024, 4096, 100000};

/* An edge of the grid that is cut, in voxels. */
#define SIDE 100000

/* Boxes on their way. */
typedef struct boxes {
    snow_box *boxes;
    int count;
} boxes;

static void cut_slabs(boxes *to, int parts) {
    for (int n = 0; n < parts; n++)
        to->boxes[to->count++] = (snow_box){{0, 0, n}, {SIDE, SIDE, 1}};
}

/* The largest divisor that is not above a root. */
static int divisor_below(int number, int root) {
    int low = 1;
    for (int n = 1; n <= number; n++)
        if (number % n == 0 && (int64_t)n * n * (root == 3 ? n : 1) <= number)
            low = n;
    return low;
}

static void cut_grid(boxes *to, int parts) {
    const int x = divisor_below(parts, 3);
    const int y = divisor_below(parts / x, 2);
    const int64_t side = SIDE / (parts / x / y);
    for (int n = 0; n < parts; n++)
        to->boxes[to->count++] =
            (snow_box){{n % x * side, n / x % y * side, n / x / y * side},
                       {side, side, side}};
}

/* The longest axis of each box, so unevenly as costs are. */
static void cut_tree(boxes *to, snow_box box, int parts) {
    int axis = 0, low = parts / 2 - (parts > 16 ? parts % 5 : 0);
    if (parts == 1) {
        to->boxes[to->count++] = box;
        return;
    }
    for (int i = 1; i < 3; i++)
        axis = box.count[i] > box.count[axis] ? i : axis;
    snow_box high = box;
    box.count[axis] = box.count[axis] * low / parts;
    high.first[axis] += box.count[axis];
    high.count[axis] -= box.count[axis];
    cut_tree(to, box, low);
    cut_tree(to, high, parts - low);
}

static void cut_bricks(boxes *to, int parts) {
    const snow_box whole = {{0, 0, 0}, {SIDE, SIDE, SIDE}};
    cut_tree(to, whole, parts);
}

/* The same in another order, a tenth of them missing. */
static void cut_irregularly(boxes *to, int parts) {
    uint64_t seed = 1;
    cut_bricks(to, parts);
    for (int n = parts - 1; n > 0; n--) {
        seed = seed * UINT64_C(6364136223846793005) + 1442695040888963407U;
        const int other = (int)((seed >> 33) % (uint64_t)(n + 1));
        const snow_box box = to->boxes[n];
        to->boxes[n] = to->boxes[other];
        to->boxes[other] = box;
    }
    to->count -= parts / 10;
}

static const struct {
    const char *name;
    void (*cut)(boxes *to, int parts);
} cuts[] = {{"slabs", cut_slabs},
            {"grid", cut_grid},
            {"bricks", cut_bricks},
            {"irregular", cut_irregularly}};

/* Processor time of the thread, the least of all runs. */
static snow_status measure(snow_context *context, const boxes *of,
                           const bench_options *options, int *order,
                           double *seconds) {
    snow_viewer viewer = {.along = {0.3, -0.5, 0.8}};
    *seconds = 0;
    for (int run = 0; run < options->runs; run++) {
        const double begin = snow_thread_seconds();
        const snow_status status =
            snow_order_boxes(context, of->boxes, of->count, &viewer, order);
        const double took = snow_thread_seconds() - begin;
        if (status != SNOW_STATUS_OK)
            return status;
        *seconds = run && *seconds < took ? *seconds : took;
    }
    return SNOW_STATUS_OK;
}

static void print_row(const char *cut, int parts, double seconds,
                      json_t *list) {
    if (list)
        json_array_append_new(list,
                              json_pack("{s:s, s:i, s:f}", "cut", cut, "parts",
                                        parts, "cpu_ms", seconds * 1e3));
    else
        printf("%-10s %7d %9.3f\n", cut, parts, seconds * 1e3);
}

static snow_status do_all(snow_context *context, const bench_options *options,
                          boxes *room, int *order, json_t *list) {
    for (size_t cut = 0; cut < COUNT(cuts); cut++)
        for (size_t n = 0; n < COUNT(part_counts); n++) {
            double seconds;
            room->count = 0;
            cuts[cut].cut(room, part_counts[n]);
            const snow_status status =
                measure(context, room, options, order, &seconds);
            if (status != SNOW_STATUS_OK)
                return status;
            print_row(cuts[cut].name, room->count, seconds, list);
        }
    return SNOW_STATUS_OK;
}

int bench_order(snow_context *context, const bench_options *options) {
    const uint64_t most = (uint64_t)part_counts[COUNT(part_counts) - 1];
    boxes room = {snow_allocate_array(context, most, sizeof *room.boxes), 0};
    int *order = snow_allocate_array(context, most, sizeof *order);
    json_t *list = options->json ? json_array() : NULL;
    if (!list)
        printf("Order: ms of one processor to put the parts of a picture in "
               "order from front\nto back\n\ncut          parts    cpu_ms\n");
    snow_status status = room.boxes && order
                             ? do_all(context, options, &room, order, list)
                             : SNOW_STATUS_NO_MEMORY;
    snow_release(context, room.boxes);
    snow_release(context, order);
    if (status != SNOW_STATUS_OK) {
        json_decref(list);
        return bench_fail(context, status);
    }
    if (!list)
        return SNOW_STATUS_OK;
    return bench_print_json(json_pack("{s:s, s:s, s:o}", "bench", "order",
                                      "version", snow_version(), "rows", list));
}
