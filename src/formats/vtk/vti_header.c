/* formats/vtk/vti_header.c - reads the XML text of a VTI file, with expat.
 *
 * The text is read only up to the numbers of the requested array.  These are
 * read from the source, whether in the element or appended after the text,
 * where raw bytes are not valid XML.
 *
 * The array is selected by name; by default it is the one that the file calls
 * its scalars, otherwise the first; arrays of points have priority over those
 * of cells. */
#include "formats/bytes/lz4.h"
#include "formats/features.h"
#include "formats/vtk/vti.h"

#if SNOW_HAVE_EXPAT

#include <expat.h>
#include <string.h>

/* Limit for sums of indices, far above any grid. */
#define MOST_INDEX ((int64_t)1 << 40)

/* How good a choice an array is. */
enum { UNWANTED, LAST_RESORT, WANTED };

typedef struct vti_text {
    snow_context *context;
    const snow_volume_options *options;
    vti_header *header;
    XML_Parser parser;
    snow_status status; /* why the parser was stopped */
    bool done;          /* ... successfully, at the data */
    uint64_t end;       /* end of the tag before them, in bytes of the text */
    bool file, grid, piece; /* these elements were found */
    bool ignored;           /* inside a later piece */
    bool points, cells;     /* inside PointData, CellData */
    bool any_points;        /* arrays of points were found */
    char scalars[256];      /* the name of the section's scalars */
    int choice;             /* how good header->array is */
    char seen[512];         /* names of arrays so far, for messages */
} vti_text;

const char *snow_vti_attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (!strcmp(*attributes, name))
            return attributes[1];
    return NULL;
}

/* Stops the parser: with SNOW_STATUS_OK at the data. */
static void stop(vti_text *text, snow_status status) {
    text->status = status;
    text->done = status == SNOW_STATUS_OK;
    text->end = (uint64_t)XML_GetCurrentByteIndex(text->parser) +
                (uint64_t)XML_GetCurrentByteCount(text->parser);
    XML_StopParser(text->parser, XML_FALSE);
}

static void fail_header(vti_text *text, const char *reason) {
    stop(text, snow_fail(text->context, SNOW_STATUS_BAD_INPUT, "%s", reason));
}

/* Splits off the next word of a text of numbers; returns false at the end. */
static bool next_word(const char **at, char word[64]) {
    *at += strspn(*at, " \t\r\n");
    size_t length = strcspn(*at, " \t\r\n");
    if (!length || length >= 64)
        return false;
    memcpy(word, *at, length);
    word[length] = 0;
    *at += length;
    return true;
}

/* Parses exactly `count` real numbers; a missing attribute leaves the numbers
 * unchanged. */
static bool take_reals(const char *value, int count, double *out) {
    char word[64];
    if (!value)
        return true;
    for (int i = 0; i < count; i++)
        if (!next_word(&value, word) || !snow_parse_double(word, &out[i]))
            return false;
    return !value[strspn(value, " \t\r\n")];
}

bool snow_vti_take_extent(const char *value, int64_t first[3],
                          int64_t points[3]) {
    char word[64];
    int64_t ends[6];
    if (!value)
        return false;
    for (int i = 0; i < 6; i++)
        if (!next_word(&value, word) || !snow_parse_int64(word, &ends[i]) ||
            ends[i] < -MOST_INDEX || ends[i] > MOST_INDEX)
            return false;
    for (int i = 0; i < 3; i++) {
        first[i] = ends[2 * i];
        points[i] = ends[2 * i + 1] - ends[2 * i] + 1;
        if (points[i] < 1)
            return false;
    }
    return true;
}

static const char lz4_name[] = "vtkLZ4DataCompressor";

void snow_vti_file_form(vti_header *header, const char **attributes) {
    const char *order = snow_vti_attribute(attributes, "byte_order");
    const char *count = snow_vti_attribute(attributes, "header_type");
    const char *compressor = snow_vti_attribute(attributes, "compressor");
    header->big_endian = order && !strcmp(order, "BigEndian");
    header->count_bytes = count && !strcmp(count, "UInt64") ? 8 : 4;
    header->packed = compressor && *compressor;
    if (header->packed && !strcmp(compressor, lz4_name))
        header->unpack = snow_lz4_unpack;
}

