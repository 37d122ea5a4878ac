/* formats/nrrd/nrrd.c - the NRRD format; its parts are listed in
 * formats/nrrd/nrrd.h.
 *
 * The field "data file" has three forms:
 *
 *   data file: head.raw
 *   data file: slice_%03d.raw 1 113 1 [2]     numbers from, to, step
 *   data file: LIST [2]                       a name on each following line
 *
 * The last number, the subdimension, is the number of axes in one file, by
 * default one less than all.  The bytes of a file are always contiguous in the
 * whole array, so only the number of files has to be checked. */
#include "formats/nrrd/nrrd.h"
#include "formats/ascii.h"
#include "formats/write.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Accepts any version, so that a newer one is refused as such and not read as
 * raw data. */
static bool looks_nrrd(const unsigned char *bytes, size_t size) {
    return size >= 6 && !memcmp(bytes, "NRRD00", 6);
}

/* --- the files with the data ---------------------------------------------- */

#define MOST_NAME_BYTES 4096

/* The value is shortened in messages: a name may be as long as a line. */
static snow_status fail_data_file(const nrrd_text *text, const char *wrong) {
    return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                     "the header's field \"data file: %.60s\" %s; correct it",
                     snow_nrrd_value(text, NRRD_DATA_FILE), wrong);
}

/* Parses "pattern first last step [subdimension]"; returns false for a plain
 * name. */
static bool parse_pattern(const char *value, int64_t numbers[4], int *count,
                          snow_detached *out) {
    size_t length = strcspn(value, " \t");
    char name[MOST_NAME_BYTES];
    if (!snow_detached_name(value, length, 0, name, sizeof name))
        return false;
    out->name = value;
    out->name_bytes = length;
    const char *at = value + length;
    for (*count = 0; *count < 4; (*count)++)
        if (!snow_next_word(&at, name, sizeof name))
            break;
        else if (!snow_parse_int64(name, &numbers[*count]))
            return false;
    return *count >= 3 && !at[strspn(at, " \t")];
}

/* The number of values from first to last; 0 if the step does not lead
 * there. */
static uint64_t count_steps(int64_t first, int64_t last, int64_t step) {
    if (step > 0 && first <= last)
        return ((uint64_t)last - (uint64_t)first) / (uint64_t)step + 1;
    if (step < 0 && first >= last)
        return ((uint64_t)first - (uint64_t)last) / (0 - (uint64_t)step) + 1;
    return 0;
}

/* Each file spans the first `subdimension` axes, or, if that is all of them, a
 * slab of the last axis. */
static bool count_fits(const nrrd_header *header, int64_t subdimension,
                       uint64_t count) {
    int dimension = header->dimension;
    uint64_t pieces = 1;
    if (!count || subdimension < 1 || subdimension > dimension)
        return false;
    if (subdimension == dimension)
        return (uint64_t)header->axes[dimension - 1].size % count == 0;
    for (int i = (int)subdimension; i < dimension; i++)
        if (!snow_mul_u64(pieces, (uint64_t)header->axes[i].size, &pieces))
            return false;
    return pieces == count;
}

/* Tries a list, a pattern, a name, in this order: a file may be called "LIST"
 * only with a folder before it. */
static snow_status find_files(const nrrd_text *text, nrrd_header *header) {
    snow_detached *out = &header->data;
    const char *value = snow_nrrd_value(text, NRRD_DATA_FILE);
    int64_t numbers[4], subdimension = header->dimension - 1;
    int count;
    if (!value)
        return SNOW_STATUS_OK;
    bool list = !strncmp(value, "LIST", 4) &&
                (!value[4] || isspace((unsigned char)value[4]));
    if (list) {
        out->place = SNOW_DATA_LIST;
        out->count = text->listed;
        out->name = text->block + text->list;
        if (value[4] && !snow_parse_int64(value + 4, &subdimension))
            return fail_data_file(text, "has no subdimension behind LIST");
    } else if (parse_pattern(value, numbers, &count, out)) {
        out->place = SNOW_DATA_PATTERN;
        out->first = numbers[0];
        out->step = numbers[2];
        out->count = count_steps(numbers[0], numbers[1], numbers[2]);
        if (count == 4)
            subdimension = numbers[3];
    } else {
        out->place = SNOW_DATA_SINGLE;
        out->name = value;
        return SNOW_STATUS_OK;
    }
    if (!count_fits(header, subdimension, out->count))
        return fail_data_file(text,
                              "gives a number of files that does not fit the "
                              "sizes");
    return SNOW_STATUS_OK;
}

/* --- volumes -------------------------------------------------------------- */

/* Where no segment has a layer, as 3D Slicer wrote before 2020, each of several
 * volumes holds one segment, as 1. */
static snow_status set_labels(const nrrd_text *text,
                              const snow_volume_info *info,
                              snow_volume *volume) {
    const size_t count = text->segment_count;
    int64_t last = -1;
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
        if (text->segments[i].layer > last)
            last = text->segments[i].layer;
    const bool old = last < 0 && info->times == (int64_t)count && count > 1;
    snow_label *labels =
        snow_allocate_array(text->context, count, sizeof *labels);
    if (!labels)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const nrrd_segment *segment = &text->segments[i];
        if ((last > 0 && segment->layer != info->time && info->times > 1) ||
            (old && (int64_t)i != info->time))
            continue;
        labels[used] = segment->label;
        if (isnan(labels[used].value))
            labels[used].value = old ? 1 : (double)i + 1;
        used++;
    }
    snow_status status = snow_volume_set_labels(volume, labels, used);
    snow_release(text->context, labels);
    return status;
}

