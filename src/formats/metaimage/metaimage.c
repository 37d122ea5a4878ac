/* formats/metaimage/metaimage.c - MetaImage volumes: .mha, and .mhd with data
 * elsewhere.
 *
 * The voxels follow the header (LOCAL), or are in a file, or in several: LIST
 * and their names, one per line, or a pattern with first number, last and step.
 * Each file of several holds some of the axes; the parts follow one another in
 * memory as the files do in the list. */
#include "formats/metaimage/metaimage.h"
#include "formats/write.h"

#include <stdio.h>
#include <string.h>

/* More files than any folder has, but few enough that sums of their numbers do
 * not overflow. */
#define MOST_FILES INT64_C(1000000000)

/* The names of a list must not take more memory than this. */
#define MOST_LIST_BYTES ((size_t)16 << 20)

/* For files that each hold the first `axes` axes. */
static snow_status count_files(snow_context *context, int axes,
                               metaimage_header *header) {
    if (axes < 1 || axes > 3 || axes > header->axes)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "a LIST of files with %d axes each does not make %d "
                         "axes; correct ElementDataFile",
                         axes, header->axes);
    for (int i = axes; i < 4; i++)
        header->data.count *= (uint64_t)header->dims[i];
    return SNOW_STATUS_OK;
}

/* "LIST", "LIST 2" or "LIST 2D": the number of axes in each file, by default
 * all but the last. */
static snow_status read_list(snow_source *source, metaimage_header *header,
                             char **names) {
    snow_context *context = snow_source_context(source);
    const uint64_t *count = &header->data.count;
    int axes = header->axes - 1;
    size_t used = 0;
    sscanf(header->file, "%*s %1d", &axes);
    SNOW_TRY(count_files(context, axes, header));
    /* A name needs at least a letter and a line end. */
    SNOW_TRY(
        snow_source_expect(source, 2 * *count - 1, "the names of the files"));
    for (uint64_t i = 0; i < *count;) {
        char line[METAIMAGE_VALUE_BYTES];
        bool got;
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        if (!got || used > MOST_LIST_BYTES)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             got ? "lists %llu of %llu files, whose names have "
                                   "more than 16 MiB; give a pattern"
                                 : "lists %llu of the %llu files that its "
                                   "sizes need; add the others",
                             (unsigned long long)i, (unsigned long long)*count);
        size_t length = strlen(line);
        while (length && (line[length - 1] == ' ' || line[length - 1] == '\t'))
            line[--length] = 0;
        const char *name = line + strspn(line, " \t");
        if (!*name)
            continue;
        length = strlen(name) + 1;
        SNOW_TRY(SNOW_RESERVE(context, *names, used, used + length));
        memcpy(*names + used, name, length);
        used += length;
        i++;
    }
    header->data.place = SNOW_DATA_LIST;
    header->data.name = *names;
    return snow_source_finish(source);
}

/* "pattern first last step"; by default first is 1, last follows from the
 * sizes, and step is 1. */
static snow_status read_pattern(snow_context *context,
                                metaimage_header *header) {
    snow_detached *data = &header->data;
    char name[METAIMAGE_VALUE_BYTES + 64];
    long long first = 1, last = 0, step = 1;
    SNOW_TRY(count_files(context, header->axes - 1, header));
    int words =
        sscanf(header->file, "%*s %18lld %18lld %18lld", &first, &last, &step);
    const bool possible = data->count <= (uint64_t)MOST_FILES;
    const int64_t count = possible ? (int64_t)data->count : 0;
    if (possible && words < 2)
        last = first + count - 1;
    data->place = SNOW_DATA_PATTERN;
    data->name = header->file;
    data->name_bytes = strcspn(header->file, " \t");
    data->first = first;
    data->step = step;
    if (possible && step >= 1 && last >= first &&
        (last - first) / step + 1 == count &&
        snow_detached_name(data->name, data->name_bytes,
                           first + (count - 1) * step, name, sizeof name))
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "\"%.60s\" does not name %llu files; give a pattern like "
                     "slice%%03d.raw with first number, last and step",
                     header->file, (unsigned long long)data->count);
}

/* Returns whether the text begins with the word in capitals, or is it with
 * small letters after the first. */
static bool is_word(const char *text, const char *word, const char *also) {
    size_t length = strcspn(text, " \t");
    return (strlen(word) == length && memcmp(text, word, length) == 0) ||
           strcmp(text, also) == 0;
}

/* ElementDataFile's special words have priority over a file of that name
 * ("./LOCAL" still opens one). */
static snow_status find_files(snow_source *source, metaimage_header *header,
                              char **names) {
    const char *file = header->file;
    bool is_there = true;
    if (is_word(file, "LOCAL", "Local") || is_word(file, "local", "local"))
        return SNOW_STATUS_OK;
    if (is_word(file, "LIST", "List"))
        return read_list(source, header, names);
    if (strchr(file, '%'))
        return read_pattern(snow_source_context(source), header);
    header->data.place = SNOW_DATA_SINGLE;
    header->data.name = file;
    if (*file && !strncmp("LOCAL", file, strlen(file))) {
        is_there = snow_source_has_siblings(source);
        if (is_there)
            SNOW_TRY(snow_source_look_for_sibling(source, file, &is_there));
    }
    if (is_there)
        return SNOW_STATUS_OK;
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "its data file \"%s\" cannot be opened; the header may be "
                     "truncated within LOCAL",
                     file);
}

