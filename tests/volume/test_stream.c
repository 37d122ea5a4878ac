/* tests/volume/test_stream.c - a volume whose voxels stay in its file makes the
 * looks and pictures of the same volume in memory, bit for bit, however thin
 * its slabs are; and never holds more of it than a slab. */
#include "support/files.h"

#include "image/image.h"
#include "render/tested.h"
#include "volume/stream.h"

#include <math.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

enum { WIDTH = 90, HEIGHT = 70 };
static const int64_t dims[3] = {41, 46, 103};
static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_UINT16,
                                  SNOW_TYPE_INT16, SNOW_TYPE_FLOAT32};

/* Slices along every axis, from both sides, straight and oblique. */
static const struct {
    const char *name;
    double azimuth, elevation, fov;
} stands[] = {
    {"+z", 0, 0, 0},    {"-z", 20, 30, 0},  {"+y", 0, 0, 0},
    {"-y", -35, 10, 0}, {"+x", 0, 0, 0},    {"-x", 25, -20, 0},
    {"iso", 3, 0, 0},   {"+z", 15, 25, 40}, {"+y", 30, 10, 60},
    {"-x", 10, 35, 30},
};

/* A head of a type, with a little noise so that no slice is like its neighbour.
 */
static snow_volume *make_head(support_files *place, snow_type type) {
    snow_volume *head, *made;
    double ends[2] = {0, 255};
    const double *range = type == SNOW_TYPE_FLOAT32 ? NULL : ends;
    uint64_t seed = 7;
    assert_int_equal(
        snow_volume_open_phantom(place->context, "head", dims, 0, &head),
        SNOW_STATUS_OK);
    unsigned char *voxels = head->owned;
    for (int64_t n = 0; n < dims[0] * dims[1] * dims[2]; n++)
        if (voxels[n] > 8 && voxels[n] < 248)
            voxels[n] = (unsigned char)(voxels[n] + support_random(&seed) % 8);
    assert_int_equal(snow_volume_convert(head, type, range, &made),
                     SNOW_STATUS_OK);
    snow_volume_close(head);
    return made;
}

/* Puts it into a file. */
static const char *write_volume(support_files *place, snow_volume *volume,
                                const char *name) {
    const char *path = support_path(place, name);
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    return path;
}

static const char *write_head(support_files *place, snow_type type,
                              const char *name) {
    return write_volume(place, make_head(place, type), name);
}

/* A head with no values in a corner, in a slice, and here and there. */
static const char *write_holes(support_files *place) {
    snow_volume *head = make_head(place, SNOW_TYPE_FLOAT32);
    float *voxel = head->owned;
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t y = 0; y < dims[1]; y++)
            for (int64_t x = 0; x < dims[0]; x++, voxel++)
                if ((x < 20 && y < 23 && z < 50) || z == 60 ||
                    (x + y + z) % 97 == 0)
                    *voxel = NAN;
    return write_volume(place, head, "holes.nrrd");
}

static snow_volume *stream_of(support_files *place, const char *path,
                              const snow_volume_options *options,
                              uint64_t slab_bytes) {
    snow_volume *volume;
    assert_int_equal(snow_volume_open_streamed(place->context, path, options,
                                               slab_bytes, &volume),
                     SNOW_STATUS_OK);
    return volume;
}

/* One picture of each volume, from one frame each. */
typedef struct pair {
    snow_volume *whole, *stream;
    snow_frame *of_whole, *of_stream;
    snow_transfer *transfer;
} pair;

