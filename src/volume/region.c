/* volume/region.c - a box of voxels as runs of bytes of a file.
 *
 * Places are 64 bit numbers throughout: the array may be far larger than the
 * memory.  Its size in bytes was checked to fit when the window was laid, so
 * that no product below overflows. */
#include "volume/region.h"
#include "volume/volume.h"

#include <stdio.h>
#include <string.h>

/* Gaps up to a page are read with the rows around them: the disk does so
 * anyway, and one long read costs less than many short ones. */
#define NEAR_BYTES 4096

static snow_status refuse_crop(snow_context *context,
                               const snow_volume_options *options,
                               const int64_t dims[3]) {
    char text[192];
    size_t used = 0;
    for (int i = 0; i < 3; i++) {
        int64_t end = options->crop[i][1] ? options->crop[i][1] : dims[i];
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%lld:%lld",
                                 i ? "," : "", (long long)options->crop[i][0],
                                 (long long)end);
    }
    return snow_fail(
        context, SNOW_STATUS_BAD_USAGE,
        "--crop %s is not inside the volume of %lldx%lldx%lld voxels; give the "
        "first voxel and one past the last along x, y and z",
        text, (long long)dims[0], (long long)dims[1], (long long)dims[2]);
}

snow_status snow_region_lay_out(snow_context *context,
                                const snow_volume_options *options,
                                snow_volume_info *info, snow_region *out) {
    snow_region region = {.value = snow_type_size(info->type)};
    int64_t voxels;
    uint64_t step;
    SNOW_TRY(snow_volume_info_check(context, info));
    snow_volume_count(info->dims, info->type, &voxels, &step);
    if (!snow_mul_u64(step, (uint64_t)info->times, &region.all) ||
        region.all > (uint64_t)INT64_MAX)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "%lld time steps are larger than any file; check the sizes",
            (long long)info->times);
    region.before = step * (uint64_t)info->time;
    for (int i = 0; i < 3; i++) {
        int64_t size = info->dims[i], first = options->crop[i][0];
        int64_t end = options->crop[i][1] ? options->crop[i][1] : size;
        if (first < 0 || end > size || first >= end)
            return refuse_crop(context, options, info->dims);
        region.dims[i] = size;
        region.first[i] = first;
        region.count[i] = end - first;
    }
    memcpy(info->dims, region.count, sizeof info->dims);
    *out = region;
    return SNOW_STATUS_OK;
}

/* How many axes a run spans: x, and others while those before are whole. */
static int run_axes(const snow_region *w) {
    if (w->count[0] != w->dims[0])
        return 1;
    return w->count[1] == w->dims[1] ? 3 : 2;
}

int64_t snow_region_runs(const snow_region *w) {
    int axes = run_axes(w);
    return (axes < 2 ? w->count[1] : 1) * (axes < 3 ? w->count[2] : 1);
}

/* A run of slices begins with the first of them: 0 along all axes but x. */
void snow_region_run(const snow_region *w, int64_t run, uint64_t *begin,
                     uint64_t *end) {
    int64_t rows = run_axes(w) < 2 ? w->count[1] : 1;
    int64_t y = w->first[1] + run % rows, z = w->first[2] + run / rows;
    uint64_t voxel =
        (uint64_t)((z * w->dims[1] + y) * w->dims[0] + w->first[0]);
    *begin = w->before + voxel * w->value;
    int axes = run_axes(w);
    uint64_t voxels = (uint64_t)w->count[0];
    for (int i = 1; i < axes; i++)
        voxels *= (uint64_t)w->count[i];
    *end = *begin + (voxels * w->value);
}

int64_t snow_region_run_at(const snow_region *w, uint64_t at) {
    int64_t low = 0, high = snow_region_runs(w);
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        uint64_t begin, end;
        snow_region_run(w, middle, &begin, &end);
        if (end > at)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Wanted bytes from .. to - 1 of a part, and where they go. */
typedef struct piece {
    uint64_t from, to; /* in the array */
    uint64_t place;    /* in the memory of the box */
} piece;

/* What a part has of a run, which does not end before it; false behind the last
 * one. */
static bool next_piece(const snow_file_part *part, int64_t run, piece *out) {
    uint64_t from, to;
    if (run >= snow_region_runs(part->region))
        return false;
    snow_region_run(part->region, run, &from, &to);
    uint64_t cut = part->begin > from ? part->begin - from : 0;
    *out = (piece){from + cut, to < part->end ? to : part->end,
                   (uint64_t)run * (to - from) + cut};
    return out->from < part->end;
}

bool snow_file_part_wanted(const snow_file_part *part) {
    piece first;
    return next_piece(part, snow_region_run_at(part->region, part->begin),
                      &first);
}

bool snow_file_part_is_all(const snow_file_part *part) {
    uint64_t begin, end;
    snow_region_run(part->region, 0, &begin, &end);
    return snow_region_runs(part->region) == 1 && begin == part->begin &&
           end == part->end;
}

/* Returns where the bytes end that are read in one go with those of a run: at
 * the end of the run, of its slice, or of the box, as gaps are small. */
static uint64_t stretch_end(const snow_region *w, int64_t run) {
    uint64_t begin, end, next;
    int64_t rows = run_axes(w) < 2 ? w->count[1] : 1;
    snow_region_run(w, run, &begin, &end);
    if (rows > 1) {
        uint64_t gap = (uint64_t)(w->dims[0] - w->count[0]) * w->value;
        if (gap > NEAR_BYTES)
            return end;
        run += rows - 1 - run % rows;
        snow_region_run(w, run, &begin, &end);
    }
    if (run + 1 == snow_region_runs(w))
        return end;
    snow_region_run(w, run + 1, &next, &begin);
    if (next - end > NEAR_BYTES)
        return end;
    snow_region_run(w, snow_region_runs(w) - 1, &begin, &end);
    return end;
}

/* From stretch to stretch with a jump, within one by reading on. */
snow_status snow_file_part_read(snow_source *source, const snow_file_part *part,
                                void *voxels) {
    uint64_t at = part->begin, planned = at;
    int64_t run = snow_region_run_at(part->region, part->begin);
    piece p;
    for (; next_piece(part, run, &p); run++) {
        if (p.from >= planned) {
            planned = stretch_end(part->region, run);
            if (planned > part->end)
                planned = part->end;
            snow_source_plan(source, 0);
            SNOW_TRY(snow_source_skip(source, p.from - at, "the voxels"));
            snow_source_plan(source, planned - p.from);
            at = p.from;
        }
        SNOW_TRY(snow_source_skip(source, p.from - at, "the voxels"));
        SNOW_TRY(snow_source_read_all(source, (unsigned char *)voxels + p.place,
                                      (size_t)(p.to - p.from), "the voxels"));
        at = p.to;
    }
    snow_source_plan(source, 0);
    SNOW_TRY(snow_source_skip(source, part->end - at, "the voxels"));
    snow_source_plan(source, UINT64_MAX);
    return SNOW_STATUS_OK;
}

void snow_file_part_copy(const snow_file_part *part, const void *bytes,
                         void *voxels) {
    piece p;
    for (int64_t run = snow_region_run_at(part->region, part->begin);
         next_piece(part, run, &p); run++)
        memcpy((unsigned char *)voxels + p.place,
               (const unsigned char *)bytes + (p.from - part->begin),
               (size_t)(p.to - p.from));
}
