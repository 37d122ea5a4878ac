/* outputs.c - the rules for writing files: no file is replaced unless
 * requested, and a file under its final name is complete.
 *
 * The library writes pictures and volumes.  The figures are written after them
 * by the tool itself, which follows the library's rules (src/io/output_file.c)
 * for this small text: a hidden .NAME.snow-XXXXXX beside the final file, fsync,
 * then link or rename. */
#define _XOPEN_SOURCE 700 /* realpath */
#include "picture/outputs.h"
#include "run/log.h"
#include "run/paths.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The part of the final name that the hidden name repeats: names have at most
 * 255 bytes, and ".", ".snow-" and six letters are added. */
#define NAME_PART 200

bool is_special(const char *path) {
    struct stat what;
    if (strcmp(path, "-") == 0)
        return true;
    return stat(path, &what) == 0 && !S_ISREG(what.st_mode) &&
           !S_ISDIR(what.st_mode);
}

size_t folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The folder of a path, "." if it has none. */
static void folder_of(const char *path, char *out, size_t size) {
    size_t length = folder_length(path);
    snprintf(out, size, "%.*s", length ? (int)length : 1, length ? path : ".");
}

/* Whether both paths name what is there; *lost: a look-up has failed. */
static bool look_at(const char *a, const char *b, struct stat *of_a,
                    struct stat *of_b, bool *lost) {
    const bool both = stat(a, of_a) == 0 && stat(b, of_b) == 0;
    *lost = *lost || (!both && !means_absence(errno));
    return both;
}

/* Existing files are compared by device and inode, so that links and "./" do
 * not hide that they are equal.  For new files the folder and the name are
 * compared.  A device may take two streams. */
