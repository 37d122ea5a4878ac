/* formats/nrrd/header.c - parses and checks the fields of an NRRD header.
 *
 * Names are compared without case, blanks, dashes and underscores, which covers
 * the many spellings that the format allows. */
#include "formats/ascii.h"
#include "formats/nrrd/nrrd.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WORD_BYTES 64

/* Names in lower case, without blanks and dashes, separated by blanks. */
typedef struct name_value {
    const char *names;
    int value;
} name_value;

/* "char" alone is missing on purpose: the format has no such type, since its
 * sign depends on the compiler. */
static const name_value type_names[] = {
    {"signedchar int8 int8t", SNOW_TYPE_INT8},
    {"uchar unsignedchar uint8 uint8t", SNOW_TYPE_UINT8},
    {"short shortint signedshort signedshortint int16 int16t", SNOW_TYPE_INT16},
    {"ushort unsignedshort unsignedshortint uint16 uint16t", SNOW_TYPE_UINT16},
    {"int signedint int32 int32t", SNOW_TYPE_INT32},
    {"uint unsignedint uint32 uint32t", SNOW_TYPE_UINT32},
    {"longlong longlongint signedlonglong signedlonglongint int64 int64t",
     SNOW_TYPE_INT64},
    {"ulonglong unsignedlonglong unsignedlonglongint uint64 uint64t",
     SNOW_TYPE_UINT64},
    {"float float32", SNOW_TYPE_FLOAT32},
    {"double float64", SNOW_TYPE_FLOAT64},
    {NULL, SNOW_TYPE_NONE},
};

/* Not supported: zrl (in no document of the format). */
static const name_value encoding_names[] = {
    {"raw", SNOW_PACKING_NONE},
    {"gzip gz", SNOW_PACKING_GZIP},
    {"bzip2 bz2", SNOW_PACKING_BZIP2},
    {"hex", SNOW_PACKING_HEX},
    {"ascii text txt", SNOW_PACKING_TEXT},
    {NULL, 0},
};

/* Kinds of several values: complex numbers, vectors, colours, tensors. */
static const name_value role_names[] = {
    {"domain space", NRRD_AXIS_SPACE},
    {"time", NRRD_AXIS_TIME},
    {"list", NRRD_AXIS_LIST},
    {"??? none", NRRD_AXIS_UNKNOWN},
    {"rgbcolor rgbacolor 3color 4color", NRRD_AXIS_COLORS},
    {"vector covariantvector 2vector 3vector 4vector 3gradient 3normal",
     NRRD_AXIS_VECTOR},
    {NULL, NRRD_AXIS_VALUES},
};

/* Worlds: the number of coordinates, and the signs that convert them to RAS+
 * (medical ones) or to a right-handed system. */
static const struct world {
    const char *names;
    int dimension;
    double turn[3];
    bool medical;
} worlds[] = {
    {"rightanteriorsuperior ras", 3, {1, 1, 1}, true},
    {"leftanteriorsuperior las", 3, {-1, 1, 1}, true},
    {"leftposteriorsuperior lps", 3, {-1, -1, 1}, true},
    {"rightanteriorsuperiortime rast", 4, {1, 1, 1}, true},
    {"leftanteriorsuperiortime last", 4, {-1, 1, 1}, true},
    {"leftposteriorsuperiortime lpst", 4, {-1, -1, 1}, true},
    {"scannerxyz", 3, {1, 1, 1}, false},
    {"scannerxyztime", 4, {1, 1, 1}, false},
    {"3drighthanded", 3, {1, 1, 1}, false},
    {"3drighthandedtime", 4, {1, 1, 1}, false},
    {"3dlefthanded", 3, {1, 1, -1}, false},
    {"3dlefthandedtime", 4, {1, 1, -1}, false},
};

/* The value is shortened in messages: a line may be 256 KiB long. */
static snow_status fail_field(const nrrd_text *text, nrrd_field field,
                              const char *wrong) {
    const char *value = snow_nrrd_value(text, field);
    if (!value)
        return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                         "the header has no field \"%s\"; add it",
                         snow_nrrd_field_name(field));
    return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                     "the header's field \"%s: %.60s\" %s; correct it",
                     snow_nrrd_field_name(field), value, wrong);
}

/* The value in the form of the name tables.  Shortening is safe: all names in
 * them are shorter than what is left. */
static void plain_name(const char *value, char name[WORD_BYTES]) {
    size_t used = 0;
    for (; *value && used + 1 < WORD_BYTES; value++)
        if (!strchr(" \t-_", *value))
            name[used++] = (char)tolower((unsigned char)*value);
    name[used] = 0;
}

