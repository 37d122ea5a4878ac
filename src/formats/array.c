/* formats/array.c - reads arrays of voxels with regular strides.
 *
 * Axes are sorted by their strides in the file, so that the source is read once
 * from front to back.  Adjacent axes are joined.  Voxels that are stored in the
 * order of memory are read directly into place; all others pass through a
 * buffer. */
#include "formats/array.h"
#include "formats/ascii.h"

#include <string.h>

#define BUFFER_BYTES ((uint64_t)4 << 20)

/* Reading this many extra bytes costs less than a seek. */
#define GAP_BYTES ((uint64_t)8192)

/* An axis: its count, and its strides in the file and in memory. */
typedef struct walk {
    uint64_t count, from, to;
} walk;

typedef struct array_reader {
    snow_source *source;
    const snow_array *array;
    size_t size;    /* bytes of a stored value */
    size_t wide;    /* bytes of a voxel in memory */
    uint64_t first; /* offset of the first voxel in the box */
    uint64_t at;    /* bytes of the array read so far */
    walk axis[3];   /* the shortest stride in the file first */
    unsigned char *voxels;
    unsigned char *buffer;
    uint64_t room; /* size of the buffer in bytes */
} array_reader;

size_t snow_coding_size(snow_coding coding, snow_type type) {
    return coding == SNOW_CODING_HALF   ? 2
           : coding == SNOW_CODING_BOOL ? 1
                                        : snow_type_size(type);
}

bool snow_array_steps(const int64_t *sizes, int rank, uint64_t value,
                      uint64_t *steps, uint64_t *all) {
    uint64_t bytes = value;
    for (int i = 0; i < rank; i++) {
        steps[i] = bytes;
        if (sizes[i] < 1 || !snow_mul_u64(bytes, (uint64_t)sizes[i], &bytes) ||
            bytes > (uint64_t)INT64_MAX)
            return false;
    }
    *all = bytes;
    return true;
}

void snow_array_of_volumes(const snow_volume_info *info, uint64_t skip,
                           snow_array *array) {
    const int64_t sizes[4] = {info->dims[0], info->dims[1], info->dims[2],
                              info->times};
    uint64_t steps[4] = {0};
    if (!snow_array_steps(sizes, 4, snow_coding_size(array->coding, info->type),
                          steps, &array->all) ||
        !snow_add_u64(skip, array->all, &array->all))
        array->all = UINT64_MAX;
    memcpy(array->step, steps, sizeof array->step);
    array->first = skip + (uint64_t)info->time * steps[3];
}

void snow_array_place(const snow_axes *roles, const uint64_t *steps,
                      int64_t channel, const snow_volume_info *info,
                      snow_array *array) {
    for (int i = 0; i < 3; i++)
        array->step[i] = roles->space[i] < 0 ? 0 : steps[roles->space[i]];
    if (roles->time >= 0)
        array->first += (uint64_t)info->time * steps[roles->time];
    if (roles->channel >= 0)
        array->first += (uint64_t)channel * steps[roles->channel];
}

bool snow_array_of_grid(snow_type type, const int64_t dims[3], int64_t channels,
                        int64_t channel, uint64_t begin, snow_array *out) {
    const int64_t sizes[4] = {channels, dims[0], dims[1], dims[2]};
    const size_t size = snow_type_size(type);
    uint64_t steps[4], all;
    if (!snow_array_steps(sizes, 4, size, steps, &all) ||
        !snow_add_u64(all, begin, &out->all))
        return false;
    memcpy(out->step, steps + 1, sizeof out->step);
    out->first = begin + (uint64_t)channel * size;
    return true;
}

