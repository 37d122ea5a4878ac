/* classify/shading/normals.c - gradients of interesting voxels as codes of 16
 * bits (model, point 4), made when a volume is encoded.
 *
 * A unit sphere's half z >= 0 is projected onto the octahedron |x|+|y|+|z| = 1
 * and that, seen from above and turned by 45 degrees, is the square
 *
 *   across = (x + y) / (|x|+|y|+|z|),  down = (x - y) / (|x|+|y|+|z|)
 *
 * from -1 to 1 (Cigolle et al., "A Survey of Efficient Representations for
 * Independent Unit Vectors", JCGT 2014, section 3).  Rounding to the nearest
 * place gives the nearest normal to a thousandth, because the two directions
 * stay at right angles in the middle of the faces, where places lie farthest
 * apart.
 *
 * Voxels are processed in blocks of neighbours, including those between that
 * are not needed: vectors make up for it. Where few are needed, or neighbours
 * are not contiguous in memory, their differences are collected one by one and
 * encoded as a block. Differences beyond single precision (huge, tiny and
 * infinite ones) and the two ends of a row are computed by snow_gradient_of. */
#include "classify/shading/normals.h"
#include "base/vec3.h"

#include <math.h>
#include <string.h>

/* Places along each side of the square, and the middle one. */
#define SIDE SNOW_NORMAL_SIDE
#define MIDDLE (SNOW_NORMAL_SIDE / 2)

#define UNSURE 65535 /* code of a block that must be computed exactly */
#define BLOCK 64     /* voxels */
#define GROUP 16     /* blocks are padded to multiples of this */
#define SPARSE 6     /* a row is sparse from this many columns per voxel on */

#define SUM_LEAST 1e-30F
#define SUM_MOST 1e30F
#define LEAST 1e-35F /* least difference that is not 0 */

typedef void differences_fn(const void *low, const void *high, size_t count,
                            float weight, float *out);

/* The loops of one instruction set, described in
 * classify/shading/normals.tmpl.h. */
typedef struct normal_kernels {
    differences_fn *differences[SNOW_TYPE_FLOAT64 + 1];
    void (*add)(const float *more, size_t count, float *out);
    bool (*encode)(const float carry[9], float gradients[3][BLOCK],
                   size_t count, uint32_t *codes);
} normal_kernels;

/* --- differences of two values as floats ---------------------------------- */

static inline float whole(int high, int low) {
    return (float)(high - low);
}

static inline float wide(double high, double low) {
    return (float)(high - low);
}

/* Single precision gives the direction of a gradient only where |x|+|y|+|z| is
 * between SUM_LEAST and SUM_MOST. A difference that is not 0 is raised so that
 * it cannot vanish on the way there. */
static inline float single(float high, float low) {
    float d = high - low, size = fabsf(d);
    float least = size > 0 ? LEAST : 0;
    return copysignf(size < least ? least : size, d);
}

/* The same for doubles; one that a float cannot hold, or that is not a number,
 * becomes infinite. */
static inline float twice(double high, double low) {
    double d = high - low, size = fabs(d);
    double bounded = size < 1e37 ? size : (double)INFINITY;
    double least = bounded > 0 ? (double)LEAST : 0;
    return (float)copysign(bounded < least ? least : bounded, d);
}

/* X(NAME, C type, type that is subtracted, subtraction) for each scalar type.
 */
#define SUBTRACTIONS(X)               \
    X(INT8, int8_t, int, whole)       \
    X(UINT8, uint8_t, int, whole)     \
    X(INT16, int16_t, int, whole)     \
    X(UINT16, uint16_t, int, whole)   \
    X(INT32, int32_t, double, wide)   \
    X(UINT32, uint32_t, double, wide) \
    X(INT64, int64_t, double, wide)   \
    X(UINT64, uint64_t, double, wide) \
    X(FLOAT32, float, float, single)  \
    X(FLOAT64, double, double, twice)

#define TEMPLATE "classify/shading/normals.tmpl.h"
#include "simd/each_isa.h"

static const normal_kernels *kernels_of(snow_isa isa) {
    return SNOW_OF_ISA(isa, &kernels);
}

/* --- one normal ----------------------------------------------------------- */

