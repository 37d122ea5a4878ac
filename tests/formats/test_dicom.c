/* tests/formats/test_dicom.c - DICOM: which frames make a volume and where it
 * lies, what damaged files say, and what they may cost.  Values and places of
 * whole series are compared with pydicom in oracle_dicom.py. */
#include "formats/dicom/dicom.h"
#include "support/files.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

/* The most memory that a refusal may ask for at once. */
#define MOST ((size_t)200 * 1024)

/* --- frames --------------------------------------------------------------- */

static dicom_image plain_image = {.path = "a/slice",
                                  .series = "1.2",
                                  .columns = 4,
                                  .rows = 4,
                                  .samples = 1,
                                  .allocated = 16,
                                  .stored = 16,
                                  .high = 15,
                                  .photometric = "MONOCHROME2"};

static dicom_frame frame_at(double x, double y, double z) {
    return (dicom_frame){.image = &plain_image,
                         .placed = true,
                         .position = {x, y, z},
                         .row = {1, 0, 0},
                         .column = {0, 1, 0},
                         .pixel = {1, 1},
                         .measured = true,
                         .slope = 1};
}

/* Frames one behind the other at these heights. */
static void stack_up(dicom_frame *frames, const double *heights, size_t count) {
    for (size_t i = 0; i < count; i++) {
        frames[i] = frame_at(0, 0, heights[i]);
        frames[i].number = (int64_t)i;
    }
}

static dicom_stack stacked(snow_context *context, dicom_frame *frames,
                           size_t count) {
    dicom_stack stack;
    assert_int_equal(snow_dicom_stack(context, frames, count, false, &stack),
                     SNOW_STATUS_OK);
    return stack;
}

static void refuse_stack(dicom_frame *frames, size_t count, const char *part) {
    snow_context *context = support_context();
    dicom_stack stack;
    assert_int_equal(snow_dicom_stack(context, frames, count, false, &stack),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(context), part));
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void slices_are_ordered_along_their_normal(void **state) {
    (void)state;
    snow_context *context = support_context();
    dicom_frame frames[4];
    const double heights[] = {6, 0, 4, 2};
    stack_up(frames, heights, 4);
    dicom_stack stack = stacked(context, frames, 4);
    for (int i = 0; i < 4; i++)
        assert_true(stack.frames[i].position[2] == 2 * i);
    assert_true(stack.matrix[2][2] == 2 && stack.matrix[0][0] == -1);
    snow_dicom_stack_free(&stack);
    /* rows to the patient's right: the normal is down */
    stack_up(frames, heights, 4);
    for (int i = 0; i < 4; i++)
        frames[i].row[0] = -1;
    stack = stacked(context, frames, 4);
    assert_true(stack.frames[0].position[2] == 6);
    assert_true(stack.matrix[2][2] == -2 && stack.matrix[2][3] == 6);
    snow_dicom_stack_free(&stack);
    snow_context_free(context);
}

static void
frames_without_a_position_have_their_first_row_on_top(void **state) {
    (void)state;
    snow_context *context = support_context();
    dicom_frame frames[3];
    for (int i = 0; i < 3; i++) {
        frames[i] = frame_at(0, 0, 0);
        frames[i].placed = false;
        frames[i].number = i;
        frames[i].depth = 2;
    }
    dicom_stack stack = stacked(context, frames, 3);
    const double turned[3] = {1, -1, -2};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            assert_true(stack.matrix[i][k] == (i == k ? turned[i] : 0));
    assert_true(stack.frames[0].number == 0);
    snow_dicom_stack_free(&stack);
    snow_context_free(context);
}

static void a_tilt_is_a_shear_in_the_matrix(void **state) {
    (void)state;
    snow_context *context = support_context();
    dicom_frame frames[5];
    for (int i = 0; i < 5; i++) {
        frames[i] = frame_at(1, 2, 3 * i);
        frames[i].column[1] = 0.8;
        frames[i].column[2] = 0.6;
    }
    dicom_stack stack = stacked(context, frames, 5);
    assert_true(stack.matrix[0][2] == 0 && stack.matrix[1][2] == 0);
    assert_true(stack.matrix[2][2] == 3 && stack.matrix[2][1] == 0.6);
    assert_null(stack.slices);
    snow_dicom_stack_free(&stack);
    snow_context_free(context);
}

