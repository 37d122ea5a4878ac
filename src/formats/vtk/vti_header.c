/* formats/vtk/vti_header.c - reads the XML text of a VTI file, with expat.
 *
 * The text is read only up to the numbers of the requested array.  These are
 * read from the source, whether in the element or appended after the text,
 * where raw bytes are not valid XML.
 *
 * The array is selected by name; by default it is the one that the file calls
 * its scalars, otherwise the first; arrays of points have priority over those
 * of cells. */
#include "formats/ascii.h"
#include "formats/bytes/packed.h"
#include "formats/features.h"
#include "formats/index/index.h"
#include "formats/vtk/vti.h"

#include <string.h>

/* Limit for sums of indices, far above any grid. */
#define MOST_INDEX ((int64_t)1 << 40)

/* How good a choice an array is. */
enum { UNWANTED, LAST_RESORT, WANTED };

typedef struct vti_text {
    snow_context *context;
    const snow_volume_options *options;
    vti_header *header;
    snow_source *source;
    size_t ahead;   /* bytes of it that the parser has, but are not consumed */
    uint64_t fed;   /* those before them */
    index_text xml; /* done at the data */
    bool file, grid, piece; /* these elements were found */
    bool ignored;           /* inside a later piece */
    bool points, cells;     /* inside PointData, CellData */
    bool any_points;        /* arrays of points were found */
    char scalars[256];      /* the name of the section's scalars, */
    char vectors[256];      /* and vectors */
    int choice;             /* how good header->array is */
    char seen[512];         /* names of arrays so far, for messages */
} vti_text;

static snow_status fail_header(const vti_text *text, const char *reason) {
    return snow_fail(text->context, SNOW_STATUS_BAD_INPUT, "%s", reason);
}

/* Parses exactly `count` real numbers; a missing attribute leaves the numbers
 * unchanged. */
static bool take_reals(const char *value, int count, double *out) {
    return !value || snow_text_reals(value, "", out, count) == count;
}

bool snow_vti_take_extent(const char *value, int64_t first[3],
                          int64_t points[3]) {
    int64_t ends[16]; /* more than six are ignored */
    if (!value || snow_text_integers(value, "", ends, 16) < 6)
        return false;
    for (int i = 0; i < 6; i++)
        if (ends[i] < -MOST_INDEX || ends[i] > MOST_INDEX)
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
    const char *order = snow_index_attribute(attributes, "byte_order");
    const char *count = snow_index_attribute(attributes, "header_type");
    const char *compressor = snow_index_attribute(attributes, "compressor");
    header->big_endian = order && !strcmp(order, "BigEndian");
    header->count_bytes = count && !strcmp(count, "UInt64") ? 8 : 4;
    header->packed = compressor && *compressor;
    if (header->packed && !strcmp(compressor, lz4_name))
        header->unpack = snow_lz4_unpack;
}

static snow_status begin_file(vti_text *text, const char **attributes) {
    const char *type = snow_index_attribute(attributes, "type");
    const char *compressor = snow_index_attribute(attributes, "compressor");
    const char *wanted =
        text->header->grid.rectilinear ? "RectilinearGrid" : "ImageData";
    text->file = true;
    snow_vti_file_form(text->header, attributes);
    if (!type || strcmp(type, wanted) != 0)
        return fail_header(text, snow_vtk_other(type));
    if (text->header->unpack)
        return snow_lz4_need(text->context);
    if (text->header->packed &&
        strcmp(compressor, "vtkZLibDataCompressor") != 0)
        return fail_header(
            text, "its data are compressed neither by zlib nor LZ4; write it "
                  "again with vtkZLibDataCompressor or without compression");
    return SNOW_STATUS_OK;
}

static snow_status begin_grid(vti_text *text, const char **attributes) {
    vtk_grid *grid = &text->header->grid;
    double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    text->grid = true;
    if (!snow_vti_take_extent(snow_index_attribute(attributes, "WholeExtent"),
                              grid->first, grid->points) ||
        !take_reals(snow_index_attribute(attributes, "Origin"), 3,
                    grid->origin) ||
        !take_reals(snow_index_attribute(attributes, "Spacing"), 3,
                    grid->spacing) ||
        !take_reals(snow_index_attribute(attributes, "Direction"), 9,
                    direction))
        return fail_header(
            text, "its WholeExtent, Origin, Spacing or Direction is empty or "
                  "not a row of numbers; write the file again");
    for (int i = 0; i < 9; i++)
        grid->direction[i / 3][i % 3] = direction[i];
    return SNOW_STATUS_OK;
}

/* The text ended before any usable data. */
static snow_status fail_unfound(const vti_text *text) {
    if (!*text->seen)
        return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                         "has no array of values; write one with the image");
    if (text->options->dataset)
        return snow_fail(
            text->context, SNOW_STATUS_BAD_USAGE,
            "--dataset %.100s: there is no such array; the file has %s",
            text->options->dataset, text->seen);
    return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                     "lacks the array that it calls its scalars; choose one "
                     "with --dataset: %s",
                     text->seen);
}

/* A piece that does not span the whole is one of several, each of which is read
 * by itself; later ones are not looked at then. */
