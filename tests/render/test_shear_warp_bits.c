/* tests/render/test_shear_warp_bits.c - what must not change a bit of a sheared
 * picture (threads, encodings, vector levels, what a frame did before), and
 * when a frame encodes anew. */
#include <math.h>
#include <sys/wait.h>
#include <unistd.h>

#include "frame.h"
#include "image/image.h"
#include "reference/shear_warp.h"
#include "simd/isa.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Scalar kernels round products and sums apart. */
#define SCALAR_BOUND 1e-4

/* A scene with the objects that a program would keep. */
typedef struct studio {
    snow_context *context;
    snow_frame *frame;
    snow_volume *volume;
    reference_scene scene;
} studio;

static studio open_studio(snow_type type, bool grey, uint64_t seed) {
    studio s = {.context = support_context()};
    s.scene =
        model_scene((int64_t[]){70, 45, 38}, type, grey, MODEL_OBLIQUE, seed);
    s.scene.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.scene.settings.threads = 2;
    s.scene.view.width = 90;
    s.scene.view.height = 70;
    model_turn(&s.scene, 20, -15, 10, 1.4);
    assert_int_equal(snow_frame_new(s.context, &s.frame), SNOW_STATUS_OK);
    assert_int_equal(
        snow_volume_wrap(s.context, &s.scene.info, s.scene.voxels, &s.volume),
        SNOW_STATUS_OK);
    snow_volume_freeze(s.volume);
    return s;
}

static void close_studio(studio *s) {
    snow_frame_free(s->frame);
    snow_volume_close(s->volume);
    assert_int_equal(snow_context_bytes(s->context), 0);
    snow_context_free(s->context);
    free((void *)(uintptr_t)s->scene.voxels);
}

/* A picture by a frame, as it is; the caller frees it. */
static snow_image *shoot_with(const studio *s, snow_frame *frame) {
    const reference_scene *scene = &s->scene;
    snow_transfer *transfer = model_transfer(s->context, scene);
    snow_image *image = NULL;
    snow_status status = snow_frame_render(
        frame, s->volume, transfer, &scene->view, &scene->settings, &image);
    snow_transfer_free(transfer);
    if (status != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(s->context));
    assert_int_equal(snow_frame_stats(frame)->method, SNOW_METHOD_SHEAR_WARP);
    return image;
}

static snow_image *shoot(const studio *s) {
    return shoot_with(s, s->frame);
}

/* The largest difference of two pictures of one size. */
static double apart(snow_image *a, snow_image *b) {
    assert_int_equal(snow_image_width(a), snow_image_width(b));
    assert_int_equal(snow_image_height(a), snow_image_height(b));
    assert_int_equal(snow_image_channels(a), snow_image_channels(b));
    size_t count = (size_t)snow_image_width(a) * (size_t)snow_image_height(a) *
                   (size_t)snow_image_channels(a);
    const float *p = snow_image_pixels(a), *q = snow_image_pixels(b);
    double most = 0;
    for (size_t n = 0; n < count; n++)
        most = fmax(most, fabs((double)p[n] - (double)q[n]));
    /* Also zeros of either sign and numbers that are none. */
    if (most == 0)
        assert_memory_equal(p, q, count * sizeof *p);
    return most;
}

/* Renders by a frame that knows nothing, and compares with `image`, which is
 * freed; the bits have to be equal. */
static void same_as_fresh(const studio *s, snow_image *image) {
    snow_frame *fresh = NULL;
    assert_int_equal(snow_frame_new(s->context, &fresh), SNOW_STATUS_OK);
    snow_image *expected = shoot_with(s, fresh);
    assert_true(apart(image, expected) == 0);
    snow_image_free(expected);
    snow_image_free(image);
    snow_frame_free(fresh);
}

static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                  SNOW_TYPE_FLOAT32};
static const snow_quality qualities[] = {SNOW_QUALITY_NORMAL,
                                         SNOW_QUALITY_DRAFT, SNOW_QUALITY_HIGH};

