/* tests/render/test_shear_warp_perspective.c - the sheared method in
 * perspective: against a float64 transcription of itself, and against the exact
 * picture. */
#include "classify/sample/opacity_correction.h"
#include "reference/model.h"
#include "splat/separable/rake.h"
#include "transform/shear_perspective.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))
static const model_stand stands[] = {
    {{0, 0, 1}, {0, 1, 0}, 0, 0, 0},   {{0, 0, -1}, {0, 1, 0}, 0, 0, 0},
    {{0, 1, 0}, {0, 0, 1}, 0, 0, 0},   {{0, -1, 0}, {0, 0, 1}, 0, 0, 0},
    {{1, 0, 0}, {0, 0, 1}, 0, 0, 0},   {{-1, 0, 0}, {0, 0, 1}, 0, 0, 90},
    {{0, 0, 1}, {0, 1, 0}, 30, 20, 0}, {{0, 1, 0}, {0, 0, 1}, -120, -35, 25},
    {{1, 0, 0}, {0, 0, 1}, 90, 40, 0}, {MODEL_ISO, 0, 0, 0},
};

static void stand_at(reference_scene *scene, size_t n, double zoom) {
    model_stand_at(scene, &stands[n % COUNT(stands)], zoom);
}

/* --- opacities and weights ------------------------------------------------ */

/* Against pow(), for every exponent that a view can have, and then some. */
static void opacities_of_rays_are_within_a_quarter_step(void **state) {
    (void)state;
    enum { CODES = 256 };
    float palette[(CODES + 1) * 4] = {0};
    unsigned char codes[CODES + 128];
    double largest = 0, share = 0;
    for (int n = 0; n < CODES; n++) {
        codes[n] = (unsigned char)n;
        palette[4 * (n + 1)] = 1;
        palette[4 * (n + 1) + 3] =
            n == 255 ? SNOW_OPAQUE : (float)log2(1 - n / 255.0);
    }
    for (int isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX512; isa++) {
        if (!snow_isa_runs((snow_isa)isa))
            continue;
        snow_ray_sample_fn *sample =
            snow_ray_sample_of((snow_isa)isa, 1, 4, false, false);
        for (double base = 0.001; base < 300; base *= 1.37)
            for (int at = 0; at < CODES - 16; at += 16) {
                /* The root of a square whose root is linear: base + x / 40. */
                float square[3] = {(float)(base * base), (float)(base / 20),
                                   1.0f / 1600};
                float samples[(16 + 16) * 4];
                sample(codes + at, NULL, NULL, 0xFFFF, 16, palette + 4, NULL,
                       square, samples);
                for (int x = 0; x < 16; x++) {
                    double a = (at + x) / 255.0;
                    double exact = 1 - pow(1 - a, base + x / 40.0);
                    double error = fabs((double)samples[4 * x + 3] - exact);
                    largest = fmax(largest, error);
                    if (exact > 1e-6)
                        share = fmax(share, error / exact);
                    assert_true(samples[4 * x] == samples[4 * x + 3]);
                }
            }
    }
    print_message("             differ by up to %.2g, %.2g of themselves\n",
                  largest, share);
    assert_true(largest < 1e-5 && share < 1e-4);
}

static void voxels_that_are_not_there_leave_nothing(void **state) {
    (void)state;
    float palette[2 * 2] = {0, 0, 1, -1}, square[3] = {1, 0, 0};
    unsigned char codes[128] = {0};
    float samples[(40 + 16) * 2];
    snow_ray_sample_of(SNOW_ISA_SCALAR, 1, 2, false,
                       false)(codes, NULL, NULL, UINT64_C(1) << 7, 40,
                              palette + 2, NULL, square, samples);
    for (int n = 0; n < 40; n++) {
        assert_true(fabsf(samples[2 * n] - (n == 7 ? 0.5f : 0)) < 1e-6f);
        assert_true(n == 7 || samples[2 * n + 1] == 0);
    }
}

