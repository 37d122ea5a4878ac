/* formats/detached/detached.c - reads the bytes of an array from where a header
 * of text places them.
 *
 * Lines are skipped before decompression, bytes after it; a byte skip of -1
 * means that the data are the last bytes.  The size of every file is checked
 * before the voxels are allocated. */
#include "formats/detached/detached.h"
#include "formats/ascii.h"
#include "formats/bytes/packed.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define MOST_NAME_BYTES 4096

/* --- encodings of binary data --------------------------------------------- */

typedef struct hex_filter {
    snow_filter_stage filter;
    int digits;    /* of a byte, so far */
    unsigned byte; /* their value */
} hex_filter;

static snow_status fail_hex(const hex_filter *hex, const char *what) {
    return snow_fail(hex->filter.context, SNOW_STATUS_BAD_INPUT,
                     "%s: its hexadecimal data %s; fetch or write it again",
                     hex->filter.name, what);
}

static snow_status pull_hex(snow_filter_stage *filter, void *bytes, size_t size,
                            size_t *got) {
    static const char digits[] = "0123456789abcdef";
    hex_filter *hex = (hex_filter *)filter;
    snow_filter_stage *below = filter->below;
    for (*got = 0; *got < size;) {
        SNOW_TRY(snow_filter_stage_fill(below, 1));
        if (below->begin == below->end)
            return hex->digits ? fail_hex(hex, "end within a byte")
                               : SNOW_STATUS_OK;
        const int letter = tolower(below->buffer[below->begin]);
        const char *digit = letter ? strchr(digits, letter) : NULL;
        if (!digit && !isspace(letter))
            return fail_hex(hex, "have a letter that is no digit");
        snow_filter_stage_drop(below, 1);
        if (!digit)
            continue;
        hex->byte = hex->byte << 4 | (unsigned)(digit - digits);
        if (++hex->digits == 2) {
            ((unsigned char *)bytes)[(*got)++] = (unsigned char)hex->byte;
            hex->digits = 0;
        }
    }
    return SNOW_STATUS_OK;
}

static uint64_t limit_hex(const snow_filter_stage *filter) {
    return snow_filter_stage_limit(filter->below) / 2 +
           (filter->end - filter->begin) + 1;
}

static snow_status open_hex(snow_filter_stage *below, snow_filter_stage **out) {
    hex_filter *hex = snow_filter_stage_over(below, sizeof *hex);
    if (!hex)
        return SNOW_STATUS_NO_MEMORY;
    hex->filter.pull = pull_hex;
    hex->filter.limit = limit_hex;
    *out = &hex->filter;
    return SNOW_STATUS_OK;
}

static snow_status begin_unpacking(snow_source *source, snow_packing packing) {
    return packing == SNOW_PACKING_GZIP    ? snow_source_unpack(source)
           : packing == SNOW_PACKING_BZIP2 ? snow_source_unpack_bzip2(source)
           : packing == SNOW_PACKING_HEX
               ? snow_source_unpack_by(source, open_hex)
               : SNOW_STATUS_OK;
}

/* --- one file ------------------------------------------------------------- */

/* Binary data may count as a line, so its length is not limited. */
static snow_status skip_lines(snow_source *source, uint64_t lines) {
    char bytes[SNOW_PEEK_BYTES];
    size_t got;
    while (lines) {
        SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &got));
        if (!got)
            return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                             "%s: has fewer lines than its header skips; "
                             "correct \"line skip\"",
                             snow_source_name(source));
        const char *end = memchr(bytes, '\n', got);
        if (end) {
            got = (size_t)(end - bytes) + 1;
            lines--;
        }
        SNOW_TRY(snow_source_skip(source, got, "the skipped lines"));
    }
    return SNOW_STATUS_OK;
}

/* Headers are often written by hand for data in another format, whose own
 * header would then be read as voxels. */