static pair open_pair(support_files *place, const char *path,
                      const snow_volume_options *options, uint64_t slab_bytes,
                      const snow_look *look) {
    pair p = {0};
    snow_transfer *other;
    assert_int_equal(snow_volume_open(place->context, path, options, &p.whole),
                     SNOW_STATUS_OK);
    p.stream = stream_of(place, path, options, slab_bytes);
    assert_int_equal(snow_transfer_new_for_volume(p.whole, look, &p.transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(p.stream, look, &other),
                     SNOW_STATUS_OK);
    assert_string_equal(snow_transfer_description(p.transfer),
                        snow_transfer_description(other));
    snow_transfer_free(p.transfer);
    p.transfer = other;
    assert_int_equal(snow_frame_new(place->context, &p.of_whole),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(place->context, &p.of_stream),
                     SNOW_STATUS_OK);
    return p;
}

static void close_pair(pair *p) {
    snow_frame_free(p->of_whole);
    snow_frame_free(p->of_stream);
    snow_transfer_free(p->transfer);
    snow_volume_close(p->whole);
    snow_volume_close(p->stream);
}

static bool is_seen(snow_image *image) {
    const float *pixels = snow_image_pixels(image);
    size_t channels = (size_t)snow_image_channels(image);
    size_t count = (size_t)snow_image_width(image) *
                   (size_t)snow_image_height(image) * channels;
    for (size_t n = channels - 1; n < count; n += channels)
        if (channels == 1 ? !isnan(pixels[n]) : pixels[n] > 0.05F)
            return true;
    return false;
}

static void draw_both(const pair *p, const snow_view *view,
                      const snow_settings *settings, snow_image **whole,
                      snow_image **stream) {
    assert_int_equal(snow_frame_render(p->of_whole, p->whole, p->transfer, view,
                                       settings, whole),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_render(p->of_stream, p->stream, p->transfer,
                                       view, settings, stream),
                     SNOW_STATUS_OK);
    assert_true(is_seen(*whole));
    assert_int_equal(snow_image_channels(*whole), snow_image_channels(*stream));
}

static void same_figures(const pair *p, snow_method method) {
    const snow_stats *given = snow_frame_stats(p->of_whole);
    const snow_stats *same = snow_frame_stats(p->of_stream);
    assert_int_equal(given->method, method);
    assert_int_equal(same->method, method);
    assert_int_equal(same->voxels, given->voxels);
    assert_int_equal(same->slice_axis, given->slice_axis);
    if (!given->encoded || !same->encoded) /* encodings are of another look */
        return;
    assert_int_equal(same->interesting, given->interesting);
}

static void same_pictures(const pair *p, const snow_view *view,
                          const snow_settings *settings) {
    snow_image *a, *b;
    draw_both(p, view, settings, &a, &b);
    same_figures(p, SNOW_METHOD_SHEAR_WARP);
    assert_memory_equal(snow_image_pixels(a), snow_image_pixels(b),
                        (size_t)(WIDTH * HEIGHT * snow_image_channels(a)) *
                            sizeof(float));
    snow_image_free(a);
    snow_image_free(b);
}

/* The same to a few units of the last place of the largest number: samples of
 * slabs are added up from another voxel on. */
static void near_pictures(const pair *p, const snow_view *view,
                          const snow_settings *settings, snow_method method) {
    snow_image *a, *b;
    float largest = 0, apart = 0;
    draw_both(p, view, settings, &a, &b);
    same_figures(p, method);
    for (int n = 0; n < a->width * a->height * a->channels; n++) {
        assert_int_equal(isnan(a->pixels[n]), isnan(b->pixels[n]));
        largest = fmaxf(largest, fabsf(a->pixels[n]));
        apart = fmaxf(apart, fabsf(a->pixels[n] - b->pixels[n]));
    }
    if (apart > 4e-6F * largest)
        fail_msg("%g of %g", (double)apart, (double)largest);
    snow_image_free(a);
    snow_image_free(b);
}

static snow_view stand_at(support_files *place, size_t n) {
    snow_view view = {.size = sizeof view};
    assert_int_equal(snow_view_from_name(place->context, stands[n].name, &view),
                     SNOW_STATUS_OK);
    view.width = WIDTH;
    view.height = HEIGHT;
    view.azimuth = stands[n].azimuth;
    view.elevation = stands[n].elevation;
    view.fov = stands[n].fov;
    view.zoom = n % 3 == 1 ? 2.5 : 1;
    return view;
}

/* By settings that are not set. */
static void same_usual(support_files *place, const pair *p, size_t stand) {
    const snow_view view = stand_at(place, stand);
    snow_settings settings;
    snow_settings_init(&settings);
    same_pictures(p, &view, &settings);
}

/* Slabs of so many slices of the type, ghosts included. */
static uint64_t slices_of(snow_type type, int slices) {
    return (uint64_t)(dims[0] * dims[1]) * snow_type_size(type) *
           (uint64_t)slices;
}

/* --- pictures ------------------------------------------------------------- */

/* Depths are the same to a few units of the last place: samples of slabs are
 * added up from another voxel on. */
static void same_depths(const pair *p) {
    const snow_image *a = snow_frame_depth(p->of_whole);
    const snow_image *b = snow_frame_depth(p->of_stream);
    int shown = 0;
    assert_non_null(a);
    assert_non_null(b);
    for (int n = 0; n < WIDTH * HEIGHT; n++) {
        shown += !isnan(a->pixels[n]);
        if (isnan(a->pixels[n]) || isnan(b->pixels[n]))
            assert_true(isnan(a->pixels[n]) && isnan(b->pixels[n]));
        else if (fabsf(a->pixels[n] - b->pixels[n]) > 4e-6F)
            fail_msg("depths %g and %g", (double)a->pixels[n],
                     (double)b->pixels[n]);
    }
    assert_true(shown > WIDTH * HEIGHT / 50);
}

typedef void fill_fn(size_t i, snow_type type, snow_view *view,
                     snow_settings *settings);

static void draw_over(size_t i, snow_type type, snow_view *view,
                      snow_settings *settings) {
    (void)type;
    settings->quality = (snow_quality)(i % 3);
    settings->shade = i % 4 == 3 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    settings->threshold = i % 5 == 4 ? 30 : 0;
    if (settings->quality == SNOW_QUALITY_DRAFT)
        view->zoom = 4; /* which no level is for (levels.h) */
}

static bool adds_up(snow_mode mode) {
    return mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM;
}

static void draw_modes(size_t i, snow_type type, snow_view *view,
                       snow_settings *settings) {
    bool wide = type == SNOW_TYPE_UINT16 || type == SNOW_TYPE_INT16;
    (void)view;
    settings->mode = (snow_mode)(1 + i % SNOW_MODE_ISO);
    settings->quality = (snow_quality)(1 + i % 2);
    settings->shade = i % 3 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
    settings->deterministic = i % 4 == 0 && !adds_up(settings->mode);
    settings->iso = wide ? 9000 : 90;
    settings->depth = settings->mode == SNOW_MODE_ISO && i % 2;
}

static void draw_by_footprints(size_t i, snow_type type, snow_view *view,
                               snow_settings *settings) {
    (void)type;
    (void)view;
    settings->method = (snow_method[]){SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED,
                                       SNOW_METHOD_FOOTPRINT}[i % 3];
    settings->shade = i % 4 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
}

/* What no lattice has pixels for. */
static void draw_wide_pixels(size_t i, snow_type type, snow_view *view,
                             snow_settings *settings) {
    (void)i;
    (void)type;
    settings->mode = SNOW_MODE_MIP;
    view->width = view->height = 7;
}

static void draw_depths(size_t i, snow_type type, snow_view *view,
                        snow_settings *settings) {
    (void)i;
    (void)type;
    (void)view;
    settings->depth = 1;
}

/* Opacity by gradients sees beyond a slab's border. */
static void draw_gradients(size_t i, snow_type type, snow_view *view,
                           snow_settings *settings) {
    (void)type;
    (void)view;
    settings->shade = i % 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    settings->quality = i % 3 ? SNOW_QUALITY_NORMAL : SNOW_QUALITY_HIGH;
    settings->threshold = i % 4 ? 0 : 20;
}

/* Draws a stand of each pair, and compares. */
static void check_stand(support_files *place, const pair *p, size_t i,
                        snow_type type, size_t stand, fill_fn *fill,
                        bool holes) {
    snow_view view = stand_at(place, stand);
    snow_settings settings;
    snow_settings_init(&settings);
    settings.encoding = (snow_encoding)(i / 2 % 4);
    settings.threads = 1 + (int)(i % 3);
    fill(i, type, &view, &settings);
    snow_method method = settings.method == SNOW_METHOD_AUTO
                             ? SNOW_METHOD_SHEAR_WARP
                             : settings.method;
    if (method != SNOW_METHOD_SHEAR_WARP || adds_up(settings.mode) ||
        view.width < WIDTH || (holes && settings.mode != SNOW_MODE_ISO))
        near_pictures(p, &view, &settings, method);
    else
        same_pictures(p, &view, &settings);
    if (settings.depth)
        same_depths(p);
}

static const snow_opacity_point curve[] = {{0, 0}, {40, 0.4}, {120, 1}};
static const snow_look fades = {.size = sizeof fades,
                                .gradient_opacities = curve,
                                .gradient_opacity_count = COUNT(curve)};

/* Types times slabs of so many slices times stands. */
static const struct sweep {
    fill_fn *fill;
    size_t one_of; /* support_takes */
    int slices[6]; /* 0: no more */
    const snow_look *look;
    bool holes; /* of floats alone */
} sweeps[] = {
    {draw_over, 19, {1, 5, 35, 50, 70, 1000}, NULL, false},
    {draw_modes, 19, {4, 35}, NULL, false},
    {draw_modes, 7, {20, 200}, NULL, true},
    {draw_by_footprints, 19, {30, 120}, NULL, false},
    {draw_wide_pixels, 19, {40}, NULL, false},
    {draw_depths, 19, {60, 140}, NULL, false},
    {draw_gradients, 19, {3, 43, 123}, &fades, false},
};

static void check_sweep(support_files *place, const struct sweep *sweep,
                        size_t t) {
    const snow_type type = sweep->holes ? SNOW_TYPE_FLOAT32 : types[t];
    const char *path = NULL;
    for (size_t s = 0; s < 6 && sweep->slices[s]; s++) {
        pair p = {0};
        for (size_t n = 0; n < COUNT(stands); n++) {
            if (!support_takes(n + COUNT(stands) * (s + 6 * t), sweep->one_of))
                continue;
            if (!path)
                path = sweep->holes ? write_holes(place)
                                    : write_head(place, type, "v.nrrd");
            if (!p.whole)
                p = open_pair(place, path, NULL,
                              slices_of(type, sweep->slices[s]), sweep->look);
            check_stand(place, &p, n + 5 * s + t, type, n, sweep->fill,
                        sweep->holes);
        }
        close_pair(&p);
    }
}

static void pictures_are_those_of_the_volume_in_memory(void **state) {
    for (size_t n = 0; n < COUNT(sweeps); n++)
        for (size_t t = 0; t < (sweeps[n].holes ? 1 : COUNT(types)); t++)
            check_sweep(*state, &sweeps[n], t);
}

static void a_box_a_spacing_a_mask_and_a_plane_are_heeded(void **state) {
    support_files *place = *state;
    char path[128];
    strcpy(path, write_head(place, SNOW_TYPE_UINT16, "head.nrrd"));
    snow_volume_options options = {
        .size = sizeof options,
        .spacing = {1, 1.25, 0.5},
        .crop = {{3, 38}, {0, 0}, {7, 99}},
        .clip = {{0.2, 1, 0.1, 45}},
    };
    for (size_t n = 0; n < COUNT(stands); n++) {
        if (!support_takes(n, 3))
            continue;
        options.mask = n % 2 ? NULL : path;
        options.labels = n % 2 ? NULL : "3000-65535";
        pair p = open_pair(place, path, &options,
                           slices_of(SNOW_TYPE_FLOAT32, 4 + (int)n), NULL);
        same_usual(place, &p, n);
        close_pair(&p);
    }
}

static void packed_files_are_served_as_well(void **state) {
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_INT16, "head.nii.gz");
    pair p = open_pair(place, path, NULL, slices_of(SNOW_TYPE_INT16, 40), NULL);
    for (size_t n = 0; n < COUNT(stands); n += 5) {
        same_usual(place, &p, n);
    }
    close_pair(&p);
}