static void a_missing_slice_is_named(void **state) {
    (void)state;
    dicom_frame frames[6];
    const double one[] = {0, 1, 2, 4, 5, 6}, two[] = {0, 1, 2, 3, 6, 7};
    stack_up(frames, one, 6);
    refuse_stack(frames, 6,
                 "1 of its slices is missing between slice and "
                 "slice (frames 2 and 3)");
    stack_up(frames, two, 6);
    refuse_stack(frames, 6, "2 of its slices are missing");
}

static void a_missing_slice_is_a_gap_where_it_may_be(void **state) {
    (void)state;
    snow_context *context = support_context();
    dicom_frame frames[6];
    dicom_stack stack;
    const double heights[] = {0, 1, 2, 5, 6, 7};
    stack_up(frames, heights, 6);
    assert_int_equal(snow_dicom_stack(context, frames, 6, true, &stack),
                     SNOW_STATUS_OK);
    assert_int_equal(stack.slice_count, 8);
    assert_int_equal(stack.missing, 2);
    assert_true(stack.matrix[2][2] == 1 && stack.gap == 1);
    for (size_t z = 0, place = 0; z < 8; z++) {
        const dicom_slice *slice = &stack.slices[z];
        if (z == 3 || z == 4)
            assert_true(isnan(slice->weight) && slice->low == 2 &&
                        slice->high == 3);
        else
            assert_true(slice->weight == 0 && slice->low == place++);
    }
    snow_dicom_stack_free(&stack);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void uneven_slices_are_made_even(void **state) {
    (void)state;
    snow_context *context = support_context();
    dicom_frame frames[5];
    const double heights[] = {0, 1, 2, 4, 6};
    stack_up(frames, heights, 5);
    dicom_stack stack = stacked(context, frames, 5);
    assert_int_equal(stack.slice_count, 7);
    assert_true(stack.matrix[2][2] == 1 && stack.gap == 1);
    const dicom_slice *s = stack.slices;
    assert_true(s[3].low == 2 && s[3].high == 3 && s[3].weight == 0.5);
    assert_true(s[6].high == 4 && s[6].weight == 1);
    assert_true(s[1].weight == 0 && s[1].low == 1);
    snow_dicom_stack_free(&stack);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void slices_beside_one_another_are_refused(void **state) {
    (void)state;
    dicom_frame frames[4];
    const double heights[] = {0, 1, 2, 3}, same[] = {0, 1, 1, 2};
    stack_up(frames, heights, 4);
    frames[2].position[0] = 3;
    refuse_stack(frames, 4, "are not aligned");
    stack_up(frames, same, 4);
    frames[2].position[0] = 3;
    refuse_stack(frames, 4, "beside one another in a plane");
    stack_up(frames, same, 4);
    refuse_stack(frames, 4, "has 2 images at the position of slice");
}

static void several_at_each_place_are_times(void **state) {
    (void)state;
    snow_context *context = support_context();
    dicom_frame frames[6];
    const double heights[] = {0, 1, 2, 0, 1, 2};
    stack_up(frames, heights, 6);
    for (int i = 0; i < 6; i++)
        frames[i].keys[DICOM_KEY_ECHO] = i < 3 ? 20 : 10;
    dicom_stack stack = stacked(context, frames, 6);
    assert_true(stack.times == 2 && stack.places == 3);
    for (int i = 0; i < 6; i++) {
        assert_true(stack.frames[i].position[2] == i / 2);
        assert_true(stack.frames[i].keys[DICOM_KEY_ECHO] == 10 + 10 * (i % 2));
    }
    snow_dicom_stack_free(&stack);
    snow_context_free(context);
}

static void frames_that_are_not_alike_are_groups(void **state) {
    (void)state;
    dicom_frame frames[6];
    dicom_group groups[6];
    dicom_image first = plain_image;
    first.series_number = -1;
    const double heights[] = {0, 1, 2, 3, 4, 5};
    stack_up(frames, heights, 6);
    frames[1].column[1] = 0;
    frames[1].column[2] = 1;
    frames[4].image = &first;
    frames[5].row[0] = 1 - 1e-6; /* as printed */
    assert_int_equal(snow_dicom_group(frames, 6, groups), 3);
    assert_true(groups[0].count == 1 && frames[0].image == &first);
    assert_true(groups[1].count == 4 && groups[2].count == 1);
    assert_true(frames[groups[2].first].column[2] == 1);
}

/* --- files ---------------------------------------------------------------- */

typedef struct file {
    unsigned char bytes[4096];
    size_t size;
} file;

static void put(file *f, const void *bytes, size_t size) {
    if (size)
        memcpy(f->bytes + f->size, bytes, size);
    f->size += size;
}

static void put_number(file *f, uint32_t value, int bytes) {
    for (int i = 0; i < bytes; i++)
        f->bytes[f->size++] = (unsigned char)(value >> 8 * i);
}

/* An element, explicit and little endian. */
static void element(file *f, uint32_t tag, const char *vr, const void *value,
                    size_t size) {
    put_number(f, tag >> 16, 2);
    put_number(f, tag & 0xffff, 2);
    put(f, vr, 2);
    bool is_long = strstr("OB OW SQ UN", vr) != NULL;
    put_number(f, 0, is_long ? 2 : 0);
    put_number(f, (uint32_t)size, is_long ? 4 : 2);
    put(f, value, value ? size : 0);
}

static void text(file *f, uint32_t tag, const char *vr, const char *value) {
    char padded[128];
    snprintf(padded, sizeof padded, "%s%s", value,
             strlen(value) % 2 ? " " : "");
    element(f, tag, vr, padded, strlen(padded));
}

static void number(file *f, uint32_t tag, unsigned value) {
    const unsigned char bytes[2] = {(unsigned char)value,
                                    (unsigned char)(value >> 8)};
    element(f, tag, "US", bytes, 2);
}

/* All before the pixels of a slice of 4 x 2 words at a height. */
static void begin(file *f, const char *syntax, double height) {
    char place[64], instance[32];
    memset(f, 0, sizeof *f);
    f->size = 128;
    put(f, "DICM", 4);
    text(f, 0x00020010, "UI", syntax);
    snprintf(instance, sizeof instance, "1.9.%d", (int)height + 100);
    text(f, 0x00080018, "UI", instance);
    text(f, 0x00100010, "PN", "Hidden^Name");
    text(f, 0x0020000e, "UI", "1.2.3");
    snprintf(place, sizeof place, "0\\0\\%g", height);
    text(f, 0x00200032, "DS", place);
    text(f, 0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    number(f, 0x00280002, 1);
    text(f, 0x00280004, "CS", "MONOCHROME2");
    number(f, 0x00280010, 2);
    number(f, 0x00280011, 4);
    text(f, 0x00280030, "DS", "1\\1");
    number(f, 0x00280100, 16);
    number(f, 0x00280101, 16);
    number(f, 0x00280102, 15);
    number(f, 0x00280103, 0);
}

static const char explicit_little[] = "1.2.840.10008.1.2.1";

static void slice(file *f, double height, unsigned first) {
    unsigned char words[16];
    begin(f, explicit_little, height);
    for (unsigned i = 0; i < 8; i++) {
        words[2 * i] = (unsigned char)(first + i);
        words[2 * i + 1] = 0;
    }
    element(f, 0x7fe00010, "OW", words, sizeof words);
}

static void a_folder_is_a_volume_whatever_its_names(void **state) {
    (void)state;
    static const char *const names[] = {"x", "b.dcm", "9", "a"};
    support_files files;
    support_files_begin(&files);
    for (unsigned z = 0; z < 4; z++) {
        file f;
        slice(&f, 2 * z, 10 * z);
        support_write(&files, names[z], f.bytes, f.size);
    }
    support_write_text(&files, "notes.txt", "no slice");
    snow_volume *volume = support_opened(&files, files.folder, NULL);
    const snow_volume_info *info = snow_volume_get_info(volume);
    const uint16_t *voxels = snow_volume_voxels(volume);
    assert_true(info->dims[0] == 4 && info->dims[1] == 2 && info->dims[2] == 4);
    assert_true(info->type == SNOW_TYPE_UINT16 && info->spacing[2] == 2);
    for (int z = 0; z < 4; z++)
        assert_int_equal(voxels[8 * z + 7], 10 * z + 7);
    assert_string_equal(snow_volume_patient(volume), "Hidden^Name");
    assert_int_equal(files.warnings, 0);
    snow_volume_close(volume);
    /* a slice stands for all, and says so */
    volume = support_opened(&files, support_path(&files, "9"), NULL);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 4);
    assert_non_null(strstr(files.warning, "one of 4 slices"));
    snow_volume_close(volume);
    support_files_end(&files);
}

static void a_file_says_how_to_show_it(void **state) {
    (void)state;
    static const struct {
        const char *photometric, *level, *width;
        double low, high;
    } rows[] = {
        {"MONOCHROME2", "40\\-600", "400\\1500", -160, 240},
        {"MONOCHROME2", "40", "0", 0, 0},
        {"MONOCHROME2", "40", "many", 0, 0},
        {"MONOCHROME1", "100", "50", 65535 - 125, 65535 - 75},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        unsigned char words[16] = {0};
        support_files files;
        file f;
        support_files_begin(&files);
        begin(&f, explicit_little, 0);
        text(&f, 0x00080060, "CS", "CT");
        text(&f, 0x0008103e, "LO", "Thorax  1mm");
        text(&f, 0x00281050, "DS", rows[n].level);
        text(&f, 0x00281051, "DS", rows[n].width);
        unsigned char *tag = f.bytes;
        while (memcmp(tag, "\x28\0\x04\0CS", 6) != 0)
            tag++;
        tag[8 + 10] = (unsigned char)rows[n].photometric[10];
        element(&f, 0x7fe00010, "OW", words, sizeof words);
        support_write(&files, "s.dcm", f.bytes, f.size);
        snow_volume *volume =
            support_opened(&files, support_path(&files, "s.dcm"), NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_string_equal(info->modality, "CT");
        assert_string_equal(info->description, "Thorax  1mm");
        assert_true(info->window[0] == rows[n].low);
        assert_true(info->window[1] == rows[n].high);
        snow_volume_close(volume);
        support_files_end(&files);
    }
}

static void a_slice_tells_that_those_beside_it_are_damaged(void **state) {
    (void)state;
    static const char *const names[] = {"0", "1", "2", "3"};
    support_files files;
    support_files_begin(&files);
    for (unsigned z = 0; z < 4; z++) {
        file f;
        slice(&f, z, 0);
        support_write(&files, names[z], f.bytes, f.size - (z == 3));
    }
    snow_volume *volume =
        support_opened(&files, support_path(&files, "1"), NULL);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 3);
    assert_int_equal(files.warnings, 2);
    snow_volume_close(volume);
    support_files_end(&files);
}

/* The unit of values: of a CT with a rescale, unless another one is named. */
static void hounsfield_units_are_those_of_a_ct(void **state) {
    static const struct {
        const char *modality, *intercept, *type;
        bool hounsfield;
    } table[] = {{"CT", "-1024", NULL, true}, {"CT", "-1024", "HU", true},
                 {"CT", "0", "HU", true},     {"CT", "-1024", "US", false},
                 {"CT", NULL, NULL, false},   {"MR", "-1024", NULL, false},
                 {NULL, "-1024", NULL, false}};
    (void)state;
    for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
        support_files files;
        support_files_begin(&files);
        file f;
        const unsigned char words[16] = {1};
        begin(&f, explicit_little, 0);
        if (table[n].intercept) {
            text(&f, 0x00281052, "DS", table[n].intercept);
            text(&f, 0x00281053, "DS", "1");
        }
        if (table[n].type)
            text(&f, 0x00281054, "LO", table[n].type);
        if (table[n].modality)
            text(&f, 0x00080060, "CS", table[n].modality);
        element(&f, 0x7fe00010, "OW", words, sizeof words);
        const char *path = support_write(&files, "a.dcm", f.bytes, f.size);
        snow_volume *volume = support_opened(&files, path, NULL);
        assert_true(snow_volume_get_info(volume)->hounsfield ==
                    table[n].hounsfield);
        snow_volume_close(volume);
        support_files_end(&files);
    }
}

/* Without numbers of their own files are not copies, but the given one is. */
static void a_slice_without_a_number_is_there_once(void **state) {
    (void)state;
    static const char *const names[] = {"0", "1", "2"};
    support_files files;
    support_files_begin(&files);
    for (unsigned z = 0; z < 3; z++) {
        file f;
        slice(&f, z, 10 * z);
        unsigned char *tag = f.bytes;
        while (memcmp(tag, "\x08\0\x18\0UI", 6) != 0)
            tag++;
        tag[2] = 0x19; /* no one looks for this element */
        support_write(&files, names[z], f.bytes, f.size);
    }
    snow_volume *volume =
        support_opened(&files, support_path(&files, "1"), NULL);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 3);
    assert_int_equal(files.warnings, 1);
    assert_non_null(strstr(files.warning, "one of 3 slices"));
    snow_volume_close(volume);
    support_files_end(&files);
}

