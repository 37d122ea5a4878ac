/* formats/index/xdmf_text.c - the elements of an XDMF file. */
#include "formats/ascii.h"
#include "formats/index/xdmf.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

bool snow_xdmf_is(const char *text, const char *word) {
    for (; text && *text && *word; text++, word++)
        if (tolower((unsigned char)*text) != *word)
            return false;
    return text && !*text && !*word;
}

static void copy_text(const char *from, char *to, size_t capacity) {
    snprintf(to, capacity, "%s", from ? from : "");
}

/* Reads up to three sizes, the slowest first, into x, y, z. */
static bool take_sizes(const char *text, int64_t out[3]) {
    int64_t sizes[3];
    const int count = text ? snow_text_integers(text, "", sizes, 3) : 0;
    for (int i = 0; i < 3; i++) {
        out[i] = i < count ? sizes[count - 1 - i] : 1;
        if (out[i] < 1)
            return false;
    }
    return count > 0;
}

/* A reference keeps the topology that stands before. */
static void begin_topology(xdmf_file *f, const char **attributes) {
    const char *kind = snow_index_attribute(attributes, "TopologyType");
    const char *sizes = snow_index_attribute(attributes, "Dimensions");
    xdmf_grid *grid = &f->now.grid;
    if (!kind)
        kind = snow_index_attribute(attributes, "Type");
    if (!sizes)
        sizes = snow_index_attribute(attributes, "NumberOfElements");
    if (!kind)
        return;
    copy_text(kind, grid->kind, sizeof grid->kind);
    grid->rectilinear =
        snow_xdmf_is(kind, "3drectmesh") || snow_xdmf_is(kind, "2drectmesh");
    grid->known = (grid->rectilinear || snow_xdmf_is(kind, "3dcorectmesh") ||
                   snow_xdmf_is(kind, "2dcorectmesh")) &&
                  take_sizes(sizes, grid->points);
}

static void begin_geometry(xdmf_file *f, const char **attributes) {
    const char *kind = snow_index_attribute(attributes, "GeometryType");
    if (!kind)
        kind = snow_index_attribute(attributes, "Type");
    if (!kind || snow_index_attribute(attributes, "Reference"))
        return;
    f->in_geometry = true;
    f->now.grid.item_count = 0;
    copy_text(kind, f->now.grid.geometry, sizeof f->now.grid.geometry);
}

/* The requested attribute, by default the first one of scalars or vectors. */
static void begin_attribute(xdmf_file *f, const char **attributes) {
    const char *kind = snow_index_attribute(attributes, "AttributeType");
    const char *centre = snow_index_attribute(attributes, "Center");
    copy_text(snow_index_attribute(attributes, "Name"), f->attribute,
              sizeof f->attribute);
    f->cells = snow_xdmf_is(centre, "cell");
    f->vector = snow_xdmf_is(kind, "vector");
    f->attributes++;
    f->in_attribute =
        !f->now.found &&
        (!f->options->dataset || !strcmp(f->options->dataset, f->attribute));
    if (f->steps == 0)
        snow_list_add(f->seen, sizeof f->seen, "%s", f->attribute);
}

static snow_type type_of(const char *kind, int64_t bytes) {
    if (!kind || snow_xdmf_is(kind, "float") || snow_xdmf_is(kind, "double"))
        return bytes == 8 || snow_xdmf_is(kind, "double") ? SNOW_TYPE_FLOAT64
                                                          : SNOW_TYPE_FLOAT32;
    if (snow_xdmf_is(kind, "char") || snow_xdmf_is(kind, "uchar"))
        bytes = 1;
    if (snow_xdmf_is(kind, "short") || snow_xdmf_is(kind, "ushort"))
        bytes = 2;
    return bytes < 0 ? SNOW_TYPE_NONE
                     : snow_type_of_integer(
                           (size_t)bytes, tolower((unsigned char)*kind) != 'u');
}