/* Scenes of all types, qualities, colours, shades and then the same with a
 * gradient opacity, in turn. */
static studio numbered_studio(size_t n) {
    studio s = open_studio(types[n % COUNT(types)], n / 3 % 2, n);
    s.scene.settings.quality = qualities[n / 6 % COUNT(qualities)];
    s.scene.settings.shade = n / 18 % 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    if (n / 36 % 2)
        model_fade(&s.scene);
    return s;
}

#define STUDIOS 72

static void any_number_of_threads_gives_the_same_bits(void **state) {
    (void)state;
    static const int threads[] = {2, 3, 7, 16};
    for (size_t n = 0; n < STUDIOS; n += support_stride(7)) {
        studio s = numbered_studio(n);
        s.scene.settings.threads = 1;
        snow_image *one = shoot(&s);
        for (size_t t = 0; t < COUNT(threads); t++) {
            s.scene.settings.threads = threads[t];
            snow_frame *fresh = NULL;
            assert_int_equal(snow_frame_new(s.context, &fresh), SNOW_STATUS_OK);
            snow_image *many = shoot_with(&s, fresh);
            assert_true(apart(one, many) == 0);
            assert_int_equal(snow_frame_stats(fresh)->threads, threads[t]);
            snow_image_free(many);
            snow_frame_free(fresh);
        }
        snow_image_free(one);
        close_studio(&s);
    }
}

static void all_encodings_give_the_same_bits(void **state) {
    (void)state;
    for (size_t n = 0; n < STUDIOS; n += support_stride(7)) {
        studio s = numbered_studio(n);
        s.scene.settings.encoding = SNOW_ENCODING_CRS;
        snow_image *crs = shoot(&s);
        for (int e = SNOW_ENCODING_AUTO; e <= SNOW_ENCODING_RLE; e++) {
            s.scene.settings.encoding = (snow_encoding)e;
            snow_image *other = shoot(&s);
            const snow_stats *stats = snow_frame_stats(s.frame);
            assert_true(apart(crs, other) == 0);
            assert_int_equal(stats->encoded, 1);
            if (e != SNOW_ENCODING_AUTO)
                assert_int_equal(stats->encoding, e);
            snow_image_free(other);
        }
        snow_image_free(crs);
        close_studio(&s);
    }
}

static void vector_levels_differ_as_stated(void **state) {
    (void)state;
    double most = 0;
    for (size_t n = 0; n < STUDIOS; n += support_stride(7)) {
        snow_image *images[3] = {NULL};
        studio s = numbered_studio(n);
        for (int level = 0; level < 3; level++) {
            s.scene.settings.isa = (snow_isa)(SNOW_ISA_SCALAR + level);
            if (snow_isa_runs(s.scene.settings.isa))
                images[level] = shoot(&s);
        }
        if (images[1])
            most = fmax(most, apart(images[0], images[1]));
        if (images[2])
            assert_true(apart(images[1], images[2]) == 0);
        for (int level = 0; level < 3; level++)
            snow_image_free(images[level]);
        close_studio(&s);
    }
    print_message("             scalar and vectors differ by up to %.2g\n",
                  most);
    assert_true(most <= SCALAR_BOUND);
}

/* Renders with what was changed since the last picture: whether that encodes
 * anew is as expected, and the bits are those of a fresh frame. */
#define expect_encoded(s, expected)                                        \
    do {                                                                   \
        snow_image *image = shoot(s);                                      \
        assert_int_equal(snow_frame_stats((s)->frame)->encoded, expected); \
        same_as_fresh(s, image);                                           \
    } while (0)

/* Whether one look's encoding may serve another that shows less. */
static bool keeps_codes(const studio *s) {
    return snow_type_size(s->scene.info.type) <= 2 && !s->scene.gradient_count;
}

