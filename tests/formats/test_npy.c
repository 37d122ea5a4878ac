/* tests/formats/test_npy.c - NumPy arrays as volumes: what is refused, and what
 * a box of them costs.  Every type and order is compared with NumPy in
 * oracle_npy.py. */
#include "support/files.h"

/* Writes an array with that header and `size` bytes of 0, 1, 2, ... */
static const char *write_npy(support_files *files, const char *type,
                             const char *order, const char *shape,
                             size_t size) {
    char bytes[2048] = "\x93NUMPY\1";
    int length = snprintf(bytes + 10, 500,
                          "{'descr': '%s', 'fortran_order': %s, 'shape': %s, "
                          "}\n",
                          type, order, shape);
    bytes[8] = (char)length;
    for (size_t i = 0; i < size; i++)
        bytes[10 + (size_t)length + i] = (char)i;
    return support_write(files, "a.npy", bytes, 10 + (size_t)length + size);
}

/* Those of sizes that they do not have cost nothing. */
static void what_is_no_volume_is_refused(void **state) {
    static const struct {
        const char *type, *order, *shape;
        size_t size;
        const char *part;
    } cases[] = {
        {"<c8", "False", "(2, 3, 4)", 192, "astype"},
        {"|O", "False", "(2, 3, 4)", 192, "astype"},
        {"|u1", "False", "()", 1, "0 axes"},
        {"|u1", "False", "(1,1,1,1,1,1)", 1, "6 axes"},
        {"|u1", "False", "(2, 0, 4)", 9, "empty"},
        {"|u1", "False", "(2, 3, 4)", 23, "is truncated"},
        {"<f8", "False", "(99999, 99999, 99999)", 23, "is truncated"},
        {"<f8", "True", "(9223372036854775807, 9223372036854775807, 9)", 23,
         "too large for any file"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        support_bad_file(*state,
                         write_npy(*state, cases[i].type, cases[i].order,
                                   cases[i].shape, cases[i].size),
                         cases[i].part);
    support_bad_bytes(*state, "a.npz", "PK\3\4....", 8, "unzip");
    support_bad_bytes(*state, "b.npy", "not of NumPy, no", 16,
                      "not an NPY file");
}

/* A box in the middle of 64^3, whichever axis is the fastest. */
static void a_box_costs_little_more_than_its_bytes(void **state) {
    support_files *files = *state;
    static const char *const orders[] = {"False", "True"};
    const snow_volume_options box = {.size = sizeof box,
                                     .crop = {{20, 30}, {0, 64}, {40, 44}}};
    for (int i = 0; i < 2; i++) {
        static char bytes[200 + 64 * 64 * 64] = "\x93NUMPY\1";
        int length = snprintf(bytes + 10, 150,
                              "{'descr': '|u1', 'fortran_order': %s, "
                              "'shape': (64, 64, 64)}",
                              orders[i]);
        bytes[8] = (char)length;
        for (int k = 0; k < 64 * 64 * 64; k++)
            bytes[10 + length + k] = (char)(k / 64 + k % 64);
        const char *path = support_write(files, "b.npy", bytes,
                                         10 + (size_t)length + 64 * 64 * 64);
        uint64_t before = snow_context_bytes_read(files->context);
        snow_volume *volume = support_opened(files, path, &box);
        const uint8_t *voxels = snow_volume_voxels(volume);
        int k = i ? 20 * 64 * 64 + 40 : 40 * 64 * 64 + 20;
        assert_int_equal(voxels[0], (k / 64 + k % 64) & 255);
        /* 4 or 10 slices, and what a layer reads ahead for the header. */
        assert_true(snow_context_bytes_read(files->context) - before <
                    (i ? 10 : 4) * 64 * 64 + 70000);
        snow_volume_close(volume);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(a_box_costs_little_more_than_its_bytes),
        SUPPORT_TEST(what_is_no_volume_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