uint16_t snow_normal_code(const double direction[3]) {
    double x = direction[0], y = direction[1], z = direction[2];
    double scale = copysign(MIDDLE, z) / (fabs(x) + fabs(y) + fabs(z));
    int across = (int)((x + y) * scale + (MIDDLE + 0.5));
    int down = (int)((x - y) * scale + (MIDDLE + 0.5));
    return (uint16_t)(1 + down * SIDE + across);
}

void snow_normal_of(uint16_t code, double normal[3]) {
    int place = code > 0 && code <= SIDE * SIDE ? code - 1 : 0;
    double across = (double)(place % SIDE - MIDDLE) / MIDDLE;
    double down = (double)(place / SIDE - MIDDLE) / MIDDLE;
    normal[0] = (across + down) / 2;
    normal[1] = (across - down) / 2;
    normal[2] = 1 - fmax(fabs(across), fabs(down));
    snow_normalize(normal);
}

/* --- makers --------------------------------------------------------------- */

static double frobenius(double m[3][3]) {
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += snow_dot(m[i], m[i]);
    return sqrt(square);
}

snow_status snow_normal_maker_init(snow_context *context,
                                   const snow_volume *volume,
                                   snow_normal_maker *out) {
    snow_normal_maker maker = {.volume = volume,
                               .isa = snow_isa_resolve(SNOW_ISA_AUTO)};
    double inverse[3][3], largest = 0, most = 0, linear[3][3];
    if (!snow_matrix_invert3(volume->info.matrix, inverse))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "the volume's matrix is singular: it must be invertible for "
            "shading; correct the volume's orientation and spacing");
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            largest = fmax(largest, fabs(inverse[i][j]));
            most = fmax(most, fabs(volume->info.matrix[i][j]));
        }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            maker.carry[i][j] = inverse[j][i] / largest;
            linear[i][j] = volume->info.matrix[i][j] / most;
        }
    /* The condition of the matrix: how much rounding it magnifies. */
    double condition =
        frobenius(maker.carry) * frobenius(linear) * (largest * most);
    maker.skewed = !(condition < 1e4);
    *out = maker;
    return SNOW_STATUS_OK;
}

/* --- rows ----------------------------------------------------------------- */

/* A row of one slice: for each axis (u along the row, v across it, w across the
 * slices) the two voxels that are subtracted for a voxel, as byte offsets from
 * it, and the weight of that difference: 2 where a border halves the distance.
 */
typedef struct layer {
    const char *first; /* the row's first voxel */
    int64_t low[3], high[3];
    float weight[3];
} layer;

/* The input of a row's codes: the gradients of one layer, or of two added up.
 */
typedef struct row_job {
    const snow_normal_maker *maker;
    const snow_placement *placement;
    int64_t slice, row;
    const normal_kernels *kernels;
    snow_type type;
    int64_t step; /* bytes from column to column */
    layer layers[2];
    int layer_count;
    float carry[9]; /* transforms gradients along u, v, w to world space */
} row_job;

static void set_axis(layer *l, int axis, int64_t at, int64_t last,
                     int64_t stride) {
    l->low[axis] = at > 0 ? -stride : 0;
    l->high[axis] = at < last ? stride : 0;
    l->weight[axis] = at > 0 && at < last ? 1 : 2;
}

static layer make_layer(const row_job *job, int64_t slice) {
    const snow_placement *p = job->placement;
    const snow_volume *volume = job->maker->volume;
    const int64_t *dims = volume->info.dims;
    int64_t size = (int64_t)snow_type_size(job->type), stride;
    const int64_t strides[3] = {size, dims[0] * size, dims[0] * dims[1] * size};
    layer l = {.first = snow_row_voxels(volume, p, slice, job->row, &stride)};
    set_axis(&l, 0, 1, 2, job->step); /* the row's ends are computed exactly */
    set_axis(&l, 1, job->row, p->rows - 1, strides[p->v_axis]);
    set_axis(&l, 2, slice, p->slices - 1, strides[p->slice_axis]);
    return l;
}

