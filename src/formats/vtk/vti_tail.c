/* formats/vtk/vti_tail.c - what stands behind the numbers of a VTI file.
 *
 *     ... numbers </DataArray> ... <AppendedData> _bytes </AppendedData>
 * </VTKFile> | parsed                  |           | parsed            |
 *
 * A file whose elements are not closed, or cross each other, is damaged.  The
 * numbers themselves are read elsewhere, and are not looked at twice; neither
 * are appended bytes, whose end is searched from the file's end. */
#include "formats/features.h"
#include "formats/vtk/vti.h"

#if SNOW_HAVE_EXPAT

#include <expat.h>
#include <stdio.h>
#include <string.h>

#define BLOCK_BYTES 65536

/* So far before the file's end the appended data may end, at least. */
#define MOST_BEHIND ((uint64_t)1 << 20)

static const char end_tag[] = "</AppendedData";

typedef struct tail {
    snow_source *source;
    snow_context *context;
    snow_seekable *bytes;
    XML_Parser parser;
    char *block;
    bool closed, appended; /* behind the last tag; at appended data */
} tail;

static void XMLCALL begin_element(void *user, const char *name,
                                  const char **attributes) {
    tail *t = user;
    (void)attributes;
    t->appended = !strcmp(name, "AppendedData");
    if (t->appended)
        XML_StopParser(t->parser, XML_FALSE);
}

static void XMLCALL end_element(void *user, const char *name) {
    tail *t = user;
    t->closed = t->closed || !strcmp(name, "VTKFile");
}

/* What the parser stopped at. */
static snow_status judge(const tail *t) {
    const enum XML_Error error = XML_GetErrorCode(t->parser);
    if (error == XML_ERROR_NO_MEMORY)
        return snow_fail(t->context, SNOW_STATUS_NO_MEMORY,
                         "out of memory to read XML");
    if (t->closed)
        snow_notify(t->context, "%s: bytes after its last tag ignored",
                    snow_source_name(t->source));
    if (t->closed || t->appended)
        return SNOW_STATUS_OK;
    return snow_fail(t->context, SNOW_STATUS_BAD_INPUT,
                     "its XML is damaged behind the array (%s); get or write "
                     "the file again",
                     XML_ErrorString(error));
}

/* Parses from the first tag on, at `from` or behind it. */
static snow_status feed(tail *t, uint64_t from) {
    bool tag = false;
    for (uint64_t fed = 0;;) {
        const size_t got =
            snow_seekable_read(t->bytes, from, t->block, BLOCK_BYTES);
        const char *first = tag ? t->block : memchr(t->block, '<', got);
        const size_t count = first ? got - (size_t)(first - t->block) : 0;
        from += got;
        fed += count;
        tag = first;
        if ((tag || !got) &&
            XML_Parse(t->parser, first, (int)count, !got) != XML_STATUS_OK)
            return judge(t);
        if (!got)
            return SNOW_STATUS_OK;
        const XML_Index begun = XML_GetCurrentByteIndex(t->parser);
        if (begun >= 0 && fed > (uint64_t)begun + SNOW_XML_TAG_BYTES)
            return snow_fail(t->context, SNOW_STATUS_BAD_INPUT,
                             "has a tag of more than %llu bytes; it is damaged",
                             (unsigned long long)SNOW_XML_TAG_BYTES);
    }
}

/* The same where the tags `before` are open. */
static snow_status parse(tail *t, const char *before, uint64_t from) {
    snow_status status;
    t->parser = XML_ParserCreate(NULL);
    if (!t->parser)
        return snow_fail(t->context, SNOW_STATUS_NO_MEMORY,
                         "out of memory to read XML");
    if (XML_Parse(t->parser, before, (int)strlen(before), XML_FALSE) !=
        XML_STATUS_OK) {
        status = judge(t);
    } else {
        XML_SetUserData(t->parser, t);
        XML_SetElementHandler(t->parser, begin_element, end_element);
        status = feed(t, from);
    }
    XML_ParserFree(t->parser);
    return status;
}

/* The last end of appended data, behind `from`. */
static bool find_end(const tail *t, uint64_t from, uint64_t *out) {
    const uint64_t size = snow_seekable_size(t->bytes);
    const size_t length = sizeof end_tag - 1;
    uint64_t at = size > MOST_BEHIND ? size - MOST_BEHIND : 0;
    bool found = false;
    for (size_t got = BLOCK_BYTES; got == BLOCK_BYTES;
         at += BLOCK_BYTES - length) {
        at = at > from ? at : from;
        got = snow_seekable_read(t->bytes, at, t->block, BLOCK_BYTES);
        const char *end = t->block + got;
        for (const char *tag = t->block;
             (tag = memchr(tag, '<', (size_t)(end - tag))); tag++)
            if ((size_t)(end - tag) >= length &&
                !memcmp(tag, end_tag, length)) {
                *out = at + (uint64_t)(tag - t->block);
                found = true;
            }
    }
    return found;
}

static snow_status check_appended(tail *t, uint64_t from) {
    if (!find_end(t, from, &from))
        return snow_fail(t->context, SNOW_STATUS_BAD_INPUT,
                         "its appended data have no end; it is truncated, get "
                         "or write it again");
    t->appended = false;
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
    snow_context *context = snow_source_context(source);
    tail t = {.source = source, .context = context, .bytes = bytes};
    const int64_t *dims = header->grid.uneven.count;
    uint64_t from = header->numbers + header->offset;
    if (!header->packed) /* a number has at least one byte */
        from += (uint64_t)(dims[0] * dims[1] * dims[2]);
    t.block = snow_allocate(context, BLOCK_BYTES);
    if (!t.block)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = header->form == VTI_APPENDED
                             ? check_appended(&t, from)
                             : check_inline(&t, header, from);
    snow_release(context, t.block);
    return status;
}

#else

snow_status snow_vti_check_tail(snow_source *source, snow_seekable *bytes,
                                const vti_header *header) {
    (void)source;
    (void)bytes;
    (void)header;
    return SNOW_STATUS_OK;
}

#endif
