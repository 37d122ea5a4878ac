/* parallel/fit_object.c - see fit_object.h.
 *
 * The picture is not drawn for that.  Opacities are summed by blocks of voxels,
 * and these fall onto cells of a grid before the camera, where few of them make
 * the alpha of a pixel:
 *
 *   cells     . . . # # # # . . . + . .     # the object, + a speck: a group
 *                                             of cells that has hardly any of
 *                                             the cells, or of the opacities
 *
 * Sums are integers, so that neither threads nor ranks change the frame. */
#include "parallel/fit_object.h"
#include "base/vec3.h"
#include "comm/comm.h"

#include <math.h>
#include <string.h>

/* Blocks along the longest side. */
#define BLOCKS 48

/* A pixel of less alpha is not seen; for so little, alpha is the sum of
 * opacities. */
#define SEEN 0.02

/* A group with a smaller share of the cells, or of their opacities, is a speck,
 * unless specks have so much of all
 * together that they are what the picture shows. */
#define FEW_CELLS 1e-4
#define FEW_SUM 3e-5
#define SPECKS 0.05

/* Steps of an opacity, as far as the sum of a block has room. */
#define STEPS 65536.0

static double step_length(const snow_volume_info *info, int axis) {
    const double step[3] = {info->matrix[0][axis], info->matrix[1][axis],
                            info->matrix[2][axis]};
    return snow_length(step);
}

snow_status snow_fit_object_make(snow_context *context,
                                 const snow_volume_info *whole, double length,
                                 snow_fit_object *out) {
    double side = 0, voxels = 1;
    *out =
        (snow_fit_object){.context = context, .whole = whole, .length = length};
    for (int i = 0; i < 3; i++)
        side = fmax(side, step_length(whole, i) * (double)whole->dims[i]);
    int64_t all = 1;
    for (int i = 0; i < 3; i++) {
        const double fit = ceil(side / BLOCKS / step_length(whole, i) - 1e-6);
        out->block[i] = fit < 1                        ? 1
                        : fit < (double)whole->dims[i] ? (int64_t)fit
                                                       : whole->dims[i];
        out->blocks[i] = (whole->dims[i] - 1) / out->block[i] + 1;
        voxels *= (double)out->block[i];
        all *= out->blocks[i];
    }
    out->unit = fmin(STEPS, (double)UINT32_MAX / voxels - 1);
    SNOW_TRY(SNOW_RESERVE(context, out->sums, 0, all));
    SNOW_TRY(SNOW_RESERVE(context, out->kept, 0, all));
    for (int64_t n = 0; n < all; n++)
        atomic_init(&out->sums[n], 0);
    memset(out->kept, 0, (size_t)all);
    return SNOW_STATUS_OK;
}

void snow_fit_object_free(snow_fit_object *object) {
    snow_release(object->context, object->sums);
    snow_release(object->context, object->kept);
}

/* The first of a row's blocks. */
static int64_t blocks_of(const snow_fit_object *o,
                         const snow_interesting_row *row) {
    return (row->z / o->block[2] * o->blocks[1] + row->y / o->block[1]) *
           o->blocks[0];
}

void snow_fit_object_add(snow_fit_object *o, const snow_interesting_row *row) {
    atomic_uint_least32_t *sums = o->sums + blocks_of(o, row);
    const float unit = (float)o->unit;
    uint32_t sum = 0;
    int64_t block = 0, end = 0;
    for (size_t n = 0; n < row->count; n++) {
        const int64_t x = row->stored + row->columns[n];
        if (x >= end) {
            atomic_fetch_add_explicit(&sums[block], sum, memory_order_relaxed);
            sum = 0;
            block = x / o->block[0];
            end = (block + 1) * o->block[0];
        }
        sum += (uint32_t)(row->opacities[n * row->stride] * unit + 0.5F);
    }
    atomic_fetch_add_explicit(&sums[block], sum, memory_order_relaxed);
}

/* --- before a camera ------------------------------------------------------ */

enum { NO_CELL, SEEN_CELL, SPECK_CELL, OBJECT_CELL };

