/* formats/metaimage/metaimage.c - MetaImage volumes: .mha, and .mhd with data
 * elsewhere.
 *
 * The voxels follow the header (LOCAL), or are in a file, or in several: LIST
 * and their names, one per line, or a pattern with first number, last and step.
 * Each file of several holds some of the axes; the parts follow one another in
 * memory as the files do in the list. */
#include "formats/metaimage/metaimage.h"
#include "formats/array.h"
#include "formats/ascii.h"
#include "formats/write.h"
#include "io/lookup.h"

#include <stdio.h>
#include <string.h>

/* More files than any folder has, but few enough that sums of their numbers do
 * not overflow. */
#define MOST_FILES INT64_C(1000000000)

/* A series of files that hold the volume. */
typedef struct series {
    int64_t count;      /* number of files, for all time steps */
    uint64_t bytes;     /* voxels in each */
    int64_t first, end; /* the files that hold parts of the box */
} series;

/* The box of the volume, its header, and the header's source. */
typedef struct reading {
    snow_source *source;
    const metaimage_header *header;
    const snow_volume_info *info; /* describes the box */
    snow_region region;
} reading;

/* Moves the source to the voxels and checks that it can hold `bytes` of them,
 * as binary. */
static snow_status begin_part(snow_source *source,
                              const metaimage_header *header, uint64_t bytes) {
    uint64_t skip = (uint64_t)header->header_size;
    if (header->header_size < 0) {
        int64_t remaining = snow_source_remaining(source);
        if (remaining < 0)
            return snow_fail(
                snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                "HeaderSize = -1 counts from the end, which is unknown in a "
                "compressed file or pipe; decompress it");
        SNOW_TRY(snow_source_expect(source, bytes, "the voxels"));
        skip = (uint64_t)remaining - bytes;
    }
    SNOW_TRY(snow_source_skip(source, skip, "what HeaderSize counts"));
    if (header->compressed)
        SNOW_TRY(snow_source_unpack(source));
    uint64_t least = bytes;
    if (header->text) /* a digit and a blank for each but the last */
        least = 2 * (least / snow_type_size(header->info.type)) - 1;
    return snow_source_expect(source, least, "the voxels");
}

/* Reads the voxels of the box and verifies the rest. */
static snow_status read_part(snow_source *source,
                             const metaimage_header *header,
                             const snow_file_part *part, void *voxels) {
    if (header->text)
        SNOW_TRY(
            snow_read_numbers(source, header->info.type, false, part, voxels));
    else
        SNOW_TRY(snow_file_part_read(source, part, voxels));
    return snow_source_finish(source);
}

/* Reads one file with all voxels, with or without the header. */
static snow_status read_whole(snow_source *source, const reading *r,
                              snow_volume **out) {
    const snow_file_part all = {&r->region, 0, r->region.all};
    SNOW_TRY(begin_part(source, r->header, r->region.all));
    SNOW_TRY(snow_volume_new(snow_source_context(source), r->info, out));
    return read_part(source, r->header, &all, (*out)->owned);
}

/* Opens a data file; the header says whether its contents are compressed. */
static snow_status open_data(snow_source *source,
                             const metaimage_header *header, const char *name,
                             snow_source **out) {
    return header->compressed
               ? snow_source_open_sibling_as_is(source, name, out)
               : snow_source_open_sibling(source, name, out);
}

/* Reads file `index` of a series into its place; the first makes the volume,
 * since only then it is known to exist. */
static snow_status read_member(const reading *r, const char *name,
                               const series *files, int64_t index,
                               snow_volume **out) {
    snow_source *data;
    uint64_t begin = (uint64_t)index * files->bytes;
    const snow_file_part part = {&r->region, begin, begin + files->bytes};
    if (!snow_file_part_wanted(&part))
        return SNOW_STATUS_OK;
    SNOW_TRY(open_data(r->source, r->header, name, &data));
    snow_status status = begin_part(data, r->header, files->bytes);
    if (status == SNOW_STATUS_OK && !*out)
        status = snow_volume_new(snow_source_context(data), r->info, out);
    if (status == SNOW_STATUS_OK)
        status = read_part(data, r->header, &part, (*out)->owned);
    snow_source_close(data);
    return status;
}

/* For files that each hold the first `axes` axes. */
static snow_status plan_series(const reading *r, int axes, series *out) {
    const metaimage_header *header = r->header;
    snow_context *context = snow_source_context(r->source);
    if (axes < 1 || axes > 3 || axes > header->axes)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "a LIST of files with %d axes each does not make %d "
                         "axes; correct ElementDataFile",
                         axes, header->axes);
    out->bytes = (uint64_t)header->channels * snow_type_size(header->info.type);
    out->count = 1;
    for (int i = 0; i < 4; i++) {
        if (i < axes)
            out->bytes *= (uint64_t)header->dims[i];
        else
            out->count *= header->dims[i];
    }
    uint64_t begin, end, last;
    snow_region_run(&r->region, 0, &begin, &end);
    snow_region_run(&r->region, snow_region_runs(&r->region) - 1, &last, &end);
    out->first = (int64_t)(begin / out->bytes);
    out->end = (int64_t)((end - 1) / out->bytes) + 1;
    return SNOW_STATUS_OK;
}

