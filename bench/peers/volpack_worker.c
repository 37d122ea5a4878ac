/* bench/peers/volpack_worker.c - VolPack behind the pipe of peers.py.
 *
 * VolPack (Lacroute and Levoy, "Fast Volume Rendering Using a Shear-Warp
 * Factorization of the Viewing Transformation", SIGGRAPH 1994) as its manual
 * advises for each use: while only the view turns, the run-length encoded
 * classified volume; while the transfer function changes, the raw voxels with
 * a min-max octree (vpRenderRawVolume), or a new classification through the
 * octree, whichever the last argument names.
 *
 * Commands and answers are those of the other workers: see README.md.
 *
 *   volpack_worker RAW X Y Z SIZE THREADS SHADED COLOUR HOW
 *
 * THREADS is not looked at: VolPack has one.  COLOUR 1 asks for three channels.
 * HOW is "classified" or "octree". */
#include "pipe.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <volpack.h>

/* Rays end at 99 % and voxels count from half an 8-bit step on: as good as the
 * others, where VolPack's examples take 95 % and 5 %. */
#define MAX_RAY_OPACITY 0.99
#define MIN_VOXEL_OPACITY (0.5 / 255)

/* A voxel as VolPack is to see it.  The colour's index must have two bytes: a
 * normal of 13 bits when shaded, else the density itself.  The first fields are
 * kept in the classified volume, the others are for classification. */
typedef struct voxel {
    unsigned short shade;
    unsigned char weight; /* density, chooses among materials */
    unsigned char density;
} voxel;

enum { SHADE, WEIGHT, DENSITY, FIELDS };

static struct worker {
    const char *raw;
    int dims[3], channels, materials;
    bool shaded, octree;
    unsigned char *values; /* as read */
    voxel *voxels;
    vpContext *context;
    float *shades;                 /* VolPack's shading table */
    float weights[PIPE_VALUES][2]; /* of the two materials */
    float opacities[PIPE_VALUES];  /* VolPack's classification table */
    pipe_table table;
    bool prepared, changed; /* changed since the last picture */
    unsigned char *image;   /* rows from the bottom up */
} worker;

static void load(void);
static void take(const pipe_table *table);
static void frame(double azimuth, double elevation);
static void pixel(int x, int y, unsigned char rgb[3]);

static pipe_worker face = {
    .name = "volpack_worker",
    .load = load,
    .take = take,
    .frame = frame,
    .pixel = pixel,
};

static void check(vpResult result) {
    if (result != VP_OK)
        pipe_fail(&face, vpGetErrorString(vpGetError(worker.context)));
}

static void take(const pipe_table *table) {
    memcpy(worker.table, table, sizeof worker.table);
    worker.changed = true;
}

static void load(void) {
    size_t count = (size_t)worker.dims[0] * (size_t)worker.dims[1] *
                   (size_t)worker.dims[2];
    FILE *file = fopen(worker.raw, "rb");
    size_t got = 0;
    worker.values = malloc(count);
    if (file) {
        got = worker.values ? fread(worker.values, 1, count, file) : 0;
        fclose(file);
    }
    if (got != count)
        pipe_fail(&face, "the volume cannot be read");
}

/* --- preparation --- */

/* Colours as materials: one is enough when the colour does not depend on the
 * value.  Else the table's colours lie between those of value 0 and of value
 * 255, and the two ends are the materials.  A material is ambient 0.2, diffuse
 * 0.7, specular 0.2 with exponent 20, lit from the eye on both sides. */
static void set_materials(void) {
    static const int names[] = {VP_MATERIAL0, VP_MATERIAL1};
    for (int m = 0; m < worker.materials; m++) {
        const double *c = worker.table[m ? PIPE_VALUES - 1 : 0];
        check(vpSetMaterial(worker.context, names[m], VP_AMBIENT, VP_BOTH_SIDES,
                            0.2 * c[0], 0.2 * c[1], 0.2 * c[2]));
        check(vpSetMaterial(worker.context, names[m], VP_DIFFUSE, VP_BOTH_SIDES,
                            0.7 * c[0], 0.7 * c[1], 0.7 * c[2]));
        check(vpSetMaterial(worker.context, names[m], VP_SPECULAR,
                            VP_BOTH_SIDES, 0.2, 0.2, 0.2));
        check(vpSetMaterial(worker.context, names[m], VP_SHINYNESS,
                            VP_BOTH_SIDES, 20, 0, 0));
    }
}

/* How far the colour of `value` is from the first material to the second, by
 * the channel that changes most. */
static double mixture(int value) {
    const double *first = worker.table[0],
                 *last = worker.table[PIPE_VALUES - 1];
    int widest = 0;
    for (int c = 1; c < 3; c++)
        if (fabs(last[c] - first[c]) > fabs(last[widest] - first[widest]))
            widest = c;
    double width = last[widest] - first[widest];
    return width != 0 ? (worker.table[value][widest] - first[widest]) / width
                      : 0;
}

