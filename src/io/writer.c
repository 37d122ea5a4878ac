/* io/writer.c - writes files that are complete or absent.
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
#include "io/writer.h"
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
#include <zlib.h>

#define BUFFER_BYTES 65536
#define SUFFIX_LETTERS 6
/* The part of the final name that a temporary one repeats: the longest name of
 * a file, 255 bytes, less the dots, "snow-" and characters around it. */
#define NAME_PART 200

struct snow_writer {
    snow_context *context;
    char *path;         /* the final name, its links resolved */
    char *temporary;    /* the hidden name; NULL: none */
    bool unnamed;       /* the file has no name yet */
    const char *given;  /* the caller's name, in `path`'s block */
    int file;           /* -1: closed */
    bool overwrite;     /* may NAME be replaced? */
    snow_status status; /* of the first write that failed */
    z_stream *packer;   /* NULL: bytes are not packed */
    size_t fill;        /* bytes waiting in the buffer */
    unsigned char buffer[BUFFER_BYTES];
};

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

/* The begin of the last component of a path. */
static size_t folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
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
static snow_status take_hidden_name(snow_writer *writer,
                                    int (*make)(snow_writer *writer)) {
    const char *name = writer->path + folder_length(writer->path);
    size_t folder = (size_t)(name - writer->path);
    size_t capacity = folder + NAME_PART + 16;
    writer->temporary = snow_allocate(writer->context, capacity);
    if (!writer->temporary)
        return SNOW_STATUS_NO_MEMORY;
    for (int attempt = 0; attempt < 100; attempt++) {
        char letters[SUFFIX_LETTERS + 1] = "";
        fill_letters(letters, writer, attempt);
        snprintf(writer->temporary, capacity, "%.*s.%.*s.snow-%s", (int)folder,
                 writer->path, NAME_PART, name, letters);
        if (make(writer) >= 0)
            return SNOW_STATUS_OK;
        if (errno != EEXIST)
            break;
    }
    int number = errno;
    snow_release(writer->context, writer->temporary);
    writer->temporary = NULL; /* not ours to remove */
    return fail_by_number(writer->context, writer->given, "be written", number);
}

static int open_hidden(snow_writer *writer) {
    writer->file = open(writer->temporary,
                        O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, new_mode);
    return writer->file;
}

/* Opens a file without a name, if supported. */
static bool open_tmpfile(snow_writer *writer) {
    char folder[PATH_MAX];
    size_t length = folder_length(writer->path);
    if (length >= sizeof folder)
        return false;
    snprintf(folder, sizeof folder, "%.*s", length ? (int)length : 1,
             length ? writer->path : ".");
    writer->file = snow_tmpfile_open(folder, new_mode);
    writer->unnamed = writer->file >= 0;
    return writer->unnamed;
}

/* Creates and opens the file that will be NAME. */
static snow_status open_temporary(snow_writer *writer) {
    return open_tmpfile(writer) ? SNOW_STATUS_OK
                                : take_hidden_name(writer, open_hidden);
}

static snow_status fail_existing(const snow_writer *writer) {
    return snow_fail(writer->context, SNOW_STATUS_BAD_OUTPUT,
                     "%s: the file exists; choose another name or allow "
                     "overwriting (-y)",
                     writer->given);
}

/* For a file that replaces another: it gets the permissions of that one, before
 * its first byte. File systems without permissions refuse, which does no harm.
 * The set-user and set-group bits are not for new contents. */
static snow_status open_successor(snow_writer *writer, mode_t mode) {
    SNOW_TRY(open_temporary(writer));
    (void)fchmod(writer->file, mode & (S_IRWXU | S_IRWXG | S_IRWXO));
    return SNOW_STATUS_OK;
}

/* Opens the output for the path, whatever exists there now. */
static snow_status open_target(snow_writer *writer) {
    snow_context *context = writer->context;
    const char *path = writer->path;
    if (!path[folder_length(path)])
        return snow_fail(context, SNOW_STATUS_BAD_OUTPUT,
                         "\"%s\" is not a file name; give a file name", path);
    struct stat here;
    if (stat(path, &here)) {
        if (errno != ENOENT)
            return fail_by_number(context, writer->given, "be written", errno);
        /* A link to nowhere is not followed: it counts as a file. */
        if (!writer->overwrite && lstat(path, &here) == 0)
            return fail_existing(writer);
        return open_temporary(writer);
    }
    if (S_ISDIR(here.st_mode))
        return snow_fail(context, SNOW_STATUS_BAD_OUTPUT,
                         "%s: is a folder; give the name of a file in it",
                         writer->given);
    if (S_ISREG(here.st_mode))
        return writer->overwrite ? open_successor(writer, here.st_mode)
                                 : fail_existing(writer);
    writer->file = open(path, O_WRONLY | O_NOCTTY | O_CLOEXEC);
    return writer->file >= 0
               ? SNOW_STATUS_OK
               : fail_by_number(context, writer->given, "be written", errno);
}

