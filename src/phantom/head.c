/* phantom/head.c - a synthetic head.
 *
 * It replaces the paper's Head (section 5.2, a CT of 256x256x113): skin, fat
 * and flesh, skull with orbits, sinuses, jaw and teeth, brain with folds,
 * ventricles and cerebellum, in millimetres, RAS.  In the paper's Head no voxel
 * has value 0, 47 % are at most 10 and 70 % at most 30.  The size of this head
 * and the noise of the air around it are chosen so that the same holds here (a
 * test measures it).  A capsule of oil on the right temple, as used in MR,
 * distinguishes the sides.
 *
 * Values follow CT in the skull bone and MR in the brain, so that both show
 * something.  Layers are painted from the outside in. */
#include "phantom/phantom.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* The shapes below are a small head's; voxels see it enlarged by this factor
 * and moved back and down by 6 and 5 mm, which fills the volume as the real one
 * does. */
#define GROWTH 1.06

/* clang-format off */

/* Rows of all tables: kind, place, size, round, blend, how. */
static const snow_solid skin[] = {
    {SNOW_ELLIPSOID, {0, -12, 32}, {77, 96, 75}, 0, 0, 0}, /* the vault */
    {SNOW_ELLIPSOID, {0, 34, -16}, {60, 60, 66}, 0, 24, 0}, /* the face */
    {SNOW_ELLIPSOID, {0, 44, -60}, {48, 46, 34}, 0, 22, 0}, /* the jaw */
    {SNOW_ELLIPSOID, {0, 84, -82}, {17, 13, 13}, 0, 14, 0}, /* the chin */
    {SNOW_CYLINDER_Z, {0, -18, -110}, {55, 80, 0}, 0, 22, 0}, /* the neck */
    {SNOW_ELLIPSOID, {24, 80, 23}, {23, 13, 8}, 0, 12, SNOW_TWIN}, /* brows */
    /* cheeks */
    {SNOW_ELLIPSOID, {38, 64, -24}, {22, 24, 22}, 0, 14, SNOW_TWIN},
    /* hollows of the eyes */
    {SNOW_ELLIPSOID, {32, 103, 6}, {15, 19, 11}, 0, 12, SNOW_CARVE | SNOW_TWIN},
    {SNOW_ELLIPSOID, {31, 77, 6}, {13, 13, 12}, 0, 4, SNOW_TWIN}, /* lids */
    /* the ridge of the nose */
    {SNOW_CAPSULE, {0, 88, 12}, {0, 109, -20}, 7.5, 12, 0},
    {SNOW_ELLIPSOID, {0, 110, -24}, {10, 10, 9}, 0, 8, 0}, /* its tip */
    /* its wings */
    {SNOW_ELLIPSOID, {10, 101, -27}, {7, 9, 7}, 0, 6, SNOW_TWIN},
    /* nostrils */
    {SNOW_ELLIPSOID, {6, 107, -34}, {3.5, 6, 5}, 0, 2, SNOW_CARVE | SNOW_TWIN},
    {SNOW_ELLIPSOID, {0, 91, -48}, {21, 9, 5}, 0, 7, 0}, /* the upper lip */
    {SNOW_ELLIPSOID, {0, 89, -58}, {18, 9, 5.5}, 0, 7, 0}, /* the lower lip */
    /* the gap between them */
    {SNOW_ELLIPSOID, {0, 101, -53}, {22, 7, 2}, 0, 3, SNOW_CARVE},
    {SNOW_ELLIPSOID, {81, -14, -2}, {8, 19, 31}, 0, 6, SNOW_TWIN}, /* ears */
    /* hollows of the ears */
    {SNOW_ELLIPSOID, {90, -8, 0}, {7, 11, 20}, 0, 4, SNOW_CARVE | SNOW_TWIN},
};

