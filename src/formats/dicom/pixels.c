/* formats/dicom/pixels.c - reads the words of a frame from the file, or
 * decompresses them from fragments (PS3.5, annex A).
 *
 * Fragments are assigned to frames by the table before them, or one each, or
 * all to a single frame; otherwise a frame begins with a fragment that begins
 * like a code stream. */
#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

#include "base/minmax.h"
#include "base/module.h"
#include "formats/dicom/gdcm_bridge.h"

#include <math.h>
#include <string.h>

#define RUN_LENGTHS "1.2.840.10008.1.2.5"
#define IMPLICIT "1.2.840.10008.1.2" /* all known ones begin so */

uint64_t snow_dicom_frame_bytes(const dicom_image *image) {
    uint64_t bits = image->allocated == 1 ? 8 : (uint64_t)image->allocated;
    return (uint64_t)image->columns * (uint64_t)image->rows *
           ((uint64_t)image->samples * bits / 8);
}

/* --- plain ---------------------------------------------------------------- */

static snow_status fail_short(dicom_reader *reader, const dicom_image *image,
                              const dicom_element *pixels, uint64_t bytes) {
    return snow_fail(
        reader->context, SNOW_STATUS_BAD_INPUT,
        "is truncated or damaged: its pixels have %lu bytes, not the %llu "
        "of %lld frame%s of %lldx%lld; get the file again",
        (unsigned long)pixels->length, (unsigned long long)bytes,
        (long long)image->frames, image->frames == 1 ? "" : "s",
        (long long)image->columns, (long long)image->rows);
}

/* Single bits, the lowest of a byte first; frames follow one another without a
 * gap, also within a byte (PS3.5, 8.1.1).  Each becomes a byte, 0 or
 * 1. */
static snow_status read_bits(dicom_reader *reader, const dicom_image *image,
                             const dicom_element *pixels, int64_t number,
                             unsigned char *out) {
    uint64_t count = snow_dicom_frame_bytes(image);
    uint64_t first = (uint64_t)number * count;
    unsigned char piece[4096];
    /* words of a big endian file are two bytes swapped */
    uint64_t swap = pixels->words && reader->big_endian ? 1 : 0;
    for (uint64_t i = 0; i < count;) {
        uint64_t at = (first + i) / 16 * 2;
        size_t held = at < pixels->length ? pixels->length - (size_t)at : 0;
        held = held < sizeof piece ? held : sizeof piece;
        held = snow_seekable_read(reader->store, pixels->at + at, piece, held);
        uint64_t bit = first + i - 8 * at, end = 8 * (uint64_t)(held & ~swap);
        if (bit >= end)
            return fail_short(reader, image, pixels,
                              (count * (uint64_t)image->frames + 7) / 8);
        for (; bit < end && i < count; bit++, i++)
            out[i] = piece[(bit / 8) ^ swap] >> bit % 8 & 1;
    }
    return SNOW_STATUS_OK;
}

/* Two pixels of YBR_FULL_422 are Y, Y, Cb, Cr (PS3.3, C.7.6.3.1.2).  They stand
 * at the front of what six bytes each will fill, so that the last go first. */
static void spread_colours(unsigned char *out, uint64_t pairs) {
    while (pairs--) {
        unsigned char in[4];
        memcpy(in, out + 4 * pairs, 4);
        const unsigned char pixels[] = {in[0], in[2], in[3],
                                        in[1], in[2], in[3]};
        memcpy(out + 6 * pairs, pixels, sizeof pixels);
    }
}

static snow_status read_plain(dicom_reader *reader, const dicom_image *image,
                              const dicom_element *pixels, int64_t number,
                              unsigned char *out) {
    uint64_t bytes = snow_dicom_frame_bytes(image);
    /* Some that say so have all the samples nevertheless. */
    const bool halved = !strcmp(image->photometric, "YBR_FULL_422") &&
                        bytes * (uint64_t)image->frames > pixels->length;
    if (halved && (image->samples != 3 || image->allocated != 8 || bytes % 2))
        return fail_short(reader, image, pixels,
                          bytes * (uint64_t)image->frames);
    bytes = halved ? bytes / 3 * 2 : bytes;
    uint64_t first = (uint64_t)number * bytes;
    if (first + bytes > pixels->length ||
        snow_seekable_read(reader->store, pixels->at + first, out,
                           (size_t)bytes) < bytes)
        return fail_short(reader, image, pixels,
                          bytes * (uint64_t)image->frames);
    size_t size = (size_t)image->allocated / 8;
    /* bytes that were written as words are swapped like them */
    if (size == 1 && pixels->words && reader->big_endian)
        snow_swap_bytes(out, bytes / 2, 2);
    else if (reader->big_endian != snow_machine_big_endian())
        snow_swap_bytes(out, bytes / size, size);
    if (halved)
        spread_colours(out, bytes / 4);
    return SNOW_STATUS_OK;
}