/* --- looks ---------------------------------------------------------------- */

static void looks_are_those_of_the_volume_in_memory(void **state) {
    static const snow_look looks[] = {
        {.size = sizeof(snow_look)},
        {.size = sizeof(snow_look), .preset = "linear"},
        {.size = sizeof(snow_look),
         .range = SNOW_RANGE_PERCENTILES,
         .low = 1,
         .high = 99.5},
        {.size = sizeof(snow_look),
         .range = SNOW_RANGE_FULL,
         .colormap = "viridis"},
        {.size = sizeof(snow_look),
         .log = true,
         .range = SNOW_RANGE_PERCENTILES,
         .low = 30,
         .high = 90},
        {.size = sizeof(snow_look), .preset = "mr-brain"},
    };
    support_files *place = *state;
    for (size_t t = 0; t < COUNT(types); t++) {
        const char *path = write_head(place, types[t], "head.nrrd");
        for (size_t n = 0; n < COUNT(looks); n++) {
            if (!support_takes(n + COUNT(looks) * t, 5))
                continue;
            if (looks[n].preset && snow_preset_from_name(looks[n].preset) < 0)
                continue;
            pair p = open_pair(place, path, NULL,
                               slices_of(types[t], 1 + 10 * (int)n), &looks[n]);
            snow_transfer *other;
            assert_int_equal(
                snow_transfer_new_for_volume(p.whole, &looks[n], &other),
                SNOW_STATUS_OK);
            for (int value = -4000; value < 60000; value += 200) {
                double a[4], b[4];
                snow_transfer_evaluate(p.transfer, value, a);
                snow_transfer_evaluate(other, value, b);
                assert_memory_equal(a, b, sizeof a);
            }
            snow_transfer_free(other);
            close_pair(&p);
        }
    }
}