static bool same_place(const char *a, const char *b, bool *lost) {
    struct stat of_a, of_b;
    if (look_at(a, b, &of_a, &of_b, lost))
        return S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev &&
               of_a.st_ino == of_b.st_ino;
    if (strcmp(a + folder_length(a), b + folder_length(b)) != 0)
        return false;
    char folder_a[PATH_MAX], folder_b[PATH_MAX];
    folder_of(a, folder_a, sizeof folder_a);
    folder_of(b, folder_b, sizeof folder_b);
    return look_at(folder_a, folder_b, &of_a, &of_b, lost) &&
           of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

bool same_output(const char *a, const char *b) {
    bool lost = false;
    return a && b && (strcmp(a, b) == 0 || same_place(a, b, &lost));
}

int check_apart(const char *a, const char *b, const char *fault) {
    bool lost = false;
    errno = 0;
    const bool same = a && b && (strcmp(a, b) == 0 || same_place(a, b, &lost));
    if (lost)
        return fail_output("%s: cannot be compared with %s: %s; check the "
                           "permissions and the disk",
                           a, b, strerror(errno));
    return same && fault ? fail_usage("%s", fault) : CONTINUE;
}

static int fail_existing(const char *path) {
    return fail_output("%s: exists; use --overwrite or another name", path);
}

static bool names_folder(const char *path) {
    return ends_with(path, "/") || is_folder(path);
}

int check_no_folder(const char *path) {
    return names_folder(path)
               ? fail_output("%s: is a folder; give the name of a file in it",
                             path)
               : CONTINUE;
}

bool is_free(const char *path, bool overwrite) {
    struct stat what;
    char folder[PATH_MAX];
    folder_of(path, folder, sizeof folder);
    if (is_special(path))
        return true;
    if (names_folder(path) || access(folder, W_OK | X_OK) != 0)
        return false;
    return overwrite || lstat(path, &what) != 0;
}

/* The rules are those of pictures: figures of an earlier run are results too.
 * lstat also finds a dangling link, which counts as a file. */
int check_stats_path(const char *path, bool overwrite) {
    struct stat what;
    if (is_special(path))
        return CONTINUE;
    if (names_folder(path))
        return check_no_folder(path);
    if (!overwrite && lstat(path, &what) == 0)
        return fail_existing(path);
    char folder[PATH_MAX];
    folder_of(path, folder, sizeof folder);
    if (access(folder, W_OK | X_OK) != 0)
        return fail_output("%s: %s; choose a folder that can be written", path,
                           strerror(errno));
    return CONTINUE;
}

int open_bytes(const char *path, int how) {
    int file = -1;
    do
        file = open(path, how | O_CLOEXEC, 0666);
    while (file < 0 && errno == EINTR);
    return file;
}

int write_bytes(int file, const void *bytes, size_t count) {
    const char *at = bytes;
    while (count) {
        ssize_t taken = write(file, at, count);
        if (taken < 0 && errno == EINTR)
            continue;
        if (taken <= 0)
            return taken < 0 ? errno : EIO;
        at += taken;
        count -= (size_t)taken;
    }
    return 0;
}

int write_bytes_at(int file, const void *bytes, size_t count, int64_t at) {
    return lseek(file, (off_t)at, SEEK_SET) < 0
               ? errno
               : write_bytes(file, bytes, count);
}

int sync_bytes(int file) {
    while (fsync(file) != 0)
        if (errno != EINTR)
            return errno == EINVAL ? 0 : errno;
    return 0;
}

/* It is closed even where a signal has come in between. */
int close_bytes(int file) {
    return close(file) == 0 || errno == EINTR ? 0 : errno;
}

/* A text and its end. */
typedef struct text_bytes {
    const char *bytes;
    size_t count;
} text_bytes;

/* Opens a new file beside `path`, on the same file system, and stores its name
 * in `aside`.  mkstemp's mode 0600 is for secrets, so the file gets the mode of
 * the file that it will replace, or that of a new file. */
static int open_aside(const char *path, char *aside, size_t size) {
    size_t folder = folder_length(path);
    int length = snprintf(aside, size, "%.*s.%.*s.snow-XXXXXX", (int)folder,
                          path, NAME_PART, path + folder);
    if (length < 0 || (size_t)length >= size) {
        errno = ENAMETOOLONG;
        return -1;
    }
    int handle = mkstemp(aside);
    if (handle < 0)
        return -1;
    struct stat old;
    mode_t mask = umask(0); /* the only way to read it */
    umask(mask);
    if (stat(path, &old) == 0)
        fchmod(handle, old.st_mode & 0777);
    else if (means_absence(errno))
        fchmod(handle, 0666 & ~mask);
    return handle;
}

/* link fails if a file has appeared since the check; rename would destroy
 * it. */
int name_output(const char *aside, const char *path, bool overwrite) {
    struct stat here;
    if (!overwrite && link(aside, path) == 0)
        return unlink(aside) == 0 ? 0 : errno;
    if (!overwrite && (errno == EEXIST || lstat(path, &here) == 0))
        return EEXIST; /* where there are no hard links, by lstat */
    return rename(aside, path) == 0 ? 0 : errno;
}

/* Makes the new name survive a power failure, if the file system can. */
static void sync_folder(const char *path) {
    char name[PATH_MAX];
    folder_of(path, name, sizeof name);
    int folder = open(name, O_RDONLY | O_CLOEXEC);
    if (folder < 0)
        return;
    (void)fsync(folder);
    close(folder);
}

int place_output(const char *aside, const char *path, bool overwrite) {
    int file = open_bytes(aside, O_RDWR);
    if (file < 0)
        return errno;
    int number = sync_bytes(file);
    close(file);
    if (number == 0)
        number = name_output(aside, path, overwrite);
    if (number == 0)
        sync_folder(path);
    return number;
}

/* A symbolic link is kept, and the file that it points to is replaced. */
static int write_aside(text_bytes text, const char *given, bool overwrite) {
    char resolved[PATH_MAX], aside[PATH_MAX];
    const char *path = realpath(given, resolved) ? resolved : given;
    if (path == given && !means_absence(errno))
        return errno;
    int file = open_aside(path, aside, sizeof aside);
    if (file < 0)
        return errno;
    int number = write_bytes(file, text.bytes, text.count);
    if (number == 0)
        number = sync_bytes(file);
    int closing = close_bytes(file);
    if (number == 0)
        number = closing;
    if (number == 0)
        number = name_output(aside, path, overwrite);
    if (number == 0)
        sync_folder(path);
    else
        unlink(aside);
    return number;
}

/* For pipes and devices, which a rename would replace by a regular file. */
static int write_through(text_bytes text, const char *path) {
    int file = open_bytes(path, O_WRONLY | O_NOCTTY);
    if (file < 0)
        return errno;
    int number = write_bytes(file, text.bytes, text.count);
    int closing = close_bytes(file);
    return number ? number : closing;
}

int write_text(const char *bytes, size_t count, const char *path,
               bool overwrite) {
    const text_bytes text = {bytes, count};
    if (strcmp(path, "-") == 0)
        return fwrite(bytes, 1, count, stdout) == count
                   ? finish_stdout()
                   : fail_output("standard output: cannot be written");
    errno = 0;
    int number = is_special(path) ? write_through(text, path)
                 : errno && !means_absence(errno)
                     ? errno
                     : write_aside(text, path, overwrite);
    if (number == EEXIST)
        return fail_existing(path);
    return number == 0 ? SNOW_STATUS_OK
                       : fail_output("%s: %s; %s", path, strerror(number),
                                     place_remedy(number));
}

int write_json(json_t *object, const char *path, bool overwrite) {
    if (strcmp(path, "-") == 0)
        return print_json(object);
    size_t capacity = json_dumpb(object, NULL, 0, JSON_FORM);
    char *text = capacity ? malloc(capacity + 1) : NULL;
    if (text)
        json_dumpb(object, text, capacity, JSON_FORM);
    json_decref(object);
    if (!text)
        return fail_memory(
            "%s: out of memory for its text; close other programs", path);
    text[capacity] = '\n';
    int done = write_text(text, capacity + 1, path, overwrite);
    free(text);
    return done;
}
