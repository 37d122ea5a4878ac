/* formats/dicom/parse.c - parses the elements of a DICOM file (PS3.5, chapters
 * 7 and 10; A.4 and A.5 for compressed pixels and deflated files).
 *
 *   explicit   group element  VR length(2)            value
 *              group element  VR 0 0  length(4)       value of OB, SQ, UN, ...
 *   implicit   group element  length(4)               value
 *   item       FFFE  E000     length(4)               elements, or a fragment
 *
 * They become a list in the order of the file.  The elements of an item and the
 * items of a sequence follow the element that contains them; `next` skips them:
 *
 *   (0028,0010)  (5200,9230)  item  (0020,9113)  item  (0020,0032)  (7fe0,0010)
 *        '-> 1        '-> 6    '-> 6     '-> 6     '-> 6     '-> 6
 *
 * Values stay in the file.  A length beyond the end of the file is refused
 * here, before any memory is allocated for it. */
#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

#include <string.h>

#define PREAMBLE 128
#define UNDEFINED 0xffffffffu /* length: up to a delimiter */
#define META_GROUP 2
#define LONGEST_HEAD 12 /* bytes of an element before its value */

#define TAG_CLASS 0x00020002u
#define TAG_SYNTAX 0x00020010u
#define TAG_ITEM_END 0xfffee00du
#define TAG_SEQUENCE_END 0xfffee0ddu
#define TAG_FRAME_GROUPS 0x52009230u
#define TAG_SHARED_GROUPS 0x52009229u

#define BIG_ENDIAN_SYNTAX "1.2.840.10008.1.2.2"

/* The most nested sequences; real files have three or four. */
#define MOST_DEPTH 32

/* A file without a mark is DICOM if it begins with this many elements. */
#define SURE_ELEMENTS 3

typedef struct coding {
    bool explicit_vr, big_endian;
} coding;

typedef struct head {
    uint32_t tag;
    char vr[2];
    uint32_t length;
    uint32_t bytes; /* before the value */
} head;

static uint32_t whole(const unsigned char *at, int bytes, bool big) {
    return (uint32_t)snow_number_at(at, bytes, big);
}

static bool is_vr(const unsigned char *at) {
    return at[0] >= 'A' && at[0] <= 'Z' && at[1] >= 'A' && at[1] <= 'Z';
}

/* Value representations with two empty bytes and a long length. */
static bool is_long(const char vr[2]) {
    static const char names[] = "OBOWOFODOLOVSQUCURUTUNSVUV";
    for (size_t i = 0; i + 1 < sizeof names; i += 2)
        if (!memcmp(names + i, vr, 2))
            return true;
    return false;
}

/* Parses an element's header, of which `have` bytes exist; returns false if
 * they are too few.  An explicit element without a VR is read as implicit: some
 * programs write such. */
static bool parse_head(const unsigned char *at, size_t have, coding how,
                       head *out) {
    head h = {.bytes = 8};
    if (have < 8)
        return false;
    h.tag =
        whole(at, 2, how.big_endian) << 16 | whole(at + 2, 2, how.big_endian);
    if (h.tag >> 16 == 0xfffe || !how.explicit_vr || !is_vr(at + 4)) {
        h.length = whole(at + 4, 4, how.big_endian);
        *out = h;
        return true;
    }
    memcpy(h.vr, at + 4, 2);
    h.length = whole(at + 6, 2, how.big_endian);
    if (is_long(h.vr)) {
        h.bytes = 12;
        if (have < 12)
            return false;
        h.length = whole(at + 8, 4, how.big_endian);
    }
    *out = h;
    return true;
}

/* The coding of a data set, from the first element's group, which is low. */
static coding guess(const unsigned char *at) {
    return (coding){.explicit_vr = is_vr(at + 4),
                    .big_endian = at[0] == 0 && at[1] != 0};
}

/* Without a mark: whether elements of the first groups follow in rising
 * order. */