/* Bytes of the file that a look of floats reads, under a limit. */
static uint64_t read_for_look(support_files *place, const char *path,
                              uint64_t limit, char text[1024]) {
    snow_volume *stream =
        stream_of(place, path, NULL, slices_of(SNOW_TYPE_FLOAT32, 20));
    uint64_t before = snow_context_bytes_read(place->context);
    snow_transfer *transfer;
    snow_context_set_memory_limit(place->context, limit);
    assert_int_equal(snow_transfer_new_for_volume(stream, NULL, &transfer),
                     SNOW_STATUS_OK);
    snow_context_set_memory_limit(place->context, 0);
    snprintf(text, 1024, "%s", snow_transfer_description(transfer));
    snow_transfer_free(transfer);
    snow_volume_close(stream);
    return snow_context_bytes_read(place->context) - before;
}

static void a_sample_that_has_room_spares_readings(void **state) {
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_FLOAT32, "head.nrrd");
    uint64_t all = slices_of(SNOW_TYPE_FLOAT32, (int)dims[2]);
    char one[1024], many[1024];
    uint64_t once = read_for_look(place, path, 0, one);
    uint64_t often = read_for_look(place, path, 2 * all, many);
    /* The header is read with each slab. */
    assert_true(once >= all && once < 2 * all);
    assert_true(often > 5 * all);
    assert_string_equal(one, many);
}

