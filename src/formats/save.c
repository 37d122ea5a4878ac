/* formats/save.c - snow_volume_save: selects the format by the file's name.
 *
 * The format's `write` makes the bytes.  The writer compresses them if the name
 * ends in .gz, and makes sure that the file is complete or absent. */
#include "base/monitor.h"
#include "formats/write.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *suffix;
    const snow_format *format;
    bool packed;
} endings[] = {
    {".nrrd", &snow_format_nrrd, false},
    {".nii", &snow_format_nifti, false},
    {".nii.gz", &snow_format_nifti, true},
    {".mha", &snow_format_metaimage, false},
    {".npy", &snow_format_npy, false},
    {".raw", &snow_format_raw, false},
    {".raw.gz", &snow_format_raw, true},
};
#define ENDING_COUNT (sizeof endings / sizeof *endings)

const char *snow_volume_format_suffix(size_t index) {
    return index < ENDING_COUNT ? endings[index].suffix : NULL;
}

static snow_status refuse_name(snow_context *context, const char *path) {
    char names[128] = "";
    size_t used = 0;
    for (size_t i = 0; i < ENDING_COUNT && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, " %s",
                                 endings[i].suffix);
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "%s: volumes are written as%s; use one of these endings",
                     path, names);
}

/* The name is checked first, so that a wrong one never creates a file; a file
 * that fails half-way is aborted, never committed. */
snow_status snow_volume_save(const snow_volume *volume, const char *path,
                             bool overwrite) {
    size_t i = 0;
    SNOW_TRY(snow_volume_need_voxels(volume));
    while (i < ENDING_COUNT && !snow_has_suffix(path, endings[i].suffix))
        i++;
    if (i == ENDING_COUNT)
        return refuse_name(volume->context, path);
    snow_writer *writer;
    SNOW_TRY(snow_writer_open(volume->context, path, overwrite, &writer));
    snow_monitor monitor;
    snow_monitor_begin(volume->context, &monitor, NULL, NULL);
    monitor.last = SNOW_STAGE_WRITE;
    snow_status status = SNOW_STATUS_OK;
    if (endings[i].packed)
        status = snow_writer_pack(writer);
    if (status == SNOW_STATUS_OK)
        status = endings[i].format->write(volume, path, writer);
    status = snow_monitor_end(&monitor, status);
    if (status != SNOW_STATUS_OK) {
        snow_writer_abandon(writer);
        return status;
    }
    return snow_writer_commit(writer);
}
