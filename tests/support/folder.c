/* tests/support/folder.c - see support_folder.h. */
#include "support/folder.h"
#include "support/support.h"

#include <dirent.h>
#include <unistd.h>

void support_folder_make(char folder[SUPPORT_FOLDER_BYTES]) {
    snprintf(folder, SUPPORT_FOLDER_BYTES, "/tmp/snowglass-test-XXXXXX");
    assert_non_null(mkdtemp(folder));
}

void support_folder_remove(const char *folder) {
    DIR *listing = opendir(folder);
    assert_non_null(listing);
    for (struct dirent *entry; (entry = readdir(listing));) {
        char path[512];
        if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, ".."))
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (unlink(path) != 0)
            support_folder_remove(path);
    }
    closedir(listing);
    assert_int_equal(rmdir(folder), 0);
}

int support_folder_files(const char *folder) {
    DIR *listing = opendir(folder);
    assert_non_null(listing);
    int count = -2; /* . and .. */
    while (readdir(listing))
        count++;
    closedir(listing);
    return count;
}

int support_folder_setup(void **state) {
    static char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    *state = folder;
    return 0;
}

int support_folder_teardown(void **state) {
    support_folder_remove(*state);
    return 0;
}

const char *support_folder_path(const char *folder, const char *name) {
    static char paths[4][512];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

void support_write_file(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    if (size)
        assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}
