/* formats/metaimage/header.c - parses the "Key = value" lines of a MetaImage
 * header.
 *
 * Source: MetaIO, the format's own library, and its documentation at itk.org.
 * Keys may have any order, so all values are first stored as text, and
 * interpreted at ElementDataFile, which is always the last.
 *
 * World axes are always LPS in the file; x and y are flipped here, once, to our
 * RAS+.  `medical` is set if the file describes a patient:
 * AnatomicalOrientation with letters, or axis directions without that key.
 * "???", MetaIO's word for an unknown orientation, clears it. */
#include "formats/ascii.h"
#include "formats/metaimage/metaimage.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Programs store whole dictionaries in keys of their own, each in one line. */
#define LINE_BYTES 65536

typedef enum slot {
    OBJECT_TYPE,
    AXES,
    DIMS,
    TYPE,
    BINARY,
    COMPRESSED,
    BIG_ENDIAN,
    CHANNELS,
    SPACING,
    SIZE,
    OFFSET,
    DIRECTIONS,
    ANATOMY,
    HEADER_SIZE,
    COMPRESSED_SIZE,
    SLOPE,
    INTERCEPT,
    UNITS,
    DATA,
    IGNORED, /* keys that identify a MetaImage but are not needed */
    UNKNOWN,
    SLOT_COUNT = IGNORED
} slot;

/* All keys and their synonyms. */
static const char *const keys[] = {
    [OBJECT_TYPE] = "ObjectType",
    [AXES] = "NDims",
    [DIMS] = "DimSize",
    [TYPE] = "ElementType",
    [BINARY] = "BinaryData",
    [COMPRESSED] = "CompressedData",
    [BIG_ENDIAN] = "BinaryDataByteOrderMSB ElementByteOrderMSB",
    [CHANNELS] = "ElementNumberOfChannels",
    [SPACING] = "ElementSpacing",
    [SIZE] = "ElementSize",
    [OFFSET] = "Offset Position Origin",
    [DIRECTIONS] = "TransformMatrix Rotation Orientation",
    [ANATOMY] = "AnatomicalOrientation",
    [HEADER_SIZE] = "HeaderSize",
    [COMPRESSED_SIZE] = "CompressedDataSize",
    [SLOPE] = "ElementToIntensityFunctionSlope",
    [INTERCEPT] = "ElementToIntensityFunctionOffset",
    [UNITS] = "DistanceUnits",
    [DATA] = "ElementDataFile",
    [IGNORED] = "Comment ObjectSubType TransformType Name ID ParentID Color "
                "CenterOfRotation Modality CompressionLevel ElementMin "
                "ElementMax SequenceID",
};
#define KEY_BYTES 40

/* MET_LONG has 4 bytes on all machines, as in MetaIO. */
static const struct {
    const char *name;
    snow_type type;
} types[] = {
    {"MET_CHAR", SNOW_TYPE_INT8},       {"MET_UCHAR", SNOW_TYPE_UINT8},
    {"MET_SHORT", SNOW_TYPE_INT16},     {"MET_USHORT", SNOW_TYPE_UINT16},
    {"MET_INT", SNOW_TYPE_INT32},       {"MET_UINT", SNOW_TYPE_UINT32},
    {"MET_LONG_LONG", SNOW_TYPE_INT64}, {"MET_ULONG_LONG", SNOW_TYPE_UINT64},
    {"MET_FLOAT", SNOW_TYPE_FLOAT32},   {"MET_DOUBLE", SNOW_TYPE_FLOAT64},
    {"MET_LONG", SNOW_TYPE_INT32},      {"MET_ULONG", SNOW_TYPE_UINT32},
    {"MET_ASCII_CHAR", SNOW_TYPE_INT8},
};
#define TYPE_COUNT (sizeof types / sizeof *types)

/* The values of the lines, "" if missing. */
typedef struct fields {
    snow_context *context;
    char line[LINE_BYTES];
    char key[SLOT_COUNT][KEY_BYTES]; /* the synonym that was used */
    char value[SLOT_COUNT][METAIMAGE_VALUE_BYTES];
} fields;

/* The first of the names is written: MET_LONG is read like MET_INT. */
const char *metaimage_type_name(snow_type type) {
    for (size_t i = 0; i < TYPE_COUNT; i++)
        if (types[i].type == type)
            return types[i].name;
    return NULL;
}

static slot find_slot(const char *name) {
    int at = 0;
    while (at < UNKNOWN && !snow_has_word(keys[at], name))
        at++;
    return (slot)at;
}

/* The format's separators within a line; CR is one, for files from Windows. */
static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

