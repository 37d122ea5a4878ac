/* tests/formats/test_dicom_segments.c - segmentations: where their slices lie
 * that are not empty, bits that frames do not share with bytes, and files that
 * are cut or find no memory.  oracle_seg.py compares whole ones with NumPy. */
#include "formats/dicom/dicom.h"
#include "support/failing.h"
#include "support/files.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The most memory that a refusal may ask for at once. */
#define MOST ((size_t)200 * 1024)

/* --- frames --------------------------------------------------------------- */

static const dicom_image binary = {.path = "a/segments",
                                   .columns = 4,
                                   .rows = 4,
                                   .samples = 1,
                                   .allocated = 1,
                                   .stored = 1,
                                   .segments = DICOM_BINARY};

/* Frames at these heights, the lower ones of segment 1; mm between slices, 0
 * if they are not given. */
static dicom_stack stacked(snow_context *context, dicom_frame *frames,
                           const double *heights, size_t count, double depth) {
    dicom_stack stack;
    for (size_t i = 0; i < count; i++)
        frames[i] = (dicom_frame){
            .image = &binary,
            .number = (int64_t)i,
            .placed = true,
            .measured = true,
            .position = {0, 0, heights[i]},
            .row = {1, 0, 0},
            .column = {0, 1, 0},
            .pixel = {1, 1},
            .depth = depth,
            .keys = {[DICOM_KEY_SEGMENT] = i < count / 2 ? 1 : 2}};
    assert_int_equal(snow_dicom_stack(context, frames, count, false, &stack),
                     SNOW_STATUS_OK);
    return stack;
}

/* Slices, of which '-' is empty and others are places counted from 0. */
static void expect_slices(const dicom_stack *stack, const char *wanted) {
    assert_int_equal(stack->slice_count, strlen(wanted));
    for (size_t z = 0; z < stack->slice_count; z++) {
        dicom_slice slice = {z, z, 0};
        if (stack->slices)
            slice = stack->slices[z];
        size_t nearest = slice.weight > 0.5 ? slice.high : slice.low;
        if (wanted[z] == '-')
            assert_true(isnan(slice.weight));
        else
            assert_true(!isnan(slice.weight) &&
                        (int)nearest == wanted[z] - '0');
    }
}

static void slices_between_segments_are_empty(void **state) {
    (void)state;
    static const struct {
        double heights[6], depth;
        const char *slices;
        double gap;
    } rows[] = {
        {{0, 1, 2, 1, 2, 3}, 0, "0123", 1},
        {{0, 2, 4, 2, 4, 6}, 2, "0123", 2},
        {{0, 2, 4, 2, 4, 6}, 1, "0-1-2-3", 1}, /* the file says so */
        {{0, 2, 4, 2, 4, 6}, 1.7, "0123", 2},  /* that cannot be */
        {{0, 1, 2, 5, 6, 9}, 0, "012--34--5", 1},
        {{0, 3, 5, 0, 3, 5}, 1, "0--1-2", 1},
        {{0, 0, 0, 7, 7, 7}, 1, "0------1", 1},
        {{0, 0, 0, 7, 7, 7}, 0, "01", 7},
        {{0, 1, 2.5, 3.5, 4.5, 5.5}, 0, "0122345", 5.5 / 6}, /* the nearest */
        {{0, 1, 2.5, 3.5, 10.5, 11.5}, 0, "01223-----445", 11.5 / 12},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        snow_context *context = support_context();
        dicom_frame frames[6];
        dicom_stack stack =
            stacked(context, frames, rows[n].heights, 6, rows[n].depth);
        expect_slices(&stack, rows[n].slices);
        assert_true(fabs(stack.matrix[2][2] - rows[n].gap) < 1e-12);
        assert_int_equal(stack.starts[0], 0);
        assert_int_equal(stack.starts[stack.places], 6);
        snow_dicom_stack_free(&stack);
        assert_int_equal(snow_context_bytes(context), 0);
        snow_context_free(context);
    }
}

static void segments_of_a_place_have_the_order_of_their_numbers(void **state) {
    (void)state;
    snow_context *context = support_context();
    dicom_frame frames[6];
    const double heights[] = {2, 1, 0, 0, 1, 2};
    dicom_stack stack = stacked(context, frames, heights, 6, 1);
    assert_int_equal(stack.places, 3);
    for (size_t p = 0; p < 3; p++) {
        assert_int_equal(stack.starts[p], 2 * p);
        for (size_t i = 0; i < 2; i++) {
            const dicom_frame *frame = &stack.frames[2 * p + i];
            assert_true(frame->position[2] == (double)p);
            assert_true(frame->keys[DICOM_KEY_SEGMENT] == (double)i + 1);
        }
    }
    snow_dicom_stack_free(&stack);
    snow_context_free(context);
}

/* --- a file --------------------------------------------------------------- */

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
    (void)state;
    static const unsigned char wanted[10] = {1, 0, 0, 0, 1, 2, 2, 2, 0, 2};
    support_files files;
    bytes file;
    support_files_begin(&files);
    write_segments(&file);
    const char *path = support_write(&files, "a.dcm", file.at, file.size);
    snow_volume *volume = support_opened(&files, path, NULL);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 2);
    assert_memory_equal(snow_volume_voxels(volume), wanted, sizeof wanted);
    assert_true(volume->labelled && volume->label_count == 1);
    assert_true(volume->labels->value == 2 && volume->labels->color[0] < 0);
    assert_string_equal(volume->labels->name, "Spleen");
    assert_int_equal(files.warnings, 1);
    assert_non_null(strstr(files.warning, "overlap"));
    snow_volume_close(volume);
    support_files_end(&files);
}

static void a_segmentation_cut_anywhere_is_refused(void **state) {
    (void)state;
    support_files files;
    bytes file;
    support_files_begin(&files);
    write_segments(&file);
    for (size_t size = 132; size < file.size; size++) {
        const char *path = support_write(&files, "a.dcm", file.at, size);
        support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "", MOST);
        assert_int_equal(remove(path), 0);
    }
    support_files_end(&files);
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
    (void)state;
    support_files files;
    bytes file;
    support_files_begin(&files);
    write_segments(&file);
    const char *path = support_write(&files, "a.dcm", file.at, file.size);
    support_failing whole = {.failing = -1};
    assert_int_equal(open_without(path, &whole), SNOW_STATUS_OK);
    assert_true(whole.allocations > 10);
    for (long n = 0; n < whole.allocations; n++) {
        support_failing one = {.failing = n};
        assert_int_equal(open_without(path, &one), SNOW_STATUS_NO_MEMORY);
    }
    support_files_end(&files);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slices_between_segments_are_empty),
        cmocka_unit_test(segments_of_a_place_have_the_order_of_their_numbers),
        cmocka_unit_test(frames_of_bits_are_not_padded_to_bytes),
        cmocka_unit_test(a_segmentation_cut_anywhere_is_refused),
        cmocka_unit_test(it_fails_cleanly_at_every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
