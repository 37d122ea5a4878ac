/* formats/index/xml.c - an XML file, handed out element by element, by expat.
 *
 * Entities could expand a small file without bound; these files have none. */
#include "formats/features.h"
#include "formats/index/index.h"

#include <stdio.h>
#include <string.h>

const char *snow_index_attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (!strcmp(*attributes, name))
            return attributes[1];
    return NULL;
}

/* Bytes of a file that names others: more steps than any series has. */
#define MOST_TEXT ((uint64_t)256 << 20)

typedef struct named_text {
    snow_source *source;
    uint64_t fed;
} named_text;

static snow_status next_bytes(void *user, char *bytes, size_t size,
                              size_t *got) {
    named_text *n = user;
    if (n->fed > MOST_TEXT)
        return snow_fail(snow_source_context(n->source), SNOW_STATUS_BAD_INPUT,
                         "has more than %llu bytes of XML; name fewer steps",
                         (unsigned long long)MOST_TEXT);
    SNOW_TRY(snow_source_read(n->source, bytes, size, got));
    n->fed += *got;
    return SNOW_STATUS_OK;
}

snow_status snow_index_parse(snow_source *source, const index_xml *handlers,
                             void *user) {
    named_text named = {.source = source};
    index_text text = {.context = snow_source_context(source),
                       .handlers = handlers,
                       .user = user,
                       .next = next_bytes,
                       .from = &named};
    return snow_index_parse_text(&text);
}

snow_status snow_index_next(void *from, char *bytes, size_t size, size_t *got) {
    index_bytes *b = from;
    *got = snow_seekable_read(b->bytes, b->at, bytes, size);
    b->at += *got;
    return SNOW_STATUS_OK;
}

#if SNOW_HAVE_EXPAT

#include <expat.h>

typedef struct parse {
    index_text *text;
    XML_Parser parser;
    snow_status status;
} parse;

/* expat may hand out more after it was stopped. */
static bool is_stopped(const parse *p) {
    return p->status != SNOW_STATUS_OK || p->text->done;
}

static void go_on(parse *p, snow_status status) {
    p->status = status;
    if (is_stopped(p))
        XML_StopParser(p->parser, XML_FALSE);
}

static void XMLCALL begin_element(void *user, const char *name,
                                  const char **attributes) {
    parse *p = user;
    index_text *text = p->text;
    if (is_stopped(p))
        return;
    text->at = (uint64_t)XML_GetCurrentByteIndex(p->parser);
    text->end = text->at + (uint64_t)XML_GetCurrentByteCount(p->parser);
    go_on(p, text->handlers->begin(text->user, name, attributes));
}

static void XMLCALL end_element(void *user, const char *name) {
    parse *p = user;
    if (!is_stopped(p) && p->text->handlers->end)
        go_on(p, p->text->handlers->end(p->text->user, name));
}

static void XMLCALL take_text(void *user, const char *at, int length) {
    parse *p = user;
    if (!is_stopped(p) && p->text->handlers->text)
        go_on(p, p->text->handlers->text(p->text->user, at, (size_t)length));
}

static void XMLCALL declare_entity(void *user, const char *name, int parameter,
                                   const char *value, int length,
                                   const char *base, const char *system,
                                   const char *public, const char *notation) {
    (void)name, (void)parameter, (void)value, (void)length;
    (void)base, (void)system, (void)public, (void)notation;
    go_on(user, snow_fail(((parse *)user)->text->context, SNOW_STATUS_BAD_INPUT,
                          "declares entities, which such files do not have; "
                          "remove them"));
}

static snow_status fail_text(const parse *p) {
    const enum XML_Error error = XML_GetErrorCode(p->parser);
    char line[40];
    if (error == XML_ERROR_NO_MEMORY)
        return snow_fail(p->text->context, SNOW_STATUS_NO_MEMORY,
                         "out of memory to read XML");
    snprintf(line, sizeof line, "in line %lu",
             (unsigned long)XML_GetCurrentLineNumber(p->parser));
    return snow_fail(p->text->context, SNOW_STATUS_BAD_INPUT,
                     "its XML is damaged %s (%s); get or write the file again",
                     p->text->where ? p->text->where : line,
                     XML_ErrorString(error));
}

static snow_status feed(parse *p) {
    index_text *text = p->text;
    for (uint64_t fed = text->before ? strlen(text->before) : 0;;) {
        char bytes[SNOW_PEEK_BYTES];
        size_t got;
        SNOW_TRY(text->next(text->from, bytes, sizeof bytes, &got));
        const enum XML_Status answer =
            XML_Parse(p->parser, bytes, (int)got, got == 0);
        if (is_stopped(p))
            return p->status;
        if (answer != XML_STATUS_OK)
            return fail_text(p);
        if (!got)
            return SNOW_STATUS_OK;
        fed += got;
        const XML_Index begun = XML_GetCurrentByteIndex(p->parser);
        if (begun >= 0 && fed > (uint64_t)begun + SNOW_XML_TAG_BYTES)
            return snow_fail(text->context, SNOW_STATUS_BAD_INPUT,
                             "has a tag or a comment of more than %llu bytes; "
                             "it is damaged, get or write it again",
                             (unsigned long long)SNOW_XML_TAG_BYTES);
    }
}

snow_status snow_index_parse_text(index_text *text) {
    parse p = {.text = text, .parser = XML_ParserCreate(NULL)};
    const char *before = text->before ? text->before : "";
    if (!p.parser)
        return snow_fail(text->context, SNOW_STATUS_NO_MEMORY,
                         "out of memory to read XML");
    snow_status status = SNOW_STATUS_OK;
    if (XML_Parse(p.parser, before, (int)strlen(before), XML_FALSE) !=
        XML_STATUS_OK)
        status = fail_text(&p);
    XML_SetUserData(p.parser, &p);
    XML_SetElementHandler(p.parser, begin_element, end_element);
    XML_SetCharacterDataHandler(p.parser, take_text);
    XML_SetEntityDeclHandler(p.parser, declare_entity);
    if (status == SNOW_STATUS_OK)
        status = feed(&p);
    XML_ParserFree(p.parser);
    return status;
}

#else

snow_status snow_index_parse_text(index_text *text) {
    return snow_fail_unbuilt(text->context, "a reader of XML", "libexpat1-dev");
}

#endif
