/* tests/formats/test_nifti.c - NIfTI files are read right or refused. */
#include "support/files.h"

#include <math.h>

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* A NIfTI file in memory, filled field by field at the offsets of nifti1.h and
 * nifti2.h. */
typedef struct file {
    unsigned char bytes[8192];
    size_t size;
    bool big;
    int version;
} file;

static void put_bits(file *f, size_t at, size_t size, uint64_t bits) {
    for (size_t i = 0; i < size; i++)
        f->bytes[at + (f->big ? size - 1 - i : i)] =
            (unsigned char)(bits >> (8 * i));
}

static void put_real(file *f, size_t at1, size_t at2, double value) {
    uint64_t bits;
    uint32_t narrow;
    const float single = (float)value;
    memcpy(&bits, &value, sizeof bits);
    memcpy(&narrow, &single, sizeof narrow);
    if (f->version == 1)
        put_bits(f, at1, 4, narrow);
    else
        put_bits(f, at2, 8, bits);
}

static void put_dim(file *f, size_t i, int64_t value) {
    if (f->version == 1)
        put_bits(f, 40 + 2 * i, 2, (uint64_t)value);
    else
        put_bits(f, 16 + 8 * i, 8, (uint64_t)value);
}

static void put_pixdim(file *f, size_t i, double value) {
    put_real(f, 76 + 4 * i, 104 + 8 * i, value);
}

static void put_code(file *f, size_t at1, size_t at2, int code) {
    put_bits(f, f->version == 1 ? at1 : at2, f->version == 1 ? 2 : 4,
             (uint64_t)code);
}

static void put_datatype(file *f, int datatype, size_t bytes) {
    put_bits(f, f->version == 1 ? 70 : 12, 2, (uint64_t)datatype);
    put_bits(f, f->version == 1 ? 72 : 14, 2, 8 * bytes);
}

static void put_sform(file *f, const double rows[12]) {
    put_code(f, 254, 348, 1);
    for (size_t i = 0; i < 12; i++)
        put_real(f, 280 + 4 * i, 400 + 8 * i, rows[i]);
}

static void put_qform(file *f, double b, double c, double d) {
    put_code(f, 252, 344, 1);
    put_real(f, 256, 352, b);
    put_real(f, 260, 360, c);
    put_real(f, 264, 368, d);
    put_real(f, 268, 376, 10);
    put_real(f, 272, 384, 20);
    put_real(f, 276, 392, 30);
}

/* 3 x 2 x 2 int16 voxels 100, 101, ... with neither sform nor qform. */
static file make_file(int version, bool big) {
    file f = {.big = big, .version = version};
    size_t data = version == 1 ? 352 : 544;
    put_bits(&f, 0, 4, version == 1 ? 348 : 540);
    if (version == 1)
        memcpy(f.bytes + 344, "n+1", 4);
    else
        memcpy(f.bytes + 4, "n+2\0\r\n\032\n", 8);
    const int64_t dim[8] = {3, 3, 2, 2, 1, 1, 1, 1};
    for (size_t i = 0; i < 8; i++) {
        put_dim(&f, i, dim[i]);
        put_pixdim(&f, i, i ? (double)i : 1);
    }
    put_datatype(&f, 4, 2);
    if (version == 1)
        put_real(&f, 108, 0, (double)data);
    else
        put_bits(&f, 168, 8, data);
    put_real(&f, 112, 176, 1);
    for (size_t i = 0; i < 12; i++)
        put_bits(&f, data + 2 * i, 2, 100 + i);
    f.size = data + 24;
    return f;
}

static snow_volume *open_file(support_files *files, const file *f) {
    return support_opened_bytes(files, "a.nii", f->bytes, f->size, NULL);
}

static void expect_first(snow_volume *volume, int value) {
    assert_int_equal(*(const int16_t *)snow_volume_voxels(volume), value);
    snow_volume_close(volume);
}

/* Opens it, and closes it; the warning, if there is any, has this part. */
static void expect_matrix(support_files *files, const file *f, bool medical,
                          const char *warning, const double rows[12]) {
    *files->warnings = 0;
    snow_volume *volume = open_file(files, f);
    support_expect_matrix(volume, rows);
    assert_int_equal(snow_volume_get_info(volume)->medical, medical);
    assert_true(!*warning == !*files->warnings &&
                strstr(files->warnings, warning));
    snow_volume_close(volume);
}