/* Of a kind of data, what makes codes of the wide types. */
static void an_encoding_is_used_until_it_does_not_fit(void **state) {
    (void)state;
    static const snow_color_point red[] = {
        {20, 1, 0.2, 0.1}, {45, 1, 0.1, 0}, {45, 0.9, 0, 0}, {90, 1, 1, 0}};
    static const snow_opacity_point strong[] = {
        {40, 0}, {60, 0.3}, {60, 0.2}, {85, 0.1}, {99, 0.4}};
    static const snow_opacity_point shifted[] = {
        {42, 0}, {60, 0.3}, {60, 0.2}, {85, 0.1}, {99, 0.4}};
    for (size_t n = 0; n < STUDIOS; n += support_stride(7)) {
        studio s = numbered_studio(n);
        reference_scene *scene = &s.scene;
        snow_settings *settings = &scene->settings;
        expect_encoded(&s, 1);
        expect_encoded(&s, 0); /* nothing */
        scene->colors = red;
        scene->color_count = COUNT(red);
        expect_encoded(&s, snow_type_size(types[n % 3]) > 2 && n / 3 % 2);
        settings->light_azimuth = 40;
        settings->specular = 0.7;
        expect_encoded(&s, 0);
        model_turn(scene, 12, -20, 50, 2);
        expect_encoded(&s, 0);
        scene->view.width = 40;
        expect_encoded(&s, 0);
        scene->opacities = strong; /* the same interesting voxels */
        expect_encoded(&s, 0);
        settings->opacity_length = 3;
        settings->kernel = SNOW_KERNEL_GAUSS;
        settings->threads = 3;
        expect_encoded(&s, 0);
        /* Less of them: drawn from what is there. */
        bool anew = !keeps_codes(&s);
        scene->opacities = shifted;
        expect_encoded(&s, anew);
        settings->threshold = 30;
        expect_encoded(&s, anew);
        settings->threshold = 0;
        expect_encoded(&s, anew);
        model_look(scene, (double[]){1, 0, 0}, (double[]){0, 0, 1});
        expect_encoded(&s, 1); /* another slice axis */
        settings->shade = settings->shade == SNOW_SHADE_NONE ? SNOW_SHADE_PHONG
                                                             : SNOW_SHADE_NONE;
        expect_encoded(&s, 1);
        settings->quality = settings->quality == SNOW_QUALITY_HIGH
                                ? SNOW_QUALITY_NORMAL
                                : SNOW_QUALITY_HIGH;
        expect_encoded(&s, 1);
        settings->encoding = SNOW_ENCODING_RLE;
        expect_encoded(&s, 1);
        expect_encoded(&s, 0);
        close_studio(&s);
    }
}

/* An encoding of more than is shown is used for so long that another one would
 * have paid. */
static void voxels_that_are_not_shown_are_not_drawn_for_ever(void **state) {
    (void)state;
    static const snow_opacity_point few[] = {{70, 0}, {75, 0.3}, {99, 0.4}};
    static const snow_opacity_point more[] = {{20, 0.1}, {99, 0.4}};
    for (size_t n = 0; n < STUDIOS; n += support_stride(5)) {
        studio s = numbered_studio(n);
        if (!keeps_codes(&s)) {
            close_studio(&s);
            continue;
        }
        expect_encoded(&s, 1);
        int64_t all = snow_frame_stats(s.frame)->interesting;
        s.scene.opacities = few;
        s.scene.opacity_count = COUNT(few);
        int pictures = 0;
        do {
            snow_image *image = shoot(&s);
            same_as_fresh(&s, image);
            assert_true(snow_frame_stats(s.frame)->interesting < all);
        } while (++pictures < 20 && !snow_frame_stats(s.frame)->encoded);
        bool shaded = s.scene.settings.shade == SNOW_SHADE_PHONG;
        assert_true(pictures > 1 || !shaded);
        assert_true(pictures < 20);
        expect_encoded(&s, 0);
        s.scene.opacities = more; /* than there are */
        s.scene.opacity_count = COUNT(more);
        expect_encoded(&s, 1);
        close_studio(&s);
    }
}

/* Modes take codes as numbers: voxels that are not shown would count, since the
 * lowest value, which most have, is 0 but for rounding. */
