/* source.c - bytes of a file that is reported, and numbers in them. */
#define _POSIX_C_SOURCE 200809L
#include "report/report.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

/* gzread also reads what is not packed. */
static bool read_head(source *out) {
    int copy = dup(out->file);
    gzFile packed = copy >= 0 ? gzdopen(copy, "rb") : NULL;
    out->head = malloc(SOURCE_HEAD);
    if (!packed || !out->head) {
        if (packed)
            gzclose(packed);
        else if (copy >= 0)
            close(copy);
        errno = ENOMEM;
        return false;
    }
    int count = gzread(packed, out->head, (unsigned)SOURCE_HEAD);
    out->head_size = count > 0 ? (size_t)count : 0;
    gzclose(packed);
    return true;
}

bool source_open(const char *path, source *out) {
    struct stat facts;
    *out = (source){.file = open(path, O_RDONLY | O_CLOEXEC)};
    if (out->file < 0)
        return false;
    if (fstat(out->file, &facts) == 0)
        out->size = (uint64_t)facts.st_size;
    if (read_head(out))
        return true;
    source_close(out);
    return false;
}

void source_close(source *from) {
    if (from->file >= 0)
        close(from->file);
    free(from->head);
    *from = (source){.file = -1};
}

size_t source_read(const source *from, uint64_t at, void *bytes, size_t size) {
    size_t done = 0;
    while (done < size && at + done < from->size) {
        ssize_t count = pread(from->file, (char *)bytes + done, size - done,
                              (off_t)(at + done));
        if (count <= 0)
            break;
        done += (size_t)count;
    }
    return done;
}

uint64_t whole_at(const unsigned char *bytes, int size, bool big) {
    uint64_t value = 0;
    for (int i = 0; i < size; i++)
        value = value << 8 | bytes[big ? i : size - 1 - i];
    return value;
}

double real_at(const unsigned char *bytes, int size, bool big) {
    uint64_t bits = whole_at(bytes, size, big);
    uint32_t half = (uint32_t)bits;
    double value;
    float single;
    if (size == 8) {
        memcpy(&value, &bits, 8);
        return value;
    }
    memcpy(&single, &half, 4);
    return (double)single;
}
