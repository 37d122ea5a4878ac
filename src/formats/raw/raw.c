/* formats/raw/raw.c - raw voxels without a header, described by the user.
 *
 * Missing options are taken from the file's name, where archives of volumes put
 * them: engine_256x256x110_uint8.raw, head_64x64x93_u16le.raw.gz. */
#include "formats/raw/raw.h"
#include "formats/unsupported.h"
#include "io/folder.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool snow_raw_parse_dims(const char *word, size_t length, int64_t dims[3]) {
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

bool snow_raw_parse_type(const char *word, size_t length, snow_type *type,
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
        size_t length = strcspn(word, RAW_BETWEEN);
        if (!found.dims[0])
            snow_raw_parse_dims(word, length, found.dims);
        if (!found.type)
            snow_raw_parse_type(word, length, &found.type, &found.endian);
        word += length;
        word += strspn(word, RAW_BETWEEN);
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
    char length[40] = "", advice[RAW_ADVICE_BYTES];
    int64_t left = snow_source_remaining(source); /* -1: compressed */
    uint64_t here = left > 0 && options->offset < (uint64_t)left
                        ? (uint64_t)left - options->offset
                        : 0;
    if (left >= 0)
        snprintf(length, sizeof length, " of %lld bytes", (long long)left);
    snow_raw_list_fitting(here, options, advice);
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
    char advice[RAW_ADVICE_BYTES];
    snow_context *context = snow_source_context(source);
    int64_t voxels, left = snow_source_remaining(source);
    uint64_t bytes;
    if (left < 0 || all->offset > (uint64_t)left ||
        !snow_volume_count(info->dims, info->type, &voxels, &bytes) ||
        (uint64_t)left - all->offset == bytes)
        return SNOW_STATUS_OK;
    uint64_t here = (uint64_t)left - all->offset;
    snow_raw_list_fitting(here, all, advice);
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

/* No probe: any bytes can be raw data, so that it is never found, only left. */
/* A name alone cannot bring the voxels back: the warning gives the options that
 * do.  A scaling is refused, since dropped it would change every value. */
static snow_status write_raw(const snow_volume *volume, const char *path,
                             snow_writer *writer) {
    const snow_volume_info *info = &volume->info;
    if (info->slope != 1 || info->intercept != 0)
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "%s: raw data cannot say slope %g and intercept %g; "
                         "write .nii or .mha",
                         path, info->slope, info->intercept);
    SNOW_TRY(snow_write_voxels(volume, writer));
    snow_notify(volume->context,
                "%s: raw data keep no sizes; open it with --dims "
                "%lldx%lldx%lld --type %s --spacing %gx%gx%g",
                path, (long long)info->dims[0], (long long)info->dims[1],
                (long long)info->dims[2], snow_type_name(info->type),
                info->spacing[0], info->spacing[1], info->spacing[2]);
    return SNOW_STATUS_OK;
}

const snow_format snow_format_raw = {
    .name = "raw",
    .text = "raw voxels, described by options (.raw, .raw.gz, any name)",
    .suffixes = {".raw", ".raw.gz", ".bin", ".bin.gz"},
    .crops = true,
    .read = read_raw,
    .write = write_raw,
};
