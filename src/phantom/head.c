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

static const snow_solid skin[] = {
    /* the vault */
    {.kind = SNOW_ELLIPSOID, .at = {0, -12, 32}, .size = {77, 96, 75}},
    /* the face */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 34, -16},
     .size = {60, 60, 66},
     .blend = 24},
    /* the jaw */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 44, -60},
     .size = {48, 46, 34},
     .blend = 22},
    /* the chin */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 84, -82},
     .size = {17, 13, 13},
     .blend = 14},
    /* the neck */
    {.kind = SNOW_CYLINDER_Z,
     .at = {0, -18, -110},
     .size = {55, 80},
     .blend = 22},
    /* brows */
    {.kind = SNOW_ELLIPSOID,
     .at = {24, 80, 23},
     .size = {23, 13, 8},
     .blend = 12,
     .twin = true},
    /* cheeks */
    {.kind = SNOW_ELLIPSOID,
     .at = {38, 64, -24},
     .size = {22, 24, 22},
     .blend = 14,
     .twin = true},
    /* hollows of the eyes */
    {.kind = SNOW_ELLIPSOID,
     .at = {32, 103, 6},
     .size = {15, 19, 11},
     .blend = 12,
     .carve = true,
     .twin = true},
    /* lids */
    {.kind = SNOW_ELLIPSOID,
     .at = {31, 77, 6},
     .size = {13, 13, 12},
     .blend = 4,
     .twin = true},
    /* the ridge of the nose */
    {.kind = SNOW_CAPSULE,
     .at = {0, 88, 12},
     .size = {0, 109, -20},
     .round = 7.5,
     .blend = 12},
    /* its tip */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 110, -24},
     .size = {10, 10, 9},
     .blend = 8},
    /* its wings */
    {.kind = SNOW_ELLIPSOID,
     .at = {10, 101, -27},
     .size = {7, 9, 7},
     .blend = 6,
     .twin = true},
    /* nostrils */
    {.kind = SNOW_ELLIPSOID,
     .at = {6, 107, -34},
     .size = {3.5, 6, 5},
     .blend = 2,
     .carve = true,
     .twin = true},
    /* the upper lip */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 91, -48},
     .size = {21, 9, 5},
     .blend = 7},
    /* the lower lip */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 89, -58},
     .size = {18, 9, 5.5},
     .blend = 7},
    /* the gap between them */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 101, -53},
     .size = {22, 7, 2},
     .blend = 3,
     .carve = true},
    /* ears */
    {.kind = SNOW_ELLIPSOID,
     .at = {81, -14, -2},
     .size = {8, 19, 31},
     .blend = 6,
     .twin = true},
    /* hollows of the ears */
    {.kind = SNOW_ELLIPSOID,
     .at = {90, -8, 0},
     .size = {7, 11, 20},
     .blend = 4,
     .carve = true,
     .twin = true},
};

static const snow_solid skull[] = {
    /* the vault */
    {.kind = SNOW_ELLIPSOID, .at = {0, -12, 32}, .size = {70, 89, 69}},
    /* the upper jaw */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 56, -22},
     .size = {36, 31, 30},
     .blend = 10},
    /* cheekbones */
    {.kind = SNOW_CAPSULE,
     .at = {24, 84, -14},
     .size = {60, 48, -10},
     .round = 6.5,
     .blend = 8,
     .twin = true},
    /* the arches behind them */
    {.kind = SNOW_CAPSULE,
     .at = {60, 48, -10},
     .size = {69, 2, -8},
     .round = 4,
     .blend = 5,
     .twin = true},
    /* ridges above the eyes */
    {.kind = SNOW_CAPSULE,
     .at = {10, 81, 22},
     .size = {48, 66, 18},
     .round = 6,
     .blend = 8,
     .twin = true},
    /* orbits */
    {.kind = SNOW_ELLIPSOID,
     .at = {31, 80, 5},
     .size = {17, 30, 15},
     .blend = 5,
     .carve = true,
     .twin = true},
    /* the bone of the nose */
    {.kind = SNOW_CAPSULE,
     .at = {0, 82, 20},
     .size = {0, 96, 0},
     .round = 4.5,
     .blend = 5},
    /* its opening */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 88, -17},
     .size = {11, 20, 15},
     .blend = 4,
     .carve = true},
    /* the lower jaw */
    {.kind = SNOW_CAPSULE,
     .at = {2, 80, -82},
     .size = {40, 40, -72},
     .round = 8,
     .blend = 5,
     .twin = true},
    /* its branches up to the ears */
    {.kind = SNOW_CAPSULE,
     .at = {42, 36, -70},
     .size = {57, 8, -20},
     .round = 7,
     .blend = 8,
     .twin = true},
    /* four vertebrae */
    {.kind = SNOW_CYLINDER_Z, .at = {0, -34, -48}, .size = {17, 9}, .round = 4},
    {.kind = SNOW_CYLINDER_Z, .at = {0, -33, -69}, .size = {17, 8}, .round = 4},
    {.kind = SNOW_CYLINDER_Z, .at = {0, -32, -89}, .size = {17, 8}, .round = 4},
    {.kind = SNOW_CYLINDER_Z,
     .at = {0, -32, -110},
     .size = {17, 9},
     .round = 4},
    /* spines of two of them */
    {.kind = SNOW_CAPSULE,
     .at = {0, -50, -50},
     .size = {0, -72, -56},
     .round = 5,
     .blend = 6},
    {.kind = SNOW_CAPSULE,
     .at = {0, -50, -90},
     .size = {0, -70, -98},
     .round = 5,
     .blend = 6},
    /* the canal of the spinal cord */
    {.kind = SNOW_CYLINDER_Z,
     .at = {0, -40, -75},
     .size = {8, 70},
     .carve = true},
};

