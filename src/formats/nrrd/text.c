/* formats/nrrd/text.c - splits an NRRD header into its lines.
 *
 * A header is a magic line, then fields ("sizes: 3 4 5"), pairs of a key and a
 * value ("patient:=unknown") and comments ("# ...") in any order.  It ends at
 * an empty line or, if the data are elsewhere, at the end of the file. */
#include "formats/nrrd/nrrd.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Programs store whole protocols in key/value pairs, but nothing near this
 * size. */
#define MOST_LINE_BYTES ((size_t)256 * 1024)
#define MOST_HEADER_BYTES ((size_t)16 * 1024 * 1024)

/* From the same table as the enumeration, so that both always agree. */
static const char *const spellings[NRRD_FIELD_COUNT][2] = {
#define SPELLINGS(name, text, other) {text, other},
    NRRD_FIELD_MAP(SPELLINGS)
#undef SPELLINGS
};

const char *snow_nrrd_field_name(nrrd_field field) {
    return spellings[field][0];
}

const char *snow_nrrd_value(const nrrd_text *text, nrrd_field field) {
    return text->value[field] ? text->block + text->value[field] : NULL;
}

/* Spellings in the table are lower case. */
static bool spelled(const char *name, size_t length, const char *spelling) {
    if (!length || strlen(spelling) != length)
        return false;
    for (size_t i = 0; i < length; i++)
        if (tolower((unsigned char)name[i]) != spelling[i])
            return false;
    return true;
}

/* The field of this name, or NRRD_FIELD_COUNT. */
static nrrd_field field_named(const char *name, size_t length) {
    for (int i = 0; i < NRRD_FIELD_COUNT; i++)
        if (spelled(name, length, spellings[i][0]) ||
            spelled(name, length, spellings[i][1]))
            return (nrrd_field)i;
    return NRRD_FIELD_COUNT;
}

/* Appends a string; *offset is its position in the block. */
static snow_status append(nrrd_text *text, const char *string, size_t *offset) {
    size_t length = strlen(string) + 1;
    if (length > MOST_HEADER_BYTES - text->used)
        return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                         "the header is longer than 16 MiB; it is damaged");
    SNOW_TRY(SNOW_RESERVE(text->context, text->block, text->used,
                          text->used + length));
    memcpy(text->block + text->used, string, length);
    *offset = text->used;
    text->used += length;
    return SNOW_STATUS_OK;
}

/* Blanks at a line's end are ignored, and a CR is one of them. */
static void trim_end(char *line) {
    size_t length = strlen(line);
    while (length && isspace((unsigned char)line[length - 1]))
        length--;
    line[length] = 0;
}

/* The colour of a segment: three shares. */
static bool read_color(const char *text, double color[4]) {
    char words[3][32];
    bool good =
        sscanf(text, "%31s %31s %31s", words[0], words[1], words[2]) == 3;
    for (int c = 0; c < 3 && good; c++)
        good = snow_parse_double(words[c], &color[c]) && color[c] >= 0 &&
               color[c] <= 1;
    return good;
}

/* A key of 3D Slicer's segmentations, "Segment0_Name": its segment is made
 * before. */
static snow_status take_segment(nrrd_text *text, const char *line) {
    char key[16], digits[5];
    int at = 0;
    if (sscanf(line, "Segment%4[0-9]_%15[A-Za-z]:=%n", digits, key, &at) != 2 ||
        !at)
        return SNOW_STATUS_OK;
    size_t number = (size_t)strtoul(digits, NULL, 10);
    SNOW_TRY(SNOW_RESERVE(text->context, text->segments, text->segment_count,
                          number + 1));
    while (text->segment_count <= number)
        text->segments[text->segment_count++] =
            (nrrd_segment){{NAN, {-1, 0, 0, -1}, ""}, -1};
    snow_label *label = &text->segments[number].label;
    int64_t *layer = &text->segments[number].layer;
    bool good = true;
    if (!strcmp(key, "LabelValue"))
        good = snow_parse_double(line + at, &label->value) &&
               isfinite(label->value);
    else if (!strcmp(key, "Layer"))
        good = snow_parse_int64(line + at, layer) && *layer >= 0;
    else if (!strcmp(key, "Name"))
        snprintf(label->name, sizeof label->name, "%s", line + at);
    else if (!strcmp(key, "Opacity"))
        good = snow_parse_double(line + at, &label->color[3]) &&
               label->color[3] >= 0 && label->color[3] <= 1;
    else if (!strcmp(key, "Color"))
        good = read_color(line + at, label->color);
    if (good)
        return SNOW_STATUS_OK;
    return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                     "the header's line \"%.60s\" is wrong; a label or a "
                     "layer is a number, a colour three numbers of 0 to 1, an "
                     "opacity one",
                     line);
}