static const snow_solid skull[] = {
    {SNOW_ELLIPSOID, {0, -12, 32}, {70, 89, 69}, 0, 0, 0}, /* the vault */
    {SNOW_ELLIPSOID, {0, 56, -22}, {36, 31, 30}, 0, 10, 0}, /* the upper jaw */
    /* cheekbones */
    {SNOW_CAPSULE, {24, 84, -14}, {60, 48, -10}, 6.5, 8, SNOW_TWIN},
    /* the arches behind them */
    {SNOW_CAPSULE, {60, 48, -10}, {69, 2, -8}, 4, 5, SNOW_TWIN},
    /* ridges above the eyes */
    {SNOW_CAPSULE, {10, 81, 22}, {48, 66, 18}, 6, 8, SNOW_TWIN},
    /* orbits */
    {SNOW_ELLIPSOID, {31, 80, 5}, {17, 30, 15}, 0, 5, SNOW_CARVE | SNOW_TWIN},
    /* the bone of the nose */
    {SNOW_CAPSULE, {0, 82, 20}, {0, 96, 0}, 4.5, 5, 0},
    /* its opening */
    {SNOW_ELLIPSOID, {0, 88, -17}, {11, 20, 15}, 0, 4, SNOW_CARVE},
    /* the lower jaw */
    {SNOW_CAPSULE, {2, 80, -82}, {40, 40, -72}, 8, 5, SNOW_TWIN},
    /* its branches up to the ears */
    {SNOW_CAPSULE, {42, 36, -70}, {57, 8, -20}, 7, 8, SNOW_TWIN},
    {SNOW_CYLINDER_Z, {0, -34, -48}, {17, 9, 0}, 4, 0, 0}, /* four vertebrae */
    {SNOW_CYLINDER_Z, {0, -33, -69}, {17, 8, 0}, 4, 0, 0},
    {SNOW_CYLINDER_Z, {0, -32, -89}, {17, 8, 0}, 4, 0, 0},
    {SNOW_CYLINDER_Z, {0, -32, -110}, {17, 9, 0}, 4, 0, 0},
    /* spines of two of them */
    {SNOW_CAPSULE, {0, -50, -50}, {0, -72, -56}, 5, 6, 0},
    {SNOW_CAPSULE, {0, -50, -90}, {0, -70, -98}, 5, 6, 0},
    /* the canal of the spinal cord */
    {SNOW_CYLINDER_Z, {0, -40, -75}, {8, 70, 0}, 0, 0, SNOW_CARVE},
};

/* Upper and lower arch; x, y and z of the crowns' centres. */
static const snow_solid teeth[] = {
#define TOOTH(x, y, width) \
    {SNOW_ELLIPSOID, {x, y, -46}, {width, 4, 7}, 0, 0, SNOW_TWIN}, \
    {SNOW_ELLIPSOID, {x, (y) - 2, -61}, {width, 4, 7}, 0, 0, SNOW_TWIN}
    TOOTH(4.2, 82, 3.9), TOOTH(11.5, 80, 3.4), TOOTH(17.8, 76, 3.6),
    TOOTH(22.6, 70, 4),  TOOTH(26, 62.5, 4.4), TOOTH(28.5, 53, 5.2),
#undef TOOTH
};

static const snow_solid airways[] = {
    /* sinuses above the eyes */
    {SNOW_ELLIPSOID, {10, 75, 27}, {9, 4, 8}, 0, 0, SNOW_TWIN},
    /* sinuses in the upper jaw */
    {SNOW_ELLIPSOID, {24, 62, -18}, {9, 14, 12}, 0, 0, SNOW_TWIN},
    /* the nose */
    {SNOW_ELLIPSOID, {5.5, 76, -20}, {3.8, 34, 13}, 0, 0, SNOW_TWIN},
    /* the throat behind it */
    {SNOW_ELLIPSOID, {0, 24, -34}, {10, 9, 30}, 0, 8, 0},
    {SNOW_ELLIPSOID, {0, 50, -50}, {20, 26, 4}, 0, 8, 0}, /* the mouth */
    {SNOW_CAPSULE, {0, 16, -56}, {0, 10, -130}, 8, 8, 0}, /* the windpipe */
    /* ear canals */
    {SNOW_CAPSULE, {58, -8, -2}, {86, -8, -2}, 3.2, 0, SNOW_TWIN},
};

static const snow_solid cavity[] = {
    /* the space of the brain */
    {SNOW_ELLIPSOID, {0, -12, 32}, {63, 82, 62}, 0, 0, 0},
    /* the space of the cerebellum */
    {SNOW_ELLIPSOID, {0, -44, -6}, {48, 34, 28}, 0, 12, 0},
    /* the space of the spinal cord */
    {SNOW_CAPSULE, {0, -34, -10}, {0, -40, -130}, 8, 10, 0},
};

