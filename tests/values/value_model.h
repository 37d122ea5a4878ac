/* tests/values/value_model.h - the value model, computed slowly.
 *
 * A float64 transcription of the value model in docs/model.md: values are
 * splatted, colours come after.  Every sample of the lattice is computed from
 * the voxels alone, and every pixel from the samples around it; nothing is kept
 * from sheet to sheet.  Integers of the model are integers here too.  It shares
 * no code with the library; the camera, the look and the voxels are those of
 * reference/reference.h. */
#ifndef SNOW_TEST_VALUE_MODEL_H
#define SNOW_TEST_VALUE_MODEL_H

#include "reference/reference.h"

/* A value of a sheet that is none: a hole. */
#define VALUE_HOLE INT32_MIN
#define VALUE_MOST 16383
#define VALUE_FULL 16384 /* the weight of a voxel that is there */

/* What decides a picture, beside a scene.  Arrays are the caller's. */
typedef struct value_scene {
    reference_scene base; /* method, encoding, kernel, threads do not matter */
    bool cubic;           /* --kernel bspline */
    bool labels;          /* voxels are labels */
    const struct value_scene *front; /* a layer on the same grid, or NULL */
    bool mixes;                      /* that is mixed with it, as a channel */
    bool cropped;      /* the field is seen within `keep` only, which are */
    double keep[3][2]; /* index positions along x, y, z */
    const double (*clips)[4]; /* seen is a x + b y + c z <= d of the world */
    size_t clip_count;
} value_scene;

typedef enum value_warp {
    VALUE_WARP_BILINEAR,
    VALUE_WARP_CATMULL_ROM,
    VALUE_WARP_MEAN /* of bi-linear samples over a pixel */
} value_warp;

/* The model's choices for a scene.  A test may change some of them before it
 * makes a model, to see what they are worth.  Axes are in the order u, v, p. */
typedef struct value_plan {
    const value_scene *scene;
    reference_camera camera;
    int axis[3];
    int64_t dims[3];
    double length[3]; /* of a voxel's step in the world */
    int direction;    /* 1: p grows away from the eye; -1: it falls */
    double first;     /* p of the front sheet */
    int sheets;       /* from 0, the nearest to the eye */
    int per_slice;    /* sheets: 1, or an even number */
    bool perspective;
    double slope[2];  /* parallel: u, v per p along a ray */
    double eye[3];    /* perspective: index position */
    int cells[2];     /* of the lattice, a voxel, along u and v */
    bool quincunx;    /* a second sample in the middle of each cell */
    int nodes, steps; /* of the table, along each side; in an entry */
    bool measured;    /* nodes are placed by the look */
    value_warp warp;
    int halvings;     /* of the lattice image by boxes, before the warp */
    int mean;         /* samples a side of a pixel */
    double low, high; /* data values of V = 0 and V = 16383 */
    int stored;       /* of integers: steps from low to the highest */
    double step;      /* of a native value, in data units */
    double path;      /* world length of a slab in the table */
    bool plain_fade;  /* experiments only: gradient opacity as a factor */
    bool exact_cut;   /* experiments only: values at cuts from the voxels */
} value_plan;

/* False where the model has no picture: the eye is not before the first slice
 * or behind the last one, or there is nothing to draw. */
bool value_plan_of(const value_scene *scene, value_plan *plan);

/* The choices that depend on others, after a change of sheets or low, high. */
void value_plan_sheets(value_plan *plan, int per_slice);
double value_plan_path(const value_plan *plan);

/* How integers become numbers: V of step n is (t weight + 2^14) / 2^15, rounded
 * down, with t = n factor / divisor. */
typedef struct value_rule {
    int64_t factor, divisor, weight;
} value_rule;

value_rule value_rule_of(int steps);

/* An entry of the table: 15 bits each, in units of the table, and the place of
 * the opacity in sixteenths of the slab. */
typedef struct value_entry {
    int color[3], alpha, place;
} value_entry;

typedef struct value_table {
    int nodes;
    double *at; /* V of each node */
    uint8_t index[VALUE_MOST + 1];
    value_entry *entries; /* nodes x nodes, front first */
    double unit; /* an alpha of 1 in an entry: 1 / 32767, less of faint looks */
} value_table;

void value_table_make(const value_plan *plan, value_table *table);
void value_table_free(value_table *table);

/* The look at a value V; nothing where it is below the threshold. */
void value_look(const value_plan *plan, double v, double rgba[4]);

/* The field: voxels as integers, in the order u, v, p. */
typedef struct value_field {
    const value_plan *plan;
    int *codes;    /* 0 to 16383, VALUE_HOLE; of labels their numbers */
    double *names; /* of labels: the value of each number */
    int name_count;
    int member; /* of labels: sheets are the membership of this one */
} value_field;

/* The data value of a voxel at (i, j, k), in mode over its logarithm where the
 * look is one of logarithms; NaN where it has none. */
double value_data(const value_scene *scene, const int64_t at[3]);

void value_field_make(const value_plan *plan, value_field *field);
void value_field_free(value_field *field);