/* The entry of this name, or the last one, which has no name. */
static const name_value *look_up(const name_value *table, const char *value) {
    char name[WORD_BYTES];
    plain_name(value, name);
    while (table->names && !snow_has_word(table->names, name))
        table++;
    return table;
}

/* True if more text follows, however long. */
static bool has_more(const char *at) {
    return at[strspn(at, " \t")] != 0;
}

/* Parses "(1,0,0.5)" with `count` numbers. */
static bool next_vector(const char **at, int count, double *out) {
    const char *from = *at + strspn(*at, " \t");
    if (*from++ != '(')
        return false;
    for (int i = 0; i < count; i++) {
        char number[WORD_BYTES];
        size_t length = strcspn(from, ",)");
        if (length >= sizeof number ||
            from[length] != (i + 1 < count ? ',' : ')'))
            return false;
        memcpy(number, from, length);
        number[length] = 0;
        if (!snow_parse_double(number, &out[i]))
            return false;
        from += length + 1;
    }
    *at = from;
    return true;
}

static snow_status parse_encoding(const nrrd_text *text, nrrd_header *out) {
    const char *value = snow_nrrd_value(text, NRRD_ENCODING);
    if (!value)
        return fail_field(text, NRRD_ENCODING, "");
    const name_value *entry = look_up(encoding_names, value);
    if (!entry->names)
        return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                         "the encoding \"%.40s\" is not supported; recompress "
                         "the file with gzip",
                         value);
    out->data.packing = (snow_packing)entry->value;
    return SNOW_STATUS_OK;
}

/* If the byte order matters and is missing, guessing could show noise as
 * data. */
static snow_status parse_endian(const nrrd_text *text, nrrd_header *out) {
    const char *value = snow_nrrd_value(text, NRRD_ENDIAN);
    bool matters = out->data.packing != SNOW_PACKING_TEXT &&
                   snow_type_size(out->data.type) > 1;
    if (!value && matters)
        return fail_field(text, NRRD_ENDIAN, "");
    out->data.big_endian = snow_machine_big_endian();
    if (!value)
        return SNOW_STATUS_OK;
    char name[WORD_BYTES];
    plain_name(value, name);
    out->data.big_endian = !strcmp(name, "big");
    if (!out->data.big_endian && strcmp(name, "little") != 0)
        return fail_field(text, NRRD_ENDIAN, "is neither big nor little");
    return SNOW_STATUS_OK;
}

/* Sixteen axes are the format's own limit. */
static snow_status parse_dimension(const nrrd_text *text, nrrd_header *out) {
    const char *value = snow_nrrd_value(text, NRRD_DIMENSION);
    int64_t dimension;
    if (!value || !snow_parse_int64(value, &dimension) || dimension < 1 ||
        dimension > NRRD_MOST_AXES)
        return fail_field(text, NRRD_DIMENSION,
                          "is not a number of axes from 1 to 16");
    out->dimension = (int)dimension;
    return SNOW_STATUS_OK;
}

static snow_status parse_sizes(const nrrd_text *text, nrrd_header *out) {
    const char *at = snow_nrrd_value(text, NRRD_SIZES);
    char word[WORD_BYTES];
    if (!at)
        return fail_field(text, NRRD_SIZES, "");
    for (int i = 0; i < out->dimension; i++)
        if (!snow_next_word(&at, word, sizeof word) ||
            !snow_parse_int64(word, &out->axes[i].size) ||
            out->axes[i].size < 1)
            return fail_field(
                text, NRRD_SIZES,
                "does not have one whole number above 0 for each axis");
    if (has_more(at))
        return fail_field(text, NRRD_SIZES,
                          "has more numbers than there are axes");
    return SNOW_STATUS_OK;
}

/* One number for each axis; the field exists. */
static snow_status parse_axis_numbers(const nrrd_text *text, nrrd_field field,
                                      int dimension,
                                      double out[NRRD_MOST_AXES]) {
    const char *at = snow_nrrd_value(text, field);
    char word[WORD_BYTES];
    for (int i = 0; i < dimension; i++)
        if (!snow_next_word(&at, word, sizeof word) ||
            !snow_parse_double(word, &out[i]))
            return fail_field(text, field,
                              "does not have one number for each axis");
    if (has_more(at))
        return fail_field(text, field, "has more numbers than there are axes");
    return SNOW_STATUS_OK;
}

/* Which axes have samples at their ends.  "cell", "???", "none" and a missing
 * field are the same here: the format leaves the default to the reader, and
 * voxels are cells. */
static snow_status parse_nodes(const nrrd_text *text, int dimension,
                               bool nodes[NRRD_MOST_AXES]) {
    const char *at = snow_nrrd_value(text, NRRD_CENTERS);
    char word[WORD_BYTES], name[WORD_BYTES];
    for (int i = 0; at && i < dimension; i++) {
        if (!snow_next_word(&at, word, sizeof word))
            return fail_field(text, NRRD_CENTERS,
                              "does not have one centering for each axis");
        plain_name(word, name);
        nodes[i] = !strcmp(name, "node");
    }
    return SNOW_STATUS_OK;
}