static void refuse(support_files *files, const file *f, const char *part) {
    support_bad_bytes(files, "a.nii", f->bytes, f->size, part);
}

static void both_versions_and_byte_orders_give_one_volume(void **state) {
    support_files *files = *state;
    for (int i = 0; i < 4; i++) {
        file f = make_file(1 + i / 2, i % 2);
        snow_volume *volume = open_file(files, &f);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_int_equal(info->dims[0], 3);
        assert_int_equal(info->dims[1], 2);
        assert_int_equal(info->dims[2], 2);
        assert_int_equal(info->type, SNOW_TYPE_INT16);
        assert_string_equal(info->format, "nifti");
        assert_string_equal(info->unit, "mm");
        assert_false(info->medical);
        support_expect_matrix(volume,
                              (double[]){1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0});
        const int16_t *voxels = snow_volume_voxels(volume);
        for (int k = 0; k < 12; k++)
            assert_int_equal(voxels[k], 100 + k);
        assert_string_equal(files->warnings, "");
        snow_volume_close(volume);
    }
}

static void every_scalar_type_is_read_in_both_byte_orders(void **state) {
    support_files *files = *state;
    static const struct {
        int code;
        snow_type type;
    } types[] = {{2, SNOW_TYPE_UINT8},    {4, SNOW_TYPE_INT16},
                 {8, SNOW_TYPE_INT32},    {16, SNOW_TYPE_FLOAT32},
                 {64, SNOW_TYPE_FLOAT64}, {256, SNOW_TYPE_INT8},
                 {512, SNOW_TYPE_UINT16}, {768, SNOW_TYPE_UINT32},
                 {1024, SNOW_TYPE_INT64}, {1280, SNOW_TYPE_UINT64}};
    uint64_t seed = 5;
    for (size_t i = 0; i < 4 * COUNT(types); i++) {
        file f = make_file(1 + (int)i % 2, i / 2 % 2);
        size_t size = snow_type_size(types[i / 4].type);
        size_t data = f.size - 24;
        put_datatype(&f, types[i / 4].code, size);
        f.size = data + 12 * size;
        unsigned char wanted[96];
        for (size_t k = 0; k < 12; k++) {
            uint64_t bits = support_random(&seed);
            put_bits(&f, data + k * size, size, bits);
            memcpy(wanted + k * size, &bits, size); /* little machines only */
        }
        snow_volume *volume = open_file(files, &f);
        assert_int_equal(snow_volume_get_info(volume)->type, types[i / 4].type);
        const uint16_t one = 1;
        if (*(const unsigned char *)&one)
            assert_memory_equal(snow_volume_voxels(volume), wanted, 12 * size);
        snow_volume_close(volume);
    }
}

static void slope_and_intercept_are_kept_and_zero_means_none(void **state) {
    static const double given[][4] = {{0.5, -3, 0.5, -3},
                                      {0, 7, 1, 0},
                                      {NAN, NAN, 1, 0},
                                      {INFINITY, 1, 1, 0}};
    for (size_t i = 0; i < 8; i++) {
        file f = make_file(1 + (int)i / 4, false);
        put_real(&f, 112, 176, given[i % 4][0]);
        put_real(&f, 116, 184, given[i % 4][1]);
        snow_volume *volume = open_file(*state, &f);
        assert_true(snow_volume_get_info(volume)->slope == given[i % 4][2]);
        assert_true(snow_volume_get_info(volume)->intercept == given[i % 4][3]);
        snow_volume_close(volume);
    }
}

static void the_matrix_is_sform_then_qform_then_spacing(void **state) {
    support_files *files = *state;
    const double sform[] = {0, 0, 4, -1, 2, 0, 0, -2, 0, -3, 0, -3};
    for (int version = 1; version < 3; version++) {
        file f = make_file(version, version == 1);
        put_qform(&f, 0, 0, 1); /* half a turn about z */
        expect_matrix(files, &f, true, "",
                      (double[]){-1, 0, 0, 10, 0, -2, 0, 20, 0, 0, 3, 30});
        put_sform(&f, sform);
        expect_matrix(files, &f, true, "", sform);
    }
}