/* --- memory and reading --------------------------------------------------- */

static void no_more_than_a_slab_is_held(void **state) {
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_UINT16, "head.nrrd");
    uint64_t slab = slices_of(SNOW_TYPE_UINT16, 8);
    snow_volume *stream = stream_of(place, path, NULL, slab);
    snow_transfer *transfer;
    assert_null(snow_volume_voxels(stream));
    assert_true(snow_context_bytes(place->context) < 4096);
    place->largest = 0;
    assert_int_equal(snow_transfer_new_for_volume(stream, NULL, &transfer),
                     SNOW_STATUS_OK);
    assert_true(place->largest <= 65536 * sizeof(uint64_t) + 1024);
    assert_true(slab <= 65536 * sizeof(uint64_t));
    snow_transfer_free(transfer);
    snow_volume_close(stream);
}

/* Pictures after the first read nothing, but where the slice axis is another
 * one. */
static void the_file_is_read_for_another_slice_axis_only(void **state) {
    static const struct {
        size_t stand;
        bool reads;
    } turns[] = {{2, true}, {3, false}, {2, false}, {4, true}, {5, false}};
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_UINT8, "head.raw");
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {dims[0], dims[1], dims[2]},
                                         .type = SNOW_TYPE_UINT8};
    /* Encodings may take 8 times a slab's bytes. */
    pair p = open_pair(place, path, &options,
                       slices_of(SNOW_TYPE_UINT8, 8 * 40), NULL);
    uint64_t all = slices_of(SNOW_TYPE_UINT8, (int)dims[2]);
    for (size_t n = 0; n < COUNT(turns); n++) {
        snow_view view = stand_at(place, turns[n].stand);
        snow_settings settings;
        snow_image *image;
        snow_settings_init(&settings);
        uint64_t before = snow_context_bytes_read(place->context);
        assert_int_equal(snow_frame_render(p.of_stream, p.stream, p.transfer,
                                           &view, &settings, &image),
                         SNOW_STATUS_OK);
        uint64_t read = snow_context_bytes_read(place->context) - before;
        assert_int_equal(snow_frame_stats(p.of_stream)->encoded,
                         turns[n].reads);
        /* Ghost layers are read twice; the first picture finds the range. */
        assert_true(turns[n].reads ? read >= all && read < 3 * all : read == 0);
        snow_image_free(image);
    }
    close_pair(&p);
}

/* A picture of the stream alone, which is that of the volume in memory; returns
 * the bytes that were read. */
