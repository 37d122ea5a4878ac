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
static const int64_t dims[3] = {61, 70, 103};
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
                if ((x < 30 && y < 35 && z < 50) || z == 60 ||
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
    int pictures;
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

static void same_pictures(pair *p, const snow_view *view,
                          const snow_settings *settings) {
    snow_image *a, *b;
    draw_both(p, view, settings, &a, &b);
    same_figures(p, SNOW_METHOD_SHEAR_WARP);
    assert_memory_equal(snow_image_pixels(a), snow_image_pixels(b),
                        (size_t)(WIDTH * HEIGHT * snow_image_channels(a)) *
                            sizeof(float));
    snow_image_free(a);
    snow_image_free(b);
    p->pictures++;
}

/* The same to a few units of the last place of the largest number: samples of
 * slabs are added up from another voxel on. */
static void near_pictures(pair *p, const snow_view *view,
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
    p->pictures++;
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

/* Slabs of so many slices of the type, ghosts included. */
static uint64_t slices_of(snow_type type, int slices) {
    return (uint64_t)(dims[0] * dims[1]) * snow_type_size(type) *
           (uint64_t)slices;
}

/* --- pictures ------------------------------------------------------------- */

static void pictures_are_those_of_the_volume_in_memory(void **state) {
    static const int slices[] = {1, 5, 35, 50, 70, 1000};
    support_files *place = *state;
    int pictures = 0;
    for (size_t t = 0; t < COUNT(types); t++) {
        const char *path = write_head(place, types[t], "head.nrrd");
        for (size_t s = 0; s < COUNT(slices); s++) {
            pair p = open_pair(place, path, NULL,
                               slices_of(types[t], slices[s]), NULL);
            for (size_t n = 0; n < COUNT(stands); n++) {
                if (!support_takes(n + COUNT(stands) * (s + COUNT(slices) * t),
                                   13))
                    continue;
                snow_view view = stand_at(place, n);
                snow_settings settings;
                snow_settings_init(&settings);
                size_t i = n + 5 * s + t;
                settings.quality = (snow_quality)(i % 3);
                settings.shade =
                    i % 4 == 3 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
                settings.encoding = (snow_encoding)(i / 2 % 4);
                settings.threads = 1 + (int)(i % 3);
                settings.threshold = i % 5 == 4 ? 30 : 0;
                if (settings.quality == SNOW_QUALITY_DRAFT)
                    view.zoom = 4; /* which no level is for (levels.h) */
                same_pictures(&p, &view, &settings);
            }
            pictures += p.pictures;
            close_pair(&p);
        }
    }
    assert_true(pictures * 2 > (int)(COUNT(types) * COUNT(slices)));
}

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

static void other_modes_are_those_of_the_volume_in_memory(void **state) {
    static const int slices[] = {4, 35};
    support_files *place = *state;
    int pictures = 0;
    for (size_t t = 0; t < COUNT(types); t++) {
        const char *path = write_head(place, types[t], "head.nrrd");
        for (size_t s = 0; s < COUNT(slices); s++) {
            pair p = open_pair(place, path, NULL,
                               slices_of(types[t], slices[s]), NULL);
            for (size_t n = 0; n < COUNT(stands); n++) {
                if (!support_takes(n + COUNT(stands) * (s + COUNT(slices) * t),
                                   13))
                    continue;
                snow_view view = stand_at(place, n);
                snow_settings settings;
                snow_settings_init(&settings);
                size_t i = n + 3 * s + t;
                settings.mode = (snow_mode)(1 + i % SNOW_MODE_ISO);
                settings.quality = (snow_quality)(1 + i % 2);
                settings.encoding = (snow_encoding)(i / 2 % 4);
                settings.threads = 1 + (int)(i % 3);
                settings.shade = i % 3 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
                settings.deterministic = i % 4 == 0 &&
                                         settings.mode != SNOW_MODE_MEAN &&
                                         settings.mode != SNOW_MODE_SUM;
                settings.iso = types[t] == SNOW_TYPE_UINT8     ? 90
                               : types[t] == SNOW_TYPE_FLOAT32 ? 90
                                                               : 9000;
                settings.depth = settings.mode == SNOW_MODE_ISO && i % 2;
                if (settings.mode == SNOW_MODE_MEAN ||
                    settings.mode == SNOW_MODE_SUM)
                    near_pictures(&p, &view, &settings, SNOW_METHOD_SHEAR_WARP);
                else
                    same_pictures(&p, &view, &settings);
                if (settings.depth)
                    same_depths(&p);
            }
            pictures += p.pictures;
            close_pair(&p);
        }
    }
    assert_true(pictures * 2 > (int)(COUNT(types) * COUNT(slices)));
}

static void modes_of_a_volume_with_holes_are_near(void **state) {
    static const int slices[] = {20, 200};
    support_files *place = *state;
    const char *path = write_holes(place);
    for (size_t s = 0; s < COUNT(slices); s++) {
        pair p = open_pair(place, path, NULL,
                           slices_of(SNOW_TYPE_FLOAT32, slices[s]), NULL);
        for (size_t n = 0; n < COUNT(stands); n++) {
            if (!support_takes(n + COUNT(stands) * s, 13))
                continue;
            snow_view view = stand_at(place, n);
            snow_settings settings;
            snow_settings_init(&settings);
            settings.mode = (snow_mode)(1 + (n + s) % SNOW_MODE_SUM);
            settings.threads = 1 + (int)(n % 3);
            near_pictures(&p, &view, &settings, SNOW_METHOD_SHEAR_WARP);
        }
        snow_view view = stand_at(place, 1);
        snow_settings settings;
        snow_settings_init(&settings);
        settings.mode = SNOW_MODE_ISO;
        settings.iso = 90;
        same_pictures(&p, &view, &settings);
        close_pair(&p);
    }
}

static void exact_pictures_are_near(void **state) {
    static const snow_method methods[] = {
        SNOW_METHOD_FOOTPRINT, SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED};
    support_files *place = *state;
    for (size_t t = 0; t < COUNT(types); t++) {
        const char *path = write_head(place, types[t], "head.nrrd");
        pair p = open_pair(place, path, NULL,
                           slices_of(types[t], 30 + 90 * (int)t), NULL);
        for (size_t n = 0; n < COUNT(stands); n++) {
            if (!support_takes(n + COUNT(stands) * t, 7))
                continue;
            snow_view view = stand_at(place, n);
            snow_settings settings;
            snow_settings_init(&settings);
            settings.method = methods[n % COUNT(methods)];
            settings.shade = n % 4 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
            settings.encoding = (snow_encoding)(n / 2 % 4);
            settings.threads = 1 + (int)((n + t) % 3);
            near_pictures(&p, &view, &settings, settings.method);
        }
        close_pair(&p);
    }
}

/* What no lattice has pixels for is left to footprints. */
static void pictures_of_wide_pixels_are_near(void **state) {
    support_files *place = *state;
    pair p = open_pair(place, write_head(place, SNOW_TYPE_UINT8, "head.nrrd"),
                       NULL, slices_of(SNOW_TYPE_UINT8, 40), NULL);
    for (size_t n = 0; n < COUNT(stands); n += 3) {
        if (!support_takes(n / 3, 4))
            continue;
        snow_view view = stand_at(place, n);
        snow_settings settings;
        snow_settings_init(&settings);
        settings.mode = SNOW_MODE_MIP;
        view.width = view.height = 7;
        near_pictures(&p, &view, &settings, SNOW_METHOD_SHEAR_WARP);
    }
    close_pair(&p);
}

static void depths_of_over_are_those_of_the_volume_in_memory(void **state) {
    support_files *place = *state;
    for (size_t t = 0; t < COUNT(types); t++) {
        const char *path = write_head(place, types[t], "head.nrrd");
        pair p = open_pair(place, path, NULL,
                           slices_of(types[t], 60 + 40 * (int)t), NULL);
        for (size_t n = t; n < COUNT(stands); n += COUNT(types)) {
            if (!support_takes(n, 5))
                continue;
            snow_view view = stand_at(place, n);
            snow_settings settings;
            snow_settings_init(&settings);
            settings.depth = 1;
            same_pictures(&p, &view, &settings);
            same_depths(&p);
        }
        close_pair(&p);
    }
}

static void opacity_by_gradients_sees_beyond_a_slabs_border(void **state) {
    static const snow_opacity_point curve[] = {{0, 0}, {40, 0.4}, {120, 1}};
    const snow_look look = {.size = sizeof look,
                            .gradient_opacities = curve,
                            .gradient_opacity_count = COUNT(curve)};
    support_files *place = *state;
    for (size_t t = 0; t < COUNT(types); t++) {
        const char *path = write_head(place, types[t], "head.nrrd");
        pair p = open_pair(place, path, NULL,
                           slices_of(types[t], 3 + 40 * (int)t), &look);
        for (size_t n = 0; n < COUNT(stands); n++) {
            if (!support_takes(n + COUNT(stands) * t, 7))
                continue;
            snow_view view = stand_at(place, n);
            snow_settings settings;
            snow_settings_init(&settings);
            settings.shade = n % 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
            settings.quality = n % 3 ? SNOW_QUALITY_NORMAL : SNOW_QUALITY_HIGH;
            settings.threshold = n % 4 ? 0 : 20;
            same_pictures(&p, &view, &settings);
        }
        close_pair(&p);
    }
}

static void a_box_a_spacing_a_mask_and_a_plane_are_heeded(void **state) {
    support_files *place = *state;
    char path[128];
    strcpy(path, write_head(place, SNOW_TYPE_UINT16, "head.nrrd"));
    snow_volume_options options = {
        .size = sizeof options,
        .spacing = {1, 1.25, 0.5},
        .crop = {{3, 58}, {0, 0}, {7, 99}},
        .mask = path,
        .labels = "3000-65535",
        .clip = {{0.2, 1, 0.1, 60}},
    };
    for (size_t n = 0; n < COUNT(stands); n++) {
        if (!support_takes(n, 3))
            continue;
        if (n % 2)
            options.mask = options.labels = NULL;
        else {
            options.mask = path;
            options.labels = "3000-65535";
        }
        pair p = open_pair(place, path, &options,
                           slices_of(SNOW_TYPE_FLOAT32, 4 + (int)n), NULL);
        snow_view view = stand_at(place, n);
        snow_settings settings;
        snow_settings_init(&settings);
        same_pictures(&p, &view, &settings);
        close_pair(&p);
    }
}

/* Slabs cut what deterministic pictures take as a whole. */
static void deterministic_pictures_are_refused(void **state) {
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_UINT8, "head.nrrd");
    pair p = open_pair(place, path, NULL, slices_of(SNOW_TYPE_UINT8, 9), NULL);
    const snow_view view = stand_at(place, 2);
    snow_settings settings;
    snow_image *image = NULL;
    snow_settings_init(&settings);
    static const snow_mode modes[] = {SNOW_MODE_OVER, SNOW_MODE_MEAN,
                                      SNOW_MODE_SUM};
    settings.deterministic = 1;
    for (size_t n = 0; n < COUNT(modes); n++) {
        settings.mode = modes[n];
        assert_int_equal(snow_frame_render(p.of_stream, p.stream, p.transfer,
                                           &view, &settings, &image),
                         SNOW_STATUS_NO_MEMORY);
        assert_non_null(
            strstr(snow_context_message(place->context),
                   "needs all voxels in memory; allow more memory"));
    }
    settings.deterministic = 0;
    settings.mode = SNOW_MODE_OVER;
    same_pictures(&p, &view, &settings);
    close_pair(&p);
}

static void packed_files_are_served_as_well(void **state) {
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_INT16, "head.nii.gz");
    pair p = open_pair(place, path, NULL, slices_of(SNOW_TYPE_INT16, 40), NULL);
    for (size_t n = 0; n < COUNT(stands); n += 3) {
        snow_view view = stand_at(place, n);
        snow_settings settings;
        snow_settings_init(&settings);
        same_pictures(&p, &view, &settings);
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
            for (int value = -20; value < 300; value++) {
                snow_transfer *other;
                double a[4], b[4];
                assert_int_equal(
                    snow_transfer_new_for_volume(p.whole, &looks[n], &other),
                    SNOW_STATUS_OK);
                snow_transfer_evaluate(p.transfer, value * 200.0, a);
                snow_transfer_evaluate(other, value * 200.0, b);
                assert_memory_equal(a, b, sizeof a);
                snow_transfer_free(other);
                value += support_is_release() ? 40 : 110;
            }
            close_pair(&p);
        }
    }
}