static void begin_file(vti_text *text, const char **attributes) {
    const char *type = snow_vti_attribute(attributes, "type");
    const char *compressor = snow_vti_attribute(attributes, "compressor");
    const char *wanted =
        text->header->grid.rectilinear ? "RectilinearGrid" : "ImageData";
    text->file = true;
    snow_vti_file_form(text->header, attributes);
    if (!type || strcmp(type, wanted) != 0)
        fail_header(text, snow_vtk_other(type));
    else if (text->header->unpack) {
        if (snow_lz4_need(text->context) != SNOW_STATUS_OK)
            stop(text, SNOW_STATUS_BAD_INPUT);
    } else if (text->header->packed &&
               strcmp(compressor, "vtkZLibDataCompressor") != 0)
        fail_header(text, "its data are compressed neither by zlib nor LZ4; "
                          "write it again with vtkZLibDataCompressor or "
                          "without compression");
}

static void begin_grid(vti_text *text, const char **attributes) {
    vtk_grid *grid = &text->header->grid;
    double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    text->grid = true;
    if (!snow_vti_take_extent(snow_vti_attribute(attributes, "WholeExtent"),
                              grid->first, grid->points) ||
        !take_reals(snow_vti_attribute(attributes, "Origin"), 3,
                    grid->origin) ||
        !take_reals(snow_vti_attribute(attributes, "Spacing"), 3,
                    grid->spacing) ||
        !take_reals(snow_vti_attribute(attributes, "Direction"), 9, direction))
        fail_header(text,
                    "its WholeExtent, Origin, Spacing or Direction is empty "
                    "or not a row of numbers; write the file again");
    for (int i = 0; i < 9; i++)
        grid->direction[i / 3][i % 3] = direction[i];
}

/* The text ended before any usable data. */
static snow_status fail_unfound(const vti_text *text) {
    if (!*text->seen)
        return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                         "has no array of values; write one with the image");
    if (text->options->dataset)
        return snow_fail(text->context, SNOW_STATUS_BAD_USAGE,
                         "--dataset %.100s: there is no such array; the file "
                         "has %s",
                         text->options->dataset, text->seen);
    return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                     "lacks the array that it calls its scalars; choose one "
                     "with --dataset: %s",
                     text->seen);
}

/* A piece that does not span the whole is one of several, each of which is read
 * by itself; later ones are not looked at then. */
static void begin_piece(vti_text *text, const char **attributes) {
    vti_header *header = text->header;
    vtk_grid *grid = &header->grid;
    int64_t first[3], points[3];
    text->ignored = text->piece; /* the one before was taken */
    if (text->ignored) {
        if (!text->choice)
            stop(text, fail_unfound(text));
        return;
    }
    const bool valid =
        text->grid &&
        snow_vti_take_extent(snow_vti_attribute(attributes, "Extent"), first,
                             points);
    text->piece = true;
    if (header->one_piece && valid) {
        memcpy(grid->first, first, sizeof first);
        memcpy(grid->points, points, sizeof points);
    } else if (!valid || memcmp(first, grid->first, sizeof first) != 0 ||
               memcmp(points, grid->points, sizeof points) != 0) {
        header->in_pieces = text->grid && !grid->rectilinear;
        if (header->in_pieces)
            stop(text, SNOW_STATUS_OK);
        else
            fail_header(text,
                        "has no piece that spans the WholeExtent; write the "
                        "whole grid to one file");
    }
}

static void begin_section(vti_text *text, const char **attributes,
                          bool points) {
    const char *scalars = snow_vti_attribute(attributes, "Scalars");
    text->points = points && !text->ignored;
    text->cells = !points && !text->ignored;
    *text->scalars = 0;
    if (scalars && strlen(scalars) < sizeof text->scalars)
        memcpy(text->scalars, scalars, strlen(scalars) + 1);
}

