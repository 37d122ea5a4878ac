/* tests/support/records.h - a folder of files in one piece of memory, as tests
 * and fuzz targets have it.  A record is a byte with the length of the name,
 * the name, four bytes with the size of the data, the low one first, and the
 * data.
 */
#ifndef SNOW_TEST_SUPPORT_RECORDS_H
#define SNOW_TEST_SUPPORT_RECORDS_H

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct records_file {
    char name[256];
    const uint8_t *bytes;
    size_t size;
} records_file;

/* Reads the record at *at, and moves it to the next; returns false at the end,
 * or if a record is truncated. */
static inline bool records_next(const uint8_t *bytes, size_t size, size_t *at,
                                records_file *out) {
    const size_t left = size - *at;
    if (!left || left < (size_t)bytes[*at] + 5)
        return false;
    const uint8_t letters = bytes[*at];
    const uint8_t *name = bytes + *at + 1, *count = name + letters;
    out->bytes = count + 4;
    out->size = count[0] | (size_t)count[1] << 8 | (size_t)count[2] << 16 |
                (size_t)count[3] << 24;
    if (out->size > left - letters - 5)
        return false;
    memcpy(out->name, name, letters);
    out->name[letters] = 0;
    *at += letters + 5 + out->size;
    return true;
}

/* Writes it below a folder, in folders of its own.  Names that lead elsewhere,
 * and those that no file can have, are left out. */
static inline void records_write(const char *folder, const records_file *file) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, file->name);
    for (char *at = path + strlen(folder) + 1; (at = strchr(at, '/')); at++) {
        *at = 0;
        mkdir(path, 0700);
        *at = '/';
    }
    FILE *out = strstr(file->name, "..") ? NULL : fopen(path, "wb");
    if (out && fwrite(file->bytes, 1, file->size, out) != file->size)
        abort();
    if (out && fclose(out))
        abort();
}

/* Makes a folder of them; `folder` has the path. */
static inline void records_unpack(const uint8_t *bytes, size_t size,
                                  char folder[32]) {
    records_file file;
    snprintf(folder, 32, "/tmp/snowglass-records-XXXXXX");
    if (!mkdtemp(folder))
        abort();
    for (size_t at = 0; records_next(bytes, size, &at, &file);)
        records_write(folder, &file);
}

/* Removes a folder with all that is in it. */
static inline void records_remove(const char *folder) {
    DIR *listing = opendir(folder);
    const struct dirent *entry;
    while (listing && (entry = readdir(listing))) {
        char path[1024];
        snprintf(path, sizeof path, "%.512s/%s", folder, entry->d_name);
        if (strcmp(entry->d_name, ".") && strcmp(entry->d_name, "..") &&
            remove(path) && errno == ENOTEMPTY)
            records_remove(path);
    }
    if (!listing || closedir(listing) || rmdir(folder))
        abort();
}

#endif