/* Upper and lower arch; x, y and z of the crowns' centres. */
static const snow_solid teeth[] = {
#define TOOTH(x, y, width)                                                    \
    {.kind = SNOW_ELLIPSOID,                                                  \
     .at = {x, y, -46},                                                       \
     .size = {width, 4, 7},                                                   \
     .twin = true},                                                           \
    {                                                                         \
        .kind = SNOW_ELLIPSOID, .at = {x, (y)-2, -61}, .size = {width, 4, 7}, \
        .twin = true                                                          \
    }
    TOOTH(4.2, 82, 3.9), TOOTH(11.5, 80, 3.4), TOOTH(17.8, 76, 3.6),
    TOOTH(22.6, 70, 4),  TOOTH(26, 62.5, 4.4), TOOTH(28.5, 53, 5.2),
#undef TOOTH
};

static const snow_solid airways[] = {
    /* sinuses above the eyes */
    {.kind = SNOW_ELLIPSOID,
     .at = {10, 75, 27},
     .size = {9, 4, 8},
     .twin = true},
    /* sinuses in the upper jaw */
    {.kind = SNOW_ELLIPSOID,
     .at = {24, 62, -18},
     .size = {9, 14, 12},
     .twin = true},
    /* the nose */
    {.kind = SNOW_ELLIPSOID,
     .at = {5.5, 76, -20},
     .size = {3.8, 34, 13},
     .twin = true},
    /* the throat behind it */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 24, -34},
     .size = {10, 9, 30},
     .blend = 8},
    /* the mouth */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, 50, -50},
     .size = {20, 26, 4},
     .blend = 8},
    /* the windpipe */
    {.kind = SNOW_CAPSULE,
     .at = {0, 16, -56},
     .size = {0, 10, -130},
     .round = 8,
     .blend = 8},
    /* ear canals */
    {.kind = SNOW_CAPSULE,
     .at = {58, -8, -2},
     .size = {86, -8, -2},
     .round = 3.2,
     .twin = true},
};

static const snow_solid cavity[] = {
    /* the space of the brain */
    {.kind = SNOW_ELLIPSOID, .at = {0, -12, 32}, .size = {63, 82, 62}},
    /* the space of the cerebellum */
    {.kind = SNOW_ELLIPSOID,
     .at = {0, -44, -6},
     .size = {48, 34, 28},
     .blend = 12},
    /* the space of the spinal cord */
    {.kind = SNOW_CAPSULE,
     .at = {0, -34, -10},
     .size = {0, -40, -130},
     .round = 8,
     .blend = 10},
};

static const snow_solid cerebellum[] = {
    /* the cerebellum, and below it the brain stem */
    {.kind = SNOW_ELLIPSOID, .at = {0, -50, -10}, .size = {44, 28, 20}},
    {.kind = SNOW_CAPSULE,
     .at = {0, -20, 10},
     .size = {0, -40, -130},
     .round = 6.5,
     .blend = 6},
};

static const snow_solid ventricles[] = {
    /* front horns */
    {.kind = SNOW_CAPSULE,
     .at = {9, 24, 40},
     .size = {10, -22, 48},
     .round = 6,
     .twin = true},
    /* bends */
    {.kind = SNOW_CAPSULE,
     .at = {10, -22, 48},
     .size = {19, -46, 36},
     .round = 6.5,
     .blend = 5,
     .twin = true},
    /* lower horns */
    {.kind = SNOW_CAPSULE,
     .at = {19, -46, 36},
     .size = {33, -14, 14},
     .round = 3.5,
     .blend = 5,
     .twin = true},
    /* the third ventricle, in the middle */
    {.kind = SNOW_ELLIPSOID, .at = {0, -6, 30}, .size = {2.5, 14, 10}},
};

static const snow_solid eyes[] = {
    {.kind = SNOW_ELLIPSOID,
     .at = {31, 74, 6},
     .size = {12, 12, 12},
     .twin = true},
};

static const snow_solid capsule[] = {
    {.kind = SNOW_CAPSULE,
     .at = {75, 14, 34},
     .size = {75, 14, 46},
     .round = 5.5},
};

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
