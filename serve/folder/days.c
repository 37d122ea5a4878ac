/* days.c - the day and the UID of each series in a DICOM folder, which headers
 * of volumes do not have; see folder.h.
 *
 * Elements are read in little endian, which all but a few files have (PS3.5,
 * 7.1); those within sequences, which may name other series, are passed over.
 * What is found is used only where it agrees with what the reader of DICOM
 * finds: as many series, which it orders by number and UID. */
#include "folder/own.h"

#include "run/paths.h"

#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of a file so many bytes are looked at. */
#define HEAD_BYTES 16384

/* More series than a folder has. */
#define SERIES_MOST 1024

#define UNDEFINED 0xffffffffU
#define ITEM 0xfffee000U
#define SEQUENCE_END 0xfffee0ddU

typedef struct element {
    unsigned tag, length;
    const unsigned char *value;
} element;

static unsigned number_at(const unsigned char *at, int bytes) {
    unsigned number = 0;
    while (bytes--)
        number = number << 8 | at[bytes];
    return number;
}

/* VRs whose length has four bytes, behind two others. */
static bool is_long(const unsigned char *vr) {
    static const char names[] = "OBODOFOLOVOWSQSVUCUNURUTUV";
    for (const char *at = names; *at; at += 2)
        if (memcmp(at, vr, 2) == 0)
            return true;
    return false;
}

/* The next element, with a VR or without.  Of one of undefined length, and of
 * an item, what follows is within it. */
static bool take_element(const unsigned char *head, size_t size, size_t *at,
                         element *out) {
    const unsigned char *own = head + *at;
    if (size - *at < 12)
        return false;
    out->tag = number_at(own, 2) << 16 | number_at(own + 2, 2);
    const bool named = out->tag < ITEM && isupper(own[4]) && isupper(own[5]);
    const bool longer = named && is_long(own + 4);
    out->length = longer  ? number_at(own + 8, 4)
                  : named ? number_at(own + 6, 2)
                          : number_at(own + 4, 4);
    out->value = own + (longer ? 12 : 8);
    const size_t begin = (size_t)(out->value - head),
                 taken = out->tag == ITEM || out->length == UNDEFINED
                             ? 0
                             : out->length;
    if (taken > size - begin)
        return false;
    *at = begin + taken;
    return true;
}

/* The value of an element that is in no sequence; false where it is not found
 * or has no room. */
static bool find_value(const unsigned char *head, size_t size, unsigned tag,
                       char *out, size_t capacity) {
    const bool marked = size > 132 && memcmp(head + 128, "DICM", 4) == 0;
    size_t at = marked ? 132 : 0;
    element e;
    for (int depth = 0; take_element(head, size, &at, &e);) {
        if (e.tag == SEQUENCE_END)
            depth--;
        else if (e.length == UNDEFINED && e.tag < ITEM)
            depth++;
        else if (e.tag == tag && !depth) {
            size_t length = e.length;
            if (length >= capacity)
                return false;
            memcpy(out, e.value, length);
            while (length > 0 && (out[length - 1] == ' ' || !out[length - 1]))
                length--;
            out[length] = 0;
            return true;
        }
    }
    return false;
}

static bool is_digits(const char *text, size_t count) {
    return strlen(text) == count && strspn(text, "0123456789") == count;
}

/* Of an image; others, as reports, are no series of slices. */
static bool read_head(const char *path, day_of_series *out) {
    static const unsigned uid = 0x0020000e, number = 0x00200011,
                          rows = 0x00280010,
                          days[] = {0x00080020, 0x00080021, 0x00080022};
    static unsigned char head[HEAD_BYTES]; /* one thread looks */
    char text[65] = "";
    FILE *file = fopen(path, "rb");
    const size_t size = file ? fread(head, 1, sizeof head, file) : 0;
    if (file)
        fclose(file);
    *out = (day_of_series){.number = 0};
    if (!find_value(head, size, uid, out->uid, sizeof out->uid) ||
        !find_value(head, size, rows, text, sizeof text))
        return false;
    if (find_value(head, size, number, text, sizeof text))
        out->number = strtoll(text, NULL, 10);
    for (size_t i = 0; i < 3 && !*out->day; i++)
        if (find_value(head, size, days[i], text, sizeof text) &&
            is_digits(text, 8))
            snprintf(out->day, sizeof out->day, "%.4s-%.2s-%.2s", text,
                     text + 4, text + 6);
    return true;
}

static int in_order(const void *a, const void *b) {
    const day_of_series *x = a, *y = b;
    return x->number != y->number ? (x->number > y->number) * 2 - 1
                                  : strcmp(x->uid, y->uid);
}

static void note(days_of_folder *all, const day_of_series *one) {
    for (size_t i = 0; i < all->count; i++)
        if (strcmp(all->series[i].uid, one->uid) == 0)
            return;
    if (all->count < SERIES_MOST)
        all->series[all->count++] = *one;
}

void days_read(folder *f, const char *name, days_of_folder *out) {
    char path[PATH_MAX], own[PATH_MAX];
    const struct dirent *entry;
    day_of_series one;
    *out = (days_of_folder){.series = calloc(SERIES_MOST, sizeof one)};
    DIR *stream =
        out->series && list_path(f, name, path) ? opendir(path) : NULL;
    while (stream && cover_serve(f) && (entry = readdir(stream)))
        if (entry->d_name[0] != '.' &&
            snprintf(own, sizeof own, "%s/%s", path, entry->d_name) <
                PATH_MAX &&
            is_file(own) && read_head(own, &one))
            note(out, &one);
    if (stream)
        closedir(stream);
    if (out->series)
        qsort(out->series, out->count, sizeof one, in_order);
}

const day_of_series *days_find(const days_of_folder *all, size_t which,
                               size_t count) {
    return all->count == count ? &all->series[which] : NULL;
}

void days_free(days_of_folder *all) {
    free(all->series);
}