static bool looks_like_elements(const unsigned char *bytes, size_t size) {
    uint32_t last = 0;
    size_t at = 0;
    if (size < 12)
        return false;
    coding how = guess(bytes);
    for (int i = 0; i < SURE_ELEMENTS; i++) {
        head h;
        if (at + 12 > size || !parse_head(bytes + at, size - at, how, &h) ||
            (how.explicit_vr && !h.vr[0]))
            return false;
        uint32_t group = h.tag >> 16;
        if ((group != META_GROUP && group != 8) || h.tag <= last ||
            h.length > 1024 || (h.tag & 0xffff) > 0x1200)
            return false;
        last = h.tag;
        at += (size_t)h.bytes + h.length;
    }
    return true;
}

bool snow_dicom_probe(const unsigned char *bytes, size_t size) {
    if (size >= PREAMBLE + 4 && !memcmp(bytes + PREAMBLE, "DICM", 4))
        return true;
    return looks_like_elements(bytes, size);
}

/* --- the walk through a file ---------------------------------------------- */

typedef struct walk {
    dicom_reader *reader;
    uint64_t at, size;
    bool stops;                /* at the pixels */
    uint64_t pixels;           /* bytes of them that are wanted */
    dicom_inflater *inflater;  /* of a deflated file, whose size is unknown */
    size_t inflated;           /* bytes of it so far */
    unsigned char piece[4096]; /* of the file, from `from` on */
    uint64_t from;
    size_t held;
} walk;

/* Inflates at least `bytes` from here on, if there are as many. */
static snow_status need(walk *w, uint64_t bytes) {
    dicom_reader *r = w->reader;
    if (!w->inflater)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_dicom_inflate_to(w->inflater, w->at + bytes, &r->inflated,
                                   &w->inflated));
    if (snow_dicom_inflate_ended(w->inflater))
        w->size = w->inflated;
    return SNOW_STATUS_OK;
}

static size_t read_piece(walk *w) {
    size_t count = sizeof w->piece;
    if (!w->inflater)
        return snow_seekable_read(w->reader->store, w->at, w->piece, count);
    if (w->at >= w->inflated)
        return 0;
    if (count > w->inflated - w->at)
        count = w->inflated - w->at;
    memcpy(w->piece, w->reader->inflated + w->at, count);
    return count;
}

static const unsigned char *look(walk *w, size_t *have) {
    uint64_t end = w->from + w->held;
    if (w->at < w->from || w->at > end || end - w->at < 12) {
        w->from = w->at;
        w->held = read_piece(w);
        end = w->from + w->held;
    }
    *have = (size_t)(end - w->at);
    return w->piece + (w->at - w->from);
}

static snow_status next_head(walk *w, coding how, head *out) {
    size_t have;
    SNOW_TRY(need(w, LONGEST_HEAD));
    const unsigned char *at = look(w, &have);
    if (!parse_head(at, have, how, out))
        return snow_fail(w->reader->context, SNOW_STATUS_BAD_INPUT,
                         "is truncated or damaged: it ends within an element; "
                         "get the file again");
    w->at += out->bytes;
    return SNOW_STATUS_OK;
}

/* No more pixels are inflated than are wanted; for the others the packed bytes
 * must suffice. */
static snow_status check_length(walk *w, const head *h) {
    uint64_t bytes = h->length, most = w->size - w->at;
    if (h->tag == DICOM_TAG_PIXELS && bytes > w->pixels)
        bytes = w->pixels;
    SNOW_TRY(need(w, bytes));
    if (w->inflater)
        most = w->size == UINT64_MAX
                   ? snow_seekable_size(w->reader->store) * SNOW_DEFLATE_RATIO
                   : w->size - w->at;
    if (h->length <= most)
        return SNOW_STATUS_OK;
    return snow_fail(w->reader->context, SNOW_STATUS_BAD_INPUT,
                     "is truncated or damaged: element (%04x,%04x) claims %lu "
                     "bytes, of which %llu exist; get the file again",
                     h->tag >> 16, h->tag & 0xffff, (unsigned long)h->length,
                     (unsigned long long)most);
}