static void a_quaternion_turns_and_qfac_mirrors(void **state) {
    support_files *files = *state;
    file f = make_file(1, false);
    put_qform(&f, 0.5, 0.5, 0.5); /* x -> y -> z -> x */
    put_pixdim(&f, 0, -1);
    expect_matrix(files, &f, true, "",
                  (double[]){0, 0, -3, 10, 1, 0, 0, 20, 0, 2, 0, 30});
    put_pixdim(&f, 0, 0); /* 0 counts as 1 */
    expect_matrix(files, &f, true, "",
                  (double[]){0, 0, 3, 10, 1, 0, 0, 20, 0, 2, 0, 30});
    /* Rounding made it too long by a little; it still is a rotation. */
    put_qform(&f, 0, 0, 1.000001);
    expect_matrix(files, &f, true, "",
                  (double[]){-1, 0, 0, 10, 0, -2, 0, 20, 0, 0, 3, 30});
}

static void bad_geometry_falls_back_with_a_warning(void **state) {
    support_files *files = *state;
    file f = make_file(1, false);
    put_qform(&f, 0, 0, 0);
    put_sform(&f, (double[12]){1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0});
    expect_matrix(files, &f, true, "sform",
                  (double[]){1, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, 30});
    put_qform(&f, NAN, 0, 0);
    expect_matrix(files, &f, false, "qform",
                  (double[]){1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0});
    f = make_file(1, false);
    put_pixdim(&f, 1, NAN);
    put_pixdim(&f, 2, 0);
    put_pixdim(&f, 3, -5);
    expect_matrix(files, &f, false, "pixdim",
                  (double[]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 5, 0});
}

static void units_of_length_become_millimetres(void **state) {
    static const double factors[] = {1, 1000, 1, 0.001};
    for (unsigned unit = 0; unit < 4; unit++) {
        file f = make_file(1, false);
        f.bytes[123] = (unsigned char)(unit | 8); /* 8: seconds */
        double k = factors[unit];
        expect_matrix(*state, &f, false, "",
                      (double[]){k, 0, 0, 0, 0, 2 * k, 0, 0, 0, 0, 3 * k, 0});
    }
}

static void put_dims(file *f, const int64_t dim[8]) {
    for (size_t i = 0; i < 8; i++)
        put_dim(f, i, dim[i]);
}

/* Time is the fourth axis; axes behind it count values of a voxel. */
static void the_step_and_channel_that_are_asked_for_are_read(void **state) {
    support_files *files = *state;
    file f = make_file(1, false);
    put_dims(&f, (int64_t[]){6, 2, 1, 1, 2, 1, 3, 99});
    for (int64_t n = 0; n < 6; n++) {
        const snow_volume_options options = {
            .size = sizeof options, .time = n % 2, .channel = n / 2};
        snow_volume *volume =
            support_opened_bytes(files, "a.nii", f.bytes, f.size, &options);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_int_equal(info->times, 2);
        assert_int_equal(info->time, n % 2);
        assert_int_equal(info->channels, 3);
        assert_false(info->channel[1].shown);
        expect_first(volume, 100 + 2 * (int)n);
    }
    assert_non_null(strstr(files->warnings, "channel 0 of 3"));
    const snow_volume_options beyond[] = {
        {.size = sizeof *beyond, .time = 2},
        {.size = sizeof *beyond, .channel = 3}};
    const char *path = support_write(files, "a.nii", f.bytes, f.size);
    for (int n = 0; n < 2; n++)
        support_refused(files, path, &beyond[n], SNOW_STATUS_BAD_USAGE, "",
                        SUPPORT_MOST);
    put_dims(&f, (int64_t[]){4, 2, 1, 1, 6, 99, 99, 99});
    snow_volume_close(open_file(files, &f));
    assert_non_null(strstr(files->warnings, "time step 0 of 6"));
}

