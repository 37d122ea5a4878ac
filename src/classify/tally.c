/* classify/tally.c - see tally.h.  The classifier that encodes voxels counts
 * them as well, so that both agree on which are interesting. */
#include "classify/tally.h"
#include "volume/stream.h"

#include <string.h>

typedef struct pass {
    const snow_volume *volume;
    snow_part part;
    snow_tally *tally;
    int64_t *columns; /* per stored column: its block; -1: a neighbour's */
} pass;

/* Rows of one slice of the whole, from row `y` of it on. */
static void add_strip(const pass *p, const snow_strip *strip, int64_t y,
                      int64_t z) {
    const int64_t *blocks = p->tally->blocks;
    int64_t slice = snow_tally_find(p->tally, 2, z) * blocks[1];
    size_t at = 0;
    for (int64_t row = 0; row < strip->rows; row++) {
        int64_t *counts =
            p->tally->counts +
            (slice + snow_tally_find(p->tally, 1, y + row)) * blocks[0];
        for (; at < strip->row_end[row]; at++) {
            int64_t block = p->columns[strip->columns[at]];
            if (block >= 0)
                counts[block]++;
        }
    }
}

static void add_slices(const pass *p, const snow_classifier *classifier,
                       const snow_placement *placement, snow_strip *strip) {
    const snow_part *part = &p->part;
    int64_t end = part->first[1] + part->count[1];
    for (int64_t i = 0; i < part->count[2]; i++) {
        int64_t z = part->first[2] + i;
        for (int64_t y = part->first[1]; y < end; y += strip->room_rows) {
            int64_t rows = end - y;
            if (rows > strip->room_rows)
                rows = strip->room_rows;
            snow_classify_strip(classifier, placement, z - part->stored[2],
                                y - part->stored[1], rows, strip);
            add_strip(p, strip, y, z);
        }
    }
}

static snow_status find_columns(snow_context *context, pass *p) {
    int64_t columns = p->volume->info.dims[0];
    p->columns =
        snow_allocate_array(context, (uint64_t)columns, sizeof *p->columns);
    if (!p->columns)
        return SNOW_NO_MEMORY;
    for (int64_t i = 0; i < columns; i++) {
        int64_t x = p->part.stored[0] + i, own = x - p->part.first[0];
        p->columns[i] = own >= 0 && own < p->part.count[0]
                            ? snow_tally_find(p->tally, 0, x)
                            : -1;
    }
    return SNOW_OK;
}

snow_status snow_tally_count(const snow_volume *volume,
                             const snow_transfer *transfer, double threshold,
                             snow_isa isa, snow_tally *tally) {
    const int64_t *dims = volume->info.dims;
    snow_context *context = volume->context;
    /* Slices as they lie in memory; no camera is needed to count. */
    snow_placement placement = {.slice_axis = 2,
                                .u_axis = 0,
                                .v_axis = 1,
                                .columns = dims[0],
                                .rows = dims[1],
                                .slices = dims[2]};
    snow_classify_options options = {
        .threshold = threshold, .opacity_exponent = 1, .isa = isa};
    snow_classifier classifier = {0};
    snow_strip strip = {0};
    pass p = {.volume = volume, .tally = tally};
    SNOW_TRY(snow_volume_need_voxels(volume));
    snow_volume_get_part(volume, &p.part);
    if (!p.part.count[0] || !p.part.count[1] || !p.part.count[2])
        return SNOW_OK;
    snow_status status = find_columns(context, &p);
    if (status == SNOW_OK)
        status = snow_classifier_make(context, volume, transfer, &options,
                                      &classifier);
    if (status == SNOW_OK)
        status =
            snow_strip_make(context, &placement, classifier.channels, &strip);
    if (status == SNOW_OK)
        add_slices(&p, &classifier, &placement, &strip);
    snow_strip_free(context, &strip);
    snow_classifier_fini(context, &classifier);
    snow_release(context, p.columns);
    return status;
}

/* One block holds the whole grid. */
snow_status snow_count_interesting(const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   double threshold, snow_isa isa,
                                   int64_t *out) {
    int64_t count = 0;
    snow_part part;
    snow_volume_get_part(volume, &part);
    snow_tally tally = {.blocks = {1, 1, 1}, .counts = &count};
    for (int axis = 0; axis < 3; axis++)
        tally.grid.dims[axis] = tally.block[axis] = part.dims[axis];
    SNOW_TRY(snow_tally_count(volume, transfer, threshold, isa, &tally));
    *out = count;
    return SNOW_OK;
}