static int judge(const vti_text *text, const char *name) {
    const char *asked = text->options->dataset;
    if (asked)
        return strcmp(asked, name) ? UNWANTED : WANTED;
    if (text->cells && text->any_points)
        return UNWANTED;
    if (*text->scalars)
        return strcmp(text->scalars, name) ? LAST_RESORT : WANTED;
    return WANTED;
}

static void remember(vti_text *text, const char *name) {
    size_t used = strlen(text->seen);
    if (used + strlen(name) + 3 > sizeof text->seen)
        return;
    if (used) {
        memcpy(text->seen + used, ", ", 3);
        used += 2;
    }
    memcpy(text->seen + used, name, strlen(name) + 1);
}

static snow_type type_named(const char *name) {
    static const char *const names[] = {"Int8",    "UInt8",  "Int16", "UInt16",
                                        "Int32",   "UInt32", "Int64", "UInt64",
                                        "Float32", "Float64"};
    for (int i = 0; i < 10 && name; i++)
        if (!strcmp(name, names[i]))
            return (snow_type)(SNOW_TYPE_INT8 + i);
    return SNOW_TYPE_NONE;
}

bool snow_vti_keep_array(vti_header *header, const char **attributes,
                         const char *name, bool cells) {
    const char *form = snow_vti_attribute(attributes, "format");
    const char *channels = snow_vti_attribute(attributes, "NumberOfComponents");
    const char *offset = snow_vti_attribute(attributes, "offset");
    int64_t at = 0;
    header->array = (vtk_array){
        .cells = cells,
        .type = type_named(snow_vti_attribute(attributes, "type")),
        .channels = 1,
    };
    if (strlen(name) >= sizeof header->array.name || !form)
        return false;
    memcpy(header->array.name, name, strlen(name) + 1);
    if (!strcmp(form, "ascii"))
        header->form = VTI_ASCII;
    else if (!strcmp(form, "binary"))
        header->form = VTI_BINARY;
    else if (!strcmp(form, "appended"))
        header->form = VTI_APPENDED;
    else
        return false;
    if (header->form == VTI_APPENDED &&
        (!offset || !snow_parse_int64(offset, &at) || at < 0))
        return false;
    header->offset = (uint64_t)at;
    return header->array.type &&
           (!channels || snow_parse_int64(channels, &header->array.channels)) &&
           header->array.channels >= 1;
}

static void begin_array(vti_text *text, const char **attributes) {
    const char *name = snow_vti_attribute(attributes, "Name");
    if (!text->points && !text->cells)
        return;
    if (!name)
        name = "";
    int choice = judge(text, name);
    text->any_points = text->any_points || text->points;
    remember(text, name);
    if (choice <= text->choice)
        return;
    if (!snow_vti_keep_array(text->header, attributes, name, text->cells)) {
        if (choice == WANTED)
            fail_header(text,
                        "its array has an unknown type, format, offset or "
                        "number of components; choose another with --dataset");
        return;
    }
    /* Data in the element can be read only now, although better arrays may
     * follow. */
    if (text->header->form != VTI_APPENDED && choice != WANTED)
        return;
    text->choice = choice;
    if (text->header->form != VTI_APPENDED)
        stop(text, SNOW_STATUS_OK);
}

static void XMLCALL begin_element(void *user, const char *name,
                                  const char **attributes) {
    vti_text *text = user;
    if (text->status != SNOW_STATUS_OK || text->done)
        return;
    if (!text->file && strcmp(name, "VTKFile") != 0)
        fail_header(text, "is XML, but not a VTK file; give a .vti file");
    else if (!strcmp(name, "VTKFile"))
        begin_file(text, attributes);
    else if (!strcmp(name, "ImageData") || !strcmp(name, "RectilinearGrid"))
        begin_grid(text, attributes);
    else if (!strcmp(name, "Piece"))
        begin_piece(text, attributes);
    else if (!strcmp(name, "PointData") && text->piece)
        begin_section(text, attributes, true);
    else if (!strcmp(name, "CellData") && text->piece)
        begin_section(text, attributes, false);
    else if (!strcmp(name, "DataArray"))
        begin_array(text, attributes);
    else if (!strcmp(name, "AppendedData")) {
        const char *encoding = snow_vti_attribute(attributes, "encoding");
        text->header->raw = encoding && !strcmp(encoding, "raw");
        if (!text->header->raw &&
            (!encoding || strcmp(encoding, "base64") != 0))
            fail_header(
                text, "its appended data are neither raw nor base64; write the "
                      "file again");
        else if (text->choice)
            stop(text, SNOW_STATUS_OK);
    }
}