/* --- compressed ----------------------------------------------------------- */

/* Fragments first .. first + count - 1 of the pixels; the table is 0. */
typedef struct span {
    int64_t first, count;
} span;

static int64_t count_fragments(const dicom_reader *reader,
                               const dicom_element *pixels) {
    size_t at = (size_t)(pixels - reader->elements) + 1;
    int64_t count = (int64_t)(pixels->next - at);
    return count > 0 ? count - 1 : 0;
}

static const dicom_element *fragment(const dicom_element *pixels,
                                     int64_t index) {
    return pixels + 1 + index;
}

/* Finds the beginning of a frame in the table, which counts from its own
 * end. */
static bool table_entry(dicom_reader *reader, const dicom_element *pixels,
                        int64_t number, uint64_t *out) {
    unsigned char bytes[4];
    const dicom_element *table = fragment(pixels, 0);
    if ((uint64_t)number * 4 + 4 > table->length ||
        snow_seekable_read(reader->store, table->at + (uint64_t)number * 4,
                           bytes, 4) < 4)
        return false;
    const uint64_t offset = snow_number_at(bytes, 4, reader->big_endian);
    /* from the item after the table, whose header has 8 bytes */
    *out = table->at + table->length + offset + 8;
    return true;
}

/* Returns whether a fragment begins with JPEG, JPEG 2000, or the table of run
 * lengths. */
static bool begins_stream(dicom_reader *reader, const dicom_element *at) {
    unsigned char bytes[12];
    if (snow_seekable_read(reader->store, at->at, bytes, 12) < 12)
        return false;
    if (!strcmp(reader->syntax, RUN_LENGTHS))
        return !memcmp(bytes + 1, "\0\0\0\x40\0\0", 7);
    return !memcmp(bytes, "\xff\xd8\xff", 3) ||
           !memcmp(bytes, "\xff\x4f\xff\x51", 4) ||
           !memcmp(bytes + 4, "jP  \r\n\x87\n", 8);
}

/* Returns whether fragment `index` is the first of frame `number`, or of the
 * frame reached by counting. */
static bool begins_frame(dicom_reader *reader, const dicom_element *pixels,
                         int64_t index, int64_t number, bool table) {
    uint64_t at;
    if (table)
        return table_entry(reader, pixels, number, &at) &&
               fragment(pixels, index)->at == at;
    return begins_stream(reader, fragment(pixels, index));
}

/* False if the fragments are those of fewer or more frames. */
static bool find_span(dicom_reader *reader, const dicom_image *image,
                      const dicom_element *pixels, int64_t number, span *out) {
    int64_t count = count_fragments(reader, pixels), frame = -1;
    uint64_t ignored;
    if (count < image->frames)
        return false;
    *out = (span){number + 1, 1};
    if (count == image->frames)
        return true;
    /* All are of the only frame, whose beginning need not be known. */
    const bool single = image->frames == 1;
    bool table =
        !single && table_entry(reader, pixels, image->frames - 1, &ignored);
    if (table && table_entry(reader, pixels, image->frames, &ignored))
        return false;
    *out = (span){0, 0};
    for (int64_t i = 1; i <= count; i++) {
        if ((single && i == 1) ||
            begins_frame(reader, pixels, i, frame + 1, table))
            frame++;
        if (frame == number && !out->count)
            out->first = i;
        out->count += frame == number;
    }
    return out->count > 0 && frame + 1 == image->frames;
}

