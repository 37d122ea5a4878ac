/* formats/vtk/vti_data.c - reads the numbers of an array in a VTI file.
 *
 *     ascii       decimal numbers
 *     binary      base64 of: bytes that follow, those bytes
 *     appended    '_' and then, at the array's offset, the same, base64 or not
 *     compressed  number of blocks, bytes of a whole one, of a last part or 0,
 *                 compressed bytes of each, in base64 of its own; then the
 *                 blocks
 *
 * All counts have 4 or 8 bytes, according to the file's header_type. */
#include "formats/bytes/number.h"
#include "formats/vtk/vti.h"
#include "io/filters/filters.h"

/* Reads a count that stands before the data. */
static snow_status take_count(snow_source *source, const vti_header *header,
                              uint64_t *out) {
    unsigned char bytes[8];
    int size = header->count_bytes;
    SNOW_TRY(snow_source_read_all(source, bytes, (size_t)size,
                                  "the size of the voxels"));
    *out = snow_number_at(bytes, size, header->big_endian);
    return SNOW_STATUS_OK;
}

static snow_status fail_size(snow_source *source, uint64_t has,
                             uint64_t needed) {
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "its array has %llu bytes but the voxels need %llu; the "
                     "file is damaged, or its extent or type are wrong",
                     (unsigned long long)has, (unsigned long long)needed);
}

/* Reads the sizes of the blocks, which the caller releases. */
static snow_status take_sizes(snow_source *source, const vti_header *header,
                              snow_blocks *blocks, uint64_t *packed) {
    uint64_t bytes;
    if (!snow_mul_u64(blocks->count, (uint64_t)header->count_bytes, &bytes))
        bytes = UINT64_MAX;
    SNOW_TRY(snow_source_expect(source, bytes, "the sizes of the blocks"));
    blocks->packed = snow_allocate_array(snow_source_context(source),
                                         blocks->count, sizeof(uint64_t));
    if (!blocks->packed)
        return SNOW_STATUS_NO_MEMORY;
    *packed = 0;
    for (uint64_t i = 0; i < blocks->count; i++) {
        SNOW_TRY(take_count(source, header, &blocks->packed[i]));
        if (!snow_add_u64(*packed, blocks->packed[i], packed))
            *packed = UINT64_MAX;
    }
    return SNOW_STATUS_OK;
}

/* From here on the source delivers decompressed bytes. */
static snow_status unpack(snow_source *source, const vti_header *header) {
    uint64_t packed = 0;
    snow_blocks blocks = {.unpack = header->unpack};
    SNOW_TRY(take_count(source, header, &blocks.count));
    SNOW_TRY(take_count(source, header, &blocks.whole));
    SNOW_TRY(take_count(source, header, &blocks.last));
    if (!blocks.count || !blocks.whole)
        return fail_size(source, 0, 1);
    if (!blocks.last)
        blocks.last = blocks.whole;
    snow_status status = take_sizes(source, header, &blocks, &packed);
    if (status == SNOW_STATUS_OK)
        status = snow_source_promise(source, packed, "the voxels");
    if (status == SNOW_STATUS_OK)
        status = snow_source_unpack_blocks(source, &blocks);
    if (status != SNOW_STATUS_OK)
        snow_release(snow_source_context(source), blocks.packed);
    return status;
}

/* Moves to the array among the appended data, which begin after a '_'. */
static snow_status find_appended(snow_source *source,
                                 const vti_header *header) {
    char c = ' ';
    while (c == ' ' || c == '\t' || c == '\r' || c == '\n')
        SNOW_TRY(snow_source_read_all(source, &c, 1, "the voxels"));
    if (c != '_')
        return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                         "its appended data do not begin with \"_\"; write "
                         "the file again");
    return snow_source_skip(source, header->offset, "the voxels");
}

snow_status snow_vti_begin_numbers(snow_source *source,
                                   const vti_header *header, uint64_t needed) {
    if (header->form != VTI_APPENDED || !header->raw)
        SNOW_TRY(snow_source_unpack_base64(source));
    uint64_t has;
    if (header->packed) {
        SNOW_TRY(unpack(source, header));
        has = (uint64_t)snow_source_remaining(source);
    } else {
        SNOW_TRY(take_count(source, header, &has));
        if (has == needed)
            SNOW_TRY(snow_source_promise(source, has, "the voxels"));
    }
    return has == needed ? SNOW_STATUS_OK : fail_size(source, has, needed);
}

/* The array's numbers, which the source stands before. */
typedef struct vti_numbers {
    snow_source *source;
    const vti_header *header;
    int64_t channel;
    snow_array array;
} vti_numbers;

static snow_status read_numbers(void *user, const snow_volume_options *options,
                                snow_volume_info *info, snow_volume **out) {
    const vti_numbers *n = user;
    return n->header->form == VTI_ASCII
               ? snow_array_read_text(n->source, options,
                                      n->header->array.channels, n->channel,
                                      info, out)
               : snow_array_read(n->source, options, &n->array, info, out);
}

snow_status snow_vti_read_data(snow_source *source, const vti_header *header,
                               const snow_volume_options *options,
                               int64_t channel, snow_volume_info *info,
                               snow_volume **out) {
    vti_numbers n = {.source = source, .header = header, .channel = channel};
    n.array = (snow_array){.big_endian = header->big_endian, .more = true};
    if (!snow_array_of_grid(info->type, header->grid.uneven.count,
                            header->array.channels, channel, 0, &n.array))
        return snow_fail(
            snow_source_context(source), SNOW_STATUS_BAD_INPUT,
            "its extent is too large for any file; write it again");
    if (header->form == VTI_APPENDED)
        SNOW_TRY(find_appended(source, header));
    if (header->form != VTI_ASCII)
        SNOW_TRY(snow_vti_begin_numbers(source, header, n.array.all));
    return snow_uneven_read(snow_source_context(source), &header->grid.uneven,
                            options, read_numbers, &n, info, out);
}