static row_job make_job(const snow_normal_maker *maker, const snow_placement *p,
                        int64_t slice, int64_t row, int layer_count) {
    row_job job = {.maker = maker,
                   .placement = p,
                   .slice = slice,
                   .row = row,
                   .kernels = kernels_of(maker->isa),
                   .type = maker->volume->info.type,
                   .layer_count = layer_count};
    int64_t size = (int64_t)snow_type_size(job.type);
    job.step = p->u_axis == 0 ? size : maker->volume->info.dims[0] * size;
    for (int n = 0; n < layer_count; n++)
        job.layers[n] = make_layer(&job, slice + n);
    for (int i = 0; i < 3; i++) {
        job.carry[3 * i] = (float)maker->carry[i][p->u_axis];
        job.carry[3 * i + 1] = (float)maker->carry[i][p->v_axis];
        job.carry[3 * i + 2] = (float)maker->carry[i][p->slice_axis];
    }
    return job;
}

/* --- exact, voxel by voxel ------------------------------------------------ */

/* The code of an index gradient in doubles, of any size. */
static uint16_t code_of_gradient(const snow_normal_maker *maker,
                                 const double gradient[3]) {
    double most = 0;
    for (int i = 0; i < 3; i++) {
        if (!isfinite(gradient[i]))
            return SNOW_NO_NORMAL;
        most = fmax(most, fabs(gradient[i]));
    }
    if (most == 0)
        return SNOW_NO_NORMAL;
    double world[3], g[3];
    /* Two steps, because the inverse of a subnormal number is infinite. */
    double up = most < 0x1p-900 ? 0x1p200 : 1;
    for (int i = 0; i < 3; i++)
        g[i] = gradient[i] * up / (most * up);
    for (int i = 0; i < 3; i++)
        world[i] = snow_dot(maker->carry[i], g);
    return snow_normal_code(world);
}

/* The gradients of all layers added up, times `scale`. */
static void sum_gradients(const row_job *job, int64_t column, double scale,
                          double sum[3]) {
    const snow_placement *p = job->placement;
    const snow_volume *volume = job->maker->volume;
    int64_t at[3];
    sum[0] = sum[1] = sum[2] = 0;
    at[p->v_axis] = job->row;
    at[p->u_axis] = column;
    for (int n = 0; n < job->layer_count; n++) {
        double gradient[3];
        at[p->slice_axis] = job->slice + n;
        snow_gradient_of(job->type)(volume->voxels, volume->info.dims, at,
                                    gradient);
        for (int i = 0; i < 3; i++)
            sum[i] += gradient[i] * scale;
    }
}

static uint16_t exact_code(const row_job *job, int64_t column) {
    double sum[3];
    sum_gradients(job, column, 1, sum);
    /* Two finite sums may add up to more than a double holds. */
    if (!isfinite(sum[0] + sum[1] + sum[2]))
        sum_gradients(job, column, 0.25, sum);
    return code_of_gradient(job->maker, sum);
}

/* --- blocks --------------------------------------------------------------- */

/* Differences for the voxels of some columns, wherever they are; like the
 * kernels' differences, but `low` and `high` are byte offsets from the voxel.
 */
typedef void collect_fn(const char *first, int64_t step,
                        const uint32_t *columns, size_t count, int64_t low,
                        int64_t high, float weight, float *out);

#define COLLECT(name, type, as, subtract)                                    \
    static void collect_##name(                                              \
        const char *first, int64_t step, const uint32_t *columns,            \
        size_t count, int64_t low, int64_t high, float weight, float *out) { \
        for (size_t i = 0; i < count; i++) {                                 \
            const char *here = first + columns[i] * step;                    \
            out[i] =                                                         \
                subtract((as) * (const type *)(const void *)(here + high),   \
                         (as) * (const type *)(const void *)(here + low)) *  \
                weight;                                                      \
        }                                                                    \
    }

SUBTRACTIONS(COLLECT)

static collect_fn *const collectors[] = {
#define ENTRY(name, type, text) [SNOW_TYPE_##name] = collect_##name,
    SNOW_TYPE_MAP(ENTRY)
#undef ENTRY
};

static size_t whole_groups(size_t count) {
    return (count + GROUP - 1) / GROUP * GROUP;
}

