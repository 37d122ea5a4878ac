/* phantom/engine.c - a machined part of two metals.
 *
 * It replaces the paper's Engine (section 5.2, 256x256x110).  As in the paper,
 * 27 % of the voxels are 0, 77 % at most 10 and 81 % at most 30 (a test
 * measures them).  A cast block with four bores, water jacket, flange, manifold
 * and pump is of a soft metal.  Liners, bolts and shafts are of a dense one,
 * which alone is visible at a high threshold. */
#include "phantom/phantom.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* The four bores along x; a macro lists the parts of each once. */
#define BORES(X) \
    X(-72)       \
    X(-24)       \
    X(24)        \
    X(72)

/* clang-format off */

/* Rows of both tables: kind, place, size, round, blend, how. */

/* The casting, in the order of construction: block, flange, jacket cut out,
 * cylinders put back, pipes and pump. */
static const snow_solid casting[] = {
    {SNOW_BOX, {0, -22, -4}, {102, 42, 44}, 6, 0, 0},
    {SNOW_BOX, {0, -22, -4}, {95, 35, 37}, 4, 0, SNOW_CARVE},
    {SNOW_BOX, {0, -22, 40}, {110, 50, 5}, 2, 4, 0},
    {SNOW_BOX, {0, -22, -46}, {110, 50, 4}, 2, 4, 0},
#define WALL(x) \
    {SNOW_CYLINDER_Z, {x, -22, 0}, {25, 45, 0}, 0, 3, 0},
    BORES(WALL)
#undef WALL
#define PIPE(x) \
    {SNOW_CYLINDER_Y, {x, 48, 14}, {13, 38, 0}, 0, 6, 0},
    BORES(PIPE)
#undef PIPE
    {SNOW_CYLINDER_X, {6, 88, 14}, {17, 100, 0}, 4, 8, 0},
    {SNOW_CYLINDER_X, {108, 88, 14}, {27, 5, 0}, 2, 0, 0},
    {SNOW_CYLINDER_X, {-20, -92, -12}, {25, 50, 0}, 6, 4, 0},
    {SNOW_BOX, {-20, -70, -12}, {30, 10, 16}, 3, 6, 0},
    {SNOW_CYLINDER_X, {-20, -92, -12}, {19, 44, 0}, 4, 0, SNOW_CARVE},
#define HOLE(x) \
    {SNOW_CYLINDER_Z, {x, -22, 0}, {21, 80, 0}, 0, 0, SNOW_CARVE}, \
    {SNOW_CYLINDER_Y, {x, 50, 14}, {9, 52, 0}, 0, 0, SNOW_CARVE},
    BORES(HOLE)
#undef HOLE
    {SNOW_CYLINDER_X, {16, 88, 14}, {12.5, 104, 0}, 0, 0, SNOW_CARVE},
};

/* Liners, bolts, shafts: the dense metal. */
static const snow_solid steel[] = {
#define LINER(x) \
    {SNOW_CYLINDER_Z, {x, -22, 0}, {21.2, 44, 0}, 0, 0, 0},
    BORES(LINER)
#undef LINER
#define BORE(x) \
    {SNOW_CYLINDER_Z, {x, -22, 0}, {17.5, 80, 0}, 0, 0, SNOW_CARVE},
    BORES(BORE)
#undef BORE
#define BOLT(x) \
    {SNOW_CYLINDER_Z, {x, 21, 30}, {4, 20, 0}, 1, 0, 0}, \
    {SNOW_CYLINDER_Z, {x, 21, 48}, {6.5, 3.5, 0}, 1, 0, 0}, \
    {SNOW_CYLINDER_Z, {x, -65, 30}, {4, 20, 0}, 1, 0, 0}, \
    {SNOW_CYLINDER_Z, {x, -65, 48}, {6.5, 3.5, 0}, 1, 0, 0},
    BOLT(-101) BOLT(-48) BOLT(0) BOLT(48) BOLT(101)
#undef BOLT
    {SNOW_CYLINDER_X, {-20, -92, -12}, {7, 66, 0}, 2, 0, 0},
    {SNOW_CYLINDER_X, {46, -92, -12}, {17, 5, 0}, 2, 0, 0},
#define STUD(y, z) \
    {SNOW_CYLINDER_X, {111, y, z}, {3, 7, 0}, 1, 0, 0},
    STUD(88, 36) STUD(88, -8) STUD(107, 25) STUD(107, 3) STUD(69, 25)
    STUD(69, 3)
#undef STUD
};
/* clang-format on */

/* Steel is painted over the casting, and both over the air.  The grain belongs
 * to the metal and not to the shape, so that surfaces stay smooth. */
static void engine_row(const snow_phantom_grid *grid, int64_t j, int64_t k,
                       void *out) {
    double y = snow_phantom_place(grid, 1, j);
    double z = snow_phantom_place(grid, 2, k);
    uint8_t *bytes = out;
    uint64_t key = snow_noise_key(grid->seed, j, k);
    snow_shape_row soft, dense;
    snow_shape_row_begin(&soft, casting, COUNT(casting), y, z);
    snow_shape_row_begin(&dense, steel, COUNT(steel), y, z);
    for (int64_t i = 0; i < grid->dims[0]; i++) {
        double x = snow_phantom_place(grid, 0, i);
        uint32_t bits = snow_noise_bits(key, i);
        double grain = (bits >> 24) * (1.0 / 127.5) - 1;
        /* Scanner noise in the air: triangular, cut at 0, with a faint long
         * tail. */
        double a = (bits & 255) * (1.0 / 255),
               b = (bits >> 8 & 255) * (1.0 / 255);
        double tail = (bits >> 16 & 255) < 8 ? 12.0 : 0.0;
        double value = 9.2 * (a + b) - 7.3 + tail;
        snow_shape_paint(grid, &value, 112 + 3 * grain,
                         snow_shape_distance(&soft, x));
        snow_shape_paint(grid, &value, 246 + 9 * grain,
                         snow_shape_distance(&dense, x));
        bytes[i] = snow_phantom_byte(value);
    }
}

const snow_phantom snow_phantom_engine = {
    .name = "engine",
    .text = "a machined part of two metals; statistics of the paper's Engine",
    .dims = {256, 256, 110},
    .extent = {256, 256, 110},
    .type = SNOW_TYPE_UINT8,
    .row = engine_row,
};