/* One of several values of each voxel. */
static snow_status pick_channel(snow_context *context,
                                const metaimage_header *header,
                                const snow_volume_options *options,
                                snow_volume_info *info, snow_array *out) {
    const int64_t *dims = header->dims, count = header->channels;
    const int64_t sizes[5] = {count, dims[0], dims[1], dims[2], dims[3]};
    uint64_t steps[5];
    int64_t channel;
    SNOW_TRY(snow_volume_pick_value(context, options, count,
                                    info->type == SNOW_TYPE_UINT8 &&
                                        (count == 3 || count == 4),
                                    info, &channel));
    /* The header's sizes were checked. */
    (void)snow_array_steps(sizes, 5, snow_type_size(info->type), steps,
                           &out->all);
    memcpy(out->step, steps + 1, sizeof out->step);
    out->first = (uint64_t)channel * steps[0] + (uint64_t)info->time * steps[4];
    out->big_endian = header->data.big_endian;
    return SNOW_STATUS_OK;
}

static snow_status read_metaimage(snow_source *source,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    metaimage_header header;
    snow_array values = {.all = 0};
    char *names = NULL;
    SNOW_TRY(metaimage_read_header(source, &header));
    *info = header.info;
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    if (header.channels > 1)
        SNOW_TRY(pick_channel(context, &header, options, info, &values));
    snow_status status = find_files(source, &header, &names);
    if (status == SNOW_STATUS_OK)
        status = snow_detached_read(source, &header.data, options, &values,
                                    info, out);
    snow_release(context, names);
    return status;
}

/* --- writing, with header and voxels in one ------------------------------- */

static void append_line(char *text, size_t capacity, const char *key,
                        const double *values, int count) {
    snow_append(text, capacity, "%s = ", key);
    snow_append_numbers(text, capacity, values, count, " ");
    snow_append(text, capacity, "\n");
}

/* The world is converted from RAS+ to MetaImage's LPS.  Directions and spacings
 * are written separately, so their products may differ in the last bit. */
static void append_geometry(char *text, size_t capacity,
                            const snow_volume_info *info) {
    const double(*m)[4] = info->matrix;
    const double origin[3] = {-m[0][3], -m[1][3], m[2][3]};
    double directions[9]; /* of length 1, one for each index axis */
    for (int k = 0; k < 9; k++)
        directions[k] =
            (k % 3 < 2 ? -1 : 1) * m[k % 3][k / 3] / info->spacing[k / 3];
    append_line(text, capacity, "TransformMatrix", directions, 9);
    append_line(text, capacity, "Offset", origin, 3);
    append_line(text, capacity, "ElementSpacing", info->spacing, 3);
    /* A missing unit counts as mm. */
    if (strcmp(info->unit, "um") == 0 || strcmp(info->unit, "cm") == 0)
        snow_append(text, capacity, "DistanceUnits = %s\n", info->unit);
    /* Without this key the directions would make it a patient. */
    if (!info->medical)
        snow_append(text, capacity, "AnatomicalOrientation = ???\n");
}

static snow_status write_metaimage(const snow_volume *volume, const char *path,
                                   snow_writer *writer) {
    (void)path;
    static const char *const units[] = {"um", "mm", "cm", NULL};
    const snow_volume_info of_units = snow_write_in_units(&volume->info, units),
                           *info = &of_units;
    char text[2048] = "ObjectType = Image\n"
                      "NDims = 3\n"
                      "BinaryData = True\n"
                      "BinaryDataByteOrderMSB = False\n"
                      "CompressedData = False\n";
    append_geometry(text, sizeof text, info);
    if (info->slope != 1 || info->intercept != 0) {
        append_line(text, sizeof text, "ElementToIntensityFunctionSlope",
                    &info->slope, 1);
        append_line(text, sizeof text, "ElementToIntensityFunctionOffset",
                    &info->intercept, 1);
    }
    snow_append(text, sizeof text,
                "DimSize = %lld %lld %lld\n"
                "ElementType = %s\n"
                "ElementDataFile = LOCAL\n",
                (long long)info->dims[0], (long long)info->dims[1],
                (long long)info->dims[2], metaimage_type_name(info->type));
    SNOW_TRY(snow_writer_write(writer, text, strlen(text)));
    return snow_write_voxels(volume, writer);
}

const snow_format snow_format_metaimage = {
    .name = "metaimage",
    .text = "MetaImage (.mha, .mhd with .raw or .zraw)",
    .suffixes = {".mha", ".mhd", ".mha.gz"},
    .probe = metaimage_probe,
    .crops = true,
    .channels = true,
    .read = read_metaimage,
    .write = SNOW_WRITER(write_metaimage),
};