static void a_file_says_nothing_of_the_patient(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    file f;
    slice(&f, 0, 0);
    const char *path = support_write(&files, "a.dcm", f.bytes, f.size - 1);
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "is truncated",
                    MOST);
    assert_null(strstr(snow_context_message(files.context), "Hidden"));
    support_files_end(&files);
}

static void a_file_cut_anywhere_is_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    file f;
    slice(&f, 0, 0);
    for (size_t size = 132; size < f.size; size++) {
        const char *path = support_write(&files, "a.dcm", f.bytes, size);
        support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "", MOST);
        assert_int_equal(remove(path), 0);
    }
    support_files_end(&files);
}

static const char run_lengths[] = "1.2.840.10008.1.2.5";
static const char jpeg_lossless[] = "1.2.840.10008.1.2.4.70";

/* Packed pixels of one fragment behind an empty table. */
static void fragment(file *f, const void *bytes, size_t size) {
    element(f, 0x7fe00010, "OB", NULL, 0xffffffff);
    put_number(f, 0xe000fffe, 4);
    put_number(f, 0, 4);
    put_number(f, 0xe000fffe, 4);
    put_number(f, (uint32_t)size, 4);
    put(f, bytes, size);
    put_number(f, 0xe0ddfffe, 4);
    put_number(f, 0, 4);
}

