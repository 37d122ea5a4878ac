/* formats/nrrd/data.c - reads the bytes of an NRRD array from where the header
 * places them.
 *
 * Lines are skipped before decompression, bytes after it; a byte skip of -1
 * means that the data are the last bytes.  The size of every file is checked
 * before the voxels are allocated. */
#include "formats/ascii.h"
#include "formats/nrrd/nrrd.h"

#include <string.h>

#define MOST_NAME_BYTES 4096

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
static snow_status refuse_other_format(snow_source *source) {
    unsigned char bytes[SNOW_PEEK_BYTES];
    size_t got;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &got));
    const snow_format *format = snow_format_of_bytes(bytes, got);
    if (!format)
        return SNOW_STATUS_OK;
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "%s: is a %s file with a header of its own; add \"byte "
                     "skip: -1\" to the NRRD header to skip that",
                     snow_source_name(source), format->name);
}

/* Moves to the first byte of a file's data, or to where reading begins if data
 * at the end cannot be found without reading (*at_end).  Checks that the file
 * can hold `size` bytes. */
static snow_status go_to_data(snow_source *source, const nrrd_header *header,
                              bool attached, uint64_t size, bool *at_end) {
    *at_end = false;
    SNOW_TRY(skip_lines(source, header->line_skip));
    SNOW_TRY(snow_nrrd_unpack(source, header->encoding));
    if (header->encoding ==
        NRRD_ASCII) /* at least a digit and a separator each */
        size = 2 * (size / snow_type_size(header->type)) - 1;
    if (!attached && !header->line_skip && !header->byte_skip)
        SNOW_TRY(refuse_other_format(source));
    if (header->byte_skip >= 0) {
        SNOW_TRY(snow_source_skip(source, (uint64_t)header->byte_skip,
                                  "the skipped bytes"));
        return snow_source_expect(source, size, "the voxels");
    }
    SNOW_TRY(snow_source_expect(source, size, "the voxels"));
    int64_t remaining = snow_source_remaining(source);
    *at_end = remaining < 0;
    if (*at_end)
        return SNOW_STATUS_OK;
    return snow_source_skip(source, (uint64_t)remaining - size, "the voxels");
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
static snow_status read_part(snow_source *source, const nrrd_header *header,
                             const snow_file_part *part, bool at_end,
                             void *voxels) {
    if (header->encoding == NRRD_ASCII)
        SNOW_TRY(snow_read_numbers(source, header->type, true, part, voxels));
    else if (at_end)
        SNOW_TRY(read_last_bytes(source, part, voxels));
    else
        SNOW_TRY(snow_file_part_read(source, part, voxels));
    return snow_source_finish(source);
}

/* Reads data that are contiguous in one file. */
static snow_status read_single(snow_source *source, const nrrd_header *header,
                               bool attached, const snow_volume_info *info,
                               const snow_region *region, snow_volume **out) {
    bool at_end;
    const snow_file_part all = {region, 0, region->all};
    SNOW_TRY(go_to_data(source, header, attached, region->all, &at_end));
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(snow_source_context(source), info, &volume));
    snow_status status = read_part(source, header, &all, at_end, volume->owned);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(volume);
        return status;
    }
    *out = volume;
    return SNOW_STATUS_OK;
}

/* Only the files with parts of the box are opened, from that of its first voxel
 * to that of its last: a pattern may stand for 2^60 files.  Names in a list are
 * sequential, so there the walk begins with the first.
 *
 * Opens each file and checks its size; with `voxels` reads it too.  The first
 * of two passes makes sure that all files exist before memory is allocated. */
static snow_status walk_files(snow_source *source, const nrrd_header *header,
                              const nrrd_files *files,
                              const snow_region *region, void *voxels) {
    char name[MOST_NAME_BYTES];
    const char *at = NULL;
    uint64_t piece = region->all / files->count, begin, last, end;
    snow_region_run(region, 0, &begin, &end);
    snow_region_run(region, snow_region_runs(region) - 1, &last, &end);
    uint64_t first = files->place == NRRD_LIST ? 0 : begin / piece;
    for (uint64_t i = first; i <= (end - 1) / piece; i++) {
        const snow_file_part part = {region, i * piece, (i + 1) * piece};
        SNOW_TRY(snow_nrrd_file_name(snow_source_context(source), files, i, &at,
                                     name, sizeof name));
        if (!snow_file_part_wanted(&part))
            continue;
        snow_source *file;
        bool at_end;
        SNOW_TRY(snow_source_open_sibling_as_is(source, name, &file));
        snow_status status = go_to_data(file, header, false, piece, &at_end);
        if (status == SNOW_STATUS_OK && voxels)
            status = read_part(file, header, &part, at_end, voxels);
        snow_source_close(file);
        SNOW_TRY(status);
    }
    return SNOW_STATUS_OK;
}

