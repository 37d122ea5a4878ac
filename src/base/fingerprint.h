/* base/fingerprint.h - a few numbers that tell one file from another, without
 * reading all of it. */
#ifndef SNOW_BASE_FINGERPRINT_H
#define SNOW_BASE_FINGERPRINT_H

#include "base/base.h"

/* The fingerprint of a folder is that of names and sizes of the regular files
 * directly in it, and of blocks of a few; folders in it are not looked into. */
typedef struct snow_fingerprint {
    int64_t bytes;   /* of the file, or of all files */
    int64_t changed; /* seconds since 1970; 0 for a folder */
    int64_t hash; /* of blocks from a file's beginning to its end, below 2^62 */
} snow_fingerprint;

/* Zeros where there is neither a regular file nor a folder, or it cannot be
 * read. */
snow_fingerprint snow_fingerprint_of(const char *path);

/* Mixes bytes into a hash, which begins as SNOW_HASH_START (Fowler, Noll and
 * Vo's FNV-1a). */
#define SNOW_HASH_START UINT64_C(14695981039346656037)
uint64_t snow_hash_mix(uint64_t hash, const void *bytes, size_t size);

#endif