/* Frames enough to fill the memory, of a file without them: plain,
 * packed, and pixels whose bits are more than an int can count. */
static void frames_that_lie(support_files *files) {
    file f;
    begin(&f, explicit_little, 0);
    text(&f, 0x00280008, "IS", "100000000");
    element(&f, 0x7fe00010, "OW", "ab", 2);
    const char *path = support_write(files, "many.dcm", f.bytes, f.size);
    support_refused(files, path, NULL, SNOW_STATUS_BAD_INPUT, "cannot hold",
                    MOST);
    begin(&f, run_lengths, 0);
    text(&f, 0x00280008, "IS", "99999");
    fragment(&f, "ab", 2);
    path = support_write(files, "packed.dcm", f.bytes, f.size);
    support_refused(files, path, NULL, SNOW_STATUS_BAD_INPUT, "cannot hold",
                    MOST);
    memset(&f, 0, sizeof f);
    f.size = 128;
    put(&f, "DICM", 4);
    text(&f, 0x00020010, "UI", explicit_little);
    number(&f, 0x00280002, 65535);
    number(&f, 0x00280010, 1);
    number(&f, 0x00280011, 1);
    number(&f, 0x00280100, 65535);
    element(&f, 0x7fe00010, "OW", "ab", 2);
    path = support_write(files, "bits.dcm", f.bytes, f.size);
    support_refused(files, path, NULL, SNOW_STATUS_BAD_INPUT, "cannot hold",
                    MOST);
    /* a frame too many by one */
    begin(&f, explicit_little, 0);
    text(&f, 0x00280008, "IS", "2");
    element(&f, 0x7fe00010, "OW", f.bytes, 31);
    path = support_write(files, "short.dcm", f.bytes, f.size);
    support_refused(files, path, NULL, SNOW_STATUS_BAD_INPUT, "cannot hold",
                    MOST);
}