/* A grid of cells; blocks side by side lie in the same or in adjacent ones. */
typedef struct grid {
    const snow_camera *camera;
    double side;    /* of a cell in the world, at the target */
    double half[2]; /* of the grid, in cells */
    int64_t width, height;
    int64_t *sums, *stack; /* of cells, the outermost of which are empty */
    unsigned char *marks;
    unsigned char least;           /* mark of a cell that is kept */
    double specks;                 /* the sum of all of them */
    double block[3][3], corner[3]; /* world: steps of blocks, the first one */
} grid;

static double block_length(const snow_fit_object *o, int axis) {
    return step_length(o->whole, axis) * (double)o->block[axis];
}

/* How much nearer things are enlarged. */
static double enlarged(const snow_camera *c, double back) {
    return c->distance > 0 ? c->distance / (c->distance - back) : 1;
}

static void place_grid(const snow_fit_object *o, const snow_camera *camera,
                       grid *g) {
    const snow_volume_info *whole = o->whole;
    const double *axes[3] = {camera->right, camera->up, camera->back};
    double reach[3] = {0};
    *g = (grid){.camera = camera};
    for (int axis = 0; axis < 3; axis++) {
        if (o->blocks[axis] > 1)
            g->side = fmax(g->side, block_length(o, axis));
        for (int i = 0; i < 3; i++) {
            const double step = whole->matrix[i][axis];
            g->block[axis][i] = step * (double)o->block[axis];
            g->corner[i] +=
                step * (double)(o->block[axis] - whole->dims[axis]) / 2;
        }
    }
    /* Of the blocks' middles. */
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            if (o->blocks[axis] > 1)
                reach[i] += fabs(snow_dot(g->block[axis], axes[i])) *
                            (double)(o->blocks[axis] + 1) / 2;
    const double nearer = enlarged(camera, fmin(camera->middle[2] + reach[2],
                                                camera->distance * (1 - 1e-6)));
    g->side *= nearer;
    if (!(g->side > 0))
        g->side = block_length(o, 0);
    for (int i = 0; i < 2; i++)
        g->half[i] =
            ceil((fabs(camera->middle[i]) + reach[i]) * nearer / g->side) + 2;
    g->width = 2 * (int64_t)g->half[0];
    g->height = 2 * (int64_t)g->half[1];
}

/* The cell of a block's middle. */
static int64_t cell_of(const grid *g, int64_t x, int64_t y, int64_t z) {
    const snow_camera *c = g->camera;
    double from_middle[3];
    for (int i = 0; i < 3; i++)
        from_middle[i] = g->corner[i] + (double)x * g->block[0][i] +
                         (double)y * g->block[1][i] +
                         (double)z * g->block[2][i];
    const double scale =
        enlarged(c, c->middle[2] + snow_dot(from_middle, c->back)) / g->side;
    const double right = c->middle[0] + snow_dot(from_middle, c->right),
                 up = c->middle[1] + snow_dot(from_middle, c->up);
    return (int64_t)(g->half[1] + up * scale) * g->width +
           (int64_t)(g->half[0] + right * scale);
}

typedef void block_fn(snow_fit_object *o, grid *g, int64_t block, int64_t cell);

static void visit_blocks(snow_fit_object *o, grid *g, block_fn *visit) {
    int64_t n = 0;
    for (int64_t z = 0; z < o->blocks[2]; z++)
        for (int64_t y = 0; y < o->blocks[1]; y++)
            for (int64_t x = 0; x < o->blocks[0]; x++, n++)
                if (atomic_load_explicit(&o->sums[n], memory_order_relaxed))
                    visit(o, g, n, cell_of(g, x, y, z));
}

static void add_block(snow_fit_object *o, grid *g, int64_t block,
                      int64_t cell) {
    g->sums[cell] +=
        atomic_load_explicit(&o->sums[block], memory_order_relaxed);
}

static void keep_block(snow_fit_object *o, grid *g, int64_t block,
                       int64_t cell) {
    o->kept[block] |= g->marks[cell] >= g->least;
}