/* Stores the path twice, as given and with its links resolved, so that a link
 * to a file remains and its target is replaced. */
static snow_status keep_paths(snow_writer *writer, const char *path) {
    char resolved[PATH_MAX];
    const char *target = realpath(path, resolved) ? resolved : path;
    size_t given = strlen(path) + 1, real = strlen(target) + 1;
    writer->path = snow_allocate(writer->context, given + real);
    if (!writer->path)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(writer->path, target, real);
    memcpy(writer->path + real, path, given);
    writer->given = writer->path + real;
    return SNOW_STATUS_OK;
}

snow_status snow_writer_open(snow_context *context, const char *path,
                             bool overwrite, snow_writer **out) {
    snow_writer *writer = snow_allocate(context, sizeof *writer);
    if (!writer)
        return SNOW_STATUS_NO_MEMORY;
    writer->context = context;
    writer->path = writer->temporary = NULL;
    writer->unnamed = false;
    writer->packer = NULL;
    writer->given = "standard output";
    writer->file = STDOUT_FILENO;
    writer->overwrite = overwrite;
    writer->status = SNOW_STATUS_OK;
    writer->fill = 0;
    snow_status status = SNOW_STATUS_OK;
    if (strcmp(path, "-") != 0) {
        writer->file = -1;
        status = keep_paths(writer, path);
        if (status == SNOW_STATUS_OK)
            status = open_target(writer);
    }
    if (status != SNOW_STATUS_OK)
        snow_writer_abandon(writer);
    else
        *out = writer;
    return status;
}

snow_context *snow_writer_context(const snow_writer *writer) {
    return writer->context;
}

static snow_status write_through(snow_writer *writer,
                                 const unsigned char *bytes, size_t size) {
    while (size) {
        /* The kernel writes less than 2^31 bytes at once. */
        ssize_t taken =
            write(writer->file, bytes, size < INT_MAX ? size : INT_MAX);
        if (taken < 0 && errno == EINTR)
            continue;
        if (taken <= 0) {
            writer->status = fail_by_number(writer->context, writer->given,
                                            "be written", taken ? errno : EIO);
            return writer->status;
        }
        bytes += taken;
        size -= (size_t)taken;
    }
    return SNOW_STATUS_OK;
}

static snow_status flush_buffer(snow_writer *writer) {
    size_t fill = writer->fill;
    writer->fill = 0;
    return write_through(writer, writer->buffer, fill);
}

/* Appends bytes as they are. */
static snow_status append_bytes(snow_writer *writer, const void *bytes,
                                size_t size) {
    if (size > BUFFER_BYTES - writer->fill)
        SNOW_TRY(flush_buffer(writer));
    if (size >= BUFFER_BYTES)
        return write_through(writer, bytes, size);
    if (size)
        memcpy(writer->buffer + writer->fill, bytes, size);
    writer->fill += size;
    return SNOW_STATUS_OK;
}

static voidpf allocate_for_zlib(voidpf context, uInt count, uInt size) {
    return snow_allocate_array(context, count, size);
}

static void release_for_zlib(voidpf context, voidpf block) {
    snow_release(context, block);
}

snow_status snow_writer_pack(snow_writer *writer) {
    snow_context *context = writer->context;
    z_stream *packer = snow_allocate_clear(context, sizeof *packer);
    if (!packer)
        return SNOW_STATUS_NO_MEMORY;
    packer->zalloc = allocate_for_zlib;
    packer->zfree = release_for_zlib;
    packer->opaque = context;
    /* 15: the largest window; + 16: gzip, whose header then has no time and no
     * name, so that the same bytes give the same file. */
    if (deflateInit2(packer, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) !=
        Z_OK) {
        snow_release(context, packer);
        return SNOW_STATUS_NO_MEMORY; /* snow_allocate set the message */
    }
    writer->packer = packer;
    return SNOW_STATUS_OK;
}

