/* live_file.c - implements live_file.h.
 *
 * Folders of clusters are on servers that tell nobody of new files, so the
 * folder is looked at: its own time first, and its names only when that has
 * changed, and seldom where reading them takes long. */
#include "live_file.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* The folder is read for at most this share of the time. */
#define SCAN_SHARE 0.05

/* A picture has no more bytes. */
#define BYTES_MOST ((off_t)1 << 28)

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* --- names ---------------------------------------------------------------- */

/* Reads "%d" or "%04d"; returns what follows it, or NULL. */
static const char *read_number_sign(const char *at, int *digits) {
    char *end = NULL;
    *digits = at[1] == '0' ? (int)strtol(at + 1, &end, 10) : 0;
    const char *letter = end ? end : at + 1;
    return *letter == 'd' && *digits <= 18 ? letter + 1 : NULL;
}

bool live_files_open(live_files *f, const char *pattern) {
    const char *slash = strrchr(pattern, '/'), *after;
    const char *name = slash ? slash + 1 : pattern;
    const char *sign = strchr(name, '%');
    *f = (live_files){.newest = -1};
    if (!sign || !(after = read_number_sign(sign, &f->digits)))
        return false;
    const size_t length = strlen(after);
    if (length < 4 || strcmp(after + length - 4, ".png") != 0)
        return false;
    f->folder =
        slash ? strndup(pattern, (size_t)(name - pattern)) : strdup("./");
    f->before = strndup(name, (size_t)(sign - name));
    f->after = strdup(after);
    return f->folder && f->before && f->after;
}

void live_files_close(live_files *f) {
    free(f->folder);
    free(f->before);
    free(f->after);
}

/* The number in a name; -1 where the name is another. */
static int64_t number_of(const live_files *f, const char *name) {
    size_t before = strlen(f->before);
    char *end;
    if (strncmp(name, f->before, before) != 0 || name[before] < '0' ||
        name[before] > '9')
        return -1;
    errno = 0;
    long long number = strtoll(name + before, &end, 10);
    bool good = !errno && end - (name + before) >= f->digits &&
                strcmp(end, f->after) == 0;
    return good ? number : -1;
}

static bool is_later(const struct timespec *a, const struct timespec *b) {
    return a->tv_sec != b->tv_sec ? a->tv_sec > b->tv_sec
                                  : a->tv_nsec > b->tv_nsec;
}

/* --- the folder ----------------------------------------------------------- */

/* A later file is newer, and of two of one time the one of the higher step: a
 * simulation may begin again from an earlier one. */
static bool look_at(live_files *f, int folder, const char *name) {
    struct stat is;
    int64_t number = number_of(f, name);
    if (number < 0 || fstatat(folder, name, &is, 0) != 0 ||
        !S_ISREG(is.st_mode))
        return false;
    bool same = !is_later(&is.st_mtim, &f->newest_at) &&
                !is_later(&f->newest_at, &is.st_mtim);
    if (f->newest >= 0 && !is_later(&is.st_mtim, &f->newest_at) &&
        !(same && number > f->newest))
        return false;
    f->newest = number;
    f->newest_at = is.st_mtim;
    return true;
}

/* Finds the newest file; false where it was known. */
static bool scan(live_files *f, char name[NAME_MAX + 1]) {
    bool found = false;
    DIR *folder = opendir(f->folder);
    if (!folder)
        return false;
    for (struct dirent *each; (each = readdir(folder));)
        if (look_at(f, dirfd(folder), each->d_name)) {
            snprintf(name, NAME_MAX + 1, "%s", each->d_name);
            found = true;
        }
    closedir(folder);
    return found;
}

/* The folder's time is that of a clock with coarse steps: within one it may
 * have changed again. */
static bool has_changed(live_files *f, double now) {
    struct stat is;
    struct timespec today;
    if (now < f->next || stat(f->folder, &is) != 0)
        return false;
    clock_gettime(CLOCK_REALTIME, &today);
    bool fresh = today.tv_sec - is.st_mtim.tv_sec < 3;
    bool other = is_later(&is.st_mtim, &f->folder_at) ||
                 is_later(&f->folder_at, &is.st_mtim);
    f->folder_at = is.st_mtim;
    return other || fresh;
}

static unsigned char *read_all(const char *path, size_t *length) {
    struct stat is;
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    if (file && fstat(fileno(file), &is) == 0 && is.st_size > 0 &&
        is.st_size <= BYTES_MOST)
        bytes = malloc((size_t)is.st_size);
    if (bytes &&
        fread(bytes, 1, (size_t)is.st_size, file) != (size_t)is.st_size) {
        free(bytes);
        bytes = NULL;
    }
    if (file)
        fclose(file);
    if (bytes)
        *length = (size_t)is.st_size;
    return bytes;
}

unsigned char *live_files_next(live_files *f, size_t *length) {
    char name[NAME_MAX + 1], path[PATH_MAX];
    double begin = seconds();
    if (!has_changed(f, begin))
        return NULL;
    bool found = scan(f, name);
    double end = seconds();
    f->next = end + (end - begin) / SCAN_SHARE;
    if (!found ||
        snprintf(path, sizeof path, "%s%s", f->folder, name) >= PATH_MAX)
        return NULL;
    return read_all(path, length);
}

/* --- PNG ------------------------------------------------------------------ */

static uint32_t big_endian(const unsigned char *at) {
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 |
           (uint32_t)at[2] << 8 | at[3];
}

/* The text after its keyword. */
static json_t *read_comment(const unsigned char *at, size_t length) {
    static const char keyword[] = "Snowglass";
    if (length <= sizeof keyword || memcmp(at, keyword, sizeof keyword) != 0)
        return NULL;
    return json_loadb((const char *)at + sizeof keyword,
                      length - sizeof keyword, 0, NULL);
}

bool live_file_read(const unsigned char *bytes, size_t length, uint32_t size[2],
                    json_t **comment) {
    static const unsigned char head[16] = {
        0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
    *comment = NULL;
    if (length < 33 || memcmp(bytes, head, sizeof head) != 0)
        return false;
    size[0] = big_endian(bytes + 16);
    size[1] = big_endian(bytes + 20);
    for (size_t at = 8; length - at >= 12;) {
        size_t count = big_endian(bytes + at);
        if (count > length - at - 12 || memcmp(bytes + at + 4, "IDAT", 4) == 0)
            break;
        if (!*comment && memcmp(bytes + at + 4, "tEXt", 4) == 0)
            *comment = read_comment(bytes + at + 8, count);
        at += count + 12;
    }
    return true;
}
