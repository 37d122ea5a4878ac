/* formats/vtk/vti_tail.c - what stands behind the numbers of a VTI file.
 *
 *     ... numbers </DataArray> ... <AppendedData> _bytes </AppendedData>
 * </VTKFile> | parsed                  |           | parsed            |
 *
 * A file whose elements are not closed, or cross each other, is damaged.  The
 * numbers themselves are read elsewhere, and are not looked at twice; neither
 * are appended bytes, whose end is searched from the file's end. */
#include "formats/index/index.h"
#include "formats/vtk/vti.h"

#include <stdio.h>
#include <string.h>

/* So far before the file's end the appended data may end, at least. */
#define MOST_BEHIND ((uint64_t)1 << 20)

static const char end_tag[] = "</AppendedData";

typedef struct tail {
    snow_source *source;
    snow_seekable *bytes;
    index_bytes from;
    bool begun; /* the first tag was there */
    index_text xml;
    bool closed, appended; /* behind the last tag; at appended data */
} tail;

static snow_status begin_element(void *user, const char *name,
                                 const char **attributes) {
    tail *t = user;
    (void)attributes;
    t->appended = t->xml.done = !strcmp(name, "AppendedData");
    return SNOW_STATUS_OK;
}

static snow_status end_element(void *user, const char *name) {
    tail *t = user;
    t->closed = t->closed || !strcmp(name, "VTKFile");
    return SNOW_STATUS_OK;
}

/* From the first tag on. */
static snow_status next_bytes(void *user, char *bytes, size_t size,
                              size_t *got) {
    tail *t = user;
    const char *first = NULL;
    while (!first) {
        SNOW_TRY(snow_index_next(&t->from, bytes, size, got));
        first = t->begun || !*got ? bytes : memchr(bytes, '<', *got);
    }
    t->begun = true;
    *got -= (size_t)(first - bytes);
    memmove(bytes, first, *got);
    return SNOW_STATUS_OK;
}

/* Parses from the first tag on, at `from` or behind it, where the tags `before`
 * are open. */
static snow_status parse(tail *t, const char *before, uint64_t from) {
    t->xml.before = before;
    t->from = (index_bytes){t->bytes, from};
    t->begun = false;
    const snow_status status = snow_index_parse_text(&t->xml);
    if (status != SNOW_STATUS_BAD_INPUT || !t->closed)
        return status;
    snow_notify(t->xml.context, "%s: bytes after its last tag ignored",
                snow_source_name(t->source));
    return SNOW_STATUS_OK;
}

/* The last end of appended data, behind `from`. */
static bool find_end(const tail *t, uint64_t from, uint64_t *out) {
    const uint64_t size = snow_seekable_size(t->bytes);
    const size_t length = sizeof end_tag - 1;
    char block[4096];
    uint64_t at = size > MOST_BEHIND ? size - MOST_BEHIND : 0;
    bool found = false;
    for (size_t got = sizeof block; got == sizeof block;
         at += sizeof block - length) {
        at = at > from ? at : from;
        got = snow_seekable_read(t->bytes, at, block, sizeof block);
        const char *end = block + got;
        for (const char *tag = block;
             (tag = memchr(tag, '<', (size_t)(end - tag))); tag++)
            if ((size_t)(end - tag) >= length &&
                !memcmp(tag, end_tag, length)) {
                *out = at + (uint64_t)(tag - block);
                found = true;
            }
    }
    return found;
}

static snow_status check_appended(tail *t, uint64_t from) {
    if (!find_end(t, from, &from))
        return snow_fail(t->xml.context, SNOW_STATUS_BAD_INPUT,
                         "its appended data have no end; it is truncated, get "
                         "or write it again");
    t->appended = t->xml.done = false;
    return parse(t, "<VTKFile><AppendedData>", from);
}

/* The tags that are open where the numbers of an array are. */
static snow_status check_inline(tail *t, const vti_header *header,
                                uint64_t from) {
    char before[80];
    snprintf(before, sizeof before, "<VTKFile><%s><Piece><%s><DataArray>",
             header->grid.rectilinear ? "RectilinearGrid" : "ImageData",
             header->array.cells ? "CellData" : "PointData");
    SNOW_TRY(parse(t, before, from));
    return t->appended ? check_appended(t, from) : SNOW_STATUS_OK;
}

snow_status snow_vti_check_tail(snow_source *source, snow_seekable *bytes,
                                const vti_header *header) {
    static const index_xml handlers = {.begin = begin_element,
                                       .end = end_element};
    tail t = {.source = source,
              .bytes = bytes,
              .xml = {.context = snow_source_context(source),
                      .handlers = &handlers,
                      .user = &t,
                      .next = next_bytes,
                      .from = &t,
                      .where = "behind the array"}};
    const int64_t *dims = header->grid.uneven.count;
    uint64_t from = header->numbers + header->offset;
    if (!header->packed) /* a number has at least one byte */
        from += (uint64_t)(dims[0] * dims[1] * dims[2]);
    return header->form == VTI_APPENDED ? check_appended(&t, from)
                                        : check_inline(&t, header, from);
}
