/* io/output_file.c - files that are complete or absent.
 *
 * Bytes go to a file in the same folder that has no name yet (Linux's
 * O_TMPFILE), so that a crash, a full disk or a signal, even SIGKILL, leaves
 * nothing:
 *
 *   no name      --write, fsync-->  --link-->  folder/NAME
 *                                              --fsync of the folder
 *
 * A file that replaces another has a hidden name, .NAME.snow-XXXXXX, for the
 * moment between link and rename. If the file system has no files without a
 * name (a network file system, say) the hidden name exists from the first byte,
 * and a crash may leave it; it never leaves half of NAME. Without `overwrite`
 * the last step is link(2), which fails if NAME has been created meanwhile;
 * rename(2) would destroy it. Standard output, devices and pipes cannot be
 * renamed: they are written directly. */
#define _XOPEN_SOURCE 700 /* realpath */
#include "io/output_file.h"

#include "io/folder.h"
#include "io/tmpfile.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define SUFFIX_LETTERS 6
/* The part of the final name that a temporary one repeats: the longest name of
 * a file, 255 bytes, less the dots, "snow-" and characters around it. */
#define NAME_PART 200

/* What a user can do about an error of open, write or rename. */
static const char *remedy(int number) {
    switch (number) {
    case ENOSPC:
    case EDQUOT:
        return "free some space or write elsewhere";
    case EACCES:
    case EPERM:
    case EROFS:
        return "choose a folder that you may write to";
    case ENOENT:
    case ENOTDIR:
        return "make the folder first, or correct the name";
    case EFBIG:
        return "choose a file system or limit that allows larger files";
    case ENAMETOOLONG:
        return "choose a shorter name";
    case EPIPE:
        return "the program that reads the output has ended";
    default:
        return "try another folder or disk";
    }
}

static snow_status fail_by_number(snow_context *context, const char *path,
                                  const char *action, int number) {
    char reason[128];
    if (strerror_r(number, reason, sizeof reason))
        snprintf(reason, sizeof reason, "error %d", number);
    return snow_fail(context, SNOW_STATUS_BAD_OUTPUT, "%s: cannot %s: %s; %s",
                     path, action, reason, remedy(number));
}

/* Six characters that differ from call to call; O_EXCL decides whether the name
 * is free, so they need not be secret. */
static void fill_letters(char *letters, const void *salt, int attempt) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    uint64_t mixed = (uint64_t)now.tv_nsec ^ (uint64_t)now.tv_sec << 30 ^
                     (uint64_t)getpid() << 17 ^ (uint64_t)(uintptr_t)salt;
    mixed = (mixed + (uint64_t)attempt) * UINT64_C(0x9E3779B97F4A7C15);
    for (int i = 0; i < SUFFIX_LETTERS; i++, mixed /= 26)
        letters[i] = (char)('a' + mixed % 26);
}

/* Mode 0666 less the process' umask, as for any file that a program creates. */
static const mode_t new_mode =
    S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP | S_IROTH | S_IWOTH;

/* Creates something with `make` under a hidden name that is free, and stores
 * the name in `temporary`. */
static snow_status make_hidden(snow_output_file *file,
                               int (*make)(snow_output_file *file)) {
    const char *name = snow_path_name(file->path);
    size_t folder = (size_t)(name - file->path);
    size_t capacity = folder + NAME_PART + 16;
    file->temporary = snow_allocate(file->context, capacity);
    if (!file->temporary)
        return SNOW_STATUS_NO_MEMORY;
    for (int attempt = 0; attempt < 100; attempt++) {
        char letters[SUFFIX_LETTERS + 1] = "";
        fill_letters(letters, file, attempt);
        snprintf(file->temporary, capacity, "%.*s.%.*s.snow-%s", (int)folder,
                 file->path, NAME_PART, name, letters);
        if (make(file) >= 0)
            return SNOW_STATUS_OK;
        if (errno != EEXIST)
            break;
    }
    int number = errno;
    snow_release(file->context, file->temporary);
    file->temporary = NULL; /* not ours to remove */
    return fail_by_number(file->context, file->given, "be written", number);
}