static void a_rake_has_the_weights_of_its_kernel(void **state) {
    (void)state;
    uint64_t random = 3;
    double largest = 0;
    for (int kernel = 0; kernel < 4; kernel++)
        for (int support = 2; support <= 9; support++)
            for (double rho = 0.5; rho < 4; rho *= 1.6) {
                enum { PIXELS = 150 };
                static float weights[SNOW_TAPS_MOST * PIXELS];
                int32_t first[PIXELS];
                snow_scaled_kernel taper =
                    snow_scaled_kernel_make((snow_kernel)kernel, support, rho);
                snow_rake rake = {taper, snow_comb_taps(&taper),
                                  40 * support_uniform(&random) - 20,
                                  0.3 + support_uniform(&random), PIXELS};
                if (rake.taps > SNOW_TAPS_MOST)
                    continue;
                snow_rake_fill(&rake, 0, PIXELS, PIXELS, first, weights);
                for (int n = 0; n < PIXELS; n++) {
                    double place = rake.start + n * rake.step;
                    assert_int_equal(first[n], snow_rake_first(&rake, n));
                    for (int m = 0; m < rake.taps; m++) {
                        double exact = snow_scaled_kernel_weight(
                            &taper, place - (double)(first[n] + m));
                        largest =
                            fmax(largest,
                                 fabs((double)weights[m * PIXELS + n] - exact));
                    }
                }
            }
    assert_true(largest < 2e-6);
}

/* --- the transcription ---------------------------------------------------- */

/* What render/shear_warp/perspective.c does, in double: samples of all slices
 * on one lattice, laid over each other there, and one warp.  Only where the
 * lattice lies is the library's word. */
typedef struct transcript {
    const reference_scene *scene;
    reference_camera camera;
    snow_perspective_shear scaled;
    int axis, u_axis, v_axis;
    const double *samples;
    double *plane;
} transcript;

/* The rule of the lattice's pitch. */
static double widest_pitch(double wide, bool draft) {
    double share = wide < 1.1 ? 0.6 : fmin(0.6 + (wide - 1.1), 0.7);
    return fmin((draft ? 0.99 : share) * wide, 2);
}

static void tapers_of(const transcript *t, const snow_placement *p, int64_t k,
                      snow_scaled_kernel taper[2]) {
    bool draft = t->scene->settings.quality == SNOW_QUALITY_DRAFT;
    snow_kernel kernel = draft ? SNOW_KERNEL_TENT : t->scene->settings.kernel;
    double width[2];
    snow_perspective_pixel_width(p, (double)k, width);
    for (int n = 0; n < 2; n++)
        taper[n] = snow_scaled_kernel_make(
            kernel, draft ? 2 : reference_support(&t->scene->settings),
            width[n]);
}

static void lay_lattice(transcript *t, const snow_placement *p,
                        snow_context *context) {
    bool draft = t->scene->settings.quality == SNOW_QUALITY_DRAFT;
    double reach[2][64];
    snow_perspective_shear_options options = {.pitch = {INFINITY, INFINITY},
                                              .reach = {reach[0], reach[1]}};
    double ends[2] = {fabs(p->eye.at[2]),
                      fabs((double)p->slices - 1 - p->eye.at[2])};
    for (int64_t k = 0; k < p->slices; k++) {
        snow_scaled_kernel taper[2];
        tapers_of(t, p, k, taper);
        for (int n = 0; n < 2; n++) {
            double step =
                fabs((double)k - p->eye.at[2]) / fmin(ends[0], ends[1]);
            reach[n][k] = snow_scaled_kernel_reach(&taper[n]);
            options.pitch[n] = fmin(options.pitch[n],
                                    widest_pitch(taper[n].wide, draft) / step);
        }
    }
    assert_int_equal(
        snow_perspective_shear_make(context, p, &options, &t->scaled),
        SNOW_STATUS_OK);
}

