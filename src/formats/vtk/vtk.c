/* formats/vtk/vtk.c - VTK's legacy files of structured points and of
 * rectilinear grids: .vtk.
 *
 * After "VTK File Formats" (docs.vtk.org), legacy files of versions 1 to 5:
 *
 *     # vtk DataFile Version 3.0
 *     title
 *     ASCII or BINARY                  binary numbers are big-endian
 *     DATASET STRUCTURED_POINTS        or RECTILINEAR_GRID
 *     FIELD, with TIME and CYCLE of VisIt
 *     DIMENSIONS nx ny nz, ORIGIN, SPACING
 *     X_COORDINATES n type, numbers; Y_, Z_
 *     POINT_DATA n, or CELL_DATA n
 *     SCALARS name type [channels], LOOKUP_TABLE name, numbers
 *     VECTORS, FIELD and others, numbers
 *
 * Arrays are visited in the order of the file, up to the requested one.  The
 * default is the first array of points; without any it is the first of cells,
 * which VTK writes before those of points. */
#include "formats/vtk/vtk.h"
#include "formats/ascii.h"
#include "io/filters/filters.h"

#include <math.h>
#include <string.h>

#define LINE_BYTES 1024
#define MOST_WORDS 8

/* The state of the walk through a file. */
typedef struct vtk_reader {
    snow_source *source;
    snow_context *context;
    const snow_volume_options *options;
    bool binary;
    vtk_grid grid;
    bool sized;
    bool placed;    /* POINT_DATA or CELL_DATA was found */
    bool cells;     /* CELL_DATA */
    int64_t tuples; /* the number after it */
    char seen[512]; /* names of arrays so far, for messages */
    snow_volume_info *info;
    snow_volume *volume; /* NULL if none is requested */
    bool inspect;
    double time;      /* NaN: not given */
    bool shares;      /* numbers from 0 to 1 that stand for bytes 0 to 255 */
    bool found, done; /* an array was read; no better one can follow */
    char line[LINE_BYTES];
    char *words[MOST_WORDS];
    int count; /* number of words */
} vtk_reader;

/* Splits the next line that is not blank into words; no words at the end. */
static snow_status next_line(vtk_reader *reader) {
    bool got;
    for (reader->count = 0; !reader->count;) {
        SNOW_TRY(snow_source_read_line(reader->source, reader->line,
                                       sizeof reader->line, &got));
        if (!got)
            return SNOW_STATUS_OK;
        for (char *at = reader->line; reader->count < MOST_WORDS;) {
            at += strspn(at, " \t");
            if (!*at)
                break;
            reader->words[reader->count++] = at;
            at += strcspn(at, " \t");
            if (*at)
                *at++ = 0;
        }
    }
    return SNOW_STATUS_OK;
}

/* Keywords may have capital or small letters. */
static bool starts(const vtk_reader *reader, const char *keyword, int words) {
    return reader->count >= words && snow_same_name(reader->words[0], keyword);
}

static snow_status fail_line(const vtk_reader *reader) {
    return snow_fail(
        reader->context, SNOW_STATUS_BAD_INPUT,
        "\"%.60s%s%.60s\" is not valid in this place; write the file again",
        reader->count ? reader->words[0] : "(end of file)",
        reader->count > 1 ? " " : "",
        reader->count > 1 ? reader->words[1] : "");
}

/* Names of scalar types; "long" has 8 bytes, as on all systems but Windows. */
static snow_type type_named(const char *name) {
    static const struct {
        const char *name;
        snow_type type;
    } types[] = {
        {"CHAR", SNOW_TYPE_INT8},
        {"SIGNED_CHAR", SNOW_TYPE_INT8},
        {"UNSIGNED_CHAR", SNOW_TYPE_UINT8},
        {"SHORT", SNOW_TYPE_INT16},
        {"UNSIGNED_SHORT", SNOW_TYPE_UINT16},
        {"INT", SNOW_TYPE_INT32},
        {"UNSIGNED_INT", SNOW_TYPE_UINT32},
        {"LONG", SNOW_TYPE_INT64},
        {"UNSIGNED_LONG", SNOW_TYPE_UINT64},
        {"VTKIDTYPE", SNOW_TYPE_INT64},
        {"VTKTYPEINT64", SNOW_TYPE_INT64},
        {"VTKTYPEUINT64", SNOW_TYPE_UINT64},
        {"FLOAT", SNOW_TYPE_FLOAT32},
        {"DOUBLE", SNOW_TYPE_FLOAT64},
    };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (snow_same_name(name, types[i].name))
            return types[i].type;
    return SNOW_TYPE_NONE;
}

