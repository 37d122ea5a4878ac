/* formats/index/bov.c - VisIt's "brick of values", .bov: a header in text
 * beside raw data in one file, or in a brick for each writer:
 *
 *     TIME: 0.5                     DATA_ENDIAN: LITTLE
 *     DATA_FILE: rho_%04d.raw       CENTERING: zonal, or nodal
 *     DATA_SIZE: 128 128 128        BRICK_ORIGIN: 0. 0. 0.
 *     DATA_FORMAT: FLOAT            BRICK_SIZE: 1. 1. 1.
 *     VARIABLE: rho                 BYTE_OFFSET: 4
 *     DATA_BRICKLETS: 64 64 64      DATA_COMPONENTS: 1
 *
 * After VisIt's "Getting Data Into VisIt", chapter 3. */
#include "formats/array.h"
#include "formats/ascii.h"
#include "formats/index/index.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define NAME_BYTES 1024

typedef struct bov_header {
    char file[NAME_BYTES], variable[64];
    int64_t size[3], brick[3]; /* brick: 0s if all is in one file */
    double origin[3], extent[3], time;
    snow_type type;
    bool big_endian, nodal, sized, placed;
    int64_t offset, components;
} bov_header;

static bool is_key(const char *line, const char *key, const char **value) {
    for (; *key; line++, key++)
        if (toupper((unsigned char)*line) != *key)
            return false;
    line += strspn(line, " \t");
    if (*line != ':' && *line != '=')
        return false;
    *value = line + 1 + strspn(line + 1, " \t");
    return true;
}

/* The first three numbers of a line. */
static bool take_reals(const char *value, double out[3]) {
    double all[16];
    const bool right = snow_text_reals(value, ",", all, 16) >= 3;
    memcpy(out, all, right ? 3 * sizeof *out : 0);
    return right;
}

static bool take_sizes(const char *value, int64_t out[3]) {
    int64_t all[16];
    const bool right = snow_text_integers(value, ",", all, 16) >= 3 &&
                       all[0] >= 1 && all[1] >= 1 && all[2] >= 1;
    memcpy(out, all, right ? 3 * sizeof *out : 0);
    return right;
}

static snow_type type_named(const char *value) {
    static const struct {
        const char *name;
        snow_type type;
    } types[] = {{"BYTE", SNOW_TYPE_UINT8},   {"CHAR", SNOW_TYPE_UINT8},
                 {"SHORT", SNOW_TYPE_INT16},  {"INT", SNOW_TYPE_INT32},
                 {"LONG", SNOW_TYPE_INT64},   {"FLOAT", SNOW_TYPE_FLOAT32},
                 {"REAL", SNOW_TYPE_FLOAT32}, {"DOUBLE", SNOW_TYPE_FLOAT64}};
    const char *none;
    char word[72];
    const size_t length = strlen(value);
    const bool many =
        length && toupper((unsigned char)value[length - 1]) == 'S';
    snprintf(word, sizeof word, "%.*s:", (int)(length - many), value);
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (is_key(word, types[i].name, &none))
            return types[i].type;
    return SNOW_TYPE_NONE;
}

static bool take_text(const char *value, char *out, size_t capacity) {
    size_t length = strlen(value);
    if (length > 1 && *value == '"' && value[length - 1] == '"') {
        value++;
        length -= 2;
    }
    if (!length || length >= capacity)
        return false;
    memcpy(out, value, length);
    out[length] = 0;
    return true;
}

/* Takes a line; false if its value is invalid.  Keys that are not known do not
 * concern the voxels. */
static bool take_line(const char *line, bov_header *h) {
    const char *value;
    if (is_key(line, "DATA_FILE", &value))
        return take_text(value, h->file, sizeof h->file);
    if (is_key(line, "VARIABLE", &value))
        return take_text(value, h->variable, sizeof h->variable);
    if (is_key(line, "DATA_SIZE", &value))
        return h->sized = take_sizes(value, h->size);
    if (is_key(line, "DATA_BRICKLETS", &value))
        return take_sizes(value, h->brick);
    if (is_key(line, "DATA_FORMAT", &value))
        return (h->type = type_named(value)) != SNOW_TYPE_NONE;
    if (is_key(line, "DATA_ENDIAN", &value)) {
        h->big_endian = toupper((unsigned char)*value) == 'B';
        return h->big_endian || toupper((unsigned char)*value) == 'L';
    }
    if (is_key(line, "CENTERING", &value)) {
        h->nodal = tolower((unsigned char)*value) == 'n';
        return true;
    }
    if (is_key(line, "BRICK_ORIGIN", &value))
        return take_reals(value, h->origin);
    if (is_key(line, "BRICK_SIZE", &value))
        return h->placed = take_reals(value, h->extent);
    if (is_key(line, "TIME", &value))
        return snow_parse_double(value, &h->time);
    if (is_key(line, "BYTE_OFFSET", &value))
        return snow_parse_int64(value, &h->offset) && h->offset >= 0;
    if (is_key(line, "DATA_COMPONENTS", &value))
        return snow_parse_int64(value, &h->components) && h->components >= 1;
    return true;
}

/* A warning begins with # at the beginning or behind a blank. */
static void cut_comment(char *line) {
    for (char *at = line; *at; at++)
        if (*at == '#' && (at == line || strchr(" \t", at[-1]))) {
            *at = 0;
            return;
        }
}

