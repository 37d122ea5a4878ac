/* formats/hdf5/stacks.c - microscopes' files of a data set for each channel and
 * time, which are one volume of channels of light:
 *
 *     Imaris         /DataSet/ResolutionLevel 0/TimePoint 3/Channel 1/Data
 *                    /DataSetInfo/Channel 1: Name, Color "1.000 0.000 0.000"
 *     BigDataViewer  /t00003/s01/0/cells
 *
 * What the setups of BigDataViewer are, and how large voxels are, is in an XML
 * file beside it. */
#include "formats/array.h"
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <stdio.h>
#include <string.h>

/* More times and channels than any file has. */
#define MOST 100000

static void spell(bool imaris, int time, int channel,
                  char out[HDF5_NAME_BYTES]) {
    if (imaris)
        snprintf(out, HDF5_NAME_BYTES,
                 "/DataSet/ResolutionLevel 0/TimePoint %d/Channel %d/Data",
                 time, channel);
    else
        snprintf(out, HDF5_NAME_BYTES, "/t%05d/s%02d/0/cells", time, channel);
}

/* Whether a data set is there, of the sizes of the first. */
static bool is_there(hid_t file, bool imaris, int time, int channel,
                     hdf5_set *first) {
    hdf5_set set;
    char path[HDF5_NAME_BYTES];
    spell(imaris, time, channel, path);
    if (!snow_hdf5_open_values(file, path, &set))
        return false;
    snow_hdf5_drop(set.id);
    if (!time && !channel)
        *first = set;
    return set.axes == 3 && set.type == first->type &&
           !memcmp(set.sizes, first->sizes, 3 * sizeof *set.sizes);
}

static void take_words(const hdf5_file *file, int channel, snow_channel *out) {
    char path[64], text[64];
    snprintf(path, sizeof path, "/DataSetInfo/Channel %d", channel);
    const hid_t id =
        H5Oexists_by_name(snow_hdf5_id(file), path, H5P_DEFAULT) > 0
            ? H5Oopen(snow_hdf5_id(file), path, H5P_DEFAULT)
            : -1;
    double rgb[3];
    if (id < 0)
        return;
    snow_hdf5_letters(file, id, "Color", text);
    if (sscanf(text, "%lf %lf %lf", &rgb[0], &rgb[1], &rgb[2]) == 3 &&
        rgb[0] >= 0 && rgb[0] <= 1 && rgb[1] >= 0 && rgb[1] <= 1 &&
        rgb[2] >= 0 && rgb[2] <= 1)
        memcpy(out->color, rgb, sizeof rgb);
    snow_hdf5_letters(file, id, "Name", text);
    snow_copy_name(text, out->name, sizeof out->name);
    snow_hdf5_drop(id);
}

snow_status snow_hdf5_find_stack(snow_context *context, const hdf5_file *file,
                                 const snow_volume_options *options,
                                 snow_volume_info *said, hdf5_series *out) {
    const hid_t id = snow_hdf5_id(file);
    hdf5_set first;
    int channels = 0, times = 0;
    int64_t channel;
    bool imaris = true;
    *said = snow_volume_info_default("hdf5");
    if (options->dataset)
        return SNOW_STATUS_OK;
    if (!is_there(id, imaris, 0, 0, &first))
        imaris = false;
    while (channels < MOST && is_there(id, imaris, 0, channels, &first))
        channels++;
    while (times < MOST && channels && is_there(id, imaris, times, 0, &first))
        times++;
    if (!channels)
        return SNOW_STATUS_OK;
    said->times = times;
    snow_channels_begin(said, channels, true);
    for (int n = 0; n < channels && n < SNOW_CHANNELS_MAX && imaris; n++)
        take_words(file, n, &said->channel[n]);
    snow_channels_are_light(said, 0);
    if (!imaris && channels > 1)
        snow_notify(context,
                    "setups s00 to s%02d are taken for channels (the XML file "
                    "beside it knows); --dataset selects one alone",
                    channels - 1);
    SNOW_TRY(
        snow_volume_pick_channel(context, options, channels, said, &channel));
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, said));
    out->given = out->stack = true;
    out->count = said->times;
    out->step = out->number = said->time;
    out->no_sign = !imaris && first.type == SNOW_TYPE_INT16;
    spell(imaris, (int)said->time, (int)channel, out->path);
    return SNOW_STATUS_OK;
}

#endif
