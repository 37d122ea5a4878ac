/* tests/support/files.c - temporary files, and a context that takes notes. */
#include "support/files.h"

#include <unistd.h>
#include <zlib.h>

static void *noting_allocate(void *user, size_t bytes) {
    support_files *files = user;
    if (bytes > files->largest)
        files->largest = bytes;
    return malloc(bytes);
}

static void noting_release(void *user, void *block) {
    (void)user;
    free(block);
}

static void note(void *user, const char *text) {
    support_files *files = user;
    files->warnings++;
    snprintf(files->warning, sizeof files->warning, "%s", text);
}

void support_files_begin(support_files *files) {
    *files = (support_files){0};
    snow_allocator allocator = {noting_allocate, noting_release, files};
    assert_int_equal(snow_context_new(&allocator, &files->context),
                     SNOW_STATUS_OK);
    snow_context_set_warning(files->context, note, files);
    support_folder_make(files->folder);
}

void support_files_end(support_files *files) {
    support_folder_remove(files->folder);
    assert_int_equal(snow_context_bytes(files->context), 0);
    snow_context_free(files->context);
}

const char *support_path(const support_files *files, const char *name) {
    return support_folder_path(files->folder, name);
}

const char *support_write(const support_files *files, const char *name,
                          const void *bytes, size_t size) {
    const char *path = support_path(files, name);
    support_write_file(path, bytes, size);
    return path;
}

const char *support_write_text(const support_files *files, const char *name,
                               const char *text) {
    return support_write(files, name, text, strlen(text));
}

size_t support_gzip(const void *bytes, size_t size, void *out, size_t room) {
    z_stream stream = {0};
    assert_int_equal(
        deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY),
        Z_OK);
    stream.next_in = (Bytef *)(uintptr_t)bytes;
    stream.avail_in = (uInt)size;
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    size_t packed = room - stream.avail_out;
    deflateEnd(&stream);
    return packed;
}

snow_volume *support_opened(support_files *files, const char *path,
                            const snow_volume_options *options) {
    snow_volume *volume = NULL;
    if (snow_volume_open(files->context, path, options, &volume) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(files->context));
    return volume;
}

void support_refused(support_files *files, const char *path,
                     const snow_volume_options *options, snow_status status,
                     const char *part, size_t most) {
    snow_volume *volume = NULL;
    files->largest = 0;
    assert_int_equal(snow_volume_open(files->context, path, options, &volume),
                     status);
    const char *message = snow_context_message(files->context);
    assert_null(volume);
    if (strncmp(message, path, strlen(path)) != 0 || !strstr(message, part) ||
        !strchr(message, ';') || strchr(message, '\n'))
        fail_msg("not \"%s: ... %s ...; ...\" but \"%s\"", path, part, message);
    assert_true(files->largest <= most);
    assert_int_equal(snow_context_bytes(files->context), 0);
}