/* The transfer function goes into VolPack's tables, which it reads in place. */
static void apply_table(void) {
    for (int v = 0; v < PIPE_VALUES; v++) {
        worker.opacities[v] = (float)worker.table[v][3];
        worker.weights[v][1] = (float)mixture(v);
        worker.weights[v][0] = 1 - worker.weights[v][1];
        for (int c = 0; !worker.shaded && c < worker.channels; c++)
            worker.shades[v * worker.channels + c] =
                (float)(255 * worker.table[v][c]);
    }
    if (worker.shaded)
        set_materials();
    check(vpSetClassifierTable(worker.context, 0, DENSITY, worker.opacities,
                               sizeof worker.opacities));
}

/* The difference of the values beside `at` along an axis; one-sided at the
 * border, as the others have it. */
static double slope(const int at[3], int axis) {
    const int *d = worker.dims;
    size_t stride[3] = {1, (size_t)d[0], (size_t)d[0] * (size_t)d[1]};
    const unsigned char *here = worker.values + (size_t)at[0] +
                                (size_t)at[1] * stride[1] +
                                (size_t)at[2] * stride[2];
    bool before = at[axis] > 0, after = at[axis] + 1 < d[axis];
    double step =
        here[after ? stride[axis] : 0] - *(here - (before ? stride[axis] : 0));
    return before && after ? step / 2 : step;
}

/* vpVolumeNormals leaves voxels of the border without a normal, and so a
 * volume's cut faces dark: they get theirs here. */
static void add_border_normals(void) {
    const int *d = worker.dims;
    int at[3];
    voxel *voxel = worker.voxels;
    for (at[2] = 0; at[2] < d[2]; at[2]++)
        for (at[1] = 0; at[1] < d[1]; at[1]++) {
            bool edge = at[2] == 0 || at[2] == d[2] - 1 || at[1] == 0 ||
                        at[1] == d[1] - 1;
            int next = edge || d[0] < 2 ? 1 : d[0] - 1;
            for (at[0] = 0; at[0] < d[0]; at[0] += next) {
                double x = slope(at, 0), y = slope(at, 1), z = slope(at, 2);
                double length = sqrt(x * x + y * y + z * z);
                if (length > 0)
                    voxel[at[0]].shade = (unsigned short)vpNormalIndex(
                        x / length, y / length, z / length);
            }
            voxel += d[0];
        }
}

static void make_voxels(size_t count) {
    const int *d = worker.dims;
    worker.voxels = malloc(count * sizeof *worker.voxels);
    if (!worker.voxels)
        pipe_fail(&face, "no memory");
    check(vpSetRawVoxels(worker.context, worker.voxels,
                         (int)(count * sizeof *worker.voxels), sizeof(voxel),
                         d[0] * (int)sizeof(voxel),
                         d[0] * d[1] * (int)sizeof(voxel)));
    if (worker.shaded) {
        check(vpVolumeNormals(worker.context, worker.values, (int)count,
                              DENSITY, VP_SKIP_FIELD, SHADE));
        add_border_normals();
    }
    for (size_t i = 0; i < count; i++) {
        worker.voxels[i].weight = worker.values[i];
        worker.voxels[i].density = worker.values[i];
        if (!worker.shaded)
            worker.voxels[i].shade = worker.values[i];
    }
}

/* The weight field is only kept where two materials need it: less to read. */
static void describe_voxels(void) {
    vpContext *c = worker.context;
    int most = worker.shaded ? VP_NORM_MAX : PIPE_VALUES - 1;
    check(vpSetVolumeSize(c, worker.dims[0], worker.dims[1], worker.dims[2]));
    check(vpSetVoxelSize(c, sizeof(voxel), FIELDS, worker.materials, 1));
    check(vpSetVoxelField(c, SHADE, 2, offsetof(voxel, shade), most));
    check(vpSetVoxelField(c, WEIGHT, 1, offsetof(voxel, weight),
                          PIPE_VALUES - 1));
    check(vpSetVoxelField(c, DENSITY, 1, offsetof(voxel, density),
                          PIPE_VALUES - 1));
    size_t entries =
        (size_t)(most + 1) * (size_t)worker.channels * (size_t)worker.materials;
    worker.shades = calloc(entries, sizeof *worker.shades);
    if (!worker.shades)
        pipe_fail(&face, "no memory");
    check(vpSetLookupShader(
        c, worker.channels, worker.materials, SHADE, worker.shades,
        (int)(entries * sizeof *worker.shades),
        worker.materials > 1 ? WEIGHT : 0,
        worker.materials > 1 ? &worker.weights[0][0] : NULL,
        worker.materials > 1 ? (int)sizeof worker.weights : 0));
}