/* A DataItem that holds others: a part of one, or a vector of several. */
static snow_status begin_items(xdmf_file *f, const char *kind,
                               const char **attributes) {
    const char *function = snow_index_attribute(attributes, "Function");
    char word[5] = "";
    if (snow_xdmf_is(kind, "hyperslab")) {
        f->in_slab = true;
        f->slab_axes = 0;
        return SNOW_STATUS_OK;
    }
    if (snow_xdmf_is(kind, "function") && function)
        snprintf(word, sizeof word, "%s", function + strspn(function, " "));
    if (snow_xdmf_is(word, "join") && f->in_attribute) {
        f->joins = true;
        f->now.joined = 0;
        return SNOW_STATUS_OK;
    }
    return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                     "has a DataItem of ItemType \"%.40s\", which is not "
                     "supported; name a whole data set, or open the HDF5 "
                     "file itself with --dataset",
                     kind);
}

static snow_status begin_item(xdmf_file *f, const char **attributes) {
    const char *form = snow_index_attribute(attributes, "Format");
    const char *kind = snow_index_attribute(attributes, "ItemType");
    const char *order = snow_index_attribute(attributes, "Endian");
    const char *bytes = snow_index_attribute(attributes, "Precision");
    const char *seek = snow_index_attribute(attributes, "Seek");
    const char *number = snow_index_attribute(attributes, "NumberType");
    int64_t size = 4;
    if (!(f->in_geometry || f->in_attribute || f->in_times))
        return SNOW_STATUS_OK;
    if (kind && !snow_xdmf_is(kind, "uniform"))
        return begin_items(f, kind, attributes);
    f->item = (xdmf_item){.hdf = snow_xdmf_is(form, "hdf"),
                          .binary = snow_xdmf_is(form, "binary")};
    f->item.xml = !f->item.hdf && !f->item.binary;
    f->item.big_endian = order && !snow_xdmf_is(order, "native")
                             ? snow_xdmf_is(order, "big")
                             : snow_machine_big_endian();
    if (bytes)
        (void)snow_parse_int64(bytes, &size);
    if (seek && (!snow_parse_int64(seek, &f->item.seek) || f->item.seek < 0))
        return snow_fail(
            f->context, SNOW_STATUS_BAD_INPUT,
            "its Seek \"%.40s\" is not a number of bytes; correct it", seek);
    f->item.type = type_of(
        number ? number : snow_index_attribute(attributes, "DataType"), size);
    f->item.numbers = f->used;
    f->in_item = true;
    return SNOW_STATUS_OK;
}

static void begin_grid(xdmf_file *f, const char **attributes) {
    const char *kind = snow_index_attribute(attributes, "GridType");
    const char *how = snow_index_attribute(attributes, "CollectionType");
    const bool collects =
        snow_xdmf_is(kind, "collection") || snow_xdmf_is(kind, "tree");
    const bool in_space = collects && how && !snow_xdmf_is(how, "temporal");
    f->loose |= collects && !how;
    f->collections = f->collections << 1 | collects;
    f->spaces = f->spaces << 1 | in_space;
    if (in_space || !f->spaces)
        f->space_time = NAN;
    if (!collects) {
        f->now.found = false;
        f->now.joined = 0;
        f->now.time = f->space_time;
    }
}

static void begin_time(xdmf_file *f, const char **attributes) {
    const char *value = snow_index_attribute(attributes, "Value");
    const char *kind = snow_index_attribute(attributes, "TimeType");
    const bool collects = f->collections & 1;
    const bool even = snow_xdmf_is(kind, "hyperslab");
    f->timed = true;
    if (value && (!collects || f->spaces & 1))
        (void)snow_parse_double(value,
                                collects ? &f->space_time : &f->now.time);
    f->in_times = collects && (even || snow_xdmf_is(kind, "list"));
    if (f->in_times)
        f->even_times = even;
}