static uint64_t draw_under_limit(support_files *place, const pair *p,
                                 const snow_view *view,
                                 const snow_settings *settings,
                                 snow_image *same) {
    snow_image *image;
    uint64_t before = snow_context_bytes_read(place->context);
    assert_int_equal(snow_frame_render(p->of_stream, p->stream, p->transfer,
                                       view, settings, &image),
                     SNOW_STATUS_OK);
    assert_memory_equal(snow_image_pixels(image), snow_image_pixels(same),
                        (size_t)(WIDTH * HEIGHT * snow_image_channels(same)) *
                            sizeof(float));
    snow_image_free(image);
    return snow_context_bytes_read(place->context) - before;
}

/* Encodings of slabs are kept as far as memory allows, and no farther. */
static void a_limit_leaves_some_slabs_to_be_read_again(void **state) {
    support_files *place = *state;
    char path[128];
    strcpy(path, write_head(place, SNOW_TYPE_UINT8, "head.raw"));
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {dims[0], dims[1], dims[2]},
                                         .type = SNOW_TYPE_UINT8};
    pair p =
        open_pair(place, path, &options, slices_of(SNOW_TYPE_UINT8, 64), NULL);
    const snow_view view = stand_at(place, 2);
    snow_settings settings;
    snow_image *same, *image;
    snow_settings_init(&settings);
    settings.threads = 1;
    draw_both(&p, &view, &settings, &same, &image);
    snow_image_free(image);
    snow_frame_free(p.of_whole);
    snow_volume_close(p.whole);
    p.of_whole = NULL;
    p.whole = NULL;
    uint64_t kept = snow_context_bytes(place->context);
    int some = 0, all = 0;
    assert_int_equal(draw_under_limit(place, &p, &view, &settings, same), 0);
    snow_frame_free(p.of_stream);
    assert_int_equal(snow_frame_new(place->context, &p.of_stream),
                     SNOW_STATUS_OK);
    uint64_t held = snow_context_bytes(place->context);
    snow_context_set_memory_limit(place->context, held + 100);
    assert_int_equal(snow_frame_render(p.of_stream, p.stream, p.transfer, &view,
                                       &settings, &image),
                     SNOW_STATUS_NO_MEMORY);
    for (uint64_t parts = 4; parts <= 24; parts += support_stride(3)) {
        snow_context_set_memory_limit(place->context,
                                      held + (kept - held) * parts / 48);
        snow_status status = snow_frame_render(
            p.of_stream, p.stream, p.transfer, &view, &settings, &image);
        if (status == SNOW_STATUS_OK) {
            snow_image_free(image);
            some += draw_under_limit(place, &p, &view, &settings, same) > 0;
            all++;
        } else /* too little for one slab */
            assert_true(status == SNOW_STATUS_NO_MEMORY && all == 0);
        snow_frame_free(p.of_stream);
        assert_int_equal(snow_frame_new(place->context, &p.of_stream),
                         SNOW_STATUS_OK);
    }
    assert_true(some > 0 && some < all);
    snow_image_free(same);
    close_pair(&p);
}