/* The whole header is checked before a data file is opened or the voxels are
 * allocated, so false sizes cost nothing. */
static snow_status read_parsed(snow_source *source, const nrrd_text *text,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    nrrd_header header;
    snow_array values;
    *info = snow_volume_info_default("nrrd");
    SNOW_TRY(snow_nrrd_parse_header(text, &header));
    SNOW_TRY(snow_nrrd_lay_out(&header, options, info, &values));
    const char *unit = snow_nrrd_value(text, NRRD_SAMPLE_UNITS);
    if (unit && sscanf(unit + (*unit == '"'), "%31[^\"]", info->value_unit) < 1)
        *info->value_unit = 0;
    SNOW_TRY(find_files(text, &header));
    snow_volume *volume = NULL;
    SNOW_TRY(snow_detached_read(source, &header.data, options, &values, info,
                                out ? &volume : NULL));
    return snow_volume_give(text->segments && volume
                                ? set_labels(text, info, volume)
                                : SNOW_STATUS_OK,
                            volume, out);
}

/* Owns the text, so that the early returns below leak nothing. */
static snow_status read_nrrd(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    nrrd_text text;
    snow_status status = snow_nrrd_read_text(source, &text);
    if (status == SNOW_STATUS_OK)
        status = read_parsed(source, &text, options, info, out);
    snow_release(snow_source_context(source), text.block);
    snow_release(snow_source_context(source), text.segments);
    return status;
}

/* --- writing, with header and raw voxels in one --------------------------- */

/* NRRD's names of the scalar types, which all its readers know. */
static const char *type_name(snow_type type) {
    return type == SNOW_TYPE_FLOAT32   ? "float"
           : type == SNOW_TYPE_FLOAT64 ? "double"
                                       : snow_type_name(type);
}

static void append_geometry(char *text, size_t capacity,
                            const snow_volume_info *info) {
    const char *unit = info->unit;
    snow_append(text, capacity, "space%s\nspace directions:",
                info->medical ? ": right-anterior-superior" : " dimension: 3");
    for (int j = 0; j < 4; j++) {
        const double vector[3] = {info->matrix[0][j], info->matrix[1][j],
                                  info->matrix[2][j]};
        snow_append(text, capacity, "%s", j < 3 ? " (" : "\nspace origin: (");
        snow_append_numbers(text, capacity, vector, 3, ",");
        snow_append(text, capacity, ")");
    }
    snow_append(text, capacity, "\n");
    if (*unit && !strpbrk(unit, "\"\\\r\n"))
        snow_append(text, capacity, "space units: \"%s\" \"%s\" \"%s\"\n", unit,
                    unit, unit);
}

/* The keys of 3D Slicer's segmentations, and one for opacity. */
static snow_status write_labels(const snow_volume *volume,
                                snow_writer *writer) {
    for (size_t n = 0; n < volume->label_count; n++) {
        const snow_label *label = &volume->labels[n];
        char text[512] = "";
        snow_append(text, sizeof text,
                    "Segment%zu_LabelValue:=%.17g\n"
                    "Segment%zu_Name:=%s\n",
                    n, label->value, n, label->name);
        if (label->color[0] >= 0) {
            snow_append(text, sizeof text, "Segment%zu_Color:=", n);
            snow_append_numbers(text, sizeof text, label->color, 3, " ");
            snow_append(text, sizeof text, "\n");
        }
        if (label->color[3] >= 0)
            snow_append(text, sizeof text, "Segment%zu_Opacity:=%.17g\n", n,
                        label->color[3]);
        SNOW_TRY(snow_writer_write(writer, text, strlen(text)));
    }
    return SNOW_STATUS_OK;
}

static snow_status write_nrrd(const snow_volume *volume, const char *path,
                              snow_writer *writer) {
    (void)path;
    const snow_volume_info *info = &volume->info;
    char text[2048] = "";
    snow_append(text, sizeof text,
                "NRRD0004\n"
                "type: %s\n"
                "dimension: 3\n"
                "sizes: %lld %lld %lld\n",
                type_name(info->type), (long long)info->dims[0],
                (long long)info->dims[1], (long long)info->dims[2]);
    append_geometry(text, sizeof text, info);
    snow_append(text, sizeof text,
                "kinds: domain domain domain\n"
                "encoding: raw\n"
                "%s%s%s%s",
                snow_type_size(info->type) > 1 ? "endian: little\n" : "",
                *info->value_unit ? "sample units: " : "", info->value_unit,
                *info->value_unit ? "\n" : "");
    SNOW_TRY(snow_writer_write(writer, text, strlen(text)));
    SNOW_TRY(write_labels(volume, writer));
    SNOW_TRY(snow_writer_write(writer, "\n", 1));
    return snow_write_voxels(volume, writer);
}

const snow_format snow_format_nrrd = {
    .name = "nrrd",
    .text = "NRRD, attached or detached, in all encodings (.nrrd, .nhdr)",
    .suffixes = {".nrrd", ".nhdr", ".nrrd.gz"},
    .probe = looks_nrrd,
    .crops = true,
    .channels = true,
    .read = read_nrrd,
    .write = SNOW_WRITER(write_nrrd),
};