static void sums_are_of_no_other_voxels(void **state) {
    (void)state;
    static const snow_opacity_point all[] = {{-1e6, 0.1}, {1e6, 0.2}};
    for (size_t n = 0; n < 4; n++) {
        studio s = open_studio(SNOW_TYPE_INT16, n % 2, n);
        int16_t *voxels = (void *)(uintptr_t)s.scene.voxels;
        for (size_t i = 0; i < 70 * 45 * 38; i++)
            voxels[i] = (int16_t)(20011 + (i % 8 ? 0 : voxels[i] & 127));
        s.scene.opacities = all;
        s.scene.opacity_count = COUNT(all);
        s.scene.settings.shade = SNOW_SHADE_NONE;
        expect_encoded(&s, 1);
        s.scene.settings.mode = n / 2 ? SNOW_MODE_MEAN : SNOW_MODE_SUM;
        expect_encoded(&s, 1);
        expect_encoded(&s, 0);
        close_studio(&s);
    }
}

/* A curve belongs to the encoding, and where a threshold has to be passed so
 * does the opacity; colours do not. */
static void an_encoding_has_its_gradient_opacity(void **state) {
    (void)state;
    static const snow_color_point blue[] = {
        {20, 0, 0.2, 1}, {45, 0.1, 0.1, 1}, {45, 0.3, 0, 1}, {90, 1, 1, 1}};
    static const snow_opacity_point gentle[] = {{3, 0}, {30, 1}};
    static const snow_opacity_point strong[] = {
        {40, 0}, {60, 0.3}, {60, 0.25}, {85, 0.2}, {99, 0.9}};
    for (size_t n = 0; n < STUDIOS / 2; n += support_stride(5)) {
        studio s = numbered_studio(n);
        reference_scene *scene = &s.scene;
        expect_encoded(&s, 1);
        model_fade(scene);
        expect_encoded(&s, 1);
        expect_encoded(&s, 0);
        scene->colors = blue; /* at the same values: of greys another grid */
        scene->color_count = COUNT(blue);
        expect_encoded(&s, snow_type_size(types[n % 3]) > 2 && n / 3 % 2);
        scene->opacities = strong;
        expect_encoded(&s, 0);
        model_turn(scene, 12, -20, 50, 2);
        expect_encoded(&s, 0);
        scene->gradients = gentle;
        scene->gradient_count = COUNT(gentle);
        expect_encoded(&s, 1);
        scene->settings.threshold = 10;
        expect_encoded(&s, 1);
        expect_encoded(&s, 0);
        static const snow_opacity_point other[] = {
            {40, 0}, {60, 0.3}, {60, 0.25}, {85, 0.2}, {99, 0.8}};
        scene->opacities = other; /* what passes by itself stays the same, */
        expect_encoded(&s, 1);    /* but not what does under a factor */
        scene->gradient_count = 0;
        expect_encoded(&s, 1);
        expect_encoded(&s, 0);
        close_studio(&s);
    }
}

/* Writes another value into every third voxel. */
static void change_voxels(studio *s) {
    unsigned char *voxels = (void *)(uintptr_t)s->scene.voxels;
    for (size_t n = 0; n < 70 * 45 * 38; n += 3)
        voxels[n] = (unsigned char)(voxels[n] * 7 + 80);
}

static void shared_voxels_may_change_until_they_are_frozen(void **state) {
    (void)state;
    studio s = open_studio(SNOW_TYPE_UINT8, true, 1);
    snow_volume_close(s.volume);
    assert_int_equal(
        snow_volume_wrap(s.context, &s.scene.info, s.scene.voxels, &s.volume),
        SNOW_STATUS_OK);
    snow_image *before = shoot(&s);
    expect_encoded(&s, 1); /* not frozen: nobody knows */
    change_voxels(&s);
    snow_image *after = shoot(&s);
    assert_int_equal(snow_frame_stats(s.frame)->encoded, 1);
    assert_true(apart(before, after) > 0.01);
    same_as_fresh(&s, after);

    snow_volume_freeze(s.volume);
    expect_encoded(&s, 1);
    snow_image *frozen = shoot(&s);
    change_voxels(&s); /* against the promise: the frame does not look */
    after = shoot(&s);
    assert_int_equal(snow_frame_stats(s.frame)->encoded, 0);
    assert_true(apart(frozen, after) == 0);
    snow_image_free(after);
    snow_volume_freeze(s.volume); /* a new promise */
    after = shoot(&s);
    assert_int_equal(snow_frame_stats(s.frame)->encoded, 1);
    assert_true(apart(frozen, after) > 0.01);
    same_as_fresh(&s, after);
    snow_image_free(before);
    snow_image_free(frozen);
    close_studio(&s);
}

