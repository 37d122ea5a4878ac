/* formats/dicom/values.c - finds the values of a parsed file: in the file
 * itself, or in the functional groups of a frame (PS3.3, C.7.6.16); and text
 * among them. */
#include "formats/dicom/dicom.h"

#include <string.h>

const dicom_element *snow_dicom_find(const dicom_reader *r, size_t begin,
                                     size_t end, uint32_t tag) {
    for (size_t i = begin; i < end; i = r->elements[i].next)
        if (r->elements[i].tag == tag)
            return &r->elements[i];
    return NULL;
}

static const dicom_element *
item_of(const dicom_reader *r, const dicom_element *sequence, int64_t number) {
    if (!sequence)
        return NULL;
    size_t at = (size_t)(sequence - r->elements) + 1, end = sequence->next;
    for (int64_t i = 0; at < end; i++, at = r->elements[at].next)
        if (i == number)
            return &r->elements[at];
    return NULL;
}

const dicom_element *snow_dicom_find_in(const dicom_reader *r,
                                        const dicom_element *item,
                                        uint32_t tag) {
    return item ? snow_dicom_find(r, (size_t)(item - r->elements) + 1,
                                  item->next, tag)
                : NULL;
}

/* The groups of a frame; frames are usually requested in order. */
static const dicom_element *groups_of(dicom_reader *r, int64_t frame) {
    if (!r->frames)
        return NULL;
    if (!r->last_item || r->last_frame != frame) {
        size_t next = r->last_item && frame == r->last_frame + 1
                          ? r->elements[r->last_item].next
                          : 0;
        const dicom_element *item = next && next < r->frames->next
                                        ? &r->elements[next]
                                        : item_of(r, r->frames, frame);
        if (!item)
            return NULL;
        r->last_item = (size_t)(item - r->elements);
        r->last_frame = frame;
    }
    return &r->elements[r->last_item];
}

const dicom_element *snow_dicom_locate(dicom_reader *r, dicom_place place) {
    if (!place.sequence)
        return snow_dicom_find(r, 0, r->count, place.tag);
    const dicom_element *sequence =
        snow_dicom_find_in(r, groups_of(r, place.frame), place.sequence);
    if (!sequence)
        sequence =
            snow_dicom_find_in(r, item_of(r, r->shared, 0), place.sequence);
    if (!sequence)
        sequence = snow_dicom_find(r, 0, r->count, place.sequence);
    return snow_dicom_find_in(r, item_of(r, sequence, 0), place.tag);
}

size_t snow_dicom_bytes(const dicom_reader *reader,
                        const dicom_element *element, void *out,
                        size_t capacity) {
    if (!element)
        return 0;
    size_t size = element->length < capacity ? element->length : capacity;
    return snow_seekable_read(reader->store, element->at, out, size);
}

/* Text without blanks around it. */
static void text_of(const dicom_reader *reader, const dicom_element *element,
                    char *out, size_t capacity) {
    size_t length = snow_dicom_bytes(reader, element, out, capacity - 1);
    out[length] = 0;
    length = strlen(out);
    while (length && (out[length - 1] == ' ' || out[length - 1] == '\n'))
        out[--length] = 0;
    size_t blanks = strspn(out, " ");
    memmove(out, out + blanks,
            length - (blanks < length ? blanks : length) + 1);
}

void snow_dicom_text(dicom_reader *reader, uint32_t tag, char *out,
                     size_t capacity) {
    text_of(reader, snow_dicom_locate(reader, (dicom_place){0, 0, tag}), out,
            capacity);
}

/* Text for people in UTF-8 if the file declares UTF-8 or Latin 1, as most do;
 * otherwise '?' replaces characters outside ASCII. */
void snow_dicom_words(dicom_reader *reader, const dicom_element *element,
                      char *out, size_t capacity) {
    char set[65], raw[128];
    size_t used = 0;
    snow_dicom_text(reader, 0x00080005, set, sizeof set);
    text_of(reader, element, raw, sizeof raw);
    bool utf8 = !strcmp(set, "ISO_IR 192"), latin = !strcmp(set, "ISO_IR 100");
    const char *at = raw;
    for (; *at && used + 3 < capacity; at++) {
        unsigned char c = (unsigned char)*at;
        if (c >= 0x80 && latin) {
            out[used++] = (char)(0xc0 | c >> 6);
            out[used++] = (char)(0x80 | (c & 0x3f));
        } else {
            out[used++] =
                c < ' ' || c == 127 || (c >= 0x80 && !utf8) ? '?' : *at;
        }
    }
    while (utf8 && used && ((unsigned char)*at & 0xc0) == 0x80) {
        used--; /* half a character */
        at--;
    }
    out[used] = 0;
}