/* A line that is not a comment: a field, or a key with a value. */
static snow_status take_line(nrrd_text *text, const char *line) {
    const char *colon = strchr(line, ':');
    if (colon && colon[1] != '=') {
        nrrd_field field = field_named(line, (size_t)(colon - line));
        if (field != NRRD_FIELD_COUNT) {
            const char *value = (colon + 1) + strspn(colon + 1, " \t");
            /* 3D Slicer has written some twice. */
            if (text->value[field] &&
                !strcmp(snow_nrrd_value(text, field), value))
                return SNOW_STATUS_OK;
            if (text->value[field])
                return snow_fail(
                    text->context, SNOW_STATUS_BAD_INPUT,
                    "the header's field \"%s\" occurs twice with different "
                    "values; delete one",
                    snow_nrrd_field_name(field));
            return append(text, value, &text->value[field]);
        }
    }
    if (strstr(line, ":="))
        return take_segment(text, line);
    return snow_fail(
        text->context, SNOW_STATUS_BAD_INPUT,
        "the header's line \"%.60s\" is not a field of the format; correct it, "
        "or write \":=\" for a key with a value",
        line);
}

/* Versions differ in their fields; every field is accepted in all versions. */
static snow_status check_magic(snow_context *context, const char *line) {
    if (!strcmp(line, "NRRD00.01") ||
        (!strncmp(line, "NRRD000", 7) && line[7] >= '1' && line[7] <= '5' &&
         !line[8]))
        return SNOW_STATUS_OK;
    if (!strncmp(line, "NRRD", 4))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is an NRRD file of version \"%.20s\"; save it as "
                         "NRRD0005 or older",
                         line);
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "does not begin with \"NRRD000\" as NRRD files do; it is "
                     "damaged or of another format");
}

/* An empty line ends the header, and with it a list of files. Without one the
 * end of the file does, but only if the data are elsewhere. */
static snow_status read_lines(snow_source *source, char *line,
                              nrrd_text *text) {
    snow_context *context = snow_source_context(source);
    bool got;
    size_t at;
    SNOW_TRY(snow_source_read_line(source, line, MOST_LINE_BYTES, &got));
    trim_end(line);
    SNOW_TRY(check_magic(context, line));
    /* So that no field has offset 0. */
    SNOW_TRY(append(text, "", &at));
    for (;;) {
        SNOW_TRY(snow_source_read_line(source, line, MOST_LINE_BYTES, &got));
        trim_end(line);
        if (!got || !*line)
            break;
        /* True for "LIST" and "LIST 2". */
        const char *value = snow_nrrd_value(text, NRRD_DATA_FILE);
        if (value && !strncmp(value, "LIST", 4) &&
            (!value[4] || isspace((unsigned char)value[4]))) {
            /* The names are contiguous in the block, because nothing else is
             * appended after the list's first line. */
            SNOW_TRY(append(text, line, text->listed ? &at : &text->list));
            text->listed++;
        } else if (*line != '#') {
            SNOW_TRY(take_line(text, line));
        }
    }
    if (!got && !text->value[NRRD_DATA_FILE])
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "ends within its header; the file is truncated, or "
                         "lacks the field \"data file\"");
    return SNOW_STATUS_OK;
}

/* The line has a block of its own for now: it may be 256 KiB long. */
snow_status snow_nrrd_read_text(snow_source *source, nrrd_text *text) {
    snow_context *context = snow_source_context(source);
    *text = (nrrd_text){.context = context};
    char *line = snow_allocate(context, MOST_LINE_BYTES);
    if (!line)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = read_lines(source, line, text);
    snow_release(context, line);
    return status;
}