/* Skips the numbers of an array. */
static snow_status skip_array(vtk_reader *reader, snow_type type,
                              int64_t channels, int64_t tuples) {
    uint64_t count, bytes;
    if (channels < 0 || tuples < 0 ||
        !snow_mul_u64((uint64_t)channels, (uint64_t)tuples, &count) ||
        !snow_mul_u64(count, 8, &bytes))
        return fail_line(reader);
    if (reader->binary)
        return snow_source_skip(reader->source, count * snow_type_size(type),
                                "an array");
    const snow_region none = {.all = bytes, .value = 8};
    const snow_file_part all = {&none, 0, bytes};
    return snow_read_numbers(reader->source, type, false, &all, NULL);
}

/* Colours in text are shares of 255, which VTK converts to bytes.  In place: a
 * byte never overwrites a number that is still needed. */
static void make_bytes(vtk_reader *reader) {
    reader->info->type = SNOW_TYPE_UINT8;
    if (reader->inspect)
        return;
    snow_volume *volume = reader->volume;
    const int64_t *dims = volume->info.dims;
    unsigned char *bytes = volume->owned;
    for (int64_t i = 0; i < dims[0] * dims[1] * dims[2]; i++) {
        float share;
        memcpy(&share, bytes + (size_t)i * sizeof share, sizeof share);
        bytes[i] = share > 0
                       ? share < 1 ? (unsigned char)(share * 255 + 0.5F) : 255
                       : 0;
    }
    volume->info.type = SNOW_TYPE_UINT8;
}

/* An array's numbers, which the source stands before. */
typedef struct vtk_numbers {
    vtk_reader *reader;
    const vtk_array *array;
    int64_t channel;
    snow_array bytes;
} vtk_numbers;

static snow_status read_numbers(void *user, const snow_volume_options *options,
                                snow_volume_info *info, snow_volume **out) {
    const vtk_numbers *n = user;
    const vtk_reader *reader = n->reader;
    return reader->binary
               ? snow_array_read(reader->source, options, &n->bytes, info, out)
               : snow_array_read_text(reader->source, options,
                                      n->array->channels, n->channel, info,
                                      out);
}

/* If a better array may follow, reading continues after this one. */
static snow_status read_array(vtk_reader *reader, const vtk_array *array,
                              int64_t channel) {
    vtk_numbers n = {.reader = reader, .array = array, .channel = channel};
    snow_volume **out = reader->inspect ? NULL : &reader->volume;
    const int64_t *dims = reader->grid.uneven.count;
    int64_t tuples = dims[0] * dims[1] * dims[2];
    n.bytes = (snow_array){.big_endian = true, .more = true};
    snow_volume_close(reader->volume);
    reader->volume = NULL;
    if (!snow_array_of_grid(array->type, dims, array->channels, channel, 0,
                            &n.bytes))
        return fail_line(reader);
    snow_status status =
        snow_uneven_read(reader->context, &reader->grid.uneven, reader->options,
                         read_numbers, &n, reader->info, out);
    if (status == SNOW_STATUS_OK && reader->shares)
        make_bytes(reader);
    if (status == SNOW_STATUS_OK && reader->inspect && !reader->done)
        status = skip_array(reader, array->type, array->channels, tuples);
    return status;
}

