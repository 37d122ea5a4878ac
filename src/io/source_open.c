/* io/source_open.c - which files may be opened, and how a name in a header
 * becomes a path.
 *
 * A name on the command line may be a pipe, and "-" is standard input; a name
 * in a header, which is untrusted, must be a regular file. */
#include "io/filters/filter.h"
#include "io/lookup.h"
#include "io/source_internal.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A source without stages; *name becomes its own copy of `name_bytes` bytes
 * with a NUL. */
static snow_status new_source(snow_context *context, const char *name,
                              size_t name_bytes, snow_source **out) {
    snow_source *source =
        snow_allocate_clear(context, sizeof *source + name_bytes + 1);
    if (!source)
        return SNOW_STATUS_NO_MEMORY;
    source->context = context;
    source->name = (char *)(source + 1);
    memcpy(source->name, name, name_bytes);
    *out = source;
    return SNOW_STATUS_OK;
}

/* Detected by the first bytes, since names may be wrong and pipes have none. */
static snow_status unpack_gzip(snow_source *source) {
    snow_filter_stage *top = source->top;
    SNOW_TRY(snow_filter_stage_fill(top, 4));
    if (snow_looks_gzip(top->buffer + top->begin, top->end - top->begin))
        return snow_source_unpack(source);
    return SNOW_STATUS_OK;
}

static snow_status fail_by_errno(snow_source *source) {
    return snow_lookup_fail(source->context, source->name, "opened");
}

/* Rejects what is not a file with data. */
static snow_status check_mode(snow_source *source, const struct stat *about,
                              bool pipes) {
    if (S_ISREG(about->st_mode) ||
        (pipes && (S_ISFIFO(about->st_mode) || S_ISSOCK(about->st_mode))))
        return SNOW_STATUS_OK;
    return snow_fail(source->context, SNOW_STATUS_BAD_INPUT,
                     "%s: is %s; give a regular file", source->name,
                     S_ISDIR(about->st_mode)    ? "a folder"
                     : S_ISFIFO(about->st_mode) ? "a pipe"
                                                : "a device");
}

/* Checks before opening, since opening a device can have side effects, and
 * again after it, when the path can no longer change its meaning. A file that
 * is replaced by a pipe in between must not make the open wait for a writer,
 * hence O_NONBLOCK, which regular files ignore. */
static snow_status open_at_path(snow_source *source, const char *path,
                                bool pipes, int *out, struct stat *about) {
    if (!*path)
        return snow_fail(source->context, SNOW_STATUS_BAD_INPUT,
                         "the file name is empty; give a name");
    if (stat(path, about))
        return fail_by_errno(source);
    SNOW_TRY(check_mode(source, about, pipes));
    bool is_pipe = !S_ISREG(about->st_mode);
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY |
                                    (is_pipe ? 0 : O_NONBLOCK));
    if (descriptor < 0)
        return fail_by_errno(source);
    snow_status status = fstat(descriptor, about)
                             ? fail_by_errno(source)
                             : check_mode(source, about, is_pipe);
    if (status != SNOW_STATUS_OK)
        close(descriptor);
    else
        *out = descriptor;
    return status;
}

static snow_status open_standard_input(snow_source *source, int *out,
                                       struct stat *about) {
    if (fstat(STDIN_FILENO, about))
        return fail_by_errno(source);
    SNOW_TRY(check_mode(source, about, true));
    /* A duplicate, so that closing the source does not close the program's. */
    *out = dup(STDIN_FILENO);
    return *out < 0 ? fail_by_errno(source) : SNOW_STATUS_OK;
}

/* Opens the path, or standard input for NULL; *size is -1 for a pipe. */
static snow_status open_descriptor(snow_source *source, const char *path,
                                   bool pipes, int *out, int64_t *size) {
    struct stat about;
    SNOW_TRY(path ? open_at_path(source, path, pipes, out, &about)
                  : open_standard_input(source, out, &about));
    /* The program may have read from standard input already. */
    off_t at = path ? 0 : lseek(*out, 0, SEEK_CUR);
    *size = -1;
    if (S_ISREG(about.st_mode) && at >= 0 && at <= about.st_size)
        *size = about.st_size - at;
    return SNOW_STATUS_OK;
}

