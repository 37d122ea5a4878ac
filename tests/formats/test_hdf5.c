/* tests/formats/test_hdf5.c - HDF5 files: how a data set is chosen, and what is
 * left of libhdf5 behind a reader.  Voxels and places are compared with h5py in
 * oracle_hdf5.py. */
#include "support/files.h"

#if SNOW_HAVE_HDF5

#include <formats/hdf5/hdf5.h>
#include <unistd.h>

/* A file with data sets of 4 x 3 x 2 counting bytes under these paths. */
static const char *write_sets(support_files *files, const char *const *names) {
    static unsigned char bytes[24];
    const char *path = support_path(files, "a.h5");
    const hsize_t sizes[3] = {2, 3, 4};
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Screate_simple(3, sizes, NULL);
    hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    for (int i = 0; i < 24; i++)
        bytes[i] = (unsigned char)i;
    for (; *names; names++) {
        hid_t set = H5Dcreate2(file, *names, H5T_NATIVE_UINT8, space, links,
                               H5P_DEFAULT, H5P_DEFAULT);
        H5Dwrite(set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes);
        H5Dclose(set);
    }
    H5Pclose(links);
    H5Sclose(space);
    H5Fclose(file);
    return path;
}

static void expect_counting(snow_volume *volume) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    const uint8_t *voxels = snow_volume_voxels(volume);
    assert_string_equal(info->format, "hdf5");
    assert_true(info->dims[0] == 4 && info->dims[1] == 3 && info->dims[2] == 2);
    for (int i = 0; i < 24; i++)
        assert_int_equal(voxels[i], i);
    snow_volume_close(volume);
}

static void several_are_listed(void **state) {
    support_files *files = *state;
    static const char *const names[] = {"/b/two", "/a", NULL};
    const char *path = write_sets(files, names);
    support_refused(files, path, NULL, SNOW_STATUS_BAD_USAGE,
                    "/a (4x3x2), /b/two (4x3x2)", SUPPORT_MOST);
    const snow_volume_options wrong = {.size = sizeof wrong, .dataset = "c"};
    support_refused(files, path, &wrong, SNOW_STATUS_BAD_USAGE, "/b/two",
                    SUPPORT_MOST);
    const snow_volume_options right = {.size = sizeof right,
                                       .dataset = "b/two"};
    expect_counting(support_opened(files, path, &right));
    char inside[600];
    snprintf(inside, sizeof inside, "%s:/b/two", path);
    expect_counting(support_opened(files, inside, NULL));
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_open(files->context, inside, &right, &volume),
                     SNOW_STATUS_BAD_USAGE);
}

static herr_t hear(hid_t stack, void *user) {
    (void)stack;
    ++*(int *)user;
    return 0;
}

/* Whether the file is read or refused: nothing stays open, and who heard of
 * libhdf5's errors before still does. */
static void nothing_is_left_behind(void **state) {
    support_files *files = *state;
    static const char *const names[] = {"/a", NULL};
    int heard = 0;
    const char *path = write_sets(files, names);
    H5Eset_auto2(H5E_DEFAULT, hear, &heard);
    expect_counting(support_opened(files, path, NULL));
    const char *bad = support_write(files, "b.h5", "\x89HDF\r\n\x1a\n", 8);
    support_bad_file(files, bad, "libhdf5");
    assert_int_equal(heard, 0);
    assert_true(H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL) <= 0);
    heard = 0;
    assert_true(H5Fopen("there is none", H5F_ACC_RDONLY, H5P_DEFAULT) < 0);
    assert_int_equal(heard, 1);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

/* A second link to the root, of which its count of links knows nothing: so
 * libhdf5 takes the root for another group each time it comes to it. */
static const char *write_loop(support_files *files) {
    static const char *const names[] = {"/a", NULL};
    static const unsigned char one[4] = {1, 0, 0, 0};
    unsigned char root[8] = {0}; /* its place, in the superblock at byte 64 */
    const char *path = write_sets(files, names);
    hid_t id = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t group = H5Gcreate2(id, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_hard(id, "/", id, "loop", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_hard(id, "/", group, "up", H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(group);
    H5Fclose(id);
    FILE *file = fopen(path, "r+b");
    assert_true(fseek(file, 64, SEEK_SET) == 0 && fread(root, 8, 1, file) == 1);
    assert_true(fseek(file, root[0] + 256L * root[1] + 4, SEEK_SET) == 0);
    assert_int_equal(fwrite(one, 4, 1, file), 1);
    fclose(file);
    return path;
}

static void a_link_to_the_root_is_not_followed_for_ever(void **state) {
    support_files *files = *state;
    const snow_volume_options named = {.size = sizeof named, .dataset = "a"};
    const char *path = write_loop(files);
    alarm(20); /* ends the test */
    support_bad_file(files, path, "more than 64");
    expect_counting(support_opened(files, path, &named));
    alarm(0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(a_link_to_the_root_is_not_followed_for_ever),
        SUPPORT_TEST(several_are_listed),
        SUPPORT_TEST(nothing_is_left_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

int main(void) {
    return 77;
}

#endif
