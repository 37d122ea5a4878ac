/* formats/save.c - snow_volume_save: selects the format by the file's name.
 *
 * The format's `write` makes the bytes.  The writer compresses them if the name
 * ends in .gz, and makes sure that the file is complete or absent. */
#include "base/monitor.h"
#include "formats/write.h"

static const struct {
    const char *suffix;
    const snow_format *format;
    bool packed;
    const char *unscaled; /* what cannot scale values; NULL: it can */
} endings[] = {
    {".nrrd", &snow_format_nrrd, false, "NRRD"},
    {".nii", &snow_format_nifti, false, NULL},
    {".nii.gz", &snow_format_nifti, true, NULL},
    {".mha", &snow_format_metaimage, false, NULL},
    {".npy", &snow_format_npy, false, "NumPy arrays"},
    {".raw", &snow_format_raw, false, "raw data"},
    {".raw.gz", &snow_format_raw, true, "raw data"},
};
#define ENDING_COUNT (sizeof endings / sizeof *endings)

const char *snow_volume_format_suffix(size_t index) {
    return index < ENDING_COUNT ? endings[index].suffix : NULL;
}

static snow_status refuse_name(snow_context *context, const char *path) {
    char names[128] = "";
    for (size_t i = 0; i < ENDING_COUNT; i++)
        snow_append(names, sizeof names, " %s", endings[i].suffix);
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "%s: volumes are written as%s; use one of these endings",
                     path, names);
}

/* What can be refused is first, so that it never creates a file: a scaling that
 * was dropped would change every value.  A file that fails half-way is aborted,
 * never committed. */
snow_status snow_volume_save(const snow_volume *volume, const char *path,
                             bool overwrite) {
    size_t i = 0;
    SNOW_TRY(snow_need_path(volume->context, path));
    SNOW_TRY(snow_volume_need_voxels(volume));
    while (i < ENDING_COUNT && !snow_has_suffix(path, endings[i].suffix))
        i++;
    if (i == ENDING_COUNT)
        return refuse_name(volume->context, path);
    const snow_volume_info *info = &volume->info;
    if (endings[i].unscaled && (info->slope != 1 || info->intercept != 0))
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "%s: %s cannot hold slope %g and intercept %g; write "
                         ".nii or .mha",
                         path, endings[i].unscaled, info->slope,
                         info->intercept);
    snow_writer *writer;
    SNOW_TRY(snow_writer_open(volume->context, path, overwrite, &writer));
    snow_volume plain = *volume; /* as it is, not as it is drawn */
    snow_volume_unstretch(&plain.info);
    snow_monitor monitor;
    snow_monitor_begin(volume->context, &monitor, NULL, NULL);
    monitor.last = SNOW_STAGE_WRITE;
    snow_status status = SNOW_STATUS_OK;
    if (endings[i].packed)
        status = snow_writer_pack(writer);
    if (status == SNOW_STATUS_OK)
        status = endings[i].format->write(&plain, path, writer);
    status = snow_monitor_end(&monitor, status);
    if (status != SNOW_STATUS_OK) {
        snow_writer_abandon(writer);
        return status;
    }
    return snow_writer_commit(writer);
}