static snow_status begin_element(void *user, const char *name,
                                 const char **attributes) {
    xdmf_file *f = user;
    if (!strcmp(name, "Grid")) {
        begin_grid(f, attributes);
    } else if (!strcmp(name, "Topology")) {
        begin_topology(f, attributes);
    } else if (!strcmp(name, "Geometry")) {
        begin_geometry(f, attributes);
    } else if (!strcmp(name, "Attribute")) {
        begin_attribute(f, attributes);
    } else if (!strcmp(name, "DataItem")) {
        return begin_item(f, attributes);
    } else if (!strcmp(name, "Time")) {
        begin_time(f, attributes);
    }
    return SNOW_STATUS_OK;
}

/* First, step and count along each axis. */
static snow_status take_slab(xdmf_file *f) {
    int64_t numbers[3 * XDMF_MOST_AXES];
    const int count =
        snow_text_integers(f->item.text, "", numbers, 3 * XDMF_MOST_AXES);
    if (count < 3 || count % 3)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "has a HyperSlab that is not three numbers for each "
                         "of one to %d axes; correct it",
                         XDMF_MOST_AXES);
    f->slab_axes = count / 3;
    for (int i = 0; i < count; i++)
        f->slab[i / f->slab_axes][i % f->slab_axes] = numbers[i];
    return SNOW_STATUS_OK;
}

/* Keeps a text without blanks at its ends. */
static void trim(char *text) {
    const size_t begin = strspn(text, " \t\r\n");
    size_t end = strlen(text);
    while (end > begin && strchr(" \t\r\n", text[end - 1]))
        end--;
    memmove(text, text + begin, end - begin);
    text[end - begin] = 0;
}

/* The path in a file begins with a slash; behind "/./" all axes are of space.
 */
static void complete_path(xdmf_item *item) {
    char *colon = strrchr(item->text, ':');
    const char *more = item->axes ? "/./" : "/";
    const size_t length = strlen(more);
    if (!colon || (colon[1] == '/' && !item->axes) ||
        strlen(item->text) + length >= sizeof item->text)
        return;
    memmove(colon + 1 + length, colon + 1, strlen(colon));
    memcpy(colon + 1, more, length);
}

static snow_status end_item(xdmf_file *f) {
    xdmf_grid *grid = &f->now.grid;
    f->in_item = false;
    f->item.length = f->used - f->item.numbers;
    trim(f->item.text);
    if (f->in_slab && !f->slab_axes)
        return take_slab(f);
    if (f->in_slab) {
        f->item.axes = f->slab_axes;
        memcpy(f->item.slab, f->slab, sizeof f->slab);
    }
    if (f->item.hdf)
        complete_path(&f->item);
    if (f->in_times) {
        f->times = f->item;
    } else if (f->in_geometry && grid->item_count < XDMF_MOST_ITEMS) {
        grid->items[grid->item_count++] = f->item;
    } else if (f->in_attribute) {
        if (!f->joins || !f->now.joined)
            f->now.item = f->item;
        if (f->joins && f->now.joined < XDMF_MOST_ITEMS)
            f->now.parts[f->now.joined++] = f->item;
        f->now.cells = f->cells;
        f->now.vector = f->vector;
        f->now.found = true;
        copy_text(f->attribute, f->now.name, sizeof f->now.name);
    }
    return SNOW_STATUS_OK;
}

/* Of the last step all that come are kept, until there is a later one.  Where a
 * collection may be one in space, all are. */
static snow_status keep_part(xdmf_file *f) {
    const bool any = f->loose && !f->timed;
    const bool last = f->options->time < 0;
    if (!any && !last && f->steps != f->options->time)
        return SNOW_STATUS_OK;
    if (!any && last && f->part_count &&
        f->parts[f->part_count - 1].step < f->steps)
        f->part_count = 0;
    if (f->part_count >= XDMF_MOST_PARTS)
        return any ? SNOW_STATUS_OK
                   : snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                               "has more than %d grids side by side; write one",
                               XDMF_MOST_PARTS);
    SNOW_TRY(
        SNOW_RESERVE(f->context, f->parts, f->part_count, f->part_count + 1));
    f->now.step = f->steps;
    f->parts[f->part_count++] = f->now;
    return SNOW_STATUS_OK;
}

