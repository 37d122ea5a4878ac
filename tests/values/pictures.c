/* tests/values/pictures.c - see pictures.h. */
#include "values/pictures.h"

#include "simd/isa.h"
#include "volume/volume.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Within a quarter of a step of 8 bits, but for a few samples whose place in a
 * slab, or pixels whose end, rounds otherwise. */
#define BOUND (0.25 / 255)
#define FAR_BOUND (1.0 / 255)
/* The same few with light from the side: where a normal is at right angles to
 * the line of sight, rounding decides which of its sides is lit. */
#define TURNED_BOUND (2.0 / 255)
#define FAR_SHARE 0.012
/* The steepest look takes a number to 0.9 of a step of 8 bits: where a sheet
 * between slices is rounded, half a number is more than a quarter of a step. */
#define STEEP_SHARE 0.02
/* Numbers that are coloured after the warp. */
#define NUMBER_BOUND (0.05 / 255)

/* Less than a unit of the 15 bits of the image on the lattice, and more than
 * what its warp rounds. */
#define WARP_BOUND 2e-6

static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                  SNOW_TYPE_FLOAT32, SNOW_TYPE_INT8,
                                  SNOW_TYPE_UINT16};
static const snow_quality qualities[] = {
    SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL, SNOW_QUALITY_HIGH};
static const model_matrix matrices[] = {MODEL_PLAIN, MODEL_ANISOTROPIC,
                                        MODEL_OBLIQUE, MODEL_MIRRORED};

/* Looks with none, one and several invisible ranges; a steep one. */
static const snow_opacity_point all[] = {{0, 0.05}, {100, 0.5}};
static const snow_opacity_point above[] = {
    {0, 0}, {35, 0}, {70, 0.6}, {100, 0.9}};
static const snow_opacity_point bands[] = {{0, 0},    {20, 0}, {28, 0.4},
                                           {36, 0},   {55, 0}, {64, 0.7},
                                           {72, 0.1}, {80, 0}, {100, 0}};
static const snow_opacity_point steep[] = {
    {0, 0}, {50, 0}, {51.5, 0.9}, {100, 0.9}};
static const struct {
    const snow_opacity_point *points;
    size_t count;
} looks[] = {{all, COUNT(all)},
             {above, COUNT(above)},
             {bands, COUNT(bands)},
             {steep, COUNT(steep)}};

/* Slices so far apart that there are many sheets between them. */
static void thicken(reference_scene *s, int axis, double times) {
    for (int row = 0; row < 3; row++)
        s->info.matrix[row][axis] *= times;
    s->info.spacing[axis] *= times;
}

