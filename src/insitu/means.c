/* insitu/means.c - what stands below finer cells: the means of these, level by
 * level, as in files (formats/amr/gather.c), by the rank that has them. */
#include "insitu/internal.h"

#include <math.h>
#include <string.h>

/* Cells of one level in a box; shares NULL: 1 of all that are finite. */
typedef struct cell_layer {
    snow_box box;
    double *values;
    float *shares;
} cell_layer;

static snow_box scaled(const snow_box *box, const int64_t ratio[3]) {
    snow_box out = *box;
    for (int i = 0; i < 3; i++) {
        out.first[i] *= ratio[i];
        out.count[i] *= ratio[i];
    }
    return out;
}

/* How many cells of a level lie in one of a level below. */
static void ratio_of(const snow_insitu_levels *levels, int below, int level,
                     int64_t out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = levels->sizes[below][i] / levels->sizes[level][i];
}

static void clear_layer(snow_context *context, cell_layer *layer) {
    snow_context_release(context, layer->values);
    snow_context_release(context, layer->shares);
    *layer = (cell_layer){.values = NULL};
}

static snow_status reserve_layer(snow_context *context, cell_layer *layer,
                                 bool shared) {
    const uint64_t count = (uint64_t)snow_box_voxels(&layer->box);
    snow_status status = snow_context_reserve(context, &layer->values, 0, count,
                                              sizeof *layer->values);
    if (status == SNOW_STATUS_OK && shared)
        status = snow_context_reserve(context, &layer->shares, 0, count,
                                      sizeof *layer->shares);
    for (uint64_t i = 0; status == SNOW_STATUS_OK && shared && i < count; i++) {
        layer->values[i] = 0;
        layer->shares[i] = 0;
    }
    return status;
}

/* The brick's own cells as doubles. */
static snow_status take_own(const snow_insitu *insitu,
                            const snow_level_brick *brick, cell_layer *own) {
    const snow_brick from = snow_insitu_cells_of(insitu, brick);
    const int64_t count = snow_box_voxels(&own->box);
    INSITU_TRY(reserve_layer(insitu->context, own, false));
    snow_brick_copy(&from, snow_type_size(insitu->type), &own->box, &own->box,
                    own->values);
    if (insitu->type == SNOW_TYPE_FLOAT32) /* from behind, in place */
        for (int64_t i = count - 1; i >= 0; i--) {
            float narrow;
            memcpy(&narrow, (const char *)own->values + 4 * i, sizeof narrow);
            own->values[i] = (double)narrow;
        }
    return SNOW_STATUS_OK;
}

/* The means of the cells of a layer as one of the level below. */
static void add_layer(const cell_layer *from, const int64_t ratio[3],
                      cell_layer *to) {
    const snow_box *box = &from->box;
    for (int64_t n = 0; n < box->count[1] * box->count[2]; n++) {
        const int64_t place = n * box->count[0];
        const int64_t y = n % box->count[1] / ratio[1];
        const int64_t z = n / box->count[1] / ratio[2];
        const int64_t at = (z * to->box.count[1] + y) * to->box.count[0];
        snow_cells_add(from->values + place,
                       from->shares ? from->shares + place : NULL, 0,
                       box->count[0], ratio, to->values + at, to->shares + at);
    }
    for (int64_t i = 0; i < snow_box_voxels(&to->box); i++)
        to->values[i] =
            to->shares[i] > 0 ? to->values[i] / (double)to->shares[i] : NAN;
}

/* A layer of cells of the block's level, from the brick's. */
static snow_status mean_layer(const snow_insitu *insitu,
                              const snow_level_block *block,
                              const snow_box *layer, char *out) {
    const snow_insitu_levels *levels = &insitu->levels;
    int64_t ratio[3];
    ratio_of(levels, block->level, block->brick->level, ratio);
    cell_layer from = {.box = scaled(layer, ratio)}, to;
    snow_status status = take_own(insitu, block->brick, &from);
    for (int l = block->brick->level - 1;
         l >= block->level && status == SNOW_STATUS_OK; l--) {
        ratio_of(levels, block->level, l, ratio);
        to = (cell_layer){.box = scaled(layer, ratio)};
        status = reserve_layer(insitu->context, &to, true);
        ratio_of(levels, l, l + 1, ratio);
        if (status == SNOW_STATUS_OK)
            add_layer(&from, ratio, &to);
        clear_layer(insitu->context, &from);
        from = to;
    }
    if (status == SNOW_STATUS_OK)
        memcpy(out, from.values,
               (size_t)snow_box_voxels(layer) * sizeof *from.values);
    clear_layer(insitu->context, &from);
    return status;
}

snow_status snow_insitu_mean_cells(const snow_insitu *insitu,
                                   const snow_level_block *block, char *out) {
    snow_box layer = block->cells;
    layer.count[2] = 1;
    const size_t bytes = (size_t)snow_box_voxels(&layer) * sizeof(double);
    snow_status status = SNOW_STATUS_OK;
    for (int64_t n = 0; n < block->cells.count[2] && status == SNOW_STATUS_OK;
         n++, layer.first[2]++)
        status = mean_layer(insitu, block, &layer, out + (size_t)n * bytes);
    return status;
}