/* Bytes of the file that a look of floats reads, under a limit. */
static uint64_t read_for_look(support_files *place, const char *path,
                              uint64_t limit, char text[1024]) {
    snow_volume *stream =
        stream_of(place, path, NULL, slices_of(SNOW_TYPE_FLOAT32, 7));
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
                       slices_of(SNOW_TYPE_UINT8, 8 * 20), NULL);
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
    for (uint64_t parts = 4; parts <= 24; parts++) {
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
    support_files *place = *state;
    char path[128];
    strcpy(path, write_head(place, SNOW_TYPE_UINT8, "head.nrrd"));
    fail_everywhere(place, path, SNOW_MODE_OVER, false,
                    support_is_release() ? 1 : 31);
    fail_everywhere(place, path, SNOW_MODE_OVER, true,
                    support_is_release() ? 37 : 61);
    fail_everywhere(place, path, SNOW_MODE_SUM, false,
                    support_is_release() ? 3 : 29);
    fail_everywhere(place, path, SNOW_MODE_ISO, true,
                    support_is_release() ? 3 : 29);
}

/* --- what is refused ------------------------------------------------------ */

static void refuse(pair *p, const char *part, const snow_view *view,
                   const snow_settings *settings, snow_status status) {
    snow_image *image = NULL;
    assert_int_equal(snow_frame_render(p->of_stream, p->stream, p->transfer,
                                       view, settings, &image),
                     status);
    assert_null(image);
    assert_non_null(strstr(snow_context_message(p->stream->context), part));
}

