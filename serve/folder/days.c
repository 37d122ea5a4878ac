/* days.c - the day and the UID of each series in a DICOM folder, which headers
 * of volumes do not have; see folder.h.
 *
 * No file is parsed: the bytes of an element stand before its value, in the
 * plain encoding that all but a few files have.  What is found is used only
 * where it agrees with what the reader of DICOM finds: as many series, which it
 * orders by number and UID. */
#include "folder/own.h"

#include "run/paths.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of a file so many bytes are looked at. */
#define HEAD_BYTES 16384

/* More series than a folder has. */
#define SERIES_MOST 1024

/* The value of an element with a VR, or without; false where it is not found.
 */
static bool find_value(const unsigned char *head, size_t size,
                       const unsigned char tag[4], const char *vr, char *out,
                       size_t capacity) {
    for (size_t at = 0; at + 8 <= size; at++) {
        if (memcmp(head + at, tag, 4) != 0)
            continue;
        const bool named = memcmp(head + at + 4, vr, 2) == 0;
        const size_t length = named ? head[at + 6] | (size_t)head[at + 7] << 8
                                    : head[at + 4] | (size_t)head[at + 5] << 8;
        if (length >= capacity || at + 8 + length > size ||
            (!named && (head[at + 6] || head[at + 7])))
            continue;
        memcpy(out, head + at + 8, length);
        out[length] = 0;
        for (size_t n = length; n > 0 && (out[n - 1] == ' ' || !out[n - 1]);
             n--)
            out[n - 1] = 0;
        return true;
    }
    return false;
}

static bool is_digits(const char *text, size_t count) {
    return strlen(text) == count && strspn(text, "0123456789") == count;
}

/* Of an image; others, as reports, are no series of slices. */
static bool read_head(const char *path, day_of_series *out) {
    static const unsigned char uid[] = {0x20, 0, 0x0e, 0},
                               number[] = {0x20, 0, 0x11, 0},
                               rows[] = {0x28, 0, 0x10, 0},
                               days[][4] = {{0x08, 0, 0x20, 0},
                                            {0x08, 0, 0x21, 0},
                                            {0x08, 0, 0x22, 0}};
    static unsigned char head[HEAD_BYTES]; /* one thread looks */
    char text[65] = "";
    FILE *file = fopen(path, "rb");
    const size_t size = file ? fread(head, 1, sizeof head, file) : 0;
    if (file)
        fclose(file);
    *out = (day_of_series){.number = 0};
    if (!find_value(head, size, uid, "UI", out->uid, sizeof out->uid) ||
        !find_value(head, size, rows, "US", text, sizeof text))
        return false;
    if (find_value(head, size, number, "IS", text, sizeof text))
        out->number = strtoll(text, NULL, 10);
    for (size_t i = 0; i < 3 && !*out->day; i++)
        if (find_value(head, size, days[i], "DA", text, sizeof text) &&
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