static void lengths_that_lie_cost_no_memory(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    file f;
    begin(&f, explicit_little, 0);
    element(&f, 0x7fe00010, "OW", NULL, 0xfffffff0);
    put_number(&f, 0, 4);
    const char *path = support_write(&files, "a.dcm", f.bytes, f.size);
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT,
                    "claims 4294967280 bytes, of which 4 exist", MOST);
    begin(&f, explicit_little, 0);
    text(&f, 0x00280008, "IS", "999999999");
    element(&f, 0x7fe00010, "OW", "", 0);
    path = support_write(&files, "b.dcm", f.bytes, f.size);
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "cannot hold",
                    MOST);
    frames_that_lie(&files);
    begin(&f, explicit_little, 0);
    for (int i = 0; i < 60; i++) {
        element(&f, 0x00400000, "SQ", NULL, 0xffffffff);
        put_number(&f, 0xe000fffe, 4);
        put_number(&f, 0xffffffff, 4);
    }
    path = support_write(&files, "c.dcm", f.bytes, f.size);
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT,
                    "nests sequences", MOST);
    support_files_end(&files);
}

/* Segments of the high bytes, all 1, and of the low ones, 0 to 7. */
static size_t runs(unsigned char *out) {
    static const unsigned char segments[] = {0xf9, 1, 7, 0, 1, 2,
                                             3,    4, 5, 6, 7, 0x80};
    memset(out, 0, 64);
    out[0] = 2;
    out[4] = 64;
    out[8] = 66;
    memcpy(out + 64, segments, sizeof segments);
    return 64 + sizeof segments;
}