static void pictures_that_look_at_voxels_are_refused(void **state) {
    support_files *place = *state;
    const char *path = write_head(place, SNOW_TYPE_UINT8, "head.nrrd");
    pair p = open_pair(place, path, NULL, 0, NULL);
    snow_view view = stand_at(place, 0);
    snow_settings settings;
    snow_settings_init(&settings);
    settings.mode = SNOW_MODE_MIP;
    settings.depth = 1;
    refuse(&p, "mode mip has no depth", &view, &settings,
           SNOW_STATUS_BAD_USAGE);
    settings.mode = SNOW_MODE_OVER;
    settings.depth = 0;
    settings.deterministic = 1;
    settings.method = SNOW_METHOD_FOOTPRINT;
    refuse(&p, "a deterministic picture by method footprint", &view, &settings,
           SNOW_STATUS_NO_MEMORY);
    settings.deterministic = 0;
    snow_context_set_memory_limit(
        place->context, snow_context_bytes(place->context) + (1 << 18));
    refuse(&p, "slices of their neighbours", &view, &settings,
           SNOW_STATUS_NO_MEMORY);
    snow_context_set_memory_limit(place->context, 0);
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
    assert_int_equal(snow_volume_histogram(stream, 0, 1, 2, counts),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_volume_convert(stream, SNOW_TYPE_UINT16, NULL, &made),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_volume_mask(stream, whole, NULL, 0, &made),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_volume_mask(whole, stream, NULL, 0, &made),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_volume_clip(stream, plane, 1, &made),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(
        snow_volume_save(stream, support_path(place, "b.nrrd"), false),
        SNOW_STATUS_BAD_USAGE);
    snow_volume_get_extent(stream, &part);
    assert_int_equal(snow_volume_set_extent(stream, &part),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_transfer_new_for_volume(whole, NULL, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_sparse_ratio(transfer, stream, 0, &ratio),
                     SNOW_STATUS_BAD_USAGE);
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
        TEST(other_modes_are_those_of_the_volume_in_memory),
        TEST(modes_of_a_volume_with_holes_are_near),
        TEST(exact_pictures_are_near),
        TEST(pictures_of_wide_pixels_are_near),
        TEST(depths_of_over_are_those_of_the_volume_in_memory),
        TEST(opacity_by_gradients_sees_beyond_a_slabs_border),
        TEST(a_box_a_spacing_a_mask_and_a_plane_are_heeded),
        TEST(deterministic_pictures_are_refused),
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