/* Opens `path` (NULL: standard input) under the name of the path. */
static snow_status open_path(snow_context *context, const char *path,
                             bool pipes, bool unpack, snow_source **out) {
    snow_source *source;
    const char *name = path ? path : "standard input";
    SNOW_TRY(new_source(context, name, strlen(name), &source));
    source->siblings = path != NULL; /* standard input is not in a folder */
    int descriptor = -1;
    int64_t size = -1;
    snow_status status =
        open_descriptor(source, path, pipes, &descriptor, &size);
    if (status == SNOW_STATUS_OK) {
        status = snow_filter_stage_open_file(context, source->name, descriptor,
                                             size, &source->top);
        if (status != SNOW_STATUS_OK)
            close(descriptor);
    }
    if (status == SNOW_STATUS_OK && unpack)
        status = unpack_gzip(source);
    if (status != SNOW_STATUS_OK) {
        snow_source_close(source);
        return status;
    }
    *out = source;
    return SNOW_STATUS_OK;
}

snow_status snow_source_open(snow_context *context, const char *path,
                             snow_source **out) {
    return open_path(context, strcmp(path, "-") ? path : NULL, true, true, out);
}

bool snow_source_is_stream(const char *path) {
    struct stat about;
    return strcmp(path, "-") == 0 ||
           (stat(path, &about) == 0 &&
            (S_ISFIFO(about.st_mode) || S_ISSOCK(about.st_mode)));
}

/* Completes a source without siblings, whose bottom stage was made. */
static snow_status finish_open(snow_source *source, snow_status status,
                               snow_source **out) {
    if (status == SNOW_STATUS_OK)
        status = unpack_gzip(source);
    if (status != SNOW_STATUS_OK) {
        snow_source_close(source);
        return status;
    }
    *out = source;
    return SNOW_STATUS_OK;
}

int snow_source_depth(const snow_source *source) {
    return source->depth;
}

void snow_source_set_opener(snow_source *source, int depth,
                            snow_open_named_fn *opener) {
    source->depth = depth;
    source->opener = opener;
}

snow_status snow_source_open_named(const snow_source *source, const char *path,
                                   const snow_volume_options *options,
                                   snow_volume_info *info, snow_volume **out) {
    if (!source->opener)
        return snow_fail(source->context, SNOW_STATUS_BAD_INPUT,
                         "names another file, which is not followed here; "
                         "open it alone");
    return source->opener(source->context, path, source->depth + 1, options,
                          info, out);
}

snow_status snow_source_open_memory(snow_context *context, const char *name,
                                    const void *bytes, size_t size,
                                    snow_source **out) {
    snow_source *source;
    SNOW_TRY(new_source(context, name, strlen(name), &source));
    return finish_open(source,
                       snow_filter_stage_open_memory(context, source->name,
                                                     bytes, size, &source->top),
                       out);
}

snow_status snow_source_open_with(snow_context *context, const char *name,
                                  const snow_bytes_behind *bytes,
                                  snow_source **out) {
    snow_source *source;
    SNOW_TRY(new_source(context, name, strlen(name), &source));
    return finish_open(
        source,
        snow_filter_stage_open_with(context, source->name, bytes, &source->top),
        out);
}

/* The path is the header's folder and the name, joined as a shell would; an
 * absolute name is used as it is. Names that leave the folder are permitted:
 * the caller decides what may be read. */
snow_status snow_source_path_beside(const snow_source *source, const char *name,
                                    char **out) {
    snow_context *context = source->context;
    if (!source->siblings)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%s: its data are in another file (%s), which cannot "
                         "be opened from here; open the header as a file",
                         source->name, name);
    if (!*name || strstr(name, "://"))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%s: its data file \"%s\" does not exist or is not a "
                         "regular file; correct the header",
                         source->name, name);
    const char *slash = *name == '/' ? NULL : strrchr(source->name, '/');
    size_t folder = slash ? (size_t)(slash - source->name) + 1 : 0;
    size_t length = strlen(name);
    char *path = snow_allocate(context, folder + length + 1);
    if (!path)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(path, source->name, folder);
    memcpy(path + folder, name, length + 1);
    *out = path;
    return SNOW_STATUS_OK;
}