/* Concatenates the fragments of a frame. */
static snow_status gather(dicom_reader *reader, const dicom_element *pixels,
                          span where, unsigned char **out, size_t *size) {
    uint64_t all = 0;
    for (int64_t i = 0; i < where.count; i++)
        all += fragment(pixels, where.first + i)->length;
    unsigned char *bytes = snow_allocate_array(reader->context, all, 1);
    if (!bytes)
        return SNOW_STATUS_NO_MEMORY;
    *size = 0;
    for (int64_t i = 0; i < where.count; i++) {
        const dicom_element *part = fragment(pixels, where.first + i);
        *size += snow_seekable_read(reader->store, part->at, bytes + *size,
                                    part->length);
    }
    *out = bytes;
    if (*size == all)
        return SNOW_STATUS_OK;
    snow_release(reader->context, bytes);
    return snow_dicom_fail_unpack(reader->context, reader->syntax);
}

/* Pixels in a syntax that nobody knows would be read as if they were plain: a
 * private one of GE has little-endian elements but big-endian pixels. */
snow_status snow_dicom_check_syntax(const dicom_reader *r) {
    const size_t common = sizeof IMPLICIT - 1;
    const char *end = r->syntax + common;
    if (!*r->syntax || !strcmp(r->syntax, DICOM_DEFLATED) ||
        (!memcmp(r->syntax, IMPLICIT, common) &&
         (!*end || (*end == '.' && end[2] == (end[1] == '4' ? '.' : 0) &&
                    end[1] && strchr("1245", end[1])))))
        return SNOW_STATUS_OK;
    return snow_fail(r->context, SNOW_STATUS_BAD_INPUT,
                     "its pixels are stored in an unknown way (transfer syntax "
                     "%.64s), which is not supported; decompress it, for "
                     "example with gdcmconv --raw",
                     r->syntax);
}

#if SNOW_HAVE_GDCM

/* The codecs of GDCM that are used: JPEG, JPEG-LS and JPEG 2000 of one
 * component or colour. */
static bool is_known(const char *syntax) {
    static const char *const known[] = {".50", ".51", ".57", ".70", ".80",
                                        ".81", ".90", ".91", NULL};
    static const char common[] = "1.2.840.10008.1.2.4";
    if (strncmp(syntax, common, sizeof common - 1) != 0)
        return false;
    for (const char *const *end = known; *end; end++)
        if (!strcmp(syntax + sizeof common - 1, *end))
            return true;
    return false;
}

#if SNOW_LOADS
static snow_status find_codec(snow_context *context, gdcm_codec **out) {
    const snow_module *module;
    SNOW_TRY(snow_module_load(context, "gdcm", &module));
    *out = module->unpack;
    return SNOW_STATUS_OK;
}
#else
static snow_status find_codec(snow_context *context, gdcm_codec **out) {
    (void)context;
    *out = snow_gdcm_unpack;
    return SNOW_STATUS_OK;
}
#endif

static snow_status unpack(dicom_reader *reader, const dicom_image *image,
                          const unsigned char *bytes, size_t size, void *out,
                          dicom_words *words) {
    gdcm_codec *codec;
    int bits;
    if (!is_known(reader->syntax))
        return snow_fail(
            reader->context, SNOW_STATUS_BAD_INPUT,
            "its pixels are compressed in an unsupported way (transfer syntax "
            "%.64s); decompress it, for example with gdcmconv --raw",
            reader->syntax);
    SNOW_TRY(snow_dicom_check_packed(reader->context, reader->syntax, image,
                                     &bytes, &size, &bits));
    SNOW_TRY(find_codec(reader->context, &codec));
    gdcm_frame frame = {.syntax = reader->syntax,
                        .photometric = image->photometric,
                        .columns = (unsigned)image->columns,
                        .rows = (unsigned)image->rows,
                        .samples = image->samples,
                        .planes = words->planes,
                        .allocated = image->allocated,
                        .stored = image->stored,
                        .high = image->high,
                        .packed_bits = bits,
                        .is_signed = image->is_signed};
    if (!codec(&frame, bytes, size, out, (size_t)snow_dicom_frame_bytes(image)))
        return snow_dicom_fail_unpack(reader->context, reader->syntax);
    words->stored = frame.stored;
    words->high = frame.high;
    words->is_signed = frame.is_signed;
    if (image->is_signed && !frame.is_signed) {
        /* The stream has but the bits; the header says that they have a sign,
         * as pydicom takes it. */
        words->stored = SNOW_MIN(frame.stored, image->stored);
        words->high = frame.high - frame.stored + words->stored;
        words->is_signed = true;
    }
    words->planes = frame.planes;
    return SNOW_STATUS_OK;
}