/* The first call that fails; nothing may be left of it. */
static snow_status draw_once(support_files *place, const char *path,
                             const snow_view *view, snow_mode mode,
                             bool depth) {
    snow_volume *stream = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    snow_settings settings;
    snow_settings_init(&settings);
    settings.threads = 1;
    settings.mode = mode;
    settings.iso = 90;
    settings.depth = depth;
    snow_status status = snow_volume_open_streamed(
        place->context, path, NULL, slices_of(SNOW_TYPE_UINT8, 115), &stream);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_new_for_volume(stream, NULL, &transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_frame_new(place->context, &frame);
    if (status == SNOW_STATUS_OK)
        status =
            snow_frame_render(frame, stream, transfer, view, &settings, &image);
    snow_image_free(image);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(stream);
    return status;
}

static void fail_everywhere(support_files *place, const char *path,
                            snow_mode mode, bool depth, int step) {
    const snow_view view = stand_at(place, 2);
    snow_status status = SNOW_STATUS_NO_MEMORY;
    int failures = 0;
    uint64_t held = snow_context_bytes(place->context);
    for (int64_t n = 1; status != SNOW_STATUS_OK; n += step, failures++) {
        place->fail_at = place->allocations + n;
        status = draw_once(place, path, &view, mode, depth);
        assert_true(status == SNOW_STATUS_OK ||
                    status == SNOW_STATUS_NO_MEMORY);
        assert_int_equal(snow_context_bytes(place->context), held);
    }
    place->fail_at = 0;
    assert_true(failures * step > 50);
}

static void any_allocation_may_fail(void **state) {
    static const struct {
        snow_mode mode;
        bool depth;
        int step, least; /* and in the release tier */
    } cases[] = {{SNOW_MODE_OVER, false, 89, 1},
                 {SNOW_MODE_OVER, true, 113, 37},
                 {SNOW_MODE_SUM, false, 83, 3},
                 {SNOW_MODE_ISO, true, 97, 3}};
    support_files *place = *state;
    char path[128];
    strcpy(path, write_head(place, SNOW_TYPE_UINT8, "head.nrrd"));
    for (size_t n = 0; n < COUNT(cases); n++)
        fail_everywhere(place, path, cases[n].mode, cases[n].depth,
                        support_is_release() ? cases[n].least : cases[n].step);
}

/* --- what is refused ------------------------------------------------------ */

static void pictures_that_look_at_voxels_are_refused(void **state) {
    static const struct {
        snow_mode mode;
        snow_method method;
        bool depth, deterministic, limited;
        snow_status status;
        const char *words;
    } wrong[] = {
        {SNOW_MODE_MIP, SNOW_METHOD_AUTO, true, false, false,
         SNOW_STATUS_BAD_USAGE, "mode mip has no depth"},
        {SNOW_MODE_OVER, SNOW_METHOD_FOOTPRINT, false, true, false,
         SNOW_STATUS_NO_MEMORY, "a deterministic picture by method footprint"},
        {SNOW_MODE_OVER, SNOW_METHOD_FOOTPRINT, false, false, true,
         SNOW_STATUS_NO_MEMORY, "slices of their neighbours"},
        /* Slabs cut what these take as a whole. */
        {SNOW_MODE_OVER, SNOW_METHOD_AUTO, false, true, false,
         SNOW_STATUS_NO_MEMORY, "needs all voxels in memory; allow more"},
        {SNOW_MODE_MEAN, SNOW_METHOD_AUTO, false, true, false,
         SNOW_STATUS_NO_MEMORY, "needs all voxels in memory; allow more"},
        {SNOW_MODE_SUM, SNOW_METHOD_AUTO, false, true, false,
         SNOW_STATUS_NO_MEMORY, "needs all voxels in memory; allow more"},
    };
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_UINT8, "head.nrrd");
    pair p = open_pair(place, path, NULL, 0, NULL);
    snow_view view = stand_at(place, 0);
    snow_settings settings;
    for (size_t n = 0; n < COUNT(wrong); n++) {
        snow_image *image = NULL;
        snow_settings_init(&settings);
        settings.mode = wrong[n].mode;
        settings.method = wrong[n].method;
        settings.depth = wrong[n].depth;
        settings.deterministic = wrong[n].deterministic;
        if (wrong[n].limited)
            snow_context_set_memory_limit(
                place->context, snow_context_bytes(place->context) + (1 << 18));
        assert_int_equal(snow_frame_render(p.of_stream, p.stream, p.transfer,
                                           &view, &settings, &image),
                         wrong[n].status);
        assert_null(image);
        assert_non_null(
            strstr(snow_context_message(place->context), wrong[n].words));
        snow_context_set_memory_limit(place->context, 0);
    }
    same_usual(place, &p, 0); /* and then it draws */
    close_pair(&p);
}

static void all_else_that_looks_at_voxels_is_refused(void **state) {
    static const double plane[4] = {1, 0, 0, 5};
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_UINT8, "head.nrrd");
    snow_volume *stream = stream_of(place, path, NULL, 0), *made = NULL;
    snow_volume *whole = support_opened(place, path, NULL);
    snow_volume_statistics measures = {.size = sizeof measures};
    snow_transfer *transfer;
    uint64_t counts[2];
    double ratio;
    snow_extent part = {.size = sizeof part};
    snow_volume_get_extent(stream, &part);
    assert_int_equal(snow_transfer_new_for_volume(whole, NULL, &transfer),
                     SNOW_STATUS_OK);
    const snow_status statuses[] = {
        snow_volume_histogram(stream, 0, 1, 2, counts),
        snow_volume_convert(stream, SNOW_TYPE_UINT16, NULL, &made),
        snow_volume_mask(stream, whole, NULL, 0, &made),
        snow_volume_mask(whole, stream, NULL, 0, &made),
        snow_volume_clip(stream, plane, 1, &made),
        snow_volume_save(stream, support_path(place, "b.nrrd"), false),
        snow_volume_set_extent(stream, &part),
        snow_transfer_sparse_ratio(transfer, stream, 0, &ratio),
    };
    for (size_t n = 0; n < COUNT(statuses); n++)
        assert_int_equal(statuses[n], SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(place->context),
                           "the voxels stay in the file"));
    snow_volume_get_statistics(stream, &measures);
    assert_int_equal(measures.voxels, dims[0] * dims[1] * dims[2]);
    assert_int_equal(measures.finite, 0);
    assert_true(isnan(measures.min));
    assert_null(made);
    snow_transfer_free(transfer);
    snow_volume_close(whole);
    snow_volume_close(stream);
}