/* One slice on the lattice, behind what is there. */
static void lay_slice(transcript *t, const snow_placement *p, int64_t k) {
    const int64_t *dims = t->scene->info.dims;
    double step = ((double)k - p->eye.at[2]) / t->scaled.height;
    double u_weights[64], v_weights[64];
    snow_scaled_kernel taper[2];
    tapers_of(t, p, k, taper);
    for (int y = 0; y < t->scaled.v.count; y++)
        for (int x = 0; x < t->scaled.u.count; x++) {
            double *pixel = t->plane + 4 * (y * t->scaled.u.count + x);
            double u = (double)(t->scaled.u.first + x) * t->scaled.u.pitch;
            double v = (double)(t->scaled.v.first + y) * t->scaled.v.pitch;
            int64_t u0, u1, v0, v1, at[3];
            double sheet[4] = {0};
            u = p->eye.at[0] + (u - p->eye.at[0]) * step;
            v = p->eye.at[1] + (v - p->eye.at[1]) * step;
            reference_weights(taper[0].kernel, taper[0].support, taper[0].wide,
                              u, p->columns, u_weights, &u0, &u1);
            reference_weights(taper[1].kernel, taper[1].support, taper[1].wide,
                              v, p->rows, v_weights, &v0, &v1);
            for (int64_t j = v0; j <= v1; j++)
                for (int64_t i = u0; i <= u1; i++) {
                    at[t->axis] = k, at[t->u_axis] = i, at[t->v_axis] = j;
                    size_t voxel =
                        (size_t)((at[2] * dims[1] + at[1]) * dims[0] + at[0]);
                    for (int c = 0; c < 4; c++)
                        sheet[c] += u_weights[i] * v_weights[j] *
                                    t->samples[4 * voxel + (size_t)c];
                }
            double through = 1 - pixel[3];
            for (int c = 0; c < 4; c++)
                pixel[c] += through * sheet[c];
        }
}

static double keys(double t) { /* Catmull and Rom's cubic */
    t = fabs(t);
    if (t < 1)
        return 1 - 2.5 * t * t + 1.5 * t * t * t;
    return t < 2 ? 2 - 4 * t + 2.5 * t * t - 0.5 * t * t * t : 0;
}

static double linear(double t) {
    return fmax(0, 1 - fabs(t));
}

static double plane_at(const transcript *t, int x, int y, int c) {
    if (x < 0 || y < 0 || x >= t->scaled.u.count || y >= t->scaled.v.count)
        return 0;
    return t->plane[4 * (y * t->scaled.u.count + x) + c];
}

/* The picture at pixel (x, y): where its ray meets the plane of the lattice. */
static void warp_pixel(const transcript *t, const snow_placement *p, int x,
                       int y, double pixel[4]) {
    bool draft = t->scene->settings.quality == SNOW_QUALITY_DRAFT;
    reference_ray ray =
        reference_ray_at(t->scene, &t->camera, x + 0.5, y + 0.5);
    double k0 = t->scaled.height + p->eye.at[2];
    double along = (k0 - ray.start[t->axis]) / ray.step[t->axis];
    double at[2] = {ray.start[t->u_axis] + along * ray.step[t->u_axis],
                    ray.start[t->v_axis] + along * ray.step[t->v_axis]};
    memset(pixel, 0, 4 * sizeof *pixel);
    if (!(along > 0) || !isfinite(along))
        return;
    at[0] = at[0] / t->scaled.u.pitch - (double)t->scaled.u.first;
    at[1] = at[1] / t->scaled.v.pitch - (double)t->scaled.v.first;
    if (!(fabs(at[0]) < 1e6 && fabs(at[1]) < 1e6))
        return;
    int left = (int)floor(at[0]) - 1, top = (int)floor(at[1]) - 1;
    for (int j = top; j < top + 4; j++)
        for (int i = left; i < left + 4; i++)
            for (int c = 0; c < 4; c++)
                pixel[c] += (draft ? linear(at[0] - i) * linear(at[1] - j)
                                   : keys(at[0] - i) * keys(at[1] - j)) *
                            plane_at(t, i, j, c);
    pixel[3] = fmin(fmax(pixel[3], 0), 1);
    for (int c = 0; c < 3; c++)
        pixel[c] = fmin(fmax(pixel[c], 0), pixel[3]);
}

static double *transcribe(snow_context *context, const reference_scene *scene) {
    transcript t = {.scene = scene};
    snow_placement p;
    reference_camera_of(scene, &t.camera);
    assert_int_equal(
        snow_placement_make(context, &scene->info, &scene->view, &p),
        SNOW_STATUS_OK);
    t.axis = p.slice_axis, t.u_axis = p.u_axis, t.v_axis = p.v_axis;
    double *samples = reference_samples(scene, &t.camera, t.axis);
    t.samples = samples;
    lay_lattice(&t, &p, context);
    t.plane =
        calloc((size_t)t.scaled.u.count * (size_t)t.scaled.v.count * 4 + 1,
               sizeof(double));
    for (int64_t n = 0; n < p.slices; n++)
        lay_slice(&t, &p, p.nearest_first ? n : p.slices - 1 - n);
    size_t width = (size_t)scene->view.width;
    double *picture =
        calloc(width * (size_t)scene->view.height * 4, sizeof *picture);
    for (int y = 0; y < scene->view.height; y++)
        for (int x = 0; x < scene->view.width; x++)
            warp_pixel(&t, &p, x, y,
                       picture + 4 * ((size_t)y * width + (size_t)x));
    free(t.plane);
    free(samples);
    return picture;
}