static snow_status refuse_other_format(snow_source *source,
                                       const snow_detached *data) {
    unsigned char bytes[SNOW_PEEK_BYTES];
    size_t got;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &got));
    const snow_format *format = data->find(bytes, got);
    return format
               ? snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                           "%s: is a %s file with a header of its own; %s",
                           snow_source_name(source), format->name, data->advice)
               : SNOW_STATUS_OK;
}

/* Moves to the first byte of a file's data, or to where reading begins if data
 * at the end cannot be found without reading (*at_end).  Checks that the file
 * can hold `size` bytes. */
static snow_status go_to_data(snow_source *source, const snow_detached *data,
                              uint64_t size, bool *at_end) {
    const uint64_t skip = data->byte_skip < 0 ? 0 : (uint64_t)data->byte_skip;
    *at_end = false;
    SNOW_TRY(skip_lines(source, data->line_skip));
    if (data->skips_packed)
        SNOW_TRY(snow_source_skip(source, skip, data->skip));
    SNOW_TRY(begin_unpacking(source, data->packing));
    if (data->packing == SNOW_PACKING_TEXT) /* a digit and a separator each */
        size = 2 * (size / snow_type_size(data->type)) - 1;
    if (data->place != SNOW_DATA_ATTACHED && data->find && !data->line_skip &&
        !data->byte_skip)
        SNOW_TRY(refuse_other_format(source, data));
    if (!data->skips_packed)
        SNOW_TRY(snow_source_skip(source, skip, data->skip));
    SNOW_TRY(snow_source_expect(source, size, "the voxels"));
    if (data->byte_skip >= 0)
        return SNOW_STATUS_OK;
    int64_t remaining = snow_source_remaining(source);
    *at_end = remaining < 0;
    return *at_end ? SNOW_STATUS_OK
                   : snow_source_skip(source, (uint64_t)remaining - size,
                                      "the voxels");
}

static void reverse(unsigned char *bytes, uint64_t count) {
    for (uint64_t i = 0; i < count / 2; i++) {
        unsigned char last = bytes[count - 1 - i];
        bytes[count - 1 - i] = bytes[i];
        bytes[i] = last;
    }
}

/* Reads to the end, keeping the last `size` bytes in a ring. */
static snow_status read_into_ring(snow_source *source, unsigned char *ring,
                                  uint64_t size) {
    uint64_t at = 0, total = 0;
    for (size_t got = 1; got;) {
        SNOW_TRY(
            snow_source_read(source, ring + at, (size_t)(size - at), &got));
        at = (at + got) % size;
        total += got;
    }
    if (total < size)
        return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                         "%s: has %llu bytes but the voxels need %llu; the "
                         "file is truncated, or its sizes or type are wrong",
                         snow_source_name(source), (unsigned long long)total,
                         (unsigned long long)size);
    /* The oldest byte is at `at`: rotate the ring to begin with it. */
    reverse(ring, at);
    reverse(ring + at, size - at);
    reverse(ring, size);
    return SNOW_STATUS_OK;
}

/* For a box or a time step among the last bytes: its position is known only at
 * the end, so all of them are kept until then. */
static snow_status read_last_bytes(snow_source *source,
                                   const snow_file_part *part, void *voxels) {
    uint64_t size = part->end - part->begin;
    if (snow_file_part_is_all(part))
        return read_into_ring(source, voxels, size);
    snow_context *context = snow_source_context(source);
    unsigned char *ring = snow_allocate_array(context, size, 1);
    if (!ring)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = read_into_ring(source, ring, size);
    if (status == SNOW_STATUS_OK)
        snow_file_part_copy(part, ring, voxels);
    snow_release(context, ring);
    return status;
}

/* Reads the part in one file, from where go_to_data left it. */
static snow_status read_part(snow_source *source, const snow_detached *data,
                             const snow_file_part *part, bool at_end,
                             void *voxels) {
    SNOW_TRY(
        data->packing == SNOW_PACKING_TEXT
            ? snow_read_numbers(source, data->type, data->commas, part, voxels)
        : at_end ? read_last_bytes(source, part, voxels)
                 : snow_file_part_read(source, part, voxels));
    return snow_source_finish(source);
}