/* Adds an element to the list; its value comes next. */
static snow_status add_element(walk *w, const head *h, size_t *index) {
    dicom_reader *r = w->reader;
    SNOW_TRY(SNOW_RESERVE(r->context, r->elements, r->count, r->count + 1));
    *index = r->count++;
    r->elements[*index] =
        (dicom_element){.tag = h->tag,
                        .length = h->length == UNDEFINED ? 0 : h->length,
                        .at = w->at,
                        .next = r->count,
                        .words = !memcmp(h->vr, "OW", 2)};
    return SNOW_STATUS_OK;
}

/* Compressed pixels: a table, then fragments, then a delimiter. */
static snow_status walk_fragments(walk *w, coding how) {
    head h;
    size_t index;
    for (;;) {
        SNOW_TRY(need(w, LONGEST_HEAD));
        if (w->at >= w->size)
            return snow_fail(w->reader->context, SNOW_STATUS_BAD_INPUT,
                             "is truncated or damaged: its compressed pixels "
                             "have no end; get the file again");
        SNOW_TRY(next_head(w, how, &h));
        if (h.tag == TAG_SEQUENCE_END)
            return SNOW_STATUS_OK;
        if (h.tag != DICOM_TAG_ITEM)
            return snow_fail(w->reader->context, SNOW_STATUS_BAD_INPUT,
                             "is damaged: among its compressed pixels is an "
                             "element (%04x,%04x); get the file again",
                             h.tag >> 16, h.tag & 0xffff);
        SNOW_TRY(check_length(w, &h));
        SNOW_TRY(add_element(w, &h, &index));
        w->at += h.length;
    }
}

static snow_status walk_set(walk *w, coding how, uint64_t end, int depth);

/* Walks the items of a sequence up to `end`, UINT64_MAX for a delimiter. */
static snow_status walk_items(walk *w, coding how, uint64_t end, int depth) {
    head h;
    size_t index;
    if (depth > MOST_DEPTH)
        return snow_fail(w->reader->context, SNOW_STATUS_BAD_INPUT,
                         "nests sequences more than %d deep; it is damaged",
                         MOST_DEPTH);
    while (w->at < end) {
        SNOW_TRY(next_head(w, how, &h));
        if (h.tag == TAG_SEQUENCE_END)
            return SNOW_STATUS_OK;
        if (h.tag != DICOM_TAG_ITEM)
            return snow_fail(
                w->reader->context, SNOW_STATUS_BAD_INPUT,
                "is damaged: a sequence has an element (%04x,%04x) in place of "
                "an item; get the file again",
                h.tag >> 16, h.tag & 0xffff);
        bool open = h.length == UNDEFINED;
        if (!open)
            SNOW_TRY(check_length(w, &h));
        uint64_t item_end = open ? UINT64_MAX : w->at + h.length;
        SNOW_TRY(add_element(w, &h, &index));
        SNOW_TRY(walk_set(w, how, item_end, depth + 1));
        w->reader->elements[index].next = w->reader->count;
        if (!open)
            w->at = item_end;
    }
    return SNOW_STATUS_OK;
}

/* Without a VR, a sequence is recognised by its first item. */
static bool is_sequence(walk *w, coding how, const head *h) {
    size_t have;
    if (h->vr[0])
        return !memcmp(h->vr, "SQ", 2);
    const unsigned char *at = look(w, &have);
    return h->length >= 8 && have >= 4 &&
           whole(at, 2, how.big_endian) == DICOM_TAG_ITEM >> 16 &&
           whole(at + 2, 2, how.big_endian) == (DICOM_TAG_ITEM & 0xffff);
}