/* Ten bits of fraction, five of exponent; a float can hold every value. */
float snow_half_to_float(uint16_t half) {
    uint32_t sign = (uint32_t)(half & 0x8000) << 16;
    uint32_t exponent = half >> 10 & 31, fraction = half & 1023;
    uint32_t bits;
    float value;
    if (exponent == 0) { /* 0 or subnormal: fraction * 2^-24 */
        value = (float)fraction * 0x1p-24F;
        return sign ? -value : value;
    }
    if (exponent == 31)
        bits = sign | 0x7f800000U | fraction << 13;
    else
        bits = sign | (exponent + 112) << 23 | fraction << 13;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Skips to a byte of the array, which is never before the current one. */
static snow_status go_to(array_reader *reader, uint64_t byte) {
    snow_source_plan(reader->source, 0);
    SNOW_TRY(snow_source_skip(reader->source, byte - reader->at, "the voxels"));
    reader->at = byte;
    return SNOW_STATUS_OK;
}

static snow_status read_bytes(array_reader *reader, void *to, uint64_t bytes) {
    snow_source_plan(reader->source, bytes);
    SNOW_TRY(
        snow_source_read_all(reader->source, to, (size_t)bytes, "the voxels"));
    reader->at += bytes;
    return SNOW_STATUS_OK;
}

/* Copies `count` values from strides `from` to strides `to`. */
static void put_plain(const unsigned char *in, uint64_t from,
                      unsigned char *out, uint64_t to, uint64_t count,
                      size_t size) {
    switch (size) {
#define PUT(bytes)                                      \
    case bytes:                                         \
        for (uint64_t i = 0; i < count; i++)            \
            memcpy(out + i * to, in + i * from, bytes); \
        break;
        PUT(1)
        PUT(2)
        PUT(4)
        PUT(8)
#undef PUT
    default:
        break;
    }
}

static void put_half(const unsigned char *in, uint64_t from, bool big_endian,
                     unsigned char *out, uint64_t to, uint64_t count) {
    for (uint64_t i = 0; i < count; i++) {
        const unsigned char *at = in + i * from;
        float value = snow_half_to_float(
            (uint16_t)(big_endian ? at[0] << 8 | at[1] : at[1] << 8 | at[0]));
        memcpy(out + i * to, &value, sizeof value);
    }
}

void snow_coding_put(snow_coding coding, bool big_endian, size_t size,
                     const unsigned char *from, uint64_t step,
                     unsigned char *to, uint64_t to_step, uint64_t count) {
    switch (coding) {
    case SNOW_CODING_PLAIN:
        put_plain(from, step, to, to_step, count, size);
        break;
    case SNOW_CODING_HALF:
        put_half(from, step, big_endian, to, to_step, count);
        break;
    case SNOW_CODING_BOOL:
        for (uint64_t i = 0; i < count; i++)
            to[i * to_step] = from[i * step] != 0;
        break;
    }
}

/* Copies a block from the front of the buffer to `out`; the innermost loop
 * follows memory, so that whole cache lines are written. */
static void put_block(const array_reader *reader, const walk block[3],
                      unsigned char *out) {
    int inner = 0;
    for (int a = 1; a < 3; a++)
        if (block[a].count > 1 &&
            (block[inner].count == 1 || block[a].to < block[inner].to))
            inner = a;
    const walk *x = &block[inner];
    const walk *y = &block[inner == 0 ? 1 : 0];
    const walk *z = &block[inner == 2 ? 1 : 2];
    for (uint64_t k = 0; k < z->count; k++)
        for (uint64_t j = 0; j < y->count; j++) {
            const unsigned char *from =
                reader->buffer + k * z->from + j * y->from;
            unsigned char *to = out + k * z->to + j * y->to;
            snow_coding_put(reader->array->coding, reader->array->big_endian,
                            reader->size, from, x->from, to, x->to, x->count);
        }
}

/* Bytes from the first value of a block to the end of the last. */
static uint64_t span_of(const array_reader *reader, const walk block[3]) {
    uint64_t span = reader->size;
    for (int a = 0; a < 3; a++)
        span += (block[a].count - 1) * block[a].from;
    return span;
}

/* The number of entries of an axis that fit the buffer, at least 1, if one has
 * `span` bytes.  Gaps that are wide, and wider than the entries, are
 * skipped. */
static uint64_t fitting(const array_reader *reader, const walk *axis,
                        uint64_t span) {
    if (axis->count == 1 || axis->from > reader->room || span > reader->room ||
        (axis->from > GAP_BYTES && axis->from / 2 > span))
        return 1;
    uint64_t most = (reader->room - span) / axis->from + 1;
    return most < axis->count ? most : axis->count;
}

/* Plans the largest block that fits the buffer: an axis is included if all
 * faster axes fit completely. */
static void plan_block(const array_reader *reader, walk block[3]) {
    bool whole = true;
    for (int a = 0; a < 3; a++) {
        block[a] = reader->axis[a];
        block[a].count = 1;
    }
    for (int a = 0; a < 3 && whole; a++) {
        block[a].count =
            fitting(reader, &reader->axis[a], span_of(reader, block));
        whole = block[a].count == reader->axis[a].count;
    }
}

/* Reads block after block; blocks at the ends may be smaller. */
static snow_status read_through_buffer(array_reader *reader) {
    walk block[3], some[3];
    plan_block(reader, block);
    const walk *axis = reader->axis;
    uint64_t i[3];
    for (i[2] = 0; i[2] < axis[2].count; i[2] += block[2].count)
        for (i[1] = 0; i[1] < axis[1].count; i[1] += block[1].count)
            for (i[0] = 0; i[0] < axis[0].count; i[0] += block[0].count) {
                uint64_t from = reader->first, to = 0;
                for (int a = 0; a < 3; a++) {
                    some[a] = block[a];
                    if (some[a].count > axis[a].count - i[a])
                        some[a].count = axis[a].count - i[a];
                    from += i[a] * axis[a].from;
                    to += i[a] * axis[a].to;
                }
                SNOW_TRY(go_to(reader, from));
                SNOW_TRY(
                    read_bytes(reader, reader->buffer, span_of(reader, some)));
                put_block(reader, some, reader->voxels + to);
            }
    return SNOW_STATUS_OK;
}

/* Reads rows that are stored as in memory, skipping what lies between. */
static snow_status read_rows(array_reader *reader) {
    const walk *axis = reader->axis;
    for (uint64_t k = 0; k < axis[2].count; k++)
        for (uint64_t j = 0; j < axis[1].count; j++) {
            SNOW_TRY(go_to(reader, reader->first + k * axis[2].from +
                                       j * axis[1].from));
            SNOW_TRY(read_bytes(
                reader, reader->voxels + k * axis[2].to + j * axis[1].to,
                axis[0].count * reader->size));
        }
    return SNOW_STATUS_OK;
}

/* Joins two axes if the second continues, in file and memory, where the first
 * ends. */
static void join_axes(array_reader *reader) {
    walk *low = reader->axis;
    for (int a = 1; a < 3; a++) {
        const walk high = reader->axis[a];
        reader->axis[a].count = 1;
        if (high.count == 1)
            continue;
        if (high.from == low->count * low->from &&
            high.to == low->count * low->to)
            low->count *= high.count;
        else
            *++low = high;
    }
}

/* Sorts the axes by their strides in the file; those of one voxel come last,
 * whatever their stride. */
static void sort_axes(array_reader *reader, const int64_t dims[3]) {
    uint64_t to = reader->wide;
    walk *axis = reader->axis;
    for (int a = 0; a < 3; a++) {
        const walk next = {(uint64_t)dims[a], reader->array->step[a], to};
        int at = a;
        to *= (uint64_t)dims[a];
        while (at && next.count > 1 &&
               (axis[at - 1].count == 1 || axis[at - 1].from > next.from)) {
            axis[at] = axis[at - 1];
            at--;
        }
        axis[at] = next;
    }
}

static snow_status read_voxels(array_reader *reader) {
    snow_context *context = snow_source_context(reader->source);
    join_axes(reader);
    const walk *row = reader->axis;
    if (reader->array->coding == SNOW_CODING_PLAIN && row->to == reader->wide &&
        (row->count == 1 || row->from == reader->size))
        return read_rows(reader);
    uint64_t all = span_of(reader, reader->axis);
    reader->room = all < BUFFER_BYTES ? all : BUFFER_BYTES;
    reader->buffer = snow_allocate_array(context, reader->room, 1);
    if (!reader->buffer)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = read_through_buffer(reader);
    snow_release(context, reader->buffer);
    return status;
}

/* True if the voxels are stored as in memory, without gaps. */
static bool is_natural(const snow_array *array, const snow_region *region) {
    uint64_t step = region->value;
    for (int i = 0; i < 3; i++) {
        if (array->step[i] != step && region->dims[i] > 1)
            return false;
        step *= (uint64_t)region->dims[i];
    }
    return array->coding == SNOW_CODING_PLAIN;
}

/* Half floats get their byte order while they are converted. */
static snow_status read_values(snow_source *source, const snow_array *array,
                               uint64_t first, snow_volume *volume) {
    array_reader reader = {
        .source = source,
        .array = array,
        .first = first,
        .size = snow_coding_size(array->coding, volume->info.type),
        .wide = snow_type_size(volume->info.type),
        .voxels = volume->owned};
    sort_axes(&reader, volume->info.dims);
    SNOW_TRY(read_voxels(&reader));
    SNOW_TRY(go_to(&reader, array->all));
    snow_source_plan(source, UINT64_MAX);
    return SNOW_STATUS_OK;
}

/* A box is an array too, with a later beginning and gaps. */
snow_status snow_array_read(snow_source *source,
                            const snow_volume_options *options,
                            const snow_array *array, snow_volume_info *info,
                            snow_volume **out) {
    snow_context *context = snow_source_context(source);
    snow_region region;
    snow_volume *volume;
    SNOW_TRY(snow_region_lay_out(context, options, info, &region));
    SNOW_TRY(snow_source_expect(source, array->all, "the voxels"));
    if (!out)
        return SNOW_STATUS_OK;
    uint64_t first = array->first;
    for (int i = 0; i < 3; i++)
        first += (uint64_t)region.first[i] * array->step[i];
    SNOW_TRY(snow_volume_new(context, info, &volume));
    snow_status status;
    if (is_natural(array, &region)) {
        region.before = array->first;
        const snow_file_part part = {&region, 0, array->all};
        status = snow_file_part_read(source, &part, volume->owned);
    } else {
        status = read_values(source, array, first, volume);
    }
    if (status == SNOW_STATUS_OK && !array->more)
        status = snow_source_finish(source);
    if (status == SNOW_STATUS_OK && array->coding == SNOW_CODING_PLAIN)
        snow_volume_order_bytes(volume, array->big_endian);
    return snow_volume_give(status, volume, out);
}

snow_status snow_array_take(snow_context *context,
                            const snow_volume_options *options,
                            const snow_array *array, const void *bytes,
                            snow_volume_info *info, snow_volume **out) {
    snow_region region;
    SNOW_TRY(snow_region_lay_out(context, options, info, &region));
    if (!out)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_new(context, info, out));
    const size_t size = (size_t)region.value;
    const uint64_t *step = array->step, row = (uint64_t)region.count[0];
    const unsigned char *first = (const unsigned char *)bytes + array->first +
                                 (uint64_t)region.first[0] * step[0];
    unsigned char *to = (*out)->owned;
    for (int64_t z = region.first[2]; z < region.first[2] + region.count[2];
         z++)
        for (int64_t y = region.first[1]; y < region.first[1] + region.count[1];
             y++) {
            put_plain(first + (uint64_t)z * step[2] + (uint64_t)y * step[1],
                      step[0], to, size, row, size);
            to += row * size;
        }
    return SNOW_STATUS_OK;
}