/* Without decompression if the header says whether the file is compressed, not
 * its first bytes, which may be voxels. */
static snow_status open_data(snow_source *source, const snow_detached *data,
                             const char *name, snow_source **out) {
    return data->finds_gzip && data->packing != SNOW_PACKING_GZIP
               ? snow_source_open_sibling(source, name, out)
               : snow_source_open_sibling_as_is(source, name, out);
}

/* --- several files -------------------------------------------------------- */

/* The pattern is never used as a printf format: a name in a file could ask for
 * anything. */
bool snow_detached_name(const char *pattern, size_t length, int64_t number,
                        char *name, size_t size) {
    const char *mark = memchr(pattern, '%', length), *end = pattern + length;
    const char *at = mark ? mark + 1 : end;
    if (at == end || memchr(at, '%', (size_t)(end - at)))
        return false;
    const bool zeros = *at == '0';
    int width = 0;
    for (; at < end && *at >= '0' && *at <= '9' && width < 100; at++)
        width = 10 * width + (*at - '0');
    if (width >= 100 || at == end || !strchr("diu", *at))
        return false;
    int used = snprintf(name, size, zeros ? "%.*s%0*lld%.*s" : "%.*s%*lld%.*s",
                        (int)(mark - pattern), pattern, width,
                        (long long)number, (int)(end - at) - 1, at + 1);
    return used > 0 && (size_t)used < size;
}

/* The name of file `index` as a string; `*at`, NULL before the first call,
 * keeps the position in a list, whose files are requested in order. */
static snow_status name_of(snow_source *source, const snow_detached *data,
                           uint64_t index, const char **at, char *name) {
    /* The count was checked: first + index * step is in the range. */
    const int64_t number =
        (int64_t)((uint64_t)data->first + index * (uint64_t)data->step);
    const bool pattern = data->place == SNOW_DATA_PATTERN;
    if (!pattern)
        *at = *at ? *at + strlen(*at) + 1 : data->name;
    if (pattern ? snow_detached_name(data->name, data->name_bytes, number, name,
                                     MOST_NAME_BYTES)
                : snprintf(name, MOST_NAME_BYTES, "%s", *at) < MOST_NAME_BYTES)
        return SNOW_STATUS_OK;
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "the name of data file %llu is too long; correct the "
                     "header",
                     (unsigned long long)index);
}

/* Only the files with parts of the box are opened, from that of its first voxel
 * to that of its last: a pattern may stand for 2^60 files.  Names in a list are
 * sequential, so there the walk begins with the first.
 *
 * Opens each file and checks its size; with `voxels` reads it too.  The first
 * of two passes makes sure that all files exist before memory is allocated. */
static snow_status walk_files(snow_source *source, const snow_detached *data,
                              const snow_region *region, void *voxels) {
    char name[MOST_NAME_BYTES];
    const char *at = NULL;
    uint64_t piece = region->all / data->count, begin, last, end;
    snow_region_run(region, 0, &begin, &end);
    snow_region_run(region, snow_region_runs(region) - 1, &last, &end);
    uint64_t first = data->place == SNOW_DATA_LIST ? 0 : begin / piece;
    for (uint64_t i = first; i <= (end - 1) / piece; i++) {
        const snow_file_part part = {region, i * piece, (i + 1) * piece};
        SNOW_TRY(name_of(source, data, i, &at, name));
        if (!snow_file_part_wanted(&part))
            continue;
        snow_source *file;
        bool at_end;
        SNOW_TRY(open_data(source, data, name, &file));
        snow_status status = go_to_data(file, data, piece, &at_end);
        if (status == SNOW_STATUS_OK && voxels)
            status = read_part(file, data, &part, at_end, voxels);
        snow_source_close(file);
        SNOW_TRY(status);
    }
    return SNOW_STATUS_OK;
}

/* --- volumes -------------------------------------------------------------- */

