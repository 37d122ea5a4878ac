/* formats/index/xml.c - an XML file, handed out element by element, by expat.
 *
 * These files name others and are small: their text is limited, and they must
 * not declare entities. */
#include "formats/features.h"
#include "formats/index/index.h"

#include <string.h>

const char *snow_index_attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (!strcmp(*attributes, name))
            return attributes[1];
    return NULL;
}

#if SNOW_HAVE_EXPAT

#include <expat.h>

/* Bytes of the text: more steps than any series has. */
#define MOST_TEXT ((uint64_t)256 << 20)

typedef struct parse {
    snow_context *context;
    XML_Parser parser;
    const index_xml *handlers;
    void *user;
    snow_status status;
} parse;

static void stop(parse *p, snow_status status) {
    if (status == SNOW_STATUS_OK || p->status != SNOW_STATUS_OK)
        return;
    p->status = status;
    XML_StopParser(p->parser, XML_FALSE);
}

static void XMLCALL begin_element(void *user, const char *name,
                                  const char **attributes) {
    parse *p = user;
    if (p->status == SNOW_STATUS_OK)
        stop(p, p->handlers->begin(p->user, name, attributes));
}

static void XMLCALL end(void *user, const char *name) {
    parse *p = user;
    if (p->status == SNOW_STATUS_OK && p->handlers->end)
        stop(p, p->handlers->end(p->user, name));
}

static void XMLCALL text(void *user, const char *at, int length) {
    parse *p = user;
    if (p->status == SNOW_STATUS_OK && p->handlers->text)
        stop(p, p->handlers->text(p->user, at, (size_t)length));
}

/* Entities could expand a small file without bound; these files have none. */
static void XMLCALL declare_entity(void *user, const char *name, int parameter,
                                   const char *value, int length,
                                   const char *base, const char *system,
                                   const char *public, const char *notation) {
    (void)name;
    (void)parameter;
    (void)value;
    (void)length;
    (void)base;
    (void)system;
    (void)public;
    (void)notation;
    stop(user, snow_fail(((parse *)user)->context, SNOW_STATUS_BAD_INPUT,
                         "declares entities, which such files do not have; "
                         "remove them"));
}

static snow_status feed(snow_source *source, parse *p) {
    for (uint64_t fed = 0;;) {
        char bytes[4096];
        size_t got;
        SNOW_TRY(snow_source_read(source, bytes, sizeof bytes, &got));
        enum XML_Status answer =
            XML_Parse(p->parser, bytes, (int)got, got == 0);
        if (p->status != SNOW_STATUS_OK)
            return p->status;
        if (answer != XML_STATUS_OK)
            return snow_fail(p->context, SNOW_STATUS_BAD_INPUT,
                             "its XML is damaged in line %lu (%s); get or "
                             "write the file again",
                             (unsigned long)XML_GetCurrentLineNumber(p->parser),
                             XML_ErrorString(XML_GetErrorCode(p->parser)));
        fed += got;
        if (!got)
            return SNOW_STATUS_OK;
        const XML_Index begun = XML_GetCurrentByteIndex(p->parser);
        if (begun >= 0 && fed - (uint64_t)begun > SNOW_XML_TAG_BYTES)
            return snow_fail(
                p->context, SNOW_STATUS_BAD_INPUT,
                "has a tag or a comment of more than %llu bytes "
                "in line %lu; it is damaged, get or write it "
                "again",
                (unsigned long long)SNOW_XML_TAG_BYTES,
                (unsigned long)XML_GetCurrentLineNumber(p->parser));
        if (fed > MOST_TEXT)
            return snow_fail(p->context, SNOW_STATUS_BAD_INPUT,
                             "has more than %llu bytes of XML; name fewer "
                             "steps",
                             (unsigned long long)MOST_TEXT);
    }
}

snow_status snow_index_parse(snow_source *source, const index_xml *handlers,
                             void *user) {
    parse p = {.context = snow_source_context(source),
               .handlers = handlers,
               .user = user};
    p.parser = XML_ParserCreate(NULL);
    if (!p.parser)
        return snow_fail(p.context, SNOW_STATUS_NO_MEMORY,
                         "out of memory to read XML");
    XML_SetUserData(p.parser, &p);
    XML_SetElementHandler(p.parser, begin_element, end);
    XML_SetCharacterDataHandler(p.parser, text);
    XML_SetEntityDeclHandler(p.parser, declare_entity);
    snow_status status = feed(source, &p);
    XML_ParserFree(p.parser);
    return status;
}

#else

snow_status snow_index_parse(snow_source *source, const index_xml *handlers,
                             void *user) {
    (void)handlers;
    (void)user;
    return snow_fail_unbuilt(snow_source_context(source), "a reader of XML",
                             "libexpat1-dev");
}

#endif
