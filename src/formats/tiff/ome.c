/* formats/tiff/ome.c - what OME-XML says of an image: its axes, its channels,
 * and which page of which file has a plane.
 *
 *     <OME UUID="urn:uuid:1"> <Image Name="A"> <Pixels SizeC="2" SizeZ="41"
 * ...> <TiffData FirstZ="7" IFD="3"> <UUID FileName="b.tif">urn:uuid:2</UUID>
 *
 * It stands in the first page's description; a BinaryOnly element there says in
 * which file else. */
#include "formats/array.h"
#include "formats/index/index.h"
#include "formats/tiff/tiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

/* What is being read. */
typedef struct ome_text {
    snow_context *context;
    tiff_ome *out;
    const char *wanted; /* a name or a number; NULL: the first */
    const char *own;    /* a file that an image may have pages in; or NULL */
    int64_t number;     /* of the present image */
    bool chosen;        /* it is what is wanted: */
    bool pixels;        /* inside of its planes */
    bool done;          /* there was such an image */
    int channels;
    bool uuid; /* the text is one */
} ome_text;

static int64_t whole(const char **attributes, const char *name,
                     int64_t otherwise) {
    const char *text = snow_index_attribute(attributes, name);
    int64_t value;
    return text && snow_parse_int64(text, &value) && value >= 0 ? value
                                                                : otherwise;
}

snow_status snow_tiff_keep(snow_context *context, tiff_ome *ome,
                           const char *text, size_t length, size_t *at) {
    SNOW_TRY(
        SNOW_RESERVE(context, ome->text, ome->used, ome->used + length + 1));
    *at = ome->used;
    memcpy(ome->text + *at, text, length);
    ome->text[*at + length] = 0;
    ome->used += length + 1;
    return SNOW_STATUS_OK;
}

/* Micrometres by default. */
static void take_spacing(const char **attributes, tiff_shape *out) {
    char name[] = "PhysicalSizeX", unit_name[] = "PhysicalSizeXUnit";
    for (int i = 0; i < 3; i++) {
        double length;
        name[12] = unit_name[12] = "XYZ"[i];
        const char *size = snow_index_attribute(attributes, name);
        const char *text = snow_index_attribute(attributes, unit_name);
        if (!size || !snow_parse_double(size, &length) || !(length > 0) ||
            !isfinite(length))
            continue;
        out->spacing[i] = length;
        snprintf(out->units[i], sizeof out->units[i], "%.15s",
                 text ? text : "um");
    }
}

static void take_pixels(ome_text *t, const char **attributes) {
    tiff_shape *shape = &t->out->shape;
    const char *order = snow_index_attribute(attributes, "DimensionOrder");
    shape->channels = whole(attributes, "SizeC", 1);
    shape->slices = whole(attributes, "SizeZ", 1);
    shape->frames = whole(attributes, "SizeT", 1);
    if (order && strlen(order) == 5 && !strncmp(order, "XY", 2) &&
        strchr(order, 'C') && strchr(order, 'Z') && strchr(order, 'T'))
        memcpy(shape->order, order, sizeof shape->order);
    take_spacing(attributes, shape);
    shape->ome = t->pixels = t->done = true;
    t->out->taken = t->number - 1;
}

static bool is_among(const char *text, const char *const *words) {
    while (text && *words && strcmp(text, *words) != 0)
        words++;
    return text && *words;
}

/* Whether its light passes through, rather than being emitted. */
static bool passes_through(const char **attributes) {
    static const char *const contrasts[] = {"Brightfield", "Phase", "DIC",
                                            NULL};
    static const char *const lights[] = {"Transmitted", NULL};
    return is_among(snow_index_attribute(attributes, "ContrastMethod"),
                    contrasts) ||
           is_among(snow_index_attribute(attributes, "IlluminationType"),
                    lights);
}