static void a_file_that_goes_away_or_changes_is_an_error(void **state) {
    static const char *const others[] = {"engine", NULL};
    support_files *place = *state;
    char path[128];
    strcpy(path, write_head(place, SNOW_TYPE_UINT8, "head.nrrd"));
    for (size_t n = 0; n < COUNT(others); n++) {
        pair p =
            open_pair(place, path, NULL, slices_of(SNOW_TYPE_UINT8, 10), NULL);
        snow_view view = stand_at(place, 0);
        snow_settings settings;
        snow_image *image = NULL;
        snow_volume *other;
        snow_settings_init(&settings);
        assert_int_equal(unlink(path), 0);
        if (others[n]) { /* of the same sizes, and another type */
            assert_int_equal(
                snow_volume_convert(p.whole, SNOW_TYPE_UINT16, NULL, &other),
                SNOW_STATUS_OK);
            assert_int_equal(snow_volume_save(other, path, true),
                             SNOW_STATUS_OK);
            snow_volume_close(other);
        }
        assert_int_equal(snow_frame_render(p.of_stream, p.stream, p.transfer,
                                           &view, &settings, &image),
                         SNOW_STATUS_BAD_INPUT);
        assert_null(image);
        assert_non_null(strstr(snow_context_message(place->context), path));
        close_pair(&p);
        strcpy(path, write_head(place, SNOW_TYPE_UINT8, "head.nrrd"));
    }
}

/* Texts of options may go when the volume is open. */
static void options_are_copied(void **state) {
    support_files *place = *state;
    char file[128 + 60], component[] = "y";
    snow_volume_options options = {.size = sizeof options,
                                   .component = component};
    memcpy(file, "\x93NUMPY\1\0v\0", 10);
    snprintf(file + 10, 119, "%-117s\n",
             "{'descr': '|u1', 'fortran_order': False, "
             "'shape': (2, 2, 5, 3)}");
    for (int n = 0; n < 60; n++)
        file[128 + n] = (char)n;
    const char *path = support_write(place, "v.npy", file, sizeof file);
    snow_volume *volume = stream_of(place, path, &options, 0);
    memset(component, 'z', 1);
    const snow_look look = {
        .size = sizeof look, .preset = "linear", .range = SNOW_RANGE_FULL};
    snow_transfer *transfer = NULL;
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_OK);
    double low, high;
    snow_transfer_domain(transfer, &low, &high);
    assert_true(low == 1 && high == 58);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
}

static void streams_that_cannot_be_read_twice_are_refused(void **state) {
    support_files *place = *state;
    snow_volume *volume;
    assert_int_equal(
        snow_volume_open_streamed(place->context, "-", NULL, 0, &volume),
        SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(place->context),
                           "standard input: can be read only once"));
    assert_int_equal(snow_volume_open_streamed(place->context,
                                               support_path(place, "none.nrrd"),
                                               NULL, 0, &volume),
                     SNOW_STATUS_BAD_INPUT);
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_files_setup, \
                                    support_files_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(pictures_are_those_of_the_volume_in_memory),
        TEST(a_box_a_spacing_a_mask_and_a_plane_are_heeded),
        TEST(packed_files_are_served_as_well),
        TEST(looks_are_those_of_the_volume_in_memory),
        TEST(a_sample_that_has_room_spares_readings),
        TEST(no_more_than_a_slab_is_held),
        TEST(the_file_is_read_for_another_slice_axis_only),
        TEST(a_limit_leaves_some_slabs_to_be_read_again),
        TEST(any_allocation_may_fail),
        TEST(pictures_that_look_at_voxels_are_refused),
        TEST(all_else_that_looks_at_voxels_is_refused),
        TEST(a_file_that_goes_away_or_changes_is_an_error),
        TEST(options_are_copied),
        TEST(streams_that_cannot_be_read_twice_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
