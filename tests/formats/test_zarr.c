/* tests/formats/test_zarr.c - Zarr: what is read of a store and what memory it
 * takes. Values and places are compared with zarr in oracle_zarr.py; stores are
 * written from records here. */
#include "formats/zarr/zarr.h"
#include "support/files.h"
#include "support/records.h"

#include <dirent.h>
#include <math.h>

typedef struct records {
    unsigned char bytes[1 << 16];
    size_t size;
} records;

static void add_bytes(records *r, const char *name, const void *bytes,
                      size_t size) {
    size_t letters = strlen(name);
    unsigned char *at = r->bytes + r->size;
    assert_true(letters < 256 &&
                r->size + letters + 5 + size <= sizeof r->bytes);
    at[0] = (unsigned char)letters;
    memcpy(at + 1, name, letters);
    for (int i = 0; i < 4; i++)
        at[1 + letters + (size_t)i] = (unsigned char)(size >> (8 * i));
    memcpy(at + 5 + letters, bytes, size);
    r->size += letters + 5 + size;
}

static void add_text(records *r, const char *name, const char *text) {
    add_bytes(r, name, text, strlen(text));
}

/* An array of bytes in chunks of 2 x 2 x 2 and other keys. */
static void describe(records *r, const char *shape, const char *chunks,
                     const char *more) {
    char text[512];
    r->size = 0;
    snprintf(text, sizeof text,
             "{\"zarr_format\": 2, \"shape\": %s, \"chunks\": %s, \"dtype\": "
             "\"|u1\", \"order\": \"C\", \"filters\": null, \"fill_value\": 7, "
             "%s}",
             shape, chunks, more);
    add_text(r, ".zarray", text);
}

static snow_status open_records(support_files *files, const records *r,
                                const char *path,
                                const snow_volume_options *options,
                                snow_volume **out) {
    const snow_volume_options none = {.size = sizeof none, .time = 0};
    zarr_store store = {.context = files->context};
    char folder[32];
    snow_volume_info info = {.size = sizeof info};
    files->largest = 0;
    *files->warnings = 0;
    records_unpack(r->bytes, r->size, folder);
    snprintf(store.folder, sizeof store.folder, "%s", folder);
    snow_status status = snow_zarr_read_store(
        &store, path, options ? options : &none, &info, out);
    records_remove(folder);
    return status;
}

static void expect_refused(support_files *files, const records *r,
                           const char *path, snow_status status,
                           const char *part, size_t most) {
    snow_volume *volume = NULL;
    assert_int_equal(open_records(files, r, path, NULL, &volume), status);
    assert_null(volume);
    if (!strstr(snow_context_message(files->context), part))
        fail_msg("\"%s\" lacks \"%s\"", snow_context_message(files->context),
                 part);
    assert_true(files->largest <= most);
}

#define PLAIN "\"compressor\": null"
#define PACKED(id) "\"compressor\": {\"id\": \"" id "\"}"

static void only_the_chunks_of_a_box_are_read(void **state) {
    support_files *files = *state;
    static records r;
    const unsigned char ones[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    const snow_volume_options box = {.size = sizeof box,
                                     .crop = {{2, 4}, {1, 2}, {0, 2}}};
    snow_volume *volume;
    describe(&r, "[2, 2, 4]", "[2, 2, 2]", PLAIN);
    add_text(&r, "0.0.0", "damaged");
    add_bytes(&r, "0.0.1", ones, sizeof ones);
    assert_int_equal(open_records(files, &r, "", &box, &volume),
                     SNOW_STATUS_OK);
    const uint8_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 4; i++)
        assert_int_equal(voxels[i], 1);
    assert_string_equal(files->warnings, "");
    snow_volume_close(volume);
    expect_refused(files, &r, "", SNOW_STATUS_BAD_INPUT, "0.0.0: holds 7 bytes",
                   4096);
}

static void chunks_that_are_missing_are_filled_and_told(void **state) {
    support_files *files = *state;
    static records r;
    const unsigned char ones[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    snow_volume *volume;
    describe(&r, "[2, 2, 4]", "[2, 2, 2]", PLAIN);
    add_bytes(&r, "0.0.1", ones, sizeof ones);
    assert_int_equal(open_records(files, &r, "", NULL, &volume),
                     SNOW_STATUS_OK);
    const uint8_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 16; i++)
        assert_int_equal(voxels[i], i % 4 < 2 ? 7 : 1);
    assert_non_null(strstr(files->warnings, "1 of 2 chunks are not stored"));
    snow_volume_close(volume);
}