static int open_hidden(snow_output_file *file) {
    file->descriptor = open(file->temporary,
                            O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, new_mode);
    return file->descriptor;
}

/* Opens a file without a name, if supported. */
static bool open_tmpfile(snow_output_file *file) {
    char folder[PATH_MAX];
    size_t length = (size_t)(snow_path_name(file->path) - file->path);
    if (length >= sizeof folder)
        return false;
    snprintf(folder, sizeof folder, "%.*s", length ? (int)length : 1,
             length ? file->path : ".");
    file->descriptor = snow_tmpfile_open(folder, new_mode);
    file->unnamed = file->descriptor >= 0;
    return file->unnamed;
}

/* Creates and opens the file that will be NAME. */
static snow_status open_temporary(snow_output_file *file) {
    return open_tmpfile(file) ? SNOW_STATUS_OK : make_hidden(file, open_hidden);
}

static snow_status fail_existing(const snow_output_file *file) {
    return snow_fail(file->context, SNOW_STATUS_BAD_OUTPUT,
                     "%s: the file exists; choose another name or allow "
                     "overwriting (-y)",
                     file->given);
}

/* Opens the output for the path, whatever exists there now. */
static snow_status open_target(snow_output_file *file) {
    snow_context *context = file->context;
    const char *path = file->path;
    if (!*snow_path_name(path))
        return snow_fail(context, SNOW_STATUS_BAD_OUTPUT,
                         "\"%s\" is not a file name; give a file name", path);
    struct stat here;
    if (stat(path, &here)) {
        if (errno != ENOENT)
            return fail_by_number(context, file->given, "be written", errno);
        /* A link to nowhere is not followed: it counts as a file. */
        if (!file->overwrite && lstat(path, &here) == 0)
            return fail_existing(file);
        return open_temporary(file);
    }
    if (S_ISDIR(here.st_mode))
        return snow_fail(context, SNOW_STATUS_BAD_OUTPUT,
                         "%s: is a folder; give the name of a file in it",
                         file->given);
    /* A file that replaces another gets the permissions of that one, before its
     * first byte. File systems without permissions refuse, which does no harm.
     * The set-user and set-group bits are not for new contents. */
    if (S_ISREG(here.st_mode)) {
        if (!file->overwrite)
            return fail_existing(file);
        SNOW_TRY(open_temporary(file));
        (void)fchmod(file->descriptor,
                     here.st_mode & (S_IRWXU | S_IRWXG | S_IRWXO));
        return SNOW_STATUS_OK;
    }
    file->descriptor = open(path, O_WRONLY | O_NOCTTY | O_CLOEXEC);
    return file->descriptor >= 0
               ? SNOW_STATUS_OK
               : fail_by_number(context, file->given, "be written", errno);
}

/* Stores the path twice, as given and with its links resolved, so that a link
 * to a file remains and its target is replaced. */
static snow_status keep_paths(snow_output_file *file, const char *path) {
    char resolved[PATH_MAX];
    const char *target = realpath(path, resolved) ? resolved : path;
    if (target == path && errno != ENOENT && errno != ENOTDIR)
        return fail_by_number(file->context, path, "be written", errno);
    size_t given = strlen(path) + 1, real = strlen(target) + 1;
    file->path = snow_allocate(file->context, given + real);
    if (!file->path)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(file->path, target, real);
    memcpy(file->path + real, path, given);
    file->given = file->path + real;
    return SNOW_STATUS_OK;
}

/* Closes a file opened here. Network file systems report a full disk only now.
 * A signal in between does no harm, as the file is synced. */
static int close_file(snow_output_file *file) {
    int descriptor = file->descriptor;
    file->descriptor = -1;
    if (descriptor < 0 || descriptor == STDOUT_FILENO)
        return 0;
    return close(descriptor) && errno != EINTR ? errno : 0;
}

static snow_status fail_to_name(const snow_output_file *file, int number) {
    return number == EEXIST
               ? fail_existing(file)
               : fail_by_number(file->context, file->given, "be named", number);
}

