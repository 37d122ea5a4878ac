/* formats/dicom/header.c - reads a file's image and its frames from the header
 * (PS3.3: C.7.6.2 and C.7.6.3 image plane and pixels, C.7.6.16 functional
 * groups of frames, C.8.4 nuclear medicine, C.8.8.3 doses, C.8.20
 * segmentations). */
#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Longest value of numbers as text: offsets of a few thousand frames. */
#define TEXT_BYTES 65536

/* How numbers are stored. */
typedef enum storage { TEXT, SHORTS, LONGS, DOUBLES } storage;

/* The place of a number: in a functional group, or in the file itself. */
typedef struct field {
    uint32_t sequence, tag;
    storage kind;
    uint32_t alone; /* 0: only in the group */
    storage alone_kind;
} number_field;

static const number_field orientation_field = {0x00209116, 0x00200037, TEXT,
                                               0x00200037, TEXT};
static const number_field pixel_field = {0x00289110, 0x00280030, TEXT,
                                         0x00280030, TEXT};
static const number_field depth_field = {0x00289110, 0x00180088, TEXT,
                                         0x00180088, TEXT};
static const number_field thickness_field = {0x00289110, 0x00180050, TEXT,
                                             0x00180050, TEXT};
static const number_field slope_field = {0x00289145, 0x00281053, TEXT,
                                         0x00281053, TEXT};
static const number_field intercept_field = {0x00289145, 0x00281052, TEXT,
                                             0x00281052, TEXT};

static const number_field level_field = {0x00289132, 0x00281050, TEXT,
                                         0x00281050, TEXT};
static const number_field width_field = {0x00289132, 0x00281051, TEXT,
                                         0x00281051, TEXT};

static const number_field key_fields[DICOM_KEYS] = {
    [DICOM_KEY_SEGMENT] = {0x0062000a, 0x0062000b, SHORTS, 0, TEXT},
    [DICOM_KEY_TIME] = {0x00209111, 0x00209128, LONGS, 0x00200100, TEXT},
    [DICOM_KEY_TRIGGER] = {0x00189118, 0x00209153, DOUBLES, 0x00181060, TEXT},
    [DICOM_KEY_ECHO] = {0x00189114, 0x00189082, DOUBLES, 0x00180081, TEXT},
    [DICOM_KEY_B_VALUE] = {0x00189117, 0x00189087, DOUBLES, 0x00189087,
                           DOUBLES},
    [DICOM_KEY_ACQUISITION] = {0, 0, TEXT, 0x00200012, TEXT},
    [DICOM_KEY_INSTANCE] = {0, 0, TEXT, 0x00200013, TEXT},
};

/* --- values --------------------------------------------------------------- */

/* Parses "1.5\-2 " as numbers; stops at anything else. */
static int parse_numbers(char *text, double *out, int most) {
    int count = 0;
    for (char *end; count < most; text = end + 1) {
        end = strchr(text, '\\');
        if (end)
            *end = 0;
        if (!snow_parse_double(text, &out[count]) || !isfinite(out[count]))
            break;
        count++;
        if (!end)
            break;
    }
    return count;
}

/* Reads one number of a file in either byte order. */
static double binary(const unsigned char *bytes, size_t size, bool big) {
    return size == 8 ? snow_double_at(bytes, big)
                     : (double)snow_number_at(bytes, (int)size, big);
}

static int numbers_of(const dicom_reader *reader, const dicom_element *element,
                      storage kind, double *out, int most) {
    static const size_t sizes[] = {[SHORTS] = 2, [LONGS] = 4, [DOUBLES] = 8};
    char text[1024];
    if (kind == TEXT) {
        size_t length =
            snow_dicom_bytes(reader, element, text, sizeof text - 1);
        text[length] = 0;
        return length ? parse_numbers(text, out, most) : 0;
    }
    size_t size = sizes[kind], capacity = (size_t)most * size;
    capacity = capacity < sizeof text ? capacity : sizeof text;
    int count = (int)(snow_dicom_bytes(reader, element, text, capacity) / size);
    for (int i = 0; i < count; i++) {
        out[i] = binary((const unsigned char *)text + (size_t)i * size, size,
                        reader->big_endian);
        if (!isfinite(out[i]))
            return i;
    }
    return count;
}