/* Whichever chunk is the first one that is stored. */
static void chunks_are_found_where_they_lie(void **state) {
    support_files *files = *state;
    static records r;
    const unsigned char ones[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    const struct {
        const char *name, *keys, *note;
    } rows[] = {
        {"0/0/1", PLAIN, "\"/\" between"},
        {"0.0.1", PLAIN ", \"dimension_separator\": \"/\"", "\".\" between"}};
    for (size_t n = 0; n < 2; n++) {
        snow_volume *volume;
        describe(&r, "[2, 2, 4]", "[2, 2, 2]", rows[n].keys);
        add_bytes(&r, rows[n].name, ones, sizeof ones);
        assert_int_equal(open_records(files, &r, "", NULL, &volume),
                         SNOW_STATUS_OK);
        const uint8_t *voxels = snow_volume_voxels(volume);
        for (int i = 0; i < 16; i++)
            assert_int_equal(voxels[i], i % 4 < 2 ? 7 : 1);
        assert_non_null(strstr(files->warnings, rows[n].note));
        snow_volume_close(volume);
    }
}

/* CF 2.5.1: a value is missing if it equals _FillValue or any number of
 * missing_value; both lists are as long as lists may be. */
static void long_lists_of_missing_values_all_count(void **state) {
    static records r;
    char text[1024], *at = text;
    const unsigned char values[8] = {0, 63, 64, 127, 128, 7, 255, 200};
    at += sprintf(at, "{\"_FillValue\": [");
    for (int i = 0; i < 128; i++)
        at += sprintf(at, "%d%s", i,
                      i == 63    ? "], \"missing_value\": ["
                      : i == 127 ? "]}"
                                 : ", ");
    describe(&r, "[2, 2, 2]", "[2, 2, 2]", PLAIN);
    add_text(&r, ".zattrs", text);
    add_bytes(&r, "0.0.0", values, sizeof values);
    snow_volume *volume;
    assert_int_equal(open_records(*state, &r, "", NULL, &volume),
                     SNOW_STATUS_OK);
    const float *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 8; i++)
        assert_true(values[i] < 128 ? isnan(voxels[i])
                                    : voxels[i] == values[i]);
    snow_volume_close(volume);
}

/* The volume, and a chunk. */
static void memory_is_that_of_the_volume_and_a_chunk(void **state) {
    support_files *files = *state;
    static records r;
    static const unsigned char chunk[4096];
    const snow_volume_options box = {.size = sizeof box,
                                     .crop = {{0, 1}, {0, 1}, {0, 0}}};
    snow_volume *volume;
    describe(&r, "[8, 16, 256]", "[1, 16, 256]", PLAIN);
    for (int i = 0; i < 8; i++) {
        char name[16];
        snprintf(name, sizeof name, "%d.0.0", i);
        add_bytes(&r, name, chunk, sizeof chunk);
    }
    uint64_t before = snow_context_bytes(files->context);
    assert_int_equal(open_records(files, &r, "", &box, &volume),
                     SNOW_STATUS_OK);
    assert_true(snow_context_peak_bytes(files->context) <
                before + 3 * sizeof chunk + 8192);
    snow_volume_close(volume);
}

/* 2^30 bytes from a few: before memory is taken for them. */
static void sizes_that_lie_take_no_memory(void **state) {
    support_files *files = *state;
    static records r;
    unsigned char head[64] = {2, 1, 1, 1, 0, 0, 0, 64, 0, 0, 0, 1, 64};
    static const char *const cases[][4] = {
        {"[1, 1, 8]", "[1024, 1024, 1024]", PLAIN, "holds 64 bytes"},
#if SNOW_HAVE_BLOSC
        {"[1, 1, 8]", "[1, 1, 8]", PACKED("blosc"), "0.0.0: "},
        {"[1, 1, 8]", "[1, 1, 1000000]", PACKED("blosc"), "0.0.0: "},
#endif
        {"[1, 1, 8]", "[4096, 1024, 1024]", PACKED("zlib"), "too few for"},
        {"[4096, 4096, 4096]", "[64, 64, 64]", PLAIN, "most of it is missing"},
        {"[4096, 4096, 4096]", "[1, 1, 64]", PLAIN, "1048576 chunks"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        describe(&r, cases[i][0], cases[i][1], cases[i][2]);
        add_bytes(&r, "0.0.0", head, sizeof head);
        expect_refused(files, &r, "", SNOW_STATUS_BAD_INPUT, cases[i][3], 8192);
    }
}

static void paths_do_not_climb(void **state) {
    support_files *files = *state;
    static records r;
    static const char *const bad[] = {"..", "a/../b", "/a", "a//b", ".", "a/"};
    describe(&r, "[1, 1, 1]", "[1, 1, 1]", PLAIN);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[256];
        expect_refused(files, &r, bad[i], SNOW_STATUS_BAD_USAGE,
                       "not a path within", 1 << 16);
        static records image;
        image.size = 0;
        snprintf(text, sizeof text,
                 "{\"multiscales\": [{\"datasets\": [{\"path\": \"%s\"}]}]}",
                 bad[i]);
        add_text(&image, ".zattrs", text);
        expect_refused(files, &image, "", SNOW_STATUS_BAD_INPUT, "invalid path",
                       1 << 16);
    }
}