static void pictures_are_those_of_the_method_in_double(void **state) {
    (void)state;
    static const double fovs[] = {5, 30, 60, 100};
    static const double zooms[] = {0.3, 1, 3, 8};
    static const int64_t sizes[][3] = {
        {13, 10, 15}, {50, 34, 21}, {21, 60, 40}};
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16};
    model_stage stage = model_open();
    double largest[2] = {0, 0};
    int sheared = 0, pictures = 0;
    for (size_t n = 0; n < 72; n += support_stride(7)) {
        reference_scene scene =
            model_scene(sizes[n % 3], types[n % 2], n / 2 % 2 == 0,
                        (model_matrix)(n % MODEL_MATRICES), n);
        if (n / 2 % 3 == 1)
            model_fade(&scene);
        stand_at(&scene, n, zooms[n / 7 % 4]);
        scene.view.fov = fovs[n / 3 % 4];
        scene.view.width = 40 + (int)(n % 5) * 9;
        scene.view.height = 36;
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        scene.settings.shade = SNOW_SHADE_NONE; /* normals are of 16 bits */
        scene.settings.kernel = (snow_kernel)(n / 5 % 3); /* the box jumps */
        scene.settings.quality =
            n % 4 == 3 ? SNOW_QUALITY_DRAFT : SNOW_QUALITY_NORMAL;
        if (scene.settings.quality == SNOW_QUALITY_DRAFT)
            scene.settings.kernel = SNOW_KERNEL_BSPLINE;
        /* Where nothing becomes opaque nothing is given up. */
        bool clear = n % 2 == 0;
        scene.settings.opacity_length = clear ? 30 : 0;
        float *picture = model_picture(&stage, &scene);
        pictures++;
        if (snow_frame_stats(stage.frame)->method == SNOW_METHOD_SHEAR_WARP) {
            double *exact = transcribe(stage.context, &scene);
            double distance = model_distance(&scene, picture, exact);
            sheared++;
            if (!(distance < (clear ? 1e-4 : 0.5 / 255 + 1e-4)))
                fail_msg("differs by %g: fov %g, %s", distance, scene.view.fov,
                         model_words(&scene));
            largest[clear] = fmax(largest[clear], distance);
            free(exact);
        }
        free(picture);
        model_free(&scene);
    }
    print_message(
        "             %d pictures of %d differ by up to %.2g, or %.2g "
        "where something is opaque\n",
        sheared, pictures, largest[1], largest[0]);
    assert_true(sheared * (int)support_stride(7) > 60);
    model_close(&stage);
}

/* --- against the exact picture -------------------------------------------- */

/* A few soft balls, opaque in their middle. */
static reference_scene soft_scene(const int64_t dims[3], int n) {
    static const snow_opacity_point rise[] = {{0.1, 0}, {1, 0.5}};
    static const snow_color_point colors[] = {{0, 0.2, 0.5, 0.9},
                                              {1, 1, 0.7, 0.2}};
    reference_scene scene = model_blank(dims, 0.5);
    free((void *)(uintptr_t)scene.opacities);
    scene.opacities = rise;
    scene.opacity_count = COUNT(rise);
    scene.colors = colors;
    scene.color_count = COUNT(colors);
    float *voxel = model_voxels(&scene);
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++) {
                double x = (double)i / (double)dims[0] - 0.4;
                double y = (double)j / (double)dims[1] - 0.6;
                double z = (double)k / (double)dims[2] - 0.5;
                double ball = exp(-9 * (x * x + y * y + z * z));
                *voxel++ = (float)(ball * (0.8 + 0.2 * sin(7 * x + 5 * z + n)));
            }
    return scene;
}

static double psnr(const reference_scene *scene, const float *a,
                   const float *b) {
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height * 4;
    double sum = 0;
    for (size_t n = 0; n < count; n++)
        sum += (double)(a[n] - b[n]) * (double)(a[n] - b[n]);
    return 10 * log10((double)count / sum);
}

