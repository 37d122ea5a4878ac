/* volume/dicom_walk.c - the lengths in a DICOM file, followed from one element
 * to the next (PS3.5, chapters 7 and 10, and A.4 for packed pixels).
 *
 *   explicit   group element  VR length(2)            value
 *              group element  VR 0 0  length(4)       value of OB, SQ, UN, ...
 *   implicit   group element  length(4)               value
 *   item       FFFE  E000     length(4)               elements, or a fragment
 *
 * GDCM takes memory for a value before it looks whether the file has it, and
 * shows what there is of a picture that is cut; so a length that leads beyond
 * the file is found here, first.  What this walk does not understand it leaves
 * to GDCM, which knows how many a program gets it wrong. */
#include "volume/dicom.h"

#include <string.h>

#define PREAMBLE 128
#define UNDEFINED 0xffffffffu /* length: up to a delimiter */
#define META_GROUP 2

#define TAG_SYNTAX 0x00020010u
#define TAG_PIXELS 0x7fe00010u
#define TAG_ITEM 0xfffee000u
#define TAG_ITEM_END 0xfffee00du
#define TAG_SEQUENCE_END 0xfffee0ddu

#define DEFLATED "1.2.840.10008.1.2.1.99"
#define IMPLICIT "1.2.840.10008.1.2"
#define BIG_ENDIAN_SYNTAX "1.2.840.10008.1.2.2"

/* Real files have three or four; GDCM recurses without a limit. */
#define MOST_DEPTH 32

/* Elements that must follow one another for a file without a mark to be taken
 * for DICOM. */
#define SURE_ELEMENTS 3

typedef struct coding {
    bool explicit_vr, big_endian;
} coding;

typedef struct element {
    uint32_t tag;
    char vr[2];
    uint32_t length;
    uint64_t head; /* bytes before the value */
} element;

static uint32_t whole(const unsigned char *at, int bytes, bool big) {
    uint32_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint32_t)at[i] << 8 * (big ? bytes - 1 - i : i);
    return value;
}

static bool is_vr(const unsigned char *at) {
    return at[0] >= 'A' && at[0] <= 'Z' && at[1] >= 'A' && at[1] <= 'Z';
}

/* Those with two empty bytes and a long length. */
static bool is_long(const char vr[2]) {
    static const char names[] = "OBOWOFODOLOVSQUCURUTUNSVUV";
    for (size_t i = 0; i + 1 < sizeof names; i += 2)
        if (!memcmp(names + i, vr, 2))
            return true;
    return false;
}

/* An element's head in at least 12 bytes, of which `have` are the file's; false
 * when it is none, or is not all there. */
static bool parse(const unsigned char *at, size_t have, coding how,
                  element *out) {
    element e = {.head = 8};
    if (have < 8)
        return false;
    e.tag =
        whole(at, 2, how.big_endian) << 16 | whole(at + 2, 2, how.big_endian);
    if (e.tag >> 16 == 0xfffe || !how.explicit_vr) {
        e.length = whole(at + 4, 4, how.big_endian);
        *out = e;
        return true;
    }
    if (!is_vr(at + 4))
        return false;
    memcpy(e.vr, at + 4, 2);
    e.length = whole(at + 6, 2, how.big_endian);
    if (is_long(e.vr)) {
        e.head = 12;
        e.length = whole(at + 8, 4, how.big_endian);
    }
    *out = e;
    return have >= e.head;
}

/* The coding of a data set that begins so, by the first element's group, which
 * is low. */
static coding guess(const unsigned char *at) {
    return (coding){.explicit_vr = is_vr(at + 4),
                    .big_endian = at[0] == 0 && at[1] != 0};
}

/* Without a mark: elements of the first groups, which rise, one behind the
 * other. */
static bool looks_like_elements(const unsigned char *bytes, size_t size) {
    uint32_t last = 0;
    size_t at = 0;
    if (size < 12)
        return false;
    coding how = guess(bytes);
    for (int i = 0; i < SURE_ELEMENTS; i++) {
        element e;
        if (at + 12 > size || !parse(bytes + at, size - at, how, &e))
            return false;
        uint32_t group = e.tag >> 16;
        if ((group != META_GROUP && group != 8) || e.tag <= last ||
            e.length > 1024 || (e.tag & 0xffff) > 0x1200)
            return false;
        last = e.tag;
        at += (size_t)e.head + e.length;
    }
    return true;
}