/* A colour is red, green, blue and alpha, the bytes of a number with a sign. */
static void take_channel(ome_text *t, const char **attributes) {
    const char *name = snow_index_attribute(attributes, "Name");
    const char *color = snow_index_attribute(attributes, "Color");
    int64_t rgba;
    if (t->channels == SNOW_CHANNELS_MAX)
        return;
    t->out->shape.through |= (uint64_t)passes_through(attributes)
                             << t->channels;
    snow_channel *out = &t->out->shape.channel[t->channels++];
    if (name)
        snow_copy_name(name, out->name, sizeof out->name);
    if (color && snow_parse_int64(color, &rgba))
        for (int c = 0; c < 3; c++)
            out->color[c] =
                (double)((uint32_t)rgba >> (24 - 8 * c) & 255) / 255;
}

/* A run of one plane if it says where, else of all pages of its file. */
static snow_status take_run(ome_text *t, const char **attributes) {
    tiff_ome *ome = t->out;
    const bool placed = snow_index_attribute(attributes, "IFD") != NULL;
    int64_t count = whole(attributes, "NumPlanes", placed);
    SNOW_TRY(SNOW_RESERVE(t->context, ome->runs, ome->run_count,
                          ome->run_count + 1));
    ome->runs[ome->run_count++] =
        (tiff_run){.first = {whole(attributes, "FirstC", 0),
                             whole(attributes, "FirstZ", 0),
                             whole(attributes, "FirstT", 0)},
                   .page = whole(attributes, "IFD", 0),
                   .count = whole(attributes, "PlaneCount", count)};
    return SNOW_STATUS_OK;
}

/* A file of the latest run, which has one. */
static snow_status take_file(ome_text *t, const char **attributes) {
    tiff_ome *ome = t->out;
    const char *name = snow_index_attribute(attributes, "FileName");
    tiff_member member = {.state = TIFF_UNKNOWN};
    name = name ? name : "";
    if (ome->has_own < 0 && t->own && !strcmp(name, t->own))
        ome->has_own = t->number - 1;
    if (!t->pixels || !ome->run_count || ome->runs[ome->run_count - 1].file)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_tiff_keep(t->context, ome, name, strlen(name), &member.name));
    SNOW_TRY(snow_tiff_keep(t->context, ome, "", 0, &member.uuid));
    SNOW_TRY(SNOW_RESERVE(t->context, ome->members, ome->member_count,
                          ome->member_count + 1));
    ome->members[ome->member_count] = member;
    ome->runs[ome->run_count - 1].file = ome->member_count++;
    t->uuid = true;
    return SNOW_STATUS_OK;
}

/* An image is chosen by its number, its name or its ID. */
static void begin_image(ome_text *t, const char **attributes) {
    const char *id = snow_index_attribute(attributes, "ID");
    const char *name = snow_index_attribute(attributes, "Name");
    char number[24];
    tiff_ome *ome = t->out;
    const size_t used = strlen(ome->list);
    snprintf(number, sizeof number, "%lld", (long long)t->number++);
    ome->images = t->number;
    if (used + 80 < sizeof ome->list)
        snow_append(ome->list, sizeof ome->list, "%s%s \"%.48s\"",
                    used ? ", " : "", number,
                    name ? name
                    : id ? id
                         : "");
    t->chosen = !t->done && (!t->wanted || !strcmp(t->wanted, number) ||
                             (name && !strcmp(t->wanted, name)) ||
                             (id && !strcmp(t->wanted, id)));
}

static void take_texts(tiff_ome *ome, const char *name,
                       const char **attributes) {
    const char *uuid = snow_index_attribute(attributes, "UUID");
    const char *file = snow_index_attribute(attributes, "MetadataFile");
    if (!strcmp(name, "OME"))
        snprintf(ome->uuid, sizeof ome->uuid, "%s", uuid ? uuid : "");
    else if (!strcmp(name, "BinaryOnly"))
        snprintf(ome->elsewhere, sizeof ome->elsewhere, "%s", file ? file : "");
}

/* Names of elements may have a prefix. */
static const char *local(const char *name) {
    const char *colon = strchr(name, ':');
    return colon ? colon + 1 : name;
}

