/* tests/formats/test_dicom_segments.c - segmentations: bits that frames do not
 * share with bytes, and files that are cut or find no memory.  oracle_seg.py
 * compares whole ones with NumPy. */
#include "support/failing.h"
#include "support/files.h"

#include "volume/volume.h"

typedef struct bytes {
    unsigned char at[2048];
    size_t size;
} bytes;

/* An element, implicit and little endian; its value follows. */
static void head(bytes *to, uint32_t tag, size_t size) {
    const uint32_t words[2] = {tag >> 16 | tag << 16, (uint32_t)size};
    for (size_t i = 0; i < 8; i++)
        to->at[to->size++] = (unsigned char)(words[i / 4] >> 8 * (i % 4));
}

static void put(bytes *to, uint32_t tag, const void *value, size_t size) {
    head(to, tag, size);
    memcpy(to->at + to->size, value, size);
    to->size += size;
}

static void text(bytes *to, uint32_t tag, const char *value) {
    char even[64];
    snprintf(even, sizeof even, "%s%s", value, strlen(value) % 2 ? " " : "");
    put(to, tag, even, strlen(even));
}

static void number(bytes *to, uint32_t tag, unsigned value) {
    const unsigned char pair[2] = {(unsigned char)value,
                                   (unsigned char)(value >> 8)};
    put(to, tag, pair, 2);
}

/* A sequence of one item. */
static void sequence(bytes *to, uint32_t tag, const bytes *item) {
    head(to, tag, item->size + 8);
    put(to, 0xfffee000, item->at, item->size);
}

/* Five bits of a frame, 2 frames of segment 1 and one of 2. */
static void write_segments(bytes *file) {
    static const unsigned char bits[2] = {0x31, 0x5e}; /* 10001 10001 11101 */
    static const char *const places[] = {"0\\0\\0", "0\\0\\1", "0\\0\\1"};
    bytes measures = {0}, plane = {0}, shared = {0}, frames = {0};
    memset(file, 0, sizeof *file);
    file->size = 128;
    memcpy(file->at + file->size, "DICM", 4);
    file->size += 4;
    text(file, 0x00080016, "1.2.840.10008.5.1.4.1.1.66.4");
    text(file, 0x00080060, "SEG");
    number(file, 0x00280002, 1);
    text(file, 0x00280004, "MONOCHROME2");
    text(file, 0x00280008, "3");
    number(file, 0x00280010, 1);
    number(file, 0x00280011, 5);
    number(file, 0x00280100, 1);
    number(file, 0x00280101, 1);
    number(file, 0x00280102, 0);
    number(file, 0x00280103, 0);
    text(file, 0x00620001, "BINARY");
    bytes segment = {0};
    number(&segment, 0x00620004, 2);
    text(&segment, 0x00620005, "Spleen");
    sequence(file, 0x00620002, &segment);
    text(&measures, 0x00280030, "1\\1");
    sequence(&shared, 0x00289110, &measures);
    text(&plane, 0x00200037, "1\\0\\0\\0\\1\\0");
    sequence(&shared, 0x00209116, &plane);
    sequence(file, 0x52009229, &shared);
    for (unsigned i = 0; i < 3; i++) {
        bytes place = {0}, which = {0}, groups = {0};
        text(&place, 0x00200032, places[i]);
        sequence(&groups, 0x00209113, &place);
        number(&which, 0x0062000b, i < 2 ? 1 : 2);
        sequence(&groups, 0x0062000a, &which);
        put(&frames, 0xfffee000, groups.at, groups.size);
    }
    put(file, 0x52009230, frames.at, frames.size);
    put(file, 0x7fe00010, bits, sizeof bits);
}

static void frames_of_bits_are_not_padded_to_bytes(void **state) {
    support_files *files = *state;
    static const unsigned char wanted[10] = {1, 0, 0, 0, 1, 2, 2, 2, 0, 2};
    bytes file;
    write_segments(&file);
    const char *path = support_write(files, "a.dcm", file.at, file.size);
    snow_volume *volume = support_opened(files, path, NULL);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 2);
    assert_memory_equal(snow_volume_voxels(volume), wanted, sizeof wanted);
    assert_true(volume->labelled && volume->label_count == 1);
    assert_true(volume->labels->value == 2 && volume->labels->color[0] < 0);
    assert_string_equal(volume->labels->name, "Spleen");
    assert_int_equal(support_warned(files), 1);
    assert_non_null(strstr(files->warnings, "overlap"));
    snow_volume_close(volume);
}

static void a_segmentation_cut_anywhere_is_refused(void **state) {
    support_files *files = *state;
    bytes file;
    write_segments(&file);
    for (size_t size = 132; size < file.size; size++) {
        const char *path = support_write(files, "a.dcm", file.at, size);
        support_bad_file(files, path, "");
        assert_int_equal(remove(path), 0);
    }
}

static snow_status open_without(const char *path, support_failing *allocator) {
    snow_allocator functions = support_failing_allocator(allocator);
    snow_context *context;
    snow_volume *volume = NULL;
    if (snow_context_new(&functions, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = snow_volume_open(context, path, NULL, &volume);
    snow_volume_close(volume);
    snow_context_free(context);
    assert_int_equal(allocator->held, 0);
    return status;
}

static void it_fails_cleanly_at_every_allocation(void **state) {
    support_files *files = *state;
    bytes file;
    write_segments(&file);
    const char *path = support_write(files, "a.dcm", file.at, file.size);
    support_failing whole = {.failing = -1};
    assert_int_equal(open_without(path, &whole), SNOW_STATUS_OK);
    assert_true(whole.allocations > 10);
    for (long n = 0; n < whole.allocations; n++) {
        support_failing one = {.failing = n};
        assert_int_equal(open_without(path, &one), SNOW_STATUS_NO_MEMORY);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(frames_of_bits_are_not_padded_to_bytes),
        SUPPORT_TEST(a_segmentation_cut_anywhere_is_refused),
        SUPPORT_TEST(it_fails_cleanly_at_every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