#else

static snow_status unpack(dicom_reader *reader, const dicom_image *image,
                          const unsigned char *bytes, size_t size, void *out,
                          dicom_words *words) {
    (void)image, (void)bytes, (void)size, (void)out, (void)words;
    return snow_fail(
        reader->context, SNOW_STATUS_BAD_INPUT,
        "this build cannot read compressed DICOM images (transfer syntax "
        "%.64s): it lacks GDCM; install libgdcm-dev and g++, and build again",
        reader->syntax);
}

#endif

static snow_status read_packed(dicom_reader *reader, const dicom_image *image,
                               const dicom_element *pixels, int64_t number,
                               unsigned char *out, dicom_words *words) {
    span where;
    unsigned char *bytes;
    size_t size;
    if (image->allocated == 1)
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "its single bits are compressed (transfer syntax "
                         "%.64s), which is not supported; decompress it, for "
                         "example with gdcmconv --raw",
                         reader->syntax);
    if (!find_span(reader, image, pixels, number, &where))
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "its %lld compressed pieces of pixels are not those "
                         "of %lld frame%s; it is damaged",
                         (long long)count_fragments(reader, pixels),
                         (long long)image->frames,
                         image->frames == 1 ? "" : "s");
    SNOW_TRY(gather(reader, pixels, where, &bytes, &size));
    snow_status status = SNOW_STATUS_OK;
    if (strcmp(reader->syntax, RUN_LENGTHS) != 0)
        status = unpack(reader, image, bytes, size, out, words);
    else if (snow_dicom_unpack_runs(image, bytes, size, out))
        words->planes = true;
    else
        status = snow_dicom_fail_unpack(reader->context, reader->syntax);
    snow_release(reader->context, bytes);
    return status;
}

static unsigned char byte_of(double value) {
    return (unsigned char)fmin(fmax(floor(value + 0.5), 0), 255);
}

/* Bytes of Y, Cb, Cr as red, green, blue (PS3.3, C.7.6.3.1.2; ITU-T T.871). */
static void make_rgb(unsigned char *out, uint64_t pixels, bool planes) {
    const uint64_t step = planes ? 1 : 3, apart = planes ? pixels : 1;
    for (uint64_t i = 0; i < pixels; i++) {
        unsigned char *at = out + step * i;
        double y = at[0], cb = at[apart] - 128.0, cr = at[2 * apart] - 128.0;
        at[0] = byte_of(y + 1.402 * cr);
        at[apart] = byte_of(y - 0.114 * 1.772 / 0.587 * cb -
                            0.299 * 1.402 / 0.587 * cr);
        at[2 * apart] = byte_of(y + 1.772 * cb);
    }
}

bool snow_dicom_is_ybr(const dicom_image *image) {
    return image->samples == 3 && image->allocated == 8 &&
           (!strcmp(image->photometric, "YBR_FULL") ||
            !strcmp(image->photometric, "YBR_FULL_422"));
}

snow_status snow_dicom_read_words(dicom_reader *reader,
                                  const dicom_image *image, int64_t number,
                                  void *out, dicom_words *words) {
    const dicom_element *pixels =
        snow_dicom_find(reader, 0, reader->count, DICOM_TAG_PIXELS);
    bool single = image->allocated == 1;
    *words = (dicom_words){.size = single ? 1 : image->allocated / 8,
                           .stored = image->stored,
                           .high = image->high,
                           .is_signed = image->is_signed,
                           .planes = image->planes};
    if (!pixels)
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "has no pixels; it is truncated");
    if (reader->packed)
        SNOW_TRY(read_packed(reader, image, pixels, number, out, words));
    else
        SNOW_TRY((single ? read_bits : read_plain)(reader, image, pixels,
                                                   number, out));
    if (snow_dicom_is_ybr(image))
        make_rgb(out, (uint64_t)image->columns * (uint64_t)image->rows,
                 words->planes);
    if (!reader->packed)
        return SNOW_STATUS_OK;
    if (words->stored < 1 || words->stored > image->allocated ||
        words->high < words->stored - 1 || words->high >= image->allocated)
        return snow_dicom_fail_unpack(reader->context, reader->syntax);
    return SNOW_STATUS_OK;
}