static void XMLCALL end_element(void *user, const char *name) {
    vti_text *text = user;
    if (!strcmp(name, "PointData"))
        text->points = false;
    else if (!strcmp(name, "CellData"))
        text->cells = false;
}

/* Entities could expand a small file without bound; VTK writes none. */
static void XMLCALL begin_doctype(void *user, const char *name,
                                  const char *system, const char *public,
                                  int inner) {
    (void)name;
    (void)system;
    (void)public;
    (void)inner;
    fail_header(user, "has a document type declaration, which VTK files do not "
                      "have; remove it");
}

static snow_status fail_syntax(const vti_text *text) {
    return snow_fail(
        text->context, SNOW_STATUS_BAD_INPUT,
        "its XML is damaged in line %lu (%s); get or write the file again",
        (unsigned long)XML_GetCurrentLineNumber(text->parser),
        XML_ErrorString(XML_GetErrorCode(text->parser)));
}

/* The parser sees bytes before they are consumed; they are consumed only up to
 * the end of the tag before the data. */
static snow_status feed(snow_source *source, vti_text *text) {
    uint64_t fed = 0;
    for (;;) {
        char bytes[SNOW_PEEK_BYTES];
        size_t got;
        SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &got));
        enum XML_Status answer =
            XML_Parse(text->parser, bytes, (int)got, got == 0);
        if (text->status != SNOW_STATUS_OK)
            return text->status;
        text->header->numbers = text->end;
        if (text->done)
            return snow_source_skip(source, text->end - fed, "the header");
        if (answer != XML_STATUS_OK)
            return XML_GetErrorCode(text->parser) == XML_ERROR_NO_MEMORY
                       ? snow_fail(text->context, SNOW_STATUS_NO_MEMORY,
                                   "out of memory to read XML")
                       : fail_syntax(text);
        if (!got)
            return fail_unfound(text);
        SNOW_TRY(snow_source_skip(source, got, "the header"));
        fed += got;
        XML_Index at = XML_GetCurrentByteIndex(text->parser);
        if (at >= 0 && fed - (uint64_t)at > SNOW_XML_TAG_BYTES)
            return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                             "has a tag of more than %llu bytes; it is damaged "
                             "or not a VTI file",
                             (unsigned long long)SNOW_XML_TAG_BYTES);
    }
}

snow_status snow_vti_read_header(snow_source *source,
                                 const snow_volume_options *options,
                                 vti_header *header) {
    snow_context *context = snow_source_context(source);
    vti_text text = {.context = context, .options = options, .header = header};
    const bool rectilinear = header->grid.rectilinear;
    const bool one_piece = header->one_piece;
    *header =
        (vti_header){.grid = snow_vtk_grid_default(), .one_piece = one_piece};
    header->grid.rectilinear = rectilinear;
    text.parser = XML_ParserCreate(NULL);
    if (!text.parser)
        return snow_fail(context, SNOW_STATUS_NO_MEMORY,
                         "out of memory to read XML");
    XML_SetUserData(text.parser, &text);
    XML_SetElementHandler(text.parser, begin_element, end_element);
    XML_SetStartDoctypeDeclHandler(text.parser, begin_doctype);
    snow_status status = feed(source, &text);
    XML_ParserFree(text.parser);
    return status;
}

#else

snow_status snow_vti_read_header(snow_source *source,
                                 const snow_volume_options *options,
                                 vti_header *header) {
    (void)options;
    (void)header;
    return snow_fail_unbuilt(snow_source_context(source),
                             "VTI and VTR, which need a reader of XML",
                             "libexpat1-dev");
}

#endif