/* A file may be removed or truncated between the two passes; the second then
 * fails like the first. */
static snow_status read_files(snow_source *source, const nrrd_header *header,
                              const nrrd_files *files,
                              const snow_volume_info *info,
                              const snow_region *region, snow_volume **out) {
    SNOW_TRY(walk_files(source, header, files, region, NULL));
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(snow_source_context(source), info, &volume));
    snow_status status =
        walk_files(source, header, files, region, volume->owned);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(volume);
        return status;
    }
    *out = volume;
    return SNOW_STATUS_OK;
}

/* Without decompression: the header says whether the file is compressed, not
 * its first bytes, which may be voxels. */
static snow_status read_sibling(snow_source *source, const nrrd_header *header,
                                const nrrd_files *files,
                                const snow_volume_info *info,
                                const snow_region *region, snow_volume **out) {
    snow_source *file;
    SNOW_TRY(snow_source_open_sibling_as_is(source, files->name, &file));
    snow_status status = read_single(file, header, false, info, region, out);
    snow_source_close(file);
    return status;
}

/* Values that lie apart in text or in several files, or behind a place that is
 * found at the end: all are read. */
static snow_status read_apart(snow_source *source, const nrrd_header *header,
                              const nrrd_files *files,
                              const snow_volume_options *options,
                              const snow_array *values, snow_volume_info *info,
                              snow_volume **out) {
    snow_context *context = snow_source_context(source);
    const size_t size = snow_type_size(info->type);
    const int64_t count = (int64_t)(values->all / size);
    snow_volume_info flat = snow_volume_info_default("nrrd");
    const snow_region region = {.all = values->all,
                                .value = size,
                                .dims = {count, 1, 1},
                                .count = {count, 1, 1}};
    snow_volume *all;
    flat.type = info->type;
    flat.dims[0] = count;
    if (!out) {
        SNOW_TRY(snow_nrrd_check_data(source, header, files, &region));
        return snow_array_take(context, options, values, NULL, info, NULL);
    }
    SNOW_TRY(snow_nrrd_read_data(source, header, files, &flat, &region, &all));
    snow_status status =
        snow_array_take(context, options, values, all->voxels, info, out);
    snow_volume_close(all);
    return status;
}

snow_status snow_nrrd_read_values(snow_source *source,
                                  const nrrd_header *header,
                                  const nrrd_files *files,
                                  const snow_volume_options *options,
                                  const snow_array *values,
                                  snow_volume_info *info, snow_volume **out) {
    const bool attached = files->place == NRRD_ATTACHED;
    bool at_end;
    if (header->encoding == NRRD_ASCII || files->place > NRRD_SINGLE ||
        header->byte_skip < 0)
        return read_apart(source, header, files, options, values, info, out);
    if (!attached)
        SNOW_TRY(snow_source_open_sibling_as_is(source, files->name, &source));
    snow_status status =
        go_to_data(source, header, attached, values->all, &at_end);
    if (status == SNOW_STATUS_OK)
        status = snow_array_read(source, options, values, info, out);
    if (!attached)
        snow_source_close(source);
    return status;
}

snow_status snow_nrrd_check_data(snow_source *source, const nrrd_header *header,
                                 const nrrd_files *files,
                                 const snow_region *region) {
    bool at_end;
    if (files->place != NRRD_ATTACHED)
        return SNOW_STATUS_OK;
    return go_to_data(source, header, true, region->all, &at_end);
}

/* Bytes are swapped once at the end, however many files they came from. */
snow_status snow_nrrd_read_data(snow_source *source, const nrrd_header *header,
                                const nrrd_files *files,
                                const snow_volume_info *info,
                                const snow_region *region, snow_volume **out) {
    snow_volume *volume;
    if (files->place == NRRD_ATTACHED)
        SNOW_TRY(read_single(source, header, true, info, region, &volume));
    else if (files->place == NRRD_SINGLE)
        SNOW_TRY(read_sibling(source, header, files, info, region, &volume));
    else
        SNOW_TRY(read_files(source, header, files, info, region, &volume));
    if (header->encoding != NRRD_ASCII)
        snow_volume_order_bytes(volume, header->big_endian);
    *out = volume;
    return SNOW_STATUS_OK;
}