static int link_hidden(snow_output_file *file) {
    return snow_tmpfile_link(file->descriptor, file->temporary);
}

/* Gives an open file without a name its final one, or a hidden one if it
 * replaces a file. */
static snow_status name_file(snow_output_file *file) {
    if (snow_tmpfile_link(file->descriptor, file->path) == 0) {
        file->unnamed = false;
        return SNOW_STATUS_OK;
    }
    if (errno == EEXIST && file->overwrite)
        return make_hidden(file, link_hidden);
    return fail_to_name(file, errno);
}

/* Renames the finished file from its hidden name; returns the error number or
 * 0. */
static int rename_hidden(const snow_output_file *file) {
    if (!file->overwrite) {
        if (link(file->temporary, file->path) == 0) {
            unlink(file->temporary);
            return 0;
        }
        if (errno == EEXIST)
            return errno;
        /* A file system without hard links: check, then rename. */
        struct stat here;
        if (lstat(file->path, &here) == 0)
            return EEXIST;
    }
    return rename(file->temporary, file->path) ? errno : 0;
}

/* Makes the new name survive a power failure. Not every file system can; the
 * file is complete in any case. */
static void sync_folder(snow_output_file *file) {
    size_t length = (size_t)(snow_path_name(file->path) - file->path);
    file->path[length] = 0; /* the file name is no longer needed */
    int folder = open(length ? file->path : ".", O_RDONLY | O_CLOEXEC);
    if (folder < 0)
        return;
    (void)fsync(folder);
    close(folder);
}

/* Returns an error number or 0, also where the file system has no such thing.
 */
static int sync_file(const snow_output_file *file) {
    while (fsync(file->descriptor))
        if (errno != EINTR)
            return errno == EINVAL ? 0 : errno;
    return 0;
}

snow_status snow_output_file_finish(snow_output_file *file) {
    const bool through = !file->unnamed && !file->temporary;
    int number = through || file->hurried ? 0 : sync_file(file);
    if (!number && file->unnamed)
        SNOW_TRY(name_file(file));
    const bool named = !through && !file->unnamed && !file->temporary;
    int closing = close_file(file);
    if (!number)
        number = closing;
    if (number && named)
        unlink(file->path);
    if (number)
        return fail_by_number(file->context, file->given, "be written", number);
    if (file->temporary) {
        number = rename_hidden(file);
        if (number)
            return fail_to_name(file, number);
        snow_release(file->context, file->temporary);
        file->temporary = NULL; /* it has its final name */
    }
    if (!through && !file->hurried)
        sync_folder(file);
    return SNOW_STATUS_OK;
}

snow_status snow_output_file_open(snow_context *context, const char *path,
                                  bool overwrite, snow_output_file *out) {
    *out = (snow_output_file){.context = context,
                              .given = "standard output",
                              .descriptor = STDOUT_FILENO,
                              .overwrite = overwrite};
    if (strcmp(path, "-") == 0)
        return SNOW_STATUS_OK;
    out->descriptor = -1;
    snow_status status = keep_paths(out, path);
    if (status == SNOW_STATUS_OK)
        status = open_target(out);
    if (status != SNOW_STATUS_OK)
        snow_output_file_abandon(out);
    return status;
}

snow_status snow_output_file_write(snow_output_file *file,
                                   const unsigned char *bytes, size_t size) {
    while (size) {
        /* The kernel writes less than 2^31 bytes at once. */
        ssize_t taken =
            write(file->descriptor, bytes, size < INT_MAX ? size : INT_MAX);
        if (taken < 0 && errno == EINTR)
            continue;
        if (taken <= 0)
            return fail_by_number(file->context, file->given, "be written",
                                  taken ? errno : EIO);
        bytes += taken;
        size -= (size_t)taken;
    }
    return SNOW_STATUS_OK;
}

void snow_output_file_abandon(snow_output_file *file) {
    (void)close_file(file);
    if (file->temporary)
        unlink(file->temporary);
    snow_release(file->context, file->temporary);
    snow_release(file->context, file->path);
}