/* The format has no magic number: any of its keys may come first, after
 * comments and empty lines.  Other texts hardly begin with a known key and "="
 * or ":". */
bool metaimage_probe(const unsigned char *bytes, size_t size) {
    const char *at = (const char *)bytes, *end = at + size;
    while (at < end) {
        while (at < end && (is_blank(*at) || *at == '\n'))
            at++;
        if (at == end || *at != '#')
            break;
        while (at < end && *at != '\n')
            at++;
    }
    char key[KEY_BYTES] = "";
    for (size_t i = 0; at < end && isalnum((unsigned char)*at); i++, at++)
        if (i + 1 < sizeof key)
            key[i] = *at;
    while (at < end && is_blank(*at))
        at++;
    return at < end && (*at == '=' || *at == ':') && find_slot(key) < UNKNOWN;
}

/* Removes blanks from both ends of a string, in place. */
static char *trim(char *text) {
    while (is_blank(*text))
        text++;
    size_t length = strlen(text);
    while (length && is_blank(text[length - 1]))
        length--;
    text[length] = 0;
    return text;
}

/* Files that give a value by two synonyms (Offset and Position) are common, and
 * harmless if both agree; otherwise neither choice would be safe. */
static snow_status keep_value(fields *f, const char *name, const char *value) {
    const slot where = find_slot(name);
    if (where >= IGNORED)
        return SNOW_STATUS_OK;
    if (strlen(value) >= METAIMAGE_VALUE_BYTES)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "the value of %s has more than %d letters; shorten it",
                         name, METAIMAGE_VALUE_BYTES - 1);
    if (*f->key[where] && strcmp(f->value[where], value) != 0)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "%s and %s contradict each other; keep one of them",
                         f->key[where], name);
    memcpy(f->key[where], name, strlen(name) + 1);
    memcpy(f->value[where], value, strlen(value) + 1);
    return SNOW_STATUS_OK;
}

/* Reads lines up to ElementDataFile, which always ends the header: with LOCAL
 * the next byte is a voxel.  Unknown keys belong to other programs and are
 * ignored. */
static snow_status read_fields(snow_source *source, fields *f) {
    snow_context *context = snow_source_context(source);
    while (!*f->key[DATA]) {
        bool got;
        SNOW_TRY(snow_source_read_line(source, f->line, LINE_BYTES, &got));
        if (!got)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "the header ends without ElementDataFile; the "
                             "file is truncated");
        char *text = trim(f->line);
        if (!*text || *text == '#')
            continue;
        size_t length = strcspn(text, "=");
        if (!text[length])
            length = strcspn(text, ":");
        if (!text[length])
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "the header has a line without \"=\": \"%.40s\"; "
                             "correct it",
                             text);
        text[length] = 0;
        char *value = trim(text + length + 1);
        SNOW_TRY(keep_value(f, trim(text), value));
    }
    return SNOW_STATUS_OK;
}

/* The value is shortened in messages: it may have a thousand letters. */
static snow_status fail_value(const fields *f, slot where, const char *wanted) {
    return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                     "%s is \"%.60s\", not %s; correct the header",
                     f->key[where], f->value[where], wanted);
}

/* Parses exactly `count` numbers; returns false otherwise. */
static bool parse_numbers(const char *text, int count, double *out) {
    char word[64];
    for (int i = 0; i < count; i++)
        if (!snow_next_word(&text, word, sizeof word) ||
            !snow_parse_double(word, &out[i]))
            return false;
    return !text[strspn(text, " \t")];
}

/* A size beyond 64 bits becomes the largest 64-bit number, which is then
 * refused as too large. */
static bool parse_dims(const char *text, int count, int64_t *out) {
    char word[64];
    for (int i = 0; i < count; i++) {
        if (!snow_next_word(&text, word, sizeof word))
            return false;
        if (!snow_parse_int64(word, &out[i])) {
            if (word[strspn(word, "0123456789")])
                return false;
            out[i] = INT64_MAX;
        }
    }
    return !text[strspn(text, " \t")];
}

/* "True" or "False", by the first letter as in MetaIO; `fallback` if
 * missing. */
static snow_status read_flag(const fields *f, slot where, bool fallback,
                             bool *out) {
    char first = f->value[where][0];
    if (*f->key[where] && !strchr("TtFf10", first ? first : 'x'))
        return fail_value(f, where, "True or False");
    *out = *f->key[where] ? strchr("Tt1", first) != NULL : fallback;
    return SNOW_STATUS_OK;
}