static snow_status begin(void *user, const char *name,
                         const char **attributes) {
    ome_text *t = user;
    name = local(name);
    take_texts(t->out, name, attributes);
    if (!strcmp(name, "Image"))
        begin_image(t, attributes);
    else if (!strcmp(name, "Pixels") && t->chosen && !t->done)
        take_pixels(t, attributes);
    else if (!strcmp(name, "Channel") && t->pixels)
        take_channel(t, attributes);
    else if (!strcmp(name, "TiffData") && t->pixels)
        return take_run(t, attributes);
    else if (!strcmp(name, "UUID"))
        return take_file(t, attributes);
    return SNOW_STATUS_OK;
}

/* Files that were named before, as far as planes of a file are near to one
 * another. */
#define NEAR 1000

/* The latest run gets the number of its file, which may be a new one. */
static void number_file(tiff_ome *ome) {
    const size_t last = ome->member_count - 1;
    const char *name = ome->text + ome->members[last].name;
    const char *uuid = ome->text + ome->members[last].uuid;
    for (size_t i = last; i-- > 0 && i + NEAR > last;) {
        const tiff_member *other = &ome->members[i];
        if (strcmp(ome->text + other->name, name) != 0 ||
            (!*name && strcmp(ome->text + other->uuid, uuid) != 0))
            continue;
        ome->runs[ome->run_count - 1].file = i;
        ome->member_count--;
        return;
    }
}

static snow_status end(void *user, const char *name) {
    ome_text *t = user;
    name = local(name);
    if (t->uuid && !strcmp(name, "UUID")) {
        number_file(t->out);
        t->uuid = false;
    }
    t->pixels = t->pixels && strcmp(name, "Pixels") != 0;
    return SNOW_STATUS_OK;
}

/* It comes in pieces, of which the last is at the end of the block. */
static snow_status text(void *user, const char *at, size_t length) {
    ome_text *t = user;
    size_t where;
    for (; t->uuid && length && strchr(" \t\r\n", *at); length--)
        at++;
    for (; t->uuid && length && strchr(" \t\r\n", at[length - 1]);)
        length--;
    if (!t->uuid || !length)
        return SNOW_STATUS_OK;
    t->out->used--;
    return snow_tiff_keep(t->context, t->out, at, length, &where);
}

snow_status snow_tiff_read_ome(snow_source *source, const char *wanted,
                               const char *own, tiff_ome *out) {
    static const index_xml handlers = {begin, end, text};
    ome_text t = {.context = snow_source_context(source),
                  .out = out,
                  .own = own,
                  .wanted = wanted};
    size_t nothing;
    *out = (tiff_ome){.has_own = -1};
    snow_tiff_read_text(NULL, &out->shape);
    memcpy(out->shape.order, "XYCZT", sizeof out->shape.order);
    SNOW_TRY(snow_tiff_keep(t.context, out, "", 0, &nothing));
    SNOW_TRY(SNOW_RESERVE(t.context, out->members, 0, 1));
    out->members[out->member_count++] = (tiff_member){.name = nothing};
    SNOW_TRY(snow_index_parse(source, &handlers, &t));
    if (!t.done && *out->elsewhere)
        return SNOW_STATUS_OK;
    if (!t.done && wanted && t.number)
        return snow_fail(t.context, SNOW_STATUS_BAD_USAGE,
                         "--dataset %.64s: there is no such image; it has "
                         "%lld: %s",
                         wanted, (long long)t.number, out->list);
    if (!t.done)
        return snow_fail(t.context, SNOW_STATUS_BAD_INPUT,
                         "its OME-XML has no image with pixels");
    if (!out->run_count) {
        SNOW_TRY(SNOW_RESERVE(t.context, out->runs, 0, 1));
        out->runs[out->run_count++] = (tiff_run){.count = 0};
    }
    bool has_own = false;
    for (size_t i = 0; i < out->run_count; i++)
        has_own |= !out->runs[i].file;
    out->files = out->member_count - 1 + has_own;
    return SNOW_STATUS_OK;
}

void snow_tiff_free_ome(snow_context *context, tiff_ome *ome) {
    SNOW_DROP(context, ome->text);
    SNOW_DROP(context, ome->runs);
    SNOW_DROP(context, ome->members);
}

#endif
