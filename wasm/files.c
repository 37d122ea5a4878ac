/* files.c - the system calls of the library over the page's files, whose bytes
 * stay with the page until they are read (host.h). */
#include "files.h"
#include "host.h"

#include "base/base.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <wasi/api.h>

#define FILES_MOST 64
#define NAME_MOST 255

/* An open file, or a folder. */
typedef struct open_file {
    bool used;
    int file;          /* the host's, or HOST_FOLDER */
    uint64_t position; /* of a folder: entries that were read */
    char *path;        /* of a folder, and of a file of a server */
} open_file;

static open_file files[FILES_MOST];

static open_file *file_at(int descriptor) {
    bool known = descriptor > STDERR_FILENO && descriptor < FILES_MOST &&
                 files[descriptor].used;
    return known ? &files[descriptor] : NULL;
}

/* Other threads know a server's file by its path. */
static int number_of(const open_file *f) {
    return f->file >= HOST_FAR ? host_find(f->path) : f->file;
}

/* In the place of base/errors.c: what the page says of its files. */
void snow_explain(int number, char *out, size_t size) {
    char why[128] = "";
    strerror_r(number, why, sizeof why);
    *out = 0;
    if (number == EIO)
        host_fault(out, size);
    if (!*out)
        snprintf(out, size, "%s; check the name, and open all files of the "
                            "volume together",
                 why);
}

/* --- names ---------------------------------------------------------------- */

static void describe(int file, struct stat *out) {
    memset(out, 0, sizeof *out);
    out->st_mode = file == HOST_FOLDER ? S_IFDIR | 0555 : S_IFREG | 0444;
    out->st_ino = (ino_t)(file + 3);
    out->st_nlink = 1;
    out->st_blksize = 4096;
    out->st_size = file == HOST_FOLDER ? 0 : (off_t)host_size(file);
}

long __syscall_stat64(long path, long out) {
    int file = host_find((const char *)path);
    if (file == HOST_NONE || file == HOST_FAILED)
        return file == HOST_NONE ? -ENOENT : -EIO;
    describe(file, (struct stat *)out);
    return 0;
}

long __syscall_lstat64(long path, long out) {
    return __syscall_stat64(path, out);
}

long __syscall_fstatat64(long folder, long path, long out, long flags) {
    (void)folder;
    (void)flags;
    return __syscall_stat64(path, out);
}

long __syscall_fstat64(long descriptor, long out) {
    const open_file *f = file_at((int)descriptor);
    if (!f)
        return -EBADF;
    describe(number_of(f), (struct stat *)out);
    return 0;
}

long __syscall_open(const char *path, long flags, ...) {
    int file = host_find(path), descriptor = STDERR_FILENO + 1;
    if (file == HOST_NONE || file == HOST_FAILED)
        return file == HOST_NONE ? -ENOENT : -EIO;
    if ((flags & O_ACCMODE) != O_RDONLY)
        return -EROFS;
    while (descriptor < FILES_MOST && files[descriptor].used)
        descriptor++;
    if (descriptor == FILES_MOST)
        return -EMFILE;
    char *copy =
        file == HOST_FOLDER || file >= HOST_FAR ? strdup(path) : NULL;
    if (!copy && (file == HOST_FOLDER || file >= HOST_FAR))
        return -ENOMEM;
    files[descriptor] =
        (open_file){.used = true, .file = file, .path = copy};
    return descriptor;
}

__wasi_errno_t __wasi_fd_close(__wasi_fd_t descriptor) {
    open_file *f = file_at((int)descriptor);
    if (!f)
        return __WASI_ERRNO_BADF;
    free(f->path);
    *f = (open_file){.used = false};
    return __WASI_ERRNO_SUCCESS;
}

/* One entry a call. */
long __syscall_getdents64(long descriptor, long out, long size) {
    open_file *f = file_at((int)descriptor);
    struct dirent *entry = (struct dirent *)out;
    if (!f || f->file != HOST_FOLDER || (size_t)size < sizeof *entry)
        return -EINVAL;
    memset(entry, 0, sizeof *entry);
    int named =
        host_name(f->path, (int)f->position, entry->d_name, NAME_MOST + 1);
    if (named <= 0)
        return named ? -EIO : 0;
    f->position++;
    entry->d_ino = f->position;
    entry->d_off = (off_t)f->position;
    entry->d_reclen = sizeof *entry;
    return sizeof *entry;
}

