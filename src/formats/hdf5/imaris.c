/* formats/hdf5/imaris.c - files of Imaris (imaris.oxinst.com, "Imaris 5.5 File
 * Format"), whose numbers are texts, a letter an element:
 *
 *     /DataSet/ResolutionLevel 0/TimePoint 0/Channel 0
 *       ImageSizeX, Y, Z   voxels; those of Data beyond them fill up chunks
 *       Data
 *     /DataSetInfo/Image
 *       ExtMin0 .. ExtMax2 the box of all voxels, x first
 *       Unit */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <math.h>
#include <string.h>

void snow_hdf5_letters(const hdf5_file *file, hid_t object, const char *name,
                       char out[64]) {
    const size_t count = snow_hdf5_text(file, object, name, 0, out, 64);
    char letter[2];
    for (size_t n = 1; n < count && n < 63; n++) {
        snow_hdf5_text(file, object, name, n, letter, sizeof letter);
        out[n] = *letter;
        out[n + 1] = 0;
    }
}

static double read_number(const hdf5_file *file, hid_t object, const char *name,
                          int axis, const char *axes) {
    char whole[16] = "", text[64];
    double value = NAN;
    memcpy(whole, name, strlen(name));
    whole[strlen(name)] = axes[axis];
    snow_hdf5_letters(file, object, whole, text);
    return snow_parse_double(text, &value) ? value : NAN;
}

/* Opens the group of the channel; -1: the data set is not of Imaris. */
static hid_t open_channel(const hdf5_file *file, const hdf5_set *set) {
    const bool is_imaris =
        !strncmp(set->path, "/DataSet/ResolutionLevel ", 25) &&
        !strcmp(strrchr(set->path, '/'), "/Data") && set->axes == 3;
    return is_imaris ? snow_hdf5_above(file, set, 1) : -1;
}

void snow_hdf5_trim_imaris(const hdf5_file *file, hdf5_set *set) {
    hid_t channel = open_channel(file, set);
    for (int i = 0; i < 3 && channel >= 0; i++) {
        const double size = read_number(file, channel, "ImageSize", i, "XYZ");
        if (size >= 1 && size < (double)set->sizes[2 - i])
            set->sizes[2 - i] = (hsize_t)size;
    }
    snow_hdf5_drop(channel);
}

bool snow_hdf5_place_imaris(const hdf5_file *file, const hdf5_set *set,
                            snow_volume_info *info) {
    const hid_t channel = open_channel(file, set);
    const hid_t image = channel < 0 ? -1
                                    : H5Oopen(snow_hdf5_id(file),
                                              "DataSetInfo/Image", H5P_DEFAULT);
    char unit[64] = "";
    double step[3], low[3];
    bool given = image >= 0;
    for (int i = 0; i < 3 && given; i++) {
        low[i] = read_number(file, image, "ExtMin", i, "012");
        step[i] = (read_number(file, image, "ExtMax", i, "012") - low[i]) /
                  (double)set->sizes[2 - i];
        given = isfinite(step[i]) && step[i] > 0;
    }
    for (int i = 0; i < 3 && given; i++) {
        info->matrix[i][i] = step[i];
        info->matrix[i][3] = low[i] + step[i] / 2;
    }
    if (given)
        snow_hdf5_letters(file, image, "Unit", unit);
    memcpy(info->unit, unit, strnlen(unit, sizeof info->unit - 1));
    snow_hdf5_drop(image);
    snow_hdf5_drop(channel);
    return given;
}

#endif