/* Reads an array's numbers if it is the requested one, otherwise skips them. */
static snow_status take_array(vtk_reader *reader, const char *name,
                              snow_type type, int64_t channels,
                              int64_t tuples) {
    vtk_array array = {
        .cells = reader->cells, .type = type, .channels = channels};
    if (strlen(name) >= sizeof array.name)
        return fail_line(reader);
    memcpy(array.name, name, strlen(name) + 1);
    snow_vtk_decode_name(array.name);
    if (type == SNOW_TYPE_NONE || channels < 1 || tuples < 0)
        return fail_line(reader);
    const char *asked = reader->options->dataset;
    bool wanted = reader->placed && (asked ? !strcmp(asked, array.name)
                                           : !reader->cells || !reader->found);
    if (reader->placed)
        snow_list_add(reader->seen, sizeof reader->seen, "%s", array.name);
    if (!wanted)
        return skip_array(reader, type, channels, tuples);
    snow_volume_info *info = reader->info;
    int64_t channel;
    *info = snow_volume_info_default("vtk");
    info->time_value = reader->time;
    SNOW_TRY(snow_vtk_describe(reader->context, &reader->grid, &array,
                               reader->options, info));
    const int64_t *dims = reader->grid.uneven.count;
    const int64_t voxels = dims[0] * dims[1] * dims[2];
    if (tuples != voxels)
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "%.100s has %lld values but the grid has %lld %s; "
                         "correct the sizes",
                         array.name, (long long)tuples, (long long)voxels,
                         array.cells ? "cells" : "points");
    info->directions = !reader->shares && starts(reader, "VECTORS", 3);
    SNOW_TRY(reader->shares
                 ? snow_volume_pick_channel(reader->context, reader->options,
                                            channels, info, &channel)
                 : snow_volume_pick_component(reader->context, reader->options,
                                              channels, info, &channel));
    SNOW_TRY(snow_volume_pick_time(reader->context, "time step",
                                   reader->options, info));
    reader->found = true;
    reader->done = asked || !reader->cells;
    return read_array(reader, &array, channel);
}

/* Blocks of METADATA end with an empty line. */
static snow_status skip_metadata(vtk_reader *reader) {
    bool got = true;
    while (got && *reader->line)
        SNOW_TRY(snow_source_read_line(reader->source, reader->line,
                                       sizeof reader->line, &got));
    return SNOW_STATUS_OK;
}

/* Takes the array whose name and type the words are if it is the time, which
 * VisIt and ParaView write before the arrays of the grid. */
static snow_status take_time(vtk_reader *reader, int64_t count, bool *known) {
    const vtk_line line = {"the time", 1, !reader->binary, true,
                           type_named(reader->words[3])};
    double *value;
    *known = !reader->placed && count == 1 &&
             (snow_same_name(reader->words[0], "TIME") ||
              snow_same_name(reader->words[0], "TIMEVALUE"));
    if (!*known)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_vtk_read_line(reader->source, &line, &value));
    reader->time = *value;
    snow_release(reader->context, value);
    return SNOW_STATUS_OK;
}

/* Reads FIELD name count, then for each "name channels tuples type" and
 * numbers. */
static snow_status take_field(vtk_reader *reader) {
    int64_t count, channels, tuples;
    if (reader->count < 3 || !snow_parse_int64(reader->words[2], &count))
        return fail_line(reader);
    for (int64_t i = 0; i < count && !reader->done; i++) {
        SNOW_TRY(next_line(reader));
        if (starts(reader, "METADATA", 1)) { /* belongs to the previous array */
            SNOW_TRY(skip_metadata(reader));
            i--;
            continue;
        }
        if (reader->count < 4 ||
            !snow_parse_int64(reader->words[1], &channels) ||
            !snow_parse_int64(reader->words[2], &tuples))
            return fail_line(reader);
        bool known;
        SNOW_TRY(take_time(reader, tuples == 1 ? channels : 0, &known));
        if (!known)
            SNOW_TRY(take_array(reader, reader->words[0],
                                type_named(reader->words[3]), channels,
                                tuples));
    }
    return SNOW_STATUS_OK;
}

