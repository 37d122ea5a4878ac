/* tests/formats/test_den.c - DEN volumes: both byte orders, and what is no
 * such. */
#include "support/files.h"

#include "volume/volume.h"

#define HEADER 62

typedef struct den_file {
    unsigned char bytes[HEADER + 64];
    size_t size;
} den_file;

static void put(den_file *file, int index, int value, bool big) {
    file->bytes[2 * index + big] = (unsigned char)(value & 255);
    file->bytes[2 * index + !big] = (unsigned char)(value >> 8);
}

/* 4 x 3 x 2 voxels 0, 1, 2, ... */
static den_file make(bool big) {
    static const int dims[3] = {4, 3, 2};
    den_file file = {.size = HEADER + 24};
    put(&file, 0, 1, big);
    for (int group = 1; group < 28; group += 9)
        for (int i = 0; i < 3; i++) {
            put(&file, group + 3 + i, dims[i] - 1, big);
            put(&file, group + 6 + i, dims[i], big);
        }
    put(&file, big ? 30 : 29, 24, big);
    for (int i = 0; i < 24; i++)
        file.bytes[HEADER + i] = (unsigned char)i;
    return file;
}

static const char *put_file(support_files *files, const den_file *file) {
    return support_write(files, "a.den", file->bytes, file->size);
}

static void both_byte_orders_are_read(void **state) {
    support_files *files = *state;
    for (int big = 0; big < 2; big++) {
        den_file file = make(big);
        snow_volume *volume =
            support_opened(files, put_file(files, &file), NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_string_equal(info->format, "den");
        assert_int_equal(info->type, SNOW_TYPE_UINT8);
        assert_true(info->dims[0] == 4 && info->dims[1] == 3 &&
                    info->dims[2] == 2);
        assert_memory_equal(snow_volume_voxels(volume), file.bytes + HEADER,
                            24);
        snow_volume_close(volume);
    }
}

static void a_box_is_cut_out(void **state) {
    support_files *files = *state;
    den_file file = make(false);
    const snow_volume_options box = {.size = sizeof box,
                                     .crop = {{1, 3}, {2, 3}, {0, 2}}};
    static const unsigned char wanted[] = {9, 10, 21, 22};
    snow_volume *volume = support_opened(files, put_file(files, &file), &box);
    assert_memory_equal(snow_volume_voxels(volume), wanted, sizeof wanted);
    snow_volume_close(volume);
}

static void damaged_files_are_refused(void **state) {
    support_files *files = *state;
    den_file file = make(false);
    file.size--;
    support_bad_file(files, put_file(files, &file), "the file is truncated");
    file = make(false);
    put(&file, 29, 25, false);
    support_bad_file(files, put_file(files, &file),
                     "4x3x2 voxels but another number of bytes");
    file = make(false);
    put(&file, 26, 7, false);
    support_bad_file(files, put_file(files, &file), "not a DEN header");
    file.size = 20;
    support_bad_file(files, put_file(files, &file), "not a DEN header");
}

/* What is known but not read is called by its name. */
static void unsupported_formats_are_known(void **state) {
    support_files *files = *state;
    static const struct {
        size_t offset;
        const char *magic;
        const char *given;
    } unsupported[] = {
        {257, "ustar", "is a tar archive; unpack it"},
        {0, "11111\n66 66 66 8", "is an SLC volume"},
        {0, "PK\3\4", "is a zip archive"},
        {0, "BZh9", "is compressed by bzip2"},
        {0, "MATLAB 5.0 MAT-file", "save it with -v7.3"},
        {0, "RIFF", "is a RIFF file"},
        {0, "GRIB", "cdo -f nc4 -t ecmwf setgridtype,regular"},
        {0, "CheckPointVersion_1.0\n3", "is a checkpoint of AMReX"},
        {0, "Checkpoint version: 1\n", "is a checkpoint of AMReX"},
        {0, "InitialCycleNumber  = 0\n", "is a file of parameters of Enzo"},
        {0, "\nGrid = 1\nTask = 0\n", "is a file of the hierarchy of Enzo"},
        {0, "mrtrix image\ndim: 2,2,2\n", "convert it with mrconvert"},
        {0, "\ntype = string-attribute\nname", "convert it with 3dAFNItoNIFTI"},
        {0, "type  = integer-attribute\nname", "is a header of AFNI"},
        {0, "$MeshFormat\n4.1 0 8\n", "is a mesh of Gmsh"},
        {0, "#!TDV112", "is a file of Tecplot"},
        {0, "FoamFile\n{", "is a file of OpenFOAM"},
    };
    for (size_t i = 0; i < sizeof unsupported / sizeof *unsupported; i++) {
        char bytes[512] = "";
        memcpy(bytes + unsupported[i].offset, unsupported[i].magic,
               strlen(unsupported[i].magic));
        const char *path = support_write(files, "strange", bytes, sizeof bytes);
        support_bad_file(files, path, unsupported[i].given);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(both_byte_orders_are_read),
        SUPPORT_TEST(a_box_is_cut_out),
        SUPPORT_TEST(damaged_files_are_refused),
        SUPPORT_TEST(unsupported_formats_are_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
