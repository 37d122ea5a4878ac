/* base/fingerprint.c - see fingerprint.h. */
#include "base/fingerprint.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Blocks of a file that are read, evenly from the first to the last. */
#define BLOCKS 16
#define BLOCK 4096

/* Files of a folder of which blocks are read. */
#define FILES 4

uint64_t snow_hash_mix(uint64_t hash, const void *bytes, size_t size) {
    const unsigned char *at = bytes;
    for (size_t n = 0; n < size; n++)
        hash = (hash ^ at[n]) * UINT64_C(1099511628211);
    return hash;
}

/* The hash of a file at a path in an open folder, or from where the process
 * is. -1: it cannot be read. */
static int64_t hash_blocks(int folder, const char *path, int64_t size) {
    unsigned char block[BLOCK];
    uint64_t hash = SNOW_HASH_START;
    int file = openat(folder, path, O_RDONLY | O_CLOEXEC);
    ssize_t got = file < 0 ? -1 : 0;
    for (int n = 0; n < BLOCKS && got >= 0; n++) {
        int64_t last = size > BLOCK ? size - BLOCK : 0;
        got = pread(file, block, BLOCK, (off_t)(last * n / (BLOCKS - 1)));
        if (got > 0)
            hash = snow_hash_mix(hash, block, (size_t)got);
    }
    if (file >= 0)
        close(file);
    return got < 0 ? -1 : (int64_t)(hash >> 2);
}

typedef struct folder_file {
    uint64_t hash; /* of its name and size */
    int64_t bytes;
    char name[NAME_MAX + 1];
} folder_file;

/* Keeps the files of the lowest hashes, in their order. */
static void keep_lowest(folder_file kept[FILES], folder_file file) {
    for (int n = 0; n < FILES; n++)
        if (file.hash < kept[n].hash) {
            folder_file higher = kept[n];
            kept[n] = file;
            file = higher;
        }
}

/* False: it is no regular file. */
static bool describe_file(int folder, const char *name, folder_file *out) {
    struct stat about;
    if (fstatat(folder, name, &about, 0) != 0 || !S_ISREG(about.st_mode))
        return false;
    out->bytes = about.st_size;
    snprintf(out->name, sizeof out->name, "%s", name);
    out->hash = snow_hash_mix(SNOW_HASH_START, name, strlen(name));
    out->hash = snow_hash_mix(out->hash, &out->bytes, sizeof out->bytes);
    return true;
}

/* Folders list their files in any order, so that their hashes are added. */
static snow_fingerprint of_folder(const char *path) {
    snow_fingerprint all = {0};
    folder_file file, kept[FILES];
    DIR *folder = opendir(path);
    uint64_t hash = 0;
    for (int n = 0; n < FILES; n++)
        kept[n].hash = UINT64_MAX;
    for (struct dirent *entry; folder && (entry = readdir(folder));)
        if (describe_file(dirfd(folder), entry->d_name, &file)) {
            hash += file.hash;
            all.bytes += file.bytes;
            keep_lowest(kept, file);
        }
    for (int n = 0; n < FILES && kept[n].hash != UINT64_MAX; n++) {
        int64_t blocks =
            hash_blocks(dirfd(folder), kept[n].name, kept[n].bytes);
        hash = snow_hash_mix(hash, &blocks, sizeof blocks);
    }
    if (folder)
        closedir(folder);
    all.hash = (int64_t)(hash >> 2);
    return all;
}

snow_fingerprint snow_fingerprint_of(const char *path) {
    const snow_fingerprint none = {0};
    struct stat about;
    if (stat(path, &about) != 0)
        return none;
    if (S_ISDIR(about.st_mode))
        return of_folder(path);
    if (!S_ISREG(about.st_mode))
        return none;
    return (snow_fingerprint){about.st_size, (int64_t)about.st_mtime,
                              hash_blocks(AT_FDCWD, path, about.st_size)};
}