/* Reads SCALARS name type [channels], and a line that names a lookup table. */
static snow_status take_scalars(vtk_reader *reader) {
    char name[LINE_BYTES];
    int64_t channels = 1;
    snow_type type = type_named(reader->words[2]);
    if (reader->count > 3 && !snow_parse_int64(reader->words[3], &channels))
        return fail_line(reader);
    memcpy(name, reader->words[1], strlen(reader->words[1]) + 1);
    SNOW_TRY(next_line(reader));
    if (!starts(reader, "LOOKUP_TABLE", 2))
        return fail_line(reader);
    return take_array(reader, name, type, channels, reader->tuples);
}

/* Reads attributes by their keyword; *known is false if the line has none. */
static snow_status take_attribute(vtk_reader *reader, bool *known) {
    static const struct {
        const char *keyword;
        int64_t channels;
    } simple[] = {{"VECTORS", 3},     {"NORMALS", 3},    {"TENSORS", 9},
                  {"TENSORS6", 6},    {"GLOBAL_IDS", 1}, {"EDGE_FLAGS", 1},
                  {"PEDIGREE_IDS", 1}};
    int64_t number = 0;
    *known = true;
    reader->shares = false;
    for (size_t i = 0; i < sizeof simple / sizeof *simple; i++)
        if (starts(reader, simple[i].keyword, 3))
            return take_array(reader, reader->words[1],
                              type_named(reader->words[2]), simple[i].channels,
                              reader->tuples);
    if (starts(reader, "SCALARS", 3))
        return take_scalars(reader);
    if (starts(reader, "FIELD", 3))
        return take_field(reader);
    *known = reader->count >= 3 && snow_parse_int64(reader->words[2], &number);
    reader->shares = *known && !reader->binary &&
                     snow_same_name(reader->words[0], "COLOR_SCALARS");
    if (*known && snow_same_name(reader->words[0], "COLOR_SCALARS"))
        return take_array(reader, reader->words[1],
                          reader->binary ? SNOW_TYPE_UINT8 : SNOW_TYPE_FLOAT32,
                          number, reader->tuples);
    if (*known && snow_same_name(reader->words[0], "LOOKUP_TABLE"))
        return skip_array(reader,
                          reader->binary ? SNOW_TYPE_UINT8 : SNOW_TYPE_FLOAT32,
                          4, number);
    if (*known && starts(reader, "TEXTURE_COORDINATES", 4))
        return take_array(reader, reader->words[1],
                          type_named(reader->words[3]), number, reader->tuples);
    *known = false;
    return SNOW_STATUS_OK;
}

/* Reads lines of the grid: sizes, position, and whether arrays are of points or
 * cells. */
static bool take_geometry(vtk_reader *reader) {
    if (starts(reader, "DIMENSIONS", 4)) {
        reader->sized = true;
        bool right = reader->count >= 4;
        for (int i = 0; i < 3 && right; i++)
            right =
                snow_parse_int64(reader->words[1 + i], &reader->grid.points[i]);
        return right;
    }
    const bool origin = starts(reader, "ORIGIN", 4);
    if (origin || starts(reader, "SPACING", 4) ||
        starts(reader, "ASPECT_RATIO", 4)) {
        double *out = origin ? reader->grid.origin : reader->grid.spacing;
        bool right = reader->count >= 4;
        for (int i = 0; i < 3 && right; i++)
            right = snow_parse_double(reader->words[1 + i], &out[i]);
        return right;
    }
    bool cells = starts(reader, "CELL_DATA", 2);
    if (!cells && !starts(reader, "POINT_DATA", 2))
        return false;
    reader->placed = true;
    reader->cells = cells;
    return reader->sized && snow_parse_int64(reader->words[1], &reader->tuples);
}