/* Every uniform grid is a step, or all of a collection in space. */
static snow_status end_grid(xdmf_file *f) {
    const bool collects = f->collections & 1, in_space = f->spaces & 1;
    f->collections >>= 1;
    f->spaces >>= 1;
    if (!collects)
        SNOW_TRY(keep_part(f));
    if (!f->spaces && (!collects || in_space))
        f->steps++;
    return SNOW_STATUS_OK;
}

static snow_status end_element(void *user, const char *name) {
    xdmf_file *f = user;
    if (!strcmp(name, "Grid"))
        return end_grid(f);
    else if (!strcmp(name, "Geometry"))
        f->in_geometry = false;
    else if (!strcmp(name, "Attribute"))
        f->in_attribute = false;
    else if (!strcmp(name, "Time"))
        f->in_times = false;
    else if (!strcmp(name, "DataItem") && f->in_item)
        return end_item(f);
    else if (!strcmp(name, "DataItem") && f->in_slab)
        f->in_slab = false;
    else if (!strcmp(name, "DataItem"))
        f->joins = false;
    return SNOW_STATUS_OK;
}

/* Names are short; numbers in XML may be many. */
static snow_status take_text(void *user, const char *text, size_t length) {
    xdmf_file *f = user;
    if (!f->in_item)
        return SNOW_STATUS_OK;
    if (f->item.xml && (f->in_geometry || f->in_times) &&
        (!f->in_slab || f->slab_axes)) {
        SNOW_TRY(
            SNOW_RESERVE(f->context, f->numbers, f->used, f->used + length));
        memcpy(f->numbers + f->used, text, length);
        f->used += length;
        return SNOW_STATUS_OK;
    }
    size_t used = strlen(f->item.text);
    if (used + length >= sizeof f->item.text) {
        if (f->item.xml)
            return SNOW_STATUS_OK; /* values in XML, which are refused */
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "names a file by more than %d letters; shorten it",
                         XDMF_TEXT_BYTES - 1);
    }
    memcpy(f->item.text + used, text, length);
    f->item.text[used + length] = 0;
    return SNOW_STATUS_OK;
}

static bool is_same_item(const xdmf_file *f, const xdmf_item *a,
                         const xdmf_item *b) {
    return a->length == b->length &&
           !memcmp(f->numbers + a->numbers, f->numbers + b->numbers,
                   a->length) &&
           !strcmp(a->text, b->text) &&
           !memcmp(a->slab, b->slab, sizeof a->slab);
}

/* Grids of a collection that says neither of what it is nor any time are parts
 * of one, unless the first two lie in one place. */
static bool are_parts(const xdmf_file *f) {
    bool same = true;
    if (!f->loose || f->timed || f->part_count < 2 ||
        f->steps != (int64_t)f->part_count)
        return false;
    const xdmf_grid *a = &f->parts[0].grid, *b = &f->parts[1].grid;
    for (int i = 0; i < XDMF_MOST_ITEMS; i++)
        same = same && (i >= a->item_count || i >= b->item_count ||
                        is_same_item(f, &a->items[i], &b->items[i]));
    return !same;
}

/* Leaves the parts of the step that is wanted. */
static void choose_parts(xdmf_file *f) {
    size_t kept = 0;
    const int64_t wanted =
        f->options->time < 0 ? f->steps - 1 : f->options->time;
    if (are_parts(f))
        f->steps = 1;
    else
        for (size_t i = 0; i < f->part_count; i++)
            if (f->parts[i].step == wanted)
                f->parts[kept++] = f->parts[i];
    if (f->steps > 1 || kept)
        f->part_count = kept;
    if (f->part_count)
        f->kept = f->parts[0];
}

snow_status snow_xdmf_parse(xdmf_file *f) {
    const index_xml handlers = {begin_element, end_element, take_text};
    SNOW_TRY(snow_index_parse(f->source, &handlers, f));
    choose_parts(f);
    return SNOW_STATUS_OK;
}