snow_status snow_source_look_for_sibling(const snow_source *source,
                                         const char *name, bool *is_there) {
    char *path = NULL;
    mode_t mode = 0;
    SNOW_TRY(snow_source_path_beside(source, name, &path));
    snow_status status = snow_look_for(source->context, path, &mode);
    snow_release(source->context, path);
    *is_there = mode != 0;
    return status;
}

/* The path beside the header that a changed copy of the first `length` letters
 * of a name leads to, with the letters behind them; *out stays NULL if no file
 * is there. */
static snow_status look_at(const snow_source *source, const char *file,
                           const char *rest, char **out) {
    char *path = NULL, *all;
    mode_t mode = 0;
    SNOW_TRY(snow_source_path_beside(source, file, &path));
    snow_status status = snow_look_for(source->context, path, &mode);
    if (status != SNOW_STATUS_OK || !mode || S_ISDIR(mode)) {
        snow_release(source->context, path);
        return status;
    }
    const size_t length = strlen(path), more = strlen(rest) + 1;
    all = snow_allocate(source->context, length + more);
    if (all) {
        memcpy(all, path, length);
        memcpy(all + length, rest, more);
    }
    snow_release(source->context, path);
    *out = all;
    return all ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

/* As look_at, in the order in which a name is tried: as it is, with slashes for
 * the backslashes of Windows, and alone, for a header that was moved. */
static snow_status look_for_moved(const snow_source *source, char *file,
                                  const char *rest, int *tries, char **out) {
    snow_status status = look_at(source, file, rest, out);
    *tries = 0;
    if (status != SNOW_STATUS_OK || *out || !strpbrk(file, "/\\"))
        return status;
    for (char *at = file; *at; at++)
        if (*at == '\\')
            *at = '/';
    for (*tries = 1; *tries < 3 && status == SNOW_STATUS_OK && !*out;
         ++*tries) {
        const char *slash = *tries == 2 ? strrchr(file, '/') : NULL;
        const char *name = slash ? slash + 1 : file;
        status = *name ? look_at(source, name, rest, out) : SNOW_STATUS_OK;
    }
    return status;
}

snow_status snow_source_find_named(snow_source *source, const char *name,
                                   size_t length, char **out) {
    snow_context *context = source->context;
    char *path = NULL;
    int tries = 0;
    /* The usual refusals come first, and the usual path where nothing is. */
    SNOW_TRY(snow_source_path_beside(source, name, out));
    char *file = snow_allocate(context, length + 1);
    snow_status status = file ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    if (file) {
        memcpy(file, name, length);
        file[length] = 0;
        if (length)
            status = look_for_moved(source, file, name + length, &tries, &path);
        snow_release(context, file);
    }
    if (path || status != SNOW_STATUS_OK) {
        snow_release(context, *out);
        *out = path;
    }
    if (path && tries && !source->moved)
        snow_notify(context, "its file \"%.100s\" is not there; %s is taken",
                    name, path);
    source->moved = source->moved || (path && tries);
    return status;
}

static snow_status open_beside(snow_source *source, const char *name,
                               bool unpack, snow_source **out) {
    char *path = NULL;
    SNOW_TRY(snow_source_find_named(source, name, strlen(name), &path));
    snow_status status = open_path(source->context, path, false, unpack, out);
    snow_release(source->context, path);
    return status;
}

snow_status snow_source_open_sibling(snow_source *source, const char *name,
                                     snow_source **out) {
    return open_beside(source, name, true, out);
}

snow_status snow_source_open_sibling_as_is(snow_source *source,
                                           const char *name,
                                           snow_source **out) {
    return open_beside(source, name, false, out);
}