/* Reads X_COORDINATES count type, or those of y and z, and the numbers. */
static snow_status take_coordinates(vtk_reader *reader, bool *known) {
    static const char *const keywords[] = {"X_COORDINATES", "Y_COORDINATES",
                                           "Z_COORDINATES"};
    vtk_line line = {"the coordinates", 0, !reader->binary, true,
                     SNOW_TYPE_NONE};
    *known = false;
    for (int i = 0; i < 3; i++) {
        if (!starts(reader, keywords[i], 3))
            continue;
        *known = true;
        if (!reader->sized || reader->grid.coordinates[i] ||
            !snow_parse_int64(reader->words[1], &line.count) ||
            line.count != reader->grid.points[i])
            return fail_line(reader);
        line.type = type_named(reader->words[2]);
        return snow_vtk_read_line(reader->source, &line,
                                  &reader->grid.coordinates[i]);
    }
    return SNOW_STATUS_OK;
}

static snow_status fail_unfound(const vtk_reader *reader) {
    if (!*reader->seen)
        return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                         "has no array of values; the file is truncated, or "
                         "has only a grid");
    return snow_fail(reader->context, SNOW_STATUS_BAD_USAGE,
                     "--dataset %.100s: there is no such array; the file has "
                     "%s",
                     reader->options->dataset, reader->seen);
}

/* Reads from the line after DATASET on. */
static snow_status walk(vtk_reader *reader) {
    for (;;) {
        bool known;
        SNOW_TRY(next_line(reader));
        if (!reader->count)
            return reader->found ? SNOW_STATUS_OK : fail_unfound(reader);
        if (take_geometry(reader))
            continue;
        SNOW_TRY(take_coordinates(reader, &known));
        if (known)
            continue;
        if (starts(reader, "METADATA", 1)) {
            SNOW_TRY(skip_metadata(reader));
            continue;
        }
        SNOW_TRY(take_attribute(reader, &known));
        if (!known)
            return fail_line(reader);
        if (reader->done)
            return SNOW_STATUS_OK;
    }
}

/* Reads the four lines that every file begins with. */
static snow_status take_head(vtk_reader *reader) {
    bool got;
    for (int i = 0; i < 2; i++) /* the version, a title */
        SNOW_TRY(snow_source_read_line(reader->source, reader->line,
                                       sizeof reader->line, &got));
    SNOW_TRY(next_line(reader));
    reader->binary = starts(reader, "BINARY", 1);
    if (!reader->binary && !starts(reader, "ASCII", 1))
        return fail_line(reader);
    SNOW_TRY(next_line(reader));
    if (!starts(reader, "DATASET", 2))
        return fail_line(reader);
    reader->grid.rectilinear =
        snow_same_name(reader->words[1], "RECTILINEAR_GRID");
    if (reader->grid.rectilinear ||
        snow_same_name(reader->words[1], "STRUCTURED_POINTS"))
        return SNOW_STATUS_OK;
    return snow_fail(reader->context, SNOW_STATUS_BAD_INPUT,
                     "is a VTK file of \"%.60s\"; only structured points and "
                     "rectilinear grids are supported, so resample it to image "
                     "data first",
                     reader->words[1]);
}

static snow_status read_vtk(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    vtk_reader reader = {.source = source,
                         .context = snow_source_context(source),
                         .options = options,
                         .grid = snow_vtk_grid_default(),
                         .info = info,
                         .time = NAN,
                         .inspect = !out};
    snow_status status = take_head(&reader);
    if (status == SNOW_STATUS_OK)
        status = walk(&reader);
    snow_vtk_release(reader.context, &reader.grid);
    if (status == SNOW_STATUS_OK && out)
        status = snow_source_verify(source);
    return snow_volume_give(status, reader.volume, out);
}

static bool probe_vtk(const unsigned char *bytes, size_t size) {
    static const char magic[] = "# vtk DataFile Version";
    return size >= sizeof magic - 1 &&
           memcmp(bytes, magic, sizeof magic - 1) == 0;
}

const snow_format snow_format_vtk = {
    .name = "vtk",
    .text = "VTK structured points and rectilinear grids, older files (.vtk)",
    .suffixes = {".vtk", ".vtk.gz"},
    .probe = probe_vtk,
    .crops = true,
    .sets = true,
    .channels = true,
    .read = read_vtk,
};
