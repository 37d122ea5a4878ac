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

/* The casting, in the order of construction: block, flange, jacket cut out,
 * cylinders put back, pipes and pump. */
static const snow_solid casting[] = {
    {.kind = SNOW_BOX, .at = {0, -22, -4}, .size = {102, 42, 44}, .round = 6},
    {.kind = SNOW_BOX,
     .at = {0, -22, -4},
     .size = {95, 35, 37},
     .round = 4,
     .carve = true},
    {.kind = SNOW_BOX,
     .at = {0, -22, 40},
     .size = {110, 50, 5},
     .round = 2,
     .blend = 4},
    {.kind = SNOW_BOX,
     .at = {0, -22, -46},
     .size = {110, 50, 4},
     .round = 2,
     .blend = 4},
#define WALL(x) \
    {.kind = SNOW_CYLINDER_Z, .at = {x, -22, 0}, .size = {25, 45}, .blend = 3},
    BORES(WALL)
#undef WALL
#define PIPE(x) \
    {.kind = SNOW_CYLINDER_Y, .at = {x, 48, 14}, .size = {13, 38}, .blend = 6},
        BORES(PIPE)
#undef PIPE
            {.kind = SNOW_CYLINDER_X,
             .at = {6, 88, 14},
             .size = {17, 100},
             .round = 4,
             .blend = 8},
    {.kind = SNOW_CYLINDER_X, .at = {108, 88, 14}, .size = {27, 5}, .round = 2},
    {.kind = SNOW_CYLINDER_X,
     .at = {-20, -92, -12},
     .size = {25, 50},
     .round = 6,
     .blend = 4},
    {.kind = SNOW_BOX,
     .at = {-20, -70, -12},
     .size = {30, 10, 16},
     .round = 3,
     .blend = 6},
    {.kind = SNOW_CYLINDER_X,
     .at = {-20, -92, -12},
     .size = {19, 44},
     .round = 4,
     .carve = true},
#define HOLE(x)                   \
    {.kind = SNOW_CYLINDER_Z,     \
     .at = {x, -22, 0},           \
     .size = {21, 80},            \
     .carve = true},              \
        {.kind = SNOW_CYLINDER_Y, \
         .at = {x, 50, 14},       \
         .size = {9, 52},         \
         .carve = true},
    BORES(HOLE)
#undef HOLE
        {.kind = SNOW_CYLINDER_X,
         .at = {16, 88, 14},
         .size = {12.5, 104},
         .carve = true},
};

/* Liners, bolts, shafts: the dense metal. */
static const snow_solid steel[] = {
#define LINER(x) \
    {.kind = SNOW_CYLINDER_Z, .at = {x, -22, 0}, .size = {21.2, 44}},
    BORES(LINER)
#undef LINER
#define BORE(x)               \
    {.kind = SNOW_CYLINDER_Z, \
     .at = {x, -22, 0},       \
     .size = {17.5, 80},      \
     .carve = true},
        BORES(BORE)
#undef BORE
#define BOLT(x)                                                                \
    {.kind = SNOW_CYLINDER_Z, .at = {x, 21, 30}, .size = {4, 20}, .round = 1}, \
        {.kind = SNOW_CYLINDER_Z,                                              \
         .at = {x, 21, 48},                                                    \
         .size = {6.5, 3.5},                                                   \
         .round = 1},                                                          \
        {.kind = SNOW_CYLINDER_Z,                                              \
         .at = {x, -65, 30},                                                   \
         .size = {4, 20},                                                      \
         .round = 1},                                                          \
        {.kind = SNOW_CYLINDER_Z,                                              \
         .at = {x, -65, 48},                                                   \
         .size = {6.5, 3.5},                                                   \
         .round = 1},
            BOLT(-101) BOLT(-48) BOLT(0) BOLT(48) BOLT(101)
#undef BOLT
                {.kind = SNOW_CYLINDER_X,
                 .at = {-20, -92, -12},
                 .size = {7, 66},
                 .round = 2},
    {.kind = SNOW_CYLINDER_X,
     .at = {46, -92, -12},
     .size = {17, 5},
     .round = 2},
#define STUD(y, z) \
    {.kind = SNOW_CYLINDER_X, .at = {111, y, z}, .size = {3, 7}, .round = 1},
    STUD(88, 36) STUD(88, -8) STUD(107, 25) STUD(107, 3) STUD(69, 25)
        STUD(69, 3)
#undef STUD
};

/* Scanner noise in the air: triangular, cut at 0, with a faint long tail. */
static double air_value(uint32_t bits) {
    double a = (bits & 255) * (1.0 / 255), b = (bits >> 8 & 255) * (1.0 / 255);
    double tail = (bits >> 16 & 255) < 8 ? 12.0 : 0.0;
    return 9.2 * (a + b) - 7.3 + tail;
}

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
        double value = air_value(bits);
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
