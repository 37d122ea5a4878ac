/* formats/vtk/vti_pieces.c - files of image data in several pieces.
 *
 *     <VTKFile> <ImageData> <Piece> ... </Piece> <Piece> ... </Piece> ...
 *     |<-------- head ---->|                     |<-- a piece, and all behind
 *
 * Each piece is read as a file of its own, made of the head and what begins
 * with its tag; its array may be among appended data behind all of them.  The
 * parts are joined by formats/index/mosaic.c. */
#include "formats/index/index.h"
#include "formats/vtk/vti.h"

#include <stdio.h>
#include <string.h>

/* The text behind a piece is read once for each, up to the appended data. */
#define MOST_PIECES 4096

/* A point at a corner belongs to eight pieces. */
#define MOST_SHARED 8

typedef struct vti_pieces {
    snow_source *source;
    snow_context *context;
    snow_seekable *bytes;
    const vti_header *whole;
    const vti_small *small;
    index_bytes from;
    index_text xml;
    uint64_t head;                /* bytes before the first one's tag */
    uint64_t places[MOST_PIECES]; /* of their tags */
    size_t count;
    double points; /* of all pieces */
    bool appended; /* their data begin, and nothing else follows */
} vti_pieces;

static snow_status fail_pieces(const vti_pieces *p, const char *reason) {
    return snow_fail(p->context, SNOW_STATUS_BAD_INPUT, "%s", reason);
}

/* Pieces without points are left out: a rank had none. */
static snow_status take_piece(vti_pieces *p, const char **attributes) {
    const vtk_grid *grid = &p->whole->grid;
    int64_t first[3], points[3];
    double all = 1, whole = 1;
    p->head = p->head ? p->head : p->xml.at;
    if (!snow_vti_take_extent(snow_index_attribute(attributes, "Extent"), first,
                              points))
        return SNOW_STATUS_OK;
    for (int i = 0; i < 3; i++) {
        if (first[i] < grid->first[i] ||
            first[i] + points[i] > grid->first[i] + grid->points[i])
            return fail_pieces(
                p,
                "has a piece outside of the WholeExtent; write the file again");
        all *= (double)points[i];
        whole *= (double)grid->points[i];
    }
    p->points += all;
    if (p->count == MOST_PIECES || p->points > MOST_SHARED * whole)
        return fail_pieces(p, "has more than 4096 pieces, or pieces that "
                              "overlap; write the whole image to one file");
    p->places[p->count++] = p->xml.at;
    return SNOW_STATUS_OK;
}

static snow_status begin_element(void *user, const char *name,
                                 const char **attributes) {
    vti_pieces *p = user;
    p->appended = p->xml.done = !strcmp(name, "AppendedData");
    return strcmp(name, "Piece") ? SNOW_STATUS_OK : take_piece(p, attributes);
}

/* The bytes of the head, then those from a piece on. */
typedef struct spliced {
    snow_seekable *bytes;
    uint64_t head, shift;
} spliced;

static size_t read_spliced(void *user, uint64_t at, void *bytes, size_t size) {
    const spliced *s = user;
    size_t got = 0;
    if (at < s->head) {
        const size_t most = size < s->head - at ? size : (size_t)(s->head - at);
        got = snow_seekable_read(s->bytes, at, bytes, most);
        if (got < most)
            return got;
    }
    return got + snow_seekable_read(s->bytes, at + got + s->shift,
                                    (char *)bytes + got, size - got);
}

static void name_piece(void *user, size_t index, char name[INDEX_NAME_BYTES]) {
    (void)user;
    snprintf(name, INDEX_NAME_BYTES, "piece %zu (counted from 0)", index);
}

static snow_status open_piece(void *user, size_t index,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    vti_pieces *p = user;
    spliced part = {p->bytes, p->head, p->places[index] - p->head};
    const uint64_t size = snow_seekable_size(p->bytes) - part.shift;
    const snow_bytes_behind behind = {read_spliced, &part, size};
    vti_header header = {.one_piece = true};
    snow_source *source;
    snow_volume *volume = NULL;
    SNOW_TRY(snow_source_open_with(p->context, snow_source_name(p->source),
                                   &behind, &source));
    *info = snow_volume_info_default("vti");
    snow_status status = snow_vti_read_values(
        source, &header, p->small, options, info, out ? &volume : NULL);
    /* Tags that stand behind numbers in elements were parsed. */
    header.numbers += part.shift;
    if (status == SNOW_STATUS_OK && out && !index && p->appended)
        status = snow_vti_check_tail(p->source, p->bytes, &header);
    snow_source_close(source);
    return snow_volume_give(status, volume, out);
}

snow_status snow_vti_read_pieces(snow_source *source, snow_seekable *bytes,
                                 const vti_header *whole,
                                 const vti_small *small,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out) {
    static const index_xml handlers = {.begin = begin_element};
    snow_context *context = snow_source_context(source);
    if (!bytes)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "has several pieces, which are not read from a packed "
                         "file or a pipe; unpack it into a file");
    vti_pieces *p = snow_allocate_clear(context, sizeof *p);
    if (!p)
        return SNOW_STATUS_NO_MEMORY;
    p->source = source;
    p->context = context;
    p->bytes = p->from.bytes = bytes;
    p->whole = whole;
    p->small = small;
    p->xml = (index_text){.context = context,
                          .handlers = &handlers,
                          .user = p,
                          .next = snow_index_next,
                          .from = &p->from};
    snow_status status = snow_index_parse_text(&p->xml);
    if (status == SNOW_STATUS_OK && p->count <= 1)
        status = fail_pieces(
            p, "has no piece that spans the WholeExtent; write the file again");
    const index_parts parts = {context, p->count, p, name_piece, open_piece};
    if (status == SNOW_STATUS_OK)
        status = snow_mosaic_read(&parts, options, info, out);
    snow_release(context, p);
    return status;
}