/* The sum of a cell that is just seen. */
static double seen_sum(const snow_fit_object *o, const grid *g) {
    double cross[3], area = g->side * g->side;
    snow_cross(g->block[0], g->block[1], cross);
    const double block = fabs(snow_dot(cross, g->block[2]));
    const double voxel = block / ((double)o->block[0] * (double)o->block[1] *
                                  (double)o->block[2]);
    return SEEN * o->unit * o->length * area / voxel;
}

/* Cells and opacities. */
typedef struct group {
    int64_t cells;
    double sum;
} group;

/* Of the cells that are connected with one, at a side or a corner, and have its
 * mark, which becomes another.  The outermost cells have none. */
static group mark_group(grid *g, int64_t cell, unsigned char mark) {
    const unsigned char before = g->marks[cell];
    group found = {0, 0};
    int64_t waiting = 1;
    g->stack[0] = cell;
    g->marks[cell] = mark;
    while (waiting) {
        const int64_t at = g->stack[--waiting];
        found.cells++;
        found.sum += (double)g->sums[at];
        for (int n = 0; n < 9; n++) {
            const int64_t next = at + (n / 3 - 1) * g->width + n % 3 - 1;
            if (g->marks[next] != before)
                continue;
            g->marks[next] = mark;
            g->stack[waiting++] = next;
        }
    }
    return found;
}

/* Marks cells of what is seen and of specks. */
static void mark_cells(const snow_fit_object *o, grid *g) {
    const int64_t cells = g->width * g->height;
    const double least = seen_sum(o, g);
    group all = {0, 0};
    for (int64_t n = 0; n < cells; n++)
        if ((double)g->sums[n] > least) {
            g->marks[n] = SEEN_CELL;
            all.cells++;
            all.sum += (double)g->sums[n];
        }
    for (int64_t n = 0; n < cells; n++) {
        if (g->marks[n] != SEEN_CELL)
            continue;
        const group found = mark_group(g, n, OBJECT_CELL);
        if ((double)found.cells < FEW_CELLS * (double)all.cells ||
            found.sum < FEW_SUM * all.sum) {
            mark_group(g, n, SPECK_CELL);
            g->specks += found.sum;
        }
    }
    g->least = all.cells == 0                 ? NO_CELL
               : g->specks > SPECKS * all.sum ? SPECK_CELL
                                              : OBJECT_CELL;
}

static snow_status see_blocks(snow_fit_object *o, snow_comm *comm, grid *g) {
    const int64_t cells = g->width * g->height;
    snow_context *context = o->context;
    snow_status status = SNOW_RESERVE(context, g->sums, 0, cells);
    if (status == SNOW_STATUS_OK)
        status = SNOW_RESERVE(context, g->stack, 0, cells);
    if (status == SNOW_STATUS_OK)
        status = SNOW_RESERVE(context, g->marks, 0, cells);
    if (comm)
        status = snow_comm_agree_status(comm, status);
    SNOW_TRY(status);
    memset(g->sums, 0, (size_t)cells * sizeof *g->sums);
    memset(g->marks, NO_CELL, (size_t)cells);
    visit_blocks(o, g, add_block);
    if (comm)
        SNOW_TRY(snow_comm_reduce_ints(comm, g->sums, (size_t)cells,
                                       SNOW_REDUCE_SUM));
    mark_cells(o, g);
    visit_blocks(o, g, keep_block);
    return SNOW_STATUS_OK;
}

snow_status snow_fit_object_see(snow_fit_object *object, snow_comm *comm,
                                const snow_camera *camera) {
    grid g;
    place_grid(object, camera, &g);
    snow_status status = see_blocks(object, comm, &g);
    snow_release(object->context, g.sums);
    snow_release(object->context, g.stack);
    snow_release(object->context, g.marks);
    return status;
}

bool snow_fit_object_trim(const snow_fit_object *o,
                          const snow_interesting_row *row, size_t *first,
                          size_t *last) {
    const unsigned char *kept = o->kept + blocks_of(o, row);
    size_t from = 0, end = row->count;
    while (from < end &&
           !kept[(row->stored + row->columns[from]) / o->block[0]])
        from++;
    while (end > from &&
           !kept[(row->stored + row->columns[end - 1]) / o->block[0]])
        end--;
    *first = from;
    *last = end - 1;
    return from < end;
}