static void smooth_scenes_are_near_the_exact_picture(void **state) {
    (void)state;
    static const double fovs[] = {5, 30, 60, 100};
    static const double zooms[] = {0.3, 1, 2, 8};
    model_stage stage = model_open();
    double least = INFINITY;
    int sheared = 0;
    for (size_t n = 0; n < COUNT(stands) * 16; n += support_stride(7)) {
        reference_scene scene = soft_scene((int64_t[]){48, 40, 36}, (int)n);
        if (n % 3 == 1)
            scene.info.matrix[1][1] = 1.7; /* anisotropic */
        if (n % 3 == 2)
            scene.info.matrix[0][2] = 0.4; /* oblique */
        stand_at(&scene, n, zooms[n / COUNT(stands) % 4]);
        scene.view.fov = fovs[n / COUNT(stands) / 4];
        scene.view.width = scene.view.height = 80;
        scene.settings.shade = n % 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
        float *exact = model_picture(&stage, &scene);
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        float *fast = model_picture(&stage, &scene);
        double near = psnr(&scene, fast, exact);
        if (snow_frame_stats(stage.frame)->method == SNOW_METHOD_SHEAR_WARP)
            sheared++;
        if (!(near >= 50))
            fail_msg("%.1f dB: fov %g, %s", near, scene.view.fov,
                     model_words(&scene));
        least = fmin(least, near);
        free(exact);
        free(fast);
        free((void *)(uintptr_t)scene.voxels);
    }
    print_message("             %d sheared pictures, %.1f dB and more\n",
                  sheared, least);
    assert_true(sheared * (int)support_stride(7) > 120);
    model_close(&stage);
}

/* --- promises ------------------------------------------------------------- */

static void compare_with(const model_stage *stage, reference_scene *scene,
                         const float *first, double bound) {
    float *picture = model_picture(stage, scene);
    size_t floats = (size_t)scene->view.width * (size_t)scene->view.height * 4;
    for (size_t n = 0; n < floats; n++)
        if (!(fabs((double)picture[n] - (double)first[n]) <= bound))
            fail_msg("%zu: %.9g is not %.9g", n, (double)picture[n],
                     (double)first[n]);
    free(picture);
}

static void threads_encodings_and_levels_do_not_matter(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (size_t n = 0; n < 12; n += support_stride(5)) {
        reference_scene scene = model_scene(
            (int64_t[]){130, 70, 90}, n % 2 ? SNOW_TYPE_UINT8 : SNOW_TYPE_INT16,
            n % 3 == 0, (model_matrix)(n % MODEL_MATRICES), n);
        stand_at(&scene, n, n % 4 == 3 ? 4 : 1);
        scene.view.fov = n % 2 ? 30 : 55;
        scene.view.width = 150, scene.view.height = 130;
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        scene.settings.quality = (snow_quality)(n % 3);
        scene.settings.threads = 1;
        float *first = model_picture(&stage, &scene);
        assert_int_equal(snow_frame_stats(stage.frame)->method,
                         SNOW_METHOD_SHEAR_WARP);
        for (int threads = 2; threads < 8; threads += 3) {
            scene.settings.threads = threads;
            scene.settings.encoding = (snow_encoding)(threads % 4);
            compare_with(&stage, &scene, first, 0);
        }
        scene.settings.encoding = SNOW_ENCODING_RLE;
        compare_with(&stage, &scene, first, 0);
        for (int isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX512; isa++)
            if (snow_isa_runs((snow_isa)isa) && snow_isa_runs(SNOW_ISA_AVX2)) {
                scene.settings.isa = (snow_isa)isa;
                compare_with(&stage, &scene, first,
                             isa == SNOW_ISA_SCALAR ? 0.5 / 255 + 1e-5 : 0);
            }
        free(first);
        model_free(&scene);
    }
    model_close(&stage);
}

/* Counts what is asked of it. */
static void *allocate_counted(void *user, size_t bytes) {
    ++*(long *)user;
    return malloc(bytes);
}

static void release(void *user, void *block) {
    (void)user;
    free(block);
}