/* Packs bytes and appends the result, to the stream's end with `last`. */
static snow_status pack(snow_writer *writer, const unsigned char *bytes,
                        size_t size, bool last) {
    z_stream *packer = writer->packer;
    do {
        uInt some = size < INT_MAX ? (uInt)size : INT_MAX;
        int answer = Z_OK;
        packer->next_in = (unsigned char *)bytes;
        packer->avail_in = some;
        size -= some;
        bytes += some;
        do {
            unsigned char packed[4096];
            packer->next_out = packed;
            packer->avail_out = sizeof packed;
            answer = deflate(packer, last && !size ? Z_FINISH : Z_NO_FLUSH);
            SNOW_TRY(append_bytes(writer, packed,
                                  sizeof packed - packer->avail_out));
        } while (packer->avail_out == 0 && answer != Z_STREAM_END);
    } while (size);
    return SNOW_STATUS_OK;
}

snow_status snow_writer_write(snow_writer *writer, const void *bytes,
                              size_t size) {
    if (writer->status != SNOW_STATUS_OK || !size)
        return writer->status;
    return writer->packer ? pack(writer, bytes, size, false)
                          : append_bytes(writer, bytes, size);
}

/* Closes a file opened here. Network file systems report a full disk only now.
 */
static int close_file(snow_writer *writer) {
    int file = writer->file;
    writer->file = -1;
    if (file < 0 || file == STDOUT_FILENO)
        return 0;
    return close(file) ? errno : 0;
}

static snow_status fail_to_name(const snow_writer *writer, int number) {
    return number == EEXIST ? fail_existing(writer)
                            : fail_by_number(writer->context, writer->given,
                                             "be named", number);
}

static int link_hidden(snow_writer *writer) {
    return snow_tmpfile_link(writer->file, writer->temporary);
}

/* Gives an open file without a name its final one, or a hidden one if it
 * replaces a file. */
static snow_status name_file(snow_writer *writer) {
    if (snow_tmpfile_link(writer->file, writer->path) == 0) {
        writer->unnamed = false;
        return SNOW_STATUS_OK;
    }
    if (errno == EEXIST && writer->overwrite)
        return take_hidden_name(writer, link_hidden);
    return fail_to_name(writer, errno);
}

/* Renames the finished file from its hidden name; returns the error number or
 * 0. */
static int place_file(const snow_writer *writer) {
    if (!writer->overwrite) {
        if (link(writer->temporary, writer->path) == 0) {
            unlink(writer->temporary);
            return 0;
        }
        if (errno == EEXIST)
            return errno;
        /* A file system without hard links: check, then rename. */
        struct stat here;
        if (lstat(writer->path, &here) == 0)
            return EEXIST;
    }
    return rename(writer->temporary, writer->path) ? errno : 0;
}

/* Makes the new name survive a power failure. Not every file system can; the
 * file is complete in any case. */
static void sync_folder(snow_writer *writer) {
    size_t length = folder_length(writer->path);
    writer->path[length] = 0; /* the file name is no longer needed */
    int folder = open(length ? writer->path : ".", O_RDONLY | O_CLOEXEC);
    if (folder < 0)
        return;
    (void)fsync(folder);
    close(folder);
}

/* Syncs, closes and names the file. */
static snow_status finish_file(snow_writer *writer) {
    const bool through = !writer->unnamed && !writer->temporary;
    int number = 0;
    if (!through && fsync(writer->file) && errno != EINVAL)
        number = errno;
    else if (writer->unnamed)
        SNOW_TRY(name_file(writer));
    const bool named = !through && !writer->unnamed && !writer->temporary;
    int closing = close_file(writer);
    if (!number)
        number = closing;
    if (number && named)
        unlink(writer->path);
    if (number)
        return fail_by_number(writer->context, writer->given, "be written",
                              number);
    if (writer->temporary) {
        number = place_file(writer);
        if (number)
            return fail_to_name(writer, number);
        snow_release(writer->context, writer->temporary);
        writer->temporary = NULL; /* it has its final name */
    }
    if (!through)
        sync_folder(writer);
    return SNOW_STATUS_OK;
}

snow_status snow_writer_commit(snow_writer *writer) {
    snow_status status = writer->status;
    if (status == SNOW_STATUS_OK && writer->packer)
        status = pack(writer, (const unsigned char *)"", 0, true);
    if (status == SNOW_STATUS_OK)
        status = flush_buffer(writer);
    if (status == SNOW_STATUS_OK)
        status = finish_file(writer);
    snow_writer_abandon(writer);
    return status;
}

void snow_writer_abandon(snow_writer *writer) {
    if (!writer)
        return;
    (void)close_file(writer);
    if (writer->temporary)
        unlink(writer->temporary);
    if (writer->packer)
        deflateEnd(writer->packer);
    snow_release(writer->context, writer->packer);
    snow_release(writer->context, writer->temporary);
    snow_release(writer->context, writer->path);
    snow_release(writer->context, writer);
}