/* Walks an element and its nested elements. */
static snow_status walk_element(walk *w, coding how, const head *h, int depth) {
    size_t index;
    bool open = h->length == UNDEFINED;
    if (!open)
        SNOW_TRY(check_length(w, h));
    SNOW_TRY(add_element(w, h, &index));
    uint64_t end = open ? UINT64_MAX : w->at + h->length;
    if (open && h->tag == DICOM_TAG_PIXELS && depth == 0) {
        w->reader->packed = true;
        SNOW_TRY(walk_fragments(w, how));
    } else if (open || is_sequence(w, how, h)) {
        if (!memcmp(h->vr, "UN", 2))
            how = (coding){false, false}; /* PS3.5, 6.2.2, note 2 */
        SNOW_TRY(walk_items(w, how, end, depth));
    }
    w->reader->elements[index].next = w->reader->count;
    if (!open)
        w->at = end;
    return SNOW_STATUS_OK;
}

/* Nothing after the pixels is needed, but pixels once more contradict them:
 * elements follow in the order of their tags. */
static snow_status check_after(walk *w, coding how) {
    size_t have;
    head h;
    const unsigned char *at = look(w, &have);
    if (w->inflater || !parse_head(at, have, how, &h) ||
        h.tag != DICOM_TAG_PIXELS)
        return SNOW_STATUS_OK;
    return snow_fail(w->reader->context, SNOW_STATUS_BAD_INPUT,
                     "has element (%04x,%04x) twice; it is damaged",
                     h.tag >> 16, h.tag & 0xffff);
}

/* Walks elements up to `end`, or a delimiter if that is UINT64_MAX.  The file
 * itself ends with its last byte; blanks after the last element are dropped. */
static snow_status walk_set(walk *w, coding how, uint64_t end, int depth) {
    head h;
    for (;;) {
        SNOW_TRY(need(w, LONGEST_HEAD));
        if (w->at >= end || (!depth && w->size - w->at < 8))
            return SNOW_STATUS_OK;
        SNOW_TRY(next_head(w, how, &h));
        if (h.tag == TAG_ITEM_END && depth)
            return SNOW_STATUS_OK;
        if (depth == 0 && h.tag == DICOM_TAG_PIXELS)
            SNOW_TRY(snow_dicom_check_syntax(w->reader));
        if (depth == 0 && h.tag == DICOM_TAG_PIXELS && w->stops) {
            w->reader->has_pixels = true;
            w->reader->packed = h.length == UNDEFINED;
            w->reader->pixel_bytes = w->reader->packed ? 0 : h.length;
            w->reader->pixels_at = w->at;
            snow_status status =
                w->reader->packed ? SNOW_STATUS_OK : check_length(w, &h);
            w->reader->cut = status == SNOW_STATUS_BAD_INPUT;
            return w->reader->cut ? SNOW_STATUS_OK : status;
        }
        SNOW_TRY(walk_element(w, how, &h, depth));
        if (depth == 0 && h.tag == DICOM_TAG_PIXELS)
            return check_after(w, how);
    }
}

/* Reads the meta information, which is always explicit and little endian, and
 * its transfer syntax. */
static snow_status walk_meta(walk *w) {
    const coding how = {true, false};
    char *syntax = w->reader->syntax;
    for (;;) {
        size_t have;
        const unsigned char *at = look(w, &have);
        head h;
        if (have < 8 || whole(at, 2, false) != META_GROUP)
            return SNOW_STATUS_OK;
        SNOW_TRY(next_head(w, how, &h));
        SNOW_TRY(check_length(w, &h));
        if (h.tag == TAG_SYNTAX) {
            const size_t most = sizeof w->reader->syntax - 1;
            snow_seekable_read(w->reader->store, w->at, syntax,
                               h.length < most ? h.length : most);
            for (size_t i = strlen(syntax); i && syntax[i - 1] == ' ';)
                syntax[--i] = 0;
        }
        if (h.tag == TAG_CLASS && h.length < sizeof w->reader->class_known)
            snow_seekable_read(w->reader->store, w->at, w->reader->class_known,
                               h.length);
        w->at += h.length;
    }
}