static void a_second_picture_takes_no_memory_but_its_own(void **state) {
    (void)state;
    for (int n = 0; n < 6; n++) {
        long count = 0, before = 0;
        snow_allocator functions = {allocate_counted, release, &count};
        model_stage stage;
        snow_volume *volume;
        snow_transfer *transfer;
        assert_int_equal(snow_context_new(&functions, &stage.context),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_frame_new(stage.context, &stage.frame),
                         SNOW_STATUS_OK);
        reference_scene scene =
            model_scene((int64_t[]){40, 30, 50}, SNOW_TYPE_UINT8, n % 2 == 0,
                        MODEL_OBLIQUE, 1);
        stand_at(&scene, (size_t)n + 4, 1);
        scene.view.fov = 40;
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        scene.settings.quality = (snow_quality)(n / 2);
        scene.settings.threads = n % 2 ? 1 : 3;
        assert_int_equal(
            snow_volume_wrap(stage.context, &scene.info, scene.voxels, &volume),
            SNOW_STATUS_OK);
        assert_int_equal(snow_transfer_new(stage.context, scene.colors,
                                           scene.color_count, scene.opacities,
                                           scene.opacity_count, &transfer),
                         SNOW_STATUS_OK);
        for (int i = 0; i < 2; i++) {
            snow_image *image;
            before = count;
            assert_int_equal(snow_frame_render(stage.frame, volume, transfer,
                                               &scene.view, &scene.settings,
                                               &image),
                             SNOW_STATUS_OK);
            snow_image_free(image);
        }
        assert_int_equal(count - before, 2); /* the image and its pixels */
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        model_free(&scene);
        model_close(&stage);
    }
}

static void an_eye_between_slices_is_left_to_footprints(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_scene((int64_t[]){5, 6, 31}, SNOW_TYPE_UINT8,
                                        true, MODEL_PLAIN, 1);
    snow_placement p;
    model_turn(&scene, 44, 0, 0, 1);
    scene.view.fov = 115;
    assert_int_equal(
        snow_placement_make(stage.context, &scene.info, &scene.view, &p),
        SNOW_STATUS_OK);
    assert_true(p.eye.at[2] > 0 && p.eye.at[2] < 30);
    scene.settings.method = SNOW_METHOD_SHEAR_WARP;
    free(model_picture(&stage, &scene));
    assert_int_equal(snow_frame_stats(stage.frame)->method,
                     SNOW_METHOD_FOOTPRINT);
    scene.view.fov = 30;
    free(model_picture(&stage, &scene));
    assert_int_equal(snow_frame_stats(stage.frame)->method,
                     SNOW_METHOD_SHEAR_WARP);
    model_free(&scene);
    model_close(&stage);
}

/* Both ways at high quality, where a blend of axes may be asked for that one
 * of them cannot give. */
static void blends_leave_out_what_cannot_be_drawn(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (double fov = 30; fov <= 120; fov += 15)
        for (double azimuth = 40; azimuth < 50; azimuth += 2) {
            reference_scene scene = model_blank((int64_t[]){25, 24, 40}, 1);
            for (int n = 0; n < 25 * 24 * 40; n++)
                model_voxels(&scene)[n] = 1;
            model_turn(&scene, azimuth, 0, 0, 4);
            scene.view.fov = fov;
            scene.settings.method = SNOW_METHOD_SHEAR_WARP;
            scene.settings.quality = SNOW_QUALITY_HIGH;
            float *picture = model_picture(&stage, &scene);
            float alpha = picture[4 * (24 * 64 + 32) + 3];
            if (!(fabsf(alpha - 1) < 1e-2f))
                fail_msg("%g: fov %g, %s", (double)alpha, fov,
                         model_words(&scene));
            free(picture);
            model_free(&scene);
        }
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opacities_of_rays_are_within_a_quarter_step),
        cmocka_unit_test(voxels_that_are_not_there_leave_nothing),
        cmocka_unit_test(a_rake_has_the_weights_of_its_kernel),
        cmocka_unit_test(pictures_are_those_of_the_method_in_double),
        cmocka_unit_test(smooth_scenes_are_near_the_exact_picture),
        cmocka_unit_test(threads_encodings_and_levels_do_not_matter),
        cmocka_unit_test(a_second_picture_takes_no_memory_but_its_own),
        cmocka_unit_test(an_eye_between_slices_is_left_to_footprints),
        cmocka_unit_test(blends_leave_out_what_cannot_be_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
