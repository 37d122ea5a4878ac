/* tests/base/test_relay.c - readers that unpack a file in turn read what one
 * reads alone, and each byte of the file once. */
#include "support/files.h"

#include "io/relayed.h"

#include <zlib.h>

#define SIZE ((size_t)3000000)
#define HEADER 352

static unsigned char plain[SIZE], packed[SIZE + SIZE / 8];
static bool damaged; /* what is read may be wrong until that is found */

/* Noise in some places, and runs of any length in others. */
static void fill_plain(void) {
    uint64_t random = 7;
    for (size_t at = 0; at < SIZE;) {
        const uint64_t word = support_random(&random);
        const size_t run = word >> 58 ? 1 : 1 + word % 300;
        for (size_t n = 0; n < run && at < SIZE; n++)
            plain[at++] = (unsigned char)(word >> 40 & 63);
    }
}

/* Packs some bytes as gzip (31) or zlib (15). */
static size_t pack(int level, int form, size_t from, size_t to, size_t at) {
    z_stream stream = {0};
    assert_int_equal(
        deflateInit2(&stream, level, Z_DEFLATED, form, 9, Z_DEFAULT_STRATEGY),
        Z_OK);
    stream.next_in = plain + from;
    stream.avail_in = (uInt)(to - from);
    stream.next_out = packed + at;
    stream.avail_out = (uInt)(sizeof packed - at);
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    at = sizeof packed - stream.avail_out;
    deflateEnd(&stream);
    return at;
}

static snow_relay *begin_relay(void) {
    snow_relay *relay = calloc(1, sizeof *relay);
    assert_non_null(relay);
    return relay;
}

/* Reads the header, then the bytes from .. to - 1, and skips the rest, as
 * readers of formats do. */
static snow_status read_some(snow_source *source, size_t from, size_t to) {
    static unsigned char back[SIZE];
    snow_status status =
        snow_source_read_all(source, back, HEADER, "the header");
    snow_source_plan(source, 0);
    if (status == SNOW_STATUS_OK)
        status = snow_source_skip(source, from - HEADER, "the voxels");
    snow_source_plan(source, to - from);
    if (status == SNOW_STATUS_OK)
        status = snow_source_read_all(source, back, to - from, "the voxels");
    if (status == SNOW_STATUS_OK && !damaged)
        assert_memory_equal(back, plain + from, to - from);
    snow_source_plan(source, 0);
    if (status == SNOW_STATUS_OK)
        status = snow_source_skip(source, SIZE - to, "the voxels");
    snow_source_plan(source, UINT64_MAX);
    return status == SNOW_STATUS_OK ? snow_source_finish(source) : status;
}

/* One reader of several; the first bytes do not show zlib. */
static snow_status read_share(snow_context *context, const char *path,
                              snow_relay *relay, bool zlib, int reader,
                              int readers) {
    snow_source *source;
    snow_status status =
        snow_source_open_relayed(context, path, relay, &source);
    if (status != SNOW_STATUS_OK)
        return status;
    const size_t bytes = SIZE - HEADER, n = (size_t)readers;
    if (zlib)
        status = snow_source_unpack(source);
    if (status == SNOW_STATUS_OK)
        status = read_some(source, HEADER + bytes * (size_t)reader / n,
                           HEADER + bytes * ((size_t)reader + 1) / n);
    snow_source_close(source);
    return status;
}

/* All of them, until one fails; *read: what they have read of the file. */
static snow_status read_in_turn(support_files *files, const char *path,
                                bool zlib, int readers, uint64_t *read) {
    snow_status status = SNOW_STATUS_OK;
    snow_relay *relay = begin_relay();
    const uint64_t before = snow_context_bytes_read(files->context);
    for (int n = 0; n < readers && status == SNOW_STATUS_OK; n++) {
        relay->last = n == readers - 1;
        status = read_share(files->context, path, relay, zlib, n, readers);
    }
    *read = snow_context_bytes_read(files->context) - before;
    free(relay);
    return status;
}

/* A reader begins with the header, and some blocks of deflate too early. */
#define TWICE_BYTES 300000

/* What `size` packed bytes give to any number of readers. */
static void check_packed(size_t size, bool zlib) {
    support_files files;
    support_files_begin(&files);
    const char *path = support_write(&files, "packed", packed, size);
    static const int counts[] = {1, 2, 3, 7, 16};
    for (int n = 0; n < 5; n++) {
        uint64_t read;
        if (read_in_turn(&files, path, zlib, counts[n], &read) !=
            SNOW_STATUS_OK)
            fail_msg("%d: %s", counts[n], snow_context_message(files.context));
        assert_in_range(read, size,
                        size + (uint64_t)(counts[n] - 1) * TWICE_BYTES);
    }
    assert_int_equal(files.warnings, 0);
    support_files_end(&files);
}

static void any_number_of_readers_reads_what_one_does(void **state) {
    (void)state;
    for (int level = 0; level <= 9; level += 3) {
        check_packed(pack(level, 31, 0, SIZE, 0), false);
        check_packed(pack(level, 15, 0, SIZE, 0), true);
    }
}

