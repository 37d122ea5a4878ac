/* base/fingerprint.c - see fingerprint.h. */
#include "base/fingerprint.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Blocks of a file that are read, evenly from the first to the last. */
#define BLOCKS 16
#define BLOCK 4096

uint64_t snow_hash_mix(uint64_t hash, const void *bytes, size_t size) {
    const unsigned char *at = bytes;
    for (size_t n = 0; n < size; n++)
        hash = (hash ^ at[n]) * UINT64_C(1099511628211);
    return hash;
}

/* -1: it cannot be read. */
static int64_t hash_blocks(const char *path, int64_t size) {
    unsigned char block[BLOCK];
    uint64_t hash = SNOW_HASH_START;
    int file = open(path, O_RDONLY | O_CLOEXEC);
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

/* Folders list their files in any order, so that their hashes are added. */
static snow_fingerprint of_folder(const char *path) {
    snow_fingerprint all = {0};
    DIR *folder = opendir(path);
    uint64_t hash = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        struct stat about;
        if (fstatat(dirfd(folder), entry->d_name, &about, 0) != 0 ||
            !S_ISREG(about.st_mode))
            continue;
        int64_t bytes = about.st_size;
        uint64_t own = snow_hash_mix(SNOW_HASH_START, entry->d_name,
                                     strlen(entry->d_name));
        hash += snow_hash_mix(own, &bytes, sizeof bytes);
        all.bytes += bytes;
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
                              hash_blocks(path, about.st_size)};
}