static const snow_solid cerebellum[] = {
    /* the cerebellum, and below it the brain stem */
    {SNOW_ELLIPSOID, {0, -50, -10}, {44, 28, 20}, 0, 0, 0},
    {SNOW_CAPSULE, {0, -20, 10}, {0, -40, -130}, 6.5, 6, 0},
};

static const snow_solid ventricles[] = {
    /* front horns */
    {SNOW_CAPSULE, {9, 24, 40}, {10, -22, 48}, 6, 0, SNOW_TWIN},
    {SNOW_CAPSULE, {10, -22, 48}, {19, -46, 36}, 6.5, 5, SNOW_TWIN}, /* bends */
    /* lower horns */
    {SNOW_CAPSULE, {19, -46, 36}, {33, -14, 14}, 3.5, 5, SNOW_TWIN},
    /* the third ventricle, in the middle */
    {SNOW_ELLIPSOID, {0, -6, 30}, {2.5, 14, 10}, 0, 0, 0},
};

static const snow_solid eyes[] = {
    {SNOW_ELLIPSOID, {31, 74, 6}, {12, 12, 12}, 0, 0, SNOW_TWIN},
};

static const snow_solid capsule[] = {
    {SNOW_CAPSULE, {75, 14, 34}, {75, 14, 46}, 5.5, 0, 0},
};

/* clang-format on */

/* The values that are constant along a row. */
typedef struct head_row {
    const snow_phantom_grid *grid;
    snow_shape_row skin, skull, teeth, airways, cavity, cerebellum, ventricles,
        eyes, capsule;
    snow_noise_row cloud, folds, fine;
    uint64_t air_key, tissue_key;
    double z;
    double grain; /* of the current voxel, -1 to 1 */
} head_row;

/* Air: a floor of electronic noise, and clouds of scatter whose share of the
 * volume makes up the 23 % between 10 and 30. */
static double air_value(const head_row *row, int64_t i, double x) {
    uint32_t bits = snow_noise_bits(row->air_key, i);
    double grain = (bits & 255) * (1.0 / 255);
    double other = (bits >> 8 & 255) * (1.0 / 255);
    double cloud = snow_noise_at(&row->cloud, x) + 0.12 * (other - 0.5);
    if (cloud > 0.591)
        return 11 + 11 * grain + 20 * (cloud - 0.591);
    return 1 + 8 * grain * (0.4 + cloud);
}

/* Brain: cortex over white matter.  Folds are where a smooth noise crosses its
 * mean, cut to a depth that decreases inwards; then the gap between the
 * hemispheres. */
static double brain_value(const head_row *row, double x, double depth) {
    const snow_phantom_grid *grid = row->grid;
    double grain = row->grain;
    double n = snow_noise_at(&row->folds, x) - 0.5;
    double ridge = 1 - fabs(n) * 6;
    double groove = ridge > 0 ? ridge * ridge * 15 : 0;
    double surface = depth + 3 + groove;
    double gap = row->z > 8 ? fabs(x) - 1.1 : SNOW_SHAPE_FAR;
    if (depth < -40)
        gap = SNOW_SHAPE_FAR;
    double value = 42 + 2 * grain;
    snow_shape_paint(grid, &value, 92 + 3 * grain, surface);
    double wave = 5 * (snow_noise_at(&row->fine, x) - 0.5);
    snow_shape_paint(grid, &value, 113 + 3 * grain, surface + 5 + wave);
    snow_shape_paint(grid, &value, 44, gap);
    return value;
}

/* The inside of the skull.  The layers of the cerebellum depend on z. */
static double inner_value(const head_row *row, double x, double depth) {
    const snow_phantom_grid *grid = row->grid;
    double value = brain_value(row, x, depth), grain = row->grain;
    double little = snow_shape_distance(&row->cerebellum, x);
    if (little < grid->edge) {
        double leaf = row->z / 5 - floor(row->z / 5);
        snow_shape_paint(grid, &value, 44, little - 3);
        snow_shape_paint(grid, &value, leaf < 0.3 ? 70 : 98 + 3 * grain,
                         little);
    }
    snow_shape_paint(grid, &value, 40,
                     snow_shape_distance(&row->ventricles, x));
    return value;
}

