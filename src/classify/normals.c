/* classify/normals.c - gradients of interesting voxels as codes of 16 bits
 * (model, point 4), made when a volume is encoded.
 *
 * A unit sphere's half z >= 0 is projected onto the octahedron |x|+|y|+|z| = 1
 * and that, seen from above and turned by 45 degrees, is the square
 *
 *   across = (x + y) / (|x|+|y|+|z|),  down = (x - y) / (|x|+|y|+|z|)
 *
 * from -1 to 1 (Cigolle et al., "A Survey of Efficient Representations for
 * Independent Unit Vectors", JCGT 2014, section 3).  Rounding to the nearest
 * place is the nearest normal but for a thousandth, because the two directions
 * stay at right angles in the middle of the faces, where places lie farthest
 * apart.
 *
 * Voxels are taken in blocks of neighbours, also those between that are not
 * asked for: vectors make up for it.  What single precision cannot tell (huge,
 * tiny and infinite differences), and the two ends of a row, go through
 * snow_gradient_of one by one. */
#include "classify/normals.h"
#include "base/vec3.h"

#include <math.h>
#include <string.h>

/* Places along each side of the square, and the middle one. */
#define SIDE 255
#define MIDDLE 127

#define UNSURE 65535 /* a code of a block that must be made exactly */
#define BLOCK 64     /* columns */
#define GROUP 16     /* blocks are shortened to multiples of this */

typedef void differences_fn(const void *low, const void *high, size_t count,
                            float *out);

/* The loops of one level, described in classify/normals.tmpl.h. */
typedef struct normal_kernels {
    differences_fn *differences[SNOW_FLOAT64 + 1];
    void (*encode)(const float carry[3][3], const float *const gradients[3],
                   size_t count, uint16_t *codes);
} normal_kernels;

/* The order matters, so a blank line keeps the two from being sorted. */
#define SELECT_SCALAR
#include "simd/select.h"

#include "classify/normals.tmpl.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "classify/normals.tmpl.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "classify/normals.tmpl.h"
#endif

static const normal_kernels *kernels_of(snow_isa isa) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return &kernels_avx512;
    if (isa == SNOW_ISA_AVX2)
        return &kernels_avx2;
#endif
    (void)isa;
    return &kernels_scalar;
}

/* --- one normal -----------------------------------------------------------
 */

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

/* --- makers ---------------------------------------------------------------
 */

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
        return snow_fail(context, SNOW_BAD_USAGE,
                         "the volume's matrix cannot be inverted");
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
    return SNOW_OK;
}

/* --- exact, voxel by voxel ------------------------------------------------
 */