/* The older way to place samples, by the ends of each axis: those of the first
 * and last cell, or the first and last sample ("node").  The ends may come in
 * either order; NaN means unknown.  The field "space origin" has priority. */
static snow_status parse_ends(const nrrd_text *text, nrrd_header *out) {
    double from[NRRD_MOST_AXES], to[NRRD_MOST_AXES];
    bool nodes[NRRD_MOST_AXES] = {false};
    int dimension = out->dimension;
    SNOW_TRY(parse_axis_numbers(text, NRRD_AXIS_MINS, dimension, from));
    SNOW_TRY(parse_axis_numbers(text, NRRD_AXIS_MAXS, dimension, to));
    SNOW_TRY(parse_nodes(text, dimension, nodes));
    bool placed = snow_nrrd_value(text, NRRD_ORIGIN) != NULL;
    for (int i = 0; i < dimension; i++) {
        nrrd_axis *axis = &out->axes[i];
        int64_t steps = axis->size - nodes[i];
        if (isnan(from[i]) || isnan(to[i]))
            continue;
        if (steps > 0) /* a single node has no length */
            axis->spacing = (to[i] - from[i]) / (double)steps;
        if (!placed)
            axis->first = from[i] + (nodes[i] ? 0 : axis->spacing / 2);
    }
    return SNOW_STATUS_OK;
}

/* NaN is accepted here: it is right for an axis that is not spatial, and means
 * not known for a spatial one. */
static snow_status parse_spacings(const nrrd_text *text, nrrd_header *out) {
    double spacings[NRRD_MOST_AXES];
    bool given = snow_nrrd_value(text, NRRD_SPACINGS) != NULL;
    if (given)
        SNOW_TRY(
            parse_axis_numbers(text, NRRD_SPACINGS, out->dimension, spacings));
    for (int i = 0; i < out->dimension; i++)
        out->axes[i].spacing = given ? spacings[i] : 1;
    if (!given && !snow_nrrd_value(text, NRRD_DIRECTIONS) &&
        snow_nrrd_value(text, NRRD_AXIS_MINS) &&
        snow_nrrd_value(text, NRRD_AXIS_MAXS))
        return parse_ends(text, out);
    return SNOW_STATUS_OK;
}

/* A kind that is not in the table is some kind of components. */
static snow_status parse_kinds(const nrrd_text *text, nrrd_header *out) {
    const char *at = snow_nrrd_value(text, NRRD_KINDS);
    char word[WORD_BYTES];
    for (int i = 0; at && i < out->dimension; i++) {
        if (!snow_next_word(&at, word, sizeof word))
            return fail_field(text, NRRD_KINDS,
                              "does not have one kind for each axis");
        out->axes[i].role = (nrrd_role)look_up(role_names, word)->value;
    }
    if (at && has_more(at))
        return fail_field(text, NRRD_KINDS,
                          "has more kinds than there are axes");
    return SNOW_STATUS_OK;
}

/* The number of world coordinates: from the world's name, or given, or 3. */
static snow_status parse_world(const nrrd_text *text, nrrd_header *out,
                               int *dimension) {
    const char *space = snow_nrrd_value(text, NRRD_SPACE);
    const char *given = snow_nrrd_value(text, NRRD_SPACE_DIMENSION);
    int64_t count = 3;
    for (int i = 0; i < 3; i++)
        out->turn[i] = 1;
    if (given && (!snow_parse_int64(given, &count) || count < 1 || count > 4))
        return fail_field(text, NRRD_SPACE_DIMENSION,
                          "is not a number of world axes from 1 to 4");
    *dimension = (int)count;
    if (!space)
        return SNOW_STATUS_OK;
    char name[WORD_BYTES];
    plain_name(space, name);
    for (size_t i = 0; i < sizeof worlds / sizeof *worlds; i++) {
        if (!snow_has_word(worlds[i].names, name))
            continue;
        if (given && count != worlds[i].dimension)
            return fail_field(text, NRRD_SPACE_DIMENSION,
                              "contradicts the field \"space\"");
        *dimension = worlds[i].dimension;
        memcpy(out->turn, worlds[i].turn, sizeof out->turn);
        out->medical = worlds[i].medical;
        return SNOW_STATUS_OK;
    }
    return fail_field(text, NRRD_SPACE, "is not a space of the format");
}