static int numbers_at(dicom_reader *reader, dicom_place place, storage kind,
                      double *out, int most) {
    return numbers_of(reader, snow_dicom_locate(reader, place), kind, out,
                      most);
}

int snow_dicom_shorts(const dicom_reader *reader, const dicom_element *element,
                      double *out, int most) {
    return numbers_of(reader, element, SHORTS, out, most);
}

/* Reads numbers of a frame, or of the file; returns how many there are. */
static int numbers(dicom_reader *reader, const number_field *field,
                   int64_t frame, double *out, int most) {
    int count = 0;
    if (field->sequence)
        count = numbers_at(reader,
                           (dicom_place){frame, field->sequence, field->tag},
                           field->kind, out, most);
    if (!count && field->alone)
        count = numbers_at(reader, (dicom_place){0, 0, field->alone},
                           field->alone_kind, out, most);
    return count;
}

/* Returns `otherwise` if it is missing. */
static double number(dicom_reader *reader, uint32_t tag, storage kind,
                     double otherwise) {
    double value;
    return numbers_at(reader, (dicom_place){0, 0, tag}, kind, &value, 1)
               ? value
               : otherwise;
}

static void words(dicom_reader *reader, uint32_t tag, char *out,
                  size_t capacity) {
    snow_dicom_words(reader,
                     snow_dicom_locate(reader, (dicom_place){0, 0, tag}), out,
                     capacity);
}

/* --- the file ------------------------------------------------------------- */

/* Padding is a word like pixels, with the same sign. */
static double padding(dicom_reader *reader, uint32_t tag,
                      const dicom_image *image, bool *given) {
    double value = number(reader, tag, SHORTS, NAN);
    *given = !isnan(value);
    if (*given && image->is_signed && value >= 32768)
        value -= 65536;
    return value;
}

static void read_padding(dicom_reader *reader, dicom_image *image) {
    bool range;
    image->padding[0] = padding(reader, 0x00280120, image, &image->pads);
    image->padding[1] = padding(reader, 0x00280121, image, &range);
    if (!range)
        image->padding[1] = image->padding[0];
    if (image->pads && image->padding[1] < image->padding[0]) {
        double swap = image->padding[0];
        image->padding[0] = image->padding[1];
        image->padding[1] = swap;
    }
}

/* Returns whether a file claims to contain an image, by the class of its
 * contents (PS3.4, B.5): all classes except spectra, waveforms, presentation
 * states, registrations, measurements, documents, protocols and plans. */
static bool says_image(const dicom_reader *reader) {
    static const char root[] = "1.2.840.10008.5.1.4.1.1.";
    static const char *const others[] = {
        "4.2", "9",     "11",    "66",    "67",    "68",  "77.1.5.3", "78",
        "79",  "80",    "88",    "104",   "129",   "131", "200",      "201",
        "481", "501.3", "501.4", "501.5", "501.6", "601"};
    const char *given = reader->class_known;
    if (strncmp(given, root, sizeof root - 1) != 0)
        return false;
    given += sizeof root - 1;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        size_t length = strlen(others[i]);
        if (!strncmp(given, others[i], length) &&
            strchr(". ", given[length])) /* or its end */
            return false;
    }
    return true;
}

/* The type of a segmentation, known by the class of the file's contents. */
static dicom_segments segments_of(dicom_reader *reader) {
    static const char *const names[] = {[DICOM_BINARY] = "BINARY",
                                        [DICOM_FRACTIONAL] = "FRACTIONAL",
                                        [DICOM_LABELMAP] = "LABELMAP"};
    char given[65];
    snow_dicom_text(reader, 0x00080016, given, sizeof given);
    if (strcmp(given, "1.2.840.10008.5.1.4.1.1.66.4") != 0 &&
        strcmp(given, "1.2.840.10008.5.1.4.1.1.66.7") != 0)
        return DICOM_NO_SEGMENTS;
    snow_dicom_text(reader, 0x00620001, given, sizeof given);
    for (int i = DICOM_BINARY; i <= DICOM_LABELMAP; i++)
        if (!strcmp(given, names[i]))
            return (dicom_segments)i;
    return DICOM_UNKNOWN_SEGMENTS;
}