static void run_lengths_are_unpacked(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    unsigned char packed[128];
    size_t size = runs(packed);
    file f;
    begin(&f, run_lengths, 0);
    fragment(&f, packed, size);
    const char *path = support_write(&files, "a.dcm", f.bytes, f.size);
    snow_volume *volume = support_opened(&files, path, NULL);
    const uint16_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 8; i++)
        assert_int_equal(voxels[i], 256 + i);
    snow_volume_close(volume);
    for (size_t short_by = 2; short_by <= size; short_by += 3) {
        begin(&f, run_lengths, 0);
        fragment(&f, packed, size - short_by);
        path = support_write(&files, "b.dcm", f.bytes, f.size);
        support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT,
                        "be decompressed", MOST);
        assert_int_equal(remove(path), 0);
    }
    packed[8] = 255; /* a segment that begins behind the others */
    begin(&f, run_lengths, 0);
    fragment(&f, packed, size);
    path = support_write(&files, "c.dcm", f.bytes, f.size);
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT,
                    "be decompressed", MOST);
    support_files_end(&files);
}

/* Without GDCM that is said first, whatever the pixels are. */
static void packed_pixels_must_be_what_the_header_says(void **state) {
    (void)state;
    static const unsigned char head[] = {
        0xff, 0xd8, 0xff, 0xc3, 0, 11, 16, 0, 99, 0, 4, 1, 1, 0x11, 0, 0};
    support_files files;
    support_files_begin(&files);
    file f;
    begin(&f, jpeg_lossless, 0);
    fragment(&f, head, sizeof head);
    const char *path = support_write(&files, "a.dcm", f.bytes, f.size);
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT,
                    SNOW_HAVE_GDCM
                        ? "are 4x99 of 1 values with 16 bits but its header "
                          "says 4x2"
                        : "this build cannot read compressed DICOM images",
                    MOST);
    begin(&f, jpeg_lossless, 0);
    fragment(&f, "no picture", 10);
    path = support_write(&files, "b.dcm", f.bytes, f.size);
    support_refused(
        &files, path, NULL, SNOW_STATUS_BAD_INPUT,
        SNOW_HAVE_GDCM ? "do not begin like" : "libgdcm-dev and g++", MOST);
    begin(&f, "1.2.840.10008.1.2.4.100", 0); /* MPEG */
    fragment(&f, "no picture", 10);
    path = support_write(&files, "c.dcm", f.bytes, f.size);
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT,
                    SNOW_HAVE_GDCM ? "compressed in an unsupported way"
                                   : "1.2.840.10008.1.2.4.100",
                    MOST);
    support_files_end(&files);
}