reference_scene value_picture_scene(int n) {
    static const int64_t sizes[][3] = {{23, 19, 21}, {40, 9, 12}, {1, 14, 17},
                                       {13, 1, 9},   {12, 15, 1}, {9, 12, 2}};
    static const double backs[][3] = {{0, 0, 1},  {0, 1, 0},  {1, 0, 0},
                                      {0, 0, -1}, {0, -1, 0}, {-1, 0, 0}};
    static const double ups[][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    static const double zooms[] = {1.1, 2.6, 0.35, 5};
    static const double apart[] = {2.7, 5.5, 11, 21};
    reference_scene s =
        model_scene(sizes[n / 5 % 9 < 6 ? 0 : n % 6], types[n % 5], n / 2 % 2,
                    matrices[n / 7 % 4], (uint64_t)n);
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.settings.threads = 2;
    s.settings.quality = qualities[n % 3];
    s.settings.shade = n / 3 % 4 == 3 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    s.settings.light = SNOW_LIGHT_KEY;
    if (n / 4 % 3 == 1) {
        s.settings.light = SNOW_LIGHT_DIRECTION;
        s.settings.light_azimuth = 50;
        s.settings.light_elevation = -25;
        s.settings.shininess = 7.5;
    } else if (n / 4 % 3 == 2) {
        s.settings.light = SNOW_LIGHT_HEAD;
    }
    if (n / 6 % 5 == 2)
        s.settings.ambient = s.settings.diffuse = 0.9;
    if (n / 11 % 4 == 3)
        s.settings.threshold = 40;
    s.opacities = looks[(size_t)n / 3 % COUNT(looks)].points;
    s.opacity_count = looks[(size_t)n / 3 % COUNT(looks)].count;
    if (n % 7 == 3)
        thicken(&s, 2 - n / 2 % 3, apart[n / 7 % 4]);
    model_look(&s, backs[n / 2 % 6], ups[n / 2 % 3]);
    model_turn(&s, n % 2 ? 25 : -33, n * 37 % 70 - 35, n % 4 ? 0 : 15,
               zooms[n / 9 % 4]);
    s.view.width = 44;
    s.view.height = 36;
    return s;
}

void value_picture_free(reference_scene *s) {
    free((void *)(uintptr_t)s->voxels);
}

/* A pixel that is a data value: the value with alpha 1, or nothing. */
static void spread_value(double value, double out[4]) {
    out[1] = out[2] = 0;
    out[3] = !isnan(value);
    out[0] = isnan(value) ? 0 : value;
}

static bool is_of_values(const reference_scene *s) {
    return s->settings.mode == SNOW_MODE_MEAN ||
           s->settings.mode == SNOW_MODE_SUM;
}

double *value_picture_expected(const value_scene *scene) {
    const reference_scene *s = &scene->base;
    value_plan plan;
    size_t count = (size_t)s->view.width * (size_t)s->view.height;
    double *picture = calloc(count, 4 * sizeof *picture);
    assert_non_null(picture);
    assert_true(value_plan_of(scene, &plan));
    value_model *model = value_model_new(&plan);
    value_plan front;
    if (scene->front) {
        assert_true(value_plan_of(scene->front, &front));
        model->front = value_model_new(&front);
    }
    model->close_at =
        s->settings.quality == SNOW_QUALITY_HIGH ? 1 - 1e-4 : 1 - 0.5 / 255;
    for (size_t n = 0; n < count; n++)
        value_model_pixel(model, (int)n % s->view.width, (int)n / s->view.width,
                          picture + 4 * n);
    for (size_t n = 0; n < count && is_of_values(s); n++)
        spread_value(picture[4 * n], picture + 4 * n);
    if (model->front)
        value_model_free(model->front);
    value_model_free(model);
    return picture;
}

/* What differences of the first channel are measured by: data values by the
 * largest. */
static double unit_of(const reference_scene *s, const double *expected) {
    double most = 1e-9;
    if (!is_of_values(s))
        return 1;
    for (int n = 0; n < s->view.width * s->view.height; n++)
        most = fmax(most, fabs(expected[4 * n]));
    return most;
}

static void strengthen(const reference_scene *s, float *picture,
                       double *expected) {
    size_t count = 4 * (size_t)(s->view.width * s->view.height);
    double most = 0;
    for (size_t n = 0; n < count; n++)
        most = fmax(most, expected[n]);
    for (size_t n = 0; n < count && most > 0; n++) {
        expected[n] /= 8 * most;
        picture[n] = (float)(picture[n] / (8 * most));
    }
}

/* With a bound for the few that is `times` as wide. */
static void compare(int n, const reference_scene *s, double times,
                    const float *picture, const double *expected) {
    size_t count = 4 * (size_t)s->view.width * (size_t)s->view.height;
    size_t far = 0, worst = 0;
    double most = 0, unit = unit_of(s, expected);
    bool numbers =
        s->settings.mode != SNOW_MODE_OVER && s->settings.mode != SNOW_MODE_ISO;
    bool aside = s->settings.shade == SNOW_SHADE_PHONG &&
                 s->settings.light != SNOW_LIGHT_HEAD;
    double far_bound = numbers ? NUMBER_BOUND
                       : aside ? TURNED_BOUND
                               : FAR_BOUND;
    double share = s->opacities == steep ? STEEP_SHARE : FAR_SHARE;
    for (size_t i = 0; i < count; i++) {
        double difference = fabs((double)picture[i] - expected[i]);
        difference /= i % 4 ? 1 : unit;
        far += difference > BOUND;
        if (!(difference <= most)) {
            most = difference;
            worst = i;
        }
    }
    if (!(most <= times * far_bound) || (double)far > share * (double)count)
        fail_msg("scene %d: %g at %zu, %zu of %zu are beyond the bound", n,
                 most * 255, worst / 4, far, count);
}

void value_picture_compare(int n, const reference_scene *s,
                           const float *picture, const double *expected) {
    compare(n, s, 1, picture, expected);
}

/* --- labels --------------------------------------------------------------- */

static void set_native(const reference_scene *s, size_t at, double native) {
    void *voxels = (void *)(uintptr_t)s->voxels;
    switch (s->info.type) {
#define STORE(name, type, text)              \
    case SNOW_TYPE_##name:                   \
        ((type *)voxels)[at] = (type)native; \
        break;
        SNOW_TYPE_MAP(STORE)
#undef STORE
    case SNOW_TYPE_NONE:
        break;
    }
}

void value_picture_name(const reference_scene *s) {
    static const double labels[] = {0, 1, 2, 3, 5};
    const int64_t *dims = s->info.dims;
    size_t at = 0;
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++, at++) {
                double value = s->info.slope * reference_native(s, i, j, k) +
                               s->info.intercept;
                double layer = fmin(fmax(floor((value - 20) / 15), 0), 4);
                set_native(s, at,
                           (labels[(int)layer] - s->info.intercept) /
                               s->info.slope);
            }
}

/* --- holes and planes ----------------------------------------------------- */

