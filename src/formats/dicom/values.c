/* formats/dicom/values.c - finds the values of a parsed file: in the file
 * itself, or in the functional groups of a frame (PS3.3, C.7.6.16). */
#include "formats/dicom/dicom.h"

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

/* Finds an element in an item; NULL is no item. */
static const dicom_element *find_in(const dicom_reader *r,
                                    const dicom_element *item, uint32_t tag) {
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

static const dicom_element *locate(dicom_reader *r, dicom_place place) {
    if (!place.sequence)
        return snow_dicom_find(r, 0, r->count, place.tag);
    const dicom_element *sequence =
        find_in(r, groups_of(r, place.frame), place.sequence);
    if (!sequence)
        sequence = find_in(r, item_of(r, r->shared, 0), place.sequence);
    if (!sequence)
        sequence = snow_dicom_find(r, 0, r->count, place.sequence);
    return find_in(r, item_of(r, sequence, 0), place.tag);
}

size_t snow_dicom_value(dicom_reader *reader, dicom_place place, void *out,
                        size_t room) {
    const dicom_element *element = locate(reader, place);
    if (!element)
        return 0;
    size_t size = element->length < room ? element->length : room;
    return snow_seekable_read(reader->store, element->at, out, size);
}
