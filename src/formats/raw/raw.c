/* formats/raw/raw.c - raw voxels without a header, described by the user.
 *
 * Missing options are taken from the file's name, where archives of volumes put
 * them: engine_256x256x110_uint8.raw, head_64x64x93_u16le.raw.gz.  For a file
 * of the wrong size messages list dims and types that hold just its bytes. */
#include "formats/opening.h"
#include "formats/write.h"
#include "io/folder.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Capacity for what list_fitting writes: four times three numbers of 19 digits
 * and types. */
#define ADVICE_BYTES 512

/* What separates the words of a name. */
#define BETWEEN "_.- "

/* --- what a name says ----------------------------------------------------- */

/* Parses a word "256x256x110". */
static bool parse_dims(const char *word, size_t length, int64_t dims[3]) {
    int64_t found[3];
    const char *at = word, *end = word + length;
    for (int i = 0; i < 3; i++) {
        if (i && (at == end || *at++ != 'x'))
            return false;
        /* Nine digits cannot overflow; no volume has longer sides. */
        int digits = 0;
        for (found[i] = 0; digits < 9 && at < end; digits++, at++) {
            if (!isdigit((unsigned char)*at))
                break;
            found[i] = found[i] * 10 + (*at - '0');
        }
        if (!found[i])
            return false;
    }
    if (at != end)
        return false;
    memcpy(dims, found, sizeof found);
    return true;
}

/* Parses a type with or without byte order: "uint8", "u16be", "f32". */
static bool parse_type(const char *word, size_t length, snow_type *type,
                       snow_endian *endian) {
    static const char *const brief[][2] = {
        {"i8", "int8"},     {"u8", "uint8"},      {"i16", "int16"},
        {"u16", "uint16"},  {"i32", "int32"},     {"u32", "uint32"},
        {"i64", "int64"},   {"u64", "uint64"},    {"f32", "float32"},
        {"f64", "float64"}, {"s8", "int8"},       {"s16", "int16"},
        {"s32", "int32"},   {"ushort", "uint16"}, {"short", "int16"},
        {"uchar", "uint8"},
    };
    char text[16];
    if (length >= sizeof text)
        return false;
    for (size_t i = 0; i < length; i++)
        text[i] = (char)tolower((unsigned char)word[i]);
    text[length] = 0;
    snow_endian order = SNOW_ENDIAN_DEFAULT;
    if (snow_has_suffix(text, "be"))
        order = SNOW_ENDIAN_BIG;
    else if (snow_has_suffix(text, "le") && !snow_has_suffix(text, "double"))
        order = SNOW_ENDIAN_LITTLE;
    if (order)
        text[length - 2] = 0;
    const char *name = text;
    for (size_t i = 0; i < sizeof brief / sizeof *brief; i++)
        if (!strcmp(text, brief[i][0]))
            name = brief[i][1];
    if (!snow_type_from_name(name))
        return false;
    *type = snow_type_from_name(name);
    *endian = order;
    return true;
}

/* Fills missing options from the words of the name. */
static void read_name(snow_context *context, const char *path,
                      snow_volume_options *options) {
    snow_volume_options found = {0};
    for (const char *word = snow_path_name(path); *word;) {
        size_t length = strcspn(word, BETWEEN);
        if (!found.dims[0])
            parse_dims(word, length, found.dims);
        if (!found.type)
            parse_type(word, length, &found.type, &found.endian);
        word += length;
        word += strspn(word, BETWEEN);
    }
    bool dims = !options->dims[0] && found.dims[0];
    bool type = !options->type && found.type;
    if (dims)
        memcpy(options->dims, found.dims, sizeof found.dims);
    if (type)
        options->type = found.type;
    /* "u16be" gives the byte order even if the type is given, if it is the
     * same. */
    bool endian =
        !options->endian && found.endian && options->type == found.type;
    if (endian)
        options->endian = found.endian;
    if (options->dims[0] && options->type && (dims || type || endian)) {
        const char *kind = type ? "type" : endian ? "byte order" : "";
        snow_notify(
            context,
            "%s: read as %lldx%lldx%lld %s, %s endian; its name gives the "
            "%s%s%s",
            path, (long long)options->dims[0], (long long)options->dims[1],
            (long long)options->dims[2], snow_type_name(options->type),
            options->endian == SNOW_ENDIAN_BIG ? "big" : "little",
            dims ? "sizes" : "", dims && *kind ? " and the " : "", kind);
    }
}

/* --- what bytes may be ---------------------------------------------------- */