/* A number needs at least a digit and a blank.  Of several channels all numbers
 * are read, and the box of one is kept. */
snow_status snow_array_read_text(snow_source *source,
                                 const snow_volume_options *options,
                                 int64_t channels, int64_t channel,
                                 snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    const int64_t *dims = info->dims;
    const int64_t sizes[4] = {channels, dims[0], dims[1], dims[2]};
    const size_t size = snow_type_size(info->type);
    snow_volume_info box = *info;
    snow_array array = {.first = (uint64_t)channel * size};
    snow_region region;
    snow_volume *volume;
    uint64_t steps[4] = {0};
    if (!snow_array_steps(sizes, 4, size, steps, &array.all))
        array.all = INT64_MAX; /* what is read refuses it */
    memcpy(array.step, steps + 1, sizeof array.step);
    SNOW_TRY(snow_region_lay_out(context, options, &box, &region));
    SNOW_TRY(
        snow_source_expect(source, 2 * (array.all / size) - 1, "the voxels"));
    if (channels == 1 || !out)
        *info = box;
    if (!out)
        return SNOW_STATUS_OK;
    if (channels == 1) {
        const snow_file_part all = {&region, 0, region.all};
        SNOW_TRY(snow_volume_new(context, info, &volume));
        return snow_volume_give(
            snow_read_numbers(source, info->type, false, &all, volume->owned),
            volume, out);
    }
    const snow_region whole = snow_array_flat(array.all, size);
    const snow_file_part all = {&whole, 0, whole.all};
    unsigned char *numbers = snow_allocate_array(context, whole.all, 1);
    if (!numbers)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status =
        snow_read_numbers(source, info->type, false, &all, numbers);
    if (status == SNOW_STATUS_OK)
        status = snow_array_take(context, options, &array, numbers, info, out);
    snow_release(context, numbers);
    return status;
}