/* --- deflated files ------------------------------------------------------- */

#define BOMB_BYTES ((uint32_t)65 << 20)

/* The elements of a slice, deflated, whose last one claims BOMB_BYTES zeros and
 * has them. */
static void write_bomb(const support_files *files, const char *name,
                       double height, uint32_t last) {
    static unsigned char packed[1 << 20];
    static const unsigned char zeros[4096];
    file f;
    z_stream stream = {.avail_out = sizeof packed - 256};
    begin(&f, "1.2.840.10008.1.2.1.99", height);
    size_t meta = 132 + 8 + 22; /* the mark and the syntax */
    element(&f, last, "OB", NULL, BOMB_BYTES);
    memcpy(packed, f.bytes, meta);
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, -15, 9, 0), Z_OK);
    stream.next_out = packed + meta;
    stream.next_in = f.bytes + meta;
    stream.avail_in = (uInt)(f.size - meta);
    deflate(&stream, Z_NO_FLUSH);
    for (uint32_t made = 0; made < BOMB_BYTES; made += sizeof zeros) {
        stream.next_in = (unsigned char *)(uintptr_t)zeros;
        stream.avail_in = sizeof zeros;
        deflate(&stream, Z_NO_FLUSH);
    }
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    deflateEnd(&stream);
    support_write(files, name, packed, meta + stream.total_out);
}

/* A slice needs the headers of those beside it and no more of their pixels than
 * its image has, whatever they inflate to. */
static void a_deflated_bomb_costs_what_its_image_has(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    file f;
    slice(&f, 0, 1);
    const char *plain = support_write(&files, "a.dcm", f.bytes, f.size);
    write_bomb(&files, "b.dcm", 1, DICOM_TAG_PIXELS);
    snow_volume *volume = support_opened(&files, plain, NULL);
    const uint16_t *voxels = snow_volume_voxels(volume);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 2);
    for (int i = 0; i < 16; i++)
        assert_int_equal(voxels[i], i < 8 ? 1 + i : 0);
    snow_volume_close(volume);
    assert_true(files.largest <= MOST);
    support_files_end(&files);
}

static void a_deflated_bomb_before_the_pixels_is_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    write_bomb(&files, "b.dcm", 1, 0x00291010);
    support_refused(&files, support_path(&files, "b.dcm"), NULL,
                    SNOW_STATUS_BAD_INPUT, "inflates to more than 64 MiB",
                    MOST);
    support_files_end(&files);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slices_are_ordered_along_their_normal),
        cmocka_unit_test(frames_without_a_position_have_their_first_row_on_top),
        cmocka_unit_test(a_tilt_is_a_shear_in_the_matrix),
        cmocka_unit_test(a_missing_slice_is_named),
        cmocka_unit_test(a_missing_slice_is_a_gap_where_it_may_be),
        cmocka_unit_test(uneven_slices_are_made_even),
        cmocka_unit_test(slices_beside_one_another_are_refused),
        cmocka_unit_test(several_at_each_place_are_times),
        cmocka_unit_test(frames_that_are_not_alike_are_groups),
        cmocka_unit_test(a_folder_is_a_volume_whatever_its_names),
        cmocka_unit_test(a_file_says_how_to_show_it),
        cmocka_unit_test(a_slice_tells_that_those_beside_it_are_damaged),
        cmocka_unit_test(hounsfield_units_are_those_of_a_ct),
        cmocka_unit_test(a_slice_without_a_number_is_there_once),
        cmocka_unit_test(a_file_says_nothing_of_the_patient),
        cmocka_unit_test(a_file_cut_anywhere_is_refused),
        cmocka_unit_test(lengths_that_lie_cost_no_memory),
        cmocka_unit_test(a_deflated_bomb_costs_what_its_image_has),
        cmocka_unit_test(a_deflated_bomb_before_the_pixels_is_refused),
        cmocka_unit_test(run_lengths_are_unpacked),
        cmocka_unit_test(packed_pixels_must_be_what_the_header_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