/* The most dims that are listed; more confuse. */
#define MOST_LISTED 4

typedef struct raw_advice {
    uint64_t bytes;
    char *out;
    size_t used, listed;
    int64_t last[3]; /* the dims that were listed last */
} raw_advice;

/* The usual types of sizes in bytes. */
static const char *const types_of[] = {
    [1] = "uint8 or int8",
    [2] = "uint16 or int16",
    [4] = "float32, int32 or uint32",
    [8] = "float64",
};

/* The product, 0 if it is too large. */
static uint64_t product(const int64_t dims[3]) {
    uint64_t count = 1;
    for (int i = 0; i < 3; i++)
        if (!snow_mul_u64(count, (uint64_t)dims[i], &count))
            return 0;
    return count;
}

/* Lists dims and type if they hold the bytes exactly; types are the usual ones
 * of the size if `type` is not given. */
static void list(raw_advice *a, const int64_t dims[3], uint64_t size,
                 snow_type type) {
    uint64_t count = product(dims), all;
    const char *types = type        ? snow_type_name(type)
                        : size <= 8 ? types_of[size]
                                    : NULL;
    if (!count || !types || !snow_mul_u64(count, size, &all) ||
        all != a->bytes || a->listed == MOST_LISTED ||
        memcmp(dims, a->last, sizeof a->last) == 0)
        return;
    memcpy(a->last, dims, sizeof a->last);
    int length = snprintf(
        a->out + a->used, ADVICE_BYTES - a->used, "%s%lldx%lldx%lld %s",
        a->listed++ ? ", " : "; what fits: ", (long long)dims[0],
        (long long)dims[1], (long long)dims[2], types);
    a->used += length > 0 ? (size_t)length : 0;
}

/* The dims with another type, and with another number of slices. */
static void list_by_dims(raw_advice *a, const int64_t dims[3], snow_type type) {
    uint64_t count = product(dims), slice;
    if (count && a->bytes % count == 0)
        list(a, dims, a->bytes / count, SNOW_TYPE_NONE);
    int64_t other[3] = {dims[0], dims[1], 1};
    slice = product(other) * (type ? snow_type_size(type) : 0);
    if (!slice || a->bytes % slice || a->bytes / slice > INT64_MAX)
        return;
    other[2] = (int64_t)(a->bytes / slice);
    list(a, other, snow_type_size(type), type);
}

/* Stacks of square slices of usual sides, not much longer than wide. */
static void list_squares(raw_advice *a, uint64_t size, snow_type type) {
    for (uint64_t side = 64; side <= 1024; side *= 2) {
        uint64_t slice = side * side * size, slices = a->bytes / slice;
        const int64_t dims[3] = {(int64_t)side, (int64_t)side, (int64_t)slices};
        if (slices >= side / 8 && slices < side)
            list(a, dims, size, type);
    }
}

/* Squares or cubes of the type, or of any. */
static void list_guesses(raw_advice *a, bool squares, snow_type type) {
    for (uint64_t size = 1; size <= 8; size *= 2) {
        if (type && snow_type_size(type) != size)
            continue;
        if (squares)
            list_squares(a, size, type);
        else {
            int64_t side = (int64_t)(cbrt((double)(a->bytes / size)) + 0.5);
            const int64_t dims[3] = {side, side, side};
            list(a, dims, size, type);
        }
    }
}

/* Writes which dims and types hold `bytes` bytes exactly, as a clause that
 * begins with "; ", or nothing.  `options` has what is known: dims or type may
 * be 0. */
static void list_fitting(uint64_t bytes, const snow_volume_options *options,
                         char out[ADVICE_BYTES]) {
    raw_advice a = {.bytes = bytes, .out = out};
    out[0] = 0;
    if (options->dims[0])
        list_by_dims(&a, options->dims, options->type);
    else
        list_guesses(&a, true, options->type);
    list_guesses(&a, false, options->type);
}

/* --- files ---------------------------------------------------------------- */

/* Sizes or the type are missing: the user forgot them if the file is meant as
 * raw data; otherwise no reader knows the file. */