static void another_volume_is_encoded_anew(void **state) {
    (void)state;
    studio s = open_studio(SNOW_TYPE_UINT8, false, 1);
    studio t = open_studio(SNOW_TYPE_UINT8, false, 2);
    expect_encoded(&s, 1);
    /* The same context and frame, other voxels; then the first again. */
    snow_volume *first = s.volume, *second = NULL;
    assert_int_equal(
        snow_volume_wrap(s.context, &t.scene.info, t.scene.voxels, &second),
        SNOW_STATUS_OK);
    snow_volume_freeze(second);
    s.volume = second;
    expect_encoded(&s, 1);
    s.volume = first;
    expect_encoded(&s, 1);
    expect_encoded(&s, 0);
    snow_volume_close(second);
    close_studio(&t);
    close_studio(&s);
}

/* A slab's picture by a frame. */
static snow_image *shoot_slab(const studio *s, snow_frame *frame, int parts,
                              int part) {
    const reference_scene *scene = &s->scene;
    snow_transfer *transfer = model_transfer(s->context, scene);
    snow_image *image = NULL;
    assert_int_equal(snow_frame_render_slab(frame, s->volume, transfer,
                                            &scene->view, &scene->settings,
                                            parts, part, &image),
                     SNOW_STATUS_OK);
    snow_transfer_free(transfer);
    return image;
}

/* One frame after another slab of the same size, or of another, of a volume
 * that is frozen. */
static void slabs_are_encoded_each_for_itself(void **state) {
    (void)state;
    studio s = open_studio(SNOW_TYPE_UINT8, true, 1);
    for (int parts = 1; parts <= 5; parts++)
        for (int part = 0; part < parts; part++) {
            snow_frame *fresh = NULL;
            assert_int_equal(snow_frame_new(s.context, &fresh), SNOW_STATUS_OK);
            snow_image *kept = shoot_slab(&s, s.frame, parts, part);
            assert_int_equal(snow_frame_stats(s.frame)->encoded, 1);
            snow_image *again = shoot_slab(&s, s.frame, parts, part);
            assert_int_equal(snow_frame_stats(s.frame)->encoded, 0);
            snow_image *alone = shoot_slab(&s, fresh, parts, part);
            assert_true(apart(kept, alone) == 0 && apart(kept, again) == 0);
            snow_image_free(kept);
            snow_image_free(again);
            snow_image_free(alone);
            snow_frame_free(fresh);
        }
    close_studio(&s);
}

/* --- memory --------------------------------------------------------------- */

typedef struct counting_allocator {
    long allocations;
    size_t largest;
} counting_allocator;

static void *allocate_counted(void *user, size_t bytes) {
    counting_allocator *counts = user;
    counts->allocations++;
    counts->largest = bytes > counts->largest ? bytes : counts->largest;
    return malloc(bytes);
}

static void release_counted(void *user, void *block) {
    (void)user;
    free(block);
}

/* Renders twice; returns the allocations of the second time.  The test fails
 * when it keeps more memory than the first. */