snow_status snow_dicom_read_image(snow_context *context, dicom_reader *reader,
                                  dicom_image *out) {
    dicom_image image = {0};
    image.columns = (int64_t)number(reader, 0x00280011, SHORTS, 0);
    image.rows = (int64_t)number(reader, 0x00280010, SHORTS, 0);
    if (!image.columns || !image.rows) {
        if (says_image(reader))
            return snow_fail(
                context, SNOW_STATUS_BAD_INPUT,
                "is truncated or damaged: it claims to be an image but has "
                "none; get it again, or remove it from the folder");
        image.rows = 0;
        *out = image;
        return SNOW_STATUS_OK;
    }
    if (!reader->has_pixels)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "has no integer pixels, the only supported kind; it "
                         "is truncated, or a map of floats");
    double frames = number(reader, 0x00280008, TEXT, 1);
    image.no_frames = frames == 0;
    image.frames = image.no_frames               ? 1
                   : frames >= 1 && frames < 1e9 ? (int64_t)frames
                                                 : 0;
    image.samples = (int)number(reader, 0x00280002, SHORTS, 1);
    image.allocated = (int)number(reader, 0x00280100, SHORTS, 16);
    image.stored = (int)number(reader, 0x00280101, SHORTS, image.allocated);
    image.high = (int)number(reader, 0x00280102, SHORTS, image.stored - 1);
    image.is_signed = number(reader, 0x00280103, SHORTS, 0) > 0;
    image.planes = number(reader, 0x00280006, SHORTS, 0) > 0;
    image.segments = segments_of(reader);
    image.whole = 1;
    if (image.segments == DICOM_FRACTIONAL)
        image.whole = (unsigned)number(reader, 0x0062000e, SHORTS, 255);
    double series = number(reader, 0x00200011, TEXT, 0);
    image.series_number = fabs(series) < 1e15 ? (int64_t)series : 0;
    snow_dicom_text(reader, 0x0020000d, image.study, sizeof image.study);
    snow_dicom_text(reader, 0x0020000e, image.series, sizeof image.series);
    snow_dicom_text(reader, 0x00080018, image.instance, sizeof image.instance);
    snow_dicom_text(reader, 0x00280004, image.photometric,
                    sizeof image.photometric);
    snow_dicom_text(reader, 0x00080060, image.modality, sizeof image.modality);
    snow_dicom_text(reader, 0x00080032, image.clock, 32);
    snow_dicom_text(reader, 0x00080033, image.clock + strlen(image.clock), 32);
    words(reader, 0x00100010, image.patient, sizeof image.patient);
    words(reader, 0x0008103e, image.description, sizeof image.description);
    snow_dicom_text(reader, 0x00281054, image.rescale_type,
                    sizeof image.rescale_type);
    image.acquired = snow_dicom_acquired(reader);
    read_padding(reader, &image);
    image.more = snow_dicom_count_more(reader, &image);
    SNOW_TRY(snow_dicom_check_sizes(context, reader, &image));
    SNOW_TRY(snow_dicom_read_mosaic(reader, &image));
    *out = image;
    return SNOW_STATUS_OK;
}

/* --- a frame -------------------------------------------------------------- */

/* Normalizes the directions to length 1 and a right angle; with few printed
 * digits they are only approximately so. */
static bool set_orientation(const double six[6], dicom_frame *frame) {
    for (int k = 0; k < 2; k++) {
        double *to = k ? frame->column : frame->row;
        if (!(fabs(snow_length(six + 3 * k) - 1) <= 0.01))
            return false;
        memcpy(to, six + 3 * k, 3 * sizeof *to);
    }
    return fabs(snow_dot(frame->row, frame->column)) <= 0.01;
}

/* Reads the frames' offsets in mm, or their slices' numbers, into the
 * reader. */