/* Skin, flesh, bone and airways.  Bone stays a little below the skin. */
static double outer_value(const head_row *row, double x, double air,
                          double shell, double depth) {
    const snow_phantom_grid *grid = row->grid;
    double value = air, grain = row->grain;
    snow_shape_paint(grid, &value, 64 + 2 * grain, shell);
    snow_shape_paint(grid, &value, 82 + 4 * grain, shell + 4.5);
    double bone = snow_shape_distance(&row->skull, x), below = shell + 4.5;
    bone = bone > below ? bone : below;
    snow_shape_paint(grid, &value, 205 + 5 * grain, bone);
    double spongy = bone + 3.2, table = 2 - depth;
    snow_shape_paint(grid, &value, 160 + 10 * grain,
                     spongy > table ? spongy : table);
    snow_shape_paint(grid, &value, 84, snow_shape_distance(&row->eyes, x));
    snow_shape_paint(grid, &value, 255, snow_shape_distance(&row->teeth, x));
    snow_shape_paint(grid, &value, 3 + 3 * grain,
                     snow_shape_distance(&row->airways, x));
    snow_shape_paint(grid, &value, 230, snow_shape_distance(&row->capsule, x));
    return value;
}

/* Converts world coordinates to those of the small head; each noise has a seed
 * of its own, so that no pattern repeats another. */
static void begin_row(head_row *row, const snow_phantom_grid *grid, int64_t j,
                      int64_t k) {
    double y = (snow_phantom_place(grid, 1, j) + 6) / GROWTH;
    double z = (snow_phantom_place(grid, 2, k) + 5) / GROWTH;
    row->grid = grid;
    row->z = z;
    row->air_key = snow_noise_key(grid->seed, j, k);
    row->tissue_key = snow_noise_key(~grid->seed, j, k);
    snow_shape_row_begin(&row->skin, skin, COUNT(skin), y, z);
    snow_shape_row_begin(&row->skull, skull, COUNT(skull), y, z);
    snow_shape_row_begin(&row->teeth, teeth, COUNT(teeth), y, z);
    snow_shape_row_begin(&row->airways, airways, COUNT(airways), y, z);
    snow_shape_row_begin(&row->cavity, cavity, COUNT(cavity), y, z);
    snow_shape_row_begin(&row->cerebellum, cerebellum, COUNT(cerebellum), y, z);
    snow_shape_row_begin(&row->ventricles, ventricles, COUNT(ventricles), y, z);
    snow_shape_row_begin(&row->eyes, eyes, COUNT(eyes), y, z);
    snow_shape_row_begin(&row->capsule, capsule, COUNT(capsule), y, z);
    snow_noise_row_begin(&row->cloud, grid->seed ^ 1, 19, 128, y, z);
    snow_noise_row_begin(&row->folds, grid->seed ^ 2, 11, 128, y, z);
    snow_noise_row_begin(&row->fine, grid->seed ^ 3, 7, 128, y, z);
}

/* One voxel, from the outside in, so that each position evaluates few
 * shapes. */
static double head_value(head_row *row, int64_t i, double x) {
    const snow_phantom_grid *grid = row->grid;
    double depth = snow_shape_distance(&row->cavity, x), shell = 0;
    row->grain =
        (snow_noise_bits(row->tissue_key, i) & 255) * (1.0 / 127.5) - 1;
    if (depth < -grid->edge)
        return inner_value(row, x, depth);
    shell = snow_shape_distance(&row->skin, x);
    double air = shell > -grid->edge ? air_value(row, i, x) : 0;
    if (shell > grid->edge && (x < row->capsule.first || x > row->capsule.last))
        return air;
    double value = outer_value(row, x, air, shell, depth);
    if (depth < grid->edge) /* the cavity's wall */
        snow_shape_paint(grid, &value, inner_value(row, x, depth), depth);
    return value;
}

static void head_fill(const snow_phantom_grid *grid, int64_t j, int64_t k,
                      void *out) {
    head_row row;
    uint8_t *bytes = out;
    begin_row(&row, grid, j, k);
    for (int64_t i = 0; i < grid->dims[0]; i++) {
        double x = snow_phantom_place(grid, 0, i) / GROWTH;
        double value = head_value(&row, i, x);
        bytes[i] = snow_phantom_byte(value);
    }
}

const snow_phantom snow_phantom_head = {
    .name = "head",
    .text = "a head: skin, skull, brain; statistics of the paper's Head",
    .dims = {256, 256, 113},
    .extent = {256, 256, 226},
    .type = SNOW_TYPE_UINT8,
    .medical = true,
    .row = head_fill,
};