/* The number of a voxel of the box. */
int value_code(const value_field *field, const int64_t at[3]);

/* What a sheet has at (u, v): V, or VALUE_HOLE; the number of the nearest
 * label, or VALUE_HOLE. */
int value_sheet(const value_field *field, int sheet, double u, double v);
int value_sheet_label(const value_field *field, int sheet, double u, double v);

/* One voxel of a sheet, for kernels: its value times its weight, and its weight
 * of 16384; beyond the box by the model's rule. */
typedef struct value_part {
    int64_t value, weight;
} value_part;

value_part value_voxel(const value_field *field, int sheet, int64_t i,
                       int64_t j);

/* The integers' arithmetic: a number of 16 bits that saturates; x w / 32768
 * rounded; a + (b - a) w / 32768. */
int value_saturate(int64_t x);
int value_scale(int64_t x, int w);
int value_between(int a, int b, int w);
int value_weight(double part);

/* --- a lattice sample ----------------------------------------------------- */

/* The ray of a lattice sample: where it meets the front sheet, by how much it
 * moves per p, the world length of a slab and the direction to the eye. */
typedef struct value_ray {
    double front[2], slope[2], path;
    double eye[3]; /* index positions in the order u, v, p, per world unit */
} value_ray;

value_ray value_ray_of(const value_plan *plan, double front_u, double front_v);
double value_sheet_at(const value_plan *plan, int sheet);
void value_ray_at(const value_plan *plan, const value_ray *ray, double sheet,
                  double at[3]);

/* The front position of a lattice sample, and back. */
void value_lattice_front(const value_plan *plan, double a, double b,
                         double front[2]);
void value_lattice_of(const value_plan *plan, const double front[2],
                      double ab[2]);

/* The lattice position of an image point; false where its ray does not meet
 * the front sheet before the eye. */
bool value_lattice_at(const value_plan *plan, double x, double y, double ab[2]);

/* The part of a slab that is seen, of 32768; false when nothing is. */
bool value_cut(const value_plan *plan, const value_ray *ray, int slab,
               int part[2]);

/* Twice the gradient of a slab at `place` of 32768, in index space and the
 * order u, v, p, in units of V. */
void value_gradient(const value_field *field, const value_ray *ray, int slab,
                    int place, double gradient[3]);

/* Adds twice that of what is there, smoothly, by which the border of holes is
 * lit. */
void value_add_border(const value_field *field, const value_ray *ray, int slab,
                      int place, double gradient[3]);

/* Premultiplied colours that are shaded: from colour and alpha of an entry and
 * a gradient as above. */
void value_shade(const value_plan *plan, const value_ray *ray,
                 const double gradient[3], double rgba[4]);

/* The gradient opacity of a slab whose value at the gradient's place is `v`: as
 * if its opacity were that of a slab of one opacity, times the factor. */
void value_fade(const value_plan *plan, const double gradient[3], double v,
                double rgba[4]);

/* Alpha and colours of `share` times the length. */
void value_lengthen(double rgba[4], double share);

/* A slab of a scene of labels: colours and, where it has any, the label that is
 * seen most and the place of its opacity of 32768; false where it has none. */
bool value_label_slab(value_field *field, const value_ray *ray, int slab,
                      const int part[2], double rgba[4], int *place);

/* What a ray of modes other than over has: of iso RGBA, else the value and 1 or
 * 0. */
void value_mode_sample(const value_field *field, const value_ray *ray,
                       double out[4]);

/* --- pictures ------------------------------------------------------------- */

typedef struct value_model {
    value_plan plan;
    value_field field;
    value_table table;
    struct value_model *front; /* of the layer in front, or NULL */
    double close_at;           /* rays end at this alpha; above 1: never */
    /* Lattice samples that were computed. */
    int64_t first[2], size[2];
    double (*samples)[4];
    bool *known;
} value_model;

/* Ends the test where there is no memory.  Free with value_model_free. */
value_model *value_model_new(const value_plan *plan);
void value_model_free(value_model *model);

/* A lattice sample; transparent beyond the volume's shadow.  Of over and iso
 * RGBA, else the value and whether there is one. */
void value_model_sample(value_model *model, int64_t a, int64_t b,
                        double out[4]);

/* A pixel: premultiplied RGBA; of mean and sum out[0] in data units, NaN where
 * a ray misses. */
void value_model_pixel(value_model *model, int x, int y, double out[4]);

/* The whole picture by the model's own choices: width * height * 4 doubles, of
 * mean and sum width * height.  NULL where the model has none. */
double *value_model_render(const value_scene *scene);

/* --- a fine ray caster ---------------------------------------------------- */

/* The truth that the model is held against: tri-linear values along a ray every
 * `fine`-th of the smallest spacing, classified, shaded by central differences
 * of the interpolated field, composited.  It knows crops and clip planes, and
 * the modes over, mip, minip, mean and sum; no holes. */
typedef struct value_truth value_truth;
value_truth *value_truth_new(const value_scene *scene, int fine);
void value_truth_pixel(const value_truth *truth, double x, double y,
                       double out[4]);
void value_truth_free(value_truth *truth);

#endif