/* "LIST", "LIST 2" or "LIST 2D": the number of axes in each file, by default
 * all but the last. */
static snow_status read_list(const reading *r, snow_volume **out) {
    snow_source *source = r->source;
    const metaimage_header *header = r->header;
    snow_context *context = snow_source_context(source);
    int axes = header->axes - 1;
    series files;
    sscanf(header->data, "%*s %1d", &axes);
    SNOW_TRY(plan_series(r, axes, &files));
    /* A name needs at least a letter and a line end. */
    SNOW_TRY(snow_source_expect(source, 2 * (uint64_t)files.count - 1,
                                "the names of the files"));
    for (int64_t i = 0; i < files.count;) {
        char line[METAIMAGE_VALUE_BYTES];
        bool got;
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        if (!got)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "lists %lld of the %lld files that its sizes "
                             "need; add the others",
                             (long long)i, (long long)files.count);
        size_t length = strlen(line);
        while (length && (line[length - 1] == ' ' || line[length - 1] == '\t'))
            line[--length] = 0;
        const char *name = line + strspn(line, " \t");
        if (!*name)
            continue;
        if (i >= files.first && i < files.end)
            SNOW_TRY(read_member(r, name, &files, i, out));
        i++;
    }
    return snow_source_finish(source);
}

/* Writes the name of file `number` of a pattern such as slice%03d.raw.  Only
 * one %d, %i or %u with a width is supported: a name in a file must not become
 * a printf format.  Returns false for any other pattern. */
static bool name_of(const char *pattern, int64_t number, char *name,
                    size_t capacity) {
    const char *mark = strchr(pattern, '%');
    const char *at = mark ? mark + 1 : NULL;
    if (!mark || strchr(at, '%'))
        return false;
    bool zeros = *at == '0';
    int width = 0;
    for (; *at >= '0' && *at <= '9' && width < 100; at++)
        width = 10 * width + (*at - '0');
    if (width > 32 || !strchr("diu", *at ? *at : 'x'))
        return false;
    int used = snprintf(name, capacity, zeros ? "%.*s%0*lld%s" : "%.*s%*lld%s",
                        (int)(mark - pattern), pattern, width,
                        (long long)number, at + 1);
    return used > 0 && (size_t)used < capacity;
}

/* "pattern first last step"; by default first is 1, last follows from the
 * sizes, and step is 1. */
static snow_status read_pattern(const reading *r, snow_volume **out) {
    const metaimage_header *header = r->header;
    snow_context *context = snow_source_context(r->source);
    char pattern[METAIMAGE_VALUE_BYTES], name[METAIMAGE_VALUE_BYTES + 64];
    long long first = 1, last = 0, step = 1;
    series files;
    SNOW_TRY(plan_series(r, header->axes - 1, &files));
    int words = sscanf(header->data, "%1023s %18lld %18lld %18lld", pattern,
                       &first, &last, &step);
    bool possible = words >= 1 && files.count <= MOST_FILES;
    if (possible && words < 3)
        last = first + files.count - 1;
    if (!possible || step < 1 || last < first ||
        (last - first) / step + 1 != files.count ||
        !name_of(pattern, first + (files.count - 1) * step, name, sizeof name))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "\"%.60s\" does not name %lld files; give a pattern "
                         "like slice%%03d.raw with first number, last and "
                         "step",
                         header->data, (long long)files.count);
    /* Refuses a series whose last file is missing or too small, before memory
     * is allocated for all. */
    snow_source *data;
    SNOW_TRY(open_data(r->source, r->header, name, &data));
    snow_status status = begin_part(data, r->header, files.bytes);
    snow_source_close(data);
    SNOW_TRY(status);
    for (int64_t i = files.first; i < files.end; i++) {
        if (!name_of(pattern, first + i * step, name, sizeof name))
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "the names of the files are too long");
        SNOW_TRY(read_member(r, name, &files, i, out));
    }
    return SNOW_STATUS_OK;
}

/* Opens a name in the header: a path relative to the header's folder, or an
 * absolute one. */
static snow_status open_detached(const reading *r, snow_source **out) {
    snow_source *source = r->source;
    const metaimage_header *header = r->header;
    snow_status status = open_data(source, header, header->data, out);
    /* The name of a file, as far as the header has it. */
    if (status == SNOW_STATUS_BAD_INPUT && *header->data &&
        !strncmp("LOCAL", header->data, strlen(header->data))) {
        snow_lookup_begin(snow_source_context(source)); /* this says more */
        return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                         "its data file \"%s\" cannot be opened; the header "
                         "may be truncated within LOCAL",
                         header->data);
    }
    return status;
}

static snow_status read_detached(const reading *r, snow_volume **out) {
    snow_source *data;
    SNOW_TRY(open_detached(r, &data));
    snow_status status = read_whole(data, r, out);
    snow_source_close(data);
    return status;
}