/* As those of bgzip and of parallel packers. */
static void members_are_entered_too(void **state) {
    (void)state;
    static const size_t lengths[] = {40000, 200000, 1000000};
    for (int n = 0; n < 3; n++) {
        size_t size = 0;
        for (size_t at = 0; at < SIZE; at += lengths[n])
            size = pack(6, 31, at,
                        at + lengths[n] < SIZE ? at + lengths[n] : SIZE, size);
        check_packed(size, false);
    }
}

/* Of blocks whose ends take a few bits. */
static size_t pack_in_blocks(size_t block) {
    z_stream stream = {0};
    assert_int_equal(
        deflateInit2(&stream, 6, Z_DEFLATED, 31, 9, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_out = packed;
    stream.avail_out = (uInt)sizeof packed;
    for (size_t at = 0; at < SIZE; at += block) {
        stream.next_in = plain + at;
        stream.avail_in = (uInt)(SIZE - at < block ? SIZE - at : block);
        const bool last = at + block >= SIZE;
        assert_int_equal(deflate(&stream, last ? Z_FINISH : Z_BLOCK),
                         last ? Z_STREAM_END : Z_OK);
    }
    deflateEnd(&stream);
    return sizeof packed - stream.avail_out;
}

/* Reads up to some bytes before the point, then beyond it, and verifies. */
static snow_status read_over_point(snow_context *context, const char *path,
                                   snow_relay relay, size_t before) {
    const size_t first = (size_t)relay.from.unpacked - before;
    snow_source *source;
    relay.last = true;
    snow_status status =
        snow_source_open_relayed(context, path, &relay, &source);
    if (status != SNOW_STATUS_OK)
        return status;
    static unsigned char back[SIZE];
    snow_source_plan(source, first);
    status = snow_source_read_all(source, back, first, "the header");
    snow_source_plan(source, 0);
    if (status == SNOW_STATUS_OK)
        status = snow_source_skip(source, before + 9, "the voxels");
    snow_source_plan(source, UINT64_MAX);
    if (status == SNOW_STATUS_OK)
        status = snow_source_read_all(source, back, SIZE - first - before - 9,
                                      "the voxels");
    if (status == SNOW_STATUS_OK)
        status = snow_source_finish(source);
    snow_source_close(source);
    return status;
}

/* A reader that ends just before a point may have taken its first byte. */
static void a_point_that_was_passed_is_not_entered(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    memset(plain, 0, SIZE);
    const char *path =
        support_write(&files, "packed", packed, pack_in_blocks(200000));
    snow_relay *relay = begin_relay();
    assert_int_equal(read_share(files.context, path, relay, false, 0, 2),
                     SNOW_STATUS_OK);
    assert_true(relay->from.unpacked > 0 && relay->from.bits > 0);
    for (size_t before = 0; before < 20; before++)
        if (read_over_point(files.context, path, *relay, before) !=
            SNOW_STATUS_OK)
            fail_msg("%zu: %s", before, snow_context_message(files.context));
    free(relay);
    support_files_end(&files);
    fill_plain();
}

/* It depends on the packer what a wrong bit does. */
static bool is_damage(const char *message) {
    return strstr(message, "the compressed data are damaged") ||
           strstr(message, "the compressed data are truncated") ||
           (strstr(message, ": ends ") && strstr(message, " bytes too early"));
}

/* Whoever finds it: the sum goes along, so that it is that of all bytes. */
static void damage_is_found_by_some_reader(void **state) {
    (void)state;
    damaged = true;
    for (int zlib = 0; zlib < 2; zlib++) {
        const size_t size = pack(6, zlib ? 15 : 31, 0, SIZE, 0);
        for (size_t part = 1; part <= 10; part++) {
            support_files files;
            support_files_begin(&files);
            const size_t at = part == 10 ? size - 3 : size * part / 10;
            uint64_t read;
            packed[at] ^= 16;
            const char *path = support_write(&files, "packed", packed, size);
            packed[at] ^= 16;
            for (int readers = 1; readers < 5; readers++) {
                assert_int_equal(
                    read_in_turn(&files, path, zlib, readers, &read),
                    SNOW_STATUS_BAD_INPUT);
                assert_true(is_damage(snow_context_message(files.context)));
            }
            support_files_end(&files);
        }
    }
    damaged = false;
}

static void what_is_missing_is_found_by_the_last(void **state) {
    (void)state;
    const size_t size = pack(6, 31, 0, SIZE, 0);
    support_files files;
    support_files_begin(&files);
    uint64_t read;
    const char *path = support_write(&files, "cut", packed, size - 5);
    assert_int_equal(read_in_turn(&files, path, false, 3, &read),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(
        strstr(snow_context_message(files.context), "are truncated"));
    path = support_write(&files, "short", packed, pack(6, 31, 0, SIZE - 9, 0));
    assert_int_equal(read_in_turn(&files, path, false, 3, &read),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(files.context),
                           "ends 9 bytes too early in the voxels"));
    support_files_end(&files);
}

int main(void) {
    fill_plain();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_readers_reads_what_one_does),
        cmocka_unit_test(members_are_entered_too),
        cmocka_unit_test(a_point_that_was_passed_is_not_entered),
        cmocka_unit_test(damage_is_found_by_some_reader),
        cmocka_unit_test(what_is_missing_is_found_by_the_last),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