static long allocations_when_warm(const reference_scene *scene) {
    counting_allocator counts = {0};
    const snow_allocator allocator = {allocate_counted, release_counted,
                                      &counts};
    snow_context *context = NULL;
    snow_frame *frame = NULL;
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_image *image = NULL;
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    assert_int_equal(
        snow_volume_wrap(context, &scene->info, scene->voxels, &volume),
        SNOW_STATUS_OK);
    snow_volume_freeze(volume);
    transfer = model_transfer(context, scene);
    uint64_t held[2] = {0};
    long before = 0;
    for (int n = 0; n < 2; n++) {
        before = counts.allocations;
        assert_int_equal(snow_frame_render(frame, volume, transfer,
                                           &scene->view, &scene->settings,
                                           &image),
                         SNOW_STATUS_OK);
        held[n] = snow_context_bytes(context);
        snow_image_free(image);
    }
    long last = counts.allocations - before;
    assert_int_equal(held[0], held[1]);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_frame_free(frame);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
    return last;
}

static long allocations_of_an_image(void) {
    counting_allocator counts = {0};
    const snow_allocator allocator = {allocate_counted, release_counted,
                                      &counts};
    snow_context *context = NULL;
    snow_image *image = NULL;
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    long before = counts.allocations;
    assert_int_equal(snow_image_new(context, 90, 70, 4, &image),
                     SNOW_STATUS_OK);
    long made = counts.allocations - before;
    snow_image_free(image);
    snow_context_free(context);
    return made;
}

static void a_second_frame_allocates_its_image_only(void **state) {
    (void)state;
    long most = allocations_of_an_image();
    for (size_t n = 0; n < STUDIOS; n += support_stride(7)) {
        studio s = numbered_studio(n);
        long warm = allocations_when_warm(&s.scene);
        if (warm > most)
            fail_msg("%ld allocations, not %ld: %s", warm, most,
                     model_words(&s.scene));
        close_studio(&s);
    }
}

/* A child of fork() has none of the threads that its parent made.  The thread
 * sanitizer ends children that make threads of their own. */
static void a_child_of_fork_draws_the_same_picture(void **state) {
    (void)state;
#ifdef __SANITIZE_THREAD__
    skip();
#endif
    studio s = open_studio(SNOW_TYPE_UINT8, false, 3);
    snow_image *image = shoot(&s);
    uint64_t sum = snow_image_checksum(image);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        alarm(20);
        snow_image *again = shoot(&s);
        _exit(snow_image_checksum(again) == sum ? 0 : 1);
    }
    int status = -1;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    snow_image_free(image);
    close_studio(&s);
}

/* Slices between are part of the encoding, not of the volume. */
static void high_quality_counts_the_voxels_of_the_volume(void **state) {
    (void)state;
    studio s = open_studio(SNOW_TYPE_UINT8, false, 4);
    snow_image *image = shoot(&s);
    int64_t interesting = snow_frame_stats(s.frame)->interesting;
    double ratio = snow_frame_stats(s.frame)->sparse_ratio;
    snow_image_free(image);
    s.scene.settings.quality = SNOW_QUALITY_HIGH;
    image = shoot(&s);
    assert_int_equal(snow_frame_stats(s.frame)->interesting, interesting);
    assert_true(snow_frame_stats(s.frame)->sparse_ratio == ratio);
    snow_image_free(image);
    close_studio(&s);
}

/* With an argument: the tests of that name, which may hold a *. */
int main(int argc, char **argv) {
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(all_encodings_give_the_same_bits),
        cmocka_unit_test(vector_levels_differ_as_stated),
        cmocka_unit_test(an_encoding_is_used_until_it_does_not_fit),
        cmocka_unit_test(voxels_that_are_not_shown_are_not_drawn_for_ever),
        cmocka_unit_test(sums_are_of_no_other_voxels),
        cmocka_unit_test(an_encoding_has_its_gradient_opacity),
        cmocka_unit_test(shared_voxels_may_change_until_they_are_frozen),
        cmocka_unit_test(another_volume_is_encoded_anew),
        cmocka_unit_test(slabs_are_encoded_each_for_itself),
        cmocka_unit_test(a_second_frame_allocates_its_image_only),
        cmocka_unit_test(a_child_of_fork_draws_the_same_picture),
        cmocka_unit_test(high_quality_counts_the_voxels_of_the_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
