/* tests/support/volumes.c - see support_volumes.h. */
#include "support/volumes.h"

#include <unistd.h>

static void *allocate_recorded(void *user, size_t bytes) {
    support_place *place = user;
    if (bytes > place->largest)
        place->largest = bytes;
    place->allocations++;
    if (place->fail_at && place->allocations >= place->fail_at)
        return NULL;
    return malloc(bytes);
}

static void release_recorded(void *user, void *block) {
    (void)user;
    free(block);
}

static void hear(void *user, const char *text) {
    support_place *place = user;
    size_t used = strlen(place->warnings);
    snprintf(place->warnings + used, sizeof place->warnings - used, "%s\n",
             text);
}

int support_place_begin(void **state) {
    support_place *place = calloc(1, sizeof *place);
    assert_non_null(place);
    const snow_allocator allocator = {allocate_recorded, release_recorded,
                                      place};
    assert_int_equal(snow_context_new(&allocator, &place->context),
                     SNOW_STATUS_OK);
    snow_context_set_warning(place->context, hear, place);
    support_folder_make(place->folder);
    *state = place;
    return 0;
}

int support_place_end(void **state) {
    support_place *place = *state;
    support_folder_remove(place->folder);
    assert_int_equal(snow_context_bytes(place->context), 0);
    snow_context_free(place->context);
    free(place);
    return 0;
}

const char *support_place_path(const support_place *place, const char *name) {
    return support_folder_path(place->folder, name);
}

const char *support_place_put(const support_place *place, const char *name,
                              const void *bytes, size_t size) {
    const char *path = support_place_path(place, name);
    support_write_file(path, bytes, size);
    return path;
}

snow_volume *support_place_open(support_place *place, const char *path) {
    snow_volume *volume = NULL;
    if (snow_volume_open(place->context, path, NULL, &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    return volume;
}

void support_place_refuse(support_place *place, const char *name,
                          const void *bytes, size_t size, const char *part,
                          size_t most) {
    snow_volume *volume = NULL;
    place->largest = 0;
    snow_status status = snow_volume_open_memory(place->context, name, bytes,
                                                 size, NULL, &volume);
    const char *message = snow_context_message(place->context);
    assert_int_equal(status, SNOW_STATUS_BAD_INPUT);
    assert_null(volume);
    if (!strstr(message, part) || strchr(message, '\n') ||
        strncmp(message, name, strlen(name)) != 0)
        fail_msg("\"%s\" lacks \"%s\"", message, part);
    if (place->largest > most)
        fail_msg("%zu bytes were asked for: %s", place->largest, message);
}