static snow_status read_header(snow_source *source, bov_header *h) {
    snow_context *context = snow_source_context(source);
    *h = (bov_header){.type = SNOW_TYPE_FLOAT32, .components = 1, .time = NAN};
    h->big_endian = snow_machine_big_endian();
    for (;;) {
        char line[NAME_BYTES + 64];
        bool got;
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        if (!got)
            break;
        cut_comment(line);
        for (size_t end = strlen(line); end && strchr(" \t", line[end - 1]);
             end--)
            line[end - 1] = 0;
        if (!take_line(line + strspn(line, " \t"), h))
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "its line \"%.60s\" is not valid; correct it",
                             line);
    }
    if (*h->file && h->sized)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "lacks DATA_FILE or DATA_SIZE; add them");
}

/* Zones lie half a step from the origin, nodes at it. */
static snow_status describe(snow_context *context, const bov_header *h,
                            snow_volume_info *info) {
    *info = snow_volume_info_default("bov");
    info->type = h->type;
    info->time_value = h->time;
    memcpy(info->quantity, h->variable, sizeof h->variable);
    for (int i = 0; i < 3; i++) {
        const int64_t n = h->size[i];
        double steps = (double)(h->nodal && n > 1 ? n - 1 : n);
        double step = h->placed ? h->extent[i] / steps : 1;
        info->dims[i] = n;
        info->matrix[i][i] = step;
        info->matrix[i][3] = h->origin[i] + (h->nodal ? 0 : step / 2);
        if (h->brick[i] && (h->brick[i] > n || n % h->brick[i]))
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "DATA_BRICKLETS do not divide DATA_SIZE (%lld by "
                             "%lld); correct them",
                             (long long)n, (long long)h->brick[i]);
    }
    return SNOW_STATUS_OK;
}

/* Reads a box of an array in a file of its own. */
static snow_status read_file(snow_source *source, const bov_header *h,
                             const char *name, const int64_t dims[3],
                             int64_t channel,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_source *data;
    snow_array array = {.big_endian = h->big_endian};
    if (!snow_array_of_grid(h->type, dims, h->components, channel,
                            (uint64_t)h->offset, &array))
        return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                         "its sizes are too large for any file; correct them");
    memcpy(info->dims, dims, sizeof info->dims);
    SNOW_TRY(snow_source_open_sibling(source, name, &data));
    snow_status status = snow_array_read(data, options, &array, info, out);
    snow_source_close(data);
    return status;
}

/* The name of a brick, which has one number: %04d. */
static bool brick_name(const char *pattern, int64_t number, char *out,
                       size_t capacity) {
    const char *at = strchr(pattern, '%');
    int width = 0;
    if (!at || strchr(at + 1, '%'))
        return false;
    const char *end = at + 1;
    for (; isdigit((unsigned char)*end) && end - at < 4; end++)
        width = 10 * width + (*end - '0');
    if (*end != 'd')
        return false;
    int length = snprintf(out, capacity, "%.*s%0*lld%s", (int)(at - pattern),
                          pattern, width, (long long)number, end + 1);
    return length > 0 && (size_t)length < capacity;
}

/* Reads a brick, if the box has any of it. */
static snow_status read_brick(snow_source *source, const bov_header *h,
                              int64_t number, const int64_t at[3],
                              int64_t channel, const snow_region *box,
                              snow_volume *to) {
    char name[NAME_BYTES + 24];
    const snow_volume_options whole = {.size = sizeof whole};
    snow_volume_info info = to->info;
    snow_volume *brick;
    for (int i = 0; i < 3; i++)
        if (at[i] >= box->first[i] + box->count[i] ||
            at[i] + h->brick[i] <= box->first[i])
            return SNOW_STATUS_OK;
    if (!brick_name(h->file, number, name, sizeof name))
        return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                         "its DATA_FILE %.60s has no number such as %%04d for "
                         "its bricks; correct it",
                         h->file);
    info.times = 1;
    info.time = 0;
    SNOW_TRY(
        read_file(source, h, name, h->brick, channel, &whole, &info, &brick));
    snow_mosaic_copy(brick, at, box->first, to);
    snow_volume_close(brick);
    return SNOW_STATUS_OK;
}

static snow_status read_bricks(snow_source *source, const bov_header *h,
                               int64_t channel,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_region box;
    snow_volume *volume;
    snow_status status = SNOW_STATUS_OK;
    int64_t at[3], number = 0;
    SNOW_TRY(
        snow_region_lay_out(snow_source_context(source), options, info, &box));
    if (!out)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_new(snow_source_context(source), info, &volume));
    for (at[2] = 0; at[2] < h->size[2]; at[2] += h->brick[2])
        for (at[1] = 0; at[1] < h->size[1]; at[1] += h->brick[1])
            for (at[0] = 0; at[0] < h->size[0]; at[0] += h->brick[0])
                if (status == SNOW_STATUS_OK)
                    status = read_brick(source, h, number++, at, channel, &box,
                                        volume);
    return snow_volume_give(status, volume, out);
}

static snow_status read_bov(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    bov_header h;
    int64_t channel;
    SNOW_TRY(read_header(source, &h));
    SNOW_TRY(describe(context, &h, info));
    SNOW_TRY(snow_volume_pick_component(context, options, h.components, info,
                                        &channel));
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    return strchr(h.file, '%') && h.brick[0]
               ? read_bricks(source, &h, channel, options, info, out)
               : read_file(source, &h, h.file, h.size, channel, options, info,
                           out);
}

const snow_format snow_format_bov = {
    .name = "bov",
    .text = "brick of values of VisIt (.bov), beside raw data",
    .suffixes = {".bov"},
    .crops = true,
    .channels = true,
    .read = read_bov,
};