static void seek_offsets(dicom_reader *reader, int64_t frames) {
    const dicom_place mm = {0, 0, 0x3004000c}, slices = {0, 0, 0x00540080};
    reader->offset_in = DICOM_NO_OFFSETS;
    if (frames > TEXT_BYTES / 2)
        return; /* too many for a text or for numbers */
    double *list =
        snow_allocate_array(reader->context, (uint64_t)frames, sizeof *list);
    char *raw = snow_allocate(reader->context, TEXT_BYTES);
    if (list && raw) {
        size_t length = snow_dicom_value(reader, mm, raw, TEXT_BYTES - 1);
        raw[length] = 0;
        if (length && parse_numbers(raw, list, (int)frames) == (int)frames) {
            reader->offset_in = DICOM_MM;
        } else if (snow_dicom_value(reader, slices, raw, TEXT_BYTES) ==
                   2 * (size_t)frames) {
            reader->offset_in = DICOM_SLICES;
            for (int64_t i = 0; i < frames; i++)
                list[i] = binary((const unsigned char *)raw + 2 * i, 2,
                                 reader->big_endian) -
                          1;
        }
    }
    snow_release(reader->context, raw);
    if (reader->offset_in == DICOM_NO_OFFSETS)
        snow_release(reader->context, list);
    else
        reader->offsets = list;
}

/* Offsets in mm are from the first frame, or places along z if the first is not
 * 0 (C.8.8.3.2). */
static double way_of(const double *offsets, const dicom_frame *frame) {
    const double way = offsets[frame->number] - offsets[0];
    double normal[3];
    snow_dicom_normal(frame, normal);
    return offsets[0] != 0 && normal[2] < 0 ? -way : way;
}

/* The position of a frame relative to the first.  Only offsets in mm need no
 * slice distance. */
static double offset_of(dicom_reader *reader, const dicom_image *image,
                        dicom_frame *frame) {
    if (reader->offset_in == DICOM_UNSOUGHT)
        seek_offsets(reader, image->frames);
    if (reader->offset_in == DICOM_MM)
        return way_of(reader->offsets, frame);
    if (frame->depth == 0) {
        frame->depth = 1;
        frame->guessed = true;
    }
    return frame->depth * (reader->offsets ? reader->offsets[frame->number]
                                           : (double)frame->number);
}

/* In older files frames follow the first one along the normal. */
static void move_along(dicom_frame *frame, double offset) {
    double normal[3];
    snow_dicom_normal(frame, normal);
    for (int i = 0; i < 3; i++)
        frame->position[i] += offset * normal[i];
}

static void read_place(dicom_reader *reader, const dicom_image *image,
                       dicom_frame *frame) {
    static const number_field own = {0x00209113, 0x00200032, TEXT, 0, TEXT};
    static const number_field whole = {0, 0, TEXT, 0x00200032, TEXT};
    static const number_field detector = {0x00540022, 0x00200032, TEXT, 0,
                                          TEXT};
    static const number_field turned = {0x00540022, 0x00200037, TEXT, 0, TEXT};
    double six[6];
    int64_t n = frame->number;
    bool oriented = (numbers(reader, &orientation_field, n, six, 6) == 6 ||
                     numbers(reader, &turned, n, six, 6) == 6) &&
                    set_orientation(six, frame);
    bool each = numbers(reader, &own, n, frame->position, 3) == 3;
    bool first =
        !each && (numbers(reader, &whole, n, frame->position, 3) == 3 ||
                  numbers(reader, &detector, n, frame->position, 3) == 3);
    frame->placed = oriented && (each || first);
    if (frame->placed && first && image->frames > 1)
        move_along(frame, offset_of(reader, image, frame));
    if (frame->placed)
        return;
    /* without a position the frame is at the origin, as an image */
    memset(frame->position, 0, sizeof frame->position);
    memcpy(frame->row, (double[3]){1, 0, 0}, sizeof frame->row);
    memcpy(frame->column, (double[3]){0, 1, 0}, sizeof frame->column);
}