/* An optional number; if missing *out keeps its value. */
static snow_status read_number(const fields *f, slot where, double *out) {
    if (*f->key[where] && !parse_numbers(f->value[where], 1, out))
        return fail_value(f, where, "one number");
    return SNOW_STATUS_OK;
}

/* An optional integer; if missing *out keeps its value. */
static snow_status read_int(const fields *f, slot where, int64_t *out) {
    if (*f->key[where] && !snow_parse_int64(f->value[where], out))
        return fail_value(f, where, "a whole number");
    return SNOW_STATUS_OK;
}

/* Sizes and their products are checked in 64 bits before use; whether the file
 * really holds so much is checked when the data are opened. */
static snow_status read_sizes(const fields *f, metaimage_header *header) {
    int64_t axes = 0, channels = 1, voxels;
    SNOW_TRY(read_int(f, AXES, &axes));
    SNOW_TRY(read_int(f, CHANNELS, &channels));
    if (!*f->key[AXES] || !*f->key[DIMS])
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "the header has no %s; add it",
                         *f->key[AXES] ? "DimSize" : "NDims");
    if (axes < 1 || axes > 4)
        return fail_value(f, AXES, "a number of axes from 1 to 4");
    if (channels < 1)
        return fail_value(f, CHANNELS, "at least 1");
    header->channels = channels;
    header->axes = (int)axes;
    for (int i = 0; i < 4; i++)
        header->dims[i] = 1;
    if (!parse_dims(f->value[DIMS], header->axes, header->dims))
        return fail_value(f, DIMS,
                          "one whole number for each of the NDims axes");
    for (int i = 0; i < 4; i++)
        if (header->dims[i] < 1)
            return fail_value(f, DIMS, "sizes of at least 1");
    uint64_t step, all;
    memcpy(header->info.dims, header->dims, sizeof header->info.dims);
    if (!snow_volume_count(header->dims, header->info.type, &voxels, &step) ||
        !snow_mul_u64(step, (uint64_t)header->dims[3], &all) ||
        !snow_mul_u64(all, (uint64_t)channels, &all) ||
        all > (uint64_t)INT64_MAX)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "%s is \"%.60s\", too large for any file; correct "
                         "the header",
                         f->key[DIMS], f->value[DIMS]);
    header->info.times = header->dims[3];
    return SNOW_STATUS_OK;
}

/* ElementSize, the size of a voxel, is used if the distance between voxels is
 * missing.  A length below 0 reverses its axis, as in ITK.  An invalid length
 * is refused, not replaced by 1 as in NIfTI, where such files are common.  The
 * fourth length, of time, is ignored. */
static snow_status read_spacing(const fields *f, int axes, double spacing[4]) {
    slot where = *f->key[SPACING] ? SPACING : SIZE;
    if (!*f->key[where])
        return SNOW_STATUS_OK;
    bool good = parse_numbers(f->value[where], axes, spacing);
    for (int i = 0; i < axes && i < 3; i++)
        good = good && isfinite(spacing[i]) && spacing[i] != 0;
    return good ? SNOW_STATUS_OK
                : fail_value(f, where,
                             "one length for each axis, which is not 0");
}

/* Millimetres per unit; a missing unit and "?" count as mm, as ITK has it. */
static double read_unit(const fields *f) {
    const char *unit = f->value[UNITS];
    const double length = snow_unit_length(unit, NULL);
    if (!(length > 0) && *unit && strcmp(unit, "?") != 0)
        snow_notify(f->context,
                    "its DistanceUnits, \"%.40s\", is not known; mm are "
                    "assumed; --spacing sets others",
                    unit);
    return length > 0 ? length / snow_unit_length("mm", NULL) : 1;
}

/* Two conversions at once: from directions in rows to the columns of a matrix,
 * and from LPS to RAS.  Axes beyond NDims get a direction of their own. */
static snow_status read_geometry(const fields *f, metaimage_header *header) {
    int axes = header->axes;
    /* Directions come as one group of `axes` numbers per index axis. */
    double spacing[4] = {1, 1, 1, 1}, offset[4] = {0};
    const double millimetres = read_unit(f);
    double directions[16] = {0};
    for (int i = 0; i < axes; i++)
        directions[i * axes + i] = 1;
    SNOW_TRY(read_spacing(f, axes, spacing));
    if (*f->key[OFFSET] && !parse_numbers(f->value[OFFSET], axes, offset))
        return fail_value(f, OFFSET, "one number for each axis");
    if (*f->key[DIRECTIONS] &&
        !parse_numbers(f->value[DIRECTIONS], axes * axes, directions))
        return fail_value(f, DIRECTIONS, "a direction for each axis");
    for (int i = 0; i < 3; i++) {
        double to_ras = (i < 2 ? -1 : 1) * millimetres;
        for (int j = 0; j < 3; j++) {
            bool given = i < axes && j < axes;
            double cosine = given ? directions[j * axes + i] : i == j;
            /* Adding 0 turns -0, which the conversion makes, into 0. */
            header->info.matrix[i][j] = to_ras * cosine * spacing[j] + 0.0;
        }
        header->info.matrix[i][3] = to_ras * offset[i] + 0.0;
    }
    header->info.medical = *f->key[ANATOMY] ? f->value[ANATOMY][0] != '?'
                                            : *f->key[DIRECTIONS] != 0;
    snprintf(header->info.unit, sizeof header->info.unit, "mm");
    return SNOW_STATUS_OK;
}

