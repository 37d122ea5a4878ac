/* formats/vtk/vti_survey.c - the small arrays of a VTK XML file, which may
 * stand before or after those of values: the time, and the coordinates of a
 * rectilinear grid.
 *
 *     <FieldData> TimeValue </FieldData>
 *     <Piece> <PointData> ... <Coordinates> x, y, z </Coordinates> </Piece>
 *     <AppendedData> _numbers of all that are appended
 *
 * The text is parsed to their end, beside the source, which stays at its first
 * byte; then their numbers are read. */
#include "formats/index/index.h"
#include "formats/vtk/vti.h"

#include <math.h>
#include <string.h>

/* Bytes of a number in any form, and of what stands before numbers. */
#define NUMBER_BYTES 32
#define BEFORE_BYTES 65536

/* Blanks before the '_' of appended data. */
#define BLANKS 64

/* An array: how its numbers are stored, and where those in its element are. */
typedef struct small_array {
    bool found;
    uint64_t at;
    vti_header header;
} small_array;

typedef struct survey {
    index_bytes from;
    index_text xml;
    vti_header file; /* what the file says of all arrays */
    bool rectilinear, fields, coordinates, sized;
    int64_t points[3];
    int axes; /* coordinates so far */
    small_array time, axis[3];
    uint64_t appended; /* where the appended data begin */
    bool raw;
} survey;

static void take_array(survey *s, const char **attributes) {
    const char *name = snow_index_attribute(attributes, "Name");
    small_array *out = NULL;
    if (s->coordinates && s->axes < 3)
        out = &s->axis[s->axes++];
    else if (s->fields && name && !strcmp(name, "TimeValue"))
        out = &s->time;
    if (!out)
        return;
    out->header = s->file;
    out->found = snow_vti_keep_array(&out->header, attributes, "", false);
    out->at = s->xml.end;
}

static snow_status begin_element(void *user, const char *name,
                                 const char **attributes) {
    survey *s = user;
    int64_t first[3];
    if (!strcmp(name, "VTKFile"))
        snow_vti_file_form(&s->file, attributes);
    else if (!strcmp(name, "RectilinearGrid"))
        s->sized = snow_vti_take_extent(
            snow_index_attribute(attributes, "WholeExtent"), first, s->points);
    else if (!strcmp(name, "FieldData"))
        s->fields = true;
    else if (!strcmp(name, "Coordinates"))
        s->coordinates = s->rectilinear;
    else if (!strcmp(name, "DataArray"))
        take_array(s, attributes);
    /* Without coordinates nothing is wanted behind this element. */
    s->xml.done = !strcmp(name, "AppendedData") ||
                  (!strcmp(name, "Piece") && !s->rectilinear &&
                   !(s->time.found && s->time.header.form == VTI_APPENDED));
    if (!strcmp(name, "AppendedData")) {
        const char *encoding = snow_index_attribute(attributes, "encoding");
        s->raw = encoding && !strcmp(encoding, "raw");
        s->appended = s->xml.end;
    }
    return SNOW_STATUS_OK;
}

static snow_status end_element(void *user, const char *name) {
    survey *s = user;
    if (!strcmp(name, "FieldData"))
        s->fields = false;
    if (!strcmp(name, "Coordinates"))
        s->coordinates = false;
    return SNOW_STATUS_OK;
}

/* Returns where the numbers of an array begin; false if that is not in the
 * file. */
static bool find_numbers(const survey *s, const small_array *array,
                         uint64_t *out) {
    char blanks[BLANKS];
    *out = array->at;
    if (array->header.form != VTI_APPENDED)
        return true;
    size_t got =
        snow_seekable_read(s->from.bytes, s->appended, blanks, sizeof blanks);
    const char *mark = s->appended ? memchr(blanks, '_', got) : NULL;
    return mark && snow_add_u64(s->appended + (uint64_t)(mark - blanks) + 1,
                                array->header.offset, out);
}

/* Reads the numbers of an array from a source of their bytes. */
static snow_status decode(snow_source *source, const survey *s,
                          const small_array *array, int64_t count,
                          const char *what, double **out) {
    vti_header header = array->header;
    const vtk_line line = {what, count, header.form == VTI_ASCII,
                           header.big_endian, header.array.type};
    header.raw = s->raw && header.form == VTI_APPENDED;
    if (!line.text)
        SNOW_TRY(snow_vti_begin_numbers(
            source, &header, (uint64_t)count * snow_type_size(line.type)));
    return snow_vtk_read_line(source, &line, out);
}

static snow_status read_array(snow_source *source, const survey *s,
                              const small_array *array, int64_t count,
                              const char *what, double **out) {
    snow_context *context = snow_source_context(source);
    uint64_t at;
    if (!find_numbers(s, array, &at))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%s are not in the file; write it again", what);
    if (count > CF_MOST_COORDINATES)
        count = CF_MOST_COORDINATES + 1; /* refused where they are read */
    size_t capacity = (size_t)count * NUMBER_BYTES + BEFORE_BYTES;
    char *block = snow_allocate(context, capacity);
    if (!block)
        return SNOW_STATUS_NO_MEMORY;
    size_t got = snow_seekable_read(s->from.bytes, at, block, capacity);
    snow_source *numbers;
    snow_status status = snow_source_open_memory(
        context, snow_source_name(source), block, got, &numbers);
    if (status == SNOW_STATUS_OK) {
        status = decode(numbers, s, array, count, what, out);
        snow_source_close(numbers);
    }
    snow_release(context, block);
    return status;
}

/* A damaged time leaves the values as they are. */
static snow_status take_time(snow_source *source, const survey *s,
                             vti_small *out) {
    double *value = NULL;
    if (!s->time.found)
        return SNOW_STATUS_OK;
    snow_status status = read_array(source, s, &s->time, 1, "its time", &value);
    if (status == SNOW_STATUS_OK)
        out->time = *value;
    snow_release(snow_source_context(source), value);
    return status == SNOW_STATUS_NO_MEMORY ? status : SNOW_STATUS_OK;
}

static snow_status take_all(snow_source *source, survey *s, vti_small *out) {
    /* Whatever is wrong with the text, the reader of the values finds too. */
    if (snow_index_parse_text(&s->xml) == SNOW_STATUS_NO_MEMORY)
        return SNOW_STATUS_NO_MEMORY;
    SNOW_TRY(take_time(source, s, out));
    for (int i = 0; i < 3; i++)
        if (s->axis[i].found && s->sized)
            SNOW_TRY(read_array(source, s, &s->axis[i], s->points[i],
                                "its coordinates", &out->coordinates[i]));
    return SNOW_STATUS_OK;
}

snow_status snow_vti_survey(snow_source *source, snow_seekable *bytes,
                            bool rectilinear, vti_small *out) {
    static const index_xml handlers = {.begin = begin_element,
                                       .end = end_element};
    snow_context *context = snow_source_context(source);
    survey *s = snow_allocate(context, sizeof *s);
    *out = (vti_small){.time = NAN};
    if (!s)
        return SNOW_STATUS_NO_MEMORY;
    *s = (survey){.from = {.bytes = bytes},
                  .rectilinear = rectilinear,
                  .xml = {.context = context,
                          .handlers = &handlers,
                          .user = s,
                          .next = snow_index_next,
                          .from = &s->from}};
    snow_status status = take_all(source, s, out);
    snow_release(context, s);
    return status;
}