static snow_status refuse_unspecified(snow_source *source,
                                      const snow_volume_options *options) {
    const char *name = snow_source_name(source);
    snow_context *context = snow_source_context(source);
    unsigned char bytes[SNOW_PEEK_BYTES];
    size_t size;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &size));
    const char *stranger = snow_stranger(bytes, size);
    if (stranger)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT, "%s", stranger);
    if (!options->dims[0] && !options->type && !options->endian &&
        !options->offset && !snow_has_suffix(name, ".raw") &&
        !snow_has_suffix(name, ".raw.gz"))
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "has an unknown format; if it is raw data, give --dims "
            "XxYxZ and --type (uint8, int16, float32, ...)");
    char length[40] = "", advice[ADVICE_BYTES];
    int64_t left = snow_source_remaining(source); /* -1: compressed */
    uint64_t here = left > 0 && options->offset < (uint64_t)left
                        ? (uint64_t)left - options->offset
                        : 0;
    if (left >= 0)
        snprintf(length, sizeof length, " of %lld bytes", (long long)left);
    list_fitting(here, options, advice);
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "is raw data%s; give --dims XxYxZ and --type (uint8, "
                     "int16, float32, ...)%s",
                     length, advice);
}

/* Refuses a file with too few bytes.  One with too many is read, and a note
 * says what else it may be (*noted); without such advice the end of the voxels
 * says that there are more. */
static snow_status check_size(snow_source *source,
                              const snow_volume_options *all,
                              const snow_volume_info *info, bool *noted) {
    char advice[ADVICE_BYTES];
    snow_context *context = snow_source_context(source);
    int64_t voxels, left = snow_source_remaining(source);
    uint64_t bytes;
    if (left < 0 || all->offset > (uint64_t)left ||
        !snow_volume_count(info->dims, info->type, &voxels, &bytes) ||
        (uint64_t)left - all->offset == bytes)
        return SNOW_STATUS_OK;
    uint64_t here = (uint64_t)left - all->offset;
    list_fitting(here, all, advice);
    if (here > bytes) {
        *noted = *advice != 0;
        if (*noted)
            snow_notify(context,
                        "%s: has %llu bytes where the voxels need %llu%s",
                        snow_source_name(source), (unsigned long long)here,
                        (unsigned long long)bytes, advice);
        return SNOW_STATUS_OK;
    }
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "has %llu bytes left where the voxels need %llu "
                     "(%lldx%lldx%lld %s); it is truncated, or its dims or "
                     "type are wrong%s",
                     (unsigned long long)here, (unsigned long long)bytes,
                     (long long)info->dims[0], (long long)info->dims[1],
                     (long long)info->dims[2], snow_type_name(info->type),
                     advice);
}

static snow_status read_raw(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    snow_volume_options all = *options;
    if (!all.dims[0] || !all.type || !all.endian)
        read_name(context, snow_source_name(source), &all);
    if (!all.dims[0] || !all.dims[1] || !all.dims[2] || !all.type)
        return refuse_unspecified(source, &all);
    /* Gzip data are decompressed by now, with unknown length.  A compressed
     * file whose first bytes are damaged would be shown as noise. */
    if (snow_has_suffix(snow_source_name(source), ".gz") &&
        snow_source_remaining(source) >= 0)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "is not gzip, although its name says so; get it again, or rename "
            "it if the voxels are not compressed");
    *info = snow_volume_info_default("raw");
    memcpy(info->dims, all.dims, sizeof info->dims);
    info->type = all.type;
    SNOW_TRY(snow_volume_pick_time(context, "time step", &all, info));
    bool noted = false;
    SNOW_TRY(check_size(source, &all, info, &noted));
    snow_warning_fn *warning = context->warning;
    if (noted) /* once is enough */
        context->warning = NULL;
    snow_status status = snow_volume_read(
        source, &all, all.endian == SNOW_ENDIAN_BIG, all.offset, info, out);
    context->warning = warning;
    return status;
}

/* A name alone cannot bring the voxels back: the warning gives the options that
 * do. */
static snow_status write_raw(const snow_volume *volume, const char *path,
                             snow_writer *writer) {
    const snow_volume_info *info = &volume->info;
    SNOW_TRY(snow_write_voxels(volume, writer));
    snow_notify(volume->context,
                "%s: raw data keep no sizes; open it with --dims "
                "%lldx%lldx%lld --type %s --spacing %gx%gx%g",
                path, (long long)info->dims[0], (long long)info->dims[1],
                (long long)info->dims[2], snow_type_name(info->type),
                info->spacing[0], info->spacing[1], info->spacing[2]);
    return SNOW_STATUS_OK;
}

/* No probe: any bytes can be raw data, so that it is never found, only left. */
const snow_format snow_format_raw = {
    .name = "raw",
    .text = "raw voxels, described by options (.raw, .raw.gz, any name)",
    .suffixes = {".raw", ".raw.gz", ".bin", ".bin.gz"},
    .crops = true,
    .read = read_raw,
    .write = SNOW_WRITER(write_raw),
};