/* --- opening -------------------------------------------------------------- */

/* What follows the meta information is another row of bytes. */
static snow_status begin_inflating(walk *w) {
    SNOW_TRY(snow_dicom_inflate_begin(w->reader->context, w->reader->store,
                                      w->at, w->pixels, &w->inflater));
    w->at = w->from = w->held = 0;
    w->size = UINT64_MAX;
    return need(w, LONGEST_HEAD);
}

/* The reader's store becomes the inflated bytes. */
static snow_status keep_inflated(walk *w) {
    dicom_reader *r = w->reader;
    SNOW_TRY(snow_source_open_memory(r->context, "it", r->inflated, w->inflated,
                                     &r->inner));
    SNOW_TRY(snow_seekable_open(r->inner, &r->inner_store));
    r->store = r->inner_store;
    return SNOW_STATUS_OK;
}

static snow_status walk_file(walk *w) {
    size_t have;
    dicom_reader *r = w->reader;
    r->store = r->file;
    w->size = snow_seekable_size(r->file);
    w->at = PREAMBLE;
    const unsigned char *at = look(w, &have);
    w->at = have >= 4 && !memcmp(at, "DICM", 4) ? PREAMBLE + 4 : 0;
    SNOW_TRY(walk_meta(w));
    if (!strcmp(r->syntax, DICOM_DEFLATED))
        SNOW_TRY(begin_inflating(w));
    at = look(w, &have);
    if (have < 8)
        return snow_fail(r->context, SNOW_STATUS_BAD_INPUT,
                         "is truncated or damaged: it ends where its elements "
                         "should begin; get the file again");
    /* the elements are more reliable than the declared syntax */
    coding how = guess(at);
    if (!strcmp(r->syntax, BIG_ENDIAN_SYNTAX))
        how.big_endian = true;
    r->big_endian = how.big_endian;
    return walk_set(w, how, UINT64_MAX, 0);
}

snow_status snow_dicom_open(snow_context *context, const char *path,
                            snow_seekable *given, const dicom_image *image,
                            dicom_reader *out) {
    dicom_reader reader = {.context = context, .file = path ? NULL : given};
    walk w = {.reader = &reader, .stops = !image};
    snow_status status = SNOW_STATUS_OK;
    if (path)
        SNOW_TRY(snow_source_open(context, path, &reader.source));
    if (path)
        status = snow_seekable_open(reader.source, &reader.file);
    if (image && !snow_mul_u64(snow_dicom_frame_bytes(image),
                               (uint64_t)image->frames, &w.pixels))
        w.pixels = UINT64_MAX;
    if (image && image->allocated == 1)
        w.pixels = w.pixels / 8 + 1;
    if (status == SNOW_STATUS_OK)
        status = walk_file(&w);
    if (status == SNOW_STATUS_OK && w.inflater)
        status = keep_inflated(&w);
    snow_dicom_inflate_end(w.inflater);
    if (status != SNOW_STATUS_OK) {
        snow_dicom_close(&reader);
        return status;
    }
    reader.frames = snow_dicom_find(&reader, 0, reader.count, TAG_FRAME_GROUPS);
    reader.shared =
        snow_dicom_find(&reader, 0, reader.count, TAG_SHARED_GROUPS);
    *out = reader;
    return SNOW_STATUS_OK;
}

void snow_dicom_close(dicom_reader *reader) {
    snow_seekable_close(reader->inner_store);
    snow_source_close(reader->inner);
    if (reader->source)
        snow_seekable_close(reader->file);
    snow_source_close(reader->source);
    snow_release(reader->context, reader->offsets);
    snow_release(reader->context, reader->inflated);
    snow_release(reader->context, reader->elements);
}