static void names_are_kept_on_one_line(void **state) {
    support_files *files = *state;
    static records r;
    r.size = 0;
    add_text(&r, ".zattrs",
             "{\"multiscales\": [{\"axes\": [\"a\\nb\", \"y\", \"x\"], "
             "\"datasets\": [{\"path\": \"p\\nq\"}, {\"path\": \"r\"}]}]}");
    add_text(&r, "p\nq/.zarray",
             "{\"shape\": [2, 1, 1], \"chunks\": [1, 1, 1], \"dtype\": "
             "\"|u1\", \"order\": \"C\", \"compressor\": null}");
    expect_refused(files, &r, "", SNOW_STATUS_BAD_INPUT, "a\\nb", 1 << 16);
    assert_null(strchr(snow_context_message(files->context), '\n'));
    assert_non_null(strstr(files->warnings, "level 0 of 2 (p\\nq)"));
}

static void the_check_sum_is_castagnolis(void **state) {
    (void)state;
    /* RFC 3720, appendix B.4, and the usual check value. */
    static const unsigned char zeros[32];
    assert_int_equal(snow_zarr_sum(zeros, sizeof zeros), 0x8A9136AA);
    assert_int_equal(snow_zarr_sum((const unsigned char *)"123456789", 9),
                     0xE3069283);
}

/* Every store of the corpus, with each allocation made to fail. */
static void check_file(support_files *files, const char *path) {
    static records r;
    FILE *file = fopen(path, "rb");
    snow_volume *volume = NULL;
    assert_non_null(file);
    r.size = fread(r.bytes, 1, sizeof r.bytes, file);
    fclose(file);
    files->fail_at = 0;
    int64_t before = files->allocations;
    open_records(files, &r, "", NULL, &volume);
    snow_volume_close(volume);
    int64_t count = files->allocations - before;
    for (int64_t i = 1; i <= count; i++) {
        uint64_t held = snow_context_bytes(files->context);
        volume = NULL;
        files->fail_at = files->allocations + i;
        assert_int_equal(open_records(files, &r, "", NULL, &volume),
                         SNOW_STATUS_NO_MEMORY);
        assert_null(volume);
        files->fail_at = 0;
        assert_true(snow_context_bytes(files->context) == held);
    }
}

static void no_store_is_lost_without_memory(void **state) {
    support_files *files = *state;
    DIR *stream = opendir(SNOW_CORPUS "/zarr");
    int stores = 0;
    assert_non_null(stream);
    for (const struct dirent *entry; (entry = readdir(stream));) {
        char path[1024];
        if (*entry->d_name == '.')
            continue;
        snprintf(path, sizeof path, SNOW_CORPUS "/zarr/%s", entry->d_name);
        check_file(files, path);
        stores++;
    }
    closedir(stream);
    assert_true(stores > 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(only_the_chunks_of_a_box_are_read),
        SUPPORT_TEST(chunks_that_are_missing_are_filled_and_told),
        SUPPORT_TEST(chunks_are_found_where_they_lie),
        SUPPORT_TEST(long_lists_of_missing_values_all_count),
        SUPPORT_TEST(memory_is_that_of_the_volume_and_a_chunk),
        SUPPORT_TEST(sizes_that_lie_take_no_memory),
        SUPPORT_TEST(paths_do_not_climb),
        SUPPORT_TEST(names_are_kept_on_one_line),
        cmocka_unit_test(the_check_sum_is_castagnolis),
        SUPPORT_TEST(no_store_is_lost_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
