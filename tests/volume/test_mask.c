/* tests/volume/test_mask.c - voxels that a mask leaves out have no value, all
 * others keep theirs; labels as they are written; grids that do not fit. */
#include "support/files.h"
#include "volume/volume.h"

#include <math.h>

static snow_volume_info info_of(snow_type type, int64_t x, int64_t y,
                                int64_t z) {
    return (snow_volume_info){
        .size = sizeof(snow_volume_info), .dims = {x, y, z}, .type = type};
}

static snow_volume *shared(support_files *place, const snow_volume_info *info,
                           const void *voxels) {
    snow_volume *volume = NULL;
    if (snow_volume_wrap(place->context, info, voxels, &volume) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    return volume;
}

static snow_volume *row(support_files *place, snow_type type, int64_t count,
                        const void *voxels) {
    snow_volume_info info = info_of(type, count, 1, 1);
    return shared(place, &info, voxels);
}

/* Masks a volume, and closes both. */
static snow_volume *masked(support_files *place, snow_volume *volume,
                           snow_volume *mask, const snow_label_range *labels,
                           size_t count) {
    snow_volume *out = NULL;
    if (snow_volume_mask(volume, mask, labels, count, &out) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    snow_volume_close(volume);
    snow_volume_close(mask);
    return out;
}

/* Which of the voxels have a value, as bits; closes the volume. */
static unsigned kept(snow_volume *volume) {
    unsigned bits = 0;
    for (int64_t i = 0; i < volume->info.dims[0]; i++)
        if (!isnan(snow_volume_native(volume, i)))
            bits |= 1u << i;
    snow_volume_close(volume);
    return bits;
}

static void values_of_every_type_are_kept(void **state) {
    support_files *place = *state;
    static const uint8_t mask[] = {1, 0, 255, 0};
#define TYPE_CASE(name, c_type, text)                                     \
    {                                                                     \
        static const c_type v[] = {(c_type)7, (c_type)1, (c_type)99,      \
                                   (c_type)1};                            \
        snow_volume *made =                                               \
            masked(place, row(place, SNOW_TYPE_##name, 4, v),             \
                   row(place, SNOW_TYPE_UINT8, 4, mask), NULL, 0);        \
        bool narrow =                                                     \
            sizeof(c_type) <= 2 || SNOW_TYPE_##name == SNOW_TYPE_FLOAT32; \
        assert_int_equal(made->info.type,                                 \
                         narrow ? SNOW_TYPE_FLOAT32 : SNOW_TYPE_FLOAT64); \
        assert_true(snow_volume_native(made, 0) == 7);                    \
        assert_true(snow_volume_native(made, 2) == 99);                   \
        assert_int_equal(kept(made), 5);                                  \
    }
    SNOW_TYPE_MAP(TYPE_CASE)
#undef TYPE_CASE
}

static void the_largest_integers_are_exact(void **state) {
    support_files *place = *state;
    static const uint8_t mask[] = {1, 1};
    static const int32_t wide[] = {INT32_MAX, INT32_MIN};
    static const uint16_t narrow[] = {UINT16_MAX, 0};
    snow_volume *made = masked(place, row(place, SNOW_TYPE_INT32, 2, wide),
                               row(place, SNOW_TYPE_UINT8, 2, mask), NULL, 0);
    assert_true(snow_volume_native(made, 0) == INT32_MAX);
    assert_true(snow_volume_native(made, 1) == INT32_MIN);
    snow_volume_close(made);
    made = masked(place, row(place, SNOW_TYPE_UINT16, 2, narrow),
                  row(place, SNOW_TYPE_UINT8, 2, mask), NULL, 0);
    assert_true(snow_volume_native(made, 0) == UINT16_MAX);
    snow_volume_close(made);
}

static void what_is_known_of_the_volume_stays(void **state) {
    support_files *place = *state;
    static const int16_t v[] = {1, 2};
    static const uint8_t mask[] = {1, 0};
    snow_volume_info info = info_of(SNOW_TYPE_INT16, 2, 1, 1);
    info.slope = 0.5;
    info.intercept = -3;
    info.medical = true;
    for (int i = 0; i < 4; i++)
        info.matrix[i][i] = 1;
    info.matrix[0][3] = -20;
    snow_volume *volume = shared(place, &info, v);
    const snow_extent part = {
        sizeof part, {5, 1, 1}, {3, 0, 0}, {3, 0, 0}, {2, 1, 1}};
    assert_int_equal(snow_volume_set_extent(volume, &part), SNOW_STATUS_OK);
    snow_volume *made =
        masked(place, volume, row(place, SNOW_TYPE_UINT8, 2, mask), NULL, 0);
    assert_true(made->info.slope == 0.5 && made->info.intercept == -3);
    assert_true(made->info.medical && made->info.matrix[0][3] == -20);
    snow_extent now = {.size = sizeof now};
    snow_volume_get_extent(made, &now);
    assert_memory_equal(&now, &part, sizeof part);
    snow_volume_statistics m = {.size = sizeof m};
    snow_volume_get_statistics(made, &m);
    assert_true(m.finite == 1 && m.min == -2.5 && m.max == -2.5);
    assert_false(made->info.eight_bits);
    snow_volume_close(made);
    made = masked(place, row(place, SNOW_TYPE_UINT8, 2, mask),
                  row(place, SNOW_TYPE_UINT8, 2, mask), NULL, 0);
    assert_true(made->info.eight_bits);
    snow_volume_close(made);
}

/* Of a scaled mask the data values count. */
static void inside_is_what_is_neither_0_nor_nan(void **state) {
    support_files *place = *state;
    static const int16_t v[6] = {0};
    const float mask[] = {0, -0.0F, NAN, 1e-30F, -1, INFINITY};
    static const uint8_t scaled[] = {0, 1, 2, 2, 4, 0};
    assert_int_equal(
        kept(masked(place, row(place, SNOW_TYPE_INT16, 6, v),
                    row(place, SNOW_TYPE_FLOAT32, 6, mask), NULL, 0)),
        0x38);
    snow_volume_info info = info_of(SNOW_TYPE_UINT8, 6, 1, 1);
    info.slope = 3;
    info.intercept = -6;
    assert_int_equal(kept(masked(place, row(place, SNOW_TYPE_INT16, 6, v),
                                 shared(place, &info, scaled), NULL, 0)),
                     0x33);
    static const snow_label_range six = {6, 6};
    assert_int_equal(kept(masked(place, row(place, SNOW_TYPE_INT16, 6, v),
                                 shared(place, &info, scaled), &six, 1)),
                     0x10);
}

static void only_labels_are_inside(void **state) {
    support_files *place = *state;
    static const uint8_t v[10] = {0};
    const double mask[] = {0, 1, 2, 4, 5.5, 7, 8, -3, NAN, 1};
    static const snow_label_range ranges[] = {{1, 1}, {4, 7}, {-3, -3}};
    assert_int_equal(
        kept(masked(place, row(place, SNOW_TYPE_UINT8, 10, v),
                    row(place, SNOW_TYPE_FLOAT64, 10, mask), ranges, 3)),
        0x2aa);
    /* 0 may be asked for. */
    static const snow_label_range zero = {0, 0};
    assert_int_equal(
        kept(masked(place, row(place, SNOW_TYPE_UINT8, 10, v),
                    row(place, SNOW_TYPE_FLOAT64, 10, mask), &zero, 1)),
        1);
}

/* A float that has no value stays so. */
static void nan_of_the_volume_stays(void **state) {
    support_files *place = *state;
    const float v[] = {1, NAN, 3};
    static const uint8_t mask[] = {1, 1, 0};
    assert_int_equal(
        kept(masked(place, row(place, SNOW_TYPE_FLOAT32, 3, v),
                    row(place, SNOW_TYPE_UINT8, 3, mask), NULL, 0)),
        1);
}

/* Blocks of the loop end within a large volume. */
static void large_volumes_are_masked_to_their_end(void **state) {
    support_files *place = *state;
    static uint16_t v[5000];
    static uint32_t mask[5000];
    for (uint32_t i = 0; i < 5000; i++) {
        v[i] = (uint16_t)(3 * i);
        mask[i] = i / 700;
    }
    static const snow_label_range ranges[] = {{2, 3}, {7, 7}};
    snow_volume *made =
        masked(place, row(place, SNOW_TYPE_UINT16, 5000, v),
               row(place, SNOW_TYPE_UINT32, 5000, mask), ranges, 2);
    for (int64_t i = 0; i < 5000; i++) {
        uint32_t label = mask[i];
        double value = snow_volume_native(made, i);
        bool inside = label == 2 || label == 3 || label == 7;
        assert_true(inside ? value == v[i] : isnan(value));
    }
    snow_volume_close(made);
}

static void labels_are_read_as_written(void **state) {
    (void)state;
    snow_label_range r[4] = {{0, 0}};
    size_t count = 0;
    assert_true(snow_labels_parse("1,4-7,-3,-5--4", r, 4, &count));
    assert_int_equal(count, 4);
    assert_true(r[0].first == 1 && r[0].last == 1);
    assert_true(r[1].first == 4 && r[1].last == 7);
    assert_true(r[2].first == -3 && r[2].last == -3);
    assert_true(r[3].first == -5 && r[3].last == -4);
    assert_true(snow_labels_parse("9007199254740991", r, 4, &count));
    assert_int_equal(count, 1);
    assert_true(r[0].last == INT64_C(9007199254740991));
}

static void what_is_no_list_of_labels_changes_nothing(void **state) {
    (void)state;
    static const char *const wrong[] = {
        "",      ",",   "1,",        ",1",   "1-",
        "-",     "7-4", "1.5",       " 1",   "1 ",
        "1, 2",  "a",   "1;2",       "0x10", "9007199254740992",
        "+1",    "1e3", "1,2,3,4,5", "--1",  "99999999999999999999",
        "1-2-3", "4--2"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snow_label_range r[4] = {{11, 12}};
        size_t count = 9;
        if (snow_labels_parse(wrong[i], r, 4, &count))
            fail_msg("'%s' was read", wrong[i]);
        assert_true(count == 9 && r[0].first == 11 && r[0].last == 12);
    }
}

/* Beyond a plane of the world, whatever the matrix; in it they stay. */
static void voxels_beyond_planes_are_left_out(void **state) {
    support_files *place = *state;
    static const int16_t v[24] = {0};
    static const double planes[][4] = {
        {0.3, 0, 0.1, 4}, {0, 0, 0, 0}, {0, -2, 0, 2.6}};
    snow_volume_info info = info_of(SNOW_TYPE_INT16, 4, 3, 2);
    static const double matrix[4][4] = {
        {0, 2, 0.5, 7}, {1.3, 0, 0, -2.6}, {0, 0.25, 3, 1}, {0, 0, 0, 1}};
    memcpy(info.matrix, matrix, sizeof matrix);
    snow_volume *volume = shared(place, &info, v), *made = NULL;
    assert_int_equal(snow_volume_clip(volume, planes[0], 3, &made),
                     SNOW_STATUS_OK);
    assert_int_equal(made->info.type, SNOW_TYPE_FLOAT32);
    int left = 0, in_plane = 0;
    for (int i = 0; i < 24; i++) {
        int x = i % 4, y = i / 4 % 3, z = i / 12;
        double at[3] = {2 * y + 0.5 * z + 7, 1.3 * x - 2.6,
                        y / 4.0 + 3 * z + 1};
        bool out =
            0.3 * at[0] + 0.1 * at[2] > 4 + 1e-9 || -2 * at[1] > 2.6 + 1e-9;
        in_plane += fabs(-2 * at[1] - 2.6) < 1e-9;
        left += !out;
        assert_int_equal(isnan(snow_volume_native(made, i)), out);
    }
    assert_true(left > 4 && left < 20 && in_plane > 0);
    snow_volume_close(made);
    assert_int_equal(
        snow_volume_clip(volume, planes[0], SNOW_CLIPS_MAX + 1, &made),
        SNOW_STATUS_BAD_USAGE);
    snow_volume_close(volume);
}

static void refused(support_files *place, const snow_volume_info *a,
                    const snow_volume_info *b, const char *part) {
    static const uint8_t voxels[64] = {0};
    snow_volume *volume = shared(place, a, voxels), *out = NULL;
    snow_volume *mask = shared(place, b, voxels);
    snow_status status = snow_volume_mask(volume, mask, NULL, 0, &out);
    assert_int_equal(status, part ? SNOW_STATUS_BAD_INPUT : SNOW_STATUS_OK);
    if (part && !strstr(snow_context_message(place->context), part))
        fail_msg("\"%s\" lacks \"%s\"", snow_context_message(place->context),
                 part);
    assert_true(!out == !!part);
    snow_volume_close(out);
    snow_volume_close(mask);
    snow_volume_close(volume);
}

static snow_volume_info placed(double spacing, double x) {
    snow_volume_info info = info_of(SNOW_TYPE_UINT8, 4, 3, 2);
    for (int i = 0; i < 3; i++)
        info.matrix[i][i] = spacing;
    info.matrix[0][3] = x;
    info.matrix[3][3] = 1;
    info.medical = true;
    return info;
}

/* What the voxel nearest to a place of the world has, 0 outside. */
static int nearest_mark(const snow_volume_info *info, const uint8_t *marks,
                        const double at[3]) {
    double least = INFINITY;
    int mark = 0;
    for (int n = 0; n < info->dims[0] * info->dims[1] * info->dims[2]; n++) {
        double voxel[3] = {(double)(n % info->dims[0]),
                           (double)(n / info->dims[0] % info->dims[1]),
                           (double)(n / info->dims[0] / info->dims[1])};
        double off = 0;
        for (int row = 0; row < 3; row++) {
            double way = info->matrix[row][3] - at[row], longest = 0;
            for (int axis = 0; axis < 3; axis++) {
                way += info->matrix[row][axis] * voxel[axis];
                longest = fmax(longest, fabs(info->matrix[row][axis]));
            }
            off = fmax(off, fabs(way) / longest);
        }
        if (off < least) {
            least = off;
            mark = off <= 0.5 ? marks[n] : 0;
        }
    }
    return mark;
}

/* Turned, flipped, finer, elsewhere: by the nearest voxels; only where voxels
 * are not the same is there a note. */
static void a_mask_of_another_grid_is_resampled(void **state) {
    support_files *place = *state;
    static const struct {
        int64_t dims[3];
        double matrix[4][4];
        bool noted;
    } masks[] = {
        {{4, 3, 2},
         {{-2, 0, 0, 16}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}},
         false},
        {{2, 4, 3},
         {{0, -2, 0, 16}, {0, 0, 2, 0}, {2, 0, 0, 0}, {0, 0, 0, 1}},
         false},
        {{4, 3, 2},
         {{1.5, 0, 0, 11}, {0, 1.1, 0, 0.2}, {0, 0, 3, 1.2}, {0, 0, 0, 1}},
         true},
        {{2, 3, 2},
         {{0, 2, 0, 14}, {1.9, 0, 0, 0.1}, {0, 0, 2, 0}, {0, 0, 0, 1}},
         true}};
    static const uint8_t voxels[24] = {0};
    uint8_t marks[24];
    for (int n = 0; n < 24; n++)
        marks[n] = (uint8_t)(n * 7 % 3 > 0);
    snow_volume_info a = placed(2, 10);
    for (size_t n = 0; n < sizeof masks / sizeof *masks; n++) {
        snow_volume_info b = a;
        memcpy(b.dims, masks[n].dims, sizeof b.dims);
        memcpy(b.matrix, masks[n].matrix, sizeof b.matrix);
        snow_volume *volume = shared(place, &a, voxels), *out = NULL;
        snow_volume *mask = shared(place, &b, marks);
        place->warnings[0] = 0;
        assert_int_equal(snow_volume_mask(volume, mask, NULL, 0, &out),
                         SNOW_STATUS_OK);
        assert_int_equal(strstr(place->warnings, "another grid") != NULL,
                         masks[n].noted);
        for (int i = 0; i < 24; i++) {
            double at[3] = {10 + 2 * (i % 4), 2 * (i / 4 % 3), 2 * (i / 12)};
            assert_int_equal(isnan(snow_volume_native(out, i)),
                             !nearest_mark(&b, marks, at));
        }
        snow_volume_close(out);
        snow_volume_close(mask);
        snow_volume_close(volume);
    }
}

/* Beyond a mask is 0, whatever its intercept makes of it. */
static void beyond_a_scaled_mask_is_outside(void **state) {
    support_files *place = *state;
    static const uint8_t voxels[24] = {0}, marks[24] = {7, 7, 8, 7};
    snow_volume_info a = placed(2, 10), b = placed(2, 14);
    b.slope = 3;
    b.intercept = -22;
    snow_volume *out = masked(place, shared(place, &a, voxels),
                              shared(place, &b, marks), NULL, 0);
    assert_int_equal(kept(out), 0xc);
    static const snow_label_range two = {2, 2};
    b.dims[0] = 3;
    out = masked(place, shared(place, &a, voxels), shared(place, &b, marks + 1),
                 &two, 1);
    assert_int_equal(kept(out), 0x8);
}

static void another_size_without_a_place_is_refused(void **state) {
    support_files *place = *state;
    snow_volume_info a = info_of(SNOW_TYPE_UINT8, 4, 3, 2), b = a;
    b.dims[1] = 2;
    refused(place, &a, &b, "the mask has 4x2x2 voxels, the volume 4x3x2");
    a = placed(2, 10);
    b = placed(2, 10.1);
    refused(place, &a, &b, NULL);
}

static void what_tells_no_place_is_believed(void **state) {
    support_files *place = *state;
    snow_volume_info a = placed(2, 10),
                     none = info_of(SNOW_TYPE_UINT8, 4, 3, 2);
    refused(place, &a, &none, NULL);
    refused(place, &none, &a, NULL);
    snow_volume_info other = placed(2, 99); /* of another world */
    other.medical = false;
    refused(place, &a, &other, NULL);
}

/* A file of raw bytes as NRRD, with an origin where `origin` is not 0. */
static const char *put(support_files *place, const char *name,
                       const char *sizes, double origin, const void *voxels,
                       size_t size) {
    unsigned char bytes[4096];
    char place_line[200] = "";
    if (origin != 0)
        snprintf(place_line, sizeof place_line,
                 "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
                 "space origin: (%g,0,0)\n",
                 origin);
    int head = snprintf((char *)bytes, sizeof bytes,
                        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %s\n%s"
                        "encoding: raw\n\n",
                        sizes, place_line);
    memcpy(bytes + head, voxels, size);
    return support_write(place, name, bytes, (size_t)head + size);
}

static void a_box_is_masked_by_the_same_box(void **state) {
    support_files *place = *state;
    unsigned char v[64], m[64];
    for (int i = 0; i < 64; i++) {
        v[i] = (unsigned char)(i + 1);
        m[i] = (unsigned char)(i % 3);
    }
    const char *a = put(place, "a.nrrd", "4 4 4", 10, v, 64);
    const char *b = put(place, "b.nrrd", "4 4 4", 0, m, 64);
    snow_volume_options options = {.size = sizeof options,
                                   .crop = {{1, 4}, {0, 0}, {2, 3}},
                                   .mask = b,
                                   .labels = "2"};
    snow_volume *box = NULL;
    snow_volume_info given = {.size = sizeof given};
    assert_int_equal(snow_volume_inspect(place->context, a, &options, &given),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_volume_open(place->context, a, &options, &box),
                     SNOW_STATUS_OK);
    assert_memory_equal(&given, &box->info, sizeof given);
    assert_true(given.dims[0] == 3 && given.dims[1] == 4 && given.dims[2] == 1);
    assert_int_equal(given.type, SNOW_TYPE_FLOAT32);
    for (int64_t i = 0; i < 12; i++) {
        int64_t at = 1 + i % 3 + 4 * (i / 3) + 32;
        double value = snow_volume_native(box, i);
        assert_true(m[at] == 2 ? value == v[at] : isnan(value));
    }
    snow_volume_close(box);
}

/* Both boxes are alike; the wholes are not. */
static void a_box_of_another_grid_is_refused(void **state) {
    support_files *place = *state;
    static const unsigned char v[64] = {0};
    const char *a = put(place, "a.nrrd", "4 4 4", 0, v, 64);
    snow_volume_options options = {.size = sizeof options,
                                   .crop = {{0, 2}, {0, 2}, {0, 2}},
                                   .mask =
                                       put(place, "b.nrrd", "2 4 4", 0, v, 32)};
    snow_volume *box = NULL;
    assert_int_equal(snow_volume_open(place->context, a, &options, &box),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(
        strstr(snow_context_message(place->context),
               "b.nrrd: the mask has 2x4x4 voxels, the volume 4x4x4"));
    options.mask = NULL;
    options.labels = "1";
    assert_int_equal(
        snow_volume_open_memory(place->context, "x", v, 64, &options, &box),
        SNOW_STATUS_BAD_USAGE);
    assert_null(box);
}

static void a_mask_without_voxels_is_told(void **state) {
    support_files *place = *state;
    static const unsigned char v[64] = {5};
    const char *a = put(place, "a.nrrd", "4 4 4", 0, v, 64);
    snow_volume_options options = {
        .size = sizeof options, .mask = a, .labels = "1-4"};
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_open(place->context, a, &options, &volume),
                     SNOW_STATUS_OK);
    assert_non_null(strstr(place->warnings, "no voxel is left inside this "
                                            "mask, whose values are 0 to 5"));
    snow_volume_close(volume);
}

/* Slabs of a volume read their part of a mask of another grid; one that lies
 * elsewhere is refused, labels that there are not are told. */
static void what_a_mask_lacks_is_told(void **state) {
    support_files *place = *state;
    unsigned char v[64], m[128];
    for (int n = 0; n < 128; n++) {
        v[n / 2] = 5;
        m[n] = (unsigned char)(n * 5 % 7 > 2);
    }
    const char *a = put(place, "a.nrrd", "4 4 4", 10, v, 64);
    const char *b = put(place, "b.nrrd", "8 4 4", 7, m, 128);
    const char *c = put(place, "c.nrrd", "4 4 4", 90, v, 64);
    snow_volume_options options = {.size = sizeof options, .mask = b};
    snow_volume *whole = NULL, *part = NULL;
    assert_int_equal(snow_volume_open(place->context, a, &options, &whole),
                     SNOW_STATUS_OK);
    for (int64_t z = 0; z < 4; z++) {
        options.crop[0][0] = 1;
        options.crop[2][0] = z;
        options.crop[2][1] = z + 1;
        assert_int_equal(snow_volume_open(place->context, a, &options, &part),
                         SNOW_STATUS_OK);
        for (int64_t n = 0; n < 12; n++)
            assert_int_equal(isnan(snow_volume_native(part, n)),
                             isnan(snow_volume_native(
                                 whole, z * 16 + n / 3 * 4 + n % 3 + 1)));
        snow_volume_close(part);
    }
    snow_volume_close(whole);
    options = (snow_volume_options){.size = sizeof options, .mask = c};
    assert_int_equal(snow_volume_open(place->context, a, &options, &part),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(place->context),
                           "lies at 90..93 x 0..3 x 0..3 of the world, and the "
                           "volume at 10..13 x 0..3"));
    options = (snow_volume_options){.size = sizeof options, .labels = "7"};
    assert_int_equal(snow_volume_open(place->context, a, &options, &part),
                     SNOW_STATUS_OK);
    assert_non_null(strstr(place->warnings, "no voxel has such a label"));
    snow_volume_close(part);
}

/* Every allocation fails once; nothing is left behind. */
static void failures_of_memory_leave_nothing(void **state) {
    support_files *place = *state;
    static const unsigned char v[64] = {5};
    const char *a = put(place, "a.nrrd", "4 4 4", 0, v, 64);
    snow_volume_options options = {.size = sizeof options, .mask = a};
    snow_volume *volume = NULL;
    for (int64_t n = 1; !volume; n++) {
        place->fail_at = place->allocations + n;
        snow_status status =
            snow_volume_open(place->context, a, &options, &volume);
        assert_true(status == SNOW_STATUS_OK ||
                    status == SNOW_STATUS_NO_MEMORY);
        assert_true((status == SNOW_STATUS_OK) == !!volume);
    }
    place->fail_at = 0;
    snow_volume_close(volume);
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_files_setup, \
                                    support_files_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(values_of_every_type_are_kept),
        TEST(the_largest_integers_are_exact),
        TEST(what_is_known_of_the_volume_stays),
        TEST(inside_is_what_is_neither_0_nor_nan),
        TEST(only_labels_are_inside),
        TEST(nan_of_the_volume_stays),
        TEST(large_volumes_are_masked_to_their_end),
        TEST(labels_are_read_as_written),
        TEST(what_is_no_list_of_labels_changes_nothing),
        TEST(voxels_beyond_planes_are_left_out),
        TEST(a_mask_of_another_grid_is_resampled),
        TEST(beyond_a_scaled_mask_is_outside),
        TEST(another_size_without_a_place_is_refused),
        TEST(what_tells_no_place_is_believed),
        TEST(a_box_is_masked_by_the_same_box),
        TEST(a_box_of_another_grid_is_refused),
        TEST(a_mask_without_voxels_is_told),
        TEST(what_a_mask_lacks_is_told),
        TEST(failures_of_memory_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
