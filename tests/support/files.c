/* tests/support/files.c - temporary files, and a context that takes notes. */
#include "support/files.h"

#include <dirent.h>
#include <math.h>
#include <zlib.h>

static void *noting_allocate(void *user, size_t bytes) {
    support_files *files = user;
    if (bytes > files->largest)
        files->largest = bytes;
    files->allocations++;
    if (files->fail_at && files->allocations >= files->fail_at)
        return NULL;
    return malloc(bytes);
}

static void noting_release(void *user, void *block) {
    (void)user;
    free(block);
}

static void note(void *user, const char *text) {
    support_files *files = user;
    size_t used = strlen(files->warnings);
    snprintf(files->warnings + used, sizeof files->warnings - used, "%s\n",
             text);
}

int support_warned(const support_files *files) {
    int lines = 0;
    for (const char *at = files->warnings; (at = strchr(at, '\n')); at++)
        lines++;
    return lines;
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

int support_files_setup(void **state) {
    *state = calloc(1, sizeof(support_files));
    assert_non_null(*state);
    support_files_begin(*state);
    return 0;
}

int support_files_teardown(void **state) {
    support_files_end(*state);
    free(*state);
    return 0;
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

size_t support_deflate(int window, const void *bytes, size_t size, void *out,
                       size_t room) {
    z_stream stream = {0};
    assert_int_equal(
        deflateInit2(&stream, 9, Z_DEFLATED, window, 9, Z_DEFAULT_STRATEGY),
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

size_t support_gzip(const void *bytes, size_t size, void *out, size_t room) {
    return support_deflate(15 + 16, bytes, size, out, room);
}

snow_volume *support_opened(support_files *files, const char *path,
                            const snow_volume_options *options) {
    snow_volume *volume = NULL;
    if (snow_volume_open(files->context, path, options, &volume) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(files->context));
    return volume;
}

/* That opening failed as it should. */
static void expect_refusal(support_files *files, const snow_volume *volume,
                           const char *name, const char *part, size_t most) {
    const char *message = snow_context_message(files->context);
    assert_null(volume);
    if (strncmp(message, name, strlen(name)) != 0 || !strstr(message, part) ||
        !strchr(message, ';') || strchr(message, '\n'))
        fail_msg("not \"%s: ... %s ...; ...\" but \"%s\"", name, part, message);
    if (files->largest > most)
        fail_msg("%zu bytes were asked for: %s", files->largest, message);
    assert_int_equal(snow_context_bytes(files->context), 0);
}

void support_refused(support_files *files, const char *path,
                     const snow_volume_options *options, snow_status status,
                     const char *part, size_t most) {
    snow_volume *volume = NULL;
    files->largest = 0;
    assert_int_equal(snow_volume_open(files->context, path, options, &volume),
                     status);
    expect_refusal(files, volume, path, part, most);
}

void support_bad_file(support_files *files, const char *path,
                      const char *part) {
    support_refused(files, path, NULL, SNOW_STATUS_BAD_INPUT, part,
                    SUPPORT_MOST);
}

void support_bad_bytes(support_files *files, const char *name,
                       const void *bytes, size_t size, const char *part) {
    snow_volume *volume = NULL;
    files->largest = 0;
    assert_int_equal(snow_volume_open_memory(files->context, name, bytes, size,
                                             NULL, &volume),
                     SNOW_STATUS_BAD_INPUT);
    expect_refusal(files, volume, name, part, SUPPORT_MOST);
}

snow_volume *support_opened_bytes(support_files *files, const char *name,
                                  const void *bytes, size_t size,
                                  const snow_volume_options *options) {
    snow_volume *volume = NULL;
    if (snow_volume_open_memory(files->context, name, bytes, size, options,
                                &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(files->context));
    return volume;
}

void support_expect_matrix(const snow_volume *volume, const double rows[12]) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    for (int i = 0; i < 12; i++)
        if (!(fabs(info->matrix[i / 4][i % 4] - rows[i]) < 1e-9))
            fail_msg("matrix[%d][%d] is %g, not %g", i / 4, i % 4,
                     info->matrix[i / 4][i % 4], rows[i]);
}

void support_same_voxels(const snow_volume *a, const snow_volume *b) {
    const snow_volume_info *of_a = snow_volume_get_info(a);
    const snow_volume_info *of_b = snow_volume_get_info(b);
    assert_memory_equal(of_a->dims, of_b->dims, sizeof of_a->dims);
    assert_int_equal(of_a->type, of_b->type);
    size_t bytes = (size_t)(of_a->dims[0] * of_a->dims[1] * of_a->dims[2]) *
                   snow_type_size(of_a->type);
    assert_memory_equal(snow_volume_voxels(a), snow_volume_voxels(b), bytes);
}

void support_same_matrix(const double a[4][4], const double b[4][4],
                         double tolerance) {
    for (int i = 0; i < 16; i++)
        if (!(fabs(a[i / 4][i % 4] - b[i / 4][i % 4]) <= tolerance))
            fail_msg("matrix entry %d: %.17g and %.17g", i, a[i / 4][i % 4],
                     b[i / 4][i % 4]);
}

void support_each_of_corpus(const char *subject, const char *name,
                            void (*check)(const char *path, const char *name)) {
    char folder[512], path[1024];
    snprintf(folder, sizeof folder, "%s/%s", SNOW_CORPUS, subject);
    DIR *stream = opendir(folder);
    assert_non_null(stream);
    int files = 0;
    for (const struct dirent *entry; (entry = readdir(stream));) {
        if (*entry->d_name == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        check(path, name);
        files++;
    }
    closedir(stream);
    assert_true(files > 5);
}