/* A file may be removed or truncated between the two passes; the second then
 * fails like the first. */
static snow_status read_files(snow_source *source, const snow_detached *data,
                              const snow_volume_info *info,
                              const snow_region *region, snow_volume **out) {
    snow_volume *volume;
    SNOW_TRY(walk_files(source, data, region, NULL));
    SNOW_TRY(snow_volume_new(snow_source_context(source), info, &volume));
    return snow_volume_give(walk_files(source, data, region, volume->owned),
                            volume, out);
}

/* Reads data that are contiguous in one file. */
static snow_status read_single(snow_source *source, const snow_detached *data,
                               const snow_volume_info *info,
                               const snow_region *region, snow_volume **out) {
    const snow_file_part all = {region, 0, region->all};
    snow_volume *volume;
    bool at_end;
    SNOW_TRY(go_to_data(source, data, region->all, &at_end));
    SNOW_TRY(snow_volume_new(snow_source_context(source), info, &volume));
    return snow_volume_give(
        read_part(source, data, &all, at_end, volume->owned), volume, out);
}

/* Bytes are swapped once at the end, however many files they came from. */
static snow_status read_all(snow_source *source, const snow_detached *data,
                            const snow_volume_info *info,
                            const snow_region *region, snow_volume **out) {
    snow_source *file = source;
    if (data->place == SNOW_DATA_SINGLE)
        SNOW_TRY(open_data(source, data, data->name, &file));
    snow_status status = data->place > SNOW_DATA_SINGLE
                             ? read_files(source, data, info, region, out)
                             : read_single(file, data, info, region, out);
    if (file != source)
        snow_source_close(file);
    if (status == SNOW_STATUS_OK && data->packing != SNOW_PACKING_TEXT)
        snow_volume_order_bytes(*out, data->big_endian);
    return status;
}

/* Values that lie apart in text or in several files, or behind a place that is
 * found at the end: all are read. */
static snow_status read_apart(snow_source *source, const snow_detached *data,
                              const snow_volume_options *options,
                              const snow_array *values, snow_volume_info *info,
                              snow_volume **out) {
    const snow_region region =
        snow_array_flat(values->all, snow_type_size(info->type));
    snow_volume_info flat = snow_volume_info_default(info->format);
    snow_volume *all;
    flat.type = info->type;
    flat.dims[0] = region.dims[0];
    SNOW_TRY(read_all(source, data, &flat, &region, &all));
    snow_status status = snow_array_take(snow_source_context(source), options,
                                         values, all->voxels, info, out);
    snow_volume_close(all);
    return status;
}

static snow_status read_values(snow_source *source, const snow_detached *data,
                               const snow_volume_options *options,
                               const snow_array *values, snow_volume_info *info,
                               snow_volume **out) {
    snow_source *file = source;
    bool at_end;
    if (data->packing == SNOW_PACKING_TEXT || data->place > SNOW_DATA_SINGLE ||
        data->byte_skip < 0)
        return read_apart(source, data, options, values, info, out);
    if (data->place == SNOW_DATA_SINGLE)
        SNOW_TRY(open_data(source, data, data->name, &file));
    snow_status status = go_to_data(file, data, values->all, &at_end);
    if (status == SNOW_STATUS_OK)
        status = snow_array_read(file, options, values, info, out);
    if (file != source)
        snow_source_close(file);
    return status;
}

snow_status snow_detached_read(snow_source *source, const snow_detached *data,
                               const snow_volume_options *options,
                               const snow_array *values, snow_volume_info *info,
                               snow_volume **out) {
    snow_region region;
    bool at_end;
    if (values->all && out)
        return read_values(source, data, options, values, info, out);
    SNOW_TRY(snow_region_lay_out(snow_source_context(source), options, info,
                                 &region));
    if (out)
        return read_all(source, data, info, &region, out);
    return data->place == SNOW_DATA_ATTACHED
               ? go_to_data(source, data,
                            values->all ? values->all : region.all, &at_end)
               : SNOW_STATUS_OK;
}