bool snow_dicom_probe(const unsigned char *bytes, size_t size) {
    if (size >= PREAMBLE + 4 && !memcmp(bytes + PREAMBLE, "DICM", 4))
        return true;
    return looks_like_elements(bytes, size);
}

/* --- the walk --------------------------------------------------------------
 */

/* How a walk ended, where it did not fail. */
typedef enum ending {
    AT_END,  /* of what was asked */
    AT_STOP, /* at the pixels, where no more is wanted */
    LOST     /* at what is not understood */
} ending;

typedef struct walk {
    snow_context *context;
    snow_random *store;
    uint64_t at, size;
    bool pixels;
    unsigned char piece[4096]; /* of the file, from `from` on */
    uint64_t from;
    size_t held;
} walk;

static const unsigned char *look(walk *w, size_t *have) {
    uint64_t end = w->from + w->held;
    if (w->at < w->from || w->at > end || end - w->at < 12) {
        w->from = w->at;
        w->held = snow_random_read(w->store, w->at, w->piece, sizeof w->piece);
        end = w->from + w->held;
    }
    *have = (size_t)(end - w->at);
    return w->piece + (w->at - w->from);
}

static bool next(walk *w, coding how, element *out) {
    size_t have;
    const unsigned char *at = look(w, &have);
    if (!parse(at, have, how, out))
        return false;
    w->at += out->head;
    return true;
}

static snow_status fail_cut(walk *w, const element *e) {
    return snow_fail(w->context, SNOW_BAD_INPUT,
                     "is cut or damaged: element (%04x,%04x) says that it has "
                     "%llu bytes, of which %llu are there; fetch the file "
                     "again",
                     e->tag >> 16, e->tag & 0xffff,
                     (unsigned long long)e->length,
                     (unsigned long long)(w->size - w->at));
}

/* Goes behind a value. */
static snow_status skip(walk *w, const element *e) {
    if (e->length > w->size - w->at)
        return fail_cut(w, e);
    w->at += e->length;
    return SNOW_OK;
}

/* Packed pixels: a table, then fragments, then a delimiter. */
static snow_status walk_fragments(walk *w, coding how, ending *out) {
    element e;
    for (;;) {
        if (!next(w, how, &e) ||
            (e.tag != TAG_ITEM && e.tag != TAG_SEQUENCE_END))
            return snow_fail(w->context, SNOW_BAD_INPUT,
                             "is cut or damaged: its packed pixels have no "
                             "end; fetch the file again");
        if (e.tag == TAG_SEQUENCE_END)
            break;
        SNOW_TRY(skip(w, &e));
    }
    *out = AT_END;
    return SNOW_OK;
}

static snow_status walk_set(walk *w, coding how, uint64_t end, int depth,
                            ending *out);

/* The items of a sequence up to `end`, UINT64_MAX for a delimiter. */
static snow_status walk_items(walk *w, coding how, uint64_t end, int depth,
                              ending *out) {
    element e;
    ending inner;
    if (depth > MOST_DEPTH)
        return snow_fail(w->context, SNOW_BAD_INPUT,
                         "nests sequences more than %d deep; it is damaged",
                         MOST_DEPTH);
    *out = AT_END;
    while (w->at < end) {
        if (!next(w, how, &e) ||
            (e.tag != TAG_ITEM && e.tag != TAG_SEQUENCE_END)) {
            *out = LOST;
            return SNOW_OK;
        }
        if (e.tag == TAG_SEQUENCE_END)
            return SNOW_OK;
        bool open = e.length == UNDEFINED;
        if (!open && e.length > w->size - w->at)
            return fail_cut(w, &e);
        uint64_t inner_end = open ? UINT64_MAX : w->at + e.length;
        SNOW_TRY(walk_set(w, how, inner_end, depth + 1, &inner));
        if (inner == LOST && open) {
            *out = LOST;
            return SNOW_OK;
        }
        if (!open)
            w->at = inner_end;
    }
    return SNOW_OK;
}