void value_picture_punch(reference_scene *s, int n) {
    const int64_t *dims = s->info.dims;
    float *voxel = (float *)(uintptr_t)s->voxels;
    uint64_t state = (uint64_t)n * 2 + 1;
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++, voxel++) {
                double noise = support_uniform(&state);
                double at = (double)i / (double)dims[0] +
                            0.7 * (double)j / (double)dims[1] -
                            0.8 * (double)k / (double)dims[2];
                bool hole = n % 3 == 0   ? noise < 0.15
                            : n % 3 == 1 ? at > 0.5
                                         : at > 0.6 || noise < 0.02;
                if (hole)
                    *voxel = NAN;
            }
    s->masked = n % 4 != 3;
}

/* How far a voxel is beyond the farthest of two planes. */
static double height_of(const snow_volume_info *info, double planes[2][4],
                        size_t voxel) {
    const size_t columns = (size_t)info->dims[0], rows = (size_t)info->dims[1];
    const double at[3] = {(double)(voxel % columns),
                          (double)(voxel / columns % rows),
                          (double)(voxel / columns / rows)};
    double most = -INFINITY;
    for (int plane = 0; plane < 2; plane++) {
        double height = -planes[plane][3];
        for (int r = 0; r < 3; r++)
            height += planes[plane][r] *
                      (info->matrix[r][0] * at[0] + info->matrix[r][1] * at[1] +
                       info->matrix[r][2] * at[2] + info->matrix[r][3]);
        most = fmax(most, height);
    }
    return most;
}

/* Moves the largest and the smallest voxel to where planes leave them: the
 * model's numbers are of the whole volume, the method's of what is left. */
static void keep_range(const reference_scene *s, double planes[2][4]) {
    const int64_t *dims = s->info.dims;
    size_t count = (size_t)(dims[0] * dims[1] * dims[2]);
    size_t size = snow_type_size(s->info.type), ends[2] = {0}, inner[2] = {0};
    char *voxels = (char *)(uintptr_t)s->voxels;
    for (int side = 0; side < 2; side++) {
        inner[side] = side && inner[0] == 0;
        for (size_t n = 0; n < count; n++) {
            double a = reference_native(s, (int64_t)n % dims[0],
                                        (int64_t)n / dims[0] % dims[1],
                                        (int64_t)n / dims[0] / dims[1]);
            size_t e = ends[side];
            double b = reference_native(s, (int64_t)e % dims[0],
                                        (int64_t)e / dims[0] % dims[1],
                                        (int64_t)e / dims[0] / dims[1]);
            if (side ? a > b : a < b)
                ends[side] = n;
            if (!(side && n == inner[0]) &&
                height_of(&s->info, planes, n) <
                    height_of(&s->info, planes, inner[side]))
                inner[side] = n;
        }
    }
    char both[2][8];
    for (int side = 0; side < 2; side++)
        memcpy(both[side], voxels + ends[side] * size, size);
    for (int side = 0; side < 2; side++)
        memcpy(voxels + inner[side] * size, both[side], size);
}

/* Two planes through the volume. */
static void place_planes(const snow_volume_info *info, double planes[2][4]) {
    const double normals[2][3] = {{0.6, 0.3, -0.5}, {-0.2, 0.9, 0.4}};
    for (int plane = 0; plane < 2; plane++) {
        planes[plane][3] = 0;
        for (int r = 0; r < 3; r++) {
            double middle = info->matrix[r][3];
            for (int c = 0; c < 3; c++)
                middle += info->matrix[r][c] * (double)(info->dims[c] - 1) *
                          (plane ? 0.8 : 0.6);
            planes[plane][r] = normals[plane][r];
            planes[plane][3] += normals[plane][r] * middle;
        }
    }
}

void value_picture_clip(value_scene *scene, size_t count, double planes[2][4]) {
    place_planes(&scene->base.info, planes);
    keep_range(&scene->base, planes);
    scene->clips = (const double(*)[4])planes;
    scene->clip_count = count;
}

/* --- by the method -------------------------------------------------------- */

/* The scene's volume without what its planes leave out. */
static snow_volume *open_volume(const model_stage *stage,
                                const value_scene *scene) {
    snow_volume *volume = NULL, *cut = NULL;
    const reference_scene *s = &scene->base;
    assert_int_equal(
        snow_volume_wrap(stage->context, &s->info, s->voxels, &volume),
        SNOW_STATUS_OK);
    volume->masked = s->masked;
    if (!scene->clip_count)
        return volume;
    assert_int_equal(
        snow_volume_clip(volume, scene->clips[0], scene->clip_count, &cut),
        SNOW_STATUS_OK);
    snow_volume_close(volume);
    return cut;
}

