/* memory.c - the need is computed from sizes alone, before voxels are read.
 *
 * Bytes of an interesting voxel are those of the encodings: its value as a code
 * of 8 or 16 bits and a normal of 16 bits where it is shaded, or four floats
 * for the exact methods; its place takes a bit and a little more. */
#include "memory.h"
#include "commands.h"
#include "report.h"

#include <stdio.h>
#include <string.h>

#define PIXEL_BYTES 16 /* four floats */
#define PLACE_SHARE 7  /* EA: one byte for so many voxels */

static double sheared_bytes(const options *asked, double value_bytes) {
    double code = value_bytes > 1 ? 2 : 1;
    double normal = strcmp(asked->shade, "none") ? 2 : 0;
    /* Slices between slices are encoded as well. */
    double times = strcmp(asked->quality, "high") ? 1 : 2;
    return times * (code + normal + 1.0 / PLACE_SHARE);
}

/* Of an interesting voxel, when all else is there. */
static double encoded_bytes(const options *asked,
                            const snow_volume_info *info) {
    if (strcmp(asked->method, "original") == 0)
        return 0;
    if (strcmp(asked->method, "footprint") == 0)
        return PIXEL_BYTES + 1.0 / PLACE_SHARE;
    double value = (double)snow_type_size(info->type);
    double bytes = sheared_bytes(asked, value);
    /* A draft of few pixels: a level of half the voxels or fewer, which are
     * encoded in place of the volume's. */
    double level = (value + bytes) / 2;
    bool draft = strcmp(asked->quality, "draft") == 0;
    return draft && level > bytes ? level : bytes;
}

/* Of the largest intermediate image: two slice sides, each longer by what the
 * slices are moved. */
static double image_bytes(const options *asked, const snow_volume_info *info) {
    const int64_t *dims = info->dims;
    double scale = strcmp(asked->quality, "draft") ? 2 : 1, most = 0;
    for (int axis = 0; axis < 3; axis++) {
        double deep = (double)dims[axis];
        double wide = (double)dims[(axis + 1) % 3] + deep;
        double high = (double)dims[(axis + 2) % 3] + deep;
        if (wide * high > most)
            most = wide * high;
    }
    return most * scale * scale * PIXEL_BYTES;
}

static uint64_t picture_bytes(const options *asked) {
    return (uint64_t)(asked->size[0] * asked->size[1]) * PIXEL_BYTES;
}

memory_need memory_needed(const options *asked, const snow_volume_info *info) {
    double voxels =
        (double)info->dims[0] * (double)info->dims[1] * (double)info->dims[2];
    double least = voxels * (double)snow_type_size(info->type) +
                   (double)picture_bytes(asked);
    double most =
        least + voxels * encoded_bytes(asked, info) + image_bytes(asked, info);
    return (memory_need){(uint64_t)least, (uint64_t)most};
}

/* Bytes of voxels as they are read; 0 of what cannot be looked at, which the
 * reading tells. */
static uint64_t native_bytes(snow_context *context, const char *path,
                             const snow_volume_options *data) {
    snow_volume_info info;
    if (snow_volume_inspect(context, path, data, &info) != SNOW_OK)
        return 0;
    return (uint64_t)(info.dims[0] * info.dims[1] * info.dims[2]) *
           snow_type_size(info.type);
}

/* The mask, and the volume before it was masked or clipped, are there together
 * with what comes of both. */
static uint64_t masking_bytes(snow_context *context, const char *path,
                              const snow_volume_options *data) {
    snow_volume_options plain = *data, mask = {.type = SNOW_TYPE_NONE};
    const double *plane = data->clip[0];
    bool clips = plane[0] != 0 || plane[1] != 0 || plane[2] != 0;
    if (!data->mask && !clips)
        return 0;
    plain.mask = plain.labels = NULL;
    memset(plain.clip, 0, sizeof plain.clip);
    memcpy(mask.crop, data->crop, sizeof mask.crop);
    return native_bytes(context, path, &plain) +
           (data->mask ? native_bytes(context, data->mask, &mask) : 0);
}

/* "12.3 MiB". */
static const char *print_bytes(uint64_t bytes, char text[32]) {
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    double value = (double)bytes;
    int unit = 0;
    for (; value >= 1024 && unit < 4; unit++)
        value /= 1024;
    snprintf(text, 32, "%.*f %s", unit ? 1 : 0, value, units[unit]);
    return text;
}

int memory_check(snow_context *context, const options *asked, const char *path,
                 const snow_volume_options *data, bool tell) {
    snow_volume_info info;
    char least[32], most[32], limit[32];
    if ((!asked->memory && !tell) || strcmp(path, "-") == 0)
        return GO_ON;
    snow_status status = snow_volume_inspect(context, path, data, &info);
    if (status != SNOW_OK)
        return fail_status(context, status);
    memory_need need = memory_needed(asked, &info);
    uint64_t voxels = need.least - picture_bytes(asked);
    uint64_t masking = voxels + masking_bytes(context, path, data);
    if (masking > need.least)
        need.least = masking;
    if (need.least > need.most)
        need.most = need.least;
    print_bytes(need.least, least);
    print_bytes(need.most, most);
    if (tell)
        say("memory: at least %s, about %s if all voxels are interesting",
            least, most);
    if (!asked->memory || need.least <= asked->memory)
        return GO_ON;
    say("%s: voxels and picture need %s, over the --memory of %s; raise it, "
        "give --crop, or let several machines share the volume (snowglass-mpi)",
        path, least, print_bytes(asked->memory, limit));
    return SNOW_NO_MEMORY;
}