/* Contradicting values are refused before the data are opened: either
 * interpretation could give noise. */
static snow_status read_layout(const fields *f, metaimage_header *header) {
    bool binary = true, compressed = false;
    int64_t packed = 0;
    snow_detached *data = &header->data;
    *data = (snow_detached){.type = header->info.type,
                            .skip = "what HeaderSize counts",
                            .skips_packed = true,
                            .finds_gzip = true,
                            .count = 1};
    SNOW_TRY(read_flag(f, BINARY, true, &binary));
    SNOW_TRY(read_flag(f, COMPRESSED, false, &compressed));
    SNOW_TRY(read_flag(f, BIG_ENDIAN, false, &data->big_endian));
    SNOW_TRY(read_int(f, HEADER_SIZE, &data->byte_skip));
    SNOW_TRY(read_int(f, COMPRESSED_SIZE, &packed));
    if (packed < 0)
        return fail_value(f, COMPRESSED_SIZE, "0 or above");
    if (data->byte_skip < -1)
        return fail_value(f, HEADER_SIZE, "-1, 0 or above");
    if (data->byte_skip == -1 && (compressed || !binary))
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "HeaderSize = -1 needs plain binary voxels, whose "
                         "size is known; give the number of bytes");
    if (!binary && compressed)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "voxels as text cannot be compressed; correct "
                         "BinaryData or CompressedData");
    data->packing = compressed ? SNOW_PACKING_GZIP
                    : binary   ? SNOW_PACKING_NONE
                               : SNOW_PACKING_TEXT;
    memcpy(header->file, f->value[DATA], sizeof header->file);
    return SNOW_STATUS_OK;
}

/* Exact names only: guessing a type would mean guessing the size of a voxel.
 * MetaIO has a second name for values of several channels. */
static snow_type type_named(const char *name) {
    for (size_t i = 0; i < TYPE_COUNT; i++) {
        const size_t length = strlen(types[i].name);
        if (!strncmp(name, types[i].name, length) &&
            (!name[length] || !strcmp(name + length, "_ARRAY")))
            return types[i].type;
    }
    return SNOW_TYPE_NONE;
}

/* The type comes before the sizes, whose product in bytes needs it. */
static snow_status interpret(const fields *f, metaimage_header *header) {
    if (*f->key[OBJECT_TYPE] && strcmp(f->value[OBJECT_TYPE], "Image") != 0)
        return fail_value(f, OBJECT_TYPE, "Image; only images are volumes");
    header->info = snow_volume_info_default("metaimage");
    header->info.type = type_named(f->value[TYPE]);
    if (!*f->key[TYPE])
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "the header has no ElementType; add it");
    if (header->info.type == SNOW_TYPE_NONE)
        return fail_value(f, TYPE, "one of MET_CHAR to MET_DOUBLE");
    SNOW_TRY(read_sizes(f, header));
    SNOW_TRY(read_geometry(f, header));
    SNOW_TRY(read_layout(f, header));
    SNOW_TRY(read_number(f, SLOPE, &header->info.slope));
    SNOW_TRY(read_number(f, INTERCEPT, &header->info.intercept));
    return snow_volume_info_check(f->context, &header->info);
}

/* The fields need about 80 KiB, too much for the stack of a caller's thread. */
snow_status metaimage_read_header(snow_source *source, metaimage_header *out) {
    snow_context *context = snow_source_context(source);
    fields *f = snow_allocate_clear(context, sizeof *f);
    if (!f)
        return SNOW_STATUS_NO_MEMORY;
    f->context = context;
    metaimage_header header = {0};
    snow_status status = read_fields(source, f);
    if (status == SNOW_STATUS_OK)
        status = interpret(f, &header);
    snow_release(context, f);
    if (status == SNOW_STATUS_OK)
        *out = header;
    return status;
}