static snow_status begin_piece(vti_text *text, const char **attributes) {
    vti_header *header = text->header;
    vtk_grid *grid = &header->grid;
    int64_t first[3], points[3];
    text->ignored = text->piece; /* the one before was taken */
    if (text->ignored)
        return text->choice ? SNOW_STATUS_OK : fail_unfound(text);
    const bool valid =
        text->grid &&
        snow_vti_take_extent(snow_index_attribute(attributes, "Extent"), first,
                             points);
    text->piece = true;
    if (header->one_piece && valid) {
        memcpy(grid->first, first, sizeof first);
        memcpy(grid->points, points, sizeof points);
    } else if (!valid || memcmp(first, grid->first, sizeof first) != 0 ||
               memcmp(points, grid->points, sizeof points) != 0) {
        header->in_pieces = text->xml.done = text->grid && !grid->rectilinear;
        if (!header->in_pieces)
            return fail_header(text, "has no piece that spans the WholeExtent; "
                                     "write the whole grid to one file");
    }
    return SNOW_STATUS_OK;
}

static void take_name(const char **attributes, const char *kind,
                      char out[256]) {
    const char *name = snow_index_attribute(attributes, kind);
    *out = 0;
    if (name && strlen(name) < 256)
        memcpy(out, name, strlen(name) + 1);
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

bool snow_vti_keep_array(vti_header *header, const char **attributes,
                         const char *name, bool cells) {
    const char *form = snow_index_attribute(attributes, "format");
    const char *channels =
        snow_index_attribute(attributes, "NumberOfComponents");
    const char *offset = snow_index_attribute(attributes, "offset");
    const char *type = snow_index_attribute(attributes, "type");
    int64_t at = 0;
    header->array = (vtk_array){
        .cells = cells,
        .type = type ? snow_type_from_name(type) : SNOW_TYPE_NONE,
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

static snow_status begin_array(vti_text *text, const char **attributes) {
    const char *name = snow_index_attribute(attributes, "Name");
    if (!text->points && !text->cells)
        return SNOW_STATUS_OK;
    if (!name)
        name = "";
    int choice = judge(text, name);
    text->any_points = text->any_points || text->points;
    snow_list_add(text->seen, sizeof text->seen, "%s", name);
    if (choice <= text->choice)
        return SNOW_STATUS_OK;
    if (!snow_vti_keep_array(text->header, attributes, name, text->cells))
        return choice != WANTED
                   ? SNOW_STATUS_OK
                   : fail_header(
                         text,
                         "its array has an unknown type, format, offset or "
                         "number of components; choose another with --dataset");
    text->header->array.vectors = *name && !strcmp(name, text->vectors);
    /* Data in the element can be read only now, although better arrays may
     * follow. */
    const bool here = text->header->form != VTI_APPENDED;
    if (!here || choice == WANTED)
        text->choice = choice;
    text->xml.done = here && choice == WANTED;
    return SNOW_STATUS_OK;
}

static snow_status begin_appended(vti_text *text, const char **attributes) {
    const char *encoding = snow_index_attribute(attributes, "encoding");
    text->header->raw = encoding && !strcmp(encoding, "raw");
    if (!text->header->raw && (!encoding || strcmp(encoding, "base64") != 0))
        return fail_header(text, "its appended data are neither raw nor "
                                 "base64; write the file again");
    text->xml.done = text->choice;
    return SNOW_STATUS_OK;
}

static snow_status begin_element(void *user, const char *name,
                                 const char **attributes) {
    vti_text *text = user;
    if (!strcmp(name, "VTKFile"))
        return begin_file(text, attributes);
    if (!text->file)
        return fail_header(text,
                           "is XML, but not a VTK file; give a .vti file");
    if (!strcmp(name, "ImageData") || !strcmp(name, "RectilinearGrid"))
        return begin_grid(text, attributes);
    if (!strcmp(name, "Piece"))
        return begin_piece(text, attributes);
    if (!strcmp(name, "DataArray"))
        return begin_array(text, attributes);
    if (!strcmp(name, "AppendedData"))
        return begin_appended(text, attributes);
    const bool points = !strcmp(name, "PointData");
    if (text->piece && (points || !strcmp(name, "CellData"))) {
        text->points = points && !text->ignored;
        text->cells = !points && !text->ignored;
        take_name(attributes, "Scalars", text->scalars);
        take_name(attributes, "Vectors", text->vectors);
    }
    return SNOW_STATUS_OK;
}

static snow_status end_element(void *user, const char *name) {
    vti_text *text = user;
    if (!strcmp(name, "PointData"))
        text->points = false;
    else if (!strcmp(name, "CellData"))
        text->cells = false;
    return SNOW_STATUS_OK;
}

/* The parser sees bytes before they are consumed; they are consumed only up to
 * the end of the tag before the data. */
static snow_status next_bytes(void *user, char *bytes, size_t size,
                              size_t *got) {
    vti_text *text = user;
    SNOW_TRY(snow_source_skip(text->source, text->ahead, "the header"));
    text->fed += text->ahead;
    SNOW_TRY(snow_source_peek(text->source, bytes, size, got));
    text->ahead = *got;
    return SNOW_STATUS_OK;
}

snow_status snow_vti_read_header(snow_source *source,
                                 const snow_volume_options *options,
                                 vti_header *header) {
    static const index_xml handlers = {.begin = begin_element,
                                       .end = end_element};
    snow_context *context = snow_source_context(source);
    vti_text text = {.context = context,
                     .options = options,
                     .header = header,
                     .source = source,
                     .xml = {.context = context,
                             .handlers = &handlers,
                             .user = &text,
                             .next = next_bytes,
                             .from = &text}};
    const bool rectilinear = header->grid.rectilinear;
    const bool one_piece = header->one_piece;
    *header =
        (vti_header){.grid = snow_vtk_grid_default(), .one_piece = one_piece};
    header->grid.rectilinear = rectilinear;
    SNOW_TRY(snow_index_parse_text(&text.xml));
    if (!text.xml.done)
        return fail_unfound(&text);
    header->numbers = text.xml.end;
    return snow_source_skip(source, text.xml.end - text.fed, "the header");
}