/* --- bytes ---------------------------------------------------------------- */

static __wasi_errno_t read_from(int file, uint64_t *at,
                                const __wasi_iovec_t *parts, size_t count,
                                __wasi_size_t *read) {
    *read = 0;
    if (file < 0) /* which was there when it was opened */
        return __WASI_ERRNO_IO;
    double size = host_size(file);
    for (size_t i = 0; i < count; i++) {
        double left = size - (double)*at;
        size_t length = left < (double)parts[i].buf_len
                            ? left > 0 ? (size_t)left : 0
                            : parts[i].buf_len;
        if (length && !host_read(file, (double)*at, parts[i].buf, length))
            return __WASI_ERRNO_IO;
        *at += length;
        *read += length;
    }
    return __WASI_ERRNO_SUCCESS;
}

__wasi_errno_t __wasi_fd_read(__wasi_fd_t descriptor,
                              const __wasi_iovec_t *parts, size_t count,
                              __wasi_size_t *read) {
    open_file *f = file_at((int)descriptor);
    return !f          ? __WASI_ERRNO_BADF
           : f->file == HOST_FOLDER
               ? __WASI_ERRNO_ISDIR
               : read_from(number_of(f), &f->position, parts, count, read);
}

__wasi_errno_t __wasi_fd_pread(__wasi_fd_t descriptor,
                               const __wasi_iovec_t *parts, size_t count,
                               __wasi_filesize_t from, __wasi_size_t *read) {
    const open_file *f = file_at((int)descriptor);
    uint64_t at = from;
    return f && f->file != HOST_FOLDER
               ? read_from(number_of(f), &at, parts, count, read)
               : __WASI_ERRNO_BADF;
}

__wasi_errno_t __wasi_fd_seek(__wasi_fd_t descriptor, __wasi_filedelta_t by,
                              __wasi_whence_t whence, __wasi_filesize_t *now) {
    open_file *f = file_at((int)descriptor);
    if (!f || f->file == HOST_FOLDER)
        return f ? __WASI_ERRNO_ISDIR : __WASI_ERRNO_SPIPE;
    int64_t from = whence == SEEK_SET   ? 0
                   : whence == SEEK_CUR ? (int64_t)f->position
                                        : (int64_t)host_size(number_of(f));
    if (from + by < 0)
        return __WASI_ERRNO_INVAL;
    *now = f->position = (uint64_t)(from + by);
    return __WASI_ERRNO_SUCCESS;
}

/* --- standard output -------------------------------------------------------
 */

static unsigned char *output;
static size_t output_length, output_room;

const unsigned char *files_output(size_t *length) {
    *length = output_length;
    return output;
}

void files_forget_output(void) {
    output_length = 0;
}

static bool put(const void *bytes, size_t length) {
    size_t wanted = output_length + length;
    if (wanted > output_room) {
        unsigned char *grown = realloc(output, 2 * wanted);
        if (!grown)
            return false;
        output = grown;
        output_room = 2 * wanted;
    }
    memcpy(output + output_length, bytes, length);
    output_length = wanted;
    return true;
}

/* What goes to standard error is for nobody: the page hears the library's lines
 * (run/log.h). */
__wasi_errno_t __wasi_fd_write(__wasi_fd_t descriptor,
                               const __wasi_ciovec_t *parts, size_t count,
                               __wasi_size_t *written) {
    *written = 0;
    for (size_t i = 0; i < count; i++) {
        if (descriptor == STDOUT_FILENO && !put(parts[i].buf, parts[i].buf_len))
            return __WASI_ERRNO_NOMEM;
        *written += parts[i].buf_len;
    }
    return descriptor > STDERR_FILENO ? __WASI_ERRNO_BADF
                                      : __WASI_ERRNO_SUCCESS;
}