static float *spread_values(snow_image *image) {
    size_t count =
        (size_t)snow_image_width(image) * (size_t)snow_image_height(image);
    const float *from = snow_image_pixels(image);
    float *to = calloc(count * 4, sizeof *to);
    assert_int_equal(snow_image_channels(image), 1);
    assert_non_null(to);
    for (size_t n = 0; n < 4 * count; n++) {
        double pixel[4];
        spread_value((double)from[n / 4], pixel);
        to[n] = (float)pixel[n % 4];
    }
    return to;
}

float *value_picture_render(const model_stage *stage,
                            const value_scene *scene) {
    const reference_scene *s = &scene->base;
    snow_volume *volume = open_volume(stage, scene);
    snow_transfer *transfer = model_transfer(stage->context, s);
    snow_image *image = NULL;
    snow_volume *front = NULL;
    snow_transfer *look = NULL;
    if (scene->front) {
        front = open_volume(stage, scene->front);
        look = model_transfer(stage->context, &scene->front->base);
    }
    const snow_inlay layer = {front, look, scene->mixes};
    assert_int_equal(
        snow_frame_set_inlays(stage->frame, &layer, scene->front != NULL),
        SNOW_STATUS_OK);
    if (snow_frame_render(stage->frame, volume, transfer, &s->view,
                          &s->settings, &image) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(stage->context));
    assert_int_equal(snow_frame_stats(stage->frame)->method,
                     SNOW_METHOD_SHEAR_WARP);
    float *picture =
        is_of_values(s) ? spread_values(image) : model_spread(image);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_transfer_free(look);
    snow_volume_close(front);
    snow_image_free(image);
    return picture;
}

void value_picture_check(const model_stage *stage, int n,
                         const value_scene *scene) {
    float *picture = value_picture_render(stage, scene);
    double *expected = value_picture_expected(scene);
    /* Colours of channels add up, and what rounds otherwise of them. */
    compare(n, &scene->base, scene->mixes ? 2 : 1, picture, expected);
    free(picture);
    free(expected);
}

/* The second picture is freed. */
static void same_bits(int n, const reference_scene *s, const float *first,
                      float *other) {
    if (memcmp(first, other,
               4 * (size_t)(s->view.width * s->view.height) * sizeof *first) !=
        0)
        fail_msg("scene %d: other bits", n);
    free(other);
}

/* The image on the lattice has the same bits; its warp in plain C rounds
 * products and sums apart. */
static void check_levels(const model_stage *stage, int n, value_scene scene) {
    size_t count = 4 * (size_t)(scene.base.view.width * scene.base.view.height);
    scene.base.settings.isa = SNOW_ISA_SCALAR;
    float *plain = value_picture_render(stage, &scene), *first = NULL;
    for (snow_isa isa = SNOW_ISA_AVX2; isa <= SNOW_ISA_AVX512; isa++) {
        if (!snow_isa_runs(isa))
            continue;
        scene.base.settings.isa = isa;
        float *other = value_picture_render(stage, &scene);
        for (size_t i = 0; i < count; i++)
            if (!(fabs((double)other[i] - (double)plain[i]) <= WARP_BOUND))
                fail_msg("scene %d: other bits of an instruction set", n);
        if (first)
            same_bits(n, &scene.base, first, other);
        else
            first = other;
    }
    free(plain);
    free(first);
}

void value_picture_check_bits(const model_stage *stage, int n,
                              const value_scene *scene) {
    value_scene other = *scene;
    snow_settings *settings = &other.base.settings;
    settings->threads = 1;
    settings->encoding = SNOW_ENCODING_BITMAP;
    float *first = value_picture_render(stage, &other);
    settings->threads = 5;
    same_bits(n, &other.base, first, value_picture_render(stage, &other));
    settings->encoding = SNOW_ENCODING_CRS;
    same_bits(n, &other.base, first, value_picture_render(stage, &other));
    settings->encoding = SNOW_ENCODING_RLE;
    same_bits(n, &other.base, first, value_picture_render(stage, &other));
    free(first);
    check_levels(stage, n, other);
}

typedef void check_fn(const model_stage *stage, int n,
                      const value_scene *scene);

static void check_each(int first, int step, value_scene_fn *make,
                       check_fn *check) {
    model_stage stage = model_open();
    for (int n = first; n < VALUE_PICTURES; n += step) {
        value_scene scene = make(n);
        check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

void value_pictures_check(int first, int step, value_scene_fn *scene) {
    check_each(first, step, scene, value_picture_check);
}

void value_pictures_check_bits(int first, int step, value_scene_fn *scene) {
    check_each(first, step, scene, value_picture_check_bits);
}

void value_picture_check_faint(const model_stage *stage, int n,
                               const value_scene *scene) {
    float *picture = value_picture_render(stage, scene);
    double *expected = value_picture_expected(scene);
    strengthen(&scene->base, picture, expected);
    value_picture_compare(n, &scene->base, picture, expected);
    free(picture);
    free(expected);
}