/* Row spacing comes first: the distance down a column. */
static void read_pixel(dicom_reader *reader, dicom_frame *frame) {
    static const number_field imager = {0, 0, TEXT, 0x00181164, TEXT};
    double pair[2];
    frame->pixel[0] = frame->pixel[1] = 1;
    if (numbers(reader, &pixel_field, frame->number, pair, 2) != 2 &&
        numbers(reader, &imager, frame->number, pair, 2) != 2)
        return;
    frame->measured = pair[0] > 0 && pair[1] > 0;
    if (frame->measured) {
        frame->pixel[0] = pair[1];
        frame->pixel[1] = pair[0];
    }
}

/* Whether values have another meaning than the stored ones, by a table or by a
 * map to real world values. */
static bool has_map(dicom_reader *reader, int64_t frame) {
    static const number_field slope_of = {0x00409096, 0x00409225, DOUBLES, 0,
                                          TEXT};
    static const number_field intercept_of = {0x00409096, 0x00409224, DOUBLES,
                                              0, TEXT};
    double slope = 1, intercept = 0;
    numbers(reader, &slope_of, frame, &slope, 1);
    numbers(reader, &intercept_of, frame, &intercept, 1);
    return slope != 1 || intercept != 0 ||
           snow_dicom_locate(reader,
                             (dicom_place){frame, 0x00283000, 0x00283006});
}

/* Without a rescale, MONOCHROME1 means that high stored values are dark: the
 * range of the stored bits is inverted. */
static void read_scale(dicom_reader *reader, const dicom_image *image,
                       dicom_frame *frame) {
    double slope = number(reader, 0x3004000e, TEXT, 1), intercept = 0;
    numbers(reader, &slope_field, frame->number, &slope, 1);
    numbers(reader, &intercept_field, frame->number, &intercept, 1);
    if (slope == 0) {
        slope = 1;
        frame->unscaled = true;
    }
    frame->unmapped =
        slope == 1 && intercept == 0 && has_map(reader, frame->number);
    if (!strcmp(image->photometric, "MONOCHROME1") && slope == 1 &&
        intercept == 0) {
        intercept = image->is_signed ? -1 : ldexp(1, image->stored) - 1;
        slope = -1;
    }
    frame->slope = slope;
    frame->intercept = intercept;
}

/* The first window, if there are several.  It refers to values after the
 * rescale that the file has, but before an inversion that it only implies. */
static void read_window(dicom_reader *reader, const dicom_image *image,
                        dicom_frame *frame) {
    double level, width, middle;
    if (image->samples != 1 || strncmp(image->photometric, "MONO", 4) != 0 ||
        numbers(reader, &level_field, frame->number, &level, 1) != 1 ||
        numbers(reader, &width_field, frame->number, &width, 1) != 1 ||
        !(width > 0))
        return;
    bool inverted =
        !strcmp(image->photometric, "MONOCHROME1") && frame->slope == -1;
    middle = inverted ? frame->intercept - level : level;
    frame->window[0] = middle - width / 2;
    frame->window[1] = middle + width / 2;
}

void snow_dicom_read_frame(dicom_reader *reader, const dicom_image *image,
                           int64_t frame_number, dicom_frame *out) {
    dicom_frame frame = {.image = image, .number = frame_number};
    numbers(reader, &depth_field, frame_number, &frame.depth, 1);
    numbers(reader, &thickness_field, frame_number, &frame.thickness, 1);
    read_place(reader, image, &frame);
    read_pixel(reader, &frame);
    snow_dicom_place_tile(image, &frame);
    read_scale(reader, image, &frame);
    read_window(reader, image, &frame);
    for (int i = 0; i < DICOM_KEYS; i++)
        numbers(reader, &key_fields[i], frame_number, &frame.keys[i], 1);
    *out = frame;
}

snow_status snow_dicom_find_cut(const dicom_reader *reader,
                                const dicom_image *image, bool *cut) {
    dicom_reader whole;
    *cut = reader->cut;
    if (reader->cut || !reader->packed)
        return SNOW_STATUS_OK;
    snow_status status =
        snow_dicom_open(reader->context, NULL, reader->file, image, &whole);
    *cut = status == SNOW_STATUS_BAD_INPUT;
    if (status == SNOW_STATUS_OK)
        snow_dicom_close(&whole);
    return *cut ? SNOW_STATUS_OK : status;
}