/* True for the word in capitals, or with small letters after the first. */
static bool is_word(const char *text, const char *word, const char *also) {
    size_t length = strcspn(text, " \t");
    return (strlen(word) == length && memcmp(text, word, length) == 0) ||
           strcmp(text, also) == 0;
}

static bool is_local(const metaimage_header *header) {
    return is_word(header->data, "LOCAL", "Local") ||
           is_word(header->data, "local", "local");
}

/* ElementDataFile's special words, which have priority over a file of that name
 * ("./LOCAL" still opens one). */
static bool is_series(const metaimage_header *header) {
    return is_word(header->data, "LIST", "List") || strchr(header->data, '%');
}

static snow_status read_data(const reading *r, snow_volume **out) {
    const char *data = r->header->data;
    if (is_local(r->header))
        return read_whole(r->source, r, out);
    if (is_word(data, "LIST", "List"))
        return read_list(r, out);
    return strchr(data, '%') ? read_pattern(r, out) : read_detached(r, out);
}

/* One of several values of each voxel, in one file of binary data. */
static snow_status read_channel(const reading *r,
                                const snow_volume_options *options,
                                const snow_array *array, snow_volume_info *info,
                                snow_volume **out) {
    const bool local = is_local(r->header);
    snow_source *data = r->source;
    if (!local && !out)
        return snow_array_take(snow_source_context(data), options, array, NULL,
                               info, NULL);
    if (!local)
        SNOW_TRY(open_detached(r, &data));
    snow_status status = begin_part(data, r->header, array->all);
    if (status == SNOW_STATUS_OK)
        status = snow_array_read(data, options, array, info, out);
    if (!local)
        snow_source_close(data);
    return status;
}

/* The same of text and of several files, all of whose values are read. */
static snow_status read_all_channels(reading *r,
                                     const snow_volume_options *options,
                                     const snow_array *array,
                                     snow_volume_info *info,
                                     snow_volume **out) {
    snow_context *context = snow_source_context(r->source);
    const size_t size = snow_type_size(info->type);
    const int64_t count = (int64_t)(array->all / size);
    snow_volume_info flat = snow_volume_info_default("metaimage");
    snow_volume *all = NULL;
    if (!out)
        return snow_array_take(context, options, array, NULL, info, NULL);
    flat.type = info->type;
    flat.dims[0] = count;
    r->info = &flat;
    r->region = (snow_region){.all = array->all,
                              .value = size,
                              .dims = {count, 1, 1},
                              .count = {count, 1, 1}};
    snow_status status = read_data(r, &all);
    if (status == SNOW_STATUS_OK && !r->header->text)
        snow_volume_order_bytes(all, r->header->big_endian);
    if (status == SNOW_STATUS_OK)
        status =
            snow_array_take(context, options, array, all->voxels, info, out);
    snow_volume_close(all);
    return status;
}

static snow_status read_channels(reading *r, const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out) {
    const metaimage_header *header = r->header;
    const int64_t *dims = header->dims, count = header->channels;
    const int64_t sizes[5] = {count, dims[0], dims[1], dims[2], dims[3]};
    snow_array array = {.big_endian = header->big_endian};
    uint64_t steps[5];
    int64_t channel;
    SNOW_TRY(snow_volume_pick_value(
        snow_source_context(r->source), options, count,
        info->type == SNOW_TYPE_UINT8 && (count == 3 || count == 4), info,
        &channel));
    /* The header's sizes were checked. */
    (void)snow_array_steps(sizes, 5, snow_type_size(info->type), steps,
                           &array.all);
    memcpy(array.step, steps + 1, sizeof array.step);
    array.first =
        (uint64_t)channel * steps[0] + (uint64_t)info->time * steps[4];
    return header->text || (!is_local(header) && is_series(header))
               ? read_all_channels(r, options, &array, info, out)
               : read_channel(r, options, &array, info, out);
}

/* Bytes are swapped once at the end, however the voxels were read. */
static snow_status read_metaimage(snow_source *source,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    metaimage_header header;
    reading r = {.source = source, .header = &header, .info = info};
    SNOW_TRY(metaimage_read_header(source, &header));
    *info = header.info;
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    if (header.channels > 1)
        return read_channels(&r, options, info, out);
    SNOW_TRY(snow_region_lay_out(context, options, info, &r.region));
    if (!out)
        return is_local(&header) ? begin_part(source, &header, r.region.all)
                                 : SNOW_STATUS_OK;
    snow_volume *volume = NULL;
    snow_status status = read_data(&r, &volume);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(volume);
        return status;
    }
    if (!header.text)
        snow_volume_order_bytes(volume, header.big_endian);
    *out = volume;
    return SNOW_STATUS_OK;
}

const snow_format snow_format_metaimage = {
    .name = "metaimage",
    .text = "MetaImage (.mha, .mhd with .raw or .zraw)",
    .suffixes = {".mha", ".mhd", ".mha.gz"},
    .probe = metaimage_probe,
    .crops = true,
    .channels = true,
    .read = read_metaimage,
    .write = snow_metaimage_write,
};