/* In files without VRs a sequence shows by its first item. */
static bool is_sequence(walk *w, coding how, const element *e) {
    size_t have;
    if (how.explicit_vr)
        return !memcmp(e->vr, "SQ", 2);
    const unsigned char *at = look(w, &have);
    return e->length >= 8 && have >= 4 && !memcmp(at, "\xfe\xff\0\xe0", 4);
}

/* A value, with what is nested in it. */
static snow_status walk_value(walk *w, coding how, const element *e, int depth,
                              ending *out) {
    *out = AT_END;
    if (e->length == UNDEFINED) {
        if (e->tag == TAG_PIXELS)
            return walk_fragments(w, how, out);
        if (how.explicit_vr && !memcmp(e->vr, "UN", 2))
            how = (coding){false, false}; /* PS3.5, 6.2.2, note 2 */
        return walk_items(w, how, UINT64_MAX, depth, out);
    }
    if (e->length > w->size - w->at)
        return fail_cut(w, e);
    uint64_t end = w->at + e->length;
    if (is_sequence(w, how, e))
        SNOW_TRY(walk_items(w, how, end, depth, out));
    *out = AT_END;
    w->at = end;
    return SNOW_OK;
}

/* Elements up to `end`, or a delimiter where that is UINT64_MAX. */
static snow_status walk_set(walk *w, coding how, uint64_t end, int depth,
                            ending *out) {
    element e;
    *out = AT_END;
    while (w->at < end && w->at < w->size) {
        if (!next(w, how, &e)) {
            *out = LOST;
            return SNOW_OK;
        }
        if (e.tag == TAG_ITEM_END)
            return SNOW_OK;
        if (depth == 0 && e.tag >= TAG_PIXELS && !w->pixels) {
            *out = AT_STOP;
            return SNOW_OK;
        }
        SNOW_TRY(walk_value(w, how, &e, depth, out));
        if (*out != AT_END)
            return SNOW_OK;
    }
    /* Behind the last element an item must have had its delimiter. */
    if (end == UINT64_MAX && depth)
        return snow_fail(w->context, SNOW_BAD_INPUT,
                         "is cut or damaged: it ends within a sequence; fetch "
                         "the file again");
    return SNOW_OK;
}

/* The meta information, which is always explicit and little endian; its
 * transfer syntax. */
static snow_status walk_meta(walk *w, char syntax[65]) {
    const coding how = {true, false};
    for (;;) {
        size_t have;
        const unsigned char *at = look(w, &have);
        element e;
        if (have < 8 || whole(at, 2, false) != META_GROUP || !next(w, how, &e))
            return SNOW_OK;
        if (e.tag == TAG_SYNTAX && e.length < 65 &&
            snow_random_read(w->store, w->at, syntax, e.length) < e.length)
            return fail_cut(w, &e);
        SNOW_TRY(skip(w, &e));
    }
}

snow_status snow_dicom_walk(snow_context *context, snow_random *store,
                            bool pixels) {
    char syntax[65] = "";
    ending end;
    size_t have;
    walk w = {.context = context,
              .store = store,
              .pixels = pixels,
              .size = snow_random_size(store),
              .at = PREAMBLE};
    const unsigned char *at = look(&w, &have);
    w.at = have >= 4 && !memcmp(at, "DICM", 4) ? PREAMBLE + 4 : 0;
    SNOW_TRY(walk_meta(&w, syntax));
    for (size_t i = strlen(syntax); i && syntax[i - 1] == ' ';)
        syntax[--i] = 0;
    if (!strcmp(syntax, DEFLATED))
        return SNOW_OK; /* zlib has a check sum, and an end */
    at = look(&w, &have);
    if (have < 8)
        return SNOW_OK;
    coding how = guess(at);
    if (*syntax) {
        how.big_endian = !strcmp(syntax, BIG_ENDIAN_SYNTAX);
        if (how.explicit_vr == !strcmp(syntax, IMPLICIT))
            return SNOW_OK; /* its syntax lies: GDCM may find out */
    }
    return walk_set(&w, how, UINT64_MAX, 0, &end);
}
