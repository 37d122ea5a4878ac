/* transfer/formats/xml.c - 3D Slicer's presets: MRML, XML whose VolumeProperty
 * elements hold the lists of a .vp file as attributes.  A file of presets has
 * many, one of which is selected by name. */
#include "transfer/formats/tf.h"

#include <stdio.h>
#include <string.h>

#if SNOW_HAVE_EXPAT
#include <expat.h>

typedef struct reading {
    const tf_input *in;
    snow_look_file *tf;
    XML_Parser parser;
    snow_status status;
    int found;  /* number of VolumeProperty elements so far */
    bool taken; /* the transfer function was found */
} reading;

static const char *attribute(const XML_Char **pairs, const char *name) {
    for (; pairs[0]; pairs += 2)
        if (strcmp(pairs[0], name) == 0)
            return pairs[1];
    return NULL;
}

static void begin_element(void *user, const XML_Char *name,
                          const XML_Char **pairs) {
    reading *r = user;
    if (strcmp(name, "VolumeProperty") != 0 || r->status != SNOW_STATUS_OK)
        return;
    const char *own = attribute(pairs, "name");
    bool wanted = r->in->wanted ? own && tf_is_wanted(r->in, own) : !r->found;
    r->found++;
    if (!wanted || r->taken)
        return;
    r->taken = true;
    tf_set_name(r->tf, own ? own : "slicer");
    r->status = tf_read_slicer_lists(
        r->in, r->tf, attribute(pairs, "scalarOpacity"),
        attribute(pairs, "gradientOpacity"), attribute(pairs, "colorTransfer"));
}

/* Entities could grow without bound; presets have none. */
static void begin_doctype(void *user, const XML_Char *name,
                          const XML_Char *system, const XML_Char *public,
                          int internal) {
    reading *r = user;
    (void)name;
    (void)system;
    (void)public;
    if (internal && r->status == SNOW_STATUS_OK) {
        r->status =
            tf_fail(r->in, "has a document type declaration; remove it");
        XML_StopParser(r->parser, XML_FALSE);
    }
}

static snow_status report_end(const reading *r, enum XML_Status answer) {
    if (r->status != SNOW_STATUS_OK)
        return r->status;
    if (answer != XML_STATUS_OK)
        return tf_fail(r->in, "line %lu is not valid XML: %s; correct it",
                       (unsigned long)XML_GetCurrentLineNumber(r->parser),
                       XML_ErrorString(XML_GetErrorCode(r->parser)));
    if (!r->found)
        return tf_fail(r->in,
                       "has no VolumeProperty; give presets of 3D Slicer");
    if (!r->taken)
        return tf_fail(
            r->in,
            "has no preset '%.64s' among its %d; the names are in the file",
            r->in->wanted, r->found);
    if (r->found > 1 && !r->in->wanted)
        snow_context_warn(r->in->context,
                          "%s: has %d presets and the first, %s, is used; "
                          "select another with FILE#NAME",
                          r->in->name, r->found, r->tf->name);
    return SNOW_STATUS_OK;
}

snow_status tf_read_xml(const tf_input *in, snow_look_file *tf) {
    reading r = {.in = in, .tf = tf, .status = SNOW_STATUS_OK};
    r.parser = XML_ParserCreate(NULL);
    if (!r.parser)
        return snow_context_fail(
            in->context, SNOW_STATUS_NO_MEMORY,
            "out of memory to read %s; close other programs", in->name);
    XML_SetUserData(r.parser, &r);
    XML_SetStartElementHandler(r.parser, begin_element);
    XML_SetStartDoctypeDeclHandler(r.parser, begin_doctype);
    enum XML_Status answer =
        XML_Parse(r.parser, in->bytes, (int)in->size, XML_TRUE);
    snow_status status = report_end(&r, answer);
    XML_ParserFree(r.parser);
    tf->format = "slicer-xml";
    return status;
}

#else

snow_status tf_read_xml(const tf_input *in, snow_look_file *tf) {
    (void)tf;
    return tf_fail(
        in,
        "is XML, but this build lacks expat; build with expat, or give a .vp");
}

#endif