/* The code of an index gradient in doubles, of any size. */
static uint16_t code_of_gradient(const snow_normal_maker *maker,
                                 const double gradient[3]) {
    double most =
        fmax(fabs(gradient[0]), fmax(fabs(gradient[1]), fabs(gradient[2])));
    if (!(most > 0) || !isfinite(most))
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

/* A voxel of a row, made exactly. */
static uint16_t exact_code(const snow_normal_maker *maker,
                           const snow_placement *placement, int64_t slice,
                           int64_t row, int64_t column) {
    const snow_volume_info *info = &maker->volume->info;
    int64_t at[3];
    double gradient[3];
    at[placement->slice_axis] = slice;
    at[placement->v_axis] = row;
    at[placement->u_axis] = column;
    snow_gradient_of(info->type)(maker->volume->voxels, info->dims, at,
                                 gradient);
    return code_of_gradient(maker, gradient);
}

/* --- blocks ---------------------------------------------------------------
 */

/* A row made ready: per axis (u, v, w: along the row, across it, across the
 * slices) the two voxels at column 0 that are subtracted, as steps in voxels
 * from the row's first; and how a gradient from these differences is carried,
 * twice as much where a border leaves only half the way between them. */
typedef struct block_row {
    const snow_normal_maker *maker;
    const normal_kernels *kernels;
    const char *first; /* the row's first voxel */
    int64_t stride;    /* between columns, in voxels */
    size_t size;       /* bytes of a voxel */
    int64_t columns;
    int64_t low[3], high[3];
    float carry[3][3];
} block_row;

static void set_axis(block_row *r, int n, int axis, int64_t at, int64_t last,
                     int64_t stride) {
    r->low[n] = at > 0 ? -stride : 0;
    r->high[n] = at < last ? stride : 0;
    double weight = at > 0 && at < last ? 1 : 2;
    for (int i = 0; i < 3; i++)
        r->carry[i][n] = (float)(r->maker->carry[i][axis] * weight);
}

static block_row make_row(const snow_normal_maker *maker,
                          const snow_placement *p, int64_t slice, int64_t row) {
    const snow_volume *volume = maker->volume;
    const int64_t *dims = volume->info.dims;
    const int64_t strides[3] = {1, dims[0], dims[0] * dims[1]};
    block_row r = {.maker = maker,
                   .kernels = kernels_of(maker->isa),
                   .size = snow_type_size(volume->info.type),
                   .columns = p->columns};
    r.first = snow_row_voxels(volume, p, slice, row, &r.stride);
    /* The ends of the row are never in a block. */
    set_axis(&r, 0, p->u_axis, 1, 2, r.stride);
    set_axis(&r, 1, p->v_axis, row, p->rows - 1, strides[p->v_axis]);
    set_axis(&r, 2, p->slice_axis, slice, p->slices - 1,
             strides[p->slice_axis]);
    return r;
}

/* Copies `count` voxels that are `step` bytes apart. */
static void collect(const char *from, int64_t step, size_t size, size_t count,
                    char *to) {
    if (size == 1)
        for (size_t i = 0; i < count; i++, from += step)
            to[i] = *from;
    else if (size == 2)
        for (size_t i = 0; i < count; i++, from += step)
            memcpy(to + 2 * i, from, 2);
    else if (size == 4)
        for (size_t i = 0; i < count; i++, from += step)
            memcpy(to + 4 * i, from, 4);
    else
        for (size_t i = 0; i < count; i++, from += step)
            memcpy(to + 8 * i, from, 8);
}

/* Codes of columns first .. first + wanted - 1, all of them inside the row;
 * there is room for BLOCK.  Where voxels are not neighbours in memory, or too
 * few for whole groups, they are collected first. */
static void encode_block(const block_row *r, int64_t first, size_t wanted,
                         uint16_t *codes) {
    differences_fn *differences =
        r->kernels->differences[r->maker->volume->info.type];
    size_t count = (wanted + GROUP - 1) / GROUP * GROUP;
    bool direct = r->stride == 1 && first + (int64_t)count < r->columns;
    float gradients[3][BLOCK];
    const float *const pointers[3] = {gradients[0], gradients[1], gradients[2]};
    double room[2][BLOCK];
    int64_t step = r->stride * (int64_t)r->size;
    const char *here = r->first + first * step;
    if (!direct)
        memset(room, 0, sizeof room);
    for (int n = 0; n < 3; n++) {
        const char *low = here + r->low[n] * (int64_t)r->size;
        const char *high = here + r->high[n] * (int64_t)r->size;
        if (!direct) {
            collect(low, step, r->size, wanted, (char *)room[0]);
            collect(high, step, r->size, wanted, (char *)room[1]);
            low = (const char *)room[0];
            high = (const char *)room[1];
        }
        differences(low, high, count, gradients[n]);
    }
    r->kernels->encode(r->carry, pointers, count, codes);
}

void snow_normals_of_row(const snow_normal_maker *maker,
                         const snow_placement *placement, int64_t slice,
                         int64_t row, const uint32_t *columns, size_t count,
                         uint16_t *normals) {
    block_row r = make_row(maker, placement, slice, row);
    uint16_t codes[BLOCK];
    size_t n = 0;
    while (n < count) {
        int64_t first = columns[n];
        if (maker->skewed || first == 0 || first == r.columns - 1) {
            normals[n++] = exact_code(maker, placement, slice, row, first);
            continue;
        }
        int64_t end = first + BLOCK; /* one past the block */
        if (end > r.columns - 1)
            end = r.columns - 1;
        size_t last = n;
        while (last + 1 < count && columns[last + 1] < end)
            last++;
        encode_block(&r, first, columns[last] - (size_t)first + 1, codes);
        for (; n <= last; n++) {
            normals[n] = codes[columns[n] - first];
            if (normals[n] == UNSURE)
                normals[n] =
                    exact_code(maker, placement, slice, row, columns[n]);
        }
    }
}