static void colours_are_channels(void **state) {
    for (int samples = 3; samples <= 4; samples++) {
        file f = make_file(1 + samples % 2, false);
        put_dim(&f, 1, 2);
        put_dim(&f, 2, 1);
        put_dim(&f, 3, 2);
        put_datatype(&f, samples == 3 ? 128 : 2304, (size_t)samples);
        for (int64_t n = 0; n < samples; n++) {
            const snow_volume_options options = {.size = sizeof options,
                                                 .channel = n};
            snow_volume *volume = support_opened_bytes(*state, "a.nii", f.bytes,
                                                       f.size, &options);
            const snow_volume_info *info = snow_volume_get_info(volume);
            const snow_channel *one = &info->channel[n];
            const unsigned char *voxels = snow_volume_voxels(volume);
            const unsigned char *stored = f.bytes + f.size - 24;
            assert_int_equal(info->channels, samples);
            assert_int_equal(info->type, SNOW_TYPE_UINT8);
            assert_true(one->own == (n < 3) && one->shown == (n < 3));
            for (int c = 0; c < 3; c++)
                assert_true(one->color[c] == (c == n));
            for (int i = 0; i < 4; i++)
                assert_int_equal(voxels[i], stored[i * samples + n]);
            snow_volume_close(volume);
        }
    }
}

static void few_axes_and_extensions_are_read(void **state) {
    support_files *files = *state;
    file f = make_file(1, false);
    put_dim(&f, 0, 1);
    put_dim(&f, 1, 12);
    put_dim(&f, 2, -4); /* unused, may be anything */
    put_dim(&f, 3, 0);
    memmove(f.bytes + 384, f.bytes + 352, 24);
    memset(f.bytes + 352, 'x', 32);
    put_real(&f, 108, 0, 384);
    f.size += 32;
    snow_volume *volume = open_file(files, &f);
    assert_int_equal(snow_volume_get_info(volume)->dims[0], 12);
    assert_int_equal(snow_volume_get_info(volume)->dims[1], 1);
    expect_first(volume, 100);
    f = make_file(1, false);
    put_real(&f, 108, 0, 0); /* right after the header */
    expect_first(open_file(files, &f), 100);
    assert_string_equal(files->warnings, "");
    f.size += 5;
    snow_volume_close(open_file(files, &f));
    assert_non_null(strstr(files->warnings, "5 bytes after"));
}

static void cut_files_are_refused_at_every_length(void **state) {
    for (int version = 1; version < 3; version++) {
        file f = make_file(version, false);
        size_t whole = f.size;
        for (f.size = 1; f.size < whole; f.size++)
            refuse(*state, &f,
                   version == 2    ? ""
                   : f.size == 1   ? "1 byte is too few for a NIfTI header"
                   : f.size == 347 ? "347 bytes are too few for a NIfTI header"
                                   : "");
    }
    support_bad_bytes(*state, "a.nii", "", 0, "empty");
}

enum field { DIM, TYPE, OFFSET, INTERCEPT };