static void set_scene(void) {
    vpContext *c = worker.context;
    check(vpSetLight(c, VP_LIGHT0, VP_DIRECTION, 0, 0, 1));
    check(vpSetLight(c, VP_LIGHT0, VP_COLOR, 1, 1, 1));
    check(vpEnable(c, VP_LIGHT0, 1));
    check(vpEnable(c, VP_LIGHT_BOTH_SIDES, 1));
    check(vpEnable(c, VP_CLAMP_SHADE_TABLE, 1));
    check(vpSetd(c, VP_MAX_RAY_OPACITY, MAX_RAY_OPACITY));
    check(vpSetd(c, VP_MIN_VOXEL_OPACITY, MIN_VOXEL_OPACITY));
    size_t bytes =
        (size_t)face.size * (size_t)face.size * (size_t)worker.channels;
    worker.image = calloc(bytes, 1);
    if (!worker.image)
        pipe_fail(&face, "no memory");
    check(vpSetImage(c, worker.image, face.size, face.size,
                     face.size * worker.channels,
                     worker.channels == 1 ? VP_LUMINANCE : VP_RGB));
}

/* Once, after loading.  The octree serves changing transfer functions only. */
static void prepare(void) {
    size_t count = (size_t)worker.dims[0] * (size_t)worker.dims[1] *
                   (size_t)worker.dims[2];
    worker.context = vpCreateContext();
    /* A colour that changes with the value needs both materials. */
    worker.materials =
        1 +
        (worker.shaded && memcmp(worker.table[0], worker.table[PIPE_VALUES - 1],
                                 3 * sizeof(double)) != 0);
    describe_voxels();
    set_scene();
    make_voxels(count);
    worker.prepared = true;
}

/* --- pictures --- */

/* VolPack's object space has voxel i at i - n/2 in units of the longest side,
 * and a picture's pixel x at x; here a voxel is a box about its sample and a
 * pixel's middle counts: hence the two halves. */
static void set_view(double azimuth, double elevation) {
    const double radian = 0.017453292519943295769;
    double ca = cos(azimuth * radian), sa = sin(azimuth * radian);
    double ce = cos(elevation * radian), se = sin(elevation * radian);
    /* Rows right, up, back: model.md, section 2. */
    vpMatrix4 turn = {{ca, 0, -sa, 0},
                      {-se * sa, ce, -se * ca, 0},
                      {ce * sa, se, ce * ca, 0},
                      {0, 0, 0, 1}};
    double longest = 0, square = 0, move[3];
    for (int i = 0; i < 3; i++) {
        longest = fmax(longest, worker.dims[i]);
        square += (double)worker.dims[i] * worker.dims[i];
    }
    double radius = sqrt(square) / 2 / longest;
    double pixel = 2 * radius / face.size; /* in object units */
    for (int i = 0; i < 3; i++)
        move[i] = (turn[i][0] + turn[i][1] + turn[i][2]) * 0.5 / longest;
    /* The shift is no part of the model's matrix, by which VolPack turns the
     * light as well. */
    vpContext *c = worker.context;
    check(vpCurrentMatrix(c, VP_PROJECT));
    check(vpIdentityMatrix(c));
    check(vpWindow(c, VP_PARALLEL, -radius, radius, -radius, radius, -radius,
                   radius));
    check(vpScale(c, 1, 1, -1)); /* its near is where z is small */
    check(vpTranslate(c, move[0] - pixel / 2, move[1] - pixel / 2, move[2]));
    check(vpCurrentMatrix(c, VP_MODEL));
    check(vpSetMatrix(c, turn));
}

/* The head light turns with the view, so its table is made for each picture. */
static void frame(double azimuth, double elevation) {
    bool first = !worker.prepared, changed = worker.changed;
    if (first)
        prepare();
    if (changed)
        apply_table();
    if (first && worker.octree) {
        check(vpMinMaxOctreeThreshold(worker.context, 0, 4));
        check(vpCreateMinMaxOctree(worker.context, 0, 4));
    }
    set_view(azimuth, elevation);
    if (worker.shaded)
        check(vpShadeTable(worker.context));
    if (!first && changed && worker.octree) {
        check(vpRenderRawVolume(worker.context));
        return; /* the classification is still the old one: `changed` stays */
    }
    if (changed)
        check(vpClassifyVolume(worker.context));
    worker.changed = false;
    check(vpRenderClassifiedVolume(worker.context));
}

static void pixel(int x, int y, unsigned char rgb[3]) {
    const unsigned char *at =
        worker.image + ((face.size - 1 - y) * face.size + x) * worker.channels;
    for (int c = 0; c < 3; c++)
        rgb[c] = at[worker.channels == 1 ? 0 : c];
}

int main(int argc, char **argv) {
    if (argc != 10)
        pipe_fail(&face, "wants RAW X Y Z SIZE THREADS SHADED COLOUR HOW");
    worker.raw = argv[1];
    for (int i = 0; i < 3; i++)
        worker.dims[i] = atoi(argv[2 + i]);
    face.size = atoi(argv[5]);
    worker.shaded = atoi(argv[7]) != 0;
    worker.channels = atoi(argv[8]) ? 3 : 1;
    worker.octree = strcmp(argv[9], "octree") == 0;
    pipe_serve(&face);
    return 0;
}