/* One axis: a vector, or "none" for an axis that is not spatial. */
static bool next_direction(const char **at, int dimension, nrrd_axis *axis) {
    char word[WORD_BYTES];
    const char *from = *at;
    double *step = axis->direction;
    if (next_vector(at, dimension, step)) {
        /* All NaN also means "none". */
        for (int i = 0; i < dimension; i++)
            axis->directed |= !isnan(step[i]);
        return true;
    }
    if (!snow_next_word(&from, word, sizeof word) || strcmp(word, "none") != 0)
        return false;
    *at = from;
    return true;
}

static snow_status parse_directions(const nrrd_text *text, int dimension,
                                    nrrd_header *out) {
    const char *at = snow_nrrd_value(text, NRRD_DIRECTIONS);
    for (int i = 0; at && i < out->dimension; i++) {
        if (!next_direction(&at, dimension, &out->axes[i]))
            return fail_field(
                text, NRRD_DIRECTIONS,
                "does not have one vector or \"none\" for each axis");
        out->directions = out->directions || out->axes[i].directed;
    }
    if (at && has_more(at))
        return fail_field(text, NRRD_DIRECTIONS,
                          "has more vectors than there are axes");
    at = snow_nrrd_value(text, NRRD_ORIGIN);
    if (at && (!next_vector(&at, dimension, out->origin) || has_more(at)))
        return fail_field(text, NRRD_ORIGIN, "is not a vector of the space");
    return SNOW_STATUS_OK;
}

/* Copies the next quoted string, as far as it has room. */
static bool next_unit(const char **at, char unit[16]) {
    const char *from = strchr(*at, '"');
    const char *end = from ? strchr(from + 1, '"') : NULL;
    if (!end)
        return false;
    snprintf(unit, 16, "%.*s", (int)(end - from < 16 ? end - from - 1 : 15),
             from + 1);
    *at = end + 1;
    return true;
}

static void parse_units(const nrrd_text *text, nrrd_header *out) {
    const char *at = snow_nrrd_value(text, NRRD_SPACE_UNITS);
    while (at && out->space_unit_count < 4 &&
           next_unit(&at, out->space_units[out->space_unit_count]))
        out->space_unit_count++;
    at = snow_nrrd_value(text, NRRD_UNITS);
    for (int i = 0; at && i < out->dimension; i++)
        if (!next_unit(&at, out->axes[i].unit))
            break;
}

/* -1 cannot be counted back in a text of numbers.  Teem knows no other negative
 * skip. */
static snow_status parse_skips(const nrrd_text *text, nrrd_header *out) {
    const char *lines = snow_nrrd_value(text, NRRD_LINE_SKIP);
    const char *bytes = snow_nrrd_value(text, NRRD_BYTE_SKIP);
    int64_t skip;
    if (lines) {
        if (!snow_parse_int64(lines, &skip) || skip < 0)
            return fail_field(text, NRRD_LINE_SKIP, "is not a number of lines");
        out->data.line_skip = (uint64_t)skip;
    }
    if (bytes &&
        (!snow_parse_int64(bytes, &out->data.byte_skip) ||
         out->data.byte_skip < -1 ||
         (out->data.byte_skip < 0 && out->data.packing == SNOW_PACKING_TEXT)))
        return fail_field(
            text, NRRD_BYTE_SKIP,
            "is not a number of bytes (nor -1 before binary data)");
    return SNOW_STATUS_OK;
}

/* In the order of dependence, whatever the order in the file: the dimension
 * before lists of one entry for each axis, the world before its vectors. */
snow_status snow_nrrd_parse_header(const nrrd_text *text, nrrd_header *out) {
    int dimension = 3;
    *out = (nrrd_header){
        .context = text->context,
        .data = {.commas = true,
                 .skip = "the skipped bytes",
                 .find = snow_format_of_bytes,
                 .advice =
                     "add \"byte skip: -1\" to the NRRD header to skip that",
                 .count = 1}};
    /* "block" is also a type, of opaque samples, and is not supported. */
    const char *value = snow_nrrd_value(text, NRRD_TYPE);
    out->data.type =
        value ? (snow_type)look_up(type_names, value)->value : SNOW_TYPE_NONE;
    if (!out->data.type)
        return fail_field(text, NRRD_TYPE,
                          "is not a supported scalar type (8 to 64 bit "
                          "integers, float, double)");
    SNOW_TRY(parse_encoding(text, out));
    SNOW_TRY(parse_endian(text, out));
    SNOW_TRY(parse_dimension(text, out));
    SNOW_TRY(parse_sizes(text, out));
    SNOW_TRY(parse_spacings(text, out));
    SNOW_TRY(parse_kinds(text, out));
    SNOW_TRY(parse_world(text, out, &dimension));
    SNOW_TRY(parse_directions(text, dimension, out));
    SNOW_TRY(parse_skips(text, out));
    parse_units(text, out);
    return SNOW_STATUS_OK;
}