/* Codes of up to BLOCK columns within the row, contiguous or not. */
static void encode_apart(const row_job *job, const uint32_t *columns,
                         size_t count, uint16_t *normals) {
    float gradients[3][BLOCK] = {{0}}, more[BLOCK] = {0};
    uint32_t codes[BLOCK];
    for (int n = 0; n < job->layer_count; n++)
        for (int axis = 0; axis < 3; axis++) {
            const layer *l = &job->layers[n];
            collectors[job->type](l->first, job->step, columns, count,
                                  l->low[axis], l->high[axis], l->weight[axis],
                                  n ? more : gradients[axis]);
            if (n)
                job->kernels->add(more, whole_groups(count), gradients[axis]);
        }
    bool unsure =
        job->kernels->encode(job->carry, gradients, whole_groups(count), codes);
    for (size_t n = 0; n < count; n++)
        normals[n] = (uint16_t)codes[n];
    for (size_t n = 0; unsure && n < count; n++)
        if (normals[n] == UNSURE)
            normals[n] = exact_code(job, columns[n]);
}

/* Codes of `count` neighbouring columns from `first` on; whole groups. */
static bool encode_together(const row_job *job, int64_t first, size_t count,
                            uint32_t *codes) {
    const normal_kernels *kernels = job->kernels;
    float gradients[3][BLOCK], more[BLOCK];
    for (int n = 0; n < job->layer_count; n++)
        for (int axis = 0; axis < 3; axis++) {
            const layer *l = &job->layers[n];
            const char *here = l->first + first * job->step;
            kernels->differences[job->type](
                here + l->low[axis], here + l->high[axis], count,
                l->weight[axis], n ? more : gradients[axis]);
            if (n)
                kernels->add(more, count, gradients[axis]);
        }
    return kernels->encode(job->carry, gradients, count, codes);
}

/* Codes of the columns that one block holds, beginning with the first; all lie
 * within the row. Returns their number. */
static size_t encode_block(const row_job *job, const uint32_t *columns,
                           size_t count, uint16_t *normals) {
    uint32_t codes[BLOCK];
    size_t some = 1;
    while (some < count && columns[some] - columns[0] < BLOCK)
        some++;
    size_t width = whole_groups(columns[some - 1] - columns[0] + 1);
    /* The last block of a row is moved back to lie within it. */
    int64_t first = columns[0];
    int64_t last = job->placement->columns - 1 - (int64_t)width;
    first = first < last ? first : last;
    if (first < 1) {
        encode_apart(job, columns, some, normals);
        return some;
    }
    bool unsure = encode_together(job, first, width, codes);
    for (size_t n = 0; n < some; n++)
        normals[n] = (uint16_t)codes[columns[n] - first];
    for (size_t n = 0; unsure && n < some; n++)
        if (normals[n] == UNSURE)
            normals[n] = exact_code(job, columns[n]);
    return some;
}

/* Codes of all requested columns. */
static void encode_row(const row_job *job, const uint32_t *columns,
                       size_t count, uint16_t *normals) {
    size_t n = 0;
    int64_t last = job->placement->columns - 1;
    if (job->maker->skewed) {
        for (; n < count; n++)
            normals[n] = exact_code(job, columns[n]);
        return;
    }
    if (count && columns[0] == 0)
        normals[n++] = exact_code(job, 0);
    if (n < count && columns[count - 1] == last) {
        count--;
        normals[count] = exact_code(job, last);
    }
    if (n == count)
        return;
    bool apart = job->placement->u_axis != 0 ||
                 (columns[count - 1] - columns[n]) / SPARSE > count - n;
    while (n < count) {
        size_t left = count - n, some = left < BLOCK ? left : BLOCK;
        if (apart)
            encode_apart(job, columns + n, some, normals + n);
        else
            some = encode_block(job, columns + n, left, normals + n);
        n += some;
    }
}

void snow_normals_of_row(const snow_normal_maker *maker,
                         const snow_placement *placement, int64_t slice,
                         int64_t row, bool between, const uint32_t *columns,
                         size_t count, uint16_t *normals) {
    row_job job = make_job(maker, placement, slice, row, between ? 2 : 1);
    encode_row(&job, columns, count, normals);
}