static void headers_that_lie_are_refused(void **state) {
    static const struct {
        int version;
        enum field field;
        size_t axis;
        double value;
        const char *part;
    } cases[] = {
        {1, TYPE, 0, 1, "bits"},
        {1, TYPE, 0, 1536, "128-bit"},
        {1, TYPE, 0, 2048, "complex"},
        {1, TYPE, 0, 0, "type 0 is unknown"},
        {1, TYPE, 0, 77, "type 77"},
        {1, INTERCEPT, 0, NAN, "intercept"},
        {1, DIM, 0, 8, "8 axes"},
        {1, DIM, 2, 0, "axis 2"},
        {1, DIM, 2, -1, "axis 2"},
        {1, DIM, 2, INT16_MIN, "axis 2"},
        {2, DIM, 1, 0x1p62, "too large for any file"},
        {1, OFFSET, 0, -1, "vox_offset"},
        {1, OFFSET, 0, 100, "vox_offset"},
        {1, OFFSET, 0, 349, "vox_offset"},
        {1, OFFSET, 0, 351, "vox_offset"},
        {1, OFFSET, 0, 352.5, "vox_offset"},
        {1, OFFSET, 0, NAN, "vox_offset"},
        {1, OFFSET, 0, INFINITY, "vox_offset"},
        {1, OFFSET, 0, 1e30, "vox_offset"},
        {1, OFFSET, 0, 100000, "bytes left"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        file f = make_file(cases[i].version, false);
        const double value = cases[i].value;
        if (cases[i].field == DIM)
            put_dim(&f, cases[i].axis, (int64_t)value);
        else if (cases[i].field == TYPE)
            put_datatype(&f, (int)value, 0);
        else
            put_real(&f, cases[i].field == OFFSET ? 108 : 116, 184, value);
        refuse(*state, &f, cases[i].part);
    }
    file f = make_file(1, false);
    put_dims(&f, (int64_t[]){3, 32767, 32767, 32767, 1, 1, 1, 1});
    refuse(*state, &f, "bytes left");
    put_dims(&f,
             (int64_t[]){7, 32767, 32767, 32767, 32767, 32767, 32767, 32767});
    refuse(*state, &f, "too large for any file");
    f = make_file(2, false);
    f.bytes[8] = '\n'; /* as a transfer as text leaves it */
    refuse(*state, &f, "text");
    f = make_file(1, false);
    memset(f.bytes + 344, 0, 4);
    refuse(*state, &f, "Analyze");
}

/* Their number repeats the type, which other readers take, too. */
static void wrong_bits_leave_the_type(void **state) {
    for (int version = 1; version <= 2; version++) {
        file f = make_file(version, false);
        put_datatype(&f, 4, 1);
        expect_first(open_file(*state, &f), 100);
    }
    support_files *files = *state;
    assert_non_null(strstr(files->warnings, "claims 8 bits per voxel"));
}

static void cal_min_and_cal_max_are_the_window(void **state) {
    static const struct {
        double low, high;
        int intent;
        bool is;
    } rows[] = {{3, 80, 0, true},    {0, 0, 0, false},
                {5, 5, 0, false},    {80, 3, 0, false},
                {NAN, 3, 0, false},  {-INFINITY, 3, 0, false},
                {3, 80, 1002, false}};
    for (size_t i = 0; i < 4 * COUNT(rows); i++) {
        file f = make_file(1 + (int)i % 4 / 2, i % 2);
        put_real(&f, 128, 200, rows[i / 4].low);
        put_real(&f, 124, 192, rows[i / 4].high);
        put_code(&f, 68, 504, rows[i / 4].intent);
        snow_volume *volume = open_file(*state, &f);
        const double *window = snow_volume_get_info(volume)->window;
        assert_true(window[0] == (rows[i / 4].is ? 3 : 0));
        assert_true(window[1] == (rows[i / 4].is ? 80 : 0));
        snow_volume_close(volume);
    }
}

static void cifti_is_no_volume(void **state) {
    for (int version = 1; version <= 2; version++) {
        file f = make_file(version, false);
        put_code(&f, 68, 504, 3006); /* dense scalars */
        support_bad_bytes(*state, "a.nii", f.bytes, f.size, "wb_command");
    }
}

static void gzip_is_verified_to_its_last_byte(void **state) {
    support_files *files = *state;
    file f = make_file(1, false);
    unsigned char packed[16384];
    size_t size = support_gzip(f.bytes, f.size, packed, sizeof packed);
    expect_first(support_opened_bytes(files, "a.nii.gz", packed, size, NULL),
                 100);
    for (size_t cut = 20; cut < size; cut++)
        support_bad_bytes(files, "a.nii.gz", packed, cut, "");
    for (size_t i = size - 8; i < size; i++) {
        packed[i] ^= 1;
        support_bad_bytes(files, "a.nii.gz", packed, size, "damaged");
        packed[i] ^= 1;
    }
}

static void a_packed_size_that_lies_is_refused_early(void **state) {
    file f = make_file(1, false);
    unsigned char packed[16384];
    for (size_t i = 1; i < 4; i++)
        put_dim(&f, i, 4000);
    support_bad_bytes(*state, "a.nii.gz", packed,
                      support_gzip(f.bytes, f.size, packed, sizeof packed),
                      "at most");
}

/* Header and voxels as two files: either is opened, packed or not. */
static void pairs_open_by_either_file(void **state) {
    support_files *files = *state;
    static const char *const names[][3] = {{"a.hdr", "a.img", ""},
                                           {"B.HDR", "B.IMG", ""},
                                           {"c.hdr.gz", "c.img.gz", "x"},
                                           {"d.hdr", "d.img.gz", "x"}};
    for (size_t i = 0; i < 8; i++) {
        const char *const *name = names[i / 2];
        file f = make_file(1 + (int)i % 2, i % 2);
        size_t header = f.version == 1 ? 348 : 540;
        memcpy(f.bytes + (f.version == 1 ? 344 : 4), "ni", 2);
        if (f.version == 1)
            put_real(&f, 108, 0, 4);
        else
            put_bits(&f, 168, 8, 4);
        unsigned char packed[16384];
        /* Four bytes to skip, then voxels. */
        const unsigned char *image = f.bytes + header;
        support_write(files, name[0], f.bytes, header);
        if (*name[2])
            support_write(files, name[1], packed,
                          support_gzip(image, 28, packed, sizeof packed));
        else
            support_write(files, name[1], image, 28);
        for (int k = 0; k < 2; k++)
            expect_first(
                support_opened(files, support_path(files, name[k]), NULL), 100);
    }
}

static void a_pair_without_its_other_file_is_refused(void **state) {
    support_files *files = *state;
    file f = make_file(1, false);
    memcpy(f.bytes + 344, "ni1", 4);
    support_bad_file(files, support_write(files, "a.hdr", f.bytes, 348),
                     "a.img");
    support_bad_file(files, support_write(files, "b.img", f.bytes + 352, 24),
                     "b.hdr");
    support_bad_file(files, support_write(files, "c.dat", f.bytes, 348),
                     "rename");
    refuse(files, &f, "rename");
}

#define NII "formats/nifti/"

/* The figures of DATA.md: sizes, type, range as stored. */
static const struct real_file {
    const char *name;
    int64_t dims[3];
    const char *type;
    double min, max;
} real_files[] = {
    {"classic/fuel.nii.gz", {64, 33, 32}, "uint8", 0, 255},
    {NII "5D_zeros.nii.gz", {256, 256, 170}, "uint8", 0, 0},
    {NII "air.hdr.gz", {79, 67, 64}, "float32", 0, 92.5539},
    {NII "air.img.gz", {79, 67, 64}, "float32", 0, 92.5539},
    {NII "anatomical.nii", {33, 41, 25}, "int16", -610, 30393},
    {NII "avf_float_32.nii.gz", {74, 93, 20}, "float32", 0, 2509.89},
    {NII "avg152T1_LR_nifti.nii", {91, 109, 91}, "uint8", 0, 255},
    {NII "big.nii.gz", {64, 64, 21}, "float32", -8.71075, 18.5825},
    {NII "little.nii.gz", {64, 64, 21}, "float32", -8.71075, 18.5825},
    {NII "standard.nii.gz", {4, 5, 7}, "uint8", 0, 255},
    {NII "with_extension.nii.gz", {161, 191, 151}, "uint8", 0, 1},
    {"formats/nrrd/pynrrd/BallBinary30x30x30.nii.gz",
     {30, 30, 30},
     "int16",
     0,
     257},
    {"medical/CT_AVM.nii.gz", {256, 242, 154}, "uint8", 0, 255},
    {"medical/CT_pitch.nii.gz", {175, 248, 58}, "uint8", 0, 255},
    {"medical/ch2.nii.gz", {181, 217, 181}, "uint8", 0, 254},
    {"medical/chris_MRA.nii.gz", {200, 256, 120}, "uint8", 0, 254},
    {"medical/fmri_pitch.nii.gz", {64, 64, 35}, "uint8", 0, 255},
    {"sim/heptane.nii.gz", {302, 302, 302}, "uint8", 0, 255},
};

static void real_files_have_their_known_figures(void **state) {
    if (!support_data("classic/fuel.nii.gz"))
        skip();
    for (size_t i = 0; i < COUNT(real_files); i++) {
        const struct real_file *real = &real_files[i];
        snow_volume *volume =
            support_opened(*state, support_data(real->name), NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_memory_equal(info->dims, real->dims, sizeof info->dims);
        assert_int_equal(info->times, 1);
        assert_string_equal(snow_type_name(info->type), real->type);
        assert_true(info->medical);
        snow_volume_statistics m = {.size = sizeof m};
        snow_volume_get_statistics(volume, &m);
        double low = real->min * info->slope + info->intercept;
        double high = real->max * info->slope + info->intercept;
        assert_true(fabs(m.min - low) <= 1e-5 * fabs(low));
        assert_true(fabs(m.max - high) <= 1e-5 * fabs(high));
        assert_int_equal(m.finite, m.voxels);
        snow_volume_close(volume);
    }
}

/* Stored range over all time steps, or channels. */
static void range_of_all_steps(support_files *files, const char *name,
                               int64_t steps, double slope, double intercept,
                               double range[2]) {
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int64_t n = 0; n < steps; n++) {
        const bool times = !strstr(name, "5D");
        const snow_volume_options options = {.size = sizeof options,
                                             .time = times ? n : 0,
                                             .channel = times ? 0 : n};
        snow_volume *volume =
            support_opened(files, support_data(name), &options);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_int_equal(times ? info->times : info->channels, steps);
        assert_true(fabs(info->slope - slope) < 1e-12);
        assert_true(fabs(info->intercept - intercept) < 1e-12);
        snow_volume_statistics m = {.size = sizeof m};
        snow_volume_get_statistics(volume, &m);
        range[0] = fmin(range[0], round((m.min - intercept) / slope));
        range[1] = fmax(range[1], round((m.max - intercept) / slope));
        snow_volume_close(volume);
    }
}

static void real_files_of_many_steps_have_their_known_range(void **state) {
    support_files *files = *state;
    if (!support_data(NII "functional.nii"))
        skip();
    double range[2];
    range_of_all_steps(files, NII "functional.nii", 20, 0.07540696859359741,
                       3100.76171875, range);
    assert_true(range[0] == -32768 && range[1] == 32767);
    range_of_all_steps(files, NII "example_nifti2.nii.gz", 2, 1, 0, range);
    assert_true(range[0] == 46 && range[1] == 757);
    range_of_all_steps(files, NII "5D_small.nii", 3, 0.0027581409085541964,
                       0.07691901922225952, range);
    assert_true(range[0] == 0 && range[1] == 255);
}

static void same_real_pair(support_files *files, const char *first,
                           const char *second) {
    snow_volume *a = support_opened(files, support_data(first), NULL);
    snow_volume *b = support_opened(files, support_data(second), NULL);
    support_same_voxels(a, b);
    support_same_matrix(snow_volume_get_info(a)->matrix,
                        snow_volume_get_info(b)->matrix, 1e-5);
    snow_volume_close(a);
    snow_volume_close(b);
}

static void real_pairs_are_the_same(void **state) {
    support_files *files = *state;
    if (!support_data(NII "big.nii.gz"))
        skip();
    same_real_pair(files, NII "big.nii.gz", NII "little.nii.gz");
    same_real_pair(files, NII "avg152T1_LR_nifti.nii",
                   NII "avg152T1_LR_nifti.nii.gz");
    same_real_pair(files, NII "avf_float_32.nii.gz",
                   "formats/nrrd/avf_float_32.nrrd");
    same_real_pair(files, NII "air.hdr.gz", NII "air.img.gz");
}

static void a_real_file_of_another_kind_is_refused(void **state) {
    const char *path = support_data(NII "not-nifti.nii");
    if (!path)
        skip();
    support_bad_file(*state, path, "not a NIfTI");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(both_versions_and_byte_orders_give_one_volume),
        SUPPORT_TEST(every_scalar_type_is_read_in_both_byte_orders),
        SUPPORT_TEST(slope_and_intercept_are_kept_and_zero_means_none),
        SUPPORT_TEST(the_matrix_is_sform_then_qform_then_spacing),
        SUPPORT_TEST(a_quaternion_turns_and_qfac_mirrors),
        SUPPORT_TEST(bad_geometry_falls_back_with_a_warning),
        SUPPORT_TEST(units_of_length_become_millimetres),
        SUPPORT_TEST(the_step_and_channel_that_are_asked_for_are_read),
        SUPPORT_TEST(colours_are_channels),
        SUPPORT_TEST(few_axes_and_extensions_are_read),
        SUPPORT_TEST(cut_files_are_refused_at_every_length),
        SUPPORT_TEST(headers_that_lie_are_refused),
        SUPPORT_TEST(wrong_bits_leave_the_type),
        SUPPORT_TEST(cal_min_and_cal_max_are_the_window),
        SUPPORT_TEST(cifti_is_no_volume),
        SUPPORT_TEST(gzip_is_verified_to_its_last_byte),
        SUPPORT_TEST(a_packed_size_that_lies_is_refused_early),
        SUPPORT_TEST(pairs_open_by_either_file),
        SUPPORT_TEST(a_pair_without_its_other_file_is_refused),
        SUPPORT_TEST(real_files_have_their_known_figures),
        SUPPORT_TEST(real_files_of_many_steps_have_their_known_range),
        SUPPORT_TEST(real_pairs_are_the_same),
        SUPPORT_TEST(a_real_file_of_another_kind_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
