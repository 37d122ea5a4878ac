/* io/tiff.c - connects libtiff to our sources and memory files. */
#include "io/tiff.h"

#if SNOW_HAVE_TIFF

#include <stdarg.h>
#include <stdio.h>

/* The most that libtiff may allocate at once, for tables of strips and the
 * like, in addition to the size of the file. */
#define LIBRARY_BYTES ((uint64_t)64 << 20)

static tmsize_t read_bytes(thandle_t handle, void *bytes, tmsize_t size) {
    snow_tiff *file = (snow_tiff *)handle;
    size_t got = 0;
    if (file->bytes)
        got = snow_seekable_read(file->bytes, file->at, bytes, (size_t)size);
    file->at += got;
    return (tmsize_t)got;
}

static tmsize_t write_bytes(thandle_t handle, void *bytes, tmsize_t size) {
    snow_tiff *file = (snow_tiff *)handle;
    if (file->bytes)
        return 0;
    file->status =
        snow_memory_file_put(&file->store, file->at, bytes, (size_t)size);
    if (file->status != SNOW_STATUS_OK)
        return 0;
    file->at += (uint64_t)size;
    return size;
}

static toff_t set_size(thandle_t handle) {
    const snow_tiff *file = (const snow_tiff *)handle;
    return file->bytes ? snow_seekable_size(file->bytes) : file->store.size;
}

static toff_t seek_byte(thandle_t handle, toff_t offset, int whence) {
    snow_tiff *file = (snow_tiff *)handle;
    if (whence == SEEK_CUR)
        offset += file->at;
    else if (whence == SEEK_END)
        offset += set_size(handle);
    file->at = offset;
    return offset;
}

static int close_nothing(thandle_t handle) {
    (void)handle;
    return 0;
}

static int keep_error(TIFF *tiff, void *user, const char *module,
                      const char *format, va_list arguments) {
    snow_tiff *file = user;
    (void)tiff;
    (void)module;
    if (!*file->complaint)
        vsnprintf(file->complaint, sizeof file->complaint, format, arguments);
    return 1;
}

/* Mostly about unknown tags. */
static int ignore_warning(TIFF *tiff, void *user, const char *module,
                          const char *format, va_list arguments) {
    (void)tiff;
    (void)user;
    (void)module;
    (void)format;
    (void)arguments;
    return 1;
}

/* In `mode`, m means not mapped. */
static snow_status open_client(snow_tiff *file, const char *name,
                               const char *mode) {
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options)
        return snow_fail(file->context, SNOW_STATUS_NO_MEMORY,
                         "out of memory for TIFF");
    uint64_t most = set_size((thandle_t)file) + LIBRARY_BYTES;
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, (tmsize_t)most);
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_error, file);
    TIFFOpenOptionsSetWarningHandlerExtR(options, ignore_warning, file);
    file->tiff = TIFFClientOpenExt(name, mode, (thandle_t)file, read_bytes,
                                   write_bytes, seek_byte, close_nothing,
                                   set_size, NULL, NULL, options);
    TIFFOpenOptionsFree(options);
    return SNOW_STATUS_OK;
}

snow_status snow_tiff_open(snow_source *source, snow_tiff *file) {
    *file = (snow_tiff){.context = snow_source_context(source)};
    SNOW_TRY(snow_seekable_open(source, &file->bytes));
    SNOW_TRY(open_client(file, snow_source_name(source), "rm"));
    return file->tiff ? SNOW_STATUS_OK : snow_tiff_fail(file);
}

snow_status snow_tiff_create(snow_context *context, snow_tiff *file) {
    *file = (snow_tiff){.context = context, .store = {.context = context}};
    SNOW_TRY(open_client(file, "picture.tif", "w"));
    if (file->tiff)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_NO_MEMORY, "out of memory for TIFF");
}

void snow_tiff_end(snow_tiff *file) {
    if (file->tiff)
        TIFFClose(file->tiff);
    file->tiff = NULL;
}

void snow_tiff_close(snow_tiff *file) {
    snow_tiff_end(file);
    snow_seekable_close(file->bytes);
    snow_release(file->context, file->store.bytes);
}

snow_status snow_tiff_fail(const snow_tiff *file) {
    return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                     "is a damaged or truncated TIFF file (libtiff: %s); fetch "
                     "or write it again",
                     *file->complaint ? file->complaint : "no more bytes");
}

#endif
